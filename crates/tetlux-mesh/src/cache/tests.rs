use proptest::prelude::*;

use super::*;
use crate::procedural::{self, Split};

fn mesh() -> TetMesh {
    let parts = procedural::sphere_shell([7, 4, 2], Split::Six, DVec3::splat(1e6), [1.0, 2.0]);
    let radius = parts.sample(|p| p.length());
    let cells = parts.cells.len();
    let fields = vec![
        Field::point("radius", 1, radius),
        Field::cell("number", 2, (0..2 * cells).map(|i| if i == 3 { f64::NAN } else { i as f64 }).collect()),
    ];
    TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap()
}

fn origin() -> Origin {
    let source = SourceFile { path: "/shell.vtu".into(), size: 17, stamp: [1, 2, 3, 4, 5, 6], hash: [7; 32] };
    Origin {
        maker: "tetlux 1".into(),
        options: "split 6".into(),
        sources: vec![source],
        cell_counts: vec![("tetrahedra".into(), 5)],
        notes: vec!["nothing".into()],
    }
}

fn bytes() -> Vec<u8> {
    let mut bytes = Vec::new();
    mesh().write_cache(&origin(), &mut bytes).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> Result<TetMesh, CacheMiss> {
    CacheReader::new(bytes)?.mesh(bytes.len() as u64)
}

/// Bytes in which the byte at a place is another, and the hash and the checksum hold all the same.
fn forged(mut bytes: Vec<u8>, at: usize, to: u8) -> Vec<u8> {
    bytes[at] = to;
    let length = u64::from_ne_bytes(bytes[16..24].try_into().unwrap()) as usize;
    let (header, end) = (PREAMBLE..PREAMBLE + length, bytes.len() - CHECKSUM);
    let hash = *blake3::hash(&bytes[header.clone()]).as_bytes();
    bytes[PREAMBLE - HASH..PREAMBLE].copy_from_slice(&hash);
    let checksum = XxHash3_128::oneshot(&bytes[header.end..end]).to_ne_bytes();
    bytes[end..].copy_from_slice(&checksum);
    bytes
}

#[test]
fn a_mesh_comes_back_bit_for_bit() {
    let (mesh, bytes) = (mesh(), bytes());
    let reader = CacheReader::new(&bytes[..]).unwrap();
    assert_eq!((reader.origin(), reader.cells()), (&origin(), mesh.cells.len() as u64));
    let back = reader.mesh(bytes.len() as u64).unwrap();
    assert_eq!((back.origin, &back.points, &back.cells), (mesh.origin, &mesh.points, &mesh.cells));
    assert_eq!((&back.neighbors, back.assembly), (&mesh.neighbors, mesh.assembly));
    let bits = |m: &TetMesh| -> Vec<Vec<u64>> {
        m.fields.iter().map(|f| f.values.iter().map(|v| v.to_bits()).collect()).collect()
    };
    assert_eq!(bits(&back), bits(&mesh));
    assert_eq!(back.fields[1].name, "number");
}

#[test]
fn each_mismatch_has_its_reason() {
    let bytes = bytes();
    let changed = |at: usize| {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1;
        read(&bytes).unwrap_err()
    };
    for (at, miss) in [
        (0, CacheMiss::Foreign),
        (8, CacheMiss::Schema),
        (12, CacheMiss::Foreign),
        (16, CacheMiss::Damaged),
        (23, CacheMiss::Damaged),
        (24, CacheMiss::Damaged),
        (PREAMBLE, CacheMiss::Damaged),
        (bytes.len() - CHECKSUM - 1, CacheMiss::Damaged),
        (bytes.len() - 1, CacheMiss::Damaged),
    ] {
        assert_eq!(changed(at), miss, "{at}");
    }
    for length in [PREAMBLE, PREAMBLE + 100, bytes.len() / 2, bytes.len() - 1] {
        assert_eq!(read(&bytes[..length]).unwrap_err(), CacheMiss::Damaged, "{length}");
    }
    assert_eq!(read(&[]).unwrap_err(), CacheMiss::Foreign);
    assert_eq!(read(&[&bytes[..], b"more"].concat()).unwrap_err(), CacheMiss::Damaged);
}

#[test]
fn an_index_out_of_range_is_not_taken_though_the_checksum_holds() {
    let (bytes, mesh) = (bytes(), mesh());
    let arrays =
        bytes.len() - CHECKSUM - size_of_val(&mesh.fields[0].values[..]) - size_of_val(&mesh.fields[1].values[..]);
    let cells = size_of_val(&mesh.cells[..]);
    assert!(read(&forged(bytes.clone(), arrays - 1, bytes[arrays - 1])).is_ok());
    // The last byte of an index is its highest.
    for at in [arrays - 1, arrays - cells - 1] {
        assert_eq!(read(&forged(bytes.clone(), at, 0x70)).unwrap_err(), CacheMiss::Damaged);
    }
}

#[test]
fn the_identity_is_that_of_the_content_alone() {
    let identity = origin().identity();
    let mut touched = origin();
    touched.sources[0].stamp = [9; 6];
    assert_eq!(touched.identity(), identity);
    let changes: [fn(&mut Origin); 4] = [
        |o| o.maker.push('0'),
        |o| o.options.push('0'),
        |o| o.sources[0].hash[31] = 0,
        |o| o.sources[0].path.push('0'),
    ];
    for change in changes {
        let mut other = origin();
        change(&mut other);
        assert_ne!(other.identity(), identity);
    }
}

#[test]
fn a_header_too_long_to_read_is_not_written() {
    let long = Origin { notes: vec!["x".repeat(LONGEST_HEADER)], ..origin() };
    let mut bytes = Vec::new();
    assert_eq!(mesh().write_cache(&long, &mut bytes).unwrap_err().kind(), io::ErrorKind::InvalidInput);
    assert!(bytes.is_empty());
}

proptest! {
    /// Content whose hash and checksum hold but whose parts do not fit: as a fault of ours would write it.
    #[test]
    fn nothing_that_does_not_fit_is_taken(at in any::<proptest::sample::Index>(), to in any::<u8>()) {
        let bytes = bytes();
        let at = PREAMBLE + at.index(bytes.len() - PREAMBLE - CHECKSUM);
        // Any mesh that is given has parts that fit; a panic would fail the test.
        if let Ok(mesh) = read(&forged(bytes, at, to)) {
            prop_assert_eq!(mesh.cells.len(), mesh.neighbors.len());
        }
    }
}

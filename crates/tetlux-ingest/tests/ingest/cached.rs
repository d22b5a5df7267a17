//! Meshes kept between runs: used when all is as it was, and made anew when anything is not.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use tetlux_ingest::{
    Cache, CacheOutcome, Expression, Extras, Loaded, Miss, ReadOptions, Split, TetMesh, read_cached, read_tet_mesh,
};
use tetlux_mesh::cache::{CacheMiss, CacheReader};

use crate::writers::{Encoding, Folder, PLAIN, two_hexahedra, vtu};

/// A cache for small meshes too, in a folder that is not there yet.
fn cache(folder: &Folder) -> Cache {
    Cache { least_cells: 1, ..Cache::in_folder(folder.path().join("cache")) }
}

fn load(path: &Path, cache: &Cache) -> Loaded {
    read_cached(path, &ReadOptions::default(), Split::Six, Some(cache)).unwrap()
}

fn extras(loaded: &Loaded) -> &Extras {
    loaded.extras.as_ref().unwrap()
}

fn extra(path: &Path, cache: &Cache, name: &str) -> Option<Vec<u8>> {
    extras(&load(path, cache)).get(name)
}

fn outcome(path: &Path, cache: &Cache) -> CacheOutcome {
    load(path, cache).outcome
}

/// Two cubes whose cell numbers are others by `change`, in as many bytes.
fn numbered(change: f64) -> Vec<u8> {
    let mut mesh = two_hexahedra();
    mesh.fields[1].values = vec![7.0 + change, f64::NAN];
    let encoding = Encoding { compressed: false, ..Encoding::default() };
    vtu(&mesh, encoding)
}

fn assert_same(a: &TetMesh, b: &TetMesh) {
    assert_eq!((a.origin(), a.points(), a.cells()), (b.origin(), b.points(), b.cells()));
    assert_eq!((a.neighbors(), a.assembly()), (b.neighbors(), b.assembly()));
    let bits = |mesh: &TetMesh| -> Vec<(String, Vec<u64>)> {
        mesh.fields().iter().map(|f| (f.name.clone(), f.values.iter().map(|v| v.to_bits()).collect())).collect()
    };
    assert_eq!(bits(a), bits(b));
}

/// The one stored mesh.
fn entry(cache: &Cache) -> PathBuf {
    let entries = cache.entries().unwrap();
    assert_eq!(entries.len(), 1);
    entries[0].path.clone()
}

#[test]
fn the_second_time_the_mesh_comes_from_the_cache_bit_for_bit() {
    let folder = Folder::new();
    let (path, cache) = (folder.write("a.vtu", &numbered(0.0)), cache(&folder));
    let first = load(&path, &cache);
    assert_eq!(first.outcome, CacheOutcome::Stored(Miss::Absent));
    let second = load(&path, &cache);
    assert_eq!(second.outcome, CacheOutcome::Hit);
    assert_same(&first.mesh, &second.mesh);
    assert_same(&second.mesh, &read_tet_mesh(&path, &ReadOptions::default(), Split::Six).unwrap());
    assert_eq!((&first.cell_counts, &first.notes), (&second.cell_counts, &second.notes));
    assert_eq!(second.cell_counts, [("hexahedra".to_string(), 2)]);
    let listed = &cache.entries().unwrap()[0];
    assert_eq!((listed.source.as_deref(), listed.cells, &listed.state), (path.to_str(), 12, &Ok(())));
    assert_eq!(listed.bytes, fs::metadata(&listed.path).unwrap().len());
    // Without a cache nothing is looked for or left.
    let anew = read_cached(&path, &ReadOptions::default(), Split::Six, None).unwrap();
    assert_eq!(anew.outcome, CacheOutcome::Off);
    assert_same(&anew.mesh, &second.mesh);
}

#[test]
fn a_changed_file_is_read_anew_and_a_touched_one_is_not() {
    let folder = Folder::new();
    let (path, cache) = (folder.write("a.vtu", &numbered(0.0)), cache(&folder));
    load(&path, &cache);
    assert_eq!(numbered(0.0).len(), numbered(1.0).len());
    folder.write("a.vtu", &numbered(1.0));
    let changed = load(&path, &cache);
    assert_eq!(changed.outcome, CacheOutcome::Stored(Miss::Changed(path.to_str().unwrap().into())));
    assert_eq!(changed.mesh.fields()[1].values[0], 8.0);
    File::options().write(true).open(&path).unwrap().set_modified(SystemTime::UNIX_EPOCH).unwrap();
    assert_eq!(outcome(&path, &cache), CacheOutcome::Hit);
    fs::remove_file(&path).unwrap();
    assert!(matches!(cache.entries().unwrap()[0].state, Err(Miss::Changed(_))));
    assert!(read_cached(&path, &ReadOptions::default(), Split::Six, Some(&cache)).is_err());
}

/// Same size, same time of the last change: the time of the last change of state tells.
#[cfg(unix)]
#[test]
fn a_change_that_hides_is_seen() {
    let folder = Folder::new();
    let (path, cache) = (folder.write("a.vtu", &numbered(0.0)), cache(&folder));
    // Old enough to be trusted by its stamp.
    std::thread::sleep(Duration::from_millis(3_100));
    load(&path, &cache);
    let stamp = |path: &Path| CacheReader::new(File::open(path).unwrap()).unwrap().origin().sources[0].stamp;
    assert_ne!(stamp(&entry(&cache)), [0; 6]);
    let modified = fs::metadata(&path).unwrap().modified().unwrap();
    folder.write("a.vtu", &numbered(1.0));
    File::options().write(true).open(&path).unwrap().set_modified(modified).unwrap();
    assert_eq!(outcome(&path, &cache), CacheOutcome::Stored(Miss::Changed(path.to_str().unwrap().into())));
}

#[test]
fn each_option_has_a_mesh_of_its_own() {
    let folder = Folder::new();
    let cache = cache(&folder);
    let grid = folder.write("g.xyz", &PLAIN.grid([3, 2, 3], |_, u| u, |_| 1));
    let solutions = [1, 2].map(|n| {
        let solution = PLAIN.solution([3, 2, 3], |v, p| (n * v * p) as f32);
        folder.write(&format!("q{n}.bin"), &solution)
    });
    let with = |solution: Option<&PathBuf>| ReadOptions { solution: solution.cloned(), ..ReadOptions::default() };
    let requests = [
        (with(None), Split::Six),
        (with(None), Split::Five),
        (with(Some(&solutions[0])), Split::Six),
        (with(Some(&solutions[1])), Split::Six),
    ];
    for expected in [CacheOutcome::Stored(Miss::Absent), CacheOutcome::Hit] {
        for (options, split) in &requests {
            let loaded = read_cached(&grid, options, *split, Some(&cache)).unwrap();
            assert_eq!(loaded.outcome, expected);
            assert_same(&loaded.mesh, &read_tet_mesh(&grid, options, *split).unwrap());
        }
    }
    // A tetrahedron as a surface, filled in different ways.
    let surface = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let surface = folder.write("s.obj", surface.as_bytes());
    let fields = |text: &str| vec![("f".to_string(), Expression::parse(text).unwrap())];
    let requests = [
        ReadOptions { cell_size: Some(0.25), ..ReadOptions::default() },
        ReadOptions { cell_size: Some(0.2), ..ReadOptions::default() },
        ReadOptions { cell_size: Some(0.25), expressions: fields("x"), ..ReadOptions::default() },
        ReadOptions { cell_size: Some(0.25), expressions: fields("y"), ..ReadOptions::default() },
    ];
    for expected in [CacheOutcome::Stored(Miss::Absent), CacheOutcome::Hit] {
        for options in &requests {
            let loaded = read_cached(&surface, options, Split::Six, Some(&cache)).unwrap();
            assert_eq!(loaded.outcome, expected);
            assert_same(&loaded.mesh, &read_tet_mesh(&surface, options, Split::Six).unwrap());
        }
    }
    assert_eq!(cache.entries().unwrap().len(), 8);
}

#[test]
fn every_file_that_was_read_counts() {
    let folder = Folder::new();
    let cache = cache(&folder);
    let changed = |path: &Path| CacheOutcome::Stored(Miss::Changed(path.to_str().unwrap().into()));

    let pieces = ["a.vtu", "b.vtu"].map(|name| folder.write(name, &numbered(0.0)));
    let blocks = r#"<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet>
        <DataSet index="0" file="a.vtu"/><DataSet index="1" file="b.vtu"/></vtkMultiBlockDataSet></VTKFile>"#;
    folder.write("blocks.vtm", blocks.as_bytes());
    let times =
        r#"<VTKFile type="Collection"><Collection><DataSet timestep="0" file="blocks.vtm"/></Collection></VTKFile>"#;
    let times = folder.write("times.pvd", times.as_bytes());
    load(&times, &cache);
    assert_eq!(outcome(&times, &cache), CacheOutcome::Hit);
    folder.write("b.vtu", &numbered(1.0));
    assert_eq!(outcome(&times, &cache), changed(&pieces[1]));
    let sources = CacheReader::new(File::open(entry(&cache)).unwrap()).unwrap().origin().sources.len();
    assert_eq!(sources, 4);

    let grid = folder.write("g.xyz", &PLAIN.grid([2, 2, 2], |_, u| u, |_| 1));
    let solution = folder.write("q.bin", &PLAIN.solution([2, 2, 2], |v, p| (v * p) as f32));
    let options = ReadOptions { solution: Some(solution.clone()), ..ReadOptions::default() };
    let load_grid = || read_cached(&grid, &options, Split::Six, Some(&cache)).unwrap().outcome;
    assert_eq!([load_grid(), load_grid()], [CacheOutcome::Stored(Miss::Absent), CacheOutcome::Hit]);
    folder.write("q.bin", &PLAIN.solution([2, 2, 2], |v, p| (v + p) as f32));
    assert_eq!(load_grid(), changed(&solution));

    let nodes = folder.write("t.node", b"4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
    let elements = folder.write("t.ele", b"1 4 0\n0 0 1 2 3\n");
    load(&nodes, &cache);
    folder.write("t.ele", b"1 4 0\n0 0 2 1 3\n");
    assert_eq!(outcome(&nodes, &cache), changed(&elements));
}

#[test]
fn what_is_damaged_or_of_another_version_is_made_anew() {
    let folder = Folder::new();
    let (path, cache) = (folder.write("a.vtu", &numbered(0.0)), cache(&folder));
    let mesh = load(&path, &cache).mesh;
    let (stored, whole) = (entry(&cache), fs::read(entry(&cache)).unwrap());
    let expect = |bytes: &[u8], miss: Miss| {
        fs::write(&stored, bytes).unwrap();
        let loaded = load(&path, &cache);
        assert_eq!(loaded.outcome, CacheOutcome::Stored(miss));
        assert_same(&loaded.mesh, &mesh);
        assert_eq!(outcome(&path, &cache), CacheOutcome::Hit);
    };
    let flipped = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        bytes
    };
    expect(&whole[..whole.len() - 1], Miss::Unfit(CacheMiss::Damaged));
    expect(&whole[..100], Miss::Unfit(CacheMiss::Damaged));
    expect(b"", Miss::Unfit(CacheMiss::Foreign));
    expect(&flipped(whole.len() - 40), Miss::Unfit(CacheMiss::Damaged));
    expect(&flipped(8), Miss::Unfit(CacheMiss::Schema));
    let mut other = CacheReader::new(&whole[..]).unwrap().origin().clone();
    other.maker = "tetlux 0.0".into();
    let mut bytes = Vec::new();
    mesh.write_cache(&other, &mut bytes).unwrap();
    expect(&bytes, Miss::Version);
    // The mesh of other options under the name of these: as two keys of one hash would have it.
    other = CacheReader::new(&whole[..]).unwrap().origin().clone();
    other.options.push('x');
    bytes.clear();
    mesh.write_cache(&other, &mut bytes).unwrap();
    expect(&bytes, Miss::Absent);
}

#[test]
fn a_cache_that_cannot_be_written_is_told_and_no_error() {
    let folder = Folder::new();
    let path = folder.write("a.vtu", &numbered(0.0));
    // A file where a folder is needed: not writable for any user.
    let cache = Cache { least_cells: 1, ..Cache::in_folder(folder.write("file", b"kept").join("cache")) };
    let loaded = load(&path, &cache);
    assert!(matches!(&loaded.outcome, CacheOutcome::NotStored(why) if why.contains("cache")), "{:?}", loaded.outcome);
    assert!(loaded.extras.is_none());
    assert!(!loaded.mesh.cells().is_empty());
}

#[test]
fn small_meshes_and_ones_too_large_are_not_stored() {
    let folder = Folder::new();
    let path = folder.write("a.vtu", &numbered(0.0));
    let small = Cache { least_cells: 13, ..cache(&folder) };
    assert_eq!(outcome(&path, &small), CacheOutcome::Small);
    let large = Cache { most_bytes: 500, ..cache(&folder) };
    assert!(matches!(outcome(&path, &large), CacheOutcome::NotStored(why) if why.contains("500")));
    assert!(!small.folder.exists());
    assert_eq!((small.entries().unwrap().len(), small.clear().unwrap()), (0, (0, 0)));
}

#[test]
fn the_least_recently_used_go_first_and_clearing_leaves_others_files() {
    let folder = Folder::new();
    let mut cache = cache(&folder);
    let paths = [0, 1, 2].map(|n| folder.write(&format!("{n}.vtu"), &numbered(0.0)));
    load(&paths[0], &cache);
    let bytes = cache.entries().unwrap()[0].bytes;
    cache.most_bytes = 2 * bytes + bytes / 2;
    load(&paths[1], &cache);
    // As if the second was used long ago, and the first just now.
    for entry in cache.entries().unwrap() {
        let used = if entry.source.as_deref() == paths[1].to_str() { 1 } else { 2 };
        let time = SystemTime::UNIX_EPOCH + Duration::from_secs(used);
        File::options().append(true).open(entry.path).unwrap().set_modified(time).unwrap();
    }
    assert_eq!(outcome(&paths[0], &cache), CacheOutcome::Hit);
    load(&paths[2], &cache);
    let kept: Vec<Option<String>> = cache.entries().unwrap().into_iter().map(|entry| entry.source).collect();
    assert!(kept.len() == 2 && !kept.iter().any(|source| source.as_deref() == paths[1].to_str()), "{kept:?}");

    let other = cache.folder.join("notes.txt");
    fs::write(&other, "kept").unwrap();
    fs::write(cache.folder.join(".tetlux-cache-left"), "of a program that was stopped").unwrap();
    let (meshes, freed) = cache.clear().unwrap();
    assert!(meshes == 2 && freed > 2 * bytes, "{meshes} {freed}");
    let left: Vec<PathBuf> = fs::read_dir(&cache.folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(left, [other]);
}

#[test]
fn two_writers_leave_one_whole_mesh() {
    let folder = Folder::new();
    let (path, cache) = (folder.write("a.vtu", &numbered(0.0)), cache(&folder));
    let expected = read_tet_mesh(&path, &ReadOptions::default(), Split::Six).unwrap();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for round in 0..20 {
                    // Every other time it must be written again, while others read and write.
                    if round % 2 == 0 {
                        let _ = fs::remove_file(entry_path(&cache));
                    }
                    let loaded = load(&path, &cache);
                    assert_same(&loaded.mesh, &expected);
                    assert!(!matches!(loaded.outcome, CacheOutcome::NotStored(_)), "{:?}", loaded.outcome);
                }
            });
        }
    });
    assert_eq!(outcome(&path, &cache), CacheOutcome::Hit);
    assert_eq!(fs::read_dir(&cache.folder).unwrap().count(), 1, "no unfinished file is left");
}

/// Some stored mesh, or a path that is none.
fn entry_path(cache: &Cache) -> PathBuf {
    cache.entries().unwrap().into_iter().next().map_or_else(|| cache.folder.join("none"), |entry| entry.path)
}

#[test]
fn what_is_stored_beside_a_mesh_belongs_to_just_that_mesh() {
    let folder = Folder::new();
    let (path, cache) = (folder.write("a.vtu", &numbered(0.0)), cache(&folder));
    let first = load(&path, &cache);
    assert_eq!(extras(&first).get("order"), None);
    assert!(extras(&first).store("order", b"facts").unwrap());
    assert_eq!(extra(&path, &cache, "order"), Some(b"facts".to_vec()));
    assert_eq!(extra(&path, &cache, "other"), None);
    for bad in ["", "a/b", "..", "a.b"] {
        assert!(!extras(&first).store(bad, b"x").unwrap() && extras(&first).get(bad).is_none());
    }
    // It counts, is listed with its mesh, and goes with it.
    let listed = &cache.entries().unwrap()[0];
    assert!(listed.bytes > fs::metadata(&listed.path).unwrap().len());
    // A touched file leaves it, another content or a damaged byte does not.
    File::options().write(true).open(&path).unwrap().set_modified(SystemTime::UNIX_EPOCH).unwrap();
    assert_eq!(extra(&path, &cache, "order"), Some(b"facts".to_vec()));
    let beside = fs::read_dir(&cache.folder).unwrap().map(|e| e.unwrap().path()).find(|p| *p != listed.path).unwrap();
    let mut bytes = fs::read(&beside).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&beside, bytes).unwrap();
    assert_eq!(extra(&path, &cache, "order"), None);
    extras(&first).store("order", b"facts").unwrap();
    folder.write("a.vtu", &numbered(1.0));
    assert_eq!(extra(&path, &cache, "order"), None);
    cache.clear().unwrap();
    assert_eq!(fs::read_dir(&cache.folder).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn only_the_user_may_read_what_is_stored() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::new();
    let (path, cache) = (folder.write("a.vtu", &numbered(0.0)), cache(&folder));
    load(&path, &cache);
    for path in [&cache.folder, &entry(&cache)] {
        assert_eq!(fs::metadata(path).unwrap().permissions().mode() & 0o077, 0);
    }
}

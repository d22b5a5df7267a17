use std::ffi::OsString;
use std::fs::File;
use std::path::PathBuf;
use std::time::Duration;

use super::folder::user_folder;
use super::read_cached::READERS;
use super::*;
use crate::{ReadOptions, Split, read_tet_mesh};

#[test]
fn the_users_folder_is_named_or_the_platforms() {
    let folder = |variables: &[(&str, &str)]| {
        let variable = |name: &str| variables.iter().find(|(n, _)| *n == name).map(|(_, value)| OsString::from(value));
        user_folder(variable)
    };
    assert_eq!(folder(&[("TETLUX_CACHE_DIR", "/a/b"), ("HOME", "/c")]), Some(PathBuf::from("/a/b")));
    assert_eq!(folder(&[]), None);
    if cfg!(all(unix, not(target_os = "macos"))) {
        let home = Some(PathBuf::from("/c/.cache/tetlux"));
        assert_eq!(folder(&[("TETLUX_CACHE_DIR", ""), ("HOME", "/c")]), home);
        assert_eq!(folder(&[("XDG_CACHE_HOME", "/x"), ("HOME", "/c")]), Some(PathBuf::from("/x/tetlux")));
        assert_eq!(folder(&[("XDG_CACHE_HOME", "relative"), ("HOME", "/c")]), home);
    }
}

/// A stamp is relied on only where a later change cannot have the same, by the clock of whoever asks.
#[test]
fn a_file_just_written_has_no_stamp() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new");
    fs::write(&path, "x").unwrap();
    let written = raw_stamp(&fs::metadata(&path).unwrap()).unwrap();
    let last = written[0].max(written[2]);
    for (now, expected) in [(last - 1, None), (last, None), (last + 1, None), (last + 2, Some(written))] {
        assert_eq!(settled(written, now), expected, "{} s after it was written", now - last);
    }
    // Changed in what is to come, whatever the clock says: as by a machine whose clock is ahead.
    let ahead = SystemTime::now() + Duration::from_secs(86_400);
    File::options().write(true).open(&path).unwrap().set_modified(ahead).unwrap();
    assert_eq!(stamp(&path), None);
    assert_eq!(stamp(&folder.path().join("none")), None);
}

/// A hash of the meshes that come of all files that the tests hold. A change of what comes of them must raise `READERS`,
/// or meshes that earlier builds stored would be used: then write the new number and hash here. More files change the
/// hash alone.
#[cfg(target_endian = "little")]
#[test]
fn what_comes_of_files_is_what_the_number_says() {
    let mut paths = Vec::new();
    for folder in ["exodus", "gmsh", "tetgen", "vtk_legacy", "vtk_xml"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(folder);
        paths.extend(fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()));
    }
    paths.sort();
    let mut hasher = blake3::Hasher::new();
    let mut meshes = 0;
    for path in &paths {
        let Ok(mesh) = read_tet_mesh(path, &ReadOptions::default(), Split::Six) else { continue };
        let mut bytes = Vec::new();
        mesh.write_cache(&Default::default(), &mut bytes).unwrap();
        hasher.update(&bytes);
        meshes += 1;
    }
    assert!(meshes > 50, "{meshes} of {} files", paths.len());
    let found = hasher.finalize().to_hex();
    assert_eq!((READERS, &found[..16]), (1, "47ff06c54ef7134e"));
}

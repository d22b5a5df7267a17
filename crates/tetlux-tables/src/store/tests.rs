use proptest::prelude::*;
use tempfile::TempDir;

use super::*;
use crate::measure::measure;
use crate::{Design, Manifest, TableKind};

fn spec(precision: Precision) -> TableSpec {
    TableSpec { id: "q".to_owned(), kind: TableKind::Q { design: Design::Q }, size: [20, 18, 1], precision }
}

fn error() -> MeasuredError {
    MeasuredError { quantity: "w_b".to_owned(), max: 1e-3, mean: 1e-4, points: 10 }
}

/// A folder with a table of 20 x 18 texels.
fn stored() -> (TempDir, Store, TableSpec) {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    let spec = spec(Precision::F32);
    store.write(&Table::build(&spec).unwrap(), &error()).unwrap();
    (folder, store, spec)
}

/// Writes texels and metadata as another program, or a faulty one, might.
fn forge(
    store: &Store,
    spec: &TableSpec,
    size: [usize; 2],
    texels: &[f32],
    change: impl FnOnce(&mut serde_json::Value),
) {
    let table = Table::build(spec).unwrap();
    let metadata = store.write(&table, &error()).unwrap().metadata;
    let mut json = serde_json::to_value(&metadata).unwrap();
    change(&mut json);
    exr_file::write(&store.path(spec), size, spec.channels(), texels, false, &json.to_string()).unwrap();
}

/// Every message names the file and the command.
fn message(store: &Store, spec: &TableSpec) -> (StoreError, String) {
    let error = store.read(spec).unwrap_err();
    let text = error.to_string();
    assert!(text.contains(&file_name(spec)), "{text}");
    assert!(text.contains("cargo xtask build-tables --only q --size 20x18"), "{text}");
    (error, text)
}

#[test]
fn what_is_written_is_read() {
    let folder = tempfile::tempdir().unwrap();
    // The folder is made.
    let store = Store::new(folder.path().join("a").join("b"));
    let cube = TableKind::FrontBack { max_extinction: 3.0, max_length: 2.0 };
    for precision in Precision::ALL {
        let cube = TableSpec { id: "fb".to_owned(), kind: cube.clone(), size: [5, 6, 7], precision };
        for spec in [spec(precision), cube] {
            let table = Table::build(&spec).unwrap();
            let written = store.write(&table, &error()).unwrap();
            let read = store.read(&spec).unwrap();
            assert_eq!((&read.table, &read), (&table, &written), "{spec:?}");
            assert_eq!(store.read_metadata(&spec).unwrap(), written.metadata);
        }
    }
    assert_eq!(fs::read_dir(store.folder()).unwrap().count(), 8, "one file for each key");
}

#[test]
fn keys_tell_everything_apart_that_matters() {
    let base = spec(Precision::F32);
    let others = [
        TableSpec { id: "r".to_owned(), ..base.clone() },
        TableSpec { size: [20, 19, 1], ..base.clone() },
        TableSpec { kind: TableKind::Q { design: Design::R4 }, ..base.clone() },
        spec(Precision::U16),
    ];
    for other in &others {
        assert_ne!(key(&base), key(other));
    }
    assert_eq!(key(&base), key(&base.clone()));
    assert_eq!(key(&base).len(), 16);
}

#[test]
fn a_missing_table() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    let (error, _) = message(&store, &spec(Precision::F32));
    assert!(matches!(error, StoreError::Missing { .. }));
    fs::write(folder.path().join("q-v0-0123456789abcdef.exr"), "old").unwrap();
    let (_, text) = message(&store, &spec(Precision::F32));
    assert!(text.contains("q-v0-0123456789abcdef.exr, of another version"), "{text}");
}

#[test]
fn every_truncation_is_found() {
    let (_folder, store, spec) = stored();
    let path = store.path(&spec);
    let bytes = fs::read(&path).unwrap();
    for length in (0..bytes.len()).step_by(13).chain([bytes.len() - 1]) {
        fs::write(&path, &bytes[..length]).unwrap();
        let (error, text) = message(&store, &spec);
        assert!(matches!(error, StoreError::Damaged { .. }), "{length} bytes: {text}");
    }
}

#[test]
fn another_version_is_named() {
    let (_folder, store, spec) = stored();
    let texels = Table::build(&spec).unwrap().texels().to_vec();
    for (field, versions) in [("schema", "schema 7 and generator 1"), ("generator", "schema 1 and generator 7")] {
        forge(&store, &spec, [20, 18], &texels, |json| json[field] = 7.into());
        let (error, text) = message(&store, &spec);
        assert!(matches!(error, StoreError::Version { .. }) && text.contains(versions), "{text}");
    }
    // Another version's metadata may have any other form.
    forge(&store, &spec, [20, 18], &texels, |json| *json = serde_json::json!({"schema": 2, "generator": 1, "new": []}));
    assert!(matches!(store.read(&spec), Err(StoreError::Version { found: [2, 1], .. })));
}

#[test]
fn another_table_under_this_name() {
    let (_folder, store, spec) = stored();
    let other = TableSpec { kind: TableKind::Q { design: Design::R4 }, ..spec.clone() };
    store.write(&Table::build(&other).unwrap(), &error()).unwrap();
    fs::rename(store.path(&other), store.path(&spec)).unwrap();
    let (error, _) = message(&store, &spec);
    assert!(matches!(error, StoreError::Key { found, .. } if found == key(&other)));
    // The key alone is not believed either.
    let texels = Table::build(&spec).unwrap().texels().to_vec();
    forge(&store, &spec, [20, 18], &texels, |json| json["spec"]["size"] = serde_json::json!([20, 20, 1]));
    assert!(matches!(message(&store, &spec).0, StoreError::Key { .. }));
}

#[test]
fn another_size_is_found_before_it_is_decoded() {
    let (_folder, store, spec) = stored();
    forge(&store, &spec, [18, 20], Table::build(&spec).unwrap().texels(), |_| {});
    let (error, _) = message(&store, &spec);
    assert!(matches!(error, StoreError::Size { found: [18, 20], expected: [20, 18], .. }));
}

#[test]
fn texels_that_are_not_numbers_or_not_those_written() {
    let (_folder, store, spec) = stored();
    let texels = Table::build(&spec).unwrap().texels().to_vec();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut texels = texels.clone();
        texels[45] = bad;
        forge(&store, &spec, [20, 18], &texels, |_| {});
        assert!(matches!(message(&store, &spec).0, StoreError::NotFinite { index: 45, .. }), "{bad}");
    }
    let mut changed = texels.clone();
    changed[45] = f32::from_bits(changed[45].to_bits() ^ 1);
    forge(&store, &spec, [20, 18], &changed, |_| {});
    assert!(matches!(message(&store, &spec).0, StoreError::Hash { .. }), "a single bit");
    forge(&store, &spec, [20, 18], &texels, |json| json["hash"] = "0".into());
    assert!(matches!(message(&store, &spec).0, StoreError::Hash { .. }));
    forge(&store, &spec, [20, 18], &texels, |_| {});
    store.read(&spec).unwrap();
}

#[test]
fn other_channels_and_other_files() {
    let (_folder, store, spec) = stored();
    let text = serde_json::to_string(&store.read_metadata(&spec).unwrap()).unwrap();
    exr_file::write(&store.path(&spec), [20, 18], &["Y"], &[0.5; 360], false, &text).unwrap();
    let (_, words) = message(&store, &spec);
    assert!(words.contains("channels Y instead of q"), "{words}");
    exr_file::write(&store.path(&spec), [20, 18], &["q"], &[0.5; 360], false, "{}").unwrap();
    assert!(matches!(message(&store, &spec).0, StoreError::Damaged { .. }));
    for bytes in [&b""[..], b"\x89PNG\r\n\x1a\n", &[0; 4096], &[0x76, 0x2f, 0x31, 0x01]] {
        fs::write(store.path(&spec), bytes).unwrap();
        assert!(matches!(message(&store, &spec).0, StoreError::Damaged { .. }));
    }
    fs::remove_file(store.path(&spec)).unwrap();
    fs::create_dir(store.path(&spec)).unwrap();
    assert!(matches!(message(&store, &spec).0, StoreError::Damaged { .. } | StoreError::Open { .. }));
}

#[test]
fn a_failing_write_leaves_the_table_that_was_there() {
    let (folder, store, spec) = stored();
    let other = TableSpec { size: [4, 4, 1], ..spec.clone() };
    fs::create_dir(store.path(&other)).unwrap();
    fs::write(store.path(&other).join("inside"), "kept").unwrap();
    let error = store.write(&Table::build(&other).unwrap(), &error()).unwrap_err();
    assert!(error.to_string().contains(&file_name(&other)), "{error}");
    assert!(store.read(&spec).is_ok());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "no temporary file is left");
}

#[test]
fn the_manifest_names_each_file_once() {
    let (_folder, store, spec) = stored();
    let metadata = store.read_metadata(&spec).unwrap();
    assert!(Manifest::read(&store).tables.is_empty(), "there is none yet");
    let manifest = Manifest::add(&store, [&metadata, &metadata]).unwrap();
    let read = Manifest::read(&store);
    assert_eq!(read, manifest);
    assert_eq!(read.tables.len(), 1);
    assert_eq!(store.folder().join(&read.tables[0].file), store.path(&spec));
    fs::write(store.folder().join("manifest.json"), "{").unwrap();
    assert!(Manifest::read(&store).tables.is_empty(), "a damaged one is rebuilt");
}

#[test]
fn the_committed_table_is_what_would_be_built() {
    let store = Store::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tables"));
    let spec = TableSpec::default_q();
    let stored = store.read(&spec).unwrap();
    let built = Table::build(&spec).unwrap();
    // Elementary functions of another platform may round otherwise: some ulp of values up to 2/3.
    let tolerance = 3e-7;
    for (a, b) in stored.table.texels().iter().zip(built.texels()) {
        assert!((a - b).abs() <= tolerance, "{a} and {b}");
    }
    let measured = measure(&stored.table).unwrap();
    assert!((measured.max / stored.metadata.error.max - 1.0).abs() < 0.01, "{measured:?}");
    assert!(measured.max < 5e-5);
}

/// Each once read the manifest, added its own table and wrote it: that of the other was lost.
#[test]
fn tables_built_at_once_are_all_in_the_manifest() {
    let (_folder, store, spec) = stored();
    let metadata = store.read_metadata(&spec).unwrap();
    let spec = |number: usize| TableSpec { id: format!("q{number}"), ..spec.clone() };
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (store, metadata, spec) = (&store, &metadata, &spec);
            scope.spawn(move || {
                for number in 0..8 {
                    let metadata = Metadata { spec: spec(8 * thread + number), ..metadata.clone() };
                    Manifest::add(store, [&metadata]).unwrap();
                }
            });
        }
    });
    assert_eq!(Manifest::read(&store).tables.len(), 32);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_changed_file_is_refused_or_says_the_same(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let (_folder, store, spec) = stored();
        let original = store.read(&spec).unwrap();
        let path = store.path(&spec);
        let mut bytes = fs::read(&path).unwrap();
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        fs::write(&path, &bytes).unwrap();
        if let Ok(read) = store.read(&spec) {
            // What survives is a change in what nobody reads: padding, the compression's freedom, stated errors.
            prop_assert_eq!(read.table, original.table);
        }
    }
}

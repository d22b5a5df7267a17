//! Files that are either written whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use tempfile::Builder;

use crate::ImageError;

/// Writes a file through `write`, so that `path` holds either all of it or what it held before.
///
/// The bytes go to a temporary file in the same folder, reach the disk, and are then renamed to `path`. On any
/// failure the temporary file is removed and `path` is left alone. What is there and no regular file, as a pipe or
/// `/dev/stdout`, is not replaced: the bytes go straight to it.
///
/// # Errors
/// [`ImageError::Io`] if the folder does not take the temporary file, `write` fails, or the rename fails.
pub fn write_atomically(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), ImageError> {
    let failed = |source| ImageError::io(path, "write", source);
    if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir()) {
        let mut device = BufWriter::new(File::options().write(true).open(path).map_err(failed)?);
        return write(&mut device).and_then(|()| device.flush()).map_err(failed);
    }
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = Builder::new();
    builder.prefix(".tetlux-");
    // Temporary files are private by default; a result is as readable as any other new file (the umask still applies).
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder
        .tempfile_in(folder)
        .map_err(|source| ImageError::io(path, "create a temporary file beside it", source))?;

    let mut buffered = BufWriter::new(file);
    write(&mut buffered).map_err(failed)?;
    let file = buffered.into_inner().map_err(|error| failed(error.into_error()))?;
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|error| ImageError::io(path, "rename the finished file to it", error.error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.json");
        for text in ["a longer first text", "second"] {
            write_atomically(&path, |file| file.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names(folder.path()), ["report.json"]);
    }

    #[test]
    fn a_failing_write_leaves_the_previous_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.json");
        fs::write(&path, "before").unwrap();
        let error = write_atomically(&path, |file| {
            file.write_all(&[b'x'; 100_000])?; // more than a buffer, so that some of it reaches the disk
            Err(io::Error::other("planted failure"))
        })
        .unwrap_err();
        assert!(error.to_string().contains("report.json") && error.to_string().contains("planted failure"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        assert_eq!(names(folder.path()), ["report.json"]);
    }

    #[test]
    fn a_destination_that_cannot_be_replaced_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        fs::write(taken.join("inside"), "kept").unwrap();
        assert!(write_atomically(&taken, |file| file.write_all(b"new")).is_err());
        assert_eq!(fs::read_to_string(taken.join("inside")).unwrap(), "kept");
        assert_eq!(names(folder.path()), ["taken"]);

        let absent = folder.path().join("absent").join("file");
        assert!(matches!(write_atomically(&absent, |_| Ok(())), Err(ImageError::Io { path, .. }) if path == absent));
    }

    /// As one that is run by the superuser could: they once were.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_is_written_to_and_not_replaced() {
        use std::os::unix::fs::FileTypeExt;

        let folder = tempfile::tempdir().unwrap();
        for (device, takes) in [("/dev/null", true), ("/dev/full", false)] {
            let link = folder.path().join("link");
            std::os::unix::fs::symlink(device, &link).unwrap();
            let written = write_atomically(&link, |file| file.write_all(b"x"));
            assert_eq!(written.is_ok(), takes, "{device}");
            let named = written.err().is_none_or(|error| error.to_string().contains("link: cannot write"));
            assert!(named && fs::metadata(&link).unwrap().file_type().is_char_device(), "{device}");
            assert_eq!(names(folder.path()), ["link"]);
            fs::remove_file(link).unwrap();
        }
    }

    #[cfg(unix)]
    #[test]
    fn the_result_is_as_readable_as_any_new_file() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_atomically(&ours, |file| file.write_all(b"x")).unwrap();
        fs::write(&plain, "x").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}

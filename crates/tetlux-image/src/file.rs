//! Files as they may be read: regular ones; and pictures by their content.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use crate::{Image, ImageError, read_exr, read_png};

/// How every PNG begins.
const PNG: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Reads a picture by [`read_png`] if it begins as PNGs do, whatever its name, else by [`read_exr`].
///
/// # Errors
/// Those of the two.
pub fn read_image(path: &Path) -> Result<Image, ImageError> {
    let io = |source| ImageError::io(path, "open", source);
    let mut start = Vec::new();
    open_file(path).map_err(io)?.take(PNG.len() as u64).read_to_end(&mut start).map_err(io)?;
    if start == PNG { read_png(path) } else { read_exr(path) }
}

/// Opens a regular file for reading: a pipe could make its reader wait for ever, and a device never end.
///
/// # Errors
/// What the system says; [`io::ErrorKind::InvalidInput`], or that of a directory, if it is no regular file.
pub fn open_file(path: &Path) -> io::Result<File> {
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory: name a file in it"));
    }
    if !metadata.is_file() {
        let message = "it is a pipe or a device, and no regular file: copy its content into one";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    File::open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_opened_and_a_folder_and_nothing_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        assert_eq!(open_file(&path).unwrap_err().kind(), io::ErrorKind::NotFound);
        fs::write(&path, "x").unwrap();
        assert_eq!(open_file(&path).unwrap().metadata().unwrap().len(), 1);
        assert_eq!(open_file(folder.path()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
    }

    #[test]
    fn the_content_decides_how_a_picture_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let [png, exr] = ["picture.exr", "picture.png"].map(|name| folder.path().join(name));
        let image = Image::from_pixels(1, 1, vec![[0.0, 1.0, 0.0, 1.0]]).unwrap();
        crate::write_png(&image, &png, crate::Encoding::Srgb).unwrap();
        crate::write_exr(&image, &exr, None).unwrap();
        assert_eq!((read_image(&png).unwrap(), read_image(&exr).unwrap()), (image.clone(), image));
        fs::write(&png, "").unwrap();
        assert!(read_image(&png).unwrap_err().to_string().contains("picture.exr"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_without_an_end_is_refused() {
        assert_eq!(open_file(Path::new("/dev/zero")).unwrap_err().kind(), io::ErrorKind::InvalidInput);
    }
}

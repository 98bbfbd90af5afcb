//! Bytes from the disk, and nothing but files of a reasonable size.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::io::printable_path;

/// Why a file could not be read. Paths are escaped.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Nothing has that name.
    #[error("there is no such file: {path}")]
    Missing {
        /// Which.
        path: String,
    },

    /// A directory, a device, a pipe: reading it would fail, or never end.
    #[error("{kind}, not a file: {path}")]
    NotAFile {
        /// Which.
        path: String,
        /// What it is.
        kind: &'static str,
    },

    /// More than the caller can use.
    #[error("too large: {size} bytes, where at most {limit} are read: {path}")]
    TooLarge {
        /// Which.
        path: String,
        /// Bytes it has.
        size: u64,
        /// Bytes it may have.
        limit: u64,
    },

    /// The system does not let us.
    #[error("cannot be read ({reason}): {path}")]
    Unreadable {
        /// Which.
        path: String,
        /// What the system says.
        reason: io::Error,
    },
}

/// Reads a whole file of at most `limit` bytes. Directories, devices and pipes are refused before
/// they are opened.
pub fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let metadata = std::fs::metadata(path).map_err(|reason| io_error(path, reason))?;
    if !metadata.is_file() {
        let kind = if metadata.is_dir() { "a directory" } else { "a device or a pipe" };
        return Err(FileError::NotAFile { path: printable_path(path), kind });
    }
    check_size(path, metadata.len(), limit)?;
    let file = File::open(path).map_err(|reason| io_error(path, reason))?;
    // The file may have grown since: one byte more than allowed tells.
    let mut bytes = Vec::with_capacity(metadata.len() as usize + 1);
    file.take(limit.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|reason| io_error(path, reason))?;
    check_size(path, bytes.len() as u64, limit)?;
    Ok(bytes)
}

fn check_size(path: &Path, size: u64, limit: u64) -> Result<(), FileError> {
    if limit < size {
        return Err(FileError::TooLarge { path: printable_path(path), size, limit });
    }
    Ok(())
}

fn io_error(path: &Path, reason: io::Error) -> FileError {
    let path = printable_path(path);
    if reason.kind() == io::ErrorKind::NotFound {
        return FileError::Missing { path };
    }
    FileError::Unreadable { path, reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(read_file(&path, 5).unwrap(), b"12345");
        let message = read_file(&path, 4).unwrap_err().to_string();
        assert!(message.starts_with("too large: 5 bytes, where at most 4 are read: "), "{message}");
        assert!(message.ends_with("a"), "{message}");
    }

    #[test]
    fn what_is_not_a_file_is_refused_by_its_kind() {
        let folder = tempfile::tempdir().unwrap();
        let message = read_file(folder.path(), 10).unwrap_err().to_string();
        assert!(message.starts_with("a directory, not a file: "), "{message}");
        let message = read_file(&folder.path().join("b\u{1b}"), 10).unwrap_err().to_string();
        assert!(message.starts_with("there is no such file: "), "{message}");
        assert!(message.ends_with("b\\u{1b}"), "{message}");
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused_and_endless_ones_do_not_hang() {
        let message = read_file(Path::new("/dev/zero"), 10).unwrap_err().to_string();
        assert_eq!(message, "a device or a pipe, not a file: /dev/zero");
    }
}

//! Whole files into memory: regular files only, up to a limit.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::io::printable_path;

/// Why a file could not be read. The path is escaped where it is shown.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}: {reason}", printable_path(.path))]
pub struct FileError {
    path: PathBuf,
    reason: String,
}

impl FileError {
    fn new(path: &Path, reason: impl Into<String>) -> Self {
        Self { path: path.to_owned(), reason: reason.into() }
    }

    /// Nothing of that name.
    pub fn not_found(path: &Path) -> Self {
        Self::new(path, "no such file")
    }

    /// There, but not what it was.
    pub fn changed(path: &Path) -> Self {
        Self::new(path, "has changed since the snapshot was made; put the old file beside the PNG")
    }

    /// What is wrong, without the path.
    pub fn reason(&self) -> &str {
        &self.reason
    }
}

/// Reads a regular file of at most `limit` bytes.
///
/// # Errors
/// When it is not there, cannot be read, is a folder or a device, or is longer.
pub fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let system = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => FileError::not_found(path),
        _ => FileError::new(path, error.to_string()),
    };
    // Before it is opened: opening a pipe would wait for its writer.
    let metadata = std::fs::metadata(path).map_err(system)?;
    if metadata.is_dir() {
        return Err(FileError::new(path, "is a folder; name a file in it"));
    }
    if !metadata.is_file() {
        return Err(FileError::new(path, "is no regular file"));
    }
    let too_long = || {
        let (length, limit) = (metadata.len() >> 20, limit >> 20);
        FileError::new(path, format!("is {length} MiB long; at most {limit} MiB are read"))
    };
    if metadata.len() > limit {
        return Err(too_long());
    }
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(metadata.len() as usize)
        .map_err(|_| FileError::new(path, "does not fit into memory"))?;
    // One byte more than allowed tells a file that grows.
    let file = File::open(path).map_err(system)?;
    file.take(limit + 1).read_to_end(&mut bytes).map_err(system)?;
    if bytes.len() as u64 > limit {
        return Err(too_long());
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_readable_file_is_refused_with_its_path() {
        let folder = tempfile::tempdir().unwrap();
        let missing = read_file(&folder.path().join("a.obj"), 10).unwrap_err().to_string();
        assert!(missing.ends_with("a.obj: no such file"), "{missing}");
        let dir = read_file(folder.path(), 10).unwrap_err().to_string();
        assert!(dir.contains("is a folder"), "{dir}");
        let path = folder.path().join("long.obj");
        std::fs::write(&path, [0; 11]).unwrap();
        let long = read_file(&path, 10).unwrap_err().to_string();
        assert!(long.contains("at most"), "{long}");
        assert_eq!(read_file(&path, 11).unwrap(), [0; 11], "within the limit");
        #[cfg(unix)]
        {
            let device = read_file(Path::new("/dev/zero"), 10).unwrap_err().to_string();
            assert!(device.contains("no regular file"), "{device}");
        }
    }
}

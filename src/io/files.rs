//! Whole files into memory: regular files only, up to a limit.

use std::fs::{File, Metadata};
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::io::{memory, printable_path};

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
/// When it is not there, cannot be read, is a folder or a device, is longer, does not fit into
/// memory, or is changed by another program meanwhile.
pub fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let system = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => FileError::not_found(path),
        _ => FileError::new(path, error.to_string()),
    };
    // Before it is opened: opening a device may do something.
    check_kind(path, &std::fs::metadata(path).map_err(system)?)?;
    let mut file = open_without_waiting(path).map_err(system)?;
    // Of what was opened, which may be something else by now.
    let before = file.metadata().map_err(system)?;
    check_kind(path, &before)?;
    if limit < before.len() {
        let (length, limit) = (before.len() >> 20, limit >> 20);
        let reason = format!("is {length} MiB long; at most {limit} MiB are read");
        return Err(FileError::new(path, reason));
    }
    memory::check(before.len()).map_err(|error| FileError::new(path, error.to_string()))?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(before.len() as usize)
        .map_err(|_| FileError::new(path, "does not fit into memory"))?;
    // One byte more tells a file that grows, or is longer than it says, as the system's own may be.
    file.by_ref().take(before.len() + 1).read_to_end(&mut bytes).map_err(system)?;
    if before.len() < bytes.len() as u64 {
        return Err(changed_meanwhile(path));
    }
    check_unchanged(path, &before, &file.metadata().map_err(system)?)?;
    Ok(bytes)
}

fn check_unchanged(path: &Path, before: &Metadata, after: &Metadata) -> Result<(), FileError> {
    let is_same = before.len() == after.len() && before.modified().ok() == after.modified().ok();
    if is_same { Ok(()) } else { Err(changed_meanwhile(path)) }
}

fn changed_meanwhile(path: &Path) -> FileError {
    FileError::new(path, "was changed while it was read; open it again")
}

fn check_kind(path: &Path, metadata: &Metadata) -> Result<(), FileError> {
    if metadata.is_dir() {
        return Err(FileError::new(path, "is a folder; name a file in it"));
    }
    if !metadata.is_file() {
        return Err(FileError::new(path, "is no regular file"));
    }
    Ok(())
}

/// Opens a file for reading. Neither this nor reading waits for somebody at the other end of a pipe
/// that took the file's place, or for the next message of a kernel's log.
fn open_without_waiting(path: &Path) -> std::io::Result<File> {
    let mut options = File::options();
    options.read(true);
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    options.open(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

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
        #[cfg(target_os = "linux")]
        {
            // Calls itself a regular file, and would wait for the kernel's next message.
            let log = read_file(Path::new("/proc/kmsg"), 10).unwrap_err().to_string();
            assert!(log.starts_with("/proc/kmsg: "), "{log}");
            // Say that they are empty; the second has no end.
            for name in ["/proc/self/status", "/proc/self/pagemap"] {
                let error = read_file(Path::new(name), 1 << 30).unwrap_err().to_string();
                assert!(error.starts_with(name), "{error}");
            }
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_pipe_that_took_a_files_place_is_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("a.obj");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success(), "mkfifo");
        let (sender, opened) = std::sync::mpsc::channel();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let read = open_without_waiting(&pipe).and_then(|mut file| file.read(&mut [0]));
                sender.send(read.unwrap()).unwrap();
            });
            let n_read = opened.recv_timeout(Duration::from_secs(20));
            // Lets go whoever waits for the other end.
            drop(File::options().read(true).write(true).open(&pipe));
            assert_eq!(n_read, Ok(0), "it waits for the other end");
        });
    }

    #[test]
    fn a_file_that_changes_under_the_reader_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "v 0 0 0").unwrap();
        let before = std::fs::metadata(&path).unwrap();
        assert!(check_unchanged(&path, &before, &before).is_ok(), "nothing changed");
        std::fs::write(&path, "v 0 0").unwrap();
        let after = std::fs::metadata(&path).unwrap();
        let error = check_unchanged(&path, &before, &after).unwrap_err().to_string();
        assert!(error.contains("a.obj: was changed while"), "{error}");
    }
}

//! Where the files of a scene are looked for, and a record of what was read.

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::io::files::{FileError, read_file};
use crate::io::gallery;

/// Largest mesh, image or library that is read, in bytes.
pub const LARGEST_ASSET: u64 = 4 << 30;

/// The place that a scene's relative paths start from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Folder {
    /// A folder of the file system.
    Disk(PathBuf),
    /// The `scenes` folder inside the program.
    Gallery,
    /// A snapshot's files: each is taken from the first place where it is unchanged.
    Snapshot {
        /// The folder that the scene was opened from, where the snapshot says so.
        recorded: Option<Box<Self>>,
        /// The folder of the PNG.
        beside: PathBuf,
        /// What the files were.
        files: Vec<FileRecord>,
    },
}

/// One file that a scene used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRecord {
    /// As the scene names it, relative to its folder.
    pub file: String,
    /// Length in bytes.
    pub size: u64,
    /// SHA-256 in hexadecimal.
    pub sha256: String,
}

impl FileRecord {
    /// The record of a file's content.
    pub fn of(file: &str, bytes: &[u8]) -> Self {
        let sha256 = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        Self { file: file.to_owned(), size: bytes.len() as u64, sha256 }
    }
}

impl Folder {
    /// The folder that a file lies in.
    pub fn of(path: &Path) -> Self {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        Self::Disk(parent.unwrap_or(Path::new(".")).to_owned())
    }

    /// Reads a file named relative to this folder.
    ///
    /// # Errors
    /// When it is not there, is no regular file, or is longer than [`LARGEST_ASSET`].
    pub fn read(&self, file: &str) -> Result<Vec<u8>, FileError> {
        match self {
            Self::Disk(folder) => read_file(&folder.join(file), LARGEST_ASSET),
            // A scene of the gallery can be given a file of one's own.
            Self::Gallery if Path::new(file).is_absolute() => {
                read_file(Path::new(file), LARGEST_ASSET)
            }
            Self::Gallery => {
                let path = normalised(&Path::new("scenes").join(file));
                gallery::file(&path)
                    .map(<[u8]>::to_vec)
                    .ok_or_else(|| FileError::not_found(Path::new(file)))
            }
            Self::Snapshot { recorded, beside, files } => {
                read_unchanged(recorded.as_deref(), beside, files, file)
            }
        }
    }

    /// Whether this is the place of a snapshot that used a file of that name.
    pub fn has_record_of(&self, file: &str) -> bool {
        match self {
            Self::Disk(_) | Self::Gallery => false,
            Self::Snapshot { files, .. } => files.iter().any(|record| record.file == file),
        }
    }

    /// The one folder to name in a new snapshot: of a snapshot's, the one it records, or that of
    /// the PNG where its files lie there and not in the other.
    pub fn home(&self) -> Self {
        let Self::Snapshot { recorded, beside, files } = self else { return self.clone() };
        let beside = Self::Disk(beside.clone());
        let has_all = |place: &Self| {
            files.iter().all(|record| {
                let path = place.disk_path(&record.file);
                path.is_none_or(|path| path.metadata().is_ok_and(|it| it.len() == record.size))
            })
        };
        match recorded.as_deref() {
            Some(recorded) if has_all(recorded) || !has_all(&beside) => recorded.clone(),
            Some(_) | None => beside,
        }
    }

    /// Where a file named relative to this folder is on disk, for watching it.
    pub fn disk_path(&self, file: &str) -> Option<PathBuf> {
        match self {
            Self::Disk(folder) => Some(folder.join(file)),
            Self::Gallery if Path::new(file).is_absolute() => Some(file.into()),
            Self::Gallery | Self::Snapshot { .. } => None,
        }
    }
}

fn read_unchanged(
    recorded: Option<&Folder>,
    beside: &Path,
    files: &[FileRecord],
    file: &str,
) -> Result<Vec<u8>, FileError> {
    let wanted = files.iter().find(|record| record.file == file);
    let name = Path::new(file).file_name().and_then(OsStr::to_str).unwrap_or(file);
    let places = [
        recorded.map(|folder| (folder.clone(), file)),
        Some((Folder::Disk(beside.to_owned()), file)),
        Some((Folder::Disk(beside.to_owned()), name)),
        Some((Folder::Gallery, file)),
    ];
    let mut is_changed = false;
    for (folder, file_there) in places.into_iter().flatten() {
        let Ok(bytes) = folder.read(file_there) else { continue };
        match wanted {
            Some(record) if *record != FileRecord::of(file, &bytes) => is_changed = true,
            Some(_) | None => return Ok(bytes),
        }
    }
    let path = beside.join(file);
    Err(if is_changed { FileError::changed(&path) } else { FileError::not_found(&path) })
}

/// The path with `.` and `..` worked out, `/` between its parts.
fn normalised(path: &Path) -> String {
    let mut parts: Vec<String> = Vec::new();
    for component in path.components() {
        match component {
            Component::Normal(part) => parts.push(part.to_string_lossy().into_owned()),
            Component::ParentDir => {
                parts.pop();
            }
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_of_the_gallery_can_have_a_file_of_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, b"12345").unwrap();
        let named = path.to_str().unwrap();
        assert_eq!(Folder::Gallery.read(named).ok().as_deref(), Some(&b"12345"[..]), "not read");
        assert_eq!(Folder::Gallery.disk_path(named), Some(path.clone()), "not watched");
        assert!(Folder::Gallery.read("a.obj").is_err(), "found where it is not");
        assert_eq!(Folder::Gallery.disk_path("a.obj"), None, "it has no place");
    }

    /// A snapshot made of a snapshot names the folder in which the files lie.
    #[test]
    fn a_new_snapshot_names_the_folder_that_has_the_files() {
        let folder = tempfile::tempdir().unwrap();
        let [scene, pictures] = ["scene", "pictures"].map(|name| folder.path().join(name));
        let of = |recorded: Option<&Path>| Folder::Snapshot {
            recorded: recorded.map(|path| Box::new(Folder::Disk(path.to_owned()))),
            beside: pictures.clone(),
            files: vec![FileRecord::of("a.obj", b"12345")],
        };
        let put = |place: &Path, bytes: &[u8]| {
            std::fs::create_dir_all(place).unwrap();
            std::fs::write(place.join("a.obj"), bytes).unwrap();
        };
        put(&scene, b"12345");
        let home = |recorded: Option<&Path>| of(recorded).home();
        assert_eq!(home(Some(&scene)), Folder::Disk(scene.clone()), "not where they are");
        assert_eq!(home(None), Folder::Disk(pictures.clone()), "there is one place only");
        put(&pictures, b"12345");
        assert_eq!(home(Some(&scene)), Folder::Disk(scene.clone()), "both have them");
        put(&scene, b"changed");
        assert_eq!(home(Some(&scene)), Folder::Disk(pictures.clone()), "one has another file");
        put(&pictures, b"changed");
        assert_eq!(home(Some(&scene)), Folder::Disk(scene.clone()), "neither has it");
        assert_eq!(Folder::Gallery.home(), Folder::Gallery, "a folder is its own home");
    }
}

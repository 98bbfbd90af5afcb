//! A scene saved in another folder still finds its files: paths on disk are written anew, files
//! inside the program or a snapshot are copied beside the scene.

use crate::io::folder::Folder;
use crate::io::output::create_file;
use crate::scene::description::SceneDescription;
use std::collections::HashMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Why a scene cannot be saved there.
#[derive(Debug, thiserror::Error)]
pub(super) enum RelocateError {
    /// A file that the scene uses cannot be copied.
    #[error("{file}: cannot be copied beside the scene: {reason}")]
    Copy {
        /// As the scene names it.
        file: String,
        /// What is wrong.
        reason: String,
    },
}

/// The description as the file at `target` must say it, when its paths start from `folder` now.
/// Copies what has no place on disk; `files` are all that were read, libraries of meshes too.
///
/// # Errors
/// When a file cannot be copied.
pub(super) fn relocated(
    description: &SceneDescription,
    folder: &Folder,
    files: &[String],
    target: &Path,
) -> Result<SceneDescription, RelocateError> {
    let target = std::path::absolute(target).unwrap_or_else(|_| target.to_owned());
    let beside = target.parent().unwrap_or(Path::new("")).to_owned();
    let mut new_paths = HashMap::new();
    for file in files {
        let new = match folder.disk_path(file) {
            Some(path) => relative(&path, &beside),
            None => copied(folder, file, &target, &beside)?,
        };
        new_paths.insert(file.clone(), new);
    }
    let mut moved = description.clone();
    let named = moved
        .objects
        .iter_mut()
        .map(|object| &mut object.file)
        .chain(moved.textures.iter_mut().map(|texture| &mut texture.file));
    for file in named.flatten() {
        if let Some(new) = new_paths.get(file) {
            file.clone_from(new);
        }
    }
    Ok(moved)
}

/// A path as seen from a folder, with `/` between its parts; unchanged where nothing is shared.
pub(super) fn relative(path: &Path, from: &Path) -> String {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (path, from) = (normalised(&path), normalised(from));
    let n_shared = path.components().zip(from.components()).take_while(|(a, b)| a == b).count();
    let shares_root = 0 < n_shared;
    let parts: Vec<String> = if shares_root {
        let up = from.components().skip(n_shared).map(|_| "..".to_owned());
        let down = path.components().skip(n_shared);
        up.chain(down.map(|part| part.as_os_str().to_string_lossy().into_owned())).collect()
    } else {
        return path.to_string_lossy().into_owned();
    };
    parts.join("/")
}

/// The path with `.` and `..` worked out.
fn normalised(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                plain.pop();
            }
            Component::Prefix(_) | Component::RootDir | Component::Normal(_) => plain.push(part),
        }
    }
    plain
}

/// Writes a file that has no place on disk into a folder named after the scene.
fn copied(
    folder: &Folder,
    file: &str,
    target: &Path,
    beside: &Path,
) -> Result<String, RelocateError> {
    let failure = |reason: String| RelocateError::Copy { file: file.to_owned(), reason };
    let bytes = folder.read(file).map_err(|error| failure(error.to_string()))?;
    let stem = target.file_stem().unwrap_or_default().to_string_lossy();
    let name = Path::new(file).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let place = format!("{stem}-files");
    fs::create_dir_all(beside.join(&place)).map_err(|error| failure(error.to_string()))?;
    let path = beside.join(&place).join(&name);
    let is_there = fs::read(&path).is_ok_and(|there| there == bytes);
    if !is_there {
        create_file(&path, &bytes).map_err(|error| failure(error.to_string()))?;
    }
    Ok(format!("{place}/{name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_seen_from_the_new_folder() {
        for (path, from, seen) in [
            ("/a/b/c.obj", "/a/b", "c.obj"),
            ("/a/b/../assets/c.obj", "/a/scenes", "../assets/c.obj"),
            ("/a/c.obj", "/x/y", "../../a/c.obj"),
        ] {
            let told = relative(Path::new(path), Path::new(from));
            assert_eq!(told, seen, "{path} from {from}");
        }
    }
}

//! What is remembered from one run to the next, in a file that is always whole: an older one, or
//! the newest.

use super::state::Remembered;
use crate::io::files::read_file;
use crate::io::output::replace_file;
use crate::threads;
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

/// Longest file that is read, in bytes.
const LARGEST_FILE: u64 = 1 << 20;

/// The file, and what it holds.
#[derive(Debug)]
pub(super) struct Settings {
    /// `None` where there is no place for it.
    path: Option<PathBuf>,
    kept: Remembered,
    writing: Option<JoinHandle<()>>,
}

/// Reads what was kept in that folder; what cannot be read is as if it had never been.
pub(super) fn load(folder: Option<&Path>) -> Remembered {
    let bytes = folder.and_then(|folder| read_file(&path_in(folder), LARGEST_FILE).ok());
    let text = bytes.and_then(|bytes| String::from_utf8(bytes).ok());
    text.and_then(|text| toml::from_str(&text).ok()).unwrap_or_default()
}

fn path_in(folder: &Path) -> PathBuf {
    folder.join("settings.toml")
}

impl Settings {
    /// What is kept in that folder from now on; `kept` is what it holds.
    pub(super) fn new(folder: Option<&Path>, kept: Remembered) -> Self {
        Self { path: folder.map(path_in), kept, writing: None }
    }

    /// Keeps this, where it is news. Writing happens on a thread of its own.
    pub(super) fn keep(&mut self, remembered: &Remembered) {
        if self.kept == *remembered {
            return;
        }
        let Some(path) = self.path.clone() else { return };
        let Ok(text) = toml::to_string(remembered) else { return };
        self.kept = remembered.clone();
        self.finish();
        let write = move || {
            let folder_is_there =
                path.parent().is_none_or(|it| std::fs::create_dir_all(it).is_ok());
            if folder_is_there {
                // Where it cannot be written, the next run starts with what was kept before.
                let _ = replace_file(&path, text.as_bytes());
            }
        };
        self.writing = threads::spawn("settings", write).ok();
    }

    fn finish(&mut self) {
        if let Some(writing) = self.writing.take() {
            // A panic has been reported where it happened.
            let _ = writing.join();
        }
    }
}

impl Drop for Settings {
    fn drop(&mut self) {
        self.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::state::InterfaceState;

    #[test]
    fn settings_come_back_and_broken_ones_are_forgotten() {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("own");
        let mut state = InterfaceState { scene_unit_mm: 12.5, ..InterfaceState::default() };
        state.remember_file(PathBuf::from("a.toml"));
        #[cfg(unix)]
        {
            use std::os::unix::ffi::OsStringExt;
            state.remember_file(std::ffi::OsString::from_vec(vec![0xff]).into());
        }
        let remembered = Remembered::of(&state);
        Settings::new(Some(&own), Remembered::default()).keep(&remembered);
        assert_eq!(load(Some(&own)), remembered, "something was lost");
        std::fs::write(own.join("settings.toml"), b"scene_unit_mm = \xff").unwrap();
        assert_eq!(load(Some(&own)), Remembered::default(), "broken");
    }
}

//! What is remembered from one run to the next, in a file that is always whole: an older one, or
//! the newest.

use super::state::Remembered;
use crate::io::files::read_file;
use crate::io::output::{WriteError, replace_file};
use crate::threads;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest file that is read, in bytes.
const LARGEST_FILE: u64 = 1 << 20;

/// The file, and what it holds.
pub(super) struct Settings {
    /// `None` where there is no place for it.
    path: Option<PathBuf>,
    /// `None` where the newest could not be written: then it is tried again.
    kept: Option<Remembered>,
    writing: Option<JoinHandle<Result<(), WriteError>>>,
    /// Why it could not be written, until that is told.
    fault: Option<String>,
    /// Whether that was told; once is enough, until it has been written again.
    complained: bool,
    ctx: egui::Context,
}

/// Reads what was kept in that folder; what cannot be read is as if it had never been.
pub(super) fn load(folder: Option<&Path>) -> Remembered {
    let bytes = folder.and_then(|folder| read_file(&path_in(folder), LARGEST_FILE).ok());
    let text = bytes.and_then(|bytes| String::from_utf8(bytes).ok());
    text.and_then(|text| toml::from_str(&text).ok()).unwrap_or_default()
}

/// Whether the program has been here before: it leaves its settings behind.
pub(super) fn are_there(folder: Option<&Path>) -> bool {
    folder.is_some_and(|folder| path_in(folder).exists())
}

fn path_in(folder: &Path) -> PathBuf {
    folder.join("settings.toml")
}

impl Settings {
    /// What is kept in that folder from now on; `kept` is what it holds. `ctx` is woken when
    /// something has been written.
    pub(super) fn new(folder: Option<&Path>, kept: Remembered, ctx: &egui::Context) -> Self {
        Self {
            path: folder.map(path_in),
            kept: Some(kept),
            writing: None,
            fault: None,
            complained: false,
            ctx: ctx.clone(),
        }
    }

    /// Keeps this, where it is news. Writing happens on a thread of its own.
    pub(super) fn keep(&mut self, remembered: &Remembered) {
        self.finish();
        if self.kept.as_ref() == Some(remembered) {
            return;
        }
        let Some(path) = self.path.clone() else { return };
        let Ok(text) = toml::to_string(remembered) else { return };
        self.kept = Some(remembered.clone());
        let ctx = self.ctx.clone();
        let write = move || {
            let folder = path.parent().unwrap_or(&path);
            let written = std::fs::create_dir_all(folder)
                .map_err(|error| WriteError::new(&path, error))
                .and_then(|()| replace_file(&path, text.as_bytes()));
            // A moment later: then this thread has ended.
            ctx.request_repaint_after(Duration::from_millis(100));
            written
        };
        self.writing = threads::spawn("settings", write).ok();
        if self.writing.is_none() {
            self.kept = None;
        }
    }

    /// Why the newest could not be written, once. The next run starts with what was kept before.
    pub(super) fn take_fault(&mut self) -> Option<String> {
        if self.writing.as_ref().is_some_and(JoinHandle::is_finished) {
            self.finish();
        }
        let fault = self.fault.take()?;
        let is_news = !std::mem::replace(&mut self.complained, true);
        is_news.then(|| format!("cannot keep your settings: {fault}"))
    }

    fn finish(&mut self) {
        let Some(writing) = self.writing.take() else { return };
        match writing.join() {
            Ok(Ok(())) => self.complained = false,
            Ok(Err(error)) => (self.kept, self.fault) = (None, Some(error.to_string())),
            // A panic has been reported where it happened.
            Err(_) => self.kept = None,
        }
    }
}

impl Drop for Settings {
    fn drop(&mut self) {
        self.finish();
        if let Some(fault) = self.take_fault() {
            // Where stderr is closed, nobody is left to be told.
            let _ = writeln!(std::io::stderr(), "warning: {fault}");
        }
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
        let ctx = egui::Context::default();
        Settings::new(Some(&own), Remembered::default(), &ctx).keep(&remembered);
        assert_eq!(load(Some(&own)), remembered, "something was lost");
        std::fs::write(own.join("settings.toml"), b"scene_unit_mm = \xff").unwrap();
        assert_eq!(load(Some(&own)), Remembered::default(), "broken");
    }
}

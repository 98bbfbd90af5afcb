//! What leaves the window: scene files, snapshots, the clipboard. Writing happens on other threads.

use super::app::App;
use super::files::Written;
use super::relocate::relocated;
use crate::io::output::{OutputFormat, check_writable, create_file, replace_file};
use crate::io::{scene_file, snapshot};
use crate::session::Frame;
use crate::session::develop::encode;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// More snapshots of one scene than this are not numbered.
const MOST_SNAPSHOTS: u32 = 9999;

impl App {
    /// Saves the scene as it is now in that file.
    pub(super) fn save_to(&mut self, ctx: &egui::Context, path: PathBuf) {
        let path = with_scene_ending(&path);
        let description = self.document.description.clone();
        let folder = self.files.folder.clone();
        let files: Vec<String> =
            self.files.records.iter().map(|record| record.file.clone()).collect();
        self.files.write(ctx, move || {
            let moved = match relocated(&description, &folder, &files, &path) {
                Ok(moved) => moved,
                Err(error) => return Written::Failed(error.to_string()),
            };
            match replace_file(&path, scene_file::write(&moved).as_bytes()) {
                Ok(()) => Written::Scene { path, description: Box::new(description) },
                Err(error) => Written::Failed(error.to_string()),
            }
        });
    }

    /// Asks for a snapshot: of this picture, or of the first full one that comes.
    pub(super) fn snapshot(&mut self) {
        self.snapshot_wanted = true;
    }

    /// Writes the snapshot that was asked for, once `frame` is a full picture of the scene as it
    /// is now.
    pub(super) fn take_snapshot(&mut self, ctx: &egui::Context, frame: &Arc<Frame>) {
        let is_full = frame.scale == 1 && 0 < frame.samples;
        if !self.snapshot_wanted || !is_full || !self.work.is_current(frame) {
            return;
        }
        self.snapshot_wanted = false;
        let frame = Arc::clone(frame);
        let description = self.document.description.clone();
        let folder = self.files.folder.clone();
        let records = self.files.records.clone();
        let title = self.files.title.clone();
        let pictures = self.interface.export.folder();
        self.files.write(ctx, move || {
            let size = (frame.job.width, frame.job.height);
            let texts =
                match snapshot::texts(&description, size, frame.samples, &records, Some(&folder)) {
                    Ok(texts) => texts,
                    Err(error) => return Written::Failed(format!("snapshot: {error}")),
                };
            let tone = &description.tone_mapping;
            let path = pictures.join(&title);
            let written = encode(&path, OutputFormat::Png, &frame.picture, tone, &texts)
                .map_err(|error| error.to_string())
                .and_then(|bytes| write_numbered(&pictures, &title, "png", &bytes));
            written.map_or_else(Written::Failed, Written::Snapshot)
        });
    }

    /// Puts the picture on show on the clipboard.
    pub(super) fn copy_picture(&mut self, ctx: &egui::Context) {
        match self.picture_on_show() {
            Some(image) => {
                ctx.copy_image(egui::ColorImage::clone(image));
                self.toasts.say("copied the picture");
            }
            None => self.toasts.say("there is no picture yet"),
        }
    }
}

/// A whole path for a scene file, with its ending where none was given.
pub(super) fn with_scene_ending(path: &Path) -> PathBuf {
    let path = match path.extension() {
        Some(_) => path.to_owned(),
        None => path.with_extension("toml"),
    };
    std::path::absolute(&path).unwrap_or(path)
}

/// Writes to the first free of the names `{title}-001.png`, `{title}-002.png` and so on; gives
/// back which, or what is wrong.
pub(super) fn write_numbered(
    folder: &Path,
    title: &str,
    ending: &str,
    bytes: &[u8],
) -> Result<PathBuf, String> {
    for path in free_names(folder, title, ending) {
        match create_file(&path, bytes) {
            Ok(()) => return Ok(path),
            // Another program was quicker with this name.
            Err(error) if error.is_name_clash() => {}
            Err(error) => return Err(error.to_string()),
        }
    }
    Err(no_name(folder, title))
}

/// Finds out whether [`write_numbered`] could write there now.
pub(super) fn check_numbered(folder: &Path, title: &str, ending: &str) -> Result<(), String> {
    let path = free_names(folder, title, ending).next().ok_or_else(|| no_name(folder, title))?;
    check_writable(&path).map_err(|error| error.to_string())
}

fn free_names(folder: &Path, title: &str, ending: &str) -> impl Iterator<Item = PathBuf> {
    let name = move |number| folder.join(format!("{title}-{number:03}.{ending}"));
    (1..=MOST_SNAPSHOTS).map(name).filter(|path| !path.exists())
}

fn no_name(folder: &Path, title: &str) -> String {
    format!("{}: too many pictures of {title}", folder.display())
}

/// Where snapshots go: the user's pictures, else the home folder, else where the program runs.
pub(super) fn pictures_folder() -> PathBuf {
    let home = std::env::home_dir().filter(|home| home.is_dir());
    let pictures = home.as_ref().map(|home| home.join("Pictures")).filter(|path| path.is_dir());
    pictures.or(home).unwrap_or_else(|| PathBuf::from("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapshots_never_overwrite_one_another() {
        let folder = tempfile::tempdir().unwrap();
        for (n_before, content) in [b"one", b"two", b"six"].into_iter().enumerate() {
            let expected = folder.path().join(format!("egg-{:03}.png", n_before + 1));
            let written = write_numbered(folder.path(), "egg", "png", content);
            assert_eq!(written, Ok(expected), "another name");
        }
        let first = std::fs::read(folder.path().join("egg-001.png")).unwrap();
        assert_eq!(first, b"one", "the first snapshot was overwritten");
    }
}

//! After a crash the scene is still there: while it has unsaved edits, a copy is kept in the
//! program's own folder, as a snapshot without a picture.

use super::app::App;
use super::dialogs::{BELOW_TOP, over_picture};
use super::files::Written;
use super::theme::main_button;
use crate::io::output::{encode_png, replace_file};
use crate::io::snapshot;
use crate::loader::Source;
use crate::scene::description::SceneDescription;
use egui::{Id, RichText};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Seconds between two copies.
const PERIOD_SECS: f64 = 15.0;

/// Windows that keep copies beside one another.
const MOST_WINDOWS: u32 = 32;

/// The copy on disk, and what this window knows of it.
#[derive(Debug, Default)]
pub(super) struct Recovery {
    /// Where it is kept; `None` where there is no such place.
    path: Option<PathBuf>,
    /// Locked while this window lives, so that no other takes its copy for one left behind.
    _lock: Option<File>,
    /// Whether one from an earlier, crashed window is there.
    offered: bool,
    /// Whether this window has written one.
    written: bool,
    /// Whether it was told that the newest could not be written.
    complained: bool,
    last_time: f64,
    /// What the copy holds.
    copied: Option<SceneDescription>,
}

impl Recovery {
    /// Looks whether a window that is gone left a copy behind in that folder.
    pub(super) fn new(folder: Option<PathBuf>) -> Self {
        let Some(folder) = folder else { return Self::default() };
        let copy = |number: &u32| folder.join(format!("recovery-{number}.png"));
        let left_behind = (1..=MOST_WINDOWS).filter(|number| copy(number).is_file());
        let place = |number| Some((copy(&number), lock_of(&folder, number)?));
        let found = left_behind.into_iter().find_map(place);
        let offered = found.is_some();
        let (path, lock) = found.or_else(|| (1..=MOST_WINDOWS).find_map(place)).unzip();
        Self { path, _lock: lock, offered, ..Self::default() }
    }

    /// Whether this is the copy.
    pub(super) fn is_copy(&self, source: &Source) -> bool {
        matches!(source, Source::File(path) if Some(path) == self.path.as_ref())
    }

    /// The copy is open, and not saved: it goes when that is over.
    pub(super) fn note_restored(&mut self) {
        self.written = true;
    }

    /// A copy has been written; the scene may have been saved meanwhile, and then it goes again.
    pub(super) fn note_written(&mut self) {
        self.written = true;
        self.complained = false;
    }

    /// No copy could be written: another is tried when its time comes. Whether to tell that: once.
    pub(super) fn note_failed(&mut self) -> bool {
        self.copied = None;
        !std::mem::replace(&mut self.complained, true)
    }

    /// Removes the copy: everything is saved, or let go on purpose.
    pub(super) fn forget(&mut self) {
        if let Some(path) = self.path.as_ref().filter(|_| self.written) {
            // Where it cannot be removed it is offered next time; nothing is lost.
            let _ = std::fs::remove_file(path);
        }
        self.written = false;
        self.copied = None;
    }
}

#[cfg(test)]
impl Recovery {
    /// Offers a copy as if it had been left behind.
    pub(super) fn pretend_to_find(&mut self, path: impl Into<PathBuf>) {
        self.path = Some(path.into());
        self.offered = true;
    }
}

/// The lock of a copy; `None` while a living window has it.
fn lock_of(folder: &Path, number: u32) -> Option<File> {
    // Where the folder cannot be made, neither can the lock.
    let _ = std::fs::create_dir_all(folder);
    let path = folder.join(format!("recovery-{number}.lock"));
    let lock = File::options().create(true).truncate(false).write(true).open(path).ok()?;
    lock.try_lock().is_ok().then_some(lock)
}

impl App {
    /// Keeps a copy of unsaved edits every so often.
    pub(super) fn keep_copy(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|input| input.time);
        let is_dirty = self.document.is_dirty();
        if !is_dirty {
            self.recovery.forget();
        }
        let is_kept = self.recovery.copied.as_ref() == Some(&self.document.description);
        if !is_dirty || is_kept || self.recovery.offered {
            return;
        }
        let left = PERIOD_SECS - (now - self.recovery.last_time);
        if 0.0 < left {
            ctx.request_repaint_after(Duration::from_secs_f64(left));
            return;
        }
        self.recovery.last_time = now;
        let Some(path) = self.recovery.path.clone() else { return };
        self.recovery.written = true;
        let description = self.document.description.clone();
        self.recovery.copied = Some(description.clone());
        let (folder, records) = (self.files.folder.clone(), self.files.records.clone());
        self.files.write(ctx, move || {
            let render = &description.render;
            let size = (render.width, render.height);
            let texts =
                snapshot::texts(&description, size, render.samples, &records, Some(&folder));
            let written = texts
                .map_err(|error| error.to_string())
                .and_then(|texts| {
                    encode_png((1, 1), &[0; 3], &texts).map_err(|error| error.to_string())
                })
                .and_then(|bytes| replace_file(&path, &bytes).map_err(|error| error.to_string()));
            match written {
                Ok(()) => Written::Copy,
                Err(reason) => {
                    Written::NoCopy(format!("cannot keep a copy of your edits: {reason}"))
                }
            }
        });
    }

    /// Offers the copy that a crashed window left behind.
    pub(super) fn offer_copy(&mut self, ctx: &egui::Context) {
        let Some(path) = self.recovery.path.clone().filter(|_| self.recovery.offered) else {
            return;
        };
        let over = self.viewport.rect;
        // Below the box for a path, where that is open.
        let foot = self.dialogs.foot(ctx).map_or(over.top() + BELOW_TOP, |foot| foot + 8.0);
        let (restore, drop) = over_picture(ctx, Id::unique("recovery"), foot, over, |ui| {
            ui.label(RichText::new("Penumbra was not closed properly").strong());
            ui.label("There is a copy of the scene that was being edited, with its edits.");
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let restore = ui.add(main_button(ui, "Restore")).clicked();
                let drop = ui.button("Discard").on_hover_text("removes the copy").clicked();
                (restore, drop)
            })
            .inner
        });
        if restore {
            self.open(Source::File(path.clone()));
        }
        if restore || drop {
            self.recovery.offered = false;
            // One that is restored stays until it is loaded and saved.
            self.recovery.written = drop;
            if drop {
                self.recovery.forget();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_do_not_take_the_copies_of_others_that_live() {
        let folder = tempfile::tempdir().unwrap();
        let own = || Some(folder.path().join("own"));
        let first = Recovery::new(own());
        std::fs::write(first.path.as_ref().unwrap(), "a copy").unwrap();
        let second = Recovery::new(own());
        assert!(!second.offered, "the copy of a living window is offered");
        assert_ne!(first.path, second.path, "two windows share one place");
        let left_behind = first.path.clone();
        drop(first);
        let third = Recovery::new(own());
        assert!(third.offered && third.path == left_behind, "the copy left behind is not found");
    }
}

//! Asking for a path: the system's dialog off the window's thread, a box for typing where there is
//! none, and the question before unsaved edits would be lost.

use super::theme::modal_frame;
use crate::threads;
use egui::{Align2, Id, Key, RichText, Vec2};
use std::path::PathBuf;
use std::pin::Pin;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// A dialog that answers "nothing" faster than a hand can is a dialog that never opened.
const FASTER_THAN_A_HAND: Duration = Duration::from_millis(300);

/// What a path is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// A scene, a mesh or a snapshot to open.
    Open,
    /// A place for the scene file.
    SaveScene,
    /// The folder of rendered pictures.
    PictureFolder,
}

/// What a dialog will have answered: a path, or nothing.
pub(super) type Answer = Pin<Box<dyn Future<Output = Option<PathBuf>> + Send>>;
/// Opens a dialog for a purpose, with a suggestion, and gives back its answer to come.
pub(super) type Chooser = Box<dyn Fn(Purpose, &str) -> Answer>;

/// The system's dialog while it is open, and the box for typing.
pub(super) struct PathDialogs {
    /// Where a path is chosen: the system's dialogs, or what a test answers.
    pub(super) chooser: Chooser,
    asking: Option<Asking>,
    typing: Option<Typing>,
}

impl Default for PathDialogs {
    fn default() -> Self {
        Self::like(rfd::AsyncFileDialog::new())
    }
}

struct Asking {
    purpose: Purpose,
    answer: Receiver<Option<PathBuf>>,
    since: Instant,
}

struct Typing {
    purpose: Purpose,
    text: String,
    is_new: bool,
}

impl PathDialogs {
    /// The desktop's dialogs, above the window that `dialog` belongs to.
    pub(super) fn like(dialog: rfd::AsyncFileDialog) -> Self {
        let open = move |purpose, suggestion: &str| system_dialog(&dialog, purpose, suggestion);
        Self { chooser: Box::new(open), asking: None, typing: None }
    }

    /// Opens the system's dialog; the answer comes through [`Self::take_path`].
    pub(super) fn ask(&mut self, ctx: &egui::Context, purpose: Purpose, suggestion: &str) {
        if self.asking.is_some() {
            return;
        }
        let (sender, answer) = channel();
        let ctx = ctx.clone();
        // The future is made here, where macOS wants it, and waited for elsewhere.
        let chosen = (self.chooser)(purpose, suggestion);
        let started = threads::spawn("file dialog", move || {
            let _ = sender.send(pollster::block_on(chosen));
            ctx.request_repaint();
        });
        match started {
            Ok(_) => self.asking = Some(Asking { purpose, answer, since: Instant::now() }),
            Err(_) => self.type_path(purpose, suggestion),
        }
    }

    /// Opens the box for typing a path.
    pub(super) fn type_path(&mut self, purpose: Purpose, suggestion: &str) {
        self.typing = Some(Typing { purpose, text: suggestion.to_owned(), is_new: true });
    }

    /// Closes the box. False where it was not open.
    pub(super) fn dismiss(&mut self) -> bool {
        self.typing.take().is_some()
    }

    /// A path that was chosen or typed, once.
    pub(super) fn take_path(&mut self, ctx: &egui::Context) -> Option<(Purpose, PathBuf)> {
        self.answered().or_else(|| self.typed(ctx))
    }

    fn answered(&mut self) -> Option<(Purpose, PathBuf)> {
        let asking = self.asking.as_ref()?;
        let answer = match asking.answer.try_recv() {
            Ok(answer) => answer,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => None,
        };
        let (purpose, took) = (asking.purpose, asking.since.elapsed());
        self.asking = None;
        if answer.is_none() && took < FASTER_THAN_A_HAND {
            self.type_path(purpose, "");
        }
        answer.map(|path| (purpose, path))
    }

    fn typed(&mut self, ctx: &egui::Context) -> Option<(Purpose, PathBuf)> {
        let typing = self.typing.as_mut()?;
        let answer = path_box(ctx, typing);
        let chosen = matches!(answer, BoxAnswer::Chosen) && !typing.text.trim().is_empty();
        let result = chosen.then(|| (typing.purpose, PathBuf::from(typing.text.trim())));
        if chosen || matches!(answer, BoxAnswer::Cancelled) {
            self.typing = None;
        }
        result
    }
}

/// The dialog of the desktop.
fn system_dialog(dialog: &rfd::AsyncFileDialog, purpose: Purpose, suggestion: &str) -> Answer {
    let dialog = dialog.clone();
    let chosen: Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match purpose {
        Purpose::Open => {
            let filter = ["toml", "obj", "png"];
            Box::pin(dialog.add_filter("Scenes, meshes, snapshots", &filter).pick_file())
        }
        Purpose::SaveScene => {
            let dialog = dialog.add_filter("Scene", &["toml"]).set_file_name(suggestion);
            Box::pin(dialog.save_file())
        }
        Purpose::PictureFolder => Box::pin(dialog.set_directory(suggestion).pick_folder()),
    };
    Box::pin(async { chosen.await.map(|file| file.path().to_owned()) })
}

enum BoxAnswer {
    Typing,
    Chosen,
    Cancelled,
}

fn path_box(ctx: &egui::Context, typing: &mut Typing) -> BoxAnswer {
    let (title, button) = match typing.purpose {
        Purpose::Open => ("Open a scene, a mesh or a snapshot", "Open"),
        Purpose::SaveScene => ("Save the scene as", "Save"),
        Purpose::PictureFolder => ("Folder for pictures", "Choose"),
    };
    egui::Area::new(Id::unique("path box"))
        .order(egui::Order::Foreground)
        .anchor(Align2::CENTER_TOP, Vec2::new(0.0, 64.0))
        .show(ctx, |ui| {
            egui::Frame::popup(ui.style())
                .inner_margin(14)
                .show(ui, |ui| {
                    ui.label(RichText::new(title).strong());
                    ui.add_space(4.0);
                    ui.horizontal(|ui| {
                        let field = egui::TextEdit::singleline(&mut typing.text)
                            .hint_text(if typing.purpose == Purpose::PictureFolder {
                                "path of a folder"
                            } else {
                                "path of a file"
                            })
                            .align(Align2::LEFT_CENTER)
                            .desired_width(380.0);
                        let response = ui.add(field).accessible_name("Path");
                        if typing.is_new {
                            response.request_focus();
                            typing.is_new = false;
                        }
                        let entered = response.lost_focus()
                            && ui.input(|input| input.key_pressed(Key::Enter));
                        let ready = !typing.text.trim().is_empty();
                        let confirmed = ui.add_enabled(ready, egui::Button::new(button)).clicked();
                        let cancelled = ui.button("Cancel").clicked()
                            || ui.input(|input| input.key_pressed(Key::Escape));
                        if cancelled {
                            BoxAnswer::Cancelled
                        } else if confirmed || entered {
                            BoxAnswer::Chosen
                        } else {
                            BoxAnswer::Typing
                        }
                    })
                    .inner
                })
                .inner
        })
        .inner
}

/// What to do with edits that no file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnsavedAnswer {
    /// Save them first.
    Save,
    /// Let them go.
    Discard,
    /// Stay.
    Cancel,
}

/// Asks what to do with unsaved edits of the scene of that name.
pub(super) fn unsaved_question(ctx: &egui::Context, title: &str) -> Option<UnsavedAnswer> {
    let frame = modal_frame(&ctx.global_style());
    let modal = egui::Modal::new(Id::unique("unsaved")).frame(frame).show(ctx, |ui| {
        ui.set_width(360.0);
        ui.heading(format!("Save the changes to {title}?"));
        ui.add_space(4.0);
        ui.label(RichText::new("They are lost if you do not save them.").weak());
        ui.add_space(12.0);
        ui.horizontal(|ui| {
            let save = ui.button("Save").clicked().then_some(UnsavedAnswer::Save);
            let discard = ui.button("Do not save").clicked().then_some(UnsavedAnswer::Discard);
            let cancel = ui.button("Cancel").clicked().then_some(UnsavedAnswer::Cancel);
            save.or(discard).or(cancel)
        })
        .inner
    });
    modal.inner.or(modal.should_close().then_some(UnsavedAnswer::Cancel))
}

/// Asks whether to close the window while a picture is being rendered: true closes it.
pub(super) fn picture_question(ctx: &egui::Context) -> Option<bool> {
    let frame = modal_frame(&ctx.global_style());
    let modal = egui::Modal::new(Id::unique("picture at work")).frame(frame).show(ctx, |ui| {
        ui.set_width(360.0);
        ui.heading("A picture is still being rendered");
        ui.add_space(4.0);
        ui.label(RichText::new("It is lost if you close the window now.").weak());
        ui.add_space(12.0);
        ui.horizontal(|ui| {
            let stay = ui.button("Go on rendering").clicked().then_some(false);
            stay.or(ui.button("Stop it and close").clicked().then_some(true))
        })
        .inner
    });
    modal.inner.or(modal.should_close().then_some(false))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the system has no dialogs, the answer is "nothing" at once, or there is none.
    #[test]
    fn where_no_dialog_opens_a_path_can_be_typed() {
        let now = Instant::now();
        let long_ago = now.checked_sub(2 * FASTER_THAN_A_HAND).unwrap();
        for (is_sent, since, types) in
            [(true, now, true), (false, now, true), (true, long_ago, false)]
        {
            let (sender, answer) = channel();
            if is_sent {
                sender.send(None).unwrap();
            }
            drop(sender);
            let asking = Some(Asking { purpose: Purpose::Open, answer, since });
            let mut dialogs = PathDialogs { asking, ..PathDialogs::default() };
            assert_eq!(dialogs.answered(), None, "nobody chose a path");
            assert!(dialogs.asking.is_none(), "the dialog stays open");
            assert_eq!(dialogs.typing.is_some(), types, "sent {is_sent}, since {since:?}");
        }
    }
}

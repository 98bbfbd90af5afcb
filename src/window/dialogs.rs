//! Asking for a path: the system's dialog off the window's thread, a box for typing where there is
//! none.

use super::output::with_scene_ending;
use crate::threads;
use egui::{Align2, Event, Id, Key, Pos2, Rect, RichText};
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// A dialog that answers "nothing" faster than a hand can is a dialog that never opened.
const FASTER_THAN_A_HAND: Duration = Duration::from_millis(300);
/// From the top of the picture to a box over it, in points.
pub(super) const BELOW_TOP: f32 = 24.0;
/// Room for a path, in points.
const PATH_WIDTH: f32 = 380.0;

/// What a path is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// A scene, a mesh or a snapshot to open.
    Open,
    /// A place for the scene file.
    SaveScene,
    /// The folder of rendered pictures.
    PictureFolder,
    /// The mesh of an object.
    Mesh,
    /// The picture of a texture.
    Image,
}

/// The end of a question for a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Answered {
    /// What the path was asked for.
    pub(super) purpose: Purpose,
    /// The path; `None` where the question was left unanswered.
    pub(super) path: Option<PathBuf>,
}

/// What a dialog will have answered: a path, or nothing.
pub(super) type Answer = Pin<Box<dyn Future<Output = Option<PathBuf>> + Send>>;
/// Opens a dialog for a purpose, with a suggestion, and gives back its answer to come.
pub(super) type Chooser = Box<dyn Fn(Purpose, &str) -> Answer>;

/// The system's dialog while it is open, and the box for typing.
pub(super) struct PathDialogs {
    /// Where a path is chosen: the system's dialogs, or what a test answers.
    pub(super) chooser: Chooser,
    /// The file that saving may replace without a question: the scene's own.
    pub(super) own_file: Option<PathBuf>,
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
    suggestion: String,
    answer: Receiver<Option<PathBuf>>,
    since: Instant,
    /// Whether the window has lost the focus meanwhile: to the dialog.
    was_left: bool,
}

struct Typing {
    purpose: Purpose,
    text: String,
    is_new: bool,
    /// A file that is there, and would be replaced: it is asked about once.
    replaces: Option<PathBuf>,
}

impl PathDialogs {
    /// The desktop's dialogs, above the window that `dialog` belongs to.
    pub(super) fn like(dialog: rfd::AsyncFileDialog) -> Self {
        let open = move |purpose, suggestion: &str| system_dialog(&dialog, purpose, suggestion);
        Self { chooser: Box::new(open), own_file: None, asking: None, typing: None }
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
            Ok(_) => {
                self.asking = Some(Asking {
                    purpose,
                    suggestion: suggestion.to_owned(),
                    answer,
                    since: Instant::now(),
                    was_left: false,
                });
            }
            Err(_) => self.type_path(purpose, suggestion),
        }
    }

    /// Opens the box for typing a path.
    pub(super) fn type_path(&mut self, purpose: Purpose, suggestion: &str) {
        let text = suggestion.to_owned();
        self.typing = Some(Typing { purpose, text, is_new: true, replaces: None });
    }

    /// Closes the box. False where it was not open.
    pub(super) fn dismiss(&mut self) -> bool {
        self.typing.take().is_some()
    }

    /// The foot of the box, where it is open.
    pub(super) fn foot(&self, ctx: &egui::Context) -> Option<f32> {
        let rect = ctx.memory(|memory| memory.area_rect(path_box_id()));
        self.typing.as_ref().and(rect).map(|rect| rect.bottom())
    }

    /// Shows the box over the picture, where it is open, and gives back the end of a question, once.
    pub(super) fn take_answer(&mut self, ctx: &egui::Context, over: Rect) -> Option<Answered> {
        if let Some(asking) = &mut self.asking {
            let lost = |event: &Event| matches!(event, Event::WindowFocused(false));
            asking.was_left |= ctx.input(|input| !input.focused || input.events.iter().any(lost));
        }
        self.answered().or_else(|| self.typed(ctx, over))
    }

    fn answered(&mut self) -> Option<Answered> {
        let asking = self.asking.as_ref()?;
        let path = match asking.answer.try_recv() {
            Ok(answer) => answer,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => None,
        };
        let Asking { purpose, suggestion, since, was_left, .. } = self.asking.take()?;
        // A dialog that opened had the focus.
        let was_there = was_left && FASTER_THAN_A_HAND <= since.elapsed();
        if path.is_none() && !was_there {
            self.type_path(purpose, &suggestion);
            return None;
        }
        Some(Answered { purpose, path })
    }

    fn typed(&mut self, ctx: &egui::Context, over: Rect) -> Option<Answered> {
        let typing = self.typing.as_mut()?;
        let answer = path_box(ctx, over, typing);
        let purpose = typing.purpose;
        match answer {
            BoxAnswer::Typing => return None,
            BoxAnswer::Chosen if typing.text.trim().is_empty() => return None,
            BoxAnswer::Cancelled => {
                self.typing = None;
                return Some(Answered { purpose, path: None });
            }
            BoxAnswer::Chosen => {}
        }
        let path = typing.path();
        let is_asked = purpose == Purpose::SaveScene
            && typing.replaces.as_ref() != Some(&path)
            && self.own_file.as_ref() != Some(&path)
            && path.exists();
        if is_asked {
            typing.replaces = Some(path);
            typing.is_new = true;
            return None;
        }
        self.typing = None;
        Some(Answered { purpose, path: Some(path) })
    }
}

impl Typing {
    /// The path as it was meant.
    fn path(&self) -> PathBuf {
        let text = self.text.trim();
        let path = match (text.strip_prefix("~/"), std::env::home_dir()) {
            (Some(rest), Some(home)) => home.join(rest),
            _ => PathBuf::from(text),
        };
        match self.purpose {
            Purpose::SaveScene => with_scene_ending(&path),
            Purpose::Open | Purpose::PictureFolder | Purpose::Mesh | Purpose::Image => path,
        }
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
            let suggestion = Path::new(suggestion);
            let name = suggestion.file_name().unwrap_or_default().to_string_lossy();
            let dialog = dialog.add_filter("Scene", &["toml"]).set_file_name(name);
            let folder = suggestion.parent().unwrap_or(Path::new(""));
            Box::pin(dialog.set_directory(folder).save_file())
        }
        Purpose::PictureFolder => Box::pin(dialog.set_directory(suggestion).pick_folder()),
        Purpose::Mesh => {
            let dialog = dialog.add_filter("Meshes", &["obj"]);
            Box::pin(dialog.set_directory(suggestion).pick_file())
        }
        Purpose::Image => {
            let dialog = dialog.add_filter("Pictures", &["png", "jpg", "jpeg"]);
            Box::pin(dialog.set_directory(suggestion).pick_file())
        }
    };
    Box::pin(async { chosen.await.map(|file| file.path().to_owned()) })
}

enum BoxAnswer {
    Typing,
    Chosen,
    Cancelled,
}

fn path_box(ctx: &egui::Context, over: Rect, typing: &mut Typing) -> BoxAnswer {
    let (title, hint, button) = match typing.purpose {
        Purpose::Open => ("Open a scene, a mesh or a snapshot", "path of a file", "Open"),
        Purpose::SaveScene => ("Save the scene as", "path of a file", "Save"),
        Purpose::PictureFolder => ("Folder for pictures", "path of a folder", "Choose"),
        Purpose::Mesh => ("Choose a mesh", "path of an OBJ file", "Choose"),
        Purpose::Image => ("Choose a picture", "path of a PNG or JPEG file", "Choose"),
    };
    let replaces = typing.replaces.clone().filter(|path| *path == typing.path());
    let button = if replaces.is_some() { "Replace" } else { button };
    over_picture(ctx, path_box_id(), over.top() + BELOW_TOP, over, |ui| {
        ui.label(RichText::new(title).strong());
        ui.add_space(4.0);
        let answer = ui.horizontal(|ui| {
            let field = egui::TextEdit::singleline(&mut typing.text)
                .hint_text(hint)
                .align(Align2::LEFT_CENTER)
                .desired_width(PATH_WIDTH.min(over.width() - 200.0));
            let response = ui.add(field).accessible_name("Path");
            if std::mem::take(&mut typing.is_new) {
                response.request_focus();
            }
            let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            let ready = !typing.text.trim().is_empty();
            let confirmed = ui.add_enabled(ready, egui::Button::new(button)).clicked();
            let cancelled =
                ui.button("Cancel").clicked() || ui.input(|input| input.key_pressed(Key::Escape));
            if cancelled {
                BoxAnswer::Cancelled
            } else if confirmed || entered {
                BoxAnswer::Chosen
            } else {
                BoxAnswer::Typing
            }
        });
        if let Some(path) = replaces {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            let told = format!("{name} is there already; Replace writes over it");
            ui.colored_label(ui.visuals().warn_fg_color, told);
        }
        answer.inner
    })
}

fn path_box_id() -> Id {
    Id::unique("path box")
}

/// A box over the upper part of the picture: it asks for something and holds nothing up.
pub(super) fn over_picture<R>(
    ctx: &egui::Context,
    id: Id,
    top: f32,
    over: Rect,
    contents: impl FnOnce(&mut egui::Ui) -> R,
) -> R {
    egui::Area::new(id)
        .order(egui::Order::Foreground)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(Pos2::new(over.center().x, top))
        .show(ctx, |ui| egui::Frame::popup(ui.style()).inner_margin(14).show(ui, contents).inner)
        .inner
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the system has no dialogs, the answer is "nothing" at once, or the window never loses
    /// the focus.
    #[test]
    fn where_no_dialog_opens_a_path_can_be_typed() {
        let now = Instant::now();
        let long_ago = now.checked_sub(2 * FASTER_THAN_A_HAND).unwrap();
        for (is_sent, since, was_left, types) in [
            (true, now, false, true),
            (true, now, true, true),
            (false, now, false, true),
            (true, long_ago, false, true),
            (true, long_ago, true, false),
        ] {
            let (sender, answer) = channel();
            if is_sent {
                sender.send(None).unwrap();
            }
            drop(sender);
            let (purpose, suggestion) = (Purpose::SaveScene, "a.toml".to_owned());
            let asking = Some(Asking { purpose, suggestion, answer, since, was_left });
            let mut dialogs = PathDialogs { asking, ..PathDialogs::default() };
            let told = format!("sent {is_sent}, since {since:?}, left {was_left}");
            let expected = (!types).then_some(Answered { purpose, path: None });
            assert_eq!(dialogs.answered(), expected, "{told}");
            assert!(dialogs.asking.is_none(), "the dialog stays open: {told}");
            let typed = dialogs.typing.map(|typing| typing.text);
            assert_eq!(typed, types.then(|| "a.toml".to_owned()), "{told}");
        }
    }
}

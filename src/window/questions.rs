//! What would lose something is asked about first: unsaved edits, a picture at work.

use super::app::App;
use super::dialogs::{Answered, Purpose};
use super::files::Pending;
use super::relocate::relative;
use super::structure::{Part, set_file};
use super::theme::{self, modal_frame};
use crate::loader::Source;
use egui::{Button, Id, RichText, Ui, ViewportCommand};
use std::path::Path;

impl App {
    /// Opens a source, after a question where edits would be lost.
    pub(super) fn open(&mut self, source: Source) {
        if self.document.is_dirty() {
            self.files.pending = Some(Pending::Open(source));
        } else {
            self.files.open(source);
        }
    }

    pub(super) fn ask_to_close_scene(&mut self, ctx: &egui::Context) {
        self.files.pending = Some(Pending::CloseScene);
        if !self.document.is_dirty() {
            self.go_on(ctx);
        }
    }

    /// Keeps the window open while there are edits to ask about.
    pub(super) fn guard_close(&mut self, ctx: &egui::Context) {
        let asked = ctx.input(|input| input.viewport().close_requested());
        let is_at_work = self.document.is_dirty() || self.exporter.progress().is_some();
        if asked && is_at_work && !self.files.close_confirmed {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.files.pending = Some(Pending::Close);
        }
    }

    /// Asks about unsaved edits where something waits for the answer.
    pub(super) fn ask_about_unsaved(&mut self, ctx: &egui::Context) {
        if self.files.pending.is_none() || self.files.is_saving_first {
            return;
        }
        if !self.document.is_dirty() {
            self.ask_about_picture(ctx);
            return;
        }
        match unsaved_question(ctx, &self.files.title) {
            None => {}
            Some(UnsavedAnswer::Save) => {
                self.files.is_saving_first = true;
                self.save_scene(ctx);
            }
            Some(UnsavedAnswer::Discard) => self.go_on(ctx),
            Some(UnsavedAnswer::Cancel) => self.files.pending = None,
        }
    }

    /// Asks what to do with a picture that closing the window would stop.
    fn ask_about_picture(&mut self, ctx: &egui::Context) {
        let is_closing = self.files.pending == Some(Pending::Close);
        if !is_closing || self.exporter.progress().is_none() {
            return self.go_on(ctx);
        }
        match picture_question(ctx) {
            None => {}
            Some(true) => self.go_on(ctx),
            Some(false) => self.files.pending = None,
        }
    }

    /// Does what waited for an answer.
    pub(super) fn go_on(&mut self, ctx: &egui::Context) {
        self.files.is_saving_first = false;
        match self.files.pending.take() {
            None => {}
            Some(Pending::Open(source)) => self.files.open(source),
            Some(Pending::CloseScene) => self.close_scene(ctx),
            Some(Pending::Close) => {
                self.files.close_confirmed = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }

    /// Leaves the question about unsaved edits unanswered: everything stays.
    pub(super) fn stop_asking(&mut self) -> bool {
        !self.files.is_saving_first && self.files.pending.take().is_some()
    }

    /// Takes what a question for a path ended with.
    pub(super) fn take_path(&mut self, ctx: &egui::Context, answered: Answered) {
        match (answered.purpose, answered.path) {
            (Purpose::Open, Some(path)) => self.open(Source::File(path)),
            (Purpose::SaveScene, Some(path)) => self.save_to(ctx, path),
            (Purpose::SaveScene, None) => self.give_up_saving(),
            (Purpose::PictureFolder, Some(path)) => self.interface.export.folder = Some(path),
            (Purpose::Mesh | Purpose::Image, Some(path)) => self.take_part_file(&path),
            (Purpose::Open | Purpose::PictureFolder | Purpose::Mesh | Purpose::Image, None) => {}
        }
    }

    /// Asks for the file that a part wants.
    pub(super) fn ask_for_part_file(&mut self, ctx: &egui::Context) {
        let Some((part, name)) = self.interface.selection.wants_file.take() else { return };
        let purpose = if part == Part::Texture { Purpose::Image } else { Purpose::Mesh };
        self.file_wanted = Some((part, name));
        let folder = self.files.folder.disk_path("").unwrap_or_default();
        self.dialogs.ask(ctx, purpose, &folder.display().to_string());
    }

    fn take_part_file(&mut self, path: &Path) {
        let Some((part, name)) = self.file_wanted.take() else { return };
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let folder = self.files.folder.disk_path("");
        let file = folder.map_or_else(
            || whole.to_string_lossy().into_owned(),
            |folder| relative(&whole, &folder),
        );
        let mut scene = self.document.description.clone();
        set_file(&mut scene, part, &name, file);
        self.gesture.next();
        self.take_edit(scene);
    }

    /// Nothing is saved after all: what waited for that does not happen.
    pub(super) fn give_up_saving(&mut self) {
        if std::mem::take(&mut self.files.is_saving_first) {
            self.files.pending = None;
        }
    }
}

/// What to do with edits that no file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum UnsavedAnswer {
    /// Save them first.
    Save,
    /// Let them go.
    Discard,
    /// Stay.
    Cancel,
}

/// Asks what to do with unsaved edits of the scene of that name.
fn unsaved_question(ctx: &egui::Context, title: &str) -> Option<UnsavedAnswer> {
    let asked = format!("Save the changes to {title}?");
    let told = "They are lost if you do not save them.";
    let answers = [
        ("Save", UnsavedAnswer::Save),
        ("Do not save", UnsavedAnswer::Discard),
        ("Cancel", UnsavedAnswer::Cancel),
    ];
    question(ctx, &asked, told, &answers, UnsavedAnswer::Cancel)
}

/// Asks whether to close the window while a picture is being rendered: true closes it.
fn picture_question(ctx: &egui::Context) -> Option<bool> {
    let told = "It is lost if you close the window now.";
    let answers = [("Go on rendering", false), ("Stop it and close", true)];
    question(ctx, "A picture is still being rendered", told, &answers, false)
}

/// A question with its answers, the likeliest first: Enter gives that one, Escape gives `none`.
fn question<T: Copy>(
    ctx: &egui::Context,
    asked: &str,
    told: &str,
    answers: &[(&str, T)],
    none: T,
) -> Option<T> {
    let frame = modal_frame(&ctx.global_style());
    let modal = egui::Modal::new(Id::unique("question")).frame(frame).show(ctx, |ui| {
        ui.set_width(360.0);
        ui.heading(asked);
        ui.add_space(4.0);
        ui.label(RichText::new(told).weak());
        ui.add_space(12.0);
        ui.horizontal(|ui| answers_ui(ui, answers)).inner
    });
    modal.inner.or(modal.should_close().then_some(none))
}

fn answers_ui<T: Copy>(ui: &mut Ui, answers: &[(&str, T)]) -> Option<T> {
    let mut given = None;
    for (index, (name, answer)) in answers.iter().enumerate() {
        let button = if index == 0 { theme::main_button(ui, name) } else { Button::new(*name) };
        let response = ui.add(button);
        if index == 0 && ui.memory(|memory| memory.focused().is_none()) {
            response.request_focus();
        }
        if response.clicked() {
            given = Some(*answer);
        }
    }
    given
}

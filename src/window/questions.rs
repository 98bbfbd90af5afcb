//! What would lose something is asked about first: unsaved edits, a picture at work.

use super::app::App;
use super::dialogs::{UnsavedAnswer, picture_question, unsaved_question};
use super::files::Pending;
use crate::loader::Source;
use egui::ViewportCommand;

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
}

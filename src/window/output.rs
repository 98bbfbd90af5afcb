//! What leaves the window: scene files, snapshots, the clipboard. Writing happens elsewhere.

use super::app::App;
use std::path::PathBuf;

impl App {
    pub(super) fn save_to(&mut self, _ctx: &egui::Context, _path: PathBuf) {}
    pub(super) fn snapshot(&mut self, _ctx: &egui::Context) {}
    pub(super) fn copy_picture(&mut self, _ctx: &egui::Context) {}
}

//! The parts panels are made of: a named line, a figure with its slider, a colour, a choice.
//!
//! Every control writes to the description only on a real edit, so that showing a value never
//! changes it, and keeps the full precision of what is typed.

mod choice;
mod figure;
mod number_box;

pub(super) use choice::{choice, pick_one};
pub(super) use figure::{Figure, triple};
pub(super) use number_box::number_box;

use super::parameter::parameter;
use super::theme::{LABEL_WIDTH, ROW_HEIGHT};
use egui::{Ui, Vec2};

/// Written behind lengths: scene units.
pub(super) const LENGTH: &str = " u";

/// One line of a panel: the name on the left, `contents` in the rest. Gives back their result.
pub(super) fn row<R>(
    ui: &mut Ui,
    label: &str,
    help: &str,
    contents: impl FnOnce(&mut Ui) -> R,
) -> R {
    ui.horizontal(|ui| {
        ui.set_min_height(ROW_HEIGHT);
        name_cell(ui, label, help);
        contents(ui)
    })
    .inner
}

/// A switch with its name beside it, in the column of values.
pub(super) fn switch(ui: &mut Ui, label: &str, path: &str, help: &str, value: &mut bool) {
    row(ui, "", "", |ui| check(ui, label, path, help, value));
}

/// A switch with its name beside it.
pub(super) fn check(ui: &mut Ui, label: &str, path: &str, help: &str, value: &mut bool) {
    let response = ui.checkbox(value, label);
    let response = if help.is_empty() { response } else { response.on_hover_text(help) };
    parameter(&response, label, path);
}

/// The name of a line, cut with an ellipsis where it is too long.
fn name_cell(ui: &mut Ui, label: &str, help: &str) {
    let size = Vec2::new(LABEL_WIDTH, ROW_HEIGHT);
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    if label.is_empty() {
        return;
    }
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    // A child of its own: the line goes on behind the whole column, however short the name.
    let mut cell = ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(layout));
    let text = egui::RichText::new(label).weak();
    let response = cell.add(egui::Label::new(text).truncate());
    if !help.is_empty() {
        response.on_hover_text(help);
    }
}

//! Fields for a line of text that counts once it is entered, not at every letter.

use super::parameter::parameter;
use super::theme::ROW_HEIGHT;
use super::widgets::row;
use egui::{Key, Ui};

/// Width of the button that asks for a file, in points.
const CHOOSE_WIDTH: f32 = 64.0;

/// What came of a line with the path of a file.
pub(super) enum FileLine {
    /// Nothing.
    Left,
    /// A path was entered.
    Entered(String),
    /// One is to be chosen in a dialog.
    Choose,
}

/// A named line with the path of a file and a button that asks for another.
pub(super) fn file_line(
    ui: &mut Ui,
    label: &str,
    help: &str,
    hint: &str,
    path: &str,
    value: &str,
) -> FileLine {
    row(ui, label, help, |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let room = ui.available_width() - CHOOSE_WIDTH - 3.0;
        if let Some(entered) = field(ui, room, label, help, hint, path, value) {
            return FileLine::Entered(entered);
        }
        let choose = egui::Button::new("Choose…").min_size(egui::vec2(CHOOSE_WIDTH, ROW_HEIGHT));
        let choose = ui.add(choose).on_hover_text("opens the system's dialog");
        let choose = choose.accessible_name(format!("{label}: choose"));
        if choose.clicked() { FileLine::Choose } else { FileLine::Left }
    })
}

/// A named line with a text field. Gives back what was entered, where it differs from `value` and
/// is not empty. Escape leaves the value as it is.
pub(super) fn entered_text(
    ui: &mut Ui,
    label: &str,
    help: &str,
    hint: &str,
    path: &str,
    value: &str,
) -> Option<String> {
    row(ui, label, help, |ui| {
        let room = ui.available_width();
        field(ui, room, label, help, hint, path, value)
    })
}

/// The text field by itself.
pub(super) fn field(
    ui: &mut Ui,
    width: f32,
    label: &str,
    help: &str,
    hint: &str,
    path: &str,
    value: &str,
) -> Option<String> {
    let id = ui.scope_id().with(label);
    let mut text = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| value.to_owned());
    let field = egui::TextEdit::singleline(&mut text)
        .id(id)
        .hint_text(hint)
        .align(egui::Align2::LEFT_CENTER)
        .desired_width(width);
    let response = ui.add(field).accessible_name(label);
    let response = if help.is_empty() { response } else { response.on_hover_text(help) };
    parameter(&response, label, path);
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
        return None;
    }
    ui.data_mut(|data| data.remove::<String>(id));
    let given_up = ui.input(|input| input.key_pressed(Key::Escape));
    let entered = text.trim();
    let counts = response.lost_focus() && !given_up && !entered.is_empty() && entered != value;
    counts.then(|| entered.to_owned())
}

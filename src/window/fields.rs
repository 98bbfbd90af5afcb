//! A field for a line of text that counts once it is entered, not at every letter.

use super::parameter::parameter;
use super::widgets::row;
use egui::{Key, Ui};

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
        let id = ui.scope_id().with(label);
        let mut text =
            ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| value.to_owned());
        let field = egui::TextEdit::singleline(&mut text)
            .id(id)
            .hint_text(hint)
            .align(egui::Align2::LEFT_CENTER)
            .desired_width(ui.available_width());
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
    })
}

//! The help overlay: every key and motion, from the table that binds them.

use super::keys::{Keys, MOTIONS, keys_of};
use super::theme::modal_frame;
use egui::{Id, RichText, Ui};
use std::path::Path;

/// What was chosen in the overlay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HelpChoice {
    /// Close it.
    Close,
    /// Write a file of keys to edit.
    MakeKeysFile,
}

/// Shows the overlay. `keys_file` is where keys of one's own are read from, if there is such a
/// place.
pub(super) fn help_ui(
    ctx: &egui::Context,
    keys: &Keys,
    keys_file: Option<&Path>,
) -> Option<HelpChoice> {
    let frame = modal_frame(&ctx.global_style());
    let modal = egui::Modal::new(Id::unique("help")).frame(frame).show(ctx, |ui| {
        let room = ctx.content_rect().height() - 180.0;
        ui.heading("Keys and mouse");
        ui.add_space(8.0);
        egui::ScrollArea::vertical().max_height(room.max(120.0)).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                let lines = lines(keys);
                for (column, part) in lines.chunks(lines.len().div_ceil(2)).enumerate() {
                    ui.vertical(|ui| column_ui(ui, column, part));
                    ui.add_space(24.0);
                }
            });
        });
        ui.add_space(8.0);
        ui.label(
            RichText::new("Drag a figure to change it, click to type. Right click: reset it, or copy its path.")
                .weak(),
        );
        let mut chosen = None;
        if let Some(path) = keys_file {
            let told = format!("Keys of your own: {}", path.display());
            ui.add(egui::Label::new(RichText::new(told).weak()).truncate());
        }
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            if ui.button("Close").clicked() {
                chosen = Some(HelpChoice::Close);
            }
            let make = keys_file.filter(|path| !path.exists());
            if make.is_some()
                && ui
                    .button("Make that file")
                    .on_hover_text("writes it with every action and its key, to be edited")
                    .clicked()
            {
                chosen = Some(HelpChoice::MakeKeysFile);
            }
        });
        chosen
    });
    modal.inner.or(modal.should_close().then_some(HelpChoice::Close))
}

fn column_ui(ui: &mut Ui, column: usize, lines: &[(String, &'static str)]) {
    egui::Grid::new(("keys", column)).num_columns(2).spacing([18.0, 5.0]).show(ui, |ui| {
        for (keys, does) in lines {
            ui.label(RichText::new(keys).strong());
            ui.label(RichText::new(*does).weak());
            ui.end_row();
        }
    });
}

/// Motions first, then keys; several keys of one action in one line.
fn lines(keys: &Keys) -> Vec<(String, &'static str)> {
    let mut lines: Vec<(String, &'static str)> =
        MOTIONS.iter().map(|(input, does)| ((*input).to_owned(), *does)).collect();
    let n_motions = lines.len();
    for binding in &keys.bindings {
        let keys = keys_of(binding);
        match lines[n_motions..].iter_mut().find(|(_, does)| *does == binding.does) {
            Some((shown, _)) => *shown = format!("{shown}, {keys}"),
            None => lines.push((keys, binding.does)),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_names_every_binding() {
        let keys = Keys::default();
        let lines = lines(&keys);
        for binding in &keys.bindings {
            let keys = keys_of(binding);
            let named = lines.iter().any(|(shown, _)| shown.split(", ").any(|one| one == keys));
            assert!(named, "{keys} is not in the help");
        }
    }
}

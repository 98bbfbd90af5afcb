//! The help overlay: every key and motion, from the table that binds them.

use super::keys::{BINDINGS, MOTIONS, keys_of};
use egui::{Id, RichText, Ui};

/// Shows the overlay; `open` turns false where it is closed.
pub(super) fn help_ui(ctx: &egui::Context, open: &mut bool) {
    let modal = egui::Modal::new(Id::unique("help")).show(ctx, |ui| {
        ui.heading("Keys and mouse");
        ui.add_space(8.0);
        ui.horizontal_top(|ui| {
            let half = lines().len().div_ceil(2);
            for (column, part) in lines().chunks(half).enumerate() {
                ui.vertical(|ui| column_ui(ui, column, part));
                ui.add_space(24.0);
            }
        });
        ui.add_space(8.0);
        ui.label(RichText::new("Right click a figure: reset it, or copy its path. Drag a figure to change it, click to type.").weak());
        ui.add_space(4.0);
        ui.button("Close").clicked()
    });
    if modal.inner || modal.should_close() {
        *open = false;
    }
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
fn lines() -> Vec<(String, &'static str)> {
    let mut lines: Vec<(String, &'static str)> =
        MOTIONS.iter().map(|(input, does)| ((*input).to_owned(), *does)).collect();
    let n_motions = lines.len();
    for binding in BINDINGS {
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
        let lines = lines();
        for binding in BINDINGS {
            let keys = keys_of(binding);
            let named = lines.iter().any(|(shown, _)| shown.split(", ").any(|one| one == keys));
            assert!(named, "{keys} is not in the help");
        }
    }
}

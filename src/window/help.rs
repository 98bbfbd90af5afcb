//! The help overlay: every key and motion, from the table that binds them.

use super::keys::{Group, Keys, MOTIONS, keys_of};
use super::theme::{self, modal_frame};
use egui::{Id, RichText, Ui};
use std::path::Path;

/// Width of the column of keys, in points: the groups below one another are in line.
const KEYS_WIDTH: f32 = 168.0;

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
                for column in COLUMNS {
                    ui.vertical(|ui| column.iter().for_each(|group| group_ui(ui, keys, *group)));
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

/// The groups of each column; `None` are the motions of the mouse.
const COLUMNS: [&[Option<Group>]; 2] = [
    &[None, Some(Group::Camera), Some(Group::Scene)],
    &[Some(Group::Picture), Some(Group::Window)],
];

fn group_ui(ui: &mut Ui, keys: &Keys, group: Option<Group>) {
    let title = group.map_or("Mouse", Group::title);
    ui.label(RichText::new(title).small().color(theme::accent(ui.visuals())));
    let grid = egui::Grid::new(("keys", title)).num_columns(2).min_row_height(18.0);
    grid.min_col_width(KEYS_WIDTH).spacing([18.0, 2.0]).show(ui, |ui| {
        for (keys, does) in lines(keys, group) {
            ui.label(RichText::new(keys).strong());
            ui.label(RichText::new(does).weak());
            ui.end_row();
        }
    });
    ui.add_space(8.0);
}

/// The lines of a group; several keys of one action in one line.
fn lines(keys: &Keys, group: Option<Group>) -> Vec<(String, &'static str)> {
    let Some(group) = group else {
        return MOTIONS.iter().map(|(input, does)| ((*input).to_owned(), *does)).collect();
    };
    let mut lines: Vec<(String, &'static str)> = Vec::new();
    for binding in keys.bindings.iter().filter(|binding| binding.action.group() == group) {
        let keys = keys_of(binding);
        match lines.iter_mut().find(|(_, does)| *does == binding.does) {
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
        let groups = COLUMNS.iter().flat_map(|column| column.iter());
        let lines: Vec<_> = groups.flat_map(|group| lines(&keys, *group)).collect();
        for binding in &keys.bindings {
            let keys = keys_of(binding);
            let named = lines.iter().any(|(shown, _)| shown.split(", ").any(|one| one == keys));
            assert!(named, "{keys} is not in the help");
        }
    }
}

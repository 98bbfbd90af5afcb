//! The bar at the top: file, undo, view, and the few things that are always at hand.

use super::keys::{Action, hint};
use super::panels::DisplayState;
use super::viewport::Zoom;
use crate::scene::description::ToneMappingDescription;
use egui::{Button, RichText, Ui};

/// What the bar shows.
pub(super) struct ToolbarFacts<'a> {
    /// Name of the open scene.
    pub(super) title: &'a str,
    /// Whether it has edits that no file holds.
    pub(super) has_unsaved: bool,
    /// What undo would take back, if anything.
    pub(super) undo: Option<&'a str>,
    /// What redo would make again, if anything.
    pub(super) redo: Option<&'a str>,
    /// Whether refining is held.
    pub(super) is_paused: bool,
    /// Whether the panel is shown.
    pub(super) panel_shown: bool,
    /// Titles of the gallery scenes, in order.
    pub(super) gallery: &'a [&'a str],
    /// Files opened before, newest first.
    pub(super) recent: &'a [std::path::PathBuf],
}

/// What was chosen in the bar.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ToolbarChoice {
    /// The same as pressing its key.
    Do(Action),
    /// Open the gallery scene of that index.
    Gallery(usize),
    /// Open that file.
    File(std::path::PathBuf),
    /// Show the box for a path.
    PathBox,
}

/// Shows the bar; gives back what was chosen.
pub(super) fn toolbar_ui(
    ui: &mut Ui,
    facts: &ToolbarFacts<'_>,
    tone: &mut ToneMappingDescription,
    display: &mut DisplayState,
) -> Option<ToolbarChoice> {
    let mut chosen = None;
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        menus(ui, facts, &mut chosen);
        ui.add_space(8.0);
        let told = |verb: &str, step: Option<&str>| match step {
            Some(step) => format!("{verb}: {step}"),
            None => format!("nothing to {verb}"),
        };
        let (undo, redo) = (told("undo", facts.undo), told("redo", facts.redo));
        button(ui, "Undo", &undo, Action::Undo, facts.undo.is_some(), &mut chosen);
        button(ui, "Redo", &redo, Action::Redo, facts.redo.is_some(), &mut chosen);
        ui.add_space(8.0);
        let pause = if facts.is_paused { "Resume" } else { "Pause" };
        button(ui, pause, "holds the picture, or goes on", Action::Pause, true, &mut chosen);
        button(ui, "Frame", "the whole scene in the picture", Action::FrameAll, true, &mut chosen);
        let help = "writes the picture to a file, with its scene inside";
        button(ui, "Snapshot", help, Action::Snapshot, true, &mut chosen);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let panel = Button::selectable(facts.panel_shown, "Panel");
            if ui
                .add(panel)
                .on_hover_text(hint("the panel with all settings", Action::TogglePanel))
                .clicked()
            {
                chosen = Some(ToolbarChoice::Do(Action::TogglePanel));
            }
            button(ui, "Help", "all keys", Action::Help, true, &mut chosen);
            zoom_ui(ui, display);
            exposure_ui(ui, tone);
            let dot = if facts.has_unsaved { " •" } else { "" };
            let title = RichText::new(format!("{}{dot}", facts.title)).weak();
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.add_space(10.0);
                let told = if facts.has_unsaved { "has edits that are not saved" } else { "saved" };
                ui.add(egui::Label::new(title).truncate()).on_hover_text(told);
            });
        });
    });
    chosen
}

fn menus(ui: &mut Ui, facts: &ToolbarFacts<'_>, chosen: &mut Option<ToolbarChoice>) {
    ui.menu_button("File", |ui| {
        item(ui, "Open…", Action::Open, chosen);
        if ui.button("Open path…").on_hover_text("type where a file is").clicked() {
            *chosen = Some(ToolbarChoice::PathBox);
        }
        ui.menu_button("Gallery", |ui| {
            for (index, title) in facts.gallery.iter().enumerate() {
                if ui.button(*title).clicked() {
                    *chosen = Some(ToolbarChoice::Gallery(index));
                }
            }
        });
        ui.add_enabled_ui(!facts.recent.is_empty(), |ui| {
            ui.menu_button("Recent", |ui| {
                for path in facts.recent {
                    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                    if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                        *chosen = Some(ToolbarChoice::File(path.clone()));
                    }
                }
            });
        });
        ui.separator();
        item(ui, "Save", Action::Save, chosen);
        item(ui, "Save as…", Action::SaveAs, chosen);
        ui.separator();
        item(ui, "Snapshot", Action::Snapshot, chosen);
        item(ui, "Copy picture", Action::CopyImage, chosen);
    });
    ui.menu_button("View", |ui| {
        item(ui, "Frame all", Action::FrameAll, chosen);
        item(ui, "Scene's camera", Action::HomeCamera, chosen);
        ui.separator();
        item(ui, "Front", Action::ViewFront, chosen);
        item(ui, "Side", Action::ViewSide, chosen);
        item(ui, "Top", Action::ViewTop, chosen);
        ui.separator();
        item(ui, "Lens open or closed", Action::ToggleLens, chosen);
        item(ui, "Pin and compare", Action::Compare, chosen);
        item(ui, "Restart", Action::Restart, chosen);
        ui.separator();
        item(ui, "Full screen", Action::FullScreen, chosen);
        ui.menu_button("Theme", |ui| {
            let mut preference = ui.options(|options| options.theme_preference);
            let before = preference;
            for (theme, name) in [
                (egui::ThemePreference::System, "As the system"),
                (egui::ThemePreference::Dark, "Dark"),
                (egui::ThemePreference::Light, "Light"),
            ] {
                ui.selectable_value(&mut preference, theme, name);
            }
            if preference != before {
                ui.set_theme(preference);
            }
        });
    });
}

/// A line of a menu with its key on the right.
fn item(ui: &mut Ui, text: &str, action: Action, chosen: &mut Option<ToolbarChoice>) {
    let keys = super::keys::shown(action);
    if ui.add(Button::new(text).shortcut_text(keys)).clicked() {
        *chosen = Some(ToolbarChoice::Do(action));
    }
}

fn button(
    ui: &mut Ui,
    text: &str,
    help: &str,
    action: Action,
    enabled: bool,
    chosen: &mut Option<ToolbarChoice>,
) {
    let response = ui.add_enabled(enabled, Button::new(text).frame_when_inactive(false));
    if response.on_hover_text(hint(help, action)).clicked() {
        *chosen = Some(ToolbarChoice::Do(action));
    }
}

fn zoom_ui(ui: &mut Ui, display: &mut DisplayState) {
    let names = [(Zoom::Fit, "Fit"), (Zoom::Actual, "100 %"), (Zoom::Double, "200 %")];
    let shown = names.iter().find(|(zoom, _)| *zoom == display.zoom).map_or("", |(_, name)| name);
    egui::ComboBox::from_id_salt("toolbar zoom")
        .width(70.0)
        .selected_text(shown)
        .show_ui(ui, |ui| {
            for (zoom, name) in names {
                ui.selectable_value(&mut display.zoom, zoom, name);
            }
        })
        .response
        .accessible_name("View zoom")
        .on_hover_text("how large the picture is shown");
}

fn exposure_ui(ui: &mut Ui, tone: &mut ToneMappingDescription) {
    let mut exposure = tone.exposure;
    let response = super::widgets::number_box(ui, &mut exposure, 64.0, 0.02, " EV", false)
        .accessible_name("View exposure")
        .on_hover_text("exposure in stops (E brighter, Shift+E darker)");
    if response.changed() && exposure.is_finite() {
        tone.exposure = exposure.clamp(-64.0, 64.0);
    }
}

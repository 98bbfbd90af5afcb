//! The bar at the top: file, undo, view, and the few things that are always at hand.

use super::export::ExportProgress;
use super::icons::Icon;
use super::keys::{Action, Keys};
use super::panels::DisplayState;
use super::viewport::Zoom;
use super::views::View;
use crate::scene::description::ToneMappingDescription;
use egui::{Button, RichText, Ui};

/// Controls have their names beside them in a window at least this wide, in points.
const NAMED_FROM: f32 = 1200.0;
/// Below this width exposure and zoom are left to the panel.
const WHOLE_FROM: f32 = 920.0;
/// Below this width buttons are icons; their tooltips say the rest.
const TEXTS_FROM: f32 = 760.0;
/// Less room than this is not worth a title, in points.
const LEAST_TITLE: f32 = 24.0;

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
    /// Whether the start page is shown.
    pub(super) start_shown: bool,
    /// The keys, for menus and tooltips.
    pub(super) keys: &'a Keys,
    /// How far a picture is that is rendered to a file.
    pub(super) picture: Option<ExportProgress>,
    /// What is shown of each pixel.
    pub(super) view: View,
    /// Files opened before, newest first.
    pub(super) recent: &'a [std::path::PathBuf],
}

/// What was chosen in the bar.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ToolbarChoice {
    /// The same as pressing its key.
    Do(Action),
    /// Open that file.
    File(std::path::PathBuf),
    /// Show the box for a path.
    PathBox,
    /// Close the window.
    Quit,
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
        if !facts.start_shown {
            work_ui(ui, facts, &mut chosen);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            if !facts.start_shown {
                let panel = match TEXTS_FROM <= width(ui) {
                    true => Button::selectable(facts.panel_shown, (Icon::Panel.atom(), "Panel")),
                    false => Button::selectable(facts.panel_shown, Icon::Panel.atom()),
                };
                let help = facts.keys.hint("the panel with all settings", Action::TogglePanel);
                if ui.add(panel).accessible_name("Panel").on_hover_text(help).clicked() {
                    chosen = Some(ToolbarChoice::Do(Action::TogglePanel));
                }
            }
            button(
                ui,
                facts.keys,
                Icon::Help,
                ("Help", "all keys"),
                Action::Help,
                true,
                &mut chosen,
            );
            if !facts.start_shown {
                if WHOLE_FROM <= width(ui) {
                    zoom_ui(ui, display);
                    name_ui(ui, "Zoom");
                    exposure_ui(ui, tone);
                    name_ui(ui, "Exposure");
                }
                title_ui(ui, facts);
            }
        });
    });
    chosen
}

/// What is done with the scene and its picture.
fn work_ui(ui: &mut Ui, facts: &ToolbarFacts<'_>, chosen: &mut Option<ToolbarChoice>) {
    let told = |verb: &str, step: Option<&str>| match step {
        Some(step) => format!("{verb}: {step}"),
        None => format!("nothing to {verb}"),
    };
    let (undo, redo) = (told("undo", facts.undo), told("redo", facts.redo));
    let keys = facts.keys;
    let (can_undo, can_redo) = (facts.undo.is_some(), facts.redo.is_some());
    button(ui, keys, Icon::Undo, ("Undo", &undo), Action::Undo, can_undo, chosen);
    button(ui, keys, Icon::Redo, ("Redo", &redo), Action::Redo, can_redo, chosen);
    ui.add_space(8.0);
    let (icon, pause) =
        if facts.is_paused { (Icon::Resume, "Resume") } else { (Icon::Pause, "Pause") };
    button(ui, keys, icon, (pause, "holds the picture, or goes on"), Action::Pause, true, chosen);
    let help = "the whole scene in the picture";
    button(ui, keys, Icon::Frame, ("Frame", help), Action::FrameAll, true, chosen);
    let help = "writes the picture as it is to a file, with its scene inside";
    button(ui, keys, Icon::Snapshot, ("Snapshot", help), Action::Snapshot, true, chosen);
    let (text, help) = match &facts.picture {
        None => ("Render…".to_owned(), "renders a picture of any size to a file"),
        Some(picture) => {
            let percent = (picture.share() * 100.0).floor();
            (format!("Render {percent} %"), "a picture is being rendered")
        }
    };
    button(ui, keys, Icon::Picture, (&text, help), Action::RenderPicture, true, chosen);
}

fn title_ui(ui: &mut Ui, facts: &ToolbarFacts<'_>) {
    let dot = if facts.has_unsaved { " •" } else { "" };
    let title = RichText::new(format!("{}{dot}", facts.title)).weak();
    ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
        if ui.available_width() < LEAST_TITLE {
            return;
        }
        ui.add_space(10.0);
        let told = if facts.has_unsaved { "has edits that are not saved" } else { "saved" };
        ui.add(egui::Label::new(title).truncate()).on_hover_text(told);
    });
}

fn menus(ui: &mut Ui, facts: &ToolbarFacts<'_>, chosen: &mut Option<ToolbarChoice>) {
    let keys = facts.keys;
    ui.menu_button("File", |ui| {
        item(ui, keys, "Open…", Action::Open, chosen);
        if ui.button("Open path…").on_hover_text("type where a file is").clicked() {
            *chosen = Some(ToolbarChoice::PathBox);
        }
        item(ui, keys, "Gallery", Action::Gallery, chosen);
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
        item(ui, keys, "Save", Action::Save, chosen);
        item(ui, keys, "Save as…", Action::SaveAs, chosen);
        item(ui, keys, "Close scene", Action::CloseScene, chosen);
        ui.separator();
        item(ui, keys, "Snapshot", Action::Snapshot, chosen);
        item(ui, keys, "Render picture…", Action::RenderPicture, chosen);
        item(ui, keys, "Copy picture", Action::CopyImage, chosen);
        ui.separator();
        let quit = if cfg!(target_os = "macos") { "Cmd+Q" } else { "Ctrl+Q" };
        if ui.add(Button::new("Quit").shortcut_text(quit)).clicked() {
            *chosen = Some(ToolbarChoice::Quit);
        }
    });
    ui.menu_button("View", |ui| {
        item(ui, keys, "Frame all", Action::FrameAll, chosen);
        item(ui, keys, "Scene's camera", Action::HomeCamera, chosen);
        ui.separator();
        item(ui, keys, "Front", Action::ViewFront, chosen);
        item(ui, keys, "Side", Action::ViewSide, chosen);
        item(ui, keys, "Top", Action::ViewTop, chosen);
        ui.separator();
        for view in View::ALL {
            let action = Action::Show(view);
            let button = Button::selectable(facts.view == view, view.name());
            if ui.add(button.shortcut_text(keys.shown(action))).clicked() {
                *chosen = Some(ToolbarChoice::Do(action));
            }
        }
        ui.separator();
        item(ui, keys, "Lens open or closed", Action::ToggleLens, chosen);
        item(ui, keys, "Pin and compare", Action::Compare, chosen);
        item(ui, keys, "Loupe", Action::Loupe, chosen);
        item(ui, keys, "Restart", Action::Restart, chosen);
        ui.separator();
        item(ui, keys, "Full screen", Action::FullScreen, chosen);
        ui.menu_button("Text", |ui| {
            item(ui, keys, "Larger", Action::LargerText, chosen);
            item(ui, keys, "Smaller", Action::SmallerText, chosen);
            item(ui, keys, "As the system", Action::UsualText, chosen);
        });
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
fn item(ui: &mut Ui, keys: &Keys, text: &str, action: Action, chosen: &mut Option<ToolbarChoice>) {
    if ui.add(Button::new(text).shortcut_text(keys.shown(action))).clicked() {
        *chosen = Some(ToolbarChoice::Do(action));
    }
}

fn button(
    ui: &mut Ui,
    keys: &Keys,
    icon: Icon,
    (text, help): (&str, &str),
    action: Action,
    enabled: bool,
    chosen: &mut Option<ToolbarChoice>,
) {
    let button = match TEXTS_FROM <= width(ui) {
        true => Button::new((icon.atom(), text)),
        false => Button::new(icon.atom()),
    };
    let button = button.frame_when_inactive(false).gap(5.0);
    let response = ui.add_enabled(enabled, button).accessible_name(text);
    if response.on_hover_text(keys.hint(help, action)).clicked() {
        *chosen = Some(ToolbarChoice::Do(action));
    }
}

/// Width of the window, in points.
fn width(ui: &Ui) -> f32 {
    ui.ctx().content_rect().width()
}

/// The name of the control on its right, where there is room for it.
fn name_ui(ui: &mut Ui, name: &str) {
    if NAMED_FROM <= width(ui) {
        ui.add_space(4.0);
        ui.weak(name);
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

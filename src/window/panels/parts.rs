//! The line at the top of a group: which part is shown, and what can be done with the list.

use super::path_segment;
use crate::scene::description::{SceneDescription, Triple};
use crate::window::parameter::parameter;
use crate::window::structure::{self, Part};
use crate::window::widgets::{pick_one, row};
use egui::Ui;

/// A name being typed for a part.
#[derive(Clone, Debug)]
pub(in crate::window) struct Renaming {
    part: Part,
    index: usize,
    text: String,
    /// The field has not been shown yet, and takes the focus when it is.
    is_new: bool,
}

/// Where new parts go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// A point in the middle of what is seen.
    pub(super) place: Triple,
    /// Distance from the eye to it.
    pub(super) reach: f64,
}

impl Placement {
    /// In the middle of the picture.
    pub(super) fn of(scene: &SceneDescription) -> Self {
        let camera = &scene.camera;
        let away = (0..3).map(|axis| (camera.target[axis] - camera.eye[axis]).powi(2)).sum::<f64>();
        Self { place: camera.target, reach: away.sqrt() }
    }
}

/// The list of the parts of one kind with add, duplicate, rename and delete. Gives back the index
/// of the part to show below, or `None` where there is none.
pub(super) fn part_list(
    ui: &mut Ui,
    scene: &mut SceneDescription,
    part: Part,
    selected: &mut usize,
    renaming: &mut Option<Renaming>,
) -> Option<usize> {
    let (label, one, list) = match part {
        Part::Light => ("Light", "light", "lights"),
        Part::Material => ("Material", "material", "materials"),
        Part::Texture => ("Texture", "texture", "textures"),
        Part::Object => ("Object", "object", "objects"),
    };
    let n_parts = structure::names(scene, part).len();
    *selected = (*selected).min(n_parts.saturating_sub(1));
    let renamed_here = renaming
        .as_ref()
        .is_some_and(|renaming| renaming.part == part && renaming.index == *selected);
    if renamed_here {
        name_field(ui, scene, label, renaming);
    } else if n_parts == 0 {
        row(ui, label, "", |ui| ui.weak(format!("this scene has no {one}")));
    } else {
        row(ui, label, "", |ui| {
            let names = structure::names(scene, part);
            let shown = names[*selected].to_owned();
            if let Some(index) = pick_one(ui, label, "", &shown, names) {
                *selected = index;
            }
        });
    }
    row(ui, "", "", |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().button_padding.x = 5.0;
        if ui.button("Add").on_hover_text(format!("adds a {one}")).clicked() {
            let Placement { place, reach } = Placement::of(scene);
            *selected = structure::add(scene, part, place, reach);
        }
        ui.add_enabled_ui(n_parts > 0, |ui| {
            let copy = ui.button("Copy").on_hover_text(format!("adds a copy of this {one}"));
            if copy.clicked() {
                *selected = structure::duplicate(scene, part, *selected);
            }
            let rename = ui.button("Rename").on_hover_text(format!("renames this {one}"));
            let name = structure::names(scene, part).get(*selected).map(|name| (*name).to_owned());
            if let Some(text) = name {
                let path = format!("{list}.{}.name", path_segment(&text));
                parameter(&rename, "Rename", &path);
                if rename.clicked() {
                    *renaming = Some(Renaming { part, index: *selected, text, is_new: true });
                }
            }
            let delete = ui.button("Delete").on_hover_text(format!("removes this {one}"));
            if delete.clicked() {
                structure::remove(scene, part, *selected);
            }
        });
    });
    let n_left = structure::names(scene, part).len();
    *selected = (*selected).min(n_left.saturating_sub(1));
    (n_left > 0).then_some(*selected)
}

fn name_field(
    ui: &mut Ui,
    scene: &mut SceneDescription,
    label: &str,
    renaming: &mut Option<Renaming>,
) {
    let Some(Renaming { part, index, mut text, is_new }) = renaming.take() else { return };
    let mut refused = None;
    let done = row(ui, label, "", |ui| {
        let field = egui::TextEdit::singleline(&mut text)
            .align(egui::Align2::LEFT_CENTER)
            .desired_width(ui.available_width());
        let response = ui.add(field).accessible_name(format!("{label} name"));
        if is_new {
            response.request_focus();
        }
        response.lost_focus()
    });
    if done && ui.input(|input| input.key_pressed(egui::Key::Escape)) {
        return;
    }
    if done {
        match structure::rename(scene, part, index, &text) {
            Ok(()) => return,
            Err(error) => refused = Some(error.to_string()),
        }
        if text.trim().is_empty() {
            return;
        }
    }
    let taken = structure::names(scene, part)
        .iter()
        .enumerate()
        .any(|(other, name)| other != index && *name == text.trim());
    if let Some(reason) = refused.or_else(|| taken.then(|| "this name is taken".to_owned())) {
        row(ui, "", "", |ui| ui.colored_label(ui.visuals().warn_fg_color, reason));
    }
    if !done {
        *renaming = Some(Renaming { part, index, text, is_new: false });
    }
}

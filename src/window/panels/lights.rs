//! Lights: kind, place, size, power.

use super::parts::part_list;
use super::{PickFor, Selection, path_segment, subheading};
use crate::scene::description::{LightDescription, LightKind, OneOrTwo, SceneDescription};
use crate::window::color::strength_and_tint;
use crate::window::structure::Part;
use crate::window::widgets::{Figure, LENGTH, check, pick_one, row, switch, triple};
use egui::Ui;

const KINDS: [(LightKind, &str); 5] = [
    (LightKind::Rectangle, "Rectangle"),
    (LightKind::Disk, "Disk"),
    (LightKind::Sphere, "Sphere"),
    (LightKind::Point, "Point"),
    (LightKind::Sun, "Sun"),
];

/// The lights of the scene, one at a time, and the light that comes from everywhere.
pub(in crate::window) fn lights_ui(
    ui: &mut Ui,
    scene: &mut SceneDescription,
    selection: &mut Selection,
    picking: &mut Option<PickFor>,
    shown_in_picture: &mut bool,
) {
    let shown = part_list(ui, scene, Part::Light, &mut selection.light, &mut selection.renaming);
    let reach = super::parts::Placement::of(scene).reach;
    if let Some(light) = shown.and_then(|index| scene.lights.get_mut(index)) {
        light_ui(ui, light, reach);
        pick_ui(ui, light.kind, picking);
    }
    let help = "marks every light; drag a mark to move it";
    switch(ui, "Show in picture", "", help, shown_in_picture);
    subheading(ui, "Everywhere");
    let ambient = Figure::new("Ambient", "environment.ambient".to_owned(), 0.0..=2.0)
        .logarithmic(0.001)
        .help("even light without shadows; only the direct integrator uses it");
    strength_and_tint(ui, ambient, "environment.ambient", &mut scene.environment.ambient);
}

fn light_ui(ui: &mut Ui, light: &mut LightDescription, reach: f64) {
    let prefix = format!("lights.{}", path_segment(&light.name));
    let path = |key: &str| format!("{prefix}.{key}");
    let (position, target, power) = (path("position"), path("target"), path("power"));
    let (size, up, kind) = (path("size"), path("up"), path("type"));
    row(ui, "", "", |ui| {
        let help = "off: as if it were not there";
        check(ui, "Enabled", &path("enabled"), help, &mut light.enabled);
        let help = "seen by the camera and in mirrors; never blocks other light";
        check(ui, "Visible", &path("visible"), help, &mut light.visible);
    });
    row(ui, "Type", "", |ui| kind_ui(ui, light, &kind));
    let strength_unit = if light.kind == LightKind::Sun { " W/m²" } else { " W" };
    let figure = Figure::new("Power", power.clone(), 0.0..=1e5)
        .logarithmic(0.01)
        .unit(strength_unit)
        .help("all the light it gives; its size does not change it");
    strength_and_tint(ui, figure, &power, &mut light.power);
    size_ui(ui, light, size, reach);
    let speed = (reach * 0.004).max(1e-4);
    triple(ui, "Position", &position, "its centre", LENGTH, speed, &mut light.position);
    if !matches!(light.kind, LightKind::Point | LightKind::Sphere) {
        let help = "the side that shines faces this point";
        triple(ui, "Target", &target, help, LENGTH, speed, &mut light.target);
    }
    if light.kind == LightKind::Rectangle {
        let before = light.up;
        triple(ui, "Up", &up, "turns the rectangle about its axis", "", 0.01, &mut light.up);
        if light.up == [0.0; 3] {
            light.up = before;
        }
    }
}

/// Buttons after which a click in the picture places or turns the light.
fn pick_ui(ui: &mut Ui, kind: LightKind, picking: &mut Option<PickFor>) {
    row(ui, "", "", |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let faces = !matches!(kind, LightKind::Point | LightKind::Sphere);
        for (purpose, text, help, offered) in [
            (
                PickFor::LightPosition,
                "Put it…",
                "then click where it should be, a little off the surface",
                true,
            ),
            (PickFor::LightTarget, "Aim it…", "then click on what it should shine at", faces),
        ] {
            let chosen = *picking == Some(purpose);
            let button = egui::Button::selectable(chosen, text).frame_when_inactive(true);
            if offered && ui.add(button).on_hover_text(help).clicked() {
                *picking = if chosen { None } else { Some(purpose) };
            }
        }
    });
}

fn kind_ui(ui: &mut Ui, light: &mut LightDescription, path: &str) {
    let names = KINDS.map(|(_, name)| name);
    let shown = KINDS.iter().find(|(kind, _)| *kind == light.kind).map_or("", |(_, name)| name);
    if let Some(index) = pick_one(ui, "Light type", path, shown, names) {
        light.kind = KINDS[index].0;
        light.size = fitting_size(light.kind, light.size);
    }
}

fn size_ui(ui: &mut Ui, light: &mut LightDescription, path: String, reach: f64) {
    let [mut width, mut height] = light.size.pair();
    let largest = (reach * 2.0).max(1.0);
    let figure = |label, help| {
        Figure::new(label, path.clone(), 0.0..=largest)
            .allowed(0.0..=1e9)
            .logarithmic(largest * 1e-3)
            .unit(LENGTH)
            .help(help)
    };
    match light.kind {
        LightKind::Rectangle => {
            figure("Width", "wider light, softer shadow; the power stays").show(ui, &mut width);
            figure("Height", "wider light, softer shadow; the power stays").show(ui, &mut height);
            if [width, height] != light.size.pair() {
                // One side 0 and the other not would be no light at all.
                let closed = (width == 0.0) != (height == 0.0);
                light.size = if closed || width == height {
                    OneOrTwo::One(if closed { width.max(height) } else { width })
                } else {
                    OneOrTwo::Two([width, height])
                };
            }
        }
        LightKind::Disk | LightKind::Sphere => {
            figure("Diameter", "wider light, softer shadow; 0 is a point").show(ui, &mut width);
            if width != light.size.pair()[0] {
                light.size = OneOrTwo::One(width);
            }
        }
        LightKind::Sun => {
            Figure::new("Diameter", path, 0.0..=20.0)
                .allowed(0.0..=180.0)
                .unit("°")
                .help("angle it fills in the sky; the real sun fills 0.53°")
                .show(ui, &mut width);
            if width != light.size.pair()[0] {
                light.size = OneOrTwo::One(width);
            }
        }
        LightKind::Point => {}
    }
}

/// A size the kind accepts: one number for all but rectangles, at most 180 degrees for suns.
fn fitting_size(kind: LightKind, size: OneOrTwo) -> OneOrTwo {
    match kind {
        LightKind::Rectangle => size,
        LightKind::Disk | LightKind::Sphere | LightKind::Point => OneOrTwo::One(size.pair()[0]),
        LightKind::Sun => OneOrTwo::One(size.pair()[0].min(180.0)),
    }
}

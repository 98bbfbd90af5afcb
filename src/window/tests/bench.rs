//! A panel by itself, and the hand that works it.

use super::small_scene;
use crate::render::{Course, Noise};
use crate::scene::description::SceneDescription;
use crate::window::panels::{
    Convergence, DisplayState, Limits, PickFor, RenderFacts, Selection, SizeMode, camera_ui,
    display_ui, lights_ui, materials_ui, objects_ui, render_ui, textures_ui,
};
use crate::window::parameter::take_reset;
use crate::window::theme;
use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;

/// What a panel under test edits.
#[derive(Clone, Debug)]
pub(super) struct Bench {
    pub(super) scene: SceneDescription,
    pub(super) selection: Selection,
    pub(super) size_mode: SizeMode,
    pub(super) accelerator: usize,
    pub(super) n_threads: usize,
    pub(super) display: DisplayState,
    pub(super) unit_mm: f64,
    pub(super) picking: Option<PickFor>,
    pub(super) lights_shown: bool,
    pub(super) lens_shown: bool,
    pub(super) limits: Limits,
}

pub(super) type Panel = fn(&mut egui::Ui, &mut Bench);

pub(super) const CAMERA: Panel = |ui, bench| {
    let (unit, picking) = (&mut bench.unit_mm, &mut bench.picking);
    camera_ui(ui, &mut bench.scene.camera, unit, picking, &mut bench.lens_shown);
};
pub(super) const LIGHTS: Panel = |ui, bench| {
    let (picking, shown) = (&mut bench.picking, &mut bench.lights_shown);
    lights_ui(ui, &mut bench.scene, &mut bench.selection, picking, shown);
};
pub(super) const MATERIALS: Panel =
    |ui, bench| materials_ui(ui, &mut bench.scene, &mut bench.selection, |_, _, _| ());
pub(super) const TEXTURES: Panel =
    |ui, bench| textures_ui(ui, &mut bench.scene, &mut bench.selection, |_, _| ());
pub(super) const OBJECTS: Panel =
    |ui, bench| objects_ui(ui, &mut bench.scene, &mut bench.selection);
pub(super) const DISPLAY: Panel =
    |ui, bench| display_ui(ui, &mut bench.scene.tone_mapping, &mut bench.display, None);
pub(super) const RENDER: Panel =
    |ui, bench| render_with(ui, bench, &[(1, noise(20.0)), (4, noise(10.0))]);

/// The group Render with so many estimates of the noise.
pub(super) fn render_with(ui: &mut egui::Ui, bench: &mut Bench, noise: &[(u32, Noise)]) {
    let facts = RenderFacts {
        n_processors: 4,
        accelerators: &["kd-tree", "brute-force"],
        tree: vec![("Nodes", "12".to_owned())],
        convergence: Convergence { noise, seconds: 1.0, is_rendering: true },
    };
    let (size, accelerator) = (&mut bench.size_mode, &mut bench.accelerator);
    let limits = &mut bench.limits;
    let threads = &mut bench.n_threads;
    render_ui(ui, &mut bench.scene.render, size, accelerator, threads, limits, &facts);
}

pub(super) const fn noise(percent: f64) -> Noise {
    Noise { percent, uncertainty: 0.1, course: Course::even(0.5) }
}
pub(super) const ALL: [Panel; 7] = [CAMERA, LIGHTS, MATERIALS, TEXTURES, OBJECTS, DISPLAY, RENDER];

pub(super) fn harness(panel: Panel) -> Harness<'static, Bench> {
    harness_of(panel, bench(small_scene()))
}

/// What edits that scene, with nothing chosen.
pub(super) fn bench(scene: SceneDescription) -> Bench {
    Bench {
        scene,
        selection: Selection::default(),
        size_mode: SizeMode::Fixed,
        accelerator: 0,
        n_threads: 1,
        display: DisplayState::default(),
        unit_mm: 100.0,
        picking: None,
        lights_shown: false,
        lens_shown: false,
        limits: Limits::default(),
    }
}

/// A panel by itself, as wide as in the window.
pub(super) fn harness_of(panel: Panel, bench: Bench) -> Harness<'static, Bench> {
    let mut installed = false;
    let mut harness = Harness::builder().with_size([320.0, 1200.0]).build_ui_state(
        move |ui, bench: &mut Bench| {
            if !std::mem::replace(&mut installed, true) {
                theme::install(ui.ctx());
            }
            panel(ui, bench);
            take_reset(ui.ctx(), &mut bench.scene).expect("a reset keeps the scene valid");
        },
        bench,
    );
    harness.run();
    harness
}

/// Types a figure into the box of that name.
pub(super) fn type_figure(harness: &mut Harness<'_, Bench>, label: &str, text: &str) {
    harness.get_by_role_and_label(Role::SpinButton, label).click();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.event(egui::Event::Text(text.to_owned()));
    harness.key_press(egui::Key::Enter);
    harness.run();
}

pub(super) fn slide(harness: &mut Harness<'_, Bench>, label: &str, value: f64) {
    harness.get_by_role_and_label(Role::Slider, label).set_value_accesskit(value);
    harness.run();
}

/// Chooses from the list of that name.
pub(super) fn choose(harness: &mut Harness<'_, Bench>, label: &str, option: &str) {
    harness.get_by_role_and_label(Role::ComboBox, label).click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, option).click();
    harness.run();
}

pub(super) fn press(harness: &mut Harness<'_, Bench>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    harness.run();
}

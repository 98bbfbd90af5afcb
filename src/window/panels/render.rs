//! Render: size, samples, how light is followed, and how the work goes.

use super::convergence::{Convergence, convergence_ui};
use super::subheading;
use crate::scene::description::{FilterKind, IntegratorKind, RenderDescription, SamplerKind};
use crate::window::widgets::{Figure, choice, number_box, pick_one, row, switch};
use egui::Ui;
use serde::{Deserialize, Serialize};

/// How large the picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(in crate::window) enum SizeMode {
    /// As large as the viewport shows whole, in the shape that the scene file gives.
    #[default]
    Fit,
    /// As many pixels as the viewport has.
    Fill,
    /// The size the scene file gives.
    Fixed,
}

/// When refining stops before its samples are reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::window) struct Limits {
    /// After that many seconds of rendering.
    pub(in crate::window) seconds: Option<f64>,
    /// At that noise, in percent.
    pub(in crate::window) noise_percent: Option<f64>,
}

/// What the panel shows and does not edit.
pub(in crate::window) struct RenderFacts<'a> {
    /// Processors that there are.
    pub(in crate::window) n_processors: usize,
    /// Names of the accelerators, in the order of the list.
    pub(in crate::window) accelerators: &'a [&'a str],
    /// Lines on the tree that was built, name and value.
    pub(in crate::window) tree: Vec<(&'static str, String)>,
    /// How the noise falls.
    pub(in crate::window) convergence: Convergence<'a>,
}

const INTEGRATORS: [(IntegratorKind, &str, &str); 2] = [
    (IntegratorKind::Direct, "Direct", "ambient, direct light, mirrors and glass: quick and clean"),
    (IntegratorKind::Path, "Path", "light that bounces everywhere: slower and truer"),
];
const SAMPLERS: [(SamplerKind, &str, &str); 2] = [
    (SamplerKind::Sobol, "Sobol", "evenly spread numbers: less noise at the same cost"),
    (SamplerKind::Random, "Random", "independent numbers, to see the difference"),
];
const FILTERS: [(FilterKind, &str); 1] = [(FilterKind::Box, "Box")];
const SIZES: [(SizeMode, &str, &str); 3] = [
    (SizeMode::Fit, "Fit", "as large as the window shows, in the scene's own shape"),
    (SizeMode::Fill, "Fill", "all of the window, whatever its shape"),
    (SizeMode::Fixed, "Fixed", "the size below, which the scene file keeps"),
];

/// Settings of the render and its statistics. `accelerator` is an index in the facts' list.
pub(in crate::window) fn render_ui(
    ui: &mut Ui,
    render: &mut RenderDescription,
    size_mode: &mut SizeMode,
    accelerator: &mut usize,
    n_threads: &mut usize,
    limits: &mut Limits,
    facts: &RenderFacts<'_>,
) {
    choice(ui, "Size", "", "", size_mode, &SIZES);
    if *size_mode == SizeMode::Fixed {
        let figure = |label, key: &str| {
            Figure::new(label, format!("render.{key}"), 16.0..=3840.0)
                .allowed(1.0..=16384.0)
                .unit(" px")
        };
        figure("Width", "width").show_integer(ui, &mut render.width);
        figure("Height", "height").show_integer(ui, &mut render.height);
    }
    Figure::new("Samples", "render.samples".to_owned(), 1.0..=4096.0)
        .allowed(1.0..=1_048_576.0)
        .logarithmic(1.0)
        .help("rays per pixel at which the picture is done")
        .show_integer(ui, &mut render.samples);
    limits_ui(ui, limits);
    let help = "which paths of light are followed";
    choice(ui, "Integrator", "render.integrator", help, &mut render.integrator, &INTEGRATORS);
    Figure::new("Bounces", "render.max_depth".to_owned(), 0.0..=32.0)
        .allowed(0.0..=1024.0)
        .help("how often a ray may bounce after it leaves the camera")
        .show_integer(ui, &mut render.max_depth);
    choice(ui, "Sampler", "render.sampler", "", &mut render.sampler, &SAMPLERS);
    let help = "samples go where the picture is noisy; their number is then the mean per pixel";
    switch(ui, "Adaptive", "render.adaptive", help, &mut render.adaptive);
    row(ui, "Filter", "how samples are weighted into pixels", |ui| {
        let shown = FILTERS.iter().find(|(kind, _)| *kind == render.filter);
        let (names, shown) = (FILTERS.map(|(_, name)| name), shown.map_or("", |(_, name)| name));
        if let Some(index) = pick_one(ui, "Filter", "render.filter", shown, names) {
            render.filter = FILTERS[index].0;
        }
    });
    Figure::new("Seed", "render.seed".to_owned(), 0.0..=100.0)
        .allowed(0.0..=f64::from(u32::MAX))
        .help("another number gives another pattern of noise")
        .show_integer(ui, &mut render.seed);
    let mut threads = *n_threads as u32;
    Figure::new("Threads", String::new(), 1.0..=facts.n_processors as f64)
        .allowed(1.0..=facts.n_processors as f64)
        .help("processors that render; the picture is the same with any number")
        .show_integer(ui, &mut threads);
    *n_threads = threads as usize;
    if facts.accelerators.len() > 1 {
        row(ui, "Accelerator", "finds what rays meet; the picture is the same with each", |ui| {
            let shown = facts.accelerators[(*accelerator).min(facts.accelerators.len() - 1)];
            let names = facts.accelerators.iter().copied();
            if let Some(index) = pick_one(ui, "Accelerator", "", shown, names) {
                *accelerator = index;
            }
        });
    }
    if !facts.tree.is_empty() {
        for (name, value) in &facts.tree {
            row(ui, name, "", |ui| ui.label(value));
        }
    }
    subheading(ui, "Noise by samples");
    convergence_ui(ui, &facts.convergence, render.samples, limits.noise_percent);
}

/// Switches with a figure each: stop after a time, stop at a noise.
pub(in crate::window) fn limits_ui(ui: &mut Ui, limits: &mut Limits) {
    let limit = |ui: &mut Ui, label: &str, unit: &str, usual: f64, limit: &mut Option<f64>| {
        row(ui, "", "", |ui| {
            let mut on = limit.is_some();
            if ui.checkbox(&mut on, label).changed() {
                *limit = on.then_some(usual);
            }
            if let Some(value) = limit {
                let mut typed = *value;
                let speed = (typed * 0.01).max(0.01);
                let response = number_box(ui, &mut typed, 64.0, speed, unit, false)
                    .accessible_name(format!("{label} limit"));
                if response.changed() && typed.is_finite() {
                    *value = typed.clamp(0.01, 1e6);
                }
            }
        });
    };
    limit(ui, "Stop after", " s", 60.0, &mut limits.seconds);
    limit(ui, "Stop at noise", " %", 1.0, &mut limits.noise_percent);
}

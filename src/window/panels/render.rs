//! Render: size, samples, how light is followed, and how the work goes.

use super::subheading;
use crate::scene::description::{IntegratorKind, RenderDescription, SamplerKind};
use crate::window::status::duration;
use crate::window::theme;
use crate::window::widgets::{Figure, choice, number_box, pick_one, row, short};
use egui::{Stroke, Ui, Vec2};

/// How large the picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::window) enum SizeMode {
    /// As many pixels as the viewport has.
    #[default]
    Window,
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
    /// Names of the accelerators, in the order of the list.
    pub(in crate::window) accelerators: &'a [&'a str],
    /// Lines on the tree that was built, name and value.
    pub(in crate::window) tree: Vec<(&'static str, String)>,
    /// Seconds of rendering so far.
    pub(in crate::window) seconds: f64,
    /// (samples, noise in percent), in order of samples.
    pub(in crate::window) noise: &'a [(u32, f64)],
}

const INTEGRATORS: [(IntegratorKind, &str, &str); 2] = [
    (IntegratorKind::Direct, "Direct", "ambient, direct light, mirrors and glass: quick and clean"),
    (IntegratorKind::Path, "Path", "light that bounces everywhere: slower and truer"),
];
const SAMPLERS: [(SamplerKind, &str, &str); 2] = [
    (SamplerKind::Sobol, "Sobol", "evenly spread numbers: less noise at the same cost"),
    (SamplerKind::Random, "Random", "independent numbers, to see the difference"),
];
const SIZES: [(SizeMode, &str, &str); 2] = [
    (SizeMode::Window, "Window", "as many pixels as the window shows"),
    (SizeMode::Fixed, "Fixed", "the size below, which the scene file keeps"),
];

/// Settings of the render and its statistics. `accelerator` is an index in the facts' list.
pub(in crate::window) fn render_ui(
    ui: &mut Ui,
    render: &mut RenderDescription,
    size_mode: &mut SizeMode,
    accelerator: &mut usize,
    limits: &mut Limits,
    facts: &RenderFacts<'_>,
) {
    choice(ui, "Size", "", size_mode, &SIZES);
    if *size_mode == SizeMode::Fixed {
        let figure = |label, key: &str| {
            Figure::new(label, format!("render.{key}"), 16.0..=3840.0)
                .allowed(1.0..=16384.0)
                .unit(" px")
        };
        figure("Width", "width").default_value(1280.0).show_integer(ui, &mut render.width);
        figure("Height", "height").default_value(720.0).show_integer(ui, &mut render.height);
    }
    Figure::new("Samples", "render.samples".to_owned(), 1.0..=4096.0)
        .allowed(1.0..=1_048_576.0)
        .logarithmic(1.0)
        .default_value(256.0)
        .help("rays per pixel at which the picture is done")
        .show_integer(ui, &mut render.samples);
    limits_ui(ui, limits);
    choice(ui, "Light", "", &mut render.integrator, &INTEGRATORS);
    Figure::new("Bounces", "render.max_depth".to_owned(), 0.0..=32.0)
        .allowed(0.0..=1024.0)
        .default_value(8.0)
        .help("how often a ray may bounce after it leaves the camera")
        .show_integer(ui, &mut render.max_depth);
    choice(ui, "Sampler", "", &mut render.sampler, &SAMPLERS);
    Figure::new("Seed", "render.seed".to_owned(), 0.0..=100.0)
        .allowed(0.0..=f64::from(u32::MAX))
        .default_value(0.0)
        .help("another number gives another pattern of noise")
        .show_integer(ui, &mut render.seed);
    if facts.accelerators.len() > 1 {
        row(ui, "Tree", "finds what rays meet; the picture is the same with each", |ui| {
            let shown = facts.accelerators[(*accelerator).min(facts.accelerators.len() - 1)];
            let names = facts.accelerators.iter().copied();
            if let Some(index) = pick_one(ui, "Accelerator", shown, names) {
                *accelerator = index;
            }
        });
    }
    if !facts.tree.is_empty() {
        for (name, value) in &facts.tree {
            row(ui, name, "", |ui| ui.label(value));
        }
    }
    if facts.noise.len() > 1 {
        subheading(ui, "Noise by samples");
        noise_graph(ui, facts.noise);
        ui.label(outlook(facts.noise, facts.seconds));
    }
}

/// Switches with a figure each: stop after a time, stop at a noise.
fn limits_ui(ui: &mut Ui, limits: &mut Limits) {
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

/// "2.1 % now, 1 % in about 40 s": noise falls with the square root of the time.
fn outlook(noise: &[(u32, f64)], seconds: f64) -> String {
    let Some((_, now)) = noise.last().copied().filter(|(_, now)| 0.0 < *now) else {
        return String::new();
    };
    let mut next = 10.0_f64.powf(now.log10().floor());
    if now < next * 1.05 {
        next /= 10.0;
    }
    let more = seconds * ((now / next).powi(2) - 1.0);
    format!("{} % now, {} % in about {}", short(now), short(next), duration(more))
}

/// Noise against samples, both logarithmic: honest sampling is a line that falls.
fn noise_graph(ui: &mut Ui, noise: &[(u32, f64)]) {
    let size = Vec2::new(ui.available_width(), 84.0);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    let (first, last) = (noise[0], noise[noise.len() - 1]);
    let told = format!(
        "noise {} % at {} samples, {} % at {}",
        short(first.1),
        first.0,
        short(last.1),
        last.0
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &told));
    response.on_hover_text(told);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    let area = rect.shrink2(Vec2::new(10.0, 16.0));
    let log = |value: f64| value.max(1e-6).log10();
    let (left, right) = (log(f64::from(first.0)), log(f64::from(last.0)));
    let highest = noise.iter().map(|(_, percent)| log(*percent)).fold(f64::MIN, f64::max);
    let lowest = noise.iter().map(|(_, percent)| log(*percent)).fold(f64::MAX, f64::min);
    let points: Vec<egui::Pos2> = noise
        .iter()
        .map(|(samples, percent)| {
            let x = (log(f64::from(*samples)) - left) / (right - left).max(1e-9);
            let y = (highest - log(*percent)) / (highest - lowest).max(1e-9);
            area.lerp_inside(Vec2::new(x as f32, y as f32))
        })
        .collect();
    let accent = theme::accent(ui.visuals());
    painter.line(points, Stroke::new(1.5, accent));
    let font = egui::TextStyle::Small.resolve(ui.style());
    let quiet = ui.visuals().weak_text_color();
    for (at, align, text) in [
        (rect.left_top(), egui::Align2::LEFT_TOP, format!("{} %", short(first.1))),
        (rect.right_bottom(), egui::Align2::RIGHT_BOTTOM, format!("{} %", short(last.1))),
        (rect.left_bottom(), egui::Align2::LEFT_BOTTOM, format!("{}", first.0)),
    ] {
        let inset = (rect.center() - at).normalized() * 8.0;
        painter.text(
            at + Vec2::new(inset.x, inset.y.signum() * 2.0),
            align,
            text,
            font.clone(),
            quiet,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::outlook;

    #[test]
    fn a_tenth_of_the_noise_takes_a_hundred_times_as_long() {
        let told = outlook(&[(1, 50.0), (16, 10.0)], 2.0);
        assert_eq!(told, "10 % now, 1 % in about 3 min 18 s", "another outlook");
        assert_eq!(outlook(&[(4, 2.0)], 10.0), "2 % now, 1 % in about 30 s", "another outlook");
    }
}

//! The box that renders a picture to a file. It stays open beside the live picture.

use super::export::ExportProgress;
use super::export_settings::{Destination, ExportSettings, ExportSize};
use super::fields::entered_text;
use super::figures::{duration, noise_text};
use super::panels::limits_ui;
use super::theme::ROW_HEIGHT;
use super::widgets::{Figure, choice, row};
use crate::io::output::OutputFormat;
use egui::{Id, RichText, Ui};
use std::path::PathBuf;

/// Width of what is in the box, in points.
const WIDTH: f32 = 348.0;

const SIZES: [(ExportSize, &str, &str); 4] = [
    (ExportSize::Live, "As shown", "as many pixels as the live picture has"),
    (ExportSize::Double, "2×", "twice the pixels along each side"),
    (ExportSize::Uhd, "4K", "3840×2160"),
    (ExportSize::Custom, "Custom", "any size"),
];
const FORMATS: [(OutputFormat, &str, &str); 3] = [
    (OutputFormat::Png, "PNG", "as shown, 8 bits a channel, with its scene inside"),
    (OutputFormat::Exr, "EXR", "linear light, 32-bit float, without exposure and curve"),
    (OutputFormat::Hdr, "HDR", "linear light, shared exponent, without exposure and curve"),
];
const DESTINATIONS: [(Destination, &str, &str); 2] = [
    (Destination::File, "File", "a new file; no other is overwritten"),
    (Destination::Clipboard, "Clipboard", "to be pasted, as shown"),
];

/// What the box knows of the rest of the window.
pub(super) struct ExportFacts<'a> {
    /// Size of the live picture in pixels.
    pub(super) live: [u32; 2],
    /// Samples that the scene asks for.
    pub(super) samples: u32,
    /// Name of the scene.
    pub(super) title: &'a str,
    /// How far a picture is that is being rendered.
    pub(super) progress: Option<ExportProgress>,
}

/// What was chosen in the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ExportChoice {
    /// Start.
    Render,
    /// Stop what was started.
    Stop,
    /// Ask for a folder.
    ChooseFolder,
    /// Close the box; a picture that was started goes on.
    Close,
}

/// Shows the box and edits `settings` in place.
pub(super) fn export_ui(
    ctx: &egui::Context,
    settings: &mut ExportSettings,
    facts: &ExportFacts<'_>,
) -> Option<ExportChoice> {
    let corner = ctx.content_rect().left_top() + egui::vec2(24.0, 62.0);
    egui::Window::new("Render picture")
        .id(Id::unique("render picture"))
        .title_bar(false)
        .frame(egui::Frame::window(&ctx.global_style()).inner_margin(14))
        .resizable(false)
        .default_pos(corner)
        .show(ctx, |ui| {
            ui.set_width(WIDTH);
            ui.strong("Render picture");
            ui.add_space(6.0);
            ui.add_enabled_ui(facts.progress.is_none(), |ui| settings_ui(ui, settings, facts))
                .inner
                .or_else(|| foot(ui, facts))
        })
        .and_then(|shown| shown.inner.flatten())
}

fn settings_ui(
    ui: &mut Ui,
    settings: &mut ExportSettings,
    facts: &ExportFacts<'_>,
) -> Option<ExportChoice> {
    choice(ui, "Size", "", "", &mut settings.size, &SIZES);
    if settings.size == ExportSize::Custom {
        let figure = |label| {
            Figure::new(label, String::new(), 16.0..=7680.0)
                .allowed(1.0..=16384.0)
                .logarithmic(16.0)
                .unit(" px")
        };
        let [width, height] = &mut settings.custom;
        figure("Pixels wide").show_integer(ui, width);
        figure("Pixels high").show_integer(ui, height);
    } else {
        let [width, height] = settings.pixels(facts.live);
        row(ui, "", "", |ui| ui.weak(format!("{width}×{height} px")));
    }
    let mut samples = settings.samples.unwrap_or(facts.samples);
    let before = samples;
    Figure::new("Samples", String::new(), 1.0..=4096.0)
        .allowed(1.0..=1_048_576.0)
        .logarithmic(1.0)
        .help("samples per pixel at which the picture is done")
        .show_integer(ui, &mut samples);
    if samples != before {
        settings.samples = Some(samples);
    }
    limits_ui(ui, &mut settings.limits);
    choice(ui, "To", "", "", &mut settings.destination, &DESTINATIONS);
    if settings.destination == Destination::Clipboard {
        return None;
    }
    choice(ui, "Format", "", "", &mut settings.format, &FORMATS);
    folder_ui(ui, settings, facts)
}

fn folder_ui(
    ui: &mut Ui,
    settings: &mut ExportSettings,
    facts: &ExportFacts<'_>,
) -> Option<ExportChoice> {
    let shown = settings.folder().display().to_string();
    if let Some(folder) = entered_text(ui, "Folder", "where the file goes", "a folder", "", &shown)
    {
        settings.folder = Some(PathBuf::from(folder));
    }
    row(ui, "", "", |ui| {
        let choose = ui.button("Choose…").on_hover_text("opens the system's dialog");
        let told = format!("{}-NNN.{}", facts.title, settings.format.ending());
        ui.add(egui::Label::new(RichText::new(told).weak()).truncate())
            .on_hover_text("NNN is the first free number");
        choose.clicked().then_some(ExportChoice::ChooseFolder)
    })
}

fn foot(ui: &mut Ui, facts: &ExportFacts<'_>) -> Option<ExportChoice> {
    ui.add_space(8.0);
    match &facts.progress {
        None => {
            ui.horizontal(|ui| {
                let render = egui::Button::new(RichText::new("Render").strong())
                    .min_size(egui::vec2(88.0, ROW_HEIGHT + 4.0));
                let render = ui.add(render).on_hover_text("the live picture goes on meanwhile");
                let close = egui::Button::new("Close").min_size(egui::vec2(64.0, ROW_HEIGHT + 4.0));
                let close = ui.add(close);
                render
                    .clicked()
                    .then_some(ExportChoice::Render)
                    .or(close.clicked().then_some(ExportChoice::Close))
            })
            .inner
        }
        Some(progress) => {
            let bar = egui::ProgressBar::new(progress.share())
                .desired_width(WIDTH)
                .desired_height(6.0)
                .corner_radius(3);
            ui.add(bar).on_hover_text("how much of the picture is there");
            ui.weak(progress_text(progress));
            ui.add_space(2.0);
            ui.horizontal(|ui| {
                let stop = ui.button("Stop").on_hover_text("writes nothing");
                let close = ui.button("Close").on_hover_text("the picture goes on");
                stop.clicked()
                    .then_some(ExportChoice::Stop)
                    .or(close.clicked().then_some(ExportChoice::Close))
            })
            .inner
        }
    }
}

/// "48/256 · noise 2.1 ± 0.2 % · 12 s left".
fn progress_text(progress: &ExportProgress) -> String {
    let (now, goal) = progress.samples;
    if now == 0 {
        return "preparing".to_owned();
    }
    let noise = progress.noise.map(|noise| format!(" · noise {}", noise_text(noise)));
    let left = progress.seconds_left.map(|left| format!(" · {} left", duration(left)));
    format!("{now}/{goal}{}{}", noise.unwrap_or_default(), left.unwrap_or_default())
}

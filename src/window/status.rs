//! The status bar: what the renderer is doing, in words and figures that never flatter.

use super::figures::{duration, noise_text, short, significant};
use super::theme;
use crate::io::progress::Step;
use crate::loader::LoadProgress;
use crate::render::Noise;
use egui::{Color32, RichText, Ui, Vec2};
use std::path::Path;
use std::time::Duration;

/// What the bar says, already measured.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StatusLine {
    /// What is going on.
    pub(super) work: Work,
    /// Whole passes so far, and how many make the picture done.
    pub(super) samples: (u32, u32),
    /// 100 x estimated RMSE over mean, where there is an estimate.
    pub(super) noise: Option<Noise>,
    /// Render time so far, in seconds.
    pub(super) seconds: f64,
    /// Estimated time to the goal, in seconds.
    pub(super) seconds_left: Option<f64>,
    /// Rays per second over the last while.
    pub(super) rays_per_second: f64,
    /// Samples that were not finite and count as black.
    pub(super) n_invalid: u64,
    /// Render threads.
    pub(super) n_threads: usize,
    /// Size of the picture in pixels, and its zoom in percent.
    pub(super) size: [u32; 2],
    /// Screen pixels per picture pixel, times 100.
    pub(super) zoom_percent: f64,
}

/// What is going on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Work {
    /// Nothing to show yet.
    Idle,
    /// The tree over the scene is being built.
    Building,
    /// Samples are being added.
    Rendering,
    /// Held by the user.
    Paused,
    /// The goal is reached.
    Done,
    /// The renderer failed.
    Failed(String),
}

/// What is under the cursor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelUnderCursor {
    /// Column and row from the top left.
    pub(super) at: [u32; 2],
    /// Linear RGB.
    pub(super) linear: [f32; 3],
}

/// What is under the resting cursor.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Probed {
    /// Name of the object or light; "background" where there is none.
    pub(super) object: String,
    /// Name of its material; empty where it has none.
    pub(super) material: String,
    /// Distance along the view, in scene units; infinite for the background.
    pub(super) depth: f64,
    /// Diameter of its blur in pixels.
    pub(super) blur_px: f64,
}

/// Shows the bar: the work on the left, the pixel under the cursor and the size on the right.
pub(super) fn status_ui(
    ui: &mut Ui,
    line: &StatusLine,
    pixel: Option<PixelUnderCursor>,
    probed: Option<&Probed>,
) {
    work_line(ui, line);
    ui.horizontal_centered(|ui| {
        let [n_done, n_goal] = [line.samples.0, line.samples.1];
        ui.spacing_mut().item_spacing.x = 4.0;
        let size =
            format!("{}×{} @ {} %", line.size[0], line.size[1], significant(line.zoom_percent, 3));
        let strong = RichText::new(work_text(&line.work, n_done, n_goal)).strong();
        ui.add(egui::Label::new(strong).truncate());
        let room_for_details = ui.available_width() > 360.0;
        let details = if room_for_details { details(line) } else { String::new() };
        ui.label(RichText::new(details).weak());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(size).weak());
            if let Some(pixel) = pixel
                && ui.available_width() > 250.0
            {
                ui.label(RichText::new(pixel_text(pixel)).weak())
                    .on_hover_text("the pixel under the cursor: column, row, linear RGB");
                if let Some(probed) = probed
                    && ui.available_width() > 260.0
                {
                    ui.label(RichText::new(probed_text(probed)).weak()).on_hover_text(
                        "what is under the cursor: object, material, depth, diameter of its blur",
                    );
                }
            }
        });
    });
}

/// Shows what is being loaded and how far it is; gives back whether it is to be stopped.
pub(super) fn loading_ui(ui: &mut Ui, name: &str, progress: &LoadProgress) -> bool {
    // News are looked for, not sent: there may be a hundred a second.
    ui.request_repaint_after(Duration::from_millis(50));
    let (text, share) = match progress {
        LoadProgress::Idle | LoadProgress::Loading { step: None, .. } => (String::new(), 0.0),
        LoadProgress::Loading { step: Some((file, step)), .. } => step_text(file, *step),
    };
    progress_line(ui, share, theme::accent(ui.visuals()));
    ui.horizontal_centered(|ui| {
        ui.label(RichText::new(format!("loading {name}")).strong());
        let stop = ui.button("Cancel").on_hover_text("keeps the scene that is open (Esc)");
        ui.add(egui::Label::new(RichText::new(text).weak()).truncate());
        stop.clicked()
    })
    .inner
}

/// In words, and how far the file is by that, 0..=1.
fn step_text(file: &str, step: Step) -> (String, f32) {
    let file = Path::new(file).file_name().unwrap_or_default().to_string_lossy();
    match step {
        Step::Reading(share) => {
            let percent = (share * 100.0).floor();
            (format!("reading {file}, {percent} %"), 0.6 * share)
        }
        Step::Normals => (format!("preparing the normals of {file}"), 0.6),
        Step::Tree => (format!("building the tree of {file}"), 0.8),
    }
}

/// How far the work is.
fn work_line(ui: &Ui, line: &StatusLine) {
    let share = match line.work {
        Work::Idle | Work::Building | Work::Failed(_) => 0.0,
        Work::Rendering | Work::Paused => {
            f64::from(line.samples.0) / f64::from(line.samples.1.max(1))
        }
        Work::Done => 1.0,
    };
    let color = match line.work {
        Work::Paused | Work::Done => ui.visuals().weak_text_color(),
        _ => theme::accent(ui.visuals()),
    };
    progress_line(ui, share as f32, color);
}

/// A thin line at the top of the bar, as long as the work is far.
fn progress_line(ui: &Ui, share: f32, color: Color32) {
    let bar = ui.max_rect().expand2(Vec2::new(8.0, 0.0));
    let mut filled = bar.with_max_y(bar.top() + 2.0);
    filled.set_right(bar.left() + bar.width() * share.clamp(0.0, 1.0));
    ui.painter().rect_filled(filled, 0.0, color);
}

fn work_text(work: &Work, n_done: u32, n_goal: u32) -> String {
    match work {
        Work::Idle => "ready".to_owned(),
        Work::Building => "building the tree".to_owned(),
        Work::Rendering => format!("rendering {n_done}/{n_goal}"),
        Work::Paused => format!("paused {n_done}/{n_goal}"),
        Work::Done => format!("done {n_done}/{n_goal}"),
        Work::Failed(reason) => format!("failed: {reason}"),
    }
}

/// Everything behind the first words, parted by dots.
fn details(line: &StatusLine) -> String {
    let mut parts = Vec::new();
    let working = matches!(line.work, Work::Rendering);
    if let Some(noise) = line.noise {
        parts.push(format!("noise {}", noise_text(noise)));
    }
    if line.n_invalid > 0 {
        parts.push(format!("{} samples not finite", line.n_invalid));
    }
    if line.seconds > 0.0 {
        let left = line.seconds_left.filter(|_| working);
        let left = left.map_or(String::new(), |left| format!(", {} left", duration(left)));
        parts.push(format!("{}{left}", duration(line.seconds)));
    }
    if working && line.rays_per_second > 0.0 {
        parts.push(format!("{:.1} Mrays/s", line.rays_per_second / 1e6));
    }
    if line.n_threads > 0 {
        let s = if line.n_threads == 1 { "" } else { "s" };
        parts.push(format!("{} thread{s}", line.n_threads));
    }
    parts.iter().map(|part| format!("· {part} ")).collect::<String>().trim_end().to_owned()
}

fn pixel_text(pixel: PixelUnderCursor) -> String {
    let [r, g, b] = pixel.linear;
    format!("{}, {}: {r:.3} {g:.3} {b:.3} ·", pixel.at[0], pixel.at[1])
}

fn probed_text(probed: &Probed) -> String {
    let Probed { object, material, depth, blur_px } = probed;
    let material = if material.is_empty() { String::new() } else { format!(" ({material})") };
    let depth =
        if depth.is_finite() { format!(" · depth {}", short(*depth)) } else { String::new() };
    format!("{object}{material}{depth} · blur {blur_px:.1} px ·")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Course;

    fn line(work: Work) -> StatusLine {
        StatusLine {
            work,
            samples: (48, 256),
            noise: Some(Noise { percent: 2.13, uncertainty: 0.08, course: Course::even(0.5) }),
            seconds: 3.9,
            seconds_left: Some(12.9),
            rays_per_second: 8.4e6,
            n_invalid: 0,
            n_threads: 2,
            size: [1280, 720],
            zoom_percent: 100.0,
        }
    }

    #[test]
    fn the_line_tells_samples_noise_time_rate_and_threads() {
        let line = line(Work::Rendering);
        let told = format!("{} {}", work_text(&line.work, 48, 256), details(&line));
        let expected =
            "rendering 48/256 · noise 2.1 ± 0.2 % · 3 s, 12 s left · 8.4 Mrays/s · 2 threads";
        assert_eq!(told, expected, "the line reads differently");
    }

    #[test]
    fn done_is_a_state_and_promises_no_more_time() {
        let line = line(Work::Done);
        assert!(work_text(&line.work, 256, 256).starts_with("done"), "not said to be done");
        assert!(!details(&line).contains("left"), "done, yet: {}", details(&line));
    }

    #[test]
    fn loading_tells_the_file_and_what_is_done_with_it() {
        let told = |step| step_text("../meshes/igea.obj", step).0;
        assert_eq!(told(Step::Reading(0.439)), "reading igea.obj, 43 %", "not rounded down");
        assert_eq!(told(Step::Normals), "preparing the normals of igea.obj", "another step");
        assert_eq!(told(Step::Tree), "building the tree of igea.obj", "another step");
        let shares = [Step::Reading(0.0), Step::Reading(1.0), Step::Normals, Step::Tree]
            .map(|step| step_text("a", step).1);
        assert!(shares.is_sorted() && shares[3] < 1.0, "the line goes {shares:?}");
    }
}

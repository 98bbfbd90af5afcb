//! How the noise falls: a graph of noise against samples, both logarithmic, and when the next round
//! figure is reached.
//!
//! The plot has linear axes: it is given logarithms (base 10), and round figures for its ticks.

use crate::render::Noise;
use crate::window::figures::{duration, noise_text, percent_text, short};
use crate::window::theme;
use egui::{Color32, Margin, Sense, TextStyle, Ui};
use egui_plot::{
    AxisHints, FilledArea, GridMark, HLine, HoverPosition, Line, LineStyle, Plot, PlotUi, Points,
    VLine,
};
use std::ops::RangeInclusive;

/// Height of the graph in points, with the figures below it.
const HEIGHT: f32 = 132.0;
/// Room for the figures on the left, in points.
const LEFT: f32 = 34.0;
/// What the graph shows.
#[derive(Clone, Copy, Debug)]
pub(in crate::window) struct Convergence<'a> {
    /// Samples and noise, in order of samples.
    pub(in crate::window) noise: &'a [(u32, Noise)],
    /// Seconds of rendering so far.
    pub(in crate::window) seconds: f64,
    /// Whether samples are still being added.
    pub(in crate::window) is_rendering: bool,
}

/// Where rendering stops.
#[derive(Clone, Copy, Debug)]
struct Goal {
    samples: f64,
    percent: Option<f64>,
}

/// A figure of the graph.
#[derive(Clone, Copy, Debug)]
struct Point {
    samples: f64,
    noise: Noise,
}

impl Point {
    /// Where it is in the plot.
    fn place(&self) -> [f64; 2] {
        place(self.samples, self.noise.percent)
    }

    /// The noise to expect at so many samples.
    fn percent_at(&self, samples: f64) -> f64 {
        self.noise.percent_after(samples / self.samples)
    }

    /// The noise with its uncertainty taken off, or added: never 0.
    fn percent_less(&self, errors: f64) -> f64 {
        self.noise.percent * (1.0 - errors * self.noise.uncertainty.min(0.9))
    }

    fn told(&self) -> String {
        format!("{} at {} samples", noise_text(self.noise), short(self.samples))
    }
}

/// Where a figure goes in the plot.
fn place(samples: f64, percent: f64) -> [f64; 2] {
    [samples.max(1.0).log10(), percent.max(1e-9).log10()]
}

/// Graph and outlook; `goal_samples` and `goal_percent` are where rendering stops. As high before
/// the first estimate as after it, so that nothing below it moves when a picture begins anew.
pub(super) fn convergence_ui(
    ui: &mut Ui,
    convergence: &Convergence<'_>,
    goal_samples: u32,
    goal_percent: Option<f64>,
) {
    let points: Vec<Point> = convergence
        .noise
        .iter()
        .map(|(samples, noise)| Point { samples: f64::from(*samples), noise: *noise })
        .filter(|point| 0.0 < point.noise.percent)
        .collect();
    let goal = Goal { samples: f64::from(goal_samples), percent: goal_percent };
    let response = egui::Frame::new()
        .fill(ui.visuals().extreme_bg_color)
        .corner_radius(4)
        .inner_margin(Margin { left: 2, right: 12, top: 8, bottom: 4 })
        .show(ui, |ui| graph(ui, &points, goal, convergence.is_rendering))
        .inner;
    let both = match (points.first(), points.last()) {
        (Some(first), Some(last)) => format!("noise {}, {}", first.told(), last.told()),
        _ => "noise, not known yet".to_owned(),
    };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &both));
    ui.label(outlook(convergence, goal_percent));
}

fn graph(ui: &mut Ui, points: &[Point], goal: Goal, is_rendering: bool) -> egui::Response {
    let (across, up) = spans(points, goal);
    let look = Look::of(ui);
    let font = TextStyle::Small.resolve(ui.style());
    let axis =
        |axis: AxisHints<'static>| axis.tick_label_color(look.quiet).tick_label_font(font.clone());
    let marks = |range: &RangeInclusive<f64>, most| {
        let length = range.end() - range.start();
        // As far apart as the axis is long: each tick is drawn, and as strong as the others.
        let mark = move |value: f64| GridMark { value: value.log10(), step_size: length };
        ticks(range, most).into_iter().map(mark).collect::<Vec<_>>()
    };
    let (columns, rows) = (marks(&across, 6), marks(&up, 5));
    let samples_of = |mark: GridMark, _: &RangeInclusive<f64>| short(10.0_f64.powf(mark.value));
    let percent_of =
        move |mark: GridMark, range: &RangeInclusive<f64>| samples_of(mark, range) + " %";
    let near = |samples: f64| {
        let away = |point: &Point| (point.place()[0] - samples).abs();
        points.iter().min_by(|a, b| away(a).total_cmp(&away(b)))
    };
    Plot::new("noise by samples")
        .height(HEIGHT)
        .sense(Sense::hover())
        .allow_axis_zoom_drag(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .allow_drag(false)
        .allow_scroll(false)
        .allow_zoom(false)
        .show_background(false)
        .show_crosshair(false)
        .grid_color(look.grid)
        .grid_fade(0.0)
        .x_grid_spacer(move |_| columns.clone())
        .y_grid_spacer(move |_| rows.clone())
        .custom_x_axes(vec![axis(AxisHints::new_x()).formatter(samples_of)])
        .custom_y_axes(vec![axis(AxisHints::new_y()).formatter(percent_of).min_thickness(LEFT)])
        .label_formatter(move |at| {
            let (HoverPosition::NearDataPoint { position, .. }
            | HoverPosition::Elsewhere { position }) = at;
            near(position.x).map(Point::told)
        })
        .show(ui, |plot| {
            plot.set_plot_bounds_x(across);
            plot.set_plot_bounds_y(up);
            draw_goal(plot, goal, &look);
            draw_course(plot, points, goal, is_rendering, &look);
            let hovered = plot.response().hover_pos().map(|at| plot.plot_from_screen(at));
            if let Some(point) = hovered.and_then(|at| near(at.x)) {
                let marker = Points::new("under the cursor", vec![point.place()]);
                plot.points(marker.radius(4.5).color(look.strong).filled(false).allow_hover(false));
            }
        })
        .response
}

/// Logarithms of the samples and of the percentages that the plot shows.
fn spans(points: &[Point], goal: Goal) -> (RangeInclusive<f64>, RangeInclusive<f64>) {
    let last = points.last();
    let right = goal.samples.max(last.map_or(1.0, |last| last.samples)).max(4.0);
    let expected = last.map(|last| last.percent_at(right));
    let noise = points.iter().map(|point| point.noise.percent).chain(expected);
    let noise = noise.chain(goal.percent.filter(|goal| 1e-3 < *goal));
    let (low, high) = noise.fold((f64::MAX, f64::MIN), |(low, high), percent| {
        (low.min(percent.log10()), high.max(percent.log10()))
    });
    // From 1 % to 100 % where nothing is known.
    let (low, high) = if low <= high { (low, high) } else { (0.0, 2.0) };
    // At least half a decade, so that little noise in the noise is no mountain.
    let air = ((0.5 - (high - low)) / 2.0).max(0.06);
    // Room for the dot at the end.
    let margin = right.log10() * 0.015;
    (-margin..=right.log10() + margin, low - air..=high + air)
}

/// The colours of the plot.
struct Look {
    accent: Color32,
    grid: Color32,
    quiet: Color32,
    strong: Color32,
}

impl Look {
    fn of(ui: &Ui) -> Self {
        let visuals = ui.visuals();
        Self {
            accent: theme::accent(visuals),
            grid: theme::hairline(visuals).color.gamma_multiply(0.6),
            quiet: visuals.weak_text_color(),
            strong: visuals.strong_text_color(),
        }
    }
}

/// Where rendering stops: a line for the samples, one for the noise.
fn draw_goal(plot: &mut PlotUi<'_>, goal: Goal, look: &Look) {
    let style = LineStyle::Dashed { length: 3.0 };
    let [x, y] = place(goal.samples, goal.percent.unwrap_or(1.0));
    plot.vline(VLine::new("samples", x).color(look.quiet).style(style).allow_hover(false));
    if goal.percent.is_some() {
        plot.hline(HLine::new("noise", y).color(look.quiet).style(style).allow_hover(false));
    }
}

/// What was measured, between the limits of its uncertainty, and how it should go on.
fn draw_course(
    plot: &mut PlotUi<'_>,
    points: &[Point],
    goal: Goal,
    is_rendering: bool,
    look: &Look,
) {
    let Some(last) = points.last() else { return };
    let limit = |errors| -> Vec<f64> {
        points.iter().map(|point| place(1.0, point.percent_less(errors))[1]).collect()
    };
    let across: Vec<f64> = points.iter().map(|point| point.place()[0]).collect();
    let band = FilledArea::new("uncertainty", &across, &limit(1.0), &limit(-1.0));
    let edge = egui::Stroke::new(0.75, look.accent.gamma_multiply(0.55));
    plot.add(band.fill_color(look.accent.gamma_multiply(0.3)).stroke(edge).allow_hover(false));
    if is_rendering && last.samples < goal.samples {
        let then = place(goal.samples, last.percent_at(goal.samples));
        let expected = Line::new("expected", vec![last.place(), then]);
        let style = LineStyle::Dotted { spacing: 5.0 };
        let faint = look.accent.gamma_multiply(0.6);
        plot.line(expected.color(faint).width(1.5).style(style).allow_hover(false));
    }
    let course: Vec<[f64; 2]> = points.iter().map(Point::place).collect();
    plot.line(Line::new("course", course).color(look.strong).width(1.25).allow_hover(false));
    let dot = Points::new("now", vec![last.place()]);
    plot.points(dot.color(look.strong).radius(3.0).allow_hover(false));
}

/// Round figures between two logarithms: powers of ten, with 2 and 5 between them where `most` of
/// them have room.
fn ticks(range: &RangeInclusive<f64>, most: usize) -> Vec<f64> {
    let (low, high) = (*range.start(), *range.end());
    let decades = low.floor() as i32..=high.ceil() as i32;
    let inside = |steps: &[f64]| -> Vec<f64> {
        let all = decades.clone().flat_map(|decade| {
            steps.iter().map(move |step| step * 10.0_f64.powi(decade)).collect::<Vec<_>>()
        });
        all.filter(|tick| (low - 1e-9..=high + 1e-9).contains(&tick.log10())).collect()
    };
    [&[1.0, 2.0, 5.0][..], &[1.0, 3.0], &[1.0]]
        .into_iter()
        .map(inside)
        .find(|ticks| ticks.len() <= most)
        .unwrap_or_else(|| {
            let all = inside(&[1.0]);
            let step = all.len().div_ceil(most.max(1));
            all.into_iter().step_by(step).collect()
        })
}

/// "2.1 ± 0.2 % now, 1 % in about 40 s", at the pace and with the gain of the samples so far. The
/// figure to come is the goal where there is one ahead, else the next power of ten.
fn outlook(convergence: &Convergence<'_>, goal_percent: Option<f64>) -> String {
    let last = convergence.noise.last().filter(|(_, noise)| 0.0 < noise.percent);
    let Some((_, noise)) = last.copied() else {
        let told = if convergence.is_rendering {
            "noise: known after a few samples"
        } else {
            "noise: not known"
        };
        return told.to_owned();
    };
    if !convergence.is_rendering {
        return format!("{} after {}", noise_text(noise), duration(convergence.seconds));
    }
    let now = noise.percent;
    let mut next = 10.0_f64.powf(now.log10().floor());
    if now < next * 1.05 {
        next /= 10.0;
    }
    let next = goal_percent.filter(|goal| *goal < now).unwrap_or(next);
    let more = convergence.seconds * (noise.samples_to(next) - 1.0);
    format!("{} now, {} in about {}", noise_text(noise), percent_text(next), duration(more))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Course;

    /// After eight samples.
    fn told(noise: Noise, seconds: f64, is_rendering: bool, goal: Option<f64>) -> String {
        outlook(&Convergence { noise: &[(8, noise)], seconds, is_rendering }, goal)
    }

    fn noise(percent: f64, ratio: f64) -> Noise {
        Noise { percent, uncertainty: 0.1, course: Course::even(ratio) }
    }

    #[test]
    fn a_tenth_of_the_noise_takes_a_hundred_times_as_long_at_random() {
        let expected = "10 ± 1 % now, 1 % in about 3 min 18 s";
        assert_eq!(told(noise(10.0, 0.5), 2.0, true, None), expected, "another outlook");
        let expected = "2.0 ± 0.2 % now, 1 % in about 30 s";
        assert_eq!(told(noise(2.0, 0.5), 10.0, true, None), expected, "another outlook");
    }

    #[test]
    fn what_falls_faster_is_there_sooner() {
        // A quarter of the squared error at double the samples: ten times as many for a tenth.
        let expected = "10 ± 1 % now, 1 % in about 18 s";
        assert_eq!(told(noise(10.0, 0.25), 2.0, true, None), expected, "another outlook");
    }

    #[test]
    fn the_outlook_is_to_the_goal_and_done_promises_nothing() {
        let now = noise(10.0, 0.5);
        let expected = "10 ± 1 % now, 5 % in about 6 s";
        assert_eq!(told(now, 2.0, true, Some(5.0)), expected, "not to the goal");
        let expected = "10 ± 1 % after 2 s";
        assert_eq!(told(now, 2.0, false, Some(5.0)), expected, "done, yet a promise");
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(ticks(&(0.0..=1.0), 5), [1.0, 2.0, 5.0, 10.0], "one decade");
        assert_eq!(ticks(&(-1.0..=2.0), 5), [0.1, 1.0, 10.0, 100.0], "three decades");
        assert!(ticks(&(0.0..=6.0), 6).len() <= 6, "too many for six decades");
    }

    #[test]
    fn both_axes_are_logarithmic_and_hold_the_goals() {
        let points = [(1.0, 80.0), (16.0, 20.0)]
            .map(|(samples, percent)| Point { samples, noise: noise(percent, 0.5) });
        let [a, b, c] = [(1.0, 80.0), (4.0, 40.0), (16.0, 20.0)].map(|(x, y)| place(x, y));
        for axis in [0, 1] {
            let (first, second) = (b[axis] - a[axis], c[axis] - b[axis]);
            assert!((first - second).abs() < 1e-9, "{first} and {second} for equal ratios");
        }
        let (across, up) = spans(&points, Goal { samples: 256.0, percent: Some(1.0) });
        let [x, y] = place(256.0, 1.0);
        assert!(across.contains(&x) && up.contains(&y), "{x}, {y} is out of sight");
        let (_, up) = spans(&[], Goal { samples: 256.0, percent: None });
        assert!(up.contains(&0.0) && up.contains(&2.0), "nothing is known: {up:?}");
    }
}

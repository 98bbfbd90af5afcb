//! How the noise falls: a graph of noise against samples, both logarithmic, and when the next round
//! figure is reached.
//!
//! Drawn here rather than by a plotting crate: those have linear axes, so that ticks, grid and
//! points would have to be made logarithmic by hand all the same.

use crate::render::Noise;
use crate::window::figures::{duration, noise_text, percent_text, short};
use crate::window::theme;
use egui::{Align2, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Ui, Vec2, pos2};

/// Height of the graph in points.
const HEIGHT: f32 = 148.0;
/// Room for the figures on the left and below.
const MARGIN: Vec2 = Vec2::new(38.0, 18.0);
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

/// A figure of the graph.
#[derive(Clone, Copy, Debug)]
struct Point {
    samples: f64,
    noise: Noise,
}

impl Point {
    /// The noise to expect at so many samples.
    fn percent_at(&self, samples: f64) -> f64 {
        self.noise.percent_after(samples / self.samples)
    }

    /// The noise with its uncertainty taken off, or added: never 0.
    fn percent_less(&self, errors: f64) -> f64 {
        self.noise.percent * (1.0 - errors * self.noise.uncertainty.min(0.9))
    }
}

/// Graph and outlook; `goal_samples` and `goal_percent` are where rendering stops.
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
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
    let (rect, response) =
        ui.allocate_exact_size(Vec2::new(ui.available_width(), HEIGHT), Sense::hover());
    let told =
        |point: &Point| format!("{} at {} samples", noise_text(point.noise), short(point.samples));
    let both = format!("noise {}, {}", told(first), told(last));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &both));
    let axes = Axes::new(rect, &points, f64::from(goal_samples), goal_percent);
    axes.draw_grid(ui, rect);
    axes.draw_goals(ui, f64::from(goal_samples), goal_percent);
    axes.draw_course(ui, &points, f64::from(goal_samples), convergence.is_rendering);
    if let Some(at) = response.hover_pos().filter(|at| axes.area.contains(*at)) {
        let nearest = points.iter().min_by(|a, b| {
            let away = |point: &Point| (axes.of(point).x - at.x).abs();
            away(a).total_cmp(&away(b))
        });
        if let Some(point) = nearest {
            let marker = Stroke::new(1.5, ui.visuals().strong_text_color());
            ui.painter().circle_stroke(axes.of(point), 4.0, marker);
            response.on_hover_text_at_pointer(told(point));
        }
    }
    ui.label(outlook(convergence, goal_percent));
}

/// Where figures go in the graph.
struct Axes {
    area: Rect,
    /// Logarithms (base 10) of samples at the left and right edge.
    x: (f64, f64),
    /// Logarithms (base 10) of percent at the bottom and top edge.
    y: (f64, f64),
}

impl Axes {
    fn new(rect: Rect, points: &[Point], goal: f64, goal_percent: Option<f64>) -> Self {
        let area = Rect::from_min_max(
            rect.min + Vec2::new(MARGIN.x, 8.0),
            rect.max - Vec2::new(10.0, MARGIN.y),
        );
        let last_samples = points.last().map_or(1.0, |last| last.samples);
        let right = goal.max(last_samples).max(4.0);
        let expected = points.last().map(|last| last.percent_at(right));
        let noise = points.iter().map(|point| point.noise.percent).chain(expected);
        let noise = noise.chain(goal_percent.filter(|goal| 1e-3 < *goal));
        let (low, high) = noise.fold((f64::MAX, f64::MIN), |(low, high), percent| {
            (low.min(percent.log10()), high.max(percent.log10()))
        });
        // At least half a decade, so that little noise in the noise is no mountain.
        let air = ((0.5 - (high - low)) / 2.0).max(0.06);
        Self { area, x: (0.0, right.log10()), y: (low - air, high + air) }
    }

    fn at(&self, samples: f64, percent: f64) -> Pos2 {
        let share = |value: f64, (low, high): (f64, f64)| {
            ((value.log10() - low) / (high - low).max(1e-9)).clamp(0.0, 1.0) as f32
        };
        let (x, y) = (share(samples.max(1.0), self.x), share(percent.max(1e-9), self.y));
        pos2(self.area.left() + x * self.area.width(), self.area.bottom() - y * self.area.height())
    }

    fn of(&self, point: &Point) -> Pos2 {
        self.at(point.samples, point.noise.percent)
    }

    fn draw_grid(&self, ui: &Ui, rect: Rect) {
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
        let font = TextStyle::Small.resolve(ui.style());
        let (quiet, line) = (ui.visuals().weak_text_color(), theme::hairline(ui.visuals()));
        let line = Stroke::new(1.0, line.color.gamma_multiply(0.6));
        for percent in ticks(self.y, 5) {
            let y = self.at(1.0, percent).y;
            painter.hline(self.area.x_range(), y, line);
            let at = pos2(self.area.left() - 5.0, y);
            painter.text(
                at,
                Align2::RIGHT_CENTER,
                format!("{} %", short(percent)),
                font.clone(),
                quiet,
            );
        }
        for samples in ticks(self.x, 6).into_iter().filter(|samples| 1.0 <= *samples) {
            let x = self.at(samples, 1.0).x;
            painter.vline(x, self.area.y_range(), line);
            let at = pos2(x, self.area.bottom() + 3.0);
            painter.text(at, Align2::CENTER_TOP, short(samples), font.clone(), quiet);
        }
    }

    /// Where rendering stops: a line for the samples, one for the noise.
    fn draw_goals(&self, ui: &Ui, goal_samples: f64, goal_percent: Option<f64>) {
        let stroke = Stroke::new(1.0, ui.visuals().weak_text_color());
        let x = self.at(goal_samples, 1.0).x;
        let painter = ui.painter();
        let (top, bottom) = (pos2(x, self.area.top()), pos2(x, self.area.bottom()));
        painter.extend(Shape::dashed_line(&[top, bottom], stroke, 3.0, 3.0));
        if let Some(percent) = goal_percent {
            let y = self.at(1.0, percent).y;
            let ends = [pos2(self.area.left(), y), pos2(self.area.right(), y)];
            painter.extend(Shape::dashed_line(&ends, stroke, 3.0, 3.0));
        }
    }

    /// What was measured, between the limits of its uncertainty, and how it should go on.
    fn draw_course(&self, ui: &Ui, points: &[Point], goal: f64, is_rendering: bool) {
        let accent = theme::accent(ui.visuals());
        let painter = ui.painter();
        let Some(last) = points.last() else { return };
        for pair in points.windows(2) {
            let limit = |point: &Point, errors| self.at(point.samples, point.percent_less(errors));
            let band = [
                limit(&pair[0], 1.0),
                limit(&pair[1], 1.0),
                limit(&pair[1], -1.0),
                limit(&pair[0], -1.0),
            ];
            let faint = accent.gamma_multiply(0.3);
            painter.add(Shape::convex_polygon(band.to_vec(), faint, Stroke::NONE));
        }
        for errors in [1.0, -1.0] {
            let limit = |point: &Point| self.at(point.samples, point.percent_less(errors));
            let edge = Stroke::new(0.75, accent.gamma_multiply(0.55));
            painter.line(points.iter().map(limit).collect(), edge);
        }
        if is_rendering && last.samples < goal {
            let then = self.at(goal, last.percent_at(goal));
            let faint = Stroke::new(1.5, accent.gamma_multiply(0.5));
            painter.extend(Shape::dashed_line(&[self.of(last), then], faint, 2.0, 4.0));
        }
        let course = points.iter().map(|point| self.of(point)).collect();
        painter.line(course, Stroke::new(1.25, ui.visuals().strong_text_color()));
        painter.circle_filled(self.of(last), 3.0, ui.visuals().strong_text_color());
    }
}

/// Round figures between two logarithms: powers of ten, with 2 and 5 between them where `most` of
/// them have room.
fn ticks((low, high): (f64, f64), most: usize) -> Vec<f64> {
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
        return String::new();
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

    /// After eight samples.
    fn told(noise: Noise, seconds: f64, is_rendering: bool, goal: Option<f64>) -> String {
        outlook(&Convergence { noise: &[(8, noise)], seconds, is_rendering }, goal)
    }

    fn noise(percent: f64, ratio: f64) -> Noise {
        Noise { percent, uncertainty: 0.1, ratio, step: None }
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
        assert_eq!(ticks((0.0, 1.0), 5), [1.0, 2.0, 5.0, 10.0], "one decade");
        assert_eq!(ticks((-1.0, 2.0), 5), [0.1, 1.0, 10.0, 100.0], "three decades");
        assert!(ticks((0.0, 6.0), 6).len() <= 6, "too many for six decades");
    }

    #[test]
    fn both_axes_are_logarithmic() {
        let rect = Rect::from_min_size(Pos2::ZERO, Vec2::new(300.0, HEIGHT));
        let points = [(1.0, 80.0), (16.0, 20.0)]
            .map(|(samples, percent)| Point { samples, noise: noise(percent, 0.5) });
        let axes = Axes::new(rect, &points, 256.0, Some(1.0));
        let [a, b, c] = [(1.0, 80.0), (4.0, 40.0), (16.0, 20.0)].map(|(x, y)| axes.at(x, y));
        let (first, second) = (b - a, c - b);
        assert!((first - second).length() < 0.01, "{first:?} and {second:?} for equal ratios");
        assert!(axes.area.contains(axes.at(256.0, 1.0)), "the goals are out of sight");
    }
}

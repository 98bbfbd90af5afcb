//! How the noise falls: a graph of noise against samples, both logarithmic, and when the next round
//! figure is reached.
//!
//! Drawn here rather than by a plotting crate: those have linear axes, so that ticks, grid and
//! points would have to be made logarithmic by hand all the same.

use crate::window::status::duration;
use crate::window::theme;
use crate::window::widgets::short;
use egui::{Align2, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Ui, Vec2, pos2};

/// Height of the graph in points.
const HEIGHT: f32 = 124.0;
/// Room for the figures on the left and below.
const MARGIN: Vec2 = Vec2::new(38.0, 18.0);
/// Independent samples: half the noise for four times as many.
const SLOPE: f64 = -0.5;

/// What the graph shows.
#[derive(Clone, Copy, Debug)]
pub(in crate::window) struct Convergence<'a> {
    /// (samples, noise in percent), in order of samples.
    pub(in crate::window) noise: &'a [(u32, f64)],
    /// Seconds of rendering so far.
    pub(in crate::window) seconds: f64,
    /// Whether samples are still being added.
    pub(in crate::window) is_rendering: bool,
}

/// Graph and outlook; `goal_samples` and `goal_percent` are where rendering stops.
pub(super) fn convergence_ui(
    ui: &mut Ui,
    convergence: &Convergence<'_>,
    goal_samples: u32,
    goal_percent: Option<f64>,
) {
    let points: Vec<(f64, f64)> = convergence
        .noise
        .iter()
        .map(|(samples, percent)| (f64::from(*samples), *percent))
        .filter(|(_, percent)| 0.0 < *percent)
        .collect();
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
    let (rect, response) =
        ui.allocate_exact_size(Vec2::new(ui.available_width(), HEIGHT), Sense::hover());
    let told = format!(
        "noise {} at {} samples, {} at {}",
        percent_text(first.1),
        short(first.0),
        percent_text(last.1),
        short(last.0)
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &told));
    let axes = Axes::new(rect, &points, f64::from(goal_samples), goal_percent);
    axes.draw_grid(ui, rect);
    axes.draw_goals(ui, f64::from(goal_samples), goal_percent);
    axes.draw_course(ui, &points, f64::from(goal_samples), convergence.is_rendering);
    if let Some(at) = response.hover_pos().filter(|at| axes.area.contains(*at)) {
        let nearest = points.iter().min_by(|a, b| {
            let away = |point: &(f64, f64)| (axes.at(point.0, point.1).x - at.x).abs();
            away(a).total_cmp(&away(b))
        });
        if let Some(&(samples, percent)) = nearest {
            let marker = Stroke::new(1.5, ui.visuals().strong_text_color());
            ui.painter().circle_stroke(axes.at(samples, percent), 4.0, marker);
            let told = format!("{} at {} samples", percent_text(percent), short(samples));
            response.on_hover_text_at_pointer(told);
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
    fn new(rect: Rect, points: &[(f64, f64)], goal: f64, goal_percent: Option<f64>) -> Self {
        let area = Rect::from_min_max(
            rect.min + Vec2::new(MARGIN.x, 8.0),
            rect.max - Vec2::new(10.0, MARGIN.y),
        );
        let last = points.last().copied().unwrap_or((1.0, 1.0));
        let right = goal.max(last.0).max(4.0);
        let expected = last.1 * (right / last.0).powf(SLOPE);
        let noise = points.iter().map(|(_, percent)| *percent).chain([expected]);
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

    /// What was measured, and how it should go on.
    fn draw_course(&self, ui: &Ui, points: &[(f64, f64)], goal: f64, is_rendering: bool) {
        let accent = theme::accent(ui.visuals());
        let painter = ui.painter();
        let course: Vec<Pos2> = points.iter().map(|point| self.at(point.0, point.1)).collect();
        let Some((now, (samples, percent))) = course.last().copied().zip(points.last().copied())
        else {
            return;
        };
        if is_rendering && samples < goal {
            let then = self.at(goal, percent * (goal / samples).powf(SLOPE));
            let faint = Stroke::new(1.5, accent.gamma_multiply(0.5));
            painter.extend(Shape::dashed_line(&[now, then], faint, 2.0, 4.0));
        }
        painter.line(course, Stroke::new(2.0, accent));
        painter.circle_filled(now, 3.5, accent);
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

/// "2.1 % now, 1 % in about 40 s": noise falls with the square root of the time. The figure to come
/// is the goal where there is one ahead, else the next power of ten.
fn outlook(convergence: &Convergence<'_>, goal_percent: Option<f64>) -> String {
    let Some((_, now)) = convergence.noise.last().copied().filter(|(_, now)| 0.0 < *now) else {
        return String::new();
    };
    if !convergence.is_rendering {
        return format!("{} after {}", percent_text(now), duration(convergence.seconds));
    }
    let mut next = 10.0_f64.powf(now.log10().floor());
    if now < next * 1.05 {
        next /= 10.0;
    }
    let next = goal_percent.filter(|goal| *goal < now).unwrap_or(next);
    let more = convergence.seconds * ((now / next).powi(2) - 1.0);
    format!("{} now, {} in about {}", percent_text(now), percent_text(next), duration(more))
}

/// Two significant digits: the estimate is no better.
fn percent_text(percent: f64) -> String {
    let magnitude = percent.abs().max(1e-9).log10().floor();
    let decimals = (1.0 - magnitude).clamp(0.0, 8.0) as usize;
    let text = format!("{percent:.decimals$}");
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} %")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(noise: &[(u32, f64)], seconds: f64, is_rendering: bool, goal: Option<f64>) -> String {
        outlook(&Convergence { noise, seconds, is_rendering }, goal)
    }

    #[test]
    fn a_tenth_of_the_noise_takes_a_hundred_times_as_long() {
        let course = [(1, 50.0), (16, 10.0)];
        let expected = "10 % now, 1 % in about 3 min 18 s";
        assert_eq!(told(&course, 2.0, true, None), expected, "another outlook");
        let expected = "2 % now, 1 % in about 30 s";
        assert_eq!(told(&[(4, 2.0)], 10.0, true, None), expected, "another outlook");
    }

    #[test]
    fn the_outlook_is_to_the_goal_and_done_promises_nothing() {
        let course = [(16, 10.0)];
        let expected = "10 % now, 5 % in about 6 s";
        assert_eq!(told(&course, 2.0, true, Some(5.0)), expected, "not to the goal");
        let expected = "10 % after 2 s";
        assert_eq!(told(&course, 2.0, false, Some(5.0)), expected, "done, yet a promise");
    }

    #[test]
    fn percentages_have_two_digits() {
        for (percent, text) in
            [(9.804, "9.8 %"), (212.7, "213 %"), (1.0, "1 %"), (0.0123, "0.012 %")]
        {
            assert_eq!(percent_text(percent), text, "for {percent}");
        }
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
        let axes = Axes::new(rect, &[(1.0, 80.0), (16.0, 20.0)], 256.0, Some(1.0));
        let [a, b, c] = [(1.0, 80.0), (4.0, 40.0), (16.0, 20.0)].map(|(x, y)| axes.at(x, y));
        let (first, second) = (b - a, c - b);
        assert!((first - second).length() < 0.01, "{first:?} and {second:?} for equal ratios");
        assert!(axes.area.contains(axes.at(256.0, 1.0)), "the goals are out of sight");
    }
}

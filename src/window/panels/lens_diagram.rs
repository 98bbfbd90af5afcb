//! A small side view of the lens: what is sharp, and how the rays of a far point spread.

use crate::scene::description::CameraDescription;
use crate::scene::orbit;
use crate::window::figures::short;
use crate::window::theme;
use egui::{Align2, Color32, Pos2, Rect, Sense, Stroke, TextStyle, Ui, Vec2, pos2};

/// Draws the axis from the lens to beyond the focus, the sharp slice, and two rays to the focus.
pub(super) fn lens_diagram(
    ui: &mut Ui,
    camera: &CameraDescription,
    (near, far): (f64, Option<f64>),
) {
    let size = Vec2::new(ui.available_width(), 76.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let described = describe(camera, near, far);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &described));
    response.on_hover_text(described);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);

    let focus = orbit::focal_distance(camera);
    // Below it there is room for a line of text.
    let area =
        Rect::from_min_max(rect.min + Vec2::new(14.0, 10.0), rect.max - Vec2::new(14.0, 20.0));
    let plot = Plot::new(area, focus);
    let accent = theme::accent(ui.visuals());
    let line = Stroke::new(1.0, ui.visuals().weak_text_color());
    let font = TextStyle::Small.resolve(ui.style());

    // The sharp slice.
    let left = plot.x(near).max(plot.lens.x);
    let right = far.map_or(plot.area.right(), |far| plot.x(far));
    let slice = Rect::from_x_y_ranges(left..=right.max(left + 1.0), plot.area.y_range());
    painter.rect_filled(slice, 0.0, faded(accent, 40));
    // The axis, the lens and the cone of rays that meet in the focus.
    painter.hline(plot.area.x_range(), plot.lens.y, line);
    let opening = plot.opening(camera, focus);
    let top = plot.lens - Vec2::new(0.0, opening);
    let bottom = plot.lens + Vec2::new(0.0, opening);
    let spot = pos2(plot.x(focus), plot.lens.y);
    for edge in [top, bottom] {
        painter
            .line_segment([edge, beyond(edge, spot, plot.area.right())], Stroke::new(1.0, accent));
    }
    painter.line_segment([top, bottom], Stroke::new(3.0, ui.visuals().strong_text_color()));
    painter.vline(spot.x, plot.area.y_range(), Stroke::new(1.5, accent));
    // Distances.
    let quiet = ui.visuals().weak_text_color();
    let label = |at: Pos2, align, text: String, color| {
        painter.text(at, align, text, font.clone(), color);
    };
    label(pos2(spot.x + 4.0, rect.top() + 4.0), Align2::LEFT_TOP, short(focus), accent);
    if camera.aperture_radius > 0.0 {
        let text = match far {
            Some(far) => format!("sharp {} – {}", short(near), short(far)),
            None => format!("sharp from {}", short(near)),
        };
        label(rect.left_bottom() + Vec2::new(8.0, -4.0), Align2::LEFT_BOTTOM, text, quiet);
    } else {
        let text = "sharp everywhere".to_owned();
        label(rect.left_bottom() + Vec2::new(8.0, -4.0), Align2::LEFT_BOTTOM, text, quiet);
    }
}

/// Where distances go in the drawing: the focus at 55 % of the width, infinity at its end.
struct Plot {
    area: Rect,
    lens: Pos2,
    focus: f64,
}

impl Plot {
    fn new(area: Rect, focus: f64) -> Self {
        Self { area, lens: pos2(area.left(), area.center().y), focus }
    }

    /// Monotonic: 0 at the lens, the focus a little past the middle, infinity at the end.
    fn x(&self, distance: f64) -> f32 {
        let share = distance / (distance + self.focus * 0.82);
        self.area.left() + self.area.width() * share as f32
    }

    /// Half the opening in points, exaggerated so that small lenses show.
    fn opening(&self, camera: &CameraDescription, focus: f64) -> f32 {
        let relative = (camera.aperture_radius / focus).max(0.0);
        let shown = (relative * 5.0).min(1.0).powf(0.6) as f32;
        (self.area.height() / 2.0 * shown).max(1.0)
    }
}

/// The point at `x` on the line from `a` through `b`.
fn beyond(a: Pos2, b: Pos2, x: f32) -> Pos2 {
    let slope = (b.y - a.y) / (b.x - a.x).max(1e-3);
    pos2(x, a.y + slope * (x - a.x))
}

fn faded(color: Color32, alpha: u8) -> Color32 {
    Color32::from_rgba_unmultiplied(color.r(), color.g(), color.b(), alpha)
}

fn describe(camera: &CameraDescription, near: f64, far: Option<f64>) -> String {
    let focus = short(orbit::focal_distance(camera));
    if camera.aperture_radius <= 0.0 {
        return format!("side view of the lens: closed, sharp everywhere, focus at {focus}");
    }
    let far = far.map_or("infinity".to_owned(), short);
    format!("side view of the lens: focus at {focus}, sharp from {} to {far}", short(near))
}

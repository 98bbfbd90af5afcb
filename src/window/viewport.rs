//! The picture: where it is drawn, and what the mouse does over it.

use super::navigation::{Navigation, is_flying};
use super::panels::{DisplayState, PickFor};
use super::scroll::scroll_bars;
use super::theme;
use crate::scene::description::CameraDescription;
use crate::scene::orbit;
use egui::{Color32, PointerButton, Pos2, Rect, Sense, Stroke, TextureHandle, Ui, Vec2, pos2};

/// Size of a picture pixel on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Zoom {
    /// The whole picture in the viewport, never larger than its pixels.
    #[default]
    Fit,
    /// One picture pixel on one screen pixel.
    Actual,
    /// One picture pixel on two by two screen pixels.
    Double,
}

/// A picture on the graphics card, and the size in pixels it stands for.
pub(super) struct Shown<'a> {
    /// The texture; a coarse preview has fewer pixels than the picture.
    pub(super) texture: &'a TextureHandle,
    /// Width and height of the picture in pixels.
    pub(super) size: [u32; 2],
}

/// What a click in the picture asks for, at a place in pixels of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Click {
    /// Use what is there for that purpose.
    For(PickFor, f32, f32),
    /// Turn the camera about what is there.
    TurnAbout(f32, f32),
    /// Choose what is there in the panel.
    Choose(f32, f32),
}

impl Click {
    /// Where it was.
    pub(super) fn at(self) -> (f32, f32) {
        let (Self::For(_, x, y) | Self::TurnAbout(x, y) | Self::Choose(x, y)) = self;
        (x, y)
    }
}

/// What happened over the viewport in this frame.
pub(super) struct ViewportOutput {
    /// Where it is, in points.
    pub(super) rect: Rect,
    /// Where the picture is, in points; it may reach beyond the viewport.
    pub(super) picture: Rect,
    /// A click that needs to know what is under the cursor.
    pub(super) click: Option<Click>,
    /// The picture pixel under the cursor.
    pub(super) hovered_pixel: Option<[u32; 2]>,
    /// Screen pixels per picture pixel, times 100.
    pub(super) zoom_percent: f64,
    /// Whether letters fly now instead of doing what the table says.
    pub(super) flying: bool,
}

/// Draws the picture in the rest of `ui` and moves the camera as the mouse says. `size` is that of
/// the picture being rendered; `shown` may still be an older one.
pub(super) fn viewport_ui(
    ui: &mut Ui,
    camera: &mut CameraDescription,
    navigation: &mut Navigation,
    shown: Option<&Shown<'_>>,
    size: [u32; 2],
    display: &mut DisplayState,
    picking: Option<PickFor>,
) -> ViewportOutput {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "Picture"));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, theme::SURROUND);

    let per_point = ui.pixels_per_point();
    let DisplayState { zoom, scroll, .. } = *display;
    let placed = picture_rect(rect, size, zoom, scroll, per_point);
    match shown {
        Some(shown) => {
            let at = picture_rect(rect, shown.size, zoom, scroll, per_point);
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            painter.image(shown.texture.id(), at, whole, Color32::WHITE);
        }
        None => waiting(ui, &painter, rect),
    }
    scroll_bars(ui, rect, placed.size(), &mut display.scroll);
    navigation.apply(ui, &response, camera, placed.height());
    if navigation.turning {
        pivot_cross(&painter, placed, camera, navigation);
    }
    if picking.is_some() {
        response.clone().on_hover_cursor(egui::CursorIcon::Crosshair);
    }

    let to_pixel = |at: Pos2| {
        let share = (at - placed.min) / placed.size();
        (share.x * size[0] as f32, share.y * size[1] as f32)
    };
    let click = response.interact_pointer_pos().filter(|at| placed.contains(*at)).and_then(|at| {
        let (x, y) = to_pixel(at);
        let command = ui.input(|input| input.modifiers.command);
        if response.double_clicked_by(PointerButton::Primary) && !command {
            Some(Click::TurnAbout(x, y))
        } else if response.clicked_by(PointerButton::Primary) && command {
            Some(Click::For(PickFor::Focus, x, y))
        } else if response.clicked_by(PointerButton::Primary) {
            Some(picking.map_or(Click::Choose(x, y), |purpose| Click::For(purpose, x, y)))
        } else {
            None
        }
    });
    let hovered_pixel = response.hover_pos().filter(|at| placed.contains(*at)).map(|at| {
        let (x, y) = to_pixel(at);
        [(x as u32).min(size[0] - 1), (y as u32).min(size[1] - 1)]
    });
    ViewportOutput {
        rect,
        picture: placed,
        click,
        hovered_pixel,
        zoom_percent: f64::from(placed.width() * per_point) / f64::from(size[0]) * 100.0,
        flying: is_flying(ui.ctx(), &response),
    }
}

/// Size in physical pixels of a viewport of that rectangle; at least one pixel.
pub(super) fn physical_size(rect: Rect, pixels_per_point: f32) -> [u32; 2] {
    let pixels = |points: f32| (points * pixels_per_point).round().clamp(1.0, 16384.0) as u32;
    [pixels(rect.width()), pixels(rect.height())]
}

/// Where a picture of that size goes: in the middle, or scrolled where it does not fit, its corner
/// on a screen pixel.
fn picture_rect(rect: Rect, size: [u32; 2], zoom: Zoom, scroll: Vec2, per_point: f32) -> Rect {
    let pixels = Vec2::new(size[0].max(1) as f32, size[1].max(1) as f32);
    let actual = pixels / per_point;
    let shown = match zoom {
        Zoom::Fit => {
            let fits = (rect.width() / actual.x).min(rect.height() / actual.y);
            // A picture that follows the window is off by less than a pixel: do not resample it.
            let near_actual = (actual - rect.size()).abs().max_elem() * per_point < 1.0;
            if near_actual || 1.0 < fits { actual } else { actual * fits }
        }
        Zoom::Actual => actual,
        Zoom::Double => actual * 2.0,
    };
    let room = rect.size() - shown;
    let share = |room: f32, scroll: f32| if room < 0.0 { scroll } else { 0.5 };
    let share = Vec2::new(share(room.x, scroll.x), share(room.y, scroll.y));
    let corner = rect.min + room * share;
    let snapped = (corner.to_vec2() * per_point).round() / per_point;
    Rect::from_min_size(snapped.to_pos2(), shown)
}

/// Shows the point the camera turns about.
fn pivot_cross(
    painter: &egui::Painter,
    placed: Rect,
    camera: &CameraDescription,
    navigation: &Navigation,
) {
    let (width, height) = (f64::from(placed.width()), f64::from(placed.height()));
    let Some((x, y, _)) = orbit::project(camera, navigation.pivot(camera), width, height) else {
        return;
    };
    let at = placed.min + Vec2::new(x as f32, y as f32);
    if !placed.contains(at) {
        return;
    }
    for (stroke, radius) in [
        (Stroke::new(3.0, Color32::from_black_alpha(120)), 7.0),
        (Stroke::new(1.0, Color32::WHITE), 6.0),
    ] {
        painter.circle_stroke(at, radius, stroke);
    }
    painter.circle_filled(at, 1.5, Color32::WHITE);
}

fn waiting(ui: &Ui, painter: &egui::Painter, rect: Rect) {
    painter.text(
        rect.center(),
        egui::Align2::CENTER_CENTER,
        "the first picture is on its way",
        egui::TextStyle::Body.resolve(ui.style()),
        Color32::from_gray(140),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: Rect = Rect { min: Pos2::new(10.0, 20.0), max: Pos2::new(810.0, 620.0) };

    const MIDDLE: Vec2 = Vec2::splat(0.5);

    #[test]
    fn a_large_picture_is_fitted_whole_and_keeps_its_shape() {
        let at = picture_rect(VIEW, [3200, 1800], Zoom::Fit, MIDDLE, 1.0);
        assert!(VIEW.expand(0.6).contains_rect(at), "{at:?} leaves {VIEW:?}");
        let aspect = at.width() / at.height();
        assert!((aspect - 16.0 / 9.0).abs() < 1e-4, "aspect {aspect}");
    }

    #[test]
    fn a_picture_that_follows_the_window_is_drawn_pixel_on_pixel() {
        for per_point in [1.0, 1.25, 1.5, 2.0] {
            let size = physical_size(VIEW, per_point);
            let at = picture_rect(VIEW, size, Zoom::Fit, MIDDLE, per_point);
            let pixels = at.width() * per_point;
            assert!(
                (pixels - size[0] as f32).abs() < 1e-3,
                "{pixels} of {} at {per_point}",
                size[0]
            );
            let corner = at.min.x * per_point;
            assert!((corner - corner.round()).abs() < 1e-3, "corner at {corner}");
        }
    }

    #[test]
    fn a_picture_that_does_not_fit_is_scrolled_from_edge_to_edge() {
        let at = |scroll| picture_rect(VIEW, [3200, 200], Zoom::Actual, scroll, 2.0);
        assert_eq!(at(Vec2::ZERO).left(), VIEW.left(), "not at its left edge");
        assert_eq!(at(Vec2::splat(1.0)).right(), VIEW.right(), "not at its right edge");
        assert_eq!(at(Vec2::ZERO).center().y, VIEW.center().y, "what fits is not in the middle");
    }

    #[test]
    fn double_size_is_twice_actual_size() {
        let one = picture_rect(VIEW, [400, 300], Zoom::Actual, MIDDLE, 2.0);
        let two = picture_rect(VIEW, [400, 300], Zoom::Double, MIDDLE, 2.0);
        assert_eq!((one.width(), two.width()), (200.0, 400.0), "other sizes");
    }
}

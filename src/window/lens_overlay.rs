//! The lens made visible: what is sharp, tinted in the picture, and lines where surfaces cross the
//! plane of focus and the limits of sharpness.

use super::background::Background;
use super::figures::short;
use super::panels::sharp_range;
use crate::render::{Feature, PixelMap};
use crate::scene::description::CameraDescription;
use crate::scene::orbit;
use egui::{Color32, ColorImage, Rect, TextureHandle, TextureOptions, Ui, Vec2, pos2};
use std::sync::Arc;

/// Where surfaces cross the plane of focus.
const FOCUS: Color32 = Color32::from_rgb(150, 255, 170);
/// Where they cross the near limit: as blue as the nearer side of the blur's scale.
const NEAR: Color32 = Color32::from_rgb(110, 170, 255);
/// Where they cross the far limit.
const FAR: Color32 = Color32::from_rgb(255, 170, 80);
/// Over everything that is sharp, of 255.
const TINT: u8 = 44;

/// The overlay on show and the thread that paints the next.
pub(super) struct LensOverlay {
    thread: Background<Order, ColorImage>,
    asked: Option<Order>,
    texture: Option<TextureHandle>,
}

#[derive(Clone)]
struct Order {
    map: Arc<PixelMap<Feature>>,
    planes: Planes,
}

/// Distances along the view, in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Planes {
    near: f64,
    focus: f64,
    /// `None` is infinity.
    far: Option<f64>,
}

impl Planes {
    fn of(camera: &CameraDescription) -> Self {
        let (near, far) = sharp_range(camera);
        Self { near, focus: orbit::focal_distance(camera), far }
    }
}

impl LensOverlay {
    /// Starts the thread; `wake` is called when an overlay is ready.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let thread = Background::new("lens", |order: Order| paint(&order.map, order.planes), wake)?;
        Ok(Self { thread, asked: None, texture: None })
    }

    /// Forgets what was shown: the next time begins anew.
    pub(super) fn hide(&mut self) {
        self.asked = None;
        self.texture = None;
    }

    /// Draws the overlay over `picture`, from the first hits of what is shown there.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        picture: Rect,
        clip: Rect,
        camera: &CameraDescription,
        features: Option<&Arc<PixelMap<Feature>>>,
    ) {
        let planes = Planes::of(camera);
        if let Some(map) = features {
            let is_same = |asked: &Order| Arc::ptr_eq(&asked.map, map) && asked.planes == planes;
            if !self.asked.as_ref().is_some_and(is_same) {
                let order = Order { map: Arc::clone(map), planes };
                self.asked = Some(order.clone());
                self.thread.order(order);
            }
        }
        // A result may still be that of an overlay which was hidden meanwhile.
        if let Some(image) = self.thread.take().filter(|_| self.asked.is_some()) {
            match &mut self.texture {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                None => {
                    let texture = ui.ctx().load_texture("lens", image, TextureOptions::LINEAR);
                    self.texture = Some(texture);
                }
            }
        }
        if let Some(texture) = &self.texture {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter_at(clip).image(texture.id(), picture, whole, Color32::WHITE);
        }
        key_ui(ui, clip, planes);
    }
}

/// What the lines mean, in the upper right corner of the viewport.
fn key_ui(ui: &mut Ui, viewport: Rect, planes: Planes) {
    let far = planes.far.map_or("infinity".to_owned(), short);
    let lines = [
        (NEAR, format!("sharp from {}", short(planes.near))),
        (FOCUS, format!("in focus at {}", short(planes.focus))),
        (FAR, format!("sharp up to {far}")),
    ];
    let line_height = 17.0;
    let size = Vec2::new(168.0, line_height * 3.0 + 12.0);
    let rect = Rect::from_min_size(viewport.right_top() + Vec2::new(-12.0 - size.x, 12.0), size);
    let told: Vec<&str> = lines.iter().map(|(_, text)| text.as_str()).collect();
    let told = format!("Lens: {}", told.join(", "));
    let response = ui.interact(rect, ui.scope_id().with("lens key"), egui::Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &told));
    let painter = ui.painter_at(viewport);
    painter.rect_filled(rect, egui::CornerRadius::same(6), Color32::from_black_alpha(190));
    for (index, (color, text)) in lines.into_iter().enumerate() {
        let y = rect.top() + 6.0 + line_height * (index as f32 + 0.5);
        let from = pos2(rect.left() + 10.0, y);
        painter.line_segment([from, from + Vec2::new(18.0, 0.0)], (2.0, color));
        painter.text(
            from + Vec2::new(26.0, 0.0),
            egui::Align2::LEFT_CENTER,
            text,
            egui::FontId::proportional(12.0),
            Color32::from_gray(225),
        );
    }
}

/// The overlay of a map: transparent but for what is sharp and for the lines.
///
/// Planes across the view are straight lines in 1 / depth, which on a flat surface changes evenly
/// from pixel to pixel: a line is where a plane is nearer than about a pixel's step.
fn paint(map: &PixelMap<Feature>, planes: Planes) -> ColorImage {
    let [near, focus] = [planes.near, planes.focus].map(|depth| 1.0 / depth);
    let far = planes.far.map_or(0.0, |far| 1.0 / far);
    let color = |x: u32, y: u32| {
        let Some(here) = map.get(x, y).filter(|feature| feature.depth.is_finite()) else {
            return Color32::TRANSPARENT;
        };
        let at = 1.0 / f64::from(here.depth);
        let step = step_at(map, x, y, here, at);
        // Opaque on the line, gone one and a half steps away.
        let nearness = |plane: f64| (1.6 - (at - plane).abs() / step).clamp(0.0, 1.0);
        let (mut line, mut strength) = (FOCUS, nearness(focus));
        for (color, plane) in [(NEAR, near), (FAR, far)] {
            let other = if 0.0 < plane && plane.is_finite() { nearness(plane) } else { 0.0 };
            if strength < other {
                (line, strength) = (color, other);
            }
        }
        let is_sharp = far <= at && at <= near;
        let tint = if is_sharp { TINT } else { 0 };
        let alpha = (strength * 255.0).round() as u8;
        if alpha <= tint {
            let [r, g, b, _] = FOCUS.to_array();
            return Color32::from_rgba_unmultiplied(r, g, b, tint);
        }
        let [r, g, b, _] = line.to_array();
        Color32::from_rgba_unmultiplied(r, g, b, alpha)
    };
    let places = (0..map.height).flat_map(|y| (0..map.width).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| color(x, y)).collect();
    ColorImage::new([map.width as usize, map.height as usize], pixels)
}

/// How much 1 / depth changes from this pixel to the next of the same thing: of the two neighbours
/// along each axis the more alike one, so that outlines draw no line.
fn step_at(map: &PixelMap<Feature>, x: u32, y: u32, here: &Feature, at: f64) -> f64 {
    let change = |x: Option<u32>, y: Option<u32>| {
        let other = map.get(x?, y?).filter(|other| other.seen == here.seen)?;
        Some((1.0 / f64::from(other.depth) - at).abs())
    };
    let least = |one: Option<f64>, other: Option<f64>| match (one, other) {
        (Some(one), Some(other)) => one.min(other),
        (one, other) => one.or(other).unwrap_or(0.0),
    };
    let across = least(change(x.checked_sub(1), Some(y)), change(x.checked_add(1), Some(y)));
    let down = least(change(Some(x), y.checked_sub(1)), change(Some(x), y.checked_add(1)));
    across.hypot(down).max(at * 1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Seen;

    /// A floor seen from above: depth grows evenly in 1 / depth from 10 at the top to 1 below.
    fn floor() -> PixelMap<Feature> {
        let (width, height) = (4, 100);
        let pixels = (0..width * height).map(|index| {
            let share = f64::from(index / width) / f64::from(height - 1);
            let depth = (1.0 / (0.1 + 0.9 * share)) as f32;
            Feature { seen: Seen::Object(0), depth, ..Feature::NOTHING }
        });
        PixelMap { width, height, pixels: pixels.collect() }
    }

    #[test]
    fn what_is_sharp_is_tinted_and_its_planes_are_lines() {
        let map = floor();
        let planes = Planes { near: 2.0, focus: 3.0, far: Some(5.0) };
        let image = paint(&map, planes);
        let mut rows_of = [0; 3];
        for y in 0..map.height {
            let depth = f64::from(map.get(1, y).unwrap().depth);
            let color = image.pixels[(y * map.width + 1) as usize];
            let is_sharp = planes.near < depth && depth < 5.0;
            if color.a() == TINT {
                assert!(is_sharp, "row {y} at {depth} is tinted");
            } else if color.a() == 0 {
                assert!(!is_sharp, "row {y} at {depth} is bare");
            } else {
                for (rows, plane) in rows_of.iter_mut().zip([2.0, 3.0, 5.0]) {
                    let is_near = (1.0 / depth - 1.0 / plane).abs() < 2.0 * 0.9 / 99.0;
                    *rows += u32::from(is_near);
                }
            }
        }
        assert!(rows_of.iter().all(|rows| (2..=4).contains(rows)), "lines of {rows_of:?} rows");
    }

    #[test]
    fn outlines_draw_no_line() {
        // One half at depth 1, the other at depth 9, as a ball before a wall of the same object.
        let pixels = (0..64).map(|index| {
            let depth = if index % 8 < 4 { 1.0 } else { 9.0 };
            Feature { seen: Seen::Object(0), depth, ..Feature::NOTHING }
        });
        let map = PixelMap { width: 8, height: 8, pixels: pixels.collect() };
        let image = paint(&map, Planes { near: 2.0, focus: 3.0, far: Some(5.0) });
        assert!(image.pixels.iter().all(|color| color.a() == 0), "an outline is a crossing");
    }
}

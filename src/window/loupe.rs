//! The loupe: the pixels under the cursor, large, with all that is known of the middle one.

use super::figures::short;
use super::status::{PixelUnderCursor, Probed};
use egui::{Color32, ColorImage, Grid, Pos2, Rect, RichText, Sense, Stroke, Ui, Vec2};

/// Pixels across; odd, so that one is in the middle.
const N_ACROSS: i32 = 15;
/// Side of a magnified pixel, in points.
const CELL: f32 = 12.0;
/// Height of a line of figures, in points.
const LINE: f32 = 17.0;
/// A key that is held so long is let go of; a shorter press leaves the loupe open.
const HELD_SECS: f64 = 0.35;

/// Whether the loupe is open, and the press that opened it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Loupe {
    pub(super) shown: bool,
    /// When its key went down, while it is down.
    pressed_at: Option<f64>,
}

impl Loupe {
    /// Its key was pressed, at a time in seconds: opens or closes it.
    pub(super) fn press(&mut self, now: f64) {
        self.shown = !self.shown;
        self.pressed_at = self.shown.then_some(now);
    }

    /// Looks whether its key is still down: a long press shows the loupe only as long as it lasts.
    pub(super) fn follow(&mut self, is_held: bool, now: f64) {
        if is_held {
            return;
        }
        if self.pressed_at.take().is_some_and(|since| HELD_SECS < now - since) {
            self.shown = false;
        }
    }
}

/// What the loupe shows.
pub(super) struct LoupeFacts<'a> {
    /// The bytes on show, maybe coarser than the picture.
    pub(super) image: &'a ColorImage,
    /// Size of the picture in pixels.
    pub(super) size: [u32; 2],
    /// The pixel under the cursor and its light.
    pub(super) pixel: PixelUnderCursor,
    /// What is behind it.
    pub(super) probed: Option<&'a Probed>,
}

/// Shows the loupe beside the cursor, inside the viewport.
pub(super) fn loupe_ui(ui: &mut Ui, viewport: Rect, cursor: Pos2, facts: &LoupeFacts<'_>) {
    let side = CELL * N_ACROSS as f32;
    let outer = Vec2::new(side + 16.0, side + 16.0 + 7.0 * LINE);
    let mut corner = cursor + Vec2::splat(24.0);
    if viewport.right() < corner.x + outer.x {
        corner.x = cursor.x - 24.0 - outer.x;
    }
    if viewport.bottom() < corner.y + outer.y {
        corner.y = (viewport.bottom() - outer.y - 8.0).max(viewport.top());
    }
    egui::Area::new(egui::Id::unique("loupe"))
        .order(egui::Order::Tooltip)
        .interactable(false)
        .fixed_pos(corner)
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(side);
                pixels_ui(ui, facts);
                ui.add_space(4.0);
                figures_ui(ui, facts);
            });
        });
}

fn pixels_ui(ui: &mut Ui, facts: &LoupeFacts<'_>) {
    let side = CELL * N_ACROSS as f32;
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Loupe"));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, super::theme::SURROUND);
    let half = N_ACROSS / 2;
    let [x, y] = facts.pixel.at.map(|at| at as i32);
    for row in 0..N_ACROSS {
        for column in 0..N_ACROSS {
            let Some(color) = color_at(facts, x + column - half, y + row - half) else { continue };
            let at = rect.min + Vec2::new(column as f32, row as f32) * CELL;
            painter.rect_filled(Rect::from_min_size(at, Vec2::splat(CELL)), 0.0, color);
        }
    }
    let middle = rect.min + Vec2::splat(half as f32 * CELL);
    let middle = Rect::from_min_size(middle, Vec2::splat(CELL));
    let outline = |rect: Rect, color| {
        let stroke = Stroke::new(1.0, color);
        painter.rect_stroke(rect, 0.0, stroke, egui::StrokeKind::Outside);
    };
    outline(middle.expand(1.0), Color32::BLACK);
    outline(middle, Color32::WHITE);
}

/// The byte colour of a picture pixel, from an image that may be coarser.
fn color_at(facts: &LoupeFacts<'_>, x: i32, y: i32) -> Option<Color32> {
    let [width, height] = facts.image.size;
    let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
    let [full_width, full_height] = facts.size.map(|side| side as usize);
    if full_width <= x || full_height <= y {
        return None;
    }
    let (column, row) = (x * width / full_width, y * height / full_height);
    facts.image.pixels.get(row * width + column).copied()
}

fn figures_ui(ui: &mut Ui, facts: &LoupeFacts<'_>) {
    let [x, y] = facts.pixel.at;
    let [r, g, b] = facts.pixel.linear;
    let mut lines =
        vec![("Pixel", format!("{x}, {y}")), ("Linear", format!("{r:.4} {g:.4} {b:.4}"))];
    if let Some(color) = color_at(facts, x as i32, y as i32) {
        let [r, g, b, _] = color.to_array();
        lines.push(("Shown", format!("#{r:02x}{g:02x}{b:02x}  {r} {g} {b}")));
    }
    if let Some(probed) = facts.probed {
        lines.push(("Object", probed.object.clone()));
        if !probed.material.is_empty() {
            lines.push(("Material", probed.material.clone()));
        }
        if probed.depth.is_finite() {
            lines.push(("Depth", short(probed.depth)));
        }
        lines.push(("Blur", format!("{:.1} px", probed.blur_px)));
    }
    ui.spacing_mut().interact_size.y = LINE - 2.0;
    Grid::new("loupe figures").num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        for (name, value) in lines {
            ui.label(RichText::new(name).weak().small());
            ui.add(egui::Label::new(RichText::new(value).small()).truncate());
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_press_stays_and_a_long_one_ends_when_let_go() {
        let mut loupe = Loupe::default();
        loupe.press(1.0);
        loupe.follow(true, 1.1);
        loupe.follow(false, 1.2);
        assert!(loupe.shown, "a short press closes it");
        loupe.press(2.0);
        loupe.follow(false, 9.0);
        assert!(!loupe.shown, "a second press leaves it open");
        loupe.press(10.0);
        loupe.follow(true, 10.9);
        assert!(loupe.shown, "closed while held");
        loupe.follow(false, 11.0);
        assert!(!loupe.shown, "a long press leaves it open");
    }
}

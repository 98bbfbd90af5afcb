//! Lights in the picture: a mark for each, which selects and moves it.

use super::{panels, theme};
use crate::scene::description::{LightDescription, LightKind, SceneDescription};
use crate::scene::orbit;
use egui::{Color32, Id, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2};

/// Size of what can be grabbed, in points.
const GRIP: f32 = 18.0;

/// Shows every light with a place, lets it be chosen and dragged along the plane of the picture.
pub(super) fn lights_in_picture(
    ui: &mut Ui,
    picture: Rect,
    clip: Rect,
    scene: &mut SceneDescription,
    selected: &mut usize,
) {
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    let camera = scene.camera.clone();
    for (index, light) in scene.lights.iter_mut().enumerate() {
        if light.kind == LightKind::Sun {
            continue;
        }
        let Some((x, y, depth)) = orbit::project(&camera, light.position, width, height) else {
            continue;
        };
        let at = picture.min + Vec2::new(x as f32, y as f32);
        let grip = Rect::from_center_size(at, Vec2::splat(GRIP));
        if !clip.contains_rect(grip) {
            let id = ui.scope_id().with(("light beyond", index));
            if pointer_ui(ui, clip, at, id, light, index == *selected) {
                *selected = index;
                panels::reveal(ui.ctx(), &["Lights"]);
            }
            continue;
        }
        let id = ui.scope_id().with(("light", index));
        let response = ui.interact(grip, id, Sense::click_and_drag());
        let name = format!("Light {} in the picture", light.name);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if response.clicked() || response.drag_started() {
            *selected = index;
            panels::reveal(ui.ctx(), &["Lights"]);
        }
        let motion = response.drag_delta();
        if response.dragged()
            && motion != Vec2::ZERO
            && let Some(axes) = orbit::view_axes(&camera)
        {
            let unit = orbit::units_per_pixel(&camera, depth, height);
            let step =
                axes.right * f64::from(motion.x) * unit - axes.up * f64::from(motion.y) * unit;
            for axis in 0..3 {
                light.position[axis] += step[axis];
            }
        }
        let faded = mark_color(light, index == *selected);
        let painter = ui.painter_at(clip);
        painter.circle_stroke(at, 6.0, Stroke::new(3.5, Color32::from_black_alpha(130)));
        painter.circle_stroke(at, 6.0, Stroke::new(1.5, faded));
        for turn in 0..8_u8 {
            let direction = Vec2::angled(f32::from(turn) * std::f32::consts::FRAC_PI_4);
            let ray = [at + direction * 8.5, at + direction * 11.5];
            painter.line_segment(ray, Stroke::new(3.0, Color32::from_black_alpha(130)));
            painter.line_segment(ray, Stroke::new(1.5, faded));
        }
        response.on_hover_text(format!("{}: drag to move", light.name));
    }
}

fn mark_color(light: &LightDescription, is_selected: bool) -> Color32 {
    let color = if is_selected { theme::ACCENT_ON_PICTURE } else { Color32::WHITE };
    if light.enabled { color } else { color.gamma_multiply(0.4) }
}

/// A mark at the edge of the picture for a light beyond it; gives back whether it was clicked.
fn pointer_ui(
    ui: &Ui,
    clip: Rect,
    light_at: Pos2,
    id: Id,
    light: &LightDescription,
    is_selected: bool,
) -> bool {
    let inside = clip.shrink(GRIP);
    let direction = (light_at - inside.center()).normalized();
    let at = light_at.clamp(inside.min, inside.max);
    let response = ui.interact(Rect::from_center_size(at, Vec2::splat(GRIP)), id, Sense::click());
    let name = format!("Light {} beyond the picture", light.name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let painter = ui.painter_at(clip);
    for (size, color) in
        [(9.0, Color32::from_black_alpha(150)), (7.0, mark_color(light, is_selected))]
    {
        let corner = |turn: f32| at + Vec2::angled(direction.angle() + turn) * size;
        let corners = vec![corner(0.0), corner(2.4), corner(-2.4)];
        painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
    }
    let told = format!("{}: beyond the picture this way", light.name);
    response.on_hover_text(told).clicked()
}

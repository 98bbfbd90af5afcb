//! Lights in the picture: a mark for each, which selects and moves it.

use super::theme;
use crate::scene::description::{LightKind, SceneDescription};
use crate::scene::orbit;
use egui::{Color32, Rect, Sense, Stroke, Ui, Vec2};

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
    let accent = theme::accent(ui.visuals());
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
            continue;
        }
        let id = ui.scope_id().with(("light", index));
        let response = ui.interact(grip, id, Sense::click_and_drag());
        let name = format!("Light {} in the picture", light.name);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if response.clicked() || response.drag_started() {
            *selected = index;
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
        let color = if index == *selected { accent } else { Color32::WHITE };
        let faded = if light.enabled { color } else { color.gamma_multiply(0.4) };
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

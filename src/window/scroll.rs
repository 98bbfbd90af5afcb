//! Bars that move a picture which is larger than the viewport.

use egui::{Color32, CornerRadius, Rect, Sense, Ui, Vec2};

/// Width of a bar, in points.
const WIDTH: f32 = 8.0;

/// Shows a bar for each side along which a picture of that size, in points, does not fit. `place`
/// is how far it is scrolled to the right and down, each 0..=1.
pub(super) fn scroll_bars(ui: &mut Ui, viewport: Rect, picture: Vec2, place: &mut Vec2) {
    for (axis, name) in [(0, "Scroll sideways"), (1, "Scroll up and down")] {
        let room = viewport.size()[axis];
        // Less than a pixel is no reason for a bar.
        if picture[axis] <= room + 1.0 {
            place[axis] = 0.5;
            continue;
        }
        let mut bar = viewport.shrink(2.0);
        if axis == 0 {
            bar.min.y = bar.max.y - WIDTH;
            bar.max.x -= WIDTH;
        } else {
            bar.min.x = bar.max.x - WIDTH;
            bar.max.y -= WIDTH;
        }
        let length = bar.size()[axis];
        let handle_length = (length * room / picture[axis]).max(24.0).min(length);
        let travel = (length - handle_length).max(1.0);
        let mut handle = bar;
        handle.min[axis] += travel * place[axis];
        handle.max[axis] = handle.min[axis] + handle_length;
        let response = ui.interact(handle, ui.scope_id().with(name), Sense::drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ScrollBar, true, name));
        place[axis] = (place[axis] + response.drag_delta()[axis] / travel).clamp(0.0, 1.0);
        let alpha = if response.hovered() || response.dragged() { 220 } else { 130 };
        let painter = ui.painter_at(viewport);
        painter.rect_filled(bar, CornerRadius::same(4), Color32::from_black_alpha(90));
        painter.rect_filled(
            handle,
            CornerRadius::same(4),
            Color32::from_rgba_unmultiplied(220, 220, 220, alpha),
        );
    }
}

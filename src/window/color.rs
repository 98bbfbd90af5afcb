//! Editing colours: linear RGB in the description, shown through the sRGB transfer.

use super::parameter::parameter;
use super::theme::ROW_HEIGHT;
use super::widgets::{Figure, number_box, row};
use crate::scene::description::Triple;
use egui::ecolor::Hsva;
use egui::{Color32, Rgba, Sense, Stroke, StrokeKind, Ui, Vec2};

/// A line with a swatch that opens a picker. Reflectances, textures: held to 0..=1 by the picker;
/// the boxes take what `highest` allows.
pub(super) fn color_row(
    ui: &mut Ui,
    label: &str,
    path: &str,
    help: &str,
    highest: f64,
    value: &mut Triple,
) {
    row(ui, label, help, |ui| {
        let width = ui.available_width();
        swatch(ui, label, path, help, width, highest, value);
    });
}

/// A swatch of that width; a click opens the picker.
pub(super) fn swatch(
    ui: &mut Ui,
    label: &str,
    path: &str,
    help: &str,
    width: f32,
    highest: f64,
    value: &mut Triple,
) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(width, ROW_HEIGHT), Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ColorWell, true, label));
    let visuals = ui.style().interact(&response);
    let line = if response.hovered() || response.has_focus() {
        Stroke::new(1.0, visuals.fg_stroke.color)
    } else {
        Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color)
    };
    ui.painter().rect(rect, 4.0, display_color(value), line, StrokeKind::Inside);
    let shown = value.map(|channel| format!("{channel:.3}")).join("  ");
    let response = response.on_hover_text(format!("{help}\nlinear RGB {shown}").trim().to_owned());
    parameter(&response, label, path);
    egui::Popup::from_toggle_button_response(&response)
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
        .accessible_name(format!("{label}: colour"))
        .show(|ui| picker(ui, label, highest, value));
}

/// Two lines: how strong, on a logarithmic slider, and of which tint. For emitted light.
pub(super) fn strength_and_tint(ui: &mut Ui, figure: Figure<'_>, path: &str, value: &mut Triple) {
    let (strength, mut tint) = split(value);
    let mut new_strength = strength;
    figure.allowed(0.0..=1e12).show(ui, &mut new_strength);
    if new_strength != strength {
        *value = tint.map(|channel| channel * new_strength);
    }
    let tint_before = tint;
    color_row(ui, "Tint", path, "colour of the light at full strength", 1.0, &mut tint);
    if tint != tint_before {
        let (level, pure) = split(&tint);
        let kept = if level > 0.0 { pure } else { [0.0; 3] };
        *value = kept.map(|channel| channel * new_strength);
    }
}

/// The colour as a display shows it, clipped.
pub(super) fn display_color(linear: &Triple) -> Color32 {
    let [r, g, b] = linear.map(|channel| channel.clamp(0.0, 1.0) as f32);
    Color32::from(Rgba::from_rgb(r, g, b))
}

/// The strongest channel, and the colour with that channel at 1. Black is strength 0 of white.
fn split(value: &Triple) -> (f64, Triple) {
    let strength = value.iter().fold(0.0_f64, |most, &channel| most.max(channel));
    if strength > 0.0 {
        (strength, value.map(|channel| channel / strength))
    } else {
        (0.0, [1.0; 3])
    }
}

fn picker(ui: &mut Ui, label: &str, highest: f64, value: &mut Triple) {
    ui.set_width(220.0);
    let id = ui.scope_id().with("hsva");
    let linear = value.map(|channel| channel.clamp(0.0, 1.0) as f32);
    let remembered = ui.data(|data| data.get_temp::<Hsva>(id));
    // A grey has no hue of its own: the one last chosen is kept while the colour is the same.
    let mut hsva = remembered
        .filter(|hsva| {
            let rgb = hsva.to_rgb();
            (0..3).all(|channel| (rgb[channel] - linear[channel]).abs() < 1e-4)
        })
        .unwrap_or_else(|| Hsva::from_rgb(linear));
    let mut changed = saturation_value_square(ui, label, &mut hsva);
    ui.add_space(4.0);
    changed |= hue_bar(ui, label, &mut hsva);
    if changed {
        *value = hsva.to_rgb().map(|channel| f64::from(channel.clamp(0.0, 1.0)));
    }
    ui.data_mut(|data| data.insert_temp(id, hsva));
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let mut typed = value[channel];
            let response = number_box(ui, &mut typed, 68.0, 0.004, "", false)
                .accessible_name(format!("{label}: {name}"))
                .on_hover_text(format!("{name}, linear"));
            if response.changed() && typed.is_finite() {
                value[channel] = typed.clamp(0.0, highest);
            }
        }
    });
}

/// Saturation to the right, value to the top, at one hue.
fn saturation_value_square(ui: &mut Ui, label: &str, hsva: &mut Hsva) -> bool {
    const CELLS: u32 = 16;
    let (rect, response) = ui.allocate_exact_size(Vec2::new(220.0, 132.0), Sense::click_and_drag());
    let name = format!("{label}: saturation and brightness");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, &name));
    let picked = response.interact_pointer_pos();
    if let Some(at) = picked {
        let share = (at - rect.min) / rect.size();
        hsva.s = share.x.clamp(0.0, 1.0);
        // Squared, so that equal steps look about equal in linear light.
        hsva.v = (1.0 - share.y).clamp(0.0, 1.0).powi(2);
    }
    let mut mesh = egui::Mesh::default();
    for index in 0..(CELLS + 1) * (CELLS + 1) {
        let (column, row) = (index % (CELLS + 1), index / (CELLS + 1));
        let share = Vec2::new(column as f32, row as f32) / CELLS as f32;
        let color = Hsva::new(hsva.h, share.x, (1.0 - share.y).powi(2), 1.0);
        mesh.colored_vertex(rect.lerp_inside(share), color.into());
        if column < CELLS && row < CELLS {
            let (below, right) = (index + CELLS + 1, index + 1);
            mesh.add_triangle(index, right, below);
            mesh.add_triangle(right, below + 1, below);
        }
    }
    ui.painter().add(mesh);
    let at = rect.lerp_inside(Vec2::new(hsva.s, 1.0 - hsva.v.max(0.0).sqrt()));
    marker(ui, at, hsva.v < 0.3);
    picked.is_some()
}

/// All hues from left to right.
fn hue_bar(ui: &mut Ui, label: &str, hsva: &mut Hsva) -> bool {
    const CELLS: u32 = 36;
    let (rect, response) = ui.allocate_exact_size(Vec2::new(220.0, 18.0), Sense::click_and_drag());
    let name = format!("{label}: hue");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, &name));
    let picked = response.interact_pointer_pos();
    if let Some(at) = picked {
        hsva.h = ((at.x - rect.left()) / rect.width()).clamp(0.0, 0.9999);
    }
    let mut mesh = egui::Mesh::default();
    for column in 0..=CELLS {
        let share = column as f32 / CELLS as f32;
        let color = Color32::from(Hsva::new(share, 1.0, 1.0, 1.0));
        for side in [0.0, 1.0] {
            mesh.colored_vertex(rect.lerp_inside(Vec2::new(share, side)), color);
        }
        if column < CELLS {
            let first = column * 2;
            mesh.add_triangle(first, first + 2, first + 1);
            mesh.add_triangle(first + 2, first + 3, first + 1);
        }
    }
    ui.painter().add(mesh);
    marker(ui, rect.lerp_inside(Vec2::new(hsva.h, 0.5)), false);
    picked.is_some()
}

fn marker(ui: &Ui, at: egui::Pos2, on_dark: bool) {
    let color = if on_dark { Color32::WHITE } else { Color32::BLACK };
    ui.painter().circle_stroke(at, 5.0, Stroke::new(3.0, Color32::from_white_alpha(90)));
    ui.painter().circle_stroke(at, 5.0, Stroke::new(1.5, color));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swatch_shows_linear_middle_grey_as_srgb_188() {
        let color = display_color(&[0.5, 0.5, 0.5]);
        assert_eq!((color.r(), color.g(), color.b()), (188, 188, 188), "got {color:?}");
    }

    #[test]
    fn strength_times_tint_is_the_colour() {
        let (strength, tint) = split(&[10.0, 5.0, 2.5]);
        assert_eq!((strength, tint), (10.0, [1.0, 0.5, 0.25]), "split differently");
        assert_eq!(split(&[0.0; 3]), (0.0, [1.0; 3]), "black has no white tint");
    }
}

//! Editing colours: linear RGB in the description, shown through the sRGB transfer.

use super::fields::field;
use super::parameter::parameter;
use super::theme::ROW_HEIGHT;
use super::widgets::{Figure, number_box, row};
use crate::color::linear_from_srgb;
use crate::scene::description::Triple;
use egui::ecolor::Hsva;
use egui::{Color32, Key, Rgba, Sense, Stroke, StrokeKind, Ui, Vec2};

/// Between the boxes of the picker, in points.
const GAP: f32 = 3.0;
/// Width of the names in the picker, in points.
const NAME_WIDTH: f32 = 43.0;
/// How far an arrow key moves a mark of the picker, of its whole way.
const KEY_STEP: f32 = 0.02;

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
        // Neither a dark nor a bright colour looks like an empty button.
        Stroke::new(1.0, ui.visuals().weak_text_color().gamma_multiply(0.6))
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
    line(ui, "Linear", |ui| {
        let width = ((ui.available_width() - 2.0 * GAP) / 3.0).floor();
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let mut typed = value[channel];
            let response = number_box(ui, &mut typed, width, 0.004, "", false)
                .accessible_name(format!("{label}: {name}"))
                .on_hover_text(format!("{name}, linear"));
            if response.changed() && typed.is_finite() {
                value[channel] = typed.clamp(0.0, highest);
            }
        }
    });
    line(ui, "sRGB", |ui| {
        let (name, width) = (format!("{label}: sRGB"), ui.available_width());
        let help = "as other programs write it: #rrggbb";
        let entered = field(ui, width, &name, help, "#rrggbb", "", &hex(value));
        if let Some(new) = entered.as_deref().and_then(from_hex) {
            *value = new;
        }
    });
}

/// A line of the picker with its name.
fn line(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        let size = Vec2::new(NAME_WIDTH, ROW_HEIGHT);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let font = egui::TextStyle::Body.resolve(ui.style());
        let color = ui.visuals().weak_text_color();
        ui.painter().text(rect.left_center(), egui::Align2::LEFT_CENTER, name, font, color);
        contents(ui);
    });
}

/// As other programs write it; what is brighter than white is white.
fn hex(linear: &Triple) -> String {
    let [r, g, b, _] = display_color(linear).to_array();
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The linear colour of `#rrggbb` or `#rgb`, with or without the hash.
fn from_hex(text: &str) -> Option<Triple> {
    let digits = text.trim().trim_start_matches('#');
    let digits: Vec<u32> = digits.chars().map(|c| c.to_digit(16)).collect::<Option<_>>()?;
    let bytes = match digits[..] {
        [r, g, b] => [r * 17, g * 17, b * 17],
        [a, b, c, d, e, f] => [a * 16 + b, c * 16 + d, e * 16 + f],
        _ => return None,
    };
    Some(bytes.map(|byte| f64::from(linear_from_srgb(byte as f32 / 255.0))))
}

/// Steps to the right and down by the arrow keys, where the widget has the focus.
fn arrows(ui: &Ui, response: &egui::Response) -> Vec2 {
    if !response.has_focus() {
        return Vec2::ZERO;
    }
    let (horizontal_arrows, vertical_arrows) = (true, true);
    let filter = egui::EventFilter { horizontal_arrows, vertical_arrows, ..Default::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    ui.painter().rect_stroke(
        response.rect,
        2.0,
        Stroke::new(1.5, ui.visuals().strong_text_color()),
        StrokeKind::Outside,
    );
    let presses = |key| ui.input(|input| input.num_presses(key)) as f32;
    let right = presses(Key::ArrowRight) - presses(Key::ArrowLeft);
    Vec2::new(right, presses(Key::ArrowDown) - presses(Key::ArrowUp))
}

/// Saturation to the right, value to the top, at one hue.
fn saturation_value_square(ui: &mut Ui, label: &str, hsva: &mut Hsva) -> bool {
    const CELLS: u32 = 16;
    let (rect, response) = ui.allocate_exact_size(Vec2::new(220.0, 132.0), Sense::click_and_drag());
    let name = format!("{label}: saturation and brightness");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, &name));
    let steps = arrows(ui, &response) * KEY_STEP;
    let here = Vec2::new(hsva.s, 1.0 - hsva.v.max(0.0).sqrt());
    let nudged = (steps != Vec2::ZERO).then_some(here + steps);
    let hand = response.interact_pointer_pos().map(|at| (at - rect.min) / rect.size());
    let picked = hand.or(nudged);
    if let Some(share) = picked {
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
    let steps = arrows(ui, &response).x * KEY_STEP;
    let nudged = (steps != 0.0).then_some(hsva.h + steps);
    let hand = response.interact_pointer_pos().map(|at| (at.x - rect.left()) / rect.width());
    let picked = hand.or(nudged);
    if let Some(share) = picked {
        hsva.h = share.clamp(0.0, 0.9999);
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
    fn a_colour_is_written_as_other_programs_write_it() {
        assert_eq!(hex(&[1.0, 0.5, 0.0]), "#ffbc00", "another colour");
        for text in ["#ffbc00", "FFBC00", " #fb0 "] {
            let [r, _, b] = from_hex(text).unwrap_or_else(|| panic!("{text} is refused"));
            assert_eq!((r, b), (1.0, 0.0), "{text}");
        }
        let [_, green, _] = from_hex("#ffbc00").unwrap();
        assert!((green - 0.5).abs() < 0.005, "green is {green}");
        for text in ["", "#", "#ffb", "12345", "#gggggg", "#ffbc0000"] {
            assert_eq!(from_hex(text).is_some(), text == "#ffb", "{text}");
        }
    }

    #[test]
    fn strength_times_tint_is_the_colour() {
        let (strength, tint) = split(&[10.0, 5.0, 2.5]);
        assert_eq!((strength, tint), (10.0, [1.0, 0.5, 0.25]), "split differently");
        assert_eq!(split(&[0.0; 3]), (0.0, [1.0; 3]), "black has no white tint");
    }
}

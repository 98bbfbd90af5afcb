//! A box with a figure and its unit.

use crate::window::figures::significant;
use crate::window::theme::ROW_HEIGHT;
use egui::{Response, Ui, Vec2};

/// Left and right of the figure in its box, in points.
const BOX_PADDING: f32 = 3.0;

/// A box with a figure: drag to change, click to type. The unit stands behind it.
pub(in crate::window) fn number_box(
    ui: &mut Ui,
    value: &mut f64,
    width: f32,
    speed: f64,
    unit: &str,
    integer: bool,
) -> Response {
    let typing = ui.memory(|memory| memory.has_focus(ui.next_auto_id()));
    let whole = typing || integer;
    let shown = if whole { None } else { Some(fitting(ui, *value, unit, width)) };
    let drag = egui::DragValue::new(value)
        .speed(speed)
        .max_decimals(if integer { 0 } else { 6 })
        .update_while_editing(false)
        .clip_text(true)
        .min_size(Vec2::new(width, ROW_HEIGHT))
        // While it is typed the whole figure shows, so that leaving the box rounds nothing.
        .custom_formatter(move |figure, _| shown.clone().unwrap_or_else(|| format!("{figure}")))
        .suffix(if integer && !typing { unit.to_owned() } else { String::new() });
    ui.scope(|ui| {
        ui.spacing_mut().button_padding.x = BOX_PADDING;
        ui.add(drag)
    })
    .inner
}

/// The figure with its unit, in as many digits as the box has room for: it never grows.
fn fitting(ui: &Ui, figure: f64, unit: &str, width: f32) -> String {
    let font = ui.style().drag_value_text_style.resolve(ui.style());
    let room = width - 2.0 * BOX_PADDING;
    let fits = |text: &String| {
        let color = egui::Color32::PLACEHOLDER;
        ui.painter().layout_no_wrap(text.clone(), font.clone(), color).size().x <= room
    };
    let with_unit = (2..=4).rev().map(|n_digits| significant(figure, n_digits) + unit);
    let without = (1..=4).rev().map(|n_digits| significant(figure, n_digits));
    with_unit.chain(without).find(fits).unwrap_or_else(|| significant(figure, 1))
}

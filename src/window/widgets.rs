//! The parts panels are made of: a named line, a figure with its slider, a colour, a choice.
//!
//! Every control writes to the description only on a real edit, so that showing a value never
//! changes it, and keeps the full precision of what is typed.

use super::figures::significant;
use super::parameter::parameter;
use super::theme::{FIGURE_WIDTH, LABEL_WIDTH, ROW_HEIGHT};
use egui::{Response, Ui, Vec2};
use std::ops::RangeInclusive;

/// Left and right of the figure in its box, in points.
const BOX_PADDING: f32 = 3.0;

/// Written behind lengths: scene units.
pub(super) const LENGTH: &str = " u";

/// One line of a panel: the name on the left, `contents` in the rest. Gives back their result.
pub(super) fn row<R>(
    ui: &mut Ui,
    label: &str,
    help: &str,
    contents: impl FnOnce(&mut Ui) -> R,
) -> R {
    ui.horizontal(|ui| {
        ui.set_min_height(ROW_HEIGHT);
        name_cell(ui, label, help);
        contents(ui)
    })
    .inner
}

/// A figure with a name, a slider over the usual range and a box for any allowed value.
pub(super) struct Figure<'a> {
    label: &'a str,
    path: String,
    help: &'a str,
    unit: &'a str,
    usual: RangeInclusive<f64>,
    allowed: RangeInclusive<f64>,
    logarithmic_above: Option<f64>,
    integer: bool,
}

impl<'a> Figure<'a> {
    /// A figure of that parameter path, empty where it is none of the scene's; the slider spans
    /// `usual`, the box takes any number.
    pub(super) fn new(label: &'a str, path: String, usual: RangeInclusive<f64>) -> Self {
        Self {
            label,
            path,
            help: "",
            unit: "",
            usual,
            allowed: f64::MIN..=f64::MAX,
            logarithmic_above: None,
            integer: false,
        }
    }

    /// What it does, shown on hover.
    pub(super) fn help(mut self, help: &'a str) -> Self {
        self.help = help;
        self
    }

    /// Written behind the figure.
    pub(super) fn unit(mut self, unit: &'a str) -> Self {
        self.unit = unit;
        self
    }

    /// What a scene file accepts; typed values are held to it.
    pub(super) fn allowed(mut self, allowed: RangeInclusive<f64>) -> Self {
        self.allowed = allowed;
        self
    }

    /// A logarithmic slider; `smallest` is its first step above 0.
    pub(super) fn logarithmic(mut self, smallest: f64) -> Self {
        self.logarithmic_above = Some(smallest);
        self
    }

    /// Shows the line and edits `value` in place.
    pub(super) fn show(self, ui: &mut Ui, value: &mut f64) {
        row(ui, self.label, self.help, |ui| {
            let slider_width = ui.available_width() - FIGURE_WIDTH - ui.spacing().item_spacing.x;
            ui.spacing_mut().slider_width = slider_width.max(24.0);
            let mut slid = *value;
            let mut slider = egui::Slider::new(&mut slid, self.usual.clone())
                .show_value(false)
                .clamping(egui::SliderClamping::Never);
            if let Some(smallest) = self.logarithmic_above {
                slider = slider.logarithmic(true).smallest_positive(smallest);
            }
            if self.integer {
                slider = slider.integer();
            }
            let response = self.described(ui.add(slider));
            if response.changed() {
                self.write(value, slid);
            }
            parameter(&response, self.label, &self.path);
            self.figure_box(ui, value);
        });
    }

    /// Shows the line for a whole number and edits it in place.
    pub(super) fn show_integer(mut self, ui: &mut Ui, value: &mut u32) {
        self.integer = true;
        let mut figure = f64::from(*value);
        let lowest = self.allowed.start().max(0.0);
        let highest = self.allowed.end().min(f64::from(u32::MAX));
        self.allowed = lowest..=highest;
        self.show(ui, &mut figure);
        if figure != f64::from(*value) {
            *value = figure.round() as u32;
        }
    }

    fn figure_box(&self, ui: &mut Ui, value: &mut f64) {
        let width = ui.available_width().min(FIGURE_WIDTH);
        let integer = self.integer;
        let mut typed = *value;
        let response = number_box(ui, &mut typed, width, self.speed(*value), self.unit, integer);
        let response = self.described(response);
        if response.changed() {
            self.write(value, typed);
        }
        parameter(&response, self.label, &self.path);
    }

    fn described(&self, response: Response) -> Response {
        let response = response.accessible_name(self.label);
        if self.help.is_empty() { response } else { response.on_hover_text(self.help) }
    }

    fn write(&self, value: &mut f64, new: f64) {
        if new.is_finite() {
            let held = new.clamp(*self.allowed.start(), *self.allowed.end());
            *value = if self.integer { held.round() } else { held };
        }
    }

    /// How much one point of dragging changes the figure.
    fn speed(&self, value: f64) -> f64 {
        if self.integer {
            0.2
        } else if self.logarithmic_above.is_some() {
            (value.abs() * 0.01).max(1e-5)
        } else {
            let span = self.usual.end() - self.usual.start();
            if span.is_finite() { span / 300.0 } else { 0.01 }
        }
    }
}

/// Three figures in one line: a point, a direction, three factors.
pub(super) fn triple(
    ui: &mut Ui,
    label: &str,
    path: &str,
    help: &str,
    unit: &str,
    speed: f64,
    value: &mut [f64; 3],
) {
    row(ui, label, help, |ui| {
        let gap = 3.0;
        ui.spacing_mut().item_spacing.x = gap;
        let width = ((ui.available_width() - 2.0 * gap) / 3.0).floor();
        for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
            let mut typed = value[axis];
            let named = format!("{label} {name}");
            let response = number_box(ui, &mut typed, width, speed, unit, false)
                .accessible_name(&named)
                .on_hover_text(format!("{name}. {help}"));
            if response.changed() && typed.is_finite() {
                value[axis] = typed;
            }
            parameter(&response, &named, path);
        }
    });
}

/// A choice among a few, side by side.
pub(super) fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &str,
    path: &str,
    help: &str,
    value: &mut T,
    options: &[(T, &str, &str)],
) {
    row(ui, label, help, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.spacing_mut().button_padding.x = 2.0;
        let names = options.iter().map(|(_, name, _)| text_width(ui, name) + 2.0 * 2.0).collect();
        let widths = shares(names, ui.available_width() - 2.0 * (options.len() as f32 - 1.0));
        for ((option, name, explanation), width) in options.iter().zip(widths) {
            let chosen = value == option;
            let button = egui::Button::selectable(chosen, *name)
                .frame_when_inactive(true)
                .truncate()
                .min_size(Vec2::new(width, ROW_HEIGHT));
            let response = ui.add_sized([width, ROW_HEIGHT], button).on_hover_text(*explanation);
            let named = format!("{label}: {name}");
            let response = response.accessible_name(&named);
            if response.clicked() && !chosen {
                *value = *option;
            }
            parameter(&response, &named, path);
        }
    });
}

/// Parts of `room` for names of these widths, together all of it: equal parts, or by the names
/// where one of them needs more. Whole points but for the last.
fn shares(mut names: Vec<f32>, room: f32) -> Vec<f32> {
    let equal = room / names.len() as f32;
    let sum: f32 = names.iter().sum();
    if names.iter().all(|name| name.ceil() <= equal) {
        names.fill(equal);
    } else if sum <= room {
        let more = (room - sum) / names.len() as f32;
        names.iter_mut().for_each(|name| *name += more);
    } else {
        names.iter_mut().for_each(|name| *name *= room / sum);
    }
    let mut end = 0.0_f32;
    let ends = names.iter().map(|width| {
        end += width;
        end
    });
    let mut ends: Vec<f32> = ends.map(f32::floor).collect();
    if let Some(last) = ends.last_mut() {
        *last = room;
    }
    let begins = std::iter::once(0.0).chain(ends.iter().copied());
    ends.iter().zip(begins).map(|(end, begin)| end - begin).collect()
}

fn text_width(ui: &Ui, text: &str) -> f32 {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let color = egui::Color32::PLACEHOLDER;
    ui.painter().layout_no_wrap(text.to_owned(), font, color).size().x
}

/// A choice among many, in a list that opens. Gives back the chosen index on a click.
pub(super) fn pick_one<'a>(
    ui: &mut Ui,
    label: &str,
    path: &str,
    shown: &str,
    options: impl IntoIterator<Item = &'a str>,
) -> Option<usize> {
    let mut picked = None;
    let response = egui::ComboBox::from_id_salt(label)
        .width(ui.available_width())
        .selected_text(shown)
        .truncate()
        .show_ui(ui, |ui| {
            for (index, option) in options.into_iter().enumerate() {
                if ui.selectable_label(option == shown, option).clicked() {
                    picked = Some(index);
                }
            }
        })
        .response;
    parameter(&response.accessible_name(label), label, path);
    picked
}

/// A switch with its name beside it, in the column of values.
pub(super) fn switch(ui: &mut Ui, label: &str, path: &str, help: &str, value: &mut bool) {
    row(ui, "", "", |ui| check(ui, label, path, help, value));
}

/// A switch with its name beside it.
pub(super) fn check(ui: &mut Ui, label: &str, path: &str, help: &str, value: &mut bool) {
    let response = ui.checkbox(value, label);
    let response = if help.is_empty() { response } else { response.on_hover_text(help) };
    parameter(&response, label, path);
}

/// A box with a figure: drag to change, click to type. The unit stands behind it.
pub(super) fn number_box(
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

/// The name of a line, cut with an ellipsis where it is too long.
fn name_cell(ui: &mut Ui, label: &str, help: &str) {
    let size = Vec2::new(LABEL_WIDTH, ROW_HEIGHT);
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    if label.is_empty() {
        return;
    }
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    // A child of its own: the line goes on behind the whole column, however short the name.
    let mut cell = ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(layout));
    let text = egui::RichText::new(label).weak();
    let response = cell.add(egui::Label::new(text).truncate());
    if !help.is_empty() {
        response.on_hover_text(help);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buttons_share_a_line_without_leaving_it() {
        assert_eq!(shares(vec![20.0, 30.0], 101.0), [50.0, 51.0], "equal parts");
        assert_eq!(shares(vec![10.0, 60.0], 100.0), [25.0, 75.0], "a longer name takes more");
        assert_eq!(shares(vec![60.0, 120.0], 90.0), [30.0, 60.0], "too long for all");
        for room in [140.0, 187.3, 190.0, 400.0] {
            let widths = shares(vec![30.1, 38.2, 57.3, 40.4], room);
            let sum: f32 = widths.iter().sum();
            assert!((sum - room).abs() < 1e-3, "{widths:?} of {room}");
        }
    }
}

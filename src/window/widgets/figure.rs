//! A figure of the scene: its name, a slider and a box; or three boxes.

use super::{number_box, row};
use crate::window::parameter::parameter;
use crate::window::theme::FIGURE_WIDTH;
use egui::{Response, Ui};
use std::ops::RangeInclusive;

/// A figure with a name, a slider over the usual range and a box for any allowed value.
pub(in crate::window) struct Figure<'a> {
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
    pub(in crate::window) fn new(label: &'a str, path: String, usual: RangeInclusive<f64>) -> Self {
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
    pub(in crate::window) fn help(mut self, help: &'a str) -> Self {
        self.help = help;
        self
    }

    /// Written behind the figure.
    pub(in crate::window) fn unit(mut self, unit: &'a str) -> Self {
        self.unit = unit;
        self
    }

    /// What a scene file accepts; typed values are held to it.
    pub(in crate::window) fn allowed(mut self, allowed: RangeInclusive<f64>) -> Self {
        self.allowed = allowed;
        self
    }

    /// A logarithmic slider; `smallest` is its first step above 0.
    pub(in crate::window) fn logarithmic(mut self, smallest: f64) -> Self {
        self.logarithmic_above = Some(smallest);
        self
    }

    /// Shows the line and edits `value` in place.
    pub(in crate::window) fn show(self, ui: &mut Ui, value: &mut f64) {
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
            // A slider follows every button; the others are for its menu.
            let pointer = response.interact_pointer_pos().is_some();
            let primary =
                ui.input(|input| input.pointer.primary_down() || input.pointer.primary_released());
            if response.changed() && (primary || !pointer) {
                self.write(value, slid);
            }
            parameter(&response, self.label, &self.path);
            self.figure_box(ui, value);
        });
    }

    /// Shows the line for a whole number and edits it in place.
    pub(in crate::window) fn show_integer(mut self, ui: &mut Ui, value: &mut u32) {
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
pub(in crate::window) fn triple(
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

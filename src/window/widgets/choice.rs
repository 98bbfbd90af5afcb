//! Choices: among a few side by side, among many in a list.

use super::row;
use crate::window::parameter::parameter;
use crate::window::theme::ROW_HEIGHT;
use egui::{Ui, Vec2};

/// A choice among a few, side by side.
pub(in crate::window) fn choice<T: Copy + PartialEq>(
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
pub(in crate::window) fn pick_one<'a>(
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

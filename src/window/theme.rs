//! The look: colours, spacing and text sizes, dark and light, and the one accent.
//!
//! Greys carry no hue, so that they do not tint the eye's judgement of the picture; the accent is
//! the warm edge of a shadow and marks only what is active.

use egui::{
    Button, Color32, CornerRadius, FontFamily, FontId, Margin, RichText, Stroke, Style, TextStyle,
    Theme, Ui, Vec2,
};

/// Width of the column of names in the panel, in points.
pub(super) const LABEL_WIDTH: f32 = 96.0;
/// Width of the box with a figure, in points.
pub(super) const FIGURE_WIDTH: f32 = 72.0;
/// Height of one line of the panel, in points.
pub(super) const ROW_HEIGHT: f32 = 22.0;
/// Around the picture: neutral and dark, so that it neither tints nor dazzles.
pub(super) const SURROUND: Color32 = Color32::from_gray(30);

/// Sets both themes on a context; which one is used follows the system.
pub(super) fn install(ctx: &egui::Context) {
    ctx.set_style_of(Theme::Dark, style(Theme::Dark));
    ctx.set_style_of(Theme::Light, style(Theme::Light));
}

/// The accent over a picture, which is as bright in either theme.
pub(super) const ACCENT_ON_PICTURE: Color32 = Tones::DARK.accent;

/// The accent of the theme in use.
pub(super) fn accent(visuals: &egui::Visuals) -> Color32 {
    if visuals.dark_mode { Tones::DARK.accent } else { Tones::LIGHT.accent }
}

/// The button of the likeliest choice.
pub(super) fn main_button(ui: &Ui, text: &str) -> Button<'static> {
    let text = RichText::new(text).color(ui.visuals().strong_text_color());
    Button::new(text).fill(ui.visuals().selection.bg_fill)
}

/// Around what a modal box holds.
pub(super) fn modal_frame(style: &Style) -> egui::Frame {
    egui::Frame::popup(style).inner_margin(18)
}

/// The thin line between groups.
pub(super) fn hairline(visuals: &egui::Visuals) -> Stroke {
    let tones = if visuals.dark_mode { Tones::DARK } else { Tones::LIGHT };
    Stroke::new(1.0, tones.line)
}

struct Tones {
    panel: Color32,
    field: Color32,
    button: Color32,
    hovered: Color32,
    pressed: Color32,
    line: Color32,
    text: Color32,
    quiet_text: Color32,
    strong_text: Color32,
    accent: Color32,
    selection: Color32,
}

impl Tones {
    const DARK: Self = Self {
        panel: Color32::from_gray(43),
        field: Color32::from_gray(29),
        button: Color32::from_gray(59),
        hovered: Color32::from_gray(72),
        pressed: Color32::from_gray(84),
        line: Color32::from_gray(56),
        text: Color32::from_gray(208),
        quiet_text: Color32::from_gray(158),
        strong_text: Color32::from_gray(240),
        accent: Color32::from_rgb(229, 164, 75),
        selection: Color32::from_rgb(122, 84, 32),
    };
    const LIGHT: Self = Self {
        panel: Color32::from_gray(243),
        field: Color32::from_gray(255),
        button: Color32::from_gray(228),
        hovered: Color32::from_gray(216),
        pressed: Color32::from_gray(202),
        line: Color32::from_gray(214),
        text: Color32::from_gray(48),
        quiet_text: Color32::from_gray(100),
        strong_text: Color32::from_gray(16),
        accent: Color32::from_rgb(168, 94, 0),
        selection: Color32::from_rgb(247, 214, 164),
    };
}

fn style(theme: Theme) -> Style {
    let (mut style, tones) = match theme {
        Theme::Dark => (Style { visuals: egui::Visuals::dark(), ..Style::default() }, Tones::DARK),
        Theme::Light => {
            (Style { visuals: egui::Visuals::light(), ..Style::default() }, Tones::LIGHT)
        }
    };
    set_text(&mut style);
    set_spacing(&mut style);
    set_visuals(&mut style.visuals, &tones);
    style.interaction.tooltip_delay = 0.4;
    style.interaction.selectable_labels = false;
    style.explanation_tooltips = false;
    style.animation_time = 0.08;
    style
}

fn set_text(style: &mut Style) {
    for (text_style, size) in [
        (TextStyle::Small, 11.0),
        (TextStyle::Body, 13.0),
        (TextStyle::Button, 13.0),
        (TextStyle::Heading, 18.0),
    ] {
        style.text_styles.insert(text_style, FontId::new(size, FontFamily::Proportional));
    }
    style.text_styles.insert(TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace));
    style.drag_value_text_style = TextStyle::Body;
}

fn set_spacing(style: &mut Style) {
    let spacing = &mut style.spacing;
    spacing.item_spacing = Vec2::new(6.0, 5.0);
    spacing.button_padding = Vec2::new(8.0, 2.0);
    spacing.interact_size = Vec2::new(36.0, ROW_HEIGHT);
    spacing.window_margin = Margin::same(12);
    spacing.menu_margin = Margin::same(6);
    spacing.indent = 14.0;
    spacing.slider_rail_height = 4.0;
    spacing.icon_width = 15.0;
    spacing.icon_width_inner = 9.0;
    spacing.combo_height = 320.0;
    spacing.tooltip_width = 320.0;
    spacing.scroll.floating = false;
    spacing.scroll.foreground_color = false;
    spacing.scroll.bar_width = 6.0;
    spacing.scroll.bar_inner_margin = 4.0;
    spacing.scroll.bar_outer_margin = 2.0;
}

fn set_visuals(visuals: &mut egui::Visuals, tones: &Tones) {
    let radius = CornerRadius::same(4);
    visuals.panel_fill = tones.panel;
    visuals.window_fill = tones.panel;
    visuals.window_stroke = Stroke::new(1.0, tones.line);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.extreme_bg_color = tones.field;
    visuals.faint_bg_color = tones.button;
    visuals.weak_text_color = Some(tones.quiet_text);
    visuals.hyperlink_color = tones.accent;
    visuals.selection.bg_fill = tones.selection;
    visuals.selection.stroke = Stroke::new(1.0, tones.strong_text);
    visuals.slider_trailing_fill = true;
    visuals.striped = false;
    visuals.indent_has_left_vline = false;
    visuals.interact_cursor = None;
    visuals.handle_shape = egui::style::HandleShape::Rect { aspect_ratio: 0.5 };

    let widgets = &mut visuals.widgets;
    let state = |fill, text, line| egui::style::WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: line,
        corner_radius: radius,
        fg_stroke: Stroke::new(1.0, text),
        expansion: 0.0,
    };
    widgets.noninteractive = state(tones.panel, tones.text, Stroke::new(1.0, tones.line));
    widgets.inactive = state(tones.button, tones.text, Stroke::NONE);
    widgets.hovered = state(tones.hovered, tones.strong_text, Stroke::NONE);
    widgets.active = state(tones.pressed, tones.strong_text, Stroke::new(1.0, tones.accent));
    widgets.open = state(tones.hovered, tones.strong_text, Stroke::NONE);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance as the Web Content Accessibility Guidelines define it.
    fn luminance(color: Color32) -> f32 {
        let linear = egui::Rgba::from(color);
        0.2126 * linear.r() + 0.7152 * linear.g() + 0.0722 * linear.b()
    }

    fn contrast(a: Color32, b: Color32) -> f32 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_stands_out_from_what_is_behind_it() {
        for (name, tones) in [("dark", Tones::DARK), ("light", Tones::LIGHT)] {
            for (text, behind, least) in [
                (tones.text, tones.panel, 7.0),
                (tones.text, tones.button, 5.5),
                (tones.text, tones.field, 7.0),
                (tones.quiet_text, tones.panel, 4.5),
                (tones.strong_text, tones.selection, 4.5),
                (tones.accent, tones.panel, 4.0),
            ] {
                let ratio = contrast(text, behind);
                assert!(ratio >= least, "{name}: {text:?} on {behind:?} is {ratio:.2}");
            }
        }
    }

    #[test]
    fn figures_are_tabular() {
        let ctx = egui::Context::default();
        install(&ctx);
        let mut widths = Vec::new();
        let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let font = TextStyle::Body.resolve(ui.style());
            widths = ui.fonts_mut(|fonts| {
                ('0'..='9').map(|digit| fonts.glyph_width(&font, digit)).collect()
            });
        });
        output.textures_delta.clear();
        let same = widths.iter().all(|width: &f32| (width - widths[0]).abs() < 1e-3);
        assert!(same && widths.len() == 10, "digits are {widths:?} wide");
    }
}

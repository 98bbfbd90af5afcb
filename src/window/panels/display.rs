//! Display: view, exposure, tone curve, zoom, histogram. Nothing here restarts the render.

use crate::scene::description::{ToneMappingDescription, ToneOperator};
use crate::window::viewport::Zoom;
use crate::window::views::View;
use crate::window::widgets::{Figure, choice, pick_one, row};
use egui::{Color32, Ui, Vec2};

/// How the picture is shown, beside what the scene file keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::window) struct DisplayState {
    /// What is shown of each pixel.
    pub(in crate::window) view: View,
    /// Size of a picture pixel on the screen.
    pub(in crate::window) zoom: Zoom,
    /// How far a picture that does not fit is scrolled to the right and down, each 0..=1.
    pub(in crate::window) scroll: Vec2,
}

impl Default for DisplayState {
    fn default() -> Self {
        Self { view: View::default(), zoom: Zoom::default(), scroll: Vec2::splat(0.5) }
    }
}

/// Counts of displayed values, for the histogram.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::window) struct PictureStatistics {
    /// For red, green and blue: how many pixels show each quartet of the 256 values.
    pub(in crate::window) histogram: [[u32; 64]; 3],
}

const OPERATORS: [(ToneOperator, &str, &str); 4] = [
    (ToneOperator::Agx, "AgX", "soft highlights that fade to white, as in Blender"),
    (ToneOperator::Aces, "ACES", "film look: strong contrast"),
    (ToneOperator::Reinhard, "Reinhard", "compresses highlights, x / (1 + x)"),
    (ToneOperator::Linear, "Linear", "no curve: clips at white"),
];
const ZOOMS: [(Zoom, &str, &str); 3] = [
    (Zoom::Fit, "Fit", "the whole picture in the window"),
    (Zoom::Actual, "100 %", "one picture pixel on one screen pixel"),
    (Zoom::Double, "200 %", "one picture pixel on two by two screen pixels"),
];

/// View, exposure, operator and zoom, with a histogram of what is shown.
pub(in crate::window) fn display_ui(
    ui: &mut Ui,
    tone: &mut ToneMappingDescription,
    state: &mut DisplayState,
    statistics: Option<&PictureStatistics>,
) {
    row(ui, "View", "what is shown of each pixel (1 to 8)", |ui| {
        let names = View::ALL.map(View::name);
        if let Some(index) = pick_one(ui, "View", "", state.view.name(), names) {
            state.view = View::ALL[index];
        }
    });
    Figure::new("Exposure", "tone_mapping.exposure".to_owned(), -6.0..=6.0)
        .allowed(-64.0..=64.0)
        .unit(" EV")
        .help("brighter or darker in stops: +1 is twice the light (E, Shift+E)")
        .show(ui, &mut tone.exposure);
    let (path, help) = ("tone_mapping.operator", "how light becomes display brightness (T)");
    choice(ui, "Curve", path, help, &mut tone.operator, &OPERATORS);
    choice(ui, "Zoom", "", "", &mut state.zoom, &ZOOMS);
    if let Some(statistics) = statistics {
        histogram(ui, statistics);
    }
}

fn histogram(ui: &mut Ui, statistics: &PictureStatistics) {
    ui.add_space(4.0);
    let size = Vec2::new(ui.available_width(), 64.0);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Histogram"));
    response.on_hover_text("how many pixels show each brightness, dark to bright");
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    let area = rect.shrink(4.0);
    // The ends hold clipped pixels and would flatten the rest.
    let inner = statistics.histogram.iter().flat_map(|counts| &counts[1..63]);
    let highest = inner.copied().max().unwrap_or(0).max(1) as f32;
    let colors = if ui.visuals().dark_mode {
        [
            Color32::from_rgb(190, 60, 50),
            Color32::from_rgb(60, 150, 70),
            Color32::from_rgb(60, 95, 190),
        ]
    } else {
        [
            Color32::from_rgb(225, 110, 100),
            Color32::from_rgb(100, 190, 110),
            Color32::from_rgb(105, 140, 225),
        ]
    };
    for (counts, color) in statistics.histogram.iter().zip(colors) {
        let step = area.width() / counts.len() as f32;
        for (bin, count) in counts.iter().enumerate() {
            let height = (*count as f32 / highest).min(1.0).sqrt() * area.height();
            let left = area.left() + bin as f32 * step;
            let bar = egui::Rect::from_min_max(
                egui::pos2(left, area.bottom() - height),
                egui::pos2(left + step, area.bottom()),
            );
            painter.rect_filled(bar, 0.0, color.gamma_multiply(0.6));
        }
    }
}

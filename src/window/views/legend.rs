//! What the colours of a view mean: a ramp with figures and their unit, in a corner of the picture.

use super::View;
use super::scale::Scale;
use egui::{Align2, Color32, CornerRadius, FontId, Mesh, Pos2, Rect, Sense, Ui, Vec2, pos2};

/// What the colours of a view mean.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::window) struct Legend {
    /// Whose colours.
    pub(in crate::window) view: View,
    /// A few words more; may be empty.
    pub(in crate::window) note: String,
    /// The scale, where colours stand for figures.
    pub(super) figures: Option<Figures>,
}

/// A ramp with its scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Figures {
    pub(super) unit: &'static str,
    pub(super) ramp: Ramp,
    pub(super) scale: Scale,
}

/// Colours from the first place of a scale to the last, evenly spaced, linear in sRGB between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp(&'static [[u8; 3]]);

impl Ramp {
    /// Light is low.
    pub(super) const GREY: Self = Self(&[[245, 245, 245], [60, 60, 60]]);
    /// Black, red, yellow. Source: N. Smith and S. van der Walt, "inferno", matplotlib 1.5, 2015.
    pub(super) const HEAT: Self = Self(&[
        [0, 0, 4],
        [27, 12, 65],
        [74, 12, 107],
        [120, 28, 109],
        [165, 44, 96],
        [207, 68, 70],
        [237, 105, 37],
        [251, 155, 6],
        [247, 209, 61],
        [252, 255, 164],
    ]);
    /// Violet, green, yellow. Source: the same, "viridis".
    pub(super) const LAND: Self = Self(&[
        [68, 1, 84],
        [72, 40, 120],
        [62, 74, 137],
        [49, 104, 142],
        [38, 130, 142],
        [31, 158, 137],
        [53, 183, 121],
        [109, 205, 89],
        [180, 222, 44],
        [253, 231, 37],
    ]);
    /// Blue below, white in the middle, orange above.
    pub(super) const DIVERGING: Self =
        Self(&[[22, 58, 128], [92, 148, 214], [244, 244, 240], [238, 156, 74], [150, 60, 8]]);

    /// The colour at a place in 0..=1.
    pub(super) fn at(self, place: f64) -> Color32 {
        let steps = self.0.len() - 1;
        let at = place.clamp(0.0, 1.0) * steps as f64;
        let first = (at as usize).min(steps.saturating_sub(1));
        let share = at - first as f64;
        let (a, b) = (self.0[first], self.0[(first + 1).min(steps)]);
        let mix = |channel: usize| {
            let (a, b) = (f64::from(a[channel]), f64::from(b[channel]));
            (a + (b - a) * share).round() as u8
        };
        Color32::from_rgb(mix(0), mix(1), mix(2))
    }
}

impl Legend {
    /// Colours that words explain.
    pub(super) fn words(view: View, note: &str) -> Self {
        Self { view, note: note.to_owned(), figures: None }
    }

    /// Colours that stand for figures.
    pub(super) fn figures(
        view: View,
        unit: &'static str,
        note: &str,
        ramp: Ramp,
        scale: Scale,
    ) -> Self {
        Self { view, note: note.to_owned(), figures: Some(Figures { unit, ramp, scale }) }
    }

    /// The whole of it in words.
    fn told(&self) -> String {
        let mut told = self.view.name().to_owned();
        if let Some(figures) = &self.figures {
            let marks = figures.scale.marks();
            let texts: Vec<&str> = marks.iter().map(|(_, text)| text.as_str()).collect();
            told = format!("{told}, {}: {}", figures.unit, texts.join(", "));
        }
        if self.note.is_empty() { told } else { format!("{told}; {}", self.note) }
    }
}

const MARGIN: f32 = 10.0;
const RAMP_SIZE: Vec2 = Vec2::new(236.0, 10.0);

/// Shows the legend in the lower left corner of the viewport.
pub(in crate::window) fn legend_ui(ui: &mut Ui, viewport: Rect, legend: &Legend) {
    let title = match &legend.figures {
        Some(figures) => format!("{}  ·  {}", legend.view.name(), figures.unit),
        None => legend.view.name().to_owned(),
    };
    let text = |size: f32| FontId::proportional(size);
    let lay = |words: String, size: f32, color: Color32| {
        ui.painter().layout(words, text(size), color, RAMP_SIZE.x.max(260.0))
    };
    let title = lay(title, 13.0, Color32::WHITE);
    let note = lay(legend.note.clone(), 11.0, Color32::from_gray(190));
    let has_note = !legend.note.is_empty();
    let ramp_height = if legend.figures.is_some() { RAMP_SIZE.y + 24.0 } else { 4.0 };
    let note_height = if has_note { note.size().y } else { 0.0 };
    let width = [RAMP_SIZE.x, title.size().x, note.size().x].into_iter().fold(0.0, f32::max);
    let size = Vec2::new(width, title.size().y + ramp_height + note_height);
    let outer = size + Vec2::splat(2.0 * MARGIN);
    let corner = viewport.left_bottom() + Vec2::new(12.0, -12.0 - outer.y);
    let rect = Rect::from_min_size(corner, outer);
    let response = ui.interact(rect, ui.scope_id().with("legend"), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, legend.told()));

    let painter = ui.painter_at(viewport);
    painter.rect_filled(rect, CornerRadius::same(6), Color32::from_black_alpha(190));
    let mut at = rect.min + Vec2::splat(MARGIN);
    let title_height = title.size().y;
    painter.galley(at, title, Color32::WHITE);
    at.y += title_height + 4.0;
    if let Some(figures) = &legend.figures {
        let bar = Rect::from_min_size(at, RAMP_SIZE);
        painter.add(ramp_mesh(bar, figures.ramp));
        for (place, mark) in figures.scale.marks() {
            let x = bar.left() + bar.width() * place as f32;
            let tick = [pos2(x, bar.bottom()), pos2(x, bar.bottom() + 3.0)];
            painter.line_segment(tick, (1.0, Color32::from_gray(200)));
            let align = match place {
                place if place < 0.05 => Align2::LEFT_TOP,
                place if 0.95 < place => Align2::RIGHT_TOP,
                _ => Align2::CENTER_TOP,
            };
            painter.text(tick[1], align, mark, text(11.0), Color32::from_gray(220));
        }
        at.y += RAMP_SIZE.y + 20.0;
    }
    if has_note {
        painter.galley(at, note, Color32::WHITE);
    }
}

/// The ramp as a strip of quads.
fn ramp_mesh(bar: Rect, ramp: Ramp) -> Mesh {
    const N_STEPS: u32 = 48;
    let mut mesh = Mesh::default();
    for step in 0..=N_STEPS {
        let place = f64::from(step) / f64::from(N_STEPS);
        let x = bar.left() + bar.width() * place as f32;
        let color = ramp.at(place);
        mesh.colored_vertex(Pos2::new(x, bar.top()), color);
        mesh.colored_vertex(Pos2::new(x, bar.bottom()), color);
        if 0 < step {
            let base = 2 * step;
            mesh.add_triangle(base - 2, base - 1, base);
            mesh.add_triangle(base - 1, base, base + 1);
        }
    }
    mesh
}

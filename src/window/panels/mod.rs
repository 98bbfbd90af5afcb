//! The groups of the right panel. Each is a function that edits plain data in place; it starts
//! nothing and knows nothing of rendering. The caller finds changes by comparing.

mod camera;
mod convergence;
mod display;
mod lens_diagram;
mod lights;
mod materials;
mod objects;
mod parts;
mod render;
mod textures;

pub(super) use camera::{camera_ui, sharp_range};
pub(super) use convergence::Convergence;
pub(super) use display::{DisplayState, PictureStatistics, display_ui};
pub(super) use lights::lights_ui;
pub(super) use materials::materials_ui;
pub(super) use objects::{objects_ui, report_ui};
pub(super) use render::{Limits, RenderFacts, SizeMode, limits_ui, render_ui};
pub(super) use textures::textures_ui;

use super::structure::Part;
use super::theme;
use egui::collapsing_header::CollapsingState;
use egui::{Align, Id, Sense, TextStyle, Ui, Vec2};

/// What a click in the picture is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PickFor {
    /// The focal distance.
    Focus,
    /// The point that the chosen light faces.
    LightTarget,
    /// The place of the chosen light.
    LightPosition,
}

/// Which part of each list is being edited, and half-typed names.
#[derive(Clone, Debug, Default)]
pub(super) struct Selection {
    /// Index in the scene's lights.
    pub(super) light: usize,
    /// Index in the scene's materials.
    pub(super) material: usize,
    /// Index in the scene's textures.
    pub(super) texture: usize,
    /// Index in the scene's objects.
    pub(super) object: usize,
    /// Whether alpha_x and alpha_y move together.
    pub(super) alphas_linked: bool,
    /// The part, by name, whose file is to be chosen: a picture for a texture, a mesh for an object.
    pub(super) wants_file: Option<(Part, String)>,
    /// The name being typed, while it is not yet given.
    pub(super) renaming: Option<parts::Renaming>,
}

/// Opens the groups of these titles in this frame or the next, and brings the first into sight.
pub(super) fn reveal(ctx: &egui::Context, titles: &[&'static str]) {
    ctx.data_mut(|data| data.insert_temp(reveal_id(), titles.to_vec()));
}

/// Where a group is in the list of those to be opened, once.
fn take_reveal(ctx: &egui::Context, title: &str) -> Option<usize> {
    ctx.data_mut(|data| {
        let titles = data.get_temp_mut_or_default::<Vec<&'static str>>(reveal_id());
        let place = titles.iter().position(|revealed| *revealed == title)?;
        titles[place] = "";
        Some(place)
    })
}

fn reveal_id() -> Id {
    Id::unique("groups to be opened")
}

/// A group that opens and closes, with a short summary while it is closed.
pub(super) fn section(
    ui: &mut Ui,
    title: &str,
    summary: &str,
    open_at_first: bool,
    contents: impl FnOnce(&mut Ui),
) {
    let id = ui.make_persistent_id(("section", title));
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, open_at_first);
    let revealed = take_reveal(ui.ctx(), title);
    let was_open = state.is_open();
    state.set_open(was_open || revealed.is_some());
    let response = header(ui, title, summary, &state);
    if response.clicked() {
        state.toggle(ui);
    }
    let body = state.show_body_unindented(ui, |ui| {
        egui::Frame::new()
            .inner_margin(egui::Margin { left: 4, right: 4, top: 2, bottom: 8 })
            .show(ui, |ui| {
                ui.set_width(ui.available_width());
                contents(ui);
            });
    });
    if revealed == Some(0) {
        // A group that was open already moves only as far as it has to.
        let body = body.filter(|_| was_open).map(|body| body.response.rect);
        let whole = body.map_or(response.rect, |body| body.union(response.rect));
        ui.scroll_to_rect(whole, (!was_open).then_some(Align::TOP));
    }
    let line = theme::hairline(ui.visuals());
    let rect = ui.max_rect();
    ui.painter().hline(rect.x_range(), ui.cursor().top() - 2.0, line);
}

fn header(ui: &mut Ui, title: &str, summary: &str, state: &CollapsingState) -> egui::Response {
    let size = Vec2::new(ui.available_width(), 28.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let open = state.is_open();
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::DisclosureTriangle, true, open, title)
    });
    let visuals = *ui.style().interact(&response);
    let mut icon = response.clone();
    icon.rect = egui::Rect::from_center_size(
        egui::pos2(rect.left() + 10.0, rect.center().y),
        Vec2::splat(9.0),
    );
    egui::collapsing_header::paint_default_icon(ui, state.openness(ui.ctx()), &icon);
    let font = TextStyle::Body.resolve(ui.style());
    let strong = if response.hovered() || response.has_focus() {
        visuals.fg_stroke.color
    } else {
        ui.visuals().strong_text_color()
    };
    let title_end = ui.painter().text(
        egui::pos2(rect.left() + 24.0, rect.center().y),
        egui::Align2::LEFT_CENTER,
        title,
        font.clone(),
        strong,
    );
    if !open && !summary.is_empty() {
        let room = rect.with_min_x(title_end.right() + 12.0);
        ui.painter().with_clip_rect(room.intersect(ui.clip_rect())).text(
            egui::pos2(rect.right() - 6.0, rect.center().y),
            egui::Align2::RIGHT_CENTER,
            summary,
            font,
            ui.visuals().weak_text_color(),
        );
    }
    response
}

/// A small heading inside a group.
fn subheading(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    ui.label(egui::RichText::new(text).small().color(theme::accent(ui.visuals())));
}

/// A name as it stands in a parameter path: quoted where TOML would quote it.
pub(super) fn path_segment(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(bare) {
        name.to_owned()
    } else {
        format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
    }
}

#[cfg(test)]
mod tests {
    use super::path_segment;

    #[test]
    fn names_are_quoted_where_toml_quotes_them() {
        assert_eq!(path_segment("blue-marble_2"), "blue-marble_2", "quoted needlessly");
        assert_eq!(path_segment("blue marble"), "\"blue marble\"", "a space went bare");
        assert_eq!(path_segment("a\"b"), "\"a\\\"b\"", "a quote was not escaped");
    }
}

//! Compare: a pinned picture beside the live one, with a split to drag, and what differs.

use super::figures::significant;
use crate::io::scene_file::{self, ParameterPath};
use crate::scene::description::SceneDescription;
use egui::{Align2, Color32, ColorImage, Pos2, Rect, Sense, Stroke, TextureHandle, Ui, pos2};
use std::collections::HashMap;
use std::sync::Arc;
use toml::Value;

/// Differences shown at once.
const MOST_LINES: usize = 12;

/// A picture that was kept, and the scene that made it.
pub(super) struct Pinned {
    /// The scene as it was.
    pub(super) description: SceneDescription,
    texture: TextureHandle,
    split: f32,
    differences: Vec<Difference>,
    compared_with: Option<SceneDescription>,
}

/// A parameter whose value is not the pinned one.
#[derive(Clone, Debug, PartialEq)]
struct Difference {
    path: ParameterPath,
    /// The pinned value; `None` where the parameter was not there.
    then: Option<Value>,
    /// Path, then, now.
    line: String,
}

/// What was chosen at the pinned picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum CompareChoice {
    /// Take this one value back.
    RestoreOne(ParameterPath, Value),
    /// Take the pinned scene back.
    Restore,
    /// Stop comparing.
    Close,
}

impl Pinned {
    /// Keeps this picture and the scene that made it.
    pub(super) fn new(
        ctx: &egui::Context,
        image: &Arc<ColorImage>,
        description: SceneDescription,
    ) -> Self {
        let options = egui::TextureOptions::LINEAR;
        let texture = ctx.load_texture("pinned", Arc::clone(image), options);
        Self { description, texture, split: 0.5, differences: Vec::new(), compared_with: None }
    }

    /// Draws the pinned picture over all of the live one, for as long as a key is held.
    pub(super) fn show_alone(&self, ui: &Ui, picture: Rect, clip: Rect) {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        let painter = ui.painter_at(clip);
        painter.image(self.texture.id(), picture, whole, Color32::WHITE);
        let corner = picture.intersect(clip).left_top() + egui::vec2(12.0, 12.0);
        let text = egui::FontId::proportional(13.0);
        let galley = painter.layout_no_wrap("pinned".to_owned(), text, Color32::WHITE);
        let chip = Rect::from_min_size(corner, galley.size() + egui::vec2(16.0, 8.0));
        painter.rect_filled(chip, 6.0, Color32::from_black_alpha(190));
        painter.galley(corner + egui::vec2(8.0, 4.0), galley, Color32::WHITE);
        let response = ui.interact(chip, ui.scope_id().with("pinned"), Sense::hover());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, "Pinned picture alone")
        });
    }

    /// Draws the pinned picture over the left part of the live one in `picture`, the split, and
    /// the list of differences to `scene`.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        picture: Rect,
        clip: Rect,
        scene: &SceneDescription,
    ) -> Option<CompareChoice> {
        let visible = picture.intersect(clip);
        let x = visible.left() + visible.width() * self.split;
        let grip =
            Rect::from_center_size(pos2(x, visible.center().y), egui::vec2(12.0, visible.height()));
        let response = ui
            .interact(grip, ui.scope_id().with("split"), Sense::drag())
            .on_hover_and_drag_cursor(egui::CursorIcon::ResizeHorizontal);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Splitter, true, "Split"));
        if let Some(at) = response.interact_pointer_pos() {
            self.split = ((at.x - visible.left()) / visible.width()).clamp(0.02, 0.98);
        }
        let left = Rect::from_min_max(visible.min, pos2(x, visible.bottom()));
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        let painter = ui.painter_at(clip);
        painter.with_clip_rect(left).image(self.texture.id(), picture, whole, Color32::WHITE);
        painter.vline(x, visible.y_range(), Stroke::new(3.0, Color32::from_black_alpha(120)));
        painter.vline(x, visible.y_range(), Stroke::new(1.0, Color32::WHITE));
        grip_mark(&painter, grip.center());
        self.compare(scene);
        self.legend(ui, visible)
    }

    fn compare(&mut self, scene: &SceneDescription) {
        if self.compared_with.as_ref() != Some(scene) {
            self.differences = differences(&self.description, scene);
            self.compared_with = Some(scene.clone());
        }
    }

    fn legend(&self, ui: &Ui, visible: Rect) -> Option<CompareChoice> {
        let mut chosen = None;
        egui::Area::new(egui::Id::unique("compare"))
            .order(egui::Order::Middle)
            .pivot(Align2::LEFT_TOP)
            .fixed_pos(visible.left_top() + egui::vec2(12.0, 12.0))
            .show(ui.ctx(), |ui| {
                egui::Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_max_width(340.0);
                    ui.horizontal(|ui| {
                        ui.strong("Pinned on the left");
                        let restore = ui.button("Restore");
                        if restore.on_hover_text("takes the pinned scene back").clicked() {
                            chosen = Some(CompareChoice::Restore);
                        }
                        if ui.button("Unpin").on_hover_text("stops comparing (X)").clicked() {
                            chosen = Some(CompareChoice::Close);
                        }
                    });
                    if self.differences.is_empty() {
                        ui.weak("no setting differs");
                    }
                    for difference in self.differences.iter().take(MOST_LINES) {
                        if let Some(choice) = difference_ui(ui, difference) {
                            chosen = Some(choice);
                        }
                    }
                    let n_more = self.differences.len().saturating_sub(MOST_LINES);
                    if 0 < n_more {
                        ui.weak(format!("and {n_more} more"));
                    }
                });
            });
        chosen
    }
}

/// Shows that the split can be dragged: a disk with an arrow to each side.
fn grip_mark(painter: &egui::Painter, at: Pos2) {
    painter.circle(at, 11.0, Color32::from_black_alpha(170), Stroke::new(1.0, Color32::WHITE));
    for side in [-1.0, 1.0] {
        let corner = |x: f32, y: f32| at + egui::vec2(side * x, y);
        let arrow = vec![corner(7.0, 0.0), corner(3.0, -3.5), corner(3.0, 3.5)];
        painter.add(egui::Shape::convex_polygon(arrow, Color32::WHITE, Stroke::NONE));
    }
}

/// A line of the list; a click takes the pinned value back.
fn difference_ui(ui: &mut Ui, difference: &Difference) -> Option<CompareChoice> {
    let Difference { path, then, line } = difference;
    let Some(value) = then else {
        ui.add(egui::Label::new(line).truncate());
        return None;
    };
    let button = egui::Button::new(line).frame(false).truncate();
    let help = format!("{line}. Click: takes this value back");
    let is_chosen = ui.add(button).on_hover_text(help).clicked();
    is_chosen.then(|| CompareChoice::RestoreOne(path.clone(), value.clone()))
}

/// The parameters whose values differ, in the order of the scene as it is now, then those gone.
fn differences(then: &SceneDescription, now: &SceneDescription) -> Vec<Difference> {
    let (then, now) = (scene_file::values(then), scene_file::values(now));
    let table = |list: &[(ParameterPath, Value)]| -> HashMap<String, Value> {
        list.iter().map(|(path, value)| (path.to_string(), value.clone())).collect()
    };
    let (known_then, known_now) = (table(&then), table(&now));
    let mut differences = Vec::new();
    for (path, value) in now {
        let before = known_then.get(&path.to_string()).cloned();
        let line = match &before {
            Some(before) if *before == value => continue,
            Some(before) => format!("{path}: {}, now {}", shown(before), shown(&value)),
            None => format!("{path}: new, {}", shown(&value)),
        };
        differences.push(Difference { path, then: before, line });
    }
    for (path, value) in then {
        if !known_now.contains_key(&path.to_string()) {
            let line = format!("{path}: gone, was {}", shown(&value));
            differences.push(Difference { path, then: Some(value), line });
        }
    }
    differences
}

/// A value as a person reads it: figures short, what is the same on each axis once.
fn shown(value: &Value) -> String {
    match value {
        Value::Float(figure) => significant(*figure, 5),
        Value::String(text) => text.clone(),
        Value::Array(parts) => match parts.split_first() {
            Some((first, rest)) if rest.iter().all(|part| part == first) => shown(first),
            _ => parts.iter().map(shown).collect::<Vec<_>>().join(" "),
        },
        Value::Integer(_) | Value::Boolean(_) | Value::Datetime(_) | Value::Table(_) => {
            value.to_string()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::tests::small_scene;

    #[test]
    fn differences_name_the_parameter_and_both_values() {
        let then = small_scene();
        let mut now = then.clone();
        assert!(differences(&then, &now).is_empty(), "equal scenes differ");
        now.camera.vertical_fov = 55.0;
        now.materials[0].alpha_x = 0.5;
        let found = differences(&then, &now);
        let lines: Vec<&str> = found.iter().map(|difference| difference.line.as_str()).collect();
        assert_eq!(
            lines,
            ["camera.vertical_fov: 40, now 55", "materials.glaze.alpha_x: 0.15, now 0.5"],
            "other lines"
        );
    }

    #[test]
    fn values_read_as_people_write_them() {
        let text = |value: &str| shown(&toml::from_str::<toml::Table>(value).unwrap()["v"]);
        assert_eq!(text("v = 525.5200000000001"), "525.52", "too many digits");
        assert_eq!(text("v = [5000.0, 5000.0, 5000.0]"), "5000", "the same thrice");
        assert_eq!(text("v = [0.0, 1.5, 0.25]"), "0 1.5 0.25", "three axes");
        assert_eq!(text("v = \"glaze\""), "glaze", "a name");
    }

    #[test]
    fn what_is_gone_and_what_is_new_is_said_to_be() {
        let mut then = small_scene();
        let mut now = then.clone();
        then.camera.focal_distance = Some(4.0);
        now.lights[0].name = "rim".to_owned();
        let found = differences(&then, &now);
        let says = |text: &str| found.iter().any(|difference| difference.line == text);
        assert!(says("camera.focal_distance: gone, was 4"), "{found:?}");
        assert!(says("lights.rim.visible: new, true"), "{found:?}");
        assert!(says("lights.key.visible: gone, was true"), "{found:?}");
    }
}

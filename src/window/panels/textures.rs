//! Textures: Perlin noise in four patterns, checker, image, plain; and what stands behind it all.

use super::materials::color_or_texture;
use super::parts::part_list;
use super::{Selection, path_segment, subheading};
use crate::scene::description::{SceneDescription, TextureDescription, TextureKind, Triple};
use crate::window::color::swatch;
use crate::window::fields::{FileLine, file_line};
use crate::window::presets;
use crate::window::structure::Part;
use crate::window::theme::ROW_HEIGHT;
use crate::window::widgets::{Figure, pick_one, row};
use egui::Ui;

const KINDS: [(TextureKind, &str); 7] = [
    (TextureKind::Spots, "Spots"),
    (TextureKind::Marble, "Marble"),
    (TextureKind::Clouds, "Clouds"),
    (TextureKind::Wood, "Wood"),
    (TextureKind::Checker, "Checker"),
    (TextureKind::Image, "Image"),
    (TextureKind::Solid, "Solid"),
];
/// Colours beyond this are not shown one by one; a scene file may hold more.
const MOST_COLORS: usize = 16;

/// The textures of the scene, one at a time, and the background.
pub(in crate::window) fn textures_ui(
    ui: &mut Ui,
    scene: &mut SceneDescription,
    selection: &mut Selection,
    preview: impl FnOnce(&mut Ui, &TextureDescription),
) {
    let index =
        part_list(ui, scene, Part::Texture, &mut selection.texture, &mut selection.renaming);
    if let Some(texture) = index.and_then(|index| scene.textures.get_mut(index)) {
        preview(ui, texture);
        texture_ui(ui, texture, &mut selection.wants_file);
    }
    subheading(ui, "Background");
    let names: Vec<(String, bool)> =
        scene.textures.iter().map(|texture| (texture.name.clone(), true)).collect();
    color_or_texture(
        ui,
        "Background",
        "environment.background",
        "what rays see that leave the scene; path tracing is lit by it",
        1e6,
        &mut scene.environment.background,
        &names,
    );
}

fn texture_ui(
    ui: &mut Ui,
    texture: &mut TextureDescription,
    wants_file: &mut Option<(Part, String)>,
) {
    row(ui, "Preset", "replaces the look, keeps the name", |ui| {
        let names = presets::TEXTURES.iter().map(|preset| preset.name);
        if let Some(index) = pick_one(ui, "Texture preset", "", "choose…", names) {
            (presets::TEXTURES[index].apply)(texture);
        }
    });
    let prefix = format!("textures.{}", path_segment(&texture.name));
    row(ui, "Pattern", "", |ui| {
        let shown =
            KINDS.iter().find(|(kind, _)| *kind == texture.kind).map_or("", |(_, name)| name);
        let names = KINDS.iter().map(|(_, name)| *name);
        if let Some(picked) = pick_one(ui, "Pattern", &format!("{prefix}.type"), shown, names) {
            let kind = KINDS[picked].0;
            if kind == TextureKind::Image && texture.file.is_none() {
                // It becomes one with its file.
                *wants_file = Some((Part::Texture, texture.name.clone()));
            } else {
                texture.kind = kind;
                fit_colors(texture);
            }
        }
    });
    if let Some(file) = texture.file.clone() {
        let help = "a PNG or JPEG, relative to the scene";
        let (hint, path) = ("path of a picture", format!("{prefix}.file"));
        match file_line(ui, "Image file", help, hint, &path, &file) {
            FileLine::Left => {}
            FileLine::Entered(file) => texture.file = Some(file),
            FileLine::Choose => *wants_file = Some((Part::Texture, texture.name.clone())),
        }
    }
    figures_ui(ui, texture);
    if texture.kind != TextureKind::Image {
        colors_ui(ui, texture);
    }
}

fn figures_ui(ui: &mut Ui, texture: &mut TextureDescription) {
    let prefix = format!("textures.{}", path_segment(&texture.name));
    let figure = |label, key: &str, usual| Figure::new(label, format!("{prefix}.{key}"), usual);
    if texture.kind != TextureKind::Solid {
        figure("Scale", "scale", 0.1..=50.0)
            .allowed(1e-6..=1e6)
            .logarithmic(0.1)
            .unit(if texture.kind == TextureKind::Image { "×" } else { " /u" })
            .help("cells of the pattern in one scene unit; of an image, repetitions")
            .show(ui, &mut texture.scale);
    }
    if !texture.kind.is_noise() {
        return;
    }
    figure("Octaves", "octaves", 1.0..=12.0)
        .allowed(1.0..=12.0)
        .help("layers of ever finer detail")
        .show_integer(ui, &mut texture.octaves);
    figure("Lacunarity", "lacunarity", 1.0..=4.0)
        .allowed(1e-3..=1e3)
        .help("how much finer each layer is than the one before")
        .show(ui, &mut texture.lacunarity);
    figure("Gain", "gain", 0.0..=1.0)
        .allowed(0.0..=1e3)
        .help("how much each layer counts beside the one before")
        .show(ui, &mut texture.gain);
    figure("Distortion", "distortion", 0.0..=10.0)
        .help("how strongly turbulence bends the pattern")
        .show(ui, &mut texture.distortion);
}

fn colors_ui(ui: &mut Ui, texture: &mut TextureDescription) {
    let path = format!("textures.{}.colors", path_segment(&texture.name));
    let many = texture.kind.is_noise();
    let mut colors = texture.colors.clone().unwrap_or_else(default_ramp);
    row(ui, "Colours", "evenly spaced over the pattern, from low to high", |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let n_shown = colors.len().min(MOST_COLORS) as f32;
        let buttons = if many { 52.0 } else { 0.0 };
        let width = ((ui.available_width() - buttons) / n_shown - 2.0).clamp(8.0, 60.0);
        for (index, color) in colors.iter_mut().take(MOST_COLORS).enumerate() {
            let label = format!("Colour {}", index + 1);
            ui.push_id(index, |ui| swatch(ui, &label, &path, "", width, 1e6, color));
        }
        if many {
            ui.spacing_mut().button_padding.x = 2.0;
            let fewer = egui::Button::new("−").min_size(egui::vec2(22.0, ROW_HEIGHT));
            let fewer = ui.add_enabled(colors.len() > 2, fewer);
            if fewer.on_hover_text("takes the last colour away").clicked() {
                colors.pop();
            }
            let more = egui::Button::new("+").min_size(egui::vec2(22.0, ROW_HEIGHT));
            let more = ui.add_enabled(colors.len() < MOST_COLORS, more);
            if more.on_hover_text("adds a colour at the end").clicked() {
                let last = colors.last().copied().unwrap_or([1.0; 3]);
                colors.push(last);
            }
        }
    });
    if texture.colors.as_ref().is_none_or(|before| *before != colors) {
        let untouched = texture.colors.is_none() && colors == default_ramp();
        if !untouched {
            texture.colors = Some(colors);
        }
    }
}

/// Gives the texture as many colours as its pattern wants: one, two, or at least two.
fn fit_colors(texture: &mut TextureDescription) {
    let n_wanted = match texture.kind {
        TextureKind::Solid => Some(1),
        TextureKind::Checker => Some(2),
        TextureKind::Image => None,
        TextureKind::Spots | TextureKind::Marble | TextureKind::Clouds | TextureKind::Wood => None,
    };
    let colors = texture.colors.get_or_insert_with(default_ramp);
    if let Some(n_wanted) = n_wanted {
        colors.truncate(n_wanted);
    }
    let n_least = n_wanted.unwrap_or(2);
    while colors.len() < n_least {
        colors.push([1.0; 3]);
    }
}

fn default_ramp() -> Vec<Triple> {
    vec![[0.0; 3], [1.0; 3]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_pattern_has_as_many_colours_as_it_needs() {
        let mut texture = TextureDescription {
            name: "a".to_owned(),
            kind: TextureKind::Marble,
            scale: 1.0,
            octaves: 6,
            lacunarity: 2.0,
            gain: 0.5,
            distortion: 0.0,
            colors: Some(vec![[0.1; 3], [0.2; 3], [0.3; 3]]),
            file: None,
        };
        for (kind, n_colors) in
            [(TextureKind::Checker, 2), (TextureKind::Solid, 1), (TextureKind::Wood, 2)]
        {
            texture.kind = kind;
            fit_colors(&mut texture);
            let colors = texture.colors.as_ref().unwrap();
            assert_eq!(colors.len(), n_colors, "{kind:?} has {colors:?}");
        }
    }
}

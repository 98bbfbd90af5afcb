//! Ready-made materials and textures. A preset replaces the look and keeps the name.

use crate::scene::description::{
    ColorOrTexture, MaterialDescription, TextureDescription, TextureKind, WardForm,
};

/// A named way to set a value.
pub(super) struct Preset<T> {
    /// As the list shows it.
    pub(super) name: &'static str,
    /// Sets the look; the name stays.
    pub(super) apply: fn(&mut T),
}

/// Materials, in the order of the list.
pub(super) const MATERIALS: &[Preset<MaterialDescription>] = &[
    Preset { name: "Blue ceramic", apply: blue_ceramic },
    Preset { name: "Brushed metal", apply: brushed_metal },
    Preset { name: "Satin", apply: satin },
    Preset { name: "Matte clay", apply: matte_clay },
    Preset { name: "Glass", apply: glass },
    Preset { name: "Mirror", apply: mirror },
];

/// Textures, in the order of the list.
pub(super) const TEXTURES: &[Preset<TextureDescription>] = &[
    Preset { name: "Spotted egg", apply: spotted_egg },
    Preset { name: "Veined marble", apply: veined_marble },
    Preset { name: "Sky with clouds", apply: sky_with_clouds },
    Preset { name: "Walnut", apply: walnut },
];

fn blue_ceramic(material: &mut MaterialDescription) {
    clear(material);
    material.diffuse = ColorOrTexture::Color([0.02, 0.06, 0.36]);
    material.specular = [0.09, 0.09, 0.09];
    material.alpha_x = 0.06;
    material.alpha_y = 0.18;
    material.ward = WardForm::Bounded;
}

fn brushed_metal(material: &mut MaterialDescription) {
    clear(material);
    material.diffuse = ColorOrTexture::Color([0.06, 0.06, 0.06]);
    material.specular = [0.62, 0.60, 0.57];
    material.alpha_x = 0.05;
    material.alpha_y = 0.32;
    material.ward = WardForm::Bounded;
}

fn satin(material: &mut MaterialDescription) {
    clear(material);
    material.diffuse = ColorOrTexture::Color([0.32, 0.05, 0.09]);
    material.specular = [0.22, 0.14, 0.15];
    material.alpha_x = 0.38;
    material.alpha_y = 0.14;
    material.ward = WardForm::Bounded;
}

fn matte_clay(material: &mut MaterialDescription) {
    clear(material);
    material.diffuse = ColorOrTexture::Color([0.48, 0.22, 0.13]);
}

fn glass(material: &mut MaterialDescription) {
    clear(material);
    material.transmission = [0.97, 0.98, 0.97];
    material.ior = 1.5;
}

fn mirror(material: &mut MaterialDescription) {
    clear(material);
    material.reflection = [0.92, 0.92, 0.92];
}

/// Back to black, without gloss, glass or bump; name and tangent stay.
fn clear(material: &mut MaterialDescription) {
    let tangent = material.tangent;
    *material = MaterialDescription::new(std::mem::take(&mut material.name));
    material.tangent = tangent;
}

fn spotted_egg(texture: &mut TextureDescription) {
    texture.kind = TextureKind::Spots;
    noise(texture, [3.5, 2.0, 0.5, 0.6], 4);
    texture.colors = Some(vec![[0.78, 0.70, 0.56], [0.72, 0.62, 0.46], [0.13, 0.06, 0.03]]);
}

fn veined_marble(texture: &mut TextureDescription) {
    texture.kind = TextureKind::Marble;
    noise(texture, [1.6, 2.1, 0.55, 4.5], 7);
    texture.colors =
        Some(vec![[0.86, 0.85, 0.82], [0.80, 0.79, 0.77], [0.55, 0.54, 0.54], [0.14, 0.15, 0.18]]);
}

fn sky_with_clouds(texture: &mut TextureDescription) {
    texture.kind = TextureKind::Clouds;
    noise(texture, [2.2, 2.0, 0.55, 0.8], 7);
    texture.colors = Some(vec![[0.09, 0.23, 0.62], [0.22, 0.42, 0.80], [0.92, 0.93, 0.95]]);
}

fn walnut(texture: &mut TextureDescription) {
    texture.kind = TextureKind::Wood;
    noise(texture, [4.0, 2.0, 0.5, 0.35], 4);
    texture.colors = Some(vec![[0.26, 0.12, 0.05], [0.16, 0.07, 0.03], [0.09, 0.035, 0.015]]);
}

fn noise(texture: &mut TextureDescription, figures: [f64; 4], octaves: u32) {
    let [scale, lacunarity, gain, distortion] = figures;
    texture.scale = scale;
    texture.lacunarity = lacunarity;
    texture.gain = gain;
    texture.distortion = distortion;
    texture.octaves = octaves;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_material_preset_keeps_the_name_and_sets_all_of_the_look() {
        for preset in MATERIALS {
            let mut plain = MaterialDescription::new("cup");
            (preset.apply)(&mut plain);
            let mut busy = MaterialDescription::new("cup");
            busy.emission = [3.0; 3];
            busy.transmission = [0.5; 3];
            busy.ward = WardForm::Duer;
            (preset.apply)(&mut busy);
            assert_eq!(plain, busy, "{} leaves some of the old look", preset.name);
            assert_eq!(plain.name, "cup", "{} renames", preset.name);
            assert_ne!(plain, MaterialDescription::new("cup"), "{} does nothing", preset.name);
        }
    }
}

//! Adding, copying, renaming and removing the parts of a scene, names and references kept whole.

use crate::scene::description::{
    ColorOrTexture, LightDescription, LightKind, MaterialDescription, ObjectDescription,
    ObjectKind, OneOrTwo, SceneDescription, TextureDescription, TextureKind, Triple,
};

/// What the scene's lists hold: each has a name that is unique in its list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Light,
    Material,
    Texture,
    Object,
}

/// The names of all parts of one kind, in file order.
pub(super) fn names(scene: &SceneDescription, part: Part) -> Vec<&str> {
    match part {
        Part::Light => scene.lights.iter().map(|light| light.name.as_str()).collect(),
        Part::Material => scene.materials.iter().map(|material| material.name.as_str()).collect(),
        Part::Texture => scene.textures.iter().map(|texture| texture.name.as_str()).collect(),
        Part::Object => scene.objects.iter().map(|object| object.name.as_str()).collect(),
    }
}

/// Adds a part with useful first values near `place`; gives back its index.
pub(super) fn add(scene: &mut SceneDescription, part: Part, place: Triple, reach: f64) -> usize {
    match part {
        Part::Light => {
            let name = free_name(scene, part, "light");
            scene.lights.push(new_light(name, place, reach));
        }
        Part::Material => {
            let mut material = MaterialDescription::new(free_name(scene, part, "material"));
            material.diffuse = ColorOrTexture::Color([0.5; 3]);
            scene.materials.push(material);
        }
        Part::Texture => {
            let name = free_name(scene, part, "texture");
            scene.textures.push(new_texture(name));
        }
        Part::Object => {
            let name = free_name(scene, part, "object");
            let mut object = ObjectDescription::new(name, ObjectKind::Sphere);
            complete(&mut object, round(reach * 0.12));
            object.translate = place;
            scene.objects.push(object);
        }
    }
    names(scene, part).len() - 1
}

/// Adds a copy of a part behind it under a free name; gives back the copy's index.
pub(super) fn duplicate(scene: &mut SceneDescription, part: Part, index: usize) -> usize {
    let Some(base) = names(scene, part).get(index).map(|name| (*name).to_owned()) else {
        return index;
    };
    let name = free_name(scene, part, &base);
    match part {
        Part::Light => copy_behind(&mut scene.lights, index, |light| light.name = name),
        Part::Material => copy_behind(&mut scene.materials, index, |material| material.name = name),
        Part::Texture => copy_behind(&mut scene.textures, index, |texture| texture.name = name),
        Part::Object => copy_behind(&mut scene.objects, index, |object| object.name = name),
    }
    index + 1
}

/// Gives the texture or the object of that name its file, and with it the kind that has one.
pub(super) fn set_file(scene: &mut SceneDescription, part: Part, name: &str, file: String) {
    match part {
        Part::Texture => {
            let texture = scene.textures.iter_mut().find(|texture| texture.name == name);
            if let Some(texture) = texture {
                (texture.kind, texture.file) = (TextureKind::Image, Some(file));
            }
        }
        Part::Object => {
            if let Some(object) = scene.objects.iter_mut().find(|object| object.name == name) {
                (object.kind, object.file) = (ObjectKind::Mesh, Some(file));
            }
        }
        // They have none.
        Part::Light | Part::Material => {}
    }
}

/// Removes a part. Objects that wore a removed material turn to the neutral grey; colours that
/// came from a removed texture turn to grey, and its bumps go.
pub(super) fn remove(scene: &mut SceneDescription, part: Part, index: usize) {
    if names(scene, part).len() <= index {
        return;
    }
    match part {
        Part::Light => {
            scene.lights.remove(index);
        }
        Part::Object => {
            scene.objects.remove(index);
        }
        Part::Material => {
            let gone = scene.materials.remove(index).name;
            for object in &mut scene.objects {
                if object.material.as_ref() == Some(&gone) {
                    object.material = None;
                }
            }
        }
        Part::Texture => {
            let gone = scene.textures.remove(index).name;
            for_each_texture_name(scene, |color| {
                if color == &ColorOrTexture::Texture(gone.clone()) {
                    *color = ColorOrTexture::Color([0.5; 3]);
                }
            });
            for material in &mut scene.materials {
                if material.bump.as_ref().is_some_and(|bump| bump.texture == gone) {
                    material.bump = None;
                }
            }
        }
    }
}

/// Gives a part another name, and all that refer to it with it. A name that is empty or taken
/// changes nothing and is refused.
pub(super) fn rename(
    scene: &mut SceneDescription,
    part: Part,
    index: usize,
    new: &str,
) -> Result<(), NameError> {
    let new = new.trim();
    if new.is_empty() {
        return Err(NameError::Empty);
    }
    let all = names(scene, part);
    let Some(old) = all.get(index).map(|name| (*name).to_owned()) else { return Ok(()) };
    if all.iter().enumerate().any(|(other, name)| other != index && *name == new) {
        return Err(NameError::Taken { name: new.to_owned() });
    }
    match part {
        Part::Light => new.clone_into(&mut scene.lights[index].name),
        Part::Object => new.clone_into(&mut scene.objects[index].name),
        Part::Material => {
            new.clone_into(&mut scene.materials[index].name);
            for object in &mut scene.objects {
                if object.material.as_ref() == Some(&old) {
                    object.material = Some(new.to_owned());
                }
            }
        }
        Part::Texture => {
            new.clone_into(&mut scene.textures[index].name);
            for_each_texture_name(scene, |color| {
                if color == &ColorOrTexture::Texture(old.clone()) {
                    *color = ColorOrTexture::Texture(new.to_owned());
                }
            });
            for bump in scene.materials.iter_mut().filter_map(|material| material.bump.as_mut()) {
                if bump.texture == old {
                    new.clone_into(&mut bump.texture);
                }
            }
        }
    }
    Ok(())
}

/// Why a part cannot have that name.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum NameError {
    #[error("a name needs at least one letter")]
    Empty,
    #[error("the name \"{name}\" is taken")]
    Taken { name: String },
}

/// Gives an object the keys its type needs, where they are absent, at that size.
pub(super) fn complete(object: &mut ObjectDescription, size: f64) {
    let size = if size > 0.0 { size } else { 1.0 };
    match object.kind {
        ObjectKind::Mesh => {}
        ObjectKind::Sphere => {
            object.center.get_or_insert([0.0; 3]);
            object.radius.get_or_insert(size);
        }
        ObjectKind::Plane => {
            object.point.get_or_insert([0.0; 3]);
            object.normal.get_or_insert([0.0, 1.0, 0.0]);
        }
        ObjectKind::Box => {
            object.min.get_or_insert([-size; 3]);
            object.max.get_or_insert([size; 3]);
        }
        ObjectKind::Cone => {
            object.base.get_or_insert([0.0; 3]);
            object.tip.get_or_insert([0.0, 2.0 * size, 0.0]);
            object.radius.get_or_insert(size);
        }
        ObjectKind::Cylinder => {
            object.base.get_or_insert([0.0; 3]);
            object.top.get_or_insert([0.0, 2.0 * size, 0.0]);
            object.radius.get_or_insert(size);
        }
    }
}

/// `base` itself, or with the lowest number behind it that no other has.
fn free_name(scene: &SceneDescription, part: Part, base: &str) -> String {
    let taken = names(scene, part);
    let stem = base.trim_end_matches(|c: char| c.is_ascii_digit());
    let stem = stem.strip_suffix('-').unwrap_or(stem);
    let stem = if stem.is_empty() { base } else { stem };
    (1..=taken.len() + 1)
        .map(|number| format!("{stem}-{number}"))
        .find(|name| !taken.contains(&name.as_str()))
        .unwrap_or_else(|| format!("{stem}-{}", taken.len() + 2))
}

fn copy_behind<T: Clone>(list: &mut Vec<T>, index: usize, rename: impl FnOnce(&mut T)) {
    if let Some(mut copy) = list.get(index).cloned() {
        rename(&mut copy);
        list.insert(index + 1, copy);
    }
}

fn for_each_texture_name(scene: &mut SceneDescription, mut edit: impl FnMut(&mut ColorOrTexture)) {
    edit(&mut scene.environment.background);
    for material in &mut scene.materials {
        edit(&mut material.diffuse);
    }
}

/// A soft rectangle above and to the side of what is looked at, bright enough for that distance.
fn new_light(name: String, place: Triple, reach: f64) -> LightDescription {
    let power = round(8.0 * reach * reach);
    let away = |axis: usize, share: f64| place[axis] + round(share * reach);
    LightDescription {
        name,
        kind: LightKind::Rectangle,
        position: [away(0, 0.5), away(1, 0.8), away(2, 0.5)],
        target: place,
        up: [0.0, 1.0, 0.0],
        size: OneOrTwo::One(round(0.3 * reach)),
        power: [power; 3],
        visible: true,
        enabled: true,
    }
}

/// A figure that a person would have typed: two digits that count.
fn round(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

fn new_texture(name: String) -> TextureDescription {
    TextureDescription {
        name,
        kind: TextureKind::Marble,
        scale: 2.0,
        octaves: 6,
        lacunarity: 2.0,
        gain: 0.5,
        distortion: 4.0,
        colors: Some(vec![[0.9, 0.9, 0.88], [0.2, 0.2, 0.24]]),
        file: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{BumpDescription, CameraDescription};

    fn scene() -> SceneDescription {
        let camera = CameraDescription {
            eye: [0.0, 0.0, 5.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            vertical_fov: 40.0,
            aperture_radius: 0.0,
            focal_distance: None,
            aperture_blades: 0,
        };
        let mut scene = SceneDescription {
            render: Default::default(),
            camera,
            tone_mapping: Default::default(),
            environment: Default::default(),
            textures: vec![new_texture("veins".to_owned())],
            materials: vec![MaterialDescription::new("stone")],
            lights: vec![],
            objects: vec![ObjectDescription::new("egg", ObjectKind::Sphere)],
        };
        scene.environment.background = ColorOrTexture::Texture("veins".to_owned());
        scene.materials[0].diffuse = ColorOrTexture::Texture("veins".to_owned());
        scene.materials[0].bump =
            Some(BumpDescription { texture: "veins".to_owned(), height: 0.1 });
        scene.objects[0].material = Some("stone".to_owned());
        scene
    }

    #[test]
    fn renaming_takes_every_reference_along() {
        let mut scene = scene();
        rename(&mut scene, Part::Texture, 0, "clouds").unwrap();
        rename(&mut scene, Part::Material, 0, "glaze").unwrap();
        let clouds = ColorOrTexture::Texture("clouds".to_owned());
        assert_eq!(scene.environment.background, clouds, "background lost its texture");
        assert_eq!(scene.materials[0].diffuse, clouds, "diffuse lost its texture");
        assert_eq!(scene.materials[0].bump.as_ref().unwrap().texture, "clouds", "bump lost it");
        assert_eq!(scene.objects[0].material.as_deref(), Some("glaze"), "object lost it");
    }

    #[test]
    fn a_taken_or_empty_name_is_refused_and_changes_nothing() {
        let mut scene = scene();
        add(&mut scene, Part::Material, [0.0; 3], 1.0);
        let before = scene.clone();
        let taken = rename(&mut scene, Part::Material, 1, "stone");
        assert_eq!(taken, Err(NameError::Taken { name: "stone".to_owned() }), "accepted");
        assert_eq!(rename(&mut scene, Part::Material, 1, "  "), Err(NameError::Empty), "accepted");
        assert_eq!(scene, before, "a refused name changed the scene");
    }

    #[test]
    fn removing_leaves_no_name_that_resolves_to_nothing() {
        let mut scene = scene();
        remove(&mut scene, Part::Texture, 0);
        remove(&mut scene, Part::Material, 0);
        let grey = ColorOrTexture::Color([0.5; 3]);
        assert_eq!(scene.environment.background, grey, "background names a lost texture");
        assert_eq!(scene.objects[0].material, None, "object names a lost material");
    }

    #[test]
    fn what_is_added_has_figures_that_a_person_would_type() {
        let mut scene = scene();
        add(&mut scene, Part::Light, [0.0; 3], 8.104936767180853);
        add(&mut scene, Part::Object, [0.0; 3], 8.104936767180853);
        let light = &scene.lights[0];
        assert_eq!((light.position, light.power), ([4.1, 6.5, 4.1], [530.0; 3]), "long figures");
        assert_eq!(light.size, OneOrTwo::One(2.4), "a long size");
        assert_eq!(scene.objects[1].radius, Some(0.97), "a long radius");
    }

    #[test]
    fn copies_and_additions_have_names_of_their_own() {
        let mut scene = scene();
        for part in [Part::Light, Part::Material, Part::Texture, Part::Object] {
            let first = add(&mut scene, part, [0.0; 3], 2.0);
            let second = duplicate(&mut scene, part, first);
            duplicate(&mut scene, part, second);
            let mut all = names(&scene, part);
            let n_before = all.len();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), n_before, "{part:?} share a name: {all:?}");
        }
    }
}

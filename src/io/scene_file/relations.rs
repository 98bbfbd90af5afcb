//! What must hold between the values of a scene: names that are used exist, directions point
//! somewhere, every type has the keys it needs.
//!
//! Works on a description whose values have been found good one by one.

use std::collections::BTreeMap;

use crate::scene::description::{
    CameraDescription, ColorOrTexture, LightDescription, LightKind, MaterialDescription,
    ObjectDescription, ObjectKind, OneOrTwo, SceneDescription, TextureDescription, TextureKind,
    Triple,
};

use super::check::{Fault, missing};
use super::keys::Section;
use super::slot::Step;
use super::words::{quoted, shown_name, suggestion};

/// Below this, the sine of the angle between two directions counts as 0.
const PARALLEL: f64 = 1e-6;

/// The first of a scene's values that does not go with the others.
pub(super) fn check_relations(scene: &SceneDescription) -> Result<(), Fault> {
    let textures = scene.textures.iter().map(|texture| (&*texture.name, texture.kind)).collect();
    let materials = scene.materials.iter().map(|material| (&*material.name, ())).collect();
    check_camera(&scene.camera)?;
    let environment = Place { section: Section::Environment, entry: None };
    check_color(&environment, "background", &scene.environment.background, &textures)?;
    for (i, texture) in scene.textures.iter().enumerate() {
        check_texture(&Place { section: Section::Textures, entry: Some(i) }, texture)?;
    }
    for (i, material) in scene.materials.iter().enumerate() {
        check_material(
            &Place { section: Section::Materials, entry: Some(i) },
            material,
            &textures,
        )?;
    }
    for (i, light) in scene.lights.iter().enumerate() {
        check_light(&Place { section: Section::Lights, entry: Some(i) }, light)?;
    }
    for (i, object) in scene.objects.iter().enumerate() {
        check_object(&Place { section: Section::Objects, entry: Some(i) }, object, &materials)?;
    }
    Ok(())
}

/// Names to choose from, and what else is known of what they name.
type Names<'a, T> = BTreeMap<&'a str, T>;

/// The section or entry that is looked at.
struct Place {
    section: Section,
    entry: Option<usize>,
}

impl Place {
    fn steps(&self, keys: &[&str]) -> Vec<Step> {
        let mut steps = vec![Step::key(self.section.name())];
        steps.extend(self.entry.map(Step::Index));
        steps.extend(keys.iter().map(|key| Step::key(key)));
        steps
    }

    fn fault(&self, key: &str, cause: &str, message: impl Into<String>) -> Fault {
        Fault {
            cause: Some(self.steps(&[cause])),
            ..Fault::new(self.steps(&[key]), message.into())
        }
    }

    /// The fault of a key that this type needs.
    fn missing(&self, name: &str, kind: &str) -> Fault {
        let steps = self.steps(&[]);
        let cause = Some(self.steps(&["type"]));
        match self.section.keys().iter().find(|key| key.name == name) {
            Some(key) => {
                let message =
                    format!("this key is required by type {kind:?}; give {}", key.rule.remedy());
                Fault { cause, message, ..missing(key, &steps) }
            }
            None => Fault::new(steps, format!("{name} is required by type {kind:?}")),
        }
    }
}

fn check_camera(camera: &CameraDescription) -> Result<(), Fault> {
    let place = Place { section: Section::Camera, entry: None };
    if coincide(camera.eye, camera.target) {
        return Err(place.fault("target", "eye", "this is where the eye is; give another point"));
    }
    let forward = unit(difference(camera.target, camera.eye));
    if length(cross(forward, unit(camera.up))) < PARALLEL {
        let message = format!(
            "{:?} is parallel to the view from eye to target; give a direction that is not",
            camera.up
        );
        let cause = Some(place.steps(&["target"]));
        return Err(Fault { cause, ..place.fault("up", "eye", message) });
    }
    Ok(())
}

fn check_color(
    place: &Place,
    key: &str,
    color: &ColorOrTexture,
    textures: &Names<'_, TextureKind>,
) -> Result<(), Fault> {
    match color {
        ColorOrTexture::Color(_) => Ok(()),
        ColorOrTexture::Texture(name) => check_name(place, &[key], name, "texture", textures),
    }
}

fn check_name<T>(
    place: &Place,
    keys: &[&str],
    name: &str,
    noun: &str,
    names: &Names<'_, T>,
) -> Result<(), Fault> {
    if names.contains_key(name) {
        return Ok(());
    }
    let hint = suggestion(name, names.keys().copied(), quoted);
    let hint = if hint.is_empty() { format!("; this scene has no {noun}s") } else { hint };
    let message = format!("there is no {noun} {}{hint}", shown_name(name));
    Err(Fault::new(place.steps(keys), message))
}

fn check_texture(place: &Place, texture: &TextureDescription) -> Result<(), Fault> {
    let n_colors = texture.colors.as_ref().map(Vec::len);
    let (kind, wanted, is_right) = match texture.kind {
        TextureKind::Solid if n_colors.is_none() => return Err(place.missing("colors", "solid")),
        TextureKind::Solid => ("solid", "one colour", n_colors == Some(1)),
        TextureKind::Checker => ("checker", "two colours", n_colors.is_none_or(|n| n == 2)),
        TextureKind::Image if texture.file.is_none() => return Err(place.missing("file", "image")),
        TextureKind::Image => return Ok(()),
        TextureKind::Spots | TextureKind::Marble | TextureKind::Clouds | TextureKind::Wood => {
            ("noise", "two colours or more", n_colors.is_none_or(|n| 2 <= n))
        }
    };
    if is_right {
        return Ok(());
    }
    let found = n_colors.unwrap_or_default();
    Err(place.fault("colors", "type", format!("a {kind} texture takes {wanted}, not {found}")))
}

fn check_material(
    place: &Place,
    material: &MaterialDescription,
    textures: &Names<'_, TextureKind>,
) -> Result<(), Fault> {
    check_color(place, "diffuse", &material.diffuse, textures)?;
    let Some(bump) = &material.bump else {
        return Ok(());
    };
    check_name(place, &["bump", "texture"], &bump.texture, "texture", textures)?;
    let kind = match textures.get(&*bump.texture) {
        Some(TextureKind::Solid) => "solid",
        Some(TextureKind::Checker) => "checker",
        _ => return Ok(()),
    };
    let message = format!(
        "{} is of type {kind:?}, which has no slopes; give a noise or image texture",
        shown_name(&bump.texture)
    );
    Err(Fault::new(place.steps(&["bump", "texture"]), message))
}

fn check_light(place: &Place, light: &LightDescription) -> Result<(), Fault> {
    let is_aimed = match light.kind {
        LightKind::Rectangle | LightKind::Disk | LightKind::Sun => true,
        LightKind::Sphere | LightKind::Point => false,
    };
    if is_aimed && coincide(light.position, light.target) {
        let message = "this is the light's own position; give a point on the side that it faces";
        return Err(place.fault("target", "position", message));
    }
    let takes_one = match light.kind {
        LightKind::Disk => Some("disk"),
        LightKind::Sphere => Some("sphere"),
        LightKind::Sun => Some("sun"),
        LightKind::Rectangle | LightKind::Point => None,
    };
    if let (Some(kind), OneOrTwo::Two(size)) = (takes_one, light.size) {
        let message =
            format!("{size:?} is not the size of a {kind}; give one number, its diameter");
        return Err(place.fault("size", "type", message));
    }
    let [width, height] = light.size.pair();
    if (width == 0.0) != (height == 0.0) {
        let message = format!(
            "{:?} is neither a point nor a surface; give two numbers above 0, or 0",
            [width, height]
        );
        return Err(place.fault("size", "type", message));
    }
    if light.kind == LightKind::Sun && 180.0 < width {
        let message =
            format!("{width:?} is not the angular diameter of a sun; give degrees from 0 to 180");
        return Err(place.fault("size", "type", message));
    }
    Ok(())
}

fn check_object(
    place: &Place,
    object: &ObjectDescription,
    materials: &Names<'_, ()>,
) -> Result<(), Fault> {
    let require =
        |kind, keys: &[(&'static str, bool)]| match keys.iter().find(|(_, is_there)| !is_there) {
            Some((key, _)) => Err(place.missing(key, kind)),
            None => Ok(()),
        };
    let radius = ("radius", object.radius.is_some());
    let base = ("base", object.base.is_some());
    match object.kind {
        ObjectKind::Mesh => require("mesh", &[("file", object.file.is_some())])?,
        ObjectKind::Sphere => require("sphere", &[("center", object.center.is_some()), radius])?,
        ObjectKind::Plane => {
            let keys = [("point", object.point.is_some()), ("normal", object.normal.is_some())];
            require("plane", &keys)?;
        }
        ObjectKind::Box => {
            require("box", &[("min", object.min.is_some()), ("max", object.max.is_some())])?;
            check_box(place, object)?;
        }
        ObjectKind::Cone => {
            require("cone", &[base, ("tip", object.tip.is_some()), radius])?;
            check_axis(place, object.base, "tip", object.tip)?;
        }
        ObjectKind::Cylinder => {
            require("cylinder", &[base, ("top", object.top.is_some()), radius])?;
            check_axis(place, object.base, "top", object.top)?;
        }
    }
    match &object.material {
        Some(name) => check_name(place, &["material"], name, "material", materials),
        None => Ok(()),
    }
}

fn check_box(place: &Place, object: &ObjectDescription) -> Result<(), Fault> {
    let (Some(min), Some(max)) = (object.min, object.max) else {
        return Ok(());
    };
    if (0..3).all(|axis| min[axis] <= max[axis]) {
        return Ok(());
    }
    let message = format!("{max:?} is below min {min:?} on some axis; give the upper corner");
    Err(place.fault("max", "min", message))
}

fn check_axis(
    place: &Place,
    base: Option<Triple>,
    key: &str,
    end: Option<Triple>,
) -> Result<(), Fault> {
    match (base, end) {
        (Some(base), Some(end)) if coincide(base, end) => {
            Err(place.fault(key, "base", "this is where the base is; give another point"))
        }
        _ => Ok(()),
    }
}

/// Whether two points are one to the renderer, which works in `f32`.
fn coincide(a: Triple, b: Triple) -> bool {
    let are_same = (0..3).all(|axis| a[axis] as f32 == b[axis] as f32);
    are_same || length(difference(a, b)) < super::range::SMALLEST
}

fn difference(a: Triple, b: Triple) -> Triple {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Triple, b: Triple) -> Triple {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(v: Triple) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

fn unit(v: Triple) -> Triple {
    let length = length(v);
    v.map(|x| x / length)
}

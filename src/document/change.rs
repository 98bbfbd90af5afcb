//! What an edit touches, found by comparing: whether the picture must begin anew, and how much
//! of the scene must be made again.

use std::collections::BTreeSet;

use crate::scene::description::{
    LightDescription, MaterialDescription, ObjectDescription, ObjectKind, RenderDescription,
    SceneDescription, TextureDescription, TextureKind,
};

/// The most that a change touches, from nothing to the files that a scene is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ChangeKind {
    /// The descriptions are equal.
    None,
    /// How the picture is shown, when it is finished, what things are called: every sample taken
    /// so far stays good.
    Display,
    /// How samples are taken: size, depth, integrator, seed.
    Sampling,
    /// Where the picture is taken from, and through which lens.
    Camera,
    /// Lights, ambient light and background.
    Lights,
    /// Materials, textures, and which object has which.
    Materials,
    /// Shapes and where they are; no file that is not known already.
    Geometry,
    /// Which meshes and images are used.
    Assets,
}

impl ChangeKind {
    /// Whether samples taken before the change are worthless, so that accumulation restarts.
    pub fn restarts(self) -> bool {
        match self {
            Self::None | Self::Display => false,
            Self::Sampling
            | Self::Camera
            | Self::Lights
            | Self::Materials
            | Self::Geometry
            | Self::Assets => true,
        }
    }
}

/// What the way from one description to another touches. What is harmless is named here; all else
/// restarts the picture.
pub fn change(before: &SceneDescription, after: &SceneDescription) -> ChangeKind {
    if before == after {
        ChangeKind::None
    } else if files(before) != files(after) {
        ChangeKind::Assets
    } else if differ(&before.objects, &after.objects, shape) {
        ChangeKind::Geometry
    } else if differ(&before.materials, &after.materials, MaterialDescription::clone)
        || differ(&before.textures, &after.textures, TextureDescription::clone)
        || differ(&before.objects, &after.objects, |object| object.material.clone())
    {
        ChangeKind::Materials
    } else if before.environment != after.environment
        || differ(&before.lights, &after.lights, shine)
    {
        ChangeKind::Lights
    } else if before.camera != after.camera {
        ChangeKind::Camera
    } else if sampling(&before.render) != sampling(&after.render) {
        ChangeKind::Sampling
    } else {
        ChangeKind::Display
    }
}

/// The files that a scene is made of.
fn files(scene: &SceneDescription) -> BTreeSet<&str> {
    let meshes = scene.objects.iter().filter(|object| object.kind == ObjectKind::Mesh);
    let images = scene.textures.iter().filter(|texture| texture.kind == TextureKind::Image);
    let files = meshes.map(|mesh| &mesh.file).chain(images.map(|image| &image.file));
    files.flatten().map(String::as_str).collect()
}

/// Whether two lists differ in what is seen of their entries.
fn differ<T, S: PartialEq>(before: &[T], after: &[T], seen: impl Fn(&T) -> S) -> bool {
    !before.iter().map(&seen).eq(after.iter().map(&seen))
}

/// An object but for its name and material.
fn shape(object: &ObjectDescription) -> ObjectDescription {
    ObjectDescription { name: String::new(), material: None, ..object.clone() }
}

/// A light but for its name.
fn shine(light: &LightDescription) -> LightDescription {
    LightDescription { name: String::new(), ..light.clone() }
}

/// The settings but for the number of samples at which a render is finished.
fn sampling(render: &RenderDescription) -> RenderDescription {
    RenderDescription { samples: 0, ..render.clone() }
}

#[cfg(test)]
mod tests {
    use toml::Value;

    use super::*;
    use crate::document::Document;
    use crate::io::scene_file::{ParameterPath, Rule, Section, parse};

    const FULL: &str = include_str!("../io/scene_file/full.toml");

    /// What a change of one parameter of the full scene is, by what the contract says of it.
    fn expected(path: &ParameterPath) -> ChangeKind {
        let names: Vec<&str> = path.names().iter().map(String::as_str).collect();
        match names[..] {
            ["render", "samples"] | ["tone_mapping", _] => ChangeKind::Display,
            ["lights" | "objects", _, "name"] => ChangeKind::Display,
            ["render", _] => ChangeKind::Sampling,
            ["camera", _] => ChangeKind::Camera,
            ["environment", _] | ["lights", ..] => ChangeKind::Lights,
            ["textures", "label", "file" | "type"] => ChangeKind::Assets,
            ["objects", "my teapot", "file" | "type"] => ChangeKind::Assets,
            ["textures" | "materials", ..] | ["objects", _, "material"] => ChangeKind::Materials,
            ["objects", ..] => ChangeKind::Geometry,
            _ => panic!("{path} is not in this table"),
        }
    }

    /// Values to try in place of another.
    fn others(path: &ParameterPath, value: Option<Value>) -> Vec<Value> {
        let names = path.names();
        let section = Section::named(&names[0]).unwrap();
        let last = names.last().unwrap();
        let keys = section.keys().iter().flat_map(|key| match key.rule {
            Rule::Table(inner) => inner.iter(),
            _ => std::slice::from_ref(key).iter(),
        });
        let key = keys.into_iter().find(|key| key.name == last).unwrap();
        match (key.rule, value) {
            (Rule::Word(words), Some(value)) => {
                words.iter().map(|word| Value::from(*word)).filter(|word| *word != value).collect()
            }
            (_, Some(value)) => vec![other(value)],
            (Rule::Text, None) => vec!["ceramic".into()],
            (Rule::File, None) => vec!["new.png".into()],
            (Rule::Number(_), None) => vec![2.0.into()],
            (Rule::Triple(_) | Rule::Direction, None) => vec![vec![1.0, 5.0, 3.0].into()],
            (Rule::Colors, None) => vec![vec![vec![0.5; 3]; 2].into()],
            (rule, None) => panic!("{path}: no other value for {rule:?}"),
        }
    }

    fn other(value: Value) -> Value {
        match value {
            Value::Integer(n) => (n + 1).into(),
            Value::Float(x) => (0.75 * x + 0.0625).into(),
            Value::Boolean(flag) => (!flag).into(),
            Value::String(text) if text == "sky" => "label".into(),
            Value::String(text) => format!("other {text}").into(),
            Value::Array(array) => {
                let last = array.len() - 1;
                let change = |(i, x)| if i == last { other(x) } else { x };
                array.into_iter().enumerate().map(change).collect::<Vec<_>>().into()
            }
            value => panic!("no other value for {value}"),
        }
    }

    #[test]
    fn display_settings_never_restart_and_everything_else_does() {
        // A filter has one value yet, and what is referred to by name cannot be renamed alone.
        let fixed = ["render.filter", "textures.sky.name", "materials.ceramic.name"];
        let mut scene = parse(FULL, &[]).unwrap();
        // So that the mesh can become a sphere, and of another material.
        let name = "other ceramic".into();
        scene.materials.push(MaterialDescription { name, ..scene.materials[0].clone() });
        (scene.objects[0].center, scene.objects[0].radius) = (Some([1.0; 3]), Some(2.0));
        let document = Document::new(scene, None);
        let paths = document.parameters();
        assert!(90 < paths.len(), "{} parameters", paths.len());
        for path in paths {
            let text = path.to_string();
            let value = document.get(&text).unwrap();
            let mut edited = document.clone();
            let is_changed = others(&path, value).into_iter().any(|v| edited.set(&text, v).is_ok());
            assert_eq!(is_changed, !fixed.contains(&&*text), "{path} was changed");
            if !is_changed {
                continue;
            }
            let kind = change(&document.description, &edited.description);
            assert_eq!(kind, expected(&path), "{path}");
            let is_display = path.names()[0] == "tone_mapping" || text == "render.samples";
            let is_label = text.ends_with(".name") && kind == ChangeKind::Display;
            assert_eq!(kind.restarts(), !(is_display || is_label), "{path}");
        }
        assert_eq!(change(&document.description, &document.description), ChangeKind::None, "same");
    }

    #[test]
    fn entries_that_come_go_or_change_places_restart() {
        let scene = parse(FULL, &[]).unwrap();
        type Edit = fn(&mut SceneDescription);
        let edits: [(Edit, ChangeKind); 6] = [
            (|s| s.lights.clear(), ChangeKind::Lights),
            (|s| s.objects.swap(0, 1), ChangeKind::Geometry),
            (|s| s.objects.truncate(1), ChangeKind::Geometry),
            (|s| s.objects.clear(), ChangeKind::Assets),
            (|s| s.textures.truncate(1), ChangeKind::Assets),
            (|s| s.materials.push(MaterialDescription::new("new")), ChangeKind::Materials),
        ];
        for (i, (edit, kind)) in edits.into_iter().enumerate() {
            let mut edited = scene.clone();
            edit(&mut edited);
            assert_eq!(change(&scene, &edited), kind, "edit {i}");
        }
    }
}

//! One parameter of a description at a time, by its path: what the window, undo and `--set` share.

use toml::{Table, Value};

use crate::scene::description::SceneDescription;

use super::keys::{Key, Presence, Rule, Section};
use super::path::{ParameterPath, PathError};
use super::slot::entry_name;
use super::{Invalid, scene_of, table_of};

/// Why a parameter keeps its value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// The path names no parameter.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The scene would not be valid.
    #[error(transparent)]
    Invalid(#[from] Invalid),
}

/// The paths of all parameters of a scene, in the order of a file: those that have a value and
/// those that could have one.
pub fn parameters(scene: &SceneDescription) -> Vec<ParameterPath> {
    all_paths(&table_of(scene))
}

/// All parameters that have a value, with it.
pub fn values(scene: &SceneDescription) -> Vec<(ParameterPath, Value)> {
    let root = table_of(scene);
    let known = |path: ParameterPath| {
        let value = path.resolve(&root).ok()?.get(&root)?.clone();
        Some((path, value))
    };
    all_paths(&root).into_iter().filter_map(known).collect()
}

/// The value of a parameter; `None` where it is absent and has no default that is a value, such
/// as `camera.focal_distance`.
pub fn get(scene: &SceneDescription, path: &ParameterPath) -> Result<Option<Value>, PathError> {
    let root = table_of(scene);
    Ok(path.resolve(&root)?.get(&root).cloned())
}

/// The scene with another value for one parameter, if it is valid then.
pub fn with_value(
    scene: &SceneDescription,
    path: &ParameterPath,
    value: Value,
) -> Result<SceneDescription, EditError> {
    let mut root = table_of(scene);
    path.resolve(&root)?.set(&mut root, value);
    valid_scene(&root)
}

/// The scene with one parameter at its default, or absent; a required one has no default.
pub fn with_default(
    scene: &SceneDescription,
    path: &ParameterPath,
) -> Result<SceneDescription, EditError> {
    let mut root = table_of(scene);
    let slot = path.resolve(&root)?;
    let key = slot.innermost();
    if key.presence == Presence::Required || key.name == "name" {
        return Err(path.error("has no default; give a value".into()).into());
    }
    slot.remove(&mut root);
    valid_scene(&root)
}

/// Whether a parameter of that path has a default, so that [`with_default`] can give it.
pub fn has_default(path: &ParameterPath) -> bool {
    let mut names = path.names().iter();
    let Some(section) = names.next().and_then(|name| Section::named(name)) else { return false };
    if section.entry_noun().is_some() {
        names.next();
    }
    let named = |keys: &'static [Key], name: &String| keys.iter().find(|key| key.name == name);
    let key = names.next().and_then(|name| named(section.keys(), name));
    let innermost = match (key.map(|key| key.rule), names.next()) {
        (Some(Rule::Table(keys)), Some(inner)) => named(keys, inner),
        _ => key,
    };
    innermost.is_some_and(|key| key.presence != Presence::Required && key.name != "name")
}

fn valid_scene(root: &Table) -> Result<SceneDescription, EditError> {
    scene_of(root).map_err(|fault| Invalid::of(fault, root).into())
}

pub(super) fn all_paths(root: &Table) -> Vec<ParameterPath> {
    let mut paths = Vec::new();
    for section in Section::ALL {
        let prefixes: Vec<Vec<&str>> = if section.entry_noun().is_none() {
            vec![vec![section.name()]]
        } else {
            let entries = root.get(section.name()).and_then(Value::as_array);
            let names = entries.into_iter().flatten().filter_map(entry_name);
            names.map(|name| vec![section.name(), name]).collect()
        };
        for prefix in prefixes {
            for key in section.keys() {
                let path = |last: &[&str]| {
                    ParameterPath::new(prefix.iter().chain(last).map(|name| String::from(*name)))
                };
                match key.rule {
                    Rule::Table(inner) => {
                        paths.extend(inner.iter().map(|inner| path(&[key.name, inner.name])));
                    }
                    _ => paths.push(path(&[key.name])),
                }
            }
        }
    }
    paths
}

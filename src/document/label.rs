//! What an edit is called, found by comparing: "light key size".

use std::collections::BTreeMap;

use toml::Value;

use crate::io::scene_file::{Section, values};
use crate::scene::description::SceneDescription;

/// Parameters that say where the camera is.
const PLACE: [&str; 3] = ["eye", "target", "up"];

/// What undo would say that it undoes: which entry came, went or has another name, else the
/// parameter that is another, else the entry or the section that it is in.
pub(super) fn edit_label(before: &SceneDescription, after: &SceneDescription) -> String {
    let (before, after) = (known(before), known(after));
    let lists =
        Section::ALL.into_iter().filter_map(|section| Some((section, section.entry_noun()?)));
    for (section, noun) in lists {
        let (old, new) = (names(&before, section), names(&after, section));
        let gone: Vec<&str> = old.iter().copied().filter(|name| !new.contains(name)).collect();
        let come: Vec<&str> = new.iter().copied().filter(|name| !old.contains(name)).collect();
        match (&gone[..], &come[..]) {
            ([], []) => {}
            ([], [name]) => return format!("{noun} {name} added"),
            ([name], []) => return format!("{noun} {name} removed"),
            ([name], [_]) => return format!("{noun} {name} renamed"),
            _ => return section.name().to_owned(),
        }
    }
    let is_other = |path: &&Path| before.get(*path) != after.get(*path);
    let mut others: Vec<&Path> = before.keys().filter(is_other).collect();
    others.extend(after.keys().filter(|path| !before.contains_key(*path)));
    common_name(&others)
}

/// The names in a parameter's path.
type Path = Vec<String>;

fn known(scene: &SceneDescription) -> BTreeMap<Path, Value> {
    values(scene).into_iter().map(|(path, value)| (path.names().to_vec(), value)).collect()
}

/// The entries of a list.
fn names(known: &BTreeMap<Path, Value>, section: Section) -> Vec<&str> {
    let is_name = |path: &&Path| {
        let [list, _, key] = path.as_slice() else { return false };
        list == section.name() && key == "name"
    };
    known.keys().filter(is_name).map(|path| path[1].as_str()).collect()
}

/// What these parameters have in common, in words.
fn common_name(paths: &[&Path]) -> String {
    let Some((first, rest)) = paths.split_first() else { return "edit".to_owned() };
    let Some(section) = Section::named(&first[0]) else { return "edit".to_owned() };
    let n_names = 1 + usize::from(section.entry_noun().is_some());
    if rest.iter().any(|path| path[0] != first[0]) {
        return "several settings".to_owned();
    }
    if rest.iter().any(|path| path[..n_names] != first[..n_names]) {
        return section.name().to_owned();
    }
    let owner = match (section, section.entry_noun()) {
        (_, Some(noun)) => format!("{noun} {}", first[1]),
        (Section::ToneMapping, None) => "display".to_owned(),
        (_, None) => section.name().to_owned(),
    };
    let key = |path: &Path| path[n_names..].join(" ").replace('_', " ");
    if section == Section::Camera && paths.iter().all(|path| PLACE.contains(&path[1].as_str())) {
        format!("{owner} move")
    } else if rest.is_empty() {
        format!("{owner} {}", key(first))
    } else {
        owner
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::scene_file::parse;

    const FULL: &str = include_str!("../io/scene_file/full.toml");

    #[test]
    fn an_edit_is_called_by_what_it_changes() {
        let before = parse(FULL, &[]).unwrap();
        type Edit = fn(&mut SceneDescription);
        let edits: [(&str, Edit); 11] = [
            ("light key power", |scene| scene.lights[0].power = [1.0; 3]),
            ("light key", |scene| {
                scene.lights[0].power = [1.0; 3];
                scene.lights[0].visible ^= true;
            }),
            ("camera aperture radius", |scene| scene.camera.aperture_radius = 0.5),
            ("camera move", |scene| {
                scene.camera.eye = [7.0; 3];
                scene.camera.target = [6.0; 3];
            }),
            ("camera focal distance", |scene| scene.camera.focal_distance = Some(77.0)),
            ("display exposure", |scene| scene.tone_mapping.exposure = 9.0),
            ("light key-2 added", |scene| {
                let name = "key-2".to_owned();
                scene.lights.push(crate::scene::description::LightDescription {
                    name,
                    ..scene.lights[0].clone()
                });
            }),
            ("light key removed", |scene| {
                scene.lights.remove(0);
            }),
            ("material ceramic renamed", |scene| {
                scene.materials[0].name = "other".to_owned();
                scene.objects[0].material = Some("other".to_owned());
            }),
            ("textures", |scene| scene.textures.iter_mut().for_each(|one| one.scale = 77.0)),
            ("several settings", |scene| {
                scene.render.seed += 1;
                scene.lights[0].power = [1.0; 3];
            }),
        ];
        for (expected, edit) in edits {
            let mut after = before.clone();
            edit(&mut after);
            assert_eq!(edit_label(&before, &after), expected, "another name");
        }
    }
}

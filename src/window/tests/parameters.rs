//! Every parameter of a scene file has a control, and a control changes its own parameter only.

use super::bench::{ALL, Bench, bench, harness_of};
use super::small_scene;
use crate::io::scene_file::{self, Rule, Section};
use crate::scene::description::{
    BumpDescription, LightDescription, LightKind, NormalsKind, ObjectDescription, ObjectKind,
    OneOrTwo, SceneDescription, TextureDescription, TextureKind,
};
use crate::window::panels::Selection;
use egui::{Id, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::collections::BTreeMap;

type Notes = Vec<(String, String)>;

/// Notes that a control of that name edits the parameter of that path, where a test asks for it.
pub(in crate::window) fn note(ctx: &egui::Context, label: &str, path: &str) {
    ctx.data_mut(|data| {
        if let Some(mut notes) = data.remove_temp::<Notes>(notes_id()) {
            notes.push((label.to_owned(), path.to_owned()));
            data.insert_temp(notes_id(), notes);
        }
    });
}

fn notes_id() -> Id {
    Id::unique("controls and their parameters")
}

/// Name and path of every control that the next frame shows.
fn notes(harness: &mut Harness<'_, Bench>) -> Notes {
    harness.ctx.data_mut(|data| data.insert_temp(notes_id(), Notes::new()));
    harness.step();
    let taken = harness.ctx.data_mut(|data| data.remove_temp(notes_id()));
    taken.unwrap_or_default()
}

/// A scene with one of every type of everything, named by its type.
pub(super) fn full_scene() -> SceneDescription {
    let mut scene = small_scene();
    let light = scene.lights[0].clone();
    scene.lights = [
        ("rectangle", LightKind::Rectangle),
        ("disk", LightKind::Disk),
        ("sphere", LightKind::Sphere),
        ("point", LightKind::Point),
        ("sun", LightKind::Sun),
    ]
    .map(|(name, kind)| LightDescription {
        name: name.to_owned(),
        kind,
        size: OneOrTwo::One(1.0),
        ..light.clone()
    })
    .into();
    let texture = scene.textures[0].clone();
    scene.textures = [
        ("spots", TextureKind::Spots),
        ("marble", TextureKind::Marble),
        ("clouds", TextureKind::Clouds),
        ("wood", TextureKind::Wood),
        ("checker", TextureKind::Checker),
        ("image", TextureKind::Image),
        ("solid", TextureKind::Solid),
    ]
    .map(|(name, kind)| {
        let mut texture = TextureDescription { name: name.to_owned(), kind, ..texture.clone() };
        match kind {
            TextureKind::Image => texture.file = Some("a.png".to_owned()),
            TextureKind::Solid => texture.colors = Some(vec![[0.5; 3]]),
            _ => {}
        }
        texture
    })
    .into();
    scene.materials[0].bump = Some(BumpDescription { texture: "marble".to_owned(), height: 0.1 });
    let object = |name: &str, kind| ObjectDescription {
        material: Some("glaze".to_owned()),
        ..ObjectDescription::new(name, kind)
    };
    scene.objects = vec![
        ObjectDescription {
            file: Some("a.obj".to_owned()),
            normals: NormalsKind::Smooth,
            ..object("mesh", ObjectKind::Mesh)
        },
        ObjectDescription {
            center: Some([0.0; 3]),
            radius: Some(1.0),
            ..object("sphere", ObjectKind::Sphere)
        },
        ObjectDescription {
            point: Some([0.0; 3]),
            normal: Some([0.0, 1.0, 0.0]),
            ..object("plane", ObjectKind::Plane)
        },
        ObjectDescription {
            min: Some([-1.0; 3]),
            max: Some([1.0; 3]),
            ..object("box", ObjectKind::Box)
        },
        ObjectDescription {
            base: Some([0.0; 3]),
            tip: Some([0.0, 1.0, 0.0]),
            radius: Some(1.0),
            ..object("cone", ObjectKind::Cone)
        },
        ObjectDescription {
            base: Some([0.0; 3]),
            top: Some([0.0, 1.0, 0.0]),
            radius: Some(1.0),
            ..object("cylinder", ObjectKind::Cylinder)
        },
    ];
    scene_file::validate(&scene).expect("the scene of the test is valid");
    scene
}

/// Whether an entry of that type uses that key; what it does not use needs no control.
fn is_used(section: Section, kind: &str, key: &str) -> bool {
    let only: &[(&str, &[&str])] = match section {
        Section::Objects => &[
            ("file", &["mesh"]),
            ("normals", &["mesh"]),
            ("crease_angle", &["mesh"]),
            ("center", &["sphere"]),
            ("point", &["plane"]),
            ("normal", &["plane"]),
            ("min", &["box"]),
            ("max", &["box"]),
            ("base", &["cone", "cylinder"]),
            ("tip", &["cone"]),
            ("top", &["cylinder"]),
            ("radius", &["sphere", "cone", "cylinder"]),
        ],
        Section::Lights => &[
            ("target", &["rectangle", "disk", "sun"]),
            ("up", &["rectangle"]),
            ("size", &["rectangle", "disk", "sphere", "sun"]),
        ],
        Section::Textures => &[
            ("file", &["image"]),
            ("scale", &["spots", "marble", "clouds", "wood", "checker", "image"]),
            ("octaves", &["spots", "marble", "clouds", "wood"]),
            ("lacunarity", &["spots", "marble", "clouds", "wood"]),
            ("gain", &["spots", "marble", "clouds", "wood"]),
            ("distortion", &["spots", "marble", "clouds", "wood"]),
            ("colors", &["spots", "marble", "clouds", "wood", "checker", "solid"]),
        ],
        _ => &[],
    };
    only.iter().find(|(name, _)| *name == key).is_none_or(|(_, kinds)| kinds.contains(&kind))
}

/// Every parameter that the scene of the test could have, and that its entry uses. The names of
/// the entries are their types.
fn wanted(scene: &SceneDescription) -> Vec<String> {
    let paths = scene_file::parameters(scene).into_iter().filter(|path| {
        let names = path.names();
        let section = Section::named(&names[0]).expect("a section");
        let (kind, key) = match section.entry_noun() {
            Some(_) => (names[1].as_str(), names[2].as_str()),
            None => ("", names[1].as_str()),
        };
        is_used(section, kind, key) && !(kind == "plain" && key == "bump")
    });
    paths.map(|path| path.to_string()).collect()
}

/// Every panel, with every entry of its list chosen in turn.
pub(super) fn for_each_view(
    scene: &SceneDescription,
    mut look: impl FnMut(&mut Harness<'_, Bench>),
) {
    for panel in ALL {
        let mut shown = Vec::new();
        for index in 0..8 {
            let mut bench = bench(scene.clone());
            bench.selection = Selection {
                light: index,
                material: index,
                texture: index,
                object: index,
                ..Selection::default()
            };
            let mut harness = harness_of(panel, bench);
            let noted = notes(&mut harness);
            // Behind the end of the list the last entry shows again.
            if !shown.contains(&noted) {
                look(&mut harness);
                shown.push(noted);
            }
        }
    }
}

#[test]
fn every_parameter_of_the_scene_file_has_a_named_control() {
    let scene = full_scene();
    let mut controls: BTreeMap<String, String> = BTreeMap::new();
    for_each_view(&scene, |harness| {
        for (label, path) in notes(harness) {
            let is_there = harness.query_all_by_label(&label).next().is_some();
            assert!(is_there, "{path}: no control is called {label:?}");
            path.parse::<scene_file::ParameterPath>().expect("a path reads as one");
            controls.insert(path, label);
        }
    });
    let wanted = wanted(&scene);
    let missing: Vec<_> = wanted.iter().filter(|path| !controls.contains_key(*path)).collect();
    assert!(missing.is_empty(), "no control for {missing:#?}");
    for path in controls.keys() {
        let known = scene_file::parameters(&scene).iter().any(|known| known.to_string() == *path);
        assert!(known, "{path} is no parameter");
    }
    assert!(140 < wanted.len(), "only {} parameters were looked at", wanted.len());
}

/// The parameters whose values differ.
fn changed(before: &SceneDescription, after: &SceneDescription) -> Vec<String> {
    let differs = |path: &scene_file::ParameterPath| {
        scene_file::get(before, path).ok() != scene_file::get(after, path).ok()
    };
    let paths = scene_file::parameters(after).into_iter().filter(differs);
    paths.map(|path| path.to_string()).collect()
}

#[test]
fn a_figure_or_a_switch_changes_its_own_parameter_and_no_other() {
    let scene = full_scene();
    let mut n_driven = 0;
    for_each_view(&scene, |harness| {
        for (label, path) in notes(harness) {
            let set = |harness: &mut Harness<'_, Bench>, value: f64| {
                harness.state_mut().scene.clone_from(&scene);
                harness.step();
                if harness.query_by_role_and_label(Role::SpinButton, &label).is_some() {
                    harness
                        .get_by_role_and_label(Role::SpinButton, &label)
                        .set_value_accesskit(value);
                } else if harness.query_by_role_and_label(Role::CheckBox, &label).is_some() {
                    harness.get_by_role_and_label(Role::CheckBox, &label).click();
                } else {
                    return None;
                }
                harness.run_steps(3);
                Some(changed(&scene, &harness.state().scene))
            };
            for value in [3.0, 0.37, 5.0] {
                match set(harness, value) {
                    None => break,
                    Some(changes) if changes.is_empty() && value != 5.0 => {}
                    Some(changes) => {
                        assert_eq!(
                            changes,
                            std::slice::from_ref(&path),
                            "{label} changes something else"
                        );
                        let valid = scene_file::validate(&harness.state().scene);
                        assert!(valid.is_ok(), "{label} makes the scene invalid: {valid:?}");
                        n_driven += 1;
                        break;
                    }
                }
            }
        }
        harness.state_mut().scene.clone_from(&scene);
    });
    assert!(150 < n_driven, "only {n_driven} controls were driven");
}

#[test]
fn a_right_click_resets_a_parameter_to_the_default_of_the_file() {
    let mut harness = harness_of(ALL[0], bench(full_scene()));
    for control in [Role::SpinButton, Role::Slider] {
        harness.state_mut().scene.camera.aperture_radius = 0.3;
        harness.run();
        harness.get_by_role_and_label(control, "Aperture").click_secondary();
        harness.run();
        let radius = harness.state().scene.camera.aperture_radius;
        assert_eq!(radius, 0.3, "opening the menu of the {control:?} changed the figure");
        harness.get_by_role_and_label(Role::Button, "Reset").click();
        harness.run();
        let radius = harness.state().scene.camera.aperture_radius;
        assert_eq!(radius, 0.0, "not the file's default after a click on the {control:?}");
    }
    harness.get_by_role_and_label(Role::SpinButton, "Eye X").click_secondary();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Reset").click();
    harness.run();
    let eye = harness.state().scene.camera.eye;
    assert_eq!(eye, full_scene().camera.eye, "a required parameter was reset to {eye:?}");
}

/// What has a default can be reset, and nothing else offers it.
#[test]
fn every_parameter_with_a_default_can_be_reset() {
    let scene = full_scene();
    for path in scene_file::parameters(&scene) {
        let reset = scene_file::with_default(&scene, &path);
        let refused = matches!(&reset, Err(scene_file::EditError::Path(_)));
        assert_eq!(!refused, scene_file::has_default(&path), "{path}: {reset:?}");
    }
    let bump = Section::Materials.keys().iter().find(|key| key.name == "bump").unwrap();
    assert!(matches!(bump.rule, Rule::Table(_)), "bump is a table no more");
}

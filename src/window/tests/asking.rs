//! What asks the system for a file, and what becomes of its answer.

use super::whole::{scene_file, wait_until, window};
use crate::scene::description::{ObjectKind, TextureKind};
use crate::window::app::App;
use crate::window::dialogs::Purpose;
use crate::window::files::Pending;
use crate::window::keys::Action;
use crate::window::structure::Part;
use egui::{Key, Modifiers, Role, ViewportCommand, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

const SIZE: [f32; 2] = [1400.0, 900.0];

/// Purposes and suggestions that a dialog was opened with.
type Asked = Arc<Mutex<Vec<(Purpose, String)>>>;

/// Answers every dialog with that path at once, and notes what it was asked.
fn answer(harness: &mut Harness<'_, App>, path: Option<PathBuf>) -> Asked {
    let asked = Asked::default();
    let noted = Arc::clone(&asked);
    harness.state_mut().dialogs.chooser = Box::new(move |purpose, suggestion| {
        noted.lock().unwrap().push((purpose, suggestion.to_owned()));
        Box::pin(std::future::ready(path.clone()))
    });
    asked
}

fn press(harness: &mut Harness<'_, App>, label: &str) {
    harness
        .get_by(|node| {
            let label_of = node.label().unwrap_or_default();
            node.role() == Role::Button && label_of.starts_with(label)
        })
        .click();
    harness.run_steps(4);
}

/// Gets to a control and uses it.
type Way = fn(&mut Harness<'_, App>);

#[test]
fn whatever_asks_for_a_scene_opens_the_one_that_is_chosen() {
    let ways: [(&str, Way); 3] = [
        ("the menu", |harness| {
            press(harness, "File");
            press(harness, "Open…");
        }),
        ("the start page", |harness| {
            harness.key_press_modifiers(Modifiers::COMMAND, Key::G);
            harness.run_steps(3);
            press(harness, "Open a file…");
        }),
        ("its key", |harness| harness.key_press_modifiers(Modifiers::COMMAND, Key::O)),
    ];
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("other.toml");
    let path = scene_file(folder.path());
    std::fs::copy(&path, &other).unwrap();
    for (what, way) in ways {
        let mut harness = window(&path, SIZE);
        let asked = answer(&mut harness, Some(other.clone()));
        way(&mut harness);
        wait_until(&mut harness, |app| app.files.title == "other");
        assert_eq!(*asked.lock().unwrap(), [(Purpose::Open, String::new())], "{what}");
        let app = harness.state();
        assert_eq!(app.files.scene_path.as_ref(), Some(&other), "{what}");
        assert!(!app.interface.start_shown, "{what}: the page hides the scene");
    }
}

#[test]
fn whatever_asks_where_to_save_saves_there() {
    let ways: [(&str, Way); 2] = [
        ("the menu", |harness| {
            press(harness, "File");
            press(harness, "Save as…");
        }),
        ("its key", |harness| {
            let modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };
            harness.key_press_modifiers(modifiers, Key::S);
        }),
    ];
    for (what, way) in ways {
        let folder = tempfile::tempdir().unwrap();
        let path = scene_file(folder.path());
        let copy = folder.path().join("copy.toml");
        let mut harness = window(&path, SIZE);
        let asked = answer(&mut harness, Some(copy.clone()));
        harness.key_press(Key::E);
        harness.run_steps(2);
        way(&mut harness);
        wait_until(&mut harness, |app| !app.document.is_dirty());
        assert_eq!(
            *asked.lock().unwrap(),
            [(Purpose::SaveScene, path.display().to_string())],
            "{what}"
        );
        let saved = |path: &PathBuf| {
            crate::io::scene_file::parse(&std::fs::read_to_string(path).unwrap(), &[]).unwrap()
        };
        assert_eq!(saved(&copy), harness.state().document.description, "{what}: another scene");
        assert_eq!(saved(&path).tone_mapping.exposure, 0.0, "{what}: the first file is written");
        assert_eq!(harness.state().files.scene_path.as_ref(), Some(&copy), "{what}");
    }
}

#[test]
fn the_folder_of_pictures_is_chosen_in_the_box_that_renders() {
    let folder = tempfile::tempdir().unwrap();
    let (before, after) = (folder.path().join("before"), folder.path().join("after"));
    let mut harness = window(&scene_file(folder.path()), SIZE);
    harness.state_mut().interface.export.folder = Some(before.clone());
    let asked = answer(&mut harness, Some(after.clone()));
    harness.key_press_modifiers(Modifiers::SHIFT, Key::F12);
    harness.run_steps(3);
    press(&mut harness, "Choose…");
    wait_until(&mut harness, |app| app.interface.export.folder.as_ref() == Some(&after));
    let suggestion = before.display().to_string();
    assert_eq!(*asked.lock().unwrap(), [(Purpose::PictureFolder, suggestion)], "another question");
}

#[test]
fn where_the_system_has_no_dialog_the_path_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let other = folder.path().join("other.toml");
    std::fs::copy(&path, &other).unwrap();
    let mut harness = window(&path, SIZE);
    answer(&mut harness, None);
    press(&mut harness, "File");
    press(&mut harness, "Open…");
    wait_for_box(&mut harness);
    harness.event(egui::Event::Text(other.display().to_string()));
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    wait_until(&mut harness, |app| app.files.title == "other");
}

/// Types into the box for a path, in place of what stands there.
fn type_path(harness: &mut Harness<'_, App>, path: &str) {
    harness.run_steps(3);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(egui::Event::Text(path.to_owned()));
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
}

#[test]
fn where_nothing_is_saved_after_all_the_window_asks_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let give_ups: [(&str, Way); 3] = [
        ("Escape", |harness| harness.key_press(Key::Escape)),
        ("the button", |harness| press(harness, "Cancel")),
        ("the key of the program", |harness| {
            let ctx = harness.ctx.clone();
            let mut scene = harness.state().document.description.clone();
            harness.state_mut().do_action(&ctx, &mut scene, Action::Cancel);
        }),
    ];
    harness.key_press(Key::D);
    harness.run_steps(3);
    for (what, give_up) in give_ups {
        harness.state_mut().files.pending = Some(Pending::CloseScene);
        harness.run_steps(3);
        // It has the focus.
        harness.get_by_role_and_label(Role::Button, "Save");
        harness.state_mut().files.scene_path = None;
        answer(&mut harness, None);
        harness.key_press(Key::Enter);
        wait_for_box(&mut harness);
        give_up(&mut harness);
        harness.run_steps(3);
        let app = harness.state();
        assert!(app.document.is_dirty() && app.files.has_scene, "{what}: edits are lost");
        assert_eq!(app.files.pending, None, "{what}: it still waits");
        assert!(!app.files.is_saving_first, "{what}: it still saves");
    }
}

fn wait_for_box(harness: &mut Harness<'_, App>) {
    let since = std::time::Instant::now();
    while harness.query_by_role_and_label(Role::TextInput, "Path").is_none() {
        assert!(since.elapsed() < super::whole::PATIENCE, "no box for a path");
        harness.step();
    }
    harness.run_steps(2);
}

#[test]
fn another_file_is_replaced_only_after_a_second_answer() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let other = folder.path().join("other.toml");
    std::fs::write(&other, "precious").unwrap();
    let mut harness = window(&path, SIZE);
    harness.key_press(Key::D);
    harness.run_steps(3);
    let save_as = |harness: &mut Harness<'_, App>| {
        answer(harness, None);
        harness.key_press_modifiers(Modifiers { shift: true, ..Modifiers::COMMAND }, Key::S);
        wait_for_box(harness);
    };
    save_as(&mut harness);
    // Without its ending: it is the same file.
    type_path(&mut harness, other.with_extension("").to_str().unwrap());
    assert_eq!(std::fs::read_to_string(&other).unwrap(), "precious", "it is lost");
    harness.get_by_label_contains("other.toml is there already");
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    save_as(&mut harness);
    type_path(&mut harness, other.to_str().unwrap());
    press(&mut harness, "Replace");
    wait_until(&mut harness, |app| !app.document.is_dirty());
    assert_ne!(std::fs::read_to_string(&other).unwrap(), "precious", "it is not replaced");
    // Its own file is suggested, and saved at once.
    harness.key_press(Key::D);
    harness.run_steps(3);
    save_as(&mut harness);
    harness.key_press(Key::Enter);
    wait_until(&mut harness, |app| !app.document.is_dirty());
    assert_eq!(harness.state().files.scene_path.as_ref(), Some(&other), "saved elsewhere");
}

#[test]
fn a_part_gets_the_file_that_is_chosen_in_one_step() {
    for (part, name, file) in
        [(Part::Object, "ball", "a.obj"), (Part::Texture, "veins", "sub/a.png")]
    {
        let folder = tempfile::tempdir().unwrap();
        let path = scene_file(folder.path());
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        std::fs::write(folder.path().join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
            .unwrap();
        let pixels = crate::io::output::encode_png((1, 1), &[9; 3], &[]).unwrap();
        std::fs::write(folder.path().join("sub/a.png"), pixels).unwrap();
        let mut harness = window(&path, SIZE);
        let before = harness.state().document.description.clone();
        answer(&mut harness, Some(folder.path().join(file)));
        harness.state_mut().interface.selection.wants_file = Some((part, name.to_owned()));
        wait_until(&mut harness, |app| app.document.is_dirty());
        let scene = harness.state().document.description.clone();
        let given = match part {
            Part::Object => (scene.objects[0].kind == ObjectKind::Mesh, &scene.objects[0].file),
            _ => (scene.textures[0].kind == TextureKind::Image, &scene.textures[0].file),
        };
        assert_eq!(given, (true, &Some(file.to_owned())), "{name}");
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(3);
        assert_eq!(harness.state().document.description, before, "{name}: not one step");
    }
}

#[test]
fn the_menu_closes_the_window() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    press(&mut harness, "File");
    let quit = harness.get_by(|node| {
        node.role() == Role::Button && node.label().is_some_and(|label| label.starts_with("Quit"))
    });
    quit.click();
    let mut asked = Vec::new();
    for _ in 0..4 {
        harness.step();
        asked.extend(harness.output().viewport_output[&ViewportId::ROOT].commands.clone());
    }
    assert!(asked.contains(&ViewportCommand::Close), "it does not close: {asked:?}");
}

//! What a hand does to a scene beside the camera: nothing is lost, nothing happens by mistake.

use super::whole::{scene_file, wait_until, window};
use crate::io::scene_file;
use crate::loader::Source;
use crate::session::Phase;
use crate::window::app::App;
use egui::{DroppedFile, Event, Key, Modifiers, Role, ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const SIZE: [f32; 2] = [900.0, 640.0];

fn press(harness: &mut Harness<'_, App>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    harness.run_steps(3);
}

fn press_key(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

/// What the window asked of the system in the last frame.
fn commands(harness: &Harness<'_, App>) -> Vec<ViewportCommand> {
    harness.output().viewport_output[&ViewportId::ROOT].commands.clone()
}

/// The system asks to close the window; gives back what is answered.
fn ask_to_close(harness: &mut Harness<'_, App>) -> Vec<ViewportCommand> {
    let viewports = &mut harness.input_mut().viewports;
    viewports.entry(ViewportId::ROOT).or_default().events.push(ViewportEvent::Close);
    harness.step();
    commands(harness)
}

#[test]
fn letters_typed_into_a_field_are_no_keys() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    harness.state_mut().dialogs.type_path(crate::window::dialogs::Purpose::Open, "");
    harness.run_steps(3);
    let before = harness.state().document.description.clone();
    for (key, letter) in [(Key::D, "d"), (Key::E, "e"), (Key::Num4, "4"), (Key::Home, "")] {
        harness.event(Event::Text(letter.to_owned()));
        press_key(&mut harness, Modifiers::NONE, key);
    }
    assert_eq!(harness.state().document.description, before, "a letter edits the scene");
    assert_eq!(harness.state().interface.display.view, Default::default(), "another view");
    press_key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_role_and_label(Role::TextInput, "Path").is_none(), "it stays open");
    press_key(&mut harness, Modifiers::NONE, Key::D);
    assert_ne!(harness.state().document.description, before, "the keys are dead afterwards");
}

#[test]
fn space_pauses_and_resumes_and_r_begins_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let done = |app: &App| app.work.session.status().phase == Phase::Done;
    wait_until(&mut harness, done);
    let before = harness.state().work.session.latest().unwrap();
    press_key(&mut harness, Modifiers::NONE, Key::R);
    wait_until(&mut harness, |app| {
        let latest = app.work.session.latest().unwrap();
        before.generation < latest.generation && done(app)
    });
    press_key(&mut harness, Modifiers::NONE, Key::Space);
    assert!(harness.state().interface.is_paused, "not paused");
    press(&mut harness, "Resume");
    assert!(!harness.state().interface.is_paused, "not resumed");
    press_key(&mut harness, Modifiers::NONE, Key::Space);
    press_key(&mut harness, Modifiers::NONE, Key::Space);
    assert!(!harness.state().interface.is_paused, "the key does not resume");
}

#[test]
fn t_shows_every_tone_curve_and_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let mut seen = Vec::new();
    for _ in 0..4 {
        seen.push(harness.state().document.description.tone_mapping.operator);
        press_key(&mut harness, Modifiers::NONE, Key::T);
    }
    let last = harness.state().document.description.tone_mapping.operator;
    assert_eq!(last, seen[0], "it does not come back");
    let all_differ = (0..4).all(|i| !seen[..i].contains(&seen[i]));
    assert!(all_differ, "only {seen:?}");
}

#[test]
fn the_systems_copy_puts_the_picture_on_the_clipboard() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    harness.event(Event::Copy);
    harness.step();
    let copied = harness.output().platform_output.commands.iter().any(
        |command| matches!(command, egui::OutputCommand::CopyImage(image) if 1 < image.size[0]),
    );
    assert!(copied, "nothing is copied");
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("it is read by its path".to_owned())
    }
}

#[test]
fn a_dropped_file_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let other = folder.path().join("other.toml");
    std::fs::copy(folder.path().join("small.toml"), &other).unwrap();
    harness.input_mut().dropped_files.push(Arc::new(Dropped(other)));
    wait_until(&mut harness, |app| app.files.title == "other");
    press_key(&mut harness, Modifiers::NONE, Key::D);
    let first = folder.path().join("small.toml");
    harness.input_mut().dropped_files.push(Arc::new(Dropped(first)));
    harness.run_steps(3);
    assert!(harness.query_by_label("Do not save").is_some(), "the edit is let go unasked");
    assert!(harness.state().files.loading.is_none(), "it is loaded without an answer");
}

#[test]
fn an_empty_path_opens_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    harness.state_mut().dialogs.type_path(crate::window::dialogs::Purpose::Open, " ");
    harness.run_steps(3);
    press_key(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(harness.query_by_role_and_label(Role::TextInput, "Path").is_some(), "the box is gone");
    assert!(harness.state().files.loading.is_none(), "nothing is loaded from nowhere");
}

#[test]
fn an_edit_that_no_file_could_say_is_refused_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    for (label, value) in [("Target X", 2.0), ("Target Y", 5.0), ("Target Z", 3.0)] {
        // The camera has a target of the same name above.
        let boxes = harness.query_all_by_role(Role::SpinButton);
        let mut named =
            boxes.filter(|node| node.accesskit_node().label().as_deref() == Some(label));
        named.next_back().expect("the light's target").set_value_accesskit(value);
        drop(named);
        harness.run_steps(3);
    }
    // The light is at (2, 5, 3): it cannot face itself.
    let scene = &harness.state().document.description;
    scene_file::validate(scene).expect("the scene stays valid");
    assert_eq!(scene.lights[0].target[..2], [2.0, 5.0], "the edits before are refused too");
}

#[test]
fn edits_are_saved_first_where_that_is_the_answer() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let mut harness = window(&path, SIZE);
    press_key(&mut harness, Modifiers::NONE, Key::D);
    let edited = harness.state().document.description.clone();
    press_key(&mut harness, Modifiers::COMMAND, Key::W);
    press(&mut harness, "Save");
    wait_until(&mut harness, |app| !app.files.has_scene);
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(scene_file::parse(&text, &[]).unwrap(), edited, "the edit is lost");
}

#[test]
fn what_is_edited_while_it_is_saved_is_still_unsaved() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    press_key(&mut harness, Modifiers::NONE, Key::D);
    let files = &harness.state().files;
    let path = files.scene_path.clone().unwrap();
    let ctx = harness.ctx.clone();
    harness.state_mut().save_to(&ctx, path);
    // Before the window hears of the end.
    harness.state_mut().document.description.tone_mapping.exposure = 2.0;
    while harness.query_by_label_contains("saved ").is_none() {
        harness.step();
        std::thread::yield_now();
    }
    assert!(harness.state().document.is_dirty(), "the later edit counts as saved");
}

#[test]
fn closing_waits_for_an_answer_about_edits() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let answer = ask_to_close(&mut harness);
    assert!(!answer.contains(&ViewportCommand::CancelClose), "a clean scene keeps it open");
    press_key(&mut harness, Modifiers::NONE, Key::D);
    let answer = ask_to_close(&mut harness);
    assert!(answer.contains(&ViewportCommand::CancelClose), "it closes on unsaved edits");
    harness.run_steps(3);
    press(&mut harness, "Cancel");
    assert!(harness.query_by_label("Do not save").is_none(), "the question stays");
    ask_to_close(&mut harness);
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, "Do not save").click();
    let mut answers = Vec::new();
    for _ in 0..3 {
        harness.step();
        answers.extend(commands(&harness));
    }
    assert!(answers.contains(&ViewportCommand::Close), "it does not close then: {answers:?}");
    let answer = ask_to_close(&mut harness);
    assert!(!answer.contains(&ViewportCommand::CancelClose), "it asks again");
}

#[test]
fn closing_waits_for_an_answer_about_a_picture_at_work() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let export = &mut harness.state_mut().interface.export;
    (export.samples, export.folder) = (Some(1_048_576), Some(folder.path().to_owned()));
    harness.state_mut().export_wanted = true;
    wait_until(&mut harness, |app| app.exporter.progress().is_some());
    let answer = ask_to_close(&mut harness);
    assert!(answer.contains(&ViewportCommand::CancelClose), "it closes on a picture at work");
    harness.run_steps(3);
    press(&mut harness, "Go on rendering");
    assert!(harness.state().exporter.progress().is_some(), "the picture is stopped");
    ask_to_close(&mut harness);
    harness.run_steps(3);
    press_key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("Go on rendering").is_none(), "the question stays");
    assert!(!harness.state().files.close_confirmed, "Escape closes the window");
    assert!(harness.state().exporter.progress().is_some(), "Escape stops the picture");
}

#[test]
fn a_rendered_picture_ends_at_its_limit_of_noise_in_the_folder_that_was_typed() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let export = &mut harness.state_mut().interface.export;
    (export.size, export.custom) = (crate::window::export_settings::ExportSize::Custom, [40, 30]);
    (export.samples, export.limits.noise_percent) = (Some(1_048_576), Some(50.0));
    press_key(&mut harness, Modifiers::SHIFT, Key::F12);
    harness.get_by_role_and_label(Role::TextInput, "Folder").click();
    harness.run_steps(2);
    press_key(&mut harness, Modifiers::COMMAND, Key::A);
    harness.event(Event::Text(folder.path().display().to_string()));
    press_key(&mut harness, Modifiers::NONE, Key::Enter);
    press(&mut harness, "Render");
    wait_until(&mut harness, |_| folder.path().join("small-001.png").is_file());
}

#[test]
fn a_reload_keeps_the_camera_where_the_hand_has_moved_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let mut harness = window(&path, SIZE);
    let mut changed = harness.state().document.description.clone();
    press_key(&mut harness, Modifiers::CTRL, Key::Num3);
    let moved = harness.state().document.description.camera.clone();
    assert_ne!(moved, changed.camera, "the camera did not move");
    changed.lights[0].power = [7.0; 3];
    changed.render.samples = 123;
    std::fs::write(&path, scene_file::write(&changed)).unwrap();
    wait_until(&mut harness, |app| app.document.description.lights[0].power == [7.0; 3]);
    assert_eq!(harness.state().document.description.camera, moved, "the camera jumped");
    changed.camera.eye = [9.0, 1.0, 0.0];
    std::fs::write(&path, scene_file::write(&changed)).unwrap();
    wait_until(&mut harness, |app| app.document.description.camera == changed.camera);
}

#[test]
fn the_pinned_picture_is_split_where_the_hand_drags_and_let_go_by_its_key() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    press_key(&mut harness, Modifiers::NONE, Key::X);
    let split = |harness: &Harness<'_, App>| {
        harness.get_by_role_and_label(Role::Splitter, "Split").rect().center()
    };
    let before = split(&harness);
    let camera = harness.state().document.description.camera.clone();
    super::whole::drag(&mut harness, before, egui::vec2(120.0, 0.0));
    let after = split(&harness);
    assert!((after.x - before.x - 120.0).abs() < 2.0, "from {before:?} to {after:?}");
    assert_eq!(harness.state().document.description.camera, camera, "the camera moved with it");
    press_key(&mut harness, Modifiers::NONE, Key::X);
    assert!(harness.query_by_role_and_label(Role::Splitter, "Split").is_none(), "still pinned");
}

#[test]
fn the_menu_shows_every_view_and_marks_the_one_on_show() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    for view in crate::window::views::View::ALL {
        press(&mut harness, "View");
        let lines = harness.query_all_by_role(Role::Button);
        let mut named = lines.filter(|node| {
            node.accesskit_node().label().is_some_and(|label| label.starts_with(view.name()))
        });
        named.next_back().expect("a line of the menu").click();
        drop(named);
        harness.run_steps(3);
        assert_eq!(harness.state().interface.display.view, view, "another view");
    }
}

#[test]
fn another_file_waits_for_the_answer_too() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    press_key(&mut harness, Modifiers::NONE, Key::D);
    harness.state_mut().open(Source::Gallery("pyramid"));
    harness.run_steps(3);
    assert!(harness.state().files.loading.is_none(), "it is loaded without an answer");
    press(&mut harness, "Do not save");
    wait_until(&mut harness, |app| app.files.title == "pyramid");
}

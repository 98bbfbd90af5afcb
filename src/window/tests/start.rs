//! The start page, what is remembered, and messages that stay until they are read.

use super::whole::{drag, harness_of, scene_file, wait_until, window, window_of, window_with};
use crate::io::gallery::GALLERY;
use crate::loader::Source;
use crate::session::Phase;
use crate::window::app::App;
use crate::window::state::{InterfaceState, Remembered};
use egui::{Key, Modifiers, Role, ThemePreference};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::path::PathBuf;
use std::sync::Arc;

const SIZE: [f32; 2] = [1400.0, 900.0];

#[test]
fn closing_a_scene_shows_the_gallery_and_costs_nothing_more() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::W);
    harness.run_steps(3);
    assert!(!harness.state().files.has_scene, "the scene is still open");
    for entry in GALLERY {
        let is_there = harness.query_by_role_and_label(Role::Button, entry.title).is_some();
        assert!(is_there, "{} is not offered", entry.title);
    }
    assert!(harness.query_by_role_and_label(Role::Button, "small.toml").is_some(), "not recent");
    harness.run_steps(40);
    let frames = harness.try_run();
    assert!(frames.is_ok(), "the start page keeps repainting: {frames:?}");
    harness.get_by_role_and_label(Role::Button, "small.toml").click();
    wait_until(&mut harness, |app| app.files.has_scene);
    assert!(!harness.state().interface.start_shown, "the page hides the scene");
    assert_eq!(harness.state().files.title, "small", "another scene");
}

#[test]
fn nothing_of_a_closed_scene_stays_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    let work = &harness.state().work;
    let scene = Arc::downgrade(work.scene().unwrap());
    let assets = Arc::downgrade(&work.assets);
    let frame = Arc::downgrade(&work.session.latest().unwrap());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::W);
    wait_until(&mut harness, |app| !app.files.has_scene);
    wait_until(&mut harness, |_| {
        let n_left = [scene.strong_count(), assets.strong_count(), frame.strong_count()];
        n_left == [0; 3]
    });
    assert!(harness.state().picture_on_show().is_none(), "its picture is still there");
}

#[test]
fn the_gallery_opens_over_a_scene_and_goes_back_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::G);
    harness.run_steps(3);
    assert!(harness.query_by_role_and_label(Role::Canvas, "Picture").is_none(), "no page");
    harness.get_by_role_and_label(Role::Button, "Back to the scene").click();
    harness.run_steps(3);
    assert!(harness.query_by_role_and_label(Role::Canvas, "Picture").is_some(), "not back");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::G);
    harness.run_steps(3);
    let title = GALLERY.iter().find(|entry| entry.name == "pyramid").unwrap().title;
    harness.get_by_role_and_label(Role::Button, title).click();
    wait_until(&mut harness, |app| app.files.title == "pyramid");
}

#[test]
fn unsaved_edits_are_asked_about_before_a_scene_is_closed() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    harness.key_press(Key::D);
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::W);
    harness.run_steps(3);
    assert!(harness.state().files.has_scene, "the edits are gone");
    harness.get_by_role_and_label(Role::Button, "Do not save").click();
    harness.run_steps(3);
    assert!(!harness.state().files.has_scene, "the scene is still open");
}

#[test]
fn theme_panel_size_and_recent_files_are_there_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let mut before = InterfaceState {
        theme: ThemePreference::Light,
        panel_width: 420.0,
        ..InterfaceState::default()
    };
    before.remember_file(folder.path().join("older.toml"));
    let mut harness = window_of(&path, SIZE, Remembered::of(&before));
    harness.run_steps(2);
    let state = harness.state();
    assert_eq!(state.interface.theme, ThemePreference::Light, "another theme");
    let panel = state.interface.panel_width;
    assert!((panel - 420.0).abs() < 2.0, "the panel is {panel} wide");
    let picture = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
    // The harness leaves a margin around the window.
    assert!((picture.right() - (SIZE[0] - 428.0)).abs() < 4.0, "the picture ends at {picture:?}");
    let recent = &harness.state().interface.recent;
    assert_eq!(*recent, [path, folder.path().join("older.toml")], "other files");
    harness.ctx.set_theme(ThemePreference::Dark);
    harness.run_steps(2);
    let kept = Remembered::of(&harness.state().interface).restore();
    assert_eq!(kept.theme, ThemePreference::Dark, "the choice is not kept");
}

#[test]
fn errors_stay_until_they_are_closed_however_many_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    for number in 1..=6 {
        let name = format!("broken-{number}.toml");
        std::fs::write(folder.path().join(&name), "[camera]\neye = 7\n").unwrap();
        harness.state_mut().open(Source::File(folder.path().join(&name)));
        wait_until(&mut harness, |app| app.files.loading.is_none());
    }
    harness.state_mut().toasts.say("something passes by");
    // A minute of the window's time.
    harness.run_steps(300);
    assert!(harness.query_by_label_contains("passes by").is_none(), "a passing message stays");
    for number in (1..=6).rev() {
        let name = format!("broken-{number}.toml");
        assert!(harness.query_by_label_contains(&name).is_some(), "{name} was not shown");
        harness.key_press(Key::Escape);
        harness.run_steps(2);
    }
    assert!(harness.query_by_label_contains("broken-").is_none(), "a closed message is back");
}

#[test]
fn what_passes_by_is_in_nobodys_way() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    let before = harness.state().document.description.camera.clone();
    harness.state_mut().toasts.say("something passes by");
    harness.run_steps(2);
    let message = harness.get_by_label("something passes by").rect();
    drag(&mut harness, message.center(), egui::vec2(60.0, 0.0));
    let after = &harness.state().document.description.camera;
    assert_ne!(after.eye, before.eye, "the message holds the hand up");
}

#[test]
fn a_newcomer_is_told_what_a_hand_can_do_for_long_enough_to_read_it() {
    let folder = tempfile::tempdir().unwrap();
    let (path, own) = (scene_file(folder.path()), folder.path().join("own"));
    let is_there = || crate::window::settings::are_there(Some(&own));
    assert!(!is_there(), "nobody was here");
    let mut harness = window_with(&path, SIZE, Some(own.clone()));
    harness.state_mut().greet();
    let tells =
        |harness: &Harness<'_, App>| harness.query_by_label_contains("Drag to orbit").is_some();
    // A quarter of a second each.
    harness.run_steps(60);
    assert!(tells(&harness), "it is gone after 15 s");
    harness.run_steps(60);
    assert!(!tells(&harness), "it stays");
    harness.state_mut().keep_settings();
    wait_until(&mut harness, |_| is_there());
}

/// The kept pictures.
fn kept(own: &std::path::Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(own.join("recent")).into_iter().flatten();
    entries.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn a_file_that_was_opened_has_its_picture_on_the_start_page() {
    let folder = tempfile::tempdir().unwrap();
    let (path, own) = (scene_file(folder.path()), folder.path().join("own"));
    let mut harness = window_with(&path, SIZE, Some(own.clone()));
    wait_until(&mut harness, |_| kept(&own).len() == 1);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::G);
    wait_until(&mut harness, |app| app.thumbnails.recent_shown() == [true]);
    let picture = crate::window::recent::read(&kept(&own)[0]).expect("a picture of ours");
    // The ball stands in the middle of a black background.
    let middle = picture.pixels[45 * 160 + 80];
    assert_ne!(picture.pixels[0], middle, "a picture of nothing");
    // The next window has it at once, before the file is opened again.
    drop(harness);
    let other = folder.path().join("other.toml");
    std::fs::copy(&path, &other).unwrap();
    let mut before = InterfaceState::default();
    before.remember_file(path);
    let ctx = egui::Context::default();
    let remembered = Remembered::of(&before);
    let app = App::new(&ctx, remembered, Source::File(other), Some(own.clone())).unwrap();
    let mut harness = harness_of(app, SIZE, 1.0);
    wait_until(&mut harness, |_| kept(&own).len() == 2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::G);
    wait_until(&mut harness, |app| app.thumbnails.recent_shown() == [true, true]);
}

#[test]
fn a_picture_that_is_damaged_or_gone_leaves_its_place_empty() {
    let folder = tempfile::tempdir().unwrap();
    let (path, own) = (scene_file(folder.path()), folder.path().join("own"));
    let mut harness = window_with(&path, SIZE, Some(own.clone()));
    wait_until(&mut harness, |app| app.recent_pictures.is_kept_at(4));
    let picture = kept(&own).remove(0);
    let whole = std::fs::read(&picture).unwrap();
    let other_size = crate::io::output::encode_png((2, 1), &[9; 6], &[]).unwrap();
    let broken = [&b"no picture"[..], &whole[..whole.len() / 2], &other_size, &[]];
    for (n_before, bytes) in broken.into_iter().enumerate() {
        std::fs::write(&picture, bytes).unwrap();
        harness.state_mut().thumbnails.look_again();
        harness.state_mut().interface.start_shown = true;
        wait_until(&mut harness, |app| app.thumbnails.recent_shown() == [false]);
        let line = harness.query_by_role_and_label(Role::Button, "small.toml");
        assert!(line.is_some(), "{n_before}: the file is not offered");
        std::fs::write(&picture, &whole).unwrap();
        harness.state_mut().thumbnails.look_again();
        wait_until(&mut harness, |app| app.thumbnails.recent_shown() == [true]);
    }
}

#[test]
fn edits_that_are_not_saved_are_on_no_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (path, own) = (scene_file(folder.path()), folder.path().join("own"));
    let mut harness = window_with(&path, SIZE, Some(own.clone()));
    let is_done_at = |app: &App, samples| {
        let frame = app.work.session.latest();
        let is_last =
            frame.is_some_and(|frame| frame.samples == samples && app.work.is_current(&frame));
        is_last && app.work.session.status().phase == Phase::Done
    };
    wait_until(&mut harness, |app| is_done_at(app, 4) && app.recent_pictures.is_kept_at(4));
    let file = kept(&own).remove(0);
    let before = std::fs::read(&file).unwrap();
    let scene = &mut harness.state_mut().document.description;
    // With so many more samples that a picture would be kept.
    (scene.objects[0].enabled, scene.render.samples) = (false, 64);
    wait_until(&mut harness, |app| is_done_at(app, 64));
    assert!(harness.state().recent_pictures.is_kept_at(4), "the edit is on the picture");
    assert_eq!(std::fs::read(&file).unwrap(), before, "the edit is on the picture");
    // As many as were kept: what is saved counts all the same.
    let scene = &mut harness.state_mut().document.description;
    (scene.lights[0].power, scene.render.samples) = ([50.0; 3], 4);
    wait_until(&mut harness, |app| is_done_at(app, 4));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    wait_until(&mut harness, |app| !app.document.is_dirty());
    wait_until(&mut harness, |_| std::fs::read(&file).is_ok_and(|bytes| bytes != before));
}

#[test]
fn a_file_named_from_the_current_folder_is_remembered_by_its_whole_path() {
    let mut harness = window(std::path::Path::new("scenes/pyramid.toml"), SIZE);
    harness.run_steps(2);
    let whole = std::path::absolute("scenes/pyramid.toml").unwrap();
    assert_eq!(harness.state().interface.recent, [whole], "it depends on the folder");
}

//! The start page, what is remembered, and messages that stay until they are read.

use super::whole::{scene_file, wait_until, window, window_of};
use crate::io::gallery::GALLERY;
use crate::loader::Source;
use crate::window::state::{InterfaceState, Remembered};
use egui::{Key, Modifiers, Role, ThemePreference};
use egui_kittest::kittest::Queryable as _;
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

//! Windows of impossible sizes, and places that are gone: the scene and its picture stay.

use super::whole::{PATIENCE, scene_file, wait_until, window, window_with};
use crate::session::Phase;
use crate::window::app::App;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::time::Instant;

/// The last picture of the scene as it is, or a refusal in words.
fn is_settled(app: &App) -> bool {
    match app.work.session.status().phase {
        Phase::Failed(_) => true,
        Phase::Done => app.work.session.latest().is_some_and(|frame| app.work.is_current(&frame)),
        Phase::Idle | Phase::Building | Phase::Preview | Phase::Refining | Phase::Paused => false,
    }
}

/// Lets frames pass until something is said.
pub(super) fn wait_for_words(harness: &mut Harness<'_, App>, words: &str) {
    let since = Instant::now();
    while harness.query_by_label_contains(words).is_none() {
        assert!(since.elapsed() < PATIENCE, "nobody says {words:?}");
        harness.step();
    }
}

#[test]
fn a_window_of_any_size_keeps_its_scene_and_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    let before = harness.state().document.description.clone();
    for size in [[0.0, 0.0], [1.0, 1.0], [1024.0, 0.0], [0.0, 700.0], [7680.0, 4320.0]] {
        harness.set_size(size.into());
        harness.run_steps(6);
        assert_eq!(harness.state().document.description, before, "at {size:?}");
        let job = harness.state().work.job().unwrap();
        assert!(0 < job.width && 0 < job.height, "at {size:?}: {} x {}", job.width, job.height);
    }
    harness.set_size([640.0, 400.0].into());
    harness.run_steps(3);
    wait_until(&mut harness, is_settled);
    let frame = harness.state().work.session.latest().unwrap();
    assert!(harness.state().work.is_current(&frame), "the picture is that of an earlier size");
    assert_eq!(frame.scale, 1, "the picture is a preview");
}

/// The harness's graphics card takes 2048 pixels a side.
#[test]
fn a_picture_too_large_for_the_graphics_card_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [4000.0, 520.0]);
    wait_until(&mut harness, is_settled);
    wait_until(&mut harness, |app| app.picture_on_show().is_some_and(|image| 2048 < image.size[0]));
    harness.key_press(egui::Key::X);
    harness.run_steps(3);
    assert!(harness.state().pinned.is_some(), "it cannot be pinned");
}

#[test]
fn what_cannot_be_written_is_told_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("gone");
    std::fs::create_dir(&place).unwrap();
    let mut harness = window(&scene_file(&place), [1024.0, 700.0]);
    harness.state_mut().interface.export.folder = Some(place.join("pictures"));
    harness.key_press(egui::Key::E);
    harness.run_steps(2);
    let edited = harness.state().document.description.clone();
    std::fs::remove_dir_all(&place).unwrap();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    wait_for_words(&mut harness, "small.toml: cannot be written");
    harness.key_press(egui::Key::F12);
    wait_for_words(&mut harness, "small-001.png: cannot be written");
    assert_eq!(harness.state().document.description, edited, "the edit is gone");
    assert!(harness.state().document.is_dirty(), "the scene counts as saved");
    // Once there is a place again, the same key saves.
    std::fs::create_dir(&place).unwrap();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    wait_until(&mut harness, |app| !app.document.is_dirty());
}

#[test]
fn a_copy_that_cannot_be_kept_is_told_once_and_tried_again() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    std::fs::create_dir(&own).unwrap();
    let mut harness = window_with(&scene_file(folder.path()), [1024.0, 700.0], Some(own.clone()));
    std::fs::remove_dir_all(&own).unwrap();
    harness.key_press(egui::Key::D);
    harness.run_steps(80);
    wait_for_words(&mut harness, "cannot keep a copy");
    harness.key_press(egui::Key::Escape);
    harness.run_steps(160);
    let is_told_again = harness.query_by_label_contains("cannot keep a copy").is_some();
    assert!(!is_told_again, "told again after it was read");
    // Nothing is edited meanwhile: what failed is tried again.
    std::fs::create_dir(&own).unwrap();
    let since = Instant::now();
    while !own.join("recovery-1.png").is_file() {
        assert!(since.elapsed() < PATIENCE, "no copy is kept");
        harness.step();
    }
}

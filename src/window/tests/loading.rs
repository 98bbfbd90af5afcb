//! While a file is loaded: what is said, and that it can be stopped.

use super::whole::{scene_file, wait_until, window};
use crate::io::progress::Step;
use crate::loader::{LoadProgress, Source};
use crate::window::status::loading_ui;
use egui::{Key, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;

#[test]
fn the_bar_tells_the_step_and_offers_to_stop() {
    let progress = LoadProgress::Loading {
        source: Source::Gallery("final"),
        step: Some(("meshes/igea.obj".to_owned(), Step::Reading(0.43))),
    };
    let mut harness = Harness::builder().with_size([700.0, 30.0]).build_ui_state(
        move |ui, stopped: &mut bool| *stopped |= loading_ui(ui, "final", &progress),
        false,
    );
    assert!(harness.query_by_label("loading final").is_some(), "the scene is not named");
    assert!(harness.query_by_label("reading igea.obj, 43 %").is_some(), "the step is not told");
    harness.run_steps(2);
    assert!(!harness.state(), "stopped by itself");
    harness.get_by_role_and_label(Role::Button, "Cancel").click();
    harness.run_steps(2);
    assert!(harness.state(), "the button does nothing");
}

/// The open scene stays, whatever is stopped, whenever it is stopped.
#[test]
fn escape_and_the_button_stop_loading_and_keep_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    let before = harness.state().document.description.clone();
    let large = folder.path().join("large.obj");
    let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_owned();
    text.extend(std::iter::repeat_n("# nothing\n", 2 << 20));
    std::fs::write(&large, text).unwrap();
    for by_key in [true, false] {
        harness.state_mut().open(Source::File(large.clone()));
        harness.step();
        assert!(harness.query_by_label("loading large").is_some(), "not said to be loaded");
        if by_key {
            harness.key_press(Key::Escape);
        } else {
            harness.get_by_role_and_label(Role::Button, "Cancel").click();
        }
        harness.run_steps(2);
        assert!(harness.state().files.loading.is_none(), "still loading");
        assert!(harness.query_by_label("loading large").is_none(), "still said to be loaded");
        wait_until(&mut harness, |app| app.files.loader.progress() == LoadProgress::Idle);
        harness.run_steps(20);
        assert_eq!(harness.state().files.title, "small", "the stopped scene came");
    }
    assert_eq!(harness.state().document.description, before, "the scene changed");
}

//! The whole window, with its own renderer behind it.

use crate::loader::Source;
use crate::window::app::App;
use crate::window::panels::SizeMode;
use crate::window::state::{InterfaceState, Remembered};
use crate::window::theme;
use egui::{Role, ThemePreference};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longer than anything takes, also on a machine that has much else to do.
pub(super) const PATIENCE: Duration = Duration::from_secs(180);

/// A scene file that renders in no time.
pub(super) fn scene_file(folder: &Path) -> PathBuf {
    let path = folder.join("small.toml");
    let mut scene = super::small_scene();
    scene.render.samples = 4;
    let text = crate::io::scene_file::write(&scene);
    std::fs::File::create(&path).unwrap().write_all(text.as_bytes()).unwrap();
    path
}

/// A window of that size on a scene, once it is loaded.
pub(super) fn window(path: &Path, size: [f32; 2]) -> Harness<'static, App> {
    build(path, size, 1.0, Remembered::default(), None)
}

/// The same with a folder for what the program keeps for itself.
pub(super) fn window_with(
    path: &Path,
    size: [f32; 2],
    own: Option<PathBuf>,
) -> Harness<'static, App> {
    build(path, size, 1.0, Remembered::default(), own)
}

/// The same with what an earlier window left.
pub(super) fn window_of(
    path: &Path,
    size: [f32; 2],
    remembered: Remembered,
) -> Harness<'static, App> {
    build(path, size, 1.0, remembered, None)
}

/// The same with that many pixels in a point, in a theme; `size` is in points.
pub(super) fn window_at(
    path: &Path,
    size: [f32; 2],
    per_point: f32,
    theme: ThemePreference,
) -> Harness<'static, App> {
    let state = InterfaceState { theme, ..InterfaceState::default() };
    build(path, size, per_point, Remembered::of(&state), None)
}

fn build(
    path: &Path,
    size: [f32; 2],
    per_point: f32,
    remembered: Remembered,
    own: Option<PathBuf>,
) -> Harness<'static, App> {
    let source = Source::File(path.to_owned());
    let ctx = egui::Context::default();
    // Pictures that fill the viewport, so that places in it are places in them.
    let state = InterfaceState { size_mode: SizeMode::Fill, ..remembered.restore() };
    let app = App::new(&ctx, Remembered::of(&state), source, own).expect("the threads start");
    harness_of(app, size, per_point)
}

/// A window of that size in points around an app, once its scene is loaded.
pub(super) fn harness_of(app: App, size: [f32; 2], per_point: f32) -> Harness<'static, App> {
    let theme = app.interface.theme;
    let mut installed = false;
    let frame = move |ui: &mut egui::Ui, app: &mut App| {
        if !std::mem::replace(&mut installed, true) {
            theme::install(ui.ctx());
            // The app was made with another context than the harness's.
            ui.ctx().set_theme(theme);
            ui.ctx().options_mut(|options| options.zoom_with_keyboard = false);
        }
        app.take_news(ui.ctx());
        app.frame_ui(ui);
    };
    let mut harness = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(per_point)
        .build_ui_state(frame, app);
    wait_until(&mut harness, |app| app.files.has_scene);
    harness
}

/// Lets frames pass until something is so.
pub(super) fn wait_until(harness: &mut Harness<'_, App>, is_so: impl Fn(&App) -> bool) {
    let since = Instant::now();
    while !is_so(harness.state()) {
        assert!(since.elapsed() < PATIENCE, "waited in vain: {}", doings(harness));
        harness.step();
        std::thread::yield_now();
    }
    harness.run_steps(3);
}

/// What a window is busy with.
fn doings(harness: &Harness<'_, App>) -> String {
    let app = harness.state();
    let (status, loading) = (app.work.session.status(), &app.files.loading);
    format!("{:?}, {} samples; loading {loading:?}", status.phase, status.samples)
}

pub(super) fn drag(harness: &mut Harness<'_, App>, from: egui::Pos2, by: egui::Vec2) {
    harness.drag_at(from);
    harness.run_steps(1);
    for step in 1..=5 {
        harness.hover_at(from + by * (step as f32 / 5.0));
        harness.run_steps(1);
    }
    harness.drop_at(from + by);
    harness.run_steps(2);
}

#[test]
fn a_drag_over_the_picture_turns_the_camera_and_is_one_step_of_undo() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    let before = harness.state().document.description.clone();
    let middle = harness.get_by_role_and_label(Role::Canvas, "Picture").rect().center();
    drag(&mut harness, middle, egui::vec2(80.0, 20.0));
    let after = harness.state().document.description.clone();
    assert_ne!(after.camera.eye, before.camera.eye, "the camera did not move");
    assert_eq!(after.camera.target, before.camera.target, "the target moved");
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    harness.run_steps(3);
    assert_eq!(harness.state().document.description, before, "not one step of undo");
    harness.get_by_label("undone: camera move");
}

#[test]
fn display_settings_never_restart_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    wait_until(&mut harness, |app| app.work.session.latest().is_some_and(|f| f.samples == 4));
    let before = harness.state().work.session.latest().unwrap();
    for key in [egui::Key::E, egui::Key::T, egui::Key::N] {
        harness.key_press(key);
        harness.run_steps(2);
    }
    assert_eq!(harness.state().document.description.tone_mapping.exposure, 0.5, "E does nothing");
    harness.key_press(egui::Key::N);
    harness.run_steps(2);
    let after = harness.state().work.session.latest().unwrap();
    let jobs = (before.job.settings, after.job.settings);
    assert_eq!(jobs.0, jobs.1, "the settings changed");
}

#[test]
fn an_edited_scene_is_saved_where_it_came_from_and_is_clean_then() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let mut harness = window(&path, [1024.0, 700.0]);
    harness.key_press(egui::Key::E);
    harness.run_steps(2);
    assert!(harness.state().document.is_dirty(), "an edit leaves the scene clean");
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    wait_until(&mut harness, |app| !app.document.is_dirty());
    let text = std::fs::read_to_string(&path).unwrap();
    let saved = crate::io::scene_file::parse(&text, &[]).unwrap();
    assert_eq!(saved, harness.state().document.description, "another scene was saved");
}

#[test]
fn a_broken_file_leaves_the_scene_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    let before = harness.state().document.description.clone();
    let broken = folder.path().join("broken.toml");
    std::fs::write(&broken, "[camera]\neye = 7\n").unwrap();
    harness.state_mut().open(Source::File(broken));
    wait_until(&mut harness, |app| app.files.loading.is_none());
    assert_eq!(harness.state().document.description, before, "the scene changed");
    assert!(harness.query_by_label_contains("broken.toml").is_some(), "the file is not named");
}

#[test]
fn done_means_no_more_frames_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    wait_until(&mut harness, |app| app.work.session.status().phase == crate::session::Phase::Done);
    harness.run_steps(40);
    let frames = harness.try_run();
    assert!(frames.is_ok(), "the window keeps repainting: {frames:?}");
}

#[test]
fn a_scene_changed_by_another_program_reloads_and_can_be_undone() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let mut harness = window(&path, [1024.0, 700.0]);
    let before = harness.state().document.description.clone();
    let mut changed = before.clone();
    changed.lights[0].power = [7.0; 3];
    changed.render.samples = 123;
    std::fs::write(&path, crate::io::scene_file::write(&changed)).unwrap();
    wait_until(&mut harness, |app| app.document.description.lights[0].power == [7.0; 3]);
    assert!(!harness.state().document.is_dirty(), "what the file holds counts as unsaved");
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    harness.run_steps(3);
    assert_eq!(harness.state().document.description, before, "the reload cannot be undone");
}

#[test]
fn unsaved_edits_survive_a_crash() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let own = folder.path().join("own");
    std::fs::create_dir(&own).unwrap();
    let edited = {
        let mut harness = window_with(&path, [1024.0, 700.0], Some(own.clone()));
        harness.key_press(egui::Key::D);
        harness.run_steps(3);
        harness.run_steps(80);
        wait_until(&mut harness, |_| own.join("recovery-1.png").is_file());
        harness.state().document.description.clone()
    };
    let mut harness = window_with(&path, [1024.0, 700.0], Some(own));
    assert_ne!(harness.state().document.description, edited, "the file was saved");
    harness.get_by_role_and_label(Role::Button, "Restore").click();
    wait_until(&mut harness, |app| app.files.title == "restored");
    let restored = &harness.state().document.description;
    assert_eq!(*restored, edited, "the edits were lost");
}

#[test]
fn escape_keeps_the_scene_that_another_would_replace() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let mut harness = window(&path, [1024.0, 700.0]);
    harness.key_press(egui::Key::E);
    harness.run_steps(2);
    harness.state_mut().open(Source::Gallery("pyramid"));
    harness.run_steps(3);
    assert!(harness.query_by_label_contains("Do not save").is_some(), "nobody asks");
    harness.key_press(egui::Key::Escape);
    harness.run_steps(3);
    assert!(harness.query_by_label_contains("Do not save").is_none(), "the question stays");
    assert!(harness.state().document.is_dirty(), "the edit is gone");
}

#[test]
fn a_light_is_dragged_in_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1400.0, 900.0]);
    harness.state_mut().interface.lights_shown = true;
    harness.state_mut().document.description.lights[0].position = [0.5, 0.5, 0.0];
    harness.run_steps(3);
    let mark = harness.get_by_label("Light key in the picture").rect().center();
    drag(&mut harness, mark, egui::vec2(40.0, 0.0));
    let scene = &harness.state().document.description;
    assert!(scene.lights[0].position[0] > 0.6, "at {:?}", scene.lights[0].position);
    let moved = harness.get_by_label("Light key in the picture").rect().center() - mark;
    assert!((moved - egui::vec2(40.0, 0.0)).length() < 1.0, "not under the hand: {moved:?}");
    assert_eq!(scene.camera, super::small_scene().camera, "the camera moved with it");
}

#[test]
fn a_pinned_picture_can_be_restored() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1400.0, 900.0]);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    let before = harness.state().document.description.clone();
    harness.key_press(egui::Key::X);
    harness.run_steps(2);
    harness.key_press(egui::Key::D);
    harness.run_steps(3);
    assert!(harness.query_by_label_contains("camera.aperture_radius").is_some(), "not listed");
    harness.key_press(egui::Key::E);
    harness.run_steps(3);
    let line = "tone_mapping.exposure";
    harness.get_by_label_contains(line).click();
    harness.run_steps(3);
    assert_eq!(harness.state().document.description.tone_mapping.exposure, 0.0, "one value stays");
    assert!(harness.query_by_label_contains(line).is_none(), "still listed");
    harness.get_by_role_and_label(Role::Button, "Restore").click();
    harness.run_steps(3);
    assert_eq!(harness.state().document.description, before, "the pinned scene is not back");
}

#[test]
fn a_mesh_named_by_an_edit_is_loaded_and_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    std::fs::write(folder.path().join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let mut harness = window(&path, [1024.0, 700.0]);
    let object = &mut harness.state_mut().document.description.objects[0];
    object.file = Some("a.obj".to_owned());
    object.kind = crate::scene::description::ObjectKind::Mesh;
    wait_until(&mut harness, |app| app.work.assets.meshes.len() == 1);
    harness.run_steps(3);
    let scene = harness.state().work.scene().expect("it resolves");
    let is_mesh = matches!(scene.objects[0].instance.shape(), crate::geometry::Shape::Mesh(_));
    assert!(is_mesh, "the old shape is still rendered");
}

#[test]
fn the_wheel_moves_the_camera_over_the_picture_and_nowhere_else() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    let picture = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
    let before = harness.state().document.description.camera.clone();
    let turn = |harness: &mut Harness<'_, App>, at: egui::Pos2| {
        harness.hover_at(at);
        harness.run_steps(2);
        harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: egui::vec2(0.0, 1.0),
            source: egui::MouseWheelSource::Wheel,
            phase: egui::TouchPhase::Move,
            modifiers: egui::Modifiers::NONE,
        });
        harness.run_steps(1);
        // The cursor comes back over the picture while the panel still scrolls.
        harness.hover_at(picture.center());
        harness.run_steps(4);
    };
    turn(&mut harness, picture.right_center() + egui::vec2(100.0, 0.0));
    assert_eq!(harness.state().document.description.camera, before, "the panel's wheel moved it");
    turn(&mut harness, picture.center());
    let after = &harness.state().document.description.camera;
    assert!(after.eye[2] < before.eye[2] * 0.95, "not nearer: {:?}", after.eye);
}

#[test]
fn another_number_of_threads_takes_over_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    wait_until(&mut harness, |app| app.work.session.latest().is_some_and(|f| f.samples == 4));
    let n_before = harness.state().work.session.status().n_threads;
    harness.state_mut().interface.n_threads = Some(n_before + 1);
    wait_until(&mut harness, |app| {
        let is_new = app.work.session.status().n_threads == n_before + 1;
        is_new && app.work.session.latest().is_some_and(|frame| frame.samples == 4)
    });
    assert!(harness.state().picture_on_show().is_some(), "the picture is gone");
}

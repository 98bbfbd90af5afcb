//! The box that renders a picture of a size of its own.

use super::whole::{scene_file, wait_until, window};
use crate::io::output::OutputFormat;
use crate::io::snapshot::read_pixels;
use crate::loader::{Source, load};
use crate::render::{RenderJob, RenderSettings, World};
use crate::scene::resolve;
use crate::session::Goal;
use crate::session::develop::develop;
use crate::threads;
use crate::tone_mapping::srgb_bytes;
use crate::window::app::App;
use crate::window::export_settings::{Destination, ExportSize};
use egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// A window with the box open, set to a small picture in that folder.
pub(super) fn with_box(scene: &Path, folder: &Path) -> Harness<'static, App> {
    let mut harness = window(scene, [1400.0, 900.0]);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::F12);
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, "Size: Custom").click();
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::SpinButton, "Pixels wide").set_value_accesskit(40.0);
    harness.get_by_role_and_label(Role::SpinButton, "Pixels high").set_value_accesskit(30.0);
    harness.get_by_role_and_label(Role::SpinButton, "Samples").set_value_accesskit(3.0);
    harness.run_steps(3);
    let export = &harness.state().interface.export;
    assert_eq!(export.pixels([9, 9]), [40, 30], "the size is not taken over");
    assert_eq!((export.size, export.samples), (ExportSize::Custom, Some(3)), "other settings");
    harness.state_mut().interface.export.folder = Some(folder.to_owned());
    harness.run_steps(2);
    harness
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_picture_is_rendered_to_its_samples_beside_the_live_one() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = tempfile::tempdir().unwrap();
    let scene = scene_file(folder.path());
    let mut harness = with_box(&scene, pictures.path());
    harness.get_by_role_and_label(Role::Button, "Render").click();
    wait_until(&mut harness, |_| !names(pictures.path()).is_empty());
    wait_until(&mut harness, |app| app.exporter.progress().is_none());
    assert_eq!(names(pictures.path()), ["small-001.png"], "other files");
    let path = pictures.path().join("small-001.png");
    let bytes = std::fs::read(&path).unwrap();
    let shown = read_pixels(&bytes, (40, 30)).expect("a whole PNG of the size that was asked for");

    // Opened again, it is the scene that made it, and makes the same bytes.
    let loaded = load(&Source::File(path), &[], &AtomicBool::new(false)).unwrap();
    assert_eq!(loaded.snapshot.expect("it carries its record").samples, 3, "other samples");
    let (description, assets) = (&loaded.description, &loaded.assets);
    let job = RenderJob {
        scene: Arc::new(resolve(description, assets).unwrap()),
        width: description.render.width,
        height: description.render.height,
        settings: RenderSettings::new(&description.render, Default::default()),
    };
    let pool = threads::pool("test", 1).unwrap();
    let goal = Goal { samples: description.render.samples, seconds: None, noise_percent: None };
    let never = AtomicBool::new(false);
    let world = pool.install(|| World::new(job));
    let film = develop(&world, &pool, goal, Instant::now(), &never, |_| ()).unwrap().film;
    let again = srgb_bytes(&film.picture(), &description.tone_mapping);
    assert!(shown == again, "the picture's own scene makes another picture");
}

#[test]
fn a_picture_can_be_linear_and_never_overwrites() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = tempfile::tempdir().unwrap();
    let taken = pictures.path().join("small-001.exr");
    std::fs::write(&taken, b"mine").unwrap();
    let mut harness = with_box(&scene_file(folder.path()), pictures.path());
    harness.get_by_role_and_label(Role::Button, "Format: EXR").click();
    harness.run_steps(2);
    assert_eq!(harness.state().interface.export.format, OutputFormat::Exr, "another format");
    harness.get_by_role_and_label(Role::Button, "Render").click();
    let written = pictures.path().join("small-002.exr");
    wait_until(&mut harness, |_| written.is_file());
    assert_eq!(std::fs::read(&taken).unwrap(), b"mine", "another file was overwritten");
    let picture = image::open(written).unwrap().into_rgb32f();
    assert_eq!(picture.dimensions(), (40, 30), "another size");
}

#[test]
fn a_picture_can_be_stopped_while_the_window_lives_on() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = tempfile::tempdir().unwrap();
    let mut harness = with_box(&scene_file(folder.path()), pictures.path());
    harness.state_mut().interface.export.samples = Some(1_048_576);
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::Button, "Render").click();
    wait_until(&mut harness, |app| app.exporter.progress().is_some_and(|p| 0 < p.samples.0));
    // An edit is answered meanwhile.
    let before = harness.state().work.session.latest().map(|frame| frame.generation);
    harness.key_press(Key::D);
    wait_until(&mut harness, |app| {
        app.work.session.latest().map(|frame| frame.generation) != before
    });
    assert!(harness.state().exporter.progress().is_some(), "an edit ended the picture");
    assert!(harness.query_by_label_contains("/1048576").is_some(), "no progress is shown");
    harness.get_by_role_and_label(Role::Button, "Stop").click();
    wait_until(&mut harness, |app| app.exporter.progress().is_none());
    assert!(names(pictures.path()).is_empty(), "a stopped picture was written");
}

#[test]
fn a_picture_goes_to_the_clipboard_and_a_missing_folder_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = with_box(&scene_file(folder.path()), &folder.path().join("nowhere"));
    harness.get_by_role_and_label(Role::Button, "Render").click();
    wait_until(&mut harness, |app| app.exporter.progress().is_some());
    wait_until(&mut harness, |app| app.exporter.progress().is_none());
    assert!(harness.query_by_label_contains("there is no folder").is_some(), "nobody says so");
    harness.key_press(Key::Escape);
    harness.run_steps(2);

    harness.get_by_role_and_label(Role::Button, "To: Clipboard").click();
    harness.run_steps(2);
    let export = &harness.state().interface.export;
    assert_eq!(export.destination, Destination::Clipboard, "still a file");
    harness.get_by_role_and_label(Role::Button, "Render").click();
    let mut copied = None;
    wait_until_copied(&mut harness, &mut copied);
    assert_eq!(copied, Some([40, 30]), "another picture is on the clipboard");
}

fn wait_until_copied(harness: &mut Harness<'_, App>, copied: &mut Option<[usize; 2]>) {
    let since = Instant::now();
    while copied.is_none() {
        assert!(since.elapsed().as_secs() < 60, "nothing is copied");
        harness.step();
        for command in &harness.output().platform_output.commands {
            if let egui::OutputCommand::CopyImage(image) = command {
                *copied = Some(image.size);
            }
        }
        std::thread::yield_now();
    }
}

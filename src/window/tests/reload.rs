//! Files that other programs change while they are open, and the copy kept for a crash.

use super::whole::{scene_file, wait_until, window, window_with};
use crate::io::scene_file;
use crate::scene::description::{ColorOrTexture, ObjectKind, TextureKind};
use crate::window::app::App;
use egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::path::{Path, PathBuf};

const SIZE: [f32; 2] = [1024.0, 700.0];
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// The small scene with a mesh and an image beside it.
fn scene_with_files(folder: &Path) -> PathBuf {
    let path = scene_file(folder);
    let text = std::fs::read_to_string(&path).unwrap();
    let mut scene = scene_file::parse(&text, &[]).unwrap();
    scene.objects[0].kind = ObjectKind::Mesh;
    scene.objects[0].file = Some("a.obj".to_owned());
    scene.textures[0].kind = TextureKind::Image;
    scene.textures[0].file = Some("a.png".to_owned());
    scene.materials[0].diffuse = ColorOrTexture::Texture("veins".to_owned());
    std::fs::write(folder.join("a.obj"), TRIANGLE).unwrap();
    image::RgbImage::from_pixel(2, 2, image::Rgb([200, 0, 0])).save(folder.join("a.png")).unwrap();
    std::fs::write(&path, scene_file::write(&scene)).unwrap();
    path
}

fn press(harness: &mut Harness<'_, App>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    harness.run_steps(3);
}

fn has_said(harness: &Harness<'_, App>, text: &str) -> bool {
    harness.query_by_label_contains(text).is_some()
}

#[test]
fn what_is_wrong_with_a_changed_file_is_told_until_the_file_is_right() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_with_files(folder.path());
    let mut harness = window(&path, SIZE);
    let before = harness.state().document.description.clone();
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("{text}\nbroken = [")).unwrap();
    wait_until(&mut harness, |app| app.files.reload_fault.is_some());
    assert!(has_said(&harness, "small.toml"), "the fault is not told");
    assert_eq!(harness.state().document.description, before, "the scene changed");
    std::fs::write(&path, text.replace("power = [100.0", "power = [7.0")).unwrap();
    wait_until(&mut harness, |app| app.document.description.lights[0].power[0] == 7.0);
    assert!(!has_said(&harness, "not TOML"), "the fault is still told");
}

#[test]
fn a_changed_mesh_and_a_changed_image_come_by_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_with_files(folder.path()), SIZE);
    let first_ball = harness.state().swatches.ball_is_of(&harness.state().work.assets);
    assert!(first_ball, "the ball shows other files");
    std::fs::write(folder.path().join("a.obj"), format!("{TRIANGLE}v 0 0 1\nf 1 2 4\n")).unwrap();
    let n_triangles = |app: &App| {
        let meshes = app.work.assets.meshes.values();
        meshes.map(|mesh| mesh.traced.mesh.triangles.len()).sum::<usize>()
    };
    wait_until(&mut harness, |app| n_triangles(app) == 2);
    let image = image::RgbImage::from_pixel(4, 4, image::Rgb([0, 200, 0]));
    image.save(folder.path().join("a.png")).unwrap();
    let is_green = |app: &App| {
        let image = app.work.assets.images.get("a.png");
        image.is_some_and(|image| image.width == 4)
    };
    wait_until(&mut harness, is_green);
    harness.run_steps(2);
    let app = harness.state();
    assert!(app.swatches.ball_is_of(&app.work.assets), "the ball shows the old image");
}

#[test]
fn edits_stay_where_only_a_mesh_is_new() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_with_files(folder.path()), SIZE);
    harness.key_press(Key::E);
    harness.run_steps(3);
    let edited = harness.state().document.description.clone();
    std::fs::write(folder.path().join("a.obj"), format!("{TRIANGLE}v 0 0 1\nf 1 2 4\n")).unwrap();
    wait_until(&mut harness, |app| {
        let meshes = app.work.assets.meshes.values();
        meshes.map(|mesh| mesh.traced.mesh.triangles.len()).sum::<usize>() == 2
    });
    harness.run_steps(3);
    let document = &harness.state().document;
    assert_eq!(document.description, edited, "the edit is gone");
    assert!(document.is_dirty(), "the edit counts as saved");
}

/// A mesh opened alone has its scene made up around it: what was edited stays, the rest follows.
#[test]
fn edits_stay_where_a_mesh_opened_alone_grows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, TRIANGLE).unwrap();
    let mut harness = window(&path, SIZE);
    let first = harness.state().document.description.clone();
    let document = &mut harness.state_mut().document;
    document.description.camera.eye[0] += 0.5;
    document.description.tone_mapping.exposure = 1.0;
    harness.run_steps(3);
    let edited = harness.state().document.description.clone();
    std::fs::write(&path, format!("{TRIANGLE}v 0 -3 9\nf 1 2 4\n")).unwrap();
    wait_until(&mut harness, |app| {
        app.document.description.objects[1].point != first.objects[1].point
    });
    harness.run_steps(3);
    let app = harness.state();
    let now = &app.document.description;
    assert_eq!(now.camera, edited.camera, "the camera was moved by somebody");
    assert_eq!(now.tone_mapping.exposure, 1.0, "so was the exposure");
    assert_eq!(now.objects[1].point.unwrap()[1], -3.0, "the ground is where the mesh stands");
    assert_ne!(now.lights, first.lights, "the light does not reach it");
    assert!(app.document.is_dirty(), "the edits count as saved");
    assert_ne!(app.home_camera, first.camera, "home is before the mesh as it was");
    assert!(has_said(&harness, "changed a file of the scene"), "it is not told");
}

#[test]
fn edits_that_a_changed_scene_replaces_are_one_undo_away_and_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let mut harness = window(&path, SIZE);
    let text = std::fs::read_to_string(&path).unwrap();
    harness.key_press(Key::E);
    harness.run_steps(3);
    let edited = harness.state().document.description.clone();
    std::fs::write(&path, text.replace("power = [100.0", "power = [7.0")).unwrap();
    wait_until(&mut harness, |app| app.document.description.lights[0].power[0] == 7.0);
    harness.run_steps(3);
    assert_eq!(harness.state().document.description.tone_mapping.exposure, 0.0, "half and half");
    assert!(has_said(&harness, "undo brings your edits back"), "it is not told");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert_eq!(harness.state().document.description, edited, "undo does not bring them back");
    assert!(harness.state().document.is_dirty(), "they count as saved");
}

/// Twice in a row: what is restored is kept again, and can be restored again.
#[test]
fn a_restored_scene_is_kept_again_and_finds_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_with_files(folder.path());
    let own = folder.path().join("elsewhere/own");
    std::fs::create_dir_all(&own).unwrap();
    let copy = own.join("recovery-1.png");
    let mut exposure = 0.0;
    for round in 0..3 {
        let mut harness = window_with(&path, SIZE, Some(own.clone()));
        if 0 < round {
            harness.run_steps(3);
            harness.get_by_role_and_label(Role::Button, "Restore").click();
            wait_until(&mut harness, |app| app.files.title == "restored");
        }
        let app = harness.state();
        assert_eq!(app.document.description.tone_mapping.exposure, exposure, "round {round}");
        assert_eq!(app.work.assets.meshes.len(), 1, "the mesh is lost in round {round}");
        assert!(!app.watcher.watches(&copy), "it watches what it writes itself");
        harness.key_press(Key::E);
        exposure += 0.5;
        harness.run_steps(80);
        let says = format!("exposure = {exposure:?}");
        wait_until(&mut harness, |_| {
            let kept = std::fs::read(&copy).unwrap_or_default();
            String::from_utf8_lossy(&kept).contains(&says)
        });
    }
}

#[test]
fn files_are_watched_where_they_are_now_and_not_once_the_scene_is_closed() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let mut harness = window(&path, SIZE);
    assert!(harness.state().watcher.watches(&path), "the file is not watched");
    let other = folder.path().join("other.toml");
    let ctx = harness.ctx.clone();
    harness.state_mut().save_to(&ctx, other.clone());
    wait_until(&mut harness, |app| app.files.scene_path.as_ref() == Some(&other));
    harness.run_steps(3);
    assert!(harness.state().watcher.watches(&other), "the new file is not watched");
    let text = std::fs::read_to_string(&other).unwrap();
    std::fs::write(&other, text.replace("power = [100.0", "power = [7.0")).unwrap();
    wait_until(&mut harness, |app| app.document.description.lights[0].power[0] == 7.0);
    harness.state_mut().interface.navigation.pivot = Some([1.0; 3]);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::W);
    harness.run_steps(3);
    assert!(!harness.state().files.has_scene, "the scene is still open");
    assert!(!harness.state().watcher.watches(&other), "a closed scene is watched");
    let pivot = harness.state().interface.navigation.pivot;
    assert_eq!(pivot, None, "the next scene is turned about a point of this one");
}

#[test]
fn a_copy_of_edits_goes_once_they_are_saved_or_let_go() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let own = folder.path().join("own");
    std::fs::create_dir(&own).unwrap();
    let copy = own.join("recovery-1.png");
    let edit = |harness: &mut Harness<'_, App>| {
        harness.key_press(Key::D);
        harness.run_steps(80);
        wait_until(harness, |_| copy.is_file());
    };
    let mut harness = window_with(&path, SIZE, Some(own.clone()));
    edit(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    wait_until(&mut harness, |app| !app.document.is_dirty());
    harness.run_steps(3);
    assert!(!copy.exists(), "the copy of what is saved stays");
    edit(&mut harness);
    drop(harness);
    let mut harness = window_with(&path, SIZE, Some(own.clone()));
    harness.run_steps(3);
    let left_behind = std::fs::read(&copy).unwrap();
    // Unsaved already, while the offer is open.
    harness.key_press(Key::E);
    harness.run_steps(80);
    assert_eq!(std::fs::read(&copy).unwrap(), left_behind, "the copy on offer is overwritten");
    press(&mut harness, "Discard");
    wait_until(&mut harness, |_| {
        std::fs::read(&copy).is_ok_and(|kept| !kept.is_empty() && kept != left_behind)
    });
    assert!(harness.query_by_label("Restore").is_none(), "it is offered again");
    edit(&mut harness);
    drop(harness);
    let mut harness = window_with(&path, SIZE, Some(own));
    press(&mut harness, "Restore");
    wait_until(&mut harness, |app| app.files.title == "restored");
    assert!(harness.query_by_label("Restore").is_none(), "the restored one is offered again");
    assert!(harness.state().document.is_dirty(), "what only the copy holds counts as saved");
    assert!(copy.is_file(), "the copy is gone before it is saved");
    let saved = folder.path().join("saved.toml");
    let ctx = harness.ctx.clone();
    harness.state_mut().save_to(&ctx, saved);
    wait_until(&mut harness, |app| !app.document.is_dirty());
    harness.run_steps(3);
    assert!(!copy.exists(), "the copy of what is saved stays");
}

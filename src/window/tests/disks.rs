//! Disks that are full, read-only or have other things where files should be: it is told, nothing
//! is lost, and the same again works once there is room.

use super::export::with_box;
use super::extremes::wait_for_words;
use super::whole::{scene_file, wait_until, window_with};
use crate::io::scene_file;
use crate::window::app::App;
use crate::window::settings;
use crate::window::state::Remembered;
use egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;

/// Names the small disk to the test that runs on it.
const DISK: &str = "PENUMBRA_TEST_DISK";

/// Runs a test of this file once more, in a process of its own with a small disk that goes when it
/// ends. Where the system lets nobody mount one, that is said and nothing is tested.
fn on_a_small_disk(name: &str, test: impl FnOnce(&Path)) {
    if let Some(disk) = std::env::var_os(DISK) {
        return test(Path::new(&disk));
    }
    let disk = tempfile::tempdir().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let with_disk = |script: &str| {
        let script = format!("mount -t tmpfs -o size=256k penumbra \"$0\" && {script}");
        let mut command = Command::new("unshare");
        command.args(["--user", "--map-root-user", "--mount", "sh", "-c", &script]);
        command.arg(disk.path());
        command
    };
    if !with_disk("true").output().is_ok_and(|run| run.status.success()) {
        eprintln!("{name} is not run: this system mounts no disk for it");
        return;
    }
    let mut again = with_disk("exec \"$@\"");
    again.arg(std::env::current_exe().unwrap());
    again.args([&format!("window::tests::disks::{name}"), "--exact", "--nocapture"]);
    let run = again.env(DISK, disk.path()).env("TMPDIR", elsewhere.path()).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success() && out.contains("1 passed"), "{out}{err}");
}

/// Takes all the room that a disk has.
fn fill(disk: &Path) {
    let mut filler = std::fs::File::create(disk.join("filler")).unwrap();
    while filler.write_all(&[0; 512]).is_ok() {}
}

fn run(program: &str, arguments: &[&str], place: &Path) {
    let status = Command::new(program).args(arguments).arg(place).status();
    assert!(status.unwrap().success(), "{program} {arguments:?}");
}

/// Mounts a disk over itself, read-only: what holds files open on it does not matter then.
fn protect(disk: &Path) {
    run("mount", &["--bind", disk.to_str().unwrap()], disk);
    run("mount", &["-o", "remount,bind,ro"], disk);
}

fn n_hidden(folder: &Path) -> usize {
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    names.filter(|name| name.to_string_lossy().starts_with(".penumbra-")).count()
}

/// An edit, and time for a copy of it.
fn edit(harness: &mut Harness<'_, App>) {
    harness.key_press(Key::E);
    harness.run_steps(80);
}

fn remember(harness: &mut Harness<'_, App>, scene_unit_mm: f64) {
    harness.state_mut().interface.scene_unit_mm = scene_unit_mm;
    harness.state_mut().keep_settings();
    harness.run_steps(3);
}

/// Edits, settings and saving on a disk that is spoiled and mended.
fn nothing_is_lost(disk: &Path, reason: &str, spoil: impl Fn(), mend: impl Fn()) {
    let (scene, own) = (scene_file(disk), disk.join("own"));
    let files = [scene.clone(), own.join("recovery-1.png"), own.join("settings.toml")];
    let read = || files.each_ref().map(|path| std::fs::read(path).unwrap());
    let mut harness = window_with(&scene, [1024.0, 700.0], Some(own.clone()));
    harness.state_mut().interface.export.folder = Some(disk.to_owned());
    // What becomes of the scene's file here is no edit of another program.
    harness.state().watcher.watch(Vec::new());
    edit(&mut harness);
    wait_until(&mut harness, |_| files[1].is_file());
    remember(&mut harness, 11.0);
    wait_until(&mut harness, |_| files[2].is_file());
    let before = read();
    spoil();
    edit(&mut harness);
    wait_for_words(&mut harness, "cannot keep a copy of your edits: ");
    remember(&mut harness, 12.0);
    wait_for_words(&mut harness, "cannot keep your settings: ");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    wait_for_words(&mut harness, &format!("small.toml: cannot be written: {reason}"));
    let app = harness.state();
    assert!(app.document.is_dirty(), "the scene counts as saved");
    let edited = app.document.description.clone();
    assert_eq!(edited.tone_mapping.exposure, 1.0, "an edit is lost");
    mend();
    assert!(read() == before, "an old file is not what it was");
    assert_eq!(n_hidden(disk) + n_hidden(&own), 0, "something is left behind");
    // The copy is tried again without being asked for, the rest on the next occasion.
    harness.run_steps(80);
    wait_until(&mut harness, |_| read()[1] != before[1]);
    remember(&mut harness, 12.0);
    let remembered = Remembered::of(&harness.state().interface);
    wait_until(&mut harness, |_| settings::load(Some(&own)) == remembered);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    wait_until(&mut harness, |app| !app.document.is_dirty());
    let text = std::fs::read_to_string(&scene).unwrap();
    assert_eq!(scene_file::parse(&text, &[]).unwrap(), edited, "another scene was saved");
}

/// A snapshot that cannot be written, and the same again.
fn snapshots_come_again(disk: &Path, reason: &str, spoil: impl Fn(), mend: impl Fn()) {
    let mut harness = window_with(&scene_file(disk), [480.0, 360.0], None);
    harness.state_mut().interface.export.folder = Some(disk.to_owned());
    spoil();
    harness.key_press(Key::F12);
    wait_for_words(&mut harness, &format!("small-001.png: cannot be written: {reason}"));
    mend();
    assert_eq!(n_hidden(disk), 0, "something is left behind");
    harness.key_press(Key::F12);
    wait_for_words(&mut harness, "snapshot ");
    let shot = std::fs::read(disk.join("small-001.png")).unwrap();
    assert!(crate::io::snapshot::read(&shot, disk).is_ok(), "no snapshot");
}

#[test]
fn a_full_disk_costs_nothing() {
    on_a_small_disk("a_full_disk_costs_nothing", |disk| {
        let reason = "No space left on device";
        let free = || std::fs::remove_file(disk.join("filler")).unwrap();
        nothing_is_lost(disk, reason, || fill(disk), free);
        snapshots_come_again(disk, reason, || fill(disk), free);
    });
}

#[test]
fn a_disk_that_becomes_read_only_costs_nothing() {
    on_a_small_disk("a_disk_that_becomes_read_only_costs_nothing", |disk| {
        let (reason, free) = ("Read-only file system", || run("umount", &[], disk));
        nothing_is_lost(disk, reason, || protect(disk), free);
        snapshots_come_again(disk, reason, || protect(disk), free);
    });
}

/// Folders stand where the files were.
#[test]
fn names_that_are_taken_cost_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["small.toml", "own/recovery-1.png", "own/settings.toml"];
    let place = |name: &str| folder.path().join(name);
    let moved = |name: &str| folder.path().join(format!("{name}.moved"));
    let take = || {
        for name in names {
            std::fs::rename(place(name), moved(name)).unwrap();
            std::fs::create_dir(place(name)).unwrap();
        }
    };
    let give_back = || {
        for name in names {
            std::fs::remove_dir(place(name)).unwrap();
            std::fs::rename(moved(name), place(name)).unwrap();
        }
    };
    nothing_is_lost(folder.path(), "Is a directory", take, give_back);
}

#[test]
fn a_picture_that_has_no_place_is_told_at_once_or_kept_elsewhere() {
    on_a_small_disk("a_picture_that_has_no_place_is_told_at_once_or_kept_elsewhere", |disk| {
        let folder = tempfile::tempdir().unwrap();
        let mut harness = with_box(&scene_file(folder.path()), disk);
        fill(disk);
        harness.get_by_role_and_label(Role::Button, "Render").click();
        wait_for_words(&mut harness, "No space left on device (os error 28); the picture is in ");
        let kept = std::env::temp_dir().join("small-001.png");
        assert!(crate::io::snapshot::read(&std::fs::read(&kept).unwrap(), &kept).is_ok(), "kept");
        assert_eq!(n_hidden(disk), 0, "something is left behind");
        protect(disk);
        // One that would never end.
        harness.state_mut().interface.export.samples = Some(1_048_576);
        harness.run_steps(2);
        harness.get_by_role_and_label(Role::Button, "Render").click();
        wait_for_words(&mut harness, "small-001.png: cannot be written: Read-only file system");
    });
}

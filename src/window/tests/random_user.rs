//! Somebody who does anything at any moment, from a seed: nothing stops, nothing is lost, and the
//! last picture is the one that a cold start makes.
//!
//! `PENUMBRA_RANDOM_STEPS` makes it longer and `PENUMBRA_RANDOM_SEED` another; a long run alone in
//! its process also holds its memory to a bound.

use super::whole::{PATIENCE, scene_file, wait_until, window_with};
use crate::document::Document;
use crate::geometry::AcceleratorKind;
use crate::io::scene_file::{get, parameters, validate, with_value};
use crate::io::snapshot::read_pixels;
use crate::loader::{Source, load};
use crate::render::{Film, RenderJob, RenderSettings, World, render_pass};
use crate::scene::resolve;
use crate::session::Phase;
use crate::tone_mapping::srgb_bytes;
use crate::window::app::App;
use egui::{Event, Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use toml::Value;

/// Steps of the test as it always runs.
const N_STEPS: u64 = 150;
/// A run of at least so many steps is alone, and its memory is looked at.
const LONG: u64 = 5000;
/// By how much memory may grow from the first third of a long run to its end: what undo keeps, and
/// what the allocator does not give back.
const MOST_GROWTH_MIB: u64 = 96;
/// Longer than any frame takes, and than the waits at the end, which tell what they wait for.
const LONGEST_FRAME: Duration = PATIENCE.saturating_mul(4);
/// Snapshots of a run that are rendered again.
const N_VERIFIED: usize = 2;

struct User {
    state: u64,
    places: Vec<PathBuf>,
}

impl User {
    fn below(&mut self, n: usize) -> usize {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
        ((self.state >> 11) % n as u64) as usize
    }

    fn unit(&mut self) -> f32 {
        self.below(10_001) as f32 / 10_000.0
    }

    fn act(&mut self, harness: &mut Harness<'_, App>) {
        match self.below(13) {
            0..=2 => self.press(harness),
            3 | 4 => self.drag(harness),
            5 => {
                let delta = egui::vec2(0.0, self.unit() * 6.0 - 3.0);
                harness.event(Event::MouseWheel {
                    unit: egui::MouseWheelUnit::Line,
                    delta,
                    source: egui::MouseWheelSource::Wheel,
                    phase: egui::TouchPhase::Move,
                    modifiers: Modifiers::NONE,
                });
            }
            6..=8 => self.edit(harness),
            9 => {
                let size = egui::vec2(420.0 + 300.0 * self.unit(), 320.0 + 200.0 * self.unit());
                harness.set_size(size);
            }
            10 => self.open(harness),
            11 => harness.key_press(Key::F12),
            _ => {
                let at = harness.state().viewport.rect.lerp_inside(egui::vec2(self.unit(), 0.5));
                harness.hover_at(at);
                harness.state_mut().work.session.pick(3.0, 3.0);
            }
        }
        harness.run_steps(1 + self.below(3));
        self.answer(harness);
    }

    fn press(&mut self, harness: &mut Harness<'_, App>) {
        const KEYS: [Key; 15] = [
            Key::E,
            Key::T,
            Key::D,
            Key::Space,
            Key::R,
            Key::Home,
            Key::Backspace,
            Key::N,
            Key::X,
            Key::H,
            Key::Num1,
            Key::Num4,
            Key::Num0,
            Key::L,
            Key::Escape,
        ];
        match self.below(4) {
            0 => harness.key_press_modifiers(Modifiers::COMMAND, Key::Z),
            1 => harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z),
            2 => harness.key_press_modifiers(Modifiers::SHIFT, KEYS[self.below(3)]),
            _ => harness.key_press(KEYS[self.below(KEYS.len())]),
        }
    }

    fn drag(&mut self, harness: &mut Harness<'_, App>) {
        let rect = harness.state().viewport.rect;
        let mut at = rect.lerp_inside(egui::vec2(self.unit(), self.unit()));
        harness.drag_at(at);
        for _ in 0..=self.below(4) {
            at += egui::vec2(self.unit() - 0.5, self.unit() - 0.5) * 60.0;
            harness.hover_at(at);
            harness.run_steps(1);
        }
        harness.drop_at(at);
    }

    /// Gives a parameter, any but the size of the work, another valid value. It is still there
    /// after a frame, unless another scene comes; the camera may be on the move.
    fn edit(&mut self, harness: &mut Harness<'_, App>) {
        let document = &mut harness.state_mut().document;
        let scene = &document.description;
        let mut paths = parameters(scene);
        paths.retain(|path| !path.to_string().starts_with("render."));
        let path = &paths[self.below(paths.len())];
        let Ok(Some(value)) = get(scene, path) else { return };
        let value = self.near(value);
        let Ok(edited) = with_value(scene, path, value) else { return };
        let asked = get(&edited, path);
        document.checkpoint(None);
        document.description = edited;
        document.checkpoint(None);
        let stays = harness.state().files.loading.is_none();
        harness.run_steps(1);
        if stays && !path.to_string().starts_with("camera.") {
            let found = get(&harness.state().document.description, path);
            assert_eq!(found, asked, "{path} is lost");
        }
    }

    fn near(&mut self, value: Value) -> Value {
        match value {
            Value::Float(x) => Value::Float(x * f64::from(0.5 + self.unit()) + 0.01),
            Value::Array(values) => {
                Value::Array(values.into_iter().map(|value| self.near(value)).collect())
            }
            Value::Boolean(is_so) => Value::Boolean(is_so != (self.below(3) == 0)),
            other => other,
        }
    }

    fn open(&mut self, harness: &mut Harness<'_, App>) {
        let index = self.below(self.places.len() + 1);
        let source = match self.places.get(index) {
            Some(path) => Source::File(path.clone()),
            None => Source::Gallery("pyramid"),
        };
        harness.state_mut().open(source);
    }

    /// Answers what is asked about unsaved edits: the file is opened, or not.
    fn answer(&mut self, harness: &mut Harness<'_, App>) {
        if harness.state().files.pending.is_none() {
            return;
        }
        harness.run_steps(1);
        let choice = "Do not save";
        let is_asked = harness.query_by_role_and_label(Role::Button, choice).is_some();
        if is_asked && self.below(2) == 0 {
            harness.get_by_role_and_label(Role::Button, choice).click();
        } else {
            harness.key_press(Key::Escape);
        }
        harness.run_steps(2);
    }
}

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

#[test]
fn a_user_at_random_loses_nothing_and_ends_with_the_right_picture() {
    let n_steps = number("PENUMBRA_RANDOM_STEPS").unwrap_or(N_STEPS);
    let seed = number("PENUMBRA_RANDOM_SEED").unwrap_or(20);
    let folder = tempfile::tempdir().unwrap();
    let scene = scene_file(folder.path());
    let mesh = folder.path().join("m.obj");
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n").unwrap();
    let broken = folder.path().join("broken.toml");
    std::fs::write(&broken, "[camera]\n").unwrap();
    let mut user = User {
        state: 0x9e37_79b9_7f4a_7c15 ^ (seed << 1),
        places: vec![scene.clone(), mesh, broken, folder.path().join("none.toml")],
    };
    // A frame that never ends would leave this test waiting for ever.
    let (beat, beats) = channel::<()>();
    let watchdog = crate::threads::spawn("watchdog", move || {
        loop {
            match beats.recv_timeout(LONGEST_FRAME) {
                Ok(()) => {}
                Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => std::process::abort(),
            }
        }
    });
    let pictures = folder.path().join("pictures");
    std::fs::create_dir(&pictures).unwrap();
    let own = folder.path().join("own");
    let mut harness = window_with(&scene, [600.0, 420.0], Some(own));
    harness.state_mut().interface.export.folder = Some(pictures.clone());
    let mut memory_before = None;
    for step in 0..n_steps {
        user.act(&mut harness);
        beat.send(()).unwrap();
        let document = &harness.state().document;
        assert_eq!(validate(&document.description), Ok(()), "seed {seed}, step {step}");
        if step == n_steps / 3 {
            memory_before = resident_mib();
        }
    }
    finish(&mut harness);
    check_history(&mut harness.state_mut().document, seed);
    check_picture(&mut harness, seed);
    let n_before = paths_in(&pictures).len();
    harness.key_press(Key::F12);
    harness.run_steps(1);
    wait_until(&mut harness, |_| n_before < paths_in(&pictures).len());
    check_snapshots(&pictures, seed);
    if let (true, Some(before), Some(after)) = (LONG <= n_steps, memory_before, resident_mib()) {
        let is_bounded = after < before + MOST_GROWTH_MIB;
        assert!(is_bounded, "seed {seed}: {before} MiB after a third, {after} MiB at the end");
    }
    drop(beat);
    watchdog.unwrap().join().unwrap();
}

/// Lets everything come to rest.
fn finish(harness: &mut Harness<'_, App>) {
    wait_until(harness, |app| app.files.loading.is_none() && app.files.has_scene);
    harness.state_mut().interface.is_paused = false;
    // Of the gallery's scenes too, which ask for more.
    harness.state_mut().document.description.render.samples = 2;
    harness.run_steps(4);
    wait_until(harness, |app| {
        let status = app.work.session.status();
        let frame = app.work.session.latest();
        status.phase == Phase::Done && frame.is_some_and(|frame| app.work.is_current(&frame))
    });
}

/// Everything can be undone and done again.
fn check_history(document: &mut Document, seed: u64) {
    let last = document.description.clone();
    let mut n_steps = 0;
    while document.undo().is_some() {
        assert_eq!(validate(&document.description), Ok(()), "seed {seed}, undone {n_steps} times");
        n_steps += 1;
    }
    while document.redo().is_some() {
        n_steps -= 1;
    }
    assert_eq!(n_steps, 0, "seed {seed}: as many steps forward as back");
    assert!(document.description == last, "seed {seed}: an edit is lost");
}

/// The picture on show is that of the last scene, as a cold start makes it.
fn check_picture(harness: &mut Harness<'_, App>, seed: u64) {
    finish(harness);
    let frame = harness.state().work.session.latest().expect("there is a picture");
    assert_eq!(frame.scale, 1, "seed {seed}: a preview is the last picture");
    let world = World::new(frame.job.clone());
    let mut film = Film::new(frame.job.width, frame.job.height).unwrap();
    let passed = render_pass(&world, &mut film, frame.samples, &AtomicBool::new(false));
    assert!(passed.is_ok(), "nobody stops it");
    let bits = |pixels: &[[f32; 3]]| pixels.as_flattened().iter().map(|x| x.to_bits()).collect();
    let (shown, cold): (Vec<u32>, Vec<u32>) =
        (bits(&frame.picture.pixels), bits(&film.picture().pixels));
    assert!(shown == cold, "seed {seed}: a cold start makes another picture");
}

/// Snapshots hold the scene that they are a picture of.
fn check_snapshots(pictures: &Path, seed: u64) {
    for shot in paths_in(pictures).iter().rev().take(N_VERIFIED) {
        let bytes = std::fs::read(shot).unwrap();
        let loaded = load(&Source::File(shot.clone()), &[], &AtomicBool::new(false)).unwrap();
        let scene = Arc::new(resolve(&loaded.description, &loaded.assets).unwrap());
        let render = &loaded.description.render;
        let (width, height) = (render.width, render.height);
        let settings = RenderSettings::new(render, AcceleratorKind::default());
        let world = World::new(RenderJob { scene, width, height, settings });
        let mut film = Film::new(width, height).unwrap();
        let n_samples = loaded.snapshot.expect("a snapshot").samples;
        let passed = render_pass(&world, &mut film, n_samples, &AtomicBool::new(false));
        assert!(passed.is_ok(), "nobody stops it");
        let rendered = srgb_bytes(&film.picture(), &loaded.description.tone_mapping);
        let saved = read_pixels(&bytes, (width, height)).unwrap();
        assert!(rendered == saved, "seed {seed}: {} shows another scene", shot.display());
    }
}

/// Pictures there, in the order of their names.
fn paths_in(pictures: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(pictures).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = entries.filter(|path| !is_hidden(path)).collect();
    paths.sort();
    paths
}

/// Whether it is a file that is still being written.
fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

/// Memory of this process in MiB, where the system tells.
fn resident_mib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? / 1024)
}

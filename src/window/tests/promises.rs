//! What the window promises, each with a test that fails where it is broken. The renderer is
//! scripted where it matters which picture is whose.

use super::whole::{drag, harness_of, scene_file, wait_until, window};
use crate::color::linear_from_srgb;
use crate::geometry::{TraversalCost, TreeStatistics};
use crate::loader::Source;
use crate::render::film::FilmTooLarge;
use crate::render::{
    Feature, Film, PassStatistics, Pick, PixelMap, RenderJob, Sampling, Stopped, World, render_pass,
};
use crate::scene::Background;
use crate::scene::description::ToneOperator;
use crate::session::{Phase, Renderer, Session};
use crate::window::app::App;
use crate::window::state::Remembered;
use crate::window::views::View;
use egui::{Key, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// The grey of the first job's picture; each job is one brighter.
const FIRST_GREY: u32 = 50;

/// Paints the picture of each job in a grey of its own. Previews are quick; refining never ends but
/// by being stopped, unless it is told to.
struct Greys {
    /// Jobs so far.
    n_jobs: Arc<AtomicU32>,
    /// Passes so far.
    n_passes: Arc<AtomicU32>,
    refines: bool,
}

impl Renderer for Greys {
    type World = World;

    fn prepare(&self, job: &RenderJob, _: &AtomicBool) -> Result<World, Stopped> {
        let grey = FIRST_GREY + self.n_jobs.fetch_add(1, Ordering::SeqCst);
        let mut scene = (*job.scene).clone();
        scene.objects.clear();
        scene.lights.clear();
        let light = linear_from_srgb(grey as f32 / 255.0);
        scene.background = Background::Color(glam::Vec3::splat(light));
        Ok(World::new(RenderJob { scene: Arc::new(scene), ..job.clone() }))
    }

    fn coarse(&self, world: &World, scale: u32) -> World {
        World::new(world.job.coarse(scale))
    }

    fn film(&self, world: &World) -> Result<Film, FilmTooLarge> {
        Film::new(world.job.width, world.job.height)
    }

    fn pass(
        &self,
        world: &World,
        film: &mut Film,
        n_samples: u32,
        stop: &AtomicBool,
    ) -> Result<PassStatistics, Stopped> {
        self.n_passes.fetch_add(1, Ordering::SeqCst);
        let is_first = film.n_samples() == 0;
        while !is_first && !self.refines && !stop.load(Ordering::Relaxed) {
            std::thread::yield_now();
        }
        render_pass(world, film, n_samples, stop)
    }

    fn features(&self, world: &World, _: &AtomicBool) -> Result<PixelMap<Feature>, Stopped> {
        crate::render::features::feature_map(world, &AtomicBool::new(false))
    }

    fn costs(&self, world: &World, _: &AtomicBool) -> Result<PixelMap<TraversalCost>, Stopped> {
        crate::render::features::cost_map(world, &AtomicBool::new(false))
    }

    fn sampling(&self, film: &Film) -> PixelMap<Sampling> {
        film.sampling()
    }

    fn pick(&self, world: &World, x: f32, y: f32) -> Option<Pick> {
        world.pick(x, y)
    }

    fn trees(&self, _: &World) -> TreeStatistics {
        TreeStatistics::default()
    }

    fn n_threads(&self) -> usize {
        1
    }
}

/// A window before a scripted renderer, with its counts of jobs and of passes.
struct Stage {
    harness: Harness<'static, App>,
    n_jobs: Arc<AtomicU32>,
    n_passes: Arc<AtomicU32>,
}

impl Stage {
    fn new(folder: &Path, refines: bool) -> Self {
        let (n_jobs, n_passes) = (Arc::<AtomicU32>::default(), Arc::<AtomicU32>::default());
        let renderer =
            Greys { n_jobs: Arc::clone(&n_jobs), n_passes: Arc::clone(&n_passes), refines };
        let session = Session::with_renderer(renderer, || ()).unwrap();
        let ctx = egui::Context::default();
        let path = scene_file(folder);
        let mut scene = super::small_scene();
        scene.render.samples = 4;
        scene.tone_mapping.operator = ToneOperator::Linear;
        std::fs::write(&path, crate::io::scene_file::write(&scene)).unwrap();
        let source = Source::File(path);
        let mut app =
            App::with_session(&ctx, Remembered::default(), source, None, session).unwrap();
        // Another number of threads would bring a session of its own.
        app.interface.n_threads = Some(1);
        let mut harness = harness_of(app, [700.0, 500.0], 1.0);
        wait_until(&mut harness, |app| app.picture_on_show().is_some());
        Self { harness, n_jobs, n_passes }
    }

    fn n_jobs(&self) -> u32 {
        self.n_jobs.load(Ordering::SeqCst)
    }

    /// The one grey on show.
    fn grey(&self) -> u32 {
        let image = self.harness.state().picture_on_show().unwrap();
        let first = image.pixels[0];
        let is_even = image.pixels.iter().all(|pixel| *pixel == first);
        assert!(is_even, "parts of two pictures are shown at once");
        u32::from(first.r())
    }

    /// Lets frames pass until the picture of the newest job is shown; whatever is shown meanwhile
    /// is never black and never older than what was shown before.
    fn show_newest(&mut self, mut shown: u32) -> u32 {
        let since = std::time::Instant::now();
        loop {
            self.harness.step();
            let grey = self.grey();
            assert!(FIRST_GREY <= grey, "black, or nearly: {grey}");
            assert!(shown <= grey, "from the picture of grey {shown} back to {grey}");
            shown = grey;
            if grey == FIRST_GREY + self.n_jobs() - 1 {
                return shown;
            }
            assert!(since.elapsed().as_secs() < 60, "the picture of the newest job is not shown");
            std::thread::yield_now();
        }
    }
}

/// A drag of a hundred steps, at the pace of the renderer: the preview of every job is shown, none
/// is black, and none comes after a newer one.
#[test]
fn a_drag_shows_every_finished_preview_and_never_black() {
    let folder = tempfile::tempdir().unwrap();
    let mut stage = Stage::new(folder.path(), false);
    let middle = stage.harness.get_by_role_and_label(Role::Canvas, "Picture").rect().center();
    stage.harness.drag_at(middle);
    stage.harness.step();
    // A hand that moves a few points may still mean a click.
    stage.harness.hover_at(middle + egui::vec2(-20.0, 0.0));
    stage.harness.run_steps(2);
    let mut shown = stage.show_newest(FIRST_GREY);
    let before = stage.n_jobs();
    for step in 1..=100_u16 {
        let n_jobs = stage.n_jobs();
        stage.harness.hover_at(middle + egui::vec2(f32::from(step), f32::from(step % 7)));
        let since = std::time::Instant::now();
        while stage.n_jobs() == n_jobs {
            assert!(since.elapsed().as_secs() < 60, "step {step} makes no job");
            stage.harness.step();
            std::thread::yield_now();
        }
        let newest = stage.show_newest(shown);
        assert!(shown < newest, "step {step} shows nothing new");
        shown = newest;
    }
    stage.harness.drop_at(middle);
    assert!(100 <= stage.n_jobs() - before, "{} jobs in 100 steps", stage.n_jobs() - before);
}

/// Done is a state: no frame is asked for, nothing is asked of the renderer, whatever is on show.
#[test]
fn done_means_idle_in_every_view() {
    let folder = tempfile::tempdir().unwrap();
    let mut stage = Stage::new(folder.path(), true);
    for (key, view) in
        [(Key::Num1, None), (Key::Num4, Some(View::Depth)), (Key::Num7, Some(View::Samples))]
    {
        stage.harness.key_press(key);
        stage.harness.run_steps(3);
        wait_until(&mut stage.harness, |app| {
            app.work.session.status().phase == Phase::Done
                && app.picture.legend().map(|legend| legend.view) == view
        });
        stage.harness.run_steps(40);
        let n_passes = stage.n_passes.load(Ordering::SeqCst);
        let frame = stage.harness.state().work.session.latest().unwrap();
        let frames = stage.harness.try_run();
        assert!(frames.is_ok(), "the window keeps repainting after {key:?}: {frames:?}");
        stage.harness.run_steps(40);
        let later = stage.harness.state().work.session.latest().unwrap();
        assert!(Arc::ptr_eq(&frame, &later), "a picture is made after the last, {key:?}");
        assert_eq!(stage.n_passes.load(Ordering::SeqCst), n_passes, "rendering goes on, {key:?}");
    }
}

/// Everything that only changes how the picture is shown leaves its samples alone.
#[test]
fn nothing_of_the_display_ever_restarts() {
    let folder = tempfile::tempdir().unwrap();
    let mut stage = Stage::new(folder.path(), true);
    wait_until(&mut stage.harness, |app| app.work.session.status().phase == Phase::Done);
    let (n_jobs, before) = (stage.n_jobs(), stage.harness.state().work.session.status());
    let picture = stage.harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
    stage.harness.hover_at(picture.center());
    let views =
        [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8];
    let others = [Key::E, Key::T, Key::L, Key::X, Key::Backtick, Key::H];
    for key in views.into_iter().chain(others) {
        stage.harness.key_press(key);
        stage.harness.run_steps(4);
    }
    let interface = &mut stage.harness.state_mut().interface;
    interface.lens_shown = true;
    interface.lights_shown = true;
    interface.display.zoom = crate::window::viewport::Zoom::Double;
    stage.harness.run_steps(4);
    let status = stage.harness.state().work.session.status();
    assert_eq!(status.generation, before.generation, "rendered again");
    assert_eq!(status.samples, 4, "samples were lost");
    assert_eq!(stage.n_jobs(), n_jobs, "another job was begun");
    let exposure = stage.harness.state().document.description.tone_mapping.exposure;
    assert_eq!(exposure, 0.5, "the keys do nothing");
}

/// Something that a hand does.
type Edit<'a> = &'a dyn Fn(&mut Harness<'_, App>);

/// Whatever a hand does to a scene can be taken back, step by step, to the last digit, and made
/// again.
#[test]
fn every_edit_can_be_taken_back_and_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    let middle = harness.get_by_role_and_label(Role::Canvas, "Picture").rect().center();
    let mut scenes = vec![harness.state().document.description.clone()];
    let edits: [Edit<'_>; 5] = [
        &|harness| drag(harness, middle, egui::vec2(60.0, 20.0)),
        &|harness| harness.key_press(Key::D),
        &|harness| harness.key_press(Key::E),
        &|harness| {
            let slider = harness.get_by_role_and_label(Role::Slider, "Aperture");
            slider.set_value_accesskit(0.3);
        },
        &|harness| harness.key_press(Key::Home),
    ];
    for edit in edits {
        edit(&mut harness);
        harness.run_steps(3);
        let now = harness.state().document.description.clone();
        assert_ne!(Some(&now), scenes.last(), "edit {} changes nothing", scenes.len());
        scenes.push(now);
    }
    for scene in scenes.iter().rev().skip(1) {
        harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::Z);
        harness.run_steps(3);
        assert_eq!(harness.state().document.description, *scene, "undo leads elsewhere");
    }
    for scene in &scenes[1..] {
        harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::Y);
        harness.run_steps(3);
        assert_eq!(harness.state().document.description, *scene, "redo leads elsewhere");
    }
}

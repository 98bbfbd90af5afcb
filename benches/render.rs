//! Samples a second of the whole renderer, for the scenes of the gallery or any scene file.
//!
//! ```text
//! cargo bench --bench render [-- SCENE ...] [--width W] [--samples N] [--threads N]
//! ```
//!
//! SCENE is a name of the gallery or the path of a scene file. One JSON line a scene, the best of
//! three pictures by wall time: millions of samples a second in all and for each thread.
#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use penumbra::geometry::AcceleratorKind;
use penumbra::io::gallery::GALLERY;
use penumbra::loader::{Loaded, Source, load};
use penumbra::render::{Film, RenderJob, RenderSettings, World, render_pass};
use penumbra::scene::resolve;

/// What goes wrong ends the bench.
type Failure = Box<dyn std::error::Error + Send + Sync>;

const REPETITIONS: usize = 3;

fn main() -> Result<(), Failure> {
    let (mut scenes, mut width, mut samples) = (Vec::new(), 640, 16);
    let mut threads = penumbra::threads::available();
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or("an option lacks its value");
        match argument.as_str() {
            "--width" => width = value()?.parse()?,
            "--samples" => samples = value()?.parse()?,
            "--threads" => threads = value()?.parse()?,
            _ => scenes.push(argument),
        }
    }
    if scenes.is_empty() {
        scenes.extend(GALLERY.iter().map(|entry| entry.name.to_owned()));
    }
    let pool = penumbra::threads::pool("bench", threads)?;
    for scene in &scenes {
        let entry = GALLERY.iter().find(|entry| entry.name == scene);
        let source = match entry {
            Some(entry) => Source::Gallery(entry.name),
            None => Source::File(scene.into()),
        };
        let loaded = load(&source, &[], &AtomicBool::new(false))?;
        let world = pool.install(|| world(&loaded, width))?;
        let seconds = pool.install(|| seconds(&world, samples))?;
        let n_samples = f64::from(world.job.width * world.job.height) * f64::from(samples);
        let rate = n_samples / seconds * 1e-6;
        println!(
            "{{\"scene\":{scene:?},\"width\":{},\"height\":{},\"samples\":{samples},\"threads\":{threads},\
             \"seconds\":{seconds:.4},\"msamples_per_s\":{rate:.3},\"msamples_per_s_thread\":{:.3}}}",
            world.job.width,
            world.job.height,
            rate / threads as f64
        );
    }
    Ok(())
}

fn world(loaded: &Loaded, width: u32) -> Result<World, Failure> {
    let mut description = loaded.description.clone();
    let render = &mut description.render;
    render.height = (width * render.height / render.width).max(1);
    render.width = width;
    Ok(World::new(RenderJob {
        scene: Arc::new(resolve(&description, &loaded.assets)?),
        width,
        height: description.render.height,
        settings: RenderSettings::new(&description.render, AcceleratorKind::default()),
    }))
}

/// The least that a picture takes.
fn seconds(world: &World, samples: u32) -> Result<f64, Failure> {
    let mut least = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let mut film = Film::new(world.job.width, world.job.height)?;
        let start = Instant::now();
        render_pass(world, &mut film, samples, &AtomicBool::new(false))
            .map_err(|_| "stopped by nobody")?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok(least)
}

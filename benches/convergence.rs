//! Error against samples and against seconds, for the scenes of the gallery and both samplers.
//!
//! ```text
//! cargo bench --bench convergence [-- SCENE ...] [--width W] [--samples MAX] [--reference N]
//! ```
//!
//! One JSON line a point: the root mean square error of linear luminance against a reference of
//! another seed, the noise figure that the renderer itself gives, and the seconds spent. The
//! reference's own error (at 16 times the largest sample count by default, Sobol) is small against
//! that of the points.
#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::Vec3;
use penumbra::color::luminance;
use penumbra::geometry::AcceleratorKind;
use penumbra::io::gallery::GALLERY;
use penumbra::loader::{Loaded, Source, load};
use penumbra::render::{Film, RenderJob, RenderSettings, World, render_pass};
use penumbra::scene::description::SamplerKind;
use penumbra::scene::resolve;

struct Options {
    scenes: Vec<String>,
    width: u32,
    samples: u32,
    reference: Option<u32>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = options()?;
    let pool = penumbra::threads::pool("bench", penumbra::threads::available())?;
    for entry in GALLERY {
        if !options.scenes.is_empty() && !options.scenes.iter().any(|name| name == entry.name) {
            continue;
        }
        let loaded = load(&Source::Gallery(entry.name), &[], &AtomicBool::new(false))?;
        pool.install(|| measure(entry.name, &loaded, &options))
            .map_err(|error| error.to_string())?;
    }
    Ok(())
}

fn options() -> Result<Options, Box<dyn std::error::Error>> {
    let mut options = Options { scenes: Vec::new(), width: 160, samples: 256, reference: None };
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    while let Some(argument) = arguments.next() {
        let mut number = || -> Result<u32, Box<dyn std::error::Error>> {
            Ok(arguments.next().ok_or("an option lacks its number")?.parse()?)
        };
        match argument.as_str() {
            "--width" => options.width = number()?,
            "--samples" => options.samples = number()?,
            "--reference" => options.reference = Some(number()?),
            _ => options.scenes.push(argument),
        }
    }
    Ok(options)
}

fn measure(
    name: &str,
    loaded: &Loaded,
    options: &Options,
) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let n_reference = options.reference.unwrap_or(16 * options.samples);
    let reference = world(loaded, options.width, SamplerKind::Sobol, 4711)?;
    let mut film = Film::new(reference.job.width, reference.job.height)?;
    develop(&reference, &mut film, n_reference);
    let truth = luminances(&film);
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    for (sampler, label) in [(SamplerKind::Random, "random"), (SamplerKind::Sobol, "sobol")] {
        let world = world(loaded, options.width, sampler, 0)?;
        let mut film = Film::new(world.job.width, world.job.height)?;
        let mut seconds = 0.0;
        let mut n_samples = 1;
        while n_samples <= options.samples {
            let start = Instant::now();
            develop(&world, &mut film, n_samples);
            seconds += start.elapsed().as_secs_f64();
            let errors = luminances(&film).into_iter().zip(&truth).map(|(a, b)| (a - b).powi(2));
            let rmse = (errors.sum::<f64>() / truth.len() as f64).sqrt();
            let noise = film.noise_percent().map_or("null".to_owned(), |n| format!("{n:.4}"));
            println!(
                "{{\"scene\":\"{name}\",\"sampler\":\"{label}\",\"samples\":{n_samples},\"rmse\":{rmse:.6e},\
                 \"rmse_percent\":{:.4},\"noise_percent\":{noise},\"seconds\":{seconds:.4}}}",
                100.0 * rmse / mean
            );
            n_samples *= 2;
        }
    }
    Ok(())
}

fn world(
    loaded: &Loaded,
    width: u32,
    sampler: SamplerKind,
    seed: u32,
) -> Result<World, Box<dyn std::error::Error + Send + Sync>> {
    let mut description = loaded.description.clone();
    let render = &mut description.render;
    render.height = (width * render.height / render.width).max(1);
    render.width = width;
    render.sampler = sampler;
    render.seed = seed;
    let job = RenderJob {
        scene: Arc::new(resolve(&description, &loaded.assets)?),
        width,
        height: description.render.height,
        settings: RenderSettings::new(&description.render, AcceleratorKind::default()),
    };
    Ok(World::new(job))
}

/// Adds samples up to `n_samples`, stopping at powers of two as every render does.
fn develop(world: &World, film: &mut Film, n_samples: u32) {
    let never = AtomicBool::new(false);
    while film.n_samples() < n_samples {
        let n = penumbra::render::plan::pass_samples(film.n_samples(), n_samples);
        if render_pass(world, film, n, &never).is_err() {
            return;
        }
    }
}

fn luminances(film: &Film) -> Vec<f64> {
    let picture = film.picture();
    picture.pixels.iter().map(|p| f64::from(luminance(Vec3::from_array(*p)))).collect()
}

//! From a job to a film: no files, no clock, no output.
//!
//! [`render_pass`] adds samples to a film, whole passes at a time; the session and the command line
//! both drive it. A job determines its pixels to the last bit, whatever the threads, the
//! accelerator and the grouping of passes.

mod adaptive;
mod course;
mod emission;
pub mod features;
pub mod film;
mod integrator;
pub mod job;
mod noise;
mod pixel;
pub mod plan;
mod shading;
mod world;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use crate::render::integrator::{Part, TileRenderer};

pub use crate::geometry::Stopped;
pub use course::{Course, Step};
pub use features::{Feature, PixelMap, Seen};
pub use film::{Film, Sampling};
pub use job::{RenderJob, RenderSettings};
pub use noise::Noise;
pub use world::{Pick, World};

/// What a pass did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassStatistics {
    /// Rays traced, of all kinds.
    pub n_rays: u64,
    /// Samples that were not finite and counted as black.
    pub n_invalid: u64,
}

/// Adds `n_samples` to every pixel of a film of the job's size, or as many on the mean where samples
/// go where the error is, on the current pool. `stop` is looked at before every few tiles.
///
/// Where samples go where the error is, a pass ends wherever they are shared out anew, and the rest is
/// a pass of its own.
///
/// # Errors
/// [`Stopped`]; the film is as it was before the pass that was stopped.
pub fn render_pass(
    world: &World,
    film: &mut Film,
    n_samples: u32,
    stop: &AtomicBool,
) -> Result<PassStatistics, Stopped> {
    let goal = film.n_samples() + n_samples;
    let mut statistics = PassStatistics::default();
    while film.n_samples() < goal {
        let is_adaptive = world.job.settings.adaptive;
        let end = if is_adaptive { adaptive::next_decision(film.n_samples()) } else { goal };
        let pass = pass_to(world, film, goal.min(end), stop)?;
        statistics.n_rays += pass.n_rays;
        statistics.n_invalid += pass.n_invalid;
    }
    Ok(statistics)
}

/// One pass, after which every pixel has `goal` samples on the mean.
fn pass_to(
    world: &World,
    film: &mut Film,
    goal: u32,
    stop: &AtomicBool,
) -> Result<PassStatistics, Stopped> {
    let tiles = plan::tiles(film.width(), film.height());
    let n_samples = goal - film.n_samples();
    let n_together = plan::tiles_together(tiles.len(), n_samples, rayon::current_num_threads());
    let (n_rays, n_invalid) = (AtomicU64::new(0), AtomicU64::new(0));
    let finished = {
        let film = &*film;
        tiles
            .par_chunks(n_together)
            .map_init(
                || TileRenderer::new(world),
                |renderer, tiles| {
                    if stop.load(Ordering::Relaxed) {
                        return Err(Stopped);
                    }
                    let mut parts: Vec<Part> =
                        tiles.iter().map(|tile| film.part(*tile, goal)).collect();
                    let statistics = renderer.render(&mut parts);
                    n_rays.fetch_add(statistics.n_rays, Ordering::Relaxed);
                    n_invalid.fetch_add(statistics.n_invalid, Ordering::Relaxed);
                    Ok(parts)
                },
            )
            .collect::<Result<Vec<_>, Stopped>>()?
    };
    film.commit(goal, &world.job.settings, finished.iter().flatten());
    Ok(PassStatistics { n_rays: n_rays.into_inner(), n_invalid: n_invalid.into_inner() })
}

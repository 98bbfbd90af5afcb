//! From a job to a film: no files, no clock, no output.
//!
//! [`render_pass`] adds samples to a film, whole passes at a time; the session and the command line
//! both drive it. A job determines its pixels to the last bit, whatever the threads, the
//! accelerator and the grouping of passes.

pub mod features;
pub mod film;
mod integrator;
pub mod job;
mod noise;
pub mod plan;
mod shading;
mod world;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use crate::render::integrator::TileRenderer;

pub use features::{Feature, PixelMap, Seen};
pub use film::{Film, Sampling};
pub use job::{RenderJob, RenderSettings};
pub use world::{Pick, World};

/// A pass was stopped; the film is as it was before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

/// What a pass did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassStatistics {
    /// Rays traced, of all kinds.
    pub n_rays: u64,
    /// Samples that were not finite and counted as black.
    pub n_invalid: u64,
}

/// Adds `n_samples` to every pixel of a film of the job's size, on the current pool. `stop` is
/// looked at before every tile.
///
/// # Errors
/// [`Stopped`]; the film is untouched then.
pub fn render_pass(
    world: &World,
    film: &mut Film,
    n_samples: u32,
    stop: &AtomicBool,
) -> Result<PassStatistics, Stopped> {
    let tiles = plan::tiles(film.width(), film.height());
    let first_sample = film.n_samples();
    let (n_rays, n_invalid) = (AtomicU64::new(0), AtomicU64::new(0));
    let finished = {
        let film = &*film;
        tiles
            .into_par_iter()
            .map_init(
                || TileRenderer::new(world),
                |renderer, tile| {
                    if stop.load(Ordering::Relaxed) {
                        return Err(Stopped);
                    }
                    let mut sums = film.tile_sums(&tile);
                    let statistics = renderer.render(&tile, first_sample, n_samples, &mut sums);
                    n_rays.fetch_add(statistics.n_rays, Ordering::Relaxed);
                    n_invalid.fetch_add(statistics.n_invalid, Ordering::Relaxed);
                    Ok((tile, sums))
                },
            )
            .collect::<Result<Vec<_>, Stopped>>()?
    };
    film.commit(n_samples, &finished);
    Ok(PassStatistics { n_rays: n_rays.into_inner(), n_invalid: n_invalid.into_inner() })
}

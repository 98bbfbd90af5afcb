//! A picture without a viewer: passes in one go until a goal is reached, then the bytes of a file.
//!
//! The command line and the window's "Render picture" make their files here, so that the same job
//! gives the same file whoever asks.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use crate::color::Picture;
use crate::io::output::{OutputFormat, TextChunk, WriteError, encode_exr, encode_hdr, encode_png};
use crate::render::film::FilmTooLarge;
use crate::render::{Film, World, plan, render_pass};
use crate::scene::description::ToneMappingDescription;
use crate::session::Goal;
use crate::tone_mapping::srgb_bytes;

/// Why there is no finished film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DevelopError {
    /// It was told to stop.
    #[error("the render was stopped")]
    Stopped,
    /// Memory does not suffice.
    #[error(transparent)]
    TooLarge(#[from] FilmTooLarge),
}

/// A finished film.
#[derive(Clone, Debug)]
pub struct Developed {
    /// All its passes.
    pub film: Film,
    /// Samples that were not finite and counted as black.
    pub n_invalid: u64,
}

/// Adds passes until the goal is reached, its seconds counted from `start`. `after_pass` is shown
/// the film after each; `stop` is looked at before every tile.
///
/// # Errors
/// When it is stopped, or the film does not fit into memory.
pub fn develop(
    world: &World,
    pool: &rayon::ThreadPool,
    goal: Goal,
    start: Instant,
    stop: &AtomicBool,
    mut after_pass: impl FnMut(&Film),
) -> Result<Developed, DevelopError> {
    let mut film = Film::new(world.job.width, world.job.height)?;
    let mut n_invalid = 0;
    while !goal.is_reached(&film, start.elapsed().as_secs_f64()) {
        let before = film.n_samples();
        let mut n_samples = plan::pass_samples(before, goal.samples);
        if let Some(seconds) = goal.seconds {
            // A long pass that would overrun by far is cut to what fits.
            let elapsed = start.elapsed().as_secs_f64();
            let affordable = f64::from(before) * (seconds - elapsed) / elapsed.max(1e-9);
            n_samples = n_samples.min((affordable as u32).max(1));
        }
        let pass = pool.install(|| render_pass(world, &mut film, n_samples, stop));
        n_invalid += pass.map_err(|_| DevelopError::Stopped)?.n_invalid;
        after_pass(&film);
    }
    Ok(Developed { film, n_invalid })
}

/// The bytes of a picture file. Only a PNG is tone-mapped and carries `texts`; `path` is where it
/// is to go, for the error.
///
/// # Errors
/// When encoding fails.
pub fn encode(
    path: &Path,
    format: OutputFormat,
    picture: &Picture,
    tone_mapping: &ToneMappingDescription,
    texts: &[TextChunk],
) -> Result<Vec<u8>, WriteError> {
    let error = |error: &dyn std::fmt::Display| WriteError::new(path, error);
    match format {
        OutputFormat::Png => {
            let srgb = srgb_bytes(picture, tone_mapping);
            encode_png((picture.width, picture.height), &srgb, texts).map_err(|e| error(&e))
        }
        OutputFormat::Exr => encode_exr(picture).map_err(|e| error(&e)),
        OutputFormat::Hdr => encode_hdr(picture).map_err(|e| error(&e)),
    }
}

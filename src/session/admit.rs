//! Whether a job and its threads fit into memory, found out before any of it is taken.

use crate::io::memory::{self, Limited, NoMemory};
use crate::render::RenderJob;
use crate::threads::STACK;

/// A job that the machine cannot hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TooLarge {
    /// Mostly because of its pixels.
    #[error("a picture of {width} x {height} pixels {error}; give a smaller size")]
    Picture {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// How much is needed, and how much there is.
        error: NoMemory,
    },
    /// Mostly because of its trees.
    #[error("building {accelerator} over {n_triangles} triangles {error}; give a smaller mesh")]
    Trees {
        /// What is to be built.
        accelerator: &'static str,
        /// Over how many triangles.
        n_triangles: usize,
        /// How much is needed, and how much there is.
        error: NoMemory,
    },
    /// Because of its threads.
    #[error("starting {n_threads} threads {error}; give a smaller number")]
    Threads {
        /// How many.
        n_threads: usize,
        /// How much is needed, and how much there is.
        error: NoMemory,
    },
}

/// Bytes for all that is not estimated: what threads keep for themselves, the smaller parts of a
/// scene, a file on its way out.
const BESIDE: u64 = 8 << 20;

/// Refuses a job whose film and trees do not fit beside what is in use.
///
/// # Errors
/// With the estimate, and with what is free.
pub fn admit(job: &RenderJob) -> Result<(), TooLarge> {
    let picture = job.picture_bytes();
    let (n_triangles, trees) = job.unbuilt_trees();
    memory::check(picture.saturating_add(trees).saturating_add(BESIDE)).map_err(|error| {
        if trees < picture {
            return TooLarge::Picture { width: job.width, height: job.height, error };
        }
        TooLarge::Trees { accelerator: job.settings.accelerator.name(), n_triangles, error }
    })
}

/// What the system's allocator sets aside of the addresses for each thread; twice as much while it
/// looks for a place.
const ARENA: u64 = 64 << 20;
/// What a thread writes to, beside its stack, before it has done anything.
const SMALL_THINGS: u64 = 1 << 20;

/// Refuses threads that do not fit into the limits set for this process. Where none are set, they
/// cost next to nothing until they work.
///
/// # Errors
/// With what they set aside, and with what is left.
pub fn admit_threads(n_threads: usize) -> Result<(), TooLarge> {
    let told = |error| TooLarge::Threads { n_threads, error };
    threads_fit(n_threads, Limited::now()).map_err(told)
}

/// The most threads of `n_wanted` that fit; 0 where none does.
pub fn threads_that_fit(n_wanted: usize) -> usize {
    let limited = Limited::now();
    (0..=n_wanted).rev().find(|n| threads_fit(*n, limited).is_ok()).unwrap_or(0)
}

fn threads_fit(n_threads: usize, limited: Limited) -> Result<(), NoMemory> {
    let (n, stack) = (n_threads as u64, STACK as u64);
    let addresses = n * (stack + ARENA) + ARENA;
    let data = n * (stack + SMALL_THINGS);
    memory::fits(addresses, limited.addresses.unwrap_or(u64::MAX))?;
    memory::fits(data, limited.data.unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::AcceleratorKind;
    use crate::io::scene_file::parse;
    use crate::render::RenderSettings;
    use crate::scene::{Assets, resolve};
    use std::sync::Arc;

    #[test]
    fn pictures_that_no_machine_holds_are_refused_with_the_figure() {
        let text = "camera = { eye = [0, 0, 1], target = [0, 0, 0] }";
        let description = parse(text, &[]).unwrap();
        let scene = Arc::new(resolve(&description, &Assets::default()).unwrap());
        let settings = RenderSettings::new(&description.render, AcceleratorKind::default());
        let job =
            |side| RenderJob { scene: Arc::clone(&scene), width: side, height: side, settings };
        assert_eq!(admit(&job(1000)), Ok(()), "a small picture");
        if memory::free().is_some() {
            let refused = admit(&job(1 << 20)).unwrap_err().to_string();
            let needed = memory::size(job(1 << 20).picture_bytes());
            let expected = format!("a picture of 1048576 x 1048576 pixels takes {needed}");
            let is_told = refused.starts_with(&expected) && needed.ends_with("GiB");
            assert!(is_told && refused.contains("are free"), "{refused}");
        }
    }

    #[test]
    fn threads_fit_into_the_limits_that_are_set() {
        let limited = |addresses, data| Limited { addresses, data, file: None };
        let fit = |n, limited| threads_fit(n, limited).is_ok();
        assert!(fit(100_000, limited(None, None)), "no limit");
        assert!(fit(2, limited(Some(256 << 20), None)), "two, and one more place");
        assert!(!fit(3, limited(Some(256 << 20), None)), "a third");
        assert!(fit(20, limited(None, Some(64 << 20))), "only what is written to counts");
        assert!(!fit(21, limited(None, Some(64 << 20))), "one more");
        assert_eq!(threads_that_fit(0), 0, "none are wanted");
        let refused = threads_fit(1024, limited(Some(1 << 30), None)).unwrap_err();
        let told = TooLarge::Threads { n_threads: 1024, error: refused }.to_string();
        let expected = "starting 1024 threads takes 66.1 GiB of memory, and 1.0 GiB are free; \
                        give a smaller number";
        assert_eq!(told, expected, "both figures");
    }
}

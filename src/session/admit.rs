//! Whether a job fits into memory, found out before any of it is taken.

use crate::io::memory::{self, NoMemory};
use crate::render::RenderJob;

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
}

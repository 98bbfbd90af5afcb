//! What the session drives: the real renderer, or a script in tests.

use std::sync::atomic::AtomicBool;

use crate::geometry::{TraversalCost, TreeStatistics};
use crate::render::features::{cost_map, feature_map};
use crate::render::film::FilmTooLarge;
use crate::render::{
    Feature, Film, PassStatistics, Pick, PixelMap, RenderJob, Sampling, Stopped, World, render_pass,
};
use crate::threads;

/// Turns jobs into films.
pub trait Renderer: Send + Sync + 'static {
    /// A job made ready.
    type World: Send + Sync;

    /// Makes a job ready; may take as long as building its trees does.
    ///
    /// # Errors
    /// [`Stopped`].
    fn prepare(&self, job: &RenderJob, stop: &AtomicBool) -> Result<Self::World, Stopped>;

    /// The same, for a smaller picture of a scene that is ready.
    fn coarse(&self, world: &Self::World, scale: u32) -> Self::World;

    /// An empty film for a world.
    ///
    /// # Errors
    /// When it does not fit into memory.
    fn film(&self, world: &Self::World) -> Result<Film, FilmTooLarge>;

    /// Adds samples to a film.
    ///
    /// # Errors
    /// [`Stopped`]; the film is untouched then.
    fn pass(
        &self,
        world: &Self::World,
        film: &mut Film,
        n_samples: u32,
        stop: &AtomicBool,
    ) -> Result<PassStatistics, Stopped>;

    /// The first hits of all pixels.
    ///
    /// # Errors
    /// [`Stopped`].
    fn features(
        &self,
        world: &Self::World,
        stop: &AtomicBool,
    ) -> Result<PixelMap<Feature>, Stopped>;

    /// What the first hits of all pixels cost.
    ///
    /// # Errors
    /// [`Stopped`].
    fn costs(
        &self,
        world: &Self::World,
        stop: &AtomicBool,
    ) -> Result<PixelMap<TraversalCost>, Stopped>;

    /// Samples and error of every pixel.
    fn sampling(&self, film: &Film) -> PixelMap<Sampling>;

    /// What the middle ray of a pixel meets.
    fn pick(&self, world: &Self::World, x: f32, y: f32) -> Option<Pick>;

    /// Size of a world's trees.
    fn trees(&self, world: &Self::World) -> TreeStatistics;

    /// Threads that it renders with.
    fn n_threads(&self) -> usize;
}

/// The real renderer, on a pool of its own at low priority.
#[derive(Debug)]
pub struct PoolRenderer {
    pool: rayon::ThreadPool,
}

impl PoolRenderer {
    /// Starts `n_threads` (at least 1) threads.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn new(n_threads: usize) -> std::io::Result<Self> {
        Ok(Self { pool: threads::background_pool("render", n_threads)? })
    }
}

impl Renderer for PoolRenderer {
    type World = World;

    fn prepare(&self, job: &RenderJob, stop: &AtomicBool) -> Result<World, Stopped> {
        self.pool.install(|| World::build(job.clone(), stop))
    }

    fn coarse(&self, world: &World, scale: u32) -> World {
        self.pool.install(|| World::new(world.job.coarse(scale)))
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
        self.pool.install(|| render_pass(world, film, n_samples, stop))
    }

    fn features(&self, world: &World, stop: &AtomicBool) -> Result<PixelMap<Feature>, Stopped> {
        self.pool.install(|| feature_map(world, stop))
    }

    fn costs(&self, world: &World, stop: &AtomicBool) -> Result<PixelMap<TraversalCost>, Stopped> {
        self.pool.install(|| cost_map(world, stop))
    }

    fn sampling(&self, film: &Film) -> PixelMap<Sampling> {
        self.pool.install(|| film.sampling())
    }

    fn pick(&self, world: &World, x: f32, y: f32) -> Option<Pick> {
        world.pick(x, y)
    }

    fn trees(&self, world: &World) -> TreeStatistics {
        world.geometry.statistics()
    }

    fn n_threads(&self) -> usize {
        self.pool.current_num_threads()
    }
}

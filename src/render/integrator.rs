//! Light transport in waves: one loop for both integrators.
//!
//! All rays of a wave are intersected by one call, all their shadow rays by another, and what goes
//! on is the next wave. A path has one continuing ray, chosen among mirror, glass and (in "path")
//! scattering by how much each reflects. Shadow rays find the light of `[[lights]]` and, in "path",
//! of what glows and of the sky; scattered rays find the latter too, and both are weighted by the
//! power heuristic.

mod block_light;
mod continuation;
mod direct_light;
mod first_rays;
mod groups;
mod meeting;
mod shadows;

use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::color::Rgb;
use crate::geometry::{Hit, HitBlock, Nearest};
use crate::math::sampler::{Net, NumbersBlock, SampleNumbers, Sampler};
use crate::math::vectorized::{BLOCK, Lane, Lane3, NO_LANES, set_vec3, vec3};
use crate::math::{PrimitiveId, RayBatch};
use crate::render::PassStatistics;
use crate::render::pixel::PixelSums;
use crate::render::plan::Tile;
use crate::render::shading::{Coat, ShadingBlock};
use crate::render::world::World;
use crate::scene::description::IntegratorKind;
use crate::scene::light::LightBlock;

use direct_light::LightChoice;
use first_rays::FirstRays;
use groups::Groups;
use shadows::Shadows;

/// Dimensions of a sample's numbers. Each scattering event has a block of its own.
mod dimension {
    pub(super) const PIXEL: u32 = 0;
    pub(super) const LENS: u32 = 1;
    pub(super) const CHOICE: u32 = 2;
    pub(super) const SCATTER: u32 = 3;
    pub(super) const PROBE: u32 = 4;
    pub(super) const LIGHT_CHOICE: u32 = 5;
    pub(super) const EMITTER_CHOICE: u32 = 6;
    pub(super) const EMITTER: u32 = 7;
    pub(super) const FIRST_LIGHT: u32 = 16;

    pub(super) fn of(depth: u32, purpose: u32) -> u32 {
        depth << 16 | purpose
    }
}

/// Paths that a wave holds at most, unless there are more pixels.
const WAVE_SIZE: usize = 4096;
/// From this depth on, weak paths may end early.
const ROULETTE_DEPTH: u32 = 4;

/// A path whose next ray is in the current wave.
#[derive(Clone, Copy)]
struct Path {
    /// Which sample of the block it belongs to.
    slot: u32,
    throughput: Rgb,
    numbers: SampleNumbers,
    /// Scattering events so far.
    depth: u32,
    /// Where the ray was scattered, and not mirrored or refracted: light that was looked for there
    /// counts by its share only, and visible lights have been counted in full.
    scattered: Option<Scattered>,
}

/// The last surface of a path, as far as it decides with which chance other ways find the light that
/// its scattered ray meets.
#[derive(Clone, Copy)]
struct Scattered {
    from: Vec3,
    normal: Vec3,
    /// Index of the object that it is on.
    object: u32,
    /// Density of the ray per solid angle, with the chance that the path scattered at all.
    pdf: f32,
    /// Sum of the weights of all emitters as seen from there.
    total: f32,
}

/// A tile whose pixels want more samples.
pub(super) struct Part {
    pub(super) tile: Tile,
    /// Samples that each pixel shall have.
    pub(super) goals: Vec<u32>,
    /// Row by row.
    pub(super) pixels: Vec<PixelSums>,
}

/// The samples of one pixel in a block.
struct Run {
    part: usize,
    /// In the tile, row by row.
    pixel: usize,
    slots: Range<usize>,
}

/// A block of samples on their way, with the memory of its waves.
pub(super) struct TileRenderer<'a> {
    world: &'a World,
    runs: Vec<Run>,
    radiance: Vec<Rgb>,
    rays: RayBatch,
    paths: Vec<Path>,
    hits: Vec<Nearest>,
    next_rays: RayBatch,
    next_paths: Vec<Path>,
    groups: Groups,
    /// Paths that have met nothing.
    lost: Vec<u32>,
    shadows: Shadows,
    lights: LightChoice,
    samples: LightBlock,
    emitter_weights: Vec<f32>,
}

/// Paths of a wave that have met the same material of one object.
struct Block {
    /// How many; the last one is repeated to the end.
    n: usize,
    /// Where they are in the wave.
    places: Lane<u32>,
    depth: u32,
    slots: Lane<u32>,
    numbers: NumbersBlock,
    throughput: Lane3,
    rays: HitBlock,
    hits: Lane<Hit>,
    shading: ShadingBlock,
}

impl Part {
    /// Pixels that have fewer samples than they shall.
    fn n_open(&self) -> usize {
        let is_open = |(pixel, goal): &(&PixelSums, &u32)| pixel.n_samples < **goal;
        self.pixels.iter().zip(&self.goals).filter(is_open).count()
    }
}

impl<'a> TileRenderer<'a> {
    pub(super) fn new(world: &'a World) -> Self {
        Self {
            world,
            runs: Vec::new(),
            radiance: Vec::new(),
            rays: RayBatch::default(),
            paths: Vec::new(),
            hits: Vec::new(),
            next_rays: RayBatch::default(),
            next_paths: Vec::new(),
            groups: Groups::new(world),
            lost: Vec::new(),
            shadows: Shadows::default(),
            lights: LightChoice::default(),
            samples: LightBlock::EMPTY,
            emitter_weights: Vec::new(),
        }
    }

    /// Adds samples to the pixels of tiles, in sample order, until each has as many as its goal.
    pub(super) fn render(&mut self, parts: &mut [Part]) -> PassStatistics {
        let mut statistics = PassStatistics::default();
        loop {
            let n_open: usize = parts.iter().map(Part::n_open).sum();
            if n_open == 0 {
                return statistics;
            }
            self.start(parts, (WAVE_SIZE / n_open).max(1) as u32);
            self.trace(&mut statistics);
            for run in &self.runs {
                let pixel = &mut parts[run.part].pixels[run.pixel];
                for sample in &self.radiance[run.slots.clone()] {
                    let is_valid = sample.is_finite();
                    statistics.n_invalid += u64::from(!is_valid);
                    pixel.add(if is_valid { *sample } else { Rgb::ZERO });
                }
            }
        }
    }

    /// Follows the paths of a block, wave by wave, into `radiance`.
    fn trace(&mut self, statistics: &mut PassStatistics) {
        let mut block = Block::new(self.world.job.settings.sampler);
        while !self.rays.is_empty() {
            self.world.geometry.intersect(&self.rays, &mut self.hits);
            statistics.n_rays += self.rays.len() as u64;
            self.next_rays.clear();
            self.next_paths.clear();
            self.shadows.clear();
            self.meet();
            self.shade(&mut block);
            statistics.n_rays += self.shadows.rays.len() as u64;
            self.shadows.resolve(self.world, &mut self.radiance);
            std::mem::swap(&mut self.rays, &mut self.next_rays);
            std::mem::swap(&mut self.paths, &mut self.next_paths);
        }
    }

    /// The first wave: a camera ray for each of the next samples, up to `n_at_once` a pixel.
    fn start(&mut self, parts: &[Part], n_at_once: u32) {
        let job = &self.world.job;
        let size = Vec2::new(job.width as f32, job.height as f32);
        self.rays.clear();
        self.paths.clear();
        self.runs.clear();
        let mut first_rays = FirstRays::new(job.settings.sampler);
        let pixels = parts.iter().enumerate().flat_map(|(index, part)| {
            part.tile.pixels().enumerate().map(move |(pixel, at)| (index, part, pixel, at))
        });
        for (index, part, pixel, (x, y)) in pixels {
            let first_slot = self.paths.len();
            let first = part.pixels[pixel].n_samples;
            let numbers = job.settings.sampler.numbers(x, y, first);
            for sample in first..part.goals[pixel].min(first + n_at_once) {
                let numbers = numbers.of_sample(sample);
                first_rays.push((x, y), &numbers, &job.scene.camera, size, &mut self.rays);
                self.paths.push(Path {
                    slot: self.paths.len() as u32,
                    throughput: Rgb::ONE,
                    numbers,
                    depth: 0,
                    scattered: None,
                });
            }
            self.runs.push(Run { part: index, pixel, slots: first_slot..self.paths.len() });
        }
        first_rays.flush(&job.scene.camera, size, &mut self.rays);
        self.radiance.clear();
        self.radiance.resize(self.paths.len(), Rgb::ZERO);
    }

    /// Adds the light of all surfaces met, block by block, leaves shadow rays, and goes on.
    fn shade(&mut self, block: &mut Block) {
        for group in 0..self.groups.len() {
            let (number, mut places) = self.groups.take(group);
            let (object, slot) = self.world.slots[number];
            let coat = Coat::new(self.world, object, slot);
            while !places.is_empty() {
                let n = places.len().min(BLOCK);
                block.n = n;
                for i in 0..BLOCK {
                    let place = self.groups.path(places.start + i.min(n - 1));
                    if let Some(hit) = self.hits[place as usize].hit() {
                        block.set(i, &self.rays, place, &self.paths[place as usize], hit);
                    }
                }
                places.start += n;
                self.advance(&coat, block);
            }
        }
    }

    /// The light of the surfaces of a block, shadow rays to more of it, and what goes on.
    fn advance(&mut self, coat: &Coat<'_>, block: &mut Block) {
        let world = self.world;
        block.shading.fill(coat, &block.rays);
        let (n, material) = (block.n, coat.material);
        let emission = material.emission;
        if emission != Rgb::ZERO {
            for i in 0..n {
                let path = self.paths[block.places[i] as usize];
                let share = path.scattered.map_or(1.0, |last| {
                    let direction = vec3(&block.rays.direction, i).normalize();
                    let from = (last.from, last.normal, last.object, last.total);
                    let surface = block.shading.surface.surface(i);
                    let met = (block.hits[i], &surface, emission);
                    power(last.pdf, world.emission.pdf(from, direction, met))
                });
                self.add(path, emission * share);
            }
        }
        let settings = &world.job.settings;
        let ambient = world.job.scene.ambient;
        if settings.integrator == IntegratorKind::Direct && ambient != Rgb::ZERO {
            for i in 0..n {
                let light = vec3(&block.shading.diffuse, i) * ambient;
                self.radiance[block.slots[i] as usize] += vec3(&block.throughput, i) * light;
            }
        }
        if !material.is_never_lit() {
            self.light_block(coat, block);
        }
        let goes_on = block.depth < settings.max_depth
            && (settings.integrator == IntegratorKind::Path || material.is_specular());
        if goes_on {
            for i in 0..n {
                let path = self.paths[block.places[i] as usize];
                self.go_on(path, &block.shading.shading(coat, i));
            }
        }
    }

    /// Two numbers to choose a direction by; at what the camera sees, a net together with pixel and
    /// lens. Light, probe and scattering are terms of a sum, so they can be nets of one kind.
    fn first_net(&self, path: Path, purpose: u32) -> [f32; 2] {
        let dimension = dimension::of(path.depth, purpose);
        match self.joint_net(path.depth) {
            Some(net) => path.numbers.joint_pair(dimension, net),
            None => path.numbers.pair(dimension),
        }
    }

    /// Whose net the numbers of [`TileRenderer::first_net`] share.
    fn joint_net(&self, depth: u32) -> Option<Net> {
        let is_pinhole = self.world.job.scene.camera.aperture_radius == 0.0;
        let net = if is_pinhole { Net::Second } else { Net::Third };
        (depth == 0).then_some(net)
    }

    fn add(&mut self, path: Path, radiance: Rgb) {
        self.radiance[path.slot as usize] += path.throughput * radiance;
    }
}

impl Block {
    fn new(sampler: Sampler) -> Self {
        Self {
            n: 0,
            places: [0; BLOCK],
            depth: 0,
            slots: [0; BLOCK],
            numbers: NumbersBlock::new(sampler),
            throughput: NO_LANES,
            rays: HitBlock::EMPTY,
            hits: [Hit { t: 0.0, id: PrimitiveId::NONE }; BLOCK],
            shading: ShadingBlock::EMPTY,
        }
    }

    fn set(&mut self, i: usize, rays: &RayBatch, place: u32, path: &Path, hit: Hit) {
        self.rays.set(i, rays, place as usize, hit);
        self.hits[i] = hit;
        self.slots[i] = path.slot;
        self.numbers.set(i, &path.numbers);
        set_vec3(&mut self.throughput, i, path.throughput);
        self.places[i] = place;
        self.depth = path.depth;
    }
}

/// The share of a way of density `this` in what one of density `other` finds as well: the power
/// heuristic with exponent 2.
///
/// Source: E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 9.2.
#[inline(always)]
fn power(this: f32, other: f32) -> f32 {
    let is_only = this == f32::INFINITY;
    let (this, other) = (f64::from(this), f64::from(other));
    let (this, other) = (this * this, other * other);
    let weight = this / (this + other);
    let weight = if weight.is_finite() { weight as f32 } else { 0.0 };
    if is_only { 1.0 } else { weight }
}

//! Light transport in waves: one loop for both integrators.
//!
//! All rays of a wave are intersected by one call, all their shadow rays by another, and what goes
//! on is the next wave. A path has one continuing ray, chosen among mirror, glass and (in "path")
//! scattering by how much each reflects. Shadow rays find the light of `[[lights]]` and, in "path",
//! of what glows and of the sky; scattered rays find the latter too, and both are weighted by the
//! power heuristic.

mod direct_light;
mod shadows;

use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::brdf::fresnel;
use crate::color::{Rgb, luminance};
use crate::geometry::Hit;
use crate::math::sampler::{Net, SampleNumbers};
use crate::math::{Ray, RayBatch};
use crate::render::PassStatistics;
use crate::render::pixel::PixelSums;
use crate::render::plan::Tile;
use crate::render::shading::Shading;
use crate::render::world::World;
use crate::scene::description::IntegratorKind;

use direct_light::LightChoice;
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

/// Paths that a wave holds at most.
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

/// The samples of one pixel in a block.
struct Run {
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
    hits: Vec<Option<Hit>>,
    next_rays: RayBatch,
    next_paths: Vec<Path>,
    shadows: Shadows,
    lights: LightChoice,
    emitter_weights: Vec<f32>,
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
            shadows: Shadows::default(),
            lights: LightChoice::default(),
            emitter_weights: Vec::new(),
        }
    }

    /// Adds samples to a tile's pixels, in sample order, until each has as many as its goal.
    pub(super) fn render(
        &mut self,
        tile: &Tile,
        goals: &[u32],
        pixels: &mut [PixelSums],
    ) -> PassStatistics {
        let mut statistics = PassStatistics::default();
        loop {
            let is_open = |(pixel, goal): (&PixelSums, &u32)| pixel.n_samples < *goal;
            let n_open = pixels.iter().zip(goals).filter(|both| is_open(*both)).count();
            if n_open == 0 {
                return statistics;
            }
            let n_at_once = (WAVE_SIZE / n_open).max(1) as u32;
            self.start(tile, n_at_once, goals, pixels);
            self.trace(&mut statistics);
            for run in &self.runs {
                let pixel = &mut pixels[run.pixel];
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
        while !self.rays.is_empty() {
            self.world.geometry.intersect(&self.rays, &mut self.hits);
            statistics.n_rays += self.rays.len() as u64;
            self.next_rays.clear();
            self.next_paths.clear();
            self.shadows.clear();
            for index in 0..self.paths.len() {
                self.advance(self.paths[index], self.rays.ray(index), self.hits[index]);
            }
            statistics.n_rays += self.shadows.rays.len() as u64;
            self.shadows.resolve(self.world, &mut self.radiance);
            std::mem::swap(&mut self.rays, &mut self.next_rays);
            std::mem::swap(&mut self.paths, &mut self.next_paths);
        }
    }

    /// The first wave: a camera ray for each of the next samples, up to `n_at_once` a pixel.
    fn start(&mut self, tile: &Tile, n_at_once: u32, goals: &[u32], pixels: &[PixelSums]) {
        let job = &self.world.job;
        let size = Vec2::new(job.width as f32, job.height as f32);
        self.rays.clear();
        self.paths.clear();
        self.runs.clear();
        for (pixel, (x, y)) in tile.pixels().enumerate() {
            let first_slot = self.paths.len();
            let first = pixels[pixel].n_samples;
            for sample in first..goals[pixel].min(first + n_at_once) {
                let numbers = job.settings.sampler.numbers(x, y, sample);
                let [dx, dy] = numbers.joint_pair(dimension::PIXEL, Net::First);
                let at = Vec2::new(x as f32 + dx, y as f32 + dy);
                self.rays.push(job.scene.camera.ray(
                    at,
                    size,
                    numbers.joint_pair(dimension::LENS, Net::Second),
                ));
                self.paths.push(Path {
                    slot: self.paths.len() as u32,
                    throughput: Rgb::ONE,
                    numbers,
                    depth: 0,
                    scattered: None,
                });
            }
            self.runs.push(Run { pixel, slots: first_slot..self.paths.len() });
        }
        self.radiance.clear();
        self.radiance.resize(self.paths.len(), Rgb::ZERO);
    }

    /// What a path's ray meets: adds its light, leaves shadow rays, and goes on.
    fn advance(&mut self, path: Path, ray: Ray, hit: Option<Hit>) {
        let world = self.world;
        let t_surface = hit.map_or(f32::INFINITY, |hit| hit.t);
        if let Some(radiance) = self.visible_light(&ray, t_surface) {
            if path.scattered.is_none() {
                self.add(path, radiance);
            }
            return;
        }
        let direction = ray.direction.normalize();
        let Some(hit) = hit else {
            let share = path
                .scattered
                .map_or(1.0, |last| power(last.pdf, world.emission.sky_pdf(last.total, direction)));
            self.add(path, world.job.scene.background_radiance(direction) * share);
            return;
        };
        let shading = Shading::new(world, &ray, hit);
        let emission = shading.material.emission;
        if emission != Rgb::ZERO {
            let share = path.scattered.map_or(1.0, |last| {
                let from = (last.from, last.normal, last.object, last.total);
                let met = (hit, &shading.surface, emission);
                power(last.pdf, world.emission.pdf(from, direction, met))
            });
            self.add(path, emission * share);
        }
        let settings = &world.job.settings;
        if settings.integrator == IntegratorKind::Direct {
            self.add(path, shading.glossy.diffuse * world.job.scene.ambient);
        }
        if !shading.glossy.is_black() {
            self.sample_lights(path, &shading);
        }
        if path.depth < settings.max_depth {
            self.go_on(path, &shading);
        }
    }

    /// Two numbers to choose a direction by; at what the camera sees, a net together with pixel and
    /// lens. Light, probe and scattering are terms of a sum, so they can be nets of one kind.
    fn first_net(&self, path: Path, purpose: u32) -> [f32; 2] {
        let dimension = dimension::of(path.depth, purpose);
        if path.depth > 0 {
            return path.numbers.pair(dimension);
        }
        let is_pinhole = self.world.job.scene.camera.aperture_radius == 0.0;
        path.numbers.joint_pair(dimension, if is_pinhole { Net::Second } else { Net::Third })
    }

    fn add(&mut self, path: Path, radiance: Rgb) {
        self.radiance[path.slot as usize] += path.throughput * radiance;
    }

    /// Radiance of the nearest visible light before `t_surface`; suns are behind everything.
    fn visible_light(&self, ray: &Ray, t_surface: f32) -> Option<Rgb> {
        let mut nearest: Option<(f32, Rgb)> = None;
        for light in self.world.job.scene.lights.iter().filter(|light| light.visible) {
            let Some((t, radiance)) = light.intersect(ray) else { continue };
            let is_first = nearest.is_none_or(|(best, _)| t < best);
            if is_first && (t < t_surface || t_surface == f32::INFINITY) {
                nearest = Some((t, radiance));
            }
        }
        nearest.map(|(_, radiance)| radiance)
    }

    /// Chooses one way to go on, in proportion to what each reflects.
    fn go_on(&mut self, path: Path, shading: &Shading<'_>) {
        let material = shading.material;
        let scatters = self.world.job.settings.integrator == IntegratorKind::Path;
        let glossy = luminance(shading.glossy.diffuse) + luminance(shading.glossy.specular);
        let weights = [
            luminance(material.reflection),
            luminance(material.transmission),
            if scatters { glossy } else { 0.0 },
        ];
        let total: f32 = weights.iter().sum();
        if total <= 0.0 {
            return;
        }
        let scattering = weights[2] / total;
        let emitters =
            if scattering > 0.0 { self.sample_emitters(path, shading, scattering) } else { 0.0 };
        let [choice, roulette] = path.numbers.pair(dimension::of(path.depth, dimension::CHOICE));
        let choice = choice * total;
        let step = if choice < weights[0] {
            self.mirror(shading, shading.wo).map(|wi| (wi, material.reflection, None, weights[0]))
        } else if choice < weights[0] + weights[1] || weights[2] == 0.0 {
            let within = ((choice - weights[0]) / weights[1]).clamp(0.0, 1.0);
            self.through_glass(shading, within)
                .map(|wi| (wi, material.transmission, None, weights[1]))
        } else {
            self.scatter(path, shading).map(|(wi, value, pdf)| {
                let (from, normal) = (shading.surface.point, shading.frame.z);
                let (object, pdf) = (shading.object, scattering * pdf);
                let last = Scattered { from, normal, object, pdf, total: emitters };
                (wi, value, Some(last), weights[2])
            })
        };
        let Some((direction, value, scattered, weight)) = step else { return };
        let mut throughput = path.throughput * value * (total / weight);
        let depth = path.depth + 1;
        if depth >= ROULETTE_DEPTH {
            let survival = throughput.max_element().min(1.0);
            if roulette >= survival {
                return;
            }
            throughput /= survival;
        }
        if throughput == Rgb::ZERO {
            return;
        }
        let mut ray = Ray::new(shading.surface.leave(direction), direction);
        ray.source = shading.surface.source;
        self.next_rays.push(ray);
        self.next_paths.push(Path { throughput, depth, scattered, ..path });
    }

    /// The mirrored direction, if it is above the geometric surface.
    fn mirror(&self, shading: &Shading<'_>, wo: Vec3) -> Option<Vec3> {
        let wi = fresnel::reflect(wo, shading.frame.z).normalize();
        (shading.normal.dot(wi) > 0.0).then_some(wi)
    }

    /// Mirrored or refracted, by Fresnel; `choice` in 0..=1.
    fn through_glass(&self, shading: &Shading<'_>, choice: f32) -> Option<Vec3> {
        let normal = shading.frame.z;
        let ior = shading.material.ior;
        let eta = if shading.is_outside { ior } else { 1.0 / ior };
        if choice < fresnel::dielectric(shading.wo.dot(normal), eta) {
            return self.mirror(shading, shading.wo);
        }
        let wi = fresnel::refract(shading.wo, normal, eta)?;
        (shading.normal.dot(wi) < 0.0).then_some(wi)
    }

    /// A scattered direction, the BRDF times the cosine over its density, and that density.
    fn scatter(&self, path: Path, shading: &Shading<'_>) -> Option<(Vec3, Rgb, f32)> {
        let wo = shading.frame.local_from_world(shading.wo);
        let u = self.first_net(path, dimension::SCATTER);
        let wi = shading.glossy.sample(wo, u)?;
        let direction = shading.frame.world_from_local(wi).normalize();
        let pdf = shading.glossy.pdf(wo, wi);
        let is_valid = shading.normal.dot(direction) > 0.0 && pdf > 0.0;
        is_valid.then(|| (direction, shading.glossy.eval(wo, wi) * (wi.z / pdf), pdf))
    }
}

/// The share of a way of density `this` in what one of density `other` finds as well: the power
/// heuristic with exponent 2.
///
/// Source: E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 9.2.
fn power(this: f32, other: f32) -> f32 {
    if this == f32::INFINITY {
        return 1.0;
    }
    let (this, other) = (f64::from(this).powi(2), f64::from(other).powi(2));
    let weight = this / (this + other);
    if weight.is_finite() { weight as f32 } else { 0.0 }
}

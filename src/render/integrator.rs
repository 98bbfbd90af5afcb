//! Light transport in waves: one loop for both integrators.
//!
//! All rays of a wave are intersected by one call, all their shadow rays by another, and what goes
//! on is the next wave. A path has one continuing ray, chosen among mirror, glass and (in "path")
//! scattering by how much each reflects. Lights in `[[lights]]` are sampled at every surface;
//! glossy lobes are sampled as well and both are weighted by the power heuristic (E. Veach, "Robust
//! Monte Carlo Methods for Light Transport Simulation", 1997, section 9.2). Rays of the second kind
//! are shadow rays too, so that lights never hide one another.

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
use crate::scene::light::LightSample;

/// Dimensions of a sample's numbers. Each scattering event has a block of its own.
mod dimension {
    pub(super) const PIXEL: u32 = 0;
    pub(super) const LENS: u32 = 1;
    pub(super) const CHOICE: u32 = 2;
    pub(super) const SCATTER: u32 = 3;
    pub(super) const PROBE: u32 = 4;
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
    /// Whether visible lights count where its ray meets them: not after scattering, whose direct
    /// light has been counted already.
    sees_lights: bool,
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
}

/// Shadow rays of a wave, each with what it brings if nothing is in its way.
#[derive(Default)]
struct Shadows {
    rays: RayBatch,
    slots: Vec<u32>,
    contributions: Vec<Rgb>,
    blocked: Vec<bool>,
    shares: Vec<Rgb>,
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
                    sees_lights: true,
                });
            }
            self.runs.push(Run { pixel, slots: first_slot..self.paths.len() });
        }
        self.radiance.clear();
        self.radiance.resize(self.paths.len(), Rgb::ZERO);
    }

    /// What a path's ray meets: adds its light, leaves shadow rays, and goes on.
    fn advance(&mut self, path: Path, ray: Ray, hit: Option<Hit>) {
        let scene = &*self.world.job.scene;
        let t_surface = hit.map_or(f32::INFINITY, |hit| hit.t);
        if let Some(radiance) = self.visible_light(&ray, t_surface) {
            if path.sees_lights {
                self.add(path, radiance);
            }
            return;
        }
        let Some(hit) = hit else {
            self.add(path, scene.background_radiance(ray.direction.normalize()));
            return;
        };
        let shading = Shading::new(self.world, &ray, hit);
        self.add(path, shading.material.emission);
        let settings = self.world.job.settings;
        if settings.integrator == IntegratorKind::Direct {
            self.add(path, shading.glossy.diffuse * scene.ambient);
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

    /// Direct light of `[[lights]]`: a point of every light, and a direction of the glossy lobe.
    fn sample_lights(&mut self, path: Path, shading: &Shading<'_>) {
        let scene = &*self.world.job.scene;
        let wo = shading.frame.local_from_world(shading.wo);
        let glossy = &shading.glossy;
        let is_glossy = glossy.specular != Rgb::ZERO && wo.z > 0.0;
        for (index, light) in scene.lights.iter().enumerate() {
            let purpose = dimension::FIRST_LIGHT + index as u32;
            let u = self.first_net(path, purpose);
            let Some(sample) = light.sample(shading.surface.point, u) else { continue };
            if !shading.is_above(sample.direction) {
                continue;
            }
            let wi = shading.frame.local_from_world(sample.direction);
            let mut value = glossy.diffuse / std::f32::consts::PI;
            if is_glossy {
                let weight = sample.pdf.map_or(1.0, |pdf| power(pdf, glossy.lobe.pdf(wo, wi)));
                value += glossy.specular * (glossy.lobe.eval(wo, wi) * weight);
            }
            let contribution = path.throughput * value * sample.weight * wi.z;
            self.shadows.push(path.slot, shading, &sample, contribution);
        }
        if is_glossy {
            self.probe_lights(path, shading, wo);
        }
    }

    /// The glossy lobe's own direction, for the lights that it happens to meet.
    fn probe_lights(&mut self, path: Path, shading: &Shading<'_>, wo: Vec3) {
        let scene = &*self.world.job.scene;
        let lobe = &shading.glossy.lobe;
        let u = self.first_net(path, dimension::PROBE);
        let Some(wi) = lobe.sample(wo, u) else { return };
        let direction = shading.frame.world_from_local(wi);
        let pdf = lobe.pdf(wo, wi);
        if !(shading.is_above(direction) && pdf > 0.0) {
            return;
        }
        let from = shading.surface.point;
        let ray = Ray::new(from, direction);
        for light in &scene.lights {
            let Some((t, radiance)) = light.intersect(&ray) else { continue };
            let weight = power(pdf, light.pdf(from, direction, t));
            let value = shading.glossy.specular * (lobe.eval(wo, wi) * wi.z * weight / pdf);
            let sample = LightSample {
                direction,
                reach: if t.is_finite() { direction * t } else { direction },
                t_max: if t.is_finite() { 1.0 } else { f32::INFINITY },
                normal: light.normal_at(from + direction * t),
                weight: radiance,
                pdf: Some(pdf),
            };
            self.shadows.push(path.slot, shading, &sample, path.throughput * value * radiance);
        }
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
        let [choice, roulette] = path.numbers.pair(dimension::of(path.depth, dimension::CHOICE));
        let choice = choice * total;
        let step = if choice < weights[0] {
            self.mirror(shading, shading.wo).map(|wi| (wi, material.reflection, true, weights[0]))
        } else if choice < weights[0] + weights[1] || weights[2] == 0.0 {
            let within = ((choice - weights[0]) / weights[1]).clamp(0.0, 1.0);
            self.through_glass(shading, within)
                .map(|wi| (wi, material.transmission, true, weights[1]))
        } else {
            self.scatter(path, shading).map(|(wi, value)| (wi, value, false, weights[2]))
        };
        let Some((direction, value, is_specular, weight)) = step else { return };
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
        self.next_paths.push(Path { throughput, depth, sees_lights: is_specular, ..path });
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

    /// A scattered direction, and the BRDF times the cosine over its density.
    fn scatter(&self, path: Path, shading: &Shading<'_>) -> Option<(Vec3, Rgb)> {
        let wo = shading.frame.local_from_world(shading.wo);
        let u = self.first_net(path, dimension::SCATTER);
        let wi = shading.glossy.sample(wo, u)?;
        let direction = shading.frame.world_from_local(wi).normalize();
        let pdf = shading.glossy.pdf(wo, wi);
        let is_valid = shading.normal.dot(direction) > 0.0 && pdf > 0.0;
        is_valid.then(|| (direction, shading.glossy.eval(wo, wi) * (wi.z / pdf)))
    }
}

/// Veach's power heuristic with exponent 2.
fn power(this: f32, other: f32) -> f32 {
    if this == f32::INFINITY {
        return 1.0;
    }
    let (this, other) = (f64::from(this).powi(2), f64::from(other).powi(2));
    let weight = this / (this + other);
    if weight.is_finite() { weight as f32 } else { 0.0 }
}

impl Shadows {
    fn clear(&mut self) {
        self.rays.clear();
        self.slots.clear();
        self.contributions.clear();
    }

    /// Both ends are kept clear of the surfaces they are on by the bound of rounding errors.
    fn push(&mut self, slot: u32, shading: &Shading<'_>, sample: &LightSample, light: Rgb) {
        if light == Rgb::ZERO {
            return;
        }
        let origin = shading.surface.leave(sample.direction);
        let (direction, t_max) = if sample.t_max == f32::INFINITY {
            (sample.reach, f32::INFINITY)
        } else {
            let from = shading.surface.point;
            let target = from + sample.reach;
            let magnitude = from.abs().max_element().max(target.abs().max_element());
            let error = magnitude * (16.0 / 16_777_216.0);
            let reach = target + sample.normal.unwrap_or(Vec3::ZERO) * error - origin;
            (reach, 1.0 - (error / reach.length()).min(0.5))
        };
        self.rays.push(Ray { origin, direction, t_max, source: shading.surface.source });
        self.slots.push(slot);
        self.contributions.push(light);
    }

    /// Adds what arrives, in the order of the rays.
    fn resolve(&mut self, world: &World, radiance: &mut [Rgb]) {
        let tints = world.has_glass && world.job.settings.integrator == IntegratorKind::Direct;
        if tints {
            let clear = |hit: Hit| {
                let material = world.material_at(hit);
                material.is_glass().then_some(material.transmission)
            };
            let is_clear = |object: u32| world.is_clear[object as usize];
            world.geometry.transmittance(&self.rays, clear, is_clear, &mut self.shares);
        } else {
            world.geometry.occluded(&self.rays, &mut self.blocked);
            let share = |blocked: &bool| if *blocked { Rgb::ZERO } else { Rgb::ONE };
            self.shares.clear();
            self.shares.extend(self.blocked.iter().map(share));
        }
        let arriving = self.contributions.iter().zip(&self.shares);
        for (slot, (contribution, share)) in self.slots.iter().zip(arriving) {
            radiance[*slot as usize] += *contribution * *share;
        }
    }
}

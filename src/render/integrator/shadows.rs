//! Shadow rays of a wave.

use glam::Vec3;

use crate::color::Rgb;
use crate::geometry::{Hit, Surface};
use crate::math::vectorized::{BLOCK, Lane, Lane3, set_vec3, vec3, vectorized};
use crate::math::{Ray, RayBatch, RayBlock};
use crate::render::shading::{Shading, ShadingBlock};
use crate::render::world::World;
use crate::scene::description::IntegratorKind;
use crate::scene::light::{LightBlock, LightSample};

/// Shadow rays, each with what it brings if nothing is in its way.
#[derive(Default)]
pub(super) struct Shadows {
    pub(super) rays: RayBatch,
    slots: Vec<u32>,
    contributions: Vec<Rgb>,
    blocked: Vec<bool>,
    shares: Vec<Rgb>,
}

impl Shadows {
    /// Forgets all rays, keeps the memory.
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.slots.clear();
        self.contributions.clear();
    }

    /// A ray from a surface to a light. Both ends are kept clear of the surfaces they are on by the
    /// bound of rounding errors.
    pub(super) fn push(
        &mut self,
        slot: u32,
        shading: &Shading<'_>,
        sample: &LightSample,
        light: Rgb,
    ) {
        if light == Rgb::ZERO {
            return;
        }
        let surface = &shading.surface;
        let origin = surface.leave(sample.direction);
        let (direction, t_max) = if sample.t_max == f32::INFINITY {
            (sample.reach, f32::INFINITY)
        } else {
            clear_of(surface.point, origin, sample.reach, sample.normal.unwrap_or(Vec3::ZERO))
        };
        self.rays.push(Ray { origin, direction, t_max, source: shading.surface.source });
        self.slots.push(slot);
        self.contributions.push(light);
    }

    /// [`Shadows::push`] for the first `n` points of a block and the samples of one light.
    pub(super) fn append(
        &mut self,
        n: usize,
        slots: &Lane<u32>,
        block: &ShadingBlock,
        samples: &LightBlock,
        light: &Lane3,
    ) {
        let mut rays = RayBlock::IDLE;
        shadow_rays(block, samples, &mut rays);
        rays.source = block.surface.source;
        let is_lit = |i: &usize| vec3(light, *i) != Rgb::ZERO;
        let n_first = (0..n).take_while(is_lit).count();
        self.contributions.extend((0..n_first).map(|i| vec3(light, i)));
        self.slots.extend_from_slice(&slots[..n_first]);
        // Where all are lit nothing moves up.
        let mut n_lit = n_first;
        for i in (n_first..n).filter(is_lit) {
            self.slots.push(slots[i]);
            self.contributions.push(vec3(light, i));
            for axis in 0..3 {
                rays.origin[axis][n_lit] = rays.origin[axis][i];
                rays.direction[axis][n_lit] = rays.direction[axis][i];
            }
            rays.t_max[n_lit] = rays.t_max[i];
            rays.source[n_lit] = rays.source[i];
            n_lit += 1;
        }
        self.rays.append(&rays, n_lit);
    }

    /// Adds what arrives, in the order of the rays.
    pub(super) fn resolve(&mut self, world: &World, radiance: &mut [Rgb]) {
        let tints = world.has_glass && world.job.settings.integrator == IntegratorKind::Direct;
        if tints {
            let clear = |hit: Hit| {
                let material = world.material_at(hit);
                material.is_glass().then_some(material.transmission)
            };
            let is_clear = |object: u32| world.is_clear[object as usize];
            world.geometry.transmittance(&self.rays, clear, is_clear, &mut self.shares);
            let arriving = self.contributions.iter().zip(&self.shares);
            for (slot, (contribution, share)) in self.slots.iter().zip(arriving) {
                radiance[*slot as usize] += *contribution * *share;
            }
            return;
        }
        world.geometry.occluded(&self.rays, &mut self.blocked);
        let arriving = self.contributions.iter().zip(&self.blocked);
        for (slot, (contribution, is_blocked)) in self.slots.iter().zip(arriving) {
            if !is_blocked {
                radiance[*slot as usize] += *contribution;
            }
        }
    }
}

/// The direction and the end of a ray from `origin`, close to a point, to the place `reach` away from
/// that point on a light of that normal.
#[inline(always)]
fn clear_of(point: Vec3, origin: Vec3, reach: Vec3, normal: Vec3) -> (Vec3, f32) {
    let target = point + reach;
    let magnitude = point.abs().max_element().max(target.abs().max_element());
    let error = magnitude * (16.0 / 16_777_216.0);
    let direction = target + normal * error - origin;
    (direction, 1.0 - (error / direction.length()).min(0.5))
}

vectorized! {
    fn shadow_rays(block: &ShadingBlock, samples: &LightBlock, rays: &mut RayBlock) {
        let ShadingBlock { surface, .. } = block;
        let is_far = samples.t_max == f32::INFINITY;
        for i in 0..BLOCK {
            let (point, normal) = (vec3(&surface.point, i), vec3(&surface.normal, i));
            let direction = vec3(&samples.direction, i);
            let origin = Surface::left(point, normal, surface.clearance[i], direction);
            let reach = vec3(&samples.reach, i);
            let (near, t_max) = clear_of(point, origin, reach, vec3(&samples.normal, i));
            set_vec3(&mut rays.origin, i, origin);
            set_vec3(&mut rays.direction, i, if is_far { reach } else { near });
            rays.t_max[i] = if is_far { f32::INFINITY } else { t_max };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::Sampler;
    use crate::math::vectorized::at_every_level;

    /// The margins at both ends are those of the lane's own point and light, of whatever size its
    /// neighbours are: a margin of a neighbour would let a small thing shade itself, or not.
    #[test]
    fn a_block_of_shadow_rays_has_the_rays_of_its_points() {
        let (mut block, mut samples) = (ShadingBlock::EMPTY, LightBlock::EMPTY);
        for i in 0..BLOCK {
            let numbers = Sampler::Random { seed: 5 }.numbers(i as u32, 0, 0);
            let some = |k: u32| {
                let ([x, y], [z, _]) = (numbers.pair(2 * k), numbers.pair(2 * k + 1));
                Vec3::new(x, y, z) - 0.5
            };
            let size = 10.0_f32.powi(i as i32 * 5 % 11 - 5);
            set_vec3(&mut block.surface.point, i, some(0) * size);
            set_vec3(&mut block.surface.normal, i, some(1).normalize());
            block.surface.clearance[i] = 1e-6 * size;
            let reach = some(2) * size;
            set_vec3(&mut samples.reach, i, reach);
            set_vec3(&mut samples.direction, i, reach.normalize());
            set_vec3(&mut samples.normal, i, some(3).normalize());
        }
        for t_max in [1.0, f32::INFINITY] {
            samples.t_max = t_max;
            for (level, rays) in at_every_level(|| {
                let mut rays = RayBlock::IDLE;
                shadow_rays(&block, &samples, &mut rays);
                rays
            }) {
                for i in 0..BLOCK {
                    let (point, normal) =
                        (vec3(&block.surface.point, i), vec3(&block.surface.normal, i));
                    let clearance = block.surface.clearance[i];
                    let towards = vec3(&samples.direction, i);
                    let origin = Surface::left(point, normal, clearance, towards);
                    let reach = vec3(&samples.reach, i);
                    let (direction, end) = if t_max == f32::INFINITY {
                        (reach, t_max)
                    } else {
                        clear_of(point, origin, reach, vec3(&samples.normal, i))
                    };
                    let found = (vec3(&rays.origin, i), vec3(&rays.direction, i), rays.t_max[i]);
                    assert_eq!(found, (origin, direction, end), "{level:?}, lane {i}");
                }
            }
        }
    }
}

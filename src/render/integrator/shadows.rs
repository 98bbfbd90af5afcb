//! Shadow rays of a wave.

use glam::Vec3;

use crate::color::Rgb;
use crate::geometry::Hit;
use crate::math::{Ray, RayBatch};
use crate::render::shading::Shading;
use crate::render::world::World;
use crate::scene::description::IntegratorKind;
use crate::scene::light::LightSample;

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
    pub(super) fn resolve(&mut self, world: &World, radiance: &mut [Rgb]) {
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

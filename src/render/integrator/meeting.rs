//! What the rays of a wave meet: lights that are seen, the background, surfaces.

use super::{TileRenderer, power};
use crate::color::Rgb;
use crate::math::vectorized::{BLOCK, Lane, NO_LANES, set_vec3, vec3};
use crate::math::{Ray, RayBlock};
use crate::scene::light::Light;

impl TileRenderer<'_> {
    /// What the rays of a wave meet: adds visible lights and the background, and groups the rest.
    pub(super) fn meet(&mut self) {
        let world = self.world;
        let seen = world.job.scene.lights.iter().enumerate();
        let seen: Vec<_> = seen.filter(|(_, light)| light.visible && light.has_extent()).collect();
        let mut rays = RayBlock::IDLE;
        self.groups.clear();
        for start in (0..self.paths.len()).step_by(BLOCK) {
            let n = BLOCK.min(self.paths.len() - start);
            let mut lights = [None; BLOCK];
            if !seen.is_empty() {
                self.rays.copy_to(start, n, &mut rays);
                self.lights_before(&seen, start, n, &rays, &mut lights);
            }
            for (i, light) in lights.into_iter().enumerate().take(n) {
                let index = start + i;
                let path = &self.paths[index];
                if let Some(light) = light {
                    if path.scattered.is_none() {
                        self.add(*path, world.job.scene.lights[light as usize].radiance());
                    }
                    continue;
                }
                if let Some(hit) = self.hits[index].hit() {
                    self.groups.push(world, index as u32, hit);
                    continue;
                }
                self.lost.push(index as u32);
            }
        }
        self.groups.sort();
        self.add_background();
    }

    /// Adds the background to the paths that have left the scene.
    fn add_background(&mut self) {
        let world = self.world;
        let (mut directions, mut radiances) = (NO_LANES, NO_LANES);
        for start in (0..self.lost.len()).step_by(BLOCK) {
            let n = BLOCK.min(self.lost.len() - start);
            for i in 0..n {
                let index = self.lost[start + i] as usize;
                set_vec3(&mut directions, i, self.rays.ray(index).direction.normalize());
            }
            world.job.scene.background_radiances(&directions, &mut radiances);
            for i in 0..n {
                let path = self.paths[self.lost[start + i] as usize];
                let direction = vec3(&directions, i);
                let share = path.scattered.map_or(1.0, |last| {
                    power(last.pdf, world.emission.sky_pdf(last.total, direction))
                });
                self.add(path, vec3(&radiances, i) * share);
            }
        }
        self.lost.clear();
    }

    /// Number of the nearest visible light before what each of `n` rays meets; suns are behind
    /// everything.
    fn lights_before(
        &self,
        lights: &[(usize, &Light)],
        start: usize,
        n: usize,
        rays: &RayBlock,
        nearest: &mut Lane<Option<u32>>,
    ) {
        let (mut best, mut t) = ([f32::INFINITY; BLOCK], [f32::NAN; BLOCK]);
        for (index, light) in lights {
            light.intersect_block(rays, &mut t);
            if !(0..n).any(|i| t[i] > 0.0) {
                continue;
            }
            for i in 0..n {
                let t_surface = self.hits[start + i].hit().map_or(f32::INFINITY, |hit| hit.t);
                let is_first = nearest[i].is_none() || t[i] < best[i];
                let is_before = t[i] < t_surface || t_surface == f32::INFINITY;
                if t[i] > 0.0 && is_first && is_before {
                    (nearest[i], best[i]) = (Some(*index as u32), t[i]);
                }
            }
        }
    }

    /// Radiance of the nearest visible light before `t_surface`; suns are behind everything.
    pub(super) fn visible_light(&self, ray: &Ray, t_surface: f32) -> Option<Rgb> {
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
}

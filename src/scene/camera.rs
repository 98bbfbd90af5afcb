//! A thin-lens camera.

use glam::{DVec3, Vec2, Vec3};

use crate::math::vectorized::{BLOCK, Lane, set_vec3, vectorized};
use crate::math::{Ray, RayBlock, portable, warp};

/// A lens in the world and the plane it is focused on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Centre of the lens.
    pub eye: Vec3,
    /// Unit viewing direction.
    pub forward: Vec3,
    /// Unit direction of image x.
    pub right: Vec3,
    /// Unit direction against image y.
    pub up: Vec3,
    /// Tangent of half the vertical angle of view.
    pub tan_half_fov: f32,
    /// Radius of the lens, at least 0.
    pub aperture_radius: f32,
    /// Distance along `forward` of the plane in focus, above 0.
    pub focal_distance: f32,
    /// 0 is a round lens, else the corners of its polygon.
    pub aperture_blades: u32,
}

impl Camera {
    /// Looks from `eye` to `target`. `vertical_fov` is the full angle in radians; `up` is not
    /// parallel to the viewing direction.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, vertical_fov: f64) -> Self {
        let forward = (target - eye).normalize();
        let right = forward.cross(up).normalize();
        Self {
            eye: eye.as_vec3(),
            forward: forward.as_vec3(),
            right: right.as_vec3(),
            up: right.cross(forward).as_vec3(),
            tan_half_fov: portable::tan_f64(0.5 * vertical_fov) as f32,
            aperture_radius: 0.0,
            focal_distance: (target - eye).length() as f32,
            aperture_blades: 0,
        }
    }

    /// Direction of the pinhole ray at (x, y) in pixels, y down, of a picture of that size; its
    /// component along `forward` is 1.
    #[inline(always)]
    pub fn pinhole_direction(&self, at: Vec2, size: Vec2) -> Vec3 {
        let x = (2.0 * at.x / size.x - 1.0) * (size.x / size.y);
        let y = 1.0 - 2.0 * at.y / size.y;
        self.forward + self.tan_half_fov * (x * self.right + y * self.up)
    }

    /// The ray from a point of the lens through the point of the plane of focus that the pinhole
    /// ray at (x, y) meets. `lens` is a pair of numbers in [0, 1). Direction not normalised.
    pub fn ray(&self, at: Vec2, size: Vec2, lens: [f32; 2]) -> Ray {
        let direction = self.pinhole_direction(at, size);
        if self.aperture_radius == 0.0 {
            return Ray::new(self.eye, direction);
        }
        let p = match self.aperture_blades {
            0 => warp::square_to_disk(lens),
            blades => warp::square_to_polygon(lens, blades),
        };
        self.through_lens(direction, p)
    }

    /// [`Camera::ray`] for a block of samples.
    pub(crate) fn rays(
        &self,
        at: &[Lane<f32>; 2],
        size: Vec2,
        lens: &[Lane<f32>; 2],
        rays: &mut RayBlock,
    ) {
        match (self.aperture_radius == 0.0, self.aperture_blades) {
            (true, _) => pinhole_rays(self, at, size, rays),
            (false, 0) => round_lens_rays(self, at, size, lens, rays),
            (false, _) => {
                for i in 0..BLOCK {
                    let ray =
                        self.ray(Vec2::new(at[0][i], at[1][i]), size, [lens[0][i], lens[1][i]]);
                    set_vec3(&mut rays.origin, i, ray.origin);
                    set_vec3(&mut rays.direction, i, ray.direction);
                }
            }
        }
    }

    /// From a point of the unit lens.
    #[inline(always)]
    fn through_lens(&self, pinhole: Vec3, p: Vec2) -> Ray {
        let offset = self.aperture_radius * (p.x * self.right + p.y * self.up);
        Ray::new(self.eye + offset, pinhole * self.focal_distance - offset)
    }
}

vectorized! {
    fn pinhole_rays(camera: &Camera, at: &[Lane<f32>; 2], size: Vec2, rays: &mut RayBlock) {
        for i in 0..BLOCK {
            let direction = camera.pinhole_direction(Vec2::new(at[0][i], at[1][i]), size);
            set_vec3(&mut rays.origin, i, camera.eye);
            set_vec3(&mut rays.direction, i, direction);
        }
    }
    fn round_lens_rays(
        camera: &Camera,
        at: &[Lane<f32>; 2],
        size: Vec2,
        lens: &[Lane<f32>; 2],
        rays: &mut RayBlock,
    ) {
        for i in 0..BLOCK {
            let direction = camera.pinhole_direction(Vec2::new(at[0][i], at[1][i]), size);
            let ray = camera.through_lens(direction, warp::square_to_disk([lens[0][i], lens[1][i]]));
            set_vec3(&mut rays.origin, i, ray.origin);
            set_vec3(&mut rays.direction, i, ray.direction);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampler::Sampler;
    use crate::math::vectorized::{at_every_level, vec3};

    #[test]
    fn a_block_of_samples_has_the_rays_of_its_samples() {
        let size = Vec2::new(640.0, 360.0);
        let up = DVec3::new(0.1, 1.0, 0.0);
        let pinhole = Camera::look_at(DVec3::new(1.0, 2.0, 5.0), DVec3::ZERO, up, 0.7);
        for (aperture_radius, aperture_blades) in [(0.0, 0), (0.1, 0), (0.1, 5)] {
            let camera = Camera { aperture_radius, aperture_blades, ..pinhole };
            let (mut at, mut lens) = ([[0.0; BLOCK]; 2], [[0.0; BLOCK]; 2]);
            for i in 0..BLOCK {
                let numbers = Sampler::Random { seed: 1 }.numbers(i as u32, 0, 0);
                let [x, y] = numbers.pair(0);
                [at[0][i], at[1][i]] = [x * size.x, y * size.y];
                [lens[0][i], lens[1][i]] = numbers.pair(1);
            }
            for (level, rays) in at_every_level(|| {
                let mut rays = RayBlock::IDLE;
                camera.rays(&at, size, &lens, &mut rays);
                rays
            }) {
                for i in 0..BLOCK {
                    let at = Vec2::new(at[0][i], at[1][i]);
                    let ray = camera.ray(at, size, [lens[0][i], lens[1][i]]);
                    assert_eq!(vec3(&rays.origin, i), ray.origin, "{level:?}, {camera:?}");
                    assert_eq!(vec3(&rays.direction, i), ray.direction, "{level:?}, {camera:?}");
                }
            }
        }
    }
}

//! Samples of one light for a block of points, in lanes.

use std::f32::consts::TAU;

use glam::Vec3;

use super::way::{Way, disk_pdf, rectangle_pdf, sphere_pdf};
use super::{Emitter, Light, meet_disk, meet_rectangle, sphere};
use crate::color::Rgb;
use crate::math::vectorized::{BLOCK, Lane, Lane3, NO_LANES, set_vec3, vec3, vectorized};
use crate::math::{Ray, RayBlock};

/// A [`LightSample`](super::LightSample) for each point of a block.
#[derive(Clone, Debug)]
pub(crate) struct LightBlock {
    pub(crate) direction: Lane3,
    pub(crate) reach: Lane3,
    /// Zero where the light has none.
    pub(crate) normal: Lane3,
    /// Zero where nothing arrives.
    pub(crate) weight: Lane3,
    /// Infinite where no other ray can find the light.
    pub(crate) pdf: Lane<f32>,
    /// 1, or infinite for what is in the sky.
    pub(crate) t_max: f32,
}

impl LightBlock {
    /// Nothing yet.
    pub(crate) const EMPTY: Self = Self {
        direction: NO_LANES,
        reach: NO_LANES,
        normal: NO_LANES,
        weight: NO_LANES,
        pdf: [0.0; BLOCK],
        t_max: 1.0,
    };

    #[inline(always)]
    fn set(&mut self, i: usize, way: Way, radiance: Rgb) {
        set_vec3(&mut self.direction, i, way.direction);
        set_vec3(&mut self.reach, i, way.reach);
        set_vec3(&mut self.normal, i, way.normal);
        let weight = radiance / way.pdf;
        set_vec3(&mut self.weight, i, if way.pdf > 0.0 { weight } else { Vec3::ZERO });
        self.pdf[i] = way.pdf;
    }
}

impl Light {
    /// Whether a ray can meet it.
    pub(crate) fn has_extent(&self) -> bool {
        match self.emitter {
            Emitter::Rectangle { .. }
            | Emitter::Disk { .. }
            | Emitter::Sphere { .. }
            | Emitter::SunCap { .. } => true,
            Emitter::Point { .. } | Emitter::Spot { .. } | Emitter::Sun { .. } => false,
        }
    }

    /// The parameters of [`Light::intersect`] for a block of rays; not above 0 where it is not met.
    pub(crate) fn intersect_block(&self, rays: &RayBlock, t: &mut Lane<f32>) {
        match self.emitter {
            Emitter::Rectangle { .. } => meet_rectangles(&self.emitter, rays, t),
            Emitter::Disk { .. } => meet_disks(&self.emitter, rays, t),
            Emitter::Sphere { .. } => meet_spheres(&self.emitter, rays, t),
            Emitter::SunCap { .. } => {
                for (i, t) in t.iter_mut().enumerate() {
                    let ray = Ray::new(vec3(&rays.origin, i), vec3(&rays.direction, i));
                    *t = self.intersect(&ray).map_or(f32::NAN, |(t, _)| t);
                }
            }
            Emitter::Point { .. } | Emitter::Spot { .. } | Emitter::Sun { .. } => {
                *t = [f32::NAN; BLOCK];
            }
        }
    }

    /// [`Light::pdf`] and [`Light::normal_at`] (zero where there is none) for a block of rays from
    /// points, of unit direction, that meet the light.
    pub(crate) fn pdf_block(
        &self,
        rays: &RayBlock,
        t: &Lane<f32>,
        pdf: &mut Lane<f32>,
        normal: &mut Lane3,
    ) {
        match self.emitter {
            Emitter::Rectangle { .. } => rectangle_pdfs(&self.emitter, rays, t, pdf, normal),
            Emitter::Disk { .. } => disk_pdfs(&self.emitter, rays, t, pdf, normal),
            Emitter::Sphere { .. } => sphere_pdfs(&self.emitter, rays, t, pdf, normal),
            Emitter::SunCap { one_minus_cos, .. } => {
                *pdf = [1.0 / (TAU * one_minus_cos); BLOCK];
                *normal = NO_LANES;
            }
            Emitter::Point { .. } | Emitter::Spot { .. } | Emitter::Sun { .. } => {
                *pdf = [0.0; BLOCK];
                *normal = NO_LANES;
            }
        }
    }

    /// Emitted radiance, of a light with an extent.
    pub(crate) fn radiance(&self) -> Rgb {
        match self.emitter {
            Emitter::Rectangle { radiance, .. }
            | Emitter::Disk { radiance, .. }
            | Emitter::Sphere { radiance, .. }
            | Emitter::SunCap { radiance, .. } => radiance,
            Emitter::Point { .. } | Emitter::Spot { .. } | Emitter::Sun { .. } => Rgb::ZERO,
        }
    }

    /// [`Light::sample`] from each point.
    pub(crate) fn sample_block(&self, from: &Lane3, u: &[Lane<f32>; 2], samples: &mut LightBlock) {
        samples.t_max = 1.0;
        match self.emitter {
            Emitter::Rectangle { .. } => rectangle_samples(&self.emitter, from, u, samples),
            Emitter::Disk { .. } => disk_samples(&self.emitter, from, u, samples),
            Emitter::Sphere { .. } => sphere_samples(&self.emitter, from, u, samples),
            Emitter::Point { .. }
            | Emitter::Spot { .. }
            | Emitter::Sun { .. }
            | Emitter::SunCap { .. } => {
                for i in 0..BLOCK {
                    set_vec3(&mut samples.weight, i, Vec3::ZERO);
                    let Some(sample) = self.sample(vec3(from, i), [u[0][i], u[1][i]]) else {
                        continue;
                    };
                    set_vec3(&mut samples.direction, i, sample.direction);
                    set_vec3(&mut samples.reach, i, sample.reach);
                    set_vec3(&mut samples.normal, i, Vec3::ZERO);
                    set_vec3(&mut samples.weight, i, sample.weight);
                    samples.pdf[i] = sample.pdf.unwrap_or(f32::INFINITY);
                    samples.t_max = sample.t_max;
                }
            }
        }
    }
}

vectorized! {
    fn meet_rectangles(emitter: &Emitter, rays: &RayBlock, t: &mut Lane<f32>) {
        let Emitter::Rectangle { center, frame, half, .. } = *emitter else { return };
        for i in 0..BLOCK {
            let (origin, direction) = (vec3(&rays.origin, i), vec3(&rays.direction, i));
            t[i] = meet_rectangle(origin, direction, center, &frame, half);
        }
    }
    fn meet_disks(emitter: &Emitter, rays: &RayBlock, t: &mut Lane<f32>) {
        let Emitter::Disk { center, frame, radius, .. } = *emitter else { return };
        for i in 0..BLOCK {
            let (origin, direction) = (vec3(&rays.origin, i), vec3(&rays.direction, i));
            t[i] = meet_disk(origin, direction, center, &frame, radius);
        }
    }
    fn meet_spheres(emitter: &Emitter, rays: &RayBlock, t: &mut Lane<f32>) {
        let Emitter::Sphere { center, radius, .. } = *emitter else { return };
        for i in 0..BLOCK {
            let (origin, direction) = (vec3(&rays.origin, i), vec3(&rays.direction, i));
            let (is_met, at, _) = sphere::meeting(origin, direction, center, radius);
            t[i] = if is_met { at } else { f32::NAN };
        }
    }
    fn rectangle_pdfs(
        emitter: &Emitter,
        rays: &RayBlock,
        t: &Lane<f32>,
        pdf: &mut Lane<f32>,
        normal: &mut Lane3,
    ) {
        let Emitter::Rectangle { center, frame, half, .. } = *emitter else { return };
        for i in 0..BLOCK {
            let (from, direction) = (vec3(&rays.origin, i), vec3(&rays.direction, i));
            pdf[i] = rectangle_pdf(from, direction, t[i], center, &frame, half);
            set_vec3(normal, i, frame.z);
        }
    }
    fn disk_pdfs(
        emitter: &Emitter,
        rays: &RayBlock,
        t: &Lane<f32>,
        pdf: &mut Lane<f32>,
        normal: &mut Lane3,
    ) {
        let Emitter::Disk { center, frame, radius, .. } = *emitter else { return };
        for i in 0..BLOCK {
            let (from, direction) = (vec3(&rays.origin, i), vec3(&rays.direction, i));
            pdf[i] = disk_pdf(from, direction, t[i], center, &frame, radius);
            set_vec3(normal, i, frame.z);
        }
    }
    fn sphere_pdfs(
        emitter: &Emitter,
        rays: &RayBlock,
        t: &Lane<f32>,
        pdf: &mut Lane<f32>,
        normal: &mut Lane3,
    ) {
        let Emitter::Sphere { center, radius, .. } = *emitter else { return };
        for i in 0..BLOCK {
            let (from, direction) = (vec3(&rays.origin, i), vec3(&rays.direction, i));
            pdf[i] = sphere_pdf(from, center, radius);
            let out = from + direction * t[i] - center;
            let scale = out.length_recip();
            let is_plain = scale.is_finite() && scale > 0.0;
            set_vec3(normal, i, if is_plain { out * scale } else { Vec3::ZERO });
        }
    }
    fn rectangle_samples(
        emitter: &Emitter,
        from: &Lane3,
        u: &[Lane<f32>; 2],
        samples: &mut LightBlock,
    ) {
        let Emitter::Rectangle { center, frame, half, radiance } = *emitter else { return };
        for i in 0..BLOCK {
            let way = Way::to_rectangle(vec3(from, i), [u[0][i], u[1][i]], center, &frame, half);
            samples.set(i, way, radiance);
        }
    }
    fn disk_samples(
        emitter: &Emitter,
        from: &Lane3,
        u: &[Lane<f32>; 2],
        samples: &mut LightBlock,
    ) {
        let Emitter::Disk { center, frame, radius, radiance } = *emitter else { return };
        for i in 0..BLOCK {
            let way = Way::to_disk(vec3(from, i), [u[0][i], u[1][i]], center, &frame, radius);
            samples.set(i, way, radiance);
        }
    }
    fn sphere_samples(
        emitter: &Emitter,
        from: &Lane3,
        u: &[Lane<f32>; 2],
        samples: &mut LightBlock,
    ) {
        let Emitter::Sphere { center, radius, radiance } = *emitter else { return };
        for i in 0..BLOCK {
            let way = Way::to_sphere(vec3(from, i), [u[0][i], u[1][i]], center, radius);
            samples.set(i, way, radiance);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Frame;
    use crate::math::sampler::Sampler;
    use crate::math::vectorized::at_every_level;

    fn emitters() -> Vec<Emitter> {
        let (center, radiance) = (Vec3::new(0.3, 2.0, -0.4), Rgb::new(1.0, 2.0, 3.0));
        let frame = Frame::from_normal(Vec3::new(0.1, -1.0, 0.2).normalize());
        let normal = frame.z;
        vec![
            Emitter::Rectangle { center, frame, half: [0.7, 0.2], radiance },
            Emitter::Disk { center, frame, radius: 0.6, radiance },
            Emitter::Sphere { center, radius: 0.5, radiance },
            Emitter::Point { position: center, intensity: radiance },
            Emitter::Spot { position: center, normal, intensity: radiance },
            Emitter::Sun { towards: -normal, irradiance: radiance },
            Emitter::SunCap { frame, one_minus_cos: 0.01, radiance },
        ]
    }

    /// From all around: near and far, before and behind, within.
    #[test]
    fn a_block_of_points_sees_a_light_as_each_point_does() {
        let numbers =
            |i: usize, k: u32| Sampler::Random { seed: 1 }.numbers(i as u32, k, 0).pair(0);
        for round in 0..20 {
            let (mut from, mut u) = (NO_LANES, [[0.0; BLOCK]; 2]);
            for i in 0..BLOCK {
                let ([x, y], [z, w]) = (numbers(i, 10 * round), numbers(i, 10 * round + 1));
                let reach = if w < 0.2 { 30.0 } else { 3.0 };
                set_vec3(&mut from, i, (Vec3::new(x, y, z) - 0.5) * reach);
                [u[0][i], u[1][i]] = numbers(i, 10 * round + 2);
            }
            for emitter in emitters() {
                let light = Light { visible: true, emitter };
                let mut rays = RayBlock::IDLE;
                for (level, samples) in at_every_level(|| {
                    let mut samples = LightBlock::EMPTY;
                    light.sample_block(&from, &u, &mut samples);
                    samples
                }) {
                    for i in 0..BLOCK {
                        let found = vec3(&samples.weight, i);
                        let one = light.sample(vec3(&from, i), [u[0][i], u[1][i]]);
                        let Some(one) = one else {
                            assert_eq!(found, Rgb::ZERO, "{level:?}, {emitter:?}");
                            continue;
                        };
                        let normal = one.normal.unwrap_or(Vec3::ZERO);
                        let pdf = one.pdf.unwrap_or(f32::INFINITY);
                        assert_eq!(found, one.weight, "{level:?}, {emitter:?}");
                        assert_eq!(vec3(&samples.reach, i), one.reach, "{level:?}, {emitter:?}");
                        assert_eq!(vec3(&samples.direction, i), one.direction, "{level:?}");
                        assert_eq!(vec3(&samples.normal, i), normal, "{level:?}, {emitter:?}");
                        assert_eq!((samples.pdf[i], samples.t_max), (pdf, one.t_max), "{level:?}");
                        set_vec3(&mut rays.origin, i, vec3(&from, i));
                        set_vec3(&mut rays.direction, i, one.direction);
                    }
                }
                for (level, (t, pdf, normal)) in at_every_level(|| {
                    let (mut pdf, mut normal) = ([0.0; BLOCK], NO_LANES);
                    let mut met = [f32::NAN; BLOCK];
                    light.intersect_block(&rays, &mut met);
                    light.pdf_block(&rays, &met, &mut pdf, &mut normal);
                    (met, pdf, normal)
                }) {
                    for i in 0..BLOCK {
                        let (from, to) = (vec3(&rays.origin, i), vec3(&rays.direction, i));
                        let one = light.intersect(&Ray::new(from, to)).map(|(t, _)| t);
                        assert_eq!((t[i] > 0.0).then_some(t[i]), one, "{level:?}, {emitter:?}");
                        if one.is_some() {
                            assert_eq!(pdf[i], light.pdf(from, to, t[i]), "{level:?}, {emitter:?}");
                            let there = light.normal_at(from + to * t[i]).unwrap_or(Vec3::ZERO);
                            assert_eq!(vec3(&normal, i), there, "{level:?}, {emitter:?}");
                        }
                    }
                }
            }
        }
    }
}

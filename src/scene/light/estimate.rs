//! How much a light may bring to a point, without looking whether anything is in its way.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Emitter, Light};
use crate::color::{Rgb, luminance};

/// What a light may bring to a point, roughly: to choose among lights by.
#[derive(Clone, Copy, Debug)]
pub struct LightEstimate {
    /// Unit direction towards its middle.
    pub direction: Vec3,
    /// Sine of the angle between its middle and its rim, 0..=1, at most too large.
    pub half_width: f32,
    /// Luminance of the irradiance of a surface that faces it, above 0.
    pub irradiance: f32,
}

impl Light {
    /// About what the light may bring to a point, if nothing is in its way; `None` only where that
    /// is nothing.
    pub fn estimate(&self, from: Vec3) -> Option<LightEstimate> {
        let of_place = |center: Vec3, radius: f32, facing: &dyn Fn(f32) -> f32| {
            let way = center - from;
            let distance = way.length();
            let estimate = LightEstimate {
                direction: way.normalize_or(Vec3::Y),
                half_width: if distance > radius { radius / distance } else { 1.0 },
                irradiance: facing(distance),
            };
            (estimate.irradiance > 0.0).then_some(estimate)
        };
        // Somewhere on a plane light, the cosine of emission is up to (height + radius) / distance.
        let of_plane = |center: Vec3, normal: Vec3, radius: f32, area: f32, radiance: Rgb| {
            let height = normal.dot(from - center);
            let facing = |distance: f32| {
                let cos = ((height + radius) / distance).min(1.0);
                luminance(radiance) * area * cos / (distance * distance + area / PI)
            };
            if height > 0.0 { of_place(center, radius, &facing) } else { None }
        };
        match self.emitter {
            Emitter::Rectangle { center, frame, half: [a, b], radiance } => {
                of_plane(center, frame.z, (a * a + b * b).sqrt(), 4.0 * a * b, radiance)
            }
            Emitter::Disk { center, frame, radius, radiance } => {
                of_plane(center, frame.z, radius, PI * radius * radius, radiance)
            }
            Emitter::Sphere { center, radius, radiance } => of_place(center, radius, &|distance| {
                let sin = radius / distance;
                if sin < 1.0 { PI * sin * sin * luminance(radiance) } else { 0.0 }
            }),
            Emitter::Point { position, intensity } => {
                of_place(position, 0.0, &|distance| luminance(intensity) / (distance * distance))
            }
            Emitter::Spot { position, normal, intensity } => {
                let height = normal.dot(from - position);
                of_place(position, 0.0, &|distance| {
                    luminance(intensity) * height / (distance * distance * distance)
                })
            }
            Emitter::Sun { towards, irradiance } => Some(LightEstimate {
                direction: towards,
                half_width: 0.0,
                irradiance: luminance(irradiance),
            }),
            Emitter::SunCap { frame, one_minus_cos, radiance } => {
                let sin2 = one_minus_cos * (2.0 - one_minus_cos);
                Some(LightEstimate {
                    direction: frame.z,
                    half_width: sin2.sqrt(),
                    irradiance: PI * sin2 * luminance(radiance),
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Frame;

    /// On the axis of a light, the irradiance of a surface that faces it is known: π sin² of the angle of
    /// its rim times the radiance for round lights, and for a rectangle nearly so, by its area.
    #[test]
    fn estimates_are_exact_on_the_axis() {
        let (color, height) = (Rgb::new(2.0, 3.0, 1.0), 2.0);
        let (from, center) = (Vec3::new(0.3, -0.2, 0.5), Vec3::new(0.3, height - 0.2, 0.5));
        let frame = Frame::from_normal(Vec3::NEG_Y);
        let bright = 0.2126 * 2.0 + 0.7152 * 3.0 + 0.0722;
        let radius = 1.5_f32;
        let [of_disk, of_sphere] = [height.hypot(radius), height].map(|far| (radius / far).powi(2));
        let half = [1.2_f32, 0.5];
        let diagonal = half[0].hypot(half[1]);
        let of_area = 4.0 * half[0] * half[1] / (height.powi(2) + 4.0 * half[0] * half[1] / PI);
        let cap = 0.3_f32;
        for (emitter, half_width, irradiance) in [
            (Emitter::Point { position: center, intensity: color }, 0.0, 0.25),
            (Emitter::Spot { position: center, normal: Vec3::NEG_Y, intensity: color }, 0.0, 0.25),
            (
                Emitter::Disk { center, frame, radius, radiance: color },
                radius / height,
                PI * of_disk,
            ),
            (Emitter::Sphere { center, radius, radiance: color }, radius / height, PI * of_sphere),
            (
                Emitter::Rectangle { center, frame, half, radiance: color },
                diagonal / height,
                of_area,
            ),
            (Emitter::Sun { towards: Vec3::Y, irradiance: color }, 0.0, 1.0),
            (Emitter::sun(Vec3::Y, f64::from(cap), color), libm::sinf(cap), 1.0),
        ] {
            let found = Light { visible: true, emitter }.estimate(from).unwrap();
            let near =
                |found: f32, expected: f32| (found - expected).abs() < 1e-4 * expected.max(0.1);
            assert!(near(found.irradiance, irradiance * bright), "{emitter:?}: {found:?}");
            assert!(near(found.half_width, half_width), "{emitter:?}: {found:?}");
            assert!((found.direction - Vec3::Y).length() < 1e-6, "{emitter:?}: {found:?}");
        }
    }

    /// Beside a plane light its whole face is taken for as bright as its brightest point, a spot by its
    /// cosine; behind either is nothing.
    #[test]
    fn estimates_fall_with_the_cosine_of_emission() {
        let frame = Frame::from_normal(Vec3::Y);
        let (center, intensity) = (Vec3::ZERO, Rgb::splat(1.0));
        let disk = Emitter::Disk { center, frame, radius: 0.5, radiance: Rgb::splat(1.0) };
        let spot = Emitter::Spot { position: center, normal: Vec3::Y, intensity };
        let estimate = |emitter, from| Light { visible: true, emitter }.estimate(from);
        // At 60 degrees from the normal, two units away.
        let from = Vec3::new(3.0_f32.sqrt(), 1.0, 0.0);
        let area = PI * 0.25;
        for (emitter, expected) in [(disk, area * (1.5 / 2.0) / (4.0 + 0.25)), (spot, 0.5 / 4.0)] {
            let found = estimate(emitter, from).unwrap().irradiance;
            assert!((found / expected - 1.0).abs() < 1e-5, "{emitter:?}: {found}, not {expected}");
            assert!(estimate(emitter, -from).is_none(), "{emitter:?} from behind");
        }
    }
}

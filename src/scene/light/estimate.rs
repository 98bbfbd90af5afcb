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

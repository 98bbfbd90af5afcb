//! Sources of light, sampled from a point that they shine on.
//!
//! Rectangles, spheres and suns are sampled uniformly by the solid angle that they fill, disks
//! nearly so; small and far rectangles and disks by their area, which is the same there.

mod block;
mod estimate;
mod sphere;
mod way;

use std::f32::consts::TAU;

use glam::{DVec3, Vec3};

use crate::color::Rgb;
use crate::math::{Frame, Ray, portable, warp};

pub(crate) use block::LightBlock;
pub use estimate::LightEstimate;

use way::{Way, disk_pdf, rectangle_pdf, sphere_pdf};

/// A source of light. Never blocks light; seen by the camera only if `visible`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Whether the camera, mirrors, glass and scattered rays see it.
    pub visible: bool,
    /// Shape and strength.
    pub emitter: Emitter,
}

/// Shape and strength of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Emitter {
    /// One-sided Lambertian rectangle.
    Rectangle {
        /// Its centre.
        center: Vec3,
        /// x along the width, y along the height, z towards the emitting side.
        frame: Frame,
        /// Half the width and half the height.
        half: [f32; 2],
        /// Emitted radiance.
        radiance: Rgb,
    },
    /// One-sided Lambertian disk.
    Disk {
        /// Its centre.
        center: Vec3,
        /// z towards the emitting side.
        frame: Frame,
        /// Its radius.
        radius: f32,
        /// Emitted radiance.
        radiance: Rgb,
    },
    /// Shines outwards.
    Sphere {
        /// Its centre.
        center: Vec3,
        /// Its radius.
        radius: f32,
        /// Emitted radiance.
        radiance: Rgb,
    },
    /// A point, the same in all directions.
    Point {
        /// Where it is.
        position: Vec3,
        /// Radiant intensity.
        intensity: Rgb,
    },
    /// The limit of a small rectangle or disk: intensity falls with the cosine.
    Spot {
        /// Where it is.
        position: Vec3,
        /// Unit direction of the emitting side.
        normal: Vec3,
        /// Radiant intensity along `normal`.
        intensity: Rgb,
    },
    /// Parallel light.
    Sun {
        /// Unit direction towards it.
        towards: Vec3,
        /// Irradiance of a surface that faces it.
        irradiance: Rgb,
    },
    /// A uniform cap of the sky.
    SunCap {
        /// z towards its centre.
        frame: Frame,
        /// 1 - cosine of its angular radius, 0..=1.
        one_minus_cos: f32,
        /// Emitted radiance.
        radiance: Rgb,
    },
}

/// One way from a point to a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub direction: Vec3,
    /// From the point to the light, so that parameter 1 is the light; for suns the unit direction.
    pub reach: Vec3,
    /// 1 for lights at a place, infinite for suns.
    pub t_max: f32,
    /// Unit normal of the light's surface there, where it has one: the end of a shadow ray is kept
    /// clear along it.
    pub normal: Option<Vec3>,
    /// Radiance over density: times the BRDF and the cosine, an estimate of the light's share.
    pub weight: Rgb,
    /// Density of the direction per solid angle; `None` for points and parallel light, which no
    /// other ray can find.
    pub pdf: Option<f32>,
}

impl Light {
    /// Samples the light from `from` with two numbers in [0, 1). `None` where nothing arrives.
    pub fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<LightSample> {
        match self.emitter {
            Emitter::Rectangle { center, frame, half, radiance } => {
                Way::to_rectangle(from, u, center, &frame, half).sample(radiance)
            }
            Emitter::Disk { center, frame, radius, radiance } => {
                Way::to_disk(from, u, center, &frame, radius).sample(radiance)
            }
            Emitter::Sphere { center, radius, radiance } => {
                Way::to_sphere(from, u, center, radius).sample(radiance)
            }
            Emitter::Point { position, intensity } => from_point(from, position, |_| intensity),
            Emitter::Spot { position, normal, intensity } => {
                from_point(from, position, |d| intensity * (-normal.dot(d)).max(0.0))
            }
            Emitter::Sun { towards, irradiance } => Some(LightSample {
                direction: towards,
                reach: towards,
                t_max: f32::INFINITY,
                normal: None,
                weight: irradiance,
                pdf: None,
            }),
            Emitter::SunCap { frame, one_minus_cos, radiance } => {
                let direction = frame.world_from_local(warp::square_to_cap(u, one_minus_cos));
                Some(LightSample::of_sky(direction, radiance, 1.0 / (TAU * one_minus_cos)))
            }
        }
    }

    /// Where a ray meets the light from its emitting side: the parameter (infinite for suns) and
    /// the radiance. Lights without extent are never met.
    pub fn intersect(&self, ray: &Ray) -> Option<(f32, Rgb)> {
        let (origin, direction) = (ray.origin, ray.direction);
        let met = |t: f32, radiance: Rgb| (t > 0.0 && t < ray.t_max).then_some((t, radiance));
        match self.emitter {
            Emitter::Rectangle { center, frame, half, radiance } => {
                met(meet_rectangle(origin, direction, center, &frame, half), radiance)
            }
            Emitter::Disk { center, frame, radius, radiance } => {
                met(meet_disk(origin, direction, center, &frame, radius), radiance)
            }
            Emitter::Sphere { center, radius, radiance } => {
                let (t, _) = sphere::nearest(origin, direction, center, radius)?;
                met(t, radiance)
            }
            Emitter::SunCap { frame, one_minus_cos, radiance } => {
                let d = direction.normalize();
                let is_inside = 0.5 * (d - frame.z).length_squared() <= one_minus_cos;
                (is_inside && ray.t_max == f32::INFINITY).then_some((f32::INFINITY, radiance))
            }
            Emitter::Point { .. } | Emitter::Spot { .. } | Emitter::Sun { .. } => None,
        }
    }

    /// Unit normal of the light's surface at a point of it, where it has one.
    pub fn normal_at(&self, point: Vec3) -> Option<Vec3> {
        match self.emitter {
            Emitter::Rectangle { frame, .. } | Emitter::Disk { frame, .. } => Some(frame.z),
            Emitter::Sphere { center, .. } => (point - center).try_normalize(),
            Emitter::Point { .. }
            | Emitter::Spot { .. }
            | Emitter::Sun { .. }
            | Emitter::SunCap { .. } => None,
        }
    }

    /// Density per solid angle with which [`Light::sample`] finds what a ray from `from` along the
    /// unit `direction` meets at distance `t`; 0 for lights without extent.
    pub fn pdf(&self, from: Vec3, direction: Vec3, t: f32) -> f32 {
        match self.emitter {
            Emitter::Rectangle { center, frame, half, .. } => {
                rectangle_pdf(from, direction, t, center, &frame, half)
            }
            Emitter::Disk { center, frame, radius, .. } => {
                disk_pdf(from, direction, t, center, &frame, radius)
            }
            Emitter::Sphere { center, radius, .. } => sphere_pdf(from, center, radius),
            Emitter::SunCap { one_minus_cos, .. } => 1.0 / (TAU * one_minus_cos),
            Emitter::Point { .. } | Emitter::Spot { .. } | Emitter::Sun { .. } => 0.0,
        }
    }
}

impl LightSample {
    /// Of the point of a light that is `reach` away, found with density `pdf` per solid angle.
    pub fn of_place(reach: Vec3, normal: Option<Vec3>, radiance: Rgb, pdf: f32) -> Self {
        let (direction, weight) = (reach.normalize(), radiance / pdf);
        Self { direction, reach, t_max: 1.0, normal, weight, pdf: Some(pdf) }
    }

    /// Of a unit direction of the sky, found with density `pdf` per solid angle.
    pub fn of_sky(direction: Vec3, radiance: Rgb, pdf: f32) -> Self {
        let (t_max, weight) = (f32::INFINITY, radiance / pdf);
        Self { direction, reach: direction, t_max, normal: None, weight, pdf: Some(pdf) }
    }
}

/// A point in the frame around a light's centre.
#[inline(always)]
fn seen_from(from: Vec3, center: Vec3, frame: &Frame) -> DVec3 {
    in_frame(frame, from.as_dvec3() - center.as_dvec3())
}

#[inline(always)]
fn in_frame(frame: &Frame, v: DVec3) -> DVec3 {
    let Frame { x, y, z } = frame;
    DVec3::new(x.as_dvec3().dot(v), y.as_dvec3().dot(v), z.as_dvec3().dot(v))
}

#[inline(always)]
fn in_world(frame: &Frame, v: DVec3) -> DVec3 {
    frame.x.as_dvec3() * v.x + frame.y.as_dvec3() * v.y + frame.z.as_dvec3() * v.z
}

/// From this distance on, in squared half diagonals or radii, light is sampled by area: distance and
/// cosine hardly change over it.
const FAR2: f64 = 100.0;

fn from_point(from: Vec3, position: Vec3, intensity: impl Fn(Vec3) -> Rgb) -> Option<LightSample> {
    let reach = position - from;
    let distance2 = reach.length_squared();
    if distance2 <= 0.0 {
        return None;
    }
    let direction = reach / distance2.sqrt();
    let weight = intensity(direction) / distance2;
    Some(LightSample { direction, reach, t_max: 1.0, normal: None, weight, pdf: None })
}

/// Where a ray meets a plane from its front: the parameter, else NaN, and the place in its frame.
#[inline(always)]
fn meet_front(origin: Vec3, direction: Vec3, center: Vec3, frame: &Frame) -> (f32, Vec3) {
    let cos = frame.z.dot(direction);
    let t = frame.z.dot(center - origin) / cos;
    let place = frame.local_from_world(origin + direction * t - center);
    (if cos < 0.0 { t } else { f32::NAN }, place)
}

/// The parameter at which a ray meets a rectangle from its front, else NaN.
#[inline(always)]
fn meet_rectangle(
    origin: Vec3,
    direction: Vec3,
    center: Vec3,
    frame: &Frame,
    half: [f32; 2],
) -> f32 {
    let (t, p) = meet_front(origin, direction, center, frame);
    if p.x.abs() <= half[0] && p.y.abs() <= half[1] { t } else { f32::NAN }
}

/// The same for a disk.
#[inline(always)]
fn meet_disk(origin: Vec3, direction: Vec3, center: Vec3, frame: &Frame, radius: f32) -> f32 {
    let (t, p) = meet_front(origin, direction, center, frame);
    if p.x * p.x + p.y * p.y <= radius * radius { t } else { f32::NAN }
}

/// The emitter of a light of some power and size.
impl Emitter {
    /// A sun of angular radius `radius` (radians, 0..=π/2) that gives a facing surface exactly
    /// `irradiance`.
    pub fn sun(towards: Vec3, radius: f64, irradiance: Rgb) -> Self {
        if radius == 0.0 {
            return Self::Sun { towards, irradiance };
        }
        let half_sin = portable::sin_f64(0.5 * radius);
        let sin = portable::sin_f64(radius);
        Self::SunCap {
            frame: Frame::from_normal(towards),
            one_minus_cos: (2.0 * half_sin * half_sin) as f32,
            radiance: irradiance / (std::f64::consts::PI * sin * sin) as f32,
        }
    }
}

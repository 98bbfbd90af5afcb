//! Ways from a point to a light with an extent, without branches: for one point or in lanes.

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::{FAR2, LightSample, in_frame, in_world, seen_from, sphere};
use crate::color::Rgb;
use crate::math::spherical_ellipse::SphericalEllipse;
use crate::math::spherical_rectangle::SphericalRectangle;
use crate::math::{Frame, warp};

/// From a point to a point of a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub(super) reach: Vec3,
    /// `reach` in unit length.
    pub(super) direction: Vec3,
    /// Unit normal of the light there.
    pub(super) normal: Vec3,
    /// Density per solid angle; 0 where nothing arrives.
    pub(super) pdf: f32,
}

impl Way {
    /// As a sample of a light of that radiance.
    pub(super) fn sample(self, radiance: Rgb) -> Option<LightSample> {
        (self.pdf > 0.0).then(|| LightSample {
            direction: self.direction,
            reach: self.reach,
            t_max: 1.0,
            normal: Some(self.normal),
            weight: radiance / self.pdf,
            pdf: Some(self.pdf),
        })
    }

    /// By solid angle where the rectangle is near, else by area.
    #[inline(always)]
    pub(super) fn to_rectangle(
        from: Vec3,
        [u, v]: [f32; 2],
        center: Vec3,
        frame: &Frame,
        half: [f32; 2],
    ) -> Self {
        let [a, b] = half;
        let (whole, is_near) = rectangle(from, center, frame, half);
        let p = whole.sample([f64::from(u), f64::from(v)]);
        let near = in_world(frame, DVec3::new(p.x, p.y, -p.z)).as_vec3();
        let (x, y) = (a * (2.0 * u - 1.0), b * (2.0 * v - 1.0));
        let far = center + frame.x * x + frame.y * y - from;
        let reach = if is_near { near } else { far };
        let by_area = area_pdf(far, frame.z, 4.0 * a * b);
        let pdf = if is_near { (1.0 / whole.solid_angle) as f32 } else { by_area };
        Self { reach, direction: reach.normalize(), normal: frame.z, pdf }
    }

    /// By solid angle, nearly, where the disk is near, else by area.
    #[inline(always)]
    pub(super) fn to_disk(
        from: Vec3,
        u: [f32; 2],
        center: Vec3,
        frame: &Frame,
        radius: f32,
    ) -> Self {
        let p = warp::square_to_disk(u);
        let (cone, height, is_near) = disk(from, center, frame, radius);
        let direction = cone.sample(p.as_dvec2());
        let near = in_world(frame, direction * (height / -direction.z)).as_vec3();
        // A direction at the very rim may be rounded into the plane.
        let near_pdf = if direction.z < 0.0 { cone.pdf(direction) as f32 } else { 0.0 };
        let far = center + (frame.x * p.x + frame.y * p.y) * radius - from;
        let reach = if is_near { near } else { far };
        let pdf = if is_near { near_pdf } else { area_pdf(far, frame.z, PI * radius * radius) };
        Self { reach, direction: reach.normalize(), normal: frame.z, pdf }
    }

    /// By solid angle.
    #[inline(always)]
    pub(super) fn to_sphere(from: Vec3, u: [f32; 2], center: Vec3, radius: f32) -> Self {
        let cap = sphere::cap(from, center, radius);
        let axis = (center - from).normalize();
        let direction = Frame::from_normal(axis).world_from_local(warp::square_to_cap(u, cap));
        let (is_met, t, normal) = sphere::meeting(from, direction, center, radius);
        let (t_beside, normal_beside) = sphere::tangent(from, direction, center);
        let t = if is_met { t } else { t_beside };
        let normal = if is_met { normal } else { normal_beside };
        let pdf = if cap > 0.0 { 1.0 / (TAU * cap) } else { 0.0 };
        Self { reach: direction * t, direction, normal, pdf }
    }
}

/// A rectangle as it is seen from a point, and whether it is sampled by solid angle.
#[inline(always)]
fn rectangle(
    from: Vec3,
    center: Vec3,
    frame: &Frame,
    half: [f32; 2],
) -> (SphericalRectangle, bool) {
    let seen = seen_from(from, center, frame);
    let (wide, high) = (f64::from(half[0]), f64::from(half[1]));
    let whole = SphericalRectangle::seen([wide, high], seen);
    let is_close = seen.length_squared() < FAR2 * (wide * wide + high * high);
    (whole, seen.z > 0.0 && is_close && whole.is_visible())
}

/// The same for a disk, with the height above it.
#[inline(always)]
fn disk(from: Vec3, center: Vec3, frame: &Frame, radius: f32) -> (SphericalEllipse, f64, bool) {
    let seen = seen_from(from, center, frame);
    let wide = f64::from(radius);
    let cone = SphericalEllipse::seen(wide, seen);
    let is_close = seen.length_squared() < FAR2 * wide * wide;
    (cone, seen.z, seen.z > 0.0 && is_close && cone.is_visible())
}

/// [`Light::pdf`](super::Light::pdf) of a rectangle.
#[inline(always)]
pub(super) fn rectangle_pdf(
    from: Vec3,
    direction: Vec3,
    t: f32,
    center: Vec3,
    frame: &Frame,
    half: [f32; 2],
) -> f32 {
    let (whole, is_near) = rectangle(from, center, frame, half);
    let by_area = area_pdf_at(direction, t, frame.z, 4.0 * half[0] * half[1]);
    if is_near { (1.0 / whole.solid_angle) as f32 } else { by_area }
}

/// [`Light::pdf`](super::Light::pdf) of a disk.
#[inline(always)]
pub(super) fn disk_pdf(
    from: Vec3,
    direction: Vec3,
    t: f32,
    center: Vec3,
    frame: &Frame,
    radius: f32,
) -> f32 {
    let (cone, _, is_near) = disk(from, center, frame, radius);
    let near = cone.pdf(in_frame(frame, direction.as_dvec3())) as f32;
    if is_near { near } else { area_pdf_at(direction, t, frame.z, PI * radius * radius) }
}

/// [`Light::pdf`](super::Light::pdf) of a sphere.
#[inline(always)]
pub(super) fn sphere_pdf(from: Vec3, center: Vec3, radius: f32) -> f32 {
    let cap = sphere::cap(from, center, radius);
    if cap > 0.0 { 1.0 / (TAU * cap) } else { 0.0 }
}

/// Density per solid angle of a unit direction that meets an area at distance `t`.
#[inline(always)]
fn area_pdf_at(direction: Vec3, t: f32, normal: Vec3, area: f32) -> f32 {
    let cos = -normal.dot(direction);
    if cos > 0.0 { t * t / (cos * area) } else { 0.0 }
}

/// Density per solid angle of a way that was found with density 1 / `area`; 0 from behind.
#[inline(always)]
fn area_pdf(reach: Vec3, normal: Vec3, area: f32) -> f32 {
    let distance2 = reach.length_squared();
    let cos = -normal.dot(reach / distance2.sqrt());
    let pdf = distance2 / (cos * area);
    if cos > 0.0 && distance2 > 0.0 { pdf } else { 0.0 }
}

//! A sphere as it is seen from a point outside of it, in f64: close to a large sphere, what is seen
//! of it is a small difference of large numbers.

use glam::{DVec3, Vec3};

/// Half of the sphere's directions from a point, as 1 - cosine of the angle that it fills, 0..1; 0
/// from inside or on it.
#[inline(always)]
pub(super) fn cap(from: Vec3, center: Vec3, radius: f32) -> f32 {
    let f = from.as_dvec3() - center.as_dvec3();
    let (distance2, radius2) = (f.length_squared(), f64::from(radius) * f64::from(radius));
    let cos = ((distance2 - radius2) / distance2).sqrt();
    let cap = (radius2 / distance2 / (1.0 + cos)) as f32;
    if distance2 > radius2 { cap } else { 0.0 }
}

/// Nearest meeting of a ray with a sphere, from outside: the parameter and the unit normal.
pub(super) fn nearest(
    origin: Vec3,
    direction: Vec3,
    center: Vec3,
    radius: f32,
) -> Option<(f32, Vec3)> {
    let (is_met, t, normal) = meeting(origin, direction, center, radius);
    is_met.then_some((t, normal))
}

/// Whether a ray meets a sphere from outside, and if so, the parameter and the unit normal.
#[inline(always)]
pub(super) fn meeting(
    origin: Vec3,
    direction: Vec3,
    center: Vec3,
    radius: f32,
) -> (bool, f32, Vec3) {
    let (f, d) = (origin.as_dvec3() - center.as_dvec3(), direction.as_dvec3());
    let radius2 = f64::from(radius) * f64::from(radius);
    let a = d.length_squared();
    let b = -f.dot(d);
    let miss = f + d * (b / a);
    let discriminant = radius2 - miss.length_squared();
    let c = f.length_squared() - radius2;
    let t = c / (b + (a * discriminant).sqrt());
    let is_met = discriminant >= 0.0 && b > 0.0 && c > 0.0;
    (is_met, t as f32, (f + d * t).normalize().as_vec3())
}

/// The point of a direction that rounding put just outside the sphere; from so far that its normal
/// is lost, it faces the eye.
#[inline(always)]
pub(super) fn tangent(from: Vec3, direction: Vec3, center: Vec3) -> (f32, Vec3) {
    let t = (center - from).dot(direction);
    let out: DVec3 = (from + direction * t - center).as_dvec3();
    let scale = out.length_recip();
    let normal = (out * scale).as_vec3();
    (t, if scale.is_finite() { normal } else { -direction })
}

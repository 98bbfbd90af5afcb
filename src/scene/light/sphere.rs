//! A sphere as it is seen from a point outside of it, in f64: close to a large sphere, what is seen
//! of it is a small difference of large numbers.

use glam::{DVec3, Vec3};

/// Half of the sphere's directions from a point, as 1 - cosine of the angle that it fills, 0..1;
/// `None` from inside or on it.
pub(super) fn cap(from: Vec3, center: Vec3, radius: f32) -> Option<f32> {
    let f = from.as_dvec3() - center.as_dvec3();
    let (distance2, radius2) = (f.length_squared(), f64::from(radius).powi(2));
    if distance2 <= radius2 {
        return None;
    }
    let cos = ((distance2 - radius2) / distance2).sqrt();
    Some((radius2 / distance2 / (1.0 + cos)) as f32)
}

/// Nearest meeting of a ray with a sphere, from outside: the parameter and the unit normal.
pub(super) fn nearest(
    origin: Vec3,
    direction: Vec3,
    center: Vec3,
    radius: f32,
) -> Option<(f32, Vec3)> {
    let (f, d) = (origin.as_dvec3() - center.as_dvec3(), direction.as_dvec3());
    let radius2 = f64::from(radius).powi(2);
    let a = d.length_squared();
    let b = -f.dot(d);
    let miss = f + d * (b / a);
    let discriminant = radius2 - miss.length_squared();
    let c = f.length_squared() - radius2;
    if discriminant < 0.0 || b <= 0.0 || c <= 0.0 {
        return None;
    }
    let t = c / (b + (a * discriminant).sqrt());
    Some((t as f32, (f + d * t).normalize().as_vec3()))
}

/// The point of a direction that rounding put just outside the sphere.
pub(super) fn tangent(from: Vec3, direction: Vec3, center: Vec3) -> (f32, Vec3) {
    let t = (center - from).dot(direction);
    let normal: DVec3 = (from + direction * t - center).as_dvec3();
    (t, normal.normalize().as_vec3())
}

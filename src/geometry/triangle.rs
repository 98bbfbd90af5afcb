//! The watertight ray-triangle test.
//!
//! Corners are brought to a space where the ray is the z axis; that is the only rounding which
//! decides anything. The signs of the edge functions are exact: single precision where it is
//! certain, double where it is not, in which products of single-precision numbers are exact. So a
//! ray never slips between two triangles, and what is met is a point of the triangle that lies on
//! the ray to within a few units in the last place, even where the ray runs in the triangle's
//! plane: a tree finds there what brute force finds. No fused multiply-add: the same operations in
//! the same order give the same bits on every path and machine.
//!
//! Source: S. Woop, C. Benthin and I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
//! 2013.

use glam::Vec3;

use crate::math::Ray;

/// What the test needs of a ray, computed once: the permutation of axes that makes z the largest
/// component of the direction, and the shear that turns the direction into that axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRay {
    origin: [f32; 3],
    axes: [usize; 3],
    shear: [f32; 2],
    /// The direction's largest component.
    speed: f32,
}

/// An edge function above this share of its products has the right sign: its own rounding and that
/// of both products are below a quarter of it.
const CERTAIN: f32 = 1.0 / 4_194_304.0;

impl ShearedRay {
    /// Prepares a ray whose direction is not zero.
    pub(super) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let a = ray.direction.abs();
        let z = if a.x > a.y {
            if a.x > a.z { 0 } else { 2 }
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            (x, y) = (y, x);
        }
        let shear = [d[x] / d[z], d[y] / d[z]];
        Self { origin: ray.origin.to_array(), axes: [x, y, z], shear, speed: d[z] }
    }

    /// Parameter of the hit, of either sign and not compared with the ray's end; `None` where the
    /// line misses the triangle or lies in its plane.
    #[inline]
    pub(super) fn intersect(&self, corners: [Vec3; 3]) -> Option<f32> {
        let [kx, ky, kz] = self.axes;
        let [sx, sy] = self.shear;
        let [a, b, c] = corners.map(|corner| {
            let corner = corner.to_array();
            let z = corner[kz] - self.origin[kz];
            let x = (corner[kx] - self.origin[kx]) - sx * z;
            let y = (corner[ky] - self.origin[ky]) - sy * z;
            [x, y, z]
        });
        let (u, is_u_certain) = edge(c, b);
        let (v, is_v_certain) = edge(a, c);
        let (w, is_w_certain) = edge(b, a);
        let is_certain = is_u_certain & is_v_certain & is_w_certain;
        if is_certain && have_both_signs(u, v, w) {
            return None;
        }
        let (u, v, w) = (exact_edge(c, b), exact_edge(a, c), exact_edge(b, a));
        let det = u + v + w;
        if have_both_signs(u, v, w) || det == 0.0 {
            return None;
        }
        let [z_a, z_b, z_c] = [a, b, c].map(|corner| f64::from(corner[2]));
        Some(((u * z_a + v * z_b + w * z_c) / (det * f64::from(self.speed))) as f32)
    }
}

/// Twice the area between the ray and an edge, and whether its sign is certain.
#[inline]
fn edge(p: [f32; 3], q: [f32; 3]) -> (f32, bool) {
    let product = p[0] * q[1];
    let value = product - p[1] * q[0];
    (value, value.abs() > CERTAIN * product.abs())
}

/// The same, rounded once: its sign is right.
#[inline]
fn exact_edge(p: [f32; 3], q: [f32; 3]) -> f64 {
    f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])
}

#[inline]
fn have_both_signs<T: PartialOrd + Default + Copy>(u: T, v: T, w: T) -> bool {
    let zero = T::default();
    (u < zero || v < zero || w < zero) && (u > zero || v > zero || w > zero)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ray in the plane of a triangle that passes it by: rounded edge functions are noise there,
    /// and may all have one sign.
    #[test]
    fn a_ray_in_the_plane_of_a_triangle_meets_it_only_where_it_is() {
        let corners = [
            Vec3::new(0.00025, 0.00025, -0.00025),
            Vec3::new(0.0005, 0.0, -0.00075),
            Vec3::new(-0.00075, -0.0005, 0.0005),
        ];
        let origin = Vec3::new(0.000_120_103_17, 0.000_379_896_84, 9.793_643e-6);
        let ray = Ray::new(origin, Vec3::new(-0.300_592_66, -0.915_487_9, -0.267_443_54));
        if let Some(t) = ShearedRay::new(&ray).intersect(corners) {
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let (ab, ac, ap) = (b - a, c - a, ray.at(t).as_dvec3() - a);
            let n = ab.cross(ac) / ab.cross(ac).length_squared();
            let (v, w) = (ap.cross(ac).dot(n), ab.cross(ap).dot(n));
            assert!(v.min(w).min(1.0 - v - w) > -1e-5, "met at barycentrics ({v}, {w})");
        }
    }

    #[test]
    fn the_parameter_is_in_units_of_the_direction() {
        let corners =
            [Vec3::new(-1.0, -1.0, 4.0), Vec3::new(3.0, -1.0, 4.0), Vec3::Y + 4.0 * Vec3::Z];
        for direction in [Vec3::new(0.1, 0.0, 2.0), Vec3::new(0.05, 0.02, 0.5)] {
            let t = ShearedRay::new(&Ray::new(Vec3::ZERO, direction)).intersect(corners);
            assert_eq!(t, Some(4.0 / direction.z), "along {direction}");
            let back = ShearedRay::new(&Ray::new(Vec3::ZERO, -direction)).intersect(corners);
            assert_eq!(back, Some(-4.0 / direction.z), "behind {direction}");
        }
    }
}

//! The watertight ray-triangle test.
//!
//! Corners are brought to a space where the ray is the z axis; that is the only rounding which
//! decides anything. The signs of the edge functions are exact: what single precision leaves open
//! is decided in double, in which products of single-precision numbers are exact. So a
//! ray never slips between two triangles, and what is met is a point of the triangle that lies on
//! the ray to within a few units in the last place, even where the ray runs in the triangle's
//! plane: a tree finds there what brute force finds. No fused multiply-add: the same operations in
//! the same order give the same bits on every path and machine.
//!
//! Source: S. Woop, C. Benthin and I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
//! 2013.

use glam::Vec3;

use crate::geometry::kd_tree::{LANES, Lanes, PacketRays};
use crate::math::Ray;

/// What the test needs of a direction, computed once: the order of axes that makes z the largest
/// component, and the shear that turns the direction into that axis.
///
/// Where z is negative the triangle is seen mirrored; all three edge functions change their sign
/// then, which changes nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    /// x, y and z of the sheared space.
    pub(super) order: [usize; 3],
    /// Shear along x and y.
    pub(super) shear: [f32; 2],
    /// The direction's largest component.
    pub(super) speed: f32,
}

impl Axes {
    /// Of a direction that is not zero.
    #[inline(always)]
    pub(super) fn new(direction: Vec3) -> Self {
        let a = direction.abs();
        let order = order_of(largest_axis(a.x, a.y, a.z));
        let [x, y, speed] = order.map(|axis| direction[axis]);
        Self { order, shear: [x / speed, y / speed], speed }
    }
}

/// Which is the largest: of x and y the latter, and z, where they are equal.
#[inline(always)]
fn largest_axis(x: f32, y: f32, z: f32) -> usize {
    let of_two = if x > y { 0 } else { 1 };
    let largest = if x > y { x } else { y };
    if largest > z { of_two } else { 2 }
}

/// The order of axes that has that one last.
#[inline(always)]
fn order_of(last: usize) -> [usize; 3] {
    [(last + 1) % 3, (last + 2) % 3, last]
}

/// A ray ready for tests against triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRay {
    origin: [f32; 3],
    axes: Axes,
}

impl ShearedRay {
    /// Prepares a ray whose direction is not zero.
    pub(super) fn new(ray: &Ray) -> Self {
        Self { origin: ray.origin.to_array(), axes: Axes::new(ray.direction) }
    }

    /// Parameter of the hit, of either sign and not compared with the ray's end; `None` where the
    /// line misses the triangle or lies in its plane.
    #[inline]
    pub(super) fn intersect(&self, corners: [Vec3; 3]) -> Option<f32> {
        let [kx, ky, kz] = self.axes.order;
        let [sx, sy] = self.axes.shear;
        let [a, b, c] = corners.map(|corner| {
            let z = corner[kz] - self.origin[kz];
            let x = (corner[kx] - self.origin[kx]) - sx * z;
            let y = (corner[ky] - self.origin[ky]) - sy * z;
            [x, y, z]
        });
        let [(is_u_below, is_u_above), (is_v_below, is_v_above), (is_w_below, is_w_above)] =
            [certain_sign(c, b), certain_sign(a, c), certain_sign(b, a)];
        if (is_u_below | is_v_below | is_w_below) & (is_u_above | is_v_above | is_w_above) {
            return None;
        }
        exact(a, b, c, self.axes.speed)
    }
}

/// Rays of a packet, all with the same order of axes, ready for tests against triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRays {
    order: [usize; 3],
    /// In that order.
    origin: [Lanes<f32>; 3],
    shear: [Lanes<f32>; 2],
    speed: Lanes<f32>,
}

impl ShearedRays {
    /// `None` where rays differ in the order of axes.
    #[inline(always)]
    pub(super) fn new(rays: &PacketRays) -> Option<Self> {
        let [x, y, z] = &rays.direction;
        let first = largest_axis(x[0].abs(), y[0].abs(), z[0].abs());
        let mut n_others = 0_u32;
        for i in 0..LANES {
            let largest = largest_axis(x[i].abs(), y[i].abs(), z[i].abs());
            n_others += u32::from(largest != first);
        }
        if n_others > 0 {
            return None;
        }
        let order = order_of(first);
        let [along_x, along_y, speed] = order.map(|axis| rays.direction[axis]);
        let mut shear = [[0.0; LANES]; 2];
        for i in 0..LANES {
            shear[0][i] = along_x[i] / speed[i];
            shear[1][i] = along_y[i] / speed[i];
        }
        Some(Self { order, origin: order.map(|axis| rays.origin[axis]), shear, speed })
    }

    /// [`ShearedRay::intersect`] for all rays: parameters above 0 and not beyond the limits, else
    /// NaN. Whether there is any.
    #[inline(always)]
    pub(super) fn intersect(
        &self,
        corners: [Vec3; 3],
        limits: &Lanes<f32>,
        t: &mut Lanes<f32>,
    ) -> bool {
        let [kx, ky, kz] = self.order;
        let mut sheared = [[[0.0; LANES]; 3]; 3];
        let mut n_candidates = 0_u32;
        for (sheared, corner) in sheared.iter_mut().zip(corners) {
            let (x, y, z) = (corner[kx], corner[ky], corner[kz]);
            for i in 0..LANES {
                let along = z - self.origin[2][i];
                sheared[0][i] = (x - self.origin[0][i]) - self.shear[0][i] * along;
                sheared[1][i] = (y - self.origin[1][i]) - self.shear[1][i] * along;
                sheared[2][i] = along;
            }
        }
        let [a, b, c] = &sheared;
        for i in 0..LANES {
            let edge =
                |p: &[Lanes<f32>; 3], q: &[Lanes<f32>; 3]| p[0][i] * q[1][i] - p[1][i] * q[0][i];
            let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
            let is_outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
            n_candidates += u32::from(!is_outside);
        }
        if n_candidates == 0 {
            return false;
        }
        let mut n_hits = 0_u32;
        for i in 0..LANES {
            let corner = |p: &[Lanes<f32>; 3]| [p[0][i], p[1][i], p[2][i]];
            let (is_met, at) = decided(corner(a), corner(b), corner(c), self.speed[i]);
            let is_hit = is_met && at > 0.0 && at <= limits[i];
            t[i] = if is_hit { at } else { f32::NAN };
            n_hits += u32::from(is_hit);
        }
        n_hits > 0
    }
}

/// Whether the area between the ray and an edge is certainly below 0, or certainly above: rounding
/// keeps the order of two products, so their difference has the right sign wherever it is not 0.
#[inline(always)]
fn certain_sign(p: [f32; 3], q: [f32; 3]) -> (bool, bool) {
    let value = p[0] * q[1] - p[1] * q[0];
    (value < 0.0, value > 0.0)
}

/// The test of corners in sheared space, with exact signs; what decides every hit.
#[inline]
pub(super) fn exact(a: [f32; 3], b: [f32; 3], c: [f32; 3], speed: f32) -> Option<f32> {
    let (is_met, t) = decided(a, b, c, speed);
    is_met.then_some(t)
}

/// [`exact`] without branches.
#[inline(always)]
fn decided(a: [f32; 3], b: [f32; 3], c: [f32; 3], speed: f32) -> (bool, f32) {
    let (u, v, w) = (exact_edge(c, b), exact_edge(a, c), exact_edge(b, a));
    let det = u + v + w;
    let is_below = u < 0.0 || v < 0.0 || w < 0.0;
    let is_above = u > 0.0 || v > 0.0 || w > 0.0;
    let [z_a, z_b, z_c] = [f64::from(a[2]), f64::from(b[2]), f64::from(c[2])];
    let t = ((u * z_a + v * z_b + w * z_c) / (det * f64::from(speed))) as f32;
    (!(is_below && is_above) && det != 0.0, t)
}

/// Twice the area between the ray and an edge, rounded once: its sign is right.
#[inline(always)]
fn exact_edge(p: [f32; 3], q: [f32; 3]) -> f64 {
    f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])
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

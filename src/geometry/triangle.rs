//! The watertight ray-triangle test.
//!
//! Source: S. Woop, C. Benthin and I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
//! 2013. No fused multiply-add: the same operations in the same order give the same bits on every
//! path and machine.

use glam::Vec3;

use crate::math::Ray;

/// What the test needs of a direction, computed once: the order of axes that makes z the largest
/// component, and the shear that makes the direction (0, 0, 1).
///
/// Where z is negative the triangle is seen mirrored; all three edge functions change their sign
/// then, which changes nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    /// x, y and z of the sheared space.
    pub(super) order: [usize; 3],
    /// Shear along x and y, scale along z.
    pub(super) shear: [f32; 3],
}

impl Axes {
    /// Of a direction that is not zero.
    #[inline(always)]
    pub(super) fn new(direction: Vec3) -> Self {
        let a = direction.abs();
        let z = if a.x > a.y {
            if a.x > a.z { 0 } else { 2 }
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let order = [(z + 1) % 3, (z + 2) % 3, z];
        let [x, y, z] = order.map(|axis| direction[axis]);
        Self { order, shear: [x / z, y / z, 1.0 / z] }
    }
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
        let [sx, sy, sz] = self.axes.shear;
        let relative = corners.map(|corner| {
            let z = corner[kz] - self.origin[kz];
            let x = (corner[kx] - self.origin[kx]) - sx * z;
            let y = (corner[ky] - self.origin[ky]) - sy * z;
            [x, y, z]
        });
        let [a, b, c] = relative;
        let mut u = c[0] * b[1] - c[1] * b[0];
        let mut v = a[0] * c[1] - a[1] * c[0];
        let mut w = b[0] * a[1] - b[1] * a[0];
        if u == 0.0 || v == 0.0 || w == 0.0 {
            [u, v, w] = exact_edges([a[0], a[1]], [b[0], b[1]], [c[0], c[1]]);
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        Some((u * (sz * a[2]) + v * (sz * b[2]) + w * (sz * c[2])) / det)
    }
}

/// The edge functions with exact signs: products of f32 are exact in f64.
pub(super) fn exact_edges(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> [f32; 3] {
    let edge = |p: [f32; 2], q: [f32; 2]| {
        (f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])) as f32
    };
    [edge(c, b), edge(a, c), edge(b, a)]
}

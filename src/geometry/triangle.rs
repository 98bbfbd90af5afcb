//! The watertight ray-triangle test.
//!
//! Source: S. Woop, C. Benthin and I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
//! 2013. No fused multiply-add: the same operations in the same order give the same bits on every
//! path and machine.

use glam::Vec3;

use crate::math::Ray;

/// What the test needs of a ray, computed once: the permutation of axes that makes z the largest
/// component of the direction, and the shear that makes the direction (0, 0, 1).
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRay {
    origin: [f32; 3],
    axes: [usize; 3],
    shear: [f32; 3],
}

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
        let shear = [d[x] / d[z], d[y] / d[z], 1.0 / d[z]];
        Self { origin: ray.origin.to_array(), axes: [x, y, z], shear }
    }

    /// Parameter of the hit, of either sign and not compared with the ray's end; `None` where the
    /// line misses the triangle or lies in its plane.
    #[inline]
    pub(super) fn intersect(&self, corners: [Vec3; 3]) -> Option<f32> {
        let [kx, ky, kz] = self.axes;
        let [sx, sy, sz] = self.shear;
        let relative = corners.map(|c| {
            let c = c.to_array();
            let z = c[kz] - self.origin[kz];
            let x = (c[kx] - self.origin[kx]) - sx * z;
            let y = (c[ky] - self.origin[ky]) - sy * z;
            [x, y, z]
        });
        let [a, b, c] = relative;
        let mut u = c[0] * b[1] - c[1] * b[0];
        let mut v = a[0] * c[1] - a[1] * c[0];
        let mut w = b[0] * a[1] - b[1] * a[0];
        if u == 0.0 || v == 0.0 || w == 0.0 {
            [u, v, w] = exact_edges(a, b, c);
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
fn exact_edges(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> [f32; 3] {
    let edge = |p: [f32; 3], q: [f32; 3]| {
        (f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])) as f32
    };
    [edge(c, b), edge(a, c), edge(b, a)]
}

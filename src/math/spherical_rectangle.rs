//! A rectangle as it is seen from a point, sampled uniformly by solid angle.
//!
//! Source: C. Ureña, M. Fajardo and A. King, "An Area-Preserving Parametrization for Spherical
//! Rectangles", EGSR 2013. In f64: the solid angle is a small difference of large angles.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::math::elementary;

/// The directions from a point to a rectangle.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    /// Corners as seen from the point, in the rectangle's axes: lower x and y, upper x and y.
    x: [f64; 2],
    y: [f64; 2],
    /// Distance of its plane, above 0.
    z: f64,
    /// z components of the normals of the planes through the point and the sides at y[0], y[1].
    b: [f64; 2],
    /// Angle at which the sampled sum of angles starts.
    k: f64,
    /// In steradians, above 0.
    pub solid_angle: f64,
}

impl SphericalRectangle {
    /// The rectangle of half extents `half` around the origin of the plane z = 0, seen from `from`.
    /// `None` from its plane, and where it is too small to be told from nothing.
    pub fn new(half: [f64; 2], from: DVec3) -> Option<Self> {
        let whole = Self::seen(half, from);
        whole.is_visible().then_some(whole)
    }

    /// The same without a check.
    #[inline(always)]
    pub(crate) fn seen(half: [f64; 2], from: DVec3) -> Self {
        let z = from.z.abs();
        let (x, y) = ([-half[0] - from.x, half[0] - from.x], [-half[1] - from.y, half[1] - from.y]);
        let slope = |side: f64| side / (side * side + z * z).sqrt();
        let n = [-slope(y[0]), slope(x[1]), slope(y[1]), -slope(x[0])];
        let corner = |i: usize, j: usize| elementary::acos((-n[i] * n[j]).clamp(-1.0, 1.0));
        let k = TAU - corner(2, 3) - corner(3, 0);
        let solid_angle = corner(0, 1) + corner(1, 2) - k;
        Self { x, y, z, b: [n[0], n[2]], k, solid_angle }
    }

    /// Whether it can be told from nothing.
    #[inline(always)]
    pub(crate) fn is_visible(&self) -> bool {
        const SMALLEST: f64 = 1e-9;
        self.z > 0.0 && self.solid_angle > SMALLEST
    }

    /// The point of the rectangle's plane for two numbers in [0, 1), relative to where it is seen
    /// from; z is the distance of the plane.
    #[inline(always)]
    pub fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        let angle = u * self.solid_angle + self.k;
        let (sin, cos) = elementary::sin_cos(angle);
        let f = (cos * self.b[0] - self.b[1]) / sin;
        let c = (1.0_f64.copysign(f) / (f * f + self.b[0] * self.b[0]).sqrt()).clamp(-1.0, 1.0);
        let x = c * self.z / (1.0 - c * c).max(1e-24).sqrt();
        let x = if x.is_finite() { x.max(self.x[0]).min(self.x[1]) } else { self.x[0] };
        let across2 = x * x + self.z * self.z;
        let height = |y: f64| y / (across2 + y * y).sqrt();
        let (low, high) = (height(self.y[0]), height(self.y[1]));
        let h = low + v * (high - low);
        let y = h * (across2 / (1.0 - h * h).max(1e-24)).sqrt();
        DVec3::new(x, y.max(self.y[0]).min(self.y[1]), self.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of the four right-angled corner pieces, each an arc tangent.
    fn solid_angle(half: [f64; 2], from: DVec3) -> f64 {
        let piece =
            |x: f64, y: f64| (x * y / (from.z * (x * x + y * y + from.z * from.z).sqrt())).atan();
        let (x, y) = ([-half[0] - from.x, half[0] - from.x], [-half[1] - from.y, half[1] - from.y]);
        piece(x[1], y[1]) - piece(x[0], y[1]) - piece(x[1], y[0]) + piece(x[0], y[0])
    }

    #[test]
    fn the_solid_angle_is_that_of_four_corner_pieces() {
        for half in [[1.0, 1.0], [0.1, 3.0], [20.0, 5.0]] {
            for from in [
                DVec3::new(0.0, 0.0, 1.0),
                DVec3::new(0.3, -0.2, 1e-4),
                DVec3::new(5.0, 1.0, 0.3),
                DVec3::new(-40.0, 60.0, 30.0),
            ] {
                let found = SphericalRectangle::new(half, from).unwrap().solid_angle;
                let expected = solid_angle(half, from);
                assert!((found - expected).abs() < 1e-12 + 1e-9 * expected, "{found} {expected}");
            }
        }
    }

    /// Equal cells of the square fill equal solid angles: the corners of a cell, as seen from the
    /// point, bound a rectangle only along x; so strips of x are compared, and heights in them.
    #[test]
    fn equal_strips_fill_equal_solid_angles() {
        for (half, from) in [
            ([1.0, 1.0], DVec3::new(0.2, 0.1, 0.5)),
            ([3.0, 0.2], DVec3::new(2.9, 0.4, 0.05)),
            ([1.0, 2.0], DVec3::new(6.0, -3.0, 1.0)),
        ] {
            let whole = SphericalRectangle::new(half, from).unwrap();
            for i in 1..8 {
                let u = f64::from(i) / 8.0;
                let p = whole.sample([u, 0.5]);
                let right = from.x + p.x;
                let width = 0.5 * (right + half[0]);
                let strip = solid_angle(
                    [width, half[1]],
                    DVec3::new(from.x - (right - width), from.y, from.z),
                );
                let expected = u * whole.solid_angle;
                assert!((strip / expected - 1.0).abs() < 1e-9, "{strip} at {u}, not {expected}");
            }
        }
    }
}

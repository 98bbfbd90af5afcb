//! A rectangle as it is seen from a point, sampled uniformly by solid angle.
//!
//! Source: C. Ureña, M. Fajardo and A. King, "An Area-Preserving Parametrization for Spherical
//! Rectangles", EGSR 2013. In f64: the solid angle is a small difference of large angles. Angles are
//! added as products of complex numbers of any length, which spares most roots and arc functions.

use glam::DVec3;

use crate::math::elementary;

/// The directions from a point to a rectangle.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    /// The unit of the lengths below.
    unit: f64,
    /// Corners as seen from the point, in the rectangle's axes: lower x and y, upper x and y.
    x: [f64; 2],
    y: [f64; 2],
    /// Distance of its plane, above 0.
    z: f64,
    /// Cosine and sine, times any length, of the angle at which the sampled sum of angles starts.
    start: Turn,
    /// In steradians, above 0.
    pub solid_angle: f64,
}

/// An angle as a complex number of any length.
#[derive(Clone, Copy, Debug)]
struct Turn {
    cos: f64,
    sin: f64,
}

impl Turn {
    /// The sum of both angles.
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self {
            cos: self.cos * other.cos - self.sin * other.sin,
            sin: self.cos * other.sin + self.sin * other.cos,
        }
    }

    /// How far it is beyond half a turn, in -π..=π.
    #[inline(always)]
    fn beyond_half(self) -> f64 {
        elementary::atan2(-self.sin, -self.cos)
    }
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
        let unit = half[0] + half[1];
        let scale = 1.0 / unit;
        let (half, from) = (half.map(|length| length * scale), from * scale);
        let z = from.z.abs();
        let (x, y) = ([-half[0] - from.x, half[0] - from.x], [-half[1] - from.y, half[1] - from.y]);
        // Between the planes through the point and two sides.
        let corner = |cos: f64, x: f64, y: f64| {
            let distance = (x * x + y * y + z * z).sqrt();
            Turn { cos, sin: z * distance }
        };
        let right = corner(x[1] * y[0], x[1], y[0]).plus(corner(-x[1] * y[1], x[1], y[1]));
        let left = corner(x[0] * y[1], x[0], y[1]).plus(corner(-x[0] * y[0], x[0], y[0]));
        let solid_angle = right.beyond_half() + left.beyond_half();
        // The whole turn without the left corners.
        let start = Turn { cos: left.cos, sin: -left.sin };
        Self { unit, x, y, z, start, solid_angle }
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
        let Self { unit, x: [x0, x1], y: [y0, y1], z, .. } = *self;
        let (sin, cos) = elementary::sin_cos(u * self.solid_angle);
        let angle = self.start.plus(Turn { cos, sin });
        // The cosine over the sine of the plane through x, both times the same length.
        let z2 = z * z;
        let low2 = y0 * y0 + z2;
        let p = -angle.cos * y0 - y1 * (x0 * x0 + z2) * low2;
        let across = (p - z * angle.sin) * (p + z * angle.sin);
        let x = z * angle.sin * (low2 / across.max(1e-24 * p * p)).sqrt() * 1.0_f64.copysign(p);
        let x = if x.is_finite() { x.max(x0).min(x1) } else { x0 };
        let across2 = x * x + z2;
        let (to_low, to_high) = ((across2 + y0 * y0).sqrt(), (across2 + y1 * y1).sqrt());
        let scale = 1.0 / (to_low * to_high);
        let (low, high) = (y0 * to_high * scale, y1 * to_low * scale);
        let h = low + v * (high - low);
        let y = h * (across2 / (1.0 - h * h).max(1e-24)).sqrt();
        DVec3::new(x, y.max(y0).min(y1), z) * unit
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

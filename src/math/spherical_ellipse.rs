//! A disk as it is seen from a point: the directions in an elliptic cone, sampled nearly uniformly
//! by solid angle, with the exact density.
//!
//! The cone's axis halves the angle between the directions to the nearest and the farthest point of
//! the rim. About the axis, a direction has an azimuth φ, and the cone ends at the angle θ(φ).
//! Uniform azimuths are stretched so that they would fill equal areas of an ellipse whose half axes
//! are those of the cone in Lambert's azimuthal equal-area projection, and 1 - cos is uniform up to
//! 1 - cos θ(φ). A circular cone is sampled uniformly; so is any narrow one; the density of others
//! stays within a fifth of uniform. The exactly uniform map needs incomplete elliptic integrals,
//! inverted by search: I. Guillén et al., "Area-Preserving Parameterizations for Spherical
//! Ellipses", EGSR 2017, where the cone is derived as well.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

/// The directions from a point to a disk.
#[derive(Clone, Copy, Debug)]
pub struct SphericalEllipse {
    /// Cone axis; long half axis; short half axis: an orthonormal frame.
    axis: DVec3,
    long: DVec3,
    short: DVec3,
    /// Squared tangents of the half angles along both.
    tan2: DVec2,
    /// 1 - cosine of the half angles along both.
    drop: DVec2,
}

impl SphericalEllipse {
    /// The disk of radius `radius` around the origin of the plane z = 0, seen from `from`, whose z
    /// is above 0. `None` from its plane.
    pub fn new(radius: f64, from: DVec3) -> Option<Self> {
        let cone = Self::seen(radius, from);
        cone.is_visible().then_some(cone)
    }

    /// The same without a check.
    #[inline(always)]
    pub(crate) fn seen(radius: f64, from: DVec3) -> Self {
        let h = from.z;
        let offset = DVec2::new(from.x, from.y).length();
        // Towards the centre, along the plane.
        let along = if offset > 0.0 {
            DVec3::new(-from.x / offset, -from.y / offset, 0.0)
        } else {
            DVec3::X
        };
        let (near, far) = (DVec2::new(offset - radius, h), DVec2::new(offset + radius, h));
        let (d_near, d_far) = (near.length(), far.length());
        let middle = (near / d_near + far / d_far).normalize();
        let tan_long = 2.0 * radius * h / (d_near * d_far + near.dot(far));
        // Half the chord through the point where the axis meets the disk.
        let beside = h * middle.x / middle.y - offset;
        let tan_short = (radius * radius - beside * beside).max(0.0).sqrt() * middle.y / h;
        let tan2 = DVec2::new(tan_long * tan_long, tan_short * tan_short);
        Self {
            axis: along * middle.x - DVec3::Z * middle.y,
            long: along * middle.y + DVec3::Z * middle.x,
            short: DVec3::new(-along.y, along.x, 0.0),
            tan2,
            drop: DVec2::new(one_minus_cos(tan2.x), one_minus_cos(tan2.y)),
        }
    }

    /// Whether it can be told from nothing.
    #[inline(always)]
    pub(crate) fn is_visible(&self) -> bool {
        self.axis.z < 0.0 && self.tan2.min_element() > 0.0 && self.tan2.is_finite()
    }

    /// A unit direction for a point of the unit disk, with [`SphericalEllipse::pdf`].
    #[inline(always)]
    pub fn sample(&self, p: DVec2) -> DVec3 {
        let stretched = p * DVec2::new(self.drop.x.sqrt(), self.drop.y.sqrt());
        let heading = heading_of(stretched);
        let drop = p.length_squared().min(1.0) * self.limit(heading);
        let sin = (drop * (2.0 - drop)).sqrt();
        self.axis * (1.0 - drop) + (self.long * heading.x + self.short * heading.y) * sin
    }

    /// Density of [`SphericalEllipse::sample`] per solid angle at a unit direction of the cone, for
    /// points that are uniform in the unit disk.
    #[inline(always)]
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let across = DVec2::new(self.long.dot(direction), self.short.dot(direction));
        let heading = heading_of(across);
        let squares = heading * heading;
        // Squared radius of the ellipse, over the product of its half axes, is the density of φ.
        let radius2 = 1.0 / (squares / self.drop).element_sum();
        radius2 / (TAU * (self.drop.x * self.drop.y).sqrt() * self.limit(heading))
    }

    /// 1 - cosine of the angle at which the cone ends in a heading about its axis.
    #[inline(always)]
    fn limit(&self, heading: DVec2) -> f64 {
        one_minus_cos(1.0 / (heading * heading / self.tan2).element_sum())
    }
}

#[inline(always)]
fn heading_of(v: DVec2) -> DVec2 {
    let scale = v.length_recip();
    let is_plain = scale.is_finite() && scale > 0.0;
    if is_plain { v * scale } else { DVec2::X }
}

/// 1 - cosine of an angle below a quarter turn, from its squared tangent.
#[inline(always)]
fn one_minus_cos(tan2: f64) -> f64 {
    let cos2 = 1.0 / (1.0 + tan2);
    tan2 * cos2 / (1.0 + cos2.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;

    fn views() -> impl Iterator<Item = DVec3> {
        [0.0, 0.3, 0.99, 1.0, 1.7, 30.0].into_iter().flat_map(|offset: f64| {
            [1e-4, 0.05, 0.7, 3.0, 200.0].map(|h| DVec3::new(offset * 0.6, offset * -0.8, h))
        })
    }

    /// The rim of the unit disk of numbers goes to the rim of the disk.
    #[test]
    fn the_cone_ends_at_the_rim_of_the_disk() {
        for from in views() {
            let ellipse = SphericalEllipse::new(1.0, from).unwrap();
            for i in 0..24 {
                let (sin, cos) = (f64::from(i) * 0.3).sin_cos();
                let d = ellipse.sample(DVec2::new(cos, sin));
                assert!((d.length() - 1.0).abs() < 1e-12, "{d} from {from}");
                let p = from - d * (from.z / d.z);
                let miss = (DVec2::new(p.x, p.y).length() - 1.0).abs();
                // A small angle reaches far where the plane is seen from the side.
                let reach = from.distance(p).powi(2) / from.z;
                assert!(miss < 1e-12 * reach + 1e-9, "{miss} off the rim from {from}");
            }
        }
    }

    /// 1 / pdf averages to the solid angle, and the density is nearly uniform.
    #[test]
    fn the_density_is_that_of_a_nearly_uniform_map() {
        for from in views() {
            let ellipse = SphericalEllipse::new(1.0, from).unwrap();
            let (n, mut sum, mut least, mut most) = (64, 0.0, f64::INFINITY, 0.0_f64);
            for i in 0..n * n {
                let u = [(i % n) as f32, (i / n) as f32].map(|x| (x + 0.5) / n as f32);
                let inverse = 1.0 / ellipse.pdf(ellipse.sample(warp::square_to_disk(u).as_dvec2()));
                sum += inverse / f64::from(n * n);
                (least, most) = (least.min(inverse), most.max(inverse));
            }
            // In rings about the foot of the perpendicular, by the share of each that is covered.
            let offset = DVec2::new(from.x, from.y).length();
            let (mut expected, rings) = (0.0, 200_000);
            let (first, last) = ((offset - 1.0).max(0.0), offset + 1.0);
            let cos_of = |r: f64| from.z / (r * r + from.z * from.z).sqrt();
            let (top, bottom) = (cos_of(first), cos_of(last));
            for i in 0..rings {
                let cos = bottom + (top - bottom) * (f64::from(i) + 0.5) / f64::from(rings);
                let r = from.z * (1.0 / (cos * cos) - 1.0).sqrt();
                let share = if r + offset <= 1.0 {
                    1.0
                } else {
                    let c = (r * r + offset * offset - 1.0) / (2.0 * r * offset);
                    c.clamp(-1.0, 1.0).acos() / std::f64::consts::PI
                };
                expected += TAU * share * (top - bottom) / f64::from(rings);
            }
            assert!((sum / expected - 1.0).abs() < 2e-3, "{sum}, not {expected} from {from}");
            assert!(most / least < 1.3, "weights from {least} to {most} from {from}");
        }
    }
}

//! From a uniform square to the shapes that light is sampled on, each with its density.
//!
//! Inputs are pairs in [0, 1). All maps preserve the stratification of their input.

use std::f32::consts::{FRAC_PI_4, PI};

use glam::{Vec2, Vec3};

use crate::math::{elementary, portable};

/// Uniform on the unit disk; density 1/π per area.
///
/// Source: P. Shirley and K. Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3), 1997.
#[inline(always)]
pub fn square_to_disk([u, v]: [f32; 2]) -> Vec2 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let is_wide = a.abs() > b.abs();
    let (radius, across) = if is_wide { (a, b) } else { (b, a) };
    let ratio = if radius == 0.0 { 0.0 } else { across / radius };
    let (sin, cos) = elementary::sin_cos_octant(FRAC_PI_4 * ratio);
    let (along, across) = (radius * cos, radius * sin);
    if is_wide { Vec2::new(along, across) } else { Vec2::new(across, along) }
}

/// Cosine-weighted on the upper unit hemisphere; density [`cosine_hemisphere_pdf`].
pub fn square_to_cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let p = square_to_disk(u);
    Vec3::new(p.x, p.y, (1.0 - p.length_squared()).max(0.0).sqrt())
}

/// Density per solid angle of [`square_to_cosine_hemisphere`] at cosine `cos`.
pub fn cosine_hemisphere_pdf(cos: f32) -> f32 {
    cos.max(0.0) / PI
}

/// Uniform on the cap of the unit sphere around +z where 1 - z <= `one_minus_cos` (0..=2);
/// density 1 / (2π `one_minus_cos`) per solid angle. Taking 1 - cos keeps small caps exact.
#[inline(always)]
pub fn square_to_cap(u: [f32; 2], one_minus_cos: f32) -> Vec3 {
    let p = square_to_disk(u);
    let r2 = p.length_squared().min(1.0);
    let drop = one_minus_cos * r2;
    // sin² = drop (2 - drop), and |p|² = r2: no cancellation near the axis.
    let scale = (one_minus_cos * (2.0 - drop)).max(0.0).sqrt();
    Vec3::new(p.x * scale, p.y * scale, 1.0 - drop)
}

/// Uniform on the unit sphere; density 1/4π per solid angle.
pub fn square_to_sphere(u: [f32; 2]) -> Vec3 {
    square_to_cap(u, 2.0)
}

/// Uniform in a regular polygon of `n` corners inscribed in the unit circle, one corner at (0, 1).
#[inline]
pub fn square_to_polygon([u, v]: [f32; 2], n: u32) -> Vec2 {
    let scaled = u * n as f32;
    let side = (scaled as u32).min(n - 1);
    let s = scaled - side as f32;
    let corner = |k: u32| {
        let (sin, cos) = portable::sin_cos(2.0 * PI * (k as f32 / n as f32));
        Vec2::new(sin, cos)
    };
    // Uniform in the triangle (centre, corner, next corner): area grows with the distance squared.
    let radius = v.sqrt();
    radius * ((1.0 - s) * corner(side) + s * corner(side + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: u32) -> impl Iterator<Item = [f32; 2]> {
        (0..n * n)
            .map(move |i| [((i % n) as f32 + 0.5) / n as f32, ((i / n) as f32 + 0.5) / n as f32])
    }

    #[test]
    fn disk_is_uniform() {
        let n = 400;
        let mut moments = [0.0_f64; 3];
        for u in grid(n) {
            let p = square_to_disk(u);
            assert!(p.length() <= 1.0, "{p} leaves the disk");
            moments[0] += f64::from(p.length_squared());
            moments[1] += f64::from(p.length_squared()).powi(2);
            moments[2] += f64::from(p.x * p.y);
        }
        let mean = moments.map(|m| m / f64::from(n * n));
        assert!((mean[0] - 0.5).abs() < 1e-3, "mean of r² is {}", mean[0]);
        assert!((mean[1] - 1.0 / 3.0).abs() < 1e-3, "mean of r⁴ is {}", mean[1]);
        assert!(mean[2].abs() < 1e-3, "mean of xy is {}", mean[2]);
    }

    #[test]
    fn caps_have_their_mean_height_and_unit_length() {
        for one_minus_cos in [2.0, 1.0, 0.1, 1e-9] {
            let n = 100;
            let mut drop = 0.0_f64;
            for u in grid(n) {
                let d = square_to_cap(u, one_minus_cos);
                assert!((d.length() - 1.0).abs() < 1e-6, "{d} at {one_minus_cos}");
                let r2 = f64::from(square_to_disk(u).length_squared());
                drop += f64::from(one_minus_cos) * r2;
            }
            let mean = drop / f64::from(n * n);
            let expected = f64::from(one_minus_cos) / 2.0;
            assert!((mean / expected - 1.0).abs() < 1e-3, "mean drop {mean} at {one_minus_cos}");
        }
    }

    #[test]
    fn polygons_are_uniform_with_a_corner_up() {
        for n in [3, 5, 16] {
            let mut mean = Vec2::ZERO;
            let mut highest = -1.0_f32;
            for u in grid(200) {
                let p = square_to_polygon(u, n);
                assert!(p.length() <= 1.0 + 1e-6, "{p} leaves the circle");
                mean += p / 40_000.0;
                highest = highest.max(p.y);
            }
            assert!(mean.length() < 2e-3, "centre of {n} corners is {mean}");
            assert!(highest > 0.98, "highest point of {n} corners is {highest}");
        }
    }

    /// The mean squared distance from the centre is a sixth of 2 + cos 2π/n: that of two corners and
    /// their product, over the triangle of both and the centre.
    #[test]
    fn polygon_is_uniform() {
        for n in [3, 4, 7] {
            let steps = 210;
            let sum: f64 =
                grid(steps).map(|u| f64::from(square_to_polygon(u, n).length_squared())).sum();
            let mean = sum / f64::from(steps * steps);
            let angle = 2.0 * std::f64::consts::PI / f64::from(n);
            let expected = (2.0 + portable::cos_f64(angle)) / 6.0;
            assert!((mean / expected - 1.0).abs() < 1e-3, "{mean}, not {expected}, of {n} corners");
        }
    }
}

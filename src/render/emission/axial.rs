//! Cones and cylinders that glow, as they are seen from outside.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec3};

use super::Target;
use super::solid::volume_factor;
use crate::math::{Transform, portable, warp};

/// Primitives of a cone or a cylinder, as in the geometry.
const SIDE: usize = 0;
const BASE: usize = 1;
const TOP: usize = 2;

/// A cone or a cylinder in object space, sampled where it faces the point: a part in proportion to
/// its visible area, then the caps uniformly, and the side as it is foreshortened.
#[derive(Debug)]
pub(super) struct Axial {
    base: DVec3,
    /// z along the axis.
    axes: [DVec3; 3],
    height: f64,
    /// At the base and at the end.
    radii: [f64; 2],
    /// Areas of side, base and top in object space.
    parts: [f64; 3],
    transform: Transform,
    volume_factor: f64,
}

impl Axial {
    pub(super) fn new(base: DVec3, end: DVec3, radii: [f64; 2], transform: Transform) -> Self {
        let height = (end - base).length();
        let z = (end - base) / height;
        let x = z.any_orthonormal_vector();
        let slant = (height * height + (radii[0] - radii[1]).powi(2)).sqrt();
        let side = PI * (radii[0] + radii[1]) * slant;
        let parts = [side, PI * radii[0] * radii[0], PI * radii[1] * radii[1]];
        let volume_factor = volume_factor(&transform);
        Self { base, axes: [x, z.cross(x), z], height, radii, parts, transform, volume_factor }
    }

    /// Its whole surface, in object space.
    pub(super) fn area(&self) -> f64 {
        self.parts.iter().sum()
    }

    pub(super) fn transform(&self) -> &Transform {
        &self.transform
    }

    /// In the solid's axes, from its base.
    pub(super) fn seen(&self, from: Vec3) -> DVec3 {
        let p = self.transform.object_from_world_point(from.as_dvec3()) - self.base;
        let [x, y, z] = self.axes;
        DVec3::new(p.dot(x), p.dot(y), p.dot(z))
    }

    /// Radius at a height, continued beyond both ends.
    fn radius_at(&self, z: f64) -> f64 {
        self.radii[0] + (self.radii[1] - self.radii[0]) * (z / self.height)
    }

    pub(super) fn contains(&self, p: DVec3) -> bool {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        (0.0..=self.height).contains(&p.z) && across <= self.radius_at(p.z)
    }

    /// Half the angle, about the axis, of the part of the side that faces a point.
    fn facing(&self, p: DVec3) -> f64 {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        let radius = self.radius_at(p.z);
        if across <= radius.abs() {
            return if radius < 0.0 { PI } else { 0.0 };
        }
        portable::acos_f64(radius / across)
    }

    /// Integral, from the nearest line of the side to that at `angle`, of the distance by which the
    /// point is above the side there: to it the apparent width of the line is proportional.
    fn width_to(&self, p: DVec3, angle: f64) -> f64 {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        across * portable::sin_f64(angle) - self.radius_at(p.z) * angle
    }

    fn width_at(&self, p: DVec3, angle: f64) -> f64 {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        across * portable::cos_f64(angle) - self.radius_at(p.z)
    }

    /// The angle up to which a share of the apparent width lies: by Newton's steps, which never
    /// leave the way there, as the width falls towards the rim.
    fn angle_of(&self, p: DVec3, share: f64) -> f64 {
        let facing = self.facing(p);
        let goal = share * self.width_to(p, facing);
        let mut angle = 0.0;
        for _ in 0..20 {
            let slope = self.width_at(p, angle);
            if slope <= 0.0 {
                break;
            }
            angle = (angle + (goal - self.width_to(p, angle)) / slope).clamp(0.0, facing);
        }
        angle
    }

    /// Visible areas of the parts.
    fn visible(&self, p: DVec3) -> [f64; 3] {
        let seen = |is_seen: bool, area: f64| if is_seen { area } else { 0.0 };
        [
            self.parts[SIDE] * self.facing(p) / PI,
            seen(p.z < 0.0, self.parts[BASE]),
            seen(p.z > self.height, self.parts[TOP]),
        ]
    }

    pub(super) fn sample(&self, from: Vec3, choice: f32, u: [f32; 2]) -> Option<Target> {
        let seen = self.seen(from);
        let visible = self.visible(seen);
        let total: f64 = visible.iter().sum();
        let at = f64::from(choice) * total;
        let part = if at < visible[SIDE] {
            SIDE
        } else if at < visible[SIDE] + visible[BASE] {
            BASE
        } else {
            TOP
        };
        let (place, normal) = if part == SIDE {
            self.on_side(seen, u)
        } else {
            let end = part - BASE;
            let p = warp::square_to_disk(u).as_dvec2() * self.radii[end];
            (p.extend(self.height * end as f64), DVec3::Z * (2.0 * end as f64 - 1.0))
        };
        let object = |v: DVec3| self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z;
        let reach = self.transform.world_from_object_vector(object(place - seen));
        let normal = self.transform.world_from_object_normal(object(normal)).normalize();
        let cos = -normal.dot(reach) / reach.length();
        if !(cos > 0.0 && total > 0.0) {
            return None;
        }
        let of_area = self.area_pdf(seen, place, part as u32, normal.as_vec3());
        let pdf = of_area * reach.length_squared() / cos;
        Some(Target { reach: reach.as_vec3(), normal: normal.as_vec3(), pdf: pdf as f32 })
    }

    /// A point of the side within the angle that faces `seen`, and its outward normal.
    fn on_side(&self, seen: DVec3, [u, v]: [f32; 2]) -> (DVec3, DVec3) {
        let middle = portable::atan2_f64(seen.y, seen.x);
        let share = 2.0 * f64::from(u) - 1.0;
        let angle = middle + self.angle_of(seen, share.abs()).copysign(share);
        let (sin, cos) = (portable::sin_f64(angle), portable::cos_f64(angle));
        let [r0, r1] = self.radii;
        // Area grows with the radius: uniform in its square, where it changes.
        let v = f64::from(v);
        let share = if r0 == r1 {
            v
        } else {
            (r0 - (r0 * r0 + v * (r1 * r1 - r0 * r0)).max(0.0).sqrt()) / (r0 - r1)
        };
        let radius = r0 + (r1 - r0) * share;
        let place = DVec3::new(radius * cos, radius * sin, self.height * share);
        (place, DVec3::new(self.height * cos, self.height * sin, r0 - r1))
    }

    /// Density per area of the world, for points that face `seen`. A linear map M takes an area
    /// with unit normal n to |det M| / |Mᵀ n'| of it, n' the unit normal in the world.
    pub(super) fn area_pdf(&self, seen: DVec3, place: DVec3, primitive: u32, normal: Vec3) -> f64 {
        let visible = self.visible(seen);
        let total: f64 = visible.iter().sum();
        if !visible.get(primitive as usize).is_some_and(|area| *area > 0.0) {
            return 0.0;
        }
        let n = normal.as_dvec3();
        let pulled = DVec3::AXES.map(|axis| self.transform.world_from_object_vector(axis).dot(n));
        let of_object = if primitive as usize == SIDE {
            let (from, to) = (DVec2::new(seen.x, seen.y), DVec2::new(place.x, place.y));
            let cos = from.normalize_or(DVec2::X).dot(to.normalize_or(DVec2::X));
            let angle = portable::acos_f64(cos.clamp(-1.0, 1.0));
            let facing = self.facing(seen);
            self.width_at(seen, angle).max(0.0) * facing / self.width_to(seen, facing)
        } else {
            1.0
        };
        of_object * DVec3::from_array(pulled).length() / (self.volume_factor * total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How far around the side is sampled moves no mean, only noise: up to the lines that are seen edge
    /// on, no further, and half of the apparent width lies between the lines of a quarter and three.
    #[test]
    fn the_side_is_sampled_up_to_its_rim() {
        for radii in [[0.5, 0.5], [0.7, 0.0], [0.7, 0.2]] {
            let axial = Axial::new(DVec3::ZERO, 1.5 * DVec3::Z, radii, Transform::IDENTITY);
            for seen in
                [DVec3::new(2.0, 0.3, 0.5), DVec3::new(-0.4, 0.9, 1.9), DVec3::new(1.6, -0.9, -1.0)]
            {
                let above = |u: f32| {
                    let (place, normal) = axial.on_side(seen, [u, 0.4]);
                    normal.normalize().dot((seen - place).normalize())
                };
                for rim in [0.0, 1.0 - f32::EPSILON] {
                    assert!(above(rim).abs() < 2e-3, "{} at the rim from {seen}", above(rim));
                }
                assert!(above(0.5) > 0.05, "the test can fail: {} from {seen}", above(0.5));
                // The width from the nearest line to that at an angle, as a sum of narrow strips.
                let facing = axial.facing(seen);
                let strips = |angle: f64| {
                    let n = 10_000;
                    let at =
                        |i: i32| axial.width_at(seen, angle * (f64::from(i) + 0.5) / f64::from(n));
                    (0..n).map(at).sum::<f64>() * angle / f64::from(n)
                };
                let half = axial.angle_of(seen, 0.5);
                let share = strips(half) / strips(facing);
                assert!((share - 0.5).abs() < 1e-4, "{share} of the width from {seen}");
            }
        }
    }
}

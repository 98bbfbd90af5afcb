//! What objects can be: meshes, and solids with exact surfaces.
//!
//! Everything here is in object space. Solids are intersected in f64, so that their surfaces are
//! exact to the last bit that a world position can hold; each is convex, and a ray's stay inside is
//! the intersection of intervals, which leaves no gap at rims and edges.

use std::sync::Arc;

use glam::DVec3;

use crate::geometry::mesh_tree::TracedMesh;
use crate::math::Aabb;

/// A shape in object space. Directions are unit vectors, radii above 0.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles.
    Mesh(Arc<TracedMesh>),
    /// A ball.
    Sphere {
        /// Its centre.
        center: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// An infinite plane.
    Plane {
        /// A point on it.
        point: DVec3,
        /// Its unit normal.
        normal: DVec3,
    },
    /// An axis-aligned box.
    Box {
        /// Lower corner.
        min: DVec3,
        /// Upper corner.
        max: DVec3,
    },
    /// A capped cone.
    Cone {
        /// Centre of the base.
        base: DVec3,
        /// Where it ends.
        tip: DVec3,
        /// Radius of the base.
        radius: f64,
    },
    /// A capped cylinder.
    Cylinder {
        /// Centre of the base.
        base: DVec3,
        /// Centre of the top.
        top: DVec3,
        /// Radius of both.
        radius: f64,
    },
}

/// Meshes are equal if they are the same one.
impl PartialEq for Shape {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Mesh(a), Self::Mesh(b)) => Arc::ptr_eq(a, b),
            (Self::Sphere { center: a, radius: r }, Self::Sphere { center: b, radius: s }) => {
                a == b && r == s
            }
            (Self::Plane { point: a, normal: m }, Self::Plane { point: b, normal: n }) => {
                a == b && m == n
            }
            (Self::Box { min: a, max: b }, Self::Box { min: c, max: d }) => a == c && b == d,
            (
                Self::Cone { base: a, tip: b, radius: r },
                Self::Cone { base: c, tip: d, radius: s },
            )
            | (
                Self::Cylinder { base: a, top: b, radius: r },
                Self::Cylinder { base: c, top: d, radius: s },
            ) => a == c && b == d && r == s,
            _ => false,
        }
    }
}

/// Primitives of a cone or a cylinder.
pub(super) const SIDE: u32 = 0;
pub(super) const BASE: u32 = 1;
pub(super) const TOP: u32 = 2;

/// One end of a ray's stay inside a solid: the parameter, and the primitive crossed there.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub(super) t: f64,
    pub(super) primitive: u32,
}

/// A ray's stay inside a convex set.
#[derive(Clone, Copy)]
pub(super) struct Stay {
    pub(super) enter: End,
    pub(super) exit: End,
}

impl Stay {
    #[inline(always)]
    fn everywhere(primitive: u32) -> Self {
        Self::between(f64::NEG_INFINITY, f64::INFINITY, primitive)
    }

    #[inline(always)]
    pub(super) fn between(enter: f64, exit: f64, primitive: u32) -> Self {
        Self { enter: End { t: enter, primitive }, exit: End { t: exit, primitive } }
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        let enter = if other.enter.t > self.enter.t { other.enter } else { self.enter };
        let exit = if other.exit.t < self.exit.t { other.exit } else { self.exit };
        Self { enter, exit }
    }
}

impl Shape {
    /// Bounds in object space, as two corners; `None` for a plane and for a mesh without triangles.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        match self {
            Self::Mesh(mesh) => {
                let Aabb { min, max } = mesh.bounds;
                (!mesh.bounds.is_empty()).then_some([min.as_dvec3(), max.as_dvec3()])
            }
            Self::Sphere { center, radius } => Some([center - *radius, center + *radius]),
            Self::Plane { .. } => None,
            Self::Box { min, max } => Some([*min, *max]),
            Self::Cone { base, tip, radius } => {
                let reach = disk_reach(*tip - *base, *radius);
                Some([(base - reach).min(*tip), (base + reach).max(*tip)])
            }
            Self::Cylinder { base, top, radius } => {
                let reach = disk_reach(*top - *base, *radius);
                Some([base.min(*top) - reach, base.max(*top) + reach])
            }
        }
    }

    /// Whether nothing can be met: a mesh without triangles.
    pub fn is_empty(&self) -> bool {
        matches!(self, Self::Mesh(mesh) if mesh.bounds.is_empty())
    }

    /// Parameters at which a line crosses a solid's surface, with the primitive crossed; meshes
    /// have none here. At most two.
    pub fn crossings(&self, origin: DVec3, direction: DVec3) -> [Option<(f64, u32)>; 2] {
        let stay = match self {
            Self::Mesh(_) => None,
            Self::Plane { point, normal } => {
                let t = plane_root(origin, direction, *point, *normal);
                return [t.is_finite().then_some((t, 0)), None];
            }
            Self::Sphere { center, radius } => in_sphere(origin - *center, direction, *radius),
            Self::Box { min, max } => Some(in_box(*min - origin, *max - origin, direction)),
            Self::Cylinder { base, top, radius } => {
                let axis = *top - *base;
                let height = axis.length();
                let local = Axial::new(origin - *base, direction, axis / height);
                local.in_slab(height).and_then(|slab| {
                    let a = local.across_d.length_squared();
                    let b = local.across_o.dot(local.across_d);
                    let c = local.across_o.length_squared() - radius * radius;
                    Some(slab.and(below_zero(a, b, c, SIDE)?))
                })
            }
            Self::Cone { base, tip, radius } => {
                let axis = *tip - *base;
                let height = axis.length();
                let local = Axial::new(origin - *base, direction, axis / height);
                local
                    .in_slab(height)
                    .and_then(|slab| Some(slab.and(local.in_cone(height, *radius)?)))
            }
        };
        match stay {
            Some(Stay { enter, exit }) if enter.t <= exit.t => [
                enter.t.is_finite().then_some((enter.t, enter.primitive)),
                exit.t.is_finite().then_some((exit.t, exit.primitive)),
            ],
            _ => [None, None],
        }
    }
}

/// Half extents of a disk's bounds.
fn disk_reach(axis: DVec3, radius: f64) -> DVec3 {
    let w = axis.normalize();
    (DVec3::ONE - w * w).max(DVec3::ZERO).map(f64::sqrt) * radius
}

/// Discriminant (below 0 at a miss) and the parameters at which a line crosses a sphere, in no order.
/// `f` is the origin as seen from the centre.
///
/// Source: E. Haines, J. Günther and T. Akenine-Möller, "Precision Improvements for Ray/Sphere
/// Intersection", Ray Tracing Gems, 2019, chapter 7.
#[inline(always)]
pub(super) fn sphere_roots(f: DVec3, d: DVec3, radius: f64) -> (f64, f64, f64) {
    let a = d.length_squared();
    let b = -f.dot(d);
    let miss = f + d * (b / a);
    let discriminant = radius * radius - miss.length_squared();
    let c = f.length_squared() - radius * radius;
    let q = b + (a * discriminant).sqrt().copysign(b);
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
    (discriminant, t0, t1)
}

fn in_sphere(f: DVec3, d: DVec3, radius: f64) -> Option<Stay> {
    let (discriminant, t0, t1) = sphere_roots(f, d, radius);
    (discriminant >= 0.0).then(|| Stay::between(t0.min(t1), t0.max(t1), 0))
}

/// Parameter at which a line crosses a plane; not finite where it is parallel.
#[inline(always)]
pub(super) fn plane_root(origin: DVec3, direction: DVec3, point: DVec3, normal: DVec3) -> f64 {
    (point - origin).dot(normal) / direction.dot(normal)
}

/// `low` and `high` are the corners as seen from the ray's origin. Faces are numbered -x, +x, -y, …
#[inline(always)]
pub(super) fn in_box(low: DVec3, high: DVec3, d: DVec3) -> Stay {
    let mut stay = Stay::everywhere(0);
    for axis in 0..3 {
        let primitive = 2 * axis as u32;
        let below = End { t: low[axis] / d[axis], primitive };
        let above = End { t: high[axis] / d[axis], primitive: primitive + 1 };
        let is_along = d[axis] > 0.0;
        let (enter, exit) =
            (if is_along { below } else { above }, if is_along { above } else { below });
        // A ray along the faces is between them everywhere or nowhere.
        let is_across = d[axis] == 0.0;
        let is_between = low[axis] <= 0.0 && high[axis] >= 0.0;
        let limit = if is_between { f64::INFINITY } else { f64::NEG_INFINITY };
        let enter = End { t: if is_across { -limit } else { enter.t }, ..enter };
        let exit = End { t: if is_across { limit } else { exit.t }, ..exit };
        stay = stay.and(Stay { enter, exit });
    }
    stay
}

/// A ray split into its part along an axis and its part across it.
struct Axial {
    along_o: f64,
    along_d: f64,
    across_o: DVec3,
    across_d: DVec3,
}

impl Axial {
    fn new(origin: DVec3, direction: DVec3, axis: DVec3) -> Self {
        let (along_o, along_d) = (origin.dot(axis), direction.dot(axis));
        Self {
            along_o,
            along_d,
            across_o: origin - axis * along_o,
            across_d: direction - axis * along_d,
        }
    }

    /// Between the base and the top.
    fn in_slab(&self, height: f64) -> Option<Stay> {
        if self.along_d == 0.0 {
            let is_inside = (0.0..=height).contains(&self.along_o);
            return is_inside.then_some(Stay::everywhere(SIDE));
        }
        let base = End { t: -self.along_o / self.along_d, primitive: BASE };
        let top = End { t: (height - self.along_o) / self.along_d, primitive: TOP };
        let (enter, exit) = if self.along_d > 0.0 { (base, top) } else { (top, base) };
        Some(Stay { enter, exit })
    }

    /// In the nappe below the tip of a cone; to be cut by the slab.
    fn in_cone(&self, height: f64, radius: f64) -> Option<Stay> {
        let slope2 = (radius / height).powi(2);
        let to_tip = height - self.along_o;
        let a = self.across_d.length_squared() - slope2 * self.along_d * self.along_d;
        let b = self.across_o.dot(self.across_d) + slope2 * to_tip * self.along_d;
        let c = self.across_o.length_squared() - slope2 * to_tip * to_tip;
        if a > 0.0 {
            return below_zero(a, b, c, SIDE);
        }
        // A steep ray is inside up to one root (where it leaves upwards) or from the other on.
        let discriminant = (b * b - a * c).max(0.0);
        let q = -b - discriminant.sqrt().copysign(b);
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
        let (low, high) = (t0.min(t1), t0.max(t1));
        Some(if self.along_d > 0.0 {
            Stay::between(f64::NEG_INFINITY, low, SIDE)
        } else {
            Stay::between(high, f64::INFINITY, SIDE)
        })
    }
}

/// Where a t² + 2 b t + c <= 0, for a >= 0.
fn below_zero(a: f64, b: f64, c: f64, primitive: u32) -> Option<Stay> {
    if a == 0.0 {
        return (c <= 0.0).then_some(Stay::everywhere(primitive));
    }
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = -b - discriminant.sqrt().copysign(b);
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
    Some(Stay::between(t0.min(t1), t0.max(t1), primitive))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A crossing lies on the surface, and just inside and outside differ.
    fn check(shape: &Shape, inside: impl Fn(DVec3) -> f64) {
        let mut n_hits = 0;
        for i in 0..4000 {
            let f = f64::from(i);
            let origin = 5.0 * DVec3::new((f * 0.7).sin(), (f * 1.3).sin(), (f * 0.9).cos());
            let target = 1.2 * DVec3::new((f * 2.1).sin(), (f * 0.37).cos(), (f * 1.7).sin());
            let direction = target - origin;
            let crossings = shape.crossings(origin, direction);
            let mut previous = f64::NEG_INFINITY;
            for (t, _) in crossings.into_iter().flatten() {
                n_hits += 1;
                let p = origin + direction * t;
                assert!(inside(p).abs() < 1e-9, "{shape:?}: {p} is {} off", inside(p));
                assert!(t >= previous, "{shape:?}: crossings out of order");
                previous = t;
            }
            // Brute force: the line is inside somewhere exactly when there are crossings.
            let meets =
                (0..=4000).any(|k| inside(origin + direction * (f64::from(k) * 5e-4)) < -0.01);
            assert!(!meets || crossings[1].is_some(), "{shape:?}: missed ray {i}");
        }
        assert!(n_hits > 500, "{shape:?}: only {n_hits} crossings");
    }

    #[test]
    fn solids_are_met_on_their_surface_and_never_missed() {
        check(&Shape::Sphere { center: DVec3::ZERO, radius: 1.0 }, |p| p.length() - 1.0);
        let half = DVec3::new(0.5, 1.0, 0.7);
        check(&Shape::Box { min: -half, max: half }, |p| (p.abs() - half).max_element());
        let (base, top) = (DVec3::new(0.0, -0.5, 0.0), DVec3::new(0.0, 0.8, 0.0));
        check(&Shape::Cylinder { base, top, radius: 0.6 }, |p| {
            let side = (p.x * p.x + p.z * p.z).sqrt() - 0.6;
            side.max(p.y - 0.8).max(-0.5 - p.y)
        });
        check(&Shape::Cone { base, tip: top, radius: 0.6 }, |p| {
            let side = (p.x * p.x + p.z * p.z).sqrt() - 0.6 * (0.8 - p.y) / 1.3;
            side.max(p.y - 0.8).max(-0.5 - p.y)
        });
    }

    #[test]
    fn bounds_of_tilted_solids_are_tight() {
        let shape =
            Shape::Cylinder { base: DVec3::ZERO, top: DVec3::new(1.0, 1.0, 0.0), radius: 1.0 };
        let [min, max] = shape.bounds().unwrap();
        let reach = 0.5_f64.sqrt();
        assert!((min - DVec3::new(-reach, -reach, -1.0)).length() < 1e-12, "{min}");
        assert!((max - DVec3::new(1.0 + reach, 1.0 + reach, 1.0)).length() < 1e-12, "{max}");
    }
}

//! Where the rays of a block cross a solid, in lanes; the formulas are those of a single ray.

use glam::DVec3;

use crate::geometry::Shape;
use crate::geometry::shape::{Stay, in_box, plane_root, sphere_roots};
use crate::math::vectorized::{BLOCK, DLane3, Lane, dvec3, vectorized};

/// What [`Shape::crossings`] finds for a block of rays: parameters, NaN where there is none, and
/// primitives.
pub(super) struct Crossings {
    pub(super) t: [Lane<f32>; 2],
    pub(super) primitive: [Lane<u32>; 2],
}

impl Crossings {
    /// Nothing found.
    pub(super) const NONE: Self = Self { t: [[f32::NAN; BLOCK]; 2], primitive: [[0; BLOCK]; 2] };

    #[inline(always)]
    fn set(&mut self, i: usize, stay: Stay) {
        let Stay { enter, exit } = stay;
        let is_met = enter.t <= exit.t;
        for (k, end) in [enter, exit].into_iter().enumerate() {
            let is_found = is_met && end.t.is_finite();
            self.t[k][i] = if is_found { end.t as f32 } else { f32::NAN };
            self.primitive[k][i] = end.primitive;
        }
    }
}

impl Shape {
    /// [`Shape::crossings`] for a block of rays in object space.
    pub(super) fn crossings_of_block(&self, rays: &ObjectRays, crossings: &mut Crossings) {
        match self {
            Self::Mesh(_) => {}
            Self::Plane { point, normal } => plane_crossings(*point, *normal, rays, crossings),
            Self::Sphere { center, radius } => sphere_crossings(*center, *radius, rays, crossings),
            Self::Box { min, max } => box_crossings(*min, *max, rays, crossings),
            Self::Cone { .. } | Self::Cylinder { .. } => {
                for i in 0..BLOCK {
                    let (origin, direction) = (dvec3(&rays.origin, i), dvec3(&rays.direction, i));
                    for (k, crossing) in self.crossings(origin, direction).into_iter().enumerate() {
                        let (t, primitive) = crossing.unwrap_or((f64::NAN, 0));
                        (crossings.t[k][i], crossings.primitive[k][i]) = (t as f32, primitive);
                    }
                }
            }
        }
    }
}

/// A block of rays in object space.
pub(super) struct ObjectRays {
    pub(super) origin: DLane3,
    pub(super) direction: DLane3,
}

vectorized! {
    fn plane_crossings(
        point: DVec3,
        normal: DVec3,
        rays: &ObjectRays,
        crossings: &mut Crossings,
    ) {
        for i in 0..BLOCK {
            let t = plane_root(dvec3(&rays.origin, i), dvec3(&rays.direction, i), point, normal);
            crossings.t[0][i] = if t.is_finite() { t as f32 } else { f32::NAN };
        }
    }
    fn sphere_crossings(
        center: DVec3,
        radius: f64,
        rays: &ObjectRays,
        crossings: &mut Crossings,
    ) {
        for i in 0..BLOCK {
            let (origin, direction) = (dvec3(&rays.origin, i), dvec3(&rays.direction, i));
            let (discriminant, t0, t1) = sphere_roots(origin - center, direction, radius);
            let (enter, exit) = (t0.min(t1), t0.max(t1));
            let limit = if discriminant >= 0.0 { exit } else { f64::NEG_INFINITY };
            crossings.set(i, Stay::between(enter, limit, 0));
        }
    }
    fn box_crossings(min: DVec3, max: DVec3, rays: &ObjectRays, crossings: &mut Crossings) {
        for i in 0..BLOCK {
            let (origin, direction) = (dvec3(&rays.origin, i), dvec3(&rays.direction, i));
            crossings.set(i, in_box(min - origin, max - origin, direction));
        }
    }
}

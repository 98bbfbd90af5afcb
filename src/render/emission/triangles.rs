//! Triangles that glow, on both sides, chosen in proportion to the light that they send out.

use glam::{DVec3, Vec3};

use super::Target;
use crate::geometry::Instance;
use crate::geometry::mesh::Mesh;
use crate::math::distribution::Distribution;

/// The triangles of one mesh that emit light.
#[derive(Debug)]
pub(super) struct Triangles {
    ids: Vec<u32>,
    /// Corners in the world, in f64 only on their way: they are as exact as rays are.
    corners: Vec<[Vec3; 3]>,
    /// Area times luminance.
    power: Distribution,
}

impl Triangles {
    /// `luminance` is that of a slot's emission. `None` where nothing emits.
    pub(super) fn new(
        instance: &Instance,
        mesh: &Mesh,
        luminance: impl Fn(u32) -> f32,
    ) -> Option<Self> {
        let mut found =
            Self { ids: Vec::new(), corners: Vec::new(), power: Distribution::default() };
        let mut powers = Vec::new();
        for id in 0..mesh.triangles.len() as u32 {
            let luminance = luminance(mesh.slots.get(id as usize).copied().unwrap_or(0));
            let place = |p: Vec3| instance.transform().world_from_object_point(p.as_dvec3());
            let corners = mesh.corners(id).map(place);
            let power = double_area(corners).length() as f32 * 0.5 * luminance;
            if power > 0.0 && power.is_finite() {
                found.ids.push(id);
                found.corners.push(corners.map(|p| p.as_vec3()));
                powers.push(power);
            }
        }
        found.power = Distribution::new(powers);
        (found.power.total() > 0.0).then_some(found)
    }

    /// Sum of area times luminance.
    pub(super) fn total(&self) -> f64 {
        self.power.total()
    }

    /// A way to a point of one of them, and which triangle of the mesh it is.
    pub(super) fn sample(
        &self,
        from: Vec3,
        choice: f32,
        [u, v]: [f32; 2],
    ) -> Option<(Target, u32)> {
        let (index, _) = self.power.sample(choice)?;
        let [a, b, c] = self.corners[index].map(Vec3::as_dvec3);
        let root = f64::from(u).sqrt();
        let (s, t) = (root * (1.0 - f64::from(v)), root * f64::from(v));
        let reach = a + (b - a) * s + (c - a) * t - from.as_dvec3();
        let cross = double_area([a, b, c]);
        let double_area = cross.length();
        let distance2 = reach.length_squared();
        let side = if cross.dot(reach) > 0.0 { -1.0 } else { 1.0 };
        let normal = cross * (side / double_area);
        let cos = -normal.dot(reach) / distance2.sqrt();
        let of_area = self.power.share(index) / (0.5 * double_area);
        let pdf = (of_area * distance2 / cos) as f32;
        let target = Target { reach: reach.as_vec3(), normal: normal.as_vec3(), pdf };
        (cos > 0.0).then_some((target, self.ids[index]))
    }

    /// Density per solid angle with which [`Triangles::sample`] finds a triangle of that luminance
    /// and normal, met along the unit `direction` at the distance `t`.
    pub(super) fn pdf(&self, luminance: f32, direction: Vec3, t: f32, normal: Vec3) -> f32 {
        let cos = f64::from(normal.dot(direction).abs());
        let of_area = f64::from(luminance) / self.power.total();
        if cos > 0.0 { (of_area * f64::from(t).powi(2) / cos) as f32 } else { 0.0 }
    }
}

fn double_area([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

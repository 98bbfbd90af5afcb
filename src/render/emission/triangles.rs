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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::{Shape, TracedMesh};
    use crate::math::Transform;

    /// Moments of points uniform in a triangle: with its corners as a + x and a + y, means of a third,
    /// mean squares of a sixth, mean products of a twelfth.
    #[test]
    fn triangles_are_sampled_uniformly() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let mesh = Arc::new(TracedMesh::new(mesh));
        let instance = Instance::new(Shape::Mesh(Arc::clone(&mesh)), Transform::IDENTITY);
        let triangles = Triangles::new(&instance, &mesh.mesh, |_| 1.0).unwrap();
        let (from, n) = (Vec3::new(0.2, 0.3, 2.0), 200_u16);
        let mut moments = [0.0_f64; 5];
        for i in 0..n {
            for j in 0..n {
                let u = [i, j].map(|k| (f32::from(k) + 0.5) / f32::from(n));
                let (target, _) = triangles.sample(from, 0.5, u).unwrap();
                let p = (from + target.reach).as_dvec3();
                let terms = [p.x, p.y, p.x * p.x, p.y * p.y, p.x * p.y];
                moments.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
        }
        let means = moments.map(|sum| sum / f64::from(n).powi(2));
        let expected = [1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 12.0];
        for (found, expected) in means.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 2e-3, "{found}, not {expected}");
        }
    }
}

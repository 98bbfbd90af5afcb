//! The true bounds of what is in the world, as people want to read them: exact for every shape at
//! any place, where an accelerator is content with a box around a turned box.

use std::sync::Arc;

use glam::DVec3;

use crate::geometry::{Geometry, Instance, Shape};
use crate::math::Transform;

/// Two opposite corners.
type Extent = [DVec3; 2];

impl Geometry {
    /// The smallest box around every bounded object; `None` without any.
    pub fn extent(&self) -> Option<Extent> {
        let instances = self.instances();
        // Copies in the same place, of which there may be thousands, are measured once.
        let is_new = |(index, instance): &(usize, &Instance)| {
            *index == 0 || !instance.is_copy_of(&instances[index - 1])
        };
        let new = instances.iter().enumerate().filter(is_new);
        new.filter_map(|(_, instance)| instance.extent()).reduce(union)
    }
}

impl Instance {
    /// Whether it is the same mesh in the same place.
    fn is_copy_of(&self, other: &Self) -> bool {
        let (Shape::Mesh(mesh), Shape::Mesh(others)) = (self.shape(), other.shape()) else {
            return false;
        };
        Arc::ptr_eq(mesh, others) && self.transform() == other.transform()
    }

    /// The smallest box around it in the world; `None` where it is infinite or empty.
    pub fn extent(&self) -> Option<Extent> {
        let transform = self.transform();
        let world = |p: DVec3| transform.world_from_object_point(p);
        match self.shape() {
            Shape::Mesh(mesh) => {
                let mesh = &mesh.mesh;
                let corners = mesh.triangles.iter().flatten();
                let points = corners.map(|id| world(mesh.positions[*id as usize].as_dvec3()));
                points.map(|p| [p, p]).reduce(union)
            }
            Shape::Sphere { center, radius } => {
                let reach = rows(transform).map(|row| row.length() * radius);
                Some(around(world(*center), reach))
            }
            Shape::Plane { .. } => None,
            Shape::Box { min, max } => {
                let corner = |i: u32| {
                    let pick = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
                    world(DVec3::new(pick(0), pick(1), pick(2)))
                };
                (0..8).map(corner).map(|p| [p, p]).reduce(union)
            }
            Shape::Cone { base, tip, radius } => {
                let tip_in_world = world(*tip);
                let reach = disk_reach(transform, *tip - *base, *radius);
                Some(union(around(world(*base), reach), [tip_in_world, tip_in_world]))
            }
            Shape::Cylinder { base, top, radius } => {
                let reach = disk_reach(transform, *top - *base, *radius);
                Some(union(around(world(*base), reach), around(world(*top), reach)))
            }
        }
    }
}

fn union(a: Extent, b: Extent) -> Extent {
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn around(center: DVec3, reach: [f64; 3]) -> Extent {
    let reach = DVec3::from_array(reach);
    [center - reach, center + reach]
}

/// The rows of a transform's linear part: each says how a world axis sees the object's vectors.
fn rows(transform: &Transform) -> [DVec3; 3] {
    let [x, y, z] = DVec3::AXES.map(|axis| transform.world_from_object_vector(axis));
    [0, 1, 2].map(|axis| DVec3::new(x[axis], y[axis], z[axis]))
}

/// How far a disk across `axis` reaches along each world axis.
fn disk_reach(transform: &Transform, axis: DVec3, radius: f64) -> [f64; 3] {
    let axis = axis.normalize_or_zero();
    rows(transform).map(|row| (row - axis * row.dot(axis)).length() * radius)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::mesh::Mesh;
    use crate::geometry::{AcceleratorKind, TracedMesh};

    const TURNED: DVec3 = DVec3::new(20.0, 45.0, -70.0);

    fn assert_near(found: Option<Extent>, expected: Extent, what: &str) {
        let found = found.expect(what);
        let error = (found[0] - expected[0]).abs().max((found[1] - expected[1]).abs());
        assert!(error.max_element() < 1e-9, "{what}: {found:?}, not {expected:?}");
    }

    #[test]
    fn solids_are_bounded_as_closely_as_their_surface_points() {
        let at = Transform::new(DVec3::new(1.0, 2.0, 3.0), TURNED, DVec3::new(1.0, -2.0, 0.5));
        let (base, top) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.5, 1.7, -0.4));
        let w = (top - base).normalize();
        let u = w.any_orthonormal_vector();
        let v = w.cross(u);
        let circle = |center: DVec3| {
            (0..200_000).map(move |i| {
                let angle = f64::from(i) * std::f64::consts::TAU / 200_000.0;
                center + 0.7 * (u * angle.cos() + v * angle.sin())
            })
        };
        let sampled = |points: &mut dyn Iterator<Item = DVec3>| {
            let world = points.map(|p| at.world_from_object_point(p));
            world.map(|p| [p, p]).reduce(union).unwrap()
        };
        let found = |shape: Shape| Instance::new(shape, at).extent();
        assert_near(
            found(Shape::Cylinder { base, top, radius: 0.7 }),
            sampled(&mut circle(base).chain(circle(top))),
            "cylinder",
        );
        assert_near(
            found(Shape::Cone { base, tip: top, radius: 0.7 }),
            sampled(&mut circle(base).chain([top])),
            "cone",
        );
        let corners = [base, top].map(|p| at.world_from_object_point(p));
        let found_box = found(Shape::Box { min: base.min(top), max: base.max(top) }).unwrap();
        for corner in corners {
            let is_inside = corner.cmpge(found_box[0]).all() && corner.cmple(found_box[1]).all();
            assert!(is_inside, "{corner} is outside {found_box:?}");
        }
    }

    /// Copies of a mesh count wherever they are, and other meshes in the place of one.
    #[test]
    fn only_a_copy_in_the_same_place_is_passed_over() {
        let triangle = |x: f32| {
            let positions = vec![Vec3::ZERO, Vec3::new(x, 0.0, 0.0), Vec3::new(0.0, x, 0.0)];
            let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
            Shape::Mesh(Arc::new(TracedMesh::new(mesh)))
        };
        let (small, large) = (triangle(1.0), triangle(2.0));
        let at = |x: f64| Transform::new(DVec3::new(x, 0.0, 0.0), DVec3::ZERO, DVec3::ONE);
        let instance = |shape: &Shape, x: f64| Instance::new(shape.clone(), at(x));
        let instances = vec![instance(&small, 0.0), instance(&small, 0.0), instance(&small, 5.0)];
        let extent = |instances| Geometry::new(instances, AcceleratorKind::default()).extent();
        let copies = extent(instances.clone());
        assert_near(copies, [DVec3::ZERO, DVec3::new(6.0, 1.0, 0.0)], "copies");
        let with_large = [instances, vec![instance(&large, 5.0)]].concat();
        assert_near(extent(with_large), [DVec3::ZERO, DVec3::new(7.0, 2.0, 0.0)], "another mesh");
    }

    #[test]
    fn a_turned_ball_keeps_its_bounds() {
        let at = Transform::new(DVec3::X, TURNED, DVec3::splat(2.0));
        let ball = Instance::new(Shape::Sphere { center: DVec3::ZERO, radius: 1.5 }, at);
        assert_near(
            ball.extent(),
            [DVec3::X - DVec3::splat(3.0), DVec3::X + DVec3::splat(3.0)],
            "ball",
        );
        let plane = Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y };
        assert_eq!(Instance::new(plane, at).extent(), None, "a plane has no end");
    }
}

//! Blocks of hits against single hits.

use std::sync::Arc;

use glam::Vec3;

use super::*;
use crate::geometry::{AcceleratorKind, Instance, TracedMesh};
use crate::math::vectorized::at_every_level;

/// Two triangles, one of them smooth.
fn mesh() -> Shape {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(0.9, 1.1, 0.2), Vec3::Y];
    let tilted = |x: f32, y: f32| Vec3::new(x, y, 1.0).normalize();
    Shape::Mesh(Arc::new(TracedMesh::new(Mesh {
        positions,
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: vec![tilted(0.1, 0.2), tilted(-0.3, 0.1), tilted(0.2, -0.2)],
        normal_ids: vec![[0, 1, 2], [ABSENT; 3]],
        ..Mesh::default()
    })))
}

fn shapes() -> Vec<Shape> {
    let (a, b) = (DVec3::new(0.1, 0.2, -0.4), DVec3::new(0.9, 1.0, 0.5));
    vec![
        mesh(),
        Shape::Sphere { center: DVec3::new(0.5, 0.4, 0.0), radius: 0.6 },
        Shape::Plane { point: a, normal: (b - a).normalize() },
        Shape::Box { min: a, max: b },
        Shape::Cone { base: a, tip: b, radius: 0.5 },
        Shape::Cylinder { base: a, top: b, radius: 0.5 },
    ]
}

#[test]
fn a_block_of_hits_has_the_surfaces_of_its_hits() {
    let moved = Transform::new(
        DVec3::new(3.0, -2.0, 0.7),
        DVec3::new(20.0, 130.0, -50.0),
        DVec3::new(1.5, -0.7, 2.0),
    );
    for (shape, transform) in shapes()
        .into_iter()
        .flat_map(|shape| [(shape.clone(), Transform::IDENTITY), (shape, moved)])
    {
        let name = format!("{shape:?} at {transform:?}");
        let instance = Instance::new(shape, transform);
        let geometry = Geometry::new(vec![instance], AcceleratorKind::BruteForce);
        let mut rays = RayBatch::default();
        for i in 0..400 {
            let (x, y) = (f64::from(i % 20) / 16.0 - 0.1, f64::from(i / 20) / 16.0 - 0.1);
            let from = transform.world_from_object_point(DVec3::new(y, x * x, 3.0));
            let to = transform.world_from_object_point(DVec3::new(x, y, 0.0));
            rays.push(Ray::new(from.as_vec3(), (to - from).as_vec3()));
        }
        let mut hits = Vec::new();
        geometry.intersect(&rays, &mut hits);
        let met: Vec<(usize, Hit)> =
            hits.iter().enumerate().filter_map(|(i, near)| Some((i, near.hit()?))).collect();
        assert!(met.len() > BLOCK, "{name} is met {} times", met.len());
        for part in met.chunks_exact(BLOCK) {
            let mut block = HitBlock::EMPTY;
            for (i, (place, hit)) in part.iter().enumerate() {
                block.set(i, &rays, *place, *hit);
            }
            let at = |needs_uv| {
                let mut surfaces = SurfaceBlock::EMPTY;
                geometry.surfaces(0, &block, needs_uv, &mut surfaces);
                surfaces
            };
            for (level, [found, with_uv]) in at_every_level(|| [false, true].map(at)) {
                for (i, (place, hit)) in part.iter().enumerate() {
                    let one = geometry.surface(&rays.ray(*place), *hit);
                    let of_block = found.surface(i);
                    let rest = Surface { slot: one.slot, ..with_uv.surface(i) };
                    assert_eq!(format!("{rest:?}"), format!("{one:?}"), "{level:?}, {name}");
                    let figures = |s: &Surface| {
                        (s.point, s.normal, s.object_point, s.object_normal, s.clearance)
                    };
                    assert_eq!(figures(&of_block), figures(&one), "{level:?}, {name}");
                    assert_eq!(of_block.source, one.source, "{level:?}, {name}");
                }
            }
        }
    }
}

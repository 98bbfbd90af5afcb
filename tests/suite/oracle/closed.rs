//! Closed meshes let nothing out.

use glam::{DVec3, Vec3};
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, Geometry, Instance};
use penumbra::math::{Ray, RayBatch, Transform};

use crate::common::{Numbers, icosphere};
use crate::oracle::rays::mesh_of;

/// Rays from inside a closed mesh always meet it, wherever it is and however large.
#[test]
fn nothing_escapes_from_closed_meshes() {
    let cube = |scale: f32, center: Vec3| {
        let corner = |i: u32| {
            let sign = |bit: u32| if i & bit == 0 { -scale } else { scale };
            Vec3::new(sign(1), sign(2), sign(4)) + center
        };
        let faces =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        Mesh {
            positions: (0..8).map(corner).collect(),
            triangles: triangles.collect(),
            ..Mesh::default()
        }
    };
    let far = Vec3::new(1e4, -3e3, 7e3);
    let cases = [
        (icosphere(3, 1.0, Vec3::ZERO), 1.0, Vec3::ZERO),
        (icosphere(4, 1e-3, Vec3::ZERO), 1e-3, Vec3::ZERO),
        (icosphere(4, 1e6, Vec3::ZERO), 1e6, Vec3::ZERO),
        (icosphere(4, 1.0, far), 1.0, far),
        (cube(1.0, Vec3::ZERO), 1.0, Vec3::ZERO),
        (cube(1e6, Vec3::splat(-4e5)), 1e6, Vec3::splat(-4e5)),
    ];
    let mut numbers = Numbers::new(5);
    for (i, (mesh, scale, center)) in cases.into_iter().enumerate() {
        let corners = mesh.positions.clone();
        let shape = mesh_of(mesh.positions, mesh.triangles);
        let turned = Transform::new(
            DVec3::new(0.3, 1.0, -2.0) * f64::from(scale),
            DVec3::new(20.0, 30.0, 40.0),
            DVec3::new(1.0, -1.5, 2.0),
        );
        for transform in [Transform::IDENTITY, turned] {
            let place = |p: Vec3| transform.world_from_object_point(p.as_dvec3()).as_vec3();
            let mut rays = RayBatch::default();
            for k in 0..60_000 {
                let inside = center + numbers.direction().as_vec3() * 0.5 * scale;
                let origin = place(inside);
                // A third each: anywhere, to a corner, to the middle of two corners.
                let mut pick = || corners[(numbers.next() * corners.len() as f64) as usize];
                let to_corner = place(pick()) - origin;
                let between = place(pick().midpoint(pick())) - origin;
                let direction = match k % 3 {
                    0 => numbers.direction().as_vec3(),
                    1 => to_corner,
                    _ if between.length() > 1e-3 * scale => between,
                    _ => to_corner,
                };
                rays.push(Ray::new(origin, direction));
            }
            for kind in [AcceleratorKind::WideBvh, AcceleratorKind::KdTree] {
                let instance = Instance::new(shape.clone(), transform);
                let geometry = Geometry::new(vec![instance], kind);
                let mut hits = Vec::new();
                geometry.intersect(&rays, &mut hits);
                let escaped = hits.iter().filter(|hit| !hit.is_hit()).count();
                assert_eq!(escaped, 0, "case {i}: rays escaped of {}, {}", rays.len(), kind.name());
            }
        }
    }
}

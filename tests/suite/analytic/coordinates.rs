//! Texture coordinates of every shape: their formulas, and their gradients by differences.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2};
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, Geometry, Instance, Shape, Surface, TracedMesh};
use penumbra::math::{Ray, RayBatch, Transform};

use crate::common::Numbers;

/// The surface of a shape where a ray first meets it, in its own space.
fn surface(geometry: &Geometry, origin: DVec3, direction: DVec3) -> Option<Surface> {
    let ray = Ray::new(origin.as_vec3(), direction.as_vec3());
    let mut rays = RayBatch::default();
    rays.push(ray);
    let mut hits = Vec::new();
    geometry.intersect(&rays, &mut hits);
    hits[0].hit().map(|hit| geometry.surface(&ray, hit))
}

fn alone(shape: Shape) -> Geometry {
    Geometry::new(vec![Instance::new(shape, Transform::IDENTITY)], AcceleratorKind::BruteForce)
}

/// Two triangles of different slant, u and v stretched and skewed.
fn sheet() -> Shape {
    let corner = |x, y, z| glam::Vec3::new(x, y, z);
    Shape::Mesh(Arc::new(TracedMesh::new(Mesh {
        positions: vec![
            corner(-1.0, -0.8, 0.1),
            corner(1.0, -1.0, 0.3),
            corner(0.9, 1.0, -0.2),
            corner(-1.1, 0.9, 0.6),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: vec![
            Vec2::new(0.1, 0.2),
            Vec2::new(1.7, -0.3),
            Vec2::new(1.2, 0.8),
            Vec2::new(-0.4, 1.9),
        ],
        uv_ids: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    })))
}

fn shapes() -> Vec<(&'static str, Shape)> {
    let center = DVec3::new(0.2, -0.1, 0.3);
    let axis = DVec3::new(0.3, 1.1, -0.4);
    let (base, radius) = (center - 0.6 * axis, 0.7);
    let normal = DVec3::new(0.3, 1.0, -0.2).normalize();
    vec![
        ("sphere", Shape::Sphere { center, radius: 0.9 }),
        ("plane", Shape::Plane { point: center, normal }),
        ("box", Shape::Box { min: DVec3::new(-0.7, -0.4, -0.9), max: DVec3::new(0.8, 0.9, 0.5) }),
        ("cone", Shape::Cone { base, tip: base + 1.4 * axis, radius }),
        ("cylinder", Shape::Cylinder { base, top: base + axis, radius }),
        ("mesh", sheet()),
    ]
}

/// What a step along the surface does to u and v is what their gradients say.
#[test]
fn uv_gradients_are_the_slopes_of_uv_on_every_shape() {
    const STEP: f64 = 2e-3;
    for (name, shape) in shapes() {
        let geometry = alone(shape);
        let mut numbers = Numbers::new(3);
        let mut n_checked = 0;
        while n_checked < 400 {
            let origin = numbers.direction() * 4.0;
            let direction = (numbers.direction() * 0.9 - origin).normalize();
            let Some(here) = surface(&geometry, origin, direction) else { continue };
            let step = numbers.direction() * STEP;
            let Some(there) = surface(&geometry, origin + step, direction) else { continue };
            let moved = there.object_point - here.object_point;
            let is_smooth = here.normal.dot(there.normal) > 0.999
                && here.source == there.source
                && moved.length() < 3.0 * STEP;
            let change = (there.uv - here.uv).as_dvec2();
            // Where u jumps from 1 to 0, and where it has no gradient: poles and axes.
            let slopes = [0, 1].map(|k| {
                let both = here.uv_gradients[k].as_dvec3() + there.uv_gradients[k].as_dvec3();
                (0.5 * both, both.length() * 0.5)
            });
            if !is_smooth || change.x.abs() > 0.5 || slopes[0].1 > 2.0 || slopes[1].1 > 2.0 {
                continue;
            }
            n_checked += 1;
            let expected = DVec2::new(slopes[0].0.dot(moved), slopes[1].0.dot(moved));
            let error = (change - expected).length();
            let limit = 6e-3 * (slopes[0].1 + slopes[1].1) * moved.length() + 1e-6;
            assert!(error < limit, "{name}: {change}, not {expected} at {}", here.object_point);
            for slope in here.uv_gradients {
                let off = slope.dot(here.normal).abs();
                assert!(off < 1e-4, "{name}: a gradient leaves the surface by {off}");
            }
        }
    }
}

/// The contract's formulas of sphere and plane; of cone and cylinder the whole turn and the height; of
/// meshes what their corners say.
#[test]
fn uv_has_the_value_of_its_formula() {
    let mut numbers = Numbers::new(9);
    for (name, shape) in shapes() {
        let geometry = alone(shape.clone());
        for _ in 0..300 {
            let origin = numbers.direction() * 4.0;
            let direction = (numbers.direction() * 0.9 - origin).normalize();
            let Some(found) = surface(&geometry, origin, direction) else { continue };
            let p = found.object_point;
            let expected = match &shape {
                Shape::Sphere { center, radius } => {
                    let d = (p - *center) / *radius;
                    DVec2::new(0.5 + d.x.atan2(d.z) / TAU, 0.5 + d.y.asin() / PI)
                }
                Shape::Plane { point, normal } => {
                    let x = (DVec3::X - *normal * normal.x).normalize();
                    DVec2::new((p - *point).dot(x), (p - *point).dot(normal.cross(x)))
                }
                Shape::Cone { base, tip: end, radius }
                | Shape::Cylinder { base, top: end, radius } => {
                    let w = (*end - *base).normalize();
                    let x = (DVec3::X - w * w.x).normalize();
                    let d = p - *base;
                    let (along, across) = (d.dot(w), d - w * d.dot(w));
                    let is_cap = found.normal.as_dvec3().dot(w).abs() > 0.999;
                    let height = along / end.distance(*base);
                    let v = if is_cap { across.length() / *radius } else { height };
                    DVec2::new(0.5 + across.dot(w.cross(x)).atan2(across.dot(x)) / TAU, v)
                }
                // u and v are linear on a triangle: by its corners, and the way from the first to the others.
                Shape::Mesh(mesh) => {
                    let mesh = &mesh.mesh;
                    let triangle = found.source.primitive;
                    let [a, b, c] = mesh.corners(triangle).map(|corner| corner.as_dvec3());
                    let area = (b - a).cross(c - a);
                    let share = |v: DVec3| v.dot(area) / area.length_squared();
                    let (s, t) = (share((p - a).cross(c - a)), share((b - a).cross(p - a)));
                    let [ua, ub, uc] =
                        mesh.uv_ids[triangle as usize].map(|id| mesh.uvs[id as usize].as_dvec2());
                    ua + (ub - ua) * s + (uc - ua) * t
                }
                Shape::Box { .. } => continue,
            };
            let error = (found.uv.as_dvec2() - expected).length();
            assert!(error < 1e-5, "{name}: {}, not {expected} at {p}", found.uv);
        }
    }
}

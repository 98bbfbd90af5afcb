//! Trees over triangles, against testing every triangle.

use std::sync::Arc;

use glam::Vec3;
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, Geometry, Instance, Shape, TracedMesh};
use penumbra::math::{PrimitiveId, Ray, RayBatch, Transform};

/// Bytes of a point: three coordinates.
const POINT: usize = 3;

/// All accelerators find what brute force finds. The first byte is the number of triangles and the
/// second chooses the size of things; then come three points a triangle, then two a ray. A
/// coordinate is one byte, so that planes, edges and corners meet often.
pub fn accelerators(data: &[u8]) {
    let Some(([n_triangles, size], data)) = data.split_first_chunk() else { return };
    let scale = [1.0, 0.1, 1e-3, 1e6][usize::from(size & 3)];
    let shift = [0.0, 1.0, 1e3, 1e5][usize::from(size >> 2 & 3)];
    let mut points = data.chunks_exact(POINT).map(|bytes| {
        let coordinate = |i: usize| f32::from(bytes[i] as i8) / 16.0;
        (Vec3::new(coordinate(0), coordinate(1), coordinate(2)) + shift) * scale
    });
    let positions: Vec<Vec3> = points.by_ref().take(3 * usize::from(*n_triangles)).collect();
    let n_triangles = positions.len() as u32 / 3;
    let triangles = (0..n_triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut rays = RayBatch::default();
    while let (Some(origin), Some(target)) = (points.next(), points.next()) {
        if origin == target {
            continue;
        }
        let mut ray = Ray::new(origin, target - origin);
        rays.push(ray);
        ray.t_max = 1.0;
        ray.source = PrimitiveId { object: 0, primitive: rays.len() as u32 % (n_triangles + 1) };
        rays.push(ray);
    }
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    let shape = Shape::Mesh(Arc::new(TracedMesh::new(mesh)));
    let instance = Instance::new(shape, Transform::IDENTITY);
    let answers = AcceleratorKind::ALL.map(|kind| {
        let geometry = Geometry::new(vec![instance.clone()], kind);
        let (mut hits, mut blocked) = (Vec::new(), Vec::new());
        geometry.intersect(&rays, &mut hits);
        geometry.occluded(&rays, &mut blocked);
        let hits: Vec<_> =
            hits.iter().map(|hit| hit.hit().map(|h| (h.t.to_bits(), h.id))).collect();
        (hits, blocked)
    });
    let [.., (hits, blocked)] = &answers;
    for (i, hit) in hits.iter().enumerate() {
        assert_eq!(hit.is_some(), blocked[i], "occluded and intersect: {:?}", rays.ray(i));
        for (kind, answer) in AcceleratorKind::ALL.iter().zip(&answers) {
            let found = (answer.0[i], answer.1[i]);
            assert_eq!(found, (*hit, blocked[i]), "{}: {:?}", kind.name(), rays.ray(i));
        }
    }
}

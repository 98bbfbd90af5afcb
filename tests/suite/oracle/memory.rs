//! Trees take no more memory than is reckoned with before they are built, whatever the mesh, and
//! no more time than somebody waits for them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;

use glam::Vec3;
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, Stopped, TracedMesh};

use crate::common::Numbers;

/// Every triangle of a mesh that is all corners.
fn mesh(corners: Vec<Vec3>) -> Mesh {
    let n = corners.len() as u32 / 3;
    let triangles = (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { positions: corners, triangles, ..Mesh::default() }
}

/// Meshes made to be cut badly.
fn adversaries() -> Vec<(&'static str, Mesh)> {
    const N: usize = 20_000;
    let mut numbers = Numbers::new(9);
    let mut random = || (numbers.direction() * numbers.next()).as_vec3();
    let one = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let nested = |i: usize| one.map(|p| (p - Vec3::splat(0.3)) * (1.0 + i as f32));
    let fan = |i: usize| [Vec3::ZERO, random(), Vec3::new(0.0, 0.0, i as f32)];
    vec![
        ("equal triangles", mesh((0..N).flat_map(|_| one).collect())),
        ("nested triangles", mesh((0..N).flat_map(nested).collect())),
        ("triangles about one edge", mesh((0..N).flat_map(fan).collect())),
        (
            "needles across everything",
            mesh((0..N).flat_map(|_| [random(), random(), random() * 1e-3]).collect()),
        ),
        (
            "one large triangle among small ones",
            mesh(
                (0..N)
                    .flat_map(|i| {
                        let size = if i == 0 { 1e6 } else { 1e-3 };
                        let at = random();
                        one.map(|p| at + p * size)
                    })
                    .collect(),
            ),
        ),
        ("points", mesh((0..N).flat_map(|_| [random(); 3]).collect())),
    ]
}

#[test]
fn no_mesh_makes_a_tree_larger_than_is_reckoned_with() {
    /// A kd-tree may name a triangle in so many more leaves than one, on the worst of meshes.
    const COPIES: u64 = 16;
    for (what, mesh) in adversaries() {
        let n_triangles = mesh.triangles.len() as u64;
        let traced = Arc::new(TracedMesh::new(mesh));
        for kind in AcceleratorKind::ALL {
            traced.build_tree(kind, &AtomicBool::new(false)).unwrap();
            let n_bytes = traced.tree(kind).n_bytes() as u64;
            let reckoned = kind.bytes_a_triangle() * n_triangles;
            let most = match kind {
                AcceleratorKind::WideBvh | AcceleratorKind::BruteForce => reckoned,
                AcceleratorKind::KdTree | AcceleratorKind::KdMidpoint => COPIES / 4 * reckoned,
            };
            let name = kind.name();
            assert!(n_bytes <= most, "{name}, {what}: {n_bytes} bytes where {most} are the most");
        }
    }
}

/// Long before it would be finished: a million triangles take seconds.
#[test]
fn a_build_under_way_ends_when_nobody_wants_it() {
    let mut numbers = Numbers::new(3);
    let mut random = || Vec3::new(numbers.next() as f32, numbers.next() as f32, 0.5);
    let corners = (0..1_000_000).flat_map(|_| {
        let corner = random();
        [corner, corner + Vec3::X * 1e-3, corner + Vec3::Y * 1e-3]
    });
    let traced = TracedMesh::new(mesh(corners.collect()));
    for kind in [AcceleratorKind::WideBvh, AcceleratorKind::KdTree, AcceleratorKind::KdMidpoint] {
        let stop = AtomicBool::new(false);
        let (begin, begun) = channel();
        let built = std::thread::scope(|scope| {
            let builder = scope.spawn(|| {
                begin.send(()).unwrap();
                traced.build_tree(kind, &stop)
            });
            begun.recv().unwrap();
            stop.store(true, Ordering::Relaxed);
            builder.join().unwrap()
        });
        assert_eq!(built, Err(Stopped), "{}", kind.name());
        assert!(!traced.has_tree(kind), "{}: half a tree", kind.name());
    }
}

//! How much a ray costs: counted, so that a worse tree is seen without a clock.

use glam::{DVec3, Vec3};
use penumbra::geometry::{AcceleratorKind, Geometry, Instance, Shape, TraversalCost};
use penumbra::math::{Ray, Transform};

use super::rays::mesh_of;
use crate::common::icosphere;

/// Mean nodes and tests of rays at a grid over a sphere of 20480 triangles, all of which hit.
fn mean_cost(kind: AcceleratorKind) -> (f64, f64) {
    let mesh = icosphere(5, 1.0, Vec3::ZERO);
    let n_triangles = mesh.triangles.len() as u32;
    let shape = mesh_of(mesh.positions, mesh.triangles);
    let geometry = Geometry::new(vec![Instance::new(shape, Transform::IDENTITY)], kind);
    let side = if kind == AcceleratorKind::BruteForce { 3_u16 } else { 40 };
    let mut sum = (0.0, 0.0);
    for y in 0..side {
        for x in 0..side {
            let at = |i: u16| 1.2 * ((f32::from(i) + 0.5) / f32::from(side) - 0.5);
            let ray = Ray::new(Vec3::new(at(x), at(y), 4.0), Vec3::new(0.01, -0.02, -1.0));
            let (hit, cost) = geometry.intersect_counted(&ray);
            assert!(hit.is_some(), "{} misses at {x}, {y}", kind.name());
            assert!(cost.n_primitives <= n_triangles, "{cost:?} of {n_triangles} triangles");
            sum.0 += f64::from(cost.n_nodes);
            sum.1 += f64::from(cost.n_primitives);
        }
    }
    let n_rays = f64::from(side) * f64::from(side);
    (sum.0 / n_rays, sum.1 / n_rays)
}

#[test]
fn trees_spare_rays_nearly_all_triangles() {
    let brute = mean_cost(AcceleratorKind::BruteForce);
    assert_eq!(brute, (0.0, 20480.0), "the oracle tests every triangle and has no nodes");
    // A little above what the builders reach; a tree that is worse by a third fails.
    for (kind, most_nodes, most_tests) in [
        (AcceleratorKind::WideBvh, 7.0, 9.0),
        (AcceleratorKind::KdTree, 29.0, 8.0),
        (AcceleratorKind::KdMidpoint, 28.0, 14.0),
    ] {
        let (nodes, tests) = mean_cost(kind);
        let is_little = 1.0 <= nodes && nodes <= most_nodes && 1.0 <= tests && tests <= most_tests;
        assert!(is_little, "{}: {nodes} nodes and {tests} tests a ray", kind.name());
    }
}

/// Boxes of objects count as nodes, solids as tests.
#[test]
fn solids_and_their_boxes_are_counted() {
    let ball = |x: f64| {
        let shape = Shape::Sphere { center: DVec3::new(x, 0.0, 0.0), radius: 0.5 };
        Instance::new(shape, Transform::IDENTITY)
    };
    let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
    let cost = |xs: &[f64]| {
        let balls = xs.iter().map(|x| ball(*x)).collect();
        Geometry::new(balls, AcceleratorKind::WideBvh).intersect_counted(&ray).1
    };
    let one = TraversalCost { n_nodes: 0, n_primitives: 1 };
    assert_eq!(cost(&[0.0]), one, "a single object has no box before it");
    let three = TraversalCost { n_nodes: 3, n_primitives: 1 };
    assert_eq!(cost(&[-3.0, 0.0, 3.0]), three, "the boxes of two are missed");
    assert_eq!(three.total(), 4, "in all");
}

/// A tree over objects spares rays most of them, boxes and all.
#[test]
fn rays_come_to_few_of_many_objects() {
    let mut balls = Vec::new();
    for i in 0..32_i32 {
        for j in 0..32_i32 {
            let center = DVec3::new(f64::from(i), f64::from(j), f64::from((7 * i + 13 * j) % 5));
            balls.push(Instance::new(Shape::Sphere { center, radius: 0.45 }, Transform::IDENTITY));
        }
    }
    let geometry = Geometry::new(balls, AcceleratorKind::WideBvh);
    assert!(geometry.statistics().n_nodes > 64, "{:?}", geometry.statistics());
    let (mut n_hits, mut n_nodes, mut n_primitives) = (0, 0, 0);
    for i in 0..1000_u16 {
        let (u, v) = (0.031 * f32::from(i), 0.017 * f32::from(i * 7 % 1800));
        let ray = Ray::new(Vec3::new(u, v, 20.0), Vec3::new(0.01, -0.02, -1.0));
        let (hit, cost) = geometry.intersect_counted(&ray);
        n_hits += u32::from(hit.is_some());
        n_nodes += cost.n_nodes;
        n_primitives += cost.n_primitives;
    }
    assert!(n_hits > 500, "{n_hits} hits");
    let (nodes, tests) = (f64::from(n_nodes) / 1000.0, f64::from(n_primitives) / 1000.0);
    assert!(nodes < 50.0 && tests < 1.5, "{nodes} boxes and {tests} balls a ray");
}

//! Every tree against brute force: the same hits to the last bit, on the worst of triangles.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use penumbra::color::Rgb;
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, Geometry, Hit, Instance, Nearest, Shape, TracedMesh};
use penumbra::math::{PrimitiveId, Ray, RayBatch, Transform};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestCaseError};

use crate::common::{Numbers, icosphere};

/// Whatever is not brute force.
const TREES: [AcceleratorKind; 3] =
    [AcceleratorKind::WideBvh, AcceleratorKind::KdTree, AcceleratorKind::KdMidpoint];

/// Every answer of all trees is that of brute force, and the answers go together.
fn check(instances: &[Instance], rays: &RayBatch) -> Result<(), TestCaseError> {
    let trace = |kind| {
        let geometry = Geometry::new(instances.to_vec(), kind);
        let (mut hits, mut blocked, mut shares) = (Vec::new(), Vec::new(), Vec::new());
        geometry.intersect(rays, &mut hits);
        let hits: Vec<Option<Hit>> = hits.iter().map(Nearest::hit).collect();
        geometry.occluded(rays, &mut blocked);
        // Two of three objects are clear, with factors that tell the order of multiplication.
        let clear = |hit: Hit| {
            let k = (hit.id.primitive + 7 * hit.id.object) % 5;
            Some(Rgb::new(0.9 - 0.1 * k as f32, 0.3, 1.0 / 3.0))
        };
        geometry.transmittance(rays, clear, |object| object % 3 != 2, &mut shares);
        // Counting is slower: some rays of each kind will do.
        let counted = (0..rays.len()).map(|i| match i % 4 {
            0 => geometry.intersect_counted(&rays.ray(i)).0,
            _ => hits[i],
        });
        let counted: Vec<Option<Hit>> = counted.collect();
        (hits, blocked, shares, counted)
    };
    let (hits, blocked, shares, _) = trace(AcceleratorKind::BruteForce);
    for (i, hit) in hits.iter().enumerate() {
        prop_assert_eq!(hit.is_some(), blocked[i], "occluded and intersect: {:?}", rays.ray(i));
        if let Some(hit) = hit {
            let ray = rays.ray(i);
            prop_assert!(0.0 < hit.t && hit.t < ray.t_max && hit.id != ray.source, "{:?}", hit);
        }
    }
    for kind in TREES {
        let found = trace(kind);
        for i in 0..rays.len() {
            let ray = rays.ray(i);
            let bits = |hit: Option<Hit>| hit.map(|hit| (hit.t.to_bits(), hit.id));
            prop_assert_eq!(bits(found.0[i]), bits(hits[i]), "{}: {:?}", kind.name(), ray);
            prop_assert_eq!(found.1[i], blocked[i], "{} occluded: {:?}", kind.name(), ray);
            prop_assert_eq!(found.2[i], shares[i], "{} transmittance: {:?}", kind.name(), ray);
            prop_assert_eq!(bits(found.3[i]), bits(hits[i]), "{} counted: {:?}", kind.name(), ray);
        }
    }
    Ok(())
}

pub(super) fn mesh_of(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Shape {
    Shape::Mesh(Arc::new(TracedMesh::new(Mesh { positions, triangles, ..Mesh::default() })))
}

/// Triangles as they come from bad files: on a coarse grid, so that planes, edges and whole
/// triangles coincide; needles; flat along an axis; without area; scattered at random.
fn soup(numbers: &mut Numbers, n_triangles: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    for _ in 0..n_triangles {
        let grid = |n: &mut Numbers| (n.between(-4.0, 5.0)).floor() as f32 * 0.25;
        let free = |n: &mut Numbers| n.between(-1.0, 1.0) as f32;
        let kind = (numbers.next() * 7.0) as u32;
        let mut corner = |k: u32| match k {
            0 => Vec3::new(grid(numbers), grid(numbers), grid(numbers)),
            _ => Vec3::new(free(numbers), free(numbers), free(numbers)),
        };
        let [a, b, c] = match kind {
            0 | 1 => [corner(0), corner(0), corner(0)],
            2 => {
                // Flat along one axis, at a place shared with others.
                let (axis, level) = ((corner(0).x.abs() * 8.0) as usize % 3, corner(0).y);
                [corner(1), corner(1), corner(1)].map(|mut p| {
                    p[axis] = level;
                    p
                })
            }
            3 => {
                let (a, b) = (corner(1), corner(1));
                [a, b, a + (b - a) * 0.4 + corner(1) * 1e-6]
            }
            4 => {
                let (a, b) = (corner(1), corner(1));
                [a, b, a + (b - a) * 0.6]
            }
            5 => {
                let a = corner(1);
                [a, a + corner(1) * 1e-3, a + corner(1) * 1e-3]
            }
            _ => [corner(1), corner(1), corner(1)],
        };
        positions.extend([a, b, c]);
    }
    let triangles = (0..n_triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    (positions, triangles)
}

/// Rays through corners, along edges, in planes, along axes, from the middle and from afar, some
/// leaving a triangle, some with an end.
fn rays_at(numbers: &mut Numbers, corners: &[Vec3], scale: f32, n: u32) -> RayBatch {
    let mut rays = RayBatch::default();
    for _ in 0..n {
        let pick = |n: &mut Numbers| corners[(n.next() * corners.len() as f64) as usize];
        let any = |n: &mut Numbers, size: f64| {
            let p = n.direction() * n.between(0.0, size);
            p.as_vec3() * scale
        };
        let center = corners[0];
        let far = if numbers.next() < 0.1 { 1e3 } else { 2.0 };
        let mut origin = center + any(numbers, far);
        let target = match (numbers.next() * 7.0) as u32 {
            0 => pick(numbers),
            6 => {
                // Past a corner, closely.
                let nearness = 10.0_f64.powf(numbers.between(-7.0, -1.0)) as f32;
                pick(numbers) + any(numbers, 1.0) * nearness
            }
            1 => {
                let (a, b) = (pick(numbers), pick(numbers));
                a.lerp(b, numbers.next() as f32)
            }
            2 => {
                origin = pick(numbers);
                pick(numbers)
            }
            3 => {
                // In the plane, or along the edge, of one triangle.
                let first = (numbers.next() * (corners.len() / 3) as f64) as usize * 3;
                let [a, b, c] = [corners[first], corners[first + 1], corners[first + 2]];
                origin = a + (b - a) * numbers.between(-2.0, 2.0) as f32;
                b + (c - b) * (numbers.between(-0.5, 1.5) as f32)
            }
            4 => {
                let axis = (numbers.next() * 3.0) as usize;
                origin = pick(numbers);
                let away = if numbers.next() < 0.5 { scale } else { -scale };
                origin[axis] += 3.0 * away;
                let mut target = origin;
                target[axis] -= away;
                target
            }
            _ => center + any(numbers, 1.0),
        };
        let mut direction = target - origin;
        if numbers.next() < 0.3 {
            direction = direction.normalize_or_zero();
        }
        if direction == Vec3::ZERO || !direction.is_finite() {
            continue;
        }
        let mut ray = Ray::new(origin, direction);
        if numbers.next() < 0.3 {
            ray.t_max = numbers.between(0.1, 2.0) as f32;
        }
        if numbers.next() < 0.2 {
            let primitive = (numbers.next() * (corners.len() / 3) as f64) as u32;
            ray.source = PrimitiveId { object: 0, primitive };
        }
        rays.push(ray);
    }
    rays
}

/// Rays that go about together, sixteen by sixteen, as packets want them: each of these rays with
/// fifteen neighbours, closer or farther, some of them equal.
fn packets_of(numbers: &mut Numbers, leaders: &RayBatch, n: usize) -> RayBatch {
    let mut rays = RayBatch::default();
    for leader in (0..leaders.len().min(n)).map(|i| leaders.ray(i)) {
        let width = 10.0_f64.powf(numbers.between(-7.0, -0.5));
        let origins = if numbers.next() < 0.5 { 0.0 } else { width };
        rays.push(leader);
        for _ in 1..16 {
            let mut near = |size: f64| (numbers.direction() * numbers.between(0.0, size)).as_vec3();
            let length = leader.direction.length();
            let direction = leader.direction + near(width) * length;
            let origin = leader.origin + near(origins) * leader.origin.length();
            if direction != Vec3::ZERO {
                rays.push(Ray { origin, direction, ..leader });
            }
        }
    }
    rays
}

fn config(cases: u32) -> Config {
    Config {
        cases,
        rng_seed: RngSeed::Fixed(20),
        failure_persistence: None,
        max_shrink_iters: 200,
        ..Config::default()
    }
}

proptest! {
    #![proptest_config(config(200))]

    #[test]
    fn trees_find_what_brute_force_finds_in_any_soup(
        seed in any::<u64>(),
        n_triangles in 0_u32..130,
        exponent in prop_oneof![Just(0.0_f64), Just(-3.0), Just(6.0)],
        shift in prop_oneof![3 => Just(0.0_f32), 1 => Just(100.0), 1 => Just(1e4)],
    ) {
        let mut numbers = Numbers::new(seed);
        let scale = 10.0_f64.powf(exponent) as f32;
        let (mut positions, triangles) = soup(&mut numbers, n_triangles);
        for p in &mut positions {
            *p = (*p + Vec3::new(shift, -shift, 0.5 * shift)) * scale;
        }
        let corners = if positions.is_empty() { vec![Vec3::ZERO; 3] } else { positions.clone() };
        let rays = rays_at(&mut numbers, &corners, scale, 500);
        let instance = Instance::new(mesh_of(positions, triangles), Transform::IDENTITY);
        check(std::slice::from_ref(&instance), &rays)?;
        check(&[instance], &packets_of(&mut numbers, &rays, 20))?;
    }
}

proptest! {
    #![proptest_config(config(80))]

    /// Enough objects for a tree over objects: moved, turned, scaled, mirrored, empty, and meshes
    /// that lie far from their own origin.
    #[test]
    fn trees_find_what_brute_force_finds_among_many_objects(
        seed in any::<u64>(),
        n_objects in prop_oneof![10 => 1_u32..20, 10 => 45_u32..80, 1 => 300_u32..400],
        offset in prop_oneof![2 => Just(0.0_f64), 1 => Just(300.0), 1 => Just(1e5)],
    ) {
        let mut numbers = Numbers::new(seed);
        let n = &mut numbers;
        let mut instances = Vec::new();
        for _ in 0..n_objects {
            let place = n.direction() * n.between(0.0, 3.0);
            let turn = if n.next() < 0.3 {
                DVec3::ZERO
            } else {
                DVec3::new(n.between(0., 360.), n.between(0., 360.), 90.0)
            };
            let mut factor = || n.between(0.2, 2.0) * if n.next() < 0.3 { -1.0 } else { 1.0 };
            let scale = DVec3::new(factor(), factor(), factor());
            let home = DVec3::new(offset, -offset, 0.25 * offset);
            // The home of the mesh, moved back to where the others are.
            let there = Transform::new(DVec3::ZERO, turn, scale).world_from_object_point(home);
            let shape = match (n.next() * 7.0) as u32 {
                0 => mesh_of(Vec::new(), Vec::new()),
                1 => {
                    let (positions, triangles) = soup(n, 30);
                    let at_home = positions.iter().map(|p| *p + home.as_vec3()).collect();
                    mesh_of(at_home, triangles)
                }
                2 => {
                    let mesh = icosphere(1, 1.0, home.as_vec3());
                    mesh_of(mesh.positions, mesh.triangles)
                }
                6 => {
                    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + home.as_vec3());
                    mesh_of(corners.to_vec(), vec![[0, 1, 2]])
                }
                3 => Shape::Sphere { center: home, radius: 0.7 },
                4 => Shape::Box { min: home - 0.5, max: home + DVec3::new(0.5, 0.0, 1.0) },
                _ => Shape::Cone { base: home, tip: home + DVec3::Y, radius: 0.5 },
            };
            instances.push(Instance::new(shape, Transform::new(place - there, turn, scale)));
        }
        if n.next() < 0.3 {
            let shape = Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y };
            instances.insert(0, Instance::new(shape, Transform::IDENTITY));
        }
        let mut corners: Vec<Vec3> = instances
            .iter()
            .filter_map(Instance::bounds)
            .flat_map(|b| [b.min, b.max, b.center()])
            .collect();
        for instance in &instances {
            let Shape::Mesh(mesh) = instance.shape() else { continue };
            let place = |p: &Vec3| instance.transform().world_from_object_point(p.as_dvec3());
            corners.extend(mesh.mesh.positions.iter().map(|p| place(p).as_vec3()));
        }
        let corners = if corners.is_empty() { vec![Vec3::ZERO; 3] } else { corners };
        let rays = rays_at(n, &corners, 1.0, 500);
        check(&instances, &rays)?;
        check(&instances, &packets_of(n, &rays, 20))?;
    }
}

/// A mesh far from its own origin meets rays that pass it by less than the rounding there; its
/// place in the tree over objects allows for that.
#[test]
fn meshes_far_from_their_own_origin_are_found_by_the_tree_over_objects() {
    let home = Vec3::new(1e5, -1e5, 3e4);
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + home);
    let shape = mesh_of(corners.to_vec(), vec![[0, 1, 2]]);
    let mut numbers = Numbers::new(3);
    let mut instances = Vec::new();
    let mut rays = RayBatch::default();
    for i in 0..60 {
        let place = DVec3::new(2.0 * f64::from(i), 0.0, 0.0);
        let transform = Transform::new(place - home.as_dvec3(), DVec3::ZERO, DVec3::ONE);
        instances.push(Instance::new(shape.clone(), transform));
        for _ in 0..200 {
            let near = numbers.direction() * 0.01;
            let across = DVec3::new(0.3, 0.2, 2.0);
            let target = place + near + DVec3::Y * numbers.next();
            rays.push(Ray::new((target + across).as_vec3(), -across.as_vec3()));
        }
    }
    check(&instances, &rays).unwrap();
}

/// A mesh without triangles is nowhere.
#[test]
fn empty_meshes_are_never_met() {
    let empty = || Instance::new(mesh_of(vec![Vec3::ONE], Vec::new()), Transform::IDENTITY);
    for n in [1, 20] {
        for kind in AcceleratorKind::ALL {
            let geometry = Geometry::new((0..n).map(|_| empty()).collect(), kind);
            let mut rays = RayBatch::default();
            rays.push(Ray::new(Vec3::ZERO, Vec3::ONE));
            let (mut hits, mut blocked) = (Vec::new(), Vec::new());
            geometry.intersect(&rays, &mut hits);
            geometry.occluded(&rays, &mut blocked);
            assert_eq!((hits[0].hit(), blocked[0]), (None, false), "{n} with {}", kind.name());
            assert_eq!(geometry.bounds(), None, "no bounds");
        }
    }
}

use super::*;
use crate::math::PrimitiveId;
use crate::math::sampler::Sampler;
use crate::math::vectorized::at_every_level;

fn number(i: u32, k: u32) -> f32 {
    2.0 * Sampler::Random { seed: 5 }.numbers(i, k, 0).pair(0)[0] - 1.0
}

fn point(i: u32, k: u32) -> Vec3 {
    Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2))
}

/// Small triangles, some of them flat against an axis, repeated or without area.
fn soup(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..n {
        let center = point(i / 2 * 2, 0);
        let mut corners = [0, 1, 2].map(|corner| center + 0.2 * point(i, 10 + 3 * corner));
        match i % 16 {
            3 => corners.iter_mut().for_each(|corner| corner.y = 0.25),
            5 => corners[2] = corners[1],
            7 => corners = [Vec3::X, Vec3::Y, Vec3::Z],
            _ => {}
        }
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        mesh.positions.extend(corners);
    }
    mesh
}

/// Coherent ones, random ones, ones along axes and in the plane of triangles, ones with ends, and some
/// that go the same way nearly but not along the same largest axis.
fn rays(n: u32) -> RayBatch {
    let mut batch = RayBatch::default();
    for i in 0..n {
        let mut ray = match i / 64 % 5 {
            0 => Ray::new(Vec3::new(0.1, 0.2, 4.0), Vec3::new(0.01 * (i % 64) as f32, 0.1, -2.0)),
            1 => Ray::new(3.0 * point(i, 50), point(i, 60)),
            2 => Ray::new(Vec3::new(-3.0, 0.25, number(i, 70)), Vec3::X),
            3 => Ray::new(3.0 * point(7, 80), Vec3::ONE + 0.02 * point(i, 90)),
            _ => Ray::new(point(i, 80), Vec3::new(1.0, 0.1 * number(i, 90), -1.0)),
        };
        if i % 3 == 0 {
            ray.t_max = 1.5;
        }
        if i % 5 == 0 {
            ray.source = PrimitiveId { object: 2, primitive: i % 300 };
        }
        batch.push(ray);
    }
    batch
}

/// Every width, single and in packets, gives the hits of the scalar test over all triangles.
#[test]
fn all_registers_agree_with_brute_force() {
    use crate::geometry::triangle::ShearedRay;
    let (mesh, rays) = (soup(600), rays(4096 + 9));
    let bvh = WideBvh::build(&mesh, &AtomicBool::new(false)).unwrap();
    let mut by_packet: Vec<Nearest> = rays.t_max.iter().map(|t| Nearest::new(*t)).collect();
    let mut portable = by_packet.clone();
    let mut blocked = vec![false; rays.len()];
    let mut blocked_portable = blocked.clone();
    bvh.intersect_batch(&rays, 2, &mut by_packet);
    let mut fleet = Fleet::IDLE;
    let mut hits = TakeNearest { nearest: &mut portable, source: &rays.source, object: 2 };
    packet::nearest::<Portable>(&bvh, &rays, &mut fleet, &mut hits);
    bvh.occluded_batch(&rays, 2, &mut blocked);
    let (t_max, source) = (&rays.t_max[..], &rays.source[..]);
    let mut hits = TakeAny { blocked: &mut blocked_portable, t_max, source, object: 2 };
    packet::blocked::<Portable>(&bvh, &rays, &mut fleet, &mut hits);
    let mut n_hits = 0;
    for i in 0..rays.len() {
        let ray = rays.ray(i);
        let sheared = ShearedRay::new(&ray);
        let mut expected = Search::new(&ray);
        for id in 0..mesh.triangles.len() as u32 {
            if let Some(t) = sheared.intersect(mesh.corners(id)) {
                expected.offer(t, PrimitiveId { object: 2, primitive: id });
            }
        }
        n_hits += usize::from(expected.nearest.is_hit());
        let mut one = Search::new(&ray);
        bvh.intersect(&ray, 2, &mut one);
        let mut one_portable = Search::new(&ray);
        single::nearest::<Portable>(&bvh, &ray, &mut fleet, 2, &mut one_portable);
        let expected = expected.nearest.hit();
        assert_eq!(by_packet[i].hit(), expected, "packet, ray {i}");
        assert_eq!(portable[i].hit(), expected, "portable packet, ray {i}");
        assert_eq!(one.nearest.hit(), expected, "single, ray {i}");
        assert_eq!(one_portable.nearest.hit(), expected, "portable single, ray {i}");
        assert_eq!(blocked[i], expected.is_some(), "blocked, ray {i}");
        assert_eq!(blocked_portable[i], expected.is_some(), "blocked portable, ray {i}");
    }
    assert!((1000..4000).contains(&n_hits), "{n_hits} hits");
}

/// How rays share packets depends on the number of blocks; what they meet does not.
#[test]
fn rays_of_large_meshes_meet_the_same_alone_and_together() {
    for (n_triangles, n_blocks) in [(30_000, 0..40_000), (200_000, 40_000..150_000)] {
        let bvh = WideBvh::build(&soup(n_triangles), &AtomicBool::new(false)).unwrap();
        assert!(n_blocks.contains(&bvh.blocks.len()), "{} blocks", bvh.blocks.len());
        let rays = rays(4096 + 9);
        let together = at_every_level(|| {
            let mut nearest: Vec<Nearest> = rays.t_max.iter().map(|t| Nearest::new(*t)).collect();
            let mut blocked = vec![false; rays.len()];
            bvh.intersect_batch(&rays, 2, &mut nearest);
            bvh.occluded_batch(&rays, 2, &mut blocked);
            (nearest, blocked)
        });
        for i in 0..rays.len() {
            let ray = rays.ray(i);
            let mut one = Search::new(&ray);
            bvh.intersect(&ray, 2, &mut one);
            for (level, (nearest, blocked)) in &together {
                let case = format!("ray {i} of {n_triangles}, {level:?}");
                assert_eq!(nearest[i].hit(), one.nearest.hit(), "{case}");
                assert_eq!(blocked[i], one.nearest.is_hit(), "{case}, blocked");
            }
        }
    }
}

/// Reciprocals and their products are infinite there, and their differences no numbers.
#[test]
fn a_ray_whose_box_tests_all_overflow_comes_to_an_end() {
    let bvh = WideBvh::build(&soup(600), &AtomicBool::new(false)).unwrap();
    let far = Vec3::splat(3e19);
    let mut rays = RayBatch::default();
    (0..32).for_each(|_| rays.push(Ray::new(far, Vec3::splat(-1e-25))));
    let mut nearest = vec![Nearest::new(f32::INFINITY); rays.len()];
    bvh.intersect_batch(&rays, 2, &mut nearest);
    let mut search = Search::new(&rays.ray(0));
    bvh.intersect(&rays.ray(0), 2, &mut search);
    for nearest in nearest {
        assert_eq!(nearest.hit(), search.nearest.hit(), "all the same ray");
    }
}

#[test]
fn a_thousand_equal_triangles_make_a_tree_of_bounded_depth() {
    let positions = vec![Vec3::X, Vec3::Y, Vec3::Z];
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]; 20_000], ..Mesh::default() };
    let bvh = WideBvh::build(&mesh, &AtomicBool::new(false)).unwrap();
    let ray = Ray::new(Vec3::ZERO, Vec3::ONE);
    let mut search = Search::new(&ray);
    bvh.intersect(&ray, 0, &mut search);
    assert_eq!(search.nearest.hit().map(|hit| hit.id.primitive), Some(0), "the lowest wins");
}

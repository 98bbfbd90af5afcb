//! Cubes, creases, and everything that could make a normal NaN.

use std::collections::HashSet;

use glam::vec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;

fn smooth(positions: &[Vec3], triangles: &[[u32; 3]], crease_angle: f64) -> Normals {
    super::smooth(positions, triangles, crease_angle, &AtomicBool::new(false)).unwrap()
}

fn complete(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    stored: Normals,
    crease_angle: f64,
) -> Normals {
    super::complete(positions, triangles, stored, crease_angle, &AtomicBool::new(false)).unwrap()
}

#[test]
fn normals_that_nobody_wants_are_not_made() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for crease in [1.0, PI] {
        let stopped = super::smooth(&positions, &[[0, 1, 2]], crease, &AtomicBool::new(true));
        assert_eq!(stopped, Err(Stopped), "up to {crease}");
    }
}

const CUBE: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// Corners at ±1; vertex i has the signs of the bits of i.
fn cube() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let positions = (0..8).map(|i| vec3(sign(i & 1), sign(i & 2), sign(i & 4))).collect();
    let triangles = CUBE.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    (positions, triangles)
}

#[track_caller]
fn assert_near(found: Vec3, expected: Vec3) {
    assert!((found - expected).length() < 1e-6, "{found}, not {expected}");
}

#[test]
fn a_smooth_cube_points_along_its_diagonals_however_its_faces_are_cut() {
    let (positions, triangles) = cube();
    let normals = smooth(&positions, &triangles, PI);
    assert_eq!(normals.ids, triangles);
    for (normal, position) in normals.normals.iter().zip(&positions) {
        assert_near(*normal, position.normalize());
    }
}

#[test]
fn a_crease_angle_below_a_right_angle_keeps_a_cube_sharp_and_a_right_angle_does_not() {
    let (positions, triangles) = cube();
    let sharp = smooth(&positions, &triangles, 89.0_f64.to_radians());
    assert_eq!(sharp.normals.len(), 24, "three normals a corner, each shared where it can be");
    let round = smooth(&positions, &triangles, 90.0_f64.to_radians());
    assert_eq!(round.normals.len(), 8);
    for (triangle, ids) in triangles.iter().zip(&sharp.ids) {
        let own = face_of(triangle.map(|i| positions[i as usize])).normal.as_vec3();
        for id in ids {
            assert_near(sharp.normals[*id as usize], own);
        }
    }
    for (triangle, ids) in triangles.iter().zip(&round.ids) {
        for (vertex, id) in triangle.iter().zip(ids) {
            let diagonal = positions[*vertex as usize].normalize();
            assert_near(round.normals[*id as usize], diagonal);
        }
    }
}

#[test]
fn a_crease_of_almost_180_degrees_agrees_with_180() {
    let (positions, triangles) = cube();
    let all = smooth(&positions, &triangles, PI);
    let almost = smooth(&positions, &triangles, PI - 1e-9);
    for (ids, others) in all.ids.iter().zip(&almost.ids) {
        for (id, other) in ids.iter().zip(others) {
            assert_near(all.normals[*id as usize], almost.normals[*other as usize]);
        }
    }
}

#[test]
fn faces_that_cancel_keep_their_own_normals() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let triangles = [[0, 1, 2], [0, 2, 1]];
    for crease in [PI, PI - 1e-3, 1.0] {
        let normals = smooth(&positions, &triangles, crease);
        for (ids, own) in normals.ids.iter().zip([Vec3::Z, Vec3::NEG_Z]) {
            for id in ids {
                assert_near(normals.normals[*id as usize], own);
            }
        }
    }
}

#[test]
fn triangles_without_area_add_nothing_and_stay_flat() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, 2.0 * Vec3::X];
    let triangles = [[0, 1, 2], [0, 1, 1], [0, 1, 3]];
    for crease in [PI, 1.0] {
        let normals = smooth(&positions, &triangles, crease);
        assert_eq!(normals.ids[1..], [[ABSENT; 3]; 2]);
        for id in normals.ids[0] {
            assert_eq!(normals.normals[id as usize], Vec3::Z);
        }
    }
}

#[test]
fn a_needle_that_is_only_rounding_does_not_bend_its_neighbours() {
    // Points on a line, but for the last bit: the needle's normal is noise.
    let off = vec3(0.5, f32::EPSILON / 4.0, 0.0);
    let positions = [Vec3::ZERO, off, Vec3::X, vec3(0.5, 0.0, -1.0)];
    let triangles = [[0, 1, 2], [0, 1, 3], [1, 2, 3]];
    let normals = smooth(&positions, &triangles, PI);
    for id in normals.ids[1..].as_flattened() {
        assert_near(normals.normals[*id as usize], Vec3::Y);
    }
}

#[test]
fn stored_normals_stay_and_missing_ones_are_filled_in() {
    let (positions, triangles) = cube();
    let mut ids = vec![[ABSENT; 3]; triangles.len()];
    ids[0] = [0, ABSENT, 0];
    ids[1] = [0; 3];
    let stored = Normals { normals: vec![Vec3::X], ids };
    let normals = complete(&positions, &triangles, stored, PI);
    assert_eq!(normals.ids[1], [0; 3]);
    assert_eq!([normals.ids[0][0], normals.ids[0][2]], [0, 0]);
    assert_eq!(normals.normals[0], Vec3::X);
    let filled = normals.normals[normals.ids[0][1] as usize];
    assert_near(filled, positions[triangles[0][1] as usize].normalize());
}

#[test]
fn a_mesh_without_stored_normals_is_smooth_up_to_its_crease() {
    let (positions, triangles) = cube();
    let none = Normals::default();
    let normals = complete(&positions, &triangles, none, 1.0);
    assert_eq!(normals, smooth(&positions, &triangles, 1.0));
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn normals_are_units_or_absent_whatever_the_mesh(
        points in prop::collection::vec(
            prop::array::uniform3(prop_oneof![
                Just(0.0f32), Just(1e12), Just(-1e12), Just(1e-40), -1.0f32..1.0]), 3..12),
        corners in prop::collection::vec(prop::array::uniform3(any::<u32>()), 1..24),
        crease in 0.0f64..3.2,
    ) {
        let positions: Vec<_> = points.into_iter().map(Vec3::from).collect();
        let n = positions.len() as u32;
        let triangles: Vec<_> = corners.into_iter().map(|t| t.map(|i| i % n)).collect();
        let normals = smooth(&positions, &triangles, crease);
        for (triangle, ids) in triangles.iter().zip(&normals.ids) {
            let has_area = face_of(triangle.map(|i| positions[i as usize])).normal
                != DVec3::ZERO;
            prop_assert_eq!(has_area, *ids != [ABSENT; 3]);
            for id in ids.iter().filter(|id| **id != ABSENT) {
                let length = normals.normals[*id as usize].length();
                prop_assert!((length - 1.0).abs() < 1e-6, "length {}", length);
            }
        }
    }
}

/// Where very many faces meet, each keeps its own normal and is compared with the one before.
#[test]
fn faces_at_a_crowded_vertex_are_not_compared_with_each_other() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let most = MAX_FACES_AT_CREASE;
    for (n, expected) in [(most, 2), (most + 2, most + 2)] {
        let triangles: Vec<[u32; 3]> = (0..n / 2).flat_map(|_| [[0, 1, 2], [0, 2, 3]]).collect();
        let found = smooth(&positions, &triangles, 1.0);
        let at_origin: HashSet<u32> = found.ids.iter().map(|ids| ids[0]).collect();
        assert_eq!(at_origin.len(), expected, "normals of {n} faces");
    }
}

/// Many vertices with many faces each would take minutes.
#[test]
fn a_mesh_of_crowded_vertices_looks_for_fewer_creases() {
    for (n_vertices, expected) in [(60, MAX_FACES_AT_CREASE), (600, MAX_FACES_AT_CREASE / 2)] {
        let fans = (0..n_vertices as u32).step_by(3).map(|v| [v, v + 1, v + 2]);
        let triangles: Vec<[u32; 3]> = fans.flat_map(|ids| [ids; MAX_FACES_AT_CREASE]).collect();
        let around = CornersAround::new(n_vertices, &triangles);
        assert_eq!(max_faces_at_crease(n_vertices, &around), expected, "{n_vertices} vertices");
    }
}

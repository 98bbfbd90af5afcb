//! Outlines of every kind: the pieces tile the whole.

use std::sync::atomic::AtomicBool;

use glam::vec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;

/// Cuts for somebody who waits as long as it takes.
fn try_cut(
    cutter: &mut PolygonCutter,
    points: impl IntoIterator<Item = Vec3>,
) -> Result<(), Uncut> {
    cutter.cut(points.into_iter(), (&AtomicBool::new(false)).into())
}

fn cut(points: &[Vec3]) -> Vec<[u32; 3]> {
    let mut cutter = PolygonCutter::default();
    assert_eq!(try_cut(&mut cutter, points.iter().copied()), Ok(()));
    cutter.triangles().to_vec()
}

fn in_plane(points: &[[f32; 2]]) -> Vec<Vec3> {
    // A tilted plane, so that no axis is special.
    let (u, v) = (vec3(0.6, 0.64, -0.48), vec3(-0.8, 0.48, -0.36));
    points.iter().map(|[x, y]| *x * u + *y * v + vec3(3.0, -2.0, 5.0)).collect()
}

fn area(points: &[Vec3], triangle: [u32; 3], n: DVec3) -> f64 {
    let [a, b, c] = triangle.map(|i| points[i as usize].as_dvec3());
    0.5 * (b - a).cross(c - a).dot(n)
}

/// Every piece turns like the whole, and together they have its area.
#[track_caller]
fn assert_tiles(outline: &[[f32; 2]]) {
    let points = in_plane(outline);
    let n = vec3(0.6, 0.64, -0.48).as_dvec3().cross(vec3(-0.8, 0.48, -0.36).as_dvec3());
    let triangles = cut(&points);
    assert_eq!(triangles.len(), outline.len() - 2);
    let fan: f64 = (1..points.len() as u32 - 1).map(|i| area(&points, [0, i, i + 1], n)).sum();
    let mut total = 0.0;
    for triangle in triangles {
        let piece = area(&points, triangle, n * fan.signum());
        assert!(piece > -1e-5 * fan.abs(), "{triangle:?} turns the other way: {piece}");
        total += piece;
    }
    assert!((total - fan.abs()).abs() < 1e-4 * fan.abs(), "{total} for {fan}");
}

#[test]
fn convex_polygons_become_a_fan_from_the_first_corner() {
    let square = in_plane(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(cut(&square), [[0, 1, 2], [0, 2, 3]]);
    let straight = in_plane(&[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(cut(&straight), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
}

#[test]
fn a_dart_is_cut_through_its_notch_wherever_the_outline_starts() {
    let dart = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]];
    for start in 0..4 {
        let mut turned = dart;
        turned.rotate_left(start);
        assert_tiles(&turned);
        turned.reverse();
        assert_tiles(&turned);
    }
}

#[test]
fn outlines_with_notches_bridges_and_straight_corners_are_tiled() {
    assert_tiles(&[[0., 0.], [3., 0.], [3., 3.], [2., 3.], [2., 1.], [1., 1.], [1., 3.], [0., 3.]]);
    assert_tiles(&[[0., 0.], [2., 0.], [4., 0.], [4., 4.], [2., 1.], [0., 4.]]);
    // A square with a square hole, joined by a bridge that is walked twice.
    assert_tiles(&[
        [0., 0.],
        [6., 0.],
        [6., 6.],
        [0., 6.],
        [0., 0.],
        [2., 2.],
        [2., 4.],
        [4., 4.],
        [4., 2.],
        [2., 2.],
    ]);
    let comb: Vec<[f32; 2]> = (0..200)
        .map(|i| [i as f32, if i % 2 == 0 { 0.0 } else { 9.0 }])
        .chain([[199.0, 10.0], [0.0, 10.0]])
        .collect();
    assert_tiles(&comb);
}

#[test]
fn spirals_are_tiled() {
    let arm = |radius: f32, i: i32| {
        let (s, c) = (0.2 * i as f32).sin_cos();
        [(radius + 0.1 * i as f32) * c, (radius + 0.1 * i as f32) * s]
    };
    let outline: Vec<_> =
        (0..150).map(|i| arm(2.0, i)).chain((0..150).rev().map(|i| arm(1.0, i))).collect();
    assert_tiles(&outline);
}

#[test]
fn a_large_concave_outline_takes_no_time() {
    // A saw blade of many teeth; comparing all corners with all would take minutes.
    let n = 60_000;
    let outline: Vec<_> = (0..n)
        .map(|i| {
            let (s, c) = (std::f32::consts::TAU * i as f32 / n as f32).sin_cos();
            let r = if i % 2 == 0 { 100.0 } else { 99.0 };
            [r * c, r * s]
        })
        .collect();
    assert_eq!(cut(&in_plane(&outline)).len(), n - 2);
}

/// A comb of long teeth, a spiral and a walk that crosses itself, each of 200,000 corners.
#[test]
fn large_outlines_of_every_kind_are_cut() {
    let n = 200_000;
    let comb = |i: usize| [i as f32, if i.is_multiple_of(2) { 0.0 } else { 1e6 }];
    let comb = (0..n).map(comb).chain([[n as f32, -9.0], [0.0, -9.0]]);
    let spiral = (0..n).map(|i| {
        let (turn, radius) = if i < n / 2 { (i, 1.0) } else { (n - 1 - i, 1.5) };
        let (s, c) = (0.05 * turn as f64).sin_cos();
        [s, c].map(|x| ((radius + 0.05 * turn as f64) * x) as f32)
    });
    let mut at = [0.0; 2];
    let mut numbers = (0_u32..).map(|i| i.wrapping_mul(2_654_435_769).rotate_left(13) as i32);
    let walk = (0..n).map(|_| {
        at = at.map(|x: f32| x + numbers.next().unwrap() as f32 / 1e9);
        at
    });
    let outlines: [Vec<[f32; 2]>; 3] = [comb.collect(), spiral.collect(), walk.collect()];
    for outline in outlines {
        let mut cutter = PolygonCutter::default();
        assert_eq!(try_cut(&mut cutter, in_plane(&outline)), Ok(()));
        assert_eq!(cutter.triangles().len(), outline.len() - 2);
        let n_looks = cutter.n_looks as f64 / outline.len() as f64;
        assert!(n_looks < 1000.0, "{n_looks} looks a corner");
    }
}

/// Needles across one another: every tip is looked at for every other.
#[test]
fn what_a_file_takes_to_cut_is_limited() {
    let tooth = |i: u16| vec3(if i.is_multiple_of(2) { 0.0 } else { 9.0 }, f32::from(i), 0.0);
    let back = [vec3(-1.0, 1000.0, 0.0), vec3(-1.0, -1.0, 0.0)];
    let comb: Vec<Vec3> = (0..1000).map(tooth).chain(back).collect();
    let mut cutter = PolygonCutter::default();
    assert_eq!(try_cut(&mut cutter, comb.iter().copied()), Ok(()));
    let n_looks = cutter.n_looks;
    assert!((1_000..1_000_000).contains(&n_looks), "{n_looks} looks at a comb");
    cutter.n_looks = MAX_LOOKS - n_looks / 2;
    assert_eq!(try_cut(&mut cutter, comb.iter().copied()), Err(Uncut::TooIntricate));
    let square = in_plane(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(try_cut(&mut cutter, square), Ok(()), "a convex one takes no looks");
    cutter.n_looks = 0;
    let stopped = cutter.cut(comb.into_iter(), (&AtomicBool::new(true)).into());
    assert_eq!(stopped, Err(Uncut::Cancelled), "nobody waits");
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn n_corners_give_n_minus_2_triangles_whatever_they_are(
        points in prop::collection::vec(prop::array::uniform3(-2i8..=2), 3..40),
    ) {
        let points: Vec<_> = points.iter().map(|p| Vec3::from(p.map(f32::from))).collect();
        let triangles = cut(&points);
        prop_assert_eq!(triangles.len(), points.len() - 2);
        prop_assert!(triangles.iter().flatten().all(|i| (*i as usize) < points.len()));
    }

    #[test]
    fn star_shaped_outlines_are_tiled(radii in prop::collection::vec(0.2f32..2.0, 3..60)) {
        let n = radii.len() as f32;
        let outline: Vec<_> = radii.iter().enumerate().map(|(i, r)| {
            let (s, c) = (std::f32::consts::TAU * i as f32 / n).sin_cos();
            [r * c, r * s]
        }).collect();
        assert_tiles(&outline);
    }
}

//! Polygons cut into triangles: a fan where they are convex, ears where they are not.
//!
//! A polygon of n corners always becomes n - 2 triangles, however degenerate, with the polygon's
//! own turning sense. It is looked at along its mean normal, in `f64`.

use glam::{DVec2, DVec3, Vec3};
use std::collections::VecDeque;

/// Corners of a polygon that is not convex: ears of larger ones would take minutes to find.
pub(super) const MAX_CONCAVE_CORNERS: usize = 100_000;

/// Sine of the angle by which a corner of a convex polygon may turn back: room for the rounding
/// of corners that lie on a straight line.
const STRAIGHT: f64 = 1e-6;

/// How often all corners are tried again before ears need not be clean any more. Once is enough
/// for a simple polygon.
const MAX_ROUNDS: usize = 4;

/// Cuts one polygon after the other, and keeps its memory.
#[derive(Debug, Default)]
pub(super) struct PolygonCutter {
    points: Vec<Vec3>,
    flat: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    previous: Vec<u32>,
    next: Vec<u32>,
    is_cut: Vec<bool>,
    /// Corners that point inwards or are straight, by ascending x: only they can lie in an ear.
    inward: Vec<u32>,
    queue: VecDeque<u32>,
}

impl PolygonCutter {
    /// The triangles of the polygon that was cut last, as numbers of its corners.
    pub(super) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Cuts a polygon of three corners or more. False: too large, and not convex.
    pub(super) fn cut(&mut self, points: impl Iterator<Item = Vec3>) -> bool {
        self.points.clear();
        self.points.extend(points);
        self.triangles.clear();
        self.flatten();
        if self.is_convex() {
            self.cut_fan();
            return true;
        }
        if MAX_CONCAVE_CORNERS < self.points.len() {
            return false;
        }
        self.cut_ears();
        true
    }

    /// Projects the polygon along the largest part of its mean normal, so that it turns
    /// counter-clockwise. A polygon without area stays a heap of zeros.
    fn flatten(&mut self) {
        let origin = self.points[0].as_dvec3();
        let at = |point: &Vec3| point.as_dvec3() - origin;
        // Newell's normal: the sum over the triangles with the first corner.
        let mut normal = DVec3::ZERO;
        for pair in self.points.windows(2) {
            normal += at(&pair[0]).cross(at(&pair[1]));
        }
        let size = normal.abs();
        let (axis_u, axis_v) = if size.x >= size.y && size.x >= size.z {
            (DVec3::Y, DVec3::Z * normal.x.signum())
        } else if size.y >= size.z {
            (DVec3::Z, DVec3::X * normal.y.signum())
        } else {
            (DVec3::X, DVec3::Y * normal.z.signum())
        };
        let scale = if size.max_element() > 0.0 { 1.0 } else { 0.0 };
        self.flat.clear();
        self.flat.extend(self.points.iter().map(|point| {
            let p = scale * at(point);
            DVec2::new(p.dot(axis_u), p.dot(axis_v))
        }));
    }

    fn is_convex(&self) -> bool {
        let n = self.flat.len();
        (0..n).all(|i| {
            let before = self.flat[(i + n - 1) % n];
            let corner = self.flat[i];
            let after = self.flat[(i + 1) % n];
            let (e, f) = (corner - before, after - corner);
            -STRAIGHT * (e.length_squared() * f.length_squared()).sqrt() <= e.perp_dot(f)
        })
    }

    fn cut_fan(&mut self) {
        let n = self.points.len() as u32;
        self.triangles.extend((1..n - 1).map(|i| [0, i, i + 1]));
    }

    /// Cuts ears off until a triangle is left (G. Meisters, "Polygons Have Ears", American
    /// Mathematical Monthly 82(6), 1975). Only the neighbours of a corner that was cut can become
    /// ears by it, so that each corner is tried a few times in all.
    fn cut_ears(&mut self) {
        self.start_ring();
        let n = self.flat.len();
        let mut n_rounds = 0;
        while self.triangles.len() < n - 2 {
            if let Some(corner) = self.queue.pop_front() {
                if !self.is_cut[corner as usize] && self.is_ear(corner) {
                    self.cut_off(corner);
                }
            } else if n_rounds < MAX_ROUNDS {
                n_rounds += 1;
                self.queue.extend((0..n as u32).filter(|i| !self.is_cut[*i as usize]));
            } else {
                // The outline crosses itself: no cut is right, and any keeps the count.
                self.cut_rest();
            }
        }
    }

    fn start_ring(&mut self) {
        let n = self.flat.len() as u32;
        self.previous.clear();
        self.previous.extend((0..n).map(|i| (i + n - 1) % n));
        self.next.clear();
        self.next.extend((0..n).map(|i| (i + 1) % n));
        self.is_cut.clear();
        self.is_cut.resize(n as usize, false);
        self.queue.clear();
        let mut inward = std::mem::take(&mut self.inward);
        inward.clear();
        inward.extend((0..n).filter(|i| self.turn(*i) <= 0.0));
        inward.sort_by(|a, b| self.flat[*a as usize].x.total_cmp(&self.flat[*b as usize].x));
        self.inward = inward;
    }

    /// The triangle that a corner makes with its neighbours in what is left.
    fn triangle_at(&self, corner: u32) -> [u32; 3] {
        [self.previous[corner as usize], corner, self.next[corner as usize]]
    }

    /// Twice the area of a corner's triangle; below 0 where the corner points inwards.
    fn turn(&self, corner: u32) -> f64 {
        let [a, b, c] = self.triangle_at(corner).map(|i| self.flat[i as usize]);
        (b - a).perp_dot(c - b)
    }

    /// Whether a corner's triangle has an area and nothing of the outline in it.
    fn is_ear(&self, corner: u32) -> bool {
        if self.turn(corner) <= 0.0 {
            return false;
        }
        let ids = self.triangle_at(corner);
        let [a, b, c] = ids.map(|i| self.flat[i as usize]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let start = self.inward.partition_point(|i| self.flat[*i as usize].x < low.x);
        for other in &self.inward[start..] {
            let p = self.flat[*other as usize];
            if high.x < p.x {
                break;
            }
            // Corners that a bridge to a hole visits twice do not block each other.
            let blocks = !self.is_cut[*other as usize]
                && ![a, b, c].contains(&p)
                && (b - a).perp_dot(p - a) >= 0.0
                && (c - b).perp_dot(p - b) >= 0.0
                && (a - c).perp_dot(p - c) >= 0.0
                && self.turn(*other) <= 0.0;
            if blocks {
                return false;
            }
        }
        true
    }

    fn cut_off(&mut self, corner: u32) {
        let triangle = self.triangle_at(corner);
        let [before, _, after] = triangle;
        self.triangles.push(triangle);
        self.is_cut[corner as usize] = true;
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.queue.push_back(before);
        self.queue.push_back(after);
    }

    /// Cuts what is left into a fan.
    fn cut_rest(&mut self) {
        let first = (0..self.is_cut.len()).find(|i| !self.is_cut[*i]).unwrap_or_default();
        while self.triangles.len() + 2 < self.flat.len() {
            self.cut_off(self.next[first]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn cut(points: &[Vec3]) -> Vec<[u32; 3]> {
        let mut cutter = PolygonCutter::default();
        assert!(cutter.cut(points.iter().copied()));
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
        assert_tiles(&[
            [0., 0.],
            [3., 0.],
            [3., 3.],
            [2., 3.],
            [2., 1.],
            [1., 1.],
            [1., 3.],
            [0., 3.],
        ]);
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

    #[test]
    fn too_large_a_concave_outline_is_refused() {
        let zigzag = |i: usize| vec3(i as f32, (i % 2) as f32, 0.0);
        let n = MAX_CONCAVE_CORNERS + 1;
        let points = (0..n).map(zigzag).chain([vec3(n as f32, -9.0, 0.0)]);
        assert!(!PolygonCutter::default().cut(points));
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
}

//! Polygons cut into triangles: a fan where they are convex, ears where they are not.
//!
//! A polygon of n corners always becomes n - 2 triangles, however degenerate, with the polygon's
//! own turning sense. It is looked at along its mean normal, in `f64`.

use glam::{DVec2, DVec3, Vec3};
use std::collections::VecDeque;

/// Corners of a polygon that is not convex: ears of larger ones would take minutes to find.
pub(super) const MAX_CONCAVE_CORNERS: usize = 100_000;

/// Corners that are looked at in search of ears, in a whole file: some seconds of it. What anybody
/// drew takes a few a corner; only long teeth beside one another take their square.
const MAX_LOOKS: u64 = 1 << 30;

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
    /// Corners looked at so far, in all polygons.
    n_looks: u64,
}

/// Why a polygon was not cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Uncut {
    /// It has more than [`MAX_CONCAVE_CORNERS`], and is not convex.
    TooLarge,
    /// It, or those before it, take too long.
    TooIntricate,
}

impl PolygonCutter {
    /// The triangles of the polygon that was cut last, as numbers of its corners.
    pub(super) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Cuts a polygon of three corners or more.
    pub(super) fn cut(&mut self, points: impl Iterator<Item = Vec3>) -> Result<(), Uncut> {
        self.points.clear();
        self.points.extend(points);
        self.triangles.clear();
        self.flatten();
        if self.is_convex() {
            self.cut_fan();
            return Ok(());
        }
        if MAX_CONCAVE_CORNERS < self.points.len() {
            return Err(Uncut::TooLarge);
        }
        self.cut_ears()
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
    fn cut_ears(&mut self) -> Result<(), Uncut> {
        self.start_ring();
        let n = self.flat.len();
        let mut n_rounds = 0;
        while self.triangles.len() < n - 2 {
            if MAX_LOOKS < self.n_looks {
                return Err(Uncut::TooIntricate);
            }
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
        Ok(())
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
    fn is_ear(&mut self, corner: u32) -> bool {
        if self.turn(corner) <= 0.0 {
            return false;
        }
        let ids = self.triangle_at(corner);
        let [a, b, c] = ids.map(|i| self.flat[i as usize]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let x = |i: &u32| self.flat[*i as usize].x;
        let start = self.inward.partition_point(|i| x(i) < low.x);
        let end = self.inward.partition_point(|i| x(i) <= high.x);
        let near = &self.inward[start..end];
        let blocking = near.iter().position(|other| {
            let p = self.flat[*other as usize];
            // Corners that a bridge to a hole visits twice do not block each other.
            !self.is_cut[*other as usize]
                && ![a, b, c].contains(&p)
                && (b - a).perp_dot(p - a) >= 0.0
                && (c - b).perp_dot(p - b) >= 0.0
                && (a - c).perp_dot(p - c) >= 0.0
                && self.turn(*other) <= 0.0
        });
        self.n_looks += blocking.unwrap_or(near.len()) as u64;
        blocking.is_none()
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
mod tests;

//! Polygons cut into triangles: a fan where they are convex, ears where they are not.
//!
//! A polygon of n corners always becomes n - 2 triangles, however degenerate, with the polygon's
//! own turning sense. It is looked at along its mean normal, in `f64`.

mod grid;

use glam::{DVec2, DVec3, Vec3};
use std::collections::VecDeque;

use crate::io::progress::Watch;
use grid::{Entry, Grid};

/// Corners that are looked at in search of ears, in a whole file: some seconds of it. What anybody
/// drew takes a few a corner; only long teeth across one another take their square.
const MAX_LOOKS: u64 = 1 << 28;

/// Looks a corner that is left, after which the grid is made anew without those that are cut.
const LOOKS_A_FILL: u64 = 4;

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
    /// Corners that point inwards or are straight: only they can lie in an ear.
    inward: Vec<Entry>,
    /// The same, by place.
    grid: Grid,
    /// How many looks there may be until the grid is made anew.
    next_fill: u64,
    /// Corners to try.
    queue: VecDeque<u32>,
    /// How many were ever put into the queue.
    n_queued: u32,
    /// What `n_queued` was when each corner was put there last.
    queued_as: Vec<u32>,
    /// Corners looked at so far, in all polygons.
    n_looks: u64,
}

/// Why a polygon was not cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Uncut {
    /// It, or those before it, take too long.
    TooIntricate,
    /// Nobody wants it any more.
    Cancelled,
}

impl PolygonCutter {
    /// The triangles of the polygon that was cut last, as numbers of its corners.
    pub(super) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Cuts a polygon of three corners or more.
    pub(super) fn cut(
        &mut self,
        points: impl Iterator<Item = Vec3>,
        watch: Watch<'_>,
    ) -> Result<(), Uncut> {
        self.points.clear();
        self.points.extend(points);
        self.triangles.clear();
        self.flatten();
        if self.is_convex() {
            self.cut_fan();
            return Ok(());
        }
        self.cut_ears(watch)
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
    /// ears by it, so that each corner is tried a few times in all. They wait until all others
    /// have been tried: so ears stay small, and do not gather about one corner.
    fn cut_ears(&mut self, watch: Watch<'_>) -> Result<(), Uncut> {
        self.start_ring();
        let n = self.flat.len();
        let mut n_rounds = 0;
        while self.triangles.len() < n - 2 {
            if MAX_LOOKS < self.n_looks {
                return Err(Uncut::TooIntricate);
            }
            if watch.is_stopped() {
                return Err(Uncut::Cancelled);
            }
            if let Some(corner) = self.next_in_queue() {
                if self.is_ear(corner) {
                    self.cut_off(corner);
                }
            } else if n_rounds < MAX_ROUNDS {
                n_rounds += 1;
                self.queue_all();
            } else {
                // The outline crosses itself: no cut is right, and any keeps the count.
                self.cut_rest();
            }
        }
        Ok(())
    }

    fn queue_all(&mut self) {
        for corner in 0..self.is_cut.len() as u32 {
            if !self.is_cut[corner as usize] {
                self.put_in_queue(corner);
            }
        }
    }

    fn put_in_queue(&mut self, corner: u32) {
        self.queued_as[corner as usize] = self.n_queued;
        self.n_queued = self.n_queued.wrapping_add(1);
        self.queue.push_back(corner);
    }

    /// The next corner to try. Those that are cut, or are further behind once more, are left out.
    fn next_in_queue(&mut self) -> Option<u32> {
        loop {
            let place = self.n_queued.wrapping_sub(self.queue.len() as u32);
            let corner = self.queue.pop_front()?;
            if !self.is_cut[corner as usize] && self.queued_as[corner as usize] == place {
                return Some(corner);
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
        self.queued_as.clear();
        self.queued_as.resize(n as usize, 0);
        self.inward.clear();
        for corner in 0..n {
            if self.turn(corner) <= 0.0 {
                self.inward.push(Entry { corner, point: self.flat[corner as usize] });
            }
        }
        self.fill_grid(0);
    }

    /// Leaves out the corners that are cut, or point outwards now.
    fn renew_grid(&mut self, corner: u32) {
        let mut inward = std::mem::take(&mut self.inward);
        inward.retain(|entry| self.is_inward(entry.corner));
        self.inward = inward;
        self.fill_grid(corner);
    }

    /// Makes the grid, about some corner that is left.
    fn fill_grid(&mut self, corner: u32) {
        let n_left = self.flat.len() - self.triangles.len();
        let (mut edges, mut corner) = (DVec2::ZERO, corner as usize);
        for _ in 0..n_left {
            let next = self.next[corner] as usize;
            edges += (self.flat[next] - self.flat[corner]).abs();
            corner = next;
        }
        self.grid.fill(&self.inward, edges);
        self.next_fill = self.n_looks + LOOKS_A_FILL * n_left as u64;
    }

    fn is_inward(&self, corner: u32) -> bool {
        !self.is_cut[corner as usize] && self.turn(corner) <= 0.0
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
        let blocks = |entry: &Entry| {
            let p = entry.point;
            (b - a).perp_dot(p - a) >= 0.0
                && (c - b).perp_dot(p - b) >= 0.0
                && (a - c).perp_dot(p - c) >= 0.0
                // Corners that a bridge to a hole visits twice do not block each other.
                && ![a, b, c].contains(&p)
                && self.is_inward(entry.corner)
        };
        let mut n_looks = 0;
        let is_clean = self.grid.near([a, b, c]).all(|row| {
            let blocking = row.iter().position(blocks);
            n_looks += 1 + blocking.unwrap_or(row.len()) as u64;
            blocking.is_none()
        });
        self.n_looks += n_looks;
        if self.next_fill < self.n_looks {
            self.renew_grid(corner);
        }
        is_clean
    }

    fn cut_off(&mut self, corner: u32) {
        let triangle = self.triangle_at(corner);
        let [before, _, after] = triangle;
        self.triangles.push(triangle);
        self.is_cut[corner as usize] = true;
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.put_in_queue(before);
        self.put_in_queue(after);
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

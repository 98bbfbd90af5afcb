//! Walking sixteen rays through the cells of a kd-tree together, near to far.
//!
//! The rays point to the same side along every axis, so that near and far are the same for all. Each
//! keeps its own stay in a cell; the packet goes where any of them goes.
//!
//! Source: I. Wald, P. Slusallek, C. Benthin and M. Wagner, "Interactive Rendering with Coherent Ray
//! Tracing", Computer Graphics Forum 20(3), 2001.

use std::ops::Range;

use crate::geometry::kd_tree::KdTree;
use crate::geometry::kd_tree::traverse::{MAX_DEPTH, padding, reciprocal};
use crate::math::{Aabb, RayBatch};

/// Rays of a packet.
pub const LANES: usize = 16;

/// One number a ray.
pub type Lanes<T> = [T; LANES];

/// Rays prepared for walking together.
#[derive(Debug)]
pub struct PacketWalk {
    origin: [Lanes<f32>; 3],
    reciprocal: [Lanes<f32>; 3],
    pad: Lanes<f32>,
    t_min: Lanes<f32>,
    t_max: Lanes<f32>,
    /// Whether all directions are above 0 along an axis; else none is.
    is_up: [bool; 3],
}

/// What is done with the leaves that a packet comes to.
pub trait Visit {
    /// Takes a leaf's range of `items`; lowers the parameters up to which rays are still of interest,
    /// below 0 to stop one.
    fn visit(&mut self, items: Range<usize>, limits: &mut Lanes<f32>);
}

/// Rays of a packet as they come: origins, directions, ends. Lanes without a ray end below 0 and
/// repeat the direction of another.
#[derive(Clone, Copy, Debug)]
pub struct PacketRays {
    pub(in crate::geometry) origin: [Lanes<f32>; 3],
    pub(in crate::geometry) direction: [Lanes<f32>; 3],
    pub(in crate::geometry) t_max: Lanes<f32>,
}

impl PacketRays {
    /// `ends.len()` rays of a batch, from `first` on, with these ends; at most [`LANES`].
    #[inline(always)]
    pub fn new(rays: &RayBatch, first: usize, ends: impl ExactSizeIterator<Item = f32>) -> Self {
        let n = ends.len();
        let lanes = |column: &Vec<f32>| {
            let mut lanes = [column[first]; LANES];
            lanes[..n].copy_from_slice(&column[first..first + n]);
            lanes
        };
        let [ox, oy, oz] = &rays.origin;
        let [dx, dy, dz] = &rays.direction;
        let mut t_max = [-1.0; LANES];
        for (t_max, end) in t_max.iter_mut().zip(ends) {
            *t_max = end;
        }
        Self {
            origin: [lanes(ox), lanes(oy), lanes(oz)],
            direction: [lanes(dx), lanes(dy), lanes(dz)],
            t_max,
        }
    }
}

impl PacketWalk {
    /// `None` where rays point to different sides.
    #[inline(always)]
    pub fn new(rays: &PacketRays, bounds: &Aabb) -> Option<Self> {
        let mut packet = Self {
            origin: rays.origin,
            reciprocal: [[1.0; LANES]; 3],
            pad: [0.0; LANES],
            t_min: [0.0; LANES],
            t_max: rays.t_max,
            is_up: [true; 3],
        };
        let reach = bounds.max_abs();
        for i in 0..LANES {
            let [x, y, z] =
                [rays.origin[0][i].abs(), rays.origin[1][i].abs(), rays.origin[2][i].abs()];
            let largest = if x > y { x } else { y };
            let largest = if largest > z { largest } else { z };
            packet.pad[i] = padding(largest, reach);
        }
        for axis in 0..3 {
            let mut n_up = 0;
            for i in 0..LANES {
                let r = reciprocal(rays.direction[axis][i]);
                packet.reciprocal[axis][i] = r;
                n_up += usize::from(r > 0.0);
            }
            let is_up = n_up == LANES;
            if !is_up && n_up > 0 {
                return None;
            }
            packet.is_up[axis] = is_up;
            let (low, high) = (bounds.min[axis], bounds.max[axis]);
            for i in 0..LANES {
                let (low, high) = (low - packet.pad[i], high + packet.pad[i]);
                let (near, far) = if is_up { (low, high) } else { (high, low) };
                let origin = packet.origin[axis][i];
                let enter = (near - origin) * packet.reciprocal[axis][i];
                let leave = (far - origin) * packet.reciprocal[axis][i];
                packet.t_min[i] = packet.t_min[i].max(enter);
                packet.t_max[i] = packet.t_max[i].min(leave);
            }
        }
        Some(packet)
    }
}

/// The stays of all rays in a cell, to be visited later.
#[derive(Clone, Copy)]
struct Stay {
    node: u32,
    t_min: Lanes<f32>,
    t_max: Lanes<f32>,
}

impl KdTree {
    /// [`KdTree::walk`] for a packet. Compiled for the processor of its caller.
    #[inline(always)]
    pub fn walk_packet<V: Visit>(&self, walk: &PacketWalk, visit: &mut V) {
        let mut stack = [Stay { node: 0, t_min: walk.t_min, t_max: walk.t_max }; MAX_DEPTH];
        let mut n_stacked = 1;
        let mut limits = walk.t_max;
        while n_stacked > 0 {
            n_stacked -= 1;
            let Stay { mut node, mut t_min, mut t_max } = stack[n_stacked];
            for i in 0..LANES {
                t_max[i] = if limits[i] < t_max[i] { limits[i] } else { t_max[i] };
            }
            if !is_any(&t_min, &t_max) {
                continue;
            }
            loop {
                let entry = self.nodes[node as usize];
                if entry.is_leaf() {
                    let (first, n_items) = (entry.payload as usize, (entry.link >> 2) as usize);
                    if n_items > 0 {
                        visit.visit(first..first + n_items, &mut limits);
                    }
                    break;
                }
                let axis = (entry.link & 3) as usize;
                let plane = f32::from_bits(entry.payload);
                let is_up = walk.is_up[axis];
                let (origin, reciprocal) = (&walk.origin[axis], &walk.reciprocal[axis]);
                let mut near_max = t_max;
                let mut far_min = t_min;
                for i in 0..LANES {
                    let low = (plane - walk.pad[i] - origin[i]) * reciprocal[i];
                    let high = (plane + walk.pad[i] - origin[i]) * reciprocal[i];
                    let (enter, leave) = if is_up { (low, high) } else { (high, low) };
                    near_max[i] = if leave < t_max[i] { leave } else { t_max[i] };
                    far_min[i] = if enter > t_min[i] { enter } else { t_min[i] };
                }
                let (lower, upper) = (node + 1, entry.link >> 2);
                let (near, far) = if is_up { (lower, upper) } else { (upper, lower) };
                let (is_near, is_far) = (is_any(&t_min, &near_max), is_any(&far_min, &t_max));
                match (is_near, is_far) {
                    (true, true) => {
                        stack[n_stacked] = Stay { node: far, t_min: far_min, t_max };
                        n_stacked += 1;
                        (node, t_max) = (near, near_max);
                    }
                    (true, false) => (node, t_max) = (near, near_max),
                    (false, true) => (node, t_min) = (far, far_min),
                    (false, false) => break,
                }
            }
        }
    }
}

/// Whether any ray stays.
#[inline(always)]
fn is_any(t_min: &Lanes<f32>, t_max: &Lanes<f32>) -> bool {
    let mut n = 0_u32;
    for i in 0..LANES {
        n += u32::from(t_min[i] <= t_max[i]);
    }
    n > 0
}

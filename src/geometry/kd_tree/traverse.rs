//! Walking a ray through the cells of a kd-tree, near to far.

use std::ops::Range;

use crate::geometry::kd_tree::KdTree;
use crate::math::{Aabb, Ray};

/// Deepest tree that a walk can hold on its stack; the builder stays below.
pub(super) const MAX_DEPTH: usize = 60;

/// A ray prepared for walking: reciprocal directions, and the distance by which every plane is
/// moved to the safe side.
///
/// The triangle test and the transform of a ray into an object's space are rounded; both errors are
/// bounded by a few units in the last place of the largest coordinate involved. Planes are moved by
/// 16 of them, so that no cell is skipped that holds something the rounded test would accept.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    origin: [f32; 3],
    reciprocal: [f32; 3],
    pad: f32,
    t_min: f32,
    t_max: f32,
}

impl Walk {
    /// `None` where the ray passes the box by.
    pub fn new(ray: &Ray, bounds: &Aabb) -> Option<Self> {
        let origin = ray.origin.to_array();
        let reciprocal = ray.direction.to_array().map(reciprocal);
        let pad = padding(ray.origin.abs().max_element(), bounds.max_abs());
        let (mut t_min, mut t_max) = (0.0_f32, ray.t_max);
        for axis in 0..3 {
            let low = bounds.min[axis] - pad;
            let high = bounds.max[axis] + pad;
            let (near, far) = if reciprocal[axis] > 0.0 { (low, high) } else { (high, low) };
            t_min = t_min.max((near - origin[axis]) * reciprocal[axis]);
            t_max = t_max.min((far - origin[axis]) * reciprocal[axis]);
        }
        (t_min <= t_max).then_some(Self { origin, reciprocal, pad, t_min, t_max })
    }

    /// The parameter at which the ray enters the box, 0 from inside.
    pub fn enters_at(&self) -> f32 {
        self.t_min
    }
}

/// By how much planes are moved, from the largest coordinates of an origin and of the tree.
#[inline(always)]
pub(super) fn padding(origin: f32, tree: f32) -> f32 {
    (origin + tree) * (16.0 / 16_777_216.0)
}

/// A direction's reciprocal, finite even for 0.
#[inline(always)]
pub(super) fn reciprocal(d: f32) -> f32 {
    const SMALLEST: f32 = 1e-30;
    if d.abs() < SMALLEST { (1.0 / SMALLEST).copysign(d) } else { 1.0 / d }
}

impl KdTree {
    /// Hands the leaves that the ray may touch to `visit`, near to far, as ranges of `items`.
    /// `visit` returns the parameter up to which the ray is still of interest: the nearest hit so
    /// far, or below 0 to stop.
    pub fn walk(&self, walk: &Walk, visit: impl FnMut(Range<usize>) -> f32) {
        self.walk_counting(walk, || (), visit);
    }

    /// [`KdTree::walk`] that tells of every node it comes to.
    pub fn walk_counting(
        &self,
        walk: &Walk,
        mut enter: impl FnMut(),
        mut visit: impl FnMut(Range<usize>) -> f32,
    ) {
        let mut stack = [(0_u32, 0.0_f32, 0.0_f32); MAX_DEPTH];
        let mut n_stacked = 0;
        let (mut node_id, mut t_min, mut t_max) = (0_u32, walk.t_min, walk.t_max);
        let mut t_limit = walk.t_max;
        loop {
            let node = self.nodes[node_id as usize];
            enter();
            if node.is_leaf() {
                let first = node.payload as usize;
                let n_items = (node.link >> 2) as usize;
                if n_items > 0 {
                    t_limit = visit(first..first + n_items);
                }
                loop {
                    if n_stacked == 0 {
                        return;
                    }
                    n_stacked -= 1;
                    (node_id, t_min, t_max) = stack[n_stacked];
                    if t_min <= t_limit {
                        break;
                    }
                }
                continue;
            }
            let axis = (node.link & 3) as usize;
            let (origin, reciprocal) = (walk.origin[axis], walk.reciprocal[axis]);
            let plane = f32::from_bits(node.payload);
            let low = (plane - walk.pad - origin) * reciprocal;
            let high = (plane + walk.pad - origin) * reciprocal;
            let (lower, upper) = (node_id + 1, node.link >> 2);
            let (near, far, enter, leave) = if reciprocal > 0.0 {
                (lower, upper, low, high)
            } else {
                (upper, lower, high, low)
            };
            if t_max < enter {
                node_id = near;
            } else if t_min > leave {
                node_id = far;
            } else {
                stack[n_stacked] = (far, t_min.max(enter), t_max);
                n_stacked += 1;
                node_id = near;
                t_max = t_max.min(leave);
            }
        }
    }
}

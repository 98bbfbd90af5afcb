//! One ray through the tree: eight boxes at once, then four triangles at once.

use crate::geometry::Nearest;
use crate::geometry::lanes::{Isa, Lanes};
use crate::geometry::triangle::{Axes, exact_edges};
use crate::geometry::wide_bvh::{BLOCK, Block, BoxRay, LEAF, Node, WIDTH, WideBvh};
use crate::math::Ray;

/// Seven children a level may wait, and the builder keeps the tree below 36 levels.
pub(super) const STACK: usize = 256;

/// What is done with the blocks that a ray may touch. A trait rather than a closure: its method is
/// inlined for certain, into code compiled for the registers that it uses.
trait Visit<I: Isa> {
    /// Gives the parameter up to which the ray is still of interest, below 0 to stop.
    fn visit(&mut self, block: &Block, limit: f32) -> f32;
}

struct TakeNearest<'a> {
    ray: &'a Ray,
    axes: Axes,
    object: u32,
    nearest: &'a mut Nearest,
}

struct FindAny<'a> {
    ray: &'a Ray,
    axes: Axes,
    object: u32,
    is_blocked: bool,
}

/// The nearest hit.
#[inline(always)]
pub(super) fn nearest<I: Isa>(bvh: &WideBvh, ray: &Ray, object: u32, nearest: &mut Nearest) {
    let limit = nearest.t();
    let axes = Axes::new(ray.direction);
    walk::<I, _>(bvh, ray, limit, &mut TakeNearest { ray, axes, object, nearest });
}

/// Whether there is any hit.
#[inline(always)]
pub(super) fn blocked<I: Isa>(bvh: &WideBvh, ray: &Ray, object: u32) -> bool {
    let axes = Axes::new(ray.direction);
    let mut any = FindAny { ray, axes, object, is_blocked: false };
    walk::<I, _>(bvh, ray, ray.t_max, &mut any);
    any.is_blocked
}

impl<I: Isa> Visit<I> for TakeNearest<'_> {
    #[inline(always)]
    fn visit(&mut self, block: &Block, limit: f32) -> f32 {
        let (mask, t) = triangles::<I>(block, self.ray, &self.axes);
        if mask == 0 {
            return limit;
        }
        let mut candidates = mask & t.le(I::F4::splat(limit)) & I::F4::splat(0.0).lt(t);
        if candidates == 0 {
            return limit;
        }
        let mut ts = [0.0; BLOCK];
        t.store(&mut ts);
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            self.nearest.offer(ts[lane], self.object, block.ids[lane]);
        }
        self.nearest.t()
    }
}

impl<I: Isa> Visit<I> for FindAny<'_> {
    #[inline(always)]
    fn visit(&mut self, block: &Block, limit: f32) -> f32 {
        let (mask, t) = triangles::<I>(block, self.ray, &self.axes);
        if mask == 0 {
            return limit;
        }
        let mut candidates = mask & t.lt(I::F4::splat(self.ray.t_max)) & I::F4::splat(0.0).lt(t);
        while candidates != 0 {
            let id = block.ids[candidates.trailing_zeros() as usize];
            candidates &= candidates - 1;
            if self.ray.source.object != self.object || self.ray.source.primitive != id {
                self.is_blocked = true;
                return -1.0;
            }
        }
        limit
    }
}

/// Hands the blocks that a ray may touch to a visitor, about near to far.
#[inline(always)]
fn walk<I: Isa, V: Visit<I>>(bvh: &WideBvh, ray: &Ray, mut limit: f32, visitor: &mut V) {
    let BoxRay { reciprocal, pad } = BoxRay::new(ray.origin, ray.direction, bvh.magnitude);
    let (mut near_rows, mut far_rows) = ([0, 1, 2], [3, 4, 5]);
    let zero = I::F8::splat(0.0);
    let (mut near_origin, mut far_origin, mut scales) = ([zero; 3], [zero; 3], [zero; 3]);
    for axis in 0..3 {
        let mut outwards = pad;
        if reciprocal[axis] < 0.0 {
            std::mem::swap(&mut near_rows[axis], &mut far_rows[axis]);
            outwards = -pad;
        }
        near_origin[axis] = I::F8::splat((ray.origin[axis] + outwards) * reciprocal[axis]);
        far_origin[axis] = I::F8::splat((ray.origin[axis] - outwards) * reciprocal[axis]);
        scales[axis] = I::F8::splat(reciprocal[axis]);
    }
    let mut stack = [(0_u32, 0.0_f32); STACK];
    let mut n_stacked = 0;
    let mut current = bvh.root;
    loop {
        while current & LEAF == 0 {
            let node: &Node = &bvh.nodes[current as usize];
            let (mut enter, mut leave) = (zero, I::F8::splat(limit));
            for axis in 0..3 {
                let near = I::F8::load(&node.bounds[near_rows[axis]]);
                let far = I::F8::load(&node.bounds[far_rows[axis]]);
                enter = enter.max(near.mul_sub(scales[axis], near_origin[axis]));
                leave = leave.min(far.mul_sub(scales[axis], far_origin[axis]));
            }
            let mut hits = enter.le(leave) & ((1 << node.n_children) - 1);
            if hits == 0 {
                break;
            }
            let first = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            current = node.children[first];
            if hits == 0 {
                continue;
            }
            let mut ts = [0.0; WIDTH];
            enter.store(&mut ts);
            let mut nearest_t = ts[first];
            let base = n_stacked;
            while hits != 0 {
                let child = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                let mut entry = (node.children[child], ts[child]);
                if entry.1 < nearest_t {
                    std::mem::swap(&mut entry.1, &mut nearest_t);
                    std::mem::swap(&mut entry.0, &mut current);
                }
                // Sorted, the nearest on top.
                let mut place = n_stacked;
                while place > base && stack[place - 1].1 < entry.1 {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = entry;
                n_stacked += 1;
            }
        }
        if current & LEAF != 0 {
            limit = visitor.visit(&bvh.blocks[(current & !LEAF) as usize], limit);
        }
        loop {
            if n_stacked == 0 {
                return;
            }
            n_stacked -= 1;
            let (reference, t) = stack[n_stacked];
            if t <= limit {
                current = reference;
                break;
            }
        }
    }
}

/// The watertight test of one ray against four triangles: where it is met, and the parameters.
#[inline(always)]
fn triangles<I: Isa>(block: &Block, ray: &Ray, axes: &Axes) -> (u32, I::F4) {
    let zero = I::F4::splat(0.0);
    let (mut origin, mut shear) = ([zero; 3], [zero; 3]);
    let mut corners = [[zero; 3]; 3];
    for axis in 0..3 {
        let k = axes.order[axis];
        origin[axis] = I::F4::splat(ray.origin[k]);
        shear[axis] = I::F4::splat(axes.shear[axis]);
        for (to, from) in corners.iter_mut().zip(&block.corners) {
            to[axis] = I::F4::load(&from[k]);
        }
    }
    let [a, b, c] = corners;
    let (a, b, c) =
        (sheared(a, origin, shear), sheared(b, origin, shear), sheared(c, origin, shear));
    meet(a, b, c, shear[2])
}

/// A corner relative to the ray's origin, sheared so that the direction is (0, 0, 1); z is not yet
/// scaled.
#[inline(always)]
pub(super) fn sheared<F: Lanes>(p: [F; 3], origin: [F; 3], shear: [F; 3]) -> [F; 3] {
    let z = p[2].sub(origin[2]);
    [p[0].sub(origin[0]).sub(shear[0].mul(z)), p[1].sub(origin[1]).sub(shear[1].mul(z)), z]
}

/// The rest of the test, operation for operation as [`crate::geometry::triangle`] has it.
#[inline(always)]
pub(super) fn meet<F: Lanes>(a: [F; 3], b: [F; 3], c: [F; 3], scale: F) -> (u32, F) {
    let mut u = c[0].mul(b[1]).sub(c[1].mul(b[0]));
    let mut v = a[0].mul(c[1]).sub(a[1].mul(c[0]));
    let mut w = b[0].mul(a[1]).sub(b[1].mul(a[0]));
    let zero = F::splat(0.0);
    let on_edge = u.eq(zero) | v.eq(zero) | w.eq(zero);
    if on_edge != 0 {
        [u, v, w] = repaired([a, b, c], [u, v, w], on_edge);
    }
    let negative = u.lt(zero) | v.lt(zero) | w.lt(zero);
    let positive = zero.lt(u) | zero.lt(v) | zero.lt(w);
    let det = u.add(v).add(w);
    let mask = F::ALL & !(negative & positive) & !det.eq(zero);
    if mask == 0 {
        return (0, zero);
    }
    let sum = u.mul(scale.mul(a[2])).add(v.mul(scale.mul(b[2]))).add(w.mul(scale.mul(c[2])));
    (mask, sum.div(det))
}

/// Edge functions with exact signs in the lanes that lie on an edge.
#[cold]
#[inline(never)]
fn exact_lanes(corners: [[[f32; 16]; 2]; 3], edges: &mut [[f32; 16]; 3], lanes: u32) {
    let mut lanes = lanes;
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize;
        lanes &= lanes - 1;
        let [a, b, c] = corners.map(|corner| [corner[0][lane], corner[1][lane]]);
        let exact = exact_edges(a, b, c);
        for edge in 0..3 {
            edges[edge][lane] = exact[edge];
        }
    }
}

#[inline(always)]
fn repaired<F: Lanes>(corners: [[F; 3]; 3], edges: [F; 3], lanes: u32) -> [F; 3] {
    let (mut stored, mut stored_edges) = ([[[0.0; 16]; 2]; 3], [[0.0; 16]; 3]);
    for i in 0..3 {
        corners[i][0].store(&mut stored[i][0]);
        corners[i][1].store(&mut stored[i][1]);
        edges[i].store(&mut stored_edges[i]);
    }
    exact_lanes(stored, &mut stored_edges, lanes);
    let [u, v, w] = &stored_edges;
    [F::load(u), F::load(v), F::load(w)]
}

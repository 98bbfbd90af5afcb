//! One ray through the tree: eight boxes at once, then four triangles at once.

use crate::geometry::lanes::{Isa, Lanes, Portable};
use crate::geometry::triangle::{Axes, CERTAIN, exact};
use crate::geometry::wide_bvh::{BLOCK, Block, BoxRay, LEAF, Node, WIDTH, WideBvh};
use crate::geometry::{Nearest, TraversalCost};
use crate::math::Ray;

/// Seven children a level may wait, and the builder keeps the tree below 22 levels: 12 by cost, then
/// ten that divide what is left by eight.
const STACK: usize = 160;

/// What is done with the blocks that a ray may touch. A trait rather than a closure: its method is
/// inlined for certain, into code compiled for the registers that it uses.
trait Visit<I: Isa> {
    /// Told of every node that the ray comes to.
    #[inline(always)]
    fn enter(&mut self) {}

    /// Gives the parameter up to which the ray is still of interest, below 0 to stop.
    fn visit(&mut self, block: &Block, limit: f32) -> f32;
}

struct TakeNearest<'a> {
    ray: &'a Ray,
    axes: Axes,
    object: u32,
    nearest: &'a mut Nearest,
}

struct Counting<'a> {
    take: TakeNearest<'a>,
    cost: &'a mut TraversalCost,
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

/// The nearest hit, and what it took, in the registers that every machine has.
pub(super) fn nearest_counted(
    bvh: &WideBvh,
    ray: &Ray,
    object: u32,
    nearest: &mut Nearest,
    cost: &mut TraversalCost,
) {
    let limit = nearest.t();
    let axes = Axes::new(ray.direction);
    let take = TakeNearest { ray, axes, object, nearest };
    walk::<Portable, _>(bvh, ray, limit, &mut Counting { take, cost });
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
        let candidates = triangles::<I>(block, self.ray, &self.axes, limit);
        let mut left = candidates.mask;
        if left == 0 {
            return limit;
        }
        let corners = candidates.stored();
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            if let Some(t) = corners.decide(lane, self.axes.speed) {
                self.nearest.offer(t, self.object, block.ids[lane]);
            }
        }
        self.nearest.t()
    }
}

impl<I: Isa> Visit<I> for Counting<'_> {
    fn enter(&mut self) {
        self.cost.n_nodes += 1;
    }

    fn visit(&mut self, block: &Block, limit: f32) -> f32 {
        self.cost.n_primitives += BLOCK as u32;
        Visit::<I>::visit(&mut self.take, block, limit)
    }
}

impl<I: Isa> Visit<I> for FindAny<'_> {
    #[inline(always)]
    fn visit(&mut self, block: &Block, limit: f32) -> f32 {
        let candidates = triangles::<I>(block, self.ray, &self.axes, limit);
        let mut left = candidates.mask;
        if left == 0 {
            return limit;
        }
        let corners = candidates.stored();
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let id = block.ids[lane];
            let is_source =
                self.ray.source.object == self.object && self.ray.source.primitive == id;
            let Some(t) = corners.decide(lane, self.axes.speed) else { continue };
            if 0.0 < t && t < self.ray.t_max && !is_source {
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
    let mut stack = Stack::new();
    let mut current = bvh.root;
    loop {
        while current & LEAF == 0 {
            visitor.enter();
            let node: &Node = &bvh.nodes[current as usize];
            let (mut enter, mut leave) = (zero, I::F8::splat(limit));
            for axis in 0..3 {
                let near = I::F8::load(&node.bounds[near_rows[axis]]);
                let far = I::F8::load(&node.bounds[far_rows[axis]]);
                enter = enter.max(near.mul_sub(scales[axis], near_origin[axis]));
                leave = leave.min(far.mul_sub(scales[axis], far_origin[axis]));
            }
            let hits = enter.le(leave) & ((1 << node.n_children) - 1);
            if hits == 0 {
                break;
            }
            let mut ts = [0.0; WIDTH];
            enter.store(&mut ts);
            current = stack.descend(node, hits, &ts);
        }
        if current & LEAF != 0 {
            limit = visitor.visit(&bvh.blocks[(current & !LEAF) as usize], limit);
        }
        match stack.pop(limit) {
            Some(reference) => current = reference,
            None => return,
        }
    }
}

/// References that wait for their turn, each with the parameter at which it is entered.
pub(super) struct Stack {
    entries: [(u32, f32); STACK],
    n: usize,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { entries: [(0, 0.0); STACK], n: 0 }
    }

    /// The nearest of the children that are hit (at least one); the others wait, sorted, the
    /// nearest on top.
    #[inline(always)]
    pub(super) fn descend(&mut self, node: &Node, mut hits: u32, ts: &[f32; WIDTH]) -> u32 {
        let first = hits.trailing_zeros() as usize;
        hits &= hits - 1;
        let (mut nearest, mut nearest_t) = (node.children[first], ts[first]);
        let base = self.n;
        while hits != 0 {
            let child = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let mut entry = (node.children[child], ts[child]);
            if entry.1 < nearest_t {
                std::mem::swap(&mut entry.0, &mut nearest);
                std::mem::swap(&mut entry.1, &mut nearest_t);
            }
            let mut place = self.n;
            while place > base && self.entries[place - 1].1 < entry.1 {
                self.entries[place] = self.entries[place - 1];
                place -= 1;
            }
            self.entries[place] = entry;
            self.n += 1;
        }
        nearest
    }

    /// The next one that is entered before the limit.
    #[inline(always)]
    pub(super) fn pop(&mut self, limit: f32) -> Option<u32> {
        while self.n > 0 {
            self.n -= 1;
            let (reference, t) = self.entries[self.n];
            if t <= limit {
                return Some(reference);
            }
        }
        None
    }
}

/// One ray against four triangles.
#[inline(always)]
fn triangles<I: Isa>(block: &Block, ray: &Ray, axes: &Axes, limit: f32) -> Candidates<I::F4> {
    let zero = I::F4::splat(0.0);
    let (mut origin, mut corners) = ([zero; 3], [[zero; 3]; 3]);
    for axis in 0..3 {
        let k = axes.order[axis];
        origin[axis] = I::F4::splat(ray.origin[k]);
        for (to, from) in corners.iter_mut().zip(&block.corners) {
            to[axis] = I::F4::load(&from[k]);
        }
    }
    let shear = [I::F4::splat(axes.shear[0]), I::F4::splat(axes.shear[1])];
    let [a, b, c] = corners;
    let corners = [sheared(a, origin, shear), sheared(b, origin, shear), sheared(c, origin, shear)];
    Candidates::new(corners, I::F4::splat(1.0 / axes.speed), I::F4::splat(limit))
}

/// A corner relative to the ray's origin, sheared so that the direction is along z.
#[inline(always)]
pub(super) fn sheared<F: Lanes>(p: [F; 3], origin: [F; 3], shear: [F; 2]) -> [F; 3] {
    let z = p[2].sub(origin[2]);
    [p[0].sub(origin[0]).sub(shear[0].mul(z)), p[1].sub(origin[1]).sub(shear[1].mul(z)), z]
}

/// Pairs of a ray and a triangle that may meet before the limit: the rest certainly does not.
///
/// The corners are those of [`crate::geometry::triangle`] to the bit, so that what decides is the
/// same everywhere: [`exact`].
pub(super) struct Candidates<F> {
    pub(super) mask: u32,
    corners: [[F; 3]; 3],
}

impl<F: Lanes> Candidates<F> {
    /// `pace` is 1 over the direction's largest component.
    #[inline(always)]
    pub(super) fn new(corners: [[F; 3]; 3], pace: F, limit: F) -> Self {
        let [a, b, c] = corners;
        let zero = F::splat(0.0);
        let (mut below, mut above) = (0, 0);
        let (is_below, is_above) = certain_signs(c, b);
        below |= is_below;
        above |= is_above;
        let (is_below, is_above) = certain_signs(a, c);
        below |= is_below;
        above |= is_above;
        let (is_below, is_above) = certain_signs(b, a);
        below |= is_below;
        above |= is_above;
        let mut mask = F::ALL & !(below & above);
        if mask != 0 {
            // The parameter lies between those of the corners, give or take the rounding.
            let (t_a, t_b, t_c) = (a[2].mul(pace), b[2].mul(pace), c[2].mul(pace));
            let least = t_a.min(t_b).min(t_c);
            let slack = F::splat(1.0 - 1e-6).mul(least);
            mask &= least.min(slack).le(limit) & zero.le(limit);
            mask &= zero.lt(t_a.max(t_b).max(t_c));
        }
        Self { mask, corners }
    }

    /// The corners in memory, for [`StoredCorners::decide`].
    #[inline(always)]
    pub(super) fn stored(&self) -> StoredCorners<F> {
        let [a, b, c] = self.corners;
        StoredCorners([
            [a[0].stored(), a[1].stored(), a[2].stored()],
            [b[0].stored(), b[1].stored(), b[2].stored()],
            [c[0].stored(), c[1].stored(), c[2].stored()],
        ])
    }
}

/// Corners in sheared space, lane by lane.
pub(super) struct StoredCorners<F: Lanes>([[F::Stored; 3]; 3]);

impl<F: Lanes> StoredCorners<F> {
    /// The exact test of one lane.
    #[inline(always)]
    pub(super) fn decide(&self, lane: usize, speed: f32) -> Option<f32> {
        let mut corners = [[0.0; 3]; 3];
        for (to, from) in corners.iter_mut().zip(&self.0) {
            for (to, from) in to.iter_mut().zip(from) {
                *to = from[lane];
            }
        }
        let [a, b, c] = corners;
        exact(a, b, c, speed)
    }
}

/// Where the area between the rays and the edges is certainly below 0, and where above.
#[inline(always)]
fn certain_signs<F: Lanes>(p: [F; 3], q: [F; 3]) -> (u32, u32) {
    let zero = F::splat(0.0);
    let product = p[0].mul(q[1]);
    let value = product.sub(p[1].mul(q[0]));
    let error = F::splat(CERTAIN).mul(product.max(zero.sub(product)));
    (value.lt(zero.sub(error)), error.lt(value))
}

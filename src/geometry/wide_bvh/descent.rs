//! The way of one ray down the tree: eight boxes at once, then four triangles at once, one step at
//! a time, so that a caller can have several rays under way.
//!
//! A step has few branches that depend on the ray: all children that are hit are put on a stack
//! in one go, sorted by a network, and the next is taken from its top.

use crate::geometry::lanes::{Isa, Lanes, key_of};
use crate::geometry::triangle::Axes;
use crate::geometry::wide_bvh::stream::Take;
use crate::geometry::wide_bvh::{BLOCK, Block, LEAF, Node, WIDTH, WideBvh, leaf};
use crate::math::Ray;

/// Seven children a level may wait, the builder keeps the tree below 22 levels (12 by cost, then
/// ten that divide what is left by eight), a step overwrites eight places, and a ray may begin at
/// some.
const STACK: usize = 168 + STARTS;
/// Places where a ray may begin.
pub(super) const STARTS: usize = 12;

/// What the stack ends with.
pub(super) const DONE: u32 = u32::MAX;

/// A place where a ray begins, and the parameter at which it enters it.
#[derive(Clone, Copy, Default)]
pub(super) struct Start {
    pub(super) reference: u32,
    pub(super) enter: f32,
}

/// One ray under way.
pub(super) struct Descent {
    /// Where the ray is: a node, a block, or [`DONE`].
    pub(super) current: u32,
    /// Up to where hits are of interest.
    pub(super) limit: f32,
    near_rows: [usize; 3],
    reciprocal: [f32; 3],
    /// Origins, moved outwards by the bound of rounding errors, times the reciprocals.
    near_origin: [f32; 3],
    far_origin: [f32; 3],
    axes: Axes,
    pace: f32,
    /// By the axes' order.
    origin: [f32; 3],
    n_waiting: usize,
    keys: [u32; STACK],
    references: [u32; STACK],
}

impl Descent {
    /// A place for a ray.
    pub(super) const IDLE: Self = Self {
        current: DONE,
        limit: 0.0,
        near_rows: [0; 3],
        reciprocal: [0.0; 3],
        near_origin: [0.0; 3],
        far_origin: [0.0; 3],
        axes: Axes { order: [0; 3], shear: [0.0; 2], speed: 1.0 },
        pace: 0.0,
        origin: [0.0; 3],
        n_waiting: 0,
        keys: [0; STACK],
        references: [DONE; STACK],
    };

    /// Puts a ray of object space at the root.
    #[inline(always)]
    pub(super) fn start(&mut self, bvh: &WideBvh, ray: &Ray, limit: f32) {
        self.aim(bvh, ray, limit);
        self.current = bvh.root;
        self.n_waiting = 1;
    }

    /// Puts a ray of object space where it has come to: at most [`STARTS`] places.
    #[inline(always)]
    pub(super) fn go_on<T: Take>(
        &mut self,
        bvh: &WideBvh,
        ray: &Ray,
        limit: f32,
        starts: &[Start],
    ) {
        self.aim(bvh, ray, limit);
        self.n_waiting = 1;
        for start in starts {
            let key = key_of(start.enter);
            let mut place = self.n_waiting;
            while T::SORTED && place > 1 && self.keys[place - 1] > key {
                self.keys[place] = self.keys[place - 1];
                self.references[place] = self.references[place - 1];
                place -= 1;
            }
            self.keys[place] = key;
            self.references[place] = start.reference;
            self.n_waiting += 1;
        }
        self.leave::<T>();
    }

    /// What the tests of a ray need.
    #[inline(always)]
    fn aim(&mut self, bvh: &WideBvh, ray: &Ray, limit: f32) {
        let pad = (ray.origin.abs().max_element() + bvh.magnitude) * WideBvh::ROUNDING;
        for axis in 0..3 {
            let reciprocal = 1.0 / WideBvh::not_tiny(ray.direction[axis]);
            let is_negative = reciprocal < 0.0;
            let outwards = if is_negative { -pad } else { pad };
            self.near_rows[axis] = if is_negative { axis + 3 } else { axis };
            self.reciprocal[axis] = reciprocal;
            self.near_origin[axis] = (ray.origin[axis] + outwards) * reciprocal;
            self.far_origin[axis] = (ray.origin[axis] - outwards) * reciprocal;
        }
        self.axes = Axes::new(ray.direction);
        self.pace = 1.0 / self.axes.speed;
        for (to, axis) in self.origin.iter_mut().zip(self.axes.order) {
            *to = ray.origin[axis];
        }
        self.limit = limit;
    }

    /// Tests the children of the current node and goes to the nearest that is hit, or back to
    /// where a child waits.
    #[inline(always)]
    pub(super) fn enter<I: Isa, T: Take>(&mut self, node: &Node) {
        let (mut enter, mut leave) = (I::F8::splat(0.0), I::F8::splat(self.limit));
        for axis in 0..3 {
            let row = self.near_rows[axis];
            let far_row = if row == axis { axis + 3 } else { axis };
            let scale = I::F8::splat(self.reciprocal[axis]);
            let near = I::row(&node.bounds, row);
            let far = I::row(&node.bounds, far_row);
            enter = near.mul_sub(scale, I::F8::splat(self.near_origin[axis])).max(enter);
            leave = far.mul_sub(scale, I::F8::splat(self.far_origin[axis])).min(leave);
        }
        let hits = enter.le(leave);
        let place = self.n_waiting;
        let keys: &mut [u32; WIDTH] = places(&mut self.keys, place);
        let references: &mut [u32; WIDTH] = places(&mut self.references, place);
        if T::SORTED {
            I::push_sorted(enter, hits, &node.children, keys, references);
        } else {
            I::push_unsorted(hits, &node.children, references);
        }
        self.n_waiting += hits.count_ones() as usize;
        self.leave::<T>();
    }

    /// Goes to the next place that waits before the limit.
    #[inline(always)]
    fn leave<T: Take>(&mut self) {
        let limit = key_of(self.limit);
        loop {
            self.n_waiting -= 1;
            self.current = self.references[self.n_waiting];
            if !T::SORTED || self.n_waiting == 0 || self.keys[self.n_waiting] | 7 >= limit {
                return;
            }
        }
    }

    /// Offers what the ray meets in the current block, and goes to the next place.
    #[inline(always)]
    pub(super) fn visit<I: Isa, T: Take>(&mut self, bvh: &WideBvh, ray: usize, hits: &mut T) {
        let block = &bvh.blocks[(self.current & !LEAF) as usize];
        if let Some((mut mask, parameters)) = self.hits::<I, T>(block) {
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                self.limit = hits.take(ray, parameters[lane], block.ids[lane]);
                if self.limit < 0.0 {
                    self.current = DONE;
                    return;
                }
            }
        }
        self.leave::<T>();
    }

    /// Where the ray meets the triangles of a block before its limit.
    #[inline(always)]
    fn hits<I: Isa, T: Take>(&self, block: &Block) -> Option<(u32, [f32; BLOCK])> {
        let shear = [I::F4::splat(self.axes.shear[0]), I::F4::splat(self.axes.shear[1])];
        let [a, b, c] = &block.corners;
        let corners = [
            leaf::sheared(self.relative::<I>(a), shear),
            leaf::sheared(self.relative::<I>(b), shear),
            leaf::sheared(self.relative::<I>(c), shear),
        ];
        let (speed, pace) = (I::F4::splat(self.axes.speed), I::F4::splat(self.pace));
        let (mask, t) = leaf::hits::<_, T>(corners, speed, pace, I::F4::splat(self.limit))?;
        let mut parameters = [0.0; BLOCK];
        t.store(&mut parameters);
        Some((mask, parameters))
    }

    /// A corner of four triangles as seen from the origin, by the axes' order.
    #[inline(always)]
    fn relative<I: Isa>(&self, corner: &[[f32; BLOCK]; 3]) -> [I::F4; 3] {
        let [x, y, z] = self.axes.order;
        [
            I::F4::load(&corner[x]).sub(I::F4::splat(self.origin[0])),
            I::F4::load(&corner[y]).sub(I::F4::splat(self.origin[1])),
            I::F4::load(&corner[z]).sub(I::F4::splat(self.origin[2])),
        ]
    }
}

/// Eight places of a stack.
#[inline(always)]
fn places(stack: &mut [u32; STACK], first: usize) -> &mut [u32; WIDTH] {
    stack[first..].first_chunk_mut().expect("the depth of the tree bounds the stack")
}

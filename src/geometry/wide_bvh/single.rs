//! One ray through the tree.

use crate::geometry::TraversalCost;
use crate::geometry::lanes::{Isa, Portable};
use crate::geometry::nearest::Search;
use crate::geometry::wide_bvh::descent::{DONE, Descent};
use crate::geometry::wide_bvh::stream::{Take, TakeAny};
use crate::geometry::wide_bvh::{BLOCK, LEAF, WideBvh};
use crate::math::{PrimitiveId, Ray};

/// Offers hits to the search of one ray.
struct TakeOne<'a> {
    search: &'a mut Search,
    object: u32,
}

impl Take for TakeOne<'_> {
    const SORTED: bool = true;

    #[inline(always)]
    fn limit(&self, _: usize) -> f32 {
        self.search.nearest.t()
    }
    #[inline(always)]
    fn take(&mut self, _: usize, t: f32, primitive: u32) -> f32 {
        self.search.offer(t, PrimitiveId { object: self.object, primitive });
        self.search.nearest.t()
    }
}

/// The hit that the search is for.
#[inline(always)]
pub(super) fn nearest<I: Isa>(bvh: &WideBvh, ray: &Ray, object: u32, search: &mut Search) {
    trace::<I, _>(bvh, ray, &mut TakeOne { search, object });
}

/// The same, with what it takes, in the arithmetic that every machine has.
pub(super) fn nearest_counted(
    bvh: &WideBvh,
    ray: &Ray,
    object: u32,
    search: &mut Search,
    cost: &mut TraversalCost,
) {
    let mut hits = TakeOne { search, object };
    let mut descent = Descent::IDLE;
    descent.start(bvh, ray, hits.limit(0));
    while descent.current != DONE {
        if descent.current & LEAF == 0 {
            cost.n_nodes += 1;
            descent.enter::<Portable, TakeOne<'_>>(&bvh.nodes[descent.current as usize]);
        } else {
            cost.n_primitives += BLOCK as u32;
            descent.visit::<Portable, _>(bvh, 0, &mut hits);
        }
    }
}

/// Whether there is any hit.
#[inline(always)]
pub(super) fn blocked<I: Isa>(bvh: &WideBvh, ray: &Ray, object: u32) -> bool {
    let mut blocked = [false];
    let (t_max, source) = (&[ray.t_max], &[ray.source]);
    trace::<I, _>(bvh, ray, &mut TakeAny { blocked: &mut blocked, t_max, source, object });
    blocked[0]
}

#[inline(always)]
fn trace<I: Isa, T: Take>(bvh: &WideBvh, ray: &Ray, hits: &mut T) {
    let limit = hits.limit(0);
    if limit < 0.0 {
        return;
    }
    let mut descent = Descent::IDLE;
    descent.start(bvh, ray, limit);
    while descent.current != DONE {
        if descent.current & LEAF == 0 {
            descent.enter::<I, T>(&bvh.nodes[descent.current as usize]);
        } else {
            descent.visit::<I, T>(bvh, 0, hits);
        }
    }
}

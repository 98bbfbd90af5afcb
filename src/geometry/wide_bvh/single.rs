//! One ray through the tree.

use crate::geometry::TraversalCost;
use crate::geometry::lanes::{Isa, Portable};
use crate::geometry::nearest::Search;
use crate::geometry::wide_bvh::descent::{DONE, Descent};
use crate::geometry::wide_bvh::stream::{Fleet, Take};
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

/// The hits that the search is for.
#[inline(always)]
pub(super) fn nearest<I: Isa>(
    bvh: &WideBvh,
    ray: &Ray,
    fleet: &mut Fleet,
    object: u32,
    search: &mut Search,
) {
    let mut hits = TakeOne { search, object };
    let limit = hits.limit(0);
    if limit < 0.0 {
        return;
    }
    let descent = fleet.single();
    descent.start(bvh, ray, limit);
    while descent.current != DONE {
        if descent.current & LEAF == 0 {
            descent.enter::<I, TakeOne<'_>>(&bvh.nodes[descent.current as usize]);
        } else {
            descent.visit::<I, _>(bvh, 0, &mut hits);
        }
    }
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

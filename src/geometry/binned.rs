//! Dividing boxes by the surface area heuristic at bins, for hierarchies of bounding volumes.
//!
//! Source: I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE RT 2007.

use std::sync::atomic::AtomicBool;

use glam::Vec3;

use crate::geometry::Stopped;
use crate::geometry::kd_tree::Item;
use crate::math::Aabb;

/// Bins along an axis: more for ranges of many items, where they cost little beside the items.
const FEW_BINS: usize = 16;
const MANY_BINS: usize = 32;
const MANY_ITEMS: usize = 1024;

/// Ranges of more items are divided in parallel, and only if that is still wanted.
pub(super) const LARGE: usize = 4096;

/// A deeper tree is cut in equal parts, which bounds its depth.
const SAH_DEPTH: u32 = 12;

/// Items that belong together.
pub(super) struct Range<'a> {
    pub(super) items: &'a mut [Item],
    pub(super) bounds: Aabb,
}

impl<'a> Range<'a> {
    /// Around some items.
    pub(super) fn new(items: &'a mut [Item]) -> Self {
        let bounds = items.iter().fold(Aabb::EMPTY, |all, item| all.union(item.bounds));
        Self { items, bounds }
    }

    /// Divides a range at some depth of a tree again and again, until it is `width` children or each
    /// has no more than `LEAF` items: always the child of the largest surface.
    ///
    /// # Errors
    /// [`Stopped`], looked at where the range is large.
    pub(super) fn open<const LEAF: usize>(
        self,
        width: usize,
        depth: u32,
        stop: &AtomicBool,
    ) -> Result<Vec<Self>, Stopped> {
        let is_large = self.items.len() > LARGE;
        let mut ranges = Vec::with_capacity(width);
        ranges.push(self);
        while ranges.len() < width {
            // Deep down, and of equal surfaces, the one of most items: so the parts get equal.
            let area =
                |i: usize| if depth < SAH_DEPTH { ranges[i].bounds.half_area() } else { 0.0 };
            let order = |a: &usize, b: &usize| {
                let by_number = ranges[*a].items.len().cmp(&ranges[*b].items.len());
                area(*a).total_cmp(&area(*b)).then(by_number)
            };
            let widest = (0..ranges.len()).filter(|i| ranges[*i].items.len() > LEAF).max_by(order);
            let Some(widest) = widest else { break };
            if is_large {
                Stopped::check(stop)?;
            }
            let (lower, upper) = split::<LEAF>(ranges.swap_remove(widest), depth);
            ranges.push(lower);
            ranges.push(upper);
        }
        Ok(ranges)
    }
}

/// Twice the centre of an item's bounds.
fn center2(item: &Item) -> Vec3 {
    item.bounds.min + item.bounds.max
}

/// Two ranges from one of more than a leaf.
fn split<'a, const LEAF: usize>(range: Range<'a>, depth: u32) -> (Range<'a>, Range<'a>) {
    let centers = range.items.iter().fold(Aabb::EMPTY, |mut all, item| {
        all.grow(center2(item));
        all
    });
    let cut = if depth >= SAH_DEPTH {
        None
    } else if range.items.len() < MANY_ITEMS {
        best_cut::<LEAF, FEW_BINS>(&range, &centers)
    } else {
        best_cut::<LEAF, MANY_BINS>(&range, &centers)
    };
    let middle = match cut {
        Some(cut) => partition(range.items, &cut),
        None => {
            // Whole leaves, but for the last.
            let middle = (range.items.len() / 2).next_multiple_of(LEAF);
            let axis = longest_axis(&range.bounds);
            // Of equal ones, any half will do.
            if centers.extent()[axis] > 0.0 {
                range.items.select_nth_unstable_by(middle, |a, b| {
                    let order = center2(a)[axis].total_cmp(&center2(b)[axis]);
                    order.then(a.id.cmp(&b.id))
                });
            }
            middle
        }
    };
    let (lower, upper) = range.items.split_at_mut(middle);
    (Range::new(lower), Range::new(upper))
}

fn longest_axis(bounds: &Aabb) -> usize {
    let e = bounds.extent();
    if e.x >= e.y && e.x >= e.z {
        0
    } else if e.y >= e.z {
        1
    } else {
        2
    }
}

/// Items whose centre falls into a bin below `border` along `axis` go to one side.
struct Cut {
    axis: usize,
    border: usize,
    low: f32,
    scale: f32,
    n_bins: usize,
}

#[inline(always)]
fn bin(low: f32, scale: f32, n_bins: usize, x: f32) -> usize {
    (((x - low) * scale) as usize).min(n_bins - 1)
}

/// The cut of least cost; none where the centres are one.
fn best_cut<const LEAF: usize, const N_BINS: usize>(
    range: &Range<'_>,
    centers: &Aabb,
) -> Option<Cut> {
    let extent = centers.extent();
    let scale = Vec3::splat(N_BINS as f32) / extent;
    // Not flat along that axis, nor so small that its reciprocal overflows.
    let has_bins = |axis: usize| extent[axis] > 0.0 && scale[axis].is_finite();
    if !(0..3).any(has_bins) {
        return None;
    }
    let mut bins = [[(Aabb::EMPTY, 0_usize); N_BINS]; 3];
    for item in range.items.iter() {
        let center = center2(item);
        for axis in 0..3 {
            let bin = bin(centers.min[axis], scale[axis], N_BINS, center[axis]);
            let entry = &mut bins[axis][bin];
            entry.0 = entry.0.union(item.bounds);
            entry.1 += 1;
        }
    }
    let mut best: Option<(f32, Cut)> = None;
    for axis in 0..3 {
        if !has_bins(axis) {
            continue;
        }
        let cost = |area: f32, n: usize| area * n.div_ceil(LEAF) as f32;
        let mut upper_costs = [0.0; N_BINS];
        let (mut bounds, mut n) = (Aabb::EMPTY, 0);
        for border in (1..N_BINS).rev() {
            bounds = bounds.union(bins[axis][border].0);
            n += bins[axis][border].1;
            upper_costs[border] = cost(bounds.half_area(), n);
        }
        let (mut bounds, mut n) = (Aabb::EMPTY, 0);
        for border in 1..N_BINS {
            bounds = bounds.union(bins[axis][border - 1].0);
            n += bins[axis][border - 1].1;
            if n == 0 || n == range.items.len() {
                continue;
            }
            let total = cost(bounds.half_area(), n) + upper_costs[border];
            if best.as_ref().is_none_or(|(least, _)| total < *least) {
                let (low, scale) = (centers.min[axis], scale[axis]);
                best = Some((total, Cut { axis, border, low, scale, n_bins: N_BINS }));
            }
        }
    }
    best.map(|(_, cut)| cut)
}

/// Puts the items of the lower side first, in a fixed order; gives how many they are.
fn partition(items: &mut [Item], cut: &Cut) -> usize {
    let is_lower =
        |item: &Item| bin(cut.low, cut.scale, cut.n_bins, center2(item)[cut.axis]) < cut.border;
    let (mut first, mut last) = (0, items.len());
    loop {
        while first < last && is_lower(&items[first]) {
            first += 1;
        }
        while first < last && !is_lower(&items[last - 1]) {
            last -= 1;
        }
        if first >= last {
            return first;
        }
        items.swap(first, last - 1);
    }
}

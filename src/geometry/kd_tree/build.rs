//! Building a kd-tree: where to cut, and when to stop.
//!
//! Source of the heuristic and of clipped ("perfect") splits: I. Wald and V. Havran, "On building
//! fast kd-Trees for Ray Tracing, and on doing that in O(N log N)", IEEE RT 2006. Large nodes are
//! cut at the borders of bins and small ones at every border of an item, so that the whole build
//! is O(n log n).
//!
//! An item that a cut goes through is in both halves. Thousands of triangles in one place, or in a
//! fan of needles, would be in almost every leaf: memory and time would grow with the number of
//! leaves. So every tree has a budget of such copies, handed down in proportion to the items, and
//! what would cost more stays a leaf.

use std::sync::atomic::AtomicBool;

use crate::geometry::Stopped;
use crate::geometry::kd_tree::traverse::MAX_DEPTH;
use crate::geometry::kd_tree::{KdTree, Node};
use crate::math::Aabb;

/// A cut that leaves one side empty counts as this share of its tests.
const EMPTY_BONUS: f32 = 0.8;
/// Nodes of more items are cut at bins.
const EXACT_LIMIT: usize = 16;
const N_BINS: usize = 32;
/// Subtrees of more items are built in parallel.
const PARALLEL_LIMIT: usize = 4096;
/// Copies that a tree may have for each of its items, and beside those.
const COPIES_AN_ITEM: usize = 16;
const FREE_COPIES: usize = 1024;

/// How cuts are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Split {
    /// In the middle of the longest side.
    Midpoint,
    /// Where the surface area heuristic expects the least work, if the test of an item costs as much as
    /// so many steps from node to node.
    SurfaceArea {
        /// Above 0.
        item_cost: f32,
    },
}

/// An item of the tree and the part of its bounds inside the current cell.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// The caller's index.
    pub id: u32,
    /// Its bounds.
    pub bounds: Aabb,
}

/// Builds a tree over items with non-empty bounds. `clip` gives the bounds of what an item has
/// inside a box; it may be larger, and empty where there is nothing. `stop` is looked at before
/// every large cut.
///
/// # Errors
/// [`Stopped`].
pub fn build(
    items: Vec<Item>,
    split: Split,
    clip: &(impl Fn(u32, Aabb) -> Aabb + Sync),
    stop: &AtomicBool,
) -> Result<KdTree, Stopped> {
    let bounds = items.iter().fold(Aabb::EMPTY, |all, item| all.union(item.bounds));
    let log = usize::BITS - items.len().leading_zeros();
    let max_depth = (8 + (1.3 * log as f32) as usize).min(MAX_DEPTH);
    let builder = Builder { split, clip, stop };
    let n_copies = COPIES_AN_ITEM * items.len() + FREE_COPIES;
    let root = builder.node(items, bounds, Allowance { depth: max_depth, n_copies, n_bad: 0 })?;
    let mut tree = KdTree { bounds, nodes: Vec::new(), items: Vec::new() };
    flatten(&root, &mut tree);
    Ok(tree)
}

enum BuildNode {
    Leaf(Vec<u32>),
    Inner { axis: usize, plane: f32, children: Box<[Self; 2]> },
}

struct Builder<'a, C> {
    split: Split,
    clip: &'a C,
    stop: &'a AtomicBool,
}

/// What is left for a subtree.
#[derive(Clone, Copy)]
struct Allowance {
    /// Levels below its root.
    depth: usize,
    /// Items that may be in both halves of a cut.
    n_copies: usize,
    /// Bad cuts above it.
    n_bad: u32,
}

#[derive(Clone, Copy)]
struct Cut {
    axis: usize,
    plane: f32,
    /// Tests to expect below it.
    n_tests: f32,
}

impl<C: Fn(u32, Aabb) -> Aabb + Sync> Builder<'_, C> {
    fn node(&self, items: Vec<Item>, cell: Aabb, allowed: Allowance) -> Result<BuildNode, Stopped> {
        let Allowance { depth, n_copies, n_bad } = allowed;
        let is_large = items.len() > PARALLEL_LIMIT;
        if is_large {
            Stopped::check(self.stop)?;
        }
        let (cut, n_bad) = match self.split {
            Split::Midpoint => (midpoint(&items, &cell), 0),
            Split::SurfaceArea { item_cost } => {
                let cut = best_cut(&items, &cell);
                let n_saved = |cut: Cut| items.len() as f32 - cut.n_tests;
                let is_bad = cut.is_none_or(|cut| item_cost * n_saved(cut) <= 1.0);
                (cut, n_bad + u32::from(is_bad))
            }
        };
        // A bad cut may be followed by good ones, so a few are allowed while there is much to gain.
        let is_hopeless = n_bad > 0 && items.len() <= 16 || n_bad >= 3;
        let is_affordable = |cut: &Cut| n_copies_of(&items, *cut) <= n_copies;
        let cut = cut.filter(|cut| depth > 0 && !is_hopeless && is_affordable(cut));
        let Some(cut) = cut else {
            return Ok(BuildNode::Leaf(items.iter().map(|item| item.id).collect()));
        };
        let n_left = n_copies - n_copies_of(&items, cut);
        let (lower_items, upper_items) = self.distribute(items, &cell, cut);
        let (mut lower_cell, mut upper_cell) = (cell, cell);
        lower_cell.max[cut.axis] = cut.plane;
        upper_cell.min[cut.axis] = cut.plane;
        let n_in_halves = (lower_items.len() + upper_items.len()).max(1);
        let lower_copies =
            (n_left as u128 * lower_items.len() as u128 / n_in_halves as u128) as usize;
        let below = |n_copies| Allowance { depth: depth - 1, n_copies, n_bad };
        let lower = || self.node(lower_items, lower_cell, below(lower_copies));
        let upper = || self.node(upper_items, upper_cell, below(n_left - lower_copies));
        let (lower, upper) = if is_large { rayon::join(lower, upper) } else { (lower(), upper()) };
        let children = Box::new([lower?, upper?]);
        Ok(BuildNode::Inner { axis: cut.axis, plane: cut.plane, children })
    }

    /// Items below, above, and on both sides; the last are clipped to each.
    fn distribute(&self, items: Vec<Item>, cell: &Aabb, cut: Cut) -> (Vec<Item>, Vec<Item>) {
        let Cut { axis, plane, .. } = cut;
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        let (mut lower_cell, mut upper_cell) = (*cell, *cell);
        lower_cell.max[axis] = plane;
        upper_cell.min[axis] = plane;
        for item in items {
            let (low, high) = (item.bounds.min[axis], item.bounds.max[axis]);
            if high <= plane {
                lower.push(item);
            } else if low >= plane {
                upper.push(item);
            } else {
                for (side, side_cell) in [(&mut lower, lower_cell), (&mut upper, upper_cell)] {
                    let bounds = (self.clip)(item.id, side_cell).intersection(item.bounds);
                    if !bounds.is_empty() {
                        side.push(Item { id: item.id, bounds });
                    }
                }
            }
        }
        (lower, upper)
    }
}

/// How many items a cut goes through.
fn n_copies_of(items: &[Item], cut: Cut) -> usize {
    let is_cut = |item: &&Item| {
        item.bounds.min[cut.axis] < cut.plane && cut.plane < item.bounds.max[cut.axis]
    };
    items.iter().filter(is_cut).count()
}

/// The middle of the longest side; `None` where the cell is small enough or flat.
fn midpoint(items: &[Item], cell: &Aabb) -> Option<Cut> {
    const LEAF_ITEMS: usize = 8;
    let extent = cell.extent();
    let axis = longest_axis(extent.to_array());
    let plane = cell.center()[axis];
    let is_inside = cell.min[axis] < plane && plane < cell.max[axis];
    (items.len() > LEAF_ITEMS && is_inside).then_some(Cut { axis, plane, n_tests: 0.0 })
}

fn longest_axis(extent: [f32; 3]) -> usize {
    let xy = if extent[1] > extent[0] { 1 } else { 0 };
    if extent[2] > extent[xy] { 2 } else { xy }
}

/// The cut below which the fewest tests are to be expected of a ray through the cell.
fn best_cut(items: &[Item], cell: &Aabb) -> Option<Cut> {
    if items.is_empty() || cell.half_area() <= 0.0 {
        return None;
    }
    let mut best: Option<Cut> = None;
    for axis in 0..3 {
        if items.len() > EXACT_LIMIT {
            cuts_at_bins(items, cell, axis, &mut best);
        } else {
            cuts_at_borders(items, cell, axis, &mut best);
        }
    }
    best
}

fn consider(cell: &Aabb, axis: usize, plane: f32, counts: [usize; 2], best: &mut Option<Cut>) {
    if !(cell.min[axis] < plane && plane < cell.max[axis]) {
        return;
    }
    let (mut lower, mut upper) = (*cell, *cell);
    lower.max[axis] = plane;
    upper.min[axis] = plane;
    let scale = 1.0 / cell.half_area();
    let work = lower.half_area() * counts[0] as f32 + upper.half_area() * counts[1] as f32;
    let bonus = if counts.contains(&0) { EMPTY_BONUS } else { 1.0 };
    let n_tests = bonus * scale * work;
    if best.is_none_or(|b| n_tests < b.n_tests) {
        *best = Some(Cut { axis, plane, n_tests });
    }
}

/// Candidates at the borders of equal bins; an item counts below if it begins in a lower bin, and
/// above if it ends in a higher one.
fn cuts_at_bins(items: &[Item], cell: &Aabb, axis: usize, best: &mut Option<Cut>) {
    let (low, extent) = (cell.min[axis], cell.extent()[axis]);
    let scale = N_BINS as f32 / extent;
    if !scale.is_finite() {
        return;
    }
    let bin = |x: f32| (((x - low) * scale) as usize).min(N_BINS - 1);
    let (mut starts, mut ends) = ([0_usize; N_BINS], [0_usize; N_BINS]);
    for item in items {
        starts[bin(item.bounds.min[axis])] += 1;
        ends[bin(item.bounds.max[axis])] += 1;
    }
    let (mut n_lower, mut n_upper) = (0, items.len());
    for border in 1..N_BINS {
        n_lower += starts[border - 1];
        n_upper -= ends[border - 1];
        consider(cell, axis, low + border as f32 / scale, [n_lower, n_upper], best);
    }
}

/// Candidates at every border of an item, by one sweep over the sorted borders.
fn cuts_at_borders(items: &[Item], cell: &Aabb, axis: usize, best: &mut Option<Cut>) {
    let mut starts: Vec<f32> = items.iter().map(|item| item.bounds.min[axis]).collect();
    let mut ends: Vec<f32> = items.iter().map(|item| item.bounds.max[axis]).collect();
    let flat = items.iter().filter(|item| item.bounds.min[axis] == item.bounds.max[axis]);
    let mut flats: Vec<f32> = flat.map(|item| item.bounds.min[axis]).collect();
    for borders in [&mut starts, &mut ends, &mut flats] {
        borders.sort_unstable_by(f32::total_cmp);
    }
    let (mut n_started, mut n_ended, mut n_flat) = (0, 0, 0);
    while n_ended < ends.len() {
        let is_start = n_started < starts.len() && starts[n_started] < ends[n_ended];
        let plane = if is_start { starts[n_started] } else { ends[n_ended] };
        while n_ended < ends.len() && ends[n_ended] <= plane {
            n_ended += 1;
        }
        // Items that begin here lie above, unless they are flat and end here too.
        let flats_before = n_flat;
        while n_flat < flats.len() && flats[n_flat] <= plane {
            n_flat += 1;
        }
        let n_lower = n_started + (n_flat - flats_before);
        consider(cell, axis, plane, [n_lower, items.len() - n_ended], best);
        while n_started < starts.len() && starts[n_started] <= plane {
            n_started += 1;
        }
    }
}

fn flatten(node: &BuildNode, tree: &mut KdTree) {
    match node {
        BuildNode::Leaf(ids) => {
            tree.nodes.push(Node::leaf(tree.items.len() as u32, ids.len() as u32));
            tree.items.extend(ids);
        }
        BuildNode::Inner { axis, plane, children } => {
            let id = tree.nodes.len();
            tree.nodes.push(Node::leaf(0, 0));
            flatten(&children[0], tree);
            tree.nodes[id] = Node::inner(*axis, *plane, tree.nodes.len() as u32);
            flatten(&children[1], tree);
        }
    }
}

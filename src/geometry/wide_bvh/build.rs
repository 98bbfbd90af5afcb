//! Building a wide bounding volume hierarchy by the surface area heuristic at bins.
//!
//! Source: I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE RT 2007.
//! A node is opened until it has eight children: always the child of the largest surface.

use std::sync::atomic::AtomicBool;

use glam::Vec3;

use crate::geometry::Stopped;
use crate::geometry::mesh::Mesh;
use crate::geometry::wide_bvh::{BLOCK, Block, LEAF, Node, WIDTH};
use crate::math::Aabb;

const N_BINS: usize = 16;
/// Ranges of more triangles are built in parallel.
const PARALLEL_LIMIT: usize = 4096;

/// A deeper tree is cut in equal parts, which bounds its depth.
const SAH_DEPTH: u32 = 12;

/// A triangle on its way into the tree.
#[derive(Clone, Copy)]
struct Item {
    bounds: Aabb,
    id: u32,
}

impl Item {
    /// Twice the centre of its bounds.
    fn center2(&self) -> Vec3 {
        self.bounds.min + self.bounds.max
    }
}

/// Nodes and blocks of a subtree; its own node is the first, where it has one.
#[derive(Default)]
pub(super) struct Subtree {
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<Block>,
}

/// The tree over all triangles of a mesh that has some: nodes, blocks and the root's reference.
/// `stop` is looked at before every cut of a large range.
pub(super) fn build(mesh: &Mesh, stop: &AtomicBool) -> Result<(Subtree, u32), Stopped> {
    let n_triangles = mesh.triangles.len() as u32;
    let item = |id: u32| Item { bounds: Aabb::of(mesh.corners(id)), id };
    let mut items: Vec<Item> = (0..n_triangles).map(item).collect();
    Stopped::check(stop)?;
    let mut tree = Subtree::default();
    let bounds = bounds_of(&items);
    let source = Source { mesh, stop };
    let root = source.subtree(Range { items: &mut items, bounds }, 0, &mut tree)?;
    Ok((tree, root))
}

/// Triangles that belong together.
struct Range<'a> {
    items: &'a mut [Item],
    bounds: Aabb,
}

fn bounds_of(items: &[Item]) -> Aabb {
    items.iter().fold(Aabb::EMPTY, |all, item| all.union(item.bounds))
}

/// What is built of, and whether it is still wanted.
#[derive(Clone, Copy)]
struct Source<'a> {
    mesh: &'a Mesh,
    stop: &'a AtomicBool,
}

impl Source<'_> {
    /// Appends the subtree of a range and gives the reference to it.
    fn subtree(self, range: Range<'_>, depth: u32, tree: &mut Subtree) -> Result<u32, Stopped> {
        if range.items.len() <= BLOCK {
            tree.blocks.push(Block::new(self.mesh, range.items.iter().map(|item| item.id)));
            return Ok(LEAF | (tree.blocks.len() - 1) as u32);
        }
        let is_large = range.items.len() > PARALLEL_LIMIT;
        let mut ranges = Vec::with_capacity(WIDTH);
        ranges.push(range);
        while ranges.len() < WIDTH {
            // Deep down, and of equal surfaces, the one of most triangles: so the parts get equal.
            let area =
                |i: usize| if depth < SAH_DEPTH { ranges[i].bounds.half_area() } else { 0.0 };
            let order = |a: &usize, b: &usize| {
                let by_number = ranges[*a].items.len().cmp(&ranges[*b].items.len());
                area(*a).total_cmp(&area(*b)).then(by_number)
            };
            let widest = (0..ranges.len()).filter(|i| ranges[*i].items.len() > BLOCK).max_by(order);
            let Some(widest) = widest else { break };
            if is_large {
                Stopped::check(self.stop)?;
            }
            let (lower, upper) = split(ranges.swap_remove(widest), depth);
            ranges.push(lower);
            ranges.push(upper);
        }
        let id = tree.nodes.len();
        let mut node = Node::EMPTY;
        for (child, range) in ranges.iter().enumerate() {
            node.set_bounds(child, &range.bounds);
        }
        node.n_children = ranges.len() as u32;
        tree.nodes.push(node);
        if is_large {
            let built = self.in_parallel(ranges, depth + 1)?;
            for (child, (part, root)) in built.into_iter().enumerate() {
                tree.nodes[id].children[child] = append(tree, part, root);
            }
        } else {
            for (child, range) in ranges.into_iter().enumerate() {
                let reference = self.subtree(range, depth + 1, tree)?;
                tree.nodes[id].children[child] = reference;
            }
        }
        Ok(id as u32)
    }

    fn in_parallel(
        self,
        mut ranges: Vec<Range<'_>>,
        depth: u32,
    ) -> Result<Vec<(Subtree, u32)>, Stopped> {
        if ranges.len() == 1 {
            let range = ranges.remove(0);
            let mut part = Subtree::default();
            let root = self.subtree(range, depth, &mut part)?;
            return Ok(vec![(part, root)]);
        }
        // Halves of about the same work.
        let total: usize = ranges.iter().map(|range| range.items.len()).sum();
        let mut cut = 1;
        let mut before = ranges[0].items.len();
        while cut + 1 < ranges.len() && before + ranges[cut].items.len() / 2 < total / 2 {
            before += ranges[cut].items.len();
            cut += 1;
        }
        let upper = ranges.split_off(cut);
        let (lower, upper) =
            rayon::join(|| self.in_parallel(ranges, depth), || self.in_parallel(upper, depth));
        let mut built = lower?;
        built.extend(upper?);
        Ok(built)
    }
}

/// Moves a finished part into the tree; gives the reference to it there.
fn append(tree: &mut Subtree, mut part: Subtree, root: u32) -> u32 {
    let (first_node, first_block) = (tree.nodes.len() as u32, tree.blocks.len() as u32);
    let moved = |reference: u32| {
        if reference & LEAF == 0 { reference + first_node } else { reference + first_block }
    };
    for node in &mut part.nodes {
        let n_children = node.n_children as usize;
        for child in &mut node.children[..n_children] {
            *child = moved(*child);
        }
    }
    tree.nodes.append(&mut part.nodes);
    tree.blocks.append(&mut part.blocks);
    moved(root)
}

/// Two ranges from one of more than a block.
fn split<'a>(range: Range<'a>, depth: u32) -> (Range<'a>, Range<'a>) {
    let centers = range.items.iter().fold(Aabb::EMPTY, |mut all, item| {
        all.grow(item.center2());
        all
    });
    let cut = if depth < SAH_DEPTH { best_cut(&range, &centers) } else { None };
    let middle = match cut {
        Some(cut) => partition(range.items, &cut),
        None => {
            // Whole blocks, but for the last.
            let middle = (range.items.len() / 2).next_multiple_of(BLOCK);
            let axis = longest_axis(&range.bounds);
            // Of equal ones, any half will do.
            if centers.extent()[axis] > 0.0 {
                range.items.select_nth_unstable_by(middle, |a, b| {
                    let order = a.center2()[axis].total_cmp(&b.center2()[axis]);
                    order.then(a.id.cmp(&b.id))
                });
            }
            middle
        }
    };
    let (lower, upper) = range.items.split_at_mut(middle);
    let (lower_bounds, upper_bounds) = (bounds_of(lower), bounds_of(upper));
    (Range { items: lower, bounds: lower_bounds }, Range { items: upper, bounds: upper_bounds })
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
}

impl Cut {
    fn bin(low: f32, scale: f32, x: f32) -> usize {
        (((x - low) * scale) as usize).min(N_BINS - 1)
    }
}

/// The cut of least cost; none where the centres are one.
fn best_cut(range: &Range<'_>, centers: &Aabb) -> Option<Cut> {
    let extent = centers.extent();
    let scale = Vec3::splat(N_BINS as f32) / extent;
    // Not flat along that axis, nor so small that its reciprocal overflows.
    let has_bins = |axis: usize| extent[axis] > 0.0 && scale[axis].is_finite();
    if !(0..3).any(has_bins) {
        return None;
    }
    let mut bins = [[(Aabb::EMPTY, 0_usize); N_BINS]; 3];
    for item in range.items.iter() {
        let center = item.center2();
        for axis in 0..3 {
            let bin = Cut::bin(centers.min[axis], scale[axis], center[axis]);
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
        let cost = |area: f32, n: usize| area * n.div_ceil(BLOCK) as f32;
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
                best = Some((total, Cut { axis, border, low, scale }));
            }
        }
    }
    best.map(|(_, cut)| cut)
}

/// Puts the items of the lower side first, in a fixed order; gives how many they are.
fn partition(items: &mut [Item], cut: &Cut) -> usize {
    let is_lower =
        |item: &Item| Cut::bin(cut.low, cut.scale, item.center2()[cut.axis]) < cut.border;
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

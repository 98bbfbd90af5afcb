//! Building a wide bounding volume hierarchy: a node is opened until it has eight children.

use std::sync::atomic::AtomicBool;

use crate::geometry::Stopped;
use crate::geometry::binned::{LARGE, Range};
use crate::geometry::kd_tree::Item;
use crate::geometry::mesh::Mesh;
use crate::geometry::wide_bvh::{BLOCK, Block, LEAF, Node, WIDTH};
use crate::math::Aabb;

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
    let root = Source { mesh, stop }.subtree(Range::new(&mut items), 0, &mut tree)?;
    Ok((tree, root))
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
        let is_large = range.items.len() > LARGE;
        let ranges = range.open::<BLOCK>(WIDTH, depth, self.stop)?;
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

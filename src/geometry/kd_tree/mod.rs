//! A kd-tree over boxes: space is cut in two again and again, and a ray visits cells in its order.
//!
//! The tree knows items only by their bounds, so that one implementation serves the triangles of a
//! mesh and the objects of a scene. Traversal is conservative: whatever brute force finds, the tree
//! finds (see [`Walk`]).

mod build;
mod packet;
mod traverse;

use crate::math::Aabb;

pub use build::{Item, Split, build};
pub use packet::{LANES, Lanes, PacketRays, PacketWalk, Visit};
pub use traverse::Walk;

/// Eight bytes: an inner node's plane and far child, or a leaf's range of items.
///
/// Nodes lie depth-first: the lower child follows its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Inner: bits of the plane's coordinate. Leaf: index of the first item.
    payload: u32,
    /// Low two bits: the axis, or 3 for a leaf. High 30: index of the upper child, or number of
    /// items.
    link: u32,
}

impl Node {
    fn leaf(first: u32, n_items: u32) -> Self {
        Self { payload: first, link: n_items << 2 | 3 }
    }

    fn inner(axis: usize, plane: f32, upper_child: u32) -> Self {
        Self { payload: plane.to_bits(), link: upper_child << 2 | axis as u32 }
    }

    fn is_leaf(self) -> bool {
        self.link & 3 == 3
    }
}

/// The finished tree.
#[derive(Debug)]
pub struct KdTree {
    /// Around every item; empty without items.
    pub bounds: Aabb,
    nodes: Vec<Node>,
    /// Items in the order of the leaves; an item stands once for every leaf it reaches into.
    pub items: Vec<u32>,
}

impl KdTree {
    /// Number of inner nodes and leaves.
    pub fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Memory of nodes and item lists.
    pub fn n_bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.items[..])
    }
}

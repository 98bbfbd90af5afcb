//! A bounding volume hierarchy of eight children a node, for processors with wide registers.
//!
//! Rays are traced one by one, each against eight boxes and four triangles at once, or in packets
//! of sixteen that share their way. The code is generic over the registers and compiled for
//! AVX-512, AVX2 and arrays; which runs is decided when the program does, and the hits are the same
//! to the bit: boxes are tested conservatively, triangles by the same operations everywhere.
#![expect(unsafe_code, reason = "functions compiled for processors that are asked for first")]

mod build;
mod descent;
mod group;
mod leaf;
mod packet;
mod sharing;
mod single;
mod stream;
mod waiting;

use std::cell::RefCell;
use std::sync::atomic::AtomicBool;

use glam::Vec3;

use crate::geometry::lanes::{Isa, Portable};
use crate::geometry::mesh::Mesh;
use crate::geometry::nearest::{Nearest, Search};
use crate::geometry::wide_bvh::descent::Start;
use crate::geometry::wide_bvh::stream::{Fleet, TakeAny, TakeNearest};
use crate::geometry::{Stopped, TraversalCost};
use crate::math::{Aabb, Ray, RayBatch};

/// Children of a node.
const WIDTH: usize = 8;
/// Triangles of a leaf.
const BLOCK: usize = 4;
/// Marks a reference to a block.
const LEAF: u32 = 1 << 31;

/// Eight boxes and where they lead.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Node {
    /// Rows: lower x, y, z, then upper x, y, z.
    bounds: [[f32; WIDTH]; 6],
    /// Nodes, or blocks where [`LEAF`] is set.
    children: [u32; WIDTH],
    /// How many there are; they come first.
    n_children: u32,
}

/// Four triangles; the last is repeated where there are fewer.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct Block {
    /// By corner, by axis.
    corners: [[[f32; BLOCK]; 3]; 3],
    ids: [u32; BLOCK],
}

/// The finished tree.
#[derive(Debug)]
pub(super) struct WideBvh {
    nodes: Vec<Node>,
    blocks: Vec<Block>,
    root: u32,
    /// Largest coordinate of the bounds.
    magnitude: f32,
}

impl Node {
    /// Places without a child have bounds that nothing touches, and lead to a block even where
    /// overflow makes a ray touch everything.
    const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [LEAF; WIDTH],
        n_children: 0,
    };

    fn set_bounds(&mut self, child: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.bounds[axis][child] = bounds.min[axis];
            self.bounds[axis + 3][child] = bounds.max[axis];
        }
    }
}

impl Block {
    /// Of one to four triangles.
    fn new(mesh: &Mesh, ids: impl Iterator<Item = u32>) -> Self {
        let mut block = Self { corners: [[[0.0; BLOCK]; 3]; 3], ids: [0; BLOCK] };
        let mut n = 0;
        for id in ids.take(BLOCK) {
            block.set(n, id, mesh.corners(id));
            n += 1;
        }
        for lane in n..BLOCK {
            let id = block.ids[n.saturating_sub(1)];
            block.set(lane, id, mesh.corners(id));
        }
        block
    }

    /// How many triangles there are; each has another id.
    #[inline(always)]
    fn n_triangles(&self) -> u32 {
        let [a, b, c, d] = self.ids;
        1 + u32::from(b != a) + u32::from(c != b) + u32::from(d != c)
    }

    fn set(&mut self, lane: usize, id: u32, corners: [Vec3; 3]) {
        self.ids[lane] = id;
        for (corner, p) in corners.into_iter().enumerate() {
            for axis in 0..3 {
                self.corners[corner][axis][lane] = p[axis];
            }
        }
    }
}

impl WideBvh {
    /// Directions count as no less in box tests, so that reciprocals stay far from overflow even
    /// times the largest coordinate.
    const SMALLEST: f32 = 1e-20;

    /// A component of a direction that box tests can divide by.
    #[inline(always)]
    fn not_tiny(d: f32) -> f32 {
        if d.abs() < Self::SMALLEST { Self::SMALLEST.copysign(d) } else { d }
    }

    /// Boxes are grown by this share of the largest coordinates of the ray's origin and of the tree
    /// together: 16 units in the last place, which covers the rounding of box and triangle tests.
    const ROUNDING: f32 = 16.0 / 16_777_216.0;

    /// Builds the tree of a mesh that has triangles, on the current pool.
    pub(super) fn build(mesh: &Mesh, stop: &AtomicBool) -> Result<Self, Stopped> {
        let (tree, root) = build::build(mesh, stop)?;
        let magnitude = mesh.bounds().max_abs();
        Ok(Self { nodes: tree.nodes, blocks: tree.blocks, root, magnitude })
    }

    /// Where a ray begins that goes alone.
    #[inline(always)]
    fn start(&self) -> Start {
        Start { reference: self.root, enter: 0.0 }
    }

    /// Has a node or a block fetched.
    #[inline(always)]
    fn prefetch<I: Isa>(&self, reference: u32) {
        if reference & LEAF == 0 {
            I::prefetch(&self.nodes[reference as usize]);
        } else {
            I::prefetch(&self.blocks[(reference & !LEAF) as usize]);
        }
    }

    /// Whether most of it is in slow memory, so that it pays to ask for it early.
    #[inline(always)]
    fn is_far(&self) -> bool {
        const NEAR_BLOCKS: usize = 40_000;
        self.blocks.len() > NEAR_BLOCKS
    }

    /// Number of nodes.
    pub(super) fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Memory of nodes and triangles.
    pub(super) fn n_bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }

    /// Takes the hits of one ray in object space into a search.
    pub(super) fn intersect(&self, ray: &Ray, object: u32, search: &mut Search) {
        FLEET.with_borrow_mut(|fleet| dispatch::intersect(self, ray, fleet, object, search));
    }

    /// [`WideBvh::intersect`] that adds up what it takes, the same on every machine.
    pub(super) fn intersect_counted(
        &self,
        ray: &Ray,
        object: u32,
        search: &mut Search,
        cost: &mut TraversalCost,
    ) {
        single::nearest_counted(self, ray, object, search, cost);
    }

    /// [`WideBvh::intersect`] for many rays, one `nearest` each.
    pub(super) fn intersect_batch(&self, rays: &RayBatch, object: u32, nearest: &mut [Nearest]) {
        let source = &rays.source[..];
        FLEET.with_borrow_mut(|fleet| {
            dispatch::intersect_batch(
                self,
                rays,
                fleet,
                &mut TakeNearest { nearest, source, object },
            );
        });
    }

    /// Whether anything but its source lies between the ends of each ray; those already blocked are left
    /// out.
    pub(super) fn occluded_batch(&self, rays: &RayBatch, object: u32, blocked: &mut [bool]) {
        let (t_max, source) = (&rays.t_max[..], &rays.source[..]);
        FLEET.with_borrow_mut(|fleet| {
            let mut hits = TakeAny { blocked, t_max, source, object };
            dispatch::occluded_batch(self, rays, fleet, &mut hits);
        });
    }
}

thread_local! {
    /// Every thread's places for rays under way.
    static FLEET: RefCell<Box<Fleet>> = RefCell::new(Box::new(Fleet::IDLE));
}

/// The same functions compiled for each kind of processor.
mod dispatch {
    use super::{
        Fleet, Portable, Ray, RayBatch, Search, TakeAny, TakeNearest, WideBvh, packet, single,
    };
    #[cfg(target_arch = "x86_64")]
    use crate::geometry::lanes::{Avx2, Avx512};
    use crate::math::vectorized::Level;

    macro_rules! compiled {
        ($($name:ident => $module:ident::$generic:ident, ($($argument:ident: $type:ty),*) -> $result:ty;)+) => {$(
            pub(super) fn $name(bvh: &WideBvh, $($argument: $type),*) -> $result {
                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = "avx512f,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
                fn avx512(bvh: &WideBvh, $($argument: $type),*) -> $result {
                    $module::$generic::<Avx512>(bvh, $($argument),*)
                }
                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
                fn avx2(bvh: &WideBvh, $($argument: $type),*) -> $result {
                    $module::$generic::<Avx2>(bvh, $($argument),*)
                }
                match Level::of_machine() {
                    // SAFETY: the processor was asked for these features.
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx512 => unsafe { avx512(bvh, $($argument),*) },
                    // SAFETY: the processor was asked for these features.
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx2 => unsafe { avx2(bvh, $($argument),*) },
                    Level::Portable => $module::$generic::<Portable>(bvh, $($argument),*),
                }
            }
        )+};
    }

    compiled! {
        intersect => single::nearest,
            (ray: &Ray, fleet: &mut Fleet, object: u32, search: &mut Search) -> ();
        intersect_batch => packet::nearest,
            (rays: &RayBatch, fleet: &mut Fleet, hits: &mut TakeNearest<'_>) -> ();
        occluded_batch => packet::blocked,
            (rays: &RayBatch, fleet: &mut Fleet, hits: &mut TakeAny<'_>) -> ();
    }
}

#[cfg(test)]
mod tests;

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

use std::cell::RefCell;
use std::sync::atomic::AtomicBool;

use glam::Vec3;

use crate::geometry::lanes::{Isa, Portable};
use crate::geometry::mesh::Mesh;
use crate::geometry::nearest::{Nearest, Search};
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

    /// Has a node or a block fetched.
    #[inline(always)]
    fn prefetch<I: Isa>(&self, reference: u32) {
        if reference & LEAF == 0 {
            I::prefetch(&self.nodes[reference as usize]);
        } else {
            I::prefetch(&self.blocks[(reference & !LEAF) as usize]);
        }
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
        dispatch::intersect(self, ray, object, search);
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

    /// Whether anything but the ray's source lies between its ends.
    pub(super) fn occluded(&self, ray: &Ray, object: u32) -> bool {
        dispatch::occluded(self, ray, object)
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

    /// [`WideBvh::occluded`] for many rays; those already blocked are left out.
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
        intersect => single::nearest, (ray: &Ray, object: u32, search: &mut Search) -> ();
        occluded => single::blocked, (ray: &Ray, object: u32) -> bool;
        intersect_batch => packet::nearest,
            (rays: &RayBatch, fleet: &mut Fleet, hits: &mut TakeNearest<'_>) -> ();
        occluded_batch => packet::blocked,
            (rays: &RayBatch, fleet: &mut Fleet, hits: &mut TakeAny<'_>) -> ();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::PrimitiveId;
    use crate::math::sampler::Sampler;

    fn number(i: u32, k: u32) -> f32 {
        2.0 * Sampler::Random { seed: 5 }.numbers(i, k, 0).pair(0)[0] - 1.0
    }

    fn point(i: u32, k: u32) -> Vec3 {
        Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2))
    }

    /// Small triangles, some of them flat against an axis, repeated or without area.
    fn soup(n: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for i in 0..n {
            let center = point(i / 2 * 2, 0);
            let mut corners = [0, 1, 2].map(|corner| center + 0.2 * point(i, 10 + 3 * corner));
            match i % 16 {
                3 => corners.iter_mut().for_each(|corner| corner.y = 0.25),
                5 => corners[2] = corners[1],
                7 => corners = [Vec3::X, Vec3::Y, Vec3::Z],
                _ => {}
            }
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
            mesh.positions.extend(corners);
        }
        mesh
    }

    /// Coherent ones, random ones, ones along axes and in the plane of triangles, ones with ends.
    fn rays(n: u32) -> RayBatch {
        let mut batch = RayBatch::default();
        for i in 0..n {
            let mut ray = match i / 64 % 4 {
                0 => {
                    Ray::new(Vec3::new(0.1, 0.2, 4.0), Vec3::new(0.01 * (i % 64) as f32, 0.1, -2.0))
                }
                1 => Ray::new(3.0 * point(i, 50), point(i, 60)),
                2 => Ray::new(Vec3::new(-3.0, 0.25, number(i, 70)), Vec3::X),
                _ => Ray::new(point(i, 80), Vec3::new(1.0, 0.1 * number(i, 90), -1.0)),
            };
            if i % 3 == 0 {
                ray.t_max = 1.5;
            }
            if i % 5 == 0 {
                ray.source = PrimitiveId { object: 2, primitive: i % 300 };
            }
            batch.push(ray);
        }
        batch
    }

    /// Every width, single and in packets, gives the hits of the scalar test over all triangles.
    #[test]
    fn all_registers_agree_with_brute_force() {
        use crate::geometry::triangle::ShearedRay;
        let (mesh, rays) = (soup(600), rays(4096 + 9));
        let bvh = WideBvh::build(&mesh, &AtomicBool::new(false)).unwrap();
        let mut by_packet: Vec<Nearest> = rays.t_max.iter().map(|t| Nearest::new(*t)).collect();
        let mut portable = by_packet.clone();
        let mut blocked = vec![false; rays.len()];
        let mut blocked_portable = blocked.clone();
        bvh.intersect_batch(&rays, 2, &mut by_packet);
        let mut fleet = Fleet::IDLE;
        let mut hits = TakeNearest { nearest: &mut portable, source: &rays.source, object: 2 };
        packet::nearest::<Portable>(&bvh, &rays, &mut fleet, &mut hits);
        bvh.occluded_batch(&rays, 2, &mut blocked);
        let (t_max, source) = (&rays.t_max[..], &rays.source[..]);
        let mut hits = TakeAny { blocked: &mut blocked_portable, t_max, source, object: 2 };
        packet::blocked::<Portable>(&bvh, &rays, &mut fleet, &mut hits);
        let mut n_hits = 0;
        for i in 0..rays.len() {
            let ray = rays.ray(i);
            let sheared = ShearedRay::new(&ray);
            let mut expected = Search::new(&ray);
            for id in 0..mesh.triangles.len() as u32 {
                if let Some(t) = sheared.intersect(mesh.corners(id)) {
                    expected.offer(t, PrimitiveId { object: 2, primitive: id });
                }
            }
            n_hits += usize::from(expected.nearest.is_hit());
            let mut one = Search::new(&ray);
            bvh.intersect(&ray, 2, &mut one);
            let mut one_portable = Search::new(&ray);
            single::nearest::<Portable>(&bvh, &ray, 2, &mut one_portable);
            let expected = expected.nearest.hit();
            assert_eq!(by_packet[i].hit(), expected, "packet, ray {i}");
            assert_eq!(portable[i].hit(), expected, "portable packet, ray {i}");
            assert_eq!(one.nearest.hit(), expected, "single, ray {i}");
            assert_eq!(one_portable.nearest.hit(), expected, "portable single, ray {i}");
            assert_eq!(blocked[i], expected.is_some(), "blocked, ray {i}");
            assert_eq!(blocked_portable[i], expected.is_some(), "blocked portable, ray {i}");
            assert_eq!(bvh.occluded(&ray, 2), expected.is_some(), "occluded, ray {i}");
        }
        assert!((1000..4000).contains(&n_hits), "{n_hits} hits");
    }

    /// Reciprocals and their products are infinite there, and their differences no numbers.
    #[test]
    fn a_ray_whose_box_tests_all_overflow_comes_to_an_end() {
        let bvh = WideBvh::build(&soup(600), &AtomicBool::new(false)).unwrap();
        let far = Vec3::splat(3e19);
        let mut rays = RayBatch::default();
        (0..32).for_each(|_| rays.push(Ray::new(far, Vec3::splat(-1e-25))));
        let mut nearest = vec![Nearest::new(f32::INFINITY); rays.len()];
        bvh.intersect_batch(&rays, 2, &mut nearest);
        let mut search = Search::new(&rays.ray(0));
        bvh.intersect(&rays.ray(0), 2, &mut search);
        for nearest in nearest {
            assert_eq!(nearest.hit(), search.nearest.hit(), "all the same ray");
        }
    }

    #[test]
    fn a_thousand_equal_triangles_make_a_tree_of_bounded_depth() {
        let positions = vec![Vec3::X, Vec3::Y, Vec3::Z];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]; 20_000], ..Mesh::default() };
        let bvh = WideBvh::build(&mesh, &AtomicBool::new(false)).unwrap();
        let ray = Ray::new(Vec3::ZERO, Vec3::ONE);
        let mut search = Search::new(&ray);
        bvh.intersect(&ray, 0, &mut search);
        assert_eq!(search.nearest.hit().map(|hit| hit.id.primitive), Some(0), "the lowest wins");
    }
}

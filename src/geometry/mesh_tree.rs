//! A mesh made ready for rays: its triangles in the order of an accelerator's leaves.

use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Instant;

use glam::{DVec3, Vec3};

use crate::geometry::kd_tree::{
    self, Item, KdTree, LANES, Lanes, PacketRays, PacketWalk, Split, Visit, Walk,
};
use crate::geometry::mesh::Mesh;
use crate::geometry::nearest::{Nearest, Search};
use crate::geometry::triangle::{ShearedRay, ShearedRays};
use crate::geometry::wide_bvh::WideBvh;
use crate::geometry::{AcceleratorKind, Stopped, TraversalCost};
use crate::math::vectorized::vectorized;
use crate::math::{Aabb, PrimitiveId, Ray, RayBatch};

/// A mesh with the trees that have been asked for; each is built once.
#[derive(Debug)]
pub struct TracedMesh {
    /// The arrays.
    pub mesh: Mesh,
    /// Around every triangle.
    pub bounds: Aabb,
    trees: [OnceLock<MeshTree>; AcceleratorKind::ALL.len()],
    /// Held by whoever builds; others wait for the same tree.
    builder: Mutex<()>,
}

impl TracedMesh {
    /// Takes a mesh; builds nothing yet.
    pub fn new(mesh: Mesh) -> Self {
        let bounds = mesh.bounds();
        Self { mesh, bounds, trees: Default::default(), builder: Mutex::new(()) }
    }

    /// Seconds that a build of that kind takes now, whether one is there or not: for measurements.
    pub fn time_build(&self, kind: AcceleratorKind) -> f64 {
        let never = AtomicBool::new(false);
        MeshTree::build(&self.mesh, kind, &never).map_or(f64::NAN, |tree| tree.build_secs)
    }

    /// Whether the tree of that kind is built.
    pub fn has_tree(&self, kind: AcceleratorKind) -> bool {
        self.trees[kind as usize].get().is_some()
    }

    /// Builds the tree of that kind, unless it is there. `stop` is looked at as the build goes on.
    ///
    /// # Errors
    /// [`Stopped`]; there is no such tree then.
    pub fn build_tree(&self, kind: AcceleratorKind, stop: &AtomicBool) -> Result<(), Stopped> {
        let _alone = self.builder.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.has_tree(kind) {
            let tree = MeshTree::build(&self.mesh, kind, stop)?;
            self.trees[kind as usize].get_or_init(|| tree);
        }
        Ok(())
    }

    /// The tree of that kind, which has been built.
    pub fn tree(&self, kind: AcceleratorKind) -> &MeshTree {
        self.trees[kind as usize].get().expect("a geometry builds its trees")
    }
}

/// The triangles of a mesh in the order of an accelerator's leaves.
#[derive(Debug)]
pub struct MeshTree {
    structure: Structure,
    /// How long the build took, in seconds.
    pub build_secs: f64,
}

#[derive(Debug)]
enum Structure {
    WideBvh(WideBvh),
    KdTree(KdTree, Vec<Triangle>),
    List(Vec<Triangle>),
}

#[derive(Clone, Copy, Debug)]
struct Triangle {
    corners: [Vec3; 3],
    id: u32,
}

impl MeshTree {
    fn build(mesh: &Mesh, kind: AcceleratorKind, stop: &AtomicBool) -> Result<Self, Stopped> {
        /// Of a triangle's test, in steps of a kd-tree: for many rays at once it is cheap, and larger leaves
        /// make smaller trees, which are sooner built.
        const TRIANGLE_COST: f32 = 0.5;
        let start = Instant::now();
        let triangle = |id: u32| Triangle { corners: mesh.corners(id), id };
        let kd_tree = |split| {
            let tree = build_kd_tree(mesh, split, stop)?;
            let triangles = tree.items.iter().map(|id| triangle(*id)).collect();
            Ok(Structure::KdTree(tree, triangles))
        };
        let structure = match kind {
            // Nothing to divide.
            _ if mesh.triangles.is_empty() => Structure::List(Vec::new()),
            AcceleratorKind::WideBvh => Structure::WideBvh(WideBvh::build(mesh, stop)?),
            AcceleratorKind::KdTree => kd_tree(Split::SurfaceArea { item_cost: TRIANGLE_COST })?,
            AcceleratorKind::KdMidpoint => kd_tree(Split::Midpoint)?,
            AcceleratorKind::BruteForce => {
                Structure::List((0..mesh.triangles.len() as u32).map(triangle).collect())
            }
        };
        Ok(Self { structure, build_secs: start.elapsed().as_secs_f64() })
    }

    /// Takes the hits of a ray in object space into a search.
    pub(super) fn intersect(&self, ray: &Ray, object: u32, search: &mut Search) {
        if let Structure::WideBvh(bvh) = &self.structure {
            return bvh.intersect(ray, object, search);
        }
        let mut clipped = *ray;
        clipped.t_max = search.nearest.t();
        let sheared = ShearedRay::new(ray);
        self.visit(&clipped, |triangles| {
            for triangle in triangles {
                if let Some(t) = sheared.intersect(triangle.corners) {
                    search.offer(t, PrimitiveId { object, primitive: triangle.id });
                }
            }
            search.nearest.t()
        });
    }

    /// [`MeshTree::intersect`] that adds up what it takes.
    pub(super) fn intersect_counted(
        &self,
        ray: &Ray,
        object: u32,
        search: &mut Search,
        cost: &mut TraversalCost,
    ) {
        let sheared = ShearedRay::new(ray);
        let mut n_triangles = 0;
        let clipped = Ray { t_max: search.nearest.t(), ..*ray };
        let mut test = |triangles: &[Triangle]| {
            n_triangles += triangles.len() as u32;
            for triangle in triangles {
                if let Some(t) = sheared.intersect(triangle.corners) {
                    search.offer(t, PrimitiveId { object, primitive: triangle.id });
                }
            }
            search.nearest.t()
        };
        match &self.structure {
            Structure::WideBvh(bvh) => bvh.intersect_counted(ray, object, search, cost),
            Structure::KdTree(tree, triangles) => {
                if let Some(walk) = Walk::new(&clipped, &tree.bounds) {
                    let enter = || cost.n_nodes += 1;
                    tree.walk_counting(&walk, enter, |range| test(&triangles[range]));
                }
            }
            Structure::List(triangles) => {
                test(triangles);
            }
        }
        cost.n_primitives += n_triangles;
    }

    /// Whether anything but the ray's source lies between its ends: without wide registers.
    fn occluded(&self, ray: &Ray, object: u32) -> bool {
        let sheared = ShearedRay::new(ray);
        let mut probe = Search::new(ray);
        self.visit(ray, |triangles| {
            for triangle in triangles {
                if let Some(t) = sheared.intersect(triangle.corners) {
                    probe.offer(t, PrimitiveId { object, primitive: triangle.id });
                    if probe.nearest.is_hit() {
                        return -1.0;
                    }
                }
            }
            ray.t_max
        });
        probe.nearest.is_hit()
    }

    /// [`MeshTree::intersect`] for many rays, one `nearest` each.
    pub(super) fn intersect_batch(&self, rays: &RayBatch, object: u32, nearest: &mut [Nearest]) {
        if let Structure::WideBvh(bvh) = &self.structure {
            return bvh.intersect_batch(rays, object, nearest);
        }
        for (packet, nearest) in nearest.chunks_mut(LANES).enumerate() {
            let first = packet * LANES;
            if self.walk_packet(rays, first, object, nearest, false) {
                continue;
            }
            for (i, nearest) in nearest.iter_mut().enumerate() {
                let ray = rays.ray(first + i);
                let mut search = Search::from(&ray, *nearest);
                self.intersect(&ray, object, &mut search);
                *nearest = search.nearest;
            }
        }
    }

    /// Whether anything but its source lies between the ends of each ray; those already blocked are left
    /// out.
    pub(super) fn occluded_batch(&self, rays: &RayBatch, object: u32, blocked: &mut [bool]) {
        if let Structure::WideBvh(bvh) = &self.structure {
            return bvh.occluded_batch(rays, object, blocked);
        }
        for (packet, blocked) in blocked.chunks_mut(LANES).enumerate() {
            let first = packet * LANES;
            let mut nearest = [Nearest::new(-1.0); LANES];
            for (i, is_blocked) in blocked.iter().enumerate() {
                nearest[i] = Nearest::new(if *is_blocked { -1.0 } else { rays.t_max[first + i] });
            }
            let is_packet =
                self.walk_packet(rays, first, object, &mut nearest[..blocked.len()], true);
            for (i, (blocked, nearest)) in blocked.iter_mut().zip(&nearest).enumerate() {
                *blocked |= if is_packet {
                    nearest.is_hit()
                } else {
                    !*blocked && self.occluded(&rays.ray(first + i), object)
                };
            }
        }
    }

    /// Takes the hits of up to [`LANES`] rays from `first` on, one `nearest` each; of each ray only
    /// one where `any_will_do`. `false` where they do not go together, and nothing is done.
    fn walk_packet(
        &self,
        rays: &RayBatch,
        first: usize,
        object: u32,
        nearest: &mut [Nearest],
        any_will_do: bool,
    ) -> bool {
        let Structure::KdTree(tree, triangles) = &self.structure else { return false };
        walk_kd_tree(tree, triangles, rays, first, object, nearest, any_will_do)
    }

    fn visit(&self, ray: &Ray, mut visit: impl FnMut(&[Triangle]) -> f32) {
        match &self.structure {
            Structure::KdTree(tree, triangles) => {
                if let Some(walk) = Walk::new(ray, &tree.bounds) {
                    tree.walk(&walk, |range: Range<usize>| visit(&triangles[range]));
                }
            }
            Structure::List(triangles) => {
                visit(triangles);
            }
            Structure::WideBvh(_) => {}
        }
    }

    /// Number of nodes; 0 for brute force.
    pub fn n_nodes(&self) -> usize {
        match &self.structure {
            Structure::WideBvh(bvh) => bvh.n_nodes(),
            Structure::KdTree(tree, _) => tree.n_nodes(),
            Structure::List(_) => 0,
        }
    }

    /// Memory of nodes and triangles.
    pub fn n_bytes(&self) -> usize {
        match &self.structure {
            Structure::WideBvh(bvh) => bvh.n_bytes(),
            Structure::KdTree(tree, triangles) => tree.n_bytes() + size_of_val(&triangles[..]),
            Structure::List(triangles) => size_of_val(&triangles[..]),
        }
    }
}

/// What a packet does with the triangles of a leaf.
struct PacketVisit<'a> {
    rays: ShearedRays,
    triangles: &'a [Triangle],
    object: u32,
    nearest: &'a mut [Nearest],
    sources: &'a [PrimitiveId],
    any_will_do: bool,
    /// Parameters up to which hits count.
    ends: Lanes<f32>,
}

impl Visit for PacketVisit<'_> {
    #[inline(always)]
    fn visit(&mut self, items: Range<usize>, limits: &mut Lanes<f32>) {
        for triangle in &self.triangles[items] {
            let mut t = [f32::NAN; LANES];
            if !self.rays.intersect(triangle.corners, &self.ends, &mut t) {
                continue;
            }
            let id = PrimitiveId { object: self.object, primitive: triangle.id };
            for (i, nearest) in self.nearest.iter_mut().enumerate() {
                if t[i].is_nan() {
                    continue;
                }
                nearest.offer(t[i], id, self.sources[i]);
                let is_done = self.any_will_do && nearest.is_hit();
                self.ends[i] = if is_done { -1.0 } else { nearest.t() };
                limits[i] = self.ends[i];
            }
        }
    }
}

vectorized! {
    fn walk_kd_tree(
        tree: &KdTree,
        triangles: &[Triangle],
        rays: &RayBatch,
        first: usize,
        object: u32,
        nearest: &mut [Nearest],
        any_will_do: bool,
    ) -> bool {
        let packet = PacketRays::new(rays, first, nearest.iter().map(Nearest::t));
        let Some(walk) = PacketWalk::new(&packet, &tree.bounds) else { return false };
        let Some(sheared) = ShearedRays::new(&packet) else { return false };
        let sources = &rays.source[first..first + nearest.len()];
        let ends = packet.t_max;
        let mut visit =
            PacketVisit { rays: sheared, triangles, object, nearest, sources, any_will_do, ends };
        tree.walk_packet(&walk, &mut visit);
        true
    }
}

fn build_kd_tree(mesh: &Mesh, split: Split, stop: &AtomicBool) -> Result<KdTree, Stopped> {
    let n_triangles = mesh.triangles.len() as u32;
    let items = (0..n_triangles).map(|id| Item { id, bounds: Aabb::of(mesh.corners(id)) });
    let clip = |id: u32, cell: Aabb| clipped_bounds(mesh.corners(id), &cell);
    kd_tree::build(items.collect(), split, &clip, stop)
}

/// Bounds of the part of a triangle inside a box, rounded outwards.
///
/// Source: I. E. Sutherland and G. W. Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.
fn clipped_bounds(corners: [Vec3; 3], cell: &Aabb) -> Aabb {
    let (cell_min, cell_max) = (cell.min.as_dvec3(), cell.max.as_dvec3());
    // A triangle cut by six planes has at most nine corners.
    let mut polygon = [DVec3::ZERO; 9];
    let mut n = 3;
    for (to, from) in polygon.iter_mut().zip(corners) {
        *to = from.as_dvec3();
    }
    for axis in 0..3 {
        for (plane, sign) in [(cell_min[axis], 1.0), (cell_max[axis], -1.0)] {
            let from = polygon;
            let n_from = n;
            n = 0;
            for i in 0..n_from {
                let (a, b) = (from[i], from[(i + 1) % n_from]);
                let (da, db) = (sign * (a[axis] - plane), sign * (b[axis] - plane));
                if da >= 0.0 {
                    polygon[n] = a;
                    n += 1;
                }
                if (da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0) {
                    polygon[n] = a + (b - a) * (da / (da - db));
                    n += 1;
                }
            }
        }
    }
    let mut bounds = Aabb::EMPTY;
    for p in &polygon[..n] {
        bounds.min = bounds.min.min(Vec3::from_array(p.to_array().map(|x| (x as f32).next_down())));
        bounds.max = bounds.max.max(Vec3::from_array(p.to_array().map(|x| (x as f32).next_up())));
    }
    bounds
}

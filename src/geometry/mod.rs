//! Shapes, where they are, and what rays meet of them.
//!
//! [`Geometry`] answers three questions about a batch of rays: what each meets first
//! ([`Geometry::intersect`]), whether anything is in its way ([`Geometry::occluded`]), and how much
//! light gets through where some objects are clear ([`Geometry::transmittance`]). Every accelerator
//! gives the same answers to the last bit: of equal distances the lowest primitive wins.

mod cost;
mod crossings;
mod extent;
mod instance;
pub mod kd_tree;
mod lanes;
pub mod mesh;
mod mesh_tree;
mod nearest;
pub mod normals;
mod select;
mod shape;
mod surface;
mod triangle;
mod wide_bvh;

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::color::Rgb;
use crate::geometry::kd_tree::{Item, KdTree, Split, Walk};
use crate::geometry::nearest::Search;
use crate::geometry::select::Selection;
use crate::math::{Aabb, PrimitiveId, Ray, RayBatch};

pub use cost::TraversalCost;
pub use instance::Instance;
pub use mesh_tree::{MeshTree, TracedMesh};
pub use nearest::{Hit, Nearest};
pub use shape::Shape;
pub use surface::Surface;
pub(crate) use surface::{HitBlock, SurfaceBlock};

/// How rays find what they meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AcceleratorKind {
    /// Bounding volumes, eight to a node, for wide registers.
    #[default]
    WideBvh,
    /// kd-tree built by the surface area heuristic.
    KdTree,
    /// kd-tree cut at the middle of the longest side.
    KdMidpoint,
    /// Every ray against every triangle: the oracle.
    BruteForce,
}

impl AcceleratorKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::WideBvh, Self::KdTree, Self::KdMidpoint, Self::BruteForce];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::WideBvh => "wide-bvh",
            Self::KdTree => "kd-tree",
            Self::KdMidpoint => "kd-midpoint",
            Self::BruteForce => "brute-force",
        }
    }

    /// Bytes a triangle that building takes at its peak, tree and all: measured on ordinary meshes,
    /// with room to spare. A kd-tree may take four times as much on meshes made for that.
    pub fn bytes_a_triangle(self) -> u64 {
        match self {
            Self::WideBvh => 192,
            Self::KdTree | Self::KdMidpoint => 320,
            Self::BruteForce => 48,
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// Something was told to stop, and left nothing half done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

impl Stopped {
    /// An error once `stop` is set.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn check(stop: &AtomicBool) -> Result<(), Self> {
        if stop.load(Ordering::Relaxed) { Err(Self) } else { Ok(()) }
    }
}

/// Size and cost of the trees behind a geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeStatistics {
    /// Inner nodes and leaves; a mesh used twice counts once.
    pub n_nodes: usize,
    /// Bytes of nodes and of triangles in leaf order.
    pub n_bytes: usize,
    /// Seconds that the builds took.
    pub build_secs: f64,
}

/// Every object of a scene, ready for rays.
#[derive(Debug)]
pub struct Geometry {
    instances: Vec<Instance>,
    kind: AcceleratorKind,
    /// Over the bounded objects, where there are enough of them.
    tree: Option<KdTree>,
    /// Objects that every ray is tested against.
    listed: Vec<u32>,
}

/// What a thread keeps from one batch to the next.
#[derive(Default)]
struct Work {
    selection: Selection,
    /// Of the selected rays.
    nearest: Vec<Nearest>,
    blocked: Vec<bool>,
}

thread_local! {
    static WORK: RefCell<Work> = RefCell::default();
}

impl Geometry {
    /// [`Geometry::build`], to its end.
    pub fn new(instances: Vec<Instance>, kind: AcceleratorKind) -> Self {
        let never = AtomicBool::new(false);
        Self::build(instances, kind, &never).expect("nobody stops it")
    }

    /// Builds whatever trees are missing. `instances` are in the scene's order, which numbers them.
    /// `stop` is looked at before every cut of more than a few thousand triangles.
    ///
    /// # Errors
    /// [`Stopped`]; trees that were finished before are kept with their meshes.
    pub fn build(
        instances: Vec<Instance>,
        kind: AcceleratorKind,
        stop: &AtomicBool,
    ) -> Result<Self, Stopped> {
        /// Fewer objects are tested one by one, each by all rays of a batch that touch its box.
        const TREE_LIMIT: usize = 48;
        for instance in &instances {
            if let Shape::Mesh(mesh) = instance.shape() {
                mesh.build_tree(kind, stop)?;
            }
        }
        let bounded = |id: &u32| instances[*id as usize].bounds().is_some();
        let (bounded, mut listed): (Vec<u32>, Vec<u32>) =
            (0..instances.len() as u32).partition(bounded);
        let split = match kind {
            AcceleratorKind::WideBvh | AcceleratorKind::KdTree => Some(Split::SurfaceArea),
            AcceleratorKind::KdMidpoint => Some(Split::Midpoint),
            AcceleratorKind::BruteForce => None,
        };
        let tree = match split {
            Some(split) if bounded.len() > TREE_LIMIT => {
                let item = |id: u32| Some(Item { id, bounds: instances[id as usize].reach()? });
                let items = bounded.into_iter().filter_map(item).collect();
                let clip = |id: u32, cell: Aabb| {
                    instances[id as usize].reach().unwrap_or(cell).intersection(cell)
                };
                Some(kd_tree::build(items, split, &clip, stop)?)
            }
            _ => {
                listed.extend(bounded);
                None
            }
        };
        Ok(Self { instances, kind, tree, listed })
    }

    /// The objects, in the scene's order.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// Around every bounded object; `None` without any.
    pub fn bounds(&self) -> Option<Aabb> {
        self.instances.iter().filter_map(Instance::bounds).reduce(Aabb::union)
    }

    /// Size and cost of the trees.
    pub fn statistics(&self) -> TreeStatistics {
        let mut statistics = TreeStatistics::default();
        let mut counted: Vec<*const TracedMesh> = Vec::new();
        for instance in &self.instances {
            let Shape::Mesh(mesh) = instance.shape() else { continue };
            let address = std::sync::Arc::as_ptr(mesh);
            if !counted.contains(&address) {
                counted.push(address);
                let tree = mesh.tree(self.kind);
                statistics.n_nodes += tree.n_nodes();
                statistics.n_bytes += tree.n_bytes();
                statistics.build_secs += tree.build_secs;
            }
        }
        if let Some(tree) = &self.tree {
            statistics.n_nodes += tree.n_nodes();
            statistics.n_bytes += tree.n_bytes();
        }
        statistics
    }

    /// What each ray meets first; `nearest` is overwritten, one entry a ray.
    pub fn intersect(&self, rays: &RayBatch, nearest: &mut Vec<Nearest>) {
        nearest.clear();
        nearest.extend(rays.t_max.iter().map(|t| Nearest::new(*t)));
        WORK.with_borrow_mut(|Work { selection, nearest: theirs, .. }| {
            selection.begin();
            for id in &self.listed {
                let instance = &self.instances[*id as usize];
                let Some(bounds) = self.box_of(instance) else {
                    instance.intersect_batch(rays, *id, self.kind, nearest);
                    selection.limits.clear();
                    continue;
                };
                if selection.limits.is_empty() {
                    selection.limits.extend(nearest.iter().map(Nearest::t));
                }
                if !selection.select(rays, &bounds) {
                    continue;
                }
                theirs.clear();
                theirs.extend(selection.places.iter().map(|place| nearest[*place as usize]));
                instance.intersect_batch(&selection.rays, *id, self.kind, theirs);
                for (place, theirs) in selection.places.iter().zip(theirs.iter()) {
                    nearest[*place as usize] = *theirs;
                    selection.limits[*place as usize] = theirs.t();
                }
            }
        });
        if self.tree.is_some() {
            for (index, nearest) in nearest.iter_mut().enumerate() {
                let ray = rays.ray(index);
                let mut search = Search::from(&ray, *nearest);
                self.collect_from_tree(&ray, |_| true, &mut search);
                *nearest = search.nearest;
            }
        }
    }

    /// Whether anything lies between the ends of each ray; `blocked` is overwritten.
    pub fn occluded(&self, rays: &RayBatch, blocked: &mut Vec<bool>) {
        blocked.clear();
        blocked.resize(rays.len(), false);
        self.occluded_by(rays, |_| true, blocked);
    }

    /// The share of light that passes along each ray where some objects are clear: `clear(hit)`
    /// gives the factor of the surface that is met, or `None` where it is opaque. Factors are
    /// multiplied in order of distance, then primitive. `shares` is overwritten.
    pub fn transmittance(
        &self,
        rays: &RayBatch,
        clear: impl Fn(Hit) -> Option<Rgb>,
        is_clear: impl Fn(u32) -> bool + Copy,
        shares: &mut Vec<Rgb>,
    ) {
        let mut blocked = vec![false; rays.len()];
        self.occluded_by(rays, |object| !is_clear(object), &mut blocked);
        // Most of the others meet nothing that is clear.
        let mut is_met = blocked.clone();
        self.occluded_by(rays, is_clear, &mut is_met);
        shares.clear();
        shares.extend(blocked.iter().enumerate().map(|(i, is_blocked)| {
            if *is_blocked {
                return Rgb::ZERO;
            }
            if !is_met[i] {
                return Rgb::ONE;
            }
            let ray = rays.ray(i);
            let mut share = Rgb::ONE;
            let mut after = (0.0, PrimitiveId::NONE);
            while let Some(hit) = self.next_hit(&ray, after, is_clear) {
                let Some(factor) = clear(hit) else { return Rgb::ZERO };
                share *= factor;
                if share == Rgb::ZERO {
                    return share;
                }
                after = (hit.t, hit.id);
            }
            share
        }));
    }

    /// Whether any of the objects to take lies between the ends of each ray; those already blocked are
    /// left out.
    fn occluded_by(
        &self,
        rays: &RayBatch,
        take: impl Fn(u32) -> bool + Copy,
        blocked: &mut [bool],
    ) {
        WORK.with_borrow_mut(|Work { selection, blocked: theirs, .. }| {
            selection.begin();
            for id in self.listed.iter().filter(|id| take(**id)) {
                let instance = &self.instances[*id as usize];
                let Some(bounds) = self.box_of(instance) else {
                    instance.occluded_batch(rays, *id, self.kind, blocked);
                    selection.limits.clear();
                    continue;
                };
                if selection.limits.is_empty() {
                    let limit = |(is_blocked, t_max): (&bool, &f32)| {
                        if *is_blocked { -1.0 } else { *t_max }
                    };
                    selection.limits.extend(blocked.iter().zip(&rays.t_max).map(limit));
                }
                if !selection.select(rays, &bounds) {
                    continue;
                }
                theirs.clear();
                theirs.resize(selection.places.len(), false);
                instance.occluded_batch(&selection.rays, *id, self.kind, theirs);
                for (place, is_blocked) in selection.places.iter().zip(theirs.iter()) {
                    if *is_blocked {
                        blocked[*place as usize] = true;
                        selection.limits[*place as usize] = -1.0;
                    }
                }
            }
        });
        if self.tree.is_some() {
            for (index, blocked) in blocked.iter_mut().enumerate() {
                *blocked = *blocked || self.occluded_by_tree(&rays.ray(index), take);
            }
        }
    }

    /// What rays are held against before an object. The oracle does without, and so do one or two
    /// objects, whose own trees begin with a box anyway.
    fn box_of(&self, instance: &Instance) -> Option<Aabb> {
        const FEW: usize = 2;
        if self.listed.len() <= FEW {
            return None;
        }
        match self.kind {
            AcceleratorKind::WideBvh | AcceleratorKind::KdTree | AcceleratorKind::KdMidpoint => {
                instance.reach()
            }
            AcceleratorKind::BruteForce => None,
        }
    }

    /// The first hit after `after` in the order of distance, then primitive.
    fn next_hit(
        &self,
        ray: &Ray,
        after: (f32, PrimitiveId),
        take: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let mut search = Search::after(ray, after);
        self.collect(ray, take, &mut search);
        search.nearest.hit()
    }

    fn collect(&self, ray: &Ray, take: impl Fn(u32) -> bool, search: &mut Search) {
        for id in self.listed.iter().copied().filter(|id| take(*id)) {
            self.instances[id as usize].intersect(ray, id, self.kind, search);
        }
        self.collect_from_tree(ray, take, search);
    }

    fn collect_from_tree(&self, ray: &Ray, take: impl Fn(u32) -> bool, search: &mut Search) {
        let Some(tree) = &self.tree else { return };
        let clipped = Ray { t_max: search.nearest.t(), ..*ray };
        let Some(walk) = Walk::new(&clipped, &tree.bounds) else { return };
        tree.walk(&walk, |range| {
            for id in tree.items[range].iter().copied().filter(|id| take(*id)) {
                self.instances[id as usize].intersect(ray, id, self.kind, search);
            }
            search.nearest.t()
        });
    }

    fn occluded_by_tree(&self, ray: &Ray, take: impl Fn(u32) -> bool) -> bool {
        let blocks = |id: u32| take(id) && self.instances[id as usize].occluded(ray, id, self.kind);
        let Some(tree) = &self.tree else { return false };
        let Some(walk) = Walk::new(ray, &tree.bounds) else { return false };
        let mut is_blocked = false;
        tree.walk(&walk, |range| {
            is_blocked |= tree.items[range].iter().any(|id| blocks(*id));
            if is_blocked { -1.0 } else { ray.t_max }
        });
        is_blocked
    }
}

//! Shapes, where they are, and what rays meet of them.
//!
//! [`Geometry`] answers three questions about a batch of rays: what each meets first
//! ([`Geometry::intersect`]), whether anything is in its way ([`Geometry::occluded`]), and how much
//! light gets through where some objects are clear ([`Geometry::transmittance`]). Every accelerator
//! gives the same answers to the last bit: of equal distances the lowest primitive wins.

mod batches;
mod binned;
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
mod object_tree;
mod select;
mod shape;
mod surface;
mod triangle;
mod wide_bvh;

use std::sync::atomic::{AtomicBool, Ordering};

use crate::geometry::kd_tree::Item;
use crate::geometry::object_tree::Branch;
use crate::math::Aabb;

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
    /// Objects that every ray is tested against.
    listed: Vec<u32>,
    /// Over all others.
    tree: Option<Branch>,
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
        /// One or two objects need no box before them: their own trees begin with one.
        const FEW: usize = 2;
        for instance in &instances {
            if let Shape::Mesh(mesh) = instance.shape() {
                mesh.build_tree(kind, stop)?;
            }
        }
        let is_listed = instances.len() <= FEW || kind == AcceleratorKind::BruteForce;
        let (mut listed, mut items) = (Vec::new(), Vec::new());
        for (id, instance) in (0..).zip(&instances) {
            match instance.reach() {
                Some(bounds) if !is_listed => items.push(Item { id, bounds }),
                _ => listed.push(id),
            }
        }
        let tree = if items.is_empty() { None } else { Some(Branch::build(items, stop)?) };
        Ok(Self { instances, kind, listed, tree })
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
}

//! A shape at its place in the world.

use glam::{DVec3, Vec3};

use crate::geometry::crossings::{Crossings, ObjectRays};
use crate::geometry::mesh_tree::TracedMesh;
use crate::geometry::nearest::{Nearest, Search};
use crate::geometry::{AcceleratorKind, Shape, TraversalCost};
use crate::math::vectorized::{BLOCK, set_dvec3, set_vec3, vec3, vectorized};
use crate::math::{Aabb, PrimitiveId, Ray, RayBatch, RayBlock, Transform};

/// A shape and the transform that puts it into the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    shape: Shape,
    transform: Transform,
    bounds: Option<Aabb>,
}

impl Instance {
    /// Puts a shape at its place.
    pub fn new(shape: Shape, transform: Transform) -> Self {
        let bounds = shape.bounds().map(|corners| world_bounds(corners, &transform));
        Self { shape, transform, bounds }
    }

    /// The shape, in object space.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Where it is.
    pub fn transform(&self) -> &Transform {
        &self.transform
    }

    /// Around it in the world, rounded outwards; `None` where it is infinite or empty.
    pub fn bounds(&self) -> Option<Aabb> {
        self.bounds
    }

    /// Around everything that a ray of the world may be found to meet: a mesh is met in object
    /// space, where the ray's origin is rounded in proportion to the distance of the two origins.
    pub(super) fn reach(&self) -> Option<Aabb> {
        const UNIT: f64 = 16.0 / 16_777_216.0;
        let shift = self.transform.world_from_object_point(DVec3::ZERO).abs().max_element();
        let pad = Vec3::splat((shift * UNIT) as f32);
        self.bounds.map(|bounds| Aabb { min: bounds.min - pad, max: bounds.max + pad })
    }

    /// Takes the hits of a ray of the world into a search.
    pub(super) fn intersect(
        &self,
        ray: &Ray,
        object: u32,
        kind: AcceleratorKind,
        search: &mut Search,
    ) {
        match &self.shape {
            Shape::Mesh(mesh) => self.with_object_ray(ray, mesh, |ray| {
                mesh.tree(kind).intersect(ray, object, search);
            }),
            Shape::Sphere { .. }
            | Shape::Plane { .. }
            | Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Cylinder { .. } => {
                for (t, primitive) in self.crossings(ray).into_iter().flatten() {
                    search.offer(t as f32, PrimitiveId { object, primitive });
                }
            }
        }
    }

    /// [`Instance::intersect`] that adds up what it takes.
    pub(super) fn intersect_counted(
        &self,
        ray: &Ray,
        object: u32,
        kind: AcceleratorKind,
        search: &mut Search,
        cost: &mut TraversalCost,
    ) {
        match &self.shape {
            Shape::Mesh(mesh) => self.with_object_ray(ray, mesh, |ray| {
                mesh.tree(kind).intersect_counted(ray, object, search, cost);
            }),
            Shape::Sphere { .. }
            | Shape::Plane { .. }
            | Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Cylinder { .. } => {
                cost.n_primitives += 1;
                self.intersect(ray, object, kind, search);
            }
        }
    }

    /// [`Instance::intersect`] for many rays, one `nearest` each.
    pub(super) fn intersect_batch(
        &self,
        rays: &RayBatch,
        object: u32,
        kind: AcceleratorKind,
        nearest: &mut [Nearest],
    ) {
        match &self.shape {
            Shape::Mesh(mesh) if !mesh.bounds.is_empty() => {
                let tree = mesh.tree(kind);
                if self.transform.is_identity() {
                    tree.intersect_batch(rays, object, nearest);
                } else {
                    tree.intersect_batch(&self.object_rays(rays), object, nearest);
                }
            }
            Shape::Mesh(_) => {}
            Shape::Sphere { .. }
            | Shape::Plane { .. }
            | Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Cylinder { .. } => {
                self.each_crossing(rays, |index, t, primitive| {
                    let (nearest, source) = (&mut nearest[index], rays.source[index]);
                    nearest.offer(t, PrimitiveId { object, primitive }, source);
                });
            }
        }
    }

    /// Whether the object lies between the ends of each ray; those already blocked are left out.
    pub(super) fn occluded_batch(
        &self,
        rays: &RayBatch,
        object: u32,
        kind: AcceleratorKind,
        blocked: &mut [bool],
    ) {
        match &self.shape {
            Shape::Mesh(mesh) if !mesh.bounds.is_empty() => {
                let tree = mesh.tree(kind);
                if self.transform.is_identity() {
                    tree.occluded_batch(rays, object, blocked);
                } else {
                    tree.occluded_batch(&self.object_rays(rays), object, blocked);
                }
            }
            Shape::Mesh(_) => {}
            Shape::Sphere { .. }
            | Shape::Plane { .. }
            | Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Cylinder { .. } => {
                self.each_crossing(rays, |index, t, primitive| {
                    let mut nearest = Nearest::new(rays.t_max[index]);
                    let id = PrimitiveId { object, primitive };
                    nearest.offer(t, id, rays.source[index]);
                    blocked[index] |= nearest.is_hit();
                });
            }
        }
    }

    /// Calls with the number of a ray, the parameter and the primitive of each crossing of a solid.
    fn each_crossing(&self, rays: &RayBatch, mut call: impl FnMut(usize, f32, u32)) {
        let mut crossings = Crossings::NONE;
        let mut theirs = ObjectRays { origin: [[0.0; BLOCK]; 3], direction: [[0.0; BLOCK]; 3] };
        let mut ours = RayBlock::IDLE;
        for start in (0..rays.len()).step_by(BLOCK) {
            let n = BLOCK.min(rays.len() - start);
            rays.copy_to(start, n, &mut ours);
            widened(&self.transform, &ours, &mut theirs);
            self.shape.crossings_of_block(&theirs, &mut crossings);
            for i in 0..n {
                for k in 0..2 {
                    let t = crossings.t[k][i];
                    if t > 0.0 {
                        call(start + i, t, crossings.primitive[k][i]);
                    }
                }
            }
        }
    }

    /// Rays of the world as a mesh sees them, with one rounding.
    fn object_rays(&self, rays: &RayBatch) -> RayBatch {
        let mut batch = RayBatch::with_capacity(rays.len());
        let mut block = RayBlock::IDLE;
        for start in (0..rays.len()).step_by(BLOCK) {
            let n = BLOCK.min(rays.len() - start);
            rays.copy_to(start, n, &mut block);
            moved(&self.transform, &mut block);
            batch.append(&block, n);
        }
        batch
    }

    fn object_ray(&self, ray: &Ray) -> Ray {
        let origin = self.transform.object_from_world_point(ray.origin.as_dvec3()).as_vec3();
        let direction = self.transform.object_from_world_vector(ray.direction.as_dvec3()).as_vec3();
        Ray { origin, direction, ..*ray }
    }

    /// Crossings of a solid by a ray of the world, in f64.
    pub(super) fn crossings(&self, ray: &Ray) -> [Option<(f64, u32)>; 2] {
        let origin = self.transform.object_from_world_point(ray.origin.as_dvec3());
        let direction = self.transform.object_from_world_vector(ray.direction.as_dvec3());
        self.shape.crossings(origin, direction)
    }

    /// Calls with the ray as the mesh sees it, unless there is nothing to meet.
    fn with_object_ray(&self, ray: &Ray, mesh: &TracedMesh, call: impl FnOnce(&Ray)) {
        if mesh.bounds.is_empty() {
            return;
        }
        if self.transform.is_identity() {
            return call(ray);
        }
        call(&self.object_ray(ray));
    }
}

vectorized! {
    /// To object space, in double precision.
    fn widened(transform: &Transform, rays: &RayBlock, theirs: &mut ObjectRays) {
        if transform.is_identity() {
            for i in 0..BLOCK {
                set_dvec3(&mut theirs.origin, i, vec3(&rays.origin, i).as_dvec3());
                set_dvec3(&mut theirs.direction, i, vec3(&rays.direction, i).as_dvec3());
            }
        } else {
            for i in 0..BLOCK {
                let origin = transform.unmoved_point(vec3(&rays.origin, i).as_dvec3());
                let direction = transform.unmoved_vector(vec3(&rays.direction, i).as_dvec3());
                set_dvec3(&mut theirs.origin, i, origin);
                set_dvec3(&mut theirs.direction, i, direction);
            }
        }
    }
    /// To the space of an object that is not where it was made.
    fn moved(transform: &Transform, rays: &mut RayBlock) {
        for i in 0..BLOCK {
            let origin = transform.unmoved_point(vec3(&rays.origin, i).as_dvec3());
            let direction = transform.unmoved_vector(vec3(&rays.direction, i).as_dvec3());
            set_vec3(&mut rays.origin, i, origin.as_vec3());
            set_vec3(&mut rays.direction, i, direction.as_vec3());
        }
    }
}

fn world_bounds([min, max]: [DVec3; 2], transform: &Transform) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    for corner in 0..8 {
        let pick = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
        let p = transform.world_from_object_point(DVec3::new(pick(0), pick(1), pick(2)));
        let p = p.to_array();
        bounds.min = bounds.min.min(Vec3::from_array(p.map(|x| (x as f32).next_down())));
        bounds.max = bounds.max.max(Vec3::from_array(p.map(|x| (x as f32).next_up())));
    }
    bounds
}

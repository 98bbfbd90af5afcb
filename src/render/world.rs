//! A job made ready: its scene with the trees that rays need.

use std::sync::atomic::AtomicBool;

use crate::geometry::{Geometry, Hit, Nearest, Shape, Stopped};
use crate::math::RayBatch;
use crate::render::emission::Emission;
use crate::render::features::Feature;
use crate::render::job::RenderJob;
use crate::scene::description::IntegratorKind;
use crate::scene::{Material, Object};

/// A job and its geometry.
#[derive(Debug)]
pub struct World {
    /// What is rendered.
    pub job: RenderJob,
    /// Its objects, with their trees built.
    pub geometry: Geometry,
    /// For each object, whether any of its materials is glass.
    pub(super) is_clear: Vec<bool>,
    pub(super) has_glass: bool,
    /// The material slots of all objects: object and slot.
    pub(super) slots: Vec<(u32, u32)>,
    /// For each object, where its slots start, and at last their number.
    first_slot: Vec<u32>,
    /// What lights others in "path" beside `[[lights]]`; empty in "direct".
    pub(super) emission: Emission,
}

/// What the pinhole ray through a place in the picture meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The point met, in the world.
    pub point: [f32; 3],
    /// What is there.
    pub feature: Feature,
}

impl World {
    /// [`World::build`], to its end.
    pub fn new(job: RenderJob) -> Self {
        Self::build(job, &AtomicBool::new(false)).expect("nobody stops it")
    }

    /// Builds the trees that are missing, on the current pool. `stop` is looked at as that goes on.
    ///
    /// # Errors
    /// [`Stopped`]; trees that were finished before are kept with their meshes.
    pub fn build(job: RenderJob, stop: &AtomicBool) -> Result<Self, Stopped> {
        let instances = job.scene.objects.iter().map(|object| object.instance.clone()).collect();
        let geometry = Geometry::build(instances, job.settings.accelerator, stop)?;
        let is_glass = |object: &Object| {
            object.materials.iter().any(|id| job.scene.materials[*id as usize].is_glass())
        };
        let is_clear: Vec<bool> = job.scene.objects.iter().map(is_glass).collect();
        let has_glass = is_clear.contains(&true);
        let (mut slots, mut first_slot) = (Vec::new(), Vec::new());
        for (index, object) in job.scene.objects.iter().enumerate() {
            first_slot.push(slots.len() as u32);
            let n_slots = object.materials.len() as u32;
            slots.extend((0..n_slots).map(|slot| (index as u32, slot)));
        }
        first_slot.push(slots.len() as u32);
        let emission = match job.settings.integrator {
            IntegratorKind::Direct => Emission::default(),
            IntegratorKind::Path => Emission::new(&job.scene),
        };
        Ok(Self { job, geometry, is_clear, has_glass, slots, first_slot, emission })
    }

    /// The material at a hit.
    pub(super) fn material_at(&self, hit: Hit) -> &Material {
        let object = &self.job.scene.objects[hit.id.object as usize];
        &self.job.scene.materials[object.material(self.slot_at(hit)) as usize]
    }

    /// The material slot at a hit; the last one of the object stands for all further ones.
    pub(super) fn slot_at(&self, hit: Hit) -> u32 {
        let object = &self.job.scene.objects[hit.id.object as usize];
        let last = object.materials.len() as u32 - 1;
        match object.instance.shape() {
            Shape::Mesh(mesh) if last > 0 => {
                let slot = mesh.mesh.slots.get(hit.id.primitive as usize);
                slot.map_or(0, |slot| last.min(*slot))
            }
            Shape::Mesh(_)
            | Shape::Sphere { .. }
            | Shape::Plane { .. }
            | Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Cylinder { .. } => 0,
        }
    }

    /// The number of the material slot at a hit among those of all objects.
    pub(super) fn slot_number(&self, hit: Hit) -> u32 {
        let object = hit.id.object as usize;
        let (first, end) = (self.first_slot[object], self.first_slot[object + 1]);
        if end - first == 1 { first } else { first + self.slot_at(hit) }
    }

    /// What the pinhole ray at (x, y) in pixels meets; `None` for suns and the background.
    pub fn pick(&self, x: f32, y: f32) -> Option<Pick> {
        let ray = self.pixel_ray(x, y);
        let mut rays = RayBatch::default();
        rays.push(ray);
        let mut hits = Vec::new();
        self.geometry.intersect(&rays, &mut hits);
        let feature = self.feature(&ray, hits.first().and_then(Nearest::hit));
        let point = ray.at(feature.depth).to_array();
        feature.depth.is_finite().then_some(Pick { point, feature })
    }
}

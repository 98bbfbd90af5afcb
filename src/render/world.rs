//! A job made ready: its scene with the trees that rays need.

use crate::geometry::{Geometry, Hit, Shape};
use crate::math::Ray;
use crate::render::emission::Emission;
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
    /// What lights others in "path" beside `[[lights]]`; empty in "direct".
    pub(super) emission: Emission,
}

/// What a ray through the middle of a pixel meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The point met, in the world.
    pub point: [f32; 3],
    /// Its distance along the viewing axis.
    pub depth: f32,
    /// Index among the enabled objects.
    pub object: u32,
}

impl World {
    /// Builds the trees that are missing, on the current pool.
    pub fn new(job: RenderJob) -> Self {
        let instances = job.scene.objects.iter().map(|object| object.instance.clone()).collect();
        let geometry = Geometry::new(instances, job.settings.accelerator);
        let is_glass = |object: &Object| {
            object.materials.iter().any(|id| job.scene.materials[*id as usize].is_glass())
        };
        let is_clear: Vec<bool> = job.scene.objects.iter().map(is_glass).collect();
        let has_glass = is_clear.contains(&true);
        let emission = match job.settings.integrator {
            IntegratorKind::Direct => Emission::default(),
            IntegratorKind::Path => Emission::new(&job.scene),
        };
        Self { job, geometry, is_clear, has_glass, emission }
    }

    /// The material at a hit.
    pub(super) fn material_at(&self, hit: Hit) -> &Material {
        let object = &self.job.scene.objects[hit.id.object as usize];
        let slot = match object.instance.shape() {
            Shape::Mesh(mesh) => {
                mesh.mesh.slots.get(hit.id.primitive as usize).copied().unwrap_or(0)
            }
            Shape::Sphere { .. }
            | Shape::Plane { .. }
            | Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Cylinder { .. } => 0,
        };
        &self.job.scene.materials[object.material(slot) as usize]
    }

    /// What the pinhole ray at (x, y) in pixels meets.
    pub fn pick(&self, x: f32, y: f32) -> Option<Pick> {
        let camera = &self.job.scene.camera;
        let size = glam::Vec2::new(self.job.width as f32, self.job.height as f32);
        let ray = Ray::new(camera.eye, camera.pinhole_direction(glam::Vec2::new(x, y), size));
        let mut rays = crate::math::RayBatch::default();
        rays.push(ray);
        let mut hits = Vec::new();
        self.geometry.intersect(&rays, &mut hits);
        let hit = hits.first().copied().flatten()?;
        // The direction's component along the axis is 1, so the parameter is the depth.
        Some(Pick { point: ray.at(hit.t).to_array(), depth: hit.t, object: hit.id.object })
    }
}

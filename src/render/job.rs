//! What to render: a value that determines every pixel to the last bit.

use std::sync::Arc;

use crate::geometry::{AcceleratorKind, Shape, TracedMesh};
use crate::math::sampler::Sampler;
use crate::render::film::Film;
use crate::scene::Scene;
use crate::scene::description::{IntegratorKind, RenderDescription, SamplerKind};

/// A picture to be made. Two equal jobs have equal pixels for equal sample counts.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderJob {
    /// What is seen.
    pub scene: Arc<Scene>,
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// How light is followed.
    pub settings: RenderSettings,
}

/// How light is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Which paths.
    pub integrator: IntegratorKind,
    /// Where the numbers come from, with their seed.
    pub sampler: Sampler,
    /// Whether samples go where the error is.
    pub adaptive: bool,
    /// Scattering events after the camera ray.
    pub max_depth: u32,
    /// How rays find what they meet; changes no pixel.
    pub accelerator: AcceleratorKind,
}

impl RenderSettings {
    /// The settings of a scene file.
    pub fn new(render: &RenderDescription, accelerator: AcceleratorKind) -> Self {
        let seed = render.seed;
        let sampler = match render.sampler {
            SamplerKind::Sobol => Sampler::Sobol { seed },
            SamplerKind::Random => Sampler::Random { seed },
        };
        let RenderDescription { integrator, max_depth, adaptive, .. } = *render;
        Self { integrator, sampler, adaptive, max_depth, accelerator }
    }
}

impl RenderJob {
    /// Bytes that its picture takes while it is rendered: the film, the sums of a pass on their
    /// way, and what is made of them to be shown or written.
    pub fn picture_bytes(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * Film::BYTES_A_PIXEL
    }

    /// The trees that are to be built for it: over how many triangles, and how many bytes that
    /// takes at most while it goes on.
    pub fn unbuilt_trees(&self) -> (usize, u64) {
        let kind = self.settings.accelerator;
        let mut meshes: Vec<&Arc<TracedMesh>> = Vec::new();
        for object in &self.scene.objects {
            if let Shape::Mesh(mesh) = object.instance.shape()
                && !mesh.has_tree(kind)
                && !meshes.iter().any(|known| Arc::ptr_eq(known, mesh))
            {
                meshes.push(mesh);
            }
        }
        let n_triangles = meshes.iter().map(|mesh| mesh.mesh.triangles.len()).sum();
        (n_triangles, n_triangles as u64 * kind.bytes_a_triangle())
    }

    /// The same view in a picture smaller by `scale` (at least 1), rounded up.
    pub fn coarse(&self, scale: u32) -> Self {
        Self {
            width: self.width.div_ceil(scale),
            height: self.height.div_ceil(scale),
            ..self.clone()
        }
    }
}

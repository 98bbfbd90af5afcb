//! The surface as light meets it: sides turned, normals bent, textures looked up.

use glam::Vec3;

use crate::brdf::Glossy;
use crate::color::Rgb;
use crate::geometry::{Hit, Surface};
use crate::math::{Frame, Ray};
use crate::render::world::World;
use crate::scene::description::IntegratorKind;
use crate::scene::material::{ColorSource, Material};
use crate::scene::texture::Lookup;

/// A point ready to be lit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading<'a> {
    pub(super) surface: Surface,
    pub(super) material: &'a Material,
    /// Unit geometric normal on the viewer's side.
    pub(super) normal: Vec3,
    /// Around the shading normal, on the side of `normal`.
    pub(super) frame: Frame,
    /// Whether the viewer is on the outer side.
    pub(super) is_outside: bool,
    /// Unit direction towards the viewer, in the world.
    pub(super) wo: Vec3,
    /// Diffuse and glossy reflection here.
    pub(super) glossy: Glossy,
}

impl<'a> Shading<'a> {
    pub(super) fn new(world: &'a World, ray: &Ray, hit: Hit) -> Self {
        let surface = world.geometry.surface(ray, hit);
        let scene = &*world.job.scene;
        let object = &scene.objects[hit.id.object as usize];
        let material = &scene.materials[object.material(surface.slot) as usize];
        let lookup = Lookup {
            point: surface.object_point,
            uv: surface.uv,
            uv_gradients: surface.uv_gradients,
        };
        let bent = match material.bump {
            Some((texture, height)) => {
                let n = surface.object_normal;
                let g = scene.textures[texture as usize].luminance_gradient(&lookup);
                (n - height * (g - g.dot(n) * n)).normalize_or(n)
            }
            None => surface.object_normal,
        };
        let transform = object.instance.transform();
        let shading_normal = transform
            .world_from_object_normal(bent.as_dvec3())
            .as_vec3()
            .normalize_or(surface.normal);
        let wo = -ray.direction.normalize();
        let is_outside = surface.normal.dot(wo) >= 0.0;
        let normal = if is_outside { surface.normal } else { -surface.normal };
        let shading_normal =
            if shading_normal.dot(normal) < 0.0 { -shading_normal } else { shading_normal };
        // Only a glossy lobe and scattered directions ask where the tangents point.
        let scatters = world.job.settings.integrator == IntegratorKind::Path;
        let frame = if scatters || material.specular != Rgb::ZERO {
            let tangent = transform.world_direction(material.tangent, Vec3::X);
            Frame::from_normal_tangent(shading_normal, tangent)
        } else {
            Frame::from_normal(shading_normal)
        };
        let color = |source: &ColorSource| match source.texture {
            Some(id) => source.color * scene.textures[id as usize].eval(&lookup),
            None => source.color,
        };
        let glossy = Glossy {
            diffuse: color(&material.diffuse),
            specular: material.specular,
            lobe: material.lobe,
        };
        Self { surface, material, normal, frame, is_outside, wo, glossy }
    }

    /// Whether a direction is above both the geometric surface and the shading normal's plane.
    pub(super) fn is_above(&self, wi: Vec3) -> bool {
        self.normal.dot(wi) > 0.0 && self.frame.z.dot(wi) > 0.0
    }
}

//! The surface as light meets it: sides turned, normals bent, textures looked up; of single hits,
//! and of blocks of hits on one material, in lanes, by the same formulas.

use glam::{DVec3, Vec3};

use crate::brdf::Glossy;
use crate::color::Rgb;
use crate::geometry::{Hit, HitBlock, Surface, SurfaceBlock};
use crate::math::vectorized::{BLOCK, Lane3, NO_LANES, set_vec3, vec3, vectorized};
use crate::math::{Frame, Ray, Transform};
use crate::render::world::World;
use crate::scene::description::IntegratorKind;
use crate::scene::material::{ColorSource, Material, TextureId};
use crate::scene::texture::{Lookup, Texture};

/// A point ready to be lit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading<'a> {
    pub(super) surface: Surface,
    /// Index of its object.
    pub(super) object: u32,
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

/// What all points of one material on one object have in common.
#[derive(Clone, Copy)]
pub(super) struct Coat<'a> {
    world: &'a World,
    pub(super) object: u32,
    pub(super) material: &'a Material,
    transform: &'a Transform,
    /// Where the tangents point, in the world; `None` where nobody asks.
    tangent: Option<Vec3>,
}

impl<'a> Coat<'a> {
    /// Of an object's material slot.
    pub(super) fn new(world: &'a World, object: u32, slot: u32) -> Self {
        let scene = &*world.job.scene;
        let instance = &scene.objects[object as usize];
        let material = &scene.materials[instance.material(slot) as usize];
        let transform = instance.instance.transform();
        // Only a glossy lobe and scattered directions ask where the tangents point.
        let scatters = world.job.settings.integrator == IntegratorKind::Path;
        let is_asked = scatters || material.specular != Rgb::ZERO;
        let tangent = is_asked.then(|| transform.world_direction(material.tangent, Vec3::X));
        Self { world, object, material, transform, tangent }
    }

    fn texture(&self, id: TextureId) -> &'a Texture {
        &self.world.job.scene.textures[id as usize]
    }

    fn diffuse(&self, at: &Surface) -> Rgb {
        let ColorSource { color, texture } = self.material.diffuse;
        match texture {
            Some(id) => color * self.texture(id).eval(&lookup(at)),
            None => color,
        }
    }

    /// The shading normal in object space, bent where there are bumps.
    fn bent(&self, surface: &Surface) -> Vec3 {
        let n = surface.object_normal;
        let Some((texture, height)) = self.material.bump else { return n };
        bent(n, height, self.texture(texture).luminance_gradient(&lookup(surface)))
    }

    /// Whether texture coordinates are looked at.
    fn needs_uv(&self) -> bool {
        let bump = self.material.bump.map(|(texture, _)| texture);
        let textures = [self.material.diffuse.texture, bump];
        textures.into_iter().flatten().any(|id| matches!(self.texture(id), Texture::Image { .. }))
    }
}

fn lookup(at: &Surface) -> Lookup {
    Lookup { point: at.object_point, uv: at.uv, uv_gradients: at.uv_gradients }
}

/// A normal bent by the gradient of a texture's luminance.
fn bent(n: Vec3, height: f32, g: Vec3) -> Vec3 {
    (n - height * (g - g.dot(n) * n)).normalize_or(n)
}

/// The geometric normal on the viewer's side, and the frame around the shading normal.
#[inline(always)]
fn turned<const HAS_TANGENT: bool>(
    normal: Vec3,
    world_normal: DVec3,
    wo: Vec3,
    tangent: Vec3,
) -> (Vec3, Frame) {
    let shading_normal = world_normal.as_vec3();
    let scale = shading_normal.length_recip();
    let is_plain = scale.is_finite() && scale > 0.0;
    let shading_normal = if is_plain { shading_normal * scale } else { normal };
    let normal = if normal.dot(wo) >= 0.0 { normal } else { -normal };
    let shading_normal =
        if shading_normal.dot(normal) < 0.0 { -shading_normal } else { shading_normal };
    let frame = if HAS_TANGENT {
        Frame::from_normal_tangent(shading_normal, tangent)
    } else {
        Frame::from_normal(shading_normal)
    };
    (normal, frame)
}

impl<'a> Shading<'a> {
    pub(super) fn new(world: &'a World, ray: &Ray, hit: Hit) -> Self {
        let surface = world.geometry.surface(ray, hit);
        let coat = Coat::new(world, hit.id.object, surface.slot);
        let bent = coat.bent(&surface).as_dvec3();
        let bent = coat.transform.world_from_object_normal(bent);
        let wo = -ray.direction.normalize();
        let (normal, frame) = match coat.tangent {
            Some(tangent) => turned::<true>(surface.normal, bent, wo, tangent),
            None => turned::<false>(surface.normal, bent, wo, Vec3::ZERO),
        };
        let diffuse = coat.diffuse(&surface);
        coat.shading(surface, normal, frame, wo, diffuse)
    }

    /// Whether a direction is above both the geometric surface and the shading normal's plane.
    pub(super) fn is_above(&self, wi: Vec3) -> bool {
        self.normal.dot(wi) > 0.0 && self.frame.z.dot(wi) > 0.0
    }
}

impl<'a> Coat<'a> {
    fn shading(
        &self,
        surface: Surface,
        normal: Vec3,
        frame: Frame,
        wo: Vec3,
        diffuse: Rgb,
    ) -> Shading<'a> {
        let Self { object, material, .. } = *self;
        let is_outside = surface.normal.dot(wo) >= 0.0;
        let glossy = Glossy { diffuse, specular: material.specular, lobe: material.lobe };
        Shading { surface, object, material, normal, frame, is_outside, wo, glossy }
    }
}

/// Points of one material, ready to be lit: a [`Shading`] for each.
pub(super) struct ShadingBlock {
    pub(super) surface: SurfaceBlock,
    pub(super) normal: Lane3,
    pub(super) x: Lane3,
    pub(super) y: Lane3,
    pub(super) z: Lane3,
    pub(super) wo: Lane3,
    pub(super) diffuse: Lane3,
}

impl ShadingBlock {
    /// Nothing yet.
    pub(super) const EMPTY: Self = Self {
        surface: SurfaceBlock::EMPTY,
        normal: NO_LANES,
        x: NO_LANES,
        y: NO_LANES,
        z: NO_LANES,
        wo: NO_LANES,
        diffuse: NO_LANES,
    };

    /// Makes the points of these hits ready.
    pub(super) fn fill(&mut self, coat: &Coat<'_>, hits: &HitBlock) {
        let geometry = &coat.world.geometry;
        geometry.surfaces(coat.object, hits, coat.needs_uv(), &mut self.surface);
        self.bend(coat);
        turn(coat.transform, coat.tangent, hits, self);
        let ColorSource { color, texture } = coat.material.diffuse;
        let points = &self.surface.object_point;
        let Some(texture) = texture.map(|id| coat.texture(id)) else {
            self.diffuse = color.to_array().map(|channel| [channel; BLOCK]);
            return;
        };
        if texture.eval_block(points, &mut self.diffuse) {
            for (lane, channel) in self.diffuse.iter_mut().zip(color.to_array()) {
                *lane = lane.map(|x| channel * x);
            }
        } else {
            for i in 0..BLOCK {
                set_vec3(&mut self.diffuse, i, coat.diffuse(&self.surface.surface(i)));
            }
        }
    }

    /// Bends the shading normals where there are bumps.
    fn bend(&mut self, coat: &Coat<'_>) {
        let Some((texture, height)) = coat.material.bump else { return };
        let texture = coat.texture(texture);
        let mut gradients = NO_LANES;
        let is_known = texture.luminance_gradients(&self.surface.object_point, &mut gradients);
        for i in 0..BLOCK {
            let surface = self.surface.surface(i);
            let g = if is_known {
                vec3(&gradients, i)
            } else {
                texture.luminance_gradient(&lookup(&surface))
            };
            set_vec3(&mut self.surface.object_normal, i, bent(surface.object_normal, height, g));
        }
    }

    /// One of them.
    pub(super) fn shading<'a>(&self, coat: &Coat<'a>, i: usize) -> Shading<'a> {
        let (surface, normal) = (self.surface.surface(i), vec3(&self.normal, i));
        coat.shading(surface, normal, self.frame(i), vec3(&self.wo, i), vec3(&self.diffuse, i))
    }

    #[inline(always)]
    pub(super) fn frame(&self, i: usize) -> Frame {
        Frame { x: vec3(&self.x, i), y: vec3(&self.y, i), z: vec3(&self.z, i) }
    }

    #[inline(always)]
    fn turn<const IS_IDENTITY: bool, const HAS_TANGENT: bool>(
        &mut self,
        transform: &Transform,
        tangent: Vec3,
        hits: &HitBlock,
    ) {
        for i in 0..BLOCK {
            let bent = vec3(&self.surface.object_normal, i).as_dvec3();
            let bent = if IS_IDENTITY { bent } else { transform.moved_normal(bent) };
            let wo = -vec3(&hits.direction, i).normalize();
            let (normal, frame) =
                turned::<HAS_TANGENT>(vec3(&self.surface.normal, i), bent, wo, tangent);
            set_vec3(&mut self.normal, i, normal);
            set_vec3(&mut self.x, i, frame.x);
            set_vec3(&mut self.y, i, frame.y);
            set_vec3(&mut self.z, i, frame.z);
            set_vec3(&mut self.wo, i, wo);
        }
    }
}

vectorized! {
    fn turn(
        transform: &Transform,
        tangent: Option<Vec3>,
        hits: &HitBlock,
        block: &mut ShadingBlock,
    ) {
        match (transform.is_identity(), tangent) {
            (true, None) => block.turn::<true, false>(transform, Vec3::ZERO, hits),
            (true, Some(tangent)) => block.turn::<true, true>(transform, tangent, hits),
            (false, None) => block.turn::<false, false>(transform, Vec3::ZERO, hits),
            (false, Some(tangent)) => block.turn::<false, true>(transform, tangent, hits),
        }
    }
}

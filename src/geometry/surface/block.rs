//! Surfaces at a block of hits of one object, in lanes; the formulas are those of a single hit.

#[cfg(test)]
mod tests;

use glam::{DVec3, Vec2};

use super::{Surface, in_world, on_face, onto_plane, onto_sphere, smooth_normal};
use crate::geometry::mesh::{ABSENT, Mesh};
use crate::geometry::shape::{plane_root, sphere_roots};
use crate::geometry::{Geometry, Hit, Shape};
use crate::math::vectorized::{
    BLOCK, DLane3, Lane, Lane3, NO_LANES, dvec3, set_dvec3, set_vec3, vec3, vectorized,
};
use crate::math::{PrimitiveId, Ray, RayBatch, Transform};

/// Hits of one object, each with its ray.
#[derive(Clone, Debug)]
pub(crate) struct HitBlock {
    pub(crate) origin: Lane3,
    pub(crate) direction: Lane3,
    pub(crate) t: Lane<f32>,
    pub(crate) primitive: Lane<u32>,
}

impl HitBlock {
    /// Nothing yet.
    pub(crate) const EMPTY: Self =
        Self { origin: NO_LANES, direction: NO_LANES, t: [0.0; BLOCK], primitive: [0; BLOCK] };

    /// Sets one hit of a batch's ray.
    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, rays: &RayBatch, place: usize, hit: Hit) {
        for axis in 0..3 {
            self.origin[axis][i] = rays.origin[axis][place];
            self.direction[axis][i] = rays.direction[axis][place];
        }
        self.t[i] = hit.t;
        self.primitive[i] = hit.id.primitive;
    }
}

/// A [`Surface`] for each hit of a block.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceBlock {
    pub(crate) point: Lane3,
    pub(crate) normal: Lane3,
    pub(crate) object_point: DLane3,
    pub(crate) object_normal: Lane3,
    pub(crate) clearance: Lane<f32>,
    pub(crate) source: Lane<PrimitiveId>,
    /// Zeros unless they were asked for.
    uv: [Lane<f32>; 2],
    uv_gradients: [Lane3; 2],
}

/// What a shape knows of the points, in object space.
struct LocalBlock {
    point: DLane3,
    normal: DLane3,
}

impl SurfaceBlock {
    /// Nothing yet.
    pub(crate) const EMPTY: Self = Self {
        point: NO_LANES,
        normal: NO_LANES,
        object_point: [[0.0; BLOCK]; 3],
        object_normal: NO_LANES,
        clearance: [0.0; BLOCK],
        source: [PrimitiveId::NONE; BLOCK],
        uv: [[0.0; BLOCK]; 2],
        uv_gradients: [NO_LANES; 2],
    };

    /// One of them; its slot is left at 0.
    pub(crate) fn surface(&self, i: usize) -> Surface {
        Surface {
            point: vec3(&self.point, i),
            normal: vec3(&self.normal, i),
            object_point: dvec3(&self.object_point, i),
            object_normal: vec3(&self.object_normal, i),
            uv: Vec2::new(self.uv[0][i], self.uv[1][i]),
            uv_gradients: [vec3(&self.uv_gradients[0], i), vec3(&self.uv_gradients[1], i)],
            slot: 0,
            source: self.source[i],
            clearance: self.clearance[i],
        }
    }

    fn set(&mut self, i: usize, surface: &Surface) {
        set_vec3(&mut self.point, i, surface.point);
        set_vec3(&mut self.normal, i, surface.normal);
        set_dvec3(&mut self.object_point, i, surface.object_point);
        set_vec3(&mut self.object_normal, i, surface.object_normal);
        (self.uv[0][i], self.uv[1][i]) = (surface.uv.x, surface.uv.y);
        set_vec3(&mut self.uv_gradients[0], i, surface.uv_gradients[0]);
        set_vec3(&mut self.uv_gradients[1], i, surface.uv_gradients[1]);
        self.source[i] = surface.source;
        self.clearance[i] = surface.clearance;
    }
}

impl Geometry {
    /// [`Geometry::surface`] for a block of hits of one object; texture coordinates only where they
    /// are needed.
    pub(crate) fn surfaces(
        &self,
        object: u32,
        hits: &HitBlock,
        needs_uv: bool,
        surfaces: &mut SurfaceBlock,
    ) {
        let instance = &self.instances()[object as usize];
        let transform = instance.transform();
        let mut local = LocalBlock { point: [[0.0; BLOCK]; 3], normal: [[0.0; BLOCK]; 3] };
        let mut magnitude = 0.0;
        let mut is_flat = true;
        match instance.shape() {
            Shape::Mesh(mesh) if !needs_uv => {
                magnitude = f64::from(mesh.bounds.max_abs());
                on_mesh(&mesh.mesh, transform, hits, &mut local, &mut surfaces.object_normal);
            }
            Shape::Plane { point, normal } if !needs_uv => {
                on_planes(
                    *point,
                    *normal,
                    transform,
                    hits,
                    &mut local,
                    &mut surfaces.object_normal,
                );
            }
            Shape::Sphere { center, radius } if !needs_uv => {
                is_flat = false;
                let object_normal = &mut surfaces.object_normal;
                on_spheres(*center, *radius, transform, hits, &mut local, object_normal);
            }
            Shape::Mesh(_)
            | Shape::Sphere { .. }
            | Shape::Plane { .. }
            | Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Cylinder { .. } => {
                for i in 0..BLOCK {
                    let ray = Ray::new(vec3(&hits.origin, i), vec3(&hits.direction, i));
                    let id = PrimitiveId { object, primitive: hits.primitive[i] };
                    surfaces.set(i, &self.surface(&ray, Hit { t: hits.t[i], id }));
                }
                return;
            }
        }
        into_world(transform, &local, magnitude, surfaces);
        surfaces.object_point = local.point;
        for (source, primitive) in surfaces.source.iter_mut().zip(hits.primitive) {
            *source = if is_flat { PrimitiveId { object, primitive } } else { PrimitiveId::NONE };
        }
    }
}

/// The ray as the object sees it.
#[inline(always)]
fn object_ray<const IS_IDENTITY: bool>(
    transform: &Transform,
    hits: &HitBlock,
    i: usize,
) -> (DVec3, DVec3) {
    let origin = vec3(&hits.origin, i).as_dvec3();
    let direction = vec3(&hits.direction, i).as_dvec3();
    if IS_IDENTITY {
        (origin, direction)
    } else {
        (transform.unmoved_point(origin), transform.unmoved_vector(direction))
    }
}

fn on_mesh(
    mesh: &Mesh,
    transform: &Transform,
    hits: &HitBlock,
    local: &mut LocalBlock,
    shading_normals: &mut Lane3,
) {
    let mut corners = [NO_LANES; 3];
    // Where there are none, zeros cancel, and the flat normal stays.
    let mut normals = [NO_LANES; 3];
    for i in 0..BLOCK {
        let triangle = hits.primitive[i];
        for (lanes, corner) in corners.iter_mut().zip(mesh.corners(triangle)) {
            set_vec3(lanes, i, corner);
        }
        let ids = mesh.normal_ids.get(triangle as usize).filter(|ids| ids[0] != ABSENT);
        for (lanes, id) in normals.iter_mut().zip(ids.into_iter().flatten()) {
            set_vec3(lanes, i, mesh.normals[*id as usize]);
        }
    }
    let is_smooth = !mesh.normal_ids.is_empty();
    on_triangles(&corners, is_smooth.then_some(&normals), transform, hits, local, shading_normals);
}

#[inline(always)]
fn each_triangle<const IS_IDENTITY: bool, const IS_SMOOTH: bool>(
    corners: &[Lane3; 3],
    normals: &[Lane3; 3],
    transform: &Transform,
    hits: &HitBlock,
    local: &mut LocalBlock,
    shading_normals: &mut Lane3,
) {
    for i in 0..BLOCK {
        let (origin, direction) = object_ray::<IS_IDENTITY>(transform, hits, i);
        let [a, b, c] = [vec3(&corners[0], i), vec3(&corners[1], i), vec3(&corners[2], i)];
        let face = on_face([a.as_dvec3(), b.as_dvec3(), c.as_dvec3()], origin, direction);
        let shading_normal = if IS_SMOOTH {
            let n = [vec3(&normals[0], i), vec3(&normals[1], i), vec3(&normals[2], i)];
            smooth_normal(n, face.weights, face.normal)
        } else {
            face.normal
        };
        set_dvec3(&mut local.point, i, face.point);
        set_dvec3(&mut local.normal, i, face.normal);
        set_vec3(shading_normals, i, shading_normal.as_vec3());
    }
}

#[inline(always)]
fn each_plane<const IS_IDENTITY: bool>(
    (point, normal): (DVec3, DVec3),
    transform: &Transform,
    hits: &HitBlock,
    local: &mut LocalBlock,
    shading_normals: &mut Lane3,
) {
    for i in 0..BLOCK {
        let (origin, direction) = object_ray::<IS_IDENTITY>(transform, hits, i);
        // The hit's parameter was rounded to f32; find it again in full.
        let exact = plane_root(origin, direction, point, normal);
        let t = if exact as f32 == hits.t[i] { exact } else { f64::from(hits.t[i]) };
        set_dvec3(&mut local.point, i, onto_plane(origin + direction * t, point, normal));
        set_dvec3(&mut local.normal, i, normal);
        set_vec3(shading_normals, i, normal.as_vec3());
    }
}

#[inline(always)]
fn each_sphere<const IS_IDENTITY: bool>(
    (center, radius): (DVec3, f64),
    transform: &Transform,
    hits: &HitBlock,
    local: &mut LocalBlock,
    shading_normals: &mut Lane3,
) {
    for i in 0..BLOCK {
        let (origin, direction) = object_ray::<IS_IDENTITY>(transform, hits, i);
        let (discriminant, t0, t1) = sphere_roots(origin - center, direction, radius);
        let (first, last) = (t0.min(t1), t0.max(t1));
        let is_met = discriminant >= 0.0;
        let given = f64::from(hits.t[i]);
        let t = if is_met && last as f32 == hits.t[i] { last } else { given };
        let t = if is_met && first as f32 == hits.t[i] { first } else { t };
        let (point, normal) = onto_sphere(origin + direction * t, center, radius);
        set_dvec3(&mut local.point, i, point);
        set_dvec3(&mut local.normal, i, normal);
        set_vec3(shading_normals, i, normal.as_vec3());
    }
}

#[inline(always)]
fn each_in_world<const IS_IDENTITY: bool>(
    transform: &Transform,
    local: &LocalBlock,
    magnitude: f64,
    surfaces: &mut SurfaceBlock,
) {
    for i in 0..BLOCK {
        let (point, normal) = (dvec3(&local.point, i), dvec3(&local.normal, i));
        let (point, normal, clearance) =
            in_world::<IS_IDENTITY>(transform, point, normal, magnitude);
        set_vec3(&mut surfaces.point, i, point);
        set_vec3(&mut surfaces.normal, i, normal);
        surfaces.clearance[i] = clearance;
    }
}

vectorized! {
    fn on_triangles(
        corners: &[Lane3; 3],
        normals: Option<&[Lane3; 3]>,
        transform: &Transform,
        hits: &HitBlock,
        local: &mut LocalBlock,
        out: &mut Lane3,
    ) {
        match (transform.is_identity(), normals) {
            (true, Some(n)) => each_triangle::<true, true>(corners, n, transform, hits, local, out),
            (true, None) => {
                each_triangle::<true, false>(corners, corners, transform, hits, local, out);
            }
            (false, Some(n)) => {
                each_triangle::<false, true>(corners, n, transform, hits, local, out);
            }
            (false, None) => {
                each_triangle::<false, false>(corners, corners, transform, hits, local, out);
            }
        }
    }
    fn on_planes(
        point: DVec3,
        normal: DVec3,
        transform: &Transform,
        hits: &HitBlock,
        local: &mut LocalBlock,
        out: &mut Lane3,
    ) {
        if transform.is_identity() {
            each_plane::<true>((point, normal), transform, hits, local, out);
        } else {
            each_plane::<false>((point, normal), transform, hits, local, out);
        }
    }
    fn on_spheres(
        center: DVec3,
        radius: f64,
        transform: &Transform,
        hits: &HitBlock,
        local: &mut LocalBlock,
        out: &mut Lane3,
    ) {
        if transform.is_identity() {
            each_sphere::<true>((center, radius), transform, hits, local, out);
        } else {
            each_sphere::<false>((center, radius), transform, hits, local, out);
        }
    }
    fn into_world(
        transform: &Transform,
        local: &LocalBlock,
        magnitude: f64,
        surfaces: &mut SurfaceBlock,
    ) {
        if transform.is_identity() {
            each_in_world::<true>(transform, local, magnitude, surfaces);
        } else {
            each_in_world::<false>(transform, local, magnitude, surfaces);
        }
    }
}

//! What a surface is like where a ray meets it.

mod block;

use glam::{DVec3, Vec2, Vec3};

use crate::geometry::mesh::{ABSENT, Mesh};
use crate::geometry::shape::{BASE, SIDE, TOP};
use crate::geometry::{Geometry, Hit, Instance, Shape};
use crate::math::{Frame, PrimitiveId, Ray, Transform, portable};

pub(crate) use block::{HitBlock, SurfaceBlock};

/// A point of a surface. Normals are outward: of a solid's outside, of a face's counter-clockwise
/// side; they are not turned to the viewer yet.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// In the world.
    pub point: Vec3,
    /// Unit normal of the flat surface, in the world.
    pub normal: Vec3,
    /// In object space, where textures live.
    pub object_point: DVec3,
    /// Unit shading normal in object space, on the side of the flat one.
    pub object_normal: Vec3,
    /// Texture coordinates, u right and v up.
    pub uv: Vec2,
    /// Gradients of u and v by the object-space point, along the surface.
    pub uv_gradients: [Vec3; 2],
    /// Material slot of the face; 0 for solids.
    pub slot: u32,
    /// What a ray that leaves from here cannot meet again, where it is flat.
    pub source: PrimitiveId,
    /// How far along the normal a ray has to start to be clear of rounding errors.
    pub clearance: f32,
}

/// What a shape knows of one of its points, in object space.
struct Local {
    point: DVec3,
    normal: DVec3,
    shading_normal: DVec3,
    uv: Vec2,
    uv_gradients: [DVec3; 2],
    slot: u32,
    is_flat: bool,
    /// Largest coordinate whose rounding the next intersection suffers from.
    magnitude: f64,
}

impl Surface {
    /// The start of a ray that leaves towards `direction`: the point, moved to that side of the
    /// flat surface by the bound of the rounding errors.
    ///
    /// Source: M. Pharr, W. Jakob and G. Humphreys, "Physically Based Rendering", 4th edition,
    /// 2023, section 6.8.6.
    pub fn leave(&self, direction: Vec3) -> Vec3 {
        Self::left(self.point, self.normal, self.clearance, direction)
    }

    /// [`Surface::leave`] of the surface with these figures.
    #[inline(always)]
    pub(crate) fn left(point: Vec3, normal: Vec3, clearance: f32, direction: Vec3) -> Vec3 {
        let side = if normal.dot(direction) >= 0.0 { 1.0 } else { -1.0 };
        let step = normal * (side * clearance);
        let moved = (point + step).to_array();
        let away = |axis: usize| match step[axis] {
            s if s > 0.0 => moved[axis].next_up(),
            s if s < 0.0 => moved[axis].next_down(),
            _ => moved[axis],
        };
        Vec3::new(away(0), away(1), away(2))
    }
}

impl Geometry {
    /// The surface at a hit of this ray.
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let instance = &self.instances()[hit.id.object as usize];
        let transform = instance.transform();
        let local = local_surface(instance, ray, hit);
        let (point, normal, clearance) = if transform.is_identity() {
            in_world::<true>(transform, local.point, local.normal, local.magnitude)
        } else {
            in_world::<false>(transform, local.point, local.normal, local.magnitude)
        };
        Surface {
            point,
            normal,
            object_point: local.point,
            object_normal: local.shading_normal.as_vec3(),
            uv: local.uv,
            uv_gradients: local.uv_gradients.map(|g| g.as_vec3()),
            slot: local.slot,
            source: if local.is_flat { hit.id } else { PrimitiveId::NONE },
            clearance,
        }
    }
}

/// Point, unit normal and clearance in the world, of a point and a normal of an object.
#[inline(always)]
fn in_world<const IS_IDENTITY: bool>(
    transform: &Transform,
    point: DVec3,
    normal: DVec3,
    magnitude: f64,
) -> (Vec3, Vec3, f32) {
    let (world, normal) = if IS_IDENTITY {
        (point, normal)
    } else {
        (transform.moved_point(point), transform.moved_normal(normal))
    };
    let normal = normal.normalize().as_vec3();
    // Half a unit in the last place is 2^-24 of the magnitude; 4 of them bound the rounding of
    // the position, the transform back, and the differences of the triangle test.
    const UNIT: f64 = 4.0 / 16_777_216.0;
    let error = world.abs() * UNIT + transform.spread(magnitude * UNIT);
    (world.as_vec3(), normal, error.dot(normal.abs().as_dvec3()) as f32)
}

fn local_surface(instance: &Instance, ray: &Ray, hit: Hit) -> Local {
    let transform = instance.transform();
    let origin = transform.object_from_world_point(ray.origin.as_dvec3());
    let direction = transform.object_from_world_vector(ray.direction.as_dvec3());
    let shape = instance.shape();
    if let Shape::Mesh(mesh) = shape {
        let magnitude = f64::from(mesh.bounds.max_abs());
        return on_triangle(&mesh.mesh, hit.id.primitive, origin, direction, magnitude);
    }
    // The hit's parameter was rounded to f32; find it again in full.
    let crossings = shape.crossings(origin, direction).into_iter().flatten();
    let exact =
        crossings.filter(|(t, primitive)| *primitive == hit.id.primitive && *t as f32 == hit.t);
    let t = exact.map(|(t, _)| t).next().unwrap_or(f64::from(hit.t));
    on_solid(shape, hit.id.primitive, origin + direction * t)
}

fn on_triangle(mesh: &Mesh, id: u32, origin: DVec3, direction: DVec3, magnitude: f64) -> Local {
    let [a, b, c] = mesh.corners(id).map(Vec3::as_dvec3);
    let (ab, ac) = (b - a, c - a);
    let cross = ab.cross(ac);
    let FacePoint { point, normal, weights } = on_face([a, b, c], origin, direction);
    let triangle = id as usize;
    let shading_normal = match mesh.normal_ids.get(triangle) {
        Some(ids) if ids[0] != ABSENT => {
            smooth_normal(ids.map(|id| mesh.normals[id as usize]), weights, normal)
        }
        _ => normal,
    };
    let mut uv = Vec2::ZERO;
    let mut uv_gradients = [DVec3::ZERO; 2];
    if let Some(ids) = mesh.uv_ids.get(triangle).filter(|ids| !ids.contains(&ABSENT)) {
        let [ta, tb, tc] = ids.map(|id| mesh.uvs[id as usize].as_dvec2());
        uv = (ta * weights[0] + tb * weights[1] + tc * weights[2]).as_vec2();
        let area2 = cross.length_squared();
        if area2 > 0.0 {
            // Gradients of the second and third barycentric coordinate along the triangle.
            let (grad_v, grad_w) = (ac.cross(cross) / area2, cross.cross(ab) / area2);
            let (db, dc) = (tb - ta, tc - ta);
            uv_gradients = [grad_v * db.x + grad_w * dc.x, grad_v * db.y + grad_w * dc.y];
        }
    }
    let slot = mesh.slots.get(triangle).copied().unwrap_or(0);
    Local { point, normal, shading_normal, uv, uv_gradients, slot, is_flat: true, magnitude }
}

/// A point of a triangle.
struct FacePoint {
    point: DVec3,
    /// Unit; upwards where the triangle has no area.
    normal: DVec3,
    /// Of the three corners.
    weights: [f64; 3],
}

/// Where a ray that is known to meet a triangle does: by Cramer's rule, then back onto the triangle.
#[inline(always)]
fn on_face([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> FacePoint {
    let (ab, ac) = (b - a, c - a);
    let normal = unit_or(ab.cross(ac), DVec3::Y);
    let p = direction.cross(ac);
    let det = ab.dot(p);
    let s = origin - a;
    let is_plain = det != 0.0;
    let v = if is_plain { (s.dot(p) / det).clamp(0.0, 1.0) } else { 1.0 / 3.0 };
    let w = direction.dot(s.cross(ab)) / det;
    let w = if is_plain { w.max(0.0).min(1.0 - v) } else { 1.0 / 3.0 };
    FacePoint { point: a + ab * v + ac * w, normal, weights: [1.0 - v - w, v, w] }
}

/// Corner normals by their weights, on the side of the flat one; the flat one where they cancel.
#[inline(always)]
fn smooth_normal(corners: [Vec3; 3], weights: [f64; 3], flat: DVec3) -> DVec3 {
    let corner = |k: usize| corners[k].as_dvec3() * weights[k];
    let n = unit_or(corner(0) + corner(1) + corner(2), flat);
    if n.dot(flat) < 0.0 { -n } else { n }
}

#[inline(always)]
fn unit_or(v: DVec3, fallback: DVec3) -> DVec3 {
    let scale = v.length_recip();
    let is_plain = scale.is_finite() && scale > 0.0;
    if is_plain { v * scale } else { fallback }
}

fn on_solid(shape: &Shape, primitive: u32, p: DVec3) -> Local {
    let mut local = Local {
        point: p,
        normal: DVec3::Y,
        shading_normal: DVec3::Y,
        uv: Vec2::ZERO,
        uv_gradients: [DVec3::ZERO; 2],
        slot: 0,
        is_flat: false,
        magnitude: 0.0,
    };
    match shape {
        Shape::Mesh(_) => {}
        Shape::Sphere { center, radius } => on_sphere(&mut local, *center, *radius),
        Shape::Plane { point, normal } => {
            local.normal = *normal;
            local.is_flat = true;
            local.point = onto_plane(p, *point, *normal);
            let frame = Frame::from_normal_tangent(normal.as_vec3(), Vec3::X);
            let (x, y) = (frame.x.as_dvec3(), frame.y.as_dvec3());
            let from = local.point - *point;
            local.uv = Vec2::new(from.dot(x) as f32, from.dot(y) as f32);
            local.uv_gradients = [x, y];
        }
        Shape::Box { min, max } => on_box(&mut local, *min, *max, primitive),
        Shape::Cone { base, tip, radius } => {
            on_axial(&mut local, *base, *tip, *radius, 0.0, primitive);
        }
        Shape::Cylinder { base, top, radius } => {
            on_axial(&mut local, *base, *top, *radius, *radius, primitive);
        }
    }
    local.shading_normal = local.normal;
    local
}

#[inline(always)]
fn onto_plane(p: DVec3, point: DVec3, normal: DVec3) -> DVec3 {
    p - normal * (p - point).dot(normal)
}

/// The point, and the unit normal there.
#[inline(always)]
fn onto_sphere(p: DVec3, center: DVec3, radius: f64) -> (DVec3, DVec3) {
    let n = unit_or(p - center, DVec3::Y);
    (center + n * radius, n)
}

fn on_sphere(local: &mut Local, center: DVec3, radius: f64) {
    let n;
    (local.point, n) = onto_sphere(local.point, center, radius);
    local.normal = n;
    let u = 0.5 + portable::atan2_f64(n.x, n.z) / std::f64::consts::TAU;
    let v = 0.5 + portable::asin_f64(n.y.clamp(-1.0, 1.0)) / std::f64::consts::PI;
    local.uv = Vec2::new(u as f32, v as f32);
    let across2 = n.x * n.x + n.z * n.z;
    if across2 > 0.0 {
        let east = DVec3::new(n.z, 0.0, -n.x) / (across2 * radius * std::f64::consts::TAU);
        let north = (DVec3::Y - n * n.y) / (across2.sqrt() * radius * std::f64::consts::PI);
        local.uv_gradients = [east, north];
    }
}

/// Each face carries the unit square of uv once, upright as seen from outside.
fn on_box(local: &mut Local, min: DVec3, max: DVec3, primitive: u32) {
    let axis = (primitive / 2) as usize;
    let is_upper = primitive % 2 == 1;
    let plane = if is_upper { max[axis] } else { min[axis] };
    local.point[axis] = plane;
    local.point = local.point.clamp(min, max);
    let sign = if is_upper { 1.0 } else { -1.0 };
    local.normal = DVec3::AXES[axis] * sign;
    local.is_flat = true;
    let (right, up) = match axis {
        0 => (DVec3::Z * -sign, DVec3::Y),
        1 => (DVec3::X, DVec3::Z * -sign),
        _ => (DVec3::X * sign, DVec3::Y),
    };
    let extent = max - min;
    let coordinate = |direction: DVec3| {
        let length = extent.dot(direction.abs());
        if length <= 0.0 {
            return (0.0, DVec3::ZERO);
        }
        let from = if direction.element_sum() > 0.0 { min } else { max };
        ((local.point - from).dot(direction) / length, direction / length)
    };
    let ((u, u_gradient), (v, v_gradient)) = (coordinate(right), coordinate(up));
    local.uv = Vec2::new(u as f32, v as f32);
    local.uv_gradients = [u_gradient, v_gradient];
}

/// A cone or a cylinder: u is the angle in turns, v the height from 0 at the base to 1; on caps v
/// is the distance from the axis as a share of the radius.
fn on_axial(local: &mut Local, base: DVec3, end: DVec3, radius: f64, end_radius: f64, part: u32) {
    let axis = end - base;
    let height = axis.length();
    let w = axis / height;
    let frame = Frame::from_normal_tangent(w.as_vec3(), Vec3::X);
    let (x, y) = (frame.x.as_dvec3(), frame.y.as_dvec3());
    let from = local.point - base;
    let along = from.dot(w).clamp(0.0, height);
    let across = from - w * from.dot(w);
    let distance = across.length();
    let radial = if distance > 0.0 { across / distance } else { x };
    let angle = portable::atan2_f64(radial.dot(y), radial.dot(x)) / std::f64::consts::TAU;
    let around = if distance > 0.0 {
        w.cross(radial) / (distance * std::f64::consts::TAU)
    } else {
        DVec3::ZERO
    };
    let u = 0.5 + angle;
    local.is_flat = part != SIDE;
    let (v, v_gradient) = match part {
        BASE | TOP => {
            let (level, normal) = if part == BASE { (0.0, -w) } else { (height, w) };
            local.normal = normal;
            local.point = base + w * level + across;
            (distance / radius, radial / radius)
        }
        _ => {
            let narrowing = radius - end_radius;
            local.normal = (radial * height + w * narrowing).normalize();
            let here = radius - narrowing * (along / height);
            local.point = base + w * along + radial * here;
            let slant = (w * height - radial * narrowing).normalize();
            (along / height, slant * (slant.dot(w) / height))
        }
    };
    local.uv = Vec2::new(u as f32, v as f32);
    local.uv_gradients = [around, v_gradient];
}

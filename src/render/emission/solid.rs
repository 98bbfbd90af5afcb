//! Solids that glow, as they are seen from outside: directions to them, with their density.
//!
//! From within nothing is looked for; scattered rays meet nothing else there.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3, Vec3};

use super::Target;
use crate::geometry::{Instance, Shape};
use crate::math::{Frame, Transform, portable, warp};
use crate::scene::light::{Emitter, Light};

/// A solid at its place in the world.
#[derive(Debug)]
pub(super) enum Solid {
    /// Its faces, in the order of their primitives, shining outwards.
    Box(Box<[Face; 6]>),
    /// A sphere, however it is stretched.
    Sphere(Ball),
    /// A cone or a cylinder.
    Axial(Box<Axial>),
}

impl Solid {
    /// `None` for what cannot be looked for: planes are infinite, meshes are no solids.
    pub(super) fn new(instance: &Instance) -> Option<Self> {
        let transform = *instance.transform();
        match instance.shape() {
            Shape::Mesh(_) | Shape::Plane { .. } => None,
            Shape::Box { min, max } => Some(Self::Box(Box::new(faces(*min, *max, &transform)))),
            Shape::Sphere { center, radius } => {
                Some(Self::Sphere(Ball { center: *center, radius: *radius, transform }))
            }
            Shape::Cone { base, tip, radius } => {
                Some(Self::Axial(Box::new(Axial::new(*base, *tip, [*radius, 0.0], transform))))
            }
            Shape::Cylinder { base, top, radius } => {
                Some(Self::Axial(Box::new(Axial::new(*base, *top, [*radius; 2], transform))))
            }
        }
    }

    /// Area of its surface in the world, about: it only guides choices.
    pub(super) fn area(&self) -> f64 {
        match self {
            Self::Box(faces) => faces.iter().map(|face| face.area).sum(),
            Self::Sphere(Ball { radius, transform, .. }) => {
                4.0 * PI * radius * radius * mean_stretch(transform).powi(2)
            }
            Self::Axial(axial) => {
                axial.parts.iter().sum::<f64>() * mean_stretch(&axial.transform).powi(2)
            }
        }
    }

    /// Whether a point of the world is within.
    pub(super) fn contains(&self, from: Vec3) -> bool {
        match self {
            Self::Box(faces) => faces.iter().all(|face| face.height(from) <= 0.0),
            Self::Sphere(ball) => ball.cap(ball.seen(from)).is_none(),
            Self::Axial(axial) => axial.contains(axial.seen(from)),
        }
    }

    /// A way to the solid from a point outside; `choice` and `u` are numbers in [0, 1).
    pub(super) fn sample(&self, from: Vec3, choice: f32, u: [f32; 2]) -> Option<Target> {
        match self {
            Self::Box(faces) => {
                let weights = faces.each_ref().map(|face| face.weight(from));
                let total: f32 = weights.iter().sum();
                let mut rest = choice * total;
                let mut index = 0;
                while index < 5 && rest >= weights[index] {
                    rest -= weights[index];
                    index += 1;
                }
                let sample = faces[index].light.sample(from, u)?;
                let pdf = sample.pdf? * weights[index] / total;
                Some(Target { reach: sample.reach, normal: sample.normal?, pdf })
            }
            Self::Sphere(ball) => ball.sample(from, u),
            Self::Axial(axial) => axial.sample(from, choice, u),
        }
    }

    /// Density per solid angle with which [`Solid::sample`] finds what a ray from outside along the
    /// unit `direction` meets first: `primitive` at the distance `t`, with the unit `normal`.
    pub(super) fn pdf(
        &self,
        from: Vec3,
        direction: Vec3,
        t: f32,
        primitive: u32,
        normal: Vec3,
    ) -> f32 {
        match self {
            Self::Box(faces) => {
                let weights = faces.each_ref().map(|face| face.weight(from));
                let total: f32 = weights.iter().sum();
                let Some(face) = faces.get(primitive as usize).filter(|_| total > 0.0) else {
                    return 0.0;
                };
                face.light.pdf(from, direction, t) * weights[primitive as usize] / total
            }
            Self::Sphere(ball) => ball.pdf(ball.seen(from), direction) as f32,
            Self::Axial(axial) => {
                let cos = f64::from(normal.dot(direction).abs());
                let place = from + direction * t;
                let of_area =
                    axial.area_pdf(axial.seen(from), axial.seen(place), primitive, normal);
                if cos > 0.0 { (of_area * f64::from(t).powi(2) / cos) as f32 } else { 0.0 }
            }
        }
    }
}

/// One face of a box: a rectangle that shines outwards.
#[derive(Debug)]
pub(super) struct Face {
    light: Light,
    center: Vec3,
    normal: Vec3,
    area: f64,
}

impl Face {
    fn height(&self, from: Vec3) -> f32 {
        self.normal.dot(from - self.center)
    }

    /// About the solid angle; 0 from behind.
    fn weight(&self, from: Vec3) -> f32 {
        let height = self.height(from).max(0.0);
        let distance2 = (from - self.center).length_squared() + (self.area / PI) as f32;
        (self.area as f32) * height / (distance2 * distance2.sqrt())
    }
}

/// Axes of a box stay at right angles: an object is scaled before it is turned.
fn faces(min: DVec3, max: DVec3, transform: &Transform) -> [Face; 6] {
    let middle = 0.5 * (min + max);
    let half = 0.5 * (max - min);
    let spans = [0, 1, 2].map(|axis| transform.world_from_object_vector(axis_of(half, axis)));
    [0, 1, 2, 3, 4, 5].map(|primitive| {
        let axis = primitive / 2;
        let sign = if primitive % 2 == 1 { 1.0 } else { -1.0 };
        let place = transform.world_from_object_point(middle + axis_of(half, axis) * sign);
        let outward = transform.world_from_object_vector(DVec3::AXES[axis]) * sign;
        let (across, up) = (spans[(axis + 1) % 3], spans[(axis + 2) % 3]);
        let (normal, x) = (outward.normalize(), across.normalize_or(DVec3::X));
        let frame = Frame { x: x.as_vec3(), y: normal.cross(x).as_vec3(), z: normal.as_vec3() };
        let half = [across.length() as f32, up.length() as f32];
        let center = place.as_vec3();
        let emitter = Emitter::Rectangle { center, frame, half, radiance: Vec3::ONE };
        Face {
            light: Light { visible: false, emitter },
            center,
            normal: frame.z,
            area: 4.0 * across.length() * up.length(),
        }
    })
}

fn axis_of(v: DVec3, axis: usize) -> DVec3 {
    DVec3::AXES[axis] * v[axis]
}

/// The cube root of the volume's factor.
fn mean_stretch(transform: &Transform) -> f64 {
    portable::pow_f64(volume_factor(transform), 1.0 / 3.0)
}

fn volume_factor(transform: &Transform) -> f64 {
    let [x, y, z] = DVec3::AXES.map(|axis| transform.world_from_object_vector(axis));
    x.dot(y.cross(z)).abs()
}

/// A sphere in object space: the cone that it fills there, taken to the world.
#[derive(Debug)]
pub(super) struct Ball {
    center: DVec3,
    radius: f64,
    transform: Transform,
}

impl Ball {
    /// From the sphere's centre, in object space.
    fn seen(&self, from: Vec3) -> DVec3 {
        self.transform.object_from_world_point(from.as_dvec3()) - self.center
    }

    /// 1 - cosine of half the cone's angle; `None` from inside.
    fn cap(&self, seen: DVec3) -> Option<f64> {
        let sin2 = self.radius * self.radius / seen.length_squared();
        (sin2 < 1.0).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
    }

    fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Target> {
        let seen = self.seen(from);
        let cap = self.cap(seen)?;
        let local = warp::square_to_cap(u, cap as f32);
        let axis = (-seen).normalize();
        let direction = Frame::from_normal(axis.as_vec3()).world_from_local(local).as_dvec3();
        let b = -seen.dot(direction) / direction.length_squared();
        let miss = seen + direction * b;
        let inside = (self.radius * self.radius - miss.length_squared()).max(0.0);
        let normal = (miss - direction * (inside / direction.length_squared()).sqrt()).normalize();
        // On the sphere, however the direction was rounded.
        let way = normal * self.radius - seen;
        let reach = self.transform.world_from_object_vector(way).as_vec3();
        let normal = self.transform.world_from_object_normal(normal).normalize().as_vec3();
        let pdf = self.pdf(seen, reach.normalize()) as f32;
        Some(Target { reach, normal, pdf })
    }

    /// A linear map takes a unit direction d to M d, and its solid angle by |det M| / |M d|³.
    fn pdf(&self, seen: DVec3, direction: Vec3) -> f64 {
        let Some(cap) = self.cap(seen) else { return 0.0 };
        let back = self.transform.object_from_world_vector(direction.as_dvec3()).length();
        1.0 / (TAU * cap * volume_factor(&self.transform) * back.powi(3))
    }
}

/// Primitives of a cone or a cylinder, as in the geometry.
const SIDE: usize = 0;
const BASE: usize = 1;
const TOP: usize = 2;

/// A cone or a cylinder in object space, sampled where it faces the point: a part in proportion to
/// its visible area, then the caps uniformly, and the side as it is foreshortened.
#[derive(Debug)]
pub(super) struct Axial {
    base: DVec3,
    /// z along the axis.
    axes: [DVec3; 3],
    height: f64,
    /// At the base and at the end.
    radii: [f64; 2],
    /// Areas of side, base and top in object space.
    parts: [f64; 3],
    transform: Transform,
    volume_factor: f64,
}

impl Axial {
    fn new(base: DVec3, end: DVec3, radii: [f64; 2], transform: Transform) -> Self {
        let height = (end - base).length();
        let z = (end - base) / height;
        let x = z.any_orthonormal_vector();
        let slant = (height * height + (radii[0] - radii[1]).powi(2)).sqrt();
        let side = PI * (radii[0] + radii[1]) * slant;
        let parts = [side, PI * radii[0] * radii[0], PI * radii[1] * radii[1]];
        let volume_factor = volume_factor(&transform);
        Self { base, axes: [x, z.cross(x), z], height, radii, parts, transform, volume_factor }
    }

    /// In the solid's axes, from its base.
    fn seen(&self, from: Vec3) -> DVec3 {
        let p = self.transform.object_from_world_point(from.as_dvec3()) - self.base;
        let [x, y, z] = self.axes;
        DVec3::new(p.dot(x), p.dot(y), p.dot(z))
    }

    /// Radius at a height, continued beyond both ends.
    fn radius_at(&self, z: f64) -> f64 {
        self.radii[0] + (self.radii[1] - self.radii[0]) * (z / self.height)
    }

    fn contains(&self, p: DVec3) -> bool {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        (0.0..=self.height).contains(&p.z) && across <= self.radius_at(p.z)
    }

    /// Half the angle, about the axis, of the part of the side that faces a point.
    fn facing(&self, p: DVec3) -> f64 {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        let radius = self.radius_at(p.z);
        if across <= radius.abs() {
            return if radius < 0.0 { PI } else { 0.0 };
        }
        portable::acos_f64(radius / across)
    }

    /// Integral, from the nearest line of the side to that at `angle`, of the distance by which the
    /// point is above the side there: to it the apparent width of the line is proportional.
    fn width_to(&self, p: DVec3, angle: f64) -> f64 {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        across * portable::sin_f64(angle) - self.radius_at(p.z) * angle
    }

    fn width_at(&self, p: DVec3, angle: f64) -> f64 {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        across * portable::cos_f64(angle) - self.radius_at(p.z)
    }

    /// The angle up to which a share of the apparent width lies: by Newton's steps, which never
    /// leave the way there, as the width falls towards the rim.
    fn angle_of(&self, p: DVec3, share: f64) -> f64 {
        let facing = self.facing(p);
        let goal = share * self.width_to(p, facing);
        let mut angle = 0.0;
        for _ in 0..20 {
            let slope = self.width_at(p, angle);
            if slope <= 0.0 {
                break;
            }
            angle = (angle + (goal - self.width_to(p, angle)) / slope).clamp(0.0, facing);
        }
        angle
    }

    /// Visible areas of the parts.
    fn visible(&self, p: DVec3) -> [f64; 3] {
        let seen = |is_seen: bool, area: f64| if is_seen { area } else { 0.0 };
        [
            self.parts[SIDE] * self.facing(p) / PI,
            seen(p.z < 0.0, self.parts[BASE]),
            seen(p.z > self.height, self.parts[TOP]),
        ]
    }

    fn sample(&self, from: Vec3, choice: f32, u: [f32; 2]) -> Option<Target> {
        let seen = self.seen(from);
        let visible = self.visible(seen);
        let total: f64 = visible.iter().sum();
        let at = f64::from(choice) * total;
        let part = if at < visible[SIDE] {
            SIDE
        } else if at < visible[SIDE] + visible[BASE] {
            BASE
        } else {
            TOP
        };
        let (place, normal) = if part == SIDE {
            self.on_side(seen, u)
        } else {
            let end = part - BASE;
            let p = warp::square_to_disk(u).as_dvec2() * self.radii[end];
            (p.extend(self.height * end as f64), DVec3::Z * (2.0 * end as f64 - 1.0))
        };
        let object = |v: DVec3| self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z;
        let reach = self.transform.world_from_object_vector(object(place - seen));
        let normal = self.transform.world_from_object_normal(object(normal)).normalize();
        let cos = -normal.dot(reach) / reach.length();
        if !(cos > 0.0 && total > 0.0) {
            return None;
        }
        let of_area = self.area_pdf(seen, place, part as u32, normal.as_vec3());
        let pdf = of_area * reach.length_squared() / cos;
        Some(Target { reach: reach.as_vec3(), normal: normal.as_vec3(), pdf: pdf as f32 })
    }

    /// A point of the side within the angle that faces `seen`, and its outward normal.
    fn on_side(&self, seen: DVec3, [u, v]: [f32; 2]) -> (DVec3, DVec3) {
        let middle = portable::atan2_f64(seen.y, seen.x);
        let share = 2.0 * f64::from(u) - 1.0;
        let angle = middle + self.angle_of(seen, share.abs()).copysign(share);
        let (sin, cos) = (portable::sin_f64(angle), portable::cos_f64(angle));
        let [r0, r1] = self.radii;
        // Area grows with the radius: uniform in its square, where it changes.
        let v = f64::from(v);
        let share = if r0 == r1 {
            v
        } else {
            (r0 - (r0 * r0 + v * (r1 * r1 - r0 * r0)).max(0.0).sqrt()) / (r0 - r1)
        };
        let radius = r0 + (r1 - r0) * share;
        let place = DVec3::new(radius * cos, radius * sin, self.height * share);
        (place, DVec3::new(self.height * cos, self.height * sin, r0 - r1))
    }

    /// Density per area of the world, for points that face `seen`. A linear map M takes an area
    /// with unit normal n to |det M| / |Mᵀ n'| of it, n' the unit normal in the world.
    fn area_pdf(&self, seen: DVec3, place: DVec3, primitive: u32, normal: Vec3) -> f64 {
        let visible = self.visible(seen);
        let total: f64 = visible.iter().sum();
        if !visible.get(primitive as usize).is_some_and(|area| *area > 0.0) {
            return 0.0;
        }
        let n = normal.as_dvec3();
        let pulled = DVec3::AXES.map(|axis| self.transform.world_from_object_vector(axis).dot(n));
        let of_object = if primitive as usize == SIDE {
            let (from, to) = (DVec2::new(seen.x, seen.y), DVec2::new(place.x, place.y));
            let cos = from.normalize_or(DVec2::X).dot(to.normalize_or(DVec2::X));
            let angle = portable::acos_f64(cos.clamp(-1.0, 1.0));
            let facing = self.facing(seen);
            self.width_at(seen, angle).max(0.0) * facing / self.width_to(seen, facing)
        } else {
            1.0
        };
        of_object * DVec3::from_array(pulled).length() / (self.volume_factor * total)
    }
}

//! Solids that glow, as they are seen from outside: directions to them, with their density.
//!
//! From within nothing is looked for; scattered rays meet nothing else there.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::Target;
use super::axial::Axial;
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
            Self::Axial(axial) => axial.area() * mean_stretch(axial.transform()).powi(2),
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
        if normal.dot(direction) >= 0.0 {
            return 0.0;
        }
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

pub(super) fn volume_factor(transform: &Transform) -> f64 {
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

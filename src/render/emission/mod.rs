//! What lights others in "path" without being in `[[lights]]`: objects that glow, and the sky.
//!
//! At every surface that scatters, one of them is chosen by how much light it may bring, and a ray
//! is sent to a point of it. Scattered rays find the same light; both are weighted by the power
//! heuristic, so the chance of the choice belongs to the density. Infinite planes, the inside of
//! solids and the darker half of the sky are left to scattered rays.

mod axial;
mod sky;
mod solid;
#[cfg(test)]
mod tests;
mod triangles;

use glam::Vec3;

use crate::color::{Rgb, luminance};
use crate::geometry::{Hit, Shape, Surface};
use crate::render::emission::sky::Sky;
use crate::render::emission::solid::Solid;
use crate::render::emission::triangles::Triangles;
use crate::scene::light::LightSample;
use crate::scene::{Background, Scene};

/// A way from a point to something that glows.
struct Target {
    /// From the point to the target.
    reach: Vec3,
    /// Unit normal there, on the point's side.
    normal: Vec3,
    /// Density per solid angle.
    pdf: f32,
}

/// Everything of a scene that glows and can be looked for.
#[derive(Debug, Default)]
pub(super) struct Emission {
    sources: Vec<Source>,
    sky: Option<Sky>,
    /// For each object, its source.
    source_of: Vec<Option<u32>>,
}

#[derive(Debug)]
struct Source {
    object: u32,
    shape: SourceShape,
    /// Around all of it.
    center: Vec3,
    radius: f32,
    /// Area times luminance, over 4: what it sends in a direction, on average.
    strength: f32,
    /// Luminance of the brightest part.
    peak: f32,
}

#[derive(Debug)]
enum SourceShape {
    Solid(Solid, Rgb),
    Triangles(Triangles),
}

impl Emission {
    /// Of a scene.
    pub(super) fn new(scene: &Scene) -> Self {
        let sky = match scene.background {
            Background::Color(_) => None,
            Background::Texture(_) => Sky::new(scene),
        };
        let mut emission = Self { sky, ..Self::default() };
        for object in 0..scene.objects.len() {
            let source = source(scene, object as u32);
            emission.source_of.push(source.is_some().then_some(emission.sources.len() as u32));
            emission.sources.extend(source);
        }
        emission
    }

    /// Whether there is nothing to look for.
    pub(super) fn is_empty(&self) -> bool {
        self.sources.is_empty() && self.sky.is_none()
    }

    /// Sum of what all sources may bring to a surface, and each of them in `weights`, the sky last.
    /// Depends on nothing but the point, the normal and the object that it is on.
    pub(super) fn weigh(
        &self,
        from: Vec3,
        normal: Vec3,
        object: u32,
        weights: &mut Vec<f32>,
    ) -> f32 {
        weights.clear();
        weights.extend(self.sources.iter().map(|source| source.weight(from, normal, object)));
        weights.extend(self.sky.as_ref().map(sky_weight));
        weights.iter().sum()
    }

    /// A way to one source, chosen by `weights` with their sum `total`. `choice` and `u` are pairs
    /// of numbers in [0, 1). `None` where the sampled point does not face `from`.
    pub(super) fn sample(
        &self,
        scene: &Scene,
        from: Vec3,
        (weights, total): (&[f32], f32),
        [choice, part]: [f32; 2],
        u: [f32; 2],
    ) -> Option<LightSample> {
        let mut rest = choice * total;
        let mut index = 0;
        while index + 1 < weights.len() && rest >= weights[index] {
            rest -= weights[index];
            index += 1;
        }
        let share = weights[index] / total;
        let Some(source) = self.sources.get(index) else {
            let sky = self.sky.as_ref()?;
            let direction = sky.sample(u)?;
            let pdf = share * sky.pdf(direction);
            let radiance = scene.background_radiance(direction);
            return Some(LightSample::of_sky(direction, radiance, pdf));
        };
        let (target, radiance) = match &source.shape {
            SourceShape::Solid(solid, radiance) => (solid.sample(from, part, u)?, *radiance),
            SourceShape::Triangles(triangles) => {
                let (target, triangle) = triangles.sample(from, part, u)?;
                (target, emission_of(scene, source.object, triangle))
            }
        };
        let pdf = share * target.pdf;
        Some(LightSample::of_place(target.reach, Some(target.normal), radiance, pdf))
    }

    /// Density with which [`Emission::sample`] finds from `from` what a ray along the unit
    /// `direction` meets: a surface of that emission, where the weights added up to `total`.
    pub(super) fn pdf(
        &self,
        (from, normal, object, total): (Vec3, Vec3, u32, f32),
        direction: Vec3,
        (hit, surface, emission): (Hit, &Surface, Rgb),
    ) -> f32 {
        let source = self.source_of.get(hit.id.object as usize).copied().flatten();
        let Some(source) = source.map(|id| &self.sources[id as usize]) else { return 0.0 };
        let weight = source.weight(from, normal, object);
        if !(weight > 0.0 && total > 0.0) {
            return 0.0;
        }
        let t = (surface.point - from).length();
        let of_source = match &source.shape {
            SourceShape::Solid(solid, _) => {
                solid.pdf(from, direction, t, hit.id.primitive, surface.normal)
            }
            SourceShape::Triangles(triangles) => {
                triangles.pdf(luminance(emission), direction, t, surface.normal)
            }
        };
        weight / total * of_source
    }

    /// The same for the sky.
    pub(super) fn sky_pdf(&self, total: f32, direction: Vec3) -> f32 {
        let Some(sky) = self.sky.as_ref().filter(|_| total > 0.0) else { return 0.0 };
        sky_weight(sky) / total * sky.pdf(direction)
    }
}

impl Source {
    /// About the irradiance that it brings; 0 only where it brings nothing, or is not looked for.
    fn weight(&self, from: Vec3, normal: Vec3, object: u32) -> f32 {
        // A solid is convex: from outside it does not see itself, and from within it is not looked
        // for. On its surface rounding could not tell which.
        if object == self.object && matches!(self.shape, SourceShape::Solid(..)) {
            return 0.0;
        }
        let way = self.center - from;
        let (distance, radius) = (way.length(), self.radius);
        let cos = if distance > radius {
            ((normal.dot(way) + radius) / distance).clamp(0.0, 1.0)
        } else {
            let is_inside = match &self.shape {
                SourceShape::Solid(solid, _) => solid.contains(from),
                SourceShape::Triangles(_) => false,
            };
            f32::from(!is_inside)
        };
        let near = distance.max(0.1 * radius);
        cos * (self.strength / (near * near)).min(std::f32::consts::PI * self.peak)
    }
}

/// Half of it, about, is below the horizon or comes in at an angle.
fn sky_weight(sky: &Sky) -> f32 {
    0.5 * sky.strength()
}

fn emission_of(scene: &Scene, object: u32, triangle: u32) -> Rgb {
    let object = &scene.objects[object as usize];
    let slot = match object.instance.shape() {
        Shape::Mesh(mesh) => mesh.mesh.slots.get(triangle as usize).copied().unwrap_or(0),
        Shape::Sphere { .. }
        | Shape::Plane { .. }
        | Shape::Box { .. }
        | Shape::Cone { .. }
        | Shape::Cylinder { .. } => 0,
    };
    scene.materials[object.material(slot) as usize].emission
}

/// An object as a source, if it glows and can be looked for.
fn source(scene: &Scene, id: u32) -> Option<Source> {
    let object = &scene.objects[id as usize];
    let glow = |slot: u32| scene.materials[object.material(slot) as usize].emission;
    let peak = object
        .materials
        .iter()
        .map(|id| luminance(scene.materials[*id as usize].emission))
        .fold(0.0, f32::max);
    if !(peak > 0.0 && peak.is_finite()) {
        return None;
    }
    let bounds = object.instance.bounds()?;
    let (shape, power) = match object.instance.shape() {
        Shape::Mesh(mesh) => {
            let luminance = |slot: u32| luminance(glow(slot));
            let triangles = Triangles::new(&object.instance, &mesh.mesh, luminance)?;
            let power = triangles.total();
            (SourceShape::Triangles(triangles), power)
        }
        Shape::Sphere { .. }
        | Shape::Plane { .. }
        | Shape::Box { .. }
        | Shape::Cone { .. }
        | Shape::Cylinder { .. } => {
            let solid = Solid::new(&object.instance)?;
            let power = solid.area() * f64::from(peak);
            (SourceShape::Solid(solid, glow(0)), power)
        }
    };
    let center = bounds.center();
    // Grown a little, so that rounding leaves nothing of it outside.
    let radius = 0.5 * bounds.extent().length() * 1.001;
    let strength = (0.25 * power) as f32;
    let is_usable = strength > 0.0 && strength.is_finite() && radius > 0.0;
    is_usable.then_some(Source { object: id, shape, center, radius, strength, peak })
}

//! How a path goes on: mirrored, through glass, scattered.

use glam::Vec3;

use super::{Path, ROULETTE_DEPTH, Scattered, TileRenderer, dimension};
use crate::brdf::{Glossy, fresnel};
use crate::color::{Rgb, luminance};
use crate::math::Ray;
use crate::render::shading::Shading;
use crate::scene::Material;
use crate::scene::description::IntegratorKind;

impl TileRenderer<'_> {
    /// Chooses one way to go on, in proportion to what each reflects.
    pub(super) fn go_on(&mut self, path: Path, shading: &Shading<'_>) {
        let material = shading.material;
        let scatters = self.world.job.settings.integrator == IntegratorKind::Path;
        let weights = ways(material, &shading.glossy, scatters);
        let total: f32 = weights.iter().sum();
        if total <= 0.0 {
            return;
        }
        let scattering = weights[2] / total;
        let emitters =
            if scattering > 0.0 { self.sample_emitters(path, shading, scattering) } else { 0.0 };
        let [choice, roulette] = path.numbers.pair(dimension::of(path.depth, dimension::CHOICE));
        let choice = choice * total;
        let step = if choice < weights[0] {
            self.mirror(shading, shading.wo).map(|wi| (wi, material.reflection, None, weights[0]))
        } else if choice < weights[0] + weights[1] || weights[2] == 0.0 {
            let within = ((choice - weights[0]) / weights[1]).clamp(0.0, 1.0);
            self.through_glass(shading, within)
                .map(|wi| (wi, material.transmission, None, weights[1]))
        } else {
            self.scatter(path, shading).map(|(wi, value, pdf)| {
                let (from, normal) = (shading.surface.point, shading.frame.z);
                let (object, pdf) = (shading.object, scattering * pdf);
                let last = Scattered { from, normal, object, pdf, total: emitters };
                (wi, value, Some(last), weights[2])
            })
        };
        let Some((direction, value, scattered, weight)) = step else { return };
        let mut throughput = path.throughput * value * (total / weight);
        let depth = path.depth + 1;
        if depth >= ROULETTE_DEPTH {
            let survival = throughput.max_element().min(1.0);
            if roulette >= survival {
                return;
            }
            throughput /= survival;
        }
        if throughput == Rgb::ZERO {
            return;
        }
        let mut ray = Ray::new(shading.surface.leave(direction), direction);
        ray.source = shading.surface.source;
        self.next_rays.push(ray);
        self.next_paths.push(Path { throughput, depth, scattered, ..path });
    }

    /// The mirrored direction, if it is above the geometric surface.
    fn mirror(&self, shading: &Shading<'_>, wo: Vec3) -> Option<Vec3> {
        let wi = fresnel::reflect(wo, shading.frame.z).normalize();
        (shading.normal.dot(wi) > 0.0).then_some(wi)
    }

    /// Mirrored or refracted, by Fresnel; `choice` in 0..=1.
    fn through_glass(&self, shading: &Shading<'_>, choice: f32) -> Option<Vec3> {
        let normal = shading.frame.z;
        let ior = shading.material.ior;
        let eta = if shading.is_outside { ior } else { 1.0 / ior };
        if choice < fresnel::dielectric(shading.wo.dot(normal), eta) {
            return self.mirror(shading, shading.wo);
        }
        let wi = fresnel::refract(shading.wo, normal, eta)?;
        (shading.normal.dot(wi) < 0.0).then_some(wi)
    }

    /// A scattered direction, the BRDF times the cosine over its density, and that density.
    fn scatter(&self, path: Path, shading: &Shading<'_>) -> Option<(Vec3, Rgb, f32)> {
        let wo = shading.frame.local_from_world(shading.wo);
        let u = self.first_net(path, dimension::SCATTER);
        let wi = shading.glossy.sample(wo, u)?;
        let direction = shading.frame.world_from_local(wi).normalize();
        let pdf = shading.glossy.pdf(wo, wi);
        let is_valid = shading.normal.dot(direction) > 0.0 && pdf > 0.0;
        is_valid.then(|| (direction, shading.glossy.eval(wo, wi) * (wi.z / pdf), pdf))
    }
}

/// How much is mirrored, goes through glass, is scattered: what one of them is chosen by.
fn ways(material: &Material, glossy: &Glossy, scatters: bool) -> [f32; 3] {
    let scattered = luminance(glossy.diffuse) + luminance(glossy.specular);
    [
        luminance(material.reflection),
        luminance(material.transmission),
        if scatters { scattered } else { 0.0 },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::{Ward, WardForm};
    use crate::scene::material::ColorSource;

    /// The choice moves no mean, only noise: it is by luminance.
    #[test]
    fn ways_are_chosen_by_luminance() {
        let lobe = Ward { form: WardForm::Bounded, alpha_x: 0.1, alpha_y: 0.1 };
        let glossy = Glossy { diffuse: Rgb::X, specular: Rgb::new(0.0, 0.5, 0.0), lobe };
        let material = Material {
            diffuse: ColorSource::constant(Rgb::ONE),
            specular: Rgb::ONE,
            lobe,
            tangent: Vec3::X,
            reflection: Rgb::new(0.0, 0.0, 0.5),
            transmission: Rgb::new(0.0, 0.5, 1.0),
            ior: 1.5,
            emission: Rgb::ZERO,
            bump: None,
        };
        for (scatters, scattered) in [(true, 0.2126 + 0.3576), (false, 0.0)] {
            let found = ways(&material, &glossy, scatters);
            for (found, expected) in found.into_iter().zip([0.0361, 0.3576 + 0.0722, scattered]) {
                assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
            }
        }
    }
}

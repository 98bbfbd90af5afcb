//! Light that arrives by a shadow ray: of `[[lights]]`, and in "path" of whatever else glows.

use glam::Vec3;

use super::{Path, TileRenderer, dimension, power};
use crate::brdf::{Glossy, Ward};
use crate::color::{Rgb, luminance};
use crate::math::Ray;
use crate::render::shading::Shading;
use crate::scene::light::{Light, LightEstimate, LightSample};

/// Shadow rays to `[[lights]]` at a surface, at most, where the lobe is not sampled as well.
pub(super) const LIGHTS_AT_ONCE: usize = 8;

/// Which lights get a shadow ray at a surface, with the memory of the choice.
#[derive(Default)]
pub(super) struct LightChoice {
    /// With which chance each light gets one.
    chances: Vec<f32>,
    chosen: Vec<u32>,
}

impl LightChoice {
    /// All lights.
    fn take_all(&mut self, n: usize) {
        self.chances.clear();
        self.chances.resize(n, 1.0);
        self.chosen.clear();
        self.chosen.extend(0..n as u32);
    }

    /// `n` of the lights, in proportion to the weights in `chances`, but none with a chance above 1:
    /// systematic sampling by one number in [0, 1). What has a weight above 0 has a chance above 0.
    fn take(&mut self, n: usize, u: f32) {
        // What would be chosen with a chance of 1 or more is set apart, until nothing would.
        let (mut limit, mut n_apart) = (f32::INFINITY, 0);
        loop {
            let open = self.chances.iter().filter(|w| **w < limit);
            let next = open.sum::<f32>() / n.saturating_sub(n_apart).max(1) as f32;
            // Never up again, also where the sum is rounded: so the number apart only grows, and the
            // loop ends.
            limit = next.min(limit);
            let now_apart = self.chances.iter().filter(|w| **w >= limit && **w > 0.0).count();
            if now_apart == n_apart || now_apart >= n {
                break;
            }
            n_apart = now_apart;
        }
        self.chosen.clear();
        let mut level = u;
        for (index, chance) in self.chances.iter_mut().enumerate() {
            *chance = match *chance {
                w if w <= 0.0 => 0.0,
                w if w >= limit => 1.0,
                w => w / limit,
            };
            level += *chance;
            if level >= 1.0 {
                level -= 1.0;
                self.chosen.push(index as u32);
            }
        }
    }
}

impl TileRenderer<'_> {
    /// Direct light of `[[lights]]`: a point of each chosen light, and a direction of the glossy
    /// lobe. Where both can find the light, each counts by its share.
    pub(super) fn sample_lights(&mut self, path: Path, shading: &Shading<'_>) {
        let lights = &self.world.job.scene.lights;
        let wo = shading.frame.local_from_world(shading.wo);
        let glossy = &shading.glossy;
        let is_glossy = glossy.specular != Rgb::ZERO && wo.z > 0.0;
        self.choose_lights(path, shading, wo);
        for index in &self.lights.chosen {
            let chance = self.lights.chances[*index as usize];
            let u = self.first_net(path, dimension::FIRST_LIGHT + index);
            let light = &lights[*index as usize];
            let Some(sample) = light.sample(shading.surface.point, u) else { continue };
            if !shading.is_above(sample.direction) {
                continue;
            }
            let wi = shading.frame.local_from_world(sample.direction);
            let mut value = glossy.diffuse / std::f32::consts::PI;
            if is_glossy {
                let lobe = &glossy.lobe;
                let share = sample.pdf.map_or(1.0, |pdf| power(chance * pdf, lobe.pdf(wo, wi)));
                value += glossy.specular * (lobe.eval(wo, wi) * share);
            }
            let contribution = path.throughput * value * sample.weight * (wi.z / chance);
            self.shadows.push(path.slot, shading, &sample, contribution);
        }
        if is_glossy {
            self.probe_lights(path, shading, wo);
        }
    }

    /// All lights where they are few; else some, by what each may bring.
    fn choose_lights(&mut self, path: Path, shading: &Shading<'_>, wo: Vec3) {
        let lights = &self.world.job.scene.lights;
        if lights.len() <= LIGHTS_AT_ONCE {
            return self.lights.take_all(lights.len());
        }
        let weights = lights.iter().map(|light| weight(light, shading, wo));
        self.lights.chances.clear();
        self.lights.chances.extend(weights);
        let [u, _] = path.numbers.pair(dimension::of(path.depth, dimension::LIGHT_CHOICE));
        self.lights.take(LIGHTS_AT_ONCE, u);
    }

    /// The glossy lobe's own direction, for the lights that it happens to meet: none hides another.
    fn probe_lights(&mut self, path: Path, shading: &Shading<'_>, wo: Vec3) {
        let lights = &self.world.job.scene.lights;
        let lobe = &shading.glossy.lobe;
        let u = self.first_net(path, dimension::PROBE);
        let Some(wi) = lobe.sample(wo, u) else { return };
        let direction = shading.frame.world_from_local(wi);
        let pdf = lobe.pdf(wo, wi);
        if !(shading.is_above(direction) && pdf > 0.0) {
            return;
        }
        let from = shading.surface.point;
        let ray = Ray::new(from, direction);
        for (light, chance) in lights.iter().zip(&self.lights.chances) {
            let Some((t, radiance)) = light.intersect(&ray) else { continue };
            let share = power(pdf, chance * light.pdf(from, direction, t));
            let value = shading.glossy.specular * (lobe.eval(wo, wi) * wi.z * share / pdf);
            let sample = LightSample {
                direction,
                reach: if t.is_finite() { direction * t } else { direction },
                t_max: if t.is_finite() { 1.0 } else { f32::INFINITY },
                normal: light.normal_at(from + direction * t),
                weight: radiance,
                pdf: Some(pdf),
            };
            self.shadows.push(path.slot, shading, &sample, path.throughput * value * radiance);
        }
    }

    /// Light of the next event that a scattered ray would meet: a way to something that glows, or to
    /// the sky, weighted against the scattered ray, which is sent with the chance `scattering`.
    /// Visible lights and glass stop it. Returns the sum of the weights of all emitters.
    pub(super) fn sample_emitters(
        &mut self,
        path: Path,
        shading: &Shading<'_>,
        scattering: f32,
    ) -> f32 {
        let world = self.world;
        if world.emission.is_empty() {
            return 0.0;
        }
        let (from, normal) = (shading.surface.point, shading.frame.z);
        let object = shading.object;
        let total = world.emission.weigh(from, normal, object, &mut self.emitter_weights);
        if !(total > 0.0 && total.is_finite()) {
            return 0.0;
        }
        let choice = path.numbers.pair(dimension::of(path.depth, dimension::EMITTER_CHOICE));
        let u = self.first_net(path, dimension::EMITTER);
        let weights = (&*self.emitter_weights, total);
        let sample = world.emission.sample(&world.job.scene, from, weights, choice, u);
        let Some((sample, pdf)) = sample.and_then(|sample| Some((sample, sample.pdf?))) else {
            return total;
        };
        if !(shading.is_above(sample.direction) && pdf > 0.0) {
            return total;
        }
        let wo = shading.frame.local_from_world(shading.wo);
        let wi = shading.frame.local_from_world(sample.direction);
        let share = power(pdf, scattering * shading.glossy.pdf(wo, wi));
        let value = shading.glossy.eval(wo, wi) * (wi.z * share);
        let ray = Ray { t_max: sample.t_max, ..Ray::new(from, sample.reach) };
        if self.visible_light(&ray, sample.t_max).is_none() {
            self.shadows.push(path.slot, shading, &sample, path.throughput * value * sample.weight);
        }
        total
    }
}

/// About what a light brings to the eye by way of a surface; 0 only where that is nothing.
fn weight(light: &Light, shading: &Shading<'_>, wo: Vec3) -> f32 {
    let Some(estimate) = light.estimate(shading.surface.point) else { return 0.0 };
    let wi = shading.frame.local_from_world(estimate.direction);
    reflected(&estimate, &shading.glossy, wo, wi)
}

/// About what goes to `wo` of a light around `wi`, in the shading frame.
fn reflected(light: &LightEstimate, glossy: &Glossy, wo: Vec3, wi: Vec3) -> f32 {
    // The best cosine of any part of it.
    let cos = (wi.z + light.half_width).clamp(0.0, 1.0);
    let specular = luminance(glossy.specular);
    let mut value = (luminance(glossy.diffuse) + 0.01 * specular) / std::f32::consts::PI;
    if specular > 0.0 && wo.z > 0.0 && cos > 0.0 {
        // The lobe as wide as half the angle of the light makes it.
        let lobe = glossy.lobe;
        let widened =
            |alpha: f32| (alpha * alpha + 0.25 * light.half_width * light.half_width).sqrt();
        let (alpha_x, alpha_y) = (widened(lobe.alpha_x), widened(lobe.alpha_y));
        let wide = Ward { alpha_x, alpha_y, ..lobe };
        value += specular * wide.eval(wo, Vec3::new(wi.x, wi.y, wi.z.max(cos)).normalize());
    }
    let weight = light.irradiance * cos * value;
    // Beside a light the estimate has no bound.
    const MOST: f32 = 1e30;
    if weight < MOST { weight } else { MOST }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::WardForm;

    /// The balance of both ways is by the squares of their densities, whatever these are.
    #[test]
    fn the_power_heuristic_is_that_of_squares() {
        for (this, other, expected) in
            [(1.0, 2.0, 0.2), (3.0, 4.0, 0.36), (4e-30, 3e-30, 0.64), (1e30, 1e30, 0.5)]
        {
            let found = power(this, other);
            assert!((found - expected).abs() < 1e-6, "{found} of {this} and {other}");
            assert!((power(other, this) + found - 1.0).abs() < 1e-6, "{this} and {other}");
        }
        assert_eq!([power(f32::INFINITY, 2.0), power(0.0, 2.0), power(2.0, 0.0)], [1.0, 0.0, 1.0]);
    }

    /// What lights are chosen by moves no mean, only noise: held against its own formula, in double
    /// precision. Irradiance, times the best cosine of the light, times the diffuse part, a trace of
    /// the gloss, and the lobe that half the angle of the light has widened.
    #[test]
    fn lights_are_chosen_by_what_goes_to_the_eye() {
        let lobe = Ward { form: WardForm::Bounded, alpha_x: 0.2, alpha_y: 0.3 };
        let wo = Vec3::new(-0.36, -0.48, 0.8);
        for (wi, half_width) in [
            (Vec3::new(0.48, 0.36, 0.8), 0.1_f32),
            (Vec3::new(0.48, 0.36, 0.8), 0.0),
            (Vec3::new(0.6, 0.64, 0.48), 0.4),
            // Beside the lobe, where the diffuse part and the trace are all there is.
            (Vec3::new(-0.96, -0.28, 0.0), 0.1),
        ] {
            for (diffuse, specular) in [(0.5, 0.0), (0.004, 0.4), (0.1, 0.2)] {
                let [diffuse, specular] = [diffuse, specular].map(Rgb::splat);
                let glossy = Glossy { diffuse, specular, lobe };
                let light = LightEstimate { direction: wi, half_width, irradiance: 7.0 };
                let found = f64::from(reflected(&light, &glossy, wo, wi));
                let width = f64::from(half_width);
                let cos = (f64::from(wi.z) + width).min(1.0);
                let [x, y] = [0.2_f64, 0.3].map(|alpha| alpha * alpha + 0.25 * width * width);
                let raised = Vec3::new(wi.x, wi.y, cos as f32).as_dvec3().normalize();
                let h = wo.as_dvec3() + raised;
                let gloss = (-(h.x * h.x / x + h.y * h.y / y) / (h.z * h.z)).exp() * h.dot(h)
                    / (std::f64::consts::PI * (x * y).sqrt() * h.z.powi(4));
                let [d, s] = [diffuse.x, specular.x].map(f64::from);
                let expected = 7.0 * cos * ((d + 0.01 * s) / std::f64::consts::PI + s * gloss);
                let what = format!("{wi}, {half_width} wide, {d} and {s}");
                assert!((found / expected - 1.0).abs() < 1e-4, "{found}, not {expected}: {what}");
            }
        }
        let below = LightEstimate { direction: -Vec3::Z, half_width: 0.5, irradiance: 7.0 };
        let glossy = Glossy { diffuse: Rgb::ONE, specular: Rgb::ONE, lobe };
        assert_eq!(reflected(&below, &glossy, wo, -Vec3::Z), 0.0, "from below");
        let near = LightEstimate { direction: wo, half_width: 0.5, irradiance: f32::INFINITY };
        assert_eq!(reflected(&near, &glossy, wo, wo), 1e30, "beside a light");
    }

    /// Sums of these are rounded so that the limit would go up and down for ever.
    #[test]
    fn rounding_does_not_keep_a_choice_from_ending() {
        let weights = [
            0.118297495,
            0.49895427,
            0.27127132,
            0.7150659,
            0.3227838,
            0.00016661732,
            0.4750736,
            0.1633326,
            0.07970098,
            0.3268443,
            0.27086318,
            0.017413866,
            0.2398373,
            0.06975538,
            0.13943109,
            0.5855167,
        ];
        let mut choice = LightChoice { chances: weights.to_vec(), chosen: Vec::new() };
        choice.take(8, 0.5);
        assert_eq!(choice.chosen.len(), 8, "{:?}", choice.chosen);
    }

    /// Over all numbers every light is chosen as often as its chance says; chances are in proportion
    /// to the weights, or 1, and no light with weight is left out.
    #[test]
    fn lights_are_chosen_as_often_as_their_chance_says() {
        let cases: [&[f32]; 7] = [
            &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0],
            &[0.1, 100.0, 0.2, 90.0, 0.3, 0.0, 0.7],
            &[0.1, 0.7, 0.3],
            &[0.0, 0.1, 0.0, 0.7, 0.0, 0.3, 0.0],
            &[1e-7, 0.3, 1e6, 0.2, 1e-10, 5.0],
            &[0.1; 9],
            &[0.0; 5],
        ];
        for weights in cases {
            for n in 1..=4 {
                let steps = 4000;
                let mut counts = vec![0_u32; weights.len()];
                let mut choice = LightChoice::default();
                for step in 0..steps {
                    choice.chances = weights.to_vec();
                    choice.take(n, (step as f32 + 0.5) / steps as f32);
                    choice.chosen.iter().for_each(|index| counts[*index as usize] += 1);
                    assert!(choice.chosen.len() <= n + 1, "{weights:?}: {:?}", choice.chosen);
                }
                let below = |i: &usize| choice.chances[*i] > 0.0 && choice.chances[*i] < 1.0;
                let ratios: Vec<f32> = (0..weights.len())
                    .filter(below)
                    .map(|i| choice.chances[i] / weights[i])
                    .collect();
                for (i, chance) in choice.chances.iter().enumerate() {
                    assert!((0.0..=1.0).contains(chance), "{weights:?}: chance {chance}");
                    assert_eq!(*chance > 0.0, weights[i] > 0.0, "{weights:?}: chance {chance}");
                    let share = f64::from(counts[i]) / f64::from(steps);
                    assert!((share - f64::from(*chance)).abs() < 1e-3, "{weights:?}: {share}");
                }
                let even = ratios.iter().all(|ratio| (ratio / ratios[0] - 1.0).abs() < 1e-4);
                assert!(even, "{weights:?}: ratios {ratios:?}");
            }
        }
    }
}

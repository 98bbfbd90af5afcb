//! Direct light of a block of points, in lanes; the formulas are those of a single point.

use super::direct_light::LIGHTS_AT_ONCE;
use super::{Block, TileRenderer, dimension, power};
use crate::brdf::{Ward, WardForm};
use crate::color::Rgb;
use crate::math::RayBlock;
use crate::math::vectorized::{BLOCK, Lane, Lane3, set_vec3, vec3, vectorized};
use crate::render::shading::{Coat, ShadingBlock};
use crate::scene::light::LightBlock;

impl TileRenderer<'_> {
    /// [`TileRenderer::sample_lights`] for the points of a block.
    pub(super) fn light_block(&mut self, coat: &Coat<'_>, block: &Block) {
        let world = self.world;
        let lights = &world.job.scene.lights;
        let material = coat.material;
        if lights.len() > LIGHTS_AT_ONCE {
            for i in 0..block.n {
                let path = self.paths[block.places[i] as usize];
                self.sample_lights(path, &block.shading.shading(coat, i));
            }
            return;
        }
        let depth = block.depth;
        let gloss = (material.specular != Rgb::ZERO).then_some((material.specular, material.lobe));
        let mut u = [[0.0; BLOCK]; 2];
        for (index, light) in lights.iter().enumerate() {
            let purpose = dimension::FIRST_LIGHT + index as u32;
            block.numbers.pairs(dimension::of(depth, purpose), self.joint_net(depth), &mut u);
            light.sample_block(&block.shading.surface.point, &u, &mut self.samples);
            let mut contributions = block.throughput;
            contribute(&block.shading, &self.samples, gloss, &mut contributions);
            let slots = &block.slots;
            self.shadows.append(block.n, slots, &block.shading, &self.samples, &contributions);
        }
        if let Some(gloss) = gloss {
            block.numbers.pairs(
                dimension::of(depth, dimension::PROBE),
                self.joint_net(depth),
                &mut u,
            );
            self.probe_block(gloss, block, &u);
        }
    }

    /// [`TileRenderer::probe_lights`] for the points of a block, all lights having been sampled.
    fn probe_block(&mut self, gloss: (Rgb, Ward), block: &Block, u: &[Lane<f32>; 2]) {
        let mut probes = Probes { rays: RayBlock::IDLE, pdf: [0.0; BLOCK], value: [0.0; BLOCK] };
        probe(&block.shading, gloss.1, u, &mut probes);
        let mut t = [f32::NAN; BLOCK];
        for light in self.world.job.scene.lights.iter().filter(|light| light.has_extent()) {
            light.intersect_block(&probes.rays, &mut t);
            let is_met = (0..block.n).any(|i| t[i] > 0.0 && probes.pdf[i] > 0.0);
            if !is_met {
                continue;
            }
            let samples = &mut self.samples;
            light.pdf_block(&probes.rays, &t, &mut samples.pdf, &mut samples.normal);
            let mut contributions = block.throughput;
            weigh_probes(&probes, &t, gloss.0, light.radiance(), samples, &mut contributions);
            let slots = &block.slots;
            self.shadows.append(block.n, slots, &block.shading, &self.samples, &contributions);
        }
    }
}

/// Directions of the glossy lobe, one for each point of a block.
struct Probes {
    /// From the points.
    rays: RayBlock,
    /// Density of the direction; 0 where there is none.
    pdf: Lane<f32>,
    /// The lobe times the cosine.
    value: Lane<f32>,
}

#[inline(always)]
fn each_probe(block: &ShadingBlock, lobe: Ward, [u, v]: &[Lane<f32>; 2], probes: &mut Probes) {
    for i in 0..BLOCK {
        let frame = block.frame(i);
        let wo = frame.local_from_world(vec3(&block.wo, i));
        let (wi, is_sampled) = lobe.mirrored(wo, [u[i], v[i]]);
        let direction = frame.world_from_local(wi);
        let is_above = vec3(&block.normal, i).dot(direction) > 0.0 && frame.z.dot(direction) > 0.0;
        let pdf = lobe.pdf(wo, wi);
        probes.pdf[i] = if wo.z > 0.0 && is_sampled && is_above { pdf } else { 0.0 };
        probes.value[i] = lobe.eval(wo, wi) * wi.z;
        set_vec3(&mut probes.rays.origin, i, vec3(&block.surface.point, i));
        set_vec3(&mut probes.rays.direction, i, direction);
    }
}

vectorized! {
    fn probe(block: &ShadingBlock, lobe: Ward, u: &[Lane<f32>; 2], probes: &mut Probes) {
        // The form is spelled out so that it is known within the loop.
        match lobe.form {
            WardForm::Original => {
                each_probe(block, Ward { form: WardForm::Original, ..lobe }, u, probes);
            }
            WardForm::Duer => each_probe(block, Ward { form: WardForm::Duer, ..lobe }, u, probes),
            WardForm::Bounded => {
                each_probe(block, Ward { form: WardForm::Bounded, ..lobe }, u, probes);
            }
        }
    }
    /// Makes ways of the probes that meet a light at `t`, and multiplies what they bring with what is
    /// there; nothing where they do not meet it.
    fn weigh_probes(
        probes: &Probes,
        t: &Lane<f32>,
        specular: Rgb,
        radiance: Rgb,
        samples: &mut LightBlock,
        throughput: &mut Lane3,
    ) {
        samples.t_max = 1.0;
        for i in 0..BLOCK {
            let direction = vec3(&probes.rays.direction, i);
            let share = power(probes.pdf[i], samples.pdf[i]);
            let value = specular * (probes.value[i] * share / probes.pdf[i]);
            let light = vec3(throughput, i) * value * radiance;
            let is_met = t[i] > 0.0 && probes.pdf[i] > 0.0;
            set_vec3(throughput, i, if is_met { light } else { Rgb::ZERO });
            let is_far = t[i] == f32::INFINITY;
            set_vec3(&mut samples.direction, i, direction);
            set_vec3(&mut samples.reach, i, if is_far { direction } else { direction * t[i] });
        }
        if t.contains(&f32::INFINITY) {
            samples.t_max = f32::INFINITY;
        }
    }
}

/// What a light brings to the eye from each point of a block if nothing is in its way: to be
/// multiplied with what is there.
#[inline(always)]
fn each_contribution<const IS_GLOSSY: bool>(
    block: &ShadingBlock,
    samples: &LightBlock,
    (specular, lobe): (Rgb, Ward),
    throughput: &mut Lane3,
) {
    for i in 0..BLOCK {
        let direction = vec3(&samples.direction, i);
        let frame = block.frame(i);
        let wi = frame.local_from_world(direction);
        let mut value = vec3(&block.diffuse, i) / std::f32::consts::PI;
        if IS_GLOSSY {
            let wo = frame.local_from_world(vec3(&block.wo, i));
            let pdf = samples.pdf[i];
            let share = power(pdf, lobe.pdf(wo, wi));
            let gloss = specular * (lobe.eval(wo, wi) * share);
            value += if wo.z > 0.0 { gloss } else { Rgb::ZERO };
        }
        let is_above = vec3(&block.normal, i).dot(direction) > 0.0 && frame.z.dot(direction) > 0.0;
        let light = vec3(throughput, i) * value * vec3(&samples.weight, i) * wi.z;
        set_vec3(throughput, i, if is_above { light } else { Rgb::ZERO });
    }
}

vectorized! {
    fn contribute(
        block: &ShadingBlock,
        samples: &LightBlock,
        gloss: Option<(Rgb, Ward)>,
        throughput: &mut Lane3,
    ) {
        let Some((specular, lobe)) = gloss else {
            let nothing = Ward { form: WardForm::Bounded, alpha_x: 1.0, alpha_y: 1.0 };
            return each_contribution::<false>(block, samples, (Rgb::ZERO, nothing), throughput);
        };
        // The form is spelled out so that it is known within the loop.
        let of_form = |form: WardForm| (specular, Ward { form, ..lobe });
        match lobe.form {
            WardForm::Original => {
                let gloss = of_form(WardForm::Original);
                each_contribution::<true>(block, samples, gloss, throughput);
            }
            WardForm::Duer => {
                let gloss = of_form(WardForm::Duer);
                each_contribution::<true>(block, samples, gloss, throughput);
            }
            WardForm::Bounded => {
                let gloss = of_form(WardForm::Bounded);
                each_contribution::<true>(block, samples, gloss, throughput);
            }
        }
    }
}

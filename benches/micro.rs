//! What the smallest pieces cost: one evaluation of a BRDF, of noise, of a tone operator.
//!
//! ```text
//! cargo bench --bench micro [-- FILTER]
//! ```

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use penumbra::brdf::{Ward, WardForm, fresnel};
use penumbra::math::noise::{Octaves, perlin};
use penumbra::math::sampler::{Net, Sampler};
use penumbra::scene::description::ToneOperator;
use penumbra::tone_mapping::map_to_srgb8;

/// Arguments that differ from call to call.
const N: usize = 1024;

fn unit(i: usize) -> Vec3 {
    let [x, y] = Sampler::Random { seed: 1 }.numbers(i as u32, 0, 0).pair(0);
    Vec3::new(x - 0.5, y - 0.5, 0.6).normalize()
}

fn brdf(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("brdf");
    group.throughput(Throughput::Elements(N as u64));
    let directions: Vec<Vec3> = (0..=N).map(unit).collect();
    for form in [WardForm::Original, WardForm::Duer, WardForm::Bounded] {
        let ward = Ward { form, alpha_x: 0.1, alpha_y: 0.3 };
        group.bench_function(format!("ward {form:?} eval"), |bencher| {
            let eval = |i: usize| ward.eval(directions[i], directions[i + 1]);
            bencher.iter(|| (0..N).map(|i| eval(black_box(i))).sum::<f32>());
        });
        group.bench_function(format!("ward {form:?} sample and pdf"), |bencher| {
            let sample = |i: usize| {
                let wo = directions[i];
                ward.sample(wo, [directions[i + 1].x.abs(), 0.3]).map_or(0.0, |wi| ward.pdf(wo, wi))
            };
            bencher.iter(|| (0..N).map(|i| sample(black_box(i))).sum::<f32>());
        });
    }
    group.bench_function("fresnel", |bencher| {
        let eval = |i: usize| fresnel::dielectric(directions[i].z, 1.5);
        bencher.iter(|| (0..N).map(|i| eval(black_box(i))).sum::<f32>());
    });
}

fn noise(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("noise");
    group.throughput(Throughput::Elements(N as u64));
    let point = |i: usize| 40.0 * unit(i).as_dvec3() + DVec3::splat(i as f64 * 0.01);
    let points: Vec<DVec3> = (0..N).map(point).collect();
    group.bench_function("perlin", |bencher| {
        bencher.iter(|| points.iter().map(|p| perlin(black_box(*p))).sum::<f64>());
    });
    let octaves = Octaves { count: 6, lacunarity: 2.0, gain: 0.5 };
    group.bench_function("turbulence of 6 octaves", |bencher| {
        bencher.iter(|| points.iter().map(|p| octaves.turbulence(black_box(*p))).sum::<f64>());
    });
}

fn numbers(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("numbers");
    group.throughput(Throughput::Elements(N as u64));
    for (name, sampler) in
        [("sobol", Sampler::Sobol { seed: 1 }), ("random", Sampler::Random { seed: 1 })]
    {
        group.bench_function(format!("{name} pair of a net"), |bencher| {
            let pair = |i: usize| {
                sampler.numbers(i as u32 % 64, 7, i as u32).joint_pair(1, Net::Second)[0]
            };
            bencher.iter(|| (0..N).map(|i| pair(black_box(i))).sum::<f32>());
        });
    }
}

fn tone_mapping(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tone mapping");
    let pixels: Vec<[f32; 3]> = (0..64 * N).map(|i| (unit(i) + 0.4).to_array()).collect();
    let mut out = vec![[0; 3]; pixels.len()];
    group.throughput(Throughput::Elements(pixels.len() as u64));
    for operator in
        [ToneOperator::Linear, ToneOperator::Reinhard, ToneOperator::Aces, ToneOperator::Agx]
    {
        group.bench_function(format!("{operator:?}"), |bencher| {
            bencher.iter(|| map_to_srgb8(black_box(&pixels), 0.5, operator, &mut out));
        });
    }
}

criterion_group!(benches, brdf, noise, numbers, tone_mapping);
criterion_main!(benches);

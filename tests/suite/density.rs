//! Every way of sampling against the density that it claims, by chi-square tests.
//!
//! What is rejected is a cell of its own: Ward's density integrates to less than 1.

mod lights;

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec2, Vec3};
use penumbra::brdf::{Glossy, Ward, WardForm};
use penumbra::color::Rgb;
use penumbra::math::{Frame, Ray, warp};
use penumbra::scene::light::{Emitter, Light};

use crate::common::Numbers;

const FORMS: [WardForm; 3] = [WardForm::Original, WardForm::Duer, WardForm::Bounded];

/// Fails where counts stray from the expected shares by more than five standard deviations of the
/// chi-square statistic. Cells of fewer than ten expected samples are pooled.
#[track_caller]
fn assert_distributed(counts: &[u32], shares: &[f64], what: &str) {
    let n: f64 = counts.iter().map(|c| f64::from(*c)).sum();
    let total: f64 = shares.iter().sum();
    assert!((total - 1.0).abs() < 1e-6, "{what}: shares add up to {total}");
    let (mut chi2, mut n_cells) = (0.0, 0.0);
    let (mut pooled, mut pooled_count) = (0.0, 0.0);
    for (count, share) in counts.iter().zip(shares) {
        let expected = share * n;
        if expected < 10.0 {
            pooled += expected;
            pooled_count += f64::from(*count);
            continue;
        }
        chi2 += (f64::from(*count) - expected).powi(2) / expected;
        n_cells += 1.0;
    }
    if pooled >= 10.0 {
        chi2 += (pooled_count - pooled).powi(2) / pooled;
        n_cells += 1.0;
    } else {
        assert!(pooled_count < pooled + 30.0, "{what}: {pooled_count} where {pooled} belong");
    }
    let freedom: f64 = n_cells - 1.0;
    assert!(freedom >= 3.0, "{what}: only {n_cells} cells");
    let limit = freedom + 5.0 * (2.0 * freedom).sqrt();
    assert!(chi2 < limit, "{what}: chi-square {chi2} of {freedom} degrees of freedom");
}

/// Chi-square of directions on the hemisphere, in cells of equal cosine and azimuth.
#[track_caller]
fn assert_hemisphere(
    sample: impl Fn([f32; 2]) -> Option<Vec3>,
    pdf: impl Fn(Vec3) -> f32,
    what: &str,
) {
    const N_COS: usize = 12;
    const N_PHI: usize = 24;
    const N_SUB: usize = 24;
    const N_SAMPLES: u32 = 60_000;
    let mut shares = vec![0.0; N_COS * N_PHI];
    let d_omega = TAU / (N_COS * N_PHI * N_SUB * N_SUB) as f64;
    for i in 0..N_COS * N_SUB {
        let cos = (i as f64 + 0.5) / (N_COS * N_SUB) as f64;
        let sin = (1.0 - cos * cos).sqrt();
        for j in 0..N_PHI * N_SUB {
            let phi = TAU * (j as f64 + 0.5) / (N_PHI * N_SUB) as f64;
            let wi = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3();
            shares[(i / N_SUB) * N_PHI + j / N_SUB] += f64::from(pdf(wi)) * d_omega;
        }
    }
    let mut counts = vec![0; N_COS * N_PHI + 1];
    let mut numbers = Numbers::new(11);
    for _ in 0..N_SAMPLES {
        let u = [numbers.next() as f32, numbers.next() as f32].map(|u| u.min(1.0 - f32::EPSILON));
        let cell = sample(u).map_or(N_COS * N_PHI, |wi| {
            assert!((wi.length() - 1.0).abs() < 1e-5 && wi.z > 0.0, "{what}: {wi}");
            let cos = ((wi.z * N_COS as f32) as usize).min(N_COS - 1);
            let turn = (f64::from(wi.y).atan2(f64::from(wi.x)) / TAU).rem_euclid(1.0);
            cos * N_PHI + ((turn * N_PHI as f64) as usize).min(N_PHI - 1)
        });
        counts[cell] += 1;
    }
    let accepted: f64 = shares.iter().sum();
    assert!(accepted < 1.0 + 1e-3, "{what}: the density integrates to {accepted}");
    shares.push((1.0 - accepted).max(0.0));
    let total: f64 = shares.iter().sum();
    shares.iter_mut().for_each(|s| *s /= total);
    assert_distributed(&counts, &shares, what);
}

fn viewer(theta_deg: f64, phi: f64) -> Vec3 {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3()
}

#[test]
fn ward_samples_have_their_density_in_every_form() {
    for form in FORMS {
        for (alpha_x, alpha_y) in [(0.3, 0.3), (0.2, 0.6), (1.2, 0.4)] {
            let lobe = Ward { form, alpha_x, alpha_y };
            for theta_deg in [0.0, 40.0, 75.0, 80.0, 88.0] {
                let wo = viewer(theta_deg, 0.6);
                let what = format!("{lobe:?} at {theta_deg} degrees");
                assert_hemisphere(|u| lobe.sample(wo, u), |wi| lobe.pdf(wo, wi), &what);
            }
        }
    }
}

/// Value times cosine over density: what a scattered ray is multiplied by. Bounded in each form by
/// what its formula leaves, and of small variance where Walter's form for all three would have a
/// standard deviation of 33.
#[test]
fn ward_samples_have_bounded_weights() {
    let mut numbers = Numbers::new(5);
    for form in FORMS {
        for (alpha_x, alpha_y) in [(0.1, 0.1), (0.2, 0.6), (1.0, 1.0), (3.0, 0.5)] {
            let lobe = Ward { form, alpha_x, alpha_y };
            for theta_deg in [0.0, 45.0, 80.0, 88.0] {
                let wo = viewer(theta_deg, 0.6);
                let cos = f64::from(wo.z);
                let bound = match form {
                    WardForm::Original => 1.0 / cos.sqrt(),
                    WardForm::Duer => 1.0 / cos,
                    WardForm::Bounded => 2.0,
                };
                let (n, mut sum, mut sum2) = (20_000, 0.0, 0.0);
                for _ in 0..n {
                    let u = [numbers.next() as f32, numbers.next() as f32];
                    let Some(wi) = lobe.sample(wo, u.map(|u| u.min(0.999_999_9))) else { continue };
                    let weight = f64::from(lobe.eval(wo, wi) * wi.z / lobe.pdf(wo, wi));
                    assert!(weight <= bound * 1.001, "{lobe:?} at {theta_deg}: {weight}");
                    sum += weight / f64::from(n);
                    sum2 += weight * weight / f64::from(n);
                }
                let deviation = (sum2 - sum * sum).sqrt();
                if form == WardForm::Original && theta_deg <= 80.0 {
                    assert!(deviation < 0.75, "{lobe:?} at {theta_deg}: deviation {deviation}");
                }
            }
        }
    }
}

#[test]
fn mixtures_have_their_density() {
    for (diffuse, specular) in [(0.5, 0.3), (0.0, 0.4), (0.7, 0.0), (0.05, 0.9)] {
        let lobe = Ward { form: WardForm::Bounded, alpha_x: 0.25, alpha_y: 0.5 };
        let glossy = Glossy { diffuse: Rgb::splat(diffuse), specular: Rgb::splat(specular), lobe };
        for wo in [viewer(30.0, 1.0), viewer(80.0, 4.0), viewer(100.0, 1.0)] {
            let what = format!("{diffuse} diffuse, {specular} glossy from {wo}");
            assert_hemisphere(|u| glossy.sample(wo, u), |wi| glossy.pdf(wo, wi), &what);
        }
    }
}

/// Directions for a square of numbers are as dense as the square is stretched by the map: the density is
/// one over the area that its two slopes span. Of many places, as many as a step across a fold leaves
/// over are wrong.
#[track_caller]
fn assert_jacobian(
    sample: impl Fn([f32; 2]) -> Option<Vec3>,
    pdf: impl Fn(Vec3) -> f64,
    tolerance: f64,
    what: &str,
) {
    const STEP: f32 = 1.0 / 512.0;
    let mut numbers = Numbers::new(21);
    let mut errors = Vec::new();
    while errors.len() < 400 {
        let [u, v] = [0, 1].map(|_| numbers.between(0.01, 0.99) as f32);
        let (low, high) = (|x: f32| x - STEP, |x: f32| x + STEP);
        let places = [[u, v], [low(u), v], [high(u), v], [u, low(v)], [u, high(v)]];
        let Some([here, left, right, down, up]) = all_of(places.map(&sample)) else {
            // What is rejected is no place of the map.
            errors.push(0.0);
            continue;
        };
        let slope = |a: Vec3, b: Vec3| (b.as_dvec3() - a.as_dvec3()) / f64::from(2.0 * STEP);
        let area = slope(left, right).cross(slope(down, up)).length();
        errors.push(pdf(here) * area - 1.0);
    }
    // The middle error says whether the whole is off, the spread whether parts are.
    errors.sort_unstable_by(f64::total_cmp);
    let (low, high) = (errors[errors.len() / 20], errors[errors.len() * 19 / 20]);
    assert!(-tolerance < low && high < tolerance, "{what}: density off by {low} to {high}");
}

fn all_of<const N: usize>(values: [Option<Vec3>; N]) -> Option<[Vec3; N]> {
    values.iter().all(Option::is_some).then(|| values.map(Option::unwrap))
}

#[test]
fn densities_are_the_stretch_of_the_maps_from_numbers_to_directions() {
    for form in FORMS {
        for (alpha_x, alpha_y) in [(0.3, 0.3), (0.1, 0.4), (1.2, 0.4)] {
            let lobe = Ward { form, alpha_x, alpha_y };
            for theta_deg in [5.0, 40.0, 75.0] {
                let wo = viewer(theta_deg, 0.6);
                let what = format!("{lobe:?} at {theta_deg} degrees");
                let pdf = |wi| f64::from(lobe.pdf(wo, wi));
                assert_jacobian(|u| lobe.sample(wo, u), pdf, 0.01, &what);
            }
        }
    }
    let hemisphere = |u| Some(warp::square_to_cosine_hemisphere(u));
    let pdf = |wi: Vec3| f64::from(warp::cosine_hemisphere_pdf(wi.z));
    assert_jacobian(hemisphere, pdf, 0.01, "the cosine hemisphere");
    let frame = Frame::from_normal_tangent(Vec3::new(0.6, -0.8, 0.0), Vec3::Z);
    let (center, radiance) = (Vec3::new(1.0, 3.0, -2.0), Rgb::ONE);
    let emitters = [
        Emitter::Rectangle { center, frame, half: [0.5, 1.0], radiance },
        Emitter::Disk { center, frame, radius: 1.0, radiance },
        Emitter::Sphere { center, radius: 1.0, radiance },
        Emitter::SunCap { frame, one_minus_cos: 0.3, radiance },
    ];
    for emitter in emitters {
        let light = Light { visible: true, emitter };
        for place in
            [Vec3::new(0.5, 0.3, 12.0), Vec3::new(-0.4, 0.3, 1.3), Vec3::new(2.0, 1.0, 0.5)]
        {
            let from = center + frame.world_from_local(place);
            let pdf = |d: Vec3| {
                let met = light.intersect(&Ray::new(from, d));
                met.map_or(f64::NAN, |(t, _)| f64::from(light.pdf(from, d, t)))
            };
            let sample = |u| light.sample(from, u).map(|sample| sample.direction);
            assert_jacobian(sample, pdf, 0.01, &format!("{emitter:?} from {place}"));
        }
    }
}

#[test]
fn the_cosine_hemisphere_has_its_density() {
    assert_hemisphere(
        |u| Some(warp::square_to_cosine_hemisphere(u)).filter(|d| d.z > 0.0),
        |wi| warp::cosine_hemisphere_pdf(wi.z),
        "cosine",
    );
}

/// Cells of equal measure: caps by height and azimuth, disks by squared radius and azimuth.
#[test]
fn caps_and_disks_are_uniform() {
    const N: usize = 16;
    let cell = |share: f64, x: f32, y: f32| {
        let turn = (f64::from(y).atan2(f64::from(x)) / TAU).rem_euclid(1.0);
        let row = ((share * N as f64) as usize).min(N - 1);
        row * N + ((turn * N as f64) as usize).min(N - 1)
    };
    let mut numbers = Numbers::new(2);
    let mut assert_uniform = |place: &dyn Fn([f32; 2]) -> usize, what: &str| {
        let mut counts = vec![0; N * N];
        for _ in 0..60_000 {
            let u = [numbers.next() as f32, numbers.next() as f32];
            counts[place(u.map(|u| u.min(1.0 - f32::EPSILON)))] += 1;
        }
        assert_distributed(&counts, &[1.0 / (N * N) as f64; N * N], what);
    };
    assert_uniform(
        &|u| {
            let p = warp::square_to_disk(u);
            cell(f64::from(p.length_squared()), p.x, p.y)
        },
        "disk",
    );
    for one_minus_cos in [2.0_f32, 1.0, 0.01] {
        assert_uniform(
            &|u| {
                let d = warp::square_to_cap(u, one_minus_cos);
                cell(f64::from(1.0 - d.z) / f64::from(one_minus_cos), d.x, d.y)
            },
            &format!("cap of {one_minus_cos}"),
        );
    }
}

/// The lens's polygon: its area by counting, in square cells.
#[test]
fn polygons_are_uniform_within_their_sides() {
    const N: usize = 14;
    const N_SUB: usize = 40;
    for n in [3_u32, 4, 5, 16] {
        let apothem = (PI / f64::from(n)).cos();
        let is_inside = |x: f64, y: f64| {
            // Side k is met at right angles half way between two corners; one corner is up.
            (0..n).all(|k| {
                let (sin, cos) = (TAU * (f64::from(k) + 0.5) / f64::from(n)).sin_cos();
                x * sin + y * cos <= apothem
            })
        };
        let mut shares = vec![0.0; N * N];
        for i in 0..N * N_SUB {
            for j in 0..N * N_SUB {
                let at = |k: usize| 2.0 * (k as f64 + 0.5) / (N * N_SUB) as f64 - 1.0;
                if is_inside(at(i), at(j)) {
                    shares[(j / N_SUB) * N + i / N_SUB] += 1.0;
                }
            }
        }
        let total: f64 = shares.iter().sum();
        shares.iter_mut().for_each(|s| *s /= total);
        let mut numbers = Numbers::new(u64::from(n));
        let mut counts = vec![0; N * N];
        for _ in 0..60_000 {
            let u = [numbers.next() as f32, numbers.next() as f32].map(|u| u.min(0.999_999_9));
            let p: Vec2 = warp::square_to_polygon(u, n);
            assert!(is_inside(f64::from(p.x) * 0.999_99, f64::from(p.y) * 0.999_99), "{p} of {n}");
            let at = |x: f32| (((x + 1.0) / 2.0 * N as f32) as usize).min(N - 1);
            counts[at(p.y) * N + at(p.x)] += 1;
        }
        assert_distributed(&counts, &shares, &format!("{n} corners"));
    }
}

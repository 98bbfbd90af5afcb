//! Directions to lights against their density.

use glam::{DVec2, Vec3};
use penumbra::color::Rgb;
use penumbra::math::{Frame, Ray};
use penumbra::scene::light::{Emitter, Light};

use super::assert_distributed;
use crate::common::{Numbers, assert_close};

/// The two ways to find a light agree on where it is, how bright, and how dense.
#[test]
fn lights_are_met_where_they_are_sampled_with_the_same_density() {
    let frame = Frame::from_normal_tangent(Vec3::new(0.6, -0.8, 0.0), Vec3::Z);
    let (center, radiance) = (Vec3::new(1.0, 3.0, -2.0), Rgb::new(1.0, 2.0, 3.0));
    let emitters = [
        Emitter::Rectangle { center, frame, half: [0.4, 1.1], radiance },
        Emitter::Disk { center, frame, radius: 0.8, radiance },
        Emitter::Sphere { center, radius: 0.8, radiance },
        Emitter::SunCap { frame, one_minus_cos: 0.1, radiance },
    ];
    let mut numbers = Numbers::new(8);
    for emitter in emitters {
        let light = Light { visible: true, emitter };
        let (mut n_sampled, mut n_met) = (0, 0);
        for _ in 0..2000 {
            let from = (numbers.direction() * 4.0).as_vec3();
            let u = [numbers.next() as f32, numbers.next() as f32];
            let Some(sample) = light.sample(from, u) else { continue };
            n_sampled += 1;
            let pdf = f64::from(sample.pdf.unwrap());
            assert_close(f64::from(sample.weight.x) * pdf, 1.0, 1e-5, "radiance over density");
            // Rounding may lose what is sampled at the very rim, or at a grazing angle.
            let Some((t, met)) = light.intersect(&Ray::new(from, sample.direction)) else {
                continue;
            };
            n_met += 1;
            assert_eq!(met, radiance, "{emitter:?}");
            let found = f64::from(light.pdf(from, sample.direction, t));
            assert_close(found, pdf, 2e-3, &format!("density of {emitter:?}"));
        }
        assert!(n_met > 200 && n_met * 100 > n_sampled * 99, "{n_met} of {n_sampled} are met");
    }
}

/// Directions on a sheet where areas are solid angles: Lambert's azimuthal projection, its x along
/// the longest extent of what it was made for.
struct Sheet {
    frame: Frame,
    low: DVec2,
    high: DVec2,
}

impl Sheet {
    fn around(directions: &[Vec3]) -> Self {
        let axis = directions.iter().sum::<Vec3>().normalize();
        let mut sheet =
            Self { frame: Frame::from_normal(axis), low: DVec2::ZERO, high: DVec2::ZERO };
        let (mut along, mut across) = (0.0, 0.0);
        for d in directions {
            let p = sheet.place(*d);
            along += p.x * p.x - p.y * p.y;
            across += 2.0 * p.x * p.y;
        }
        let turn = 0.5 * across.atan2(along);
        let tangent =
            sheet.frame.world_from_local(Vec3::new(turn.cos() as f32, turn.sin() as f32, 0.0));
        sheet.frame = Frame::from_normal_tangent(axis, tangent);
        for d in directions {
            let p = sheet.place(*d);
            (sheet.low, sheet.high) = (sheet.low.min(p), sheet.high.max(p));
        }
        let margin = (sheet.high - sheet.low) * 0.005;
        (sheet.low, sheet.high) = (sheet.low - margin, sheet.high + margin);
        sheet
    }

    fn place(&self, d: Vec3) -> DVec2 {
        let d = self.frame.local_from_world(d).as_dvec3();
        DVec2::new(d.x, d.y) * (2.0 / (1.0 + d.z)).sqrt()
    }

    fn direction(&self, p: DVec2) -> Vec3 {
        let r2 = p.length_squared().min(4.0);
        let across = p * (1.0 - 0.25 * r2).sqrt();
        self.frame.world_from_local(across.extend(1.0 - 0.5 * r2).as_vec3()).normalize()
    }
}

/// Directions to a light, in cells about the way to its centre: what is sampled against the density
/// of what a ray meets, from far, near, beside, close to its plane and almost on it.
#[test]
fn lights_are_sampled_with_their_density() {
    const N: usize = 12;
    const N_SUB: usize = 30;
    const N_SAMPLES: u32 = 30_000;
    let frame = Frame::from_normal_tangent(Vec3::new(0.6, -0.8, 0.0), Vec3::Z);
    let center = Vec3::new(1.0, 3.0, -2.0);
    let radiance = Rgb::ONE;
    let emitters = [
        Emitter::Rectangle { center, frame, half: [0.5, 1.0], radiance },
        Emitter::Disk { center, frame, radius: 1.0, radiance },
        Emitter::Sphere { center, radius: 1.0, radiance },
        Emitter::SunCap { frame, one_minus_cos: 0.3, radiance },
    ];
    // In the light's frame; z is before it.
    let places = [
        Vec3::new(0.5, 0.3, 30.0),
        Vec3::new(-0.4, 0.3, 1.3),
        Vec3::new(0.9, -1.6, 0.5),
        Vec3::new(0.1, 0.4, 0.95),
        Vec3::new(0.3, -0.2, 0.05),
        Vec3::new(3.0, 1.0, 0.2),
    ];
    let mut numbers = Numbers::new(4);
    for emitter in emitters {
        let light = Light { visible: true, emitter };
        for place in places {
            let from = center + frame.world_from_local(place);
            let what = format!("{emitter:?} from {place}");
            let mut directions = Vec::new();
            for _ in 0..N_SAMPLES {
                let u = [numbers.next() as f32, numbers.next() as f32];
                let sample = light.sample(from, u.map(|u| u.min(1.0 - f32::EPSILON)));
                directions.extend(sample.map(|sample| sample.direction));
            }
            if directions.is_empty() {
                let is_inside = matches!(emitter, Emitter::Sphere { .. }) && place.length() < 1.0;
                assert!(is_inside, "{what}: nothing is sampled");
                continue;
            }
            let map = Sheet::around(&directions);
            let mut counts = vec![0; N * N + 1];
            counts[N * N] = N_SAMPLES - directions.len() as u32;
            for d in &directions {
                let at = (map.place(*d) - map.low) / (map.high - map.low) * N as f64;
                let [column, row] = [at.x, at.y].map(|x| (x as usize).min(N - 1));
                counts[row * N + column] += 1;
            }
            let mut shares = vec![0.0; N * N];
            let step = (map.high - map.low) / (N * N_SUB) as f64;
            for i in 0..N * N_SUB {
                for j in 0..N * N_SUB {
                    let place = map.low + step * (DVec2::new(j as f64, i as f64) + 0.5);
                    let d = map.direction(place);
                    let Some((t, _)) = light.intersect(&Ray::new(from, d)) else { continue };
                    let pdf = f64::from(light.pdf(from, d, t));
                    shares[(i / N_SUB) * N + j / N_SUB] += pdf * step.x * step.y;
                }
            }
            let total: f64 = shares.iter().sum();
            assert!((total - 1.0).abs() < 0.01, "{what}: the density integrates to {total}");
            shares.iter_mut().for_each(|share| *share /= total);
            shares.push(0.0);
            assert_distributed(&counts, &shares, &what);
        }
    }
}

/// What a light's surface does not emit is not sampled: from behind, from its plane, from inside.
#[test]
fn nothing_is_sampled_where_nothing_arrives() {
    let frame = Frame { x: Vec3::X, y: Vec3::Y, z: Vec3::Z };
    let (center, radiance) = (Vec3::ZERO, Rgb::ONE);
    let flat = [
        Emitter::Rectangle { center, frame, half: [1.0, 0.5], radiance },
        Emitter::Disk { center, frame, radius: 1.0, radiance },
    ];
    let ball = Emitter::Sphere { center, radius: 1.0, radiance };
    let behind = [Vec3::new(0.2, 0.1, -0.5), Vec3::new(9.0, 0.0, -3.0), Vec3::new(0.2, 0.1, 0.0)];
    let inside = [Vec3::ZERO, Vec3::new(0.2, 0.1, -0.5), Vec3::X];
    let cases = flat.iter().flat_map(|e| behind.map(|p| (*e, p)));
    for (emitter, from) in cases.chain(inside.map(|p| (ball, p))) {
        let light = Light { visible: true, emitter };
        for u in [[0.1, 0.2], [0.5, 0.5], [0.9, 0.4]] {
            assert!(light.sample(from, u).is_none(), "{emitter:?} from {from}");
        }
    }
}

//! A lake's far shore: hills, and a range of mountains behind them.

use glam::{DVec2, dvec2, dvec3};

use crate::hash::{noise, smooth_step};
use crate::mesh::Mesh;

/// Green hills that come forward at both sides of the lake, from 12 to 75 away.
pub(crate) fn hills() -> Mesh {
    let swell = |at: DVec2| {
        let beside = at.x.abs() / at.y;
        let shore = 52.0 - 36.0 * smooth_step(0.3, 1.0, beside) + 14.0 * noise(0.06 * at.x, 0.7);
        let inland = at.y - shore;
        let folds = fractal(0.06 * at) + 0.35;
        -0.8 + 1.1 * smooth_step(-4.0, 3.0, inland) + 7.5 * smooth_step(0.0, 30.0, inland) * folds
    };
    landscape([12.0, 75.0], [100, 52], swell)
}

/// The range behind, from 62 to 130 away and up to 32 high.
pub(crate) fn peaks() -> Mesh {
    let range = |at: DVec2| {
        let rise = smooth_step(62.0, 100.0, at.y) * (1.0 - smooth_step(112.0, 130.0, at.y));
        let along = 0.75 + 0.5 * noise(0.021 * at.x + 5.2, 3.1);
        rise * (3.0 + 30.0 * along * ridges(dvec2(0.021 * at.x + 0.35, 0.021 * at.y)))
    };
    landscape([62.0, 130.0], [150, 46], range)
}

/// A mesh over the ground for an eye near the origin that looks along -z: rows at growing
/// distances, as wide as the view there. Heights are above the lake.
fn landscape(depths: [f64; 2], cells: [u32; 2], height: impl Fn(DVec2) -> f64) -> Mesh {
    let mut mesh = Mesh::new(2);
    let rows: Vec<Vec<u32>> = (0..=cells[1])
        .map(|j| {
            let share = f64::from(j) / f64::from(cells[1]);
            let depth = depths[0] * libm::pow(depths[1] / depths[0], share);
            (0..=cells[0])
                .map(|i| {
                    let across = 2.0 * f64::from(i) / f64::from(cells[0]) - 1.0;
                    let at = dvec2(0.95 * across * depth, depth);
                    mesh.point(dvec3(at.x, height(at), -at.y))
                })
                .collect()
        })
        .collect();
    mesh.skin(&rows, false);
    mesh
}

/// Noise in three octaves, about -0.6..0.6: finer ones would be finer than the mesh.
fn fractal(at: DVec2) -> f64 {
    let (mut sum, mut scale, mut gain) = (0.0, 1.0, 1.0);
    for octave in 0..3 {
        let shift = 11.9 * f64::from(octave);
        sum += gain * noise(scale * at.x + shift, scale * at.y - shift);
        scale *= 2.1;
        gain *= 0.48;
    }
    sum
}

/// Sharp crests in four octaves, about 0..1. Each is rough only where the one above is high.
fn ridges(at: DVec2) -> f64 {
    let (mut sum, mut weight, mut scale, mut gain) = (0.0, 1.0, 1.0, 0.5);
    for octave in 0..4 {
        let shift = 17.3 * f64::from(octave);
        let crest = 1.0 - 1.6 * noise(scale * at.x + shift, scale * at.y - shift).abs();
        let crest = crest * crest;
        sum += gain * weight * crest;
        weight = (weight * crest * 1.4).clamp(0.0, 1.0);
        scale *= 2.1;
        gain *= 0.48;
    }
    sum
}

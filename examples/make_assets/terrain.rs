//! Mountains around a lake, seen from its shore.

use glam::{DVec2, dvec2, dvec3};

use crate::hash::{noise, smooth_step};
use crate::mesh::Mesh;

/// A landscape in metres / 10 for an eye near the origin that looks along -z: rows at growing
/// distances, as wide as the view there. Below y = 0 is the bed of the lake.
pub(crate) fn mountains() -> Mesh {
    let (n_across, n_deep) = (128, 84);
    let (near, far) = (14.0, 120.0);
    let mut mesh = Mesh::new(2);
    let rows: Vec<Vec<u32>> = (0..=n_deep)
        .map(|j| {
            let depth = near * libm::pow(far / near, f64::from(j) / f64::from(n_deep));
            (0..=n_across)
                .map(|i| {
                    let across = 2.0 * f64::from(i) / f64::from(n_across) - 1.0;
                    let at = dvec2(1.25 * across * depth, depth);
                    mesh.point(dvec3(at.x, height(at), -at.y))
                })
                .collect()
        })
        .collect();
    mesh.skin(&rows, false);
    mesh
}

/// Height of the ground: the lake's bed, shores that come forward at both sides, ridges behind.
fn height(at: DVec2) -> f64 {
    let beside = at.x.abs() / at.y;
    let shore = 62.0 - 46.0 * smooth_step(0.25, 1.1, beside) + 9.0 * noise(0.05 * at.x, 0.7);
    let inland = at.y - shore;
    let rise = smooth_step(-6.0, 45.0, inland);
    let hills = 1.2 * noise(0.09 * at.x, 0.09 * at.y);
    -1.2 + 2.4 * smooth_step(-8.0, 12.0, inland) + hills * rise + 24.0 * rise * ridges(0.033 * at)
}

/// Sharp crests in six octaves, about 0..1. Each octave is rough only where the one above is high.
fn ridges(at: DVec2) -> f64 {
    let (mut sum, mut weight, mut scale, mut gain) = (0.0, 1.0, 1.0, 0.55);
    for octave in 0..6 {
        let shift = 17.3 * f64::from(octave);
        let crest = 1.0 - 1.9 * noise(scale * at.x + shift, scale * at.y - shift).abs();
        let crest = weight * crest * crest;
        sum += gain * crest;
        weight = crest.clamp(0.0, 1.0);
        scale *= 2.03;
        gain *= 0.52;
    }
    sum
}

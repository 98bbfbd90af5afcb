//! A trefoil knot plaited of three strands.

use std::f64::consts::TAU;

use glam::{DVec3, dvec3};

use crate::mesh::Mesh;

const N_STRANDS: u32 = 3;
/// Rings of points along a strand, points on a ring.
const N_ALONG: u32 = 546;
const N_AROUND: u32 = 12;
/// Crossings of the plait from edge to edge and back, all along the knot.
const N_WAVES: f64 = 19.0;
/// Radius of a strand, and how far the plait swings to the sides and through its depth.
const STRAND: f64 = 0.165;
const SWING: f64 = 0.31;
const DEPTH: f64 = 0.16;

/// The knot about the z axis, some 6 wide before it is scaled to stand 2.6 high on y = 0.
pub(crate) fn plaited_knot() -> Mesh {
    let mut mesh = Mesh::new(4);
    for strand in 0..N_STRANDS {
        let phase = TAU * f64::from(strand) / f64::from(N_STRANDS);
        let mut rows: Vec<Vec<u32>> = (0..N_ALONG)
            .map(|i| {
                let t = TAU * f64::from(i) / f64::from(N_ALONG);
                let (tangent, _, _) = frame(t);
                let ahead = strand_middle(t + 1e-4, phase) - strand_middle(t - 1e-4, phase);
                let along = ahead.normalize();
                let side = along.cross(plait_normal(t)).normalize();
                let up = side.cross(along);
                debug_assert!(0.0 < along.dot(tangent), "strands never turn back");
                let middle = strand_middle(t, phase);
                (0..N_AROUND)
                    .map(|j| {
                        let angle = TAU * f64::from(j) / f64::from(N_AROUND);
                        let spoke = libm::cos(angle) * up + libm::sin(angle) * side;
                        mesh.point(middle + STRAND * spoke)
                    })
                    .collect()
            })
            .collect();
        rows.push(rows[0].clone());
        mesh.skin(&rows, true);
    }
    mesh.closed().map(|p| 0.4 * p).stand_centred()
}

/// The middle of a strand: three of them, a third of a wave apart, make a plait.
fn strand_middle(t: f64, phase: f64) -> DVec3 {
    let (_, normal, side) = frame(t);
    let wave = N_WAVES * t + phase;
    middle(t) + SWING * libm::sin(wave) * side + DEPTH * libm::sin(2.0 * wave) * normal
}

/// The middle line of the plait: a trefoil on a torus about z.
fn middle(t: f64) -> DVec3 {
    let reach = 2.15 + 1.0 * libm::cos(3.0 * t);
    dvec3(reach * libm::cos(2.0 * t), reach * libm::sin(2.0 * t), 1.0 * libm::sin(3.0 * t))
}

fn plait_normal(t: f64) -> DVec3 {
    frame(t).1
}

/// Direction along the middle line, away from the torus, and across.
fn frame(t: f64) -> (DVec3, DVec3, DVec3) {
    let tangent = (middle(t + 1e-4) - middle(t - 1e-4)).normalize();
    let circle = 2.15 * dvec3(libm::cos(2.0 * t), libm::sin(2.0 * t), 0.0);
    let outwards = middle(t) - circle;
    let normal = (outwards - outwards.dot(tangent) * tangent).normalize();
    (tangent, normal, tangent.cross(normal))
}

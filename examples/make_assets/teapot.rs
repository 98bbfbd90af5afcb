//! The teapot that Martin Newell drew on graph paper, as he published it.
//!
//! Source: M. E. Newell, "The Utilization of Procedure Models in Digital Image Synthesis", PhD
//! thesis, University of Utah, 1975; with the bottom of F. Crow, "The Origins of the Teapot", IEEE
//! Computer Graphics and Applications 7(1), 1987. 32 bicubic Bezier patches: body, lid and bottom
//! are quarters of turned outlines, handle and spout are halves of swept tubes.

use glam::{DVec2, DVec3, dvec2, dvec3};

use crate::lathe::bezier;
use crate::mesh::Mesh;

/// Steps along each side of a patch.
const STEPS: u32 = 16;

/// Where Newell's quarter circles have their control points, in radii.
const QUARTER: f64 = 0.56;

/// Outlines of the turned parts, as distance from the axis and height.
const TURNED: [[[f64; 2]; 4]; 6] = [
    [[0.0, 0.0], [1.425, 0.0], [1.5, 0.075], [1.5, 0.15]], // bottom
    [[1.5, 0.15], [1.5, 0.225], [2.0, 0.45], [2.0, 0.9]],  // lower body
    [[2.0, 0.9], [2.0, 1.35], [1.75, 1.875], [1.5, 2.4]],  // upper body
    [[1.5, 2.4], [1.4375, 2.53125], [1.3375, 2.53125], [1.4, 2.4]], // rim
    [[1.3, 2.4], [1.3, 2.55], [0.4, 2.55], [0.2, 2.7]],    // lid
    [[0.2, 2.7], [0.0, 2.85], [0.8, 3.15], [0.0, 3.15]],   // knob
];

/// Sections of the two patches of the handle: the inner edge's x and height, the outer edge's x
/// and height, half the width.
const HANDLE: [[f64; 5]; 7] = [
    [-1.6, 2.025, -1.5, 2.25, 0.3],
    [-2.3, 2.025, -2.5, 2.25, 0.3],
    [-2.7, 2.025, -3.0, 2.25, 0.3],
    [-2.7, 1.8, -3.0, 1.8, 0.3],
    [-2.7, 1.575, -3.0, 1.35, 0.3],
    [-2.5, 1.125, -2.65, 0.9375, 0.3],
    [-2.0, 0.9, -1.9, 0.6, 0.3],
];

/// Sections of the two patches of the spout, likewise: upper edge, lower edge, half the width.
const SPOUT: [[f64; 5]; 7] = [
    [1.7, 1.425, 1.7, 0.6, 0.66],
    [2.6, 1.425, 3.1, 0.825, 0.66],
    [2.3, 2.1, 2.4, 2.025, 0.25],
    [2.7, 2.4, 3.3, 2.4, 0.25],
    [2.8, 2.475, 3.525, 2.49375, 0.25],
    [2.9, 2.475, 3.45, 2.5125, 0.15],
    [2.8, 2.4, 3.2, 2.4, 0.15],
];

/// The teapot at half of Newell's size, on y = 0, its spout towards +x. An open surface: the pot
/// is hollow, without a wall's thickness.
pub(crate) fn teapot() -> Mesh {
    let mut mesh = Mesh::new(4);
    for outline in TURNED {
        let outline = outline.map(DVec2::from);
        for turn in 0..4 {
            add_patch(&mut mesh, |u, v| {
                let side = bezier(outline, v);
                let arc = quarter_circle(turn, u);
                dvec3(side.x * arc.x, side.y, side.x * arc.y)
            });
        }
    }
    for sections in [HANDLE, SPOUT] {
        for first in [0, 3] {
            for side in [1.0, -1.0] {
                add_patch(&mut mesh, |u, v| {
                    let u = if 0.0 < side { u } else { 1.0 - u };
                    swept(&sections[first..first + 4], side, u, v)
                });
            }
        }
    }
    mesh.weld().map(|p| 0.5 * p)
}

/// Adds a patch as quads. Seen from outside, u runs to the right and v upwards.
fn add_patch(mesh: &mut Mesh, point: impl Fn(f64, f64) -> DVec3) {
    let at = |i: u32| f64::from(i) / f64::from(STEPS);
    let rows: Vec<Vec<u32>> = (0..=STEPS)
        .map(|j| (0..=STEPS).map(|i| mesh.point(point(at(i), at(j)))).collect())
        .collect();
    mesh.skin(&rows, false);
}

/// A point of Newell's circle of radius 1: quarter `turn`, parameter 0..1, from z towards x.
fn quarter_circle(turn: u32, u: f64) -> DVec2 {
    let arc = [dvec2(0.0, 1.0), dvec2(QUARTER, 1.0), dvec2(1.0, QUARTER), dvec2(1.0, 0.0)];
    let mut p = bezier(arc, u);
    for _ in 0..turn {
        p = dvec2(p.y, -p.x);
    }
    p
}

/// A point of one half of a tube: u goes around from the first edge to the second, v along it.
fn swept(sections: &[[f64; 5]], side: f64, u: f64, v: f64) -> DVec3 {
    let along = |pick: fn(&[f64; 5]) -> DVec2| bezier([0, 1, 2, 3].map(|i| pick(&sections[i])), v);
    let first = along(|s| dvec2(s[0], s[1]));
    let second = along(|s| dvec2(s[2], s[3]));
    let half_width = along(|s| dvec2(s[4], 0.0)).x;
    let around = bezier([dvec2(0.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 1.0), dvec2(1.0, 0.0)], u);
    let middle = first.lerp(second, around.x);
    dvec3(middle.x, middle.y, side * half_width * around.y)
}

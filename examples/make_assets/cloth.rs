//! Open sheets: a curtain in folds, and the backdrop of a photographer's studio.

use std::f64::consts::PI;

use glam::{DVec3, dvec2, dvec3};

use crate::mesh::Mesh;

/// A curtain 4 wide and 12 high in the plane z = 0, its hem on y = 0: folds that open downwards.
pub(crate) fn curtain() -> Mesh {
    let (n_across, n_up) = (134, 26);
    let mut mesh = Mesh::new(3);
    let rows: Vec<Vec<u32>> = (0..=n_up)
        .map(|j| {
            let t = f64::from(j) / f64::from(n_up);
            (0..=n_across)
                .map(|i| {
                    let x = 4.0 * (f64::from(i) / f64::from(n_across) - 0.5);
                    mesh.point(hanging(x, t))
                })
                .collect()
        })
        .collect();
    mesh.skin(&rows, false);
    mesh
}

/// A point of the curtain: x across, t from the hem (0) to the rail (1).
fn hanging(x: f64, t: f64) -> DVec3 {
    let opening = 0.16 + 0.2 * (1.0 - t);
    let drift = 0.5 * libm::sin(1.3 * x + 2.2 * t);
    let wave = libm::sin(9.0 * x + drift) + 0.35 * libm::sin(4.1 * x - 1.2 * t + 0.7);
    // Deep folds lean over: the cloth is longer than the rail.
    let lean = 0.11 * opening / 0.3 * libm::sin(2.0 * (9.0 * x + drift));
    dvec3(x + lean, 12.0 * t, opening * wave)
}

/// A floor from z = 8 to -4 that bends with radius 3 into a wall 12 high; 40 wide, y = 0.
pub(crate) fn backdrop() -> Mesh {
    let (radius, n) = (3.0, 24);
    let mut line = vec![(dvec2(0.0, 8.0), dvec2(1.0, 0.0))];
    for i in 0..=n {
        let angle = 0.5 * PI * f64::from(i) / f64::from(n);
        let (s, c) = (libm::sin(angle), libm::cos(angle));
        line.push((dvec2(radius * (1.0 - c), -4.0 - radius * s), dvec2(c, s)));
    }
    line.push((dvec2(12.0, -7.0), dvec2(0.0, 1.0)));
    let mut mesh = Mesh::new(4);
    let rows: Vec<Vec<u32>> = line
        .iter()
        .enumerate()
        .map(|(i, (at, facing))| {
            let v = i as f64 / (line.len() - 1) as f64;
            [-1.0, 1.0]
                .map(|side| {
                    mesh.point_with(
                        dvec3(20.0 * side, at.x, at.y),
                        dvec3(0.0, facing.x, facing.y),
                        dvec2(0.5 + 0.5 * side, v),
                    )
                })
                .to_vec()
        })
        .collect();
    mesh.skin(&rows, false);
    mesh
}

//! Outlines, and what a lathe makes of them.

use std::f64::consts::TAU;

use glam::{DVec2, dvec2, dvec3};

use crate::mesh::Mesh;

/// An outline in the half plane: x is the distance from the axis, y the height. Going along it,
/// the inside of the solid is on the left: an outline from the foot's middle to the top.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    points: Vec<DVec2>,
}

impl Outline {
    /// Begins at a point.
    pub(crate) fn from(radius: f64, height: f64) -> Self {
        Self { points: vec![dvec2(radius, height)] }
    }

    /// Goes straight to a point.
    pub(crate) fn line(mut self, radius: f64, height: f64) -> Self {
        self.points.push(dvec2(radius, height));
        self
    }

    /// Goes to `end` along a cubic Bezier curve with two control points, in `n` steps.
    pub(crate) fn curve(mut self, c1: [f64; 2], c2: [f64; 2], end: [f64; 2], n: u32) -> Self {
        let start = self.points[self.points.len() - 1];
        let controls = [start, c1.into(), c2.into(), end.into()];
        self.points.extend((1..=n).map(|i| bezier(controls, f64::from(i) / f64::from(n))));
        self
    }

    /// Turns it about the y axis with `n` points on every circle. Points on the axis are poles; an
    /// outline that ends where it began makes a ring.
    pub(crate) fn turn(&self, n: u32) -> Mesh {
        let mut mesh = Mesh::new(4);
        let first = self.points[0];
        let ring = first == self.points[self.points.len() - 1];
        let mut rows: Vec<Vec<u32>> = vec![];
        for (i, p) in self.points.iter().enumerate() {
            if ring && i == self.points.len() - 1 {
                rows.push(rows[0].clone());
                continue;
            }
            let n_points = if p.x < 1e-9 { 1 } else { n };
            let row = (0..n_points).map(|j| {
                let angle = TAU * f64::from(j) / f64::from(n);
                mesh.point(dvec3(p.x * libm::sin(angle), p.y, p.x * libm::cos(angle)))
            });
            rows.push(row.collect());
        }
        mesh.skin(&rows, true);
        mesh.closed()
    }
}

/// A cubic Bezier curve at `t`.
pub(crate) fn bezier(p: [DVec2; 4], t: f64) -> DVec2 {
    let s = 1.0 - t;
    p[0] * (s * s * s) + p[1] * (3.0 * s * s * t) + p[2] * (3.0 * s * t * t) + p[3] * (t * t * t)
}

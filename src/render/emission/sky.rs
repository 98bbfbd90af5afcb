//! The bright parts of a textured background, to be looked for.
//!
//! A map of the luminance above the mean, in cells of equal solid angle. Scattered rays find what
//! is darker: they would find it as well without a map, and a sky without contrast needs none.
//!
//! Source: O. Karlík et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple
//! Importance Sampling", ACM TOG 38(6), 2019.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::color::luminance;
use crate::math::distribution::Distribution;
use crate::math::portable;
use crate::scene::Scene;

/// Cells around the horizon, and from the zenith to the nadir.
const COLUMNS: usize = 256;
const ROWS: usize = 128;
/// Steradians of a cell.
const CELL: f64 = 2.0 * TAU / (COLUMNS * ROWS) as f64;

/// Where the sky is brighter than on average.
#[derive(Debug)]
pub(super) struct Sky {
    rows: Distribution,
    columns: Vec<Distribution>,
}

impl Sky {
    /// Of the scene's background; `None` where it has no contrast.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        let cells: Vec<f32> = (0..ROWS * COLUMNS)
            .into_par_iter()
            .map(|cell| {
                let middle = direction(cell / COLUMNS, cell % COLUMNS, [0.5; 2]);
                luminance(scene.background_radiance(middle))
            })
            .collect();
        let mean = cells.iter().map(|cell| f64::from(*cell)).sum::<f64>() / cells.len() as f64;
        let excess = |cell: &f32| (f64::from(*cell) - mean).max(0.0) as f32;
        let columns: Vec<Distribution> = cells
            .chunks_exact(COLUMNS)
            .map(|row| Distribution::new(row.iter().map(excess)))
            .collect();
        let rows = Distribution::new(columns.iter().map(|row| row.total() as f32));
        // Rounding leaves a trace of contrast in a uniform sky.
        const LEAST_CONTRAST: f64 = 1e-3;
        let has_contrast = rows.total() > LEAST_CONTRAST * mean * cells.len() as f64;
        (has_contrast && rows.total().is_finite()).then_some(Self { rows, columns })
    }

    /// Integral of what is looked for, over all directions.
    pub(super) fn strength(&self) -> f32 {
        (self.rows.total() * CELL) as f32
    }

    /// A direction for two numbers in [0, 1), with density [`Sky::pdf`].
    pub(super) fn sample(&self, [u, v]: [f32; 2]) -> Option<Vec3> {
        let (row, y) = self.rows.sample(v)?;
        let (column, x) = self.columns[row].sample(u)?;
        Some(direction(row, column, [f64::from(x), f64::from(y)]))
    }

    /// Density of [`Sky::sample`] per solid angle.
    pub(super) fn pdf(&self, direction: Vec3) -> f32 {
        let d = direction.as_dvec3();
        let turn = 0.5 + portable::atan2_f64(d.z, d.x) / TAU;
        let row = (((1.0 - d.y) * 0.5 * ROWS as f64) as usize).min(ROWS - 1);
        let column = ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1);
        (self.rows.share(row) * self.columns[row].share(column) / CELL) as f32
    }
}

/// A unit direction in a cell: heights are uniform, as areas of a sphere are.
fn direction(row: usize, column: usize, [x, y]: [f64; 2]) -> Vec3 {
    let height = 1.0 - 2.0 * (row as f64 + y) / ROWS as f64;
    let angle = TAU * (column as f64 + x) / COLUMNS as f64 - PI;
    let across = (1.0 - height * height).max(0.0).sqrt();
    let (sin, cos) = (portable::sin_f64(angle), portable::cos_f64(angle));
    DVec3::new(across * cos, height, across * sin).as_vec3()
}

//! Which rays of a batch may meet an object: those that touch its box before their limit.
//!
//! What remains of a batch is traced together, so that packets stay full where a scene has many
//! objects.

use std::cell::OnceCell;

use crate::math::vectorized::{BLOCK, vectorized};
use crate::math::{Aabb, RayBatch};

/// A batch ready to be tested against boxes of the world.
pub(super) struct Selector<'a> {
    rays: &'a RayBatch,
    /// Of the directions, and the largest coordinate of an origin; from the first time that they
    /// are needed.
    reciprocals: OnceCell<([Vec<f32>; 3], f32)>,
}

impl<'a> Selector<'a> {
    pub(super) fn new(rays: &'a RayBatch) -> Self {
        Self { rays, reciprocals: OnceCell::new() }
    }

    /// Overwrites `selected` with the rays that may touch the box before their limits, one a ray;
    /// those whose limit is below 0 do not. The box is grown by the bound of the rounding errors.
    pub(super) fn select(&mut self, bounds: &Aabb, limits: &[f32], selected: &mut Vec<u32>) {
        let (reciprocals, magnitude) = self.reciprocals.get_or_init(|| reciprocals(self.rays));
        let pad = (*magnitude + bounds.max_abs()) * (16.0 / 16_777_216.0);
        let bounds = Aabb { min: bounds.min - pad, max: bounds.max + pad };
        touching(&bounds, &self.rays.origin, reciprocals, limits, selected);
    }
}

vectorized! {
    /// The rays that touch a box before their limits.
    fn touching(
        bounds: &Aabb,
        origin: &[Vec<f32>; 3],
        reciprocals: &[Vec<f32>; 3],
        limits: &[f32],
        selected: &mut Vec<u32>,
    ) {
        let n = limits.len();
        selected.resize(n, 0);
        let mut n_selected = 0;
        for start in (0..n).step_by(BLOCK) {
            let len = BLOCK.min(n - start);
            let mut lanes = [[0.0; BLOCK]; 7];
            let columns = [
                &origin[0][..n], &origin[1][..n], &origin[2][..n],
                &reciprocals[0][..n], &reciprocals[1][..n], &reciprocals[2][..n],
                limits,
            ];
            for (lane, column) in lanes.iter_mut().zip(columns) {
                lane[..len].copy_from_slice(&column[start..start + len]);
            }
            let mut touches = [0; BLOCK];
            let mut n_touching = 0;
            for i in 0..BLOCK {
                let (mut enter, mut leave) = (0.0, lanes[6][i]);
                for axis in 0..3 {
                    let (low, high) = (bounds.min[axis], bounds.max[axis]);
                    let (near, far) = slab(low, high, lanes[axis][i], lanes[3 + axis][i]);
                    enter = if enter > near { enter } else { near };
                    leave = if leave < far { leave } else { far };
                }
                touches[i] = u32::from(enter <= leave);
                n_touching += touches[i];
            }
            // Most blocks of rays pass by all together.
            if n_touching > 0 {
                for (i, touches) in touches.iter().enumerate().take(len) {
                    selected[n_selected] = (start + i) as u32;
                    n_selected += *touches as usize;
                }
            }
        }
        selected.truncate(n_selected);
    }
}

/// Where a line with that origin and reciprocal direction enters and leaves.
#[inline(always)]
fn slab(low: f32, high: f32, origin: f32, reciprocal: f32) -> (f32, f32) {
    let (a, b) = ((low - origin) * reciprocal, (high - origin) * reciprocal);
    if a < b { (a, b) } else { (b, a) }
}

fn reciprocals(rays: &RayBatch) -> ([Vec<f32>; 3], f32) {
    let reciprocal = |d: &f32| {
        /// Reciprocals stay finite.
        const SMALLEST: f32 = 1e-20;
        1.0 / if d.abs() < SMALLEST { SMALLEST.copysign(*d) } else { *d }
    };
    let along = |axis: usize| rays.direction[axis].iter().map(reciprocal).collect();
    let magnitude = rays.origin.iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs()));
    ([along(0), along(1), along(2)], magnitude)
}

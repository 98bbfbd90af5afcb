//! Which rays of a batch may meet an object: those that touch its box before their limit.
//!
//! What remains of a batch is traced together, so that packets stay full where a scene has many
//! objects.

use std::cell::OnceCell;

use crate::math::vectorized::vectorized;
use crate::math::{Aabb, RayBatch};

/// A batch ready to be tested against boxes of the world.
pub(super) struct Selector<'a> {
    rays: &'a RayBatch,
    /// Of the directions, and the largest coordinate of an origin; from the first time that they
    /// are needed.
    reciprocals: OnceCell<([Vec<f32>; 3], f32)>,
    /// Where rays leave the box; NaN where they do not touch it.
    leaves: Vec<f32>,
}

impl<'a> Selector<'a> {
    pub(super) fn new(rays: &'a RayBatch) -> Self {
        Self { rays, reciprocals: OnceCell::new(), leaves: Vec::new() }
    }

    /// Overwrites `selected` with the rays that may touch the box before their limit; those whose
    /// limit is below 0 do not. The box is grown by the bound of the rounding errors.
    pub(super) fn select(
        &mut self,
        bounds: &Aabb,
        limit: impl Fn(usize) -> f32,
        selected: &mut Vec<u32>,
    ) {
        let n = self.rays.len();
        let (reciprocals, magnitude) = self.reciprocals.get_or_init(|| reciprocals(self.rays));
        let pad = (*magnitude + bounds.max_abs()) * (16.0 / 16_777_216.0);
        let bounds = Aabb { min: bounds.min - pad, max: bounds.max + pad };
        self.leaves.clear();
        self.leaves.extend((0..n).map(limit));
        touch(&bounds, &self.rays.origin, reciprocals, &mut self.leaves);
        selected.clear();
        selected.resize(n, 0);
        let mut n_selected = 0;
        for (i, leave) in self.leaves.iter().enumerate() {
            selected[n_selected] = i as u32;
            n_selected += usize::from(!leave.is_nan());
        }
        selected.truncate(n_selected);
    }
}

vectorized! {
    /// Makes NaN of the limits of rays that do not touch a box before them.
    fn touch(
        bounds: &Aabb,
        origin: &[Vec<f32>; 3],
        reciprocals: &[Vec<f32>; 3],
        limits: &mut [f32],
    ) {
        let n = limits.len();
        let (low, high) = (bounds.min, bounds.max);
        let (ox, oy, oz) = (&origin[0][..n], &origin[1][..n], &origin[2][..n]);
        let (rx, ry, rz) = (&reciprocals[0][..n], &reciprocals[1][..n], &reciprocals[2][..n]);
        for i in 0..n {
            let (near_x, far_x) = slab(low.x, high.x, ox[i], rx[i]);
            let (near_y, far_y) = slab(low.y, high.y, oy[i], ry[i]);
            let (near_z, far_z) = slab(low.z, high.z, oz[i], rz[i]);
            let enter = greater(greater(greater(0.0, near_x), near_y), near_z);
            let leave = lesser(lesser(lesser(limits[i], far_x), far_y), far_z);
            limits[i] = if enter <= leave { leave } else { f32::NAN };
        }
    }
}

/// Where a line with that origin and reciprocal direction enters and leaves.
#[inline(always)]
fn slab(low: f32, high: f32, origin: f32, reciprocal: f32) -> (f32, f32) {
    let (a, b) = ((low - origin) * reciprocal, (high - origin) * reciprocal);
    if a < b { (a, b) } else { (b, a) }
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
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

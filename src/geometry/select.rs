//! Which rays of a batch may meet an object: those that touch its box before their limit.
//!
//! What remains of a batch is traced together, so that packets stay full where a scene has many
//! objects.

use std::cell::OnceCell;

use crate::math::{Aabb, RayBatch};

/// A batch ready to be tested against boxes of the world.
pub(super) struct Selector<'a> {
    rays: &'a RayBatch,
    /// Of the directions, and the largest coordinate of an origin; from the first time that they
    /// are needed.
    reciprocals: OnceCell<([Vec<f32>; 3], f32)>,
    touches: Vec<bool>,
}

impl<'a> Selector<'a> {
    pub(super) fn new(rays: &'a RayBatch) -> Self {
        Self { rays, reciprocals: OnceCell::new(), touches: Vec::new() }
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
        let (low, high) = ((bounds.min - pad).to_array(), (bounds.max + pad).to_array());
        self.touches.clear();
        self.touches.resize(n, false);
        let [ox, oy, oz] = self.rays.origin.each_ref().map(|column| &column[..n]);
        let [rx, ry, rz] = reciprocals.each_ref().map(|column| &column[..n]);
        for (i, touches) in self.touches.iter_mut().enumerate() {
            let (mut enter, mut leave) = (0.0, limit(i));
            for (axis, (o, r)) in
                [(ox[i], rx[i]), (oy[i], ry[i]), (oz[i], rz[i])].iter().enumerate()
            {
                let (a, b) = ((low[axis] - o) * r, (high[axis] - o) * r);
                let (near, far) = if a < b { (a, b) } else { (b, a) };
                enter = if enter > near { enter } else { near };
                leave = if leave < far { leave } else { far };
            }
            *touches = enter <= leave;
        }
        selected.clear();
        let touching = self.touches.iter().enumerate().filter(|(_, touches)| **touches);
        selected.extend(touching.map(|(i, _)| i as u32));
    }
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

//! Which rays of a batch may meet an object: those that touch its box before their limit.
//!
//! What remains of a batch is traced together, so that packets stay full where a scene has many
//! objects.

use crate::math::{Aabb, RayBatch};

/// A batch ready to be tested against boxes of the world.
pub(super) struct Selector<'a> {
    rays: &'a RayBatch,
    reciprocal: [Vec<f32>; 3],
    /// Largest coordinate of an origin.
    magnitude: f32,
    touches: Vec<bool>,
}

impl<'a> Selector<'a> {
    pub(super) fn new(rays: &'a RayBatch) -> Self {
        let reciprocal = |d: &f32| {
            /// Reciprocals stay finite.
            const SMALLEST: f32 = 1e-20;
            1.0 / if d.abs() < SMALLEST { SMALLEST.copysign(*d) } else { *d }
        };
        let reciprocals = |axis: usize| rays.direction[axis].iter().map(reciprocal).collect();
        let magnitude = rays.origin.iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs()));
        Self {
            rays,
            reciprocal: [reciprocals(0), reciprocals(1), reciprocals(2)],
            magnitude,
            touches: Vec::new(),
        }
    }

    /// Overwrites `selected` with the rays that may touch the box before their limit; those whose
    /// limit is below 0 do not. The box is grown by the bound of the rounding errors.
    pub(super) fn select(&mut self, bounds: &Aabb, limits: &[f32], selected: &mut Vec<u32>) {
        let n = self.rays.len();
        let pad = (self.magnitude + bounds.max_abs()) * (16.0 / 16_777_216.0);
        let (low, high) = ((bounds.min - pad).to_array(), (bounds.max + pad).to_array());
        self.touches.clear();
        self.touches.resize(n, false);
        let [ox, oy, oz] = self.rays.origin.each_ref().map(|column| &column[..n]);
        let [rx, ry, rz] = self.reciprocal.each_ref().map(|column| &column[..n]);
        let limits = &limits[..n];
        for (i, touches) in self.touches.iter_mut().enumerate() {
            let (mut enter, mut leave) = (0.0, limits[i]);
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

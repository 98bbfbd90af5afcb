//! Which rays of a batch may meet an object: those that touch its box before their limit.
//!
//! What remains of a batch is traced together, so that packets stay full where a scene has many
//! objects. Blocks of rays are held against a box first, as one beam: most pass by all together.

use crate::math::vectorized::{BLOCK, Lane, vectorized};
use crate::math::{Aabb, RayBatch};

/// Rays of a batch on their way from object to object, with memory that serves one batch after another.
#[derive(Default)]
pub(super) struct Selection {
    /// Up to where each ray of the batch is of interest, below 0 if it is not any more.
    pub(super) limits: Vec<f32>,
    /// Places of the rays in question.
    pub(super) places: Vec<u32>,
    /// Those rays.
    pub(super) rays: RayBatch,
    slopes: Slopes,
    /// For each block of rays, whether it may touch a box.
    is_near: Vec<u32>,
}

/// What the tests of boxes need beside the origins.
#[derive(Default)]
struct Slopes {
    /// Of the directions.
    reciprocals: [Vec<f32>; 3],
    /// The least and the greatest origin and reciprocal of each block of rays.
    least: [Vec<f32>; 6],
    greatest: [Vec<f32>; 6],
}

impl Selection {
    /// Begins with the rays of another batch: their limits.
    pub(super) fn begin(&mut self, limits: impl Iterator<Item = f32>) {
        self.limits.clear();
        self.limits.extend(limits);
        self.slopes.clear();
    }

    /// Takes the rays of `batch`, one a limit, that may touch the box before their limits; those whose
    /// limit is below 0 do not. For each ray the box is grown by the bound of the rounding errors.
    /// Whether there are any.
    pub(super) fn select(&mut self, batch: &RayBatch, bounds: &Aabb) -> bool {
        if self.slopes.is_empty() {
            self.slopes.fill(batch);
        }
        self.is_near.clear();
        self.is_near.resize(batch.len().div_ceil(BLOCK), 0);
        near_beams(bounds, &self.slopes.least, &self.slopes.greatest, &mut self.is_near);
        self.places.clear();
        let near = self.is_near.iter().enumerate().filter(|(_, is_near)| **is_near != 0);
        for start in near.map(|(block, _)| block * BLOCK) {
            let mut touches = [0; BLOCK];
            let [ox, oy, oz] = &batch.origin;
            let [rx, ry, rz] = &self.slopes.reciprocals;
            let columns = [ox, oy, oz, rx, ry, rz].map(|column| &column[start..]);
            let limits = &self.limits[start..];
            match whole_lanes(columns, limits) {
                Some((columns, limits)) => touching(bounds, columns, limits, &mut touches),
                None => {
                    // Rays that are not there end before they start.
                    let (mut last, mut ends) = ([[0.0; BLOCK]; 6], [-1.0; BLOCK]);
                    let n = limits.len();
                    for (lane, column) in last.iter_mut().zip(columns) {
                        lane[..n].copy_from_slice(&column[..n]);
                    }
                    ends[..n].copy_from_slice(limits);
                    touching(bounds, last.each_ref(), &ends, &mut touches);
                }
            }
            let (mut found, mut n_found) = ([0; BLOCK], 0);
            for (i, is_touched) in touches.into_iter().enumerate() {
                found[n_found] = (start + i) as u32;
                n_found += is_touched as usize;
            }
            self.places.extend_from_slice(&found[..n_found]);
        }
        if self.places.is_empty() {
            return false;
        }
        self.rays.gather(batch, &self.places);
        true
    }
}

/// The first lanes of columns that have them.
fn whole_lanes<'a>(
    columns: [&'a [f32]; 6],
    limits: &'a [f32],
) -> Option<([&'a Lane<f32>; 6], &'a Lane<f32>)> {
    let [ox, oy, oz, rx, ry, rz] = columns.map(<[f32]>::first_chunk);
    Some(([ox?, oy?, oz?, rx?, ry?, rz?], limits.first_chunk()?))
}

impl Slopes {
    fn clear(&mut self) {
        let [x, y, z] = &mut self.reciprocals;
        let columns = [x, y, z].into_iter().chain(&mut self.least).chain(&mut self.greatest);
        columns.for_each(Vec::clear);
    }

    fn is_empty(&self) -> bool {
        self.reciprocals[0].is_empty()
    }

    fn fill(&mut self, rays: &RayBatch) {
        let reciprocal = |d: &f32| {
            /// Reciprocals stay finite.
            const SMALLEST: f32 = 1e-20;
            1.0 / if d.abs() < SMALLEST { SMALLEST.copysign(*d) } else { *d }
        };
        for (reciprocals, column) in self.reciprocals.iter_mut().zip(&rays.direction) {
            reciprocals.extend(column.iter().map(reciprocal));
        }
        let columns = rays.origin.iter().chain(&self.reciprocals);
        let extents = self.least.iter_mut().zip(&mut self.greatest);
        for (column, (least, greatest)) in columns.zip(extents) {
            for start in (0..column.len()).step_by(BLOCK) {
                let block = &column[start..column.len().min(start + BLOCK)];
                // The first one fills the places of rays that are not there.
                let mut lanes = [block[0]; BLOCK];
                lanes[..block.len()].copy_from_slice(block);
                let (low, high) = extremes(&lanes);
                least.push(low);
                greatest.push(high);
            }
        }
    }
}

vectorized! {
    /// The least and the greatest number of a block.
    fn extremes(lanes: &Lane<f32>) -> (f32, f32) {
        let (mut least, mut greatest) = (*lanes, *lanes);
        let mut half = BLOCK / 2;
        while half > 0 {
            for i in 0..half {
                least[i] = lesser(least[i], least[i + half]);
                greatest[i] = greater(greatest[i], greatest[i + half]);
            }
            half /= 2;
        }
        (least[0], greatest[0])
    }
    /// Which blocks of rays may touch a box: the products that the single test makes are largest and
    /// smallest at the ends of both ranges, and rounding keeps their order.
    fn near_beams(
        bounds: &Aabb,
        least: &[Vec<f32>; 6],
        greatest: &[Vec<f32>; 6],
        is_near: &mut [u32],
    ) {
        let n = is_near.len();
        let [ox0, oy0, oz0, rx0, ry0, rz0] = least.each_ref().map(|column| &column[..n]);
        let [ox1, oy1, oz1, rx1, ry1, rz1] = greatest.each_ref().map(|column| &column[..n]);
        let magnitude = bounds.max_abs();
        for i in 0..n {
            let farthest = greater(greater(ox0[i].abs(), oy0[i].abs()), oz0[i].abs());
            let farthest = greater(greater(ox1[i].abs(), oy1[i].abs()), farthest);
            let pad = (greater(oz1[i].abs(), farthest) + magnitude) * ROUNDING;
            let (low, high) = (bounds.min - pad, bounds.max + pad);
            let (near_x, far_x) = beam(low.x, high.x, (ox0[i], ox1[i]), (rx0[i], rx1[i]));
            let (near_y, far_y) = beam(low.y, high.y, (oy0[i], oy1[i]), (ry0[i], ry1[i]));
            let (near_z, far_z) = beam(low.z, high.z, (oz0[i], oz1[i]), (rz0[i], rz1[i]));
            let enter = greater(greater(greater(0.0, near_x), near_y), near_z);
            let leave = lesser(lesser(far_x, far_y), far_z);
            is_near[i] = u32::from(enter <= leave);
        }
    }
    /// Which rays touch a box before their limits. Columns: origins, reciprocals.
    fn touching(
        bounds: &Aabb,
        columns: [&Lane<f32>; 6],
        limits: &Lane<f32>,
        touches: &mut Lane<u32>,
    ) {
        let [ox, oy, oz, rx, ry, rz] = columns;
        let magnitude = bounds.max_abs();
        for i in 0..BLOCK {
            let farthest = greater(greater(ox[i].abs(), oy[i].abs()), oz[i].abs());
            let pad = (farthest + magnitude) * ROUNDING;
            let (low, high) = (bounds.min - pad, bounds.max + pad);
            let (near_x, far_x) = slab(low.x, high.x, ox[i], rx[i]);
            let (near_y, far_y) = slab(low.y, high.y, oy[i], ry[i]);
            let (near_z, far_z) = slab(low.z, high.z, oz[i], rz[i]);
            let enter = greater(greater(greater(0.0, near_x), near_y), near_z);
            let leave = lesser(lesser(lesser(limits[i], far_x), far_y), far_z);
            touches[i] = u32::from(enter <= leave);
        }
    }
}

/// Boxes are grown by this share of the largest coordinate of the box and of a ray's origin.
const ROUNDING: f32 = 16.0 / 16_777_216.0;

/// Where a line with that origin and reciprocal direction enters and leaves.
#[inline(always)]
fn slab(low: f32, high: f32, origin: f32, reciprocal: f32) -> (f32, f32) {
    let (a, b) = ((low - origin) * reciprocal, (high - origin) * reciprocal);
    if a < b { (a, b) } else { (b, a) }
}

/// The first entry and the last exit of all lines of a block.
#[inline(always)]
fn beam(low: f32, high: f32, origin: (f32, f32), reciprocal: (f32, f32)) -> (f32, f32) {
    let mut ends = (f32::INFINITY, f32::NEG_INFINITY);
    for origin in [origin.0, origin.1] {
        for reciprocal in [reciprocal.0, reciprocal.1] {
            let (near, far) = slab(low, high, origin, reciprocal);
            ends = (lesser(near, ends.0), greater(far, ends.1));
        }
    }
    ends
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::math::Ray;
    use crate::math::sampler::Sampler;
    use crate::math::vectorized::at_every_level;

    /// Rays of every scale, alike in blocks and not, some along axes.
    fn rays(scale: f32) -> RayBatch {
        let number = |i: u32, k: u32| Sampler::Random { seed: 3 }.numbers(i, k, 0).pair(0)[0] - 0.5;
        let vector = |i, k| Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2));
        let mut rays = RayBatch::default();
        for i in 0..500 {
            let origin = 6.0 * vector(if i < 250 { 1000 } else { i }, 0);
            let mut direction = vector(i, 3) * 0.3 - origin;
            if i % 17 == 0 {
                direction.x = 0.0;
            }
            let t_max = if i % 3 == 0 { 2.0 / scale } else { f32::INFINITY };
            rays.push(Ray { t_max, ..Ray::new(origin, direction * scale) });
        }
        // From so far away boxes are large; for other rays they are not.
        rays.push(Ray::new(Vec3::splat(1e9), Vec3::NEG_ONE));
        rays
    }

    #[test]
    fn rays_are_selected_as_by_one_test_each() {
        for scale in [1.0, 1e12, 1e-12] {
            let rays = rays(scale);
            let bounds = Aabb { min: Vec3::new(-0.3, -0.1, 0.0), max: Vec3::new(0.1, 0.2, 0.0) };
            let pad = 1e-4;
            let touches = |i: &u32| {
                let ray = rays.ray(*i as usize);
                let (mut enter, mut leave) = (0.0_f32, ray.t_max);
                for axis in 0..3 {
                    let end = |x: f32| (x - ray.origin[axis]) / ray.direction[axis];
                    let (a, b) = (end(bounds.min[axis] - pad), end(bounds.max[axis] + pad));
                    enter = enter.max(a.min(b));
                    leave = leave.min(a.max(b));
                }
                enter <= leave
            };
            let expected: Vec<u32> = (0..500).filter(touches).collect();
            assert!(expected.len() > 50 && expected.len() < 400, "{}", expected.len());
            for (level, selected) in at_every_level(|| {
                let mut selection = Selection::default();
                // Of another batch before.
                selection.begin([1.0].into_iter());
                let mut other = RayBatch::default();
                other.push(Ray::new(Vec3::splat(3.0), Vec3::X));
                assert!(!selection.select(&other, &bounds), "a ray that passes by");
                selection.begin(rays.t_max.iter().copied());
                assert!(selection.select(&rays, &bounds));
                let mut selected = selection.places;
                assert_eq!(selected.len(), selection.rays.len());
                for (i, place) in selected.iter().enumerate() {
                    assert_eq!(selection.rays.ray(i), rays.ray(*place as usize));
                }
                assert_eq!(selected.pop(), Some(500), "the ray from far away");
                selected
            }) {
                let extra = selected.iter().filter(|i| !expected.contains(i)).count();
                let lost = expected.iter().filter(|i| !selected.contains(i)).count();
                // Padding differs in the last bits.
                assert!(extra <= 2 && lost <= 2, "{level:?}, {scale}: {extra} more, {lost} lost");
            }
        }
    }
}

//! Rays, one and many.

use glam::Vec3;

use crate::math::vectorized::{BLOCK, Lane, Lane3, NO_LANES};

/// A half line from `origin` along `direction`, up to parameter `t_max` (exclusive).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes; any length above 0. Distances along the ray are in units of it.
    pub direction: Vec3,
    /// Hits count while 0 < t < t_max.
    pub t_max: f32,
    /// The flat primitive that it leaves, which it cannot meet again.
    pub source: PrimitiveId,
}

/// Names one primitive of one object: a triangle, a box's face, a whole sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitiveId {
    /// Index of the object in the scene.
    pub object: u32,
    /// Index of the primitive in the object.
    pub primitive: u32,
}

impl PrimitiveId {
    /// No primitive at all; after every other in order.
    pub const NONE: Self = Self { object: u32::MAX, primitive: u32::MAX };
}

impl Ray {
    /// A ray without end.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY, source: PrimitiveId::NONE }
    }

    /// The point at parameter `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// Many rays, one array a component, so that lanes can load them.
#[derive(Clone, Debug, Default)]
pub struct RayBatch {
    /// x, y and z of the origins.
    pub origin: [Vec<f32>; 3],
    /// x, y and z of the directions.
    pub direction: [Vec<f32>; 3],
    /// Ends, exclusive.
    pub t_max: Vec<f32>,
    /// What each ray leaves.
    pub source: Vec<PrimitiveId>,
}

impl RayBatch {
    /// No rays, with room for so many.
    pub fn with_capacity(n: usize) -> Self {
        let column = || Vec::with_capacity(n);
        Self {
            origin: [column(), column(), column()],
            direction: [column(), column(), column()],
            t_max: column(),
            source: Vec::with_capacity(n),
        }
    }

    /// Appends a ray.
    #[inline]
    pub fn push(&mut self, ray: Ray) {
        for axis in 0..3 {
            self.origin[axis].push(ray.origin[axis]);
            self.direction[axis].push(ray.direction[axis]);
        }
        self.t_max.push(ray.t_max);
        self.source.push(ray.source);
    }

    /// Appends the first rays of a block.
    #[inline]
    pub(crate) fn append(&mut self, block: &RayBlock, n: usize) {
        for axis in 0..3 {
            extend(&mut self.origin[axis], &block.origin[axis], n);
            extend(&mut self.direction[axis], &block.direction[axis], n);
        }
        extend(&mut self.t_max, &block.t_max, n);
        extend(&mut self.source, &block.source, n);
    }

    /// Overwrites the first rays of a block with `n` rays from `start` on.
    #[inline]
    pub(crate) fn copy_to(&self, start: usize, n: usize, block: &mut RayBlock) {
        for axis in 0..3 {
            copy(&self.origin[axis], start, n, &mut block.origin[axis]);
            copy(&self.direction[axis], start, n, &mut block.direction[axis]);
        }
        copy(&self.t_max, start, n, &mut block.t_max);
        copy(&self.source, start, n, &mut block.source);
    }

    /// The ray at `index`.
    #[inline(always)]
    pub fn ray(&self, index: usize) -> Ray {
        Ray {
            origin: Vec3::new(self.origin[0][index], self.origin[1][index], self.origin[2][index]),
            direction: Vec3::new(
                self.direction[0][index],
                self.direction[1][index],
                self.direction[2][index],
            ),
            t_max: self.t_max[index],
            source: self.source[index],
        }
    }

    /// Overwrites the batch with the rays of another at these places, in their order.
    pub fn gather(&mut self, from: &Self, places: &[u32]) {
        for axis in 0..3 {
            pick(&from.origin[axis], places, &mut self.origin[axis]);
            pick(&from.direction[axis], places, &mut self.direction[axis]);
        }
        pick(&from.t_max, places, &mut self.t_max);
        pick(&from.source, places, &mut self.source);
    }

    /// Number of rays.
    pub fn len(&self) -> usize {
        self.t_max.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.t_max.is_empty()
    }

    /// Forgets all rays, keeps the memory.
    pub fn clear(&mut self) {
        for axis in 0..3 {
            self.origin[axis].clear();
            self.direction[axis].clear();
        }
        self.t_max.clear();
        self.source.clear();
    }
}

#[inline]
fn pick<T: Copy>(column: &[T], places: &[u32], to: &mut Vec<T>) {
    to.clear();
    to.extend(places.iter().map(|place| column[*place as usize]));
}

/// Appends the first `n`. Whole lanes are copied without a call.
#[inline(always)]
fn extend<T: Copy>(column: &mut Vec<T>, lane: &Lane<T>, n: usize) {
    let len = column.len();
    column.extend_from_slice(lane);
    column.truncate(len + n);
}

/// Copies `n` from `start` on.
#[inline(always)]
fn copy<T: Copy>(column: &[T], start: usize, n: usize, lane: &mut Lane<T>) {
    match column[start..].first_chunk() {
        Some(whole) if n == BLOCK => *lane = *whole,
        _ => lane[..n].copy_from_slice(&column[start..start + n]),
    }
}

/// A block of rays.
#[derive(Clone, Debug)]
pub(crate) struct RayBlock {
    pub(crate) origin: Lane3,
    pub(crate) direction: Lane3,
    pub(crate) t_max: Lane<f32>,
    pub(crate) source: Lane<PrimitiveId>,
}

impl RayBlock {
    /// Rays without end, from nowhere.
    pub(crate) const IDLE: Self = Self {
        origin: NO_LANES,
        direction: NO_LANES,
        t_max: [f32::INFINITY; BLOCK],
        source: [PrimitiveId::NONE; BLOCK],
    };
}

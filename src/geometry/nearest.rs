//! The rule by which one hit is preferred to another.

use crate::math::{PrimitiveId, Ray};

/// Where a ray meets a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Parameter along the ray, above 0.
    pub t: f32,
    /// What it meets.
    pub id: PrimitiveId,
}

/// The best hit found so far: the smallest distance, of equal ones the lowest primitive.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    best: Hit,
}

impl Nearest {
    /// Nothing found yet on a ray that ends there.
    #[inline(always)]
    pub(super) fn new(t_max: f32) -> Self {
        Self { best: Hit { t: t_max, id: PrimitiveId::NONE } }
    }

    /// Considers a hit at any `t`, NaN included, of a ray that leaves `source`.
    #[inline(always)]
    pub(super) fn offer(&mut self, t: f32, id: PrimitiveId, source: PrimitiveId) {
        if !(t > 0.0 && t <= self.best.t) {
            return;
        }
        let is_better = t < self.best.t || (self.is_hit() && id < self.best.id);
        if is_better && id != source {
            self.best = Hit { t, id };
        }
    }

    /// Farther hits are of no interest; equal ones may be, of a lower primitive.
    #[inline(always)]
    pub(super) fn t(&self) -> f32 {
        self.best.t
    }

    /// Whether anything was found.
    #[inline(always)]
    pub fn is_hit(&self) -> bool {
        self.best.id != PrimitiveId::NONE
    }

    /// The best hit.
    #[inline(always)]
    pub fn hit(&self) -> Option<Hit> {
        self.is_hit().then_some(self.best)
    }
}

/// The search of one ray for its nearest hit, or for the next after one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    pub(super) nearest: Nearest,
    source: PrimitiveId,
    after: Option<(f32, PrimitiveId)>,
}

impl Search {
    /// Nothing found yet.
    pub(super) fn new(ray: &Ray) -> Self {
        Self { nearest: Nearest::new(ray.t_max), source: ray.source, after: None }
    }

    /// Goes on from what was found.
    pub(super) fn from(ray: &Ray, nearest: Nearest) -> Self {
        Self { nearest, ..Self::new(ray) }
    }

    /// Only what comes after a hit, in the order of distance, then primitive.
    pub(super) fn after(ray: &Ray, (t, id): (f32, PrimitiveId)) -> Self {
        Self { after: Some((t, id)), ..Self::new(ray) }
    }

    /// Considers a hit at any `t`, NaN included.
    #[inline]
    pub(super) fn offer(&mut self, t: f32, id: PrimitiveId) {
        let is_new = self.after.is_none_or(|(last, last_id)| {
            t > last || (t == last && id > last_id && last_id != PrimitiveId::NONE)
        });
        if is_new {
            self.nearest.offer(t, id, self.source);
        }
    }
}

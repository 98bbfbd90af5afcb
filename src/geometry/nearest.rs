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

/// The search of one ray for its nearest hit, or for all.
#[derive(Clone, Debug)]
pub(super) struct Search {
    pub(super) nearest: Nearest,
    source: PrimitiveId,
    /// Every hit so far, some of them more than once, where all are wanted.
    all: Option<Vec<Hit>>,
}

impl Search {
    /// Nothing found yet.
    pub(super) fn new(ray: &Ray) -> Self {
        Self { nearest: Nearest::new(ray.t_max), source: ray.source, all: None }
    }

    /// Goes on from what was found.
    pub(super) fn from(ray: &Ray, nearest: Nearest) -> Self {
        Self { nearest, ..Self::new(ray) }
    }

    /// For every hit; the memory may have served another search.
    pub(super) fn for_all(ray: &Ray, mut memory: Vec<Hit>) -> Self {
        memory.clear();
        Self { all: Some(memory), ..Self::new(ray) }
    }

    /// Considers a hit at any `t`, NaN included.
    #[inline]
    pub(super) fn offer(&mut self, t: f32, id: PrimitiveId) {
        match &mut self.all {
            None => self.nearest.offer(t, id, self.source),
            Some(all) => {
                if t > 0.0 && t < self.nearest.t() && id != self.source {
                    all.push(Hit { t, id });
                }
            }
        }
    }

    /// Every hit, once each, in the order of distance, then primitive.
    pub(super) fn into_all(self) -> Vec<Hit> {
        let mut all = self.all.unwrap_or_default();
        all.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        all.dedup();
        all
    }
}

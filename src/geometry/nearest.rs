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
    source: PrimitiveId,
    after: Option<(f32, PrimitiveId)>,
}

impl Nearest {
    /// Nothing found yet.
    pub fn new(ray: &Ray) -> Self {
        Self { best: Hit { t: ray.t_max, id: PrimitiveId::NONE }, source: ray.source, after: None }
    }

    /// Only what comes after a hit, in the order of distance, then primitive.
    pub fn after(ray: &Ray, (t, id): (f32, PrimitiveId)) -> Self {
        Self { after: Some((t, id)), ..Self::new(ray) }
    }

    /// Considers a hit at any `t`, NaN included.
    #[inline]
    pub fn offer(&mut self, t: f32, object: u32, primitive: u32) {
        if !(t > 0.0 && t <= self.best.t) {
            return;
        }
        let id = PrimitiveId { object, primitive };
        let is_better = t < self.best.t || (self.is_hit() && id < self.best.id);
        let is_new = self.after.is_none_or(|(last, last_id)| {
            t > last || (t == last && id > last_id && last_id != PrimitiveId::NONE)
        });
        if is_better && is_new && id != self.source {
            self.best = Hit { t, id };
        }
    }

    /// Farther hits are of no interest; equal ones may be, of a lower primitive.
    #[inline]
    pub fn t(&self) -> f32 {
        self.best.t
    }

    /// Whether anything was found.
    pub fn is_hit(&self) -> bool {
        self.best.id != PrimitiveId::NONE
    }

    /// The best hit.
    pub fn hit(&self) -> Option<Hit> {
        self.is_hit().then_some(self.best)
    }
}

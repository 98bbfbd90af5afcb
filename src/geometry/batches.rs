//! Batches of rays against all objects of a scene, one object after another.

use std::cell::RefCell;

use crate::color::Rgb;
use crate::geometry::kd_tree::Walk;
use crate::geometry::nearest::{Hit, Nearest, Search};
use crate::geometry::select::Selection;
use crate::geometry::{AcceleratorKind, Geometry, Instance};
use crate::math::{Aabb, PrimitiveId, Ray, RayBatch};

/// What a thread keeps from one batch to the next.
#[derive(Default)]
struct Work {
    selection: Selection,
    /// Of the selected rays.
    nearest: Vec<Nearest>,
    blocked: Vec<bool>,
}

thread_local! {
    static WORK: RefCell<Work> = RefCell::default();
}

impl Geometry {
    /// What each ray meets first; `nearest` is overwritten, one entry a ray.
    pub fn intersect(&self, rays: &RayBatch, nearest: &mut Vec<Nearest>) {
        nearest.clear();
        nearest.extend(rays.t_max.iter().map(|t| Nearest::new(*t)));
        WORK.with_borrow_mut(|Work { selection, nearest: theirs, .. }| {
            selection.begin();
            for id in &self.listed {
                let instance = &self.instances[*id as usize];
                let Some(bounds) = self.box_of(instance) else {
                    instance.intersect_batch(rays, *id, self.kind, nearest);
                    selection.limits.clear();
                    continue;
                };
                if selection.limits.is_empty() {
                    selection.limits.extend(nearest.iter().map(Nearest::t));
                }
                if !selection.select(rays, &bounds) {
                    continue;
                }
                theirs.clear();
                theirs.extend(selection.places.iter().map(|place| nearest[*place as usize]));
                instance.intersect_batch(&selection.rays, *id, self.kind, theirs);
                for (place, theirs) in selection.places.iter().zip(theirs.iter()) {
                    nearest[*place as usize] = *theirs;
                    selection.limits[*place as usize] = theirs.t();
                }
            }
        });
        if self.tree.is_some() {
            for (index, nearest) in nearest.iter_mut().enumerate() {
                let ray = rays.ray(index);
                let mut search = Search::from(&ray, *nearest);
                self.collect_from_tree(&ray, |_| true, &mut search);
                *nearest = search.nearest;
            }
        }
    }

    /// Whether anything lies between the ends of each ray; `blocked` is overwritten.
    pub fn occluded(&self, rays: &RayBatch, blocked: &mut Vec<bool>) {
        blocked.clear();
        blocked.resize(rays.len(), false);
        self.occluded_by(rays, |_| true, blocked);
    }

    /// The share of light that passes along each ray where some objects are clear: `clear(hit)`
    /// gives the factor of the surface that is met, or `None` where it is opaque. Factors are
    /// multiplied in order of distance, then primitive. `shares` is overwritten.
    pub fn transmittance(
        &self,
        rays: &RayBatch,
        clear: impl Fn(Hit) -> Option<Rgb>,
        is_clear: impl Fn(u32) -> bool + Copy,
        shares: &mut Vec<Rgb>,
    ) {
        let mut blocked = vec![false; rays.len()];
        self.occluded_by(rays, |object| !is_clear(object), &mut blocked);
        // Most of the others meet nothing that is clear.
        let mut is_met = blocked.clone();
        self.occluded_by(rays, is_clear, &mut is_met);
        shares.clear();
        shares.extend(blocked.iter().enumerate().map(|(i, is_blocked)| {
            if *is_blocked {
                return Rgb::ZERO;
            }
            if !is_met[i] {
                return Rgb::ONE;
            }
            let ray = rays.ray(i);
            let mut share = Rgb::ONE;
            let mut after = (0.0, PrimitiveId::NONE);
            while let Some(hit) = self.next_hit(&ray, after, is_clear) {
                let Some(factor) = clear(hit) else { return Rgb::ZERO };
                share *= factor;
                if share == Rgb::ZERO {
                    return share;
                }
                after = (hit.t, hit.id);
            }
            share
        }));
    }

    /// Whether any of the objects to take lies between the ends of each ray; those already blocked are
    /// left out.
    fn occluded_by(
        &self,
        rays: &RayBatch,
        take: impl Fn(u32) -> bool + Copy,
        blocked: &mut [bool],
    ) {
        WORK.with_borrow_mut(|Work { selection, blocked: theirs, .. }| {
            selection.begin();
            for id in self.listed.iter().filter(|id| take(**id)) {
                let instance = &self.instances[*id as usize];
                let Some(bounds) = self.box_of(instance) else {
                    instance.occluded_batch(rays, *id, self.kind, blocked);
                    selection.limits.clear();
                    continue;
                };
                if selection.limits.is_empty() {
                    let limit = |(is_blocked, t_max): (&bool, &f32)| {
                        if *is_blocked { -1.0 } else { *t_max }
                    };
                    selection.limits.extend(blocked.iter().zip(&rays.t_max).map(limit));
                }
                if !selection.select(rays, &bounds) {
                    continue;
                }
                theirs.clear();
                theirs.resize(selection.places.len(), false);
                instance.occluded_batch(&selection.rays, *id, self.kind, theirs);
                for (place, is_blocked) in selection.places.iter().zip(theirs.iter()) {
                    if *is_blocked {
                        blocked[*place as usize] = true;
                        selection.limits[*place as usize] = -1.0;
                    }
                }
            }
        });
        if self.tree.is_some() {
            for (index, blocked) in blocked.iter_mut().enumerate() {
                *blocked = *blocked || self.occluded_by_tree(&rays.ray(index), take);
            }
        }
    }

    /// What rays are held against before an object. The oracle does without, and so do one or two
    /// objects, whose own trees begin with a box anyway.
    pub(super) fn box_of(&self, instance: &Instance) -> Option<Aabb> {
        const FEW: usize = 2;
        if self.listed.len() <= FEW {
            return None;
        }
        match self.kind {
            AcceleratorKind::WideBvh | AcceleratorKind::KdTree | AcceleratorKind::KdMidpoint => {
                instance.reach()
            }
            AcceleratorKind::BruteForce => None,
        }
    }

    /// The first hit after `after` in the order of distance, then primitive.
    fn next_hit(
        &self,
        ray: &Ray,
        after: (f32, PrimitiveId),
        take: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let mut search = Search::after(ray, after);
        self.collect(ray, take, &mut search);
        search.nearest.hit()
    }

    fn collect(&self, ray: &Ray, take: impl Fn(u32) -> bool, search: &mut Search) {
        for id in self.listed.iter().copied().filter(|id| take(*id)) {
            self.instances[id as usize].intersect(ray, id, self.kind, search);
        }
        self.collect_from_tree(ray, take, search);
    }

    fn collect_from_tree(&self, ray: &Ray, take: impl Fn(u32) -> bool, search: &mut Search) {
        let Some(tree) = &self.tree else { return };
        let clipped = Ray { t_max: search.nearest.t(), ..*ray };
        let Some(walk) = Walk::new(&clipped, &tree.bounds) else { return };
        tree.walk(&walk, |range| {
            for id in tree.items[range].iter().copied().filter(|id| take(*id)) {
                self.instances[id as usize].intersect(ray, id, self.kind, search);
            }
            search.nearest.t()
        });
    }

    fn occluded_by_tree(&self, ray: &Ray, take: impl Fn(u32) -> bool) -> bool {
        let blocks = |id: u32| take(id) && self.instances[id as usize].occluded(ray, id, self.kind);
        let Some(tree) = &self.tree else { return false };
        let Some(walk) = Walk::new(ray, &tree.bounds) else { return false };
        let mut is_blocked = false;
        tree.walk(&walk, |range| {
            is_blocked |= tree.items[range].iter().any(|id| blocks(*id));
            if is_blocked { -1.0 } else { ray.t_max }
        });
        is_blocked
    }
}

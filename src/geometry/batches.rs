//! Batches of rays against all objects of a scene, branch by branch of the tree over them: each box
//! selects from the rays that came to its branch.

use std::cell::RefCell;
use std::mem;

use crate::color::Rgb;
use crate::geometry::nearest::{Hit, Nearest, Search};
use crate::geometry::object_tree::{Branch, What};
use crate::geometry::select::Selection;
use crate::geometry::{Geometry, Instance};
use crate::math::{Ray, RayBatch};

/// What a thread keeps from one batch to the next, for each level of the tree over objects.
#[derive(Default)]
struct Work {
    selection: Selection,
    order: Vec<(f32, u32)>,
    /// Of the selected rays.
    nearest: Vec<Nearest>,
    blocked: Vec<bool>,
}

thread_local! {
    static WORK: RefCell<Vec<Work>> = RefCell::default();
}

impl Geometry {
    /// What each ray meets first; `nearest` is overwritten, one entry a ray.
    pub fn intersect(&self, rays: &RayBatch, nearest: &mut Vec<Nearest>) {
        nearest.clear();
        nearest.extend(rays.t_max.iter().map(|t| Nearest::new(*t)));
        for id in &self.listed {
            self.instances[*id as usize].intersect_batch(rays, *id, self.kind, nearest);
        }
        self.with_tree(|tree, works| self.nearest_among(tree, rays, nearest, works));
    }

    /// Calls with the tree over objects, where there is one, and memory for each of its levels.
    fn with_tree(&self, call: impl FnOnce(&Branch, &mut [Work])) {
        let Some(tree) = &self.tree else { return };
        WORK.with_borrow_mut(|works| {
            let n_levels = tree.n_levels();
            if works.len() < n_levels {
                works.resize_with(n_levels, Work::default);
            }
            call(tree, works);
        });
    }

    /// What each ray meets first of a branch, or has met before.
    fn nearest_among(
        &self,
        branch: &Branch,
        rays: &RayBatch,
        nearest: &mut [Nearest],
        works: &mut [Work],
    ) {
        let Some((Work { selection, order, nearest: theirs, .. }, deeper)) =
            works.split_first_mut()
        else {
            unreachable!("there is memory for every level");
        };
        selection.begin(nearest.iter().map(Nearest::t));
        for member in branch.in_order(rays, order) {
            if !selection.select(rays, &member.bounds) {
                continue;
            }
            theirs.clear();
            theirs.extend(selection.places.iter().map(|place| nearest[*place as usize]));
            match &member.what {
                What::Object(id) => {
                    let instance = &self.instances[*id as usize];
                    instance.intersect_batch(&selection.rays, *id, self.kind, theirs);
                }
                What::Branch(branch) => {
                    self.nearest_among(branch, &selection.rays, theirs, deeper);
                }
            }
            for (place, theirs) in selection.places.iter().zip(theirs.iter()) {
                nearest[*place as usize] = *theirs;
                selection.limits[*place as usize] = theirs.t();
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
        let mut hits = Vec::new();
        shares.extend(blocked.iter().enumerate().map(|(i, is_blocked)| {
            if *is_blocked {
                return Rgb::ZERO;
            }
            if !is_met[i] {
                return Rgb::ONE;
            }
            let ray = rays.ray(i);
            let mut search = Search::for_all(&ray, mem::take(&mut hits));
            self.visit(&ray, is_clear, &mut || (), |id, instance| {
                instance.intersect(&ray, id, self.kind, &mut search);
                ray.t_max
            });
            hits = search.into_all();
            let mut share = Rgb::ONE;
            for hit in &hits {
                let Some(factor) = clear(*hit) else { return Rgb::ZERO };
                share *= factor;
                if share == Rgb::ZERO {
                    break;
                }
            }
            share
        }));
    }

    /// Hands every object to take that a ray may meet to `visit`, about as the ray comes to them.
    /// `visit` returns the parameter up to which the ray is still of interest; `enter` is told of
    /// every box.
    pub(super) fn visit(
        &self,
        ray: &Ray,
        take: impl Fn(u32) -> bool,
        enter: &mut impl FnMut(),
        mut visit: impl FnMut(u32, &Instance) -> f32,
    ) {
        let mut ray = *ray;
        let mut visit = |id: u32, t_max: f32| {
            if take(id) { visit(id, &self.instances[id as usize]) } else { t_max }
        };
        for id in &self.listed {
            ray.t_max = visit(*id, ray.t_max);
        }
        if let Some(tree) = &self.tree {
            tree.walk(&mut ray, enter, &mut visit);
        }
    }

    /// Whether any of the objects to take lies between the ends of each ray; those already blocked are
    /// left out.
    fn occluded_by(
        &self,
        rays: &RayBatch,
        take: impl Fn(u32) -> bool + Copy,
        blocked: &mut [bool],
    ) {
        for id in self.listed.iter().filter(|id| take(**id)) {
            self.instances[*id as usize].occluded_batch(rays, *id, self.kind, blocked);
        }
        self.with_tree(|tree, works| self.occluded_among(tree, rays, take, blocked, works));
    }

    /// [`Geometry::occluded_by`] what a branch holds.
    fn occluded_among(
        &self,
        branch: &Branch,
        rays: &RayBatch,
        take: impl Fn(u32) -> bool + Copy,
        blocked: &mut [bool],
        works: &mut [Work],
    ) {
        let Some((Work { selection, order, blocked: theirs, .. }, deeper)) =
            works.split_first_mut()
        else {
            unreachable!("there is memory for every level");
        };
        let limit = |(is_blocked, t_max): (&bool, &f32)| if *is_blocked { -1.0 } else { *t_max };
        selection.begin(blocked.iter().zip(&rays.t_max).map(limit));
        for member in branch.in_order(rays, order) {
            if matches!(member.what, What::Object(id) if !take(id))
                || !selection.select(rays, &member.bounds)
            {
                continue;
            }
            theirs.clear();
            theirs.resize(selection.places.len(), false);
            match &member.what {
                What::Object(id) => {
                    let instance = &self.instances[*id as usize];
                    instance.occluded_batch(&selection.rays, *id, self.kind, theirs);
                }
                What::Branch(branch) => {
                    self.occluded_among(branch, &selection.rays, take, theirs, deeper);
                }
            }
            for (place, is_blocked) in selection.places.iter().zip(theirs.iter()) {
                if *is_blocked {
                    blocked[*place as usize] = true;
                    selection.limits[*place as usize] = -1.0;
                }
            }
        }
    }
}

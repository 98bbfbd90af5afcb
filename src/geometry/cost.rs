//! What finding the first hit takes: counted one ray at a time, beside the fast paths.
//!
//! The counts are those of a single ray in portable arithmetic, so that they are the same on every
//! machine; packets share part of the work.

use crate::geometry::kd_tree::Walk;
use crate::geometry::nearest::Search;
use crate::geometry::{Geometry, Hit};
use crate::math::Ray;

/// Work done for one ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TraversalCost {
    /// Nodes of trees that the ray came to, and boxes of objects that it was held against.
    pub n_nodes: u32,
    /// Triangles and solids that it was tested against.
    pub n_primitives: u32,
}

impl TraversalCost {
    /// Nodes and tests together.
    pub fn total(self) -> u32 {
        self.n_nodes + self.n_primitives
    }
}

impl Geometry {
    /// What a ray meets first, as [`Geometry::intersect`] finds it, and what that takes.
    pub fn intersect_counted(&self, ray: &Ray) -> (Option<Hit>, TraversalCost) {
        let mut search = Search::new(ray);
        let mut cost = TraversalCost::default();
        for id in &self.listed {
            let instance = &self.instances[*id as usize];
            if let Some(bounds) = self.box_of(instance) {
                cost.n_nodes += 1;
                let clipped = Ray { t_max: search.nearest.t(), ..*ray };
                if Walk::new(&clipped, &bounds).is_none() {
                    continue;
                }
            }
            instance.intersect_counted(ray, *id, self.kind, &mut search, &mut cost);
        }
        let clipped = Ray { t_max: search.nearest.t(), ..*ray };
        if let Some(tree) = &self.tree
            && let Some(walk) = Walk::new(&clipped, &tree.bounds)
        {
            let mut n_entered = 0;
            tree.walk_counting(
                &walk,
                || n_entered += 1,
                |range| {
                    for id in &tree.items[range] {
                        let instance = &self.instances[*id as usize];
                        instance.intersect_counted(ray, *id, self.kind, &mut search, &mut cost);
                    }
                    search.nearest.t()
                },
            );
            cost.n_nodes += n_entered;
        }
        (search.nearest.hit(), cost)
    }
}

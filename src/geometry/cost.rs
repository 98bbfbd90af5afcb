//! What finding the first hit takes: counted one ray at a time, beside the fast paths.
//!
//! The counts are those of a single ray in portable arithmetic, so that they are the same on every
//! machine; packets share part of the work.

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
        let mut n_boxes = 0;
        self.visit(
            ray,
            |_| true,
            &mut || n_boxes += 1,
            |id, instance| {
                instance.intersect_counted(ray, id, self.kind, &mut search, &mut cost);
                search.nearest.t()
            },
        );
        cost.n_nodes += n_boxes;
        (search.nearest.hit(), cost)
    }
}

//! What can be had beside a picture: maps with one value a pixel, made when a view asks for them.

use std::sync::Arc;

use crate::geometry::TraversalCost;
use crate::render::{Feature, PixelMap, RenderJob, Sampling};

/// Which maps somebody looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// First hits.
    pub features: bool,
    /// What finding them costs.
    pub costs: bool,
    /// Samples and error.
    pub sampling: bool,
}

impl Wanted {
    /// No maps at all.
    pub const NOTHING: Self = Self { features: false, costs: false, sampling: false };

    /// What one of the two wants.
    pub fn and(self, other: Self) -> Self {
        Self {
            features: self.features || other.features,
            costs: self.costs || other.costs,
            sampling: self.sampling || other.sampling,
        }
    }

    /// Whether all of `other` is wanted here.
    pub fn covers(self, other: Self) -> bool {
        (self.features || !other.features)
            && (self.costs || !other.costs)
            && (self.sampling || !other.sampling)
    }
}

/// The maps of a job. A coarse one is there first, as with pictures; its size tells.
#[derive(Clone, Debug, Default)]
pub struct Maps {
    /// First hits.
    pub features: Option<Arc<PixelMap<Feature>>>,
    /// What finding them costs.
    pub costs: Option<Arc<PixelMap<TraversalCost>>>,
    /// Samples and error of the picture beside it.
    pub sampling: Option<Arc<PixelMap<Sampling>>>,
}

impl Maps {
    /// What of `wanted` a first, coarse map would show.
    pub(super) fn absent(&self, wanted: Wanted) -> Wanted {
        Wanted {
            features: wanted.features && self.features.is_none(),
            costs: wanted.costs && self.costs.is_none(),
            sampling: false,
        }
    }

    /// What of `wanted` is not there in a job's full size.
    pub(super) fn unfinished(&self, wanted: Wanted, job: &RenderJob) -> Wanted {
        let size = (job.width, job.height);
        let has_features =
            self.features.as_ref().is_some_and(|map| (map.width, map.height) == size);
        let has_costs = self.costs.as_ref().is_some_and(|map| (map.width, map.height) == size);
        Wanted {
            features: wanted.features && !has_features,
            costs: wanted.costs && !has_costs,
            sampling: wanted.sampling && self.sampling.is_none(),
        }
    }
}

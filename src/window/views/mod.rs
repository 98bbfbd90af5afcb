//! What the viewport can show of a scene beside its picture. A view is a display setting: changing
//! it restarts nothing.

mod false_color;
mod legend;
mod scale;

use crate::session::{Frame, Wanted};
use std::sync::Arc;

pub(super) use false_color::paint;
pub(super) use legend::{Legend, legend_ui};

/// What is shown of each pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum View {
    /// Its light.
    #[default]
    Picture,
    /// What its surface reflects.
    Albedo,
    /// Where its surface faces.
    Normals,
    /// How far away it is.
    Depth,
    /// How wide its blur is.
    Blur,
    /// What finding it costs.
    Cost,
    /// How many samples it has.
    Samples,
    /// How far from the truth it is.
    Noise,
}

impl View {
    /// All of them, in the order of their keys.
    pub(super) const ALL: [Self; 8] = [
        Self::Picture,
        Self::Albedo,
        Self::Normals,
        Self::Depth,
        Self::Blur,
        Self::Cost,
        Self::Samples,
        Self::Noise,
    ];

    /// As lists call it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Picture => "Picture",
            Self::Albedo => "Albedo",
            Self::Normals => "Normals",
            Self::Depth => "Depth",
            Self::Blur => "Circle of confusion",
            Self::Cost => "Traversal cost",
            Self::Samples => "Sample count",
            Self::Noise => "Noise",
        }
    }

    /// The maps it is made of.
    pub(super) fn wanted(self) -> Wanted {
        let features = Wanted { features: true, ..Wanted::NOTHING };
        match self {
            Self::Picture => Wanted::NOTHING,
            Self::Albedo | Self::Normals | Self::Depth | Self::Blur => features,
            Self::Cost => Wanted { costs: true, ..Wanted::NOTHING },
            Self::Samples | Self::Noise => Wanted { sampling: true, ..Wanted::NOTHING },
        }
    }

    /// Whether two frames look the same in this view. The picture is not asked for.
    pub(super) fn same(self, one: &Arc<Frame>, other: &Arc<Frame>) -> bool {
        fn same_map<T>(one: &Option<Arc<T>>, other: &Option<Arc<T>>) -> bool {
            one.as_ref().zip(other.as_ref()).is_some_and(|(one, other)| Arc::ptr_eq(one, other))
        }
        let same_features = || same_map(&one.maps.features, &other.maps.features);
        match self {
            Self::Picture => Arc::ptr_eq(one, other),
            Self::Albedo | Self::Normals | Self::Depth => same_features(),
            Self::Blur => same_features() && one.job.scene.camera == other.job.scene.camera,
            Self::Cost => same_map(&one.maps.costs, &other.maps.costs),
            Self::Samples | Self::Noise => same_map(&one.maps.sampling, &other.maps.sampling),
        }
    }
}

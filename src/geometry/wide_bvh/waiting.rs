//! Places of the tree where rays of a packet wait to go: together, or alone later.

use crate::geometry::lanes::Lanes;
use crate::geometry::wide_bvh::WideBvh;
use crate::geometry::wide_bvh::descent::{STARTS, Start};
use crate::geometry::wide_bvh::group::LANES;
use crate::geometry::wide_bvh::packet::GROUPS;
use crate::geometry::wide_bvh::stream::Fleet;

/// Seven children a level may wait; the builder keeps the tree below 22 levels.
const STACK: usize = 160;

/// Rays of a group that go on alone from some places.
pub(super) struct Stragglers {
    n: [u8; LANES],
    starts: [[Start; STARTS]; LANES],
}

impl Stragglers {
    pub(super) const NONE: Self =
        Self { n: [0; LANES], starts: [[Start { reference: 0, enter: 0.0 }; STARTS]; LANES] };

    /// Notes a place for some rays; gives those that have too many already, who begin again at the
    /// root.
    #[inline(always)]
    pub(super) fn add<F: Lanes>(&mut self, rays: u32, entered: F, reference: u32) -> u32 {
        let mut enters = [0.0; LANES];
        entered.store(&mut enters);
        let mut left = rays;
        let mut lost = 0;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            match self.starts[lane].get_mut(usize::from(self.n[lane])) {
                Some(start) => *start = Start { reference, enter: enters[lane] },
                None => lost |= 1 << lane,
            }
            self.n[lane] += 1;
        }
        lost
    }

    /// Lets them wait for the stream; `first` is the place of the group in its batch.
    #[inline(always)]
    pub(super) fn hand_over(&mut self, bvh: &WideBvh, first: usize, fleet: &mut Fleet) {
        for (lane, n) in self.n.iter_mut().enumerate() {
            match self.starts[lane].get(..usize::from(*n)) {
                Some([]) => {}
                Some(starts) => fleet.push(first + lane, starts),
                None => fleet.push(first + lane, &[bvh.start()]),
            }
            *n = 0;
        }
    }
}

/// A place that waits, with the parameter at which it is entered, the groups that go there, and which
/// of their rays.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    pub(super) reference: u32,
    pub(super) enter: f32,
    pub(super) groups: u32,
    pub(super) rays: [u16; GROUPS],
}

impl Entry {
    const NONE: Self = Self { reference: 0, enter: 0.0, groups: 0, rays: [0; GROUPS] };
}

/// Places that wait, the next on top.
pub(super) struct Stack {
    entries: [Entry; STACK],
    pub(super) n: usize,
}

impl Stack {
    pub(super) const EMPTY: Self = Self { entries: [Entry::NONE; STACK], n: 0 };

    /// Keeps what lies above `base` in order, the nearest on top.
    #[inline(always)]
    pub(super) fn insert(&mut self, base: usize, entry: Entry) {
        let mut place = self.n;
        while place > base && self.entries[place - 1].enter < entry.enter {
            self.entries[place] = self.entries[place - 1];
            place -= 1;
        }
        self.entries[place] = entry;
        self.n += 1;
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Entry> {
        self.n = self.n.checked_sub(1)?;
        Some(self.entries[self.n])
    }
}

//! Which paths of a wave have met the same material of the same object: those are shaded together.

use std::ops::Range;

use crate::geometry::Hit;
use crate::render::world::World;

/// The paths of a wave by what they have met, each group in the order of the wave.
#[derive(Default)]
pub(super) struct Groups {
    /// For each material slot of the world, how many paths there are, and later where they go. Zeros
    /// between waves.
    counts: Vec<u32>,
    /// Path and number, in the order of the wave.
    met: Vec<(u32, u32)>,
    /// Numbers that were met, in the order of their first path.
    seen: Vec<u32>,
    /// Paths, group by group.
    order: Vec<u32>,
    /// Where the next group starts.
    start: usize,
}

impl Groups {
    pub(super) fn new(world: &World) -> Self {
        Self { counts: vec![0; world.slots.len()], ..Self::default() }
    }

    /// Forgets all paths.
    pub(super) fn clear(&mut self) {
        self.met.clear();
        self.seen.clear();
    }

    /// Takes a path and what it has met.
    pub(super) fn push(&mut self, world: &World, path: u32, hit: Hit) {
        let number = world.slot_number(hit);
        let count = &mut self.counts[number as usize];
        if *count == 0 {
            self.seen.push(number);
        }
        *count += 1;
        self.met.push((path, number));
    }

    /// Puts the paths in order.
    pub(super) fn sort(&mut self) {
        let mut start = 0;
        for number in &self.seen {
            let count = &mut self.counts[*number as usize];
            (*count, start) = (start, start + *count);
        }
        self.start = 0;
        self.order.clear();
        self.order.resize(self.met.len(), 0);
        for (path, number) in &self.met {
            let place = &mut self.counts[*number as usize];
            self.order[*place as usize] = *path;
            *place += 1;
        }
    }

    /// The number of groups.
    pub(super) fn len(&self) -> usize {
        self.seen.len()
    }

    /// Number of a group's slot, and where its paths are in the order; for each once, in turn.
    pub(super) fn take(&mut self, group: usize) -> (usize, Range<usize>) {
        let number = self.seen[group] as usize;
        let end = std::mem::take(&mut self.counts[number]) as usize;
        let start = self.start;
        self.start = end;
        (number, start..end)
    }

    /// A path by its place in the order.
    pub(super) fn path(&self, place: usize) -> u32 {
        self.order[place]
    }
}

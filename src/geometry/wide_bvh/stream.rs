//! Rays that go their own ways, several at once.
//!
//! A single ray spends its time waiting: for memory, and for the outcome of a test before it knows
//! which node comes next. So a few rays are kept under way; each makes one step in turn, and what
//! it needs for the next is fetched while the others make theirs.

use crate::geometry::lanes::Isa;
use crate::geometry::nearest::Nearest;
use crate::geometry::wide_bvh::descent::{DONE, Descent, Start};
use crate::geometry::wide_bvh::{LEAF, WideBvh};
use crate::math::{PrimitiveId, RayBatch};

/// Rays under way at a time.
const FLEET: usize = 32;

/// What is done with hits. A trait rather than a closure: its methods are inlined for certain, into
/// code compiled for the registers that it uses.
pub(super) trait Take {
    /// Whether nearer hits matter more than others; otherwise any will do.
    const SORTED: bool;
    /// Up to where hits of a ray are of interest at first, below 0 if none is.
    fn limit(&self, ray: usize) -> f32;
    /// Takes a hit at a parameter above 0 and gives the new limit, below 0 to be done.
    fn take(&mut self, ray: usize, t: f32, primitive: u32) -> f32;
}

/// Keeps the nearest hits.
pub(super) struct TakeNearest<'a> {
    pub(super) nearest: &'a mut [Nearest],
    pub(super) source: &'a [PrimitiveId],
    pub(super) object: u32,
}

impl Take for TakeNearest<'_> {
    const SORTED: bool = true;

    #[inline(always)]
    fn limit(&self, ray: usize) -> f32 {
        self.nearest[ray].t()
    }
    #[inline(always)]
    fn take(&mut self, ray: usize, t: f32, primitive: u32) -> f32 {
        let id = PrimitiveId { object: self.object, primitive };
        self.nearest[ray].offer(t, id, self.source[ray]);
        self.nearest[ray].t()
    }
}

/// Tells which rays are blocked.
pub(super) struct TakeAny<'a> {
    pub(super) blocked: &'a mut [bool],
    pub(super) t_max: &'a [f32],
    pub(super) source: &'a [PrimitiveId],
    pub(super) object: u32,
}

impl Take for TakeAny<'_> {
    const SORTED: bool = false;

    #[inline(always)]
    fn limit(&self, ray: usize) -> f32 {
        if self.blocked[ray] { -1.0 } else { self.t_max[ray] }
    }
    #[inline(always)]
    fn take(&mut self, ray: usize, t: f32, primitive: u32) -> f32 {
        let id = PrimitiveId { object: self.object, primitive };
        if t < self.t_max[ray] && id != self.source[ray] {
            self.blocked[ray] = true;
            return -1.0;
        }
        self.t_max[ray]
    }
}

/// Places for rays under way, kept between batches.
pub(super) struct Fleet {
    descents: [Descent; FLEET],
    /// Rays of the batch that wait for a place.
    waiting: Vec<Waiting>,
    /// Where they begin.
    starts: Vec<Start>,
}

/// A ray of the batch and where it begins: a range of [`Fleet::starts`].
struct Waiting {
    ray: u32,
    first: u32,
    n: u32,
}

impl Fleet {
    pub(super) const IDLE: Self = Self {
        descents: [const { Descent::IDLE }; FLEET],
        waiting: Vec::new(),
        starts: Vec::new(),
    };

    /// Lets a ray of the batch wait, with the places where it begins: 1 to [`STARTS`].
    #[inline(always)]
    pub(super) fn push(&mut self, ray: usize, starts: &[Start]) {
        let first = self.starts.len() as u32;
        self.starts.extend_from_slice(starts);
        self.waiting.push(Waiting { ray: ray as u32, first, n: starts.len() as u32 });
    }

    /// A place for one ray, while no others are under way.
    #[inline(always)]
    pub(super) fn single(&mut self) -> &mut Descent {
        &mut self.descents[0]
    }

    /// Forgets the rays that waited.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.waiting.clear();
        self.starts.clear();
    }
}

/// Which of the fleet are at nodes, at blocks, or done.
#[derive(Clone, Copy)]
struct Lists {
    at_node: List,
    at_block: List,
    done: List,
}

#[derive(Clone, Copy)]
struct List {
    members: [u8; FLEET],
    n: usize,
}

impl List {
    const EMPTY: Self = Self { members: [0; FLEET], n: 0 };

    /// Appends a member if it belongs here, without a branch.
    #[inline(always)]
    fn push_if(&mut self, member: usize, belongs: bool) {
        self.members[self.n % FLEET] = member as u8;
        self.n += usize::from(belongs);
    }

    #[inline(always)]
    fn members(&self) -> &[u8] {
        &self.members[..self.n.min(FLEET)]
    }
}

impl Lists {
    const EMPTY: Self = Self { at_node: List::EMPTY, at_block: List::EMPTY, done: List::EMPTY };

    #[inline(always)]
    fn push(&mut self, member: usize, current: u32) {
        self.at_node.push_if(member, current & LEAF == 0);
        self.at_block.push_if(member, current & LEAF != 0 && current != DONE);
        self.done.push_if(member, current == DONE);
    }
}

/// Traces the rays of a batch that wait.
#[inline(always)]
pub(super) fn trace<I: Isa, T: Take>(
    bvh: &WideBvh,
    rays: &RayBatch,
    fleet: &mut Fleet,
    hits: &mut T,
) {
    let mut next = 0;
    let mut ray_of = [0; FLEET];
    let mut lists = Lists::EMPTY;
    for member in 0..FLEET {
        lists.done.push_if(member, true);
    }
    loop {
        let now = lists;
        lists = Lists::EMPTY;
        for member in now.at_node.members() {
            let current = fleet.descents[usize::from(*member)].current;
            I::prefetch(&bvh.nodes[current as usize]);
        }
        for member in now.at_block.members() {
            let current = fleet.descents[usize::from(*member)].current;
            I::prefetch(&bvh.blocks[(current & !LEAF) as usize]);
        }
        for member in now.done.members() {
            let member = usize::from(*member);
            while let Some(waiting) = fleet.waiting.get(next) {
                let ray = waiting.ray as usize;
                let limit = hits.limit(ray);
                next += 1;
                if limit < 0.0 {
                    continue;
                }
                let starts = &fleet.starts[waiting.first as usize..][..waiting.n as usize];
                let descent = &mut fleet.descents[member];
                descent.go_on::<T>(bvh, &rays.ray(ray), limit, starts);
                if descent.current != DONE {
                    ray_of[member] = ray;
                    lists.push(member, descent.current);
                    break;
                }
            }
        }
        for member in now.at_node.members() {
            let member = usize::from(*member);
            let descent = &mut fleet.descents[member];
            descent.enter::<I, T>(&bvh.nodes[descent.current as usize]);
            lists.push(member, descent.current);
        }
        for member in now.at_block.members() {
            let member = usize::from(*member);
            let descent = &mut fleet.descents[member];
            descent.visit::<I, T>(bvh, ray_of[member], hits);
            lists.push(member, descent.current);
        }
        if lists.at_node.n + lists.at_block.n + lists.done.n == 0 {
            return;
        }
    }
}

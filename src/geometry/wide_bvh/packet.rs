//! Packets of rays through the tree.
//!
//! Up to four groups of sixteen rays that go about the same way share a traversal: an interval of
//! their origins and reciprocal directions is tested against eight boxes at once, the boxes that
//! remain against the rays themselves, a group at a time, and only groups of which a ray touches a
//! box go on with it. A triangle is tested against sixteen rays, or, where few touch the box of a
//! large mesh's block, four rays against its four triangles at once. Rays that begin near each other
//! and part soon go together as far as several of them touch the same boxes; from there on they are
//! left to [`stream`]. Packets count what they cost and spare, so that rays go alone where that is
//! less, as among leaves of a tree or long beams.
//!
//! Source: S. Boulos, I. Wald and C. Benthin, "Adaptive Ray Packet Reordering", IEEE RT 2008, for
//! interval tests of packets.

use crate::geometry::lanes::{Isa, Lanes};
use crate::geometry::wide_bvh::group::{Group, LANES};
use crate::geometry::wide_bvh::sharing::{Share, Sharing, Toll};
use crate::geometry::wide_bvh::stream::{self, Fleet, Take, TakeAny, TakeNearest};
use crate::geometry::wide_bvh::waiting::{Entry, Stack, Stragglers};
use crate::geometry::wide_bvh::{Block, LEAF, Node, WIDTH, WideBvh};
use crate::math::RayBatch;

/// Groups of a packet.
pub(super) const GROUPS: usize = 4;

/// The nearest hit of every ray of a batch.
#[inline(always)]
pub(super) fn nearest<I: Isa>(
    bvh: &WideBvh,
    rays: &RayBatch,
    fleet: &mut Fleet,
    hits: &mut TakeNearest<'_>,
) {
    trace::<I, _>(bvh, rays, fleet, hits);
}

/// Which rays of a batch are blocked; those that are already are left out.
#[inline(always)]
pub(super) fn blocked<I: Isa>(
    bvh: &WideBvh,
    rays: &RayBatch,
    fleet: &mut Fleet,
    hits: &mut TakeAny<'_>,
) {
    trace::<I, _>(bvh, rays, fleet, hits);
}

/// Traces all rays of a batch, together where they go together.
#[inline(always)]
fn trace<I: Isa, T: Take>(bvh: &WideBvh, rays: &RayBatch, fleet: &mut Fleet, hits: &mut T) {
    let mut packet = Packet::<I>::idle();
    let mut sharing = Sharing::new::<T>(bvh.blocks.len());
    fleet.clear();
    let mut first = 0;
    while first < rays.len() {
        let Share { n, n_alone } = sharing.next::<I>(rays, first);
        if n_alone < LANES {
            packet.start(bvh, rays, first, n, hits);
            packet.n_alone = n_alone;
            if bvh.is_far() {
                packet.walk::<T, true>(bvh, hits);
            } else {
                packet.walk::<T, false>(bvh, hits);
            }
            packet.stragglers.hand_over(bvh, first, fleet);
            sharing.learn(packet.toll);
        } else {
            (first..first + n).for_each(|ray| fleet.push(ray, &[bvh.start()]));
        }
        first += n;
    }
    stream::trace::<I, T>(bvh, rays, fleet, hits);
}

/// Groups that go together.
struct Packet<I: Isa> {
    groups: [Group<I>; GROUPS],
    n_groups: usize,
    /// The place of the first ray in its batch.
    first: usize,
    farthest: f32,
    /// Interval test along each axis; none where directions differ in their sign.
    intervals: [Option<Interval>; 3],
    /// In a packet of one group, so few rays that touch a box go there alone.
    n_alone: usize,
    stragglers: Stragglers,
    stack: Stack,
    /// Of the packet under way.
    toll: Toll,
}

/// Bounds of a packet's reciprocal directions and origins along one axis, all directions having the
/// same sign there.
#[derive(Clone, Copy)]
struct Interval {
    /// Rows of the near and far planes.
    near: usize,
    far: usize,
    /// Least and greatest reciprocal.
    reciprocals: [f32; 2],
    /// The same times the origin that makes the near parameter least, and the far one greatest.
    near_origin: [f32; 2],
    far_origin: [f32; 2],
}

impl<I: Isa> Packet<I> {
    /// No rays.
    #[inline(always)]
    fn idle() -> Self {
        Self {
            groups: [Group::idle(), Group::idle(), Group::idle(), Group::idle()],
            n_groups: 0,
            first: 0,
            farthest: -1.0,
            intervals: [None; 3],
            n_alone: 0,
            stragglers: Stragglers::NONE,
            stack: Stack::EMPTY,
            toll: Toll::default(),
        }
    }

    /// Takes on the rays `first..first + n` of a batch.
    #[inline(always)]
    fn start<T: Take>(&mut self, bvh: &WideBvh, rays: &RayBatch, first: usize, n: usize, hits: &T) {
        self.n_groups = n.div_ceil(LANES);
        self.first = first;
        self.farthest = -1.0;
        // Alone, each would ask the root.
        self.toll = Toll { paid: 0, spared: n as u32 };
        for (index, group) in self.groups[..self.n_groups].iter_mut().enumerate() {
            let offset = index * LANES;
            let mut limits = [-1.0; LANES];
            for (lane, limit) in limits.iter_mut().enumerate().take(n - offset) {
                *limit = hits.limit(first + offset + lane);
            }
            group.start(bvh, rays, first + offset, n - offset, &limits);
            self.farthest = self.farthest.max(group.farthest);
        }
        for axis in 0..3 {
            self.intervals[axis] = self.interval(axis);
        }
    }

    /// What the box tests along an axis have in common, if the directions have their sign.
    #[inline(always)]
    fn interval(&self, axis: usize) -> Option<Interval> {
        let [first, others @ ..] = &self.groups[..self.n_groups] else { return None };
        let is_negative = first.negative[axis] != 0;
        let (mut least, mut greatest) = (first.reciprocal[axis], first.reciprocal[axis]);
        let low_of = |group: &Group<I>| group.aim.origin[axis].sub(group.pad);
        let high_of = |group: &Group<I>| group.aim.origin[axis].add(group.pad);
        let (mut low, mut high) = (low_of(first), high_of(first));
        let mut are_negative = first.negative[axis];
        for group in others {
            if (group.negative[axis] != 0) != is_negative {
                return None;
            }
            are_negative &= group.negative[axis];
            least = least.min(group.reciprocal[axis]);
            greatest = greatest.max(group.reciprocal[axis]);
            low = low.min(low_of(group));
            high = high.max(high_of(group));
        }
        if is_negative && are_negative != I::F16::ALL {
            return None;
        }
        let reciprocals = [least.least(), greatest.greatest()];
        let (low, high) = (low.least(), high.greatest());
        let (near, far) = if is_negative { (axis + 3, axis) } else { (axis, axis + 3) };
        // The near plane is met first from the origin farthest along the direction.
        let (foremost, hindmost) = if is_negative { (low, high) } else { (high, low) };
        Some(Interval {
            near,
            far,
            reciprocals,
            near_origin: [reciprocals[0] * foremost, reciprocals[1] * foremost],
            far_origin: [reciprocals[0] * hindmost, reciprocals[1] * hindmost],
        })
    }

    /// Takes the hits of all rays. Trees that are `FAR` from the processor are fetched ahead, and their
    /// triangles, small beside a group, tested against the rays that touch their box.
    #[inline(always)]
    fn walk<T: Take, const FAR: bool>(&mut self, bvh: &WideBvh, hits: &mut T) {
        let groups = (1 << self.n_groups) - 1;
        let mut current =
            Entry { reference: bvh.root, enter: 0.0, groups, rays: [u16::MAX; GROUPS] };
        self.stack.n = 0;
        loop {
            while current.reference & LEAF == 0 {
                let node = &bvh.nodes[current.reference as usize];
                match self.enter::<FAR>(bvh, node, current.groups) {
                    Some(nearest) => current = nearest,
                    None => break,
                }
            }
            if current.reference & LEAF != 0 {
                let block = &bvh.blocks[(current.reference & !LEAF) as usize];
                if self.visit::<T, FAR>(block, &current, hits) && self.farthest < 0.0 {
                    return;
                }
            }
            loop {
                let Some(entry) = self.stack.pop() else { return };
                if entry.enter <= self.farthest {
                    current = entry;
                    break;
                }
            }
        }
    }

    /// The nearest of the children that some ray touches; the others go onto the stack.
    #[inline(always)]
    fn enter<const FAR: bool>(&mut self, bvh: &WideBvh, node: &Node, groups: u32) -> Option<Entry> {
        let (mut enter, mut leave) = (I::F8::splat(0.0), I::F8::splat(self.farthest));
        for interval in &self.intervals {
            let Some(interval) = interval else { continue };
            let near = I::row(&node.bounds, interval.near);
            let far = I::row(&node.bounds, interval.far);
            let least = I::F8::splat(interval.reciprocals[0]);
            let greatest = I::F8::splat(interval.reciprocals[1]);
            let near_least = near.mul_sub(least, I::F8::splat(interval.near_origin[0]));
            let near_greatest = near.mul_sub(greatest, I::F8::splat(interval.near_origin[1]));
            enter = near_least.min(near_greatest).max(enter);
            let far_least = far.mul_sub(least, I::F8::splat(interval.far_origin[0]));
            let far_greatest = far.mul_sub(greatest, I::F8::splat(interval.far_origin[1]));
            leave = far_least.max(far_greatest).min(leave);
        }
        let mut left = enter.le(leave) & ((1 << node.n_children) - 1);
        let mut enters = [0.0; WIDTH];
        enter.store(&mut enters);
        let base = self.stack.n;
        self.toll.paid += left.count_ones() * groups.count_ones();
        while left != 0 {
            let child = left.trailing_zeros() as usize;
            left &= left - 1;
            let reference = node.children[child];
            let (mut touching, mut rays) = (0, [0; GROUPS]);
            let mut asked = groups;
            while asked != 0 {
                let group = asked.trailing_zeros() as usize % GROUPS;
                asked &= asked - 1;
                let (touch, entered) = self.groups[group].touches(node, child);
                if FAR {
                    rays[group] = touch as u16;
                }
                let n = touch.count_ones() as usize;
                if n > self.n_alone {
                    touching |= 1 << group;
                    self.toll.spared += n as u32;
                } else if n > 0 {
                    let lost = self.stragglers.add(touch, entered, reference);
                    if lost != 0 {
                        self.groups[group].dismiss(lost);
                    }
                }
            }
            if touching != 0 {
                if FAR || self.n_alone > 0 {
                    bvh.prefetch::<I>(reference);
                }
                self.stack.insert(
                    base,
                    Entry { reference, enter: enters[child], groups: touching, rays },
                );
            }
        }
        if self.stack.n == base { None } else { self.stack.pop() }
    }

    /// Tests the triangles of a block; tells whether a limit changed.
    #[inline(always)]
    fn visit<T: Take, const FAR: bool>(
        &mut self,
        block: &Block,
        entry: &Entry,
        hits: &mut T,
    ) -> bool {
        let mut left = entry.groups;
        let mut is_changed = false;
        self.toll.paid += left.count_ones() * block.n_triangles();
        while left != 0 {
            let index = left.trailing_zeros() as usize % GROUPS;
            left &= left - 1;
            let group = &mut self.groups[index];
            let rays = if FAR { u32::from(entry.rays[index]) } else { I::F16::ALL };
            if group.visit(block, rays, self.first + index * LANES, hits) {
                group.farthest = group.limit.greatest();
                is_changed = true;
            }
        }
        if is_changed {
            self.farthest = -1.0;
            for group in &self.groups[..self.n_groups] {
                self.farthest = self.farthest.max(group.farthest);
            }
        }
        is_changed
    }
}

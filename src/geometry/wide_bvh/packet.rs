//! Packets of rays through the tree.
//!
//! Sixteen rays that go about the same way share a traversal: an interval of their origins and
//! reciprocal directions is tested against eight boxes at once, the boxes that remain against the
//! sixteen rays themselves, and each triangle against sixteen rays. Rays that do not go together are
//! traced one by one.
//!
//! Source: S. Boulos, I. Wald and C. Benthin, "Adaptive Ray Packet Reordering", IEEE RT 2008, for
//! interval tests of packets.

use crate::geometry::Nearest;
use crate::geometry::lanes::{Isa, Lanes};
use crate::geometry::triangle::Axes;
use crate::geometry::wide_bvh::single::{self, Candidates, Stack, sheared};
use crate::geometry::wide_bvh::{BLOCK, Block, BoxRay, LEAF, Node, WIDTH, WideBvh};
use crate::math::RayBatch;

/// Rays of a packet.
const LANES: usize = 16;

/// The nearest hit of every ray of a batch.
#[inline(always)]
pub(super) fn intersect_batch<I: Isa>(
    bvh: &WideBvh,
    rays: &RayBatch,
    object: u32,
    nearest: &mut [Nearest],
) {
    for first in (0..rays.len()).step_by(LANES) {
        let n = LANES.min(rays.len() - first);
        let nearest = &mut nearest[first..first + n];
        let mut ends = [-1.0; LANES];
        for (end, nearest) in ends.iter_mut().zip(nearest.iter()) {
            *end = nearest.t();
        }
        match Packet::<I>::new(bvh, rays, first, n, &ends) {
            Some(mut packet) => {
                let sources = sources(rays, first, n, object);
                packet.walk(bvh, &mut TakeNearest { sources, object, nearest });
            }
            None => {
                for (lane, nearest) in nearest.iter_mut().enumerate() {
                    single::nearest::<I>(bvh, &rays.ray(first + lane), object, nearest);
                }
            }
        }
    }
}

/// Which rays of a batch are blocked; those that are already are left out.
#[inline(always)]
pub(super) fn occluded_batch<I: Isa>(
    bvh: &WideBvh,
    rays: &RayBatch,
    object: u32,
    blocked: &mut [bool],
) {
    for first in (0..rays.len()).step_by(LANES) {
        let n = LANES.min(rays.len() - first);
        let blocked = &mut blocked[first..first + n];
        let mut ends = [-1.0; LANES];
        for lane in 0..n {
            if !blocked[lane] {
                ends[lane] = rays.t_max[first + lane];
            }
        }
        match Packet::<I>::new(bvh, rays, first, n, &ends) {
            Some(mut packet) => {
                let sources = sources(rays, first, n, object);
                let mut any = FindAny { sources, hits: 0 };
                packet.walk(bvh, &mut any);
                for (lane, blocked) in blocked.iter_mut().enumerate() {
                    *blocked |= any.hits >> lane & 1 == 1;
                }
            }
            None => {
                for (lane, blocked) in blocked.iter_mut().enumerate() {
                    if !*blocked {
                        *blocked = single::blocked::<I>(bvh, &rays.ray(first + lane), object);
                    }
                }
            }
        }
    }
}

/// The triangle that each ray leaves, where it is one of this object.
#[inline(always)]
fn sources(rays: &RayBatch, first: usize, n: usize, object: u32) -> [u32; LANES] {
    let mut sources = [u32::MAX; LANES];
    for (lane, source) in rays.source[first..first + n].iter().enumerate() {
        if source.object == object {
            sources[lane] = source.primitive;
        }
    }
    sources
}

/// What is done with the blocks that some ray of a packet may touch; see [`single`] for why it is
/// a trait.
trait Visit<I: Isa> {
    /// Tells whether limits changed.
    fn visit(&mut self, packet: &mut Packet<I>, block: &Block) -> bool;
}

struct TakeNearest<'a> {
    sources: [u32; LANES],
    object: u32,
    nearest: &'a mut [Nearest],
}

struct FindAny {
    sources: [u32; LANES],
    hits: u32,
}

impl<I: Isa> Visit<I> for TakeNearest<'_> {
    #[inline(always)]
    fn visit(&mut self, packet: &mut Packet<I>, block: &Block) -> bool {
        let mut any = 0;
        for corner in 0..BLOCK {
            let id = block.ids[corner];
            if corner > 0 && id == block.ids[corner - 1] {
                break;
            }
            let candidates = packet.triangle(block, corner);
            if candidates.mask == 0 {
                continue;
            }
            let mut limits = [0.0; LANES];
            packet.limit.store(&mut limits);
            let mut left = candidates.mask;
            let corners = candidates.stored();
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                if self.sources[lane] == id {
                    continue;
                }
                if let Some(t) = corners.decide(lane, packet.speeds[lane]) {
                    self.nearest[lane].offer(t, self.object, id);
                    limits[lane] = self.nearest[lane].t();
                }
            }
            packet.limit = I::F16::load(&limits);
            any |= candidates.mask;
        }
        any != 0
    }
}

impl<I: Isa> Visit<I> for FindAny {
    #[inline(always)]
    fn visit(&mut self, packet: &mut Packet<I>, block: &Block) -> bool {
        let mut found = 0;
        for corner in 0..BLOCK {
            let id = block.ids[corner];
            if corner > 0 && id == block.ids[corner - 1] {
                break;
            }
            let candidates = packet.triangle(block, corner);
            let mut left = candidates.mask & !found;
            if left == 0 {
                continue;
            }
            let corners = candidates.stored();
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                if self.sources[lane] == id {
                    continue;
                }
                let t = corners.decide(lane, packet.speeds[lane]);
                found |= u32::from(t.is_some_and(|t| 0.0 < t && t < packet.ends[lane])) << lane;
            }
        }
        if found == 0 {
            return false;
        }
        self.hits |= found;
        packet.limit = packet.limit.blend(I::F16::splat(-1.0), found);
        true
    }
}

/// Sixteen rays that go together. Lanes without a ray, or whose ray is done, end below 0.
struct Packet<I: Isa> {
    origin: [I::F16; 3],
    reciprocal: [I::F16; 3],
    /// Origin times reciprocal.
    scaled_origin: [I::F16; 3],
    /// Axis order of the triangle test, the same for all.
    order: [usize; 3],
    shear: [I::F16; 2],
    /// The directions' largest components, and 1 over them.
    speeds: [f32; LANES],
    pace: I::F16,
    /// Where the rays end, and where what is of interest does.
    ends: [f32; LANES],
    limit: I::F16,
    pad: f32,
    /// Interval test along each axis.
    intervals: [Interval; 3],
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
    /// `None` where the directions differ in a sign or in their largest axis.
    #[inline(always)]
    fn new(
        bvh: &WideBvh,
        rays: &RayBatch,
        first: usize,
        n: usize,
        ends: &[f32; LANES],
    ) -> Option<Self> {
        if n < LANES / 2 {
            return None;
        }
        let order = Axes::new(rays.ray(first).direction).order;
        let zero = I::F16::splat(0.0);
        let (mut origin, mut direction, mut size) = ([zero; 3], [zero; 3], [zero; 3]);
        let mut farthest_origin = zero;
        for axis in 0..3 {
            origin[axis] = lanes(&rays.origin[axis], first, n);
            direction[axis] = lanes(&rays.direction[axis], first, n);
            size[axis] = direction[axis].max(zero.sub(direction[axis]));
            let n_negative = direction[axis].lt(zero);
            if n_negative != 0 && n_negative != I::F16::ALL {
                return None;
            }
            farthest_origin = farthest_origin.max(origin[axis]).max(zero.sub(origin[axis]));
        }
        let largest = size[order[2]];
        if largest.lt(size[order[0]]) | largest.lt(size[order[1]]) != 0 {
            return None;
        }
        if largest.eq(size[order[0]]) | largest.eq(size[order[1]]) != 0 {
            // Ties of the largest axis are broken as for a single ray.
            for index in first..first + n {
                if Axes::new(rays.ray(index).direction).order != order {
                    return None;
                }
            }
        }
        let pad = BoxRay::pad(farthest_origin.greatest(), bvh.magnitude);
        let one = I::F16::splat(1.0);
        let (mut reciprocal, mut scaled_origin) = ([zero; 3], [zero; 3]);
        let mut intervals = [Interval::NONE; 3];
        for axis in 0..3 {
            let smallest = BoxRay::SMALLEST.copysign(rays.direction[axis][first]);
            let is_tiny = size[axis].lt(I::F16::splat(BoxRay::SMALLEST));
            let d = direction[axis].blend(I::F16::splat(smallest), is_tiny);
            reciprocal[axis] = one.div(d);
            scaled_origin[axis] = origin[axis].mul(reciprocal[axis]);
            intervals[axis] = Interval::new(axis, reciprocal[axis], origin[axis], pad);
        }
        let speed = direction[order[2]];
        let mut speeds = [0.0; LANES];
        speed.store(&mut speeds);
        Some(Self {
            origin,
            reciprocal,
            scaled_origin,
            order,
            shear: [direction[order[0]].div(speed), direction[order[1]].div(speed)],
            speeds,
            pace: one.div(speed),
            ends: *ends,
            limit: I::F16::load(ends),
            pad,
            intervals,
        })
    }

    /// Sixteen rays against one triangle of a block.
    #[inline(always)]
    fn triangle(&self, block: &Block, lane: usize) -> Candidates<I::F16> {
        let zero = I::F16::splat(0.0);
        let (mut origin, mut corners) = ([zero; 3], [[zero; 3]; 3]);
        for axis in 0..3 {
            let k = self.order[axis];
            origin[axis] = self.origin[k];
            for (to, from) in corners.iter_mut().zip(&block.corners) {
                to[axis] = I::F16::splat(from[k][lane]);
            }
        }
        let [a, b, c] = corners;
        let shear = self.shear;
        let corners =
            [sheared(a, origin, shear), sheared(b, origin, shear), sheared(c, origin, shear)];
        Candidates::new(corners, self.pace, self.limit)
    }

    /// Hands the blocks that some ray may touch to a visitor, about near to far.
    #[inline(always)]
    fn walk<V: Visit<I>>(&mut self, bvh: &WideBvh, visitor: &mut V) {
        let mut farthest = self.limit.greatest();
        let mut stack = Stack::new();
        let mut current = bvh.root;
        loop {
            while current & LEAF == 0 {
                let node: &Node = &bvh.nodes[current as usize];
                let (hits, ts) = self.test_node(node, farthest);
                if hits == 0 {
                    break;
                }
                current = stack.descend(node, hits, &ts);
            }
            if current & LEAF != 0 && visitor.visit(self, &bvh.blocks[(current & !LEAF) as usize]) {
                farthest = self.limit.greatest();
                if farthest < 0.0 {
                    return;
                }
            }
            match stack.pop(farthest) {
                Some(reference) => current = reference,
                None => return,
            }
        }
    }

    /// Children that some ray may touch, and about where: first by intervals, then by the rays.
    #[inline(always)]
    fn test_node(&self, node: &Node, farthest: f32) -> (u32, [f32; WIDTH]) {
        let (mut enter, mut leave) = (I::F8::splat(0.0), I::F8::splat(farthest));
        for interval in &self.intervals {
            let near = I::F8::load(&node.bounds[interval.near]);
            let far = I::F8::load(&node.bounds[interval.far]);
            let least = I::F8::splat(interval.reciprocals[0]);
            let greatest = I::F8::splat(interval.reciprocals[1]);
            let near_least = near.mul_sub(least, I::F8::splat(interval.near_origin[0]));
            let near_greatest = near.mul_sub(greatest, I::F8::splat(interval.near_origin[1]));
            enter = enter.max(near_least.min(near_greatest));
            let far_least = far.mul_sub(least, I::F8::splat(interval.far_origin[0]));
            let far_greatest = far.mul_sub(greatest, I::F8::splat(interval.far_origin[1]));
            leave = leave.min(far_least.max(far_greatest));
        }
        let mut left = enter.le(leave) & ((1 << node.n_children) - 1);
        let mut ts = [0.0; WIDTH];
        enter.store(&mut ts);
        let mut hits = 0;
        while left != 0 {
            let child = left.trailing_zeros() as usize;
            left &= left - 1;
            let (mut enter, mut leave) = (I::F16::splat(0.0), self.limit);
            for axis in 0..3 {
                let interval = &self.intervals[axis];
                let outwards = if interval.near < 3 { self.pad } else { -self.pad };
                let near = I::F16::splat(node.bounds[interval.near][child] - outwards);
                let far = I::F16::splat(node.bounds[interval.far][child] + outwards);
                let (scale, origin) = (self.reciprocal[axis], self.scaled_origin[axis]);
                enter = enter.max(near.mul_sub(scale, origin));
                leave = leave.min(far.mul_sub(scale, origin));
            }
            hits |= u32::from(enter.le(leave) != 0) << child;
        }
        (hits, ts)
    }
}

/// Lanes `first..first + n`; those beyond repeat the first.
#[inline(always)]
fn lanes<F: Lanes>(from: &[f32], first: usize, n: usize) -> F {
    if n == LANES {
        return F::load(&from[first..]);
    }
    let mut padded = [from[first]; LANES];
    padded[..n].copy_from_slice(&from[first..first + n]);
    F::load(&padded)
}

impl Interval {
    const NONE: Self = Self {
        near: 0,
        far: 0,
        reciprocals: [0.0; 2],
        near_origin: [0.0; 2],
        far_origin: [0.0; 2],
    };

    #[inline(always)]
    fn new<F: Lanes>(axis: usize, reciprocal: F, origin: F, pad: f32) -> Self {
        let reciprocals = [reciprocal.least(), reciprocal.greatest()];
        let (low, high) = (origin.least() - pad, origin.greatest() + pad);
        let is_positive = reciprocals[0] > 0.0;
        let (near, far) = if is_positive { (axis, axis + 3) } else { (axis + 3, axis) };
        // The near plane is met first from the origin farthest along the direction.
        let (foremost, hindmost) = if is_positive { (high, low) } else { (low, high) };
        Self {
            near,
            far,
            reciprocals,
            near_origin: [reciprocals[0] * foremost, reciprocals[1] * foremost],
            far_origin: [reciprocals[0] * hindmost, reciprocals[1] * hindmost],
        }
    }
}

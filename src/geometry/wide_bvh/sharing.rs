//! Which rays of a batch share a packet.

use crate::geometry::lanes::{Isa, Lanes};
use crate::geometry::wide_bvh::group::{LANES, lanes};
use crate::geometry::wide_bvh::packet::GROUPS;
use crate::geometry::wide_bvh::stream::Take;
use crate::math::RayBatch;

/// Fewer rays that are alike are not worth a packet that stays together.
const FEWEST: usize = 6;

/// The next rays of a batch that start together.
pub(super) struct Share {
    /// How many.
    pub(super) n: usize,
    /// From boxes that so few of them touch they go on alone: 0 where they stay together, all
    /// where they had better not start together.
    pub(super) n_alone: usize,
}

/// What rays of a packet pay for going together: tests of a group of sixteen against a box or a
/// triangle; and what they are spared: steps that each would make alone.
#[derive(Clone, Copy, Default)]
pub(super) struct Toll {
    pub(super) paid: u32,
    pub(super) spared: u32,
}

/// Divides a batch as it goes on.
pub(super) struct Sharing {
    spread: f32,
    n_alone: usize,
    /// Rays before this one are known not to make one large packet,
    parted: usize,
    /// but runs of rays that are alike.
    are_runs: bool,
    /// What packets of this batch have paid and spared, the older ones counting less.
    paid: f32,
    spared: f32,
}

impl Sharing {
    /// For a tree of so many blocks. The finer the mesh, the sooner rays part, and the less of the
    /// tree stays in the cache of the processor, which packets do not wait for with other rays under
    /// way. All figures were found by trial.
    pub(super) fn new<T: Take>(n_blocks: usize) -> Self {
        /// Larger trees are too far from the processor.
        const MOST_BLOCKS: usize = 150_000;
        let root = (n_blocks as f32).sqrt();
        let spread = (152.0 / (root * root.sqrt())).clamp(0.05, 0.7);
        let few = if T::SORTED { 4 } else { 8 };
        let n_alone = if n_blocks < MOST_BLOCKS { few } else { LANES };
        Self { spread, n_alone, parted: 0, are_runs: false, paid: 0.0, spared: 0.0 }
    }

    /// Takes note of what a packet paid.
    #[inline(always)]
    pub(super) fn learn(&mut self, toll: Toll) {
        /// Of what was known before.
        const SHARE: f32 = 0.75;
        self.paid = SHARE * self.paid + toll.paid as f32;
        self.spared = SHARE * self.spared + toll.spared as f32;
    }

    /// Whether rays had better go alone, by the packets of late; what is known of those fades.
    #[inline(always)]
    fn is_dear(&mut self) -> bool {
        /// Of a step alone, in tests of sixteen rays: by trial on meshes of all kinds.
        const WORTH: f32 = 0.6;
        const FADES: f32 = 0.98;
        let is_dear = self.paid > WORTH * self.spared;
        if is_dear {
            self.paid *= FADES;
        }
        is_dear
    }

    /// What starts at a ray of the batch.
    #[inline(always)]
    pub(super) fn next<I: Isa>(&mut self, rays: &RayBatch, first: usize) -> Share {
        let n = (LANES * GROUPS).min(rays.len() - first);
        if self.is_dear() {
            return Share { n: n.min(LANES), n_alone: LANES };
        }
        if first >= self.parted {
            if go_together::<I>(rays, first, n, self.spread) {
                return Share { n, n_alone: 0 };
            }
            self.parted = first + n;
            self.are_runs = are_runs::<I>(rays, first, n, self.spread);
        }
        let n = n.min(LANES);
        if self.are_runs {
            let n = n_alike::<I>(rays, first, n, self.spread);
            Share { n, n_alone: if n < FEWEST { LANES } else { 0 } }
        } else {
            Share { n, n_alone: self.n_alone }
        }
    }
}

/// Whether all directions are no farther than `spread` from the first along each axis, in units of
/// its largest component.
#[inline(always)]
fn go_together<I: Isa>(rays: &RayBatch, first: usize, n: usize, spread: f32) -> bool {
    let direction = rays.ray(first).direction;
    let reach = I::F16::splat(spread * direction.abs().max_element());
    let zero = I::F16::splat(0.0);
    let mut farthest = zero;
    for axis in 0..3 {
        let start = I::F16::splat(direction[axis]);
        for offset in (0..n).step_by(LANES) {
            let these = lanes::<I::F16>(&rays.direction[axis], first + offset, n - offset);
            let apart = these.sub(start);
            farthest = apart.max(zero.sub(apart)).max(farthest);
        }
    }
    farthest.le(reach) == I::F16::ALL
}

/// How many of the next rays have directions no farther than `spread` from the first along each
/// axis, in units of its largest component.
#[inline(always)]
fn n_alike<I: Isa>(rays: &RayBatch, first: usize, n: usize, spread: f32) -> usize {
    let direction = rays.ray(first).direction;
    let last = rays.ray(first + n.min(FEWEST) - 1).direction;
    if (last - direction).abs().max_element() > spread * direction.abs().max_element() {
        return 1;
    }
    let reach = I::F16::splat(spread * direction.abs().max_element());
    let zero = I::F16::splat(0.0);
    let mut alike = I::F16::ALL;
    for axis in 0..3 {
        let these = lanes::<I::F16>(&rays.direction[axis], first, n);
        let apart = these.sub(I::F16::splat(direction[axis]));
        alike &= apart.max(zero.sub(apart)).le(reach);
    }
    (alike.trailing_ones() as usize).clamp(1, n)
}

/// Whether most rays go about where the one before them goes.
#[inline(always)]
fn are_runs<I: Isa>(rays: &RayBatch, first: usize, n: usize, spread: f32) -> bool {
    let reach = I::F16::splat(spread * rays.ray(first).direction.abs().max_element());
    let zero = I::F16::splat(0.0);
    let mut n_alike = 0;
    for offset in (0..n - 1).step_by(LANES) {
        let left = (n - 1 - offset).min(LANES);
        let mut alike = u32::MAX >> (32 - left);
        for axis in 0..3 {
            let these = lanes::<I::F16>(&rays.direction[axis], first + offset, left);
            let next = lanes::<I::F16>(&rays.direction[axis], first + offset + 1, left);
            let apart = next.sub(these);
            alike &= apart.max(zero.sub(apart)).le(reach);
        }
        n_alike += alike.count_ones() as usize;
    }
    4 * n_alike >= 3 * n
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::lanes::Portable;
    use crate::geometry::wide_bvh::stream::TakeAny;
    use crate::math::Ray;

    fn alike(n: usize) -> RayBatch {
        let mut rays = RayBatch::default();
        (0..n).for_each(|_| rays.push(Ray::new(Vec3::ZERO, Vec3::ONE)));
        rays
    }

    /// How many of the rays of a batch go in packets that cost so much.
    fn n_together(toll: Toll) -> usize {
        let rays = alike(4096);
        let mut sharing = Sharing::new::<TakeAny<'_>>(1000);
        let (mut first, mut n_together) = (0, 0);
        while first < rays.len() {
            let share = sharing.next::<Portable>(&rays, first);
            assert!(share.n > 0 && first + share.n <= rays.len(), "a part of the batch");
            if share.n_alone < LANES {
                sharing.learn(toll);
                n_together += share.n;
            }
            first += share.n;
        }
        n_together
    }

    #[test]
    fn rays_go_together_while_that_spares_them_work() {
        assert_eq!(n_together(Toll { paid: 50, spared: 100 }), 4096, "cheap");
        // Tried at first, and again now and then.
        let dear = n_together(Toll { paid: 200, spared: 100 });
        assert!((128..1024).contains(&dear), "{dear}");
    }
}

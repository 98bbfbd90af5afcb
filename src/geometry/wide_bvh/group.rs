//! Sixteen rays of a packet: their test against one box, and against one triangle after another.

use crate::geometry::lanes::{Isa, Lanes};
use crate::geometry::wide_bvh::stream::Take;
use crate::geometry::wide_bvh::{BLOCK, Block, Node, WideBvh, leaf};
use crate::math::RayBatch;

/// Rays of a group.
pub(super) const LANES: usize = 16;

/// Sixteen rays. Lanes without a ray, or whose ray is done, end below 0.
pub(super) struct Group<I: Isa> {
    pub(super) aim: Aim<I::F16>,
    /// By how much boxes are grown.
    pub(super) pad: I::F16,
    pub(super) reciprocal: [I::F16; 3],
    /// Origins, moved outwards by the bound of rounding errors, times the reciprocals.
    near_origin: [I::F16; 3],
    far_origin: [I::F16; 3],
    /// Where directions are below 0.
    pub(super) negative: [u32; 3],
    pub(super) limit: I::F16,
    /// The greatest limit.
    pub(super) farthest: f32,
}

/// What triangle tests need of rays.
pub(super) struct Aim<F> {
    pub(super) origin: [F; 3],
    /// Where x is a direction's largest component, and where y is; elsewhere z.
    largest: [u32; 2],
    shear: [F; 2],
    speed: F,
    pace: F,
}

impl<I: Isa> Group<I> {
    /// No rays.
    #[inline(always)]
    pub(super) fn idle() -> Self {
        let zero = I::F16::splat(0.0);
        Self {
            aim: Aim {
                origin: [zero; 3],
                largest: [0; 2],
                shear: [zero; 2],
                speed: zero,
                pace: zero,
            },
            pad: zero,
            reciprocal: [zero; 3],
            near_origin: [zero; 3],
            far_origin: [zero; 3],
            negative: [0; 3],
            limit: zero,
            farthest: -1.0,
        }
    }

    /// Takes on the rays `first..first + n` of a batch; of more than sixteen the first. Lanes end at
    /// their limits.
    #[inline(always)]
    pub(super) fn start(
        &mut self,
        bvh: &WideBvh,
        rays: &RayBatch,
        first: usize,
        n: usize,
        limits: &[f32; LANES],
    ) {
        let zero = I::F16::splat(0.0);
        let mut farthest = zero;
        for axis in 0..3 {
            let origin = lanes::<I::F16>(&rays.origin[axis], first, n);
            farthest = origin.max(zero.sub(origin)).max(farthest);
            self.aim.origin[axis] = origin;
        }
        let reach = farthest.add(I::F16::splat(bvh.magnitude));
        self.pad = reach.mul(I::F16::splat(WideBvh::ROUNDING));
        let x = lanes::<I::F16>(&rays.direction[0], first, n);
        let y = lanes::<I::F16>(&rays.direction[1], first, n);
        let z = lanes::<I::F16>(&rays.direction[2], first, n);
        self.set_axis(0, x);
        self.set_axis(1, y);
        self.set_axis(2, z);
        self.aim.set_axes([x, y, z]);
        self.limit = I::F16::load(limits);
        self.farthest = self.limit.greatest();
    }

    /// What box tests need along one axis.
    #[inline(always)]
    fn set_axis(&mut self, axis: usize, direction: I::F16) {
        let (zero, origin) = (I::F16::splat(0.0), self.aim.origin[axis]);
        let negative = direction.lt(zero);
        let smallest = I::F16::splat(WideBvh::SMALLEST);
        let smallest = smallest.blend(zero.sub(smallest), negative);
        let size = direction.max(zero.sub(direction));
        let is_tiny = size.lt(I::F16::splat(WideBvh::SMALLEST));
        let reciprocal = I::F16::splat(1.0).div(direction.blend(smallest, is_tiny));
        let outwards = self.pad.blend(zero.sub(self.pad), negative);
        self.reciprocal[axis] = reciprocal;
        self.near_origin[axis] = origin.add(outwards).mul(reciprocal);
        self.far_origin[axis] = origin.sub(outwards).mul(reciprocal);
        self.negative[axis] = negative;
    }

    /// Rays that go no further.
    #[inline(always)]
    pub(super) fn dismiss(&mut self, rays: u32) {
        self.limit = self.limit.blend(I::F16::splat(-1.0), rays);
    }

    /// Which rays touch a box before their limits, and where they enter it.
    #[inline(always)]
    pub(super) fn touches(&self, node: &Node, child: usize) -> (u32, I::F16) {
        let (mut enter, mut leave) = (I::F16::splat(0.0), self.limit);
        for axis in 0..3 {
            let lower = I::F16::splat(node.bounds[axis][child]);
            let upper = I::F16::splat(node.bounds[axis + 3][child]);
            let (near, far) = match self.negative[axis] {
                0 => (lower, upper),
                negative if negative == I::F16::ALL => (upper, lower),
                negative => (lower.blend(upper, negative), upper.blend(lower, negative)),
            };
            enter = near.mul_sub(self.reciprocal[axis], self.near_origin[axis]).max(enter);
            leave = far.mul_sub(self.reciprocal[axis], self.far_origin[axis]).min(leave);
        }
        (enter.le(leave), enter)
    }

    /// Offers what these rays meet in a block; tells whether a limit changed.
    #[inline(always)]
    pub(super) fn visit<T: Take>(
        &mut self,
        block: &Block,
        rays: u32,
        first: usize,
        hits: &mut T,
    ) -> bool {
        let n_triangles = block.n_triangles();
        if rays != I::F16::ALL {
            let rays = rays & I::F16::splat(0.0).le(self.limit);
            if rays.count_ones().div_ceil(4) < n_triangles {
                return self.visit_with_few(block, rays, first, hits);
            }
        }
        let mut is_changed = false;
        for corner in 0..n_triangles as usize % (BLOCK + 1) {
            let id = block.ids[corner];
            let splat =
                |axes: &[[f32; BLOCK]; 3]| axes.each_ref().map(|axis| I::F16::splat(axis[corner]));
            let found = self.aim.hits::<T>(block.corners.each_ref().map(splat), self.limit);
            let Some((mut mask, t)) = found else { continue };
            let mut parameters = [0.0; LANES];
            t.store(&mut parameters);
            let mut taken = 0;
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize % LANES;
                mask &= mask - 1;
                let limit = hits.take(first + lane, parameters[lane], id);
                // A hit at the very end of a ray is none where any hit will do.
                let is_taken = if T::SORTED { limit <= parameters[lane] } else { limit < 0.0 };
                taken |= u32::from(is_taken) << lane;
            }
            // What is taken ends there, or at once where any hit will do.
            let limit = if T::SORTED { t } else { I::F16::splat(-1.0) };
            self.limit = self.limit.blend(limit, taken);
            is_changed = true;
        }
        is_changed
    }

    /// The same, four rays against four triangles at once.
    #[inline(always)]
    fn visit_with_few<T: Take>(
        &mut self,
        block: &Block,
        mut rays: u32,
        first: usize,
        hits: &mut T,
    ) -> bool {
        let mut limits = None;
        let repeat = |axes: &[[f32; BLOCK]; 3]| axes.each_ref().map(I::repeated);
        let corners = block.corners.each_ref().map(repeat);
        while rays != 0 {
            let mut of = [rays.trailing_zeros() as usize % LANES; 4];
            let mut n = 0;
            while rays != 0 && n < 4 {
                of[n] = rays.trailing_zeros() as usize % LANES;
                rays &= rays - 1;
                n += 1;
            }
            let four = I::four(of);
            let limit = I::each_four_times(self.limit, four);
            let Some((mask, t)) = self.aim.of_four::<I>(of, four).hits::<T>(corners, limit) else {
                continue;
            };
            let mut mask = mask & ((1 << (4 * n)) - 1);
            if mask == 0 {
                continue;
            }
            let mut parameters = [0.0; LANES];
            t.store(&mut parameters);
            let limits = limits.get_or_insert_with(|| {
                let mut limits = [0.0; LANES];
                self.limit.store(&mut limits);
                limits
            });
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize % LANES;
                mask &= mask - 1;
                let ray = of[lane / 4];
                let limit = hits.take(first + ray, parameters[lane], block.ids[lane % 4]);
                limits[ray] = limits[ray].min(limit);
            }
        }
        let Some(limits) = limits else { return false };
        self.limit = I::F16::load(&limits);
        true
    }
}

impl<F: Lanes> Aim<F> {
    /// Takes on directions.
    #[inline(always)]
    fn set_axes(&mut self, [x, y, z]: [F; 3]) {
        let zero = F::splat(0.0);
        let (size_x, size_y) = (x.max(zero.sub(x)), y.max(zero.sub(y)));
        let size_z = z.max(zero.sub(z));
        // As for a single ray: x where it is above both, y where it is not below x and above z.
        let is_x = size_y.lt(size_x) & size_z.lt(size_x);
        let is_y = size_x.le(size_y) & size_z.lt(size_y);
        self.largest = [is_x, is_y];
        let [along_x, along_y, speed] = self.turned([x, y, z]);
        self.shear = [along_x.div(speed), along_y.div(speed)];
        self.speed = speed;
        self.pace = F::splat(1.0).div(speed);
    }

    /// Coordinates in the order of axes that each ray has for triangle tests.
    #[inline(always)]
    fn turned(&self, [x, y, z]: [F; 3]) -> [F; 3] {
        let [is_x, is_y] = self.largest;
        if is_x | is_y == 0 {
            [x, y, z]
        } else if is_y == F::ALL {
            [z, x, y]
        } else if is_x == F::ALL {
            [y, z, x]
        } else {
            [
                x.blend(z, is_y).blend(y, is_x),
                y.blend(x, is_y).blend(z, is_x),
                z.blend(y, is_y).blend(x, is_x),
            ]
        }
    }

    /// Where the rays meet triangles of these corners before their limits.
    #[inline(always)]
    fn hits<T: Take>(&self, [a, b, c]: [[F; 3]; 3], limit: F) -> Option<(u32, F)> {
        let corners = [self.seen(a), self.seen(b), self.seen(c)];
        leaf::hits::<_, T>(corners, self.speed, self.pace, limit)
    }

    #[inline(always)]
    fn seen(&self, corner: [F; 3]) -> [F; 3] {
        let [x, y, z] = corner;
        let [from_x, from_y, from_z] = self.origin;
        leaf::sheared(self.turned([x.sub(from_x), y.sub(from_y), z.sub(from_z)]), self.shear)
    }

    /// Four of the rays, each four times.
    #[inline(always)]
    fn of_four<I: Isa<F16 = F>>(&self, of: [usize; 4], four: I::Four) -> Self {
        let each = |from| I::each_four_times(from, four);
        let quads = |mask: u32| {
            if mask == 0 || mask == F::ALL {
                return mask;
            }
            (0..4).fold(0, |quads, ray| quads | ((mask >> of[ray] & 1) * 15) << (4 * ray))
        };
        Self {
            origin: self.origin.map(each),
            largest: self.largest.map(quads),
            shear: self.shear.map(each),
            speed: each(self.speed),
            pace: each(self.pace),
        }
    }
}

/// Lanes `first..first + n`; those beyond repeat the first.
#[inline(always)]
pub(super) fn lanes<F: Lanes>(from: &[f32], first: usize, n: usize) -> F {
    if n >= LANES {
        return F::load(&from[first..]);
    }
    let mut padded = [from[first]; LANES];
    padded[..n].copy_from_slice(&from[first..first + n]);
    F::load(&padded)
}

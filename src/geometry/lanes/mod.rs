//! Several numbers at once: AVX2 and AVX-512 registers, and arrays where there are none.
//!
//! Every operation is the IEEE one, lane by lane, so that all widths give the same bits; only
//! [`Lanes::mul_sub`] may or may not round in between, and serves conservative box tests alone.
//! Masks are bits, lane 0 lowest.

mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(super) use portable::Portable;
#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2, Avx512};

/// A fixed number of f32 lanes.
pub(super) trait Lanes: Copy {
    /// How many.
    const N: usize;
    /// As many lanes of f64.
    type Double: DoubleLanes<Single = Self>;
    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// The first `N` numbers of a slice that has them.
    fn load(from: &[f32]) -> Self;
    /// Into the first `N` places of a slice that has them.
    fn store(self, to: &mut [f32]);
    /// Sum.
    fn add(self, other: Self) -> Self;
    /// Difference.
    fn sub(self, other: Self) -> Self;
    /// Product.
    fn mul(self, other: Self) -> Self;
    /// Quotient.
    fn div(self, other: Self) -> Self;
    /// self · a - b, rounded once or twice.
    fn mul_sub(self, a: Self, b: Self) -> Self;
    /// The lesser; `other` where `self` is NaN.
    fn min(self, other: Self) -> Self;
    /// The greater; `other` where `self` is NaN.
    fn max(self, other: Self) -> Self;
    /// Where self < other.
    fn lt(self, other: Self) -> u32;
    /// Where self <= other.
    fn le(self, other: Self) -> u32;
    /// `other` where the mask is set, else `self`; bits are moved as they are.
    fn blend(self, other: Self, mask: u32) -> Self;
    /// The same numbers in double precision.
    fn widened(self) -> Self::Double;

    /// All lanes.
    const ALL: u32 = u32::MAX >> (32 - Self::N);

    /// The least of all lanes.
    #[inline(always)]
    fn least(self) -> f32 {
        let mut lanes = [f32::INFINITY; 16];
        self.store(&mut lanes);
        lanes.into_iter().fold(f32::INFINITY, f32::min)
    }

    /// The greatest of all lanes.
    #[inline(always)]
    fn greatest(self) -> f32 {
        let mut lanes = [f32::NEG_INFINITY; 16];
        self.store(&mut lanes);
        lanes.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }
}

/// As many f64 lanes as its [`Lanes`] have.
pub(super) trait DoubleLanes: Copy {
    /// The lanes of f32.
    type Single;
    /// Sum.
    fn add(self, other: Self) -> Self;
    /// Difference.
    fn sub(self, other: Self) -> Self;
    /// Product.
    fn mul(self, other: Self) -> Self;
    /// Quotient.
    fn div(self, other: Self) -> Self;
    /// Where the numbers are below 0, and where above.
    fn signs(self) -> (u32, u32);
    /// Rounded to the nearest f32.
    fn narrowed(self) -> Self::Single;
}

/// The registers of one kind of processor, and what it does best in its own way.
pub(super) trait Isa {
    type F4: Lanes;
    type F8: Lanes;
    type F16: Lanes;
    /// Which four of sixteen lanes.
    type Four: Copy;

    /// Names four lanes.
    fn four(lanes: [usize; 4]) -> Self::Four;

    /// Each of four lanes four times.
    fn each_four_times(from: Self::F16, which: Self::Four) -> Self::F16;

    /// Four numbers four times, one after another.
    fn repeated(four: &[f32; 4]) -> Self::F16;

    /// One of six rows, without a check in builds without debug assertions.
    fn row(rows: &[[f32; 8]; 6], row: usize) -> Self::F8;

    /// Has the lines of a value fetched into the fastest cache.
    fn prefetch<T>(value: &T);

    /// Writes the references of the children that are hit, farthest first, with keys that order
    /// them: [`key_of`] of `enter`, less than 8 units off. Eight places are overwritten.
    fn push_sorted(
        enter: Self::F8,
        hits: u32,
        children: &[u32; 8],
        keys: &mut [u32; 8],
        references: &mut [u32; 8],
    );

    /// Writes the references of the children that are hit in any order. Eight places are
    /// overwritten.
    fn push_unsorted(hits: u32, children: &[u32; 8], references: &mut [u32; 8]);
}

/// A number that is lower the farther away `t` is, which is at least 0. The three lowest bits are
/// free for the number of a child.
pub(super) fn key_of(t: f32) -> u32 {
    0x7FFF_FFFF_u32.wrapping_sub(t.to_bits() | 7)
}

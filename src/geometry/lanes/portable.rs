//! Lanes in arrays: any processor.

use crate::geometry::lanes::{DoubleLanes, Isa, Lanes, key_of};

/// Arrays.
pub(in crate::geometry) struct Portable;

impl Isa for Portable {
    type F4 = Array<4>;
    type F8 = Array<8>;
    type F16 = Array<16>;
    type Four = [usize; 4];

    #[inline(always)]
    fn four(lanes: [usize; 4]) -> [usize; 4] {
        lanes
    }

    #[inline(always)]
    fn each_four_times(from: Array<16>, which: [usize; 4]) -> Array<16> {
        Array(std::array::from_fn(|lane| from.0[which[lane / 4] % 16]))
    }

    #[inline(always)]
    fn repeated(four: &[f32; 4]) -> Array<16> {
        Array(std::array::from_fn(|lane| four[lane % 4]))
    }

    #[inline(always)]
    fn row(rows: &[[f32; 8]; 6], row: usize) -> Array<8> {
        Array(rows[row])
    }

    #[inline(always)]
    fn prefetch<T>(_: &T) {}

    #[inline(always)]
    fn push_sorted(
        enter: Array<8>,
        hits: u32,
        children: &[u32; 8],
        keys: &mut [u32; 8],
        references: &mut [u32; 8],
    ) {
        for (n, child) in (0..8).filter(|child| hits >> child & 1 == 1).enumerate() {
            let key = key_of(enter.0[child]) | child as u32;
            let mut place = n;
            while place > 0 && keys[place - 1] > key {
                keys[place] = keys[place - 1];
                references[place] = references[place - 1];
                place -= 1;
            }
            keys[place] = key;
            references[place] = children[child];
        }
    }

    #[inline(always)]
    fn push_unsorted(hits: u32, children: &[u32; 8], references: &mut [u32; 8]) {
        let hit = (0..8).filter(|child| hits >> child & 1 == 1);
        hit.zip(references).for_each(|(child, reference)| *reference = children[child]);
    }
}

/// Lanes in an array.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct Array<const N: usize, T = f32>([T; N]);

impl<const N: usize, T: Copy> Array<N, T> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(&T, &T) -> bool) -> u32 {
        (0..N).fold(0, |mask, i| mask | u32::from(f(&self.0[i], &other.0[i])) << i)
    }
}

impl<const N: usize> Lanes for Array<N> {
    const N: usize = N;
    type Double = Array<N, f64>;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; N])
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        Self(std::array::from_fn(|i| from[i]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[..N].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn mul_sub(self, a: Self, b: Self) -> Self {
        self.mul(a).sub(b)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        self.compare(other, f32::lt)
    }
    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self.compare(other, f32::le)
    }
    #[inline(always)]
    fn blend(self, other: Self, mask: u32) -> Self {
        Self(std::array::from_fn(|i| if mask >> i & 1 == 1 { other.0[i] } else { self.0[i] }))
    }
    #[inline(always)]
    fn widened(self) -> Array<N, f64> {
        Array(self.0.map(f64::from))
    }
}

impl<const N: usize> DoubleLanes for Array<N, f64> {
    type Single = Array<N>;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn signs(self) -> (u32, u32) {
        let zero = Self([0.0; N]);
        (self.compare(zero, f64::lt), self.compare(zero, f64::gt))
    }
    #[inline(always)]
    fn narrowed(self) -> Array<N> {
        Array(self.0.map(|x| x as f32))
    }
}

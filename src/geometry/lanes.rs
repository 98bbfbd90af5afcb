//! Several floats at once: SSE2, AVX2 and AVX-512 registers, and arrays where there are none.
//!
//! Every operation is the IEEE one, lane by lane, so that all widths give the same bits; only
//! [`Lanes::mul_sub`] may or may not round in between, and serves conservative box tests alone.
//! Masks are bits, lane 0 lowest.
#![expect(unsafe_code, reason = "register intrinsics; see the safety notes")]

/// A fixed number of f32 lanes.
pub(super) trait Lanes: Copy {
    /// How many.
    const N: usize;
    /// The lanes as an array.
    type Stored: Copy + std::ops::Index<usize, Output = f32>;
    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// The first `N` numbers of a slice that has them.
    fn load(from: &[f32]) -> Self;
    /// Into the first `N` places of a slice that has them.
    fn store(self, to: &mut [f32]);
    /// Into an array.
    fn stored(self) -> Self::Stored;
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
    /// Where self == other.
    fn eq(self, other: Self) -> u32;
    /// `other` where the mask is set, else `self`.
    fn blend(self, other: Self, mask: u32) -> Self;

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

/// The registers of one kind of processor: four, eight and sixteen lanes.
pub(super) trait Isa {
    type F4: Lanes;
    type F8: Lanes;
    type F16: Lanes;
}

/// Arrays: any processor.
pub(super) struct Portable;

impl Isa for Portable {
    type F4 = Array<4>;
    type F8 = Array<8>;
    type F16 = Array<16>;
}

/// Lanes in an array.
#[derive(Clone, Copy)]
pub(super) struct Array<const N: usize>([f32; N]);

impl<const N: usize> Array<N> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(&f32, &f32) -> bool) -> u32 {
        (0..N).fold(0, |mask, i| mask | u32::from(f(&self.0[i], &other.0[i])) << i)
    }
}

impl<const N: usize> Lanes for Array<N> {
    const N: usize = N;
    type Stored = [f32; N];

    #[inline(always)]
    fn stored(self) -> [f32; N] {
        self.0
    }

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
    fn eq(self, other: Self) -> u32 {
        self.compare(other, f32::eq)
    }
    #[inline(always)]
    fn blend(self, other: Self, mask: u32) -> Self {
        Self(std::array::from_fn(|i| if mask >> i & 1 == 1 { other.0[i] } else { self.0[i] }))
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2, Avx512};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Isa, Lanes};

    /// Processors with AVX2 and FMA.
    pub(in crate::geometry) struct Avx2;

    impl Isa for Avx2 {
        type F4 = F4;
        type F8 = F8;
        type F16 = Pair<F8>;
    }

    /// Processors with AVX-512 F and VL.
    pub(in crate::geometry) struct Avx512;

    impl Isa for Avx512 {
        type F4 = F4;
        type F8 = F8;
        type F16 = F16;
    }

    #[derive(Clone, Copy)]
    pub(in crate::geometry) struct F4(__m128);
    #[derive(Clone, Copy)]
    pub(in crate::geometry) struct F8(__m256);
    #[derive(Clone, Copy)]
    pub(in crate::geometry) struct F16(__m512);

    /// Twice as many lanes in two registers.
    #[derive(Clone, Copy)]
    pub(in crate::geometry) struct Pair<L>(L, L);

    // SAFETY, for every block below: F4 needs SSE2, which every x86-64 processor has. F8 is named
    // only through `Avx2` and `Avx512`, F16 only through `Avx512`, and code that is generic over
    // those runs only inside functions that enable their features after asking the processor
    // (`wide_bvh::dispatch`). Loads and stores are of slices whose length is checked first.

    macro_rules! arithmetic {
        ($sub:ident $mul:ident $div:ident $min:ident $max:ident) => {
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(unsafe { $sub(self.0, other.0) })
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self(unsafe { $mul(self.0, other.0) })
            }
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                Self(unsafe { $div(self.0, other.0) })
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self(unsafe { $min(self.0, other.0) })
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(unsafe { $max(self.0, other.0) })
            }
        };
    }

    impl Lanes for F4 {
        const N: usize = 4;
        type Stored = [f32; 4];

        #[inline(always)]
        fn stored(self) -> [f32; 4] {
            let mut lanes = [0.0; 4];
            self.store(&mut lanes);
            lanes
        }
        arithmetic!(_mm_sub_ps _mm_mul_ps _mm_div_ps _mm_min_ps _mm_max_ps);

        #[inline(always)]
        fn splat(x: f32) -> Self {
            Self(unsafe { _mm_set1_ps(x) })
        }
        #[inline(always)]
        fn load(from: &[f32]) -> Self {
            let from = &from[..4];
            Self(unsafe { _mm_loadu_ps(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f32]) {
            let to = &mut to[..4];
            unsafe { _mm_storeu_ps(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn mul_sub(self, a: Self, b: Self) -> Self {
            self.mul(a).sub(b)
        }
        #[inline(always)]
        fn lt(self, other: Self) -> u32 {
            unsafe { _mm_movemask_ps(_mm_cmplt_ps(self.0, other.0)) as u32 }
        }
        #[inline(always)]
        fn le(self, other: Self) -> u32 {
            unsafe { _mm_movemask_ps(_mm_cmple_ps(self.0, other.0)) as u32 }
        }
        #[inline(always)]
        fn eq(self, other: Self) -> u32 {
            unsafe { _mm_movemask_ps(_mm_cmpeq_ps(self.0, other.0)) as u32 }
        }
        #[inline(always)]
        fn blend(self, other: Self, mask: u32) -> Self {
            let (mut to, mut from) = ([0.0; 4], [0.0; 4]);
            self.store(&mut to);
            other.store(&mut from);
            for lane in 0..4 {
                if mask >> lane & 1 == 1 {
                    to[lane] = from[lane];
                }
            }
            Self::load(&to)
        }
    }

    impl Lanes for F8 {
        const N: usize = 8;
        type Stored = [f32; 8];

        #[inline(always)]
        fn stored(self) -> [f32; 8] {
            let mut lanes = [0.0; 8];
            self.store(&mut lanes);
            lanes
        }
        arithmetic!(
            _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_min_ps _mm256_max_ps
        );

        #[inline(always)]
        fn splat(x: f32) -> Self {
            Self(unsafe { _mm256_set1_ps(x) })
        }
        #[inline(always)]
        fn load(from: &[f32]) -> Self {
            let from = &from[..8];
            Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f32]) {
            let to = &mut to[..8];
            unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn mul_sub(self, a: Self, b: Self) -> Self {
            Self(unsafe { _mm256_fmsub_ps(self.0, a.0, b.0) })
        }
        #[inline(always)]
        fn lt(self, other: Self) -> u32 {
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) as u32 }
        }
        #[inline(always)]
        fn le(self, other: Self) -> u32 {
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
        }
        #[inline(always)]
        fn eq(self, other: Self) -> u32 {
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0)) as u32 }
        }
        #[inline(always)]
        fn blend(self, other: Self, mask: u32) -> Self {
            Self(unsafe {
                let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
                let set = _mm256_and_si256(_mm256_set1_epi32(mask as i32), bits);
                let lanes = _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bits));
                _mm256_blendv_ps(self.0, other.0, lanes)
            })
        }
    }

    impl Lanes for F16 {
        const N: usize = 16;
        type Stored = [f32; 16];

        #[inline(always)]
        fn stored(self) -> [f32; 16] {
            let mut lanes = [0.0; 16];
            self.store(&mut lanes);
            lanes
        }
        arithmetic!(
            _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_min_ps _mm512_max_ps
        );

        #[inline(always)]
        fn splat(x: f32) -> Self {
            Self(unsafe { _mm512_set1_ps(x) })
        }
        #[inline(always)]
        fn load(from: &[f32]) -> Self {
            let from = &from[..16];
            Self(unsafe { _mm512_loadu_ps(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f32]) {
            let to = &mut to[..16];
            unsafe { _mm512_storeu_ps(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn mul_sub(self, a: Self, b: Self) -> Self {
            Self(unsafe { _mm512_fmsub_ps(self.0, a.0, b.0) })
        }
        #[inline(always)]
        fn lt(self, other: Self) -> u32 {
            u32::from(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) })
        }
        #[inline(always)]
        fn le(self, other: Self) -> u32 {
            u32::from(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) })
        }
        #[inline(always)]
        fn eq(self, other: Self) -> u32 {
            u32::from(unsafe { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, other.0) })
        }
        #[inline(always)]
        fn blend(self, other: Self, mask: u32) -> Self {
            Self(unsafe { _mm512_mask_mov_ps(self.0, mask as u16, other.0) })
        }
        #[inline(always)]
        fn least(self) -> f32 {
            unsafe { _mm512_reduce_min_ps(self.0) }
        }
        #[inline(always)]
        fn greatest(self) -> f32 {
            unsafe { _mm512_reduce_max_ps(self.0) }
        }
    }

    impl Lanes for Pair<F8> {
        const N: usize = 16;
        type Stored = [f32; 16];

        #[inline(always)]
        fn stored(self) -> [f32; 16] {
            let mut lanes = [0.0; 16];
            self.store(&mut lanes);
            lanes
        }

        #[inline(always)]
        fn splat(x: f32) -> Self {
            Self(F8::splat(x), F8::splat(x))
        }
        #[inline(always)]
        fn load(from: &[f32]) -> Self {
            Self(F8::load(from), F8::load(&from[F8::N..]))
        }
        #[inline(always)]
        fn store(self, to: &mut [f32]) {
            self.0.store(to);
            self.1.store(&mut to[F8::N..]);
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            Self(self.0.sub(other.0), self.1.sub(other.1))
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Self(self.0.mul(other.0), self.1.mul(other.1))
        }
        #[inline(always)]
        fn div(self, other: Self) -> Self {
            Self(self.0.div(other.0), self.1.div(other.1))
        }
        #[inline(always)]
        fn mul_sub(self, a: Self, b: Self) -> Self {
            Self(self.0.mul_sub(a.0, b.0), self.1.mul_sub(a.1, b.1))
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(self.0.min(other.0), self.1.min(other.1))
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(self.0.max(other.0), self.1.max(other.1))
        }
        #[inline(always)]
        fn lt(self, other: Self) -> u32 {
            self.0.lt(other.0) | self.1.lt(other.1) << F8::N
        }
        #[inline(always)]
        fn le(self, other: Self) -> u32 {
            self.0.le(other.0) | self.1.le(other.1) << F8::N
        }
        #[inline(always)]
        fn eq(self, other: Self) -> u32 {
            self.0.eq(other.0) | self.1.eq(other.1) << F8::N
        }
        #[inline(always)]
        fn blend(self, other: Self, mask: u32) -> Self {
            Self(self.0.blend(other.0, mask & F8::ALL), self.1.blend(other.1, mask >> F8::N))
        }
        #[inline(always)]
        fn least(self) -> f32 {
            self.0.min(self.1).least()
        }
        #[inline(always)]
        fn greatest(self) -> f32 {
            self.0.max(self.1).greatest()
        }
    }
}

//! Lanes in the registers of x86-64 processors.
#![expect(unsafe_code, reason = "register intrinsics; see the safety notes")]

use std::arch::x86_64::*;

use crate::geometry::lanes::Lanes;

/// Processors with AVX2 and FMA.
pub(in crate::geometry) struct Avx2;

/// Processors with AVX-512 F and VL.
pub(in crate::geometry) struct Avx512;

/// Four lanes.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct F4(__m128);
/// Eight lanes.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct F8(__m256);
/// Sixteen lanes.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct F16(__m512);
/// Four lanes of f64.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct D4(__m256d);
/// Eight lanes of f64.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct D8(__m512d);
/// Twice as many lanes in two registers.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct Pair<L>(L, L);

// SAFETY, for every block below and in the modules of this one: the types are named only through `Avx2`, which has F4, F8, D4 and
// pairs of them, and `Avx512`, which has all; and code that is generic over those two runs only
// inside functions that enable their features after asking the processor (`wide_bvh::dispatch`).
// Loads and stores are of slices whose length is checked first, or of arrays.

macro_rules! operations {
    ($($name:ident = $intrinsic:ident;)+) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> Self {
            Self(unsafe { $intrinsic(self.0, other.0) })
        }
    )+};
}

macro_rules! memory {
    ($n:literal $splat:ident $load:ident $store:ident) => {
        #[inline(always)]
        fn splat(x: f32) -> Self {
            Self(unsafe { $splat(x) })
        }
        #[inline(always)]
        fn load(from: &[f32]) -> Self {
            let from = &from[..$n];
            Self(unsafe { $load(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f32]) {
            let to = &mut to[..$n];
            unsafe { $store(to.as_mut_ptr(), self.0) }
        }
    };
}

// After the macros, which they use too.
mod doubles;
mod isa;

impl Lanes for F4 {
    const N: usize = 4;
    type Double = D4;

    memory!(4 _mm_set1_ps _mm_loadu_ps _mm_storeu_ps);
    operations! {
        add = _mm_add_ps;
        sub = _mm_sub_ps;
        mul = _mm_mul_ps;
        div = _mm_div_ps;
        min = _mm_min_ps;
        max = _mm_max_ps;
    }
    #[inline(always)]
    fn mul_sub(self, a: Self, b: Self) -> Self {
        Self(unsafe { _mm_fmsub_ps(self.0, a.0, b.0) })
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
    fn blend(self, other: Self, mask: u32) -> Self {
        Self(unsafe {
            let bits = _mm_setr_epi32(1, 2, 4, 8);
            let set = _mm_and_si128(_mm_set1_epi32(mask as i32), bits);
            _mm_blendv_ps(self.0, other.0, _mm_castsi128_ps(_mm_cmpeq_epi32(set, bits)))
        })
    }
    #[inline(always)]
    fn widened(self) -> D4 {
        D4(unsafe { _mm256_cvtps_pd(self.0) })
    }
}

impl Lanes for F8 {
    const N: usize = 8;
    type Double = Pair<D4>;

    memory!(8 _mm256_set1_ps _mm256_loadu_ps _mm256_storeu_ps);
    operations! {
        add = _mm256_add_ps;
        sub = _mm256_sub_ps;
        mul = _mm256_mul_ps;
        div = _mm256_div_ps;
        min = _mm256_min_ps;
        max = _mm256_max_ps;
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
    fn blend(self, other: Self, mask: u32) -> Self {
        Self(unsafe { _mm256_blendv_ps(self.0, other.0, _mm256_castsi256_ps(lanes_of(mask))) })
    }
    #[inline(always)]
    fn widened(self) -> Pair<D4> {
        unsafe {
            let upper = _mm256_extractf128_ps::<1>(self.0);
            let lower = _mm256_castps256_ps128(self.0);
            Pair(D4(_mm256_cvtps_pd(lower)), D4(_mm256_cvtps_pd(upper)))
        }
    }
}

/// Eight lanes of which all bits are set where the mask's are.
#[inline(always)]
fn lanes_of(mask: u32) -> __m256i {
    unsafe {
        let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(mask as i32), bits), bits)
    }
}

impl Lanes for F16 {
    const N: usize = 16;
    type Double = Pair<D8>;

    memory!(16 _mm512_set1_ps _mm512_loadu_ps _mm512_storeu_ps);
    operations! {
        add = _mm512_add_ps;
        sub = _mm512_sub_ps;
        mul = _mm512_mul_ps;
        div = _mm512_div_ps;
        min = _mm512_min_ps;
        max = _mm512_max_ps;
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
    #[inline(always)]
    fn widened(self) -> Pair<D8> {
        unsafe {
            let upper = _mm512_extractf64x4_pd::<1>(_mm512_castps_pd(self.0));
            let lower = _mm512_castps512_ps256(self.0);
            Pair(D8(_mm512_cvtps_pd(lower)), D8(_mm512_cvtps_pd(_mm256_castpd_ps(upper))))
        }
    }
}

impl Lanes for Pair<F8> {
    const N: usize = 16;
    type Double = Pair<Pair<D4>>;

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
    fn add(self, other: Self) -> Self {
        Self(self.0.add(other.0), self.1.add(other.1))
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
    fn blend(self, other: Self, mask: u32) -> Self {
        Self(self.0.blend(other.0, mask & F8::ALL), self.1.blend(other.1, mask >> F8::N))
    }
    #[inline(always)]
    fn widened(self) -> Pair<Pair<D4>> {
        Pair(self.0.widened(), self.1.widened())
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

//! Lanes in the registers of x86-64 processors.
#![expect(unsafe_code, reason = "register intrinsics; see the safety notes")]

use std::arch::x86_64::*;

use crate::geometry::lanes::{DoubleLanes, Isa, Lanes};

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

// SAFETY, for every block below: the types are named only through `Avx2`, which has F4, F8, D4 and
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

impl DoubleLanes for D4 {
    type Single = F4;

    operations! {
        add = _mm256_add_pd;
        sub = _mm256_sub_pd;
        mul = _mm256_mul_pd;
        div = _mm256_div_pd;
    }
    #[inline(always)]
    fn signs(self) -> (u32, u32) {
        unsafe {
            let zero = _mm256_setzero_pd();
            let below = _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, zero);
            let above = _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, zero);
            (_mm256_movemask_pd(below) as u32, _mm256_movemask_pd(above) as u32)
        }
    }
    #[inline(always)]
    fn narrowed(self) -> F4 {
        F4(unsafe { _mm256_cvtpd_ps(self.0) })
    }
}

impl DoubleLanes for D8 {
    type Single = F8;

    operations! {
        add = _mm512_add_pd;
        sub = _mm512_sub_pd;
        mul = _mm512_mul_pd;
        div = _mm512_div_pd;
    }
    #[inline(always)]
    fn signs(self) -> (u32, u32) {
        unsafe {
            let zero = _mm512_setzero_pd();
            let below = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, zero);
            let above = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, zero);
            (u32::from(below), u32::from(above))
        }
    }
    #[inline(always)]
    fn narrowed(self) -> F8 {
        F8(unsafe { _mm512_cvtpd_ps(self.0) })
    }
}

/// Two halves of f64 lanes, whose f32 lanes join to those of the whole.
macro_rules! double_pair {
    ($half:ty, $n:literal, $single:ty, $join:path) => {
        impl DoubleLanes for Pair<$half> {
            type Single = $single;

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
            fn signs(self) -> (u32, u32) {
                let ((below, above), (below_1, above_1)) = (self.0.signs(), self.1.signs());
                (below | below_1 << $n, above | above_1 << $n)
            }
            #[inline(always)]
            fn narrowed(self) -> $single {
                $join(self.0.narrowed(), self.1.narrowed())
            }
        }
    };
}

double_pair!(D4, 4, F8, joined_8);
double_pair!(D8, 8, F16, joined_16);
double_pair!(Pair<D4>, 8, Pair<F8>, Pair);

#[inline(always)]
fn joined_8(lower: F4, upper: F4) -> F8 {
    F8(unsafe { _mm256_set_m128(upper.0, lower.0) })
}

#[inline(always)]
fn joined_16(lower: F8, upper: F8) -> F16 {
    F16(unsafe {
        let lower = _mm512_castpd256_pd512(_mm256_castps_pd(lower.0));
        _mm512_castpd_ps(_mm512_insertf64x4::<1>(lower, _mm256_castps_pd(upper.0)))
    })
}

/// Fetches the lines of a value.
#[inline(always)]
fn prefetch<T>(value: &T) {
    const LINE: usize = 64;
    let start = std::ptr::from_ref(value).cast::<i8>();
    for offset in (0..size_of::<T>()).step_by(LINE) {
        // SAFETY: the address is inside the value; a fetch changes nothing but the cache.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(offset)) }
    }
}

#[inline(always)]
fn row(rows: &[[f32; 8]; 6], row: usize) -> F8 {
    debug_assert!(row < rows.len(), "row {row}");
    // SAFETY: callers give 0..6, which debug builds check.
    F8(unsafe { _mm256_loadu_ps(rows.get_unchecked(row).as_ptr()) })
}

/// Sorts eight keys, and what belongs to them by the lowest three bits of a key.
///
/// Source: K. E. Batcher, "Sorting Networks and Their Applications", AFIPS 1968 (bitonic sorter).
#[inline(always)]
fn sort(mut keys: __m256i, children: &[u32; 8], to: &mut [u32; 8], references: &mut [u32; 8]) {
    macro_rules! stage {
        ($swapped:expr, $greater:literal) => {{
            let swapped = $swapped;
            let (low, high) = (_mm256_min_epu32(keys, swapped), _mm256_max_epu32(keys, swapped));
            keys = _mm256_blend_epi32::<$greater>(low, high);
        }};
    }
    unsafe {
        stage!(_mm256_shuffle_epi32::<0xB1>(keys), 0b0110_0110);
        stage!(_mm256_shuffle_epi32::<0x4E>(keys), 0b0011_1100);
        stage!(_mm256_shuffle_epi32::<0xB1>(keys), 0b0101_1010);
        stage!(_mm256_permute2x128_si256::<1>(keys, keys), 0b1111_0000);
        stage!(_mm256_shuffle_epi32::<0x4E>(keys), 0b1100_1100);
        stage!(_mm256_shuffle_epi32::<0xB1>(keys), 0b1010_1010);
        let children = _mm256_loadu_si256(children.as_ptr().cast());
        let sorted = _mm256_permutevar8x32_epi32(children, keys);
        _mm256_storeu_si256(to.as_mut_ptr().cast(), keys);
        _mm256_storeu_si256(references.as_mut_ptr().cast(), sorted);
    }
}

/// The keys of parameters, with the number of their lane; the highest where the mask is not set.
#[inline(always)]
fn keys(enter: F8, hits: __m256i) -> __m256i {
    unsafe {
        let rounded = _mm256_or_si256(_mm256_castps_si256(enter.0), _mm256_set1_epi32(7));
        let keys = _mm256_sub_epi32(_mm256_set1_epi32(0x7FFF_FFFF), rounded);
        let numbered = _mm256_or_si256(keys, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
        _mm256_or_si256(numbered, _mm256_xor_si256(hits, _mm256_set1_epi32(-1)))
    }
}

impl Isa for Avx2 {
    type F4 = F4;
    type F8 = F8;
    type F16 = Pair<F8>;

    #[inline(always)]
    fn row(rows: &[[f32; 8]; 6], index: usize) -> F8 {
        row(rows, index)
    }
    #[inline(always)]
    fn prefetch<T>(value: &T) {
        prefetch(value);
    }
    #[inline(always)]
    fn push_sorted(
        enter: F8,
        hits: u32,
        children: &[u32; 8],
        to: &mut [u32; 8],
        references: &mut [u32; 8],
    ) {
        sort(keys(enter, lanes_of(hits)), children, to, references);
    }
    #[inline(always)]
    fn push_unsorted(hits: u32, children: &[u32; 8], references: &mut [u32; 8]) {
        // The numbers of the lanes, those of set bits first.
        const ORDERS: [[u8; 8]; 256] = {
            let mut orders = [[0; 8]; 256];
            let mut mask = 0;
            while mask < 256 {
                let (mut n, mut lane) = (0, 0);
                while lane < 8 {
                    if mask >> lane & 1 == 1 {
                        orders[mask][n] = lane as u8;
                        n += 1;
                    }
                    lane += 1;
                }
                mask += 1;
            }
            orders
        };
        unsafe {
            let order = _mm_loadl_epi64(ORDERS[(hits & 255) as usize].as_ptr().cast());
            let children = _mm256_loadu_si256(children.as_ptr().cast());
            let packed = _mm256_permutevar8x32_epi32(children, _mm256_cvtepu8_epi32(order));
            _mm256_storeu_si256(references.as_mut_ptr().cast(), packed);
        }
    }
}

impl Isa for Avx512 {
    type F4 = F4;
    type F8 = F8;
    type F16 = F16;

    #[inline(always)]
    fn row(rows: &[[f32; 8]; 6], index: usize) -> F8 {
        row(rows, index)
    }
    #[inline(always)]
    fn prefetch<T>(value: &T) {
        prefetch(value);
    }
    #[inline(always)]
    fn push_sorted(
        enter: F8,
        hits: u32,
        children: &[u32; 8],
        to: &mut [u32; 8],
        references: &mut [u32; 8],
    ) {
        let hits = unsafe { _mm256_maskz_set1_epi32(hits as u8, -1) };
        sort(keys(enter, hits), children, to, references);
    }
    #[inline(always)]
    fn push_unsorted(hits: u32, children: &[u32; 8], references: &mut [u32; 8]) {
        unsafe {
            let children = _mm256_loadu_si256(children.as_ptr().cast());
            let packed = _mm256_maskz_compress_epi32(hits as u8, children);
            _mm256_storeu_si256(references.as_mut_ptr().cast(), packed);
        }
    }
}

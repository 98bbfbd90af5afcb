//! What each kind of processor does in its own way.

use std::arch::x86_64::*;

use super::{Avx2, Avx512, F4, F8, F16, Pair, lanes_of};
use crate::geometry::lanes::Isa;

// SAFETY, for every block below: see the module above.

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
    /// For each half of the result the places in a half, and which half.
    type Four = [(__m256i, __m256); 2];

    #[inline(always)]
    fn four(lanes: [usize; 4]) -> [(__m256i, __m256); 2] {
        let half = |a: usize, b: usize| unsafe {
            let (a, b) = (a as i32, b as i32);
            let places = _mm256_setr_epi32(a, a, a, a, b, b, b, b);
            // The bit of the upper half becomes the sign.
            (places, _mm256_castsi256_ps(_mm256_slli_epi32::<28>(places)))
        };
        [half(lanes[0], lanes[1]), half(lanes[2], lanes[3])]
    }
    #[inline(always)]
    fn each_four_times(from: Pair<F8>, which: [(__m256i, __m256); 2]) -> Pair<F8> {
        let half = |(places, is_upper): (__m256i, __m256)| unsafe {
            let lower = _mm256_permutevar8x32_ps(from.0.0, places);
            let upper = _mm256_permutevar8x32_ps(from.1.0, places);
            F8(_mm256_blendv_ps(lower, upper, is_upper))
        };
        Pair(half(which[0]), half(which[1]))
    }
    #[inline(always)]
    fn repeated(four: &[f32; 4]) -> Pair<F8> {
        let twice = F8(unsafe {
            let four = _mm_loadu_ps(four.as_ptr());
            _mm256_set_m128(four, four)
        });
        Pair(twice, twice)
    }
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
    type Four = __m512i;

    #[inline(always)]
    fn four(lanes: [usize; 4]) -> __m512i {
        let [a, b, c, d] = lanes.map(|lane| lane as i32);
        unsafe {
            let which = _mm512_castsi128_si512(_mm_setr_epi32(a, b, c, d));
            let quads = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
            _mm512_permutexvar_epi32(quads, which)
        }
    }
    #[inline(always)]
    fn each_four_times(from: F16, which: __m512i) -> F16 {
        F16(unsafe { _mm512_permutexvar_ps(which, from.0) })
    }
    #[inline(always)]
    fn repeated(four: &[f32; 4]) -> F16 {
        F16(unsafe { _mm512_broadcast_f32x4(_mm_loadu_ps(four.as_ptr())) })
    }
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

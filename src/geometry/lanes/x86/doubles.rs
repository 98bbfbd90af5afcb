//! Lanes of f64, and what joins their halves.

use std::arch::x86_64::*;

use super::{D4, D8, F4, F8, F16, Pair};
use crate::geometry::lanes::DoubleLanes;

// SAFETY, for every block below: see the module above.

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

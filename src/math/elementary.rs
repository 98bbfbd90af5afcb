//! Elementary functions without branches, so that loops over them become lanes.
//!
//! Products and sums in a fixed order: the same bits on every machine, as those of
//! [`crate::math::portable`], which serve where speed does not matter.
//!
//! Sources: S. Moshier, "Cephes Mathematical Library", 1989 (f32); Sun Microsystems, "Freely
//! Distributable LIBM", 1993 (f64): reductions and coefficients.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};

/// Sine and cosine in f32 for |x| <= π/4, within 1e-7.
#[inline(always)]
pub fn sin_cos_octant(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = ((-1.951_529_6e-4 * z + 8.332_161e-3) * z - 1.666_665_5e-1) * z * x + x;
    let cos = ((2.443_315_7e-5 * z - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z - 0.5 * z + 1.0;
    (sin, cos)
}

/// Sine and cosine in f32 of `turns` · 2π, for |turns| <= 1e5; within 2e-7 where a turn is exact.
#[inline(always)]
pub fn sin_cos_turns(turns: f32) -> (f32, f32) {
    // To the nearest quarter; the difference is exact.
    const ROUND: f32 = 12_582_912.0;
    let shifted = turns * 4.0 + ROUND;
    let quarter = shifted.to_bits();
    let within = turns - (shifted - ROUND) * 0.25;
    let (sin, cos) = sin_cos_octant(within * std::f32::consts::TAU);
    let (a, b) = if quarter & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let sign = |x: f32, bit: u32| f32::from_bits(x.to_bits() ^ (bit & 2) << 30);
    (sign(a, quarter), sign(b, quarter + 1))
}

/// e^x in f32, within 2 units in the last place; 0 below -104, infinite above 88.8.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    const ROUND: f32 = 12_582_912.0;
    // Beyond these the result is 0 and infinite all the same; NaN becomes 0.
    let x = if x > -105.0 { x } else { -105.0 };
    let x = if x < 89.0 { x } else { 89.0 };
    let n = (x * std::f32::consts::LOG2_E + ROUND) - ROUND;
    let r = (x - n * 0.693_359_4) + n * 2.121_944_4e-4;
    let mut sum = 1.987_569_1e-4;
    for term in [1.398_2e-3, 8.333_452e-3, 4.166_579_6e-2, 1.666_666_5e-1, 5.0e-1] {
        sum = sum * r + term;
    }
    let value = sum * (r * r) + r + 1.0;
    // In two steps, so that neither power leaves the range of normal numbers.
    let power = |n: i32| f32::from_bits(((n + 127) as u32) << 23);
    let n = n as i32;
    let half = n >> 1;
    value * power(half) * power(n - half)
}

/// The natural logarithm in f32 of 1e-30 < x <= 1, within 2 units in the last place or 1e-7.
#[inline(always)]
pub fn ln_of_share(x: f32) -> f32 {
    // x = 2^e m with m in sqrt(1/2)..sqrt(2).
    let shifted = x.to_bits().wrapping_sub(0x3f35_04f3);
    let e = (shifted as i32) >> 23;
    let m = f32::from_bits((shifted & 0x007f_ffff).wrapping_add(0x3f35_04f3)) - 1.0;
    let z = m * m;
    let mut sum = 7.037_683_6e-2;
    for term in [
        -1.151_461e-1,
        1.167_699_9e-1,
        -1.242_014_1e-1,
        1.424_932_3e-1,
        -1.666_805_8e-1,
        2.000_071_5e-1,
        -2.499_999_4e-1,
        3.333_333e-1,
    ] {
        sum = sum * m + term;
    }
    let e = e as f32;
    let fraction = sum * m * z - 2.121_944_4e-4 * e - 0.5 * z;
    m + fraction + 0.693_359_4 * e
}

/// The angle in -π..=π of the point (x, y), within 1e-15; π where both are 0.
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    let (a, b) = (x.abs(), y.abs());
    let is_steep = a < b;
    let (short, long) = if is_steep { (a, b) } else { (b, a) };
    // Beyond π/8, from the diagonal.
    const TAN_PI_8: f64 = 0.414_213_562_373_095_03;
    let is_turned = short > TAN_PI_8 * long;
    let (opposite, adjacent) = if is_turned { (short - long, short + long) } else { (short, long) };
    let t = opposite / adjacent;
    let z = t * t;
    let mut p = 1.628_582_011_536_578_2e-2;
    for term in [
        -3.653_157_274_421_691_6e-2,
        4.976_877_994_615_932e-2,
        -5.833_570_133_790_573_5e-2,
        6.661_073_137_387_531e-2,
        -7.691_876_205_044_83e-2,
        9.090_887_133_436_507e-2,
        -1.111_111_040_546_235_6e-1,
        1.428_571_427_250_346_6e-1,
        -1.999_999_999_987_648_3e-1,
        3.333_333_333_333_293e-1,
    ] {
        p = p * z + term;
    }
    let angle = t - t * z * p;
    let angle = if is_turned { angle + FRAC_PI_4 } else { angle };
    let angle = if is_steep { FRAC_PI_2 - angle } else { angle };
    let angle = if x > 0.0 { angle } else { PI - angle };
    // Not a number where both are 0.
    let angle = if long > 0.0 { angle } else { PI };
    angle.copysign(y)
}

/// Sine and cosine in f64 for |x| <= 1e5, within 1e-15.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let shifted = x * FRAC_2_PI + ROUND;
    let n = shifted - ROUND;
    let quarter = shifted.to_bits();
    let r = (x - n * 1.570_796_326_734_125_6) - n * 6.077_100_506_506_192e-11;
    let z = r * r;
    let mut s = 1.589_690_995_211_55e-10;
    for term in [
        -2.505_076_025_340_686_3e-8,
        2.755_731_370_707_006_8e-6,
        -1.984_126_982_985_795e-4,
        8.333_333_333_322_49e-3,
        -1.666_666_666_666_663_2e-1,
    ] {
        s = s * z + term;
    }
    let sin = r + r * z * s;
    let mut c = -1.135_964_755_778_819_5e-11;
    for term in [
        2.087_572_321_298_175e-9,
        -2.755_731_435_139_066_3e-7,
        2.480_158_728_947_673e-5,
        -1.388_888_888_887_411e-3,
        4.166_666_666_666_66e-2,
    ] {
        c = c * z + term;
    }
    let cos = 1.0 - 0.5 * z + z * z * c;
    let (a, b) = if quarter & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let sign = |x: f64, bit: u64| f64::from_bits(x.to_bits() ^ (bit & 2) << 62);
    (sign(a, quarter), sign(b, quarter.wrapping_add(1)))
}

/// The largest integer that is not above x; 0 has no sign.
#[inline(always)]
pub fn floor(x: f64) -> f64 {
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const ALL_INTEGERS: f64 = 2_251_799_813_685_248.0;
    let nearest = (x + ROUND) - ROUND;
    let below = if nearest > x { nearest - 1.0 } else { nearest };
    if x.abs() < ALL_INTEGERS { below } else { x }
}

/// sin(π x) for any finite x, within 1e-15.
#[inline(always)]
pub fn sin_half_turns(x: f64) -> f64 {
    let within = x - 2.0 * floor(0.5 * x + 0.5);
    sin_cos(PI * within).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::portable;

    /// The largest of `error(i)` over many i in 0..=1.
    fn worst(error: impl Fn(f64) -> f64) -> f64 {
        (0..=200_000).map(|i| error(f64::from(i) / 200_000.0)).fold(0.0, f64::max)
    }

    #[test]
    fn functions_in_single_precision_are_exact_to_their_bounds() {
        let octant = worst(|s| {
            let x = ((2.0 * s - 1.0) * 0.25 * PI) as f32;
            let (sin, cos) = sin_cos_octant(x);
            let x = f64::from(x);
            (f64::from(sin) - portable::sin_f64(x))
                .abs()
                .max((f64::from(cos) - portable::cos_f64(x)).abs())
        });
        assert!(octant < 1e-7, "{octant}");
        let turns = worst(|s| {
            let x = (4.0 * s - 2.0) as f32;
            let (sin, cos) = sin_cos_turns(x);
            let x = 2.0 * PI * f64::from(x);
            (f64::from(sin) - portable::sin_f64(x))
                .abs()
                .max((f64::from(cos) - portable::cos_f64(x)).abs())
        });
        assert!(turns < 4e-7, "{turns}");
        let exponential = worst(|s| {
            let x = (-87.0 + 175.0 * s) as f32;
            let truth = portable::exp_f64(f64::from(x));
            (f64::from(exp(x)) / truth - 1.0).abs()
        });
        assert!(exponential < 2.4e-7, "{exponential}");
        let ln = worst(|s| {
            let x = (s + 1e-30) as f32;
            let truth = libm::log(f64::from(x));
            (f64::from(ln_of_share(x)) - truth).abs() / truth.abs().max(1.0)
        });
        assert!(ln < 2.4e-7, "{ln}");
    }

    #[test]
    fn functions_in_double_precision_are_exact_to_their_bounds() {
        let arc = worst(|s| {
            // Of every length.
            let (angle, length) = (2.0 * PI * s - PI, 10.0_f64.powf(4.0 * (s * 1e4).fract() - 2.0));
            let (x, y) = (length * portable::cos_f64(angle), length * portable::sin_f64(angle));
            (atan2(y, x) - portable::atan2_f64(y, x)).abs()
        });
        assert!(arc < 1e-15, "{arc}");
        let turns = worst(|s| {
            let x = 20.0 * s - 10.0;
            let (sin, cos) = sin_cos(x);
            (sin - portable::sin_f64(x)).abs().max((cos - portable::cos_f64(x)).abs())
        });
        assert!(turns < 1e-15, "{turns}");
    }

    #[test]
    fn integers_below_and_sines_of_half_turns() {
        for x in [0.0, 0.5, -0.5, 1.0, -1.0, 2.999_999, -7.25, 1e15 + 0.5, -1e15 - 0.5, 1e300] {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
        for (x, expected) in
            [(0.5, 1.0), (-0.5, -1.0), (100.5, 1.0), (1e9 + 1.5, -1.0), (3e15, 0.0)]
        {
            assert!((sin_half_turns(x) - expected).abs() < 1e-15, "{x}");
        }
        let error = worst(|s| {
            let x = 6.0 * s - 3.0;
            (sin_half_turns(x) - portable::sin_f64(PI * x)).abs()
        });
        // The product of the comparison is rounded.
        assert!(error < 2e-15, "{error}");
    }

    #[test]
    fn ends_of_their_ranges() {
        for (x, expected) in [(0.0, 1.0), (-200.0, 0.0), (f32::NEG_INFINITY, 0.0), (-1e30, 0.0)] {
            assert_eq!(exp(x), expected, "e^{x}");
        }
        assert_eq!(exp(1e9), f32::INFINITY);
        assert!(0.0 < exp(-100.0), "denormal, not 0");
        assert_eq!(ln_of_share(1.0), 0.0);
        assert_eq!(sin_cos_turns(0.25), (1.0, sin_cos_turns(0.25).1));
        assert_eq!(sin_cos_turns(0.5).1, -1.0);
        assert_eq!((atan2(0.0, 2.0), atan2(-0.0, -2.0)), (0.0, -PI));
        assert_eq!((atan2(3.0, 0.0), atan2(-1e-300, 0.0)), (FRAC_PI_2, -FRAC_PI_2));
        assert_eq!((atan2(0.0, 0.0), atan2(1e300, 1e300)), (PI, FRAC_PI_4));
    }
}

//! Logarithm and power of two without branches, so that loops over them become lanes.
//!
//! Relative error below 3e-7: enough for what is rounded to 8 bits. Only sums, products and one
//! division, so the bits are the same everywhere.

/// Logarithm to base 2 of a normal positive number.
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    // x = 2^e m with m in [√½, √2), then the series of the inverse hyperbolic tangent.
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let shifted = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let e = (shifted as i32) >> 23;
    let m = f32::from_bits((shifted & 0x007f_ffff).wrapping_add(SQRT_HALF_BITS));
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    const TWO_OVER_LN_2: f32 = 2.0 * std::f32::consts::LOG2_E;
    let series = 1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0 + s2 * (1.0 / 9.0))));
    e as f32 + TWO_OVER_LN_2 * s * series
}

/// 2 to the x, for x within ±126; clamped beyond.
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    // Adding 1.5 * 2^23 rounds to the nearest integer.
    const ROUND: f32 = 12_582_912.0;
    let x = x.clamp(-126.0, 126.0);
    let i = (x + ROUND) - ROUND;
    let f = (x - i) * std::f32::consts::LN_2;
    let tail = 1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0 + f * (1.0 / 5040.0)));
    let series = 1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * tail)));
    f32::from_bits(((i as i32 + 127) as u32) << 23) * series
}

/// x to the y for x >= 0 and y > 0; 0 for x below the smallest normal number.
#[inline(always)]
pub fn pow(x: f32, y: f32) -> f32 {
    let power = exp2(y * log2(x.max(f32::MIN_POSITIVE)));
    if x < f32::MIN_POSITIVE { 0.0 } else { power }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_stay_below_the_promise() {
        let mut x = 1e-20_f32;
        while x < 1e20 {
            let exact = f64::from(x).log2();
            let error = (f64::from(log2(x)) - exact).abs() / exact.abs().max(1.0);
            assert!(error < 3e-7, "log2({x}) is off by {error}");
            x *= 1.0137;
        }
        for i in -12_000..12_000 {
            let x = i as f32 * 0.01;
            let error = f64::from(exp2(x)) / f64::from(x).exp2() - 1.0;
            assert!(error.abs() < 3e-7, "exp2({x}) is off by {error}");
        }
    }

    #[test]
    fn powers_of_nothing_are_nothing() {
        assert_eq!(pow(0.0, 2.2), 0.0, "0 to the 2.2");
        assert_eq!(pow(1.0, 2.2), 1.0, "1 to the 2.2");
    }
}

//! Decimal numbers to the nearest `f32`, fast.

/// Powers of ten that an `f64` holds exactly.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Reads the number at the start of `bytes`: its value rounded to nearest, and its length. `None`
/// where there is none, or where only the slow, general way is sure of the last bit.
///
/// A mantissa below 2^53 and a power of ten up to 10^22 are both exact in `f64`, so that one
/// multiplication or division rounds correctly (W. Clinger, "How to Read Floating Point Numbers
/// Accurately", PLDI 1990). Rounding that once more to `f32` goes wrong only where it falls
/// exactly between two of them.
#[inline]
pub(super) fn read_f32(bytes: &[u8]) -> Option<(f32, usize)> {
    let mut at = 0;
    let negative = bytes.first() == Some(&b'-');
    if negative || bytes.first() == Some(&b'+') {
        at = 1;
    }
    let mut mantissa = 0_u64;
    let n_whole = read_digits(bytes, &mut at, &mut mantissa);
    let mut n_fraction = 0;
    if bytes.get(at) == Some(&b'.') {
        at += 1;
        n_fraction = read_digits(bytes, &mut at, &mut mantissa);
    }
    // 19 digits always fit into 64 bits.
    if !(1..=19).contains(&(n_whole + n_fraction)) {
        return None;
    }
    let mut exponent = -(n_fraction as i32);
    if let Some(b'e' | b'E') = bytes.get(at) {
        at += 1;
        exponent += read_exponent(bytes, &mut at)?;
    }
    let power = EXACT_POWERS.get(exponent.unsigned_abs() as usize)?;
    if mantissa >= 1 << 53 {
        return None;
    }
    let magnitude = if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power };
    let rounds_once = magnitude.to_bits() & 0x1fff_ffff != 0x1000_0000;
    let is_normal = magnitude == 0.0
        || (f64::from(f32::MIN_POSITIVE) <= magnitude && magnitude <= f64::from(f32::MAX));
    if !rounds_once || !is_normal {
        return None;
    }
    let value = magnitude as f32;
    Some((if negative { -value } else { value }, at))
}

/// Appends the decimal digits at `at` to `mantissa` (which may wrap); how many there were.
#[inline]
fn read_digits(bytes: &[u8], at: &mut usize, mantissa: &mut u64) -> usize {
    let start = *at;
    while let Some(byte) = bytes.get(*at) {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        *at += 1;
    }
    *at - start
}

/// The signed integer at `at`, of one to three digits.
fn read_exponent(bytes: &[u8], at: &mut usize) -> Option<i32> {
    let negative = bytes.get(*at) == Some(&b'-');
    if negative || bytes.get(*at) == Some(&b'+') {
        *at += 1;
    }
    let mut magnitude = 0;
    let n_digits = read_digits(bytes, at, &mut magnitude);
    if !(1..=3).contains(&n_digits) {
        return None;
    }
    let magnitude = magnitude as i32;
    Some(if negative { -magnitude } else { magnitude })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    #[track_caller]
    fn assert_like_std(text: &str) {
        if let Some((value, length)) = read_f32(text.as_bytes()) {
            let expected: f32 = text[..length].parse().unwrap();
            assert_eq!(value.to_bits(), expected.to_bits(), "{text}: {value:e}, not {expected:e}");
        }
    }

    #[test]
    fn common_spellings_take_the_fast_way() {
        for text in ["0", "-0", "1", "-1.5", "+.5", "5.", "0.008178", "1e-6", "1.5E+3", "123456789"]
        {
            let (value, length) = read_f32(text.as_bytes()).unwrap();
            assert_eq!(length, text.len());
            assert_eq!(value.to_bits(), text.parse::<f32>().unwrap().to_bits(), "{text}");
        }
    }

    #[test]
    fn what_is_not_a_number_is_left_to_others() {
        for text in ["", "-", ".", "e5", "1e", "1e+", "nan", "inf", "--1", "1e9999"] {
            assert_eq!(read_f32(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn numbers_between_two_floats_are_not_rounded_twice() {
        // 1 + 2^-24 is half way between 1 and its successor; a nudge decides.
        for text in
            ["1.000000059604644775", "1.0000000596046448", "1.00000017881393433", "16777217"]
        {
            assert_like_std(text);
        }
        assert_eq!(read_f32(b"16777217"), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            rng_seed: RngSeed::Fixed(1),
            failure_persistence: None,
            ..ProptestConfig::default()
        })]

        #[test]
        fn every_number_is_rounded_to_nearest(
            sign in "[-+]?", whole in "[0-9]{0,12}", fraction in "(\\.[0-9]{0,12})?",
            exponent in "([eE][-+]?[0-9]{1,3})?",
        ) {
            assert_like_std(&format!("{sign}{whole}{fraction}{exponent}"));
        }

        #[test]
        fn floats_come_back_as_written(bits in any::<u32>()) {
            let value = f32::from_bits(bits);
            assert_like_std(&format!("{value}"));
            assert_like_std(&format!("{value:e}"));
            assert_like_std(&format!("{value:.6}"));
        }
    }
}

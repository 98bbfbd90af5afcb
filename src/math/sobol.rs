//! Owen-scrambled Sobol points in two dimensions, computed from an index alone.
//!
//! The first two Sobol dimensions form a (0, 2)-sequence: any 2^k successive aligned points fall
//! one to each elementary interval. Scrambling keeps that and makes every point uniform.

/// First Sobol dimension of `index`: van der Corput's sequence, as a 0.32 fixed-point number.
#[inline]
pub fn sobol_0(index: u32) -> u32 {
    index.reverse_bits()
}

/// Second Sobol dimension of `index`, as a 0.32 fixed-point number.
///
/// Its generator matrix is Pascal's triangle modulo 2, a tensor power of [[1, 1], [0, 1]], so five
/// masked shifts multiply by it.
#[inline]
pub fn sobol_1(index: u32) -> u32 {
    let mut x = index.reverse_bits();
    x ^= (x << 1) & 0xaaaa_aaaa;
    x ^= (x << 2) & 0xcccc_cccc;
    x ^= (x << 4) & 0xf0f0_f0f0;
    x ^= (x << 8) & 0xff00_ff00;
    x ^ ((x << 16) & 0xffff_0000)
}

/// Owen's nested uniform scramble of a 0.32 fixed-point number, by a hash in which every bit is
/// flipped depending on the bits above it only.
///
/// Source: S. Laine and T. Karras, "Stratified Sampling for Stochastic Transparency", EGSR 2011;
/// B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020; constants by N. Vegdahl.
#[inline]
pub fn owen_scramble(x: u32, seed: u32) -> u32 {
    laine_karras(x.reverse_bits(), seed).reverse_bits()
}

/// The scramble of [`owen_scramble`] on a number whose bits are in reversed order: each bit depends
/// on those below it.
#[inline]
pub fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_direction_numbers(mut index: u32) -> u32 {
        let (mut direction, mut result) = (1_u32 << 31, 0);
        while index != 0 {
            if index & 1 == 1 {
                result ^= direction;
            }
            direction ^= direction >> 1;
            index >>= 1;
        }
        result
    }

    #[test]
    fn masked_shifts_agree_with_the_direction_numbers() {
        for index in (0..100_000).chain([u32::MAX, 1 << 31, 0x1234_5678]) {
            assert_eq!(sobol_1(index), by_direction_numbers(index), "index {index}");
        }
    }

    /// Every elementary interval of area 1/64 holds exactly one of 64 aligned points.
    #[test]
    fn scrambled_points_are_a_net() {
        for (seed, first) in [(1, 0), (77, 64), (12345, 640)] {
            for bits_x in 0..=6 {
                let bits_y = 6 - bits_x;
                let mut counts = [0; 64];
                for index in first..first + 64 {
                    let x = u64::from(owen_scramble(sobol_0(index), seed)) >> (32 - bits_x);
                    let y = u64::from(owen_scramble(sobol_1(index), seed + 9)) >> (32 - bits_y);
                    counts[(x << bits_y | y) as usize] += 1;
                }
                assert_eq!(counts, [1; 64], "seed {seed}, {bits_x} bits of x");
            }
        }
    }
}

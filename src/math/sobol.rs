//! Owen-scrambled Sobol points in two dimensions, computed from an index alone.
//!
//! The first two Sobol dimensions form a (0, 2)-sequence: any 2^k successive aligned points fall
//! one to each elementary interval. Scrambling keeps that and makes every point uniform.

/// Second Sobol dimension of `index`, with the digit of most weight in bit 0. The first dimension,
/// van der Corput's sequence, written so is the index itself.
///
/// Its generator matrix is Pascal's triangle modulo 2, a tensor power of [[1, 1], [0, 1]], so five
/// masked shifts multiply by it.
#[inline(always)]
pub fn second_dimension(index: u32) -> u32 {
    let mut x = index;
    x ^= (x >> 1) & 0x5555_5555;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^ (x >> 16)
}

/// Owen's nested uniform scramble, by a hash in which every bit is flipped depending on the bits
/// below it only: of a number with the digit of most weight in bit 0.
///
/// Source: S. Laine and T. Karras, "Stratified Sampling for Stochastic Transparency", EGSR 2011;
/// B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020; constants by N. Vegdahl.
#[inline(always)]
pub fn owen_scramble(mut x: u32, seed: u32) -> u32 {
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
            let found = second_dimension(index).reverse_bits();
            assert_eq!(found, by_direction_numbers(index), "index {index}");
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
                    let leading = |x: u32, bits: u32| u64::from(x.reverse_bits()) >> (32 - bits);
                    let x = leading(owen_scramble(index, seed), bits_x);
                    let y = leading(owen_scramble(second_dimension(index), seed + 9), bits_y);
                    counts[(x << bits_y | y) as usize] += 1;
                }
                assert_eq!(counts, [1; 64], "seed {seed}, {bits_x} bits of x");
            }
        }
    }
}

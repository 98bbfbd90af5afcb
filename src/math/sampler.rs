//! Random numbers from (seed, pixel, sample, dimension), without state.
//!
//! Every use of chance in a path has a dimension of its own, and every dimension yields a pair of
//! numbers. With [`Sampler::Sobol`] each pair is a (0, 2)-sequence over the samples of a pixel,
//! scrambled and shuffled independently of every other pair and pixel (padding). So is the choice
//! of one number: the first of a pair.

use crate::math::sobol::{laine_karras, owen_scramble, sobol_1};

/// Where the numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// Owen-scrambled Sobol points.
    Sobol {
        /// Seed of all numbers.
        seed: u32,
    },
    /// Independent numbers.
    Random {
        /// Seed of all numbers.
        seed: u32,
    },
}

/// The pairs of numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct SampleNumbers {
    sampler: Sampler,
    pixel_hash: u32,
    sample: u32,
}

impl Sampler {
    /// The numbers of sample `sample` of the pixel in column `x` and row `y`.
    #[inline]
    pub fn numbers(self, x: u32, y: u32, sample: u32) -> SampleNumbers {
        let seed = match self {
            Self::Sobol { seed } | Self::Random { seed } => seed,
        };
        let pixel_hash = mix(mix(seed ^ 0x9e37_79b9).wrapping_add(x | y << 16));
        SampleNumbers { sampler: self, pixel_hash, sample }
    }
}

impl SampleNumbers {
    /// Two numbers in [0, 1) for one dimension.
    #[inline]
    pub fn pair(&self, dimension: u32) -> [f32; 2] {
        let key = mix(self.pixel_hash ^ dimension.wrapping_mul(0x85eb_ca6b));
        match self.sampler {
            Sampler::Sobol { .. } => {
                // Reversed twice, the index stays as it is: see `owen_scramble` and `sobol_0`.
                let index = laine_karras(self.sample.reverse_bits(), key).reverse_bits();
                let x = laine_karras(index, mix(key ^ 0x68e3_1da4)).reverse_bits();
                let y = owen_scramble(sobol_1(index), mix(key ^ 0xb529_7a4d));
                [unit(x), unit(y)]
            }
            Sampler::Random { .. } => {
                let x = mix(key ^ mix(self.sample ^ 0x68e3_1da4));
                [unit(x), unit(mix(x ^ key.rotate_left(16)))]
            }
        }
    }
}

/// A number in [0, 1) from the upper 24 bits.
#[inline]
fn unit(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A bijection of 32 bits in which every input bit changes about half of the output bits.
///
/// Source: the "lowbias32" constants of C. Wellons, "Prospecting for Hash Functions", 2018.
#[inline]
pub fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sobol_pairs_are_stratified_over_the_samples_of_a_pixel() {
        let sampler = Sampler::Sobol { seed: 3 };
        for dimension in [0, 1, 2, 65_537] {
            let mut cells = [0; 256];
            for sample in 256..512 {
                let [x, y] = sampler.numbers(17, 4, sample).pair(dimension);
                cells[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1;
            }
            assert_eq!(cells, [1; 256], "dimension {dimension}");
        }
    }

    /// Chi-square over 16 x 16 cells, and no correlation between dimensions, pixels and samples.
    #[test]
    fn numbers_are_uniform_and_independent() {
        for sampler in [Sampler::Sobol { seed: 9 }, Sampler::Random { seed: 9 }] {
            let mut cells = [0_u32; 256];
            let n = 1 << 16;
            let (mut across_dimensions, mut across_pixels) = (0.0_f64, 0.0_f64);
            for i in 0..n {
                // One sample a pixel, so that the points of both samplers are independent.
                let numbers = sampler.numbers(i % 256, i / 256, 5);
                let [x, y] = numbers.pair(7);
                cells[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1;
                let x = f64::from(x) - 0.5;
                across_dimensions += x * (f64::from(numbers.pair(8)[0]) - 0.5);
                let neighbour = sampler.numbers(i % 256 + 1, i / 256, 5);
                across_pixels += x * (f64::from(neighbour.pair(7)[0]) - 0.5);
            }
            let expected = f64::from(n) / 256.0;
            let chi2: f64 =
                cells.iter().map(|c| (f64::from(*c) - expected).powi(2) / expected).sum();
            assert!((150.0..390.0).contains(&chi2), "{sampler:?}: chi-square {chi2} of 255");
            // Five standard deviations of a sum of n products of variance 1/144.
            let limit = 5.0 * (f64::from(n) / 144.0).sqrt();
            assert!(across_dimensions.abs() < limit, "{sampler:?}: {across_dimensions}");
            assert!(across_pixels.abs() < limit, "{sampler:?}: {across_pixels}");
        }
    }
}

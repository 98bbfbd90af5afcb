//! Random numbers from (seed, pixel, sample, dimension), without state.
//!
//! Every use of chance in a path has a dimension of its own, and every dimension yields a pair of
//! numbers. With [`Sampler::Sobol`] each pair is a (0, 2)-sequence over the samples of a pixel, in an
//! order of its own (padding) but for the first pairs of a path, which are a net together; and the
//! pixels of a block share them out so that their errors cancel (see `math/nets.rs`). So is the choice
//! of one number: the first of a pair.

use crate::math::nets;
use crate::math::sobol::{owen_scramble, second_dimension};
use crate::math::vectorized::{BLOCK, Lane, vectorized};

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
    /// Of the block of pixels for Sobol points, else of the pixel.
    hash: u32,
    /// In its block, in three orders, a byte each: neighbours are first those in a row, a column, a
    /// diagonal.
    places: u32,
    sample: u32,
}

/// Which pairs form a net of four dimensions with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Net {
    /// The first pair of all, in the order of the sequence.
    First,
    /// Pairs that form a net with the first, and with those of the third kind.
    Second,
    /// Pairs that form a net with the first, and with those of the second kind.
    Third,
}

impl Sampler {
    /// The numbers of sample `sample` (below 2^24) of the pixel in column `x` and row `y`.
    #[inline]
    pub fn numbers(self, x: u32, y: u32, sample: u32) -> SampleNumbers {
        let (seed, unit) = match self {
            Self::Sobol { seed } => (seed, nets::BLOCK_SIZE),
            Self::Random { seed } => (seed, 1),
        };
        let hash = mix(mix(seed ^ 0x9e37_79b9).wrapping_add((x / unit) | ((y / unit) << 16)));
        let [row, column, diagonal] =
            [nets::place_of(x, y), nets::place_of(y, x), nets::place_of(x, x ^ y)].map(u32::from);
        let places = row | column << 8 | diagonal << 16;
        SampleNumbers { sampler: self, hash, places, sample }
    }
}

impl SampleNumbers {
    /// Two numbers in [0, 1) for one dimension, in an order of its own.
    #[inline]
    pub fn pair(&self, dimension: u32) -> [f32; 2] {
        match self.sampler {
            Sampler::Sobol { .. } => self.sobol(dimension),
            Sampler::Random { .. } => self.random(dimension),
        }
    }

    /// Two numbers in [0, 1) for one dimension, which are a net with those of other kinds. Numbers of
    /// two dimensions of one kind should not be factors of one product.
    #[inline]
    pub fn joint_pair(&self, dimension: u32, net: Net) -> [f32; 2] {
        match self.sampler {
            Sampler::Sobol { .. } => self.joint(dimension, net),
            Sampler::Random { .. } => self.random(dimension),
        }
    }

    /// The same for the next samples of the same pixel.
    #[inline]
    pub(crate) fn of_sample(self, sample: u32) -> Self {
        Self { sample, ..self }
    }

    #[inline(always)]
    fn key(&self, dimension: u32) -> u32 {
        mix(self.hash ^ dimension.wrapping_mul(0x85eb_ca6b))
    }

    #[inline(always)]
    fn sobol(&self, dimension: u32) -> [f32; 2] {
        let key = self.key(dimension);
        let order = mix(key ^ (self.places & 0xff).wrapping_mul(0x9e37_79b9));
        self.point(key, shuffled(self.sample, order))
    }

    #[inline(always)]
    fn joint(&self, dimension: u32, net: Net) -> [f32; 2] {
        let index = match net {
            Net::First => self.sample,
            Net::Second => nets::reordered(0, self.sample),
            Net::Third => nets::reordered(1, self.sample),
        };
        self.point(self.key(dimension), index)
    }

    /// A point of the sequence, shifted by the pixel's place and scrambled as in its whole block.
    #[inline(always)]
    fn point(&self, key: u32, index: u32) -> [f32; 2] {
        // Every dimension sees the block's pixels in another order, so that their errors in two
        // dimensions have nothing to do with each other.
        let order = (key >> 8).wrapping_mul(3) >> 24;
        let place = self.places.wrapping_shr(8 * order) & 0xff;
        let place = owen_scramble(place, mix(key ^ 0x2545_f491)) as u8;
        let [shift_x, shift_y] = nets::shift(place);
        let x = owen_scramble(index ^ shift_x, mix(key ^ 0x68e3_1da4));
        let y = owen_scramble(second_dimension(index) ^ shift_y, mix(key ^ 0xb529_7a4d));
        [unit(x.reverse_bits()), unit(y.reverse_bits())]
    }

    #[inline(always)]
    fn random(&self, dimension: u32) -> [f32; 2] {
        let key = self.key(dimension);
        let x = mix(key ^ mix(self.sample ^ 0x68e3_1da4));
        [unit(x), unit(mix(x ^ key.rotate_left(16)))]
    }
}

/// The numbers of a block of samples.
#[derive(Clone, Debug)]
pub(crate) struct NumbersBlock {
    sampler: Sampler,
    hash: Lane<u32>,
    places: Lane<u32>,
    sample: Lane<u32>,
}

impl NumbersBlock {
    /// Of no samples yet.
    pub(crate) fn new(sampler: Sampler) -> Self {
        Self { sampler, hash: [0; BLOCK], places: [0; BLOCK], sample: [0; BLOCK] }
    }

    /// Sets one sample.
    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, numbers: &SampleNumbers) {
        self.hash[i] = numbers.hash;
        self.places[i] = numbers.places;
        self.sample[i] = numbers.sample;
    }

    /// [`SampleNumbers::joint_pair`] of each, or [`SampleNumbers::pair`] where no net is asked for.
    #[inline]
    pub(crate) fn pairs(&self, dimension: u32, net: Option<Net>, pairs: &mut [Lane<f32>; 2]) {
        match (self.sampler, net) {
            (Sampler::Random { .. }, _) => random_pairs(self, dimension, pairs),
            (Sampler::Sobol { .. }, None) => sobol_pairs(self, dimension, pairs),
            (Sampler::Sobol { .. }, Some(Net::First)) => first_pairs(self, dimension, pairs),
            (Sampler::Sobol { .. }, Some(Net::Second)) => second_pairs(self, dimension, pairs),
            (Sampler::Sobol { .. }, Some(Net::Third)) => third_pairs(self, dimension, pairs),
        }
    }

    /// One of them.
    #[inline(always)]
    fn get(&self, i: usize) -> SampleNumbers {
        let (hash, places, sample) = (self.hash[i], self.places[i], self.sample[i]);
        SampleNumbers { sampler: self.sampler, hash, places, sample }
    }
}

vectorized! {
    fn random_pairs(block: &NumbersBlock, dimension: u32, pairs: &mut [Lane<f32>; 2]) {
        let [u, v] = pairs;
        for i in 0..BLOCK {
            [u[i], v[i]] = block.get(i).random(dimension);
        }
    }
    fn sobol_pairs(block: &NumbersBlock, dimension: u32, pairs: &mut [Lane<f32>; 2]) {
        let [u, v] = pairs;
        for i in 0..BLOCK {
            [u[i], v[i]] = block.get(i).sobol(dimension);
        }
    }
    fn first_pairs(block: &NumbersBlock, dimension: u32, pairs: &mut [Lane<f32>; 2]) {
        let [u, v] = pairs;
        for i in 0..BLOCK {
            [u[i], v[i]] = block.get(i).joint(dimension, Net::First);
        }
    }
    fn second_pairs(block: &NumbersBlock, dimension: u32, pairs: &mut [Lane<f32>; 2]) {
        let [u, v] = pairs;
        for i in 0..BLOCK {
            [u[i], v[i]] = block.get(i).joint(dimension, Net::Second);
        }
    }
    fn third_pairs(block: &NumbersBlock, dimension: u32, pairs: &mut [Lane<f32>; 2]) {
        let [u, v] = pairs;
        for i in 0..BLOCK {
            [u[i], v[i]] = block.get(i).joint(dimension, Net::Third);
        }
    }
}

/// Another order of all indices, in which every block of the first 2^k stays what it is, and aligned
/// blocks stay together.
#[inline(always)]
fn shuffled(index: u32, key: u32) -> u32 {
    // The bits below the highest, as the leading digits of a number.
    let n_bits = 31 - (index | 1).leading_zeros();
    let digits = index.reverse_bits().wrapping_shr(32 - n_bits);
    let digits = owen_scramble(digits, key.wrapping_add(n_bits));
    let shuffled = 1_u32.wrapping_shl(n_bits) | digits.reverse_bits().wrapping_shr(32 - n_bits);
    if index < 2 { index } else { shuffled }
}

/// A number in [0, 1) from the upper 24 bits.
#[inline(always)]
fn unit(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A bijection of 32 bits in which every input bit changes about half of the output bits.
///
/// Source: the "lowbias32" constants of C. Wellons, "Prospecting for Hash Functions", 2018.
#[inline(always)]
pub const fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vectorized::at_every_level;

    const SOBOL: Sampler = Sampler::Sobol { seed: 3 };

    /// All ways to get a pair, by number.
    fn any_pair(numbers: &SampleNumbers, way: u32) -> [f32; 2] {
        match way {
            0 => numbers.joint_pair(0, Net::First),
            1 => numbers.joint_pair(1, Net::Second),
            2 => numbers.joint_pair(16, Net::Third),
            _ => numbers.pair(65_534 + way),
        }
    }

    #[test]
    fn sobol_pairs_are_stratified_over_the_samples_of_a_pixel() {
        for way in 0..6 {
            for first in [0, 256, 512] {
                let mut cells = [0; 256];
                for sample in first..first + 256 {
                    let [x, y] = any_pair(&SOBOL.numbers(17, 4, sample), way);
                    cells[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1;
                }
                assert_eq!(cells, [1; 256], "way {way}, from {first}");
            }
        }
    }

    #[test]
    fn numbers_of_a_block_are_those_of_its_samples() {
        for sampler in [SOBOL, Sampler::Random { seed: 9 }] {
            for (dimension, net) in [
                (0, Some(Net::First)),
                (1, Some(Net::Second)),
                (16, Some(Net::Third)),
                (65_539, None),
            ] {
                let sample = |i: usize| {
                    let i = i as u32;
                    sampler.numbers(7 * i, i * i, if i < 8 { i } else { i * 40_503 })
                };
                let mut block = NumbersBlock::new(sampler);
                (0..BLOCK).for_each(|i| block.set(i, &sample(i)));
                for (level, [u, v]) in at_every_level(|| {
                    let mut pairs = [[0.0; BLOCK]; 2];
                    block.pairs(dimension, net, &mut pairs);
                    pairs
                }) {
                    for i in 0..BLOCK {
                        let one = match net {
                            Some(net) => sample(i).joint_pair(dimension, net),
                            None => sample(i).pair(dimension),
                        };
                        assert_eq!([u[i], v[i]], one, "{level:?}, {net:?}, sample {i}");
                    }
                }
            }
        }
    }

    #[test]
    fn joint_pairs_are_stratified_together() {
        // Of t = 3: boxes of volume 8 / 4096 hold eight points each, whatever their shape.
        let of_two = |a: u32, b: u32| {
            let mut cells = vec![0; 512];
            for sample in 0..4096 {
                let numbers = SOBOL.numbers(17, 4, sample);
                let ([x, y], [z, w]) = (any_pair(&numbers, a), any_pair(&numbers, b));
                let place = |v: f32, n: f32| (v * n) as usize;
                cells[((place(x, 8.0) * 4 + place(y, 4.0)) * 4 + place(z, 4.0)) * 4
                    + place(w, 4.0)] += 1;
            }
            cells
        };
        assert_eq!(of_two(0, 1), [8; 512], "pixel and lens");
        assert_ne!(of_two(0, 3), [8; 512], "the test can fail");
    }

    #[test]
    fn shuffling_keeps_blocks_of_the_first_samples() {
        let mut seen = vec![false; 1 << 12];
        for key in [1, 0xdead_beef] {
            seen.fill(false);
            for index in 0..1_u32 << 12 {
                let shuffled = shuffled(index, key);
                let bits = |index: u32| 32 - index.leading_zeros();
                assert_eq!(bits(shuffled), bits(index), "{index} has become {shuffled}");
                assert!(!std::mem::replace(&mut seen[shuffled as usize], true), "{shuffled} twice");
            }
            let moved = (0..1 << 12).filter(|index| shuffled(*index, key) != *index).count();
            assert!(moved > 4000, "only {moved} of 4096 moved");
        }
    }

    /// Chi-square over 16 x 16 cells, and no correlation between dimensions.
    #[test]
    fn numbers_are_uniform_and_independent() {
        for sampler in [Sampler::Sobol { seed: 9 }, Sampler::Random { seed: 9 }] {
            let mut cells = [0_u32; 256];
            let n = 1 << 16;
            let mut across_dimensions = 0.0_f64;
            for i in 0..n {
                // One pixel a block, so that the points of both samplers are independent.
                let numbers = sampler.numbers(i % 256 * 16 + 3, i / 256 * 16 + 11, 5);
                let [x, y] = numbers.pair(7);
                cells[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1;
                across_dimensions += (f64::from(x) - 0.5) * (f64::from(numbers.pair(8)[0]) - 0.5);
            }
            let expected = f64::from(n) / 256.0;
            let chi2: f64 =
                cells.iter().map(|c| (f64::from(*c) - expected).powi(2) / expected).sum();
            assert!((150.0..390.0).contains(&chi2), "{sampler:?}: chi-square {chi2} of 255");
            // Five standard deviations of a sum of n products of variance 1/144.
            let limit = 5.0 * (f64::from(n) / 144.0).sqrt();
            assert!(across_dimensions.abs() < limit, "{sampler:?}: {across_dimensions}");
        }
    }

    /// The mean over 4 x 4 pixels is far nearer to its expectation than that of independent pixels where
    /// one dimension counts alone. Where only the product of two does it is at most twice as far off, in
    /// squares: two points that are stratified in both dimensions lie on a diagonal.
    #[test]
    fn neighbours_share_the_square_out() {
        let variance = |sampler: Sampler, n_samples: u32, of: fn(f64, f64) -> f64| {
            let mut sum = 0.0;
            for block in 0..4096 {
                let mut mean = 0.0;
                for i in 0..16 * n_samples {
                    let (x, y) = (block % 64 * 4 + i % 4, block / 64 * 4 + i / 4 % 4);
                    let numbers = sampler.numbers(x, y, i / 16);
                    let [a, b] = [numbers.pair(7)[1], numbers.pair(8)[0]].map(f64::from);
                    mean += of(a - 0.5, b - 0.5) / f64::from(16 * n_samples);
                }
                sum += mean * mean / 4096.0;
            }
            sum
        };
        let random = Sampler::Random { seed: 1 };
        for n_samples in [1, 2, 4] {
            let alone = |sampler| variance(sampler, n_samples, |a, _| a);
            let share = alone(SOBOL) / alone(random);
            assert!(share < 0.04, "{n_samples} samples, one dimension: {share}");
            let both = |sampler| variance(sampler, n_samples, |a, b| a * b);
            let share = both(SOBOL) / both(random);
            assert!(share < 2.2, "{n_samples} samples, product of two: {share}");
        }
    }
}

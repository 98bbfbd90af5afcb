//! How far the picture is from the truth, told from the picture alone.
//!
//! *Independent samples*: the variance of a pixel's mean is the variance of its samples over their
//! number.
//!
//! *Sobol points* are better than that. Let V(n) be the variance of the mean of the first n samples,
//! n a power of two. The two halves of those samples are nets of their own with equal variance
//! V(n/2), but not independent: scrambled Sobol points avoid in the second half what the first half
//! covered. The mean squared difference D(n) of the two half means is 4 (V(n/2) - V(n)), whatever
//! the correlation, so V(n) is a quarter of the sum of all D to come: D r / (4 (1 - r)) if D falls
//! by r whenever samples double. The ratio is read off halves and eighths, two doublings apart, pooled
//! over all pixels, and drawn towards that of a discontinuity between two and four dimensions: few
//! pixels may hold most of the error, and what falls fast at first (smooth parts) leaves behind what
//! falls slowly (edges). With it, quarters and eighths tell of D as well as the halves do.

use rayon::prelude::*;

use crate::math::sampler::Sampler;
use crate::render::pixel::PixelSums;

/// The error of a picture, as estimated from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// 100 x the root mean squared error of linear luminance over its mean.
    pub percent: f64,
    /// Standard error of `percent`, as a share of it.
    pub uncertainty: f64,
    /// By how much the squared error falls whenever samples double.
    pub ratio: f64,
}

impl Noise {
    /// How many times the samples so far it takes to come down to `percent`.
    pub fn samples_to(&self, percent: f64) -> f64 {
        libm::pow(self.percent / percent, -2.0 / libm::log2(self.ratio))
    }
}

/// From the sums of all pixels to the variance of the mean of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorModel {
    sampler: Sampler,
    ratio: f64,
}

/// Ratio of the variance when samples double, for independent samples.
const INDEPENDENT: f64 = 0.5;
/// Pixels that are summed at once.
const CHUNK: usize = 4096;

impl ErrorModel {
    /// Reads the ratio off the pixels.
    pub(super) fn new(sampler: Sampler, pixels: &[PixelSums]) -> Self {
        let ratio = match sampler {
            Sampler::Random { .. } => INDEPENDENT,
            Sampler::Sobol { .. } => {
                let [halves, quarters, above, eighths] = sums(pixels, |pixel| {
                    let from = |n: u32, x: f32| {
                        if pixel.n_samples >= n { f64::from(x) } else { 0.0 }
                    };
                    let halves = pixel.between_halves;
                    let (quarters, eighths) = (pixel.between_quarters, pixel.between_eighths);
                    [from(4, halves), from(4, quarters), from(8, halves), from(8, eighths)]
                });
                let has_eighths = eighths > 0.0;
                let two_doublings = (above / eighths).sqrt();
                sobol_ratio(if has_eighths { two_doublings } else { halves / quarters })
            }
        };
        Self { sampler, ratio }
    }

    /// Estimate of the variance of the mean of a pixel's luminance; 0 below two samples.
    pub(super) fn variance(&self, pixel: &PixelSums) -> f64 {
        let n = f64::from(pixel.n_samples);
        if n < 2.0 {
            return 0.0;
        }
        match self.sampler {
            Sampler::Random { .. } => {
                let spread = pixel.squares - pixel.luminance().powi(2) / n;
                spread.max(0.0) / (n * (n - 1.0))
            }
            Sampler::Sobol { .. } => {
                let halves = f64::from(pixel.between_halves);
                let quarters = self.ratio * f64::from(pixel.between_quarters);
                let eighths = self.ratio.powi(2) * f64::from(pixel.between_eighths);
                // One difference of halves, two of quarters, and two of the four of eighths.
                let difference = match pixel.n_samples {
                    ..4 => halves,
                    4..8 => (halves + 2.0 * quarters) / 3.0,
                    8.. => (halves + 2.0 * quarters + 2.0 * eighths) / 5.0,
                };
                let last_power = f64::from(1_u32 << pixel.n_samples.ilog2());
                let at_power = 0.25 * difference * self.ratio / (1.0 - self.ratio);
                at_power * libm::pow(n / last_power, libm::log2(self.ratio))
            }
        }
    }

    /// The figure for a whole picture; `None` where there is none: too few samples, or black.
    pub(super) fn noise(&self, pixels: &[PixelSums]) -> Option<Noise> {
        let [variance, squares, light] = sums(pixels, |pixel| {
            let variance = self.variance(pixel);
            let n = f64::from(pixel.n_samples.max(1));
            [variance, variance.powi(2) * self.spread(pixel), pixel.luminance() / n]
        });
        let n_pixels = pixels.len() as f64;
        let percent = 100.0 * (variance / n_pixels).sqrt() / (light / n_pixels);
        let by_chance = 0.5 * squares.sqrt() / variance.max(f64::MIN_POSITIVE);
        let by_model: f64 = match self.sampler {
            Sampler::Random { .. } => 0.0,
            // What is left where there are pixels enough: see the tests of the gallery.
            Sampler::Sobol { .. } => 0.08,
        };
        let has_two = pixels.first().is_some_and(|pixel| pixel.n_samples >= 2);
        (has_two && percent.is_finite()).then_some(Noise {
            percent,
            uncertainty: by_chance.hypot(by_model),
            ratio: self.ratio,
        })
    }

    /// Variance of an estimated variance over its square: 2 / (d + 2) for d degrees of freedom.
    fn spread(&self, pixel: &PixelSums) -> f64 {
        let freedom = match self.sampler {
            // Rare bright samples make many worth few.
            Sampler::Random { .. } => f64::from(pixel.n_samples - 1).min(16.0),
            Sampler::Sobol { .. } => 5.0,
        };
        2.0 / (freedom + 2.0)
    }
}

/// See the module.
fn sobol_ratio(measured: f64) -> f64 {
    const OF_EDGES: f64 = 0.38;
    /// How much the measured ratio counts, where the other is 1 - `TRUST`: found by the spread of both
    /// the figure and the samples foretold, over all scenes of the gallery.
    const TRUST: f64 = 0.4;
    if measured.is_finite() && measured > 0.0 {
        OF_EDGES * libm::pow(measured.clamp(0.05, INDEPENDENT) / OF_EDGES, TRUST)
    } else {
        INDEPENDENT
    }
}

/// Sums over all pixels, in the same order whatever the threads.
fn sums<const N: usize>(
    pixels: &[PixelSums],
    of: impl Fn(&PixelSums) -> [f64; N] + Sync,
) -> [f64; N] {
    let add = |mut sum: [f64; N], terms: [f64; N]| {
        for (sum, term) in sum.iter_mut().zip(terms) {
            *sum += term;
        }
        sum
    };
    let of_chunk = |chunk: &[PixelSums]| chunk.iter().map(&of).fold([0.0; N], add);
    let partial: Vec<[f64; N]> = pixels.par_chunks(CHUNK).map(of_chunk).collect();
    partial.into_iter().fold([0.0; N], add)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    /// Pixels of given samples, the same in all channels.
    fn pixels(values: &[&[f32]]) -> Vec<PixelSums> {
        let of = |values: &&[f32]| {
            let mut pixel = PixelSums::default();
            values.iter().for_each(|value| pixel.add(Rgb::splat(*value)));
            pixel
        };
        values.iter().map(of).collect()
    }

    #[track_caller]
    fn assert_near(found: f64, expected: f64, what: &str) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{what}: {found}, not {expected}");
    }

    /// s² / n with n - 1 in s², and its root mean square over the mean of the picture.
    #[test]
    fn independent_samples_are_judged_by_their_variance() {
        let pixels = pixels(&[&[1.0, 3.0, 5.0], &[2.0, 2.0, 8.0]]);
        let model = ErrorModel::new(Sampler::Random { seed: 0 }, &pixels);
        let expected = [4.0 / 3.0, 12.0 / 3.0];
        for (pixel, expected) in pixels.iter().zip(expected) {
            assert_near(model.variance(pixel), expected, "variance of the mean");
        }
        let noise = model.noise(&pixels).unwrap();
        let mean = 0.5 * (3.0 + 4.0);
        assert_near(noise.percent, 100.0 * (8.0_f64 / 3.0).sqrt() / mean, "figure");
    }

    /// A quarter of all differences to come: of the halves and the quarters of the samples.
    #[test]
    fn sobol_points_are_judged_by_the_differences_to_come() {
        let pixels = pixels(&[&[1.0, 2.0, 4.0, 5.0, 3.0, 1.0, 6.0, 4.0]]);
        let model = ErrorModel::new(Sampler::Sobol { seed: 0 }, &pixels);
        // Means of the quarters 1.5, 4.5, 2 and 5; of the eighths of the first half the samples.
        let (halves, quarters, eighths) = (0.25_f64, 9.0, 1.0);
        let ratio = 0.38_f64 * ((halves / eighths).sqrt() / 0.38).powf(0.4);
        assert_near(model.ratio, ratio, "ratio");
        let difference = (halves + 2.0 * ratio * quarters + 2.0 * ratio.powi(2) * eighths) / 5.0;
        let expected = 0.25 * difference * (ratio + ratio.powi(2) / (1.0 - ratio));
        assert_near(model.variance(&pixels[0]), expected, "variance of the mean");
    }

    #[test]
    fn samples_to_a_noise_are_those_at_which_the_law_gives_it() {
        for ratio in [0.35_f64, 0.5] {
            let noise = Noise { percent: 8.0, uncertainty: 0.1, ratio };
            // Three doublings.
            let goal = 8.0 * ratio.powf(1.5);
            assert_near(noise.samples_to(goal), 8.0, "three doublings");
        }
    }
}

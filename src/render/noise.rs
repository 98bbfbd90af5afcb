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
//! over all pixels, and drawn towards that of a discontinuity between two and four dimensions: what
//! falls fast at first (smooth parts) leaves behind what falls slowly (edges), and few pixels may hold
//! most of the error, so that chance decides; the more of it, the less the measured ratio counts. With
//! it, quarters and eighths tell of D as well as the halves do.

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
    /// By how much the squared error falls whenever samples double evenly.
    pub ratio: f64,
    /// What comes first, where samples go where the error is.
    pub step: Option<Step>,
}

/// Samples that are shared out already.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// How many times the samples so far there are with them; more than 1.
    pub samples: f64,
    /// The squared error then over that of now; below 1.
    pub ratio: f64,
}

impl Noise {
    /// How many times the samples so far it takes to come down to `percent`.
    pub fn samples_to(&self, percent: f64) -> f64 {
        let fall = (self.percent / percent).powi(2);
        let evenly = |fall: f64| libm::pow(fall, -1.0 / libm::log2(self.ratio));
        match self.step {
            None => evenly(fall),
            Some(step) if fall * step.ratio > 1.0 => step.samples * evenly(fall * step.ratio),
            Some(step) => libm::pow(step.samples, -libm::log(fall) / libm::log(step.ratio)),
        }
    }

    /// The figure with so many times the samples so far.
    pub fn percent_after(&self, samples: f64) -> f64 {
        let evenly = |times: f64| libm::pow(times, libm::log2(self.ratio));
        let squared = match self.step {
            None => evenly(samples),
            Some(step) if samples > step.samples => step.ratio * evenly(samples / step.samples),
            Some(step) => libm::pow(step.ratio, libm::log(samples) / libm::log(step.samples)),
        };
        self.percent * squared.sqrt()
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
            Sampler::Sobol { .. } => sobol_ratio(pixels),
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
                at_power * self.fall(n / last_power)
            }
        }
    }

    /// By how much a variance falls with so many times the samples.
    pub(super) fn fall(&self, times: f64) -> f64 {
        libm::pow(times, libm::log2(self.ratio))
    }

    /// The figure for a whole picture; `None` where there is none: too few samples, or black.
    pub(super) fn noise(&self, pixels: &[PixelSums], step: Option<Step>) -> Option<Noise> {
        let [variance, squares, light] = sums(pixels.len(), |place| {
            let pixel = &pixels[place];
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
            step,
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

/// By how much D falls whenever samples double: see the module.
fn sobol_ratio(pixels: &[PixelSums]) -> f64 {
    /// Of discontinuities.
    const OF_EDGES: f64 = 0.38;
    /// How much a measured ratio counts that is free of chance, where that of edges is the rest.
    const TRUST: f64 = 0.5;
    /// Chance error that halves this. These three by the spread of both the figure and the samples
    /// foretold, over all scenes of the gallery, in pictures of several sizes.
    const DOUBT: f64 = 0.1;
    let of_eighths = Fall::new(pixels, 2, |pixel| pixel.between_eighths);
    let measured = of_eighths.or_else(|| Fall::new(pixels, 1, |pixel| pixel.between_quarters));
    let Some(Fall { ratio, chance }) = measured else { return INDEPENDENT };
    let trust = TRUST / (1.0 + (chance / DOUBT).powi(2));
    OF_EDGES * libm::pow(ratio.clamp(0.05, INDEPENDENT) / OF_EDGES, trust)
}

/// By how much D has fallen at each of the last doublings, as the pixels show it.
struct Fall {
    ratio: f64,
    /// Standard error of the logarithm of the ratio, by chance.
    chance: f64,
}

impl Fall {
    /// From `before`, so many doublings ago, to the halves. `None` where there was nothing.
    fn new(
        pixels: &[PixelSums],
        n_doublings: i32,
        before: impl Fn(&PixelSums) -> f32 + Sync,
    ) -> Option<Self> {
        let [now, now_squared, then, then_squared] = sums(pixels.len(), |place| {
            let pixel = &pixels[place];
            if pixel.n_samples < 2 << n_doublings {
                return [0.0; 4];
            }
            let [now, then] = [pixel.between_halves, before(pixel)].map(f64::from);
            [now, now.powi(2), then, then.powi(2)]
        });
        // Two thirds of the mean square of a squared normal difference are its variance.
        let chance = (now_squared / now.powi(2) + then_squared / then.powi(2)) * (2.0 / 3.0);
        let each = 1.0 / f64::from(n_doublings);
        (now > 0.0 && then > 0.0)
            .then(|| Self { ratio: libm::pow(now / then, each), chance: each * chance.sqrt() })
    }
}

/// Sums over all places of a picture, in the same order whatever the threads.
pub(super) fn sums<const N: usize>(
    n_places: usize,
    of: impl Fn(usize) -> [f64; N] + Sync,
) -> [f64; N] {
    let add = |mut sum: [f64; N], terms: [f64; N]| {
        for (sum, term) in sum.iter_mut().zip(terms) {
            *sum += term;
        }
        sum
    };
    let of_chunk = |chunk: usize| {
        let places = chunk * CHUNK..((chunk + 1) * CHUNK).min(n_places);
        places.map(&of).fold([0.0; N], add)
    };
    let n_chunks = n_places.div_ceil(CHUNK);
    let partial: Vec<[f64; N]> = (0..n_chunks).into_par_iter().map(of_chunk).collect();
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
        let noise = model.noise(&pixels, None).unwrap();
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
        // One pixel: its squares are the squares of its sums.
        let trust = 0.5 / (1.0 + 0.25 * (2.0 / 3.0 * 2.0) / 0.1_f64.powi(2));
        let ratio = 0.38 * ((halves / eighths).sqrt() / 0.38).powf(trust);
        assert_near(model.ratio, ratio, "ratio");
        let difference = (halves + 2.0 * ratio * quarters + 2.0 * ratio.powi(2) * eighths) / 5.0;
        let expected = 0.25 * difference * (ratio + ratio.powi(2) / (1.0 - ratio));
        assert_near(model.variance(&pixels[0]), expected, "variance of the mean");
    }

    #[test]
    fn samples_to_a_noise_are_those_at_which_the_law_gives_it() {
        for ratio in [0.35_f64, 0.5] {
            let noise = Noise { percent: 8.0, uncertainty: 0.1, ratio, step: None };
            // Three doublings.
            let goal = 8.0 * ratio.powf(1.5);
            assert_near(noise.samples_to(goal), 8.0, "three doublings");
        }
    }

    /// What is shared out already comes first: half of the error is gone with thrice the samples.
    #[test]
    fn samples_to_a_noise_begin_with_those_shared_out() {
        let step = Some(Step { samples: 3.0, ratio: 0.25 });
        let noise = Noise { percent: 8.0, uncertainty: 0.1, ratio: 0.5, step };
        for (samples, percent) in
            [(1.0, 8.0), (3.0_f64.sqrt(), 8.0 * 0.5_f64.sqrt()), (3.0, 4.0), (12.0, 2.0)]
        {
            assert_near(noise.samples_to(percent), samples, "samples");
            assert_near(noise.percent_after(samples), percent, "figure");
        }
    }
}

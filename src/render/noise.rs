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
//! it, quarters and eighths tell of D as well as the halves do. The sum reaches far, where what falls
//! slowest is left, so a slow measured ratio counts more in it than a fast one; what the next few
//! doublings will do is a ratio of its own.

use rayon::prelude::*;

use crate::math::sampler::Sampler;
use crate::render::course::Course;
use crate::render::pixel::PixelSums;

/// The error of a picture, as estimated from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// 100 x the root mean squared error of linear luminance over its mean.
    pub percent: f64,
    /// Standard error of `percent`, as a share of it.
    pub uncertainty: f64,
    /// How it will fall.
    pub course: Course,
}

impl Noise {
    /// How many times the samples so far it takes to come down to `percent`.
    pub fn samples_to(&self, percent: f64) -> f64 {
        self.course.samples_to((self.percent / percent).powi(-2))
    }

    /// The figure with so many times the samples so far.
    pub fn percent_after(&self, samples: f64) -> f64 {
        self.percent * self.course.after(samples).sqrt()
    }
}

/// From the sums of all pixels to the variance of the mean of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorModel {
    sampler: Sampler,
    /// By how much D falls at each of all doublings to come, on the whole.
    tail: f64,
    /// By how much the squared error falls at each of the next few.
    ratio: f64,
}

/// Ratio of the variance when samples double, for independent samples.
const INDEPENDENT: f64 = 0.5;
/// Pixels that are summed at once.
const CHUNK: usize = 4096;

impl ErrorModel {
    /// Reads the ratio off the pixels.
    pub(super) fn new(sampler: Sampler, pixels: &[PixelSums]) -> Self {
        let (tail, ratio) = match sampler {
            Sampler::Random { .. } => (INDEPENDENT, INDEPENDENT),
            Sampler::Sobol { .. } => sobol_ratios(pixels),
        };
        Self { sampler, tail, ratio }
    }

    /// By how much the squared error falls when samples double evenly.
    pub(super) fn ratio(&self) -> f64 {
        self.ratio
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
                let quarters = self.tail * f64::from(pixel.between_quarters);
                let eighths = self.tail.powi(2) * f64::from(pixel.between_eighths);
                // One difference of halves, two of quarters, and two of the four of eighths.
                let difference = match pixel.n_samples {
                    ..4 => halves,
                    4..8 => (halves + 2.0 * quarters) / 3.0,
                    8.. => (halves + 2.0 * quarters + 2.0 * eighths) / 5.0,
                };
                let last_power = f64::from(1_u32 << pixel.n_samples.ilog2());
                let at_power = 0.25 * difference * self.tail / (1.0 - self.tail);
                at_power * self.fall(n / last_power)
            }
        }
    }

    /// By how much a variance falls with so many times the samples.
    pub(super) fn fall(&self, times: f64) -> f64 {
        libm::pow(times, libm::log2(self.ratio))
    }

    /// The figure for a whole picture; `None` where there is none: too few samples, or black.
    pub(super) fn noise(&self, pixels: &[PixelSums], course: Course) -> Option<Noise> {
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
            course,
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

/// By how much D falls, on the whole and at the next few doublings: see the module.
fn sobol_ratios(pixels: &[PixelSums]) -> (f64, f64) {
    /// Of discontinuities; and how much a measured ratio free of chance counts against it, if it is
    /// below and above: what falls slower is left in the end.
    const TAIL: (f64, [f64; 2]) = (0.38, [0.5, 0.7]);
    /// The same for the next few doublings.
    const NEXT: (f64, [f64; 2]) = (0.37, [0.45, 0.45]);
    /// Chance error that halves this. These by the spread of both the figure and the samples
    /// foretold, over all scenes of the gallery, in pictures of several sizes.
    const DOUBT: f64 = 0.1;
    let of_eighths = Fall::new(pixels, 2, |pixel| pixel.between_eighths);
    let measured = of_eighths.or_else(|| Fall::new(pixels, 1, |pixel| pixel.between_quarters));
    let Some(Fall { ratio, chance }) = measured else { return (INDEPENDENT, INDEPENDENT) };
    let toward = |(of_edges, [below, above]): (f64, [f64; 2])| {
        let ratio = ratio.clamp(0.05, INDEPENDENT);
        let trust = if ratio < of_edges { below } else { above };
        of_edges * libm::pow(ratio / of_edges, trust / (1.0 + (chance / DOUBT).powi(2)))
    };
    (toward(TAIL), toward(NEXT))
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
        let noise = model.noise(&pixels, Course::even(0.5)).unwrap();
        let mean = 0.5 * (3.0 + 4.0);
        assert_near(noise.percent, 100.0 * (8.0_f64 / 3.0).sqrt() / mean, "figure");
        // A variance of two degrees of freedom is off by half of its square, in squares.
        let squares = 0.5 * (expected[0].powi(2) + expected[1].powi(2));
        let sum = expected[0] + expected[1];
        assert_near(noise.uncertainty, 0.5 * squares.sqrt() / sum, "its standard error");
    }

    /// A quarter of all differences to come: of the halves and the quarters of the samples.
    #[test]
    fn sobol_points_are_judged_by_the_differences_to_come() {
        // Means of the quarters 1.5, 4.5, 2 and 4.625; of the eighths of the first half the samples.
        let falling = [1.0, 2.0, 4.0, 5.0, 3.0, 1.0, 6.0, 3.25];
        // Halves as far apart as the eighths: as fast as independent samples, at most.
        let even = [1.0, 2.0, 2.0, 1.0, 2.5, 2.5, 2.5, 2.5];
        for (values, [halves, quarters, eighths], trust) in
            [(falling, [0.3125_f64.powi(2), 7.945_312_5, 1.0], 0.5), (even, [1.0, 0.0, 1.0], 0.7)]
        {
            let pixels = pixels(&[&values]);
            let model = ErrorModel::new(Sampler::Sobol { seed: 0 }, &pixels);
            // One pixel: its squares are the squares of its sums.
            let chance = 1.0 + 0.25 * (2.0 / 3.0 * 2.0) / 0.1_f64.powi(2);
            let measured = (halves / eighths).sqrt().min(0.5);
            let toward = |edges: f64, trust: f64| edges * (measured / edges).powf(trust / chance);
            let tail = toward(0.38, trust);
            assert_near(model.tail, tail, "tail");
            assert_near(model.ratio, toward(0.37, 0.45), "ratio");
            let difference = (halves + 2.0 * tail * quarters + 2.0 * tail.powi(2) * eighths) / 5.0;
            let expected = 0.25 * difference * (tail + tail.powi(2) / (1.0 - tail));
            assert_near(model.variance(&pixels[0]), expected, "variance of the mean");
        }
    }

    /// Between four and eight samples halves and quarters are all there is. The figure doubts itself by
    /// five degrees of freedom a pixel and 8 % for the model.
    #[test]
    fn few_sobol_points_are_judged_by_halves_and_quarters() {
        let pixels = pixels(&[&[1.0, 2.0, 4.0, 5.5], &[3.0, 1.0, 2.0, 0.5]]);
        let model = ErrorModel::new(Sampler::Sobol { seed: 0 }, &pixels);
        let variances = [(3.25_f64.powi(2), 1.625), (0.75_f64.powi(2), 3.125)].map(
            |(halves, quarters): (f64, f64)| {
                let difference = (halves + 2.0 * model.tail * quarters) / 3.0;
                0.25 * difference * model.tail / (1.0 - model.tail)
            },
        );
        for (pixel, expected) in pixels.iter().zip(variances) {
            assert_near(model.variance(pixel), expected, "variance of the mean");
        }
        let noise = model.noise(&pixels, Course::even(0.5)).unwrap();
        let squares = 2.0 / 7.0 * (variances[0].powi(2) + variances[1].powi(2));
        let by_chance = 0.5 * squares.sqrt() / (variances[0] + variances[1]);
        assert_near(noise.uncertainty, by_chance.hypot(0.08), "standard error");
    }

    /// The figure is a root: half of it is a quarter of the squared error.
    #[test]
    fn the_figure_follows_the_course() {
        let noise = Noise { percent: 8.0, uncertainty: 0.1, course: Course::even(0.5) };
        assert_near(noise.samples_to(4.0), 4.0, "samples");
        assert_near(noise.percent_after(4.0), 4.0, "figure");
    }
}

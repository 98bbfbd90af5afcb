//! Where samples go when they go where the error is.
//!
//! At every power of two of the mean number of samples a pixel, from [`FIRST_DECISION`] on, the
//! samples up to the next power are shared out anew. A pixel's number only ever doubles, so that it
//! is a power of two at each decision, which Sobol points want; the doublings that take away the
//! most squared error a sample come first. Between two decisions all numbers grow evenly. All of
//! this follows from the film at the decisions, so it does not depend on passes, tiles or threads.
//!
//! *No bias*: were a pixel's own samples to decide how many it gets, those that happened to miss a
//! light would stop early, and the picture would be too dark. A pixel is judged by its neighbours
//! alone; its own samples are kept out of its decision, and its mean is a plain one.

use crate::math::sampler::mix;
use crate::render::noise::{ErrorModel, Step, sums};
use crate::render::pixel::PixelSums;

/// Mean samples a pixel before the first decision.
const FIRST_DECISION: u32 = 16;
/// No pixel has fewer samples than the mean over this.
const LARGEST_LAG: u32 = 4;
/// Nor more than the mean times this.
const LARGEST_LEAD: u32 = 16;
/// Neighbours up to this many pixels away judge a pixel.
const REACH: usize = 2;

/// Mean samples a pixel at the first decision after `n_mean`.
pub(super) fn next_decision(n_mean: u32) -> u32 {
    (n_mean + 1).next_power_of_two().max(FIRST_DECISION)
}

/// Whether samples are shared out at `n_mean` a pixel.
pub(super) fn is_decision(n_mean: u32) -> bool {
    n_mean.is_power_of_two() && n_mean >= FIRST_DECISION
}

/// How many samples each pixel has at one power of two of the mean, and at the next.
#[derive(Clone, Debug)]
pub(super) struct Allotment {
    n_mean: u32,
    shares: Vec<Share>,
}

#[derive(Clone, Copy, Debug)]
struct Share {
    n_before: u32,
    n_after: u32,
}

impl Allotment {
    /// Shares out the samples from `n_mean` a pixel, a power of two, to twice as many.
    pub(super) fn new(width: usize, n_mean: u32, pixels: &[PixelSums], model: &ErrorModel) -> Self {
        let mut shares: Vec<Share> = pixels
            .iter()
            .map(|pixel| Share { n_before: pixel.n_samples, n_after: pixel.n_samples })
            .collect();
        let has: u64 = shares.iter().map(|share| u64::from(share.n_before)).sum();
        let mut left = (2 * u64::from(n_mean) * pixels.len() as u64).saturating_sub(has);
        // First those that would fall behind.
        for share in &mut shares {
            let least = 2 * n_mean / LARGEST_LAG;
            if share.n_after < least {
                left = left.saturating_sub(u64::from(least - share.n_after));
                share.n_after = least;
            }
        }
        let mut doublings = doublings(width, n_mean, pixels, model, &shares);
        doublings
            .sort_unstable_by_key(|doubling| (std::cmp::Reverse(doubling.gain), doubling.order));
        for doubling in &doublings {
            let share = &mut shares[doubling.pixel as usize];
            // A later doubling of a pixel comes after the earlier ones, if those found room.
            if share.n_after == doubling.n && u64::from(doubling.n) <= left {
                left -= u64::from(doubling.n);
                share.n_after *= 2;
            }
        }
        Self { n_mean, shares }
    }

    /// What the samples up to the next decision will do when the mean is `n_mean`; `None` where no more
    /// come, and for a picture without error.
    pub(super) fn step(
        &self,
        n_mean: u32,
        pixels: &[PixelSums],
        model: &ErrorModel,
    ) -> Option<Step> {
        let [now, then] = sums(pixels.len(), |place| {
            let pixel = &pixels[place];
            let variance = model.variance(pixel);
            let times = f64::from(self.shares[place].n_after) / f64::from(pixel.n_samples.max(1));
            [variance, if times > 1.0 { variance * model.fall(times) } else { variance }]
        });
        let samples = 2.0 * f64::from(self.n_mean) / f64::from(n_mean);
        (samples > 1.0 && then < now).then(|| Step { samples, ratio: then / now })
    }

    /// Samples of a pixel when the mean is `n_mean`, between this decision and the next.
    pub(super) fn n_samples(&self, pixel: usize, n_mean: u32) -> u32 {
        let Share { n_before, n_after } = self.shares[pixel];
        let (grown, whole) = (u64::from(n_mean - self.n_mean), u64::from(self.n_mean));
        // Rounded up or down by chance, so that the mean is right at every step.
        let chance = (u64::from(mix(pixel as u32)) * whole) >> 32;
        let share = u64::from(n_after - n_before) * grown + chance;
        n_before + (share / whole) as u32
    }
}

/// A pixel's samples might double from `n`.
struct Doubling {
    /// Squared error it takes away for each sample, as ordered bits.
    gain: u64,
    /// Decides between equal gains.
    order: u32,
    pixel: u32,
    n: u32,
}

/// All doublings that may be worth it.
fn doublings(
    width: usize,
    n_mean: u32,
    pixels: &[PixelSums],
    model: &ErrorModel,
    shares: &[Share],
) -> Vec<Doubling> {
    // Of one sample, so that neighbours with different counts can be compared.
    let variances: Vec<f64> =
        pixels.iter().map(|pixel| model.variance(pixel) * f64::from(pixel.n_samples)).collect();
    let judged = mean_of_neighbours(width, &variances);
    let mean = judged.iter().sum::<f64>() / judged.len().max(1) as f64;
    let mut doublings = Vec::new();
    for (index, (variance, share)) in judged.iter().zip(shares).enumerate() {
        // Nothing seen is not nothing there.
        let variance = variance.max(1e-4 * mean);
        let mut n = share.n_after;
        while 2 * u64::from(n) <= 2 * u64::from(n_mean) * u64::from(LARGEST_LEAD) {
            let gain = (variance / f64::from(n).powi(2)).to_bits();
            let order = mix(index as u32 ^ n_mean);
            doublings.push(Doubling { gain, order, pixel: index as u32, n });
            n *= 2;
        }
    }
    doublings
}

/// The mean over the square around each place, without the place itself.
fn mean_of_neighbours(width: usize, values: &[f64]) -> Vec<f64> {
    let height = values.len() / width.max(1);
    let around = |at: usize, end: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(end);
    let mut means = Vec::with_capacity(values.len());
    for y in 0..height {
        for x in 0..width {
            let (columns, rows) = (around(x, width), around(y, height));
            let n_others = columns.len() * rows.len() - 1;
            let others = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
            let sum: f64 = others
                .filter(|place| *place != (x, y))
                .map(|(column, row)| values[row * width + column])
                .sum();
            means.push(sum / n_others.max(1) as f64);
        }
    }
    means
}

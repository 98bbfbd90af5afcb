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

use std::collections::BTreeMap;

use crate::math::sampler::mix;
use crate::render::course::{Course, LONGEST, Step};
use crate::render::noise::{ErrorModel, sums};
use crate::render::pixel::PixelSums;

/// Mean samples a pixel before the first decision.
const FIRST_DECISION: u32 = 16;
/// No pixel has fewer samples than the mean over this.
const LARGEST_LAG: u32 = 4;
/// Nor more than the mean times this.
const LARGEST_LEAD: u32 = 16;
/// Neighbours up to this many pixels away judge a pixel.
const REACH: usize = 2;
/// No pixel is judged to have less error than the mean times this.
const LEAST_JUDGED: f64 = 1e-4;
/// Decisions after the next whose effect is foretold.
const AHEAD: usize = LONGEST - 1;

/// Mean samples a pixel at the first decision after `n_mean`.
pub(super) fn next_decision(n_mean: u32) -> u32 {
    (n_mean + 1).next_power_of_two().max(FIRST_DECISION)
}

/// Whether what samples are to come is told anew at `n_mean` a pixel.
pub(super) fn is_told_anew(n_mean: u32) -> bool {
    n_mean < FIRST_DECISION || is_decision(n_mean)
}

/// Whether samples are shared out by the error at `n_mean` a pixel.
fn is_decision(n_mean: u32) -> bool {
    n_mean.is_power_of_two() && n_mean >= FIRST_DECISION
}

/// How many samples each pixel has at one number of samples on the mean, and at the next decision.
#[derive(Clone, Debug)]
pub(super) struct Allotment {
    n_mean: u32,
    n_next: u32,
    shares: Vec<Share>,
    /// What the decisions after the next are likely to do.
    later: [Step; AHEAD],
}

#[derive(Clone, Copy, Debug)]
struct Share {
    n_before: u32,
    n_after: u32,
}

impl Allotment {
    /// Shares out the samples from `n_mean` a pixel to the next decision: at a decision by the error,
    /// before the first one evenly.
    pub(super) fn new(width: usize, n_mean: u32, pixels: &[PixelSums], model: &ErrorModel) -> Self {
        // Of one sample, so that neighbours with different counts can be compared.
        let variances: Vec<f64> =
            pixels.iter().map(|pixel| model.variance(pixel) * f64::from(pixel.n_samples)).collect();
        let judged = mean_of_neighbours(width, &variances);
        let n_next = next_decision(n_mean);
        let mut numbers: Vec<u32> = pixels.iter().map(|pixel| pixel.n_samples).collect();
        if is_decision(n_mean) {
            share_out(n_mean, &mut numbers, &judged, |_| 1);
        } else {
            numbers.fill(n_next);
        }
        let share = |(pixel, n_after): (&PixelSums, &u32)| Share {
            n_before: pixel.n_samples,
            n_after: *n_after,
        };
        let shares: Vec<Share> = pixels.iter().zip(&numbers).map(share).collect();
        let later = later(n_next, &shares, &judged, &variances, model);
        Self { n_mean, n_next, shares, later }
    }

    /// What the samples to come will do when the mean is `n_mean`: those that are shared out exactly,
    /// later ones by what this decision would make of their errors. `None` for a picture without error.
    pub(super) fn course(
        &self,
        n_mean: u32,
        pixels: &[PixelSums],
        model: &ErrorModel,
    ) -> Option<Course> {
        let [now, then] = sums(pixels.len(), |place| {
            let pixel = &pixels[place];
            let variance = model.variance(pixel);
            let times = f64::from(self.shares[place].n_after) / f64::from(pixel.n_samples.max(1));
            [variance, if times > 1.0 { variance * model.fall(times) } else { variance }]
        });
        let samples = f64::from(self.n_next) / f64::from(n_mean);
        let mut steps = [Step { samples, ratio: then / now }; LONGEST];
        steps[1..].copy_from_slice(&self.later);
        (then < now).then(|| Course::new(steps, model.ratio()))
    }

    /// Samples of a pixel when the mean is `n_mean`, between this decision and the next.
    pub(super) fn n_samples(&self, pixel: usize, n_mean: u32) -> u32 {
        let Share { n_before, n_after } = self.shares[pixel];
        let grown = u64::from(n_mean - self.n_mean);
        let whole = u64::from(self.n_next - self.n_mean);
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

/// Raises the numbers of samples so that their mean, `n_mean`, doubles: `judged` is the variance of
/// one sample. An entry stands for `count` pixels.
fn share_out(n_mean: u32, numbers: &mut [u32], judged: &[f64], count: impl Fn(usize) -> u64) {
    let (mut has, mut n_pixels, mut sum) = (0, 0, 0.0);
    for (index, n) in numbers.iter().enumerate() {
        let count = count(index);
        has += count * u64::from(*n);
        n_pixels += count;
        sum += judged[index] * count as f64;
    }
    let mut left = (2 * u64::from(n_mean) * n_pixels).saturating_sub(has);
    // First those that would fall behind.
    let least = 2 * n_mean / LARGEST_LAG;
    for (index, n) in numbers.iter_mut().enumerate().filter(|(_, n)| **n < least) {
        left = left.saturating_sub(count(index) * u64::from(least - *n));
        *n = least;
    }
    let mean = sum / n_pixels.max(1) as f64;
    let mut doublings = Vec::new();
    for (index, (variance, first)) in judged.iter().zip(&*numbers).enumerate() {
        // Nothing seen is not nothing there.
        let variance = variance.max(LEAST_JUDGED * mean);
        let mut n = *first;
        while 2 * u64::from(n) <= 2 * u64::from(n_mean) * u64::from(LARGEST_LEAD) {
            let gain = (variance / f64::from(n).powi(2)).to_bits();
            let order = mix(index as u32 ^ n_mean);
            doublings.push(Doubling { gain, order, pixel: index as u32, n });
            n *= 2;
        }
    }
    doublings.sort_unstable_by_key(|doubling| (std::cmp::Reverse(doubling.gain), doubling.order));
    for doubling in &doublings {
        let index = doubling.pixel as usize;
        let cost = count(index) * u64::from(doubling.n);
        // A later doubling of a pixel comes after the earlier ones, if those found room.
        if numbers[index] == doubling.n && cost <= left {
            left -= cost;
            numbers[index] *= 2;
        }
    }
}

/// Pixels with about the same error and the same number of samples.
#[derive(Clone, Copy, Default)]
struct Crowd {
    count: u64,
    n: u32,
    /// Sum of the variances of one sample, as judged and as the pixels' own.
    judged: f64,
    own: f64,
}

/// What the decisions from that at `n_mean` on would do to errors that fall as the model says.
fn later(
    mut n_mean: u32,
    shares: &[Share],
    judged: &[f64],
    own: &[f64],
    model: &ErrorModel,
) -> [Step; AHEAD] {
    /// Errors that differ by less than a factor of 2^(1/4) are alike.
    const PER_OCTAVE: f64 = 4.0;
    let mean = judged.iter().sum::<f64>() / judged.len().max(1) as f64;
    let mut crowds = BTreeMap::new();
    for (share, (judged, own)) in shares.iter().zip(judged.iter().zip(own)) {
        let times = f64::from(share.n_after) / f64::from(share.n_before.max(1));
        let fall = times * model.fall(times);
        let judged = fall * judged.max(LEAST_JUDGED * mean);
        let class = (share.n_after, (PER_OCTAVE * libm::log2(judged)) as i32);
        let crowd: &mut Crowd = crowds.entry(class).or_default();
        crowd.n = share.n_after;
        crowd.count += 1;
        crowd.judged += judged;
        crowd.own += own * fall;
    }
    let mut crowds: Vec<Crowd> = crowds.into_values().collect();
    let error = |crowds: &[Crowd]| -> f64 {
        crowds.iter().map(|crowd| crowd.own / f64::from(crowd.n)).sum()
    };
    [(); AHEAD].map(|()| {
        let mut numbers: Vec<u32> = crowds.iter().map(|crowd| crowd.n).collect();
        let judged: Vec<f64> =
            crowds.iter().map(|crowd| crowd.judged / crowd.count as f64).collect();
        let before = error(&crowds);
        share_out(n_mean, &mut numbers, &judged, |index| crowds[index].count);
        for (crowd, n) in crowds.iter_mut().zip(numbers) {
            let times = f64::from(n) / f64::from(crowd.n.max(1));
            let fall = times * model.fall(times);
            *crowd = Crowd { n, judged: crowd.judged * fall, own: crowd.own * fall, ..*crowd };
        }
        n_mean *= 2;
        Step { samples: 2.0, ratio: error(&crowds) / before }
    })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::math::sampler::Sampler;

    const WIDTH: usize = 32;

    /// Pixels whose samples lie as far above their mean as below, up to 20 times as far in some as in
    /// others.
    fn add(pixels: &mut [PixelSums], goal: impl Fn(usize) -> u32) {
        for (index, pixel) in pixels.iter_mut().enumerate() {
            let [x, y] = [index % WIDTH, index / WIDTH].map(|i| i as f32 / WIDTH as f32);
            let far = 1.0 + 19.0 * (x * y).powi(3);
            while pixel.n_samples < goal(index) {
                let sign = if pixel.n_samples % 2 == 0 { 1.0 } else { -1.0 };
                pixel.add(Rgb::splat(30.0 + sign * far));
            }
        }
    }

    /// Errors that fall as the model says: the decisions to come are foretold at the first one, and
    /// before it.
    #[test]
    fn decisions_to_come_are_foretold() {
        for first in [8, 16] {
            let mut pixels = vec![PixelSums::default(); WIDTH * WIDTH];
            add(&mut pixels, |_| first);
            let model = ErrorModel::new(Sampler::Random { seed: 0 }, &pixels);
            let mut allotment = Allotment::new(WIDTH, first, &pixels, &model);
            let (foretold, mut n_mean) = (allotment.later, first);
            for (index, step) in foretold.iter().enumerate() {
                n_mean *= 2;
                add(&mut pixels, |pixel| allotment.n_samples(pixel, n_mean));
                allotment = Allotment::new(WIDTH, n_mean, &pixels, &model);
                let done = allotment.course(n_mean, &pixels, &model).unwrap().after(2.0);
                let ratio = step.ratio / done;
                assert!(
                    (ratio - 1.0).abs() < 0.03,
                    "from {first}: {step:?} at {index}, not {done}"
                );
            }
            let [first_decision, _, _, last] = foretold;
            if first == 8 {
                assert!(first_decision.ratio < 0.9 * last.ratio, "the test can fail: {foretold:?}");
            }
        }
    }
}

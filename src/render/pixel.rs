//! What a film keeps of a pixel: sums for its colour, and marks from which its error is told.

use crate::color::{Rgb, luminance};

/// Sums over the samples of one pixel, taken in sample order.
///
/// The error of Sobol points shows in the differences between blocks of successive samples. When
/// the count reaches a power of two, n, the samples fall into four quarters; `between_halves` and
/// `between_quarters` keep how far those were apart until the next power, and `between_eighths` what
/// was known of the first half when it was the whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PixelSums {
    /// Of the radiance.
    pub(super) radiance: [f64; 3],
    /// Of the squared luminance.
    pub(super) squares: f64,
    /// Luminance of the first three quarters of the next power of two, as far as the count is: up to
    /// the last mark, at counts 2^k and 3 2^k.
    quarters: [f32; 3],
    /// Squared difference of the means of both halves, at the last power of two (2 or more).
    pub(super) between_halves: f32,
    /// The same of the quarters of each half, their mean, at the last power of two (4 or more).
    pub(super) between_quarters: f32,
    /// The same of the eighths of the first half, at the last power of two (8 or more).
    pub(super) between_eighths: f32,
    /// Samples so far.
    pub(super) n_samples: u32,
}

impl PixelSums {
    /// Adds the next sample.
    #[inline]
    pub(super) fn add(&mut self, sample: Rgb) {
        for channel in 0..3 {
            self.radiance[channel] += f64::from(sample[channel]);
        }
        self.squares += f64::from(luminance(sample)).powi(2);
        self.n_samples += 1;
        // Marks are where the count has one bit, or two next to each other.
        let odd = self.n_samples >> self.n_samples.trailing_zeros();
        if odd == 1 {
            self.close_octave();
        } else if odd == 3 {
            self.quarters[2] = self.since_mark();
        }
    }

    /// The mean of the radiance; black without samples.
    #[inline]
    pub(super) fn mean(&self) -> [f32; 3] {
        let scale = 1.0 / f64::from(self.n_samples.max(1));
        self.radiance.map(|sum| (sum * scale) as f32)
    }

    /// Sum of the luminance.
    pub(super) fn luminance(&self) -> f64 {
        let [r, g, b] = self.radiance;
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    fn since_mark(&self) -> f32 {
        let up_to_mark: f64 = self.quarters.iter().map(|part| f64::from(*part)).sum();
        (self.luminance() - up_to_mark) as f32
    }

    /// The count has reached a power of two: what was a whole is the first half of the next.
    fn close_octave(&mut self) {
        let last = self.since_mark();
        let n = self.n_samples as f32;
        let [a, b, c] = self.quarters;
        match self.n_samples {
            1 => self.quarters = [last, 0.0, 0.0],
            2 => {
                self.between_halves = (a - last).powi(2);
                self.quarters = [a, last, 0.0];
            }
            _ => {
                self.between_halves = ((a + b - c - last) * (2.0 / n)).powi(2);
                self.between_eighths = self.between_quarters;
                let (first, second) = ((a - b) * (4.0 / n), (c - last) * (4.0 / n));
                self.between_quarters = 0.5 * (first.powi(2) + second.powi(2));
                self.quarters = [a + b, c + last, 0.0];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The marks against the same figures from all samples at hand.
    #[test]
    fn differences_of_halves_and_quarters_are_those_of_the_samples() {
        let values: Vec<f32> = (0..64_u32).map(|i| (i * 37 % 64) as f32 / 8.0).collect();
        let mut pixel = PixelSums::default();
        for (index, value) in values.iter().enumerate() {
            pixel.add(Rgb::splat(*value));
            let n = index + 1;
            assert_eq!(pixel.n_samples as usize, n);
            let whole = if n.is_power_of_two() { n } else { n.next_power_of_two() / 2 };
            let mean = |part: &[f32]| f64::from(part.iter().sum::<f32>()) / part.len() as f64;
            let apart = |part: &[f32]| {
                let (first, second) = part.split_at(part.len() / 2);
                (mean(first) - mean(second)).powi(2)
            };
            let seen = &values[..whole];
            if whole >= 2 {
                let expected = apart(seen);
                let found = f64::from(pixel.between_halves);
                assert!((found - expected).abs() <= 1e-5, "{found}, not {expected} at {n}");
            }
            if whole >= 4 {
                let (first, second) = seen.split_at(whole / 2);
                let expected = 0.5 * (apart(first) + apart(second));
                let found = f64::from(pixel.between_quarters);
                assert!((found - expected).abs() <= 1e-5, "{found}, not {expected} at {n}");
            }
            if whole >= 8 {
                let (first, second) = seen[..whole / 2].split_at(whole / 4);
                let expected = 0.5 * (apart(first) + apart(second));
                let found = f64::from(pixel.between_eighths);
                assert!((found - expected).abs() <= 1e-5, "{found}, not {expected} at {n}");
            }
        }
    }

    /// Sums of a cache line: they decide how large a picture fits into memory.
    #[test]
    fn a_pixel_takes_64_bytes() {
        assert_eq!(size_of::<PixelSums>(), 64);
    }
}

//! When rendering ends.

use crate::render::Film;

/// When a picture is finished: at the first of these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Samples a pixel.
    pub samples: u32,
    /// Seconds of rendering.
    pub seconds: Option<f64>,
    /// Noise in percent.
    pub noise_percent: Option<f64>,
}

impl Goal {
    /// With fewer samples the estimate of the noise is not to be trusted.
    const LEAST_FOR_NOISE: u32 = 8;

    /// Whether a film that took so many seconds is finished. Nothing is before its first sample.
    pub fn is_reached(&self, film: &Film, seconds: f64) -> bool {
        let n_samples = film.n_samples();
        let is_clean = n_samples >= Self::LEAST_FOR_NOISE
            && self.noise_percent.zip(film.noise_percent()).is_some_and(|(goal, now)| now <= goal);
        let is_late = n_samples > 0 && self.seconds.is_some_and(|limit| seconds >= limit);
        n_samples >= self.samples || is_clean || is_late
    }

    /// Estimate of the seconds until it is, at the pace so far, `seconds` for the film's samples.
    /// `None` before the first sample.
    pub fn seconds_left(&self, film: &Film, seconds: f64) -> Option<f64> {
        let n_samples = f64::from(film.n_samples());
        if n_samples == 0.0 {
            return None;
        }
        let by_samples = seconds * (f64::from(self.samples) / n_samples - 1.0);
        let by_time = self.seconds.map(|limit| limit - seconds);
        let by_noise = self
            .noise_percent
            .zip(film.noise())
            .map(|(goal, noise)| seconds * (noise.samples_to(goal) - 1.0));
        let nearest = [by_time, by_noise].into_iter().flatten().fold(by_samples, f64::min);
        Some(nearest.max(0.0))
    }
}

//! How far the picture is from the truth, told from the picture alone.
//!
//! Let V(n) be the variance of the mean of the first n samples of a pixel, for n a power of two.
//! The two halves of those samples are nets of their own with equal variance V(n/2), but not
//! independent: scrambled Sobol points avoid in the second half what the first half covered. The
//! mean squared difference D of the two half means is 4 (V(n/2) - V(n)), whatever the correlation.
//! With V(2n) = r V(n) this gives V(n) = D r / (4 (1 - r)): the familiar D / 4 for independent
//! samples, r = 1/2. The ratio r is read off the growth of D itself, pooled over all pixels.

/// Differences between halves of the samples, at every power of two.
#[derive(Clone, Debug)]
pub(super) struct NoiseEstimate {
    /// Sum of luminance of every pixel at the last power of two.
    half_sums: Vec<f64>,
    /// Mean over pixels of the squared difference of half means, at 2, 4, 8, … samples.
    differences: Vec<f64>,
    mean_luminance: f64,
}

impl NoiseEstimate {
    pub(super) const BYTES_A_PIXEL: usize = size_of::<f64>();

    /// `None` where memory does not suffice.
    pub(super) fn new(n_pixels: usize) -> Option<Self> {
        let mut half_sums = Vec::new();
        half_sums.try_reserve_exact(n_pixels).ok()?;
        half_sums.resize(n_pixels, 0.0);
        Some(Self { half_sums, differences: Vec::new(), mean_luminance: 0.0 })
    }

    /// Takes the luminance sums at a power of two of samples; every power must be recorded.
    pub(super) fn record(&mut self, n_samples: u32, sums: impl Iterator<Item = f64>) {
        let n_half = f64::from(n_samples) / 2.0;
        let n_pixels = self.half_sums.len().max(1) as f64;
        let (mut difference, mut total) = (0.0, 0.0);
        for (half, sum) in self.half_sums.iter_mut().zip(sums) {
            difference += ((2.0 * *half - sum) / n_half).powi(2);
            total += sum;
            *half = sum;
        }
        if n_samples > 1 {
            self.differences.push(difference / n_pixels);
        }
        self.mean_luminance = total / (n_pixels * f64::from(n_samples));
    }

    /// 100 x RMSE over mean at `n_samples`, extrapolated from the last power of two.
    pub(super) fn percent(&self, n_samples: u32) -> Option<f64> {
        let last = *self.differences.last()?;
        let ratio = self.ratio();
        let n_recorded = f64::from(2_u32.saturating_pow(self.differences.len() as u32));
        let octaves = (f64::from(n_samples) / n_recorded).log2();
        let variance = 0.25 * last * ratio / (1.0 - ratio) * ratio.powf(octaves);
        let percent = 100.0 * variance.sqrt() / self.mean_luminance;
        percent.is_finite().then_some(percent)
    }

    /// By how much the variance falls when samples double; pooled over the last doublings.
    fn ratio(&self) -> f64 {
        const INDEPENDENT: f64 = 0.5;
        const N_POOLED: usize = 3;
        let n = self.differences.len();
        let n_ratios = N_POOLED.min(n.saturating_sub(1));
        if n_ratios == 0 {
            return INDEPENDENT;
        }
        let (first, last) = (self.differences[n - 1 - n_ratios], self.differences[n - 1]);
        let ratio = (last / first).powf(1.0 / n_ratios as f64);
        if ratio.is_finite() { ratio.clamp(0.05, INDEPENDENT) } else { INDEPENDENT }
    }
}

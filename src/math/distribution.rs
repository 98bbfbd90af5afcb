//! Choosing one of many in proportion to weights.

/// Shares of a whole, by their running sum.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distribution {
    /// Sum of the weights up to and with each; the last one is the total.
    sums: Vec<f64>,
}

impl Distribution {
    /// Of weights that are finite and not negative.
    pub fn new(weights: impl IntoIterator<Item = f32>) -> Self {
        let mut sum = 0.0;
        let sums = weights.into_iter().map(|weight| {
            sum += f64::from(weight);
            sum
        });
        Self { sums: sums.collect() }
    }

    /// Sum of all weights.
    pub fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// Chance of one of them; 0 for all where no weight is above 0.
    pub fn share(&self, index: usize) -> f64 {
        let before = if index == 0 { 0.0 } else { self.sums[index - 1] };
        if self.total() > 0.0 { (self.sums[index] - before) / self.total() } else { 0.0 }
    }

    /// One of them for a number in [0, 1), and that number's place within it, again in [0, 1).
    /// `None` where no weight is above 0.
    pub fn sample(&self, u: f32) -> Option<(usize, f32)> {
        let total = self.total();
        if total <= 0.0 {
            return None;
        }
        let at = f64::from(u) * total;
        let index = self.sums.partition_point(|sum| *sum <= at).min(self.sums.len() - 1);
        let before = if index == 0 { 0.0 } else { self.sums[index - 1] };
        let width = self.sums[index] - before;
        const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
        (width > 0.0).then(|| (index, (((at - before) / width) as f32).clamp(0.0, BELOW_ONE)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_come_in_proportion_and_their_rest_is_uniform() {
        let weights = [0.0, 3.0, 0.0, 1.0, 4.0, 0.0];
        let distribution = Distribution::new(weights);
        let n = 8000;
        let (mut counts, mut rests) = ([0_u32; 6], [0.0_f64; 6]);
        for i in 0..n {
            let (index, rest) = distribution.sample((i as f32 + 0.5) / n as f32).unwrap();
            counts[index] += 1;
            rests[index] += f64::from(rest);
        }
        assert_eq!(counts, [0, 3000, 0, 1000, 4000, 0]);
        for (index, count) in counts.iter().enumerate() {
            assert_eq!(distribution.share(index), f64::from(weights[index]) / 8.0);
            let mean = rests[index] / f64::from((*count).max(1));
            assert!(*count == 0 || (mean - 0.5).abs() < 1e-3, "mean rest {mean} of {index}");
        }
    }

    #[test]
    fn without_weight_nothing_is_chosen() {
        assert!(Distribution::new([]).sample(0.5).is_none(), "none at all");
        assert!(Distribution::new([0.0, 0.0]).sample(0.5).is_none(), "only zeros");
    }
}

//! How figures become places on a ramp of colours, and which of them are written beside it.

use crate::window::figures::short;

/// From a figure to its place on the ramp, 0..=1. The ends are round figures, so that they stand
/// still while the picture changes a little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// From 0 to the highest.
    Linear {
        /// At the end of the ramp, above 0.
        high: f64,
    },
    /// Equal factors are equal steps.
    Logarithmic {
        /// At the beginning of the ramp, above 0.
        low: f64,
        /// At its end, above `low`.
        high: f64,
    },
    /// Both signs: 0 in the middle, logarithmic far from it, linear below 1.
    Signed {
        /// At the end of the ramp, above 0.
        most: f64,
    },
}

/// Marks of ten are divided so finely.
const ROUND: [f64; 9] = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

impl Scale {
    /// The place of a figure.
    pub(super) fn place(self, value: f64) -> f64 {
        let place = match self {
            Self::Linear { high } => value / high,
            Self::Logarithmic { low, high } => (value / low).ln() / (high / low).ln(),
            Self::Signed { most } => {
                let bent = value.abs().min(f64::MAX).ln_1p() / most.ln_1p();
                0.5 + 0.5 * bent.min(1.0).copysign(value)
            }
        };
        if place.is_nan() { 0.0 } else { place.clamp(0.0, 1.0) }
    }

    /// Figures to be written, each with its place; never nearer than a sixth of the ramp.
    pub(super) fn marks(self) -> Vec<(f64, String)> {
        let inner: Vec<f64> = match self {
            Self::Linear { high } => vec![high / 2.0],
            Self::Logarithmic { low, high } => {
                let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
                let at = |decade: i32, digit: f64| digit * 10.0_f64.powi(decade);
                let tens = decades.clone().map(|decade| at(decade, 1.0));
                let others = decades.flat_map(|decade| [2.0, 5.0, 3.0].map(|d| at(decade, d)));
                tens.chain(others).filter(|value| low < *value && *value < high).collect()
            }
            Self::Signed { most } => {
                let sides = [1.0, 10.0, 100.0].into_iter().filter(|value| *value < most);
                [0.0].into_iter().chain(sides.flat_map(|value| [-value, value])).collect()
            }
        };
        let ends = match self {
            Self::Linear { high } => [0.0, high],
            Self::Logarithmic { low, high } => [low, high],
            Self::Signed { most } => [-most, most],
        };
        let mut marks: Vec<(f64, String)> = Vec::new();
        for value in ends.into_iter().chain(inner) {
            let place = self.place(value);
            if marks.iter().all(|(other, _)| (place - other).abs() > 1.0 / 6.0) {
                marks.push((place, short(value).replace('-', "−")));
            }
        }
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        marks
    }
}

/// The next round figure that is not below this one, above 0.
pub(super) fn rounded_up(value: f64) -> f64 {
    let (digit, decade) = split(value);
    let round = ROUND.into_iter().find(|round| digit <= round * (1.0 + 1e-9));
    round.unwrap_or(10.0) * decade
}

/// The next round figure that is not above this one, above 0.
pub(super) fn rounded_down(value: f64) -> f64 {
    let (digit, decade) = split(value);
    let round = ROUND.into_iter().rev().find(|round| round * (1.0 - 1e-9) <= digit);
    round.unwrap_or(1.0) * decade
}

/// A digit in 1..10 and its power of ten.
fn split(value: f64) -> (f64, f64) {
    let value = if value.is_finite() { value.clamp(1e-30, 1e30) } else { 1.0 };
    let decade = 10.0_f64.powf(value.log10().floor());
    (value / decade, decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_round_and_enclose_what_is_shown() {
        for (value, down, up) in [(4.31, 4.0, 5.0), (0.017, 0.015, 0.02), (2.0, 2.0, 2.0)] {
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
            let (below, above) = (rounded_down(value), rounded_up(value));
            assert!(near(below, down) && near(above, up), "{value} lies in {below}..{above}");
        }
    }

    #[test]
    fn figures_are_written_where_their_colour_is() {
        for scale in [
            Scale::Linear { high: 80.0 },
            Scale::Logarithmic { low: 0.3, high: 40.0 },
            Scale::Signed { most: 30.0 },
        ] {
            let marks = scale.marks();
            assert!(3 <= marks.len(), "{scale:?} has {marks:?}");
            for (place, text) in &marks {
                let value: f64 = text.replace('−', "-").parse().unwrap();
                assert!(
                    (scale.place(value) - place).abs() < 1e-6,
                    "{text} of {scale:?} at {place}"
                );
            }
            assert_eq!((marks[0].0, marks[marks.len() - 1].0), (0.0, 1.0), "the ends of {scale:?}");
        }
    }

    #[test]
    fn the_sides_of_a_signed_scale_mirror_each_other() {
        let scale = Scale::Signed { most: 20.0 };
        assert_eq!(scale.place(0.0), 0.5, "0 is not in the middle");
        let sum = scale.place(-7.0) + scale.place(7.0);
        assert!((sum - 1.0).abs() < 1e-12, "off by {sum}");
        assert_eq!(scale.place(f64::INFINITY), 1.0, "infinity leaves the ramp");
    }
}

//! Which numbers a key takes.
//!
//! Two kinds of bounds are kept apart, because they are explained apart: what a number means
//! (a reflectance lies in 0..=1), and what the renderer's single-precision arithmetic can square
//! and divide by without overflow ([`LARGEST`], [`LARGEST_LIGHT`], [`SMALLEST`]).

/// Largest size of a length, a factor or any number of which nothing narrower is said: scenes are
/// computed in `f32`, where its square, and the product with another's, is still finite.
pub const LARGEST: f64 = 1e12;

/// Largest radiance, power or component of a colour.
pub const LARGEST_LIGHT: f64 = 1e30;

/// Smallest size of a number that must not be 0: its square can still be divided by in `f32`.
pub const SMALLEST: f64 = 1e-12;

/// A set of numbers, with the words that describe it.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// After "a number": "above 0". Empty where any finite number will do.
    words: &'static str,
    meant: fn(f64) -> bool,
    smallest: f64,
    largest: f64,
}

/// Why a number is not in a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outside {
    /// It is no number to compute with: infinite, or NaN.
    NotFinite,
    /// It means nothing here.
    Meaning,
    /// Its size is above what can be computed with.
    TooLarge(f64),
    /// Its size is below what can be computed with.
    TooSmall(f64),
}

impl Range {
    /// Every finite number.
    pub const ANY: Self = Self { words: "", meant: |_| true, smallest: 0.0, largest: LARGEST };
    /// 0 and more.
    pub const AT_LEAST_0: Self = Self { words: "of at least 0", meant: |x| 0.0 <= x, ..Self::ANY };
    /// More than 0.
    pub const ABOVE_0: Self =
        Self { words: "above 0", meant: |x| 0.0 < x, smallest: SMALLEST, ..Self::ANY };
    /// All but 0.
    pub const NOT_0: Self =
        Self { words: "other than 0", meant: |x| x != 0.0, smallest: SMALLEST, ..Self::ANY };
    /// What a surface may do with light.
    pub const UNIT: Self =
        Self { words: "from 0 to 1", meant: |x| (0.0..=1.0).contains(&x), ..Self::ANY };
    /// Radiance, power, colour.
    pub const LIGHT: Self = Self { largest: LARGEST_LIGHT, ..Self::AT_LEAST_0 };
    /// A full angle of view in degrees, in `f32` too: just below 180 it would be 180 there.
    pub const FIELD_OF_VIEW: Self = Self {
        words: "above 0 and below 180",
        meant: |x| 0.0 < x && (x as f32) < 180.0,
        smallest: 1e-6,
        ..Self::ANY
    };
    /// An angle between normals in degrees.
    pub const CREASE: Self =
        Self { words: "from 0 to 180", meant: |x| (0.0..=180.0).contains(&x), ..Self::ANY };
    /// Stops; 2 to their power stays finite.
    pub const EXPOSURE: Self = Self { largest: 100.0, ..Self::ANY };
    /// Amplitude ratio; its 12th power stays finite.
    pub const GAIN: Self = Self { largest: 1000.0, ..Self::AT_LEAST_0 };
    /// Frequency ratio; its 12th power stays finite.
    pub const LACUNARITY: Self = Self { largest: 1000.0, ..Self::ABOVE_0 };

    /// Whether a number belongs, and if not, why.
    pub fn judge(self, number: f64) -> Result<(), Outside> {
        if !number.is_finite() {
            return Err(Outside::NotFinite);
        }
        if !(self.meant)(number) {
            return Err(Outside::Meaning);
        }
        if self.largest < number.abs() {
            return Err(Outside::TooLarge(self.largest));
        }
        if number.abs() < self.smallest {
            return Err(Outside::TooSmall(self.smallest));
        }
        Ok(())
    }

    /// What it holds, in words: `say("a number")` is "a number above 0".
    pub fn say(self, what: &str) -> String {
        if self.words.is_empty() { what.into() } else { format!("{what} {}", self.words) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_strict_and_loose_where_they_are_meant_to_be() {
        for (range, inside, outside) in [
            (Range::ABOVE_0, vec![1e-12, 1e12], vec![0.0, -0.0, -1.0, 1e-13, 1.1e12]),
            (Range::AT_LEAST_0, vec![0.0, -0.0, 1e-300], vec![-1e-300, 1.1e12]),
            (Range::NOT_0, vec![-1.0, 1.0], vec![0.0, -0.0, 1e-13]),
            (Range::UNIT, vec![0.0, 1.0], vec![-1e-9, 1.000_000_1]),
            (Range::FIELD_OF_VIEW, vec![0.001, 179.999], vec![0.0, 180.0, 179.999_999_99]),
            (Range::CREASE, vec![0.0, 180.0], vec![-0.1, 180.1]),
            (Range::LIGHT, vec![0.0, 1e30], vec![-1.0, 1.1e30]),
            (Range::ANY, vec![-1e12, 1e12], vec![-1.1e12]),
        ] {
            for number in inside {
                assert_eq!(range.judge(number), Ok(()), "{number} and {range:?}");
            }
            for number in outside.into_iter().chain([f64::NAN, f64::INFINITY, -f64::INFINITY]) {
                assert!(range.judge(number).is_err(), "{number} and {range:?}");
            }
        }
    }
}

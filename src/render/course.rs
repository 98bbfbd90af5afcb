//! How the squared error of a picture is going to fall.

/// How a squared error is going to fall: in steps, each by a power of the samples, then evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    steps: [Step; LONGEST],
    /// By how much it falls whenever samples double after them.
    ratio: f64,
}

/// Steps of a course.
pub(super) const LONGEST: usize = 5;

/// Samples that are shared out already, or are likely to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// How many times the samples before there are with them; 1 for no step at all.
    pub samples: f64,
    /// The squared error with them over that before.
    pub ratio: f64,
}

impl Course {
    /// Falls by `ratio` whenever samples double.
    pub const fn even(ratio: f64) -> Self {
        Self { steps: [Step { samples: 1.0, ratio: 1.0 }; LONGEST], ratio }
    }

    /// First in steps, then evenly.
    pub fn new(steps: [Step; LONGEST], ratio: f64) -> Self {
        Self { steps, ratio }
    }

    /// The squared error at so many times the samples, over that of now.
    pub fn after(&self, samples: f64) -> f64 {
        let (mut left, mut error) = (samples, 1.0);
        for step in self.steps() {
            if left <= step.samples {
                return error * libm::pow(step.ratio, libm::log(left) / libm::log(step.samples));
            }
            left /= step.samples;
            error *= step.ratio;
        }
        error * libm::pow(left, libm::log2(self.ratio))
    }

    /// At how many times the samples the squared error has fallen to `error` times that of now.
    pub fn samples_to(&self, error: f64) -> f64 {
        let (mut left, mut samples) = (error, 1.0);
        for step in self.steps() {
            if left >= step.ratio {
                return samples * libm::pow(step.samples, libm::log(left) / libm::log(step.ratio));
            }
            left /= step.ratio;
            samples *= step.samples;
        }
        samples * libm::pow(left, 1.0 / libm::log2(self.ratio))
    }

    /// Those that do anything.
    fn steps(&self) -> impl Iterator<Item = &Step> {
        self.steps.iter().filter(|step| step.samples > 1.0 && step.ratio < 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_near(found: f64, expected: f64, what: &str) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{what}: {found}, not {expected}");
    }

    #[test]
    fn an_even_course_falls_at_each_doubling() {
        for ratio in [0.35_f64, 0.5] {
            let course = Course::even(ratio);
            assert_near(course.samples_to(ratio.powi(3)), 8.0, "three doublings");
            assert_near(course.after(8.0), ratio.powi(3), "three doublings");
        }
    }

    /// What is shared out comes first: three quarters of the error are gone with thrice the samples.
    #[test]
    fn a_course_goes_step_by_step() {
        let nothing = Step { samples: 1.0, ratio: 1.0 };
        let [first, second] =
            [Step { samples: 3.0, ratio: 0.25 }, Step { samples: 2.0, ratio: 0.4 }];
        let course = Course::new([first, second, nothing, nothing, nothing], 0.5);
        for (samples, error) in [
            (1.0, 1.0),
            (3.0_f64.sqrt(), 0.5),
            (3.0, 0.25),
            (3.0 * 2.0_f64.sqrt(), 0.25 * 0.4_f64.sqrt()),
            (6.0, 0.1),
            (24.0, 0.025),
        ] {
            assert_near(course.samples_to(error), samples, "samples");
            assert_near(course.after(samples), error, "error");
        }
    }
}

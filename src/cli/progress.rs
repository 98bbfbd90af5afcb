//! A progress bar on stderr, where that is a terminal.

use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::render::Film;
use crate::session::Goal;

/// Shows how far a render is.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    goal: Goal,
    start: Instant,
}

impl Progress {
    /// From now on. The goal's samples are 100 %, though it may be reached before. Hidden where nobody
    /// looks.
    pub(super) fn new(goal: Goal, is_quiet: bool) -> Self {
        let target =
            if is_quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(u64::from(goal.samples)), target);
        let rate = |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            // Writing to a string cannot fail.
            let _ = write!(out, "{:.1}", state.per_sec());
        };
        let template = "{bar:32} {pos}/{len} samples  {rate} samples/s  {msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.with_key("rate", rate));
        }
        Self { bar, goal, start: Instant::now() }
    }

    /// After every pass.
    pub(super) fn show(&mut self, film: &Film) {
        self.bar.set_position(u64::from(film.n_samples()));
        let seconds = self.start.elapsed().as_secs_f64();
        let left = self.goal.seconds_left(film, seconds).map(|seconds| {
            let whole = Duration::from_secs(seconds.round() as u64);
            format!("{} left", HumanDuration(whole))
        });
        let noise = film.noise().map(|noise| {
            format!("noise {:.2} ± {:.2} %", noise.percent, noise.percent * noise.uncertainty)
        });
        let parts: Vec<String> = left.into_iter().chain(noise).collect();
        self.bar.set_message(parts.join("  "));
    }

    /// Clears the line.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

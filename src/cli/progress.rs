//! A progress bar on stderr, where that is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::render::Film;

/// Shows how far a render is.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// `n_samples` a pixel are 100 %. Hidden where nobody looks.
    pub(super) fn new(n_samples: u64, is_quiet: bool) -> Self {
        let target =
            if is_quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(n_samples), target);
        let rate = |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            // Writing to a string cannot fail.
            let _ = write!(out, "{:.1}", state.per_sec());
        };
        let template = "{bar:32} {pos}/{len} samples  {rate} samples/s  {eta} left  {msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.with_key("rate", rate));
        }
        Self { bar }
    }

    /// After every pass.
    pub(super) fn show(&mut self, film: &Film) {
        self.bar.set_position(u64::from(film.n_samples()));
        if let Some(noise) = film.noise_percent() {
            self.bar.set_message(format!("noise {noise:.2} %"));
        }
    }

    /// Clears the line.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

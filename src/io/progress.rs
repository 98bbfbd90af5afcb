//! Who waits for a file: whether it is still wanted, and how far it is.

use std::sync::atomic::{AtomicBool, Ordering};

/// What is being done with a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Its text is read; so much of it, 0..=1.
    Reading(f32),
    /// Its shading normals are made.
    Normals,
    /// The tree over its triangles is built.
    Tree,
}

/// Asked by those who read, all the time, whether to go on; and told how far they are.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    stop: &'a AtomicBool,
    told: &'a dyn Fn(Step),
}

impl<'a> Watch<'a> {
    /// Stops what it watches once `stop` is set, and hears of every step.
    pub fn new(stop: &'a AtomicBool, told: &'a dyn Fn(Step)) -> Self {
        Self { stop, told }
    }

    /// Whether the file is not wanted any more.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// What is set once the file is not wanted any more.
    pub fn stop(&self) -> &'a AtomicBool {
        self.stop
    }

    /// Takes note of a step.
    pub fn tell(&self, step: Step) {
        (self.told)(step);
    }
}

impl<'a> From<&'a AtomicBool> for Watch<'a> {
    /// Stops only; nobody listens.
    fn from(stop: &'a AtomicBool) -> Self {
        Self { stop, told: &|_| () }
    }
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").field("is_stopped", &self.is_stopped()).finish_non_exhaustive()
    }
}

//! What was done to a scene, step by step, as whole descriptions.

use std::collections::VecDeque;

use crate::scene::description::SceneDescription;

/// As many steps are kept.
const MOST_STEPS: usize = 256;

/// Fewer are kept where they hold more than this many entries of lists in all: about 100 MB.
const MOST_ENTRIES: usize = 200_000;

/// The present, with steps back and forth.
#[derive(Clone, Debug)]
pub(super) struct History {
    present: SceneDescription,
    /// Oldest first.
    undo: VecDeque<Step>,
    /// The next one last.
    redo: Vec<Step>,
    /// Whether the newest step may still grow by edits of its gesture.
    is_open: bool,
}

/// One edit: what it was called, and what was there on its other side.
#[derive(Clone, Debug)]
struct Step {
    label: String,
    gesture: Option<u64>,
    other: SceneDescription,
}

impl History {
    pub(super) fn new(present: SceneDescription) -> Self {
        Self { present, undo: VecDeque::new(), redo: Vec::new(), is_open: false }
    }

    /// The scene as of the last step.
    pub(super) fn present(&self) -> &SceneDescription {
        &self.present
    }

    /// Makes a step to `now`, or lengthens the newest where the gesture is the same.
    /// `name` says what a new step is called, from what was there to what is.
    pub(super) fn record(
        &mut self,
        now: &SceneDescription,
        gesture: Option<u64>,
        name: impl FnOnce(&SceneDescription, &SceneDescription) -> String,
    ) {
        if *now == self.present {
            return;
        }
        let before = std::mem::replace(&mut self.present, now.clone());
        self.redo.clear();
        let newest = self.undo.back().filter(|_| self.is_open);
        if let Some(newest) = newest.filter(|step| gesture.is_some() && step.gesture == gesture) {
            if newest.other == self.present {
                self.undo.pop_back();
                self.is_open = false;
            }
            return;
        }
        let label = name(&before, now);
        self.undo.push_back(Step { label, gesture, other: before });
        self.is_open = true;
        self.forget();
    }

    pub(super) fn undo(&mut self) -> Option<String> {
        let mut step = self.undo.pop_back()?;
        std::mem::swap(&mut step.other, &mut self.present);
        let label = step.label.clone();
        self.redo.push(step);
        self.is_open = false;
        Some(label)
    }

    pub(super) fn redo(&mut self) -> Option<String> {
        let mut step = self.redo.pop()?;
        std::mem::swap(&mut step.other, &mut self.present);
        let label = step.label.clone();
        self.undo.push_back(step);
        self.is_open = false;
        Some(label)
    }

    pub(super) fn undo_label(&self) -> Option<&str> {
        self.undo.back().map(|step| &*step.label)
    }

    pub(super) fn redo_label(&self) -> Option<&str> {
        self.redo.last().map(|step| &*step.label)
    }

    /// Drops the oldest steps beyond the limits; the newest always stays.
    fn forget(&mut self) {
        let mut entries: usize = self.undo.iter().map(|step| n_entries(&step.other)).sum();
        while 1 < self.undo.len() && (MOST_STEPS < self.undo.len() || MOST_ENTRIES < entries) {
            if let Some(oldest) = self.undo.pop_front() {
                entries -= n_entries(&oldest.other);
            }
        }
    }
}

fn n_entries(scene: &SceneDescription) -> usize {
    scene.textures.len() + scene.materials.len() + scene.lights.len() + scene.objects.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::scene_file::parse;

    #[test]
    fn the_oldest_steps_are_forgotten() {
        let mut scene = parse("camera = { eye = [0, 0, 1], target = [0, 0, 0] }", &[]).unwrap();
        let mut history = History::new(scene.clone());
        for seed in 1..=2 * MOST_STEPS as u32 {
            scene.render.seed = seed;
            history.record(&scene, None, |_, _| "seed".to_owned());
        }
        let mut n_undone = 0;
        while history.undo().is_some() {
            n_undone += 1;
        }
        assert_eq!(n_undone, MOST_STEPS, "steps");
        assert_eq!(history.present().render.seed, MOST_STEPS as u32, "seed of the oldest step");
    }
}

//! The scene being edited: what it is, where it came from, what was done to it.
//!
//! The description is edited in place, by anyone; what has changed is found by comparing, never
//! told. [`Document::checkpoint`] ends a step of undo. Nothing here reads or writes files.

use std::path::{Path, PathBuf};

use toml::Value;

use crate::io::scene_file::{
    EditError, ParameterPath, PathError, get, parameters, with_default, with_value,
};
use crate::scene::description::SceneDescription;

mod change;
mod history;
mod label;
mod rebase;

pub use change::{ChangeKind, change};

use history::History;
use label::edit_label;
use rebase::with_edits;

/// A scene with its past.
#[derive(Clone, Debug)]
pub struct Document {
    /// The scene as it is now. Edit it in place, then call [`Document::checkpoint`].
    pub description: SceneDescription,
    path: Option<PathBuf>,
    saved: SceneDescription,
    history: History,
}

impl Document {
    /// A scene that was just opened, and is unchanged. `path` is the file that saving writes to;
    /// `None` for a scene that has none of its own, such as one around a mesh.
    pub fn new(description: SceneDescription, path: Option<PathBuf>) -> Self {
        let saved = description.clone();
        let history = History::new(description.clone());
        Self { description, path, saved, history }
    }

    /// A scene that no file of its own holds: it differs from `saved` until it is saved.
    pub fn unsaved(description: SceneDescription, saved: SceneDescription) -> Self {
        Self { saved, ..Self::new(description, None) }
    }

    /// The file that it was read from or last saved to.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Whether it differs from what its file holds. Undoing everything makes it clean again.
    pub fn is_dirty(&self) -> bool {
        self.description != self.saved
    }

    /// Says that this file now holds the scene as it is.
    pub fn mark_saved(&mut self, path: impl Into<PathBuf>) {
        self.path = Some(path.into());
        self.saved = self.description.clone();
    }

    /// What its file holds, as it was read or saved last.
    pub fn saved(&self) -> &SceneDescription {
        &self.saved
    }

    /// Takes over what its file holds now, after another program changed it. Can be undone.
    pub fn reload(&mut self, description: SceneDescription) {
        self.checkpoint(None);
        self.saved = description.clone();
        self.description = description;
        self.history.record(&self.description, None, |_, _| "reload".to_owned());
    }

    /// Takes over what a scene that nobody wrote is now, such as the one around a mesh, beneath the
    /// edits: every part that was edited stays. Can be undone.
    pub fn rebase(&mut self, beneath: SceneDescription) {
        self.checkpoint(None);
        self.description = with_edits(&self.saved, &self.description, &beneath);
        self.saved = beneath;
        self.history.record(&self.description, None, |_, _| "reload".to_owned());
    }

    /// Makes one step of undo of all edits since the last, if there are any. Edits with the same
    /// `gesture`, such as those of one drag, become one step, as long as nothing else comes
    /// between. What undo would undo is named after what the first of them changed.
    pub fn checkpoint(&mut self, gesture: Option<u64>) {
        self.history.record(&self.description, gesture, edit_label);
    }

    /// Goes back one step, and says which. Edits without a checkpoint are a step of their own.
    pub fn undo(&mut self) -> Option<String> {
        self.checkpoint(None);
        let label = self.history.undo()?;
        self.description = self.history.present().clone();
        Some(label)
    }

    /// Goes forward one step that was undone, and says which.
    pub fn redo(&mut self) -> Option<String> {
        self.checkpoint(None);
        let label = self.history.redo()?;
        self.description = self.history.present().clone();
        Some(label)
    }

    /// What undo would undo.
    pub fn undo_label(&self) -> Option<&str> {
        self.history.undo_label()
    }

    /// What redo would do again.
    pub fn redo_label(&self) -> Option<&str> {
        self.history.redo_label()
    }

    /// The paths of all parameters, in the order of a file.
    pub fn parameters(&self) -> Vec<ParameterPath> {
        parameters(&self.description)
    }

    /// The value of a parameter; `None` where it is absent and its default is no fixed value.
    pub fn get(&self, path: &str) -> Result<Option<Value>, PathError> {
        get(&self.description, &path.parse()?)
    }

    /// Gives a parameter a value, if the scene is valid then; else it stays as it was.
    pub fn set(&mut self, path: &str, value: impl Into<Value>) -> Result<(), EditError> {
        self.description = with_value(&self.description, &path.parse()?, value.into())?;
        Ok(())
    }

    /// Gives a parameter its default, or takes it away; required ones have none.
    pub fn reset(&mut self, path: &str) -> Result<(), EditError> {
        self.description = with_default(&self.description, &path.parse()?)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::scene_file::parse;

    const TEXT: &str = "\
        camera = { eye = [0, 1, 5], target = [0, 1, 0] }\n\
        [[objects]]\nname = 'my ball'\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\n";

    /// What undo calls a change of the radius.
    const RADIUS: &str = "object my ball radius";

    fn document() -> Document {
        Document::new(parse(TEXT, &[]).unwrap(), Some("a.toml".into()))
    }

    fn radius(document: &Document) -> Option<f64> {
        document.description.objects[0].radius
    }

    fn set_radius(document: &mut Document, radius: f64, gesture: Option<u64>) {
        document.description.objects[0].radius = Some(radius);
        document.checkpoint(gesture);
    }

    #[test]
    fn a_drag_is_one_step_of_undo() {
        let mut document = document();
        for step in 1..=10 {
            set_radius(&mut document, 1.0 + f64::from(step), Some(7));
        }
        set_radius(&mut document, 20.0, Some(8));
        assert_eq!(document.undo().as_deref(), Some(RADIUS), "the second drag");
        assert_eq!(radius(&document), Some(11.0), "after the first drag");
        assert_eq!(document.undo().as_deref(), Some(RADIUS), "the first drag");
        assert_eq!(radius(&document), Some(1.0), "at the start");
        assert_eq!(document.undo(), None, "nothing is left");
        assert_eq!(document.redo().as_deref(), Some(RADIUS), "the first drag again");
        assert_eq!(radius(&document), Some(11.0), "after the first drag again");
    }

    #[test]
    fn edits_without_a_gesture_are_steps_of_their_own() {
        let mut document = document();
        set_radius(&mut document, 2.0, None);
        set_radius(&mut document, 3.0, None);
        document.undo();
        assert_eq!(radius(&document), Some(2.0), "after one undo");
    }

    #[test]
    fn a_drag_that_ends_where_it_began_leaves_no_step() {
        let mut document = document();
        set_radius(&mut document, 2.0, Some(1));
        set_radius(&mut document, 1.0, Some(1));
        assert_eq!(document.undo_label(), None, "label");
    }

    #[test]
    fn a_gesture_does_not_join_a_step_across_an_undo() {
        let mut document = document();
        set_radius(&mut document, 2.0, Some(1));
        set_radius(&mut document, 3.0, Some(2));
        document.undo();
        set_radius(&mut document, 4.0, Some(1));
        document.undo();
        assert_eq!(radius(&document), Some(2.0), "after undo");
    }

    #[test]
    fn a_new_edit_ends_redo_and_no_edit_does_not() {
        let mut document = document();
        set_radius(&mut document, 2.0, None);
        document.undo();
        document.checkpoint(None);
        assert_eq!(document.redo_label(), Some(RADIUS), "before an edit");
        set_radius(&mut document, 3.0, None);
        assert_eq!(document.redo_label(), None, "after an edit");
        assert_eq!(document.redo(), None, "redo after an edit");
    }

    #[test]
    fn an_edit_without_a_checkpoint_is_not_lost_by_undo() {
        let mut document = document();
        document.description.camera.vertical_fov = 50.0;
        document.undo();
        assert_eq!(document.description.camera.vertical_fov, 40.0, "undone");
        document.redo();
        assert_eq!(document.description.camera.vertical_fov, 50.0, "done again");
    }

    #[test]
    fn it_is_dirty_while_it_differs_from_its_file() {
        let mut document = document();
        assert!(!document.is_dirty(), "just opened");
        set_radius(&mut document, 2.0, None);
        assert!(document.is_dirty(), "edited");
        document.undo();
        assert!(!document.is_dirty(), "undone");
        document.redo();
        document.mark_saved("b.toml");
        assert!(!document.is_dirty(), "saved");
        assert_eq!(document.path(), Some(Path::new("b.toml")), "path");
        document.undo();
        assert!(document.is_dirty(), "undone behind the save");
    }

    #[test]
    fn a_scene_without_a_file_is_dirty_until_it_is_saved() {
        let Document { description, .. } = document();
        let mut other = description.clone();
        other.render.samples = 7;
        let mut document = Document::unsaved(description, other);
        assert!(document.is_dirty(), "restored");
        assert_eq!(document.undo(), None, "there is nothing before it");
        document.mark_saved("b.toml");
        assert!(!document.is_dirty(), "saved");
    }

    #[test]
    fn a_reload_is_clean_and_can_be_undone() {
        let mut document = document();
        let other = parse(&TEXT.replace("radius = 1", "radius = 9"), &[]).unwrap();
        document.description.camera.vertical_fov = 50.0;
        document.reload(other);
        assert!(!document.is_dirty(), "reloaded");
        assert_eq!(document.undo().as_deref(), Some("reload"), "label");
        assert_eq!(document.description.camera.vertical_fov, 50.0, "the edit before");
    }

    #[test]
    fn parameters_are_read_set_and_reset_by_path() {
        let mut document = document();
        assert_eq!(document.get("objects.'my ball'.radius"), Ok(Some(1.0.into())), "radius");
        assert_eq!(document.get("camera.focal_distance"), Ok(None), "focal distance");
        document.set("camera.focal_distance", 3).unwrap();
        assert_eq!(document.description.camera.focal_distance, Some(3.0), "focal distance");
        document.reset("camera.focal_distance").unwrap();
        assert_eq!(document.description.camera.focal_distance, None, "focal distance");
        document.set("render.samples", 5).unwrap();
        document.reset("render.samples").unwrap();
        assert_eq!(document.description.render.samples, 256, "samples");
    }

    #[test]
    fn a_refused_edit_leaves_the_scene_as_it_was() {
        let mut document = document();
        for (path, value, says) in [
            ("camera.eye", Value::from(vec![0, 1, 0]), "camera.target: this is where the eye is"),
            ("render.samples", 0.into(), "render.samples: 0 is not a number of samples"),
            ("render.sample", 1.into(), "did you mean samples?"),
            ("objects.'my ball'.radius", "big".into(), "\"big\" is not a radius"),
        ] {
            let error = document.set(path, value).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
        for path in ["camera.eye", "objects.'my ball'.name", "objects.'my ball'.center", "a..b"] {
            assert!(document.reset(path).is_err(), "{path}");
        }
        assert!(!document.is_dirty(), "after refused edits");
    }
}

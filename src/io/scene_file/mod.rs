//! Scene files: TOML to a valid [`SceneDescription`], and back.
//!
//! A text is read in steps, each with its own errors: TOML with the place of every value; the
//! names of what has none; overrides; types and ranges, key by key; serde; and what must hold
//! between values. An error says line and column, the parameter's path, what was found and what
//! would be right. Nothing here reads the meshes and images that a scene names.

use serde::Deserialize;
use toml::{Table, Value};

use crate::scene::description::SceneDescription;

mod check;
mod keys;
mod nesting;
mod overrides;
mod parameters;
mod path;
#[cfg(test)]
mod random;
mod range;
#[cfg(test)]
mod refused;
mod relations;
mod slot;
mod source;
#[cfg(test)]
mod tests;
mod words;
mod write;

pub use keys::{Key, Presence, Rule, Section};
pub use overrides::{Override, OverrideError};
pub use parameters::{EditError, get, has_default, parameters, values, with_default, with_value};
pub use path::{ParameterPath, PathError};
pub use range::{LARGEST, LARGEST_LIGHT, Outside, Range, SMALLEST};
#[cfg(feature = "window")]
pub(crate) use words::suggestion;
pub use write::write;

use check::{Fault, check_shape, check_values, name_the_unnamed};
use relations::check_relations;
use slot::{Slot, Step, path_text};
use source::{Position, Source};
use words::printable;

/// Longest scene file that is read, in bytes: room for 50 000 objects.
pub const LARGEST_FILE: u64 = 8 << 20;

/// Why a text is no scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneFileError {
    /// The command line is wrong, not the scene.
    #[error(transparent)]
    Override(#[from] OverrideError),

    /// A mistake at a place in the text.
    #[error("{line}:{column}: {message}")]
    Text {
        /// Counted from 1.
        line: usize,
        /// In characters, counted from 1.
        column: usize,
        /// Path of the parameter, where there is one, what is wrong and what would be right.
        message: String,
    },

    /// A mistake in a value that an override gave.
    #[error("{option} {message}")]
    OverrideValue {
        /// The option that gave it: "--set".
        option: String,
        /// Path of the parameter, what is wrong and what would be right.
        message: String,
    },

    /// The file is longer than [`LARGEST_FILE`].
    #[error("is longer than {LARGEST_FILE} bytes, too long for a scene")]
    TooLarge,
}

impl SceneFileError {
    /// The message for a file of that name, as in "scene.toml:4:11: …".
    pub fn in_file(&self, file: &str) -> String {
        match self {
            Self::Override(_) | Self::OverrideValue { .. } => self.to_string(),
            Self::Text { .. } => format!("{}:{self}", printable(file)),
            Self::TooLarge => format!("{}: {self}", printable(file)),
        }
    }
}

/// A value of a description that cannot be, or does not go with the others.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {message}")]
pub struct Invalid {
    /// The parameter's path.
    pub path: String,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl Invalid {
    fn of(fault: Fault, root: &Table) -> Self {
        Self { path: path_text(root, &fault.steps), message: fault.message }
    }
}

/// Bytes of a scene file as text.
pub fn text_of(bytes: Vec<u8>) -> Result<String, SceneFileError> {
    if LARGEST_FILE < bytes.len() as u64 {
        return Err(SceneFileError::TooLarge);
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let byte = error.as_bytes()[good];
        let before = String::from_utf8_lossy(&error.as_bytes()[..good]);
        let place = source::position(before.trim_start_matches('\u{feff}'), usize::MAX);
        at(place, format!("byte 0x{byte:02x} is not UTF-8; save the file in that encoding"))
    })
}

/// Reads a scene: its TOML, with the overrides in their order on top of it.
pub fn parse(text: &str, overrides: &[Override]) -> Result<SceneDescription, SceneFileError> {
    if LARGEST_FILE < text.len() as u64 {
        return Err(SceneFileError::TooLarge);
    }
    let source = Source::parse(text).map_err(|(place, message)| at(place, message))?;
    let mut root = source.table();
    let mut placed = Vec::new();
    check_shape(&root).map_err(|fault| located(&fault, &root, &source, &placed))?;
    name_the_unnamed(&mut root);
    for given in overrides {
        placed.push((given, given.apply(&mut root)?));
    }
    scene_of(&root).map_err(|fault| located(&fault, &root, &source, &placed))
}

/// Whether a description could have come from a file.
pub fn validate(scene: &SceneDescription) -> Result<(), Invalid> {
    let root = table_of(scene);
    check_values(&root)
        .and_then(|()| check_relations(scene))
        .map_err(|fault| Invalid::of(fault, &root))
}

/// The valid description that a table with all its names holds.
fn scene_of(root: &Table) -> Result<SceneDescription, Fault> {
    check_values(root)?;
    let scene = SceneDescription::deserialize(Value::Table(root.clone()))
        .map_err(|error| Fault::new(Vec::new(), printable(error.message())))?;
    check_relations(&scene)?;
    Ok(scene)
}

/// A description as the table that a file would hold.
fn table_of(scene: &SceneDescription) -> Table {
    Table::try_from(scene).expect("a description is made of tables with string keys")
}

fn at(Position { line, column }: Position, message: String) -> SceneFileError {
    SceneFileError::Text { line, column, message }
}

/// A fault at its place: the override that made it, or line and column.
fn located(
    fault: &Fault,
    root: &Table,
    source: &Source<'_>,
    placed: &[(&Override, Slot)],
) -> SceneFileError {
    let message = format!("{}: {}", path_text(root, &fault.steps), fault.message);
    let from = |steps: &[Step]| {
        let (given, _) = placed.iter().rev().find(|(_, slot)| steps.starts_with(&slot.steps()))?;
        Some(*given)
    };
    if let Some(given) = from(&fault.steps) {
        return SceneFileError::OverrideValue { option: given.option.clone(), message };
    }
    if let Some(given) = fault.cause.as_deref().and_then(from) {
        let option = format!("{} {}:", given.option, given.path);
        return SceneFileError::OverrideValue { option, message };
    }
    let place = if fault.is_key {
        source.key_position(&fault.steps)
    } else {
        source.value_position(&fault.steps)
    };
    at(place, message)
}

/// An error about the file that an entry names: `index` counts in the section, `message` says what
/// is wrong with the file. The place is the entry's `file` key, or the override that gave it.
pub fn file_fault(
    text: &str,
    overrides: &[Override],
    section: Section,
    index: usize,
    message: &str,
) -> SceneFileError {
    let fault = Fault::new(
        vec![Step::key(section.name()), Step::Index(index), Step::key("file")],
        message.to_owned(),
    );
    let located = || {
        let source = Source::parse(text).ok()?;
        let mut root = source.table();
        name_the_unnamed(&mut root);
        let mut placed = Vec::new();
        for given in overrides {
            placed.push((given, given.apply(&mut root).ok()?));
        }
        Some(located(&fault, &root, &source, &placed))
    };
    located().unwrap_or_else(|| at(Position { line: 1, column: 1 }, message.to_owned()))
}

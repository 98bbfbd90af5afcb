//! Values given beside the file: `--set materials.ceramic.alpha_x=0.3`.

use toml::{Table, Value};

use super::path::{ParameterPath, end_of_path};
use super::slot::Slot;
use super::source::parse_value;
use super::words::{cut, quoted};

/// A value that takes the place of the file's, or joins it.
#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    /// The option that gave it, for messages: "--set".
    pub option: String,
    /// Which parameter.
    pub path: ParameterPath,
    /// Its value; checked as if the file held it.
    pub value: Value,
}

/// An override that does not parse, or whose path names no parameter: the command line is wrong,
/// not the scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{option} {text}: {message}")]
pub struct OverrideError {
    /// The option that gave it.
    pub option: String,
    /// What it said, made safe to print.
    pub text: String,
    /// What is wrong with it, and what would be right.
    pub message: String,
}

impl Override {
    /// An override that another option stands for, such as `--samples 64`.
    pub fn new(option: &str, path: &[&str], value: impl Into<Value>) -> Self {
        let path = ParameterPath::new(path.iter().copied());
        Self { option: option.into(), path, value: value.into() }
    }

    /// Reads `PATH=VALUE` of `--set`. VALUE is TOML; a bare word that is none is a string.
    pub fn parse(text: &str) -> Result<Self, OverrideError> {
        let error = |message: String| OverrideError {
            option: "--set".into(),
            text: cut(&quoted(text)),
            message,
        };
        let Some(end) = end_of_path(text) else {
            return Err(error(
                "has no value; write PATH=VALUE, as in camera.vertical_fov=35".into(),
            ));
        };
        let (path, value) = (&text[..end], text[end + 1..].trim());
        let path = path.parse::<ParameterPath>().map_err(|e| error(e.message))?;
        if value.is_empty() {
            return Err(error(
                "has no value; write PATH=VALUE, as in camera.vertical_fov=35".into(),
            ));
        }
        let value = match parse_value(value) {
            Ok(value) => value,
            Err(_) if is_bare_word(value) => Value::String(value.into()),
            Err(message) => {
                let remedy = "write a number, true, \"text\" or [1, 2, 3]";
                return Err(error(format!("its value is not TOML: {message}; {remedy}")));
            }
        };
        Ok(Self { option: "--set".into(), path, value })
    }

    /// Puts the value into a well-shaped table, and says where it went.
    pub(super) fn apply(&self, root: &mut Table) -> Result<Slot, OverrideError> {
        let slot = self.path.resolve(root).map_err(|error| OverrideError {
            option: self.option.clone(),
            text: error.path,
            message: error.message,
        })?;
        slot.set(root, self.value.clone());
        Ok(slot)
    }
}

/// Whether a value is a string without its quotes: a name, a word, the path of a file.
fn is_bare_word(text: &str) -> bool {
    let starts_well = |c: char| c.is_alphabetic() || "_./\\".contains(c);
    text.starts_with(starts_well)
        && text.chars().all(|c| c.is_alphanumeric() || "_-./\\:".contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_toml_and_bare_words_are_strings() {
        for (text, value) in [
            ("render.samples=16", Value::Integer(16)),
            ("camera.eye=[0, 1.5, 2]", Value::Array(vec![0.into(), 1.5.into(), 2.into()])),
            ("render.integrator=path", "path".into()),
            ("render.integrator = \"path\" ", "path".into()),
            ("materials.x.diffuse=blue-marble", "blue-marble".into()),
            ("objects.x.file=../a/b-2.obj", "../a/b-2.obj".into()),
            ("lights.key.visible=true", true.into()),
            ("lights.key.visible=True", "True".into()),
            ("objects.'a=b'.scale=inf", f64::INFINITY.into()),
        ] {
            assert_eq!(Override::parse(text).map(|o| o.value), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_does_not_parse_is_the_command_lines_fault() {
        for text in [
            "",
            "=",
            "render.samples",
            "render.samples=",
            "=5",
            "render..samples=5",
            "render.samples=1.2.3",
            "render.samples=12abc",
            "camera.eye=[1, 2",
            "a.b=two words",
            "a.b=1\nc = 2",
            "a.b=\u{1b}[31m",
            "render.samples=-",
            "render.seed=0x",
            "materials.é.ior=2",
        ] {
            let read = Override::parse(text);
            let error = read.expect_err(text).to_string();
            assert!(!error.contains(|c: char| c.is_control()), "{error:?}");
        }
        let tower = format!("a.b={}", "[".repeat(100_000));
        assert!(Override::parse(&tower).is_err(), "read a tower of brackets");
    }
}

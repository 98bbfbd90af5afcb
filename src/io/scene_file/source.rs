//! The text of a scene file as a tree that knows where everything stands.

use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use super::nesting::too_deep;
use super::slot::Step;
use super::words::{cut, printable, quoted};

/// A text that is TOML.
pub(super) struct Source<'t> {
    text: &'t str,
    root: DeTable<'t>,
}

/// A place in a text, counted from 1; a column is a character, not a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Position {
    pub(super) line: usize,
    pub(super) column: usize,
}

impl<'t> Source<'t> {
    /// Reads TOML; the error is its first mistake.
    pub(super) fn parse(text: &'t str) -> Result<Self, (Position, String)> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if let Some(offset) = too_deep(text) {
            return Err((position(text, offset), "not a scene: nested too deeply".into()));
        }
        match DeTable::parse(text) {
            Ok(root) => Ok(Self { text, root: root.into_inner() }),
            Err(error) => {
                let span = error.span().unwrap_or(text.len()..text.len());
                let found = text.get(span.clone()).unwrap_or_default().trim();
                let message = complaint(&error);
                let found = if found.is_empty() {
                    String::new()
                } else {
                    format!(", at {}", cut(&quoted(found)))
                };
                Err((position(text, span.start), format!("not TOML: {message}{found}")))
            }
        }
    }

    /// Its content. An integer beyond 64 bits becomes a float or, of another base than ten, a
    /// string, to be refused by what it is for.
    pub(super) fn table(&self) -> Table {
        plain_table(&self.root)
    }

    /// Where a value stands; the nearest that holds it where it is absent.
    pub(super) fn value_position(&self, steps: &[Step]) -> Position {
        self.find(steps, |_, value| value.span().start)
    }

    /// Where the key of a value stands; of what holds it, the value, where it is absent.
    pub(super) fn key_position(&self, steps: &[Step]) -> Position {
        self.find(steps, |key, _| key)
    }

    fn find(
        &self,
        steps: &[Step],
        offset: impl Fn(usize, &Spanned<DeValue<'_>>) -> usize,
    ) -> Position {
        let Some((Step::Key(first), rest)) = steps.split_first() else {
            return Position { line: 1, column: 1 };
        };
        let Some((key, mut value)) = self.root.get_key_value(first.as_str()) else {
            return Position { line: 1, column: 1 };
        };
        let mut key_start = key.span().start;
        for step in rest {
            let next = match (step, value.get_ref()) {
                (Step::Key(name), DeValue::Table(table)) => {
                    table.get_key_value(name.as_str()).map(|(key, value)| (key.span().start, value))
                }
                (Step::Index(index), DeValue::Array(array)) => {
                    array.get(*index).map(|value| (value.span().start, value))
                }
                (_, _) => None,
            };
            match next {
                Some(next) => (key_start, value) = next,
                None => return position(self.text, value.span().start),
            }
        }
        position(self.text, offset(key_start, value))
    }
}

/// Reads one TOML value; the error is what is wrong with it.
pub(super) fn parse_value(text: &str) -> Result<Value, String> {
    if too_deep(text).is_some() {
        return Err("nested too deeply".into());
    }
    text.parse::<Value>().map_err(|error| complaint(&error))
}

/// The parser's words, without what says nothing.
fn complaint(error: &toml::de::Error) -> String {
    let message = error.message();
    let known = [", expected nothing", ", expected literal string"];
    let message = known.into_iter().find_map(|end| message.strip_suffix(end)).unwrap_or(message);
    printable(message)
}

/// Line and column of a byte offset.
pub(super) fn position(text: &str, offset: usize) -> Position {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    Position {
        line: before.bytes().filter(|&b| b == b'\n').count() + 1,
        column: before[line_start..].chars().count() + 1,
    }
}

fn plain_table(table: &DeTable<'_>) -> Table {
    table.iter().map(|(key, value)| (key.get_ref().to_string(), plain(value.get_ref()))).collect()
}

fn plain(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(integer) => Value::Integer(integer),
            Err(_) => match digits.as_str().parse() {
                Ok(float) if digits.radix() == 10 => Value::Float(float),
                _ => Value::String(digits.to_string()),
            },
        },
        DeValue::Float(digits) => Value::Float(digits.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Boolean(*flag),
        DeValue::Datetime(datetime) => Value::Datetime(*datetime),
        DeValue::Array(array) => {
            Value::Array(array.iter().map(|element| plain(element.get_ref())).collect())
        }
        DeValue::Table(table) => Value::Table(plain_table(table)),
    }
}

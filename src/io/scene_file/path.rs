//! The path of a parameter: `camera.eye`, `materials.ceramic.bump.height`,
//! `objects."my teapot".scale`.
//!
//! A path names one value of a scene's table, whether or not it is there yet.

use std::fmt;
use std::str::FromStr;

use toml::{Table, Value};

use super::keys::{Key, Rule, Section};
use super::slot::{Slot, entry_name};
use super::words::{cut, key_text, quoted, shown_name, suggestion};

/// The names of a path, from the section inward. Its text quotes them where TOML would.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ParameterPath(Vec<String>);

/// A path that cannot be read or that leads nowhere.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {message}")]
pub struct PathError {
    /// The path as it was given, made safe to print.
    pub path: String,
    /// What is wrong with it, and what would be right.
    pub message: String,
}

impl ParameterPath {
    /// A path of these names.
    pub fn new(names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self(names.into_iter().map(Into::into).collect())
    }

    /// Its names, unquoted.
    pub fn names(&self) -> &[String] {
        &self.0
    }

    /// Finds the place it names in a scene's table, whose lists have been given their names.
    pub(super) fn resolve(&self, root: &Table) -> Result<Slot, PathError> {
        let Some((first, rest)) = self.0.split_first() else {
            return Err(self.error("names no parameter".into()));
        };
        let Some(section) = Section::named(first) else {
            let sections = Section::ALL.map(Section::name);
            let hint = suggestion(first, sections, key_text);
            return Err(self.error(format!("there is no section {}{hint}", shown_name(first))));
        };
        let (entry, rest) = match (section.entry_noun(), rest.split_first()) {
            (Some(noun), Some((name, rest))) => {
                (Some(self.entry(root, section, noun, name)?), rest)
            }
            (Some(noun), None) => {
                let (name, a) = (section.name(), if noun == "object" { "an" } else { "a" });
                return Err(self.error(format!(
                    "names all {name}, not a parameter; write {name}.NAME.KEY, with the name of {a} {noun}"
                )));
            }
            (None, _) => (None, rest),
        };
        let (key, rest) = self.key(section.keys(), rest)?;
        match (key.rule, rest) {
            (_, []) => Ok(Slot { section, entry, key, inner: None }),
            (Rule::Table(keys), rest) => match self.key(keys, rest)? {
                (inner, []) => Ok(Slot { section, entry, key, inner: Some(inner) }),
                (inner, _) => Err(self.too_deep(inner)),
            },
            (_, _) => Err(self.too_deep(key)),
        }
    }

    fn entry(
        &self,
        root: &Table,
        section: Section,
        noun: &str,
        name: &str,
    ) -> Result<usize, PathError> {
        let entries = root.get(section.name()).and_then(Value::as_array).map_or(&[][..], |a| a);
        let names = entries.iter().filter_map(entry_name);
        entries.iter().position(|entry| entry_name(entry) == Some(name)).ok_or_else(|| {
            let hint = suggestion(name, names, quoted);
            self.error(format!("there is no {noun} {}{hint}", shown_name(name)))
        })
    }

    fn key<'p>(
        &self,
        keys: &'static [Key],
        rest: &'p [String],
    ) -> Result<(&'static Key, &'p [String]), PathError> {
        let names = keys.iter().map(|key| key.name);
        let Some((name, rest)) = rest.split_first() else {
            let names = names.collect::<Vec<_>>().join(", ");
            return Err(self.error(format!("is no parameter; add the name of one: {names}")));
        };
        match keys.iter().find(|key| key.name == name) {
            Some(key) => Ok((key, rest)),
            None => {
                let hint = suggestion(name, names, key_text);
                Err(self.error(format!("there is no key {}{hint}", shown_name(name))))
            }
        }
    }

    fn too_deep(&self, key: &Key) -> PathError {
        self.error(format!(
            "{} is one value and is set as a whole; give {}",
            key.name,
            key.rule.remedy()
        ))
    }

    pub(super) fn error(&self, message: String) -> PathError {
        PathError { path: cut(&self.to_string()), message }
    }
}

impl fmt::Display for ParameterPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, name) in self.0.iter().enumerate() {
            if 0 < i {
                f.write_str(".")?;
            }
            f.write_str(&key_text(name))?;
        }
        Ok(())
    }
}

impl FromStr for ParameterPath {
    type Err = PathError;

    /// Reads names as TOML reads a dotted key: bare, or in either kind of quotes, with white
    /// space allowed around the dots.
    fn from_str(text: &str) -> Result<Self, PathError> {
        let mut names = Vec::new();
        let mut rest = text.trim();
        loop {
            let (name, after) = read_name(rest).map_err(|message| PathError {
                path: cut(&quoted(text)),
                message: message.into(),
            })?;
            names.push(name);
            let after = after.trim_start();
            match after.strip_prefix('.') {
                Some(next) => rest = next.trim_start(),
                None if after.is_empty() => return Ok(Self(names)),
                None => {
                    return Err(PathError {
                        path: cut(&quoted(text)),
                        message: NEEDS_QUOTES.into(),
                    });
                }
            }
        }
    }
}

const NEEDS_QUOTES: &str =
    "a name in the path has other characters than letters, digits, - and _; put it in quotes";

/// The first name of a path, and what follows it.
fn read_name(text: &str) -> Result<(String, &str), &'static str> {
    const UNCLOSED: &str = "a quote in the path is not closed";
    const UNREADABLE: &str = "a quoted name in the path is no TOML string";
    if let Some(inside) = text.strip_prefix('\'') {
        let end = inside.find('\'').ok_or(UNCLOSED)?;
        return Ok((inside[..end].into(), &inside[end + 1..]));
    }
    if text.starts_with('"') {
        let end = closing_quote(text).ok_or(UNCLOSED)?;
        let value: Value = text[..end].parse().map_err(|_| UNREADABLE)?;
        let name = value.as_str().ok_or(UNREADABLE)?;
        return Ok((name.into(), &text[end..]));
    }
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let end = text.find(|c| !is_bare(c)).unwrap_or(text.len());
    if end == 0 && !text.is_empty() && !text.starts_with('.') {
        return Err(NEEDS_QUOTES);
    }
    if end == 0 {
        return Err("a name is missing in the path; write it as in camera.eye");
    }
    Ok((text[..end].into(), &text[end..]))
}

/// The offset behind the quote that closes the one at the start.
fn closing_quote(text: &str) -> Option<usize> {
    let mut escaped = false;
    for (i, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return Some(i + 1),
            _ => {}
        }
    }
    None
}

/// Where in a text of `PATH=VALUE` the equals sign stands that ends the path.
pub(super) fn end_of_path(text: &str) -> Option<usize> {
    let mut quote = None;
    let mut escaped = false;
    for (i, c) in text.char_indices() {
        match (quote, c) {
            _ if escaped => escaped = false,
            (Some('"'), '\\') => escaped = true,
            (Some(open), c) if open == c => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '=') => return Some(i),
            (None, _) => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_read_as_toml_keys_and_write_themselves_back() {
        for (text, names) in [
            ("render.samples", &["render", "samples"][..]),
            (" objects . 'my teapot' . scale ", &["objects", "my teapot", "scale"]),
            (r#"objects."a \"b\" = c".scale"#, &["objects", "a \"b\" = c", "scale"]),
            (r#"lights."".size"#, &["lights", "", "size"]),
            ("lights.1.size", &["lights", "1", "size"]),
            (r#"lights."é.ü".size"#, &["lights", "é.ü", "size"]),
        ] {
            let path: ParameterPath = text.parse().unwrap();
            assert_eq!(path.names(), names, "{text}");
            assert_eq!(path.to_string().parse::<ParameterPath>().unwrap(), path, "{text}");
        }
    }

    #[test]
    fn broken_paths_are_refused() {
        for text in
            ["", ".", "a..b", "a.", "a b", "a.\"b", "a.'b", "é.x", "a.\"\\q\".b", "a.\"b\"c"]
        {
            let path = text.parse::<ParameterPath>();
            assert!(path.is_err(), "{text:?} read as {path:?}");
        }
    }

    #[test]
    fn the_path_ends_at_the_first_equals_sign_outside_quotes() {
        for (text, end) in [
            ("a.b=c", Some(3)),
            (r#"a."=\"=".c=1"#, Some(10)),
            ("a.'=\\'=1", Some(6)),
            ("a.b", None),
            ("a.\"b=1", None),
        ] {
            assert_eq!(end_of_path(text), end, "{text}");
        }
    }
}

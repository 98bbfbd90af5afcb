//! The path of a parameter: `camera.eye`, `materials.ceramic.bump.height`,
//! `objects."my teapot".scale`.
//!
//! A path names one value of a scene's table, whether or not it is there yet.

use std::fmt;
use std::str::FromStr;

use toml::{Table, Value};

use super::keys::{Key, Rule, Section};
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
                return Err(self.error(format!(
                    "names all {}, not a parameter; write {}.NAME.KEY, with the name of a {noun}",
                    section.name(),
                    section.name()
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
                        message: "is no path: put quotes around names with other characters \
                                  than letters, digits, - and _"
                            .into(),
                    });
                }
            }
        }
    }
}

/// The first name of a path, and what follows it.
fn read_name(text: &str) -> Result<(String, &str), &'static str> {
    const UNCLOSED: &str = "is no path: a quote is not closed";
    if let Some(inside) = text.strip_prefix('\'') {
        let end = inside.find('\'').ok_or(UNCLOSED)?;
        return Ok((inside[..end].into(), &inside[end + 1..]));
    }
    if text.starts_with('"') {
        let end = closing_quote(text).ok_or(UNCLOSED)?;
        let value: Value =
            text[..end].parse().map_err(|_| "is no path: a quoted name is no TOML string")?;
        let name = value.as_str().ok_or("is no path: a quoted name is no TOML string")?;
        return Ok((name.into(), &text[end..]));
    }
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let end = text.find(|c| !is_bare(c)).unwrap_or(text.len());
    if end == 0 {
        return Err("is no path: a name is missing; write it as in camera.eye");
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

/// The name of an entry of a list, where it has one.
pub(super) fn entry_name(entry: &Value) -> Option<&str> {
    entry.get("name")?.as_str()
}

/// The place of one parameter in a scene's table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    section: Section,
    /// Which entry, where the section is a list.
    entry: Option<usize>,
    key: &'static Key,
    /// A key of the key's own table.
    inner: Option<&'static Key>,
}

impl Slot {
    /// What stands there.
    pub(super) fn get(self, root: &Table) -> Option<&Value> {
        let mut value = root.get(self.section.name())?;
        if let Some(entry) = self.entry {
            value = value.get(entry)?;
        }
        value = value.get(self.key.name)?;
        match self.inner {
            Some(inner) => value.get(inner.name),
            None => Some(value),
        }
    }

    /// Puts a value there. Where what should hold it is no table, nothing happens: that is an
    /// error of its own.
    pub(super) fn set(self, root: &mut Table, value: Value) {
        let empty = || Value::Table(Table::new());
        if self.entry.is_none() {
            root.entry(self.section.name()).or_insert_with(empty);
        }
        if let (Some(_), Some(table)) = (self.inner, self.outer_table(root)) {
            table.entry(self.key.name).or_insert_with(empty);
        }
        if let Some(table) = self.table(root) {
            table.insert(self.innermost().name.into(), value);
        }
    }

    /// Takes what stands there away.
    pub(super) fn remove(self, root: &mut Table) {
        if let Some(table) = self.table(root) {
            table.remove(self.innermost().name);
        }
    }

    /// The key of the value itself.
    pub(super) fn innermost(self) -> &'static Key {
        self.inner.unwrap_or(self.key)
    }

    /// The way to it from the root.
    pub(super) fn steps(self) -> Vec<Step> {
        let mut steps = vec![Step::key(self.section.name())];
        steps.extend(self.entry.map(Step::Index));
        steps.push(Step::key(self.key.name));
        steps.extend(self.inner.map(|inner| Step::key(inner.name)));
        steps
    }

    /// The table of the section or entry.
    fn outer_table(self, root: &mut Table) -> Option<&mut Table> {
        let section = root.get_mut(self.section.name())?;
        match self.entry {
            Some(entry) => section.get_mut(entry)?.as_table_mut(),
            None => section.as_table_mut(),
        }
    }

    /// The table that holds the value.
    fn table(self, root: &mut Table) -> Option<&mut Table> {
        let table = self.outer_table(root)?;
        match self.inner {
            Some(_) => table.get_mut(self.key.name)?.as_table_mut(),
            None => Some(table),
        }
    }
}

/// One step on the way from a scene's table to a value in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Into a table.
    Key(String),
    /// Into an array.
    Index(usize),
}

impl Step {
    pub(super) fn key(name: &str) -> Self {
        Self::Key(name.into())
    }
}

/// The parameter path of a way, for messages: entries by name, elements of arrays left out.
pub(super) fn path_text(root: &Table, steps: &[Step]) -> String {
    let mut names: Vec<String> = Vec::new();
    for (i, step) in steps.iter().enumerate() {
        match step {
            Step::Key(name) => names.push(cut(&key_text(name))),
            Step::Index(index) if i == 1 => {
                let entry = names.first().and_then(|list| root.get(list)?.get(index));
                match entry.and_then(entry_name) {
                    Some(name) => names.push(cut(&key_text(name))),
                    None => names.push(format!("(no. {})", index + 1)),
                }
            }
            Step::Index(_) => {}
        }
    }
    names.join(".")
}

/// The paths of all parameters of a scene, in the order of a file: those that have a value and
/// those that could have one.
pub(super) fn all_paths(root: &Table) -> Vec<ParameterPath> {
    let mut paths = Vec::new();
    for section in Section::ALL {
        let prefixes: Vec<Vec<&str>> = if section.entry_noun().is_none() {
            vec![vec![section.name()]]
        } else {
            let entries = root.get(section.name()).and_then(Value::as_array);
            let names = entries.into_iter().flatten().filter_map(entry_name);
            names.map(|name| vec![section.name(), name]).collect()
        };
        for prefix in prefixes {
            for key in section.keys() {
                let path = |last: &[&str]| {
                    ParameterPath::new(prefix.iter().chain(last).map(|name| String::from(*name)))
                };
                match key.rule {
                    Rule::Table(inner) => {
                        paths.extend(inner.iter().map(|inner| path(&[key.name, inner.name])));
                    }
                    _ => paths.push(path(&[key.name])),
                }
            }
        }
    }
    paths
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

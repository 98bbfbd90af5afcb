//! Places in a scene's table: what a parameter path leads to, and the steps on the way.

use toml::{Table, Value};

use super::keys::{Key, Section};
use super::words::{cut, key_text};

/// The name of an entry of a list, where it has one.
pub(super) fn entry_name(entry: &Value) -> Option<&str> {
    entry.get("name")?.as_str()
}

/// The place of one parameter in a scene's table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) section: Section,
    /// Which entry, where the section is a list.
    pub(super) entry: Option<usize>,
    pub(super) key: &'static Key,
    /// A key of the key's own table.
    pub(super) inner: Option<&'static Key>,
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

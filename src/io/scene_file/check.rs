//! Whether the values of a scene's table are what their keys want: types and ranges, one by one.

use std::collections::BTreeMap;

use toml::{Table, Value};

use super::keys::{Key, Presence, Rule, Section};
use super::range::{Outside, Range};
use super::slot::{Step, entry_name};
use super::words::{key_text, nearest, quoted, shown, shown_name, suggestion};

/// A mistake in a scene, and the way to it.
#[derive(Debug, PartialEq)]
pub(super) struct Fault {
    /// From the root to the value.
    pub(super) steps: Vec<Step>,
    /// Whether the key is at fault, not its value.
    pub(super) is_key: bool,
    /// The way to another value that may have been changed to cause it.
    pub(super) cause: Option<Vec<Step>>,
    /// What is wrong, and what would be right.
    pub(super) message: String,
}

impl Fault {
    pub(super) fn new(steps: Vec<Step>, message: String) -> Self {
        Self { steps, is_key: false, cause: None, message }
    }
}

/// Sections are tables and lists arrays of tables, and there are no others.
pub(super) fn check_shape(root: &Table) -> Result<(), Fault> {
    for (name, value) in root {
        let steps = vec![Step::key(name)];
        let Some(section) = Section::named(name) else {
            let hint = suggestion(name, Section::ALL.map(Section::name), key_text);
            let message = format!("there is no section {}{hint}", shown_name(name));
            return Err(Fault { is_key: true, ..Fault::new(steps, message) });
        };
        let Some(noun) = section.entry_noun() else {
            if !value.is_table() {
                let message = format!("this is a section; write it as [{name}]");
                return Err(Fault { is_key: true, ..Fault::new(steps, message) });
            }
            continue;
        };
        let is_list = value.as_array().is_some_and(|entries| entries.iter().all(Value::is_table));
        if !is_list {
            let message = format!("this is a list; write each {noun} as [[{name}]]");
            return Err(Fault { is_key: true, ..Fault::new(steps, message) });
        }
    }
    Ok(())
}

/// Gives the unnamed lights and objects of a well-shaped table their names: "light-1", …,
/// counted among the unnamed.
pub(super) fn name_the_unnamed(root: &mut Table) {
    for section in [Section::Lights, Section::Objects] {
        let (Some(noun), Some(entries)) =
            (section.entry_noun(), root.get_mut(section.name()).and_then(Value::as_array_mut))
        else {
            continue;
        };
        let unnamed = entries
            .iter_mut()
            .filter_map(Value::as_table_mut)
            .filter(|entry| !entry.contains_key("name"));
        for (i, entry) in unnamed.enumerate() {
            entry.insert("name".into(), Value::String(format!("{noun}-{}", i + 1)));
        }
    }
}

/// Every key is known, every required one there, every value of its type and in its range.
pub(super) fn check_values(root: &Table) -> Result<(), Fault> {
    check_shape(root)?;
    for section in Section::ALL {
        let steps = vec![Step::key(section.name())];
        match root.get(section.name()) {
            Some(Value::Table(table)) => check_table(section.keys(), table, &steps)?,
            Some(Value::Array(entries)) => {
                for (i, entry) in entries.iter().enumerate() {
                    let steps = [&steps[..], &[Step::Index(i)]].concat();
                    if let Value::Table(table) = entry {
                        check_table(section.keys(), table, &steps)?;
                    }
                }
                check_names(section, entries)?;
            }
            _ => {
                let required = section.keys().iter().find(|k| k.presence == Presence::Required);
                if let (Some(key), None) = (required, section.entry_noun()) {
                    return Err(missing(key, &steps));
                }
            }
        }
    }
    Ok(())
}

fn check_table(keys: &'static [Key], table: &Table, steps: &[Step]) -> Result<(), Fault> {
    let way_to = |name: &str| [steps, &[Step::key(name)]].concat();
    for name in table.keys() {
        if !keys.iter().any(|key| key.name == name) {
            let hint = suggestion(name, keys.iter().map(|key| key.name), key_text);
            let message = format!("there is no such key{hint}");
            return Err(Fault { is_key: true, ..Fault::new(way_to(name), message) });
        }
    }
    for key in keys {
        match (table.get(key.name), key.presence) {
            (Some(Value::Table(inner)), _) if let Rule::Table(keys) = key.rule => {
                check_table(keys, inner, &way_to(key.name))?;
            }
            (Some(value), _) => check_value(key, value, way_to(key.name))?,
            (None, Presence::Required) => return Err(missing(key, steps)),
            (None, Presence::Written | Presence::Optional) => {}
        }
    }
    Ok(())
}

/// The fault of a key that is not there.
pub(super) fn missing(key: &Key, steps: &[Step]) -> Fault {
    let steps = [steps, &[Step::key(key.name)]].concat();
    Fault::new(steps, format!("this key is required; give {}", key.rule.remedy()))
}

fn check_names(section: Section, entries: &[Value]) -> Result<(), Fault> {
    let mut first_of_name = BTreeMap::new();
    for (i, name) in entries.iter().enumerate().filter_map(|(i, e)| Some((i, entry_name(e)?))) {
        if let Some(first) = first_of_name.insert(name, i) {
            let way_to = |i| vec![Step::key(section.name()), Step::Index(i), Step::key("name")];
            let noun = section.entry_noun().unwrap_or_default();
            let counted =
                if name == format!("{noun}-{}", first + 1) || name == format!("{noun}-{}", i + 1) {
                    format!(" (the unnamed are {noun}-1, {noun}-2 and so on)")
                } else {
                    String::new()
                };
            let message = format!(
                "{} names two {}{counted}; give each its own name",
                shown_name(name),
                section.name()
            );
            return Err(Fault { cause: Some(way_to(first)), ..Fault::new(way_to(i), message) });
        }
    }
    Ok(())
}

fn check_value(key: &Key, value: &Value, mut steps: Vec<Step>) -> Result<(), Fault> {
    let Err(wrong) = judge(key.rule, value) else {
        return Ok(());
    };
    let found = shown(value);
    let message = match wrong.why {
        Outside::Meaning => format!("{found} is not {}; {}", key.noun, remedy(key.rule, value)),
        Outside::NotFinite => format!("{found} is not finite; give {}", key.rule.remedy()),
        Outside::TooLarge(limit) => {
            format!("{found} is too large to compute with; stay within {}", round(limit))
        }
        Outside::TooSmall(limit) => {
            format!("{found} is too close to 0 to compute with; keep {} away", round(limit))
        }
    };
    steps.extend(wrong.elements.into_iter().map(Step::Index));
    Err(Fault::new(steps, message))
}

/// What would be right in place of a value: the word that was meant, or what to give.
fn remedy(rule: Rule, value: &Value) -> String {
    if let (Rule::Word(words), Some(found)) = (rule, value.as_str())
        && let Some(meant) = nearest(found, words.iter().copied())
    {
        return format!("did you mean {}?", quoted(meant));
    }
    format!("give {}", rule.remedy())
}

/// A limit as one would say it: 100, 1e12.
fn round(limit: f64) -> String {
    if (1e-3..1e6).contains(&limit) { format!("{limit}") } else { format!("{limit:e}") }
}

/// What is wrong with a value, and in which element of its arrays.
struct Wrong {
    why: Outside,
    elements: Vec<usize>,
}

const NOT_MEANT: Wrong = Wrong { why: Outside::Meaning, elements: Vec::new() };

fn judge(rule: Rule, value: &Value) -> Result<(), Wrong> {
    match rule {
        Rule::Number(range) => number(range, value),
        Rule::Whole(least, most) => holds(whole(value, least, most)),
        Rule::Blades => holds(whole(value, 0, 0) || whole(value, 3, 16)),
        Rule::Flag => holds(value.is_bool()),
        Rule::Word(words) => holds(value.as_str().is_some_and(|word| words.contains(&word))),
        Rule::Text => holds(value.is_str()),
        Rule::File => holds(value.as_str().is_some_and(|path| !path.is_empty())),
        Rule::Triple(range) => numbers(range, value, &[3]),
        Rule::Direction => direction(value),
        Rule::ColorOrTexture(_) if value.is_str() => Ok(()),
        Rule::ColorOrTexture(range) => numbers(range, value, &[3]),
        Rule::Colors => colors(value),
        Rule::OneOrTwo(range) if value.is_array() => numbers(range, value, &[1, 2]),
        Rule::OneOrThree(range) if value.is_array() => numbers(range, value, &[3]),
        Rule::OneOrTwo(range) | Rule::OneOrThree(range) => number(range, value),
        // A table is checked key by key; here something else stands in its place.
        Rule::Table(_) => Err(NOT_MEANT),
    }
}

fn holds(condition: bool) -> Result<(), Wrong> {
    if condition { Ok(()) } else { Err(NOT_MEANT) }
}

fn whole(value: &Value, least: u32, most: u32) -> bool {
    value.as_integer().is_some_and(|n| (i64::from(least)..=i64::from(most)).contains(&n))
}

fn number(range: Range, value: &Value) -> Result<(), Wrong> {
    let number = match value {
        Value::Float(float) => *float,
        Value::Integer(integer) => *integer as f64,
        _ => return Err(NOT_MEANT),
    };
    range.judge(number).map_err(|why| Wrong { why, elements: Vec::new() })
}

fn numbers(range: Range, value: &Value, lengths: &[usize]) -> Result<(), Wrong> {
    let array = value.as_array().filter(|array| lengths.contains(&array.len())).ok_or(NOT_MEANT)?;
    for (i, element) in array.iter().enumerate() {
        number(range, element).map_err(|wrong| inside(i, wrong))?;
    }
    Ok(())
}

fn direction(value: &Value) -> Result<(), Wrong> {
    numbers(Range::ANY, value, &[3])?;
    let elements = value.as_array().map_or(&[][..], |array| array);
    let is_zero = elements.iter().all(|element| number(Range::NOT_0, element).is_err());
    holds(!is_zero)
}

fn colors(value: &Value) -> Result<(), Wrong> {
    let array = value.as_array().ok_or(NOT_MEANT)?;
    for (i, color) in array.iter().enumerate() {
        numbers(Range::LIGHT, color, &[3]).map_err(|wrong| inside(i, wrong))?;
    }
    Ok(())
}

fn inside(element: usize, mut wrong: Wrong) -> Wrong {
    wrong.elements.insert(0, element);
    wrong
}

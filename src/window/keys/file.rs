//! Keys of one's own: a file that gives actions other keys.
//!
//! One line for an action, `pause = "P"` or `help = ["H", "F1"]`; `[]` takes its keys away. What
//! the file does not name keeps its key. A line that is wrong is left out and told.

use super::number_pad::pad_key;
use super::{Action, BINDINGS, Binding, Keys, keys_of};
use crate::io::files::read_file;
use crate::io::scene_file::suggestion;
use egui::{Key, Modifiers};
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Its name in the program's own folder.
pub(in crate::window) const NAME: &str = "keys.toml";
/// A longer file is no file of keys.
const LARGEST: u64 = 64 << 10;

/// The keys that the file at `path` gives, with what is wrong in it. Without a file, the usual
/// ones.
pub(in crate::window) fn load(path: &Path) -> (Keys, Vec<String>) {
    if !path.exists() {
        return (Keys::default(), Vec::new());
    }
    let text = read_file(path, LARGEST).map_err(|error| error.reason().to_owned());
    let text = text.and_then(|bytes| {
        String::from_utf8(bytes).map_err(|_| "is not UTF-8; save it as plain text".to_owned())
    });
    match text {
        Ok(text) => read(&text),
        Err(reason) => (Keys::default(), vec![reason]),
    }
}

/// A file that changes nothing: every action with its usual keys, as comments.
pub(in crate::window) fn template() -> String {
    let mut text = String::from(
        "# Keys of Penumbra. Take the # away from a line and give another key, or a list of keys;\n\
         # [] takes the key away. Modifiers: Ctrl (Cmd on macOS), Shift, Alt. Read at the start.\n\n",
    );
    let mut told: Vec<Action> = Vec::new();
    for binding in BINDINGS {
        if told.contains(&binding.action) {
            continue;
        }
        told.push(binding.action);
        let same = BINDINGS.iter().filter(|other| other.action == binding.action);
        let keys: Vec<String> = same.map(|same| format!("{:?}", keys_of(same))).collect();
        let keys = if keys.len() == 1 { keys[0].clone() } else { format!("[{}]", keys.join(", ")) };
        let line = format!("# {} = {keys}", binding.action.name());
        text += &format!("{line:40} # {}\n", binding.does);
    }
    text
}

/// A binding that the file gives, and its line.
struct Own {
    line: usize,
    binding: Binding,
}

fn read(text: &str) -> (Keys, Vec<String>) {
    let mut complaints = Vec::new();
    let table = match DeTable::parse(text) {
        Ok(table) => table.into_inner(),
        Err(error) => {
            let start = error.span().map_or(text.len(), |span| span.start);
            let line = line_of(text, start);
            return (Keys::default(), vec![format!("line {line}: {}", error.message())]);
        }
    };
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(name, _)| name.span().start);
    let (mut own, mut rebound) = (Vec::new(), Vec::new());
    for (name, value) in entries {
        let line = line_of(text, name.span().start);
        match entry(name.get_ref(), value) {
            Ok(Entry { action, bindings, faults }) => {
                complaints.extend(faults.iter().map(|fault| format!("line {line}: {fault}")));
                // A line of which nothing can be read leaves the usual key.
                if !bindings.is_empty() || faults.is_empty() {
                    rebound.push(action);
                }
                for binding in bindings {
                    take(&mut own, Own { line, binding }, &mut complaints);
                }
            }
            Err(fault) => complaints.push(format!("line {line}: {fault}")),
        }
    }
    (merged(&own, &rebound, &mut complaints), complaints)
}

/// The first line that asks for a key gets it.
fn take(own: &mut Vec<Own>, new: Own, complaints: &mut Vec<String>) {
    let keys = keys_of(&new.binding);
    match own.iter().find(|other| keys_of(&other.binding) == keys) {
        None => own.push(new),
        Some(first) => complaints.push(format!(
            "line {}: {keys} is {} already (line {}); give {} another key",
            new.line,
            first.binding.action.name(),
            first.line,
            new.binding.action.name()
        )),
    }
}

/// The file's keys, and the usual ones of all actions that it does not name. Of two that want the
/// same key the file's has it.
fn merged(own: &[Own], rebound: &[Action], complaints: &mut Vec<String>) -> Keys {
    let mut bindings: Vec<Binding> = own.iter().map(|own| own.binding).collect();
    for usual in BINDINGS.iter().filter(|usual| !rebound.contains(&usual.action)) {
        match own.iter().find(|own| keys_of(&own.binding) == keys_of(usual)) {
            None => bindings.push(*usual),
            Some(taker) => complaints.push(format!(
                "line {}: {} was {} before and is {} now; give {} another key, or [] for none",
                taker.line,
                keys_of(usual),
                usual.action.name(),
                taker.binding.action.name(),
                usual.action.name()
            )),
        }
    }
    let place = |action| BINDINGS.iter().position(|usual| usual.action == action);
    bindings.sort_by_key(|binding| place(binding.action));
    Keys { bindings }
}

/// One line of the file.
struct Entry {
    action: Action,
    bindings: Vec<Binding>,
    faults: Vec<String>,
}

fn entry(name: &str, value: &Spanned<DeValue<'_>>) -> Result<Entry, String> {
    let Some(usual) = BINDINGS.iter().find(|usual| usual.action.name() == name) else {
        let mut names: Vec<String> = BINDINGS.iter().map(|usual| usual.action.name()).collect();
        names.dedup();
        let hint = suggestion(name, names.iter().map(String::as_str), str::to_owned);
        return Err(format!("there is no action {name:?}{hint}"));
    };
    let give = "give a key such as \"Ctrl+P\", a list of keys, or [] for none";
    let texts: Vec<&str> = match value.get_ref() {
        DeValue::String(text) => vec![text],
        DeValue::Array(list) => list
            .iter()
            .map(|item| match item.get_ref() {
                DeValue::String(text) => Ok(text.as_ref()),
                _ => Err(format!("{name} has something in its list that is no key; {give}")),
            })
            .collect::<Result<_, String>>()?,
        _ => return Err(format!("{name} is given no key; {give}")),
    };
    let (mut bindings, mut faults) = (Vec::new(), Vec::new());
    for text in texts {
        match key_of(text) {
            Ok((modifiers, key)) => bindings.push(Binding { modifiers, key, ..*usual }),
            Err(fault) => faults.push(fault),
        }
    }
    Ok(Entry { action: usual.action, bindings, faults })
}

/// Reads "Ctrl+Shift+S".
fn key_of(text: &str) -> Result<(Modifiers, Key), String> {
    let mut modifiers = Modifiers::NONE;
    let mut parts: Vec<&str> = text.split('+').map(str::trim).collect();
    let last = parts.pop().unwrap_or_default();
    for part in parts {
        match part.to_ascii_lowercase().as_str() {
            "ctrl" | "cmd" => modifiers.command = true,
            "shift" => modifiers.shift = true,
            "alt" => modifiers.alt = true,
            _ => return Err(format!("{text:?}: {part:?} is none of Ctrl, Shift and Alt")),
        }
    }
    let key = pad_key(last)
        .or_else(|| Key::from_name(last))
        .or_else(|| Key::from_name(&last.to_ascii_uppercase()));
    match key {
        Some(key) => Ok((modifiers, key)),
        None => Err(format!(
            "{text:?}: there is no key {last:?}; give A to Z, 0 to 9, Numpad 0 to Numpad 9, F1 to \
             F25, Space, Home, Plus or another by its name"
        )),
    }
}

fn line_of(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|byte| *byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_action_gets_the_keys_of_the_file_and_loses_its_own() {
        let (keys, complaints) = read("pause = \"P\"\nhelp = [\"Ctrl+Shift+H\"]\nrestart = []\n");
        assert!(complaints.is_empty(), "{complaints:?}");
        for (action, shown) in [
            (Action::Pause, "P"),
            (Action::Help, "Ctrl+Shift+H"),
            (Action::Restart, ""),
            (Action::FrameAll, "Home"),
        ] {
            assert_eq!(keys.shown(action), shown, "{action:?}");
        }
        let n_help = keys.bindings.iter().filter(|one| one.action == Action::Help).count();
        assert_eq!(n_help, 1, "help keeps a key that the file took away");
    }

    #[test]
    fn the_template_names_every_action_and_changes_nothing() {
        let (keys, complaints) = read(&template());
        assert!(complaints.is_empty(), "{complaints:?}");
        assert_eq!(keys.bindings.len(), BINDINGS.len(), "a comment rebinds");
        let uncommented: String =
            template().lines().skip(3).map(|line| format!("{}\n", &line[2..])).collect();
        let (keys, complaints) = read(&uncommented);
        assert!(complaints.is_empty(), "{complaints:?}");
        let all = |keys: &Keys| keys.bindings.iter().map(keys_of).collect::<Vec<_>>();
        assert_eq!(all(&keys), all(&Keys::default()), "the template differs from the table");
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line_and_a_remedy() {
        for (text, says) in [
            ("puase = \"P\"", "line 1: there is no action \"puase\"; did you mean pause?"),
            (
                "\npause = \"Hyper+P\"",
                "line 2: \"Hyper+P\": \"Hyper\" is none of Ctrl, Shift and Alt",
            ),
            ("pause = \"Banana\"", "there is no key \"Banana\""),
            ("pause = 7", "line 1: pause is given no key; give a key"),
            (
                "pause = \"P\"\nhelp = \"p\"",
                "line 2: P is pause already (line 1); give help another",
            ),
            (
                "pause = \"R\"",
                "line 1: R was restart before and is pause now; give restart another",
            ),
            ("pause = \"P", "line 1: "),
        ] {
            let (keys, complaints) = read(text);
            assert!(complaints.iter().any(|line| line.contains(says)), "{text}: {complaints:?}");
            let shown = keys.shown(Action::Save);
            assert_eq!(shown, keys_of_default(Action::Save), "{text} changes another key");
        }
        let (_, complaints) = read("nonsense = \"K\"");
        assert!(
            complaints.concat().contains("undo, redo, compare"),
            "not once each: {complaints:?}"
        );
        let (keys, _) = read("pause = \"Banana\"");
        assert_eq!(
            keys.shown(Action::Pause),
            "Space",
            "an unreadable key takes the usual one away"
        );
    }

    fn keys_of_default(action: Action) -> String {
        Keys::default().shown(action)
    }
}

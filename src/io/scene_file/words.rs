//! Values and names as messages and files show them.

use toml::Value;

/// As many characters of a value as a message shows.
const SHOWN: usize = 60;

/// A TOML basic string that stands for this text on one line, whatever is in it: characters that
/// move a terminal's cursor, colour it or turn the writing direction are escaped.
pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::with_capacity(text.len() + 2);
    quoted.push('"');
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            '\r' => quoted.push_str("\\r"),
            c if is_unprintable(c) => quoted.push_str(&format!("\\U{:08X}", u32::from(c))),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// A name as a TOML key: bare where it can be, else quoted.
pub(super) fn key_text(name: &str) -> String {
    let is_bare = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
    if !name.is_empty() && name.bytes().all(is_bare) { name.into() } else { quoted(name) }
}

/// A value in TOML, on one line. Numbers read back to the last bit.
pub(super) fn value_text(value: &Value) -> String {
    match value {
        Value::String(text) => quoted(text),
        Value::Integer(integer) => integer.to_string(),
        Value::Float(float) if float.is_nan() => "nan".into(),
        Value::Float(float) => format!("{float:?}"),
        Value::Boolean(flag) => flag.to_string(),
        Value::Datetime(datetime) => datetime.to_string(),
        Value::Array(array) => {
            format!("[{}]", array.iter().map(value_text).collect::<Vec<_>>().join(", "))
        }
        Value::Table(table) if table.is_empty() => "{}".into(),
        Value::Table(table) => {
            let entry = |(key, value): (&String, &Value)| {
                format!("{} = {}", key_text(key), value_text(value))
            };
            format!("{{ {} }}", table.iter().map(entry).collect::<Vec<_>>().join(", "))
        }
    }
}

/// A value as a message shows it: cut where it is long.
pub(super) fn shown(value: &Value) -> String {
    cut(&value_text(value))
}

/// A name as a message shows it: quoted, and cut where it is long.
pub(super) fn shown_name(name: &str) -> String {
    cut(&quoted(name))
}

/// At most [`SHOWN`] characters of a text, with a sign where something is missing.
pub(super) fn cut(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}

/// A text of someone else's, such as a parser's message, made safe to print.
pub(super) fn printable(text: &str) -> String {
    text.chars()
        .flat_map(|c| if is_unprintable(c) { c.escape_unicode().collect() } else { vec![c] })
        .collect()
}

/// The candidate that was probably meant by a misspelt word.
pub(super) fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    const LONGEST: usize = 64;
    let letters: Vec<char> = word.to_lowercase().chars().take(LONGEST + 1).collect();
    if letters.len() > LONGEST {
        return None;
    }
    let reach = (letters.len() / 3).max(1);
    let mut best: Option<(usize, &str)> = None;
    let mut holding = None;
    for candidate in candidates {
        let other: Vec<char> = candidate.to_lowercase().chars().take(LONGEST + 1).collect();
        if LONGEST < other.len() {
            continue;
        }
        if 3 <= letters.len() && holding.is_none() && contains(&other, &letters) {
            holding = Some(candidate);
        }
        if reach < other.len().abs_diff(letters.len()) {
            continue;
        }
        let distance = edits(&letters, &other);
        if distance <= reach && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate).or(holding)
}

/// "; did you mean …?", or what to choose from where nothing is near, or nothing where there is
/// no choice.
pub(crate) fn suggestion<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str> + Clone,
    show: impl Fn(&str) -> String,
) -> String {
    /// More than this many candidates are not listed in full.
    const LISTED: usize = 24;
    if let Some(meant) = nearest(word, candidates.clone()) {
        return format!("; did you mean {}?", cut(&show(meant)));
    }
    let listed: Vec<_> =
        candidates.clone().into_iter().take(LISTED).map(|c| cut(&show(c))).collect();
    if listed.is_empty() {
        return String::new();
    }
    let more = if candidates.into_iter().nth(LISTED).is_some() { ", …" } else { "" };
    format!("; known: {}{more}", listed.join(", "))
}

fn contains(text: &[char], part: &[char]) -> bool {
    text.windows(part.len()).any(|window| window == part)
}

/// Letters to insert, delete or replace, or neighbours to swap (optimal string alignment).
fn edits(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = vec![0; b.len() + 1];
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if 1 < i && 1 < j && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

/// Control characters, and those that are invisible or turn the direction of writing.
fn is_unprintable(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_text_reads_back_and_has_no_control_characters() {
        for text in
            ["", "a b", "\u{1b}[31mred", "\"\\\n\r\t\0\u{7f}\u{85}", "\u{202e}turned", "é\u{e0041}"]
        {
            let quoted = quoted(text);
            let back: Value = quoted.parse().unwrap();
            assert_eq!(back.as_str(), Some(text), "{quoted}");
            assert!(!quoted.chars().any(is_unprintable), "{quoted:?}");
        }
    }

    #[test]
    fn nearest_finds_slips_and_parts_but_not_strangers() {
        let keys = ["alpha_x", "alpha_y", "vertical_fov", "size", "colors", "center"];
        for (word, meant) in [
            ("alphax", Some("alpha_x")),
            ("Alpha_Y", Some("alpha_y")),
            ("fov", Some("vertical_fov")),
            ("colours", Some("colors")),
            ("centre", Some("center")),
            ("siez", Some("size")),
            ("sized", Some("size")),
            ("roughness", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, keys), meant, "{word}");
        }
    }

    #[test]
    fn long_values_are_cut() {
        let long = Value::String("x".repeat(1000));
        assert_eq!(shown(&long).chars().count(), SHOWN + 1, "{}", shown(&long));
    }
}

//! Pieces of foreign text in messages: escaped, so that no file can send a control sequence to a
//! terminal, and shortened.

use std::path::Path;

/// Characters of a file's text that a message repeats at most.
const MAX_CHARS: usize = 48;

/// The start of `bytes`, safe to print on one line: control and other unprintable characters and
/// bytes that are not UTF-8 are written as escapes, and what is left out as `…`.
pub fn excerpt(bytes: &[u8]) -> String {
    // A character takes at most four bytes: the rest cannot be shown anyway.
    let head = &bytes[..bytes.len().min(4 * (MAX_CHARS + 1))];
    let mut text = String::new();
    let mut n_shown = 0;
    for chunk in head.utf8_chunks() {
        for c in chunk.valid().chars() {
            if n_shown == MAX_CHARS {
                return text + "…";
            }
            push_escaped(&mut text, c);
            n_shown += 1;
        }
        for byte in chunk.invalid() {
            if n_shown == MAX_CHARS {
                return text + "…";
            }
            text += &format!("\\x{byte:02x}");
            n_shown += 1;
        }
    }
    if head.len() < bytes.len() { text + "…" } else { text }
}

/// A path, safe to print on one line: see [`printable_ends`].
pub fn printable_path(path: &Path) -> String {
    printable_ends(&path.to_string_lossy())
}

/// A text, safe to print on one line: what cannot be printed is escaped, and of one too long to be
/// read both ends are shown.
pub fn printable_ends(text: &str) -> String {
    const END_CHARS: usize = 200;
    let n_chars = text.chars().count();
    if n_chars <= 2 * END_CHARS {
        return printable(text);
    }
    let head: String = text.chars().take(END_CHARS).collect();
    let tail: String = text.chars().skip(n_chars - END_CHARS).collect();
    printable(&head) + "…" + &printable(&tail)
}

/// A text, safe to print on one line and whole: what cannot be printed is escaped.
pub fn printable(foreign: &str) -> String {
    let mut text = String::new();
    for c in foreign.chars() {
        push_escaped(&mut text, c);
    }
    text
}

fn push_escaped(text: &mut String, c: char) {
    // Quotes and backslashes print as they are: they are harmless, and paths are full of them.
    if matches!(c, '\'' | '"' | '\\') {
        text.push(c);
    } else {
        text.extend(c.escape_debug());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terminal_escapes_and_direction_marks_are_never_echoed() {
        let text = excerpt("a\u{1b}[31m\u{202e}\u{9b}b\r\n".as_bytes());
        assert_eq!(text, "a\\u{1b}[31m\\u{202e}\\u{9b}b\\r\\n");
    }

    #[test]
    fn bytes_that_are_not_utf8_are_written_in_hexadecimal() {
        assert_eq!(excerpt(b"\xff\x00A\xc3"), "\\xff\\0A\\xc3");
    }

    #[test]
    fn long_text_is_cut_and_marked() {
        assert_eq!(excerpt(&[b'x'; 48]), "x".repeat(48));
        assert_eq!(excerpt(&[b'x'; 49]), "x".repeat(48) + "…");
        assert_eq!(excerpt(&[b'x'; 100_000]), "x".repeat(48) + "…");
        assert_eq!(excerpt("ä".repeat(48).as_bytes()), "ä".repeat(48));
    }

    #[test]
    fn paths_keep_their_backslashes() {
        assert_eq!(excerpt(b"C:\\models\\a.obj"), "C:\\models\\a.obj");
        let path = "C:\\a b\u{1b}[0m\\".repeat(20);
        let expected = "C:\\a b\\u{1b}[0m\\".repeat(20);
        assert_eq!(printable_path(Path::new(&path)), expected);
        let long = format!("a{}b", "x".repeat(100 << 10));
        let shown = printable_path(Path::new(&long));
        assert!(shown.starts_with("axx") && shown.ends_with("xxb"), "both ends");
        assert_eq!(shown.chars().count(), 401, "no more");
    }
}

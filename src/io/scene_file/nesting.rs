//! A look at TOML text before it is parsed: is it nested deeper than a scene can be?
//!
//! The parser builds a tree by recursion, and dotted keys inside inline tables let a few
//! kilobytes nest thousands of tables. A scene needs five levels at most.

/// As many brackets may be open at once.
const DEEPEST: usize = 16;

/// As many dots may stand in one key.
const LONGEST_KEY: usize = 8;

/// The byte where a text becomes nested too deeply, if it does. Strings and comments do not
/// count. Says nothing about whether the text is TOML.
pub(super) fn too_deep(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let mut open = 0_usize;
    let mut dots = 0;
    let mut i = 0;
    while i < bytes.len() {
        let start = i;
        match bytes[i] {
            b'"' | b'\'' => {
                i = end_of_string(bytes, i);
                continue;
            }
            b'#' => {
                i += bytes[i..].iter().position(|&b| b == b'\n').unwrap_or(bytes.len() - i);
                continue;
            }
            b'.' => dots += 1,
            b'[' | b'{' => {
                open += 1;
                dots = 0;
            }
            b']' | b'}' => {
                open = open.saturating_sub(1);
                dots = 0;
            }
            b'=' | b',' | b'\n' => dots = 0,
            _ => {}
        }
        if DEEPEST < open || LONGEST_KEY < dots {
            return Some(start);
        }
        i += 1;
    }
    None
}

/// The offset behind a string that starts at `start`; of one that is not closed, the offset of
/// the end of its line.
fn end_of_string(bytes: &[u8], start: usize) -> usize {
    let quote = bytes[start];
    let is_multi_line = bytes[start..].starts_with(&[quote; 3]);
    let mut i = start + if is_multi_line { 3 } else { 1 };
    while i < bytes.len() {
        match bytes[i] {
            b'\\' if quote == b'"' && bytes.get(i + 1) != Some(&b'\n') => i += 1,
            b'\n' if !is_multi_line => return i,
            b if b == quote && !is_multi_line => return i + 1,
            b if b == quote && bytes[i..].starts_with(&[quote; 3]) => {
                // Up to two quotes of the content may stand before the three that close it.
                let more = bytes[i + 3..].iter().take(2).take_while(|&&b| b == quote).count();
                return i + 3 + more;
            }
            _ => {}
        }
        i += 1;
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_pass_and_towers_do_not() {
        let dotted = vec!["a"; 20].join(".");
        for (text, at) in [
            ("[camera]\neye = [0.1, 0.2, 0.3]\n[[a.b.c]]\nx = [[1.0, 2.0], [3.0]]".into(), None),
            (
                "file = \"../../../../../../../../../../../a.obj\" # a.b.c.d.e.f.g.h.i.j.k".into(),
                None,
            ),
            ("x = '''\n[[[[[[[[[[[[[[[[[[[['\n'''\ny = 1".into(), None),
            ("x = \"\\\"[[[[[[[[[[[[[[[[[[[[\"".into(), None),
            ("x = \"\"\"\"[[[[[[[[[[[[[[[[[[[[\"\"\"\"\"".into(), None),
            (format!("{dotted} = 1"), Some(17)),
            (format!("[{dotted}]"), Some(18)),
            (format!("x = {}", "[".repeat(20)), Some(20)),
            (format!("x = \"\"\"\"\"\", {}", "{".repeat(20)), Some(28)),
            (format!("x = \"open\n{dotted} = 1"), Some(27)),
            (format!("x = \"\"\"a\"\"\"\"\" {dotted}"), Some(31)),
            (String::new(), None),
            ("\"\"\"".into(), None),
            ("\"\\".into(), None),
        ] {
            let text: String = text;
            assert_eq!(too_deep(&text), at, "{text}");
        }
    }
}

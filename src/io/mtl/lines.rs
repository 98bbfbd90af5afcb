//! The lines of a material library that matter, written plainly.

use crate::io::excerpt;

/// The library with nothing but what is used: names, colours of three finite numbers, numbers,
/// and files of pictures without options, in one spelling; and what was odd about the rest.
pub(super) fn plain(text: &str) -> (String, Vec<String>) {
    let mut plain = String::new();
    let mut warnings = Vec::new();
    let mut is_named = false;
    for (line, text) in joined_lines(text) {
        let (keyword, rest) = split_word(&text);
        if keyword == "newmtl" {
            is_named = !rest.is_empty();
        }
        let written = match canonical(keyword) {
            Some("newmtl") if is_named => Ok(rest.to_owned()),
            Some("newmtl") => Err("no name".to_owned()),
            Some(_) if !is_named => Err("no material before it".to_owned()),
            Some("Kd" | "Ks" | "Ke") => color(rest),
            Some("map_Kd") => picture(rest, line, &mut warnings),
            Some(_) => number(rest.strip_prefix("-halo").unwrap_or(rest).trim_start()),
            None => continue,
        };
        match written {
            Ok(value) => plain += &format!("{} {value}\n", canonical(keyword).unwrap_or(keyword)),
            Err(problem) => {
                let keyword = excerpt(keyword.as_bytes());
                warnings.push(format!("line {line}: `{keyword}`: {problem}"));
            }
        }
    }
    (plain, warnings)
}

/// The keyword as the format spells it, if it is used here. Exporters are careless with case.
fn canonical(keyword: &str) -> Option<&'static str> {
    const USED: [&str; 9] = ["newmtl", "Kd", "Ks", "Ke", "Ns", "Ni", "d", "Tr", "map_Kd"];
    USED.into_iter().find(|used| used.eq_ignore_ascii_case(keyword))
}

/// Lines with their numbers from 1, without comments and blanks around them; one that ends with a
/// backslash goes on in the next.
fn joined_lines(text: &str) -> impl Iterator<Item = (usize, String)> {
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
    let mut lines = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (i, part) in text.split('\n').enumerate() {
        let (number, mut line) = open.take().unwrap_or((i + 1, String::new()));
        if let Some(part) = part.strip_suffix('\\') {
            line += part;
            line.push(' ');
            open = Some((number, line));
            continue;
        }
        line += part;
        lines.push((number, line));
    }
    lines.extend(open);
    lines.into_iter().filter_map(|(number, line)| {
        let line = line.trim();
        (!line.is_empty() && !line.starts_with('#')).then(|| (number, line.to_owned()))
    })
}

/// The first word, and the rest without blanks around it.
fn split_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim())
}

/// `r g b`, or one number for all three.
fn color(text: &str) -> Result<String, String> {
    let words: Vec<&str> = text.split_whitespace().take_while(|w| !w.starts_with('#')).collect();
    match words[..] {
        [grey] => {
            let grey = number(grey)?;
            Ok(format!("{grey} {grey} {grey}"))
        }
        [r, g, b] => Ok(format!("{} {} {}", number(r)?, number(g)?, number(b)?)),
        _ => {
            let found = excerpt(text.as_bytes());
            Err(format!("`{found}` is not a colour of three numbers; it is passed over"))
        }
    }
}

fn number(text: &str) -> Result<String, String> {
    let (word, _) = split_word(text);
    match word.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value.to_string()),
        Ok(_) | Err(_) => {
            let found = excerpt(word.as_bytes());
            Err(format!("`{found}` is not a finite number; it is passed over"))
        }
    }
}

/// The file after the options.
fn picture(text: &str, line: usize, warnings: &mut Vec<String>) -> Result<String, String> {
    let mut rest = text;
    while let (option, after) = split_word(rest)
        && let Some(max_arguments) = arguments_of(option)
    {
        rest = after;
        let mut n_arguments = 0;
        let mut has_effect = false;
        while n_arguments < max_arguments {
            let (argument, after) = split_word(rest);
            // A vector may be short: it ends where no number comes.
            let is_number = argument.parse::<f32>().is_ok();
            if after.is_empty() || (max_arguments == 3 && !is_number) {
                break;
            }
            has_effect |= argument.parse() != Ok(if option == "-s" { 1.0 } else { 0.0 });
            rest = after;
            n_arguments += 1;
        }
        if max_arguments == 3 && has_effect {
            warnings.push(format!("line {line}: `{option}` is not supported; it is passed over"));
        }
    }
    let file = rest.trim_matches('"').trim();
    if file.is_empty() {
        return Err("no file; it is passed over".to_owned());
    }
    Ok(file.replace('\\', "/"))
}

/// How many words may follow an option of a picture.
fn arguments_of(option: &str) -> Option<usize> {
    match option {
        "-o" | "-s" | "-t" => Some(3),
        "-mm" => Some(2),
        "-blendu" | "-blendv" | "-boost" | "-texres" | "-clamp" | "-bm" | "-imfchan" | "-type"
        | "-cc" | "-colorspace" => Some(1),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_used_is_spelled_plainly() {
        let (text, warnings) = plain(
            "\u{feff}# c\r\n newmtl  Material #25 \r\n\tkd .5 \\\r\n1 0 # c\nKa x\nTR 0.5\nNs 1e2 9",
        );
        assert_eq!(text, "newmtl Material #25\nKd 0.5 1 0\nTr 0.5\nNs 100\n");
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn pictures_lose_their_options_and_keep_their_blanks() {
        let cases = [
            ("a.png", "a.png"),
            ("-s 1 1 1 my file.png", "my file.png"),
            ("-s 1 1 -o 0 0 0 -mm 0 1 -blendu on a.png", "a.png"),
            ("-clamp on \"tex\\my file.png\"", "tex/my file.png"),
            ("..\\tex\\a.png", "../tex/a.png"),
            ("-s 1 2", "2"),
            ("-weird.png", "-weird.png"),
        ];
        for (text, expected) in cases {
            let (text, warnings) = plain(&format!("newmtl m\nmap_Kd {text}"));
            assert_eq!(text, format!("newmtl m\nmap_Kd {expected}\n"));
            assert!(warnings.is_empty(), "{warnings:?}");
        }
        let (text, warnings) = plain("newmtl m\nmap_Kd -s 2 2 2 a.png");
        assert_eq!(text, "newmtl m\nmap_Kd a.png\n");
        assert_eq!(warnings, ["line 2: `-s` is not supported; it is passed over"]);
    }

    #[test]
    fn broken_lines_are_told_and_cost_nothing_else() {
        let (text, warnings) = plain(
            "Kd 1 1 1\nnewmtl\nKd 1 1 1\nnewmtl m\nKd 1 2\nKs spectral a.rfl\nNs\nNi nan\nd 1e99\n\
             map_Kd\nKe 1 1 \u{1b}\nKd 1 0 0",
        );
        assert_eq!(text, "newmtl m\nKd 1 0 0\n");
        let expected = [
            "line 1: `Kd`: no material before it",
            "line 2: `newmtl`: no name",
            "line 3: `Kd`: no material before it",
            "line 5: `Kd`: `1 2` is not a colour of three numbers; it is passed over",
            "line 6: `Ks`: `spectral a.rfl` is not a colour of three numbers; it is passed over",
            "line 7: `Ns`: `` is not a finite number; it is passed over",
            "line 8: `Ni`: `nan` is not a finite number; it is passed over",
            "line 9: `d`: `1e99` is not a finite number; it is passed over",
            "line 10: `map_Kd`: no file; it is passed over",
            "line 11: `Ke`: `\\u{1b}` is not a finite number; it is passed over",
        ];
        assert_eq!(warnings, expected);
    }
}

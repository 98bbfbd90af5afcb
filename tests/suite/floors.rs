//! Who may use whom: every path of every module is held against the table of floors.

use std::path::{Path, PathBuf};

/// The floor of each module at the top of the crate.
const FLOORS: &[(u32, &[&str])] = &[
    (0, &["math", "color", "threads"]),
    (1, &["geometry", "brdf"]),
    (2, &["scene"]),
    (3, &["render", "io", "tone_mapping"]),
    (4, &["session", "loader", "document"]),
    (5, &["window", "cli"]),
    (6, &["main", "lib"]),
];

/// Words that only these modules may say.
const RESERVED: &[(&str, &[&str])] = &[
    ("egui::", &["window"]),
    ("egui_extras::", &["window"]),
    ("egui_plot::", &["window"]),
    ("egui_kittest::", &["window"]),
    ("eframe::", &["window"]),
    ("winit::", &["window"]),
    ("rfd::", &["window"]),
    ("crate::threads", &["session", "loader", "window", "cli"]),
    ("thread::spawn", &["threads"]),
    ("thread::Builder", &["threads"]),
    ("ThreadPoolBuilder", &["threads"]),
    ("println!", &["cli", "main"]),
];

/// Words that a module may not say.
const FORBIDDEN: &[(&str, &[&str])] =
    &[("render", &["std::fs", "std::io", "std::time", "print!", "println!", "std::env"])];

#[test]
fn modules_use_only_lower_floors_and_themselves() {
    let faults: Vec<String> = sources().iter().flat_map(|s| faults_of(&s.path, &s.text)).collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// Files whose registers need it; everything else does without, tests too.
const UNSAFE: &[&str] = &["geometry/lanes", "geometry/wide_bvh/", "math/vectorized.rs"];

#[test]
fn only_the_code_for_wide_registers_is_unsafe() {
    let mut n_found = 0;
    for Source { path, text } in sources() {
        let path = path.to_str().unwrap();
        let is_allowed = UNSAFE.iter().any(|place| path.starts_with(place));
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            if says(code, "unsafe ") || says(code, "unsafe_code") {
                n_found += 1;
                assert!(is_allowed, "src/{path}:{}: {line}", number + 1);
                assert!(text.contains("// SAFETY"), "src/{path}: says nowhere why it is sound");
            }
        }
    }
    assert!(n_found > 0, "nothing unsafe is found at all");
}

#[test]
fn every_module_of_the_crate_has_a_floor() {
    let names: Vec<String> = sources().iter().map(|source| module_of(&source.path)).collect();
    for known in ["math", "geometry", "scene", "render", "session", "cli", "main"] {
        assert!(names.iter().any(|name| name == known), "{known} was not read");
    }
    for name in names {
        assert!(floor_of(&name).is_some(), "{name} has no floor");
    }
}

/// The test can fail: each of these breaks one rule.
#[test]
fn broken_rules_are_found() {
    for (path, text) in [
        ("math/a.rs", "use crate::scene::Scene;"),
        ("io/a.rs", "use crate::render::Film;"),
        ("color.rs", "let x = crate::math::pow(2.0);"),
        ("render/a.rs", "use crate::{math, session};"),
        ("render/a.rs", "    let now = std::time::Instant::now();"),
        ("render/mod.rs", "use super::session::Session;"),
        ("session/a.rs", "use super::super::window::App;"),
        ("io/a.rs", "use crate::threads;"),
        ("cli.rs", "use egui::Ui;"),
        ("geometry/a.rs", "std::thread::spawn(|| ());"),
    ] {
        assert!(!faults_of(Path::new(path), text).is_empty(), "{path}: {text}");
    }
    for (path, text) in [
        ("io/a.rs", "use crate::io::files::read_file;\nuse crate::math::Ray;"),
        ("cli.rs", "use crate::{loader, math};"),
        ("color.rs", "//! See [`crate::render::Film`].\nmod tests {\n    use super::*;\n}"),
        ("session/a.rs", "use super::Frame;"),
    ] {
        assert_eq!(faults_of(Path::new(path), text), Vec::<String>::new(), "{path}: {text}");
    }
}

struct Source {
    /// Relative to `src`.
    path: PathBuf,
    text: String,
}

fn sources() -> Vec<Source> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut folders = vec![top.clone()];
    let mut sources = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                sources.push(Source { path: path.strip_prefix(&top).unwrap().to_owned(), text });
            }
        }
    }
    assert!(sources.len() > 50, "only {} files were found", sources.len());
    sources
}

/// The module at the top of the crate that a file belongs to.
fn module_of(path: &Path) -> String {
    let first = path.components().next().unwrap();
    Path::new(&first).file_stem().unwrap().to_str().unwrap().to_owned()
}

fn floor_of(module: &str) -> Option<u32> {
    FLOORS.iter().find(|(_, names)| names.contains(&module)).map(|(floor, _)| *floor)
}

fn faults_of(path: &Path, text: &str) -> Vec<String> {
    let module = module_of(path);
    let floor = floor_of(&module).unwrap();
    let mut faults = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let code = line.split("//").next().unwrap_or_default();
        let mut fault = |what: String| {
            faults.push(format!("src/{}:{}: {what}: {line}", path.display(), number + 1));
        };
        for used in modules_named(code) {
            match floor_of(&used) {
                Some(other) if other < floor || used == module => {}
                Some(other) => {
                    fault(format!("{module} (floor {floor}) uses {used} (floor {other})"));
                }
                None => fault(format!("{used} has no floor")),
            }
        }
        if climbs_out(path, line) {
            fault("climbs out of its module; write `crate::`".to_owned());
        }
        for (word, modules) in RESERVED {
            if says(code, word) && !modules.contains(&&*module) {
                fault(format!("only {modules:?} may say {word}"));
            }
        }
        for (name, words) in FORBIDDEN {
            for word in words.iter().filter(|word| *name == module && says(code, word)) {
                fault(format!("{name} may not say {word}"));
            }
        }
    }
    faults
}

/// Whether a word begins somewhere: `egui::` is not in `my_egui::`.
fn says(code: &str, word: &str) -> bool {
    code.match_indices(word).any(|(at, _)| {
        let before = code[..at].chars().next_back();
        before.is_none_or(|c| !c.is_alphanumeric() && c != '_')
    })
}

/// The modules after every `crate::`, also those in braces.
fn modules_named(code: &str) -> Vec<String> {
    let mut named = Vec::new();
    for (at, prefix) in code.match_indices("crate::") {
        let rest = &code[at + prefix.len()..];
        let list = match rest.strip_prefix('{') {
            Some(list) => list,
            None => rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap(),
        };
        let mut depth = 0;
        let mut name = String::new();
        let mut is_head = true;
        for c in list.chars().chain([',']) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth <= 0 => {
                    named.extend((!name.is_empty()).then(|| std::mem::take(&mut name)));
                    is_head = true;
                }
                ':' | ';' => is_head = false,
                _ if depth == 0 && is_head && (c.is_alphanumeric() || c == '_') => name.push(c),
                _ => {}
            }
        }
    }
    named
}

/// Whether a chain of `super::` reaches the top of the crate, where every module could be named.
/// Inside a module in the file, which is indented, one more is allowed.
fn climbs_out(path: &Path, line: &str) -> bool {
    let n_folders = path.components().count();
    let is_folder_itself = path.file_stem().is_some_and(|stem| stem == "mod");
    let depth = if is_folder_itself { n_folders - 1 } else { n_folders };
    let is_nested = line.starts_with(' ');
    let n_supers = line.matches("super::").count();
    n_supers > 0 && depth + usize::from(is_nested) <= n_supers
}

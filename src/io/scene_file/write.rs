//! A description as the text of a scene file.
//!
//! Sections and keys come in the order of the tables of keys. What has its default value is left
//! out, but for what a reader wants to see. Numbers read back to the last bit.

use serde::Deserialize;
use toml::{Table, Value};

use crate::scene::description::SceneDescription;

use super::keys::{Key, Presence, Rule, Section};
use super::table_of;
use super::words::value_text;

/// Lines up to this many characters are not broken.
const LONGEST_LINE: usize = 100;

/// TOML that [`super::parse`] reads as an equal description.
pub fn write(scene: &SceneDescription) -> String {
    let root = table_of(scene);
    let defaults = defaults_of(&root);
    let mut sections = Vec::new();
    for section in Section::ALL {
        let name = section.name();
        match (root.get(name), defaults.get(name)) {
            (Some(Value::Array(entries)), Some(Value::Array(defaults))) => {
                for (entry, default) in entries.iter().zip(defaults) {
                    sections.push(format!("[[{name}]]\n{}", lines(section, entry, default)));
                }
            }
            (Some(table), Some(default)) => {
                sections.push(format!("[{name}]\n{}", lines(section, table, default)));
            }
            (_, _) => {}
        }
    }
    sections.join("\n")
}

/// The same scene with only its required keys and its names given: every other value of it is a
/// default.
fn defaults_of(root: &Table) -> Table {
    let mut bare = Table::new();
    for section in Section::ALL {
        let strip = |value: &Value| {
            let is_kept = |key: &&Key| key.presence == Presence::Required || key.name == "name";
            let kept = section.keys().iter().filter(is_kept);
            let pairs =
                kept.filter_map(|key| Some((key.name.into(), value.get(key.name)?.clone())));
            Value::Table(pairs.collect())
        };
        let value = match root.get(section.name()) {
            Some(Value::Array(entries)) => Value::Array(entries.iter().map(strip).collect()),
            Some(value) => strip(value),
            None => continue,
        };
        bare.insert(section.name().into(), value);
    }
    let scene = SceneDescription::deserialize(Value::Table(bare))
        .expect("a description reads back from its required keys");
    table_of(&scene)
}

fn lines(section: Section, values: &Value, defaults: &Value) -> String {
    let mut lines = String::new();
    for key in section.keys() {
        let Some(value) = values.get(key.name) else {
            continue;
        };
        if key.presence != Presence::Optional || defaults.get(key.name) != Some(value) {
            lines.push_str(&line(key, value));
        }
    }
    lines
}

fn line(key: &Key, value: &Value) -> String {
    let text = match (key.rule, value) {
        (Rule::Table(keys), Value::Table(table)) => {
            let pair =
                |key: &Key| Some(format!("{} = {}", key.name, value_text(table.get(key.name)?)));
            format!("{{ {} }}", keys.iter().filter_map(pair).collect::<Vec<_>>().join(", "))
        }
        (_, value) => value_text(value),
    };
    let line = format!("{} = {text}\n", key.name);
    match (key.rule, value) {
        (Rule::Colors, Value::Array(colors)) if LONGEST_LINE < line.chars().count() => {
            let colors: String =
                colors.iter().map(|color| format!("    {},\n", value_text(color))).collect();
            format!("{} = [\n{colors}]\n", key.name)
        }
        (_, _) => line,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{parse, random, tests::FULL, validate};
    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig {
            rng_seed: prop::test_runner::RngSeed::Fixed(1),
            failure_persistence: None,
            ..ProptestConfig::with_cases(256)
        })]

        #[test]
        fn what_is_written_reads_back_as_it_was(scene in random::scene()) {
            prop_assert_eq!(validate(&scene), Ok(()));
            let text = write(&scene);
            let back = parse(&text, &[]).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
            prop_assert_eq!(back, scene, "{}", text);
        }
    }

    #[test]
    fn the_full_scene_is_written_as_a_person_wrote_it() {
        let scene = parse(FULL, &[]).unwrap();
        assert_eq!(write(&scene), FULL, "written text");
    }

    #[test]
    fn defaults_are_left_out() {
        let text = "\
[render]
width = 1280
height = 720
samples = 256
max_depth = 8
integrator = \"direct\"

[camera]
eye = [0.0, 0.0, 1.0]
target = [0.0, 0.0, 0.0]
vertical_fov = 40.0
aperture_radius = 0.0

[tone_mapping]
exposure = 0.0
operator = \"agx\"

[environment]
ambient = [0.0, 0.0, 0.0]
background = [0.0, 0.0, 0.0]

[[objects]]
name = \"object-1\"
type = \"sphere\"
center = [0.0, 0.0, 0.0]
radius = 1.0
";
        let short = "camera = { eye = [0, 0, 1], target = [0, 0, 0] }\n\
                     [[objects]]\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = 1";
        assert_eq!(write(&parse(short, &[]).unwrap()), text, "written text");
    }

    #[test]
    fn long_lists_of_colours_are_broken_into_lines() {
        let mut scene = parse(FULL, &[]).unwrap();
        scene.textures[0].colors = Some(vec![[0.125, 0.25, 0.5]; 8]);
        let text = write(&scene);
        assert!(text.contains("colors = [\n    [0.125, 0.25, 0.5],\n"), "{text}");
        assert_eq!(parse(&text, &[]).unwrap(), scene, "read back");
    }
}

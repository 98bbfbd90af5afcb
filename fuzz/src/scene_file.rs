//! The reader and the writer of scene files.

use penumbra::io::scene_file::{Override, get, parameters, parse, text_of, with_value, write};

/// Parameters of one scene that are read and set again.
const MAX_PARAMETERS: usize = 24;

/// A text is a scene or is refused in a sentence; a scene is written and read as it is. Lines
/// `#set PATH=VALUE` at the start are overrides.
pub fn scene_file(data: &[u8]) {
    let text = match text_of(data.to_vec()) {
        Ok(text) => text,
        Err(error) => return super::check_message(&error.to_string()),
    };
    let mut overrides = Vec::new();
    for line in text.lines().map_while(|line| line.strip_prefix("#set ")) {
        match Override::parse(line) {
            Ok(given) => overrides.push(given),
            Err(error) => super::check_message(&error.to_string()),
        }
    }
    let scene = match parse(&text, &overrides) {
        Ok(scene) => scene,
        Err(error) => return super::check_message(&error.in_file("s.toml")),
    };
    let written = write(&scene);
    match parse(&written, &[]) {
        Ok(again) => assert!(again == scene, "read again, it differs:\n{written}"),
        Err(error) => panic!("{error} in what was written:\n{written}"),
    }
    for path in parameters(&scene).iter().take(MAX_PARAMETERS) {
        let value = get(&scene, path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let Some(value) = value else { continue };
        match with_value(&scene, path, value) {
            Ok(same) => assert!(same == scene, "{path} set to its own value changes the scene"),
            Err(error) => panic!("{path} refuses its own value: {error}"),
        }
    }
}

//! The scenes that come with the program.

use penumbra::io::gallery::GALLERY;

use super::{Place, Png};

#[test]
fn every_scene_of_the_gallery_renders() {
    let place = Place::new();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    assert!(GALLERY.len() >= 12, "only {} scenes", GALLERY.len());
    for entry in GALLERY {
        let scene = folder.join(format!("{}.toml", entry.name));
        let small = ["--width", "16", "--height", "9", "-s", "1"];
        let run =
            place.ok(&[&["render", scene.to_str().unwrap(), "-o", "a.png"], &small[..]].concat());
        assert_eq!(run.stderr, "", "{} warns", entry.name);
        let png = Png::read(&place.read("a.png"));
        let (darkest, brightest) = (png.pixels.iter().min(), png.pixels.iter().max());
        assert_ne!(darkest, brightest, "{} shows nothing", entry.name);
    }
}

#[test]
fn a_gallery_picture_opens_where_the_scene_is_not() {
    let place = Place::new();
    let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/pyramid.toml");
    let small = ["--width", "16", "--height", "9", "-s", "1"];
    place.ok(&[&["render", scene.to_str().unwrap(), "-o", "a.png"], &small[..]].concat());
    place.ok(&["verify", "a.png"]);
}

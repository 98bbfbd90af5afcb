//! Pictures that carry their scenes: `verify`, and opening them elsewhere.

use super::{BALL, LIBRARY, MESH, Place, Png, checkered_png};

const SMALL: [&str; 6] = ["-s", "2", "--width", "12", "--height", "8"];

/// A scene in `a/scenes` with a mesh in `a/assets`, and its picture `a/scenes/shot.png`.
fn place_with_shot() -> Place {
    let place = Place::new();
    let scene = format!(
        "{BALL}[[objects]]\ntype = \"mesh\"\nfile = \"../assets/m.obj\"\n\
         [[textures]]\nname = \"map\"\ntype = \"image\"\nfile = \"../assets/t.png\"\n"
    );
    place.write("a/scenes/s.toml", scene.as_bytes());
    place.write("a/assets/m.obj", MESH.as_bytes());
    place.write("a/assets/m.mtl", LIBRARY.as_bytes());
    place.write("a/assets/m.png", &checkered_png());
    place.write("a/assets/t.png", &checkered_png());
    place.ok(&[&["render", "a/scenes/s.toml", "-o", "a/scenes/shot.png"], &SMALL[..]].concat());
    place
}

fn copy(place: &Place, from: &str, to: &str) {
    place.write(to, &place.read(from));
}

#[test]
fn a_fresh_picture_is_equal_to_its_scene() {
    let place = Place::with_ball();
    place.ball_png(
        "a.png",
        &["--set", "camera.vertical_fov=31", "--set", "tone_mapping.operator=aces"],
    );
    for threads in ["1", "2"] {
        let run = place.ok(&["verify", "a.png", "-t", threads]);
        assert!(run.stdout.starts_with("equal"), "{}", run.stdout);
    }
    let png = Png::read(&place.read("a.png"));
    let keywords: Vec<&str> = png.texts.iter().map(|(key, _)| key.as_str()).collect();
    assert_eq!(keywords, ["penumbra:scene", "penumbra:render"], "keywords");
    assert!(png.text("penumbra:scene").contains("vertical_fov = 31"), "the scene as rendered");
    let record: serde_json::Value = serde_json::from_str(png.text("penumbra:render")).unwrap();
    assert_eq!(super::keys(&record), ["files", "samples", "seed", "version"], "no folder");
}

#[test]
fn a_changed_byte_is_counted() {
    let place = Place::with_ball();
    let mut png = Png::read(&place.ball_png("a.png", &[]));
    png.pixels[7] ^= 1;
    png.pixels[100] ^= 128;
    place.write("b.png", &png.bytes());
    let run = place.run(&["verify", "b.png"]);
    assert_eq!(run.status, Some(1), "{}", run.stdout);
    assert!(run.stdout.contains("2 of 432 bytes"), "{}", run.stdout);
    assert!(!run.stdout.contains("version"), "the same version: {}", run.stdout);
    let record = png.text("penumbra:render");
    let version = env!("CARGO_PKG_VERSION");
    png.texts[1].1 = record.replace(&format!("\"{version}\""), "\"0.0.1\\u001b[31m\"");
    place.write("b.png", &png.bytes());
    let run = place.run(&["verify", "b.png"]);
    let names_both = run.stdout.contains("0.0.1") && run.stdout.contains(version);
    assert!(run.status == Some(1) && names_both, "{}", run.stdout);
}

#[test]
fn a_changed_scene_gives_another_picture_and_a_damaged_one_an_error() {
    let place = Place::with_ball();
    let bytes = place.ball_png("a.png", &[]);
    let with_scene = |from: &str, to: &str| {
        let mut png = Png::read(&bytes);
        let changed = png.texts[0].1.replace(from, to);
        assert_ne!(png.texts[0].1, changed, "{from} is not there");
        png.texts[0].1 = changed;
        place.write("b.png", &png.bytes());
        place.run(&["verify", "b.png"])
    };
    let run = with_scene("vertical_fov = 40", "vertical_fov = 70");
    assert_eq!(run.status, Some(1), "{}", run.stdout);
    assert!(run.stdout.starts_with("different: "), "{}", run.stdout);
    let run = with_scene("width = 16", "width = 17");
    assert!(run.status == Some(1) && run.stdout.contains("16 x 9"), "{}", run.stdout);
    let run = with_scene("samples = 4", "samples = 1048576");
    assert!(run.status == Some(1) && run.stderr.contains("b.png"), "{}", run.stderr);
    let run = with_scene("vertical_fov", "vertical_fog");
    assert!(run.status == Some(1) && run.stderr.contains("b.png:"), "{}", run.stderr);
}

#[test]
fn what_is_no_snapshot_is_named() {
    let place = Place::with_mesh();
    place.write("ball.toml", BALL.as_bytes());
    for (file, says) in
        [("m.png", "carries no scene"), ("ball.toml", "no snapshot"), ("gone.png", "no such file")]
    {
        let error = place.fails(1, &["verify", file]);
        assert!(error.contains(file) && error.contains(says), "{error}");
    }
    let shot = place.ball_png("a.png", &[]);
    for length in [0, 7, 20, 60, shot.len() / 2, shot.len() - 20, shot.len() - 9, shot.len() - 1] {
        place.write("cut.png", &shot[..length]);
        let error = place.fails(1, &["verify", "cut.png"]);
        assert!(error.contains("cut.png"), "{length}: {error}");
    }
}

#[test]
fn a_snapshot_rendered_again_is_the_same_file() {
    let place = place_with_shot();
    place.ok(&["render", "a/scenes/shot.png", "-o", "a/scenes/again.png"]);
    assert_eq!(place.read("a/scenes/shot.png"), place.read("a/scenes/again.png"), "the same bytes");
}

#[test]
fn a_moved_snapshot_finds_its_files_beside_it() {
    let place = place_with_shot();
    place.ok(&["verify", "a/scenes/shot.png"]);
    copy(&place, "a/scenes/shot.png", "lost/shot.png");
    place.fails(1, &["verify", "lost/shot.png"]);
    for name in ["m.obj", "m.mtl", "m.png", "t.png"] {
        copy(&place, &format!("a/assets/{name}"), &format!("b/{name}"));
    }
    copy(&place, "a/scenes/shot.png", "b/shot.png");
    place.ok(&["verify", "b/shot.png"]);
    // In folders beside it, as the scene names them.
    for name in ["m.obj", "m.mtl", "m.png", "t.png"] {
        copy(&place, &format!("a/assets/{name}"), &format!("c/assets/{name}"));
    }
    copy(&place, "a/scenes/shot.png", "c/shots/shot.png");
    place.ok(&["verify", "c/shots/shot.png"]);
}

#[test]
fn missing_and_changed_files_of_a_snapshot_are_named() {
    let place = place_with_shot();
    let names = ["m.obj", "m.mtl", "m.png", "t.png"];
    for broken in names {
        for name in names {
            copy(&place, &format!("a/assets/{name}"), &format!("b/{name}"));
        }
        copy(&place, "a/scenes/shot.png", "b/shot.png");
        std::fs::remove_file(place.path(&format!("b/{broken}"))).unwrap();
        let error = place.fails(1, &["verify", "b/shot.png"]);
        assert!(error.contains(broken), "missing {broken}: {error}");
        let mut bytes = place.read(&format!("a/assets/{broken}"));
        bytes.push(b'\n');
        place.write(&format!("b/{broken}"), &bytes);
        let error = place.fails(1, &["render", "b/shot.png", "-o", "c.png"]);
        let is_clear = error.contains(broken) && error.contains("changed");
        assert!(is_clear, "changed {broken}: {error}");
    }
}

/// A library that was missing when the picture was made is not part of it.
#[test]
fn files_that_a_snapshot_did_not_use_change_nothing() {
    let place = Place::with(&[("m.obj", MESH)]);
    place.ok(&[&["render", "m.obj", "-o", "shot.png", "--quiet"], &SMALL[..]].concat());
    place.write("m.mtl", LIBRARY.as_bytes());
    place.ok(&["verify", "shot.png"]);
}

#[test]
fn a_snapshot_of_a_bare_mesh_needs_the_mesh_only() {
    let place = Place::with_mesh();
    place.ok(&[&["render", "m.obj", "-o", "shot.png"], &SMALL[..]].concat());
    place.ok(&["verify", "shot.png"]);
    place.ok(&["render", "shot.png", "-o", "again.png"]);
    assert_eq!(place.read("shot.png"), place.read("again.png"), "the same bytes");
    std::fs::remove_file(place.path("m.obj")).unwrap();
    let error = place.fails(1, &["verify", "shot.png"]);
    assert!(error.contains("m.obj"), "{error}");
}

#[test]
fn a_small_text_that_unpacks_to_a_huge_one_is_refused() {
    let place = Place::new();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    for keyword in ["penumbra:scene", "penumbra:render"] {
        let mut chunk = png::text_metadata::ITXtChunk::new(keyword, " ".repeat(100 << 20));
        chunk.compressed = true;
        chunk.compress_text().unwrap();
        writer.write_text_chunk(&chunk).unwrap();
    }
    writer.write_image_data(&[0, 0, 0]).unwrap();
    drop(writer);
    assert!(bytes.len() < 1 << 20, "{} bytes are no small text", bytes.len());
    place.write("bomb.png", &bytes);
    let error = place.fails(1, &["info", "bomb.png"]);
    assert!(error.contains("bomb.png") && error.contains("carries no scene"), "{error}");
}

//! What formats allow and few programs write, and what only looks like it.

use super::{open, opened};
use crate::cli::{BALL, Place, checkered_png};

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

#[test]
fn meshes_of_every_dialect_have_as_many_triangles_as_they_say() {
    let place = Place::with_mesh();
    let with = |text: &str| format!("{CORNERS}{text}\n");
    for (what, text, n_triangles) in [
        ("lines that end with CR", with("f 1 2 3").replace('\n', "\r"), 1),
        ("every kind of line end", "v 0 0 0\rv 1 0 0\r\nv 0 1 0\n\rf 1 2 3\r\r\n".to_owned(), 1),
        (
            "continued lines",
            "v \\\n0 0 \\\r\n0\nv 1 0 0\nv 0 1\\\n 0\nf 1\\\n 2 \\\n\\\n3".to_owned(),
            1,
        ),
        ("a keyword alone on its line", with("f\\\n 1 2 3"), 1),
        ("a line continued a lot", with(&format!("f 1 2 {}3", "\\\n".repeat(50_000))), 1),
        ("a comment that seems continued", format!("# c \\\n{}", with("f 1 2 3")), 1),
        ("indices from the end", with("f -4 -3 -2\nf 1 -3 4"), 2),
        ("signs", with("f +1 +2 +3"), 1),
        ("corners of every form", with("vt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1\nf 1 2/1/1 4//1"), 2),
        (
            "the same three times",
            with("vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\nf 3/3/3 2/2/2 1/1/1"),
            1,
        ),
        ("parts left empty", with("f 1/ 2/ 3/\nf 1// 2// 4//"), 2),
        (
            "curves",
            with("vp 0.1 0.2 1\ncstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nparm u 0 1\nend\nf 1 2 3"),
            1,
        ),
        (
            "orders to other programs",
            with("f 1 2 3\ncall /etc/passwd 1\ncsh -rm x\nshadow_obj /dev/zero"),
            1,
        ),
        (
            "lines and points without an end",
            with(&format!("f 1 2 3\nl{}\np{}", " 1".repeat(100_000), " 9e999".repeat(100_000))),
            1,
        ),
        (
            "groups that write to terminals",
            with("g \u{1b}]0;x\u{7}\no \u{9b}31m\ns \0\nf 1 2 3"),
            1,
        ),
        (
            "many groups",
            with(&(0..20_000).map(|i| format!("g {i}\nusemtl {i}\nf 1 2 3\n")).collect::<String>()),
            20_000,
        ),
        (
            "names written from the right",
            with("mtllib \u{202e}gpj.mtl\nusemtl \u{202e}\u{2066}x\u{2069}\nf 1 2 3"),
            1,
        ),
        (
            "many libraries in one line",
            with(&format!("mtllib {}\nf 1 2 3", "a.mtl ".repeat(60_000))),
            1,
        ),
        ("libraries without names", with("mtllib\nmtllib .mtl\nmtllib .\nmtllib /\nf 1 2 3"), 1),
        ("a weight below 0", "v 1 1 1 -1\nv 1 0 0\nv 0 1 0\nf 1 2 3".to_owned(), 1),
        ("a face on a line", with("v 2 0 0\nv 3 0 0\nf 1 2 5 6"), 2),
        ("a bow tie", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4".to_owned(), 2),
    ] {
        let loaded = opened(&place, "n.obj", text.as_bytes(), what);
        let loaded = loaded.unwrap_or_else(|error| panic!("{what}: {error}"));
        let meshes = loaded.assets.meshes.values();
        let n: usize = meshes.map(|mesh| mesh.traced.mesh.triangles.len()).sum();
        assert_eq!(n, n_triangles, "{what}");
    }
}

#[test]
fn what_only_looks_like_a_mesh_is_refused_by_line() {
    let place = Place::new();
    for (line, says) in [
        ("v 1\0 2 3", "`1\\0` is not a number"),
        ("v \u{ff11} 0 0", "is not a number"),
        ("v \u{661} 0 0", "is not a number"),
        ("v 0 0 \\ ", "`\\` is not a number"),
        ("v 1 1 1 1e-45", "out of range"),
        ("v 1e 0 0", "`1e` is not a number"),
        ("v 1_0 0 0", "`1_0` is not a number"),
        ("v 1d0 0 0", "`1d0` is not a number"),
        ("v 0 0 0 1 1", "5 numbers"),
        ("v 0 0 0 1 1 1 1 1 1", "more than 8 numbers"),
        ("vt 0 0 0 0", "more than 3 numbers"),
        ("f -0 1 2", "index 0"),
        ("f -5 1 2", "vertex -5, but only 4"),
        ("f -4/-1 -3/-1 -2/-1", "texture coordinate -1, but only 0"),
        ("f 1/// 2 3", "`1///` is not a corner"),
        ("f /1 2 3", "`/1` is not a corner"),
        ("f 1 / 2 / 3", "`/` is not a corner"),
        ("f 1/1/1/1 2 3", "`1/1/1/1` is not a corner"),
        ("f 1 2 3#", "`3#` is not a corner"),
        ("\0\0\0\0", "`\\0\\0\\0\\0` is not text"),
        ("\u{1a}", "`\\u{1a}` is not text"),
    ] {
        let text = format!("{CORNERS}{line}\nf 1 2 3\n");
        let error = opened(&place, "m.obj", text.as_bytes(), line).expect_err(line);
        assert!(error.contains("m.obj: line 5: ") && error.contains(says), "{line}: {error}");
    }
    let text = format!("f -1 -2 -3\n{CORNERS}f 1 2 3\n");
    let error = opened(&place, "m.obj", text.as_bytes(), "from the end").expect_err("nothing yet");
    assert!(error.contains("m.obj: line 1: `-1` uses vertex -1, but only 0"), "{error}");
}

#[test]
fn pictures_of_materials_are_found_behind_every_option() {
    let place = Place::with_mesh();
    let mesh = "mtllib n.mtl\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
    for options in [
        "-blendu on -blendv off -clamp on -cc off",
        "-bm 1e999 -boost nan -texres 99999999999",
        "-imfchan l -type sphere -colorspace linear",
        "-mm -1e38 1e38 -mm 0",
        "-o 0 0 0 -s 1 1 1 -t 0",
        "-s 1 -o 0 -t 0 0 -mm 1 1 -bm 1",
        "-o -s -t",
    ] {
        let maps = ["map_Kd", "map_Ks", "map_Bump", "bump", "disp", "decal", "refl", "norm"];
        let lines: String = maps.iter().map(|map| format!("{map} {options} m.png\n")).collect();
        place.write("n.mtl", format!("newmtl a\nKd 1 1 1\n{lines}").as_bytes());
        let loaded = opened(&place, "n.obj", format!("{CORNERS}{mesh}").as_bytes(), options);
        let loaded = loaded.expect(options);
        assert!(loaded.report.is_empty(), "{options}: {:?}", loaded.report);
        let slots = loaded.assets.meshes.values().flat_map(|mesh| &mesh.slots);
        let n_maps = slots.flatten().filter(|slot| slot.diffuse_map.is_some()).count();
        assert_eq!(n_maps, 1, "{options}: another picture");
    }
    // Libraries that name each other are libraries that name nothing.
    place.write("n.mtl", b"mtllib n.mtl\ncall n.mtl\nnewmtl a\nKd 1 0 0\n");
    opened(&place, "n.obj", format!("{CORNERS}{mesh}").as_bytes(), "a circle").expect("a circle");
}

/// A checker of 8 x 8 in that kind of PNG, with other chunks before its pixels.
fn png(
    color: png::ColorType,
    depth: png::BitDepth,
    add: impl Fn(&mut png::Encoder<'_, &mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 8, 8);
    encoder.set_color(color);
    encoder.set_depth(depth);
    add(&mut encoder);
    let mut writer = encoder.write_header().unwrap();
    // Eight pixels a row, and as many bits a sample as the depth says.
    let row = color.samples() * depth as usize;
    writer.write_image_data(&[0x10].repeat(8 * row)).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn pictures_of_every_kind_load_and_texts_in_them_are_left_alone() {
    use png::{BitDepth, ColorType};
    let place = Place::new();
    let scene = format!("{BALL}[[textures]]\nname = \"t\"\ntype = \"image\"\nfile = \"t.png\"\n");
    let zeros = "\0".repeat(100 << 20);
    for (what, bytes) in [
        ("16 bits", png(ColorType::Rgb, BitDepth::Sixteen, |_| ())),
        ("16 bits and alpha", png(ColorType::Rgba, BitDepth::Sixteen, |_| ())),
        ("grey of 1 bit", png(ColorType::Grayscale, BitDepth::One, |_| ())),
        ("a palette", png(ColorType::Indexed, BitDepth::Four, |e| e.set_palette(&[9; 48][..]))),
        ("a movement", png(ColorType::Rgb, BitDepth::Eight, |e| e.set_animated(1, 0).unwrap())),
        (
            "a text of 100 MiB, in 100 KiB",
            png(ColorType::Rgb, BitDepth::Eight, |e| {
                e.add_ztxt_chunk("a".into(), zeros.clone()).unwrap();
            }),
        ),
        (
            "20,000 texts",
            png(ColorType::Rgb, BitDepth::Eight, |e| {
                (0..20_000).for_each(|i| e.add_text_chunk(i.to_string(), "x".into()).unwrap());
            }),
        ),
    ] {
        place.write("t.png", &bytes);
        let loaded = opened(&place, "s.toml", scene.as_bytes(), what);
        assert!(loaded.is_ok(), "{what}: {:?}", loaded.err());
        let error = open(place.path("t.png"), what).expect_err(what);
        assert!(error.contains("carries no scene"), "{what}: {error}");
    }
    let colors = checkered_png();
    let palette = png(ColorType::Indexed, BitDepth::Eight, |e| e.set_palette(&[9; 6][..]));
    for (what, bytes) in [
        ("an index past the palette", palette),
        ("something after the end", [&colors[..], b"\x1b[31m"].concat()),
    ] {
        place.write("t.png", &bytes);
        let _ = opened(&place, "s.toml", scene.as_bytes(), what);
    }
}

#[test]
fn scenes_of_every_dialect_load_or_are_refused_by_place() {
    let place = Place::new();
    let of = |from: &str, to: &str| {
        assert!(BALL.contains(from), "{from}");
        BALL.replacen(from, to, 1)
    };
    for (what, text) in [
        ("an escape in a key", of("samples = 4", "\"s\\u0061mples\" = 4")),
        ("digits in groups", of("samples = 4", "samples = 1_6")),
        ("a name with dots", of("name = \"ball\"", "name = \"a.b\"")),
        (
            "names that look alike",
            of("name = \"ball\"", "name = \"\u{e9}\"").replace("\"block\"", "\"e\u{301}\""),
        ),
        ("a name from the right", of("name = \"ball\"", "name = \"\u{202e}llab\u{2066}\"")),
        (
            "a panel without a size",
            of("type = \"disk\"", "type = \"rectangle\"").replace("size = 1.5", "size = [0, 0]"),
        ),
        ("many empty lines", format!("{BALL}{}", "\n".repeat(2_000_000))),
        (
            "many objects",
            format!(
                "{BALL}{}",
                "[[objects]]\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\n".repeat(2000)
            ),
        ),
        (
            "many lights",
            format!(
                "{BALL}{}",
                "[[lights]]\ntype = 'point'\nposition = [0, 9, 0]\npower = [1, 1, 1]\n"
                    .repeat(1000)
            ),
        ),
    ] {
        let loaded = opened(&place, "s.toml", text.as_bytes(), what);
        assert!(loaded.is_ok(), "{what}: {:?}", loaded.err());
    }
    for (text, says) in [
        (of("samples = 4", "samples = 1979-05-27"), "s.toml:4:11: render.samples: 1979-05-27"),
        (of("samples = 4", "samples = 99999999999999999999"), "s.toml:4:11: render.samples: 1e20"),
        (
            of("samples = 4", "samples = 4\n\"s\\u0061mples\" = 4"),
            "s.toml:5:1: not TOML: duplicate key",
        ),
        (of("[render]", "render.seed = 1\n[render]"), "s.toml:2:2: not TOML: duplicate key"),
        (of("[camera]", "\u{feff}[camera]"), "s.toml:5:2: not TOML"),
        (of("radius = 1.0", "radius = 1e-320"), "s.toml:34:10: objects.ball.radius: 1e-320"),
        (of("radius = 1.0", "radius = 1e308"), "s.toml:34:10: objects.ball.radius: 1e308"),
        (of("eye = [0.0, 1.0, 5.0]", "eye = [0, 0, 0]"), "s.toml:7:10: camera.target"),
        (of("[0.0, 0.0, 0.0]", "[0, 0, 0]\nup = [0, 1, 5]"), "s.toml:8:6: camera.up"),
        (of("size = 1.5", "size = []"), "s.toml:23:8: lights.key.size"),
        (of("name = \"block\"", "name = \"ball\""), "s.toml:37:8: objects.ball.name"),
        (BALL.replace('\n', "\r"), "s.toml:1:10: not TOML"),
        (format!("{BALL}# \u{7f}\n"), "s.toml:42:3: not TOML"),
        (format!("x = {}", "[".repeat(100_000)), "s.toml:1:21: not a scene: nested too deeply"),
        (format!("x = {}", "[{a=".repeat(50_000)), "s.toml:1:37: not a scene: nested too deeply"),
        (format!("[{}a]", "a.".repeat(100_000)), "s.toml:1:19: not a scene: nested too deeply"),
    ] {
        let error = opened(&place, "s.toml", text.as_bytes(), says).expect_err(says);
        assert!(error.contains(says), "{error} does not say {says}");
    }
}

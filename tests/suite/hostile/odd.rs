//! Files that other programs save, and files that want to be more than they are.

use super::opened;
use crate::cli::{BALL, MESH, Place};

fn utf16(text: &str, bytes_of: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes_of).collect()
}

#[test]
fn other_encodings_load_or_are_refused_by_place() {
    let place = Place::with_mesh();
    for (name, text) in [("s.toml", BALL), ("m.obj", MESH)] {
        for (what, same) in [
            ("a mark at the start", format!("\u{feff}{text}")),
            ("lines as on Windows", text.replace('\n', "\r\n")),
            ("both", format!("\u{feff}{}", text.replace('\n', "\r\n"))),
        ] {
            let loaded = opened(&place, name, same.as_bytes(), what);
            assert!(loaded.is_ok(), "{name}, {what}: {:?}", loaded.err());
        }
        let marked = format!("\u{feff}{text}");
        for (what, bytes) in [
            ("UTF-16, low byte first", utf16(&marked, u16::to_le_bytes)),
            ("UTF-16, high byte first", utf16(&marked, u16::to_be_bytes)),
            ("UTF-16 without a mark", utf16(text, u16::to_le_bytes)),
            ("UTF-32", marked.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect()),
        ] {
            let error = opened(&place, name, &bytes, what).expect_err(what);
            let is_placed = error.contains("s.toml:1:") || error.contains("m.obj: line 1");
            assert!(is_placed, "{what}: {error}");
        }
    }
    let latin = [BALL.as_bytes(), b"# caf\xe9\n"].concat();
    let error = opened(&place, "s.toml", &latin, "Latin-1").expect_err("Latin-1");
    assert!(error.contains("s.toml:42:6: byte 0xe9 is not UTF-8"), "{error}");
}

/// A library is never a reason to refuse a mesh; what it names is read as what it should be, or
/// not at all.
#[test]
fn libraries_that_climb_out_are_passed_over_with_a_warning() {
    let place = Place::with_mesh();
    for library in [
        "../../../../../../../../etc/passwd",
        "/etc/passwd",
        "/dev/zero",
        "/proc/self/mem",
        "/proc/kmsg",
        ".",
        "m.obj",
    ] {
        let mesh = MESH.replace("m.mtl", library);
        let loaded = opened(&place, "n.obj", mesh.as_bytes(), library).expect(library);
        assert!(!loaded.report.is_empty(), "{library}: nothing is told");
        place.write("m.mtl", format!("newmtl red\nKd 1 0 0\nmap_Kd {library}\n").as_bytes());
        let loaded = opened(&place, "m.obj", MESH.as_bytes(), library).expect(library);
        let is_told = loaded.report.iter().any(|line| line.contains("map_Kd"));
        assert!(is_told, "{library}: {:?}", loaded.report);
    }
}

#[test]
fn a_scene_file_of_gigabytes_is_refused_by_its_length() {
    let place = Place::new();
    let file = std::fs::File::create(place.path("s.toml")).unwrap();
    file.set_len(3 << 30).unwrap();
    let error = super::open(place.path("s.toml"), "3 GiB").expect_err("3 GiB");
    assert!(error.contains("3072 MiB long; at most 8 MiB"), "{error}");
}

#[test]
fn files_of_another_kind_are_told_what_can_be_opened() {
    let place = Place::new();
    for (name, bytes) in [
        ("photo.jpg", &b"\xff\xd8\xff\xe0\0\x10JFIF"[..]),
        ("scene", b"\x7fELF\x02\xf0"),
        ("archive.zip", b"PK\x03\x04\x80\xff"),
    ] {
        let error = opened(&place, name, bytes, name).expect_err(name);
        assert!(error.contains(name) && error.contains(".toml, .obj or .png"), "{error}");
    }
}

/// The decoder quotes some of its words.
#[test]
fn what_a_decoder_says_is_no_riddle() {
    let place = Place::with_mesh();
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/color.jpg");
    let picture = std::fs::read(data).unwrap();
    let arithmetic: Vec<u8> = picture
        .iter()
        .enumerate()
        .map(|(at, byte)| if *byte == 0xc0 && picture[at - 1] == 0xff { 0xc9 } else { *byte })
        .collect();
    place.write("i.jpg", &arithmetic);
    let scene = format!("{BALL}[[textures]]\nname = \"t\"\ntype = \"image\"\nfile = \"i.jpg\"\n");
    let error = opened(&place, "s.toml", scene.as_bytes(), "i.jpg").expect_err("i.jpg");
    assert!(error.contains("JPEG") && !error.contains(['\\', '"']), "{error}");
}

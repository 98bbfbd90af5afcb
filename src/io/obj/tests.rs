//! What the reader accepts, what it refuses and with which words, and how it agrees with tobj.

mod real;

use glam::{Vec3, vec2, vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use std::cell::RefCell;
use std::sync::atomic::AtomicBool;

use super::reader::MAX_MATERIALS;
use super::*;
use crate::geometry::mesh::ABSENT;

fn parse(bytes: &[u8]) -> Result<ObjFile, ObjError> {
    super::parse(bytes, &AtomicBool::new(false))
}

fn read(text: &str) -> ObjFile {
    parse(text.as_bytes()).unwrap_or_else(|error| panic!("{text:?}: {error}"))
}

/// A triangle's lines, before which others may stand.
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn a_triangle_is_read() {
    let file = read(TRIANGLE);
    assert_eq!(file.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(file.triangles, [[0, 1, 2]]);
    assert_eq!(file.slot_names, [None]);
    assert_eq!(file.n_faces, 1);
    assert!(file.uv_ids.is_empty() && file.normal_ids.is_empty() && file.slots.is_empty());
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
}

#[test]
fn all_spellings_of_a_line_mean_the_same() {
    let expected = read(TRIANGLE);
    let spellings = [
        "\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3",
        "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
        "v 0 \\\n0 0\nv 1 0 0\nv\\\r\n0 1\\\r0\nf 1 \\\n 2\\\n3",
        "\t v\t0  0\t0 \nv 1 0 0 \x0b\n\n \n  v 0 1 0\t\nf\t1\t2 3 \t",
        "# a \\\nv 0 0 0 # b\nv 1 0 0\n#c\nv 0 1 0\nf 1 2 3 #",
        "v 0 0 0 0.1 0.2 0.3\nv 1 0 0 1 1 1 1\nv 0 1 0 9 9 9 9 9\nf 1 2 3",
        "v 0 0 0 1\nv 2 0 0 2\nv 0 -1 0 -1\nf 1 2 3",
        "v 0 0 0\nv 1. +0 -0.0\nv 0e5 1E0 0\nf -3 -2 -1",
        "g a\no b\ns off\np 1\nl 1 2\nv 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\nf 1/ 2// 3",
        "curv 0 1 \\\n v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 +3",
    ];
    for text in spellings {
        let file = read(text);
        assert_eq!(file.positions, expected.positions, "{text:?}");
        assert_eq!(file.triangles, expected.triangles, "{text:?}");
        assert!(file.warnings.is_empty(), "{text:?}: {:?}", file.warnings);
    }
}

#[test]
fn the_forms_of_corners_mix_within_a_face() {
    let file = read(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5\nvt 0.25 0.75 9\nvn 0 0 2\nvn 0 3 4\n\
         f 1 2 3\nf 1 2/2 3//2 4/-2/-1\n",
    );
    assert_eq!(file.uvs, [vec2(0.5, 0.0), vec2(0.25, 0.75)]);
    assert_eq!(file.normals, [Vec3::Z, vec3(0.0, 0.6, 0.8)]);
    assert_eq!(file.triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
    assert_eq!(file.uv_ids, [[ABSENT; 3], [ABSENT, 1, ABSENT], [ABSENT, ABSENT, 0]]);
    assert_eq!(file.normal_ids, [[ABSENT; 3], [ABSENT, ABSENT, 1], [ABSENT, 1, 1]]);
    assert_eq!(file.n_faces, 2);
}

#[test]
fn negative_indices_count_from_the_face_backwards() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -2 -1\n";
    assert_eq!(read(text).triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn slots_are_in_order_of_first_use_by_a_face() {
    let text = format!(
        "{TRIANGLE}usemtl unused\nusemtl Material #25 \nf 1 2 3\nusemtl b\nf 1 2 3 1\n\
         usemtl Material #25\nf 1 2 3\nusemtl\nf 3 2 1\n"
    );
    let file = read(&text);
    assert_eq!(file.slot_names, [None, Some("Material #25".into()), Some("b".into())]);
    assert_eq!(file.slots, [0, 1, 2, 2, 1, 0]);
}

#[test]
fn one_slot_needs_no_array() {
    let file = read(&format!("usemtl a\n{TRIANGLE}"));
    assert_eq!(file.slot_names, [Some("a".into())]);
    assert!(file.slots.is_empty());
}

#[test]
fn libraries_may_be_several_and_hold_blanks() {
    let text = format!(
        "mtllib a.mtl\nmtllib a.mtl two words.MTL\tc.mtl \r\nmtllib d.mtl.old e\n{TRIANGLE}"
    );
    let expected = ["a.mtl", "two words.MTL", "c.mtl", "d.mtl.old e"];
    assert_eq!(read(&text).libraries, expected);
}

#[test]
fn libraries_without_end_are_cut_off() {
    let lines: String = (0..5000).map(|i| format!("mtllib {i}.mtl\n")).collect();
    let file = read(&(lines + TRIANGLE));
    assert_eq!(file.libraries.len(), 100);
    assert_eq!(file.warnings, ["only the first 100 material libraries are read"]);
}

#[test]
fn zero_normals_are_absent_and_told() {
    let file = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nvn 0 0 0\nf 1//1 2//2 3//1\n");
    assert_eq!(file.normal_ids, [[0, ABSENT, 0]]);
    assert!(file.normals.iter().all(|n| n.length() == 1.0));
    assert_eq!(file.warnings, ["line 5: `vn` has no direction; normals left out: 1"]);
}

#[test]
fn tiny_and_huge_normals_have_unit_length() {
    let file = read(&format!("vn 1e-44 0 0\nvn 0 3e38 3e38\n{TRIANGLE}"));
    for normal in file.normals {
        assert!((normal.length() - 1.0).abs() < 1e-6, "{normal}");
    }
}

#[test]
fn triangles_without_area_load_and_are_told() {
    let file = read("v 0 0 0\nv 1 1 1\nv 2 2 2\nv 0 1 0\nf 1 2 3\nf 1 1 4\nf 1 2 4\n");
    assert_eq!(file.triangles.len(), 3);
    assert_eq!(file.warnings, ["2 of 3 triangles have no area and cannot be seen"]);
}

#[test]
fn unknown_keywords_are_passed_over_and_told() {
    let file = read(&format!("solid x\nfacet\nä 1\n{TRIANGLE}"));
    assert_eq!(file.warnings, ["line 1: `solid` is not known; lines passed over: 3"]);
}

#[test]
fn every_mistake_is_named_with_its_line() {
    let cases: &[(&str, &str)] = &[
        ("", "no triangles: the file has no `f` lines"),
        ("v 0 0 0\n", "no triangles"),
        ("solid cube\nfacet\n", "no `f` lines (line 1 starts with `solid`"),
        ("\u{1}\u{2}\n", "line 1: `\\u{1}\\u{2}` is not text"),
        ("# a\n\0\0\0", "line 2: `\\0\\0\\0` is not text"),
        ("v 0 0\n", "line 1: `v` has 2 numbers; expected 3 numbers, 4 with"),
        ("v\n", "line 1: `v` has 0 numbers"),
        ("v 0 0 0 1 1\n", "line 1: `v` has 5 numbers"),
        ("v 1 2 3 4 5 6 7 8 9\n", "line 1: `v` has more than 8 numbers"),
        ("\n\nv 0 0 x\n", "line 3: `x` is not a number"),
        ("v 0 0 1_0\n", "line 1: `1_0` is not a number"),
        ("v 0 0 0x10\n", "line 1: `0x10` is not a number"),
        ("v 0 0 1,5\n", "line 1: `1,5` is not a number"),
        ("v 0 0 0 red\n", "line 1: `red` is not a number"),
        ("v 0 0 \u{1b}[31m\n", "line 1: `\\u{1b}[31m` is not a number"),
        ("v nan 0 0\n", "line 1: `nan` is not a finite number"),
        ("v 0 -inf 0\n", "line 1: `-inf` is not a finite number"),
        ("v 0 0 1e999\n", "line 1: `1e999` is not a finite number"),
        ("v 0 0 0 nan nan nan\n", "line 1: `nan` is not a finite number"),
        ("v 0 0 2e12\n", "line 1: coordinate `2e12` is out of range"),
        ("v 0 0 -1e30\n", "line 1: coordinate `-1e30` is out of range"),
        ("v 0 0 1 1e-30\n", "line 1: coordinate `1e30` is out of range"),
        ("v 0 0 0 0\n", "line 1: the fourth number of `v`, its weight, is 0"),
        ("v 0 0 0 -0.0\n", "line 1: the fourth number of `v`"),
        ("vt\n", "line 1: `vt` has no number; expected 1 to 3"),
        ("vt 1 2 3 4\n", "line 1: `vt` has more than 3 numbers"),
        ("vt inf\n", "line 1: `inf` is not a finite number"),
        ("vt 1e30\n", "line 1: coordinate `1e30` is out of range"),
        ("vn 1 0\n", "line 1: `vn` has 2 numbers; expected 3"),
        ("vn 1 0 0 0\n", "line 1: `vn` has more than 3 numbers"),
        ("vn nan 0 0\n", "line 1: `nan` is not a finite number"),
        ("v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3: `f` has 2 corners; expected 3 or more"),
        ("f\n", "line 1: `f` has 0 corners"),
        ("v 0 0 0\nf 1 1 2\n", "line 2: `2` uses vertex 2, but only 1 are defined above it"),
        ("v 0 0 0\nf 1 1 -2\n", "line 2: `-2` uses vertex -2, but only 1 are defined"),
        ("f 1 2 3\nv 0 0 0\nv 0 0 0\nv 0 0 0\n", "line 1: `1` uses vertex 1, but only 0"),
        ("v 0 0 0\nf 1/1 1 1\n", "line 2: `1/1` uses texture coordinate 1, but only 0 are"),
        ("v 0 0 0\nvn 0 0 1\nf 1 1//-2 1\n", "line 3: `1//-2` uses normal -2, but only 1"),
        ("v 0 0 0\nf 0 1 1\n", "line 2: `0` has index 0; they count from 1"),
        ("v 0 0 0\nf 1 1/0 1\n", "line 2: `1/0` has index 0"),
        ("v 0 0 0\nf 1 1 4294967297\n", "line 2: `4294967297` uses vertex 4294967297, but"),
        ("v 0 0 0\nf 1 1 99999999999999999999\n", "line 2: `99999999999999999999` uses vertex"),
        ("v 0 0 0\nf 1 1 x\n", "line 2: `x` is not a corner of a face; expected 1, 1/2"),
        ("v 0 0 0\nf 1 1 1.5\n", "line 2: `1.5` is not a corner"),
        ("v 0 0 0\nf 1 1 /1\n", "line 2: `/1` is not a corner"),
        ("v 0 0 0\nf 1 1 1/1/1/1\n", "line 2: `1/1/1/1` is not a corner"),
        ("v 0 0 0\nf 1 1 - 1\n", "line 2: `-` is not a corner"),
        ("v 0 0 0\nf 1 \\\n1 y\n", "line 3: `y` is not a corner"),
        ("v 0 0 0\rv 0 0\r", "line 2: `v` has 2 numbers"),
        ("v 0 0 0\r\nv 0 0\r\n", "line 2: `v` has 2 numbers"),
    ];
    for (text, fragment) in cases {
        let message = parse(text.as_bytes()).expect_err(text).to_string();
        assert!(message.contains(fragment), "{text:?}: {message:?} lacks {fragment:?}");
    }
}

#[test]
fn files_of_other_kinds_are_named_as_such() {
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    let message = parse(png).unwrap_err().to_string();
    assert_eq!(message, "line 1: `\\x89PNG` is not text; is this a Wavefront OBJ file?");
    let utf16: Vec<u8> = "\u{feff}v 0 0 0\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(matches!(parse(&utf16), Err(ObjError::NotText { line: 1, .. })));
}

#[test]
fn long_tokens_are_shortened_in_messages() {
    let text = format!("v 0 0 {}\n", "x".repeat(100_000));
    let message = parse(text.as_bytes()).unwrap_err().to_string();
    assert!(message.len() < 100, "{message}");
}

#[test]
fn concave_polygons_are_cut_by_ears() {
    let text = "v 1 1 0\nv 0 4 0\nv 0 0 0\nv 4 0 0\nf 2 3 4 1\nf 1 2 3 4\n";
    // The notch is the first vertex: the cut goes from there, wherever the face begins.
    assert_eq!(read(text).triangles, [[0, 1, 2], [2, 3, 0], [0, 1, 2], [2, 3, 0]]);
}

#[test]
fn a_mesh_has_the_normals_that_were_asked_for() {
    let text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2//1 3//1\n";
    let load = |kind| load_mesh(text.as_bytes(), kind, 180.0, &AtomicBool::new(false)).unwrap();
    let (mesh, notes) = load(NormalsKind::File);
    assert_eq!((mesh.normals[0], mesh.normal_ids[0]), (Vec3::X, [0; 3]));
    assert_eq!(notes.libraries, ["m.mtl"]);
    let (mesh, _) = load(NormalsKind::Smooth);
    assert_eq!(mesh.normal_ids[0].map(|id| mesh.normals[id as usize]), [Vec3::Z; 3]);
    let (mesh, _) = load(NormalsKind::Flat);
    assert!(mesh.normals.is_empty() && mesh.normal_ids.is_empty());
}

/// A valid file of every kind of line, to be broken.
const VALID: &str = "\u{feff}mtllib a.mtl\r\n# c\nv 0 0 0\nv 1 0 0 1\nv 1 1.5e0 0 .1 .2 .3\nv 0 1 0\n\
    vt 0 1\nvn 0 0 1\nusemtl m\nf 1 2 3 4\nf 1/1 2/-1/1 \\\n 3//1\ns 1\nl 1 2\nf -1 -2 -3 -4 1\n";

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse(&bytes);
    }

    #[test]
    fn no_text_makes_it_panic(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "v ", "vt ", "vn ", "f ", "usemtl ", "mtllib ", "\n", "\r", "\\\n", "\\", "#", "/",
                "1 ", "-1", "2/", "3//1 ", "0.5 ", "1e", "nan ", "9999999999999999999999 ", "\t", "é",
            ]), 0..60),
    ) {
        let _ = parse(words.concat().as_bytes());
    }

    #[test]
    fn broken_files_give_a_mesh_or_an_error(
        edits in prop::collection::vec((0usize..VALID.len(), any::<u8>()), 0..6),
        cut in 0usize..VALID.len(),
    ) {
        let mut bytes = VALID.as_bytes().to_vec();
        for (at, byte) in edits {
            bytes[at] = byte;
        }
        bytes.truncate(cut.max(100));
        if let Ok((mesh, _)) = load_mesh(&bytes, NormalsKind::File, 60.0, &AtomicBool::new(false)) {
            let within = |ids: &[[u32; 3]], n: usize| {
                ids.as_flattened().iter().all(|id| *id == ABSENT || (*id as usize) < n)
            };
            prop_assert!(within(&mesh.triangles, mesh.positions.len()));
            prop_assert!(within(&mesh.uv_ids, mesh.uvs.len()));
            prop_assert!(within(&mesh.normal_ids, mesh.normals.len()));
            prop_assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
        }
    }
}

#[test]
fn a_file_is_given_up_at_once_when_nobody_wants_it() {
    let stopped = super::parse(TRIANGLE.as_bytes(), &AtomicBool::new(true));
    assert_eq!(stopped, Err(ObjError::Cancelled), "it was read to its end");
    let read = read(TRIANGLE).into_mesh(NormalsKind::Smooth, 40.0, &AtomicBool::new(true));
    assert_eq!(read.unwrap_err(), ObjError::Cancelled, "it got its normals");
}

/// The square is named again and again: nine million triangles by two bytes each.
#[test]
fn small_files_of_very_many_triangles_are_refused() {
    let face = |n: usize| format!("f{}\n", " 1 2 3 4".repeat(n));
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let parse_at_most = |max_triangles, text: &str| {
        let stop = AtomicBool::new(false);
        let mut reader = Reader::new(text.as_bytes(), (&stop).into());
        reader.max_triangles = max_triangles;
        reader.read()
    };
    let text = format!("{corners}{}{}", face(1), face(3));
    assert_eq!(parse_at_most(12, &text).unwrap().triangles.len(), 12, "2 and 10");
    let refused = parse_at_most(11, &text).unwrap_err().to_string();
    let words = "line 6: more than 11 triangles in a file of its length; a mesh of that size is \
                 not supported";
    assert_eq!(refused, words);
    assert_eq!(most_triangles(40_000_000), 1 << 23, "the least");
    assert_eq!(most_triangles(391_000_000), 48_875_000, "where a grid of 10 million is a file");
}

#[test]
fn more_materials_than_anybody_has_are_refused() {
    let faces: String = (0..=MAX_MATERIALS).map(|i| format!("usemtl {i}\nf 1 1 1\n")).collect();
    let refused = parse(format!("v 0 0 0\n{faces}").as_bytes()).unwrap_err().to_string();
    let line = 2 * MAX_MATERIALS + 3;
    assert!(
        refused.starts_with(&format!("line {line}: more than 1048576 materials;")),
        "{refused}"
    );
}

#[test]
fn how_far_it_is_is_told_every_few_megabytes() {
    let bytes = [TRIANGLE.as_bytes(), &vec![b'\n'; 10 << 20]].concat();
    let (never, steps) = (AtomicBool::new(false), RefCell::new(Vec::new()));
    let told = |step| steps.borrow_mut().push(step);
    load_mesh(&bytes, NormalsKind::Flat, 0.0, Watch::new(&never, &told)).unwrap();
    let steps = steps.into_inner();
    let [Step::Reading(first), Step::Reading(second), Step::Normals] = steps[..] else {
        panic!("told {steps:?}");
    };
    assert!((first - 0.4).abs() < 0.01 && (second - 0.8).abs() < 0.01, "told {steps:?}");
}

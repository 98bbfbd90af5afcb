//! `penumbra info`: counts and bounds.

use serde_json::{Value, json};

use super::{Place, keys};

fn info(place: &Place, file: &str) -> Value {
    place.ok(&["info", file, "--json"]).json()
}

/// Asserts bounds to within what single precision rounds.
fn assert_bounds(info: &Value, min: [f64; 3], max: [f64; 3]) {
    for (key, expected) in [("min", min), ("max", max)] {
        let found = info["bounds"][key].as_array().unwrap_or_else(|| panic!("{info}"));
        for (x, wanted) in found.iter().map(|x| x.as_f64().unwrap()).zip(expected) {
            let tolerance = 1e-6 * wanted.abs().max(1.0);
            assert!((x - wanted).abs() < tolerance, "{key}: {found:?}, not {expected:?}");
        }
    }
}

#[test]
fn counts_and_bounds_are_those_of_the_file() {
    let place = Place::with_ball();
    let info = info(&place, "ball.toml");
    let expected =
        ["accelerator", "bounds", "lights", "materials", "objects", "triangles", "vertices"];
    assert_eq!(keys(&info), expected, "keys");
    for (key, n) in
        [("vertices", 0), ("triangles", 0), ("materials", 2), ("objects", 2), ("lights", 2)]
    {
        assert_eq!(info[key], json!(n), "{key}");
    }
    assert!(info["accelerator"].is_object(), "accelerator");
    assert_eq!(info["bounds"]["min"], json!([-1.0, -1.0, -1.0]), "exactly");
    assert_eq!(info["bounds"]["max"], json!([1.5, 1.0, 1.0]), "exactly");
}

#[test]
fn polygons_are_n_minus_2_triangles_and_unused_vertices_count() {
    let place = Place::with(&[(
        "m.obj",
        "v 0 0 0\nv 2 0 0\nv 2.1 1 0\nv 1 2 0\nv 0 1 0\nv 99 99 99\nf 1 2 3 4 5\nf 1 2 3\n",
    )]);
    let info = info(&place, "m.obj");
    assert_eq!([&info["vertices"], &info["triangles"]], [6, 4], "counts");
    assert_eq!(info["bounds"], json!({ "min": [0.0, 0.0, 0.0], "max": [2.1, 2.0, 0.0] }), "bounds");
}

#[test]
fn a_file_used_twice_counts_twice_and_what_is_disabled_not_at_all() {
    let place = Place::with_mesh();
    let object = |name: &str, more: &str| {
        format!("[[objects]]\nname = \"{name}\"\ntype = \"mesh\"\nfile = \"m.obj\"\n{more}")
    };
    let scene = [
        "camera = { eye = [0, 0, 5], target = [0, 0, 0] }\n",
        &object("a", ""),
        &object("b", "translate = [10, 0, 0]\n"),
        &object("c", "translate = [99, 0, 0]\nenabled = false\n"),
        "[[lights]]\ntype = \"sun\"\nposition = [0, 1, 0]\npower = [1, 1, 1]\nenabled = false\n",
    ]
    .concat();
    place.write("s.toml", scene.as_bytes());
    let info = info(&place, "s.toml");
    for (key, n) in [("vertices", 10), ("triangles", 6), ("objects", 2), ("lights", 0)] {
        assert_eq!(info[key], json!(n), "{key}");
    }
    assert_bounds(&info, [-1.0, 0.0, -1.0], [11.0, 2.0, 1.0]);
}

#[test]
fn bounds_follow_the_points_of_turned_and_scaled_meshes() {
    let place = Place::with(&[("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")]);
    let scene = |more: &str| {
        format!(
            "camera = {{ eye = [0, 0, 5], target = [0, 0, 0] }}\n[[objects]]\ntype = \"mesh\"\n\
             file = \"t.obj\"\n{more}"
        )
    };
    let half = 0.5_f64.sqrt();
    // A box around the turned box would reach from -half to half * 2.
    place.write("s.toml", scene("rotate = [0, 0, 45]\n").as_bytes());
    assert_bounds(&info(&place, "s.toml"), [-half, 0.0, 0.0], [half, half, 0.0]);
    place.write(
        "s.toml",
        scene("rotate = [90, 0, 90]\nscale = [2, -3, 1]\ntranslate = [5, 6, 7]\n").as_bytes(),
    );
    // (1, 0, 0) -> (2, 0, 0) -> x by X90 stays -> by Z90 (0, 2, 0); (0, 1, 0) -> (0, -3, 0)
    // -> by X90 (0, 0, -3) -> stays.
    assert_bounds(&info(&place, "s.toml"), [5.0, 6.0, 4.0], [5.0, 8.0, 7.0]);
}

#[test]
fn bounds_of_solids_are_exact() {
    let place = Place::new();
    let scene = |object: &str| {
        format!("camera = {{ eye = [0, 0, 5], target = [0, 0, 0] }}\n[[objects]]\n{object}\n")
    };
    let reach = 0.5_f64.sqrt();
    for (object, min, max) in [
        ("type = 'sphere'\ncenter = [1, 2, 3]\nradius = 0.5", [0.5, 1.5, 2.5], [1.5, 2.5, 3.5]),
        (
            "type = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nrotate = [10, 20, 30]",
            [-1.0; 3],
            [1.0; 3],
        ),
        (
            "type = 'cylinder'\nbase = [0, 0, 0]\ntop = [1, 1, 0]\nradius = 1",
            [-reach, -reach, -1.0],
            [1.0 + reach, 1.0 + reach, 1.0],
        ),
        (
            "type = 'cone'\nbase = [0, 0, 0]\ntip = [0, 3, 0]\nradius = 2\nrotate = [0, 0, 90]",
            [-3.0, -2.0, -2.0],
            [0.0, 2.0, 2.0],
        ),
        (
            "type = 'box'\nmin = [0, 0, 0]\nmax = [1, 2, 3]\nrotate = [0, 90, 0]",
            [0.0, 0.0, -1.0],
            [3.0, 2.0, 0.0],
        ),
    ] {
        place.write("s.toml", scene(object).as_bytes());
        assert_bounds(&info(&place, "s.toml"), min, max);
    }
}

#[test]
fn planes_have_no_bounds() {
    let place = Place::with(&[(
        "s.toml",
        "camera = { eye = [0, 0, 5], target = [0, 0, 0] }\n[[objects]]\ntype = 'plane'\n\
         point = [0, 0, 0]\nnormal = [0, 1, 0]\n",
    )]);
    assert_eq!(info(&place, "s.toml")["bounds"], Value::Null, "a plane");
    place.write("s.toml", b"camera = { eye = [0, 0, 5], target = [0, 0, 0] }\n");
    assert_eq!(info(&place, "s.toml")["bounds"], Value::Null, "an empty scene");
    assert!(place.ok(&["info", "s.toml"]).stdout.contains("none"), "in words");
}

#[test]
fn words_and_json_say_the_same_of_scenes_meshes_and_snapshots() {
    let place = Place::with_mesh();
    place.ok(&["render", "m.obj", "-o", "shot.png", "-s", "1", "--width", "8", "--height", "8"]);
    let mesh = info(&place, "m.obj");
    let shot = info(&place, "shot.png");
    for key in ["vertices", "triangles", "materials", "objects", "lights", "bounds"] {
        assert_eq!(mesh[key], shot[key], "{key}");
    }
    assert_eq!([&mesh["vertices"], &mesh["triangles"], &mesh["materials"]], [5, 3, 2], "mesh");
    let words = place.ok(&["info", "m.obj"]).stdout;
    assert!(words.contains("vertices     5\ntriangles    3\n"), "{words}");
}

/// Such a mesh can be looked at; a scene or a snapshot saved of it would not find it again.
#[cfg(target_os = "linux")]
#[test]
fn a_mesh_whose_name_no_scene_can_hold_is_told() {
    use std::os::unix::ffi::OsStrExt;
    let place = Place::with_mesh();
    let name = std::ffi::OsStr::from_bytes(b"m\xff.obj");
    std::fs::rename(place.path("m.obj"), place.path("").join(name)).unwrap();
    let run = super::Run::of(place.command().arg("info").arg(name));
    let expected = "warning: m\u{fffd}.obj: its name is no UTF-8, so that no saved scene or snapshot can find \
         it; give it another name first\n";
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), expected), "{}", run.stdout);
}

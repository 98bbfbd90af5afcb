//! `penumbra render`: what it writes, and what its options mean.

use penumbra::color::Picture;
use penumbra::scene::description::{ToneMappingDescription, ToneOperator};
use penumbra::tone_mapping::srgb_bytes;

use super::{Place, Png, keys, linear};

fn picture(place: &Place, name: &str) -> Picture {
    let image = linear(&place.path(name));
    let pixels = image.pixels().map(|pixel| pixel.0).collect();
    Picture { width: image.width(), height: image.height(), pixels }
}

#[test]
fn png_exr_and_hdr_hold_the_same_picture() {
    let place = Place::with_ball();
    let set = "tone_mapping.exposure=0.7";
    for operator in
        [ToneOperator::Linear, ToneOperator::Reinhard, ToneOperator::Aces, ToneOperator::Agx]
    {
        let name = format!("{operator:?}").to_lowercase();
        let operator_set = format!("tone_mapping.operator={name}");
        let options = ["--set", set, "--set", &operator_set];
        let png = Png::read(&place.ball_png("a.png", &options));
        place.ball_png("a.exr", &options);
        let exr = picture(&place, "a.exr");
        let tone_mapping = ToneMappingDescription { exposure: 0.7, operator };
        assert_eq!((png.width, png.height), (16, 9), "size");
        assert_eq!(png.pixels, srgb_bytes(&exr, &tone_mapping), "{name}");
        let darkest = png.pixels.iter().min();
        assert_ne!(darkest, png.pixels.iter().max(), "{name} shows nothing");
    }
    place.ball_png("a.hdr", &[]);
    let (exr, hdr) = (picture(&place, "a.exr"), picture(&place, "a.hdr"));
    for (a, b) in exr.pixels.iter().zip(&hdr.pixels) {
        let brightest = a.iter().copied().fold(0.0, f32::max);
        for (x, y) in a.iter().zip(b) {
            assert!((x - y).abs() <= brightest / 128.0, "{x} in EXR, {y} in HDR");
        }
    }
}

#[test]
fn linear_pngs_are_the_rounded_transfer_function_of_the_exr() {
    let place = Place::with_ball();
    let png = Png::read(&place.ball_png("a.png", &["--set", "tone_mapping.operator=linear"]));
    place.ball_png("a.exr", &[]);
    let exr = picture(&place, "a.exr");
    for (byte, x) in png.pixels.iter().zip(exr.pixels.as_flattened()) {
        let x = f64::from(*x).clamp(0.0, 1.0);
        let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        assert!((f64::from(*byte) - 255.0 * encoded).abs() < 0.501, "{byte} for {x}");
    }
}

#[test]
fn rows_go_down_and_columns_to_the_right() {
    let place = Place::with_ball();
    let red_top_left = [
        "--set",
        "objects.ball.center=[-1.5, 1.2, 0]",
        "--set",
        "objects.ball.radius=0.4",
        "--set",
        "objects.block.enabled=false",
    ];
    place.ball_png("a.exr", &red_top_left);
    let exr = linear(&place.path("a.exr"));
    let difference = |x: u32, y: u32| {
        let [r, _, b] = exr.get_pixel(x, y).0;
        r - b
    };
    let middle_of = |xs: std::ops::Range<u32>, ys: std::ops::Range<u32>| {
        ys.flat_map(|y| xs.clone().map(move |x| (x, y))).map(|(x, y)| difference(x, y)).sum::<f32>()
    };
    let top_left = middle_of(0..8, 0..4);
    for other in [middle_of(8..16, 0..4), middle_of(0..8, 5..9), middle_of(8..16, 5..9)] {
        assert!(top_left > other + 0.1, "top left {top_left}, elsewhere {other}");
    }
}

#[test]
fn outputs_hold_no_trace_of_when_and_how_they_were_made() {
    let place = Place::with_ball();
    for ending in ["png", "exr", "hdr"] {
        let out = |name: &str| format!("{name}.{ending}");
        let first = place.ball_png(&out("first"), &["-t", "1"]);
        for (i, options) in [
            &["-t", "2"][..],
            &["--threads", "5"],
            &["--accelerator", "kd-midpoint"],
            &["--accelerator", "brute-force", "--quiet"],
            &["--accelerator", "kd-tree", "--json"],
            &["-s", "4", "--width", "16", "--height", "9", "--seed", "0"],
            &["--set", "render.samples=4"],
        ]
        .iter()
        .enumerate()
        {
            let again = place.ball_png(&out(&format!("again-{i}")), options);
            assert_eq!(first, again, "{ending} with {options:?}");
        }
    }
}

#[test]
fn meshes_glass_and_paths_are_the_same_for_every_thread_and_accelerator() {
    let place = Place::with_mesh();
    let mesh = "[[objects]]\nname = \"mesh\"\ntype = \"mesh\"\nfile = \"m.obj\"\nnormals = \"smooth\"\n\
        rotate = [10, 20, 30]\n[[objects]]\ntype = \"plane\"\npoint = [0, -1, 0]\nnormal = [0, 1, 0]\n";
    place.write("ball.toml", format!("{}{mesh}", super::BALL).as_bytes());
    for set in ["render.integrator=path", "render.sampler=random"] {
        let first = place.ball_png("a.exr", &["-t", "1", "--set", set]);
        for accelerator in ["kd-tree", "kd-midpoint", "brute-force"] {
            let options = ["-t", "2", "--set", set, "--accelerator", accelerator];
            assert_eq!(first, place.ball_png("b.exr", &options), "{set} with {accelerator}");
        }
    }
}

#[test]
fn options_win_over_set_and_set_over_the_file() {
    let place = Place::with_ball();
    let sets = [
        "--set",
        "render.width=5",
        "--set",
        "render.height=6",
        "--set",
        "render.samples=7",
        "--set",
        "render.seed=8",
    ];
    let by_set = place.ok(&[&["render", "ball.toml", "-o", "a.png", "--json"], &sets[..]].concat());
    let size = |run: &super::Run| {
        let json = run.json();
        ["width", "height", "samples"].map(|key| json[key].as_u64().unwrap())
    };
    assert_eq!(size(&by_set), [5, 6, 7], "set");
    let options = ["--width", "3", "--height", "4", "--samples", "2", "--seed", "9"];
    let command = [&["render", "ball.toml", "-o", "b.png", "--json"], &options[..], &sets].concat();
    assert_eq!(size(&place.ok(&command)), [3, 4, 2], "options");
    let record = Png::read(&place.read("b.png"));
    let record: serde_json::Value = serde_json::from_str(record.text("penumbra:render")).unwrap();
    assert_eq!(record["seed"], 9, "seed");
    let twice = ["--set", "render.width=5", "--set", "render.width=6"];
    let run = place.ok(&[&["render", "ball.toml", "-o", "a.png", "--json"], &twice[..]].concat());
    assert_eq!(size(&run)[0], 6, "the last of two");
}

#[test]
fn a_set_heals_a_wrong_value_of_the_file() {
    let place = Place::with(&[("ball.toml", &super::BALL.replace("radius = 1.0", "radius = -1"))]);
    place.fails(1, &["render", "ball.toml", "-o", "a.png"]);
    place.ball_png("a.png", &["--set", "objects.ball.radius=1"]);
}

#[test]
fn the_seed_changes_the_noise_only() {
    let place = Place::with_ball();
    let [a, b] = ["1", "2"].map(|seed| {
        let name = format!("{seed}.exr");
        place.ball_png(&name, &["--seed", seed, "-s", "64"]);
        picture(&place, &name)
    });
    assert_ne!(a, b, "seeds 1 and 2");
    let mean = |p: &Picture| p.pixels.as_flattened().iter().sum::<f32>() / p.pixels.len() as f32;
    assert!((mean(&a) / mean(&b) - 1.0).abs() < 0.02, "{} and {}", mean(&a), mean(&b));
}

#[test]
fn time_and_noise_end_a_render_at_a_whole_pass_and_leave_no_trace() {
    let place = Place::with_ball();
    let json = |options: &[&str]| {
        let set = "render.samples=1000";
        let command = ["render", "ball.toml", "-o", "a.png", "--set", set, "--json"];
        place.ok(&[&command, options].concat()).json()
    };
    assert_eq!(json(&["--time", "1e-9"])["samples"], 1, "one pass");
    assert_eq!(place.read("a.png"), place.ball_png("b.png", &["-s", "1"]), "as if asked for 1");
    let by_noise = json(&["--noise", "1e6"]);
    let samples = by_noise["samples"].as_u64().unwrap();
    assert!(samples < 1000, "ended by noise, not at {samples}");
    let count = samples.to_string();
    assert_eq!(place.read("a.png"), place.ball_png("b.png", &["-s", &count]), "as if asked for");
    let noise = json(&["--noise", "5"])["noise_percent"].as_f64().unwrap();
    assert!(noise <= 5.0, "noise {noise}");
    let all = json(&["--time", "1e9", "--noise", "1e-9", "-s", "3"]);
    assert_eq!(all["samples"], 3, "samples come first");
}

#[test]
fn json_is_one_object_with_these_keys() {
    let place = Place::with_ball();
    let run = place.ok(&["render", "ball.toml", "-o", "a.png", "--json"]);
    let json = run.json();
    let expected = ["height", "noise_percent", "output", "samples", "seconds", "width"];
    assert_eq!(keys(&json), expected, "keys");
    assert_eq!(json["output"], "a.png", "output");
    assert_eq!([&json["width"], &json["height"], &json["samples"]], [16, 9, 4], "integers");
    assert!(json["seconds"].as_f64().unwrap() > 0.0, "seconds");
    assert!(json["noise_percent"].as_f64().unwrap() > 0.0, "noise");
    let alone = place.ok(&["render", "ball.toml", "-o", "a.png"]);
    assert_eq!((&*alone.stdout, &*alone.stderr), ("", ""), "nothing to say without a terminal");
}

#[test]
fn warnings_change_no_status_and_quiet_silences_them_but_no_error() {
    let place = Place::with(&[("m.obj", super::MESH)]);
    let command = ["render", "m.obj", "-o", "a.png", "-s", "1", "--width", "8", "--height", "8"];
    let loud = place.ok(&command);
    assert!(loud.stderr.starts_with("warning: "), "{}", loud.stderr);
    assert!(loud.stderr.contains("m.mtl"), "names the library: {}", loud.stderr);
    let quiet = place.ok(&[&command[..], &["--quiet"]].concat());
    assert_eq!((&*quiet.stdout, &*quiet.stderr), ("", ""), "quiet");
    let error = place.fails(1, &["render", "gone.toml", "-o", "a.png", "--quiet"]);
    assert!(error.contains("gone.toml"), "{error}");
}

/// Of the library's materials only those with a picture count.
#[test]
fn pictures_on_meshes_without_texture_coordinates_are_told() {
    let place = Place::with_mesh();
    let scene = |more: &str, material: &str| {
        format!(
            "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n\
             [[textures]]\nname = 'tiles'\ntype = 'image'\nfile = 'm.png'\n\
             [[textures]]\nname = 'spots'\ntype = 'spots'\n\
             [[materials]]\nname = 'tiled'\n{more}\n\
             [[objects]]\ntype = 'mesh'\nfile = 'm.obj'\n{material}\n"
        )
    };
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nvt 0 0\n";
    let (bare, half) =
        (format!("{corners}f 1 2 3\n"), format!("{corners}f 1/1 2/1 3/1\nf 1 2 4\n"));
    let (none, some) = ("m.obj: has no texture coordinates", "m.obj: has faces without texture");
    let (image, bump) = ("diffuse = 'tiles'", "bump = {texture = 'tiles', height = 0.1}");
    let cases = [
        (bare.as_str(), image, "material = 'tiled'", Some(none)),
        (&bare, bump, "material = 'tiled'", Some(none)),
        (&half, image, "material = 'tiled'", Some(some)),
        (&bare, "diffuse = 'spots'", "material = 'tiled'", None),
        (&bare, image, "", None),
        // The face without any has a material without a picture.
        (super::MESH, image, "", None),
        (&super::MESH.replace("4/4", "4"), image, "", Some(some)),
    ];
    for (mesh, more, material, expected) in cases {
        place.write("m.obj", mesh.as_bytes());
        place.write("s.toml", scene(more, material).as_bytes());
        let run = place.run(&["info", "s.toml"]);
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        let told = run.stderr.lines().find(|line| line.contains("texture coord"));
        let is_as_expected =
            expected.is_none_or(|says| told.is_some_and(|told| told.contains(says)));
        assert!(
            is_as_expected && expected.is_some() == told.is_some(),
            "{mesh} {more}: {}",
            run.stderr
        );
    }
}

#[test]
fn a_mesh_in_a_scenes_place_is_seen_on_its_ground() {
    let place = Place::with_mesh();
    place.ok(&["render", "m.obj", "-o", "a.exr", "-s", "16", "--width", "32", "--height", "32"]);
    let image = linear(&place.path("a.exr"));
    let n_red = image.pixels().filter(|p| p.0[0] > 2.0 * p.0[1] && p.0[0] > 2.0 * p.0[2]).count();
    let n_blue = image.pixels().filter(|p| p.0[2] > 2.0 * p.0[0] && p.0[2] > 0.05).count();
    assert!(n_blue > 20, "{n_blue} blue pixels of the triangle, {n_red} red ones");
    let top = image.get_pixel(0, 0).0;
    let bottom = image.get_pixel(0, 31).0;
    assert_ne!(top, bottom, "a ground below a background");
    place.ok(&["render", "m.obj", "-o", "b.exr", "--set", "camera.vertical_fov=60", "-s", "1"]);
}

#[test]
fn scenes_open_by_relative_and_absolute_paths_from_any_folder() {
    let place = Place::with_mesh();
    let scene = format!("{}[[objects]]\ntype = \"mesh\"\nfile = \"../m.obj\"\n", super::BALL);
    place.write("scenes/deep.toml", scene.as_bytes());
    place.write("elsewhere/empty", b"");
    place.ok(&["render", "scenes/deep.toml", "-o", "elsewhere/a.png"]);
    let from_there = |file: &str| {
        let mut command = place.command();
        command.current_dir(place.path("elsewhere")).args(["render", file, "-o", "b.png"]);
        let run = super::Run::of(&mut command);
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        place.read("elsewhere/b.png")
    };
    let expected = place.read("elsewhere/a.png");
    assert_eq!(from_there("../scenes/deep.toml"), expected, "relative");
    let absolute = place.path("scenes/deep.toml");
    assert_eq!(from_there(absolute.to_str().unwrap()), expected, "absolute");
}

#[test]
fn endings_may_be_written_in_capitals() {
    let place = Place::with_ball();
    place.ok(&["render", "ball.toml", "-o", "A.PNG", "-s", "1"]);
    place.ok(&["render", "ball.toml", "-o", "A.Exr", "-s", "1"]);
    assert_eq!(Png::read(&place.read("A.PNG")).width, 16, "width");
}

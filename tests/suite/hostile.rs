//! Files made to break things: each loads, or is refused in one clean sentence, soon.
//!
//! What loads is rendered too, in a few pixels, by every accelerator.

mod dialects;
mod odd;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use penumbra::geometry::AcceleratorKind;
use penumbra::io::scene_file::{get, parameters, parse, with_value, write};
use penumbra::loader::{Loaded, Source, load};
use penumbra::render::{Film, RenderJob, RenderSettings, World, render_pass};
use penumbra::scene::resolve;
use toml::Value;

use crate::cli::{BALL, LIBRARY, MESH, Place, checkered_png};

/// Promised for any file.
const LIMIT: Duration = Duration::from_secs(10);

/// Loads a file and renders what it is; the error is its message. Panics, long times and messages
/// that are no clean line are failures.
fn open(path: PathBuf, what: &str) -> Result<Loaded, String> {
    let start = Instant::now();
    let opened = catch_unwind(AssertUnwindSafe(|| {
        let loaded = load(&Source::File(path), &[], &AtomicBool::new(false));
        loaded.map(render_small).map_err(|error| error.to_string())
    }));
    let elapsed = start.elapsed();
    let opened = opened.unwrap_or_else(|_| panic!("{what}: a panic"));
    assert!(elapsed < LIMIT, "{what}: {elapsed:?}");
    let texts = match &opened {
        Ok(loaded) => loaded.report.clone(),
        Err(message) => vec![message.clone()],
    };
    for text in texts {
        assert!(!text.contains(char::is_control), "{what}: {text:?}");
        assert!(!text.is_empty() && text.len() < 2000, "{what}: {} bytes", text.len());
    }
    opened
}

fn render_small(loaded: Loaded) -> Loaded {
    let Ok(scene) = resolve(&loaded.description, &loaded.assets) else {
        panic!("a loaded scene lacks something")
    };
    let scene = Arc::new(scene);
    let mut pictures = Vec::new();
    for accelerator in AcceleratorKind::ALL {
        let mut settings = RenderSettings::new(&loaded.description.render, accelerator);
        settings.max_depth = settings.max_depth.min(4);
        let job = RenderJob { scene: Arc::clone(&scene), width: 4, height: 3, settings };
        let world = World::new(job);
        world.pick(2.0, 1.5);
        let mut film = Film::new(4, 3).unwrap();
        let Ok(_) = render_pass(&world, &mut film, 1, &AtomicBool::new(false)) else {
            panic!("nobody stops it")
        };
        pictures.push(film.picture().pixels.into_flattened());
    }
    let bits = |picture: &Vec<f32>| picture.iter().map(|x| x.to_bits()).collect::<Vec<u32>>();
    for picture in &pictures {
        assert!(picture.iter().all(|x| x.is_finite()), "a pixel is no number: {picture:?}");
        assert_eq!(bits(picture), bits(&pictures[0]), "accelerators differ");
    }
    loaded
}

fn opened(place: &Place, name: &str, bytes: &[u8], what: &str) -> Result<Loaded, String> {
    place.write(name, bytes);
    open(place.path(name), what)
}

#[test]
fn truncated_and_damaged_files_load_or_are_refused() {
    let place = Place::with_mesh();
    let all = format!(
        "{BALL}[[objects]]\ntype = \"mesh\"\nfile = \"m.obj\"\n[[textures]]\nname = \"i\"\n\
         type = \"image\"\nfile = \"i.jpg\"\n"
    );
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    place.write("i.jpg", &std::fs::read(data.join("color.jpg")).unwrap());
    place.write("s.toml", all.as_bytes());
    let small = ["--width", "4", "--height", "3", "-s", "1"];
    place.ok(&[&["render", "s.toml", "-o", "shot.png"], &small[..]].concat());
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = move |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % n as u64) as usize
    };
    // The file that is damaged, and the one that is opened.
    for (damaged, file) in [
        ("s.toml", "s.toml"),
        ("m.obj", "m.obj"),
        ("m.obj", "s.toml"),
        ("m.mtl", "m.obj"),
        ("m.png", "m.obj"),
        ("i.jpg", "s.toml"),
        ("shot.png", "shot.png"),
    ] {
        let good = place.read(damaged);
        let (mut n_ok, mut n_refused) = (0, 0);
        for round in 0..60 {
            let mut bytes = good.clone();
            match round % 3 {
                0 => bytes.truncate(random(good.len())),
                1 => {
                    for _ in 0..=random(4) {
                        let at = random(bytes.len());
                        bytes[at] = random(256) as u8;
                    }
                }
                _ => {
                    let (from, to) = (random(good.len()), random(good.len()));
                    bytes.rotate_left(from);
                    bytes.truncate(to.max(1));
                }
            }
            let what = format!("{damaged} opened as {file}, round {round}");
            place.write(damaged, &bytes);
            match open(place.path(file), &what) {
                Ok(_) => n_ok += 1,
                Err(_) => n_refused += 1,
            }
        }
        place.write(damaged, &good);
        assert!(open(place.path(file), damaged).is_ok(), "{damaged} is whole again");
        assert!(n_ok + n_refused == 60, "{damaged}: {n_ok} loaded, {n_refused} were refused");
    }
}

#[test]
fn meshes_of_impossible_numbers_are_refused_by_line() {
    let place = Place::new();
    let face = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for line in [
        "v nan 0 0",
        "v inf 0 0",
        "v 0 -infinity 0",
        "v 1e30 0 0",
        "v 1e39 0 0",
        "v 1e999 0 0",
        "v 0 0",
        "v 0x10 0 0",
        "v 1,5 0 0",
        "vn nan 0 1",
        "vt inf 0",
        "f 0 1 2",
        "f 1 2 4",
        "f 1 2 -4",
        "f 1 2 4294967297",
        "f 1 2 18446744073709551617",
        "f 1 2 99999999999999999999999999",
        "f 1 2 -9223372036854775809",
        "f 1/9 2 3",
        "f 1//9 2 3",
        "f 1 2",
        "f 1.5 2 3",
        "f a b c",
        "f 1 2 3\0",
    ] {
        let text = format!("{face}{line}\n{face}");
        let error = opened(&place, "m.obj", text.as_bytes(), line).expect_err(line);
        assert!(error.contains("line 5"), "{line}: {error}");
    }
    for text in ["", "\0", "v 0 0 0\n", "# nothing\n", "\u{feff}", "f\n", "\r\r\r\r", "\\\n\\\n"] {
        opened(&place, "m.obj", text.as_bytes(), text).expect_err(text);
    }
}

#[test]
fn odd_meshes_render_the_same_by_every_accelerator() {
    let place = Place::new();
    let repeat = |text: &str, n: usize| text.repeat(n);
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let circle = |radius: fn(u32) -> f64| {
        let mut text = String::new();
        for i in 0..10_000 {
            let angle = f64::from(i) * std::f64::consts::TAU / 10_000.0;
            let r = radius(i);
            text += &format!("v {} {} 0\n", r * angle.cos(), r * angle.sin());
        }
        text += "f";
        for i in 1..=10_000 {
            text += &format!(" {i}");
        }
        text + "\n"
    };
    for (what, text) in [
        ("20,000 identical triangles", format!("{corners}{}", repeat("f 1 2 3\n", 20_000))),
        (
            "20,000 triangles without area",
            format!("{corners}{}f 1 2 3\n", repeat("f 1 1 2\n", 20_000)),
        ),
        ("only triangles without area", format!("{corners}{}", repeat("f 2 2 2\n", 100))),
        (
            "20,000 coplanar triangles",
            format!("{corners}v 1 1 0\n{}", repeat("f 1 2 3\nf 2 3 4\n", 10_000)),
        ),
        ("denormals", "v 1e-40 0 0\nv 1e-45 1e-40 0\nv 0 0 1e-42\nf 1 2 3\n".to_owned()),
        (
            "the largest and the smallest",
            "v 1e11 0 0\nv 1e-30 1e11 0\nv -1e11 0 1e11\nf 1 2 3\n".to_owned(),
        ),
        ("a needle", "v 0 0 0\nv 1e6 1e-6 0\nv 1e6 0 1e-6\nf 1 2 3\n".to_owned()),
        (
            "a far mesh",
            "v 1e9 1e9 1e9\nv 1000000100 1e9 1e9\nv 1e9 1000000100 1e9\nf 1 2 3\n".to_owned(),
        ),
        ("a convex polygon of 10,000 corners", circle(|_| 1.0)),
        ("a polygon that crosses itself", format!("{corners}v 1 1 0\nf 1 4 2 3\nf 1 2 1 3 2\n")),
        ("a corner 1000 times", format!("{corners}f{}\n", " 1 2 3".repeat(333))),
        ("zero normals", format!("{corners}vn 0 0 0\nf 1//1 2//1 3//1\n")),
        ("normals to every side", format!("{corners}vn 0 0 -1\nvn 1 0 0\nf 1//1 2//2 3//1\n")),
        ("huge texture coordinates", format!("{corners}vt 1e11 -1e11\nf 1/1 2/1 3/1\n")),
    ] {
        let loaded = opened(&place, "m.obj", text.as_bytes(), what);
        assert!(loaded.is_ok(), "{what}: {:?}", loaded.err());
    }
    let vast = "v 1e12 0 0\nv 0 1e12 0\nv 0 0 1e12\nf 1 2 3\n";
    let error = opened(&place, "m.obj", vast.as_bytes(), "too vast").expect_err("too vast");
    assert!(error.contains("1e12") && error.contains("1e11"), "{error}");
    let star = circle(|i| if i % 2 == 0 { 1.0 } else { 0.5 });
    if let Err(error) = opened(&place, "m.obj", star.as_bytes(), "a star of 10,000 corners") {
        assert!(error.contains("line 10001"), "{error}");
    }
}

#[test]
fn names_of_100_kib_are_cut_where_they_are_shown() {
    let place = Place::with_mesh();
    let long = "x".repeat(100 << 10);
    for mesh in [
        format!("mtllib {long}.mtl\n{MESH}"),
        format!("{MESH}usemtl {long}\nf 1 2 3\n"),
        format!("g {long}\n{long} 1\n{MESH}"),
        format!("v {long}\n"),
        format!("v 1{} 0 0\n", "0".repeat(100 << 10)),
        format!("f {long}\n"),
    ] {
        let _ = opened(&place, "m.obj", mesh.as_bytes(), &mesh[..20]);
    }
    for library in [
        format!("newmtl {long}\n{LIBRARY}"),
        format!("{LIBRARY}map_Kd {long}\n"),
        format!("{LIBRARY}Kd {long} 0 0\n"),
        format!("{long}\n{LIBRARY}"),
    ] {
        place.write("m.mtl", library.as_bytes());
        let what = &library[..20];
        assert!(opened(&place, "m.obj", MESH.as_bytes(), what).is_ok(), "{what}: only a warning");
    }
    for scene in [
        format!("{long} = 1\n"),
        format!("{BALL}[[objects]]\nname = \"{long}\"\ntype = \"sphere\"\nradius = -1\n"),
        format!("{BALL}[[objects]]\ntype = \"{long}\"\n"),
        format!("{BALL}[[objects]]\ntype = \"mesh\"\nfile = \"{long}\"\n"),
        format!("{BALL}[[objects]]\ntype = \"mesh\"\nfile = \"m.obj\"\nmaterial = \"{long}\"\n"),
        format!("{BALL}[[textures]]\nname = \"t\"\ntype = \"image\"\nfile = \"{long}\"\n"),
        format!("x = {}1{}\n", "[".repeat(100 << 10), "]".repeat(100 << 10)),
        format!("a{} = 1\n", ".a".repeat(100 << 10)),
    ] {
        let what = &scene[scene.len().min(BALL.len() + 40) - 30..][..30];
        opened(&place, "s.toml", scene.as_bytes(), what).expect_err(what);
    }
}

#[test]
fn pictures_that_lie_are_refused() {
    let place = Place::new();
    let mut huge = Vec::new();
    drop(png::Encoder::new(&mut huge, 60_000, 60_000).write_header().unwrap());
    let scene = |file: &str| {
        format!("{BALL}[[textures]]\nname = \"t\"\ntype = \"image\"\nfile = \"{file}\"\n")
    };
    place.write("huge.png", &huge);
    let error = open(place.path("huge.png"), "a snapshot").expect_err("a snapshot");
    assert!(error.contains("huge.png"), "{error}");
    let error = opened(&place, "s.toml", scene("huge.png").as_bytes(), "a texture");
    assert!(error.expect_err("a texture").contains("60000 x 60000"), "the size is told");
    let jpeg_start = [0xff, 0xd8, 0xff, 0xe0];
    let garbage: Vec<u8> =
        (0..5000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for (name, bytes) in [
        ("garbage.jpg", [&jpeg_start[..], &garbage].concat()),
        ("garbage.png", garbage.clone()),
        ("text.png", b"not a picture\x1b[31m".to_vec()),
        ("empty.png", Vec::new()),
        ("start.png", checkered_png()[..8].to_vec()),
    ] {
        place.write(name, &bytes);
        let error = opened(&place, "s.toml", scene(name).as_bytes(), name).expect_err(name);
        let is_located = error.contains("s.toml:45:8: textures.t.file") && error.contains(name);
        assert!(is_located, "{error}");
        if name.ends_with(".png") {
            open(place.path(name), name).expect_err(name);
        }
    }
}

#[test]
fn paths_that_climb_out_read_what_they_name_or_nothing() {
    let place = Place::with_mesh();
    for file in [
        "../../../../../../../../../../etc/passwd",
        "/etc/passwd",
        "/proc/self/mem",
        "/sys/kernel/notes",
        "",
        ".",
        "..",
        "/",
        "m.obj/",
        "m.obj/x",
        "\\u0000",
        "m.obj\\u0000.png",
    ] {
        for entry in
            ["[[objects]]\ntype = \"mesh\"", "[[textures]]\nname = \"t\"\ntype = \"image\""]
        {
            let scene = format!("{BALL}{entry}\nfile = \"{file}\"\n");
            let what = format!("{entry} {file}");
            let error = opened(&place, "s.toml", scene.as_bytes(), &what).expect_err(&what);
            assert!(error.contains("s.toml:4"), "{what}: {error}");
        }
    }
}

/// A picture of whatever a scene file may say.
#[test]
fn every_parameter_at_its_extremes_renders_or_is_refused() {
    let place = Place::with_mesh();
    let scene = format!(
        "{BALL}\n\
         [[textures]]\nname = \"noise\"\ntype = \"marble\"\n\
         [[textures]]\nname = \"squares\"\ntype = \"checker\"\ncolors = [[0, 0, 0], [1, 1, 1]]\n\
         [[textures]]\nname = \"map\"\ntype = \"image\"\nfile = \"m.png\"\n\
         [[materials]]\nname = \"bumpy\"\ndiffuse = \"noise\"\nspecular = [0.3, 0.3, 0.3]\n\
         bump = {{ texture = \"noise\", height = 0.1 }}\n\
         [[lights]]\nname = \"sun\"\ntype = \"sun\"\nposition = [1, 1, 1]\nsize = 1\npower = [1, 1, 1]\n\
         [[lights]]\nname = \"panel\"\ntype = \"rectangle\"\nposition = [1, 3, 1]\nsize = [1, 2]\n\
         power = [9, 9, 9]\n\
         [[lights]]\nname = \"bulb\"\ntype = \"sphere\"\nposition = [-1, 3, 1]\nsize = 0.5\n\
         power = [9, 9, 9]\n\
         [[objects]]\nname = \"ground\"\ntype = \"plane\"\npoint = [0, -1, 0]\nnormal = [0, 1, 0]\n\
         material = \"bumpy\"\n\
         [[objects]]\nname = \"mesh\"\ntype = \"mesh\"\nfile = \"m.obj\"\nmaterial = \"bumpy\"\n\
         [[objects]]\nname = \"cone\"\ntype = \"cone\"\nbase = [1, 0, 1]\ntip = [1, 1, 1]\n\
         radius = 0.5\n\
         [[objects]]\nname = \"pipe\"\ntype = \"cylinder\"\nbase = [1, 0, 1]\ntop = [1, 1, 1]\n\
         radius = 0.5\nmaterial = \"bumpy\"\n"
    );
    place.write("s.toml", scene.as_bytes());
    let loaded = open(place.path("s.toml"), "the scene as it is").unwrap();
    let start = parse(&scene, &[]).unwrap();
    let numbers = [0.0, 1e-12, -1e-12, 1e-6, 1.0, -1.0, 180.0, 1e6, -1e6, 1e12, -1e12, 1e30, 1e300];
    let (mut n_rendered, mut n_refused) = (0, 0);
    for path in parameters(&start) {
        let is_triple = matches!(get(&start, &path), Ok(Some(Value::Array(_))));
        for x in numbers {
            let mut values = vec![Value::Float(x), Value::Integer(x as i64)];
            if is_triple {
                values = vec![
                    Value::Array(vec![x.into(); 3]),
                    Value::Array(vec![0.0.into(), x.into(), 1.0.into()]),
                ];
            }
            for value in values {
                let what = format!("{path} = {value}");
                let Ok(description) = with_value(&start, &path, value) else {
                    n_refused += 1;
                    continue;
                };
                n_rendered += 1;
                let changed = Loaded { description, ..loaded.clone() };
                // What cannot be resolved names a mesh of another crease angle.
                if resolve(&changed.description, &changed.assets).is_ok() {
                    let drawn = catch_unwind(AssertUnwindSafe(|| render_small(changed.clone())));
                    assert!(drawn.is_ok(), "{what}");
                }
                let text = write(&changed.description);
                let again = parse(&text, &[]).unwrap_or_else(|error| panic!("{what}: {error}"));
                assert!(again == changed.description, "{what} is written as another scene");
            }
        }
    }
    assert!(n_rendered > 500 && n_refused > 200, "{n_rendered} rendered, {n_refused} refused");
}

//! What the reader takes, and what overrides do.

use super::*;
use crate::scene::description::{ColorOrTexture, OneOrTwo};

/// A camera in one line, so that a snippet below it starts at line 2.
pub(super) const CAMERA: &str = "camera = { eye = [0, 1, 5], target = [0, 1, 0] }\n";

/// A scene with one of everything, every key of which has a value of its own.
pub(super) const FULL: &str = include_str!("full.toml");

pub(super) fn read(snippet: &str) -> Result<SceneDescription, SceneFileError> {
    parse(&format!("{CAMERA}{snippet}"), &[])
}

fn sets(texts: &[&str]) -> Vec<Override> {
    texts.iter().map(|text| Override::parse(text).unwrap()).collect()
}

#[test]
fn what_the_contract_allows_is_taken() {
    for snippet in [
        "",
        "[render]\nseed = 4294967295\nsamples = 1048576\nwidth = 16384\nheight = 1\nmax_depth = 0",
        "[[lights]]\ntype=\"sun\"\nposition=[0,1,0]\npower=[0,0,0]\nsize=180",
        "[[lights]]\ntype=\"disk\"\nposition=[0,1,0]\npower=[0,0,0]\nsize=[0.5]",
        "[[lights]]\ntype=\"rectangle\"\nposition=[0,1,0]\npower=[0,0,0]\nsize=[0,0]",
        "[[lights]]\ntype=\"rectangle\"\nposition=[0,1,0]\npower=[0,0,0]\nsize=0",
        "[[lights]]\ntype=\"point\"\nposition=[0,0,0]\npower=[0,0,0]",
        "[[lights]]\nname=\"\"\ntype=\"sphere\"\nposition=[0,0,0]\npower=[0,0,0]",
        "[[textures]]\nname=\"c\"\ntype=\"checker\"",
        "[[textures]]\nname=\"c\"\ntype=\"solid\"\ncolors=[[2,0,0]]\noctaves=3\nfile=\"unused.png\"",
        "[[objects]]\ntype=\"box\"\nmin=[0,0,0]\nmax=[1,0,1]\nscale=[-1,1,2]\nradius=3",
        "[[objects]]\ntype=\"sphere\"\ncenter=[1,2,3]\nradius=1\nscale=-1\nfile=\"unused\"",
        "[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\r\nscale=2 # comment\r\n",
    ] {
        if let Err(error) = read(snippet) {
            panic!("{snippet}\n{error}");
        }
    }
}

#[test]
fn absent_keys_have_the_contracts_defaults() {
    let scene = read(
        "[[textures]]\nname='t'\ntype='wood'\n[[materials]]\nname='m'\n\
         [[lights]]\ntype='point'\nposition=[1,2,3]\npower=[4,5,6]\n\
         [[objects]]\ntype='mesh'\nfile='a.obj'",
    )
    .unwrap();
    let table = table_of(&scene);
    for (path, value) in [
        ("render.width", "1280"),
        ("render.height", "720"),
        ("render.samples", "256"),
        ("render.max_depth", "8"),
        ("render.integrator", "\"direct\""),
        ("render.seed", "0"),
        ("render.filter", "\"box\""),
        ("render.adaptive", "false"),
        ("render.sampler", "\"sobol\""),
        ("camera.up", "[0.0, 1.0, 0.0]"),
        ("camera.vertical_fov", "40.0"),
        ("camera.aperture_radius", "0.0"),
        ("camera.focal_distance", "absent"),
        ("camera.aperture_blades", "0"),
        ("tone_mapping.exposure", "0.0"),
        ("tone_mapping.operator", "\"agx\""),
        ("environment.ambient", "[0.0, 0.0, 0.0]"),
        ("environment.background", "[0.0, 0.0, 0.0]"),
        ("textures.t.scale", "1.0"),
        ("textures.t.octaves", "6"),
        ("textures.t.lacunarity", "2.0"),
        ("textures.t.gain", "0.5"),
        ("textures.t.distortion", "0.0"),
        ("textures.t.colors", "absent"),
        ("materials.m.diffuse", "[0.0, 0.0, 0.0]"),
        ("materials.m.specular", "[0.0, 0.0, 0.0]"),
        ("materials.m.alpha_x", "0.15"),
        ("materials.m.alpha_y", "0.15"),
        ("materials.m.ward", "\"original\""),
        ("materials.m.tangent", "[1.0, 0.0, 0.0]"),
        ("materials.m.reflection", "[0.0, 0.0, 0.0]"),
        ("materials.m.transmission", "[0.0, 0.0, 0.0]"),
        ("materials.m.ior", "1.5"),
        ("materials.m.emission", "[0.0, 0.0, 0.0]"),
        ("materials.m.bump", "absent"),
        ("lights.light-1.target", "[0.0, 0.0, 0.0]"),
        ("lights.light-1.up", "[0.0, 1.0, 0.0]"),
        ("lights.light-1.size", "0.0"),
        ("lights.light-1.visible", "true"),
        ("lights.light-1.enabled", "true"),
        ("objects.object-1.enabled", "true"),
        ("objects.object-1.normals", "\"file\""),
        ("objects.object-1.crease_angle", "180.0"),
        ("objects.object-1.material", "absent"),
        ("objects.object-1.translate", "[0.0, 0.0, 0.0]"),
        ("objects.object-1.rotate", "[0.0, 0.0, 0.0]"),
        ("objects.object-1.scale", "1.0"),
    ] {
        let slot = path.parse::<ParameterPath>().unwrap().resolve(&table).unwrap();
        let found = slot.get(&table).map_or("absent".into(), words::value_text);
        assert_eq!(found, value, "{path}");
    }
}

#[test]
fn the_tables_of_keys_and_the_description_say_the_same() {
    let scene = parse(FULL, &[]).unwrap();
    let root = table_of(&scene);
    for section in Section::ALL {
        let known: Vec<_> = section.keys().iter().map(|key| key.name).collect();
        let mut written = Vec::new();
        let value = &root[section.name()];
        for entry in value.as_array().map_or(std::slice::from_ref(value), |entries| entries) {
            written.extend(entry.as_table().unwrap().keys().map(String::as_str));
        }
        for key in &known {
            assert!(written.contains(key), "{}: {key} is not in the description", section.name());
        }
        for key in written {
            assert!(known.contains(&key), "{}: {key} is not in the tables", section.name());
        }
    }
    for path in parameters(&scene) {
        let key = path.resolve(&root).unwrap().innermost();
        let Rule::Word(words) = key.rule else {
            continue;
        };
        for word in words {
            let mut changed = root.clone();
            path.resolve(&root).unwrap().set(&mut changed, Value::String((*word).into()));
            let read = SceneDescription::deserialize(Value::Table(changed));
            assert!(read.is_ok(), "{path} = {word}: {read:?}");
        }
    }
}

#[test]
fn the_unnamed_are_counted_among_themselves() {
    let light = "[[lights]]\ntype='point'\nposition=[0,0,1]\npower=[1,1,1]\n";
    let scene = read(&format!("{light}name='a'\n{light}{light}name='b'\n{light}")).unwrap();
    let names: Vec<_> = scene.lights.iter().map(|light| &*light.name).collect();
    assert_eq!(names, ["a", "light-1", "b", "light-2"], "names of lights");
}

#[test]
fn overrides_come_before_validation_and_the_last_one_wins() {
    let text = "[camera]\neye = [0, 0, 1]\n[render]\nsamples = -3\n[[lights]]\ntype = 'disk'\n\
                position = [0, 3, 0]\npower = [1, 1, 1]\nsize = 'big'\n\
                [[materials]]\nname = 'my clay'\n[[textures]]\nname='w'\ntype='wood'";
    let mut given = sets(&[
        "render.samples=4",
        "camera.target=[0, 0, 0]",
        "lights.light-1.size=[0.5]",
        "materials.\"my clay\".bump.height=0.1",
        "materials.'my clay'.bump.texture=w",
        "materials.'my clay'.diffuse=w",
        "tone_mapping.exposure=2",
        "camera.focal_distance=3",
    ]);
    given.push(Override::new("--samples", &["render", "samples"], 9));
    let scene = parse(text, &given).unwrap();
    assert_eq!(scene.render.samples, 9, "samples");
    assert_eq!(scene.camera.target, [0.0; 3], "target");
    assert_eq!(scene.lights[0].size, OneOrTwo::Single([0.5]), "size");
    assert_eq!(scene.materials[0].bump.as_ref().unwrap().height, 0.1, "height");
    assert_eq!(scene.materials[0].diffuse, ColorOrTexture::Texture("w".into()), "diffuse");
    assert_eq!(scene.tone_mapping.exposure, 2.0, "exposure");
    assert_eq!(scene.camera.focal_distance, Some(3.0), "focal distance");
}

#[test]
fn of_two_overrides_the_one_that_counts_is_blamed() {
    let mut given = sets(&["render.samples=4"]);
    given.push(Override::new("--samples", &["render", "samples"], 0));
    let error = parse(CAMERA, &given).map(|_| ()).unwrap_err().to_string();
    assert!(error.starts_with("--samples render.samples: 0 is not"), "{error}");
}

#[test]
fn an_override_that_names_nothing_is_apart_from_one_of_a_bad_value() {
    let text = format!(
        "{CAMERA}[[materials]]\nname='ceramic'\n[[objects]]\nname='my teapot'\ntype='sphere'\n\
         center=[0,0,0]\nradius=1"
    );
    for (set, names_nothing, says) in [
        (
            "rendr.samples=5",
            true,
            "--set rendr.samples: there is no section \"rendr\"; did you mean",
        ),
        ("render=5", true, "is no parameter; add the name of one: width,"),
        ("render.sample=5", true, "there is no key \"sample\"; did you mean samples?"),
        ("materials.cermic.ior=2", true, "no material \"cermic\"; did you mean \"ceramic\"?"),
        ("materials.x.ior=2", true, "no material \"x\"; known: \"ceramic\""),
        ("lights.key.size=2", true, "there is no light \"key\""),
        ("materials.ceramic=2", true, "is no parameter; add the name of one: name, diffuse"),
        ("materials=2", true, "write materials.NAME.KEY, with the name of a material"),
        ("camera.eye.x=2", true, "eye is one value and is set as a whole; give three numbers"),
        ("materials.ceramic.bump.hight=2", true, "there is no key \"hight\"; did you mean height?"),
        (
            "materials.ceramic.alpha_x=-2",
            false,
            "--set materials.ceramic.alpha_x: -2 is not a rough",
        ),
        (
            "materials.ceramic.diffuse=red",
            false,
            "--set materials.ceramic.diffuse: there is no text",
        ),
        (
            "materials.ceramic.bump.height=1",
            false,
            "materials.ceramic.bump.texture: this key is required",
        ),
        ("render.samples=abc", false, "--set render.samples: \"abc\" is not a number of samples"),
        (
            "camera.eye=[0, 1, 0]",
            false,
            "--set camera.eye: camera.target: this is where the eye is",
        ),
        (
            "objects.'my teapot'.type=box",
            false,
            "--set objects.\"my teapot\".type: objects.\"my teapot\".min: this key is required by type \"box\"",
        ),
        ("camera.eye=[0, 1, nan]", false, "[0, 1, nan] is not finite"),
    ] {
        let error = parse(&text, &sets(&[set])).map(|_| ()).expect_err(set);
        assert_eq!(matches!(error, SceneFileError::Override(_)), names_nothing, "{set}: {error}");
        assert!(error.to_string().contains(says), "{set}\n{error}\nshould say {says}");
    }
}

#[test]
fn bytes_that_are_not_utf8_are_named_by_line() {
    let error = text_of(b"[render]\nwidth = 5 # \xff".to_vec()).map(|_| ()).unwrap_err();
    assert_eq!(
        error.in_file("a.toml"),
        "a.toml:2:13: byte 0xff is not UTF-8; save the file in that encoding",
        "message"
    );
}

#[test]
fn long_files_are_refused_before_they_are_parsed() {
    let long = vec![b'#'; LARGEST_FILE as usize + 1];
    assert!(matches!(text_of(long), Err(SceneFileError::TooLarge)), "read a long file");
}

#[test]
fn a_description_is_judged_as_its_file_would_be() {
    let mut scene = parse(FULL, &[]).unwrap();
    assert_eq!(validate(&scene), Ok(()), "the full scene");
    scene.materials[0].alpha_x = f64::NAN;
    let invalid = validate(&scene).unwrap_err();
    assert_eq!(invalid.path, format!("materials.{}.alpha_x", scene.materials[0].name), "{invalid}");
}

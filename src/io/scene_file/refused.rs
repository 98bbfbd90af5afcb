//! Everything that a scene file may not hold, with the place and the message of each error.

use proptest::prelude::*;

use super::parse;
use super::tests::{FULL, read};

/// Snippet below a camera, line, column, part of the message.
const REFUSED: &[(&str, usize, usize, &str)] = &[
    // Not TOML.
    ("[render", 2, 8, "not TOML"),
    ("[render]\nwidth = ", 3, 9, "not TOML"),
    ("[render]\nwidth = 5\nwidth = 6", 4, 1, "duplicate key"),
    ("[render]\nintegrator = path", 3, 14, "must be quoted"),
    ("x = [[[[[[[[[[[[[[[[[[[[", 2, 21, "nested too deeply"),
    // Sections and keys.
    ("[rendr]", 2, 2, "rendr: there is no section \"rendr\"; did you mean render?"),
    ("[zzz]", 2, 2, "known: render, camera"),
    ("render = 5", 2, 1, "render: this is a section; write it as [render]"),
    ("[[render]]", 2, 3, "write it as [render]"),
    ("[materials]\nname = \"a\"", 2, 2, "write each material as [[materials]]"),
    ("[materials.ceramic]\ndiffuse = [0, 0, 0]", 2, 2, "write each material as [[materials]]"),
    ("lights = [1]", 2, 1, "write each light as [[lights]]"),
    ("[render]\nwidht = 5", 3, 1, "render.widht: there is no such key; did you mean width?"),
    ("[render]\n  \tzzz = 5", 3, 4, "known: width, height, samples"),
    ("[[materials]]\nname = \"a\"\nroughness = 1", 4, 1, "materials.a.roughness: there is no such"),
    ("[[materials]]\nname=\"a\"\nbump = {texture=\"t\", hight=1}", 4, 22, "did you mean height?"),
    ("[[materials]]\nname = \"a b\"\nalpha = 1", 4, 1, "materials.\"a b\".alpha"),
    // What is required.
    (
        "[[textures]]\ntype = \"wood\"",
        2,
        1,
        "textures.(no. 1).name: this key is required; give a string",
    ),
    ("[[textures]]\nname = \"t\"", 2, 1, "textures.t.type: this key is required; give \"solid\","),
    ("[[materials]]\ndiffuse = [0, 0, 0]", 2, 1, "materials.(no. 1).name: this key is required"),
    (
        "[[lights]]\nposition = [0,0,1]\npower = [1,1,1]",
        2,
        1,
        "lights.light-1.type: this key is required",
    ),
    (
        "[[lights]]\ntype = \"sun\"\npower = [1,1,1]",
        2,
        1,
        "lights.light-1.position: this key is required",
    ),
    (
        "\n[[lights]]\ntype=\"sun\"\nposition=[1,1,1]",
        3,
        1,
        "lights.light-1.power: this key is required",
    ),
    ("[[objects]]\nradius = 1", 2, 1, "objects.object-1.type: this key is required; give \"mesh\""),
    (
        "[[objects]]\ntype = \"mesh\"",
        2,
        1,
        "file: this key is required by type \"mesh\"; give the path",
    ),
    (
        "[[objects]]\ntype = \"sphere\"\nradius=1",
        2,
        1,
        "center: this key is required by type \"sphere\"",
    ),
    ("[[objects]]\ntype = \"sphere\"\ncenter=[0,0,0]", 2, 1, "radius: this key is required"),
    ("[[objects]]\ntype = \"plane\"\npoint=[0,0,0]", 2, 1, "normal: this key is required"),
    ("[[objects]]\ntype = \"plane\"\nnormal=[0,0,1]", 2, 1, "point: this key is required"),
    ("[[objects]]\ntype = \"box\"\nmin=[0,0,0]", 2, 1, "max: this key is required"),
    ("[[objects]]\ntype = \"box\"\nmax=[0,0,0]", 2, 1, "min: this key is required"),
    ("[[objects]]\ntype = \"cone\"\nbase=[0,0,0]\nradius=1", 2, 1, "tip: this key is required"),
    ("[[objects]]\ntype = \"cylinder\"\nbase=[0,0,0]\nradius=1", 2, 1, "top: this key is required"),
    ("[[objects]]\ntype = \"cylinder\"\ntop=[0,0,0]\nradius=1", 2, 1, "base: this key is required"),
    (
        "[[objects]]\ntype = \"cone\"\nbase=[0,0,0]\ntip=[0,1,0]",
        2,
        1,
        "radius: this key is required",
    ),
    (
        "[[textures]]\nname=\"t\"\ntype = \"image\"",
        2,
        1,
        "file: this key is required by type \"image\"",
    ),
    (
        "[[textures]]\nname=\"t\"\ntype = \"solid\"",
        2,
        1,
        "colors: this key is required by type \"solid\"",
    ),
    (
        "[[materials]]\nname=\"a\"\nbump = {texture=\"t\"}",
        4,
        8,
        "a.bump.height: this key is required",
    ),
    ("[[materials]]\nname=\"a\"\nbump = {height=1}", 4, 8, "a.bump.texture: this key is required"),
    (
        "[[materials]]\nname=\"a\"\n[materials.bump]\nheight=1",
        4,
        1,
        "a.bump.texture: this key is required",
    ),
    // Numbers.
    ("[render]\nwidth = 0", 3, 9, "render.width: 0 is not a width; give a whole number from 1"),
    ("[render]\nwidth = 16385", 3, 9, "16385"),
    ("[render]\nheight = 1.5", 3, 10, "1.5 is not a height"),
    ("[render]\nheight = 0", 3, 10, "from 1 to 16384"),
    ("[render]\nsamples = 0", 3, 11, "from 1 to 1048576"),
    ("[render]\nsamples = 1048577", 3, 11, "1048577"),
    ("[render]\nsamples = 16.0", 3, 11, "16.0 is not a number of samples"),
    ("[render]\nsamples = \"16\"", 3, 11, "\"16\" is not a number of samples"),
    ("[render]\nmax_depth = -1", 3, 13, "from 0 to 1024"),
    ("[render]\nmax_depth = 1025", 3, 13, "1025"),
    ("[render]\nseed = -1", 3, 8, "from 0 to 4294967295"),
    ("[render]\nseed = 4294967296", 3, 8, "4294967296"),
    ("[render]\nseed = 99999999999999999999", 3, 8, "1e20 is not a seed"),
    ("[render]\nseed = 0xffffffffffffffffff", 3, 8, "\"0xffffffffffffffffff\" is not a seed"),
    ("[render]\nintegrator = \"pth\"", 3, 14, "; did you mean \"path\"?"),
    ("[render]\nfilter = \"gauss\"", 3, 10, "give \"box\""),
    ("[render]\nadaptive = 1", 3, 12, "1 is not a switch; give true or false"),
    ("[render]\nsampler = \"halton\"", 3, 11, "\"sobol\" or \"random\""),
    ("[tone_mapping]\nexposure = nan", 3, 12, "nan is not finite; give a number"),
    ("[tone_mapping]\nexposure = 1e4", 3, 12, "too large to compute with; stay within 100"),
    ("[tone_mapping]\noperator = \"filmic\"", 3, 12, "\"aces\" or \"agx\""),
    ("[environment]\nambient = [0, -1, 0]", 3, 15, "[0, -1, 0] is not a colour"),
    ("[environment]\nambient = [0, 0]", 3, 11, "give three numbers of at least 0"),
    ("[environment]\nambient = 0.5", 3, 11, "0.5 is not a colour"),
    ("[environment]\nbackground = 1979-05-27", 3, 14, "1979-05-27 is not a background"),
    (
        "[environment]\nbackground = \"sky\"",
        3,
        14,
        "no texture \"sky\"; this scene has no textures",
    ),
    ("[environment]\nbackground = [inf, 0, 0]", 3, 15, "or the name of a texture"),
    ("[environment]\nbackground = [1e31, 0, 0]", 3, 15, "too large to compute with"),
    // Textures.
    (
        "[[textures]]\nname=\"t\"\ntype = \"marbel\"",
        4,
        8,
        "not a type of texture; did you mean \"marble\"?",
    ),
    ("[[textures]]\nname=5\ntype = \"wood\"", 3, 6, "5 is not a name; give a string"),
    ("[[textures]]\nname=\"t\"\ntype=\"wood\"\nscale = 0", 5, 9, "give a number above 0"),
    ("[[textures]]\nname=\"t\"\ntype=\"wood\"\noctaves = 13", 5, 11, "from 1 to 12"),
    ("[[textures]]\nname=\"t\"\ntype=\"wood\"\noctaves = 0", 5, 11, "from 1 to 12"),
    ("[[textures]]\nname=\"t\"\ntype=\"wood\"\nlacunarity = 0.0", 5, 14, "above 0"),
    ("[[textures]]\nname=\"t\"\ntype=\"wood\"\ngain = -0.1", 5, 8, "of at least 0"),
    ("[[textures]]\nname=\"t\"\ntype=\"wood\"\ndistortion = inf", 5, 14, "inf is not finite"),
    (
        "[[textures]]\nname=\"t\"\ntype=\"wood\"\ncolors = [[0,0,0]]",
        5,
        10,
        "noise texture takes two colours or",
    ),
    (
        "[[textures]]\nname=\"t\"\ntype=\"wood\"\ncolors = []",
        5,
        10,
        "takes two colours or more, not 0",
    ),
    ("[[textures]]\nname=\"t\"\ntype=\"wood\"\ncolors = [[0,0,0],[0,0,-1]]", 5, 24, "each three"),
    ("[[textures]]\nname=\"t\"\ntype=\"wood\"\ncolors = [[0,0,0],[0,0]]", 5, 19, "list of colours"),
    (
        "[[textures]]\nname=\"t\"\ntype=\"solid\"\ncolors = [[0,0,0],[1,1,1]]",
        5,
        10,
        "takes one colour",
    ),
    ("[[textures]]\nname=\"t\"\ntype=\"checker\"\ncolors = [[0,0,0]]", 5, 10, "takes two colours"),
    ("[[textures]]\nname=\"t\"\ntype=\"image\"\nfile = \"\"", 5, 8, "give the path of a file"),
    (
        "[[textures]]\nname=\"t\"\ntype=\"wood\"\n[[textures]]\nname=\"t\"\ntype=\"wood\"",
        6,
        6,
        "textures.t.name: \"t\" names two textures; give each its own name",
    ),
    // Materials.
    ("[[materials]]\nname=\"a\"\ndiffuse = [0, 0, 1.5]", 4, 18, "numbers from 0 to 1, or the name"),
    ("[[materials]]\nname=\"a\"\ndiffuse = \"t\"", 4, 11, "there is no texture \"t\""),
    ("[[materials]]\nname=\"a\"\nspecular = [2, 0, 0]", 4, 13, "not a reflectance; give three"),
    ("[[materials]]\nname=\"a\"\nspecular = \"t\"", 4, 12, "\"t\" is not a reflectance"),
    ("[[materials]]\nname=\"ceramic\"\nalpha_x = -0.2", 4, 11, "-0.2 is not a roughness; give a"),
    ("[[materials]]\nname=\"a\"\nalpha_y = 0", 4, 11, "give a number above 0"),
    ("[[materials]]\nname=\"a\"\nalpha_y = 1e-300", 4, 11, "too close to 0 to compute with"),
    ("[[materials]]\nname=\"a\"\nward = \"dur\"", 4, 8, "did you mean \"duer\"?"),
    ("[[materials]]\nname=\"a\"\ntangent = [0, 0, 0.0]", 4, 11, "numbers that are not all 0"),
    ("[[materials]]\nname=\"a\"\nreflection = [0, 0, -0.5]", 4, 21, "not a reflectance"),
    ("[[materials]]\nname=\"a\"\ntransmission = [0, 1.1, 0]", 4, 20, "not a transmittance"),
    ("[[materials]]\nname=\"a\"\nior = 0", 4, 7, "0 is not an index of refraction"),
    ("[[materials]]\nname=\"a\"\nemission = [-1, 0, 0]", 4, 13, "not a radiance"),
    (
        "[[materials]]\nname=\"a\"\nbump = 3",
        4,
        8,
        "not a bump map; give { texture = …, height = … }",
    ),
    ("[[materials]]\nname=\"a\"\nbump = {texture=\"t\", height=1}", 4, 17, "there is no texture"),
    (
        "[[textures]]\nname=\"c\"\ntype=\"checker\"\n[[materials]]\nname=\"a\"\nbump={texture=\"c\",height=1}",
        7,
        15,
        "\"c\" is of type \"checker\", which has no slopes; give a noise or image texture",
    ),
    (
        "[[textures]]\nname=\"marble\"\ntype=\"marble\"\n[[materials]]\nname=\"a\"\ndiffuse=\"marbel\"",
        7,
        9,
        "there is no texture \"marbel\"; did you mean \"marble\"?",
    ),
    (
        "[[textures]]\nname=\"w\"\ntype=\"wood\"\n[[materials]]\nname=\"a\"\nbump={texture=\"w\",height=nan}",
        7,
        26,
        "nan is not finite; give a number",
    ),
    ("[[materials]]\nname=\"a\"\n[[materials]]\nname=\"a\"", 5, 6, "names two materials"),
    // Lights.
    ("[[lights]]\ntype=\"spot\"\nposition=[0,0,1]\npower=[1,1,1]", 3, 6, "not a type of light"),
    (
        "[[lights]]\ntype=\"sun\"\nposition=[0,0,0]\npower=[1,1,1]",
        2,
        1,
        "target: this is the light's own",
    ),
    (
        "[[lights]]\ntype=\"disk\"\nposition=[0,2,0]\ntarget = [0,2,0]\npower=[1,1,1]",
        5,
        10,
        "faces",
    ),
    ("[[lights]]\ntype=\"rectangle\"\nposition=[0,0,0]\npower=[1,1,1]", 2, 1, "own position"),
    ("[[lights]]\ntype=\"point\"\nposition=[0,0,1e13]\npower=[1,1,1]", 4, 15, "stay within 1e12"),
    ("[[lights]]\ntype=\"point\"\nposition=[0,0,1]\npower=[1,1,-1]", 5, 12, "not a power"),
    ("[[lights]]\ntype=\"point\"\nposition=[0,0,1]\npower=[1,1,1]\nup=[0,0,0]", 6, 4, "not all 0"),
    ("[[lights]]\ntype=\"point\"\nposition=[0,0,1]\npower=[1,1,1]\nsize=-1", 6, 6, "of at least 0"),
    (
        "[[lights]]\ntype=\"sphere\"\nposition=[0,0,1]\npower=[1,1,1]\nsize=[1,1]",
        6,
        6,
        "one number",
    ),
    (
        "[[lights]]\ntype=\"disk\"\nposition=[0,0,1]\npower=[1,1,1]\nsize=[1,1]",
        6,
        6,
        "its diameter",
    ),
    ("[[lights]]\ntype=\"sun\"\nposition=[0,0,1]\npower=[1,1,1]\nsize=180.5", 6, 6, "0 to 180"),
    ("[[lights]]\ntype=\"rectangle\"\nposition=[0,0,1]\npower=[1,1,1]\nsize=[0,1]", 6, 6, "or 0"),
    (
        "[[lights]]\ntype=\"rectangle\"\nposition=[0,0,1]\npower=[1,1,1]\nsize=[]",
        6,
        6,
        "one or two",
    ),
    (
        "[[lights]]\ntype=\"rectangle\"\nposition=[0,0,1]\npower=[1,1,1]\nsize=[1,2,3]",
        6,
        6,
        "or two",
    ),
    (
        "[[lights]]\ntype=\"point\"\nposition=[0,0,1]\npower=[1,1,1]\nvisible=\"no\"",
        6,
        9,
        "a switch",
    ),
    (
        "[[lights]]\ntype=\"point\"\nposition=[0,0,1]\npower=[1,1,1]\nenabled=0",
        6,
        9,
        "true or false",
    ),
    (
        "[[lights]]\nname=\"light-1\"\ntype=\"point\"\nposition=[0,0,1]\npower=[1,1,1]\n\
         [[lights]]\ntype=\"point\"\nposition=[0,0,1]\npower=[1,1,1]",
        7,
        1,
        "names two lights (the unnamed are light-1, light-2 and so on)",
    ),
    // Objects.
    ("[[objects]]\ntype=\"torus\"", 3, 6, "not a type of object"),
    ("[[objects]]\ntype=\"sphere\"\ncenter=[0,0,0]\nradius=0", 5, 8, "0 is not a radius"),
    ("[[objects]]\ntype=\"plane\"\npoint=[0,0,0]\nnormal=[0,0,0]", 5, 8, "not a direction"),
    ("[[objects]]\ntype=\"box\"\nmin=[0,0,0]\nmax=[1,-1,1]", 5, 5, "is below min [0.0, 0.0, 0.0]"),
    ("[[objects]]\ntype=\"cone\"\nbase=[0,1,0]\ntip=[0,1,0]\nradius=1", 5, 5, "where the base is"),
    ("[[objects]]\ntype=\"cylinder\"\nbase=[0,1,0]\ntop=[0,1,0]\nradius=1", 5, 5, "the base is"),
    ("[[objects]]\ntype=\"mesh\"\nfile=\"\"", 4, 6, "not a file"),
    ("[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\nnormals=\"hard\"", 5, 9, "kind of normals"),
    ("[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\ncrease_angle=181", 5, 14, "from 0 to 180"),
    ("[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\nscale=0", 5, 7, "other than 0"),
    ("[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\nscale=[1,0,1]", 5, 10, "or an array of three"),
    ("[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\nscale=[1,1]", 5, 7, "or an array of three"),
    (
        "[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\ntranslate=[0,nan,0]",
        5,
        14,
        "[0, nan, 0] is not finite",
    ),
    ("[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\nrotate=90", 5, 8, "90 is not a rotation"),
    (
        "[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\nmaterial=\"x\"",
        5,
        10,
        "there is no material \"x\"",
    ),
    ("[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\nenabled=0", 5, 9, "a switch"),
    // Used or not, every value must be good.
    ("[[objects]]\ntype=\"mesh\"\nfile=\"a.obj\"\nradius=-1", 5, 8, "not a radius"),
    (
        "[[objects]]\nenabled=false\ntype=\"mesh\"\nfile=\"a.obj\"\ncenter=[0,0,inf]",
        6,
        13,
        "inf] is not finite; give three numbers",
    ),
    (
        "[[objects]]\nname=\"a\"\ntype=\"mesh\"\nfile=\"a\"\n[[objects]]\nname=\"a\"\ntype=\"mesh\"\nfile=\"a\"",
        7,
        6,
        "names two objects; give",
    ),
    // Nothing of a file reaches a terminal as it is.
    ("\"\\u001b[31m\" = 5", 2, 1, "\\U0000001B[31m"),
    ("[[materials]]\nname=\"\\u001b[2J\"\nior=0", 4, 5, "materials.\"\\U0000001B[2J\".ior"),
    ("[[objects]]\ntype=\"\\u202ea\"", 3, 6, "\\U0000202Ea"),
    ("[render]\n\u{1b}[31m", 3, 2, "not TOML"),
];

#[test]
fn every_mistake_is_named_with_its_place() {
    for (snippet, line, column, fragment) in REFUSED {
        let error = read(snippet).map(|_| ()).expect_err(snippet);
        let place = format!("{line}:{column}: ");
        let text = error.to_string();
        assert!(text.starts_with(&place), "{snippet}\n{text}\nshould be at {place}");
        assert!(text.contains(fragment), "{snippet}\n{text}\nshould say {fragment}");
        assert!(!text.contains(|c: char| c.is_control() || c == '\u{202e}'), "{text:?}");
        assert!(text.chars().count() < 400, "{text}");
    }
}

#[test]
fn mistakes_of_the_camera_are_named_with_their_place() {
    for (text, line, column, fragment) in [
        ("", 1, 1, "camera.eye: this key is required; give three numbers"),
        ("\n\n[camera]\neye=[0,0,1]", 3, 1, "camera.target: this key is required"),
        ("[camera]\ntarget=[0,0,1]", 1, 1, "camera.eye: this key is required"),
        ("camera.eye=[0,0,1]", 1, 1, "camera.target: this key is required"),
        (
            "[camera]\neye=[0,0,1]\ntarget=[0,0,1]",
            3,
            8,
            "target: this is where the eye is; give another",
        ),
        ("[camera]\neye=[0,0,1]\ntarget=[0,0,1.0000000001]", 3, 8, "is where the eye is"),
        ("[camera]\neye=[0,0,1]\ntarget=[0,0,0]\nup=[0,0,-3]", 4, 4, "is parallel to the view"),
        ("[camera]\neye=[0,9,0]\ntarget=[0,0,0]", 1, 1, "camera.up: [0.0, 1.0, 0.0] is parallel"),
        ("[camera]\neye=[0,0,1]\ntarget=[0,0,0]\nup=[0,0,0]", 4, 4, "not all 0"),
        ("[camera]\neye=[0,0,1]\ntarget=[0,0,0]\nvertical_fov=180", 4, 14, "above 0 and below 180"),
        (
            "[camera]\neye=[0,0,1]\ntarget=[0,0,0]\nvertical_fov=0",
            4,
            14,
            "0 is not an angle of view",
        ),
        ("[camera]\neye=[0,0,1]\ntarget=[0,0,0]\naperture_radius=-1", 4, 17, "of at least 0"),
        ("[camera]\neye=[0,0,1]\ntarget=[0,0,0]\nfocal_distance=0", 4, 16, "above 0"),
        ("[camera]\neye=[0,0,1]\ntarget=[0,0,0]\naperture_blades=2", 4, 17, "from 3 to 16"),
        ("[camera]\neye=[0,0,1]\ntarget=[0,0,0]\naperture_blades=17", 4, 17, "0 for a round lens"),
        ("[camera]\neye=[0,\"a\",1]\ntarget=[0,0,0]", 2, 8, "[0, \"a\", 1] is not a point"),
        ("\u{feff}[camera]\r\neye=[0,0,1]\r\ntarget=5", 3, 8, "5 is not a point"),
        ("# é\n[camera]\neyé=1", 3, 3, "not TOML"),
        ("\u{feff}rendr = 1", 1, 1, "there is no section \"rendr\""),
        ("[camera]\n'é'=1", 2, 1, "camera.\"é\": there is no such key"),
    ] {
        let error = parse(text, &[]).map(|_| ()).expect_err(text).to_string();
        assert!(error.starts_with(&format!("{line}:{column}: ")), "{text}\n{error}");
        assert!(error.contains(fragment), "{text}\n{error}\nshould say {fragment}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: prop::test_runner::RngSeed::Fixed(2),
        failure_persistence: None,
        ..ProptestConfig::with_cases(2000)
    })]

    /// Whatever is done to a file, it is read or refused with one clean line.
    #[test]
    fn damaged_files_never_panic(
        at in any::<prop::sample::Index>(),
        n_removed in 0..40_usize,
        inserted in prop_oneof![
            proptest::collection::vec(any::<char>(), 0..5).prop_map(String::from_iter),
            prop::sample::select(vec![
                "=", ".", "\"", "'''", "[", "]]", "{", "\n", "nan", "-1e999", "[camera]",
                "[[lights]]\n", "name = 1\n", "\u{feff}", "\r", "1979-05-27", "0x", "#",
            ]).prop_map(String::from),
        ],
    ) {
        let letters: Vec<char> = FULL.chars().collect();
        let start = at.index(letters.len());
        let end = (start + n_removed).min(letters.len());
        let mut text = String::from_iter(&letters[..start]);
        text.push_str(&inserted);
        text.extend(&letters[end..]);
        if let Err(error) = parse(&text, &[]) {
            let message = error.to_string();
            prop_assert!(!message.contains(|c: char| c.is_control()), "{:?}", message);
            let line: usize = message.split(':').next().unwrap().parse().unwrap();
            prop_assert!(line <= text.lines().count() + 1, "{}", message);
        }
    }
}

//! The real program on small files: every option, every exit status, every output.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use image::Rgb32FImage;

mod failures;
mod gallery;
mod info;
mod render;
#[cfg(target_os = "linux")]
mod scarce;
mod snapshots;

/// A scene of a ball and a box under two lights, 16 x 9 pixels, 4 samples.
pub(crate) const BALL: &str = r#"[render]
width = 16
height = 9
samples = 4
[camera]
eye = [0.0, 1.0, 5.0]
target = [0.0, 0.0, 0.0]
aperture_radius = 0.05
[environment]
ambient = [0.05, 0.05, 0.05]
background = [0.1, 0.2, 0.4]
[[materials]]
name = "clay"
diffuse = [0.7, 0.4, 0.2]
specular = [0.2, 0.2, 0.2]
[[materials]]
name = "glass"
transmission = [0.9, 0.95, 0.9]
[[lights]]
name = "key"
type = "disk"
position = [2.0, 4.0, 3.0]
size = 1.5
power = [200.0, 180.0, 150.0]
[[lights]]
name = "spark"
type = "point"
position = [-2.0, 1.0, 2.0]
power = [20.0, 20.0, 30.0]
[[objects]]
name = "ball"
type = "sphere"
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "clay"
[[objects]]
name = "block"
type = "box"
min = [0.9, -1.0, 0.4]
max = [1.5, 0.2, 1.0]
material = "glass"
"#;

/// A square of two triangles and a triangle above it, with a material library.
pub(crate) const MESH: &str = "mtllib m.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 2 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl red\nf 1/1 4/4 3/3 2/2\nusemtl blue\nf 1 5 2\n";

/// The library of [`MESH`]; the red is multiplied by a picture.
pub(crate) const LIBRARY: &str =
    "newmtl red\nKd 0.9 0.1 0.1\nmap_Kd m.png\nnewmtl blue\nKd 0 0 1\n";

/// A folder with files, and the program run in it.
pub(crate) struct Place {
    folder: tempfile::TempDir,
}

/// What the program did.
pub(crate) struct Run {
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Place {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn with(files: &[(&str, &str)]) -> Self {
        let place = Self::new();
        for (name, text) in files {
            place.write(name, text.as_bytes());
        }
        place
    }

    /// With the scene of a ball in `ball.toml`.
    pub(crate) fn with_ball() -> Self {
        Self::with(&[("ball.toml", BALL)])
    }

    /// With a mesh, its library and its picture.
    pub(crate) fn with_mesh() -> Self {
        let place = Self::with(&[("m.obj", MESH), ("m.mtl", LIBRARY)]);
        place.write("m.png", &checkered_png());
        place
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_penumbra"));
        command.current_dir(self.folder.path()).stdin(Stdio::null());
        for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(variable);
        }
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Run {
        Run::of(self.command().args(arguments))
    }

    /// Runs what has to succeed.
    pub(crate) fn ok(&self, arguments: &[&str]) -> Run {
        let run = self.run(arguments);
        assert_eq!(run.status, Some(0), "{arguments:?}: {}", run.stderr);
        run
    }

    /// Runs what has to fail with this status, and gives its message.
    pub(crate) fn fails(&self, status: i32, arguments: &[&str]) -> String {
        let run = self.run(arguments);
        let Run { stdout, stderr, .. } = run;
        assert_eq!(run.status, Some(status), "{arguments:?}: {stderr}{stdout}");
        assert!(stderr.starts_with("error: "), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
        let is_quiet = stdout.is_empty();
        assert!(is_quiet, "{arguments:?} wrote {stdout}");
        stderr
    }

    /// A picture of the ball scene with these options.
    pub(crate) fn ball_png(&self, out: &str, options: &[&str]) -> Vec<u8> {
        self.ok(&[&["render", "ball.toml", "-o", out], options].concat());
        self.read(out)
    }
}

impl Run {
    pub(crate) fn of(command: &mut Command) -> Self {
        let output = command.output().unwrap();
        let text = |bytes| String::from_utf8(bytes).expect("output is text");
        let run = Self {
            status: output.status.code(),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        };
        let is_control = |c: char| c.is_control() && c != '\n';
        let all = format!("{}{}", run.stdout, run.stderr);
        assert!(!all.contains(is_control), "control characters in {all:?}");
        run
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        assert_eq!(self.stdout.lines().count(), 1, "one object: {}", self.stdout);
        serde_json::from_str(&self.stdout).unwrap()
    }
}

/// Keys of a JSON object, sorted.
pub(crate) fn keys(value: &serde_json::Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

/// Width, height, 8-bit pixels and texts of a PNG.
pub(crate) struct Png {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: Vec<u8>,
    pub(crate) texts: Vec<(String, String)>,
}

impl Png {
    pub(crate) fn read(bytes: &[u8]) -> Self {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        assert_eq!(frame.color_type, png::ColorType::Rgb, "colours");
        assert_eq!(frame.bit_depth, png::BitDepth::Eight, "depth");
        let info = reader.info();
        let texts =
            info.utf8_text.iter().map(|text| (text.keyword.clone(), text.get_text().unwrap()));
        let texts = texts.collect();
        let is_plain = info.uncompressed_latin1_text.is_empty()
            && info.compressed_latin1_text.is_empty()
            && info.exif_metadata.is_none();
        assert!(is_plain, "nothing else is said");
        Self { width: frame.width, height: frame.height, pixels, texts }
    }

    pub(crate) fn text(&self, keyword: &str) -> &str {
        &self.texts.iter().find(|(key, _)| key == keyword).unwrap().1
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        for (keyword, text) in &self.texts {
            encoder.add_itxt_chunk(keyword.clone(), text.clone()).unwrap();
        }
        encoder.write_header().unwrap().write_image_data(&self.pixels).unwrap();
        bytes
    }
}

/// The linear pixels of an EXR or HDR file.
pub(crate) fn linear(path: &Path) -> Rgb32FImage {
    image::open(path).unwrap().into_rgb32f()
}

/// A PNG of 2 x 2 pixels.
pub(crate) fn checkered_png() -> Vec<u8> {
    let pixels = vec![255, 255, 255, 90, 90, 90, 90, 90, 90, 255, 255, 255];
    Png { width: 2, height: 2, pixels, texts: Vec::new() }.bytes()
}

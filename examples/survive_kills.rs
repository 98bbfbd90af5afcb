//! Kills programs while they write, and looks at what is left: `survive_kills [KILLS [FOLDER]]`.
//!
//! This program starts itself as a writer that saves a scene, settings and the copy kept for a
//! crash over and over, and adds snapshots, all by the functions that the program itself writes
//! with. The writer is killed at a random moment, and every file has to be whole: an older version,
//! or a newer one. Half of the kills hit `penumbra render` instead, if it is built beside this.

#![expect(clippy::print_stdout, reason = "a program for a terminal")]

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use penumbra::io::output::{create_file, encode_png, replace_file};
use penumbra::io::{scene_file, snapshot};
use penumbra::scene::description::SceneDescription;

/// Makes this program a writer in the folder that it names.
const WRITER: &str = "--writer";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let first = arguments.next();
    if first.as_deref() == Some(WRITER) {
        let folder = PathBuf::from(arguments.next().expect("a folder"));
        let version = arguments.next().and_then(|n| n.parse().ok()).expect("a version");
        write_for_ever(&folder, version);
    }
    let n_kills = first.map_or(300, |n| n.parse().expect("how many kills"));
    let folder = arguments.next().map_or_else(std::env::temp_dir, PathBuf::from);
    let folder = folder.join(format!("survive-kills-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder to write in");
    let start = Instant::now();
    let mut survived = Survived::default();
    let mut moment = 0x2545_f491_4f6c_dd1d_u64;
    for kill in 0..n_kills {
        moment ^= moment << 13;
        moment ^= moment >> 7;
        moment ^= moment << 17;
        let micros = moment % 40_000;
        if kill % 2 == 1 && penumbra().is_file() {
            kill_render(&folder, kill, Duration::from_micros(micros));
        } else {
            kill_writer(&folder, &mut survived, Duration::from_micros(micros));
        }
        survived.check(&folder);
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("{n_kills} kills in {seconds:.0} s; whole afterwards, every time: {survived:?}");
    std::fs::remove_dir_all(&folder).expect("the folder can be removed");
    ExitCode::SUCCESS
}

/// What was found, and how far each file has come.
#[derive(Debug, Default)]
struct Survived {
    newest_told: u32,
    scenes: u32,
    settings: u32,
    copies: u32,
    snapshots: u32,
    renders: u32,
    left_behind: usize,
}

/// The scene of a version: longer and shorter in turn, so that a mixture of two is no scene.
fn scene(version: u32) -> SceneDescription {
    let mut text = format!(
        "camera = {{ eye = [0, 0, 5], target = [0, 0, 0] }}\n\
         render = {{ width = 48, height = 32, samples = 1, seed = {version} }}\n"
    );
    for index in 0..(version % 7) * 300 {
        text += &format!("[[objects]]\ntype = \"sphere\"\ncenter = [{index}, 0, 0]\nradius = 1\n");
    }
    scene_file::parse(&text, &[]).expect("a valid scene")
}

fn picture(version: u32) -> Vec<u8> {
    let texts = snapshot::texts(&scene(version), (48, 32), 1, &[], None).expect("a record");
    let pixels: Vec<u8> = (0..48 * 32 * 3).map(|i| (i * version % 251) as u8).collect();
    encode_png((48, 32), &pixels, &texts).expect("a picture")
}

fn settings(version: u32) -> String {
    format!("version = {version}\nrecent = [{}]\n", "\"a.toml\", ".repeat(version as usize % 50))
}

fn write_for_ever(folder: &Path, from: u32) -> ! {
    for version in from.. {
        let text = scene_file::write(&scene(version));
        let picture = picture(version);
        replace_file(&folder.join("scene.toml"), text.as_bytes()).expect("a scene");
        replace_file(&folder.join("settings.toml"), settings(version).as_bytes())
            .expect("settings");
        replace_file(&folder.join("recovery.png"), &picture).expect("a copy");
        create_file(&folder.join(format!("shot-{version:06}.png")), &picture).expect("a snapshot");
        println!("{version}");
        std::io::stdout().flush().expect("somebody listens");
    }
    unreachable!("the versions do not end")
}

fn kill_writer(folder: &Path, survived: &mut Survived, after: Duration) {
    let own = std::env::current_exe().expect("this program");
    let from = (survived.newest_told + 2).to_string();
    let mut child = Command::new(own)
        .args([WRITER, folder.to_str().expect("a plain path"), &from])
        .stdout(Stdio::piped())
        .spawn()
        .expect("the writer starts");
    let mut lines = BufReader::new(child.stdout.take().expect("it is piped")).lines();
    // It has begun to write when it has told of its first version.
    let first = lines.next().and_then(Result::ok);
    kill(child, after);
    let told = first.into_iter().chain(lines.map_while(Result::ok));
    let newest = told.filter_map(|line| line.parse().ok()).max();
    survived.newest_told = newest.unwrap_or(survived.newest_told);
}

/// The program, where cargo puts it beside the examples.
fn penumbra() -> PathBuf {
    let own = std::env::current_exe().expect("this program");
    let folder = own.parent().and_then(Path::parent).expect("two folders up");
    folder.join("penumbra")
}

fn kill_render(folder: &Path, kill_number: u32, after: Duration) {
    let file = folder.join("input.toml");
    replace_file(&file, scene_file::write(&scene(kill_number)).as_bytes()).expect("an input");
    let child = Command::new(penumbra())
        .args(["render", "--quiet", "-o"])
        .args([&folder.join("render.png"), &file])
        .spawn()
        .expect("penumbra starts");
    kill(child, after);
}

fn kill(mut child: Child, after: Duration) {
    let start = Instant::now();
    while start.elapsed() < after {
        std::hint::spin_loop();
    }
    child.kill().expect("it can be killed");
    child.wait().expect("it is gone");
}

impl Survived {
    fn check(&mut self, folder: &Path) {
        let read = |name: &str| std::fs::read(folder.join(name)).ok();
        let mut version_of = Vec::new();
        if let Some(bytes) = read("scene.toml") {
            let text = scene_file::text_of(bytes).expect("a whole scene");
            let found = scene_file::parse(&text, &[]).expect("a whole scene");
            assert!(found == scene(found.render.seed), "scene.toml is a mixture");
            version_of.push(found.render.seed);
            self.scenes += 1;
        }
        if let Some(bytes) = read("settings.toml") {
            let text = String::from_utf8(bytes).expect("whole settings");
            let first = text.lines().next().and_then(|line| line.strip_prefix("version = "));
            let version = first.and_then(|n| n.parse().ok()).expect("whole settings");
            assert!(text == settings(version), "settings.toml is a mixture");
            version_of.push(version);
            self.settings += 1;
        }
        if let Some(bytes) = read("recovery.png") {
            version_of.push(check_picture(&bytes));
            self.copies += 1;
        }
        for version in version_of {
            assert!(self.newest_told <= version, "what was told as written is older on disk");
        }
        if let Some(bytes) = read("render.png") {
            let found = snapshot::read(&bytes, Path::new("render.png")).expect("a whole picture");
            let pixels = snapshot::read_pixels(&bytes, (48, 32)).expect("whole pixels");
            assert_eq!(pixels.len(), 48 * 32 * 3, "{}", found.scene);
            self.renders += 1;
        }
        self.left_behind = 0;
        for entry in std::fs::read_dir(folder).expect("the folder is there") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().and_then(|name| name.to_str()).expect("a plain name");
            if name.starts_with("shot-") {
                check_picture(&std::fs::read(&path).expect("it is there"));
                self.snapshots += 1;
                std::fs::remove_file(&path).expect("it can be removed");
            } else if name.starts_with(".penumbra-") {
                self.left_behind += 1;
            }
        }
    }
}

/// The version of a picture that is one whole of [`picture`].
fn check_picture(bytes: &[u8]) -> u32 {
    let found = snapshot::read(bytes, Path::new("a.png")).expect("a whole picture");
    let version = found.record.seed;
    assert!(bytes == picture(version), "a picture is a mixture");
    version
}

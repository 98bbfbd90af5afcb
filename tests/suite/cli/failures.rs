//! What is wrong is said in one message, with the right exit status, and nothing is lost.

use std::io::{BufRead as _, BufReader};
use std::process::Stdio;
use std::time::{Duration, Instant};

use super::{BALL, MESH, Place, Run};

#[test]
fn wrong_command_lines_are_status_2() {
    let place = Place::with_ball();
    place.write("a.png", b"as it was");
    for arguments in [
        &["render"][..],
        &["render", "ball.toml"],
        &["render", "ball.toml", "-o"],
        &["render", "-o", "a.png"],
        &["render", "ball.toml", "-o", "a.jpg"],
        &["render", "ball.toml", "-o", "a"],
        &["render", "ball.toml", "-o", "a.png.txt"],
        &["render", "ball.toml", "-o", "a.png", "--samples", "0"],
        &["render", "ball.toml", "-o", "a.png", "-s", "1048577"],
        &["render", "ball.toml", "-o", "a.png", "-s", "many"],
        &["render", "ball.toml", "-o", "a.png", "-s", "-1"],
        &["render", "ball.toml", "-o", "a.png", "-s", "1.5"],
        &["render", "ball.toml", "-o", "a.png", "--width", "0"],
        &["render", "ball.toml", "-o", "a.png", "--height", "16385"],
        &["render", "ball.toml", "-o", "a.png", "--seed", "4294967296"],
        &["render", "ball.toml", "-o", "a.png", "--threads", "0"],
        &["render", "ball.toml", "-o", "a.png", "--time", "nan"],
        &["render", "ball.toml", "-o", "a.png", "--time", "-1"],
        &["render", "ball.toml", "-o", "a.png", "--noise", "inf"],
        &["render", "ball.toml", "-o", "a.png", "--accelerator", "octree"],
        &["render", "ball.toml", "-o", "a.png", "--sample", "1"],
        &["render", "ball.toml", "-o", "a.png", "--set"],
        &["render", "ball.toml", "-o", "a.png", "--set", "render.samples"],
        &["render", "ball.toml", "-o", "a.png", "--set", "render.samples=1.2.3"],
        &["render", "ball.toml", "-o", "a.png", "--set", "render.samples=[1, 2"],
        &["render", "ball.toml", "-o", "a.png", "--set", "render.sampels=4"],
        &["render", "ball.toml", "-o", "a.png", "--set", "objects.bell.radius=4"],
        &["render", "ball.toml", "-o", "a.png", "--set", "camera=4"],
        &["render", "ball.toml", "-o", "a.png", "--set", "camera.eye.x=4"],
        &["render", "ball.toml", "-o", "a.png", "extra"],
        &["info"],
        &["info", "ball.toml", "--yaml"],
        &["verify"],
        &["draw", "ball.toml"],
    ] {
        place.fails(2, arguments);
    }
    assert_eq!(place.read("a.png"), b"as it was", "the old file");
}

#[test]
fn anything_else_is_status_1_and_says_where() {
    let place = Place::with_ball();
    place.write("a.png", b"as it was");
    place.write("folder/inside", b"");
    place.write("unknown.toml", BALL.replace("samples = 4", "smaples = 4").as_bytes());
    place.write("range.toml", BALL.replace("radius = 1.0", "radius = -1.0").as_bytes());
    place.write("broken.toml", b"[camera\neye = 1\n");
    place.write("name.toml", BALL.replace("material = \"clay\"", "material = \"cly\"").as_bytes());
    place.write(
        "mesh.toml",
        format!("{BALL}[[objects]]\ntype = 'mesh'\nfile = 'no.obj'\n").as_bytes(),
    );
    place.write("bad.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    place.write(
        "inside.toml",
        format!("{BALL}[[objects]]\ntype = 'mesh'\nfile = 'bad.obj'\n").as_bytes(),
    );
    for (file, says) in [
        ("missing.toml", &["missing.toml: no such file"][..]),
        ("folder", &["folder: is a folder"]),
        ("unknown.toml", &["unknown.toml:4:1:", "smaples", "samples"]),
        ("range.toml", &["range.toml:34:10:", "objects.ball.radius", "above 0"]),
        ("broken.toml", &["broken.toml:1:"]),
        ("name.toml", &["name.toml:35:12:", "cly", "clay"]),
        ("mesh.toml", &["mesh.toml:44:8:", "no.obj"]),
        ("bad.obj", &["bad.obj: line 4", "9", "3"]),
        ("inside.toml", &["inside.toml:44:8:", "bad.obj: line 4"]),
    ] {
        let error = place.fails(1, &["render", file, "-o", "a.png"]);
        for part in says {
            assert!(error.contains(part), "{file}: {error:?} does not say {part:?}");
        }
        assert_eq!(error.lines().count(), 1, "{file}: {error}");
        assert_eq!(error, place.fails(1, &["info", file]), "info says the same");
    }
    for (set, says) in [
        ("render.samples=0", "render.samples"),
        ("objects.ball.radius=big", "objects.ball.radius"),
        ("objects.ball.material=cly", "objects.ball.material"),
        ("camera.eye=[0, 0, 0]", "camera.target"),
    ] {
        let error = place.fails(1, &["render", "ball.toml", "-o", "a.png", "--set", set]);
        assert!(error.contains("--set") && error.contains(says), "{set}: {error}");
    }
    assert_eq!(place.read("a.png"), b"as it was", "the old file");
}

#[test]
fn outputs_that_cannot_be_written_are_named_before_anything_is_read() {
    let place = Place::with_ball();
    place.write("folder.png/inside", b"");
    place.write("file", b"");
    for out in ["nowhere/a.png", "folder.png", "file/a.png", "/proc/a.png"] {
        let error = place.fails(1, &["render", "missing.toml", "-o", out]);
        let place_name = out.split('/').next().unwrap();
        assert!(error.contains(place_name), "{out}: {error}");
    }
}

#[test]
fn a_picture_takes_the_place_of_nothing_that_it_is_made_of() {
    let place = Place::with_ball();
    place.ok(&["render", "ball.toml", "-o", "wood.png", "-s", "1"]);
    let wood = place.read("wood.png");
    let texture = "[[textures]]\nname = 'wood'\ntype = 'image'\nfile = 'wood.png'\n";
    place.write("textured.toml", format!("{BALL}{texture}").as_bytes());
    for out in ["wood.png", "./wood.png"] {
        let error = place.fails(1, &["render", "textured.toml", "-o", out]);
        assert!(error.contains("wood.png") && error.contains("another name"), "{error}");
    }
    assert_eq!(place.read("wood.png"), wood, "the texture");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(place.path("ball.toml"), place.path("link.png")).unwrap();
        let error = place.fails(1, &["render", "ball.toml", "-o", "link.png"]);
        assert!(error.contains("link.png"), "{error}");
        assert_eq!(place.read("ball.toml"), BALL.as_bytes(), "the scene");
    }
    // A snapshot carries the same scene on.
    place.ok(&["render", "wood.png", "-o", "wood.png", "-s", "2"]);
    assert_ne!(place.read("wood.png"), wood, "more samples");
}

/// A real one, of 64 KiB, where the system lets anybody mount it.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_old_file_and_nothing_else() {
    let place = Place::with_ball();
    place.write("full/below", b"");
    let script = "mount -t tmpfs -o size=64k penumbra full || { echo none; exit 1; }
        printf 'as it was' >full/a.exr; TMPDIR=/dev/null/none \"$0\" render ball.toml \
        -o full/a.exr --width 200 --height 200; status=$?; cat full/a.exr; ls -A full; exit $status";
    let mut command = std::process::Command::new("unshare");
    command.args(["--user", "--map-root-user", "--mount", "sh", "-c", script]);
    command.arg(env!("CARGO_BIN_EXE_penumbra")).current_dir(place.path(""));
    let run = Run::of(&mut command);
    if run.stdout.starts_with("none") || run.stderr.starts_with("unshare: ") {
        eprintln!("not tested: this system mounts no disk for it");
        return;
    }
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    let is_plain =
        run.stderr.contains("a.exr: cannot be written") && !run.stderr.contains(".penumbra-");
    assert!(is_plain, "{}", run.stderr);
    assert_eq!(run.stdout, "as it wasa.exr\n", "the old file, and nothing beside it");
}

#[cfg(unix)]
#[test]
fn a_picture_whose_place_is_gone_when_it_is_done_is_kept_elsewhere() {
    let place = Place::with(&[("m.obj", MESH)]);
    place.write("gone/inside", b"");
    place.write("elsewhere/inside", b"");
    let mut child = place
        .command()
        .args(["render", "m.obj", "-o", "gone/a.png", "--width", "8", "--height", "6"])
        .args(["-s", "1048576", "--time", "1"])
        .env("TMPDIR", place.path("elsewhere"))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // It warns of a library that is not there when all is read and nothing is rendered yet.
    let mut words = BufReader::new(child.stderr.take().unwrap()).lines();
    let first = words.next().unwrap().unwrap();
    assert!(first.starts_with("warning: "), "{first}");
    std::fs::remove_dir_all(place.path("gone")).unwrap();
    let last = words.last().unwrap().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{last}");
    let (reason, kept) = last.split_once("; the picture is in ").expect(&last);
    assert!(reason.contains("gone/a.png: cannot be written"), "{last}");
    let bytes = std::fs::read(kept).unwrap();
    assert_eq!(super::Png::read(&bytes).width, 8, "the picture that was kept");
}

#[cfg(unix)]
#[test]
fn a_killed_run_leaves_the_old_file_or_the_new_one() {
    let place = Place::with_ball();
    let new = place.ball_png("a.png", &[]);
    let mut n_old = 0;
    for i in 0..24 {
        place.write("a.png", b"as it was");
        let mut child = place
            .command()
            .args(["render", "ball.toml", "-o", "a.png"])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while start.elapsed() < Duration::from_micros(800 * i) {
            std::thread::yield_now();
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let found = place.read("a.png");
        let is_old = found == b"as it was";
        n_old += usize::from(is_old);
        assert!(is_old || found == new, "{} bytes after {i}", found.len());
    }
    assert!(n_old > 0, "no run was killed in time");
}

#[test]
fn special_files_are_refused_at_once() {
    let place = Place::with_ball();
    place.write("folder/inside", b"");
    let scene = |file: &str| format!("{BALL}[[objects]]\ntype = 'mesh'\nfile = '{file}'\n");
    let fifo = place.path("fifo");
    let made = std::process::Command::new("mkfifo").arg(&fifo).status().unwrap();
    assert!(made.success(), "mkfifo");
    for file in ["/dev/null", "/dev/zero", "/dev/random", "folder", "fifo"] {
        let error = place.fails(1, &["info", file]);
        assert!(error.contains(file), "{file}: {error}");
        place.write("s.toml", scene(file).as_bytes());
        let error = place.fails(1, &["info", "s.toml"]);
        let is_located =
            error.contains("s.toml:44:8: objects.object-1.file") && error.contains(file);
        assert!(is_located, "{file}: {error}");
    }
}

#[test]
fn control_characters_reach_no_terminal() {
    // `Run::of` looks for them in everything that is printed.
    let place = Place::with_ball();
    let bad = "x\u{1b}[31m\u{7}\u{202e}\u{9b}";
    place.run(&["info", bad]);
    place.run(&["render", bad, "-o", "a.png"]);
    place.run(&["render", "ball.toml", "-o", bad]);
    place.run(&["render", "ball.toml", "-o", &format!("{bad}/a.png")]);
    place.run(&["render", "ball.toml", "-o", &format!("/proc/{bad}.png")]);
    place.run(&["render", "ball.toml", "-o", "a.png", bad]);
    place.run(&["render", "ball.toml", "-o", "a.png", "--set", bad]);
    place.run(&["render", "ball.toml", "-o", "a.png", "--set", &format!("render.samples={bad}")]);
    place.run(&["render", "ball.toml", "-o", "a.png", "--accelerator", bad]);
    place.run(&["verify", bad]);
    place.run(&[&format!("--{bad}")]);
    let escaped = "x\\u001b[31m\\u0007\\u009b";
    for scene in [
        format!("\"{escaped}\" = 1\n"),
        format!("{BALL}[[objects]]\nname = \"{escaped}\"\ntype = \"mesh\"\nfile = \"{escaped}\"\n"),
        format!("{BALL}[[objects]]\nname = \"{escaped}\"\ntype = \"{escaped}\"\n"),
        format!("{BALL}[[objects]]\ntype = \"mesh\"\nfile = \"m.obj\"\nmaterial = \"{escaped}\"\n"),
        format!("{BALL}[[textures]]\nname = \"t\"\ntype = \"image\"\nfile = \"{escaped}\"\n"),
        format!("[camera]\neye = {bad}\n"),
    ] {
        place.write("s.toml", scene.as_bytes());
        place.fails(1, &["info", "s.toml"]);
    }
    for mesh in [
        format!("mtllib {bad}.mtl\nusemtl {bad}\n{MESH}"),
        format!("{bad} 1\n{MESH}"),
        format!("v {bad}\n"),
        format!("f {bad}\n"),
    ] {
        place.write("m.obj", mesh.as_bytes());
        place.write("m.mtl", format!("newmtl {bad}\nKd {bad}\nmap_Kd {bad}\n{bad}\n").as_bytes());
        place.run(&["info", "m.obj"]);
    }
    place.write(&format!("{bad}.obj"), MESH.as_bytes());
    place.run(&[
        "render",
        &format!("{bad}.obj"),
        "-o",
        &format!("{bad}.png"),
        "--json",
        "-s",
        "1",
        "--width",
        "9",
    ]);
    place.run(&["verify", &format!("{bad}.png")]);
}

#[test]
fn a_result_that_reaches_nobody_is_an_error_and_no_panic() {
    let place = Place::with_ball();
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    for arguments in [&["info", "ball.toml"][..], &["info", "ball.toml", "--json"]] {
        let run = place.command().args(arguments).stdout(full()).output().unwrap();
        let error = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(1), "{error}");
        assert!(error.contains("standard output") && !error.contains("panicked"), "{error}");
    }
    let status = place.command().arg("--help").stdout(full()).status().unwrap();
    assert_eq!(status.code(), Some(1), "help that nobody reads");
    let status = place.command().args(["info", "gone.toml"]).stderr(full()).status().unwrap();
    assert_eq!(status.code(), Some(1), "an error that nobody hears");
}

#[test]
fn without_a_display_the_window_says_so_in_one_line() {
    let place = Place::with_ball();
    for arguments in [&[][..], &["ball.toml"]] {
        let run = place.run(arguments);
        assert_eq!(run.status, Some(1), "{}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
        assert!(run.stderr.contains("penumbra render"), "{}", run.stderr);
    }
}

/// Some have a display that is none.
#[test]
fn a_display_that_does_not_answer_is_told_in_one_line() {
    let place = Place::with_ball();
    for (variable, value) in [("DISPLAY", ":4000"), ("WAYLAND_DISPLAY", "wayland-4000")] {
        let mut command = place.command();
        let run = Run::of(command.env(variable, value).env("XDG_RUNTIME_DIR", place.path("")));
        assert_eq!(run.status, Some(1), "{variable}: {}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{variable}: {}", run.stderr);
        assert!(run.stderr.contains("penumbra render"), "{variable}: {}", run.stderr);
    }
}

#[test]
fn a_mistake_of_the_program_leaves_a_report() {
    let place = Place::with_ball();
    let own = place.path("own");
    let folders = [("XDG_DATA_HOME", &own), ("TMPDIR", &own)];
    for number in ["crash-01.txt", "crash-02.txt"] {
        let mut command = place.command();
        command.args(["render", "ball.toml", "-o", "a.png"]).env("PENUMBRA_MISTAKE", "1");
        let run = Run::of(command.envs(folders).env_remove("RUST_BACKTRACE"));
        assert_eq!(run.status, Some(1), "{}", run.stderr);
        let is_told =
            run.stderr.starts_with("error: penumbra made a mistake: a mistake on purpose")
                && run.stderr.contains(number)
                && run.stderr.lines().count() == 1;
        assert!(is_told, "{}", run.stderr);
    }
    let report = ["own/penumbra/crash-01.txt", "own/crash-01.txt"]
        .iter()
        .find_map(|name| std::fs::read_to_string(place.path(name)).ok())
        .expect("a report");
    for part in [env!("CARGO_PKG_VERSION"), "a mistake on purpose", "crash.rs:", "rehearse", BALL] {
        assert!(report.contains(part), "{part} is missing:\n{report}");
    }
    assert!(!place.path("a.png").exists(), "a picture of a mistake");
}

/// The decoder panics on this palette.
#[test]
fn a_decoder_that_gives_up_is_no_mistake_of_the_program() {
    let place = Place::new();
    place.write("t.png", include_bytes!("../../corpus/snapshot/palette-of-odd-length"));
    let texture = "[[textures]]\nname = 't'\ntype = 'image'\nfile = 't.png'\n";
    place.write("s.toml", format!("{BALL}{texture}").as_bytes());
    let error = place.fails(1, &["info", "s.toml"]);
    let is_plain = error.lines().count() == 1 && error.contains("t.png: damaged or incomplete PNG");
    assert!(is_plain, "{error}");
}

#[test]
fn help_and_version_are_no_errors() {
    let place = Place::new();
    for arguments in [&["--help"][..], &["render", "--help"], &["info", "-h"], &["--version"]] {
        let run = place.ok(arguments);
        assert!(run.stdout.contains("penumbra"), "{}", run.stdout);
        assert_eq!(run.stderr, "", "{arguments:?}");
    }
}

pub(super) fn files_in(place: &Place) -> Vec<String> {
    let entries = std::fs::read_dir(place.path("")).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

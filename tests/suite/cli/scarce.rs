//! Systems with little memory and few threads. Limits of address space stand for any.

use super::{BALL, Place, Run};

/// Where nobody asks for a number of threads, few do; where somebody does, it is these or none.
/// Limits of address space stand for any system that runs out of threads.
#[test]
fn a_system_without_threads_or_memory_is_told_with_what_would_help() {
    let place = Place::with_ball();
    let limited = |kibibytes, options: &str| {
        run_within(&place, kibibytes, &format!("render ball.toml -o a.png {options}"))
    };
    let run = limited(1 << 20, "-t 1024");
    let needs = "error: starting 1024 threads takes 66.1 GiB of memory, and ";
    let is_told = run.stderr.starts_with(needs) && run.stderr.contains("give a smaller number");
    assert!(run.status == Some(1) && is_told, "{:?}: {}", run.status, run.stderr);
    let run = limited(1 << 20, "-t 12");
    assert_eq!(run.status, Some(0), "12 threads: {}", run.stderr);
    std::fs::remove_file(place.path("a.png")).unwrap();
    let run = limited(1 << 20, "--width 4000 --height 3000");
    let needs = "error: a picture of 4000 x 3000 pixels takes 1.6 GiB of memory, and ";
    let is_told = run.stderr.starts_with(needs) && run.stderr.contains("MiB are free");
    assert!(run.status == Some(1) && is_told, "{:?}: {}", run.status, run.stderr);
    assert_eq!(super::failures::files_in(&place), ["ball.toml"], "a picture of nothing");
    let run = limited(1 << 20, "");
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    // How much the program itself takes up depends on what is built into it.
    let runs: Vec<Run> = (28..=48).step_by(2).map(|mib| limited(mib << 10, "")).collect();
    let says = "error: penumbra itself takes 16 MiB of memory, and ";
    let is_told = |run: &Run| run.status == Some(1) && run.stderr.starts_with(says);
    assert!(runs.iter().any(is_told), "{:?}", runs.last().map(|run| &run.stderr));
}

/// Just enough for the program, or for a thread, or for the picture: each limit has its picture or its
/// sentence, and never the system's own words.
#[test]
fn a_limit_that_is_only_just_too_low_is_told_too() {
    let place = Place::with_ball();
    for kibibytes in (60 << 10..240 << 10).step_by(5003) {
        let run = run_within(&place, kibibytes, "render ball.toml -o a.png");
        let is_told = run.status == Some(1) && run.stderr.starts_with("error: ");
        let is_whole = run.status == Some(0) && run.stderr.is_empty();
        assert!(is_told || is_whole, "{kibibytes} KiB: {:?}: {}", run.status, run.stderr);
    }
}

/// Beyond such a limit the system ends a program without a word; nothing is begun.
#[test]
fn a_picture_longer_than_a_file_may_be_is_refused_and_nothing_is_left() {
    let place = Place::with_ball();
    place.write("a.exr", b"as it was");
    for before in ["", "trap '' XFSZ; "] {
        let script = format!(
            "{before}ulimit -f 1; exec \"$0\" render ball.toml -o a.exr --width 200 --height 200"
        );
        let mut command = std::process::Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_penumbra")]).current_dir(place.path(""));
        let run = Run::of(&mut command);
        let start = "error: a.exr: cannot be written: takes ";
        let is_told =
            run.stderr.starts_with(start) && run.stderr.contains(" bytes, and a file may ");
        assert!(run.status == Some(1) && is_told, "{:?}: {}", run.status, run.stderr);
        assert_eq!(place.read("a.exr"), b"as it was", "the old file");
        assert_eq!(super::failures::files_in(&place), ["a.exr", "ball.toml"], "what is left");
    }
}

/// What a mesh will take is asked while it is read, and once more for each of its crease angles.
#[test]
fn a_mesh_without_memory_is_refused_with_both_figures() {
    let place = Place::new();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    place.write("m.obj", format!("{corners}{}", "f 1 2 3\n".repeat(2_000_000)).as_bytes());
    let run = run_within(&place, 160 << 10, "info m.obj");
    let (start, rest) = run.stderr.split_once(": the mesh up to here takes ").unwrap_or_default();
    assert!(start.starts_with("error: m.obj: line "), "{:?}: {}", run.status, run.stderr);
    let is_told = rest.contains("MiB of memory, and ") && rest.ends_with(" MiB are free\n");
    assert!(run.status == Some(1) && is_told, "{:?}: {}", run.status, run.stderr);
    place.write("m.obj", format!("{corners}{}", "f 1 2 3\n".repeat(100_000)).as_bytes());
    let angles = |n: u32| {
        let object =
            |i| format!("[[objects]]\ntype = 'mesh'\nfile = 'm.obj'\ncrease_angle = {i}\n");
        (0..n).map(object).collect::<String>()
    };
    place.write("s.toml", format!("{BALL}{}", angles(100)).as_bytes());
    let run = run_within(&place, 160 << 10, "info s.toml");
    let says = "m.obj: the mesh once more, for another crease angle, takes ";
    assert!(run.status == Some(1) && run.stderr.contains(says), "{:?}: {}", run.status, run.stderr);
    place.write("s.toml", format!("{BALL}{}", angles(3)).as_bytes());
    // Threads may reserve 64 MiB each.
    let run = run_within(&place, 400 << 10, "info s.toml");
    assert_eq!(run.status, Some(0), "{}", run.stderr);
}

/// Runs the program within so much address space.
fn run_within(place: &Place, kibibytes: u32, arguments: &str) -> Run {
    let script = format!("ulimit -v {kibibytes}; exec \"$0\" {arguments}");
    let mut command = std::process::Command::new("sh");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_penumbra")]).current_dir(place.path(""));
    Run::of(&mut command)
}

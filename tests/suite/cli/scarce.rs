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
    // Where the threads before took all there is, not even the message may find room.
    let is_told = |run: &Run| {
        let says = run.stderr.contains("1024 threads") && run.stderr.contains("smaller number");
        run.status == Some(1) && says
    };
    let runs: Vec<Run> = (0..5).map(|_| limited(1 << 20, "-t 1024")).collect();
    assert!(runs.iter().any(is_told), "{:?}", runs.last().map(|run| &run.stderr));
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

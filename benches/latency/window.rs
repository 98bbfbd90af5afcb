//! What the window's own thread spends on a frame: the whole interface run and tessellated without
//! a screen, while pictures come in and while the mouse turns the camera; what a new picture costs
//! to hand over; and what all of it costs when the picture is done.

use std::io::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

use penumbra::loader::Source;
use penumbra::window::Headless;

use super::{HEIGHT, WIDTH, quantiles};

/// Frames of each kind.
const N_FRAMES: usize = 240;
/// Points: the picture at its full size, with bars and panel around it.
const WINDOW: [f32; 2] = [WIDTH as f32 + 328.0, HEIGHT as f32 + 64.0];
const FRAME: Duration = Duration::from_micros(16_667);

/// One JSON line for each scene and kind of frame.
pub(super) fn measure() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("sphere-100k.toml");
    write_sphere(folder.path(), &path)?;
    for (name, source) in
        [("final", Source::Gallery("final")), ("sphere-100k", Source::File(path.clone()))]
    {
        let mut window = Headless::new(source, WINDOW)?;
        while !window.has_picture() {
            window.frame();
            std::thread::sleep(Duration::from_millis(2));
        }
        window.edit(|scene| {
            scene.render.width = WIDTH;
            scene.render.height = HEIGHT;
            scene.render.samples = 1 << 20;
        });
        for kind in ["refining", "turning the camera"] {
            let costs = frames(&mut window, kind == "turning the camera");
            println!("{{\"scene\":\"{name}\",\"frames\":\"{kind}\",{costs}}}");
        }
        println!("{{\"scene\":\"{name}\",\"frames\":\"done\",{}}}", rest(&mut window));
    }
    Ok(())
}

/// Times of frames at the pace of a display.
fn frames(window: &mut Headless, is_dragging: bool) -> String {
    let (mut wall, mut cpu, mut upload) = (Vec::new(), Vec::new(), Vec::new());
    let mut copied = Vec::new();
    let mut n_pictures = 0;
    for index in 0..N_FRAMES {
        if is_dragging {
            window.drag([if index < N_FRAMES / 2 { 1.0 } else { -1.0 }, 0.0]);
        }
        let (start, start_cpu) = (Instant::now(), thread_cpu_secs());
        let frame = window.frame();
        wall.push(start.elapsed().as_secs_f64() * 1e3);
        cpu.push((thread_cpu_secs() - start_cpu) * 1e3);
        let start_copy = Instant::now();
        // Smaller images are glyphs and swatches.
        if (WIDTH * HEIGHT) as usize <= frame.copy_images(&mut copied) {
            upload.push(start_copy.elapsed().as_secs_f64() * 1e3);
            n_pictures += 1;
        }
        std::thread::sleep(FRAME.saturating_sub(start.elapsed()));
    }
    window.release();
    window.frame();
    upload.resize(upload.len().max(1), 0.0);
    format!(
        "\"ui_ms\":{},\"ui_cpu_ms\":{},\"full_size_pictures\":{n_pictures},\"copy_for_upload_ms\":{}",
        percentiles(&mut wall),
        percentiles(&mut cpu),
        quantiles(&mut upload)
    )
}

fn percentiles(times: &mut [f64]) -> String {
    times.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
    format!("{{\"p50\":{:.2},\"p99\":{:.2}}}", at(0.5), at(0.99))
}

/// What a second costs in which nothing is left to do.
fn rest(window: &mut Headless) -> String {
    window.edit(|scene| scene.render.samples = 1);
    let mut n_quiet = 0;
    // Hover and toasts fade first.
    while n_quiet < 90 {
        let frame = window.frame();
        n_quiet = if window.is_done() && !frame.wants_another { n_quiet + 1 } else { 0 };
        std::thread::sleep(Duration::from_millis(1));
    }
    let before = process_cpu_secs();
    std::thread::sleep(Duration::from_secs(2));
    let percent = (process_cpu_secs() - before) / 2.0 * 100.0;
    format!("\"frames_asked_for\":0,\"cpu_percent\":{percent:.2}")
}

fn thread_cpu_secs() -> f64 {
    cpu_secs(rustix::time::ClockId::ThreadCPUTime)
}

fn process_cpu_secs() -> f64 {
    cpu_secs(rustix::time::ClockId::ProcessCPUTime)
}

fn cpu_secs(clock: rustix::time::ClockId) -> f64 {
    let time = rustix::time::clock_gettime(clock);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// The bench's sphere as files, to be loaded as a person would.
fn write_sphere(folder: &Path, scene: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let mesh = super::sphere();
    let mut obj = std::io::BufWriter::new(std::fs::File::create(folder.join("sphere.obj"))?);
    for p in &mesh.positions {
        writeln!(obj, "v {} {} {}", p.x, p.y, p.z)?;
    }
    for [a, b, c] in mesh.triangles.iter().map(|triangle| triangle.map(|index| index + 1)) {
        writeln!(obj, "f {a} {b} {c}")?;
    }
    obj.flush()?;
    std::fs::write(scene, super::SPHERE_SCENE)?;
    Ok(())
}

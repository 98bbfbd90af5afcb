//! How soon an edit is seen: from a slider's change to the first new picture, and to the first
//! full-resolution sample.
//!
//! ```text
//! cargo bench --bench latency [-- window] [edits] [tones]
//! ```
//!
//! Without a name of a part, all of them, the window first.
//!
//! `edits` drives the session as the window does, at 1280 x 720 and with as many threads: light size,
//! roughness, aperture and camera of the final scene and of a mesh of 100 000 triangles, one edit after
//! the other. One JSON line for each scene and kind of edit, in milliseconds. `tones` is the cost of tone mapping one picture. `window` (on Linux) is what the
//! window's own thread spends on its frames.
#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

#[cfg(all(feature = "window", target_os = "linux"))]
#[path = "latency/window.rs"]
mod window;

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use glam::Vec3;
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, TracedMesh};
use penumbra::io::scene_file;
use penumbra::loader::{Source, load};
use penumbra::math::portable::{cos, sin};
use penumbra::render::{RenderJob, RenderSettings};
use penumbra::scene::assets::{MeshAsset, MeshKey};
use penumbra::scene::description::{OneOrTwo, SceneDescription, ToneOperator};
use penumbra::scene::{Assets, resolve};
use penumbra::session::{Goal, Session};
use penumbra::tone_mapping::map_to_srgb8;

const WIDTH: u32 = 1280;
const HEIGHT: u32 = 720;
const N_EDITS: u32 = 12;

type Edit = fn(&mut SceneDescription, f64);

const PARTS: [&str; 3] = ["window", "edits", "tones"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Cargo adds an option of its own.
    let asked: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    if let Some(unknown) = asked.iter().find(|word| !PARTS.contains(&word.as_str())) {
        return Err(format!("there is no part {unknown:?}; there are {}", PARTS.join(", ")).into());
    }
    let is_asked = |part: &str| asked.is_empty() || asked.iter().any(|word| word == part);
    #[cfg(all(feature = "window", target_os = "linux"))]
    if is_asked("window") {
        window::measure()?;
    }
    if is_asked("edits") {
        edits()?;
    }
    if is_asked("tones") {
        tone_mapping();
    }
    Ok(())
}

fn edits() -> Result<(), Box<dyn std::error::Error>> {
    let signal = Arc::new((Mutex::new(0_u64), Condvar::new()));
    let theirs = Arc::clone(&signal);
    let n_threads = penumbra::threads::beside_window();
    let session = Session::new(n_threads, move || {
        *theirs.0.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        theirs.1.notify_all();
    })?;
    let loaded = load(&Source::Gallery("final"), &[], &AtomicBool::new(false))?;
    let (knot, knot_assets) = sphere_scene()?;
    let edits: [(&str, Edit); 4] = [
        ("light size", |scene, x| scene.lights[0].size = OneOrTwo::One(0.5 + x)),
        ("alpha_x", |scene, x| scene.materials[0].alpha_x = 0.05 + 0.4 * x),
        ("aperture", |scene, x| scene.camera.aperture_radius = 0.01 + 0.1 * x),
        ("orbit", |scene, x| scene.camera.eye[0] += 0.05 * x),
    ];
    for (name, description, assets) in
        [("final", &loaded.description, &loaded.assets), ("sphere-100k", &knot, &knot_assets)]
    {
        for (edit_name, edit) in edits {
            let (mut first, mut full) = (Vec::new(), Vec::new());
            for i in 0..=N_EDITS {
                let mut edited = description.clone();
                edit(&mut edited, f64::from(i) / f64::from(N_EDITS));
                let start = Instant::now();
                let scene = Arc::new(resolve(&edited, assets)?);
                let settings = RenderSettings::new(&edited.render, AcceleratorKind::default());
                let job = RenderJob { scene, width: WIDTH, height: HEIGHT, settings };
                session.submit(&job, Goal { samples: 1, seconds: None, noise_percent: None });
                let times = wait(&session, &signal, &job, start);
                // The first one builds the trees and learns the speed.
                if i > 0 {
                    first.push(times.0);
                    full.push(times.1);
                }
            }
            println!(
                "{{\"scene\":\"{name}\",\"edit\":\"{edit_name}\",\"threads\":{n_threads},\
                 \"first_picture_ms\":{},\"full_sample_ms\":{}}}",
                quantiles(&mut first),
                quantiles(&mut full)
            );
        }
    }
    Ok(())
}

/// Milliseconds to the first picture of a job, and to its first full-size sample.
fn wait(
    session: &Session,
    signal: &(Mutex<u64>, Condvar),
    job: &RenderJob,
    start: Instant,
) -> (f64, f64) {
    let mut first = None;
    loop {
        let count = signal.0.lock().unwrap_or_else(PoisonError::into_inner);
        let elapsed = || start.elapsed().as_secs_f64() * 1e3;
        if let Some(frame) = session.latest().filter(|frame| frame.job == *job) {
            let first = *first.get_or_insert_with(elapsed);
            if frame.scale == 1 {
                return (first, elapsed());
            }
        }
        let patience = Duration::from_millis(200);
        let _woken = signal.1.wait_timeout(count, patience).unwrap_or_else(PoisonError::into_inner);
    }
}

fn quantiles(times: &mut [f64]) -> String {
    times.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
    format!("{{\"p50\":{:.1},\"p95\":{:.1}}}", at(0.5), at(0.95))
}

/// A rippled sphere of 100 000 triangles on a ground under a soft light.
const SPHERE_SCENE: &str = r#"
[camera]
eye = [1.5, 1.2, 3.2]
target = [0.0, 0.0, 0.0]
aperture_radius = 0.03
[[materials]]
name = "glaze"
diffuse = [0.3, 0.4, 0.6]
specular = [0.2, 0.2, 0.2]
[[lights]]
type = "rectangle"
position = [2.0, 4.0, 3.0]
size = 1.0
power = [200.0, 200.0, 200.0]
[[objects]]
type = "mesh"
file = "sphere.obj"
normals = "flat"
material = "glaze"
[[objects]]
type = "plane"
point = [0.0, -1.1, 0.0]
normal = [0.0, 1.0, 0.0]
"#;

fn sphere_scene() -> Result<(SceneDescription, Assets), Box<dyn std::error::Error>> {
    let description = scene_file::parse(SPHERE_SCENE, &[])?;
    let key = MeshKey::of(&description.objects[0]).ok_or("the mesh has a file")?;
    let asset = MeshAsset { traced: Arc::new(TracedMesh::new(sphere())), slots: Vec::new() };
    let mut assets = Assets::default();
    assets.meshes.insert(key, Arc::new(asset));
    Ok((description, assets))
}

fn sphere() -> Mesh {
    let (rows, columns) = (225_u32, 224_u32);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let theta = std::f32::consts::PI * row as f32 / rows as f32;
            let phi = std::f32::consts::TAU * column as f32 / columns as f32;
            let radius = 1.0 + 0.05 * sin(12.0 * theta) * cos(9.0 * phi);
            let ring = sin(theta);
            mesh.positions.push(radius * Vec3::new(ring * cos(phi), cos(theta), ring * sin(phi)));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let b = a + columns + 1;
            mesh.triangles.push([a, a + 1, b]);
            mesh.triangles.push([a + 1, b + 1, b]);
        }
    }
    mesh
}

fn tone_mapping() {
    let n_pixels = (WIDTH * HEIGHT) as usize;
    let pixels: Vec<[f32; 3]> =
        (0..n_pixels).map(|i| [0.7, 0.2, 1.3].map(|c| c * (i % 997) as f32 / 500.0)).collect();
    let mut out = vec![[0; 3]; n_pixels];
    for (operator, name) in [
        (ToneOperator::Linear, "linear"),
        (ToneOperator::Reinhard, "reinhard"),
        (ToneOperator::Aces, "aces"),
        (ToneOperator::Agx, "agx"),
    ] {
        let times = (0..9).map(|_| {
            let start = Instant::now();
            map_to_srgb8(&pixels, 0.5, operator, &mut out);
            start.elapsed().as_secs_f64() * 1e3
        });
        let mut times: Vec<f64> = times.collect();
        println!("{{\"tone_mapping\":\"{name}\",\"ms\":{}}}", quantiles(&mut times));
    }
}

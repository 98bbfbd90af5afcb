//! Rays a second on one mesh, on rays that any other program can reproduce to the bit.
//!
//! ```text
//! cargo bench --bench trace -- MESH.obj [--threads N]
//! cargo bench --bench trace -- --scaling [--threads N] [--report DIRECTORY]
//! ```
//!
//! With `--scaling`: on a knot of a thousand to a million triangles, which the bench makes itself;
//! `--report` writes `scaling.md` and `scaling.svg`. One JSON line a measurement. The rays: a pinhole camera of 1024 x 1024 pixels around the mesh's
//! bounds ("primary"); from every hit a ray to a random point of a square light above ("shadow"),
//! to a point that a block of 4 x 4 pixels shares ("shadow_block"), and in a cosine-weighted random
//! direction ("bounce"). Everything is computed in f64 and rounded to f32 at the end; random
//! numbers are hashes of the pixel. Sets keep the order of 16 x 16 tiles of 4 x 4 blocks.
#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

#[path = "convergence/plot.rs"]
mod plot;
#[path = "trace/scaling.rs"]
mod scaling;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::{DVec3, Vec3};
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, Geometry, Instance, Nearest, Shape, TracedMesh};
use penumbra::io::obj;
use penumbra::math::{Aabb, PrimitiveId, Ray, RayBatch, Transform};
use penumbra::scene::description::NormalsKind;
use rayon::prelude::*;

const WIDTH: u32 = 1024;
/// Rays that one call traces: a wave of eight samples a pixel of a tile.
const BATCH: usize = 2048;
const REPETITIONS: usize = 5;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut path, mut threads) = (None, vec![1, penumbra::threads::available()]);
    let (mut is_scaling, mut report) = (false, None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--threads" => {
                threads = vec![arguments.next().ok_or("--threads needs a number")?.parse()?];
            }
            "--scaling" => is_scaling = true,
            "--report" => {
                report = Some(arguments.next().ok_or("--report needs a directory")?);
            }
            _ => path = Some(argument),
        }
    }
    threads.dedup();
    if is_scaling {
        let mut rows = Vec::new();
        for n_triangles in [1_000, 4_000, 16_000, 64_000, 256_000, 1_000_000] {
            rows.extend(measure("knot", scaling::knot(n_triangles), &threads)?);
        }
        if let Some(directory) = report {
            scaling::write(&rows, std::path::Path::new(&directory))?;
        }
        return Ok(());
    }
    let Some(path) = path else {
        println!("{{\"note\":\"give a mesh: cargo bench --bench trace -- MESH.obj\"}}");
        return Ok(());
    };
    let stem = std::path::Path::new(&path).file_stem().ok_or("no file name")?;
    let (mesh, _) =
        obj::load_mesh(&std::fs::read(&path)?, NormalsKind::Flat, 0.0, &AtomicBool::new(false))?;
    measure(&stem.to_string_lossy(), mesh, &threads)?;
    Ok(())
}

/// One measurement, of the best repetition.
struct Row {
    n_triangles: usize,
    n_threads: usize,
    set: &'static str,
    accelerator: AcceleratorKind,
    mrays_per_s: f64,
    build_ms: f64,
    n_bytes: usize,
}

/// Measures all sets of rays on all accelerators but brute force, and prints a line for each.
fn measure(name: &str, mesh: Mesh, threads: &[usize]) -> Result<Vec<Row>, Failure> {
    let bounds = Aabb::of(mesh.positions.iter().copied());
    let n_triangles = mesh.triangles.len();
    let traced = Arc::new(TracedMesh::new(mesh));
    let sets = ray_sets(&traced, &bounds)?;
    let mut rows = Vec::new();
    for n_threads in threads.iter().copied() {
        let pool = penumbra::threads::pool("trace", n_threads)?;
        for kind in AcceleratorKind::ALL {
            if kind == AcceleratorKind::BruteForce {
                continue;
            }
            let build_ms = pool.install(|| build_ms(&traced, kind));
            let geometry = pool.install(|| geometry(&traced, kind));
            let n_bytes = geometry.statistics().n_bytes;
            for set in &sets {
                let best = pool.install(|| set.measure(&geometry));
                let (rays, set) = (set.n_rays, set.name);
                let mrays_per_s = rays as f64 / best.wall_secs * 1e-6;
                println!(
                    "{{\"peer\":\"penumbra\",\"mesh\":{name:?},\"tris\":{n_triangles},\"threads\":{n_threads},\
                     \"kind\":\"{set}\",\"mode\":\"{}\",\"rays\":{rays},\"mrays_per_s\":{mrays_per_s:.3},\
                     \"mrays_cpu\":{:.3},\"build_ms\":{build_ms:.2},\"tree_bytes\":{n_bytes},\
                     \"hits\":{},\"checksum\":{:.6}}}",
                    kind.name(),
                    rays as f64 / best.cpu_secs * 1e-6,
                    best.n_hits,
                    best.checksum,
                );
                rows.push(Row {
                    n_triangles,
                    n_threads,
                    set,
                    accelerator: kind,
                    mrays_per_s,
                    build_ms,
                    n_bytes,
                });
            }
        }
    }
    Ok(rows)
}

fn geometry(mesh: &Arc<TracedMesh>, kind: AcceleratorKind) -> Geometry {
    let shape = Shape::Mesh(Arc::clone(mesh));
    Geometry::new(vec![Instance::new(shape, Transform::IDENTITY)], kind)
}

/// The least of three builds of a fresh tree.
fn build_ms(mesh: &Arc<TracedMesh>, kind: AcceleratorKind) -> f64 {
    let times = (0..3).map(|_| mesh.time_build(kind) * 1e3);
    times.fold(f64::INFINITY, f64::min)
}

struct RaySet {
    name: &'static str,
    batches: Vec<RayBatch>,
    n_rays: usize,
    is_shadow: bool,
}

struct Measurement {
    wall_secs: f64,
    cpu_secs: f64,
    n_hits: usize,
    checksum: f64,
}

impl RaySet {
    fn new(name: &'static str, rays: &[Ray], is_shadow: bool) -> Self {
        let batch = |rays: &[Ray]| {
            let mut batch = RayBatch::default();
            rays.iter().for_each(|ray| batch.push(*ray));
            batch
        };
        let batches = rays.chunks(BATCH).map(batch).collect();
        Self { name, batches, n_rays: rays.len(), is_shadow }
    }

    /// The best of some repetitions, by CPU time.
    fn measure(&self, geometry: &Geometry) -> Measurement {
        let runs = (0..REPETITIONS).map(|_| {
            let (wall, cpu) = (Instant::now(), cpu_secs());
            let (n_hits, checksum) = self.trace(geometry);
            let wall_secs = wall.elapsed().as_secs_f64();
            Measurement { wall_secs, cpu_secs: cpu_secs() - cpu, n_hits, checksum }
        });
        runs.reduce(|a, b| Measurement {
            wall_secs: a.wall_secs.min(b.wall_secs),
            cpu_secs: a.cpu_secs.min(b.cpu_secs),
            ..a
        })
        .expect("there is at least one repetition")
    }

    fn trace(&self, geometry: &Geometry) -> (usize, f64) {
        // Tiles in chunks, so that the cost of sharing them out is not measured.
        let parts: Vec<(usize, f64)> = self
            .batches
            .par_chunks(2)
            .map(|batches| {
                let (mut hits, mut blocked) = (Vec::new(), Vec::new());
                let (mut n_hits, mut checksum) = (0, 0.0);
                for batch in batches {
                    if self.is_shadow {
                        geometry.occluded(batch, &mut blocked);
                        n_hits += blocked.iter().filter(|b| **b).count();
                    } else {
                        geometry.intersect(batch, &mut hits);
                        let met = || hits.iter().filter_map(Nearest::hit);
                        n_hits += met().count();
                        checksum += met().map(|hit| f64::from(hit.t)).sum::<f64>();
                    }
                }
                (n_hits, checksum)
            })
            .collect();
        parts.iter().fold((0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1))
    }
}

/// CPU time of all threads of this process.
fn cpu_secs() -> f64 {
    #[cfg(target_os = "linux")]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
    }
    #[cfg(not(target_os = "linux"))]
    {
        // Wall time of the busy threads; only ratios on one machine mean anything.
        static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
        START.get_or_init(Instant::now).elapsed().as_secs_f64()
    }
}

fn pcg(x: u32) -> u32 {
    let s = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let w = ((s >> ((s >> 28) + 4)) ^ s).wrapping_mul(277_803_737);
    (w >> 22) ^ w
}

fn uniform(i: u32, k: u32) -> f64 {
    f64::from(pcg(i.wrapping_mul(4).wrapping_add(k)) >> 8) / 16_777_216.0
}

/// Pixels by 16 x 16 tiles, by 4 x 4 blocks, by rows.
fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..WIDTH * WIDTH).map(|n| {
        let (tile, block, pixel) = (n / 256, n / 16 % 16, n % 16);
        let tiles = WIDTH / 16;
        let x = tile % tiles * 16 + block % 4 * 4 + pixel % 4;
        let y = tile / tiles * 16 + block / 4 * 4 + pixel / 4;
        (x, y)
    })
}

fn ray_sets(mesh: &Arc<TracedMesh>, bounds: &Aabb) -> Result<Vec<RaySet>, std::io::Error> {
    let pool = penumbra::threads::pool("rays", penumbra::threads::available())?;
    let geometry = pool.install(|| geometry(mesh, AcceleratorKind::KdTree));
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let center = (low + high) / 2.0;
    let diagonal = (high - low).length();
    let eye = center + 1.2 * diagonal * DVec3::new(0.6, 0.4, 1.0).normalize();
    let forward = (center - eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let k = 20.0_f64.to_radians().tan();
    let width = f64::from(WIDTH);
    let primary: Vec<Ray> = pixels()
        .map(|(x, y)| {
            let sx = (2.0 * (f64::from(x) + 0.5) / width - 1.0) * k;
            let sy = (1.0 - 2.0 * (f64::from(y) + 0.5) / width) * k;
            let direction = (forward + sx * right + sy * up).normalize();
            Ray::new(eye.as_vec3(), direction.as_vec3())
        })
        .collect();
    let mut batch = RayBatch::default();
    primary.iter().for_each(|ray| batch.push(*ray));
    let mut hits = Vec::new();
    geometry.intersect(&batch, &mut hits);
    let (mut shadow, mut shadow_block, mut bounce) = (Vec::new(), Vec::new(), Vec::new());
    for ((x, y), (ray, hit)) in pixels().zip(primary.iter().zip(&hits)) {
        let Some(hit) = hit.hit() else { continue };
        let i = y * WIDTH + x;
        let [a, b, c] = mesh.mesh.corners(hit.id.primitive).map(Vec3::as_dvec3);
        let direction = ray.direction.as_dvec3();
        let p = ray.origin.as_dvec3() + f64::from(hit.t) * direction;
        let mut n = (b - a).cross(c - a).normalize();
        if n.dot(direction) > 0.0 {
            n = -n;
        }
        let q = p + n * 1e-4 * diagonal;
        let block = (y & !3) * WIDTH + (x & !3);
        for (i, set) in [(i, &mut shadow), (block, &mut shadow_block)] {
            let across = DVec3::X * (uniform(i, 0) - 0.5) + DVec3::Z * (uniform(i, 1) - 0.5);
            let light = center + DVec3::Y * diagonal + 0.5 * diagonal * across;
            if n.dot(light - p) > 0.0 {
                let mut ray = Ray::new(q.as_vec3(), (light - q).as_vec3());
                ray.t_max = 1.0;
                ray.source = PrimitiveId::NONE;
                set.push(ray);
            }
        }
        bounce.push(Ray::new(q.as_vec3(), scattered(i, n)));
    }
    Ok(vec![
        RaySet::new("primary", &primary, false),
        RaySet::new("shadow", &shadow, true),
        RaySet::new("shadow_block", &shadow_block, true),
        RaySet::new("bounce", &bounce, false),
    ])
}

/// A cosine-weighted direction around `n`.
fn scattered(i: u32, n: DVec3) -> Vec3 {
    let (phi, r2) = (std::f64::consts::TAU * uniform(i, 2), uniform(i, 3));
    let s = 1.0_f64.copysign(n.z);
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    let tangent = DVec3::new(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
    let bitangent = DVec3::new(b, s + n.y * n.y * a, -n.y);
    let r = r2.sqrt();
    let direction = r * phi.cos() * tangent + r * phi.sin() * bitangent + (1.0 - r2).sqrt() * n;
    direction.normalize().as_vec3()
}

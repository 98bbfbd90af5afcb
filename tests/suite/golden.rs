//! The gallery against pictures that have converged: a z-test for every pixel and for the whole.
//!
//! `tests/golden/NAME.pfm` holds the mean of every pixel and below it its standard error, linear, of
//! many independent samples. `UPDATE_GOLDEN=1` writes them anew. A test that fails leaves pictures
//! of what it found, what it wanted, how they differ and how likely that is, in `target/golden`.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use penumbra::geometry::AcceleratorKind;
use penumbra::io::gallery::GALLERY;
use penumbra::io::output::encode_png;
use penumbra::loader::{Source, load};
use penumbra::math::sampler::Sampler;
use penumbra::render::{Film, RenderJob, RenderSettings, World, render_pass};
use penumbra::scene::description::{IntegratorKind, SamplerKind};
use penumbra::scene::resolve;

const SIZE: u32 = 32;
/// Pictures of independent samples, whose spread is their error.
const N_BATCHES: u32 = 8;
const BATCH_SAMPLES: u32 = 4;
/// Of a golden picture, in batches.
const N_GOLDEN_BATCHES: u32 = 32;
const GOLDEN_BATCH_SAMPLES: u32 = 64;
/// A sound renderer fails a scene this rarely.
const CHANCE: f64 = 1e-3;

/// All scenes as they are, and those where light takes more ways by "path" too.
fn looks() -> Vec<(&'static str, IntegratorKind)> {
    let direct = GALLERY.iter().map(|entry| (entry.name, IntegratorKind::Direct));
    let path = ["soft-shadows", "glass-and-mirrors", "ward-ceramic"];
    direct.chain(path.map(|name| (name, IntegratorKind::Path))).collect()
}

/// A mean and its standard error for every channel of every pixel.
struct Estimate {
    means: Vec<f64>,
    errors: Vec<f64>,
}

impl Estimate {
    fn render(job: &RenderJob, first_seed: u32, n_batches: u32, n_samples: u32) -> Self {
        let mut sums = vec![(0.0, 0.0); (SIZE * SIZE * 3) as usize];
        let mut world = World::new(job.clone());
        for seed in first_seed..first_seed + n_batches {
            world.job.settings.sampler = Sampler::Random { seed };
            let mut film = Film::new(SIZE, SIZE).unwrap();
            render_pass(&world, &mut film, n_samples, &AtomicBool::new(false)).unwrap();
            for (sum, value) in sums.iter_mut().zip(film.picture().pixels.as_flattened()) {
                sum.0 += f64::from(*value);
                sum.1 += f64::from(*value).powi(2);
            }
        }
        let n = f64::from(n_batches);
        let error = |(sum, squares): &(f64, f64)| {
            ((squares - sum * sum / n).max(0.0) / (n * (n - 1.0))).sqrt()
        };
        let means = sums.iter().map(|(sum, _)| sum / n).collect();
        Self { means, errors: sums.iter().map(error).collect() }
    }

    fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap_or_else(|e| {
            panic!("{}: {e}; UPDATE_GOLDEN=1 writes it", path.display());
        });
        let data = bytes.strip_prefix(header().as_bytes()).expect("the header of a golden picture");
        let mut values: Vec<f64> = data
            .chunks_exact(4)
            .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))
            .collect();
        let errors = values.split_off((SIZE * SIZE * 3) as usize);
        Self { means: values, errors }
    }

    fn write(&self, path: &Path) {
        let mut bytes = header().into_bytes();
        for value in self.means.iter().chain(&self.errors) {
            bytes.extend_from_slice(&(*value as f32).to_le_bytes());
        }
        std::fs::write(path, bytes).unwrap();
    }
}

/// Of a portable float map; its rows run from the top down here, the means above the errors.
fn header() -> String {
    format!("PF\n{SIZE} {}\n-1.0\n", 2 * SIZE)
}

fn job(name: &str, integrator: IntegratorKind) -> RenderJob {
    let source = Source::Gallery(GALLERY.iter().find(|entry| entry.name == name).unwrap().name);
    let loaded = load(&source, &[], &AtomicBool::new(false)).unwrap();
    let mut description = loaded.description.clone();
    let render = &mut description.render;
    (render.width, render.height) = (SIZE, SIZE);
    render.sampler = SamplerKind::Random;
    render.integrator = integrator;
    RenderJob {
        scene: std::sync::Arc::new(resolve(&description, &loaded.assets).unwrap()),
        width: SIZE,
        height: SIZE,
        settings: RenderSettings::new(&description.render, AcceleratorKind::default()),
    }
}

/// The z of every channel of every pixel. The spread of few samples says little where a light is
/// found rarely, so that of the golden samples counts too.
fn scores(found: &Estimate, golden: &Estimate) -> Vec<f64> {
    let share =
        f64::from(N_GOLDEN_BATCHES * GOLDEN_BATCH_SAMPLES) / f64::from(N_BATCHES * BATCH_SAMPLES);
    let score = |index: usize| {
        let difference = found.means[index] - golden.means[index];
        let golden_variance = golden.errors[index].powi(2);
        let variance = found.errors[index].powi(2).max(golden_variance * share) + golden_variance;
        // Where nothing is noise, a few roundings are allowed.
        let rounding = 1e-5 * golden.means[index].abs() + 1e-9;
        difference / (variance + rounding.powi(2)).sqrt()
    };
    (0..found.means.len()).map(score).collect()
}

/// The z of the sum of all channels of all pixels.
fn score_of_all(found: &Estimate, golden: &Estimate) -> f64 {
    let sum = |values: &[f64]| values.iter().sum::<f64>();
    let squares = |values: &[f64]| values.chunks_exact(3).map(|c| sum(c).powi(2)).sum::<f64>();
    let rounding = 1e-5 * sum(&golden.means);
    let variance = squares(&found.errors) + squares(&golden.errors) + rounding.powi(2);
    (sum(&found.means) - sum(&golden.means)) / variance.sqrt()
}

/// Two-sided.
fn p_value(z: f64) -> f64 {
    libm::erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// What is wrong, if anything.
fn verdict(found: &Estimate, golden: &Estimate) -> Option<String> {
    let scores = scores(found, golden);
    // Z. Sidak, "Rectangular Confidence Regions for the Means of Multivariate Normal
    // Distributions", Journal of the American Statistical Association 62(318), 1967.
    let limit = 1.0 - (1.0 - CHANCE).powf(1.0 / scores.len() as f64);
    let worst = (0..scores.len()).max_by(|a, b| scores[*a].abs().total_cmp(&scores[*b].abs()))?;
    let whole = score_of_all(found, golden);
    let (x, y) = (worst / 3 % SIZE as usize, worst / 3 / SIZE as usize);
    if p_value(scores[worst]) < limit {
        let (is, should) = (found.means[worst], golden.means[worst]);
        return Some(format!("pixel ({x}, {y}): {is}, not {should}: z = {}", scores[worst]));
    }
    (p_value(whole) < CHANCE).then(|| format!("the whole picture: z = {whole}"))
}

fn golden_path(name: &str, integrator: IntegratorKind) -> PathBuf {
    let suffix = match integrator {
        IntegratorKind::Direct => "",
        IntegratorKind::Path => "-path",
    };
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}{suffix}.pfm"))
}

/// Pictures for a person, brighter and sixteen times as large.
fn show(path: &Path, found: &Estimate, golden: &Estimate) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/golden");
    std::fs::create_dir_all(&folder).unwrap();
    let stem = path.file_stem().unwrap().to_string_lossy();
    let white = golden.means.iter().fold(1e-9_f64, |a, b| a.max(*b)).min(1.0);
    let scores = scores(found, golden);
    let level = |x: f64| (255.0 * (x / white).clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8;
    let difference = |i: usize| 128.0 + 128.0 * 4.0 * (found.means[i] - golden.means[i]) / white;
    for view in ["actual", "expected", "difference", "p-value"] {
        let byte = |i: usize| match view {
            "actual" => level(found.means[i]),
            "expected" => level(golden.means[i]),
            "difference" => difference(i).clamp(0.0, 255.0) as u8,
            _ => (255.0 * p_value(scores[i])) as u8,
        };
        let scale = 16;
        let mut pixels = Vec::new();
        for y in 0..SIZE * scale {
            for x in 0..SIZE * scale {
                let first = ((y / scale * SIZE + x / scale) * 3) as usize;
                pixels.extend((first..first + 3).map(byte));
            }
        }
        let png = encode_png((SIZE * scale, SIZE * scale), &pixels, &[]).unwrap();
        std::fs::write(folder.join(format!("{stem}-{view}.png")), png).unwrap();
    }
}

#[test]
fn the_gallery_looks_as_it_did_when_it_had_converged() {
    let is_update = std::env::var_os("UPDATE_GOLDEN").is_some();
    let mut faults = Vec::new();
    for (name, integrator) in looks() {
        let (path, job) = (golden_path(name, integrator), job(name, integrator));
        if is_update {
            Estimate::render(&job, 1000, N_GOLDEN_BATCHES, GOLDEN_BATCH_SAMPLES).write(&path);
        }
        let found = Estimate::render(&job, 0, N_BATCHES, BATCH_SAMPLES);
        let golden = Estimate::read(&path);
        if let Some(fault) = verdict(&found, &golden) {
            show(&path, &found, &golden);
            faults.push(format!("{}: {fault}", path.display()));
        }
    }
    assert!(faults.is_empty(), "see target/golden:\n{}", faults.join("\n"));
}

/// The test can fail: a light 3 % too strong, and one pixel that is wrong.
#[test]
fn wrong_pictures_are_found() {
    let golden = Estimate::read(&golden_path("soft-shadows", IntegratorKind::Direct));
    let found = |factor: f64| {
        let means = golden.means.iter().map(|mean| factor * mean).collect();
        let share = f64::from(N_GOLDEN_BATCHES * GOLDEN_BATCH_SAMPLES)
            / f64::from(N_BATCHES * BATCH_SAMPLES);
        Estimate { means, errors: golden.errors.iter().map(|e| e * share.sqrt()).collect() }
    };
    assert_eq!(verdict(&found(1.0), &golden), None);
    assert!(verdict(&found(1.03), &golden).is_some(), "3 % too bright");
    let mut spotted = found(1.0);
    let place =
        (0..golden.means.len()).max_by(|a, b| golden.means[*a].total_cmp(&golden.means[*b]));
    spotted.means[place.unwrap()] *= 1.5;
    assert!(verdict(&spotted, &golden).is_some(), "one pixel half too bright");
}

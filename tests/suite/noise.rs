//! Error: the noise figure against the truth, how fast it falls, and how it is spread in the picture.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use penumbra::geometry::AcceleratorKind;
use penumbra::io::gallery::GALLERY;
use penumbra::loader::{Loaded, Source, load};
use penumbra::math::sampler::Sampler;
use penumbra::render::{Film, RenderJob, RenderSettings, World, plan, render_pass};
use penumbra::scene::resolve;
use penumbra::session::Goal;

use crate::common::job;

const SOFT: &str = "[[materials]]\nname = 'm'\ndiffuse = [0.7, 0.6, 0.5]\n\
    [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n\
    [[objects]]\ntype = 'sphere'\ncenter = [0, 1, 0]\nradius = 1\nmaterial = 'm'\n\
    [[lights]]\ntype = 'disk'\nposition = [3, 5, 2]\nsize = 2\npower = [300, 300, 300]\n";

const GLOWING: &str = "[[materials]]\nname = 'm'\ndiffuse = [0.7, 0.6, 0.5]\n\
    specular = [0.2, 0.2, 0.2]\n\
    [[materials]]\nname = 'glow'\nemission = [9, 8, 7]\n\
    [[objects]]\ntype = 'box'\nmin = [-4, 0, -4]\nmax = [4, 5, 5]\nmaterial = 'm'\n\
    [[objects]]\ntype = 'sphere'\ncenter = [0, 1, 0]\nradius = 1\nmaterial = 'm'\n\
    [[objects]]\ntype = 'sphere'\ncenter = [2, 3, 1]\nradius = 0.7\nmaterial = 'glow'\n";

/// The spread of pictures that differ only in their seed is the true error; the figure, which knows
/// one picture alone, comes near it with either sampler, at powers of two and between.
#[test]
fn the_noise_figure_is_near_the_true_error() {
    const N_SEEDS: u32 = 6;
    for (body, integrator) in [(SOFT, "direct"), (GLOWING, "path")] {
        for (sampler, goal) in
            [("random", 32), ("random", 96), ("sobol", 16), ("sobol", 64), ("sobol", 96)]
        {
            let films: Vec<Film> = (0..N_SEEDS)
                .map(|seed| {
                    let text = format!(
                        "[render]\nwidth = 24\nheight = 18\nintegrator = '{integrator}'\n\
                         sampler = '{sampler}'\nseed = {seed}\nmax_depth = 3\n\
                         [camera]\neye = [0.5, 1.5, 4.5]\ntarget = [0, 1, 0]\n{body}"
                    );
                    let job = job(&text);
                    let world = World::new(job.clone());
                    let mut film = Film::new(job.width, job.height).unwrap();
                    while film.n_samples() < goal {
                        let n = plan::pass_samples(film.n_samples(), goal);
                        render_pass(&world, &mut film, n, &AtomicBool::new(false)).unwrap();
                    }
                    film
                })
                .collect();
            let (mut variance, mut mean) = (0.0, 0.0);
            for y in 0..18 {
                for x in 0..24 {
                    let values = films.iter().map(|film| {
                        let [r, g, b] = film.mean(x, y).map(f64::from);
                        0.2126 * r + 0.7152 * g + 0.0722 * b
                    });
                    let values: Vec<f64> = values.collect();
                    let middle = values.iter().sum::<f64>() / f64::from(N_SEEDS);
                    let spread: f64 = values.iter().map(|v| (v - middle).powi(2)).sum();
                    variance += spread / f64::from(N_SEEDS - 1) / (18.0 * 24.0);
                    mean += middle / (18.0 * 24.0);
                }
            }
            let truth = 100.0 * variance.sqrt() / mean;
            let figures = films.iter().map(|film| film.noise_percent().unwrap().powi(2));
            let figure = (figures.sum::<f64>() / f64::from(N_SEEDS)).sqrt();
            let ratio = figure / truth;
            let what = format!("{figure} %, not {truth} %, at {goal} {sampler} samples");
            assert!((0.7..1.4).contains(&ratio), "{integrator}: {what}");
        }
    }
}

/// A scene of the gallery in a small picture, of which `zoom` pixels go into one of the same field of
/// view.
fn gallery_world(loaded: &Loaded, width: u32, zoom: f64) -> World {
    let mut description = loaded.description.clone();
    description.camera.vertical_fov /= zoom;
    let render = &mut description.render;
    render.height = width * render.height / render.width;
    render.width = width;
    World::new(RenderJob {
        scene: Arc::new(resolve(&description, &loaded.assets).unwrap()),
        width,
        height: description.render.height,
        settings: RenderSettings::new(&description.render, AcceleratorKind::default()),
    })
}

fn opened(name: &'static str) -> Loaded {
    load(&Source::Gallery(name), &[], &AtomicBool::new(false)).unwrap()
}

fn add(world: &World, film: &mut Film, n_samples: u32) {
    let n = n_samples - film.n_samples();
    render_pass(world, film, n, &AtomicBool::new(false)).unwrap();
}

fn luminances(film: &Film) -> Vec<f64> {
    let of = |p: &[f32; 3]| {
        let [r, g, b] = p.map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    film.picture().pixels.iter().map(of).collect()
}

/// What is known of pictures of one number of samples that differ in their seed only.
#[derive(Clone, Copy, Default)]
struct Known {
    /// Mean squared error, from their spread.
    truth: f64,
    /// Mean of the squared noise figures, as an error of that kind.
    figure: f64,
    /// Largest doubt of a figure.
    doubt: f64,
}

fn errors(
    world: &mut World,
    sampler: fn(u32) -> Sampler,
    n_seeds: u32,
    counts: &[u32],
) -> Vec<Known> {
    let mut pictures = vec![Vec::new(); counts.len()];
    let mut known = vec![Known::default(); counts.len()];
    for seed in 0..n_seeds {
        world.job.settings.sampler = sampler(seed);
        let mut film = Film::new(world.job.width, world.job.height).unwrap();
        for ((count, pictures), known) in counts.iter().zip(&mut pictures).zip(&mut known) {
            add(world, &mut film, *count);
            let values = luminances(&film);
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let noise = film.noise().unwrap();
            known.figure += (0.01 * noise.percent * mean).powi(2) / f64::from(n_seeds);
            known.doubt = known.doubt.max(noise.uncertainty);
            pictures.push(values);
        }
    }
    let n = f64::from(n_seeds);
    let variance = |pictures: &Vec<Vec<f64>>| {
        let n_pixels = pictures[0].len();
        let spread = |place: usize| {
            let values = pictures.iter().map(|picture| picture[place]);
            let mean = values.clone().sum::<f64>() / n;
            values.map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)
        };
        (0..n_pixels).map(spread).sum::<f64>() / n_pixels as f64
    };
    pictures.iter().zip(known).map(|(p, known)| Known { truth: variance(p), ..known }).collect()
}

const RANDOM: fn(u32) -> Sampler = |seed| Sampler::Random { seed };
const SOBOL: fn(u32) -> Sampler = |seed| Sampler::Sobol { seed };

/// Within a quarter, for every scene of the gallery and both samplers, and nearly always within twice
/// its own doubt.
#[test]
fn the_noise_figure_holds_for_the_gallery() {
    /// What five pictures of so few pixels leave open of the truth itself.
    const TRUTH_DOUBT: f64 = 0.08;
    let counts = [16, 32];
    let (mut faults, mut n_beyond_doubt) = (Vec::new(), 0);
    for entry in GALLERY {
        let mut world = gallery_world(&opened(entry.name), 40, 1.0);
        for (name, sampler) in [("random", RANDOM), ("sobol", SOBOL)] {
            for (count, known) in counts.iter().zip(errors(&mut world, sampler, 5, &counts)) {
                let ratio = (known.figure / known.truth).sqrt();
                let doubt = known.doubt.hypot(TRUTH_DOUBT);
                n_beyond_doubt += u32::from((ratio - 1.0).abs() > 2.0 * doubt);
                let what = format!("at {count} {name} samples of {}", entry.name);
                if !(0.75..1.25).contains(&ratio) {
                    faults.push(format!("{ratio} of the truth {what}"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(n_beyond_doubt <= 3, "{n_beyond_doubt} of 48 figures are off by more than they say");
}

/// The samples that it takes to come down to a noise, told up to two doublings before: nearly within a
/// fifth from one picture of independent samples; with Sobol points, whose few differences hang on few
/// pixels in so small a picture, so on the whole, evenly spread or where the error is.
#[test]
fn the_samples_to_a_noise_are_foretold() {
    let counts = [16, 32, 64];
    let names = ["final", "depth-of-field", "soft-shadows", "kd-tree", "sky", "glass-and-mirrors"];
    for (kind, sampler, is_adaptive, most_root_mean_square, most_lean) in [
        ("random", RANDOM, false, 0.1, 0.05),
        // Pixels of so small a picture hold whole edges, which fall slower: told a little too soon.
        ("sobol", SOBOL, false, 0.25, 0.12),
        ("adaptive", SOBOL, true, 0.25, 0.15),
    ] {
        let mut errors = Vec::new();
        for name in names {
            let mut world = gallery_world(&opened(name), 64, 1.0);
            world.job.settings.sampler = sampler(3);
            world.job.settings.adaptive = is_adaptive;
            let mut film = Film::new(world.job.width, world.job.height).unwrap();
            let mut figures = Vec::new();
            for n in counts {
                add(&world, &mut film, n);
                figures.push((f64::from(n), film.noise().unwrap()));
            }
            for (i, (few, early)) in figures.iter().enumerate() {
                for (many, late) in &figures[i + 1..] {
                    let error = (few * early.samples_to(late.percent) / many).ln();
                    let what = format!("{name}: from {few} to {many} {kind} samples");
                    assert!(error.abs() < 0.8, "{what}: off by a factor of {}", error.exp());
                    errors.push(error);
                }
            }
        }
        let n = errors.len() as f64;
        let lean = errors.iter().sum::<f64>() / n;
        let root_mean_square = (errors.iter().map(|error| error * error).sum::<f64>() / n).sqrt();
        assert!(lean.abs() < most_lean, "{kind}: off by a factor of {} on the mean", lean.exp());
        assert!(root_mean_square < most_root_mean_square, "{kind}: {root_mean_square}");
    }
}

/// At a pace of four samples a second: what is left to the nearest of all goals.
#[test]
fn the_time_left_is_that_to_the_nearest_goal() {
    let job = job(&format!(
        "[render]\nwidth = 24\nheight = 18\nsampler = 'random'\n\
         [camera]\neye = [0.5, 1.5, 4.5]\ntarget = [0, 1, 0]\n{SOFT}"
    ));
    let mut film = Film::new(job.width, job.height).unwrap();
    let all = Goal { samples: 64, seconds: None, noise_percent: None };
    assert_eq!(all.seconds_left(&film, 0.0), None, "before the first sample");
    add(&World::new(job), &mut film, 16);
    let figure = film.noise_percent().unwrap();
    for (goal, expected) in [
        (all, 12.0),
        (Goal { seconds: Some(10.0), ..all }, 6.0),
        (Goal { seconds: Some(60.0), ..all }, 12.0),
        // Independent samples: half the noise takes four times the samples.
        (Goal { samples: 1000, noise_percent: Some(0.5 * figure), ..all }, 12.0),
        (Goal { samples: 32, noise_percent: Some(0.5 * figure), ..all }, 4.0),
        (Goal { noise_percent: Some(2.0 * figure), ..all }, 0.0),
    ] {
        let found = goal.seconds_left(&film, 4.0).unwrap();
        assert!((found - expected).abs() < 1e-9, "{goal:?}: {found} s, not {expected} s");
    }
}

/// What lens and lights cost: squared error at 64 samples, and how it falls with their number, in
/// pixels as small as those of a picture 640 wide.
#[test]
fn sobol_points_beat_random_ones_on_lens_and_penumbra() {
    for (name, least_gain, slope) in [("depth-of-field", 6.0, -0.6), ("soft-shadows", 10.0, -0.6)] {
        let mut world = gallery_world(&opened(name), 80, 8.0);
        let [random] = errors(&mut world, RANDOM, 2, &[64])[..] else { unreachable!() };
        let [few, many] = errors(&mut world, SOBOL, 2, &[16, 64])[..] else { unreachable!() };
        let gain = random.truth / many.truth;
        let found = 0.5 * (many.truth / few.truth).log(4.0);
        assert!(gain >= least_gain, "{name}: squared error {gain} times smaller at 64 samples");
        assert!(found <= slope, "{name}: error falls with slope {found}");
    }
}

/// The error has few low frequencies: what is left of it after a blur is less than of white noise.
#[test]
fn the_error_is_blue() {
    const WIDTH: usize = 96;
    const HEIGHT: usize = 64;
    let mut world = World::new(job(&format!(
        "[render]\nwidth = {WIDTH}\nheight = {HEIGHT}\n\
         [camera]\neye = [0, 2, 4]\ntarget = [0, 0, 0]\n\
         [[materials]]\nname = 'm'\ndiffuse = [0.7, 0.6, 0.5]\n\
         [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n\
         [[objects]]\ntype = 'box'\nmin = [-9, 1.5, -9]\nmax = [0, 1.6, 9]\nmaterial = 'm'\n\
         [[lights]]\ntype = 'rectangle'\nposition = [0, 3, 0]\nsize = [4, 4]\nvisible = false\n\
         power = [300, 300, 300]\n"
    )));
    let mut picture = |sampler: Sampler, n_samples: u32| {
        world.job.settings.sampler = sampler;
        let mut film = Film::new(WIDTH as u32, HEIGHT as u32).unwrap();
        add(&world, &mut film, n_samples);
        luminances(&film)
    };
    let truth = picture(SOBOL(99), 512);
    // Gaussian of a standard deviation of two pixels.
    let kernel: Vec<f64> = (-6..=6).map(|i: i32| (-f64::from(i * i) / 8.0).exp()).collect();
    let of_white = kernel.iter().map(|k| k * k).sum::<f64>().powi(2);
    let low_energy = |picture: &[f64]| {
        let error = |x: usize, y: usize| picture[y * WIDTH + x] - truth[y * WIDTH + x];
        let (mut low, mut all, mut n_low) = (0.0, 0.0, 0.0);
        for y in 0..HEIGHT - 12 {
            for x in 0..WIDTH - 12 {
                let row = |j: usize| (0..13).map(|i| kernel[i] * error(x + i, y + j)).sum::<f64>();
                low += (0..13).map(|j| kernel[j] * row(j)).sum::<f64>().powi(2);
                n_low += 1.0;
            }
        }
        all += (0..WIDTH * HEIGHT).map(|i| (picture[i] - truth[i]).powi(2)).sum::<f64>();
        (low / n_low) / (all / (WIDTH * HEIGHT) as f64 * of_white)
    };
    for (n_samples, most) in [(1, 0.35), (2, 0.4), (4, 0.5), (8, 0.8)] {
        let sobol = low_energy(&picture(SOBOL(1), n_samples));
        let random = low_energy(&picture(RANDOM(1), n_samples));
        assert!(sobol < most, "{sobol} of white noise at {n_samples} samples");
        assert!((0.7..1.3).contains(&random), "{random} at {n_samples} random samples");
    }
}

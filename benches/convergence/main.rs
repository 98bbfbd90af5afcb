//! Error against samples and against seconds, for the scenes of the gallery and both samplers.
//!
//! ```text
//! cargo bench --bench convergence [-- SCENE ...] [--width W] [--tiles N] [--samples MAX]
//!                                  [--seeds N] [--report FOLDER]
//! ```
//!
//! One JSON line a point. The error is the root mean square of the difference of two pictures that
//! differ in their seed only, over the square root of two: that of either, where the renderer has no
//! bias (which the golden pictures of the tests see to). Beside it the noise figure that the renderer
//! itself gives, and the seconds of one picture. The third kind, "adaptive", is "sobol" with samples
//! that go where the error is. With `--tiles`, N tiles of 16 x 16 pixels, spread over the picture,
//! stand for the whole of it. `--report` writes `convergence.md`, with the table, and the plots
//! `convergence-samples.svg` and `convergence-seconds.svg`. With `--seeds`, the noise figure is judged
//! instead, by that many pictures, and `--report` writes `noise-figure.md`: see [`figure`].
#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

mod figure;
mod plot;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::Vec3;
use penumbra::color::luminance;
use penumbra::geometry::AcceleratorKind;
use penumbra::io::gallery::GALLERY;
use penumbra::loader::{Loaded, Source, load};
use penumbra::render::{Film, RenderJob, RenderSettings, World, render_pass};
use penumbra::scene::description::SamplerKind;
use penumbra::scene::resolve;

/// What goes wrong ends the bench.
type Failure = Box<dyn std::error::Error + Send + Sync>;

struct Options {
    scenes: Vec<String>,
    width: u32,
    tiles: Option<u32>,
    samples: u32,
    seeds: Option<u32>,
    report: Option<PathBuf>,
}

/// How a picture was sampled.
#[derive(Clone, Copy)]
struct Kind {
    label: &'static str,
    sampler: SamplerKind,
    adaptive: bool,
}

const KINDS: [Kind; 3] = [
    Kind { label: "random", sampler: SamplerKind::Random, adaptive: false },
    Kind { label: "sobol", sampler: SamplerKind::Sobol, adaptive: false },
    Kind { label: "adaptive", sampler: SamplerKind::Sobol, adaptive: true },
];

/// One picture at one number of samples.
#[derive(Clone, Copy)]
struct Point {
    samples: u32,
    /// 100 x the root mean squared error over the mean.
    percent: f64,
    /// What the renderer says of it, the root mean square of both pictures.
    figure: f64,
    seconds: f64,
}

/// The points of a scene, for each kind.
struct Measured {
    name: &'static str,
    curves: [Vec<Point>; 3],
}

fn main() -> Result<(), Failure> {
    let options = options()?;
    let pool = penumbra::threads::pool("bench", penumbra::threads::available())?;
    let (mut all, mut judged) = (Vec::new(), Vec::new());
    for entry in GALLERY {
        if !options.scenes.is_empty() && !options.scenes.iter().any(|name| name == entry.name) {
            continue;
        }
        let loaded = load(&Source::Gallery(entry.name), &[], &AtomicBool::new(false))?;
        match options.seeds {
            Some(n) => {
                judged.extend(pool.install(|| figure::judge(entry.name, &loaded, &options, n))?);
            }
            None => all.push(pool.install(|| measure(entry.name, &loaded, &options))?),
        }
    }
    match (&options.report, options.seeds) {
        (Some(folder), Some(n)) => figure::report(folder, &options, n, &judged),
        (Some(folder), None) => report(folder, &options, &all),
        (None, _) => Ok(()),
    }
}

fn options() -> Result<Options, Failure> {
    let (scenes, width, samples) = (Vec::new(), 48, 4096);
    let mut options = Options { scenes, width, tiles: None, samples, seeds: None, report: None };
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or("an option lacks its value");
        match argument.as_str() {
            "--width" => options.width = value()?.parse()?,
            "--tiles" => options.tiles = Some(value()?.parse()?),
            "--samples" => options.samples = value()?.parse()?,
            "--seeds" => options.seeds = Some(value()?.parse()?),
            "--report" => options.report = Some(value()?.into()),
            _ => options.scenes.push(argument),
        }
    }
    Ok(options)
}

fn measure(name: &'static str, loaded: &Loaded, options: &Options) -> Result<Measured, Failure> {
    let mut curves = [const { Vec::new() }; 3];
    for (kind, curve) in KINDS.iter().zip(&mut curves) {
        let mut pairs = Vec::new();
        for tile in 0..options.tiles.unwrap_or(1) {
            let mut pair = Vec::new();
            for seed in [1, 2] {
                let mut job = job(loaded, options.width, *kind, seed)?;
                if options.tiles.is_some() {
                    crop(&mut job, tile);
                }
                pair.push((Film::new(job.width, job.height)?, World::new(job)));
            }
            pairs.push(pair);
        }
        let (mut seconds, mut samples) = (0.0, 4);
        while samples <= options.samples {
            let start = Instant::now();
            for (film, world) in pairs.iter_mut().flatten() {
                let n = samples - film.n_samples();
                let never = AtomicBool::new(false);
                render_pass(world, film, n, &never).map_err(|_| "stopped by nobody")?;
            }
            seconds += 0.5 * start.elapsed().as_secs_f64();
            let films = pairs.iter().map(|pair| (&pair[0].0, &pair[1].0));
            let point = point(films, samples, seconds);
            println!(
                "{{\"scene\":\"{name}\",\"sampler\":\"{}\",\"samples\":{samples},\"rmse_percent\":{:.4},\
                 \"noise_percent\":{:.4},\"seconds\":{seconds:.4}}}",
                kind.label, point.percent, point.figure
            );
            curve.push(point);
            samples *= 2;
        }
    }
    Ok(Measured { name, curves })
}

/// Of pairs of films that differ in their seed only.
fn point<'a>(
    pairs: impl Iterator<Item = (&'a Film, &'a Film)>,
    samples: u32,
    seconds: f64,
) -> Point {
    let (mut squared_error, mut squared_figure, mut light, mut n) = (0.0, 0.0, 0.0, 0.0);
    for (a, b) in pairs {
        let both = luminances(a).into_iter().zip(luminances(b));
        squared_error += both.map(|(a, b)| 0.5 * (a - b).powi(2)).sum::<f64>();
        for film in [a, b] {
            let values = luminances(film);
            let (sum, n_pixels) = (values.iter().sum::<f64>(), values.len() as f64);
            let error = 0.01 * film.noise_percent().unwrap_or(0.0) * sum / n_pixels;
            squared_figure += 0.5 * error.powi(2) * n_pixels;
            light += 0.5 * sum;
            n += 0.5 * n_pixels;
        }
    }
    let percent = |squares: f64| 100.0 * (squares / n).sqrt() * n / light;
    Point { samples, percent: percent(squared_error), figure: percent(squared_figure), seconds }
}

fn job(loaded: &Loaded, width: u32, kind: Kind, seed: u32) -> Result<RenderJob, Failure> {
    let mut description = loaded.description.clone();
    let render = &mut description.render;
    render.height = (width * render.height / render.width).max(1);
    (render.width, render.sampler, render.adaptive) = (width, kind.sampler, kind.adaptive);
    render.seed = seed;
    Ok(RenderJob {
        scene: Arc::new(resolve(&description, &loaded.assets)?),
        width,
        height: description.render.height,
        settings: RenderSettings::new(&description.render, AcceleratorKind::default()),
    })
}

/// One tile of the picture, at a place that its number gives: all of them together cover it evenly.
fn crop(job: &mut RenderJob, tile: u32) {
    const SIDE: u32 = 16;
    // M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
    let place = |step: f64| (0.5 + step * f64::from(tile)).fract() as f32;
    let (width, height) = (job.width as f32, job.height as f32);
    let x = (2.0 * place(0.754_877_666_2) - 1.0) * (width / height);
    let y = 1.0 - 2.0 * place(0.569_840_291_0);
    let mut scene = (*job.scene).clone();
    let camera = &mut scene.camera;
    let aside = camera.tan_half_fov * (x * camera.right + y * camera.up);
    camera.forward += aside;
    camera.tan_half_fov *= SIDE as f32 / height;
    (job.scene, job.width, job.height) = (Arc::new(scene), SIDE, SIDE);
}

fn luminances(film: &Film) -> Vec<f64> {
    let picture = film.picture();
    picture.pixels.iter().map(|p| f64::from(luminance(Vec3::from_array(*p)))).collect()
}

/// The slope of log error over log samples from 16 samples on, by its ends.
fn slope(curve: &[Point]) -> f64 {
    let from = curve.iter().find(|point| point.samples == 16);
    let (Some(from), Some(to)) = (from, curve.last()) else { return f64::NAN };
    (to.percent / from.percent).ln() / (f64::from(to.samples) / f64::from(from.samples)).ln()
}

fn report(folder: &Path, options: &Options, all: &[Measured]) -> Result<(), Failure> {
    let columns: Vec<u32> =
        (1..=6).map(|k| 4_u32.pow(k)).filter(|n| *n <= options.samples).collect();
    let (place, tiles) = match options.tiles {
        Some(n) => (format!("{n} tiles of 16 x 16 pixels of pictures"), format!("--tiles {n} ")),
        None => ("pictures".to_owned(), String::new()),
    };
    let mut text = format!(
        "# Convergence\n\nRoot mean squared error of linear luminance in percent of its mean, for the scenes \
         of the gallery in {} {} wide, written by\n\n```sh\ncargo bench --bench convergence -- --width {} {}\
         --samples {} --report docs\n```\n\n\
         The slope is that of log error over log samples from 16 samples on; the gain is the squared \
         error of \"random\" over that of the row at 64 samples; what the \
         renderer's own noise figure says is compared with the truth in [a table of its own](noise-figure.md).\n\
         In a small picture a pixel covers a whole edge of a shadow or a circle of confusion; in one of \
         full size it does not, and Sobol points gain more: see \
         [what bounds the slope](correctness.md#how-fast-the-error-falls).\n\n\
         ![Error against samples](convergence-samples.svg)\n\n\
         ![Error against seconds](convergence-seconds.svg)\n\n| scene | sampler |",
        place, options.width, options.width, tiles, options.samples
    );
    for n in &columns {
        write!(text, " {n} |")?;
    }
    text += " slope | gain | seconds |\n|---|---|";
    text += &"---|".repeat(columns.len() + 3);
    text += "\n";
    for scene in all {
        for (kind, curve) in KINDS.iter().zip(&scene.curves) {
            let at =
                |curve: &[Point], n: u32| curve.iter().find(|point| point.samples == n).copied();
            write!(text, "| {} | {} |", scene.name, kind.label)?;
            for n in &columns {
                let percent = at(curve, *n).map_or(f64::NAN, |point| point.percent);
                write!(text, " {percent:.3} |")?;
            }
            let gain = at(&scene.curves[0], 64)
                .zip(at(curve, 64))
                .map_or(f64::NAN, |(random, this)| (random.percent / this.percent).powi(2));
            let seconds = curve.last().map_or(f64::NAN, |point| point.seconds);
            let slope = slope(curve);
            writeln!(text, " {slope:.2} | {gain:.1} | {seconds:.1} |")?;
        }
    }
    std::fs::write(folder.join("convergence.md"), text)?;
    let panels = |x: fn(&Point) -> f64| -> Vec<plot::Panel> {
        let curve = |curve: &Vec<Point>| curve.iter().map(|p| [x(p), p.percent]).collect();
        all.iter()
            .map(|scene| plot::Panel {
                title: scene.name,
                curves: scene.curves.each_ref().map(curve),
            })
            .collect()
    };
    let labels = KINDS.map(|kind| kind.label);
    let samples = plot::draw(
        &panels(|p| f64::from(p.samples)),
        labels,
        "error in percent against samples a pixel",
    );
    std::fs::write(folder.join("convergence-samples.svg"), samples)?;
    let seconds = plot::draw(&panels(|p| p.seconds), labels, "error in percent against seconds");
    std::fs::write(folder.join("convergence-seconds.svg"), seconds)?;
    Ok(())
}

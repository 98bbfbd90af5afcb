//! The noise figure against the truth, and how well it foretells the samples that a noise takes.
//!
//! Whole pictures of several seeds. The true squared error is their spread, the figure's the mean of
//! its squares; the doubt of their ratio comes from leaving out one seed after another. A picture's
//! own figure at one count and a later one give the samples that it foretold and those that it took.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use penumbra::loader::Loaded;
use penumbra::render::{Film, Noise, World, render_pass};

use crate::{Failure, KINDS, Kind, Options, job, luminances};

/// Fewer samples tell too little.
const FEWEST: u32 = 8;
/// Doublings ahead of which samples are foretold.
const AHEAD: u32 = 3;

/// What is known of pictures of one scene, one kind and one number of samples.
#[derive(Clone, Copy)]
struct Known {
    samples: u32,
    /// The true error in percent.
    truth: f64,
    /// Figure over truth, and its standard error.
    ratio: f64,
    doubt: f64,
}

/// Of one scene and kind.
pub(crate) struct Judged {
    name: &'static str,
    kind: Kind,
    known: Vec<Known>,
    /// For every picture, count and later count.
    foretold: Vec<Foretold>,
}

/// How well the samples were foretold that it takes to come down to a noise.
#[derive(Clone, Copy)]
struct Foretold {
    /// Samples of the picture that told.
    from: u32,
    /// Doublings it took.
    ahead: u32,
    /// The samples that were still to come, as told, over those that came.
    left: f64,
}

/// One picture as it goes on.
struct Run {
    world: World,
    film: Film,
    noises: Vec<Noise>,
    pixels: Vec<f64>,
}

/// All kinds of one scene.
pub(crate) fn judge(
    name: &'static str,
    loaded: &Loaded,
    options: &Options,
    n_seeds: u32,
) -> Result<Vec<Judged>, Failure> {
    KINDS.into_iter().map(|kind| judge_kind(name, loaded, options, n_seeds, kind)).collect()
}

fn judge_kind(
    name: &'static str,
    loaded: &Loaded,
    options: &Options,
    n_seeds: u32,
    kind: Kind,
) -> Result<Judged, Failure> {
    if n_seeds < 3 {
        return Err("a spread of which one may be left out takes 3 seeds".into());
    }
    let start = |seed: u32| {
        let job = job(loaded, options.width, kind, seed)?;
        let film = Film::new(job.width, job.height)?;
        Ok(Run { world: World::new(job), film, noises: Vec::new(), pixels: Vec::new() })
    };
    let mut runs = (1..=n_seeds).map(start).collect::<Result<Vec<_>, Failure>>()?;
    let (mut known, mut samples) = (Vec::new(), FEWEST);
    while samples <= options.samples {
        for run in &mut runs {
            let n = samples - run.film.n_samples();
            let never = AtomicBool::new(false);
            render_pass(&run.world, &mut run.film, n, &never).map_err(|_| "stopped by nobody")?;
            run.pixels = luminances(&run.film);
            run.noises.push(run.film.noise().ok_or("a black picture")?);
        }
        let found = compare(&runs, samples);
        println!(
            "{{\"scene\":\"{name}\",\"sampler\":\"{}\",\"samples\":{samples},\"rmse_percent\":{:.4},\
             \"figure_over_truth\":{:.3},\"standard_error\":{:.3}}}",
            kind.label, found.truth, found.ratio, found.doubt
        );
        known.push(found);
        samples *= 2;
    }
    let foretold = runs.iter().flat_map(|run| foretold(&run.noises)).collect();
    Ok(Judged { name, kind, known, foretold })
}

/// Figures against the spread of the pictures.
fn compare(runs: &[Run], samples: u32) -> Known {
    let squares = |without: Option<usize>| {
        let others: Vec<&Run> = runs
            .iter()
            .enumerate()
            .filter(|(index, _)| Some(*index) != without)
            .map(|(_, run)| run)
            .collect();
        let n = others.len() as f64;
        let (mut spread, mut light) = (0.0, 0.0);
        for place in 0..others[0].pixels.len() {
            let values = others.iter().map(|run| run.pixels[place]);
            let mean = values.clone().sum::<f64>() / n;
            spread += values.map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
            light += mean;
        }
        let n_pixels = others[0].pixels.len() as f64;
        let truth = spread / n_pixels * (100.0 * n_pixels / light).powi(2);
        let figures = others.iter().map(|run| run.noises[run.noises.len() - 1].percent.powi(2));
        (truth, figures.sum::<f64>() / n)
    };
    let ratio = |(truth, figure): (f64, f64)| (figure / truth).sqrt();
    let all = squares(None);
    let left_out: Vec<f64> = (0..runs.len()).map(|run| ratio(squares(Some(run)))).collect();
    let n = runs.len() as f64;
    let mean = left_out.iter().sum::<f64>() / n;
    let spread: f64 = left_out.iter().map(|ratio| (ratio - mean).powi(2)).sum();
    Known {
        samples,
        truth: all.0.sqrt(),
        ratio: ratio(all),
        doubt: ((n - 1.0) / n * spread).sqrt(),
    }
}

/// Of one picture whose samples double from one figure to the next.
fn foretold(noises: &[Noise]) -> Vec<Foretold> {
    let mut all = Vec::new();
    for (i, early) in noises.iter().enumerate() {
        for (ahead, late) in (1..=AHEAD).zip(&noises[i + 1..]) {
            let took = f64::from((1_u32 << ahead) - 1);
            let left = (early.samples_to(late.percent) - 1.0) / took;
            all.push(Foretold { from: FEWEST << i, ahead, left });
        }
    }
    all
}

/// Writes the table.
pub(crate) fn report(
    folder: &Path,
    options: &Options,
    n_seeds: u32,
    all: &[Judged],
) -> Result<(), Failure> {
    let first = all.first().ok_or("no scene of that name")?;
    let counts: Vec<u32> = first.known.iter().map(|known| known.samples).collect();
    let mut text = format!(
        "# The noise figure against the truth\n\nThe renderer's own noise figure over the true error, \
         for the scenes of the gallery in pictures {0} wide, written by\n\n```sh\n\
         cargo bench --bench convergence -- --width {0} --samples {1} --seeds {n_seeds} --report docs\n\
         ```\n\n\
         The truth is the spread of {n_seeds} pictures that differ in their seed only, the figure the root \
         mean square of theirs; after ± stands the standard error of the ratio, from leaving out one \
         seed after another.\n\
         The last column tells how far one picture's own forecast of the samples that are left to a noise, \
         and with them of the time, was off, up to three doublings ahead, from {FEWEST} samples on: the \
         root mean square of the error, and in which share of cases it was within a fifth.\n\n\
         | scene | sampler |",
        options.width, options.samples
    );
    for n in &counts {
        write!(text, " {n} |")?;
    }
    text += " time left |\n|---|---|";
    text += &"---|".repeat(counts.len() + 1);
    text += "\n";
    for Judged { name, kind, known, foretold } in all {
        write!(text, "| {name} | {} |", kind.label)?;
        for known in known {
            write!(text, " {:.2} ± {:.2} |", known.ratio, known.doubt)?;
        }
        writeln!(text, " {} |", accuracy(foretold.iter().copied()))?;
    }
    text += "\n| sampler | figures within a quarter of the truth | time left |\n|---|---|---|\n";
    for kind in KINDS {
        let of_kind = || all.iter().filter(|judged| judged.kind.label == kind.label);
        let ratios = || of_kind().flat_map(|judged| &judged.known);
        let n_within = ratios().filter(|known| (0.75..=1.25).contains(&known.ratio)).count();
        let foretold = of_kind().flat_map(|judged| judged.foretold.iter().copied());
        let (label, n) = (kind.label, ratios().count());
        writeln!(text, "| {label} | {n_within} of {n} | {} |", accuracy(foretold))?;
    }
    text += "\nThe time left by the samples from which it was told, and how many doublings ahead:\n\n\
             | sampler | from |";
    for ahead in 1..=AHEAD {
        write!(text, " {} times the samples |", 1 << ahead)?;
    }
    text += "\n|---|---|";
    text += &"---|".repeat(AHEAD as usize);
    text += "\n";
    for kind in KINDS {
        for from in &counts[..counts.len() - 1] {
            write!(text, "| {} | {from} |", kind.label)?;
            for ahead in 1..=AHEAD {
                let of_kind = all.iter().filter(|judged| judged.kind.label == kind.label);
                let foretold = of_kind.flat_map(|judged| judged.foretold.iter().copied());
                let those = foretold.filter(|one| one.from == *from && one.ahead == ahead);
                write!(text, " {} |", accuracy(those))?;
            }
            text += "\n";
        }
    }
    std::fs::write(folder.join("noise-figure.md"), text)?;
    Ok(())
}

fn accuracy(all: impl Iterator<Item = Foretold>) -> String {
    let errors: Vec<f64> = all.map(|one| one.left - 1.0).collect();
    if errors.is_empty() {
        return String::new();
    }
    let n = errors.len() as f64;
    let square = errors.iter().map(|error| error.powi(2)).sum::<f64>() / n;
    let n_within = errors.iter().filter(|error| error.abs() <= 0.2).count();
    format!("{:.2}, {:.0} %", square.sqrt(), 100.0 * n_within as f64 / n)
}

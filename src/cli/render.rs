//! `penumbra render`: a scene to a picture file.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::anyhow;

use crate::cli::progress::Progress;
use crate::cli::{Failure, RenderArguments, pool, print_json, warn};
use crate::geometry::AcceleratorKind;
use crate::io::output::{OutputFormat, check_writable, keep_elsewhere, replace_file};
use crate::io::scene_file::Override;
use crate::io::snapshot;
use crate::io::{crash, memory, printable_path};
use crate::loader::{LoadError, Loaded, Source, load};
use crate::render::{RenderJob, RenderSettings, World};
use crate::scene::resolve;
use crate::session::Goal;
use crate::session::admit::admit;
use crate::session::develop::{Developed, develop, encode};

/// Bytes without which even a small scene is not begun.
const LEAST: u64 = 16 << 20;

pub(super) fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let output = &arguments.output;
    let Some(format) = OutputFormat::of(output) else {
        return Err(Failure::Usage(format!(
            "--output {}: unknown ending; give a name that ends in .png, .exr or .hdr",
            printable_path(output)
        )));
    };
    // Before hours are spent on a picture that has no place to go.
    check_writable(output)?;
    let loaded = open(&arguments.file, &overrides(arguments))?;
    spare(output, &arguments.file, &loaded)?;
    warn(&loaded.report, arguments.quiet);
    crash::rehearse();
    let samples = loaded.description.render.samples;
    let start = Instant::now();
    let pool = pool("render", arguments.threads)?;
    let world = world_of(&loaded, arguments.accelerator, &pool)?;
    let goal = Goal { samples, seconds: arguments.time, noise_percent: arguments.noise };
    let mut progress = Progress::new(goal, arguments.quiet);
    let never = AtomicBool::new(false);
    let Developed { film, n_invalid } =
        develop(&world, &pool, goal, start, &never, |film| progress.show(film))?;
    progress.finish();
    warn(&not_finite(n_invalid), arguments.quiet);
    let seconds = start.elapsed().as_secs_f64();
    let size = (film.width(), film.height());
    let texts = snapshot::texts(&loaded.description, size, film.n_samples(), &loaded.files, None)?;
    let tone_mapping = &loaded.description.tone_mapping;
    let bytes = encode(output, format, &film.picture(), tone_mapping, &texts)?;
    if let Err(error) = replace_file(output, &bytes) {
        // Hours may have been spent on it, and the disk have filled up meanwhile.
        return Err(match keep_elsewhere(output, &bytes) {
            Some(place) => anyhow!("{error}; the picture is in {}", printable_path(&place)).into(),
            None => error.into(),
        });
    }
    if arguments.json {
        let summary = serde_json::json!({
            "output": output.to_string_lossy(),
            "width": size.0,
            "height": size.1,
            "samples": film.n_samples(),
            "seconds": seconds,
            "noise_percent": film.noise_percent(),
        });
        print_json(&summary)?;
    }
    Ok(())
}

/// Loads a file; a wrong `--set` is the command line's fault.
pub(super) fn open(file: &Path, overrides: &[Override]) -> Result<Loaded, Failure> {
    memory::check(LEAST).map_err(|error| anyhow!("penumbra itself {error}"))?;
    match load(&Source::File(file.to_owned()), overrides, &AtomicBool::new(false)) {
        Ok(loaded) => Ok(loaded),
        Err(LoadError::Override(error)) => Err(Failure::Usage(error.to_string())),
        Err(error) => Err(error.into()),
    }
}

/// Refuses an output that would take the place of what the picture is made of. A snapshot may: the new
/// one carries the same scene.
fn spare(output: &Path, scene: &Path, loaded: &Loaded) -> Result<(), Failure> {
    let Ok(place) = output.canonicalize() else { return Ok(()) };
    let scene = loaded.snapshot.is_none().then(|| scene.to_owned());
    let read = loaded.files.iter().filter_map(|record| loaded.folder.disk_path(&record.file));
    if scene.into_iter().chain(read).all(|path| path.canonicalize().ok() != Some(place.clone())) {
        return Ok(());
    }
    let output = printable_path(output);
    Err(anyhow!("--output {output}: the scene is read from there; give another name").into())
}

/// The scene with its trees built.
pub(super) fn world_of(
    loaded: &Loaded,
    accelerator: AcceleratorKind,
    pool: &rayon::ThreadPool,
) -> anyhow::Result<World> {
    let scene = resolve(&loaded.description, &loaded.assets)?;
    let render = &loaded.description.render;
    let job = RenderJob {
        scene: Arc::new(scene),
        width: render.width,
        height: render.height,
        settings: RenderSettings::new(render, accelerator),
    };
    admit(&job)?;
    Ok(pool.install(|| World::new(job)))
}

/// A warning where any samples were not finite.
pub(super) fn not_finite(n_invalid: u64) -> Vec<String> {
    let warning = || format!("{n_invalid} samples were not finite and counted as black");
    (n_invalid > 0).then(warning).into_iter().collect()
}

/// `--set` first, then the options of their own, which win.
fn overrides(arguments: &RenderArguments) -> Vec<Override> {
    let mut overrides = arguments.sets.clone();
    let options = [
        ("--samples", "samples", arguments.samples),
        ("--width", "width", arguments.width),
        ("--height", "height", arguments.height),
        ("--seed", "seed", arguments.seed),
    ];
    for (option, key, value) in options {
        if let Some(value) = value {
            overrides.push(Override::new(option, &["render", key], i64::from(value)));
        }
    }
    overrides
}

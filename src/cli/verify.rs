//! `penumbra verify`: does a snapshot's scene still give its picture?

use std::time::Instant;

use anyhow::anyhow;

use crate::cli::progress::Progress;
use crate::cli::render::{Limits, develop, open, world_of};
use crate::cli::{Failure, VerifyArguments, print, warn};
use crate::geometry::AcceleratorKind;
use crate::io::files::read_file;
use crate::io::folder::LARGEST_ASSET;
use crate::io::output::srgb_bytes;
use crate::io::snapshot::read_pixels;
use crate::threads;

pub(super) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let path = &arguments.shot;
    let loaded = open(path, &[])?;
    let Some(record) = &loaded.snapshot else {
        return Err(
            anyhow!("{}: is no snapshot; give a PNG saved by penumbra", path.display()).into()
        );
    };
    warn(&loaded.report, arguments.quiet);
    let (width, height, saved) = read_pixels(&read_file(path, LARGEST_ASSET)?)?;
    let n_threads = arguments.threads.map_or_else(threads::available, |n| n as usize);
    let pool = threads::pool("render", n_threads)?;
    let mut world = world_of(&loaded, AcceleratorKind::default(), &pool)?;
    let limits = Limits { samples: record.samples, seconds: None, noise: None };
    let mut progress = Progress::new(u64::from(record.samples), arguments.quiet);
    let film = develop(&mut world, &pool, limits, Instant::now(), |film| progress.show(film))?;
    progress.finish();
    let rendered = srgb_bytes(&film.picture(), &loaded.description.tone_mapping);
    let version = env!("CARGO_PKG_VERSION");
    let versions = if record.version == version {
        String::new()
    } else {
        format!("; saved by version {}, this is {version}", record.version)
    };
    if (width, height) != (film.width(), film.height()) {
        let (w, h) = (film.width(), film.height());
        print(&format!(
            "different: the picture is {width} x {height}, its scene {w} x {h}{versions}"
        ));
        return Err(Failure::Different);
    }
    let n_different = saved.iter().zip(&rendered).filter(|(a, b)| a != b).count();
    if n_different > 0 {
        let n = rendered.len();
        print(&format!("different: {n_different} of {n} bytes{versions}"));
        return Err(Failure::Different);
    }
    print(&format!("equal: {} bytes at {} samples", rendered.len(), record.samples));
    Ok(())
}

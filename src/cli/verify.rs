//! `penumbra verify`: does a snapshot's scene still give its picture?

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::anyhow;

use crate::cli::progress::Progress;
use crate::cli::render::{not_finite, open, world_of};
use crate::cli::{Failure, VerifyArguments, pool, print, warn};
use crate::geometry::AcceleratorKind;
use crate::io::files::read_file;
use crate::io::folder::LARGEST_ASSET;
use crate::io::snapshot::{SnapshotError, read_pixels};
use crate::io::{excerpt, printable_path};
use crate::session::Goal;
use crate::session::develop::{Developed, develop};
use crate::tone_mapping::srgb_bytes;

pub(super) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let path = &arguments.shot;
    let shown = printable_path(path);
    let other = || anyhow!("{shown}: is no snapshot; give a PNG saved by penumbra");
    if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
        return Err(other().into());
    }
    let loaded = open(path, &[])?;
    let record = loaded.snapshot.as_ref().ok_or_else(other)?;
    warn(&loaded.report, arguments.quiet);
    let render = &loaded.description.render;
    if (record.samples, record.seed) != (render.samples, render.seed) {
        return Err(anyhow!("{shown}: its scene and its record differ: the file is damaged").into());
    }
    let version = env!("CARGO_PKG_VERSION");
    let versions = if record.version == version {
        String::new()
    } else {
        format!("; saved by version {}, this is {version}", excerpt(record.version.as_bytes()))
    };
    let saved = match read_pixels(&read_file(path, LARGEST_ASSET)?, (render.width, render.height)) {
        Ok(saved) => saved,
        Err(error @ SnapshotError::OtherSize { .. }) => {
            print(&format!("different: {error}{versions}"))?;
            return Err(Failure::Different);
        }
        Err(error) => return Err(anyhow!("{shown}: {error}").into()),
    };
    let pool = pool("render", arguments.threads)?;
    let world = world_of(&loaded, AcceleratorKind::default(), &pool)?;
    let goal = Goal { samples: record.samples, seconds: None, noise_percent: None };
    let mut progress = Progress::new(goal, arguments.quiet);
    let never = AtomicBool::new(false);
    let Developed { film, n_invalid } =
        develop(&world, &pool, goal, Instant::now(), &never, |film| progress.show(film))?;
    progress.finish();
    warn(&not_finite(n_invalid), arguments.quiet);
    let rendered = srgb_bytes(&film.picture(), &loaded.description.tone_mapping);
    let n_different = saved.iter().zip(&rendered).filter(|(a, b)| a != b).count();
    if n_different > 0 {
        let n = rendered.len();
        print(&format!("different: {n_different} of {n} bytes{versions}"))?;
        return Err(Failure::Different);
    }
    print(&format!("equal: {} bytes at {} samples", rendered.len(), record.samples))?;
    Ok(())
}

//! From a file to a scene: scene files, meshes in a scene's place, and snapshots.
//!
//! [`load`] does the work where it is called; [`Loader`] does it on a thread of its own, the newest
//! request first, and can be cancelled.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::io::files::{FileError, read_file};
use crate::io::folder::{FileRecord, Folder, LARGEST_ASSET};
use crate::io::obj::ObjError;
use crate::io::progress::Step;
use crate::io::scene_file::{self, LARGEST_FILE, Override, OverrideError, SceneFileError, Section};
use crate::io::snapshot::{self, RenderRecord, SnapshotError};
use crate::io::{crash, gallery, printable_path};
use crate::math::Aabb;
use crate::scene::assets::{Assets, MeshAsset, MeshKey};
use crate::scene::description::SceneDescription;

mod framing;
mod reading;
mod worker;

use reading::{AssetFailure, Reading};
pub use worker::{LoadProgress, Loader};

/// Hears of a file, as the scene names it, what is being done with it.
type Told<'a> = dyn Fn(&str, Step) + 'a;

/// What is opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A scene, a mesh or a snapshot on disk.
    File(PathBuf),
    /// A scene of the gallery, by name.
    Gallery(&'static str),
}

impl Source {
    /// The name to show and to derive other names from, without folder and ending.
    pub fn stem(&self) -> String {
        match self {
            Self::File(path) => path
                .file_stem()
                .map_or_else(|| "scene".into(), |s| s.to_string_lossy().into_owned()),
            Self::Gallery(name) => (*name).to_owned(),
        }
    }

    /// Whether it is a mesh, whose scene is made up around it.
    pub fn is_mesh(&self) -> bool {
        match self {
            Self::File(path) => has_ending(path, "obj"),
            Self::Gallery(_) => false,
        }
    }
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// A scene with everything that its files hold.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// Where it came from.
    pub source: Source,
    /// Where its relative paths start from.
    pub folder: Folder,
    /// The scene.
    pub description: SceneDescription,
    /// Meshes and images, all that the description names.
    pub assets: Assets,
    /// The files that were read, the scene itself left out.
    pub files: Vec<FileRecord>,
    /// What was missing or repaired, a line each.
    pub report: Vec<String>,
    /// How the snapshot was made, if it was one.
    pub snapshot: Option<RenderRecord>,
}

/// Why nothing was loaded. The message begins with the file.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// An override on the command line is wrong.
    #[error(transparent)]
    Override(OverrideError),
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// Nothing that can be opened.
    #[error("{name}: is no scene, mesh or snapshot; give a file that ends in .toml, .obj or .png")]
    Unknown {
        /// The file.
        name: String,
    },
    /// The scene is wrong, or names a file that is.
    #[error("{}", .error.in_file(.name))]
    Scene {
        /// The scene file.
        name: String,
        /// What is wrong.
        error: SceneFileError,
    },
    /// A mesh in a scene's place is wrong.
    #[error("{name}: {error}")]
    Mesh {
        /// The file.
        name: String,
        /// What is wrong.
        error: ObjError,
    },
    /// A mesh in a scene's place is too far out for a scene around it.
    #[error(
        "{name}: reaches {reach:e} from the origin, too far to be framed (at most {:e}); make it \
         smaller by `scale` in a scene",
        framing::FARTHEST
    )]
    Unframed {
        /// The file.
        name: String,
        /// Its largest coordinate.
        reach: f32,
    },
    /// A PNG is no snapshot.
    #[error("{name}: {error}")]
    Snapshot {
        /// The file.
        name: String,
        /// What is wrong.
        error: SnapshotError,
    },
    /// There is no such scene in the gallery.
    #[error("the gallery has no scene {0:?}")]
    NotInGallery(String),
    /// An edited scene names a file that cannot be used.
    #[error("{0}")]
    Edit(String),
    /// The loader itself failed; the next file is loaded as if nothing had been.
    #[error("loading failed: {0}; this is a mistake in penumbra")]
    Failed(String),
    /// The request was cancelled or replaced by a newer one.
    #[error("cancelled")]
    Cancelled,
}

/// Loads a file with overrides of its parameters. `is_cancelled` is looked at before every
/// file, and at every line of a mesh.
///
/// # Errors
/// See [`LoadError`]; nothing is half loaded.
pub fn load(
    source: &Source,
    overrides: &[Override],
    is_cancelled: &AtomicBool,
) -> Result<Loaded, LoadError> {
    load_telling(source, overrides, is_cancelled, &|_, _| ())
}

/// [`load`] that says of each file how far it is.
fn load_telling(
    source: &Source,
    overrides: &[Override],
    stop: &AtomicBool,
    told: &Told<'_>,
) -> Result<Loaded, LoadError> {
    let opened = Opened::open(source, stop, told)?;
    let scene_error = |error| match error {
        SceneFileError::Override(error) => LoadError::Override(error),
        error => LoadError::Scene { name: opened.name.clone(), error },
    };
    crash::note_scene(opened.text.as_str());
    let description = scene_file::parse(&opened.text, overrides).map_err(scene_error)?;
    let mut reading = Reading::new(&opened.folder, stop, told);
    reading.report.extend(opened.report.iter().cloned());
    reading.assets.meshes.extend(opened.meshes.clone());
    reading.records.extend(opened.mesh_files.iter().cloned());
    reading.all_of(&description).map_err(|failure| match failure {
        AssetFailure::Cancelled => LoadError::Cancelled,
        AssetFailure::Broken { section, index, message } => {
            scene_error(scene_file::file_fault(&opened.text, overrides, section, index, &message))
        }
    })?;
    Ok(Loaded {
        source: source.clone(),
        folder: opened.folder.clone(),
        description,
        assets: reading.assets,
        files: reading.records,
        report: reading.report,
        snapshot: opened.snapshot,
    })
}

/// Loads what an edited description names and `assets` does not hold yet.
///
/// # Errors
/// The parameter's path and what is wrong with its file.
fn load_missing(
    description: &SceneDescription,
    folder: &Folder,
    assets: &Assets,
    stop: &AtomicBool,
    told: &Told<'_>,
) -> Result<(Assets, Vec<FileRecord>, Vec<String>), String> {
    let mut reading = Reading::new(folder, stop, told);
    reading.assets = assets.clone();
    match reading.all_of(description) {
        Ok(()) => Ok((reading.assets, reading.records, reading.report)),
        Err(AssetFailure::Cancelled) => Err("cancelled".to_owned()),
        Err(AssetFailure::Broken { section, index, message }) => {
            let name = match section {
                Section::Objects => description.objects.get(index).map(|entry| &entry.name),
                _ => description.textures.get(index).map(|entry| &entry.name),
            };
            let name = name.map_or("", String::as_str);
            Err(format!("{}.{name}.file: {message}", section.name()))
        }
    }
}

/// What was opened, as the text of a scene.
struct Opened {
    name: String,
    text: String,
    folder: Folder,
    snapshot: Option<RenderRecord>,
    /// A mesh in a scene's place, read already.
    meshes: HashMap<MeshKey, Arc<MeshAsset>>,
    mesh_files: Vec<FileRecord>,
    report: Vec<String>,
}

impl Opened {
    fn open(source: &Source, stop: &AtomicBool, told: &Told<'_>) -> Result<Self, LoadError> {
        let path = match source {
            Source::Gallery(name) => {
                let text = gallery::scene_text(name)
                    .ok_or_else(|| LoadError::NotInGallery((*name).to_owned()))?;
                return Ok(Self::scene(format!("{name}.toml"), text.to_owned(), Folder::Gallery));
            }
            Source::File(path) => path,
        };
        let name = printable_path(path);
        let is_scene = has_ending(path, "toml");
        let bytes = read_file(path, if is_scene { LARGEST_FILE } else { LARGEST_ASSET })?;
        if bytes.starts_with(b"\x89PNG") || has_ending(path, "png") {
            let snapshot = snapshot::read(&bytes, path)
                .map_err(|error| LoadError::Snapshot { name: name.clone(), error })?;
            let mut opened = Self::scene(name, snapshot.scene, snapshot.folder);
            opened.snapshot = Some(snapshot.record);
            return Ok(opened);
        }
        if source.is_mesh() {
            return Self::mesh(name, path, &bytes, stop, told);
        }
        if !is_scene && str::from_utf8(&bytes).is_err() {
            return Err(LoadError::Unknown { name });
        }
        let text = scene_file::text_of(bytes)
            .map_err(|error| LoadError::Scene { name: name.clone(), error })?;
        Ok(Self::scene(name, text, Folder::of(path)))
    }

    fn scene(name: String, text: String, folder: Folder) -> Self {
        Self {
            name,
            text,
            folder,
            snapshot: None,
            meshes: HashMap::new(),
            mesh_files: Vec::new(),
            report: Vec::new(),
        }
    }

    /// A mesh opened alone: framed, on a ground, softly lit.
    fn mesh(
        name: String,
        path: &Path,
        bytes: &[u8],
        stop: &AtomicBool,
        told: &Told<'_>,
    ) -> Result<Self, LoadError> {
        let file = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let folder = Folder::of(path);
        let mut reading = Reading::new(&folder, stop, told);
        let mut description = framing::scene_around(&file, None);
        let keys = description.objects.iter().filter_map(MeshKey::of);
        reading.meshes_of(&file, keys, bytes).map_err(|error| match error {
            ObjError::Cancelled => LoadError::Cancelled,
            error => LoadError::Mesh { name: name.clone(), error },
        })?;
        reading.records.insert(0, FileRecord::of(&file, bytes));
        let meshes = reading.assets.meshes;
        let bounds = meshes.values().map(|mesh| mesh.traced.bounds).fold(Aabb::EMPTY, Aabb::union);
        let reach = bounds.max_abs();
        if framing::FARTHEST < reach {
            return Err(LoadError::Unframed { name, reach });
        }
        description = framing::scene_around(&file, Some(bounds));
        let mut report = reading.report;
        if path.file_name().and_then(OsStr::to_str).is_none() {
            let why = "its name is no UTF-8, so that no saved scene or snapshot can find it";
            report.push(format!("{name}: {why}; give it another name first"));
        }
        let mut opened = Self::scene(name, scene_file::write(&description), folder.clone());
        opened.meshes = meshes;
        opened.mesh_files = reading.records;
        opened.report = report;
        Ok(opened)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::AcceleratorKind;
    use crate::io::gallery::GALLERY;
    use crate::math::vectorized::at_every_level;
    use crate::render::{Film, RenderJob, RenderSettings, World, render_pass};
    use crate::scene::description::IntegratorKind;
    use crate::scene::resolve;
    use crate::threads;

    /// Registers of any width, and none.
    #[test]
    fn scenes_of_the_gallery_have_the_same_bytes_on_every_processor() {
        let stop = AtomicBool::new(false);
        let pool = threads::pool("test", 1).unwrap();
        for entry in GALLERY {
            let loaded = load(&Source::Gallery(entry.name), &[], &stop).unwrap();
            let scene = Arc::new(resolve(&loaded.description, &loaded.assets).unwrap());
            for integrator in [IntegratorKind::Direct, IntegratorKind::Path] {
                let accelerator = AcceleratorKind::default();
                let mut settings = RenderSettings::new(&loaded.description.render, accelerator);
                settings.integrator = integrator;
                let job = RenderJob { scene: Arc::clone(&scene), width: 40, height: 24, settings };
                let world = World::new(job);
                let picture = || {
                    let mut film = Film::new(40, 24).unwrap();
                    render_pass(&world, &mut film, 2, &stop).unwrap();
                    film.picture().pixels
                };
                let pictures = pool.install(|| at_every_level(picture));
                for (level, picture) in &pictures {
                    assert!(
                        *picture == pictures[0].1,
                        "{} by {integrator:?}: {level:?} differs from {:?}",
                        entry.name,
                        pictures[0].0
                    );
                }
            }
        }
    }
}

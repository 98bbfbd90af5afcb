//! From a file to a scene: scene files, meshes in a scene's place, and snapshots.
//!
//! [`load`] does the work where it is called; [`Loader`] does it on a thread of its own, the newest
//! request first, and can be cancelled.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::geometry::TracedMesh;
use crate::io::files::{FileError, read_file};
use crate::io::folder::{FileRecord, Folder, LARGEST_ASSET};
use crate::io::obj::{self, ObjError};
use crate::io::scene_file::{self, Override, OverrideError, SceneFileError, Section};
use crate::io::snapshot::{self, RenderRecord, SnapshotError};
use crate::io::{excerpt, gallery, image_file, mtl, printable_path};
use crate::scene::assets::{Assets, MeshAsset, MeshKey, SlotMaterial};
use crate::scene::description::{ObjectKind, SceneDescription, TextureKind};
use crate::scene::image::Image;

mod framing;
mod worker;

pub use worker::{LoadProgress, Loader};

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
    /// The request was cancelled or replaced by a newer one.
    #[error("cancelled")]
    Cancelled,
}

/// Loads a file with overrides of its parameters. `is_cancelled` is looked at before every file.
///
/// # Errors
/// See [`LoadError`]; nothing is half loaded.
pub fn load(
    source: &Source,
    overrides: &[Override],
    is_cancelled: &AtomicBool,
) -> Result<Loaded, LoadError> {
    let opened = Opened::open(source)?;
    let scene_error = |error| match error {
        SceneFileError::Override(error) => LoadError::Override(error),
        error => LoadError::Scene { name: opened.name.clone(), error },
    };
    let description = scene_file::parse(&opened.text, overrides).map_err(scene_error)?;
    let mut reading = Reading::new(&opened.folder, is_cancelled);
    reading.report.extend(opened.report.iter().cloned());
    reading.assets.meshes.extend(opened.mesh.clone());
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
pub fn load_missing(
    description: &SceneDescription,
    folder: &Folder,
    assets: &Assets,
    is_cancelled: &AtomicBool,
) -> Result<(Assets, Vec<FileRecord>, Vec<String>), String> {
    let mut reading = Reading::new(folder, is_cancelled);
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
    mesh: Option<(MeshKey, Arc<MeshAsset>)>,
    mesh_files: Vec<FileRecord>,
    report: Vec<String>,
}

impl Opened {
    fn open(source: &Source) -> Result<Self, LoadError> {
        let path = match source {
            Source::Gallery(name) => {
                let text = gallery::scene_text(name)
                    .ok_or_else(|| LoadError::NotInGallery((*name).to_owned()))?;
                return Ok(Self::scene(format!("{name}.toml"), text.to_owned(), Folder::Gallery));
            }
            Source::File(path) => path,
        };
        let name = printable_path(path);
        let bytes = read_file(path, LARGEST_ASSET)?;
        if bytes.starts_with(b"\x89PNG") {
            let snapshot = snapshot::read(&bytes, path)
                .map_err(|error| LoadError::Snapshot { name: name.clone(), error })?;
            let mut opened = Self::scene(name, snapshot.scene, snapshot.folder);
            opened.snapshot = Some(snapshot.record);
            return Ok(opened);
        }
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj")) {
            return Self::mesh(name, path, &bytes);
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
            mesh: None,
            mesh_files: Vec::new(),
            report: Vec::new(),
        }
    }

    /// A mesh opened alone: framed, on a ground, softly lit.
    fn mesh(name: String, path: &Path, bytes: &[u8]) -> Result<Self, LoadError> {
        let file = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let folder = Folder::of(path);
        let never = AtomicBool::new(false);
        let mut reading = Reading::new(&folder, &never);
        let mut description = framing::scene_around(&file, None);
        let key = description.objects.first().and_then(MeshKey::of);
        let Some(key) = key else { return Err(LoadError::NotInGallery(name)) };
        let asset = reading
            .mesh_of(&key, bytes)
            .map_err(|error| LoadError::Mesh { name: name.clone(), error })?;
        reading.records.insert(0, FileRecord::of(&file, bytes));
        description = framing::scene_around(&file, Some(asset.traced.bounds));
        let mut opened = Self::scene(name, scene_file::write(&description), folder.clone());
        opened.mesh = Some((key, Arc::new(asset)));
        opened.mesh_files = reading.records;
        opened.report = reading.report;
        Ok(opened)
    }
}

/// The files of one scene on their way in; each is read once.
struct Reading<'a> {
    folder: &'a Folder,
    is_cancelled: &'a AtomicBool,
    assets: Assets,
    records: Vec<FileRecord>,
    report: Vec<String>,
}

enum AssetFailure {
    Cancelled,
    Broken { section: Section, index: usize, message: String },
}

impl<'a> Reading<'a> {
    fn new(folder: &'a Folder, is_cancelled: &'a AtomicBool) -> Self {
        Self {
            folder,
            is_cancelled,
            assets: Assets { meshes: HashMap::new(), images: HashMap::new() },
            records: Vec::new(),
            report: Vec::new(),
        }
    }

    /// Everything that a description names, disabled objects and unused textures too.
    fn all_of(&mut self, description: &SceneDescription) -> Result<(), AssetFailure> {
        for (index, object) in description.objects.iter().enumerate() {
            self.check_cancelled()?;
            let ObjectKind::Mesh = object.kind else { continue };
            let Some(key) = MeshKey::of(object) else { continue };
            if self.assets.meshes.contains_key(&key) {
                continue;
            }
            let broken =
                |message| AssetFailure::Broken { section: Section::Objects, index, message };
            let bytes = self.read(&key.file).map_err(|error| broken(error.to_string()))?;
            let label = excerpt(key.file.as_bytes());
            let asset =
                self.mesh_of(&key, &bytes).map_err(|error| broken(format!("{label}: {error}")))?;
            self.assets.meshes.insert(key, Arc::new(asset));
        }
        for (index, texture) in description.textures.iter().enumerate() {
            self.check_cancelled()?;
            let (TextureKind::Image, Some(file)) = (texture.kind, &texture.file) else { continue };
            if self.assets.images.contains_key(file) {
                continue;
            }
            let image = self.image(file).map_err(|message| AssetFailure::Broken {
                section: Section::Textures,
                index,
                message,
            })?;
            self.assets.images.insert(file.clone(), Arc::new(image));
        }
        Ok(())
    }

    fn check_cancelled(&self) -> Result<(), AssetFailure> {
        if self.is_cancelled.load(Ordering::Relaxed) {
            return Err(AssetFailure::Cancelled);
        }
        Ok(())
    }

    fn read(&mut self, file: &str) -> Result<Vec<u8>, FileError> {
        let bytes = self.folder.read(file)?;
        if !self.records.iter().any(|record| record.file == file) {
            self.records.push(FileRecord::of(file, &bytes));
        }
        Ok(bytes)
    }

    fn image(&mut self, file: &str) -> Result<Image, String> {
        let bytes = self.read(file).map_err(|error| error.to_string())?;
        image_file::decode(&bytes).map_err(|error| format!("{}: {error}", excerpt(file.as_bytes())))
    }

    /// The mesh with its libraries' materials; whatever is wrong with those is reported only.
    fn mesh_of(&mut self, key: &MeshKey, bytes: &[u8]) -> Result<MeshAsset, ObjError> {
        let (mesh, notes) = obj::load_mesh(bytes, key.normals, key.crease_angle_deg())?;
        let label = excerpt(key.file.as_bytes());
        let beside = Path::new(&key.file).parent().unwrap_or(Path::new("")).to_owned();
        let named = |path: &Path| beside.join(path).to_string_lossy().into_owned();
        let (materials, warnings) =
            mtl::materials_of_slots(&notes.slot_names, &notes.libraries, |path| {
                self.read(&named(path)).map_err(|error| error.reason().to_owned())
            });
        let told = notes.warnings.into_iter().chain(warnings);
        self.report.extend(told.map(|warning| format!("{label}: {warning}")));
        let mut maps: HashMap<String, Option<Arc<Image>>> = HashMap::new();
        let mut slots = Vec::with_capacity(materials.len());
        for material in materials {
            let Some(material) = material else {
                slots.push(None);
                continue;
            };
            let diffuse_map = material.diffuse_map.and_then(|map| {
                let file = named(Path::new(&map));
                if !maps.contains_key(&file) {
                    let image = self.image(&file);
                    if let Err(reason) = &image {
                        self.report.push(format!("{label}: map_Kd {reason}"));
                    }
                    maps.insert(file.clone(), image.ok().map(Arc::new));
                }
                maps.get(&file).cloned().flatten()
            });
            slots.push(Some(SlotMaterial { description: material.description, diffuse_map }));
        }
        let has_map = slots.iter().flatten().any(|slot| slot.diffuse_map.is_some());
        if mesh.uvs.is_empty() && has_map {
            self.report.push(format!("{label}: has no texture coordinates; (0, 0) is used"));
        }
        Ok(MeshAsset { traced: Arc::new(TracedMesh::new(mesh)), slots })
    }
}

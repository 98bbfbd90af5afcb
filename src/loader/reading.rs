//! The files that a scene names, on their way in.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::geometry::TracedMesh;
use crate::io::files::FileError;
use crate::io::folder::{FileRecord, Folder};
use crate::io::obj::{self, ObjError};
use crate::io::progress::{Step, Watch};
use crate::io::scene_file::Section;
use crate::io::{excerpt, image_file, mtl};
use crate::loader::Told;
use crate::scene::assets::{Assets, MeshAsset, MeshKey, SlotMaterial};
use crate::scene::description::{ObjectKind, SceneDescription, TextureKind};
use crate::scene::image::Image;

/// The files of one scene on their way in; each is read once.
pub(super) struct Reading<'a> {
    folder: &'a Folder,
    stop: &'a AtomicBool,
    told: &'a Told<'a>,
    pub(super) assets: Assets,
    pub(super) records: Vec<FileRecord>,
    pub(super) report: Vec<String>,
    /// A library or an image that a snapshot's mesh had and that is gone or changed.
    lost: Option<FileError>,
}

/// Why not everything was read.
pub(super) enum AssetFailure {
    Cancelled,
    Broken { section: Section, index: usize, message: String },
}

impl<'a> Reading<'a> {
    pub(super) fn new(folder: &'a Folder, stop: &'a AtomicBool, told: &'a Told<'a>) -> Self {
        Self {
            folder,
            stop,
            told,
            assets: Assets { meshes: HashMap::new(), images: HashMap::new() },
            records: Vec::new(),
            report: Vec::new(),
            lost: None,
        }
    }

    /// Everything that a description names, disabled objects and unused textures too.
    pub(super) fn all_of(&mut self, description: &SceneDescription) -> Result<(), AssetFailure> {
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
            let asset = self.mesh_of(&key, &bytes).map_err(|error| match error {
                ObjError::Cancelled => AssetFailure::Cancelled,
                error => broken(format!("{label}: {error}")),
            })?;
            if let Some(lost) = self.lost.take() {
                return Err(broken(lost.to_string()));
            }
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
        if self.stop.load(Ordering::Relaxed) {
            return Err(AssetFailure::Cancelled);
        }
        Ok(())
    }

    fn read(&mut self, file: &str) -> Result<Vec<u8>, FileError> {
        (self.told)(file, Step::Reading(0.0));
        let bytes = self.folder.read(file)?;
        if !self.records.iter().any(|record| record.file == file) {
            self.records.push(FileRecord::of(file, &bytes));
        }
        Ok(bytes)
    }

    fn image(&mut self, file: &str) -> Result<Image, String> {
        let bytes = self.read(file).map_err(|error| error.to_string())?;
        decode(file, &bytes)
    }

    /// Reads what a mesh asks for. A snapshot's mesh gets what it had when the snapshot was made:
    /// no less, and nothing that was not there.
    fn read_for(&mut self, mesh: &str, file: &str) -> Result<Vec<u8>, FileError> {
        if !self.folder.has_record_of(mesh) {
            return self.read(file);
        }
        if !self.folder.has_record_of(file) {
            return Err(FileError::not_found(Path::new(file)));
        }
        let bytes = self.read(file);
        if let Err(error) = &bytes {
            self.lost.get_or_insert_with(|| error.clone());
        }
        bytes
    }

    /// The mesh with its libraries' materials; whatever is wrong with those is reported only.
    pub(super) fn mesh_of(&mut self, key: &MeshKey, bytes: &[u8]) -> Result<MeshAsset, ObjError> {
        let told = |step| (self.told)(&key.file, step);
        let watch = Watch::new(self.stop, &told);
        let (mesh, notes) = obj::load_mesh(bytes, key.normals, key.crease_angle_deg(), watch)?;
        let label = excerpt(key.file.as_bytes());
        let beside = Path::new(&key.file).parent().unwrap_or(Path::new("")).to_owned();
        let named = |path: &Path| beside.join(path).to_string_lossy().into_owned();
        let (materials, warnings) =
            mtl::materials_of_slots(&notes.slot_names, &notes.libraries, |path| {
                self.read_for(&key.file, &named(path)).map_err(|error| error.reason().to_owned())
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
                    let bytes = self.read_for(&key.file, &file);
                    let image = bytes
                        .map_err(|error| error.to_string())
                        .and_then(|bytes| decode(&file, &bytes));
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

fn decode(file: &str, bytes: &[u8]) -> Result<Image, String> {
    image_file::decode(bytes).map_err(|error| format!("{}: {error}", excerpt(file.as_bytes())))
}

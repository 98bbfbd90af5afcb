//! The files that a scene names, on their way in.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::geometry::TracedMesh;
use crate::geometry::mesh::ABSENT;
use crate::io::files::FileError;
use crate::io::folder::{FileRecord, Folder};
use crate::io::obj::{self, MeshNotes, ObjError};
use crate::io::progress::{Step, Watch};
use crate::io::scene_file::Section;
use crate::io::{excerpt, image_file, mtl};
use crate::loader::Told;
use crate::scene::assets::{Assets, MeshAsset, MeshKey, SlotMaterial};
use crate::scene::description::{
    ColorOrTexture, MaterialDescription, ObjectKind, SceneDescription, TextureKind,
};
use crate::scene::image::Image;

/// The files of one scene on their way in; each is read once.
pub(super) struct Reading<'a> {
    folder: &'a Folder,
    stop: &'a AtomicBool,
    told: &'a Told<'a>,
    pub(super) assets: Assets,
    pub(super) records: Vec<FileRecord>,
    pub(super) report: Vec<String>,
    /// Bytes of the meshes so far.
    n_mesh_bytes: usize,
    /// Triangles of the meshes so far, once for each crease angle.
    n_triangles: usize,
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
            n_mesh_bytes: 0,
            n_triangles: 0,
            lost: None,
        }
    }

    /// Everything that a description names, disabled objects and unused textures too.
    pub(super) fn all_of(&mut self, description: &SceneDescription) -> Result<(), AssetFailure> {
        let mut wanted: HashMap<String, HashSet<MeshKey>> = HashMap::new();
        for key in description.objects.iter().filter_map(MeshKey::of) {
            if !self.assets.meshes.contains_key(&key) {
                wanted.entry(key.file.clone()).or_default().insert(key);
            }
        }
        for (index, object) in description.objects.iter().enumerate() {
            self.check_cancelled()?;
            let (ObjectKind::Mesh, Some(file)) = (object.kind, &object.file) else { continue };
            let Some(keys) = wanted.remove(file) else { continue };
            let broken =
                |message| AssetFailure::Broken { section: Section::Objects, index, message };
            let bytes = self.read(file).map_err(|error| broken(error.to_string()))?;
            let label = excerpt(file.as_bytes());
            self.meshes_of(file, keys, &bytes).map_err(|error| match error {
                ObjError::Cancelled => AssetFailure::Cancelled,
                error => broken(format!("{label}: {error}")),
            })?;
            if let Some(lost) = self.lost.take() {
                return Err(broken(lost.to_string()));
            }
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
        self.tell_missing_uvs(description);
        Ok(())
    }

    /// Meshes that a material shows a picture on, and that do not say where.
    fn tell_missing_uvs(&mut self, description: &SceneDescription) {
        let is_image = |name: &str| {
            let mut textures = description.textures.iter();
            textures.any(|texture| texture.kind == TextureKind::Image && texture.name == name)
        };
        let has_image = |material: &MaterialDescription| {
            let bumps = material.bump.as_ref().is_some_and(|bump| is_image(&bump.texture));
            bumps || matches!(&material.diffuse, ColorOrTexture::Texture(name) if is_image(name))
        };
        for object in &description.objects {
            let Some(asset) = MeshKey::of(object).and_then(|key| self.assets.meshes.get(&key))
            else {
                continue;
            };
            let material = object.material.as_ref().map(|name| {
                let mut materials = description.materials.iter();
                materials.any(|material| material.name == *name && has_image(material))
            });
            let slot_has_map: Vec<bool> = (asset.slots.iter())
                .map(|slot| slot.as_ref().is_some_and(|slot| slot.diffuse_map.is_some()))
                .collect();
            if !material.unwrap_or(slot_has_map.contains(&true)) {
                continue;
            }
            let mesh = &asset.traced.mesh;
            let is_shown = |triangle: &usize| {
                let slot = mesh.slots.get(*triangle).map_or(0, |slot| *slot as usize);
                material.unwrap_or_else(|| slot_has_map.get(slot) == Some(&true))
            };
            let is_bare =
                |triangle: usize| mesh.uv_ids.get(triangle).is_none_or(|ids| ids.contains(&ABSENT));
            let mut are_bare = (0..mesh.triangles.len()).filter(is_shown).map(is_bare);
            let what =
                match (are_bare.clone().all(|is_bare| is_bare), are_bare.any(|is_bare| is_bare)) {
                    (true, true) => "has no texture coordinates; (0, 0) is used",
                    (false, true) => "has faces without texture coordinates; (0, 0) is used there",
                    (_, false) => continue,
                };
            let file = excerpt(object.file.as_deref().unwrap_or_default().as_bytes());
            let told = format!("{file}: {what}");
            if !self.report.contains(&told) {
                self.report.push(told);
            }
        }
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

    /// Reads a mesh once for all the normals that are wanted of it.
    pub(super) fn meshes_of(
        &mut self,
        file: &str,
        keys: impl IntoIterator<Item = MeshKey>,
        bytes: &[u8],
    ) -> Result<(), ObjError> {
        let (stop, told) = (self.stop, self.told);
        let told = |step| told(file, step);
        let watch = Watch::new(stop, &told);
        let mut parsed = obj::parse(bytes, watch)?;
        self.n_mesh_bytes += bytes.len();
        let notes = parsed.take_notes();
        let slots = self.slots_of(file, notes);
        let mut keys = keys.into_iter().peekable();
        while let Some(key) = keys.next() {
            self.n_triangles += parsed.triangles.len();
            let limit = obj::most_triangles(self.n_mesh_bytes);
            if limit < self.n_triangles {
                return Err(ObjError::TooManyTogether { limit });
            }
            watch.tell(Step::Normals);
            let is_last = keys.peek().is_none();
            let own = if is_last { std::mem::take(&mut parsed) } else { parsed.try_clone()? };
            let mesh = own.into_mesh(key.normals, key.crease_angle_deg(), watch)?;
            let asset = MeshAsset { traced: Arc::new(TracedMesh::new(mesh)), slots: slots.clone() };
            self.assets.meshes.insert(key, Arc::new(asset));
        }
        Ok(())
    }

    /// The materials that a mesh's libraries have; whatever is wrong with those is reported only.
    fn slots_of(&mut self, file: &str, notes: MeshNotes) -> Vec<Option<SlotMaterial>> {
        let label = excerpt(file.as_bytes());
        let beside = Path::new(file).parent().unwrap_or(Path::new("")).to_owned();
        let named = |path: &Path| beside.join(path).to_string_lossy().into_owned();
        let (materials, warnings) =
            mtl::materials_of_slots(&notes.slot_names, &notes.libraries, |path| {
                self.read_for(file, &named(path)).map_err(|error| error.reason().to_owned())
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
                let map = named(Path::new(&map));
                if !maps.contains_key(&map) {
                    let bytes = self.read_for(file, &map);
                    let image = bytes
                        .map_err(|error| error.to_string())
                        .and_then(|bytes| decode(&map, &bytes));
                    if let Err(reason) = &image {
                        self.report.push(format!("{label}: map_Kd {reason}"));
                    }
                    maps.insert(map.clone(), image.ok().map(Arc::new));
                }
                maps.get(&map).cloned().flatten()
            });
            slots.push(Some(SlotMaterial { description: material.description, diffuse_map }));
        }
        slots
    }
}

fn decode(file: &str, bytes: &[u8]) -> Result<Image, String> {
    image_file::decode(bytes).map_err(|error| format!("{}: {error}", excerpt(file.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{NormalsKind, ObjectDescription};
    use std::cell::RefCell;

    /// Four normals of a tent, whose library is not there.
    #[test]
    fn a_mesh_of_several_crease_angles_is_read_once() {
        let folder = tempfile::tempdir().unwrap();
        let text = "mtllib gone.mtl\nv 0 0 0\nv 0 0 1\nv 1 1 0\nv 2 0 0\n\
                    vn 0 1 0\nf 1 2 3\nf 3//1 2//1 4//1\n";
        std::fs::write(folder.path().join("a.obj"), text).unwrap();
        let mut description = crate::loader::framing::scene_around("a.obj", None);
        let wanted = [
            (NormalsKind::Smooth, 20.0),
            (NormalsKind::Smooth, 180.0),
            (NormalsKind::File, 180.0),
            (NormalsKind::Smooth, 20.0),
            (NormalsKind::Flat, 20.0),
        ];
        description.objects = Vec::from(wanted.map(|(normals, crease_angle)| ObjectDescription {
            file: Some("a.obj".to_owned()),
            normals,
            crease_angle,
            ..ObjectDescription::new("tent", ObjectKind::Mesh)
        }));
        let (stop, steps) = (AtomicBool::new(false), RefCell::new(Vec::new()));
        let told = |_: &str, step| steps.borrow_mut().push(step);
        let of = Folder::of(&folder.path().join("scene.toml"));
        let mut reading = Reading::new(&of, &stop, &told);
        assert!(reading.all_of(&description).is_ok(), "it cannot be read");
        let steps = steps.borrow();
        let n_read = steps.iter().filter(|step| **step == Step::Reading(0.0)).count();
        // The mesh, and the look for its library.
        assert_eq!(n_read, 2, "{steps:?}");
        assert_eq!(reading.report.len(), 1, "told more than once: {:?}", reading.report);
        assert_eq!(reading.assets.meshes.len(), 4, "other meshes");
        for (key, asset) in &reading.assets.meshes {
            let angle = key.crease_angle_deg();
            let (alone, _) = obj::load_mesh(text.as_bytes(), key.normals, angle, &stop).unwrap();
            let mesh = &asset.traced.mesh;
            assert_eq!(mesh.positions, alone.positions, "{key:?}");
            assert_eq!(mesh.triangles, alone.triangles, "{key:?}");
            let normals = (&mesh.normals, &mesh.normal_ids);
            assert_eq!(normals, (&alone.normals, &alone.normal_ids), "{key:?}");
        }
    }

    /// A mesh of one triangle by two angles, where there is room for one more.
    #[test]
    fn triangles_of_a_scene_count_once_for_each_crease_angle() {
        let folder = tempfile::tempdir().unwrap();
        let text = "v 0 0 0\nv 0 0 1\nv 1 1 0\nf 1 2 3\n";
        std::fs::write(folder.path().join("a.obj"), text).unwrap();
        let mut description = crate::loader::framing::scene_around("a.obj", None);
        description.objects = Vec::from([20.0, 40.0].map(|crease_angle| ObjectDescription {
            file: Some("a.obj".to_owned()),
            normals: NormalsKind::Smooth,
            crease_angle,
            ..ObjectDescription::new("sail", ObjectKind::Mesh)
        }));
        let of = Folder::of(&folder.path().join("scene.toml"));
        let stop = AtomicBool::new(false);
        for (n_before, fits) in [((1 << 23) - 2, true), ((1 << 23) - 1, false)] {
            let mut reading = Reading::new(&of, &stop, &|_, _| ());
            reading.n_triangles = n_before;
            match reading.all_of(&description) {
                Ok(()) => assert!(fits, "{n_before} and 2 are too many"),
                Err(AssetFailure::Broken { message, .. }) => {
                    assert!(!fits, "{n_before} and 2: {message}");
                    assert!(message.starts_with("a.obj: more than 8388608 tri"), "{message}");
                }
                Err(AssetFailure::Cancelled) => panic!("nobody has cancelled"),
            }
        }
    }
}

//! A reader of Wavefront OBJ files: triangles with the identity of their `v` lines.
//!
//! It reads polygons (cut into triangles), texture coordinates, normals, and the names of
//! materials and libraries. Smoothing groups, groups, lines, points, curves and vertex colours are
//! passed over. Nothing here touches the disk.
//!
//! Memory grows with the file and no faster: its arrays are usually smaller than its text, and at
//! worst, where faces have very many corners of one digit, some forty times as large.

mod cursor;
mod error;
mod faces;
mod number;
mod polygon;
mod reader;
#[cfg(test)]
mod tests;

use glam::{Vec2, Vec3};

use crate::geometry::mesh::Mesh;
use crate::geometry::{Stopped, normals};
use crate::io::memory;
use crate::io::progress::{Step, Watch};
use crate::scene::description::NormalsKind;
pub use error::ObjError;
use reader::Reader;
pub use reader::most_triangles;

/// Bytes a triangle that computing shading normals takes.
const NORMALS_A_TRIANGLE: usize = 80;

/// What an OBJ file holds, its faces cut into triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjFile {
    /// One point a `v` line, used by a face or not.
    pub positions: Vec<Vec3>,
    /// One pair a `vt` line.
    pub uvs: Vec<Vec2>,
    /// One unit vector a `vn` line. No corner refers to one that was zero in the file.
    pub normals: Vec<Vec3>,
    /// Three indices into `positions` a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Three indices into `uvs` a triangle, or `ABSENT`; empty where no face has any.
    pub uv_ids: Vec<[u32; 3]>,
    /// Three indices into `normals` a triangle, or `ABSENT`; empty where no face has any.
    pub normal_ids: Vec<[u32; 3]>,
    /// Index into `slot_names` a triangle; empty where there is one slot only.
    pub slots: Vec<u32>,
    /// The `usemtl` names that faces have, in order of first use; `None` for faces without.
    pub slot_names: Vec<Option<String>>,
    /// Material libraries as the file names them.
    pub libraries: Vec<String>,
    /// How many `f` lines there were.
    pub n_faces: usize,
    /// What was odd about the file and did not keep it from loading.
    pub warnings: Vec<String>,
}

/// What a mesh file says beside its mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshNotes {
    /// The name of each material slot; `None`: no material was named.
    pub slot_names: Vec<Option<String>>,
    /// Material libraries as the file names them, relative to it.
    pub libraries: Vec<String>,
    /// How many faces there were before they were cut.
    pub n_faces: usize,
    /// What was odd about the file and did not keep it from loading.
    pub warnings: Vec<String>,
}

/// Reads a whole mesh and gives it shading normals. `crease_angle_deg` is a scene's
/// `crease_angle`: 0..=180. `watch` is asked at every line, and told how far it is every few
/// megabytes.
///
/// # Errors
/// When it is no mesh, does not fit into memory, or is not wanted any more.
pub fn load_mesh<'a>(
    bytes: &[u8],
    kind: NormalsKind,
    crease_angle_deg: f64,
    watch: impl Into<Watch<'a>>,
) -> Result<(Mesh, MeshNotes), ObjError> {
    let watch = watch.into();
    let mut file = parse(bytes, watch)?;
    let notes = file.take_notes();
    watch.tell(Step::Normals);
    Ok((file.into_mesh(kind, crease_angle_deg, watch)?, notes))
}

/// Reads the text of an OBJ file.
///
/// # Errors
/// As [`load_mesh`].
pub fn parse<'a>(bytes: &[u8], watch: impl Into<Watch<'a>>) -> Result<ObjFile, ObjError> {
    Reader::new(bytes, watch.into()).read()
}

impl ObjFile {
    /// What it says beside its mesh; it is without it then.
    pub fn take_notes(&mut self) -> MeshNotes {
        MeshNotes {
            slot_names: std::mem::take(&mut self.slot_names),
            libraries: std::mem::take(&mut self.libraries),
            n_faces: self.n_faces,
            warnings: std::mem::take(&mut self.warnings),
        }
    }

    /// Its mesh with shading normals; `crease_angle_deg` as in [`load_mesh`].
    ///
    /// # Errors
    /// When it is not wanted any more.
    pub fn into_mesh<'a>(
        self,
        kind: NormalsKind,
        crease_angle_deg: f64,
        watch: impl Into<Watch<'a>>,
    ) -> Result<Mesh, ObjError> {
        let crease_angle = crease_angle_deg.to_radians();
        let stop = watch.into().stop();
        let normals = match kind {
            NormalsKind::Flat => Ok(normals::Normals::default()),
            NormalsKind::Smooth => {
                normals::smooth(&self.positions, &self.triangles, crease_angle, stop)
            }
            NormalsKind::File => normals::complete(
                &self.positions,
                &self.triangles,
                normals::Normals { normals: self.normals, ids: self.normal_ids },
                crease_angle,
                stop,
            ),
        };
        let normals = normals.map_err(|Stopped| ObjError::Cancelled)?;
        Ok(Mesh {
            positions: self.positions,
            triangles: self.triangles,
            normals: normals.normals,
            normal_ids: normals.ids,
            uvs: self.uvs,
            uv_ids: self.uv_ids,
            slots: self.slots,
        })
    }

    /// A copy, for other shading normals of the same mesh.
    ///
    /// # Errors
    /// When it would not fit into memory.
    pub fn try_clone(&self) -> Result<Self, ObjError> {
        memory::check(self.bytes_to_come()).map_err(ObjError::NoMemoryForCopy)?;
        Ok(self.clone())
    }

    /// Bytes that making a mesh of it takes beside its arrays: as much again, where they grow or
    /// are copied, and the shading normals.
    fn bytes_to_come(&self) -> u64 {
        let used = size_of_val(&self.positions[..])
            + size_of_val(&self.uvs[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.uv_ids[..])
            + size_of_val(&self.normal_ids[..])
            + size_of_val(&self.slots[..]);
        (used + NORMALS_A_TRIANGLE * self.triangles.len()) as u64
    }
}

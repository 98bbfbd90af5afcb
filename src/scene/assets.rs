//! What a scene's files hold, once read.

use std::collections::HashMap;
use std::sync::Arc;

use crate::geometry::TracedMesh;
use crate::scene::description::{MaterialDescription, NormalsKind, ObjectDescription, ObjectKind};
use crate::scene::image::Image;

/// Meshes and images by what names them in the description.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    /// Meshes by file and treatment of normals.
    pub meshes: HashMap<MeshKey, Arc<MeshAsset>>,
    /// Images by file, as written in the description.
    pub images: HashMap<String, Arc<Image>>,
}

/// What determines a loaded mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MeshKey {
    /// File, as written in the description.
    pub file: String,
    /// Where normals come from.
    pub normals: NormalsKind,
    /// Bits of the crease angle in degrees; irrelevant for flat meshes, then 0.
    crease_bits: u64,
}

impl MeshKey {
    /// What an object needs; `None` if it is no mesh or names no file.
    pub fn of(object: &ObjectDescription) -> Option<Self> {
        let ObjectKind::Mesh = object.kind else { return None };
        let file = object.file.clone()?;
        let crease_bits = match object.normals {
            NormalsKind::Flat => 0,
            NormalsKind::File | NormalsKind::Smooth => object.crease_angle.to_bits(),
        };
        Some(Self { file, normals: object.normals, crease_bits })
    }

    /// Crease angle in degrees.
    pub fn crease_angle_deg(&self) -> f64 {
        f64::from_bits(self.crease_bits)
    }
}

/// A mesh and the materials that its file asks for.
#[derive(Debug)]
pub struct MeshAsset {
    /// The triangles.
    pub traced: Arc<TracedMesh>,
    /// Material of each slot; `None` is the neutral grey.
    pub slots: Vec<Option<SlotMaterial>>,
}

/// A material that came with a mesh.
#[derive(Clone, Debug)]
pub struct SlotMaterial {
    /// Its parameters.
    pub description: MaterialDescription,
    /// Multiplies the diffuse reflectance.
    pub diffuse_map: Option<Arc<Image>>,
}

//! Objects as a person writes them.

use serde::{Deserialize, Serialize};

use super::{OneOrThree, Triple, defaults};

/// `[[objects]]`: a shape, where it is and what it is made of. One struct for all types: a key
/// that the type does not use is accepted and kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectDescription {
    /// Unique among objects. A file that gives none means "object-1", "object-2" and so on.
    #[serde(default)]
    pub name: String,
    /// What shape it is.
    #[serde(rename = "type")]
    pub kind: ObjectKind,
    /// Whether it is there at all.
    #[serde(default = "defaults::yes")]
    pub enabled: bool,
    /// Name of a material. `None`: the MTL's, else a neutral grey.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Added last, in scene units.
    #[serde(default)]
    pub translate: Triple,
    /// Degrees about X, then Y, then Z.
    #[serde(default)]
    pub rotate: Triple,
    /// Applied first; not 0.
    #[serde(default = "defaults::unit_scale")]
    pub scale: OneOrThree,
    /// Mesh: OBJ file, relative to the scene file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Mesh: where shading normals come from.
    #[serde(default)]
    pub normals: NormalsKind,
    /// Mesh, "smooth": faces that meet at a sharper angle (degrees) are not averaged, 0..=180.
    #[serde(default = "defaults::straight_angle")]
    pub crease_angle: f64,
    /// Sphere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center: Option<Triple>,
    /// Sphere, cone, cylinder; above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Plane: a point on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<Triple>,
    /// Plane: its normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<Triple>,
    /// Box: its lower corner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<Triple>,
    /// Box: its upper corner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<Triple>,
    /// Cone, cylinder: centre of the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<Triple>,
    /// Cone: its tip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<Triple>,
    /// Cylinder: centre of the top.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top: Option<Triple>,
}

impl ObjectDescription {
    /// An object of that type with every other key at its default or absent.
    pub fn new(name: impl Into<String>, kind: ObjectKind) -> Self {
        Self {
            name: name.into(),
            kind,
            enabled: true,
            material: None,
            translate: [0.0; 3],
            rotate: [0.0; 3],
            scale: defaults::unit_scale(),
            file: None,
            normals: NormalsKind::File,
            crease_angle: defaults::straight_angle(),
            center: None,
            radius: None,
            point: None,
            normal: None,
            min: None,
            max: None,
            base: None,
            tip: None,
            top: None,
        }
    }
}

/// What shape an object is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ObjectKind {
    /// Triangles from an OBJ file.
    Mesh,
    /// `center`, `radius`.
    Sphere,
    /// `point`, `normal`; infinite.
    Plane,
    /// `min`, `max`.
    Box,
    /// `base`, `tip`, `radius`; capped.
    Cone,
    /// `base`, `top`, `radius`; capped.
    Cylinder,
}

/// Where a mesh's shading normals come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NormalsKind {
    /// As stored, smooth where absent.
    #[default]
    File,
    /// Averaged over the faces that share a vertex.
    Smooth,
    /// The face's own.
    Flat,
}

//! The scene as a person writes it: file units, names in place of indices, nothing resolved.
//!
//! One value of [`SceneDescription`] is what a scene file holds, what the window edits, what undo
//! keeps and what a snapshot carries. Lengths are scene units, angles degrees, colours linear RGB
//! with Rec. 709 primaries. Numbers are `f64`, so that reading and writing a file is exact. The
//! renderer never sees this type: it works on the resolved [`crate::scene::Scene`].

use serde::{Deserialize, Serialize};

mod defaults;
mod lights;
mod objects;
mod surfaces;
mod values;

pub use lights::{LightDescription, LightKind};
pub use objects::{NormalsKind, ObjectDescription, ObjectKind};
pub use surfaces::{
    BumpDescription, MaterialDescription, TextureDescription, TextureKind, WardForm,
};
pub use values::{ColorOrTexture, OneOrThree, OneOrTwo, Triple};

/// Everything a scene file holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneDescription {
    /// How the picture is computed: size, samples, integrator.
    #[serde(default)]
    pub render: RenderDescription,
    /// Where the picture is taken from, and through which lens.
    pub camera: CameraDescription,
    /// How linear light becomes a displayed picture.
    #[serde(default)]
    pub tone_mapping: ToneMappingDescription,
    /// Ambient light and background.
    #[serde(default)]
    pub environment: EnvironmentDescription,
    /// Textures by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub textures: Vec<TextureDescription>,
    /// Materials by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialDescription>,
    /// Light sources.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<LightDescription>,
    /// Shapes and meshes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectDescription>,
}

/// `[render]`: how the picture is computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RenderDescription {
    /// Width in pixels, 1..=16384.
    pub width: u32,
    /// Height in pixels, 1..=16384.
    pub height: u32,
    /// Samples per pixel at which a render is finished, 1..=1048576.
    pub samples: u32,
    /// Scattering events after the camera ray, 0..=1024.
    pub max_depth: u32,
    /// Which light paths are followed.
    pub integrator: IntegratorKind,
    /// Seed of all random numbers.
    pub seed: u32,
    /// Pixel reconstruction filter.
    pub filter: FilterKind,
    /// Whether samples go where the error is.
    pub adaptive: bool,
    /// Where the numbers come from.
    pub sampler: SamplerKind,
}

impl Default for RenderDescription {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            samples: 256,
            max_depth: 8,
            integrator: IntegratorKind::Direct,
            seed: 0,
            filter: FilterKind::Box,
            adaptive: false,
            sampler: SamplerKind::Sobol,
        }
    }
}

/// Which light paths are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum IntegratorKind {
    /// Ambient, direct light, mirrors and glass: the classic look.
    Direct,
    /// Global illumination by unidirectional path tracing.
    Path,
}

/// Pixel reconstruction filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FilterKind {
    /// Uniform over the pixel.
    Box,
}

/// Where the sampler's numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SamplerKind {
    /// Owen-scrambled Sobol points.
    Sobol,
    /// Independent numbers, to see the difference.
    Random,
}

/// `[camera]`: a thin lens that looks from `eye` to `target`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraDescription {
    /// Centre of the lens.
    pub eye: Triple,
    /// The point in the middle of the picture.
    pub target: Triple,
    /// Which way is up in the picture; any length above 0.
    #[serde(default = "defaults::y_axis")]
    pub up: Triple,
    /// Full vertical angle of view in degrees, 0 < fov < 180.
    #[serde(default = "defaults::default_fov")]
    pub vertical_fov: f64,
    /// Radius of the lens in scene units, at least 0; 0 is a pinhole.
    #[serde(default)]
    pub aperture_radius: f64,
    /// Distance along the viewing axis to the plane in focus, above 0. `None` is |target - eye|.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub focal_distance: Option<f64>,
    /// 0 is a round lens, 3..=16 a regular polygon.
    #[serde(default)]
    pub aperture_blades: u32,
}

/// `[tone_mapping]`: how linear light becomes a displayed picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ToneMappingDescription {
    /// Exposure in stops (EV).
    pub exposure: f64,
    /// The curve.
    pub operator: ToneOperator,
}

impl Default for ToneMappingDescription {
    fn default() -> Self {
        Self { exposure: 0.0, operator: ToneOperator::Agx }
    }
}

/// The curve that brings scene light into the display's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ToneOperator {
    /// Clips at 1.
    Linear,
    /// x / (1 + x) per channel.
    Reinhard,
    /// Hill's fit of the ACES reference rendering and output transforms.
    Aces,
    /// The base look of Sobotka's AgX.
    Agx,
}

/// `[environment]`: light that comes from no place in the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EnvironmentDescription {
    /// Ambient light of the "direct" integrator, at least 0.
    pub ambient: Triple,
    /// Radiance of rays that leave the scene: a colour, or a texture looked up by direction.
    pub background: ColorOrTexture,
}

impl Default for EnvironmentDescription {
    fn default() -> Self {
        Self { ambient: [0.0; 3], background: ColorOrTexture::Color([0.0; 3]) }
    }
}

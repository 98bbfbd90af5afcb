//! What objects are made of.

use glam::Vec3;

use crate::brdf::Ward;
use crate::color::Rgb;

/// Index of a texture in the scene.
pub type TextureId = u32;
/// Index of a material in the scene.
pub type MaterialId = u32;

/// A colour that may come from a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorSource {
    /// The colour, or the factor of the texture.
    pub color: Rgb,
    /// Multiplies the colour where there is one.
    pub texture: Option<TextureId>,
}

impl ColorSource {
    /// The same everywhere.
    pub fn constant(color: Rgb) -> Self {
        Self { color, texture: None }
    }
}

/// How a surface scatters and emits light. All parts are added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Lambertian reflectance, 0..=1.
    pub diffuse: ColorSource,
    /// Ward's rho_s, 0..=1.
    pub specular: Rgb,
    /// The lobe that rho_s scales.
    pub lobe: Ward,
    /// Object-space unit direction whose projection on the surface is X.
    pub tangent: Vec3,
    /// Perfect mirror reflectance, 0..=1.
    pub reflection: Rgb,
    /// Transmission of one surface of glass, 0..=1; glass if any is above 0.
    pub transmission: Rgb,
    /// Index of refraction inside, against 1 outside.
    pub ior: f32,
    /// Emitted radiance on both sides.
    pub emission: Rgb,
    /// A texture whose luminance is a height, and the height of luminance 1 in object space.
    pub bump: Option<(TextureId, f32)>,
}

impl Material {
    /// Whether no light is scattered anywhere: black, and without gloss.
    pub fn is_never_lit(&self) -> bool {
        self.diffuse == ColorSource::constant(Rgb::ZERO) && self.specular == Rgb::ZERO
    }

    /// Whether it is a mirror or glass.
    pub fn is_specular(&self) -> bool {
        self.reflection.max_element() > 0.0 || self.is_glass()
    }

    /// Whether light passes through.
    pub fn is_glass(&self) -> bool {
        self.transmission.max_element() > 0.0
    }
}

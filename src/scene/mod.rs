//! A scene: as a person describes it, and as the renderer sees it.
//!
//! [`description::SceneDescription`] is the document; [`resolve()`] turns it and its loaded
//! [`assets::Assets`] into a [`Scene`]: plain data, indices in place of names, radians, f32.

pub mod assets;
pub mod camera;
pub mod description;
pub mod image;
pub mod light;
pub mod material;
pub mod orbit;
pub mod resolve;
pub mod texture;

use glam::Vec3;

use crate::color::Rgb;
use crate::geometry::Instance;
use crate::math::vectorized::{BLOCK, Lane3};

pub use assets::Assets;
pub use camera::Camera;
pub use light::Light;
pub use material::{Material, MaterialId, TextureId};
pub use resolve::resolve;
pub use texture::Texture;

/// Everything that decides what light arrives at the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The lens.
    pub camera: Camera,
    /// Ambient light of the "direct" integrator.
    pub ambient: Rgb,
    /// What rays see that leave the scene.
    pub background: Background,
    /// Textures by [`TextureId`].
    pub textures: Vec<Texture>,
    /// Materials by [`MaterialId`].
    pub materials: Vec<Material>,
    /// Enabled lights.
    pub lights: Vec<Light>,
    /// Enabled objects, in the order of the file: their index is part of a primitive's identity.
    pub objects: Vec<Object>,
}

/// A shape at its place, and what it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Shape and place.
    pub instance: Instance,
    /// Material of each slot of a mesh; the last one serves every further slot. Never empty.
    pub materials: Vec<MaterialId>,
}

impl Object {
    /// Material of a slot.
    pub fn material(&self, slot: u32) -> MaterialId {
        let last = self.materials.len() - 1;
        self.materials[(slot as usize).min(last)]
    }
}

/// Radiance by direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// The same in every direction.
    Color(Rgb),
    /// Looked up by direction.
    Texture(TextureId),
}

impl Scene {
    /// Radiance of the background in a unit direction.
    pub fn background_radiance(&self, direction: Vec3) -> Rgb {
        match self.background {
            Background::Color(color) => color,
            Background::Texture(id) => self.textures[id as usize].eval_direction(direction),
        }
    }

    /// [`Scene::background_radiance`] for a block of directions.
    pub(crate) fn background_radiances(&self, directions: &Lane3, radiances: &mut Lane3) {
        match self.background {
            Background::Color(color) => {
                *radiances = color.to_array().map(|channel| [channel; BLOCK]);
            }
            Background::Texture(id) => {
                self.textures[id as usize].eval_directions(directions, radiances);
            }
        }
    }
}

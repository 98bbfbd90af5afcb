//! From a description and its loaded files to a scene.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::brdf::{self, Ward};
use crate::color::Rgb;
use crate::geometry::{Instance, Shape};
use crate::math::noise::Octaves;
use crate::math::{Frame, Transform};
use crate::scene::assets::{Assets, MeshAsset, MeshKey, SlotMaterial};
use crate::scene::camera::Camera;
use crate::scene::description as file;
use crate::scene::description::{ColorOrTexture, SceneDescription, Triple};
use crate::scene::light::{Emitter, Light};
use crate::scene::material::{ColorSource, Material, MaterialId, TextureId};
use crate::scene::texture::{Noise, Pattern, Texture};
use crate::scene::{Background, Object, Scene};

/// What a description lacks to become a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ResolveError {
    /// A mesh that has not been loaded.
    #[error("mesh {:?} is not loaded", .0.file)]
    Mesh(MeshKey),
    /// An image that has not been loaded.
    #[error("image {0:?} is not loaded")]
    Image(String),
    /// Something that validation would have refused.
    #[error("{path}: {problem}")]
    Invalid {
        /// The parameter's path.
        path: String,
        /// What is wrong.
        problem: &'static str,
    },
}

/// Turns a valid description into a scene. Disabled lights and objects are left out.
///
/// # Errors
/// A file that is not among `assets`, or a name or key that is missing although validation demands
/// it.
pub fn resolve(description: &SceneDescription, assets: &Assets) -> Result<Scene, ResolveError> {
    let mut resolver = Resolver::new(description, assets)?;
    let objects = description.objects.iter().filter(|object| object.enabled);
    let objects = objects.map(|object| resolver.object(object)).collect::<Result<_, _>>()?;
    let lights = description.lights.iter().filter(|light| light.enabled);
    let background = match &description.environment.background {
        ColorOrTexture::Color(color) => Background::Color(rgb(*color)),
        ColorOrTexture::Texture(name) => {
            Background::Texture(resolver.texture(name, "environment.background")?)
        }
    };
    Ok(Scene {
        camera: camera(&description.camera),
        ambient: rgb(description.environment.ambient),
        background,
        lights: lights.map(light).collect(),
        objects,
        textures: resolver.textures,
        materials: resolver.materials,
    })
}

struct Resolver<'a> {
    assets: &'a Assets,
    texture_ids: HashMap<&'a str, TextureId>,
    material_ids: HashMap<&'a str, MaterialId>,
    /// Materials of a mesh's slots, made once for every mesh.
    slot_ids: HashMap<MeshKey, Vec<MaterialId>>,
    textures: Vec<Texture>,
    materials: Vec<Material>,
    grey: Option<MaterialId>,
}

impl<'a> Resolver<'a> {
    fn new(description: &'a SceneDescription, assets: &'a Assets) -> Result<Self, ResolveError> {
        let mut resolver = Self {
            assets,
            texture_ids: HashMap::new(),
            material_ids: HashMap::new(),
            slot_ids: HashMap::new(),
            textures: Vec::new(),
            materials: Vec::new(),
            grey: None,
        };
        for entry in &description.textures {
            let texture = texture(entry, assets)?;
            let id = resolver.add_texture(texture);
            resolver.texture_ids.insert(&entry.name, id);
        }
        for entry in &description.materials {
            let id = resolver.add_material(entry, None)?;
            resolver.material_ids.insert(&entry.name, id);
        }
        Ok(resolver)
    }

    fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        self.textures.len() as TextureId - 1
    }

    fn texture(&self, name: &str, path: &str) -> Result<TextureId, ResolveError> {
        self.texture_ids.get(name).copied().ok_or_else(|| ResolveError::Invalid {
            path: path.to_owned(),
            problem: "names no texture",
        })
    }

    fn add_material(
        &mut self,
        entry: &file::MaterialDescription,
        diffuse_map: Option<TextureId>,
    ) -> Result<MaterialId, ResolveError> {
        let path = |key: &str| format!("materials.{}.{key}", entry.name);
        let diffuse = match &entry.diffuse {
            ColorOrTexture::Color(color) => {
                ColorSource { color: rgb(*color), texture: diffuse_map }
            }
            ColorOrTexture::Texture(name) => ColorSource {
                color: Rgb::ONE,
                texture: Some(self.texture(name, &path("diffuse"))?),
            },
        };
        let bump = match &entry.bump {
            Some(bump) => {
                Some((self.texture(&bump.texture, &path("bump.texture"))?, bump.height as f32))
            }
            None => None,
        };
        let form = match entry.ward {
            file::WardForm::Original => brdf::WardForm::Original,
            file::WardForm::Duer => brdf::WardForm::Duer,
            file::WardForm::Bounded => brdf::WardForm::Bounded,
        };
        self.materials.push(Material {
            diffuse,
            specular: rgb(entry.specular),
            lobe: Ward { form, alpha_x: slope(entry.alpha_x), alpha_y: slope(entry.alpha_y) },
            tangent: dvec(entry.tangent).normalize_or(DVec3::X).as_vec3(),
            reflection: rgb(entry.reflection),
            transmission: rgb(entry.transmission),
            ior: entry.ior as f32,
            emission: rgb(entry.emission),
            bump,
        });
        Ok(self.materials.len() as MaterialId - 1)
    }

    /// The neutral grey of whatever names no material.
    fn grey(&mut self) -> Result<MaterialId, ResolveError> {
        if let Some(id) = self.grey {
            return Ok(id);
        }
        let mut grey = file::MaterialDescription::new("");
        grey.diffuse = ColorOrTexture::Color([0.5; 3]);
        let id = self.add_material(&grey, None)?;
        self.grey = Some(id);
        Ok(id)
    }

    fn object(&mut self, entry: &file::ObjectDescription) -> Result<Object, ResolveError> {
        let asset = match MeshKey::of(entry) {
            Some(key) => match self.assets.meshes.get(&key) {
                Some(asset) => Some((key, Arc::clone(asset))),
                None => return Err(ResolveError::Mesh(key)),
            },
            None => None,
        };
        let path = |key: &str| format!("objects.{}.{key}", entry.name);
        let materials = match (&entry.material, &asset) {
            (Some(name), _) => {
                vec![self.material_ids.get(name.as_str()).copied().ok_or_else(|| {
                    ResolveError::Invalid { path: path("material"), problem: "names no material" }
                })?]
            }
            (None, Some((key, asset))) => self.slots(key, asset)?,
            (None, None) => vec![self.grey()?],
        };
        let shape = shape(entry, asset.as_ref().map(|(_, asset)| &**asset))
            .ok_or_else(|| ResolveError::Invalid { path: path("type"), problem: "lacks a key" })?;
        let transform =
            Transform::new(dvec(entry.translate), dvec(entry.rotate), dvec(entry.scale.triple()));
        Ok(Object { instance: Instance::new(shape, transform), materials })
    }

    fn slots(&mut self, key: &MeshKey, asset: &MeshAsset) -> Result<Vec<MaterialId>, ResolveError> {
        if let Some(ids) = self.slot_ids.get(key) {
            return Ok(ids.clone());
        }
        let mut ids = Vec::with_capacity(asset.slots.len().max(1));
        for slot in &asset.slots {
            ids.push(match slot {
                Some(SlotMaterial { description, diffuse_map }) => {
                    let map = diffuse_map.as_ref().map(|image| {
                        self.add_texture(Texture::Image { scale: 1.0, image: Arc::clone(image) })
                    });
                    self.add_material(description, map)?
                }
                None => self.grey()?,
            });
        }
        if ids.is_empty() {
            ids.push(self.grey()?);
        }
        self.slot_ids.insert(key.clone(), ids.clone());
        Ok(ids)
    }
}

fn shape(entry: &file::ObjectDescription, asset: Option<&MeshAsset>) -> Option<Shape> {
    let point = |triple: Option<Triple>| triple.map(dvec);
    Some(match entry.kind {
        file::ObjectKind::Mesh => Shape::Mesh(Arc::clone(&asset?.traced)),
        file::ObjectKind::Sphere => {
            Shape::Sphere { center: point(entry.center)?, radius: entry.radius? }
        }
        file::ObjectKind::Plane => {
            Shape::Plane { point: point(entry.point)?, normal: point(entry.normal)?.normalize() }
        }
        file::ObjectKind::Box => Shape::Box { min: point(entry.min)?, max: point(entry.max)? },
        file::ObjectKind::Cone => {
            Shape::Cone { base: point(entry.base)?, tip: point(entry.tip)?, radius: entry.radius? }
        }
        file::ObjectKind::Cylinder => Shape::Cylinder {
            base: point(entry.base)?,
            top: point(entry.top)?,
            radius: entry.radius?,
        },
    })
}

fn texture(entry: &file::TextureDescription, assets: &Assets) -> Result<Texture, ResolveError> {
    let colors: Vec<Rgb> = match &entry.colors {
        Some(colors) => colors.iter().map(|color| rgb(*color)).collect(),
        None => vec![Rgb::ZERO, Rgb::ONE],
    };
    let lacking = |problem| ResolveError::Invalid {
        path: format!("textures.{}.colors", entry.name),
        problem,
    };
    let pattern = match entry.kind {
        file::TextureKind::Solid => {
            return colors.first().copied().map(Texture::Solid).ok_or(lacking("lacks a color"));
        }
        file::TextureKind::Checker => {
            let colors = colors.try_into().map_err(|_| lacking("needs two colors"))?;
            return Ok(Texture::Checker { scale: entry.scale, colors });
        }
        file::TextureKind::Image => {
            let file = entry.file.clone().unwrap_or_default();
            let Some(image) = assets.images.get(&file) else {
                return Err(ResolveError::Image(file));
            };
            return Ok(Texture::Image { scale: entry.scale, image: Arc::clone(image) });
        }
        file::TextureKind::Spots => Pattern::Spots,
        file::TextureKind::Marble => Pattern::Marble,
        file::TextureKind::Clouds => Pattern::Clouds,
        file::TextureKind::Wood => Pattern::Wood,
    };
    if colors.len() < 2 {
        return Err(lacking("needs two colors or more"));
    }
    let octaves = Octaves { count: entry.octaves, lacunarity: entry.lacunarity, gain: entry.gain };
    let (scale, distortion) = (entry.scale, entry.distortion);
    Ok(Texture::Noise(Noise { pattern, scale, octaves, distortion, colors }))
}

fn camera(entry: &file::CameraDescription) -> Camera {
    let mut camera = Camera::look_at(
        dvec(entry.eye),
        dvec(entry.target),
        dvec(entry.up),
        entry.vertical_fov.to_radians(),
    );
    camera.aperture_radius = entry.aperture_radius as f32;
    camera.aperture_blades = entry.aperture_blades;
    if let Some(focal_distance) = entry.focal_distance {
        camera.focal_distance = focal_distance as f32;
    }
    camera
}

fn light(entry: &file::LightDescription) -> Light {
    let position = dvec(entry.position);
    let axis = dvec(entry.target) - position;
    let normal = axis.normalize_or(DVec3::NEG_Y);
    let power = dvec(entry.power);
    let [width, height] = light_size(entry);
    let is_point = width == 0.0;
    let scaled = |factor: f64| (power * factor).as_vec3();
    let center = position.as_vec3();
    let emitter = match entry.kind {
        file::LightKind::Point => Emitter::Point { position: center, intensity: scaled(0.25 / PI) },
        file::LightKind::Sphere if is_point => {
            Emitter::Point { position: center, intensity: scaled(0.25 / PI) }
        }
        file::LightKind::Sphere => {
            let radius = 0.5 * width;
            let radiance = scaled(0.25 / (PI * PI * radius * radius));
            Emitter::Sphere { center, radius: radius as f32, radiance }
        }
        file::LightKind::Rectangle | file::LightKind::Disk if is_point => Emitter::Spot {
            position: center,
            normal: normal.as_vec3(),
            intensity: scaled(1.0 / PI),
        },
        file::LightKind::Rectangle => {
            let frame = light_frame(normal, dvec(entry.up));
            let half = [(0.5 * width) as f32, (0.5 * height) as f32];
            Emitter::Rectangle {
                center,
                frame,
                half,
                radiance: scaled(1.0 / (PI * width * height)),
            }
        }
        file::LightKind::Disk => {
            let frame = light_frame(normal, dvec(entry.up));
            let radius = 0.5 * width;
            let radiance = scaled(1.0 / (PI * PI * radius * radius));
            Emitter::Disk { center, frame, radius: radius as f32, radiance }
        }
        file::LightKind::Sun => {
            Emitter::sun((-normal).as_vec3(), 0.5 * width.to_radians(), power.as_vec3())
        }
    };
    Light { visible: entry.visible, emitter }
}

/// Width and height, both 0 for a light so small that it is its own limit, and that its radiance
/// could not be computed with; never only one of them.
fn light_size(entry: &file::LightDescription) -> [f64; 2] {
    const SMALLEST: f64 = 1e-9;
    let sides = entry.size.pair();
    if sides.iter().all(|side| *side < SMALLEST) {
        return [0.0; 2];
    }
    sides.map(|side| side.max(SMALLEST))
}

/// x along the width, z towards the emitting side.
fn light_frame(normal: DVec3, up: DVec3) -> Frame {
    let mut across = normal.cross(up.normalize_or(DVec3::Y));
    if across.length() < 1e-4 {
        across = normal.cross(DVec3::NEG_Z);
    }
    let x = across.normalize_or(DVec3::X);
    Frame { x: x.as_vec3(), y: x.cross(normal).as_vec3(), z: normal.as_vec3() }
}

/// A roughness: narrower ones than directions in f32 can tell from a mirror are the narrowest that they
/// can, broader ones than reflect anything the broadest.
fn slope(alpha: f64) -> f32 {
    const SMALLEST: f64 = 1e-5;
    alpha.clamp(SMALLEST, 1.0 / SMALLEST) as f32
}

fn dvec(triple: Triple) -> DVec3 {
    DVec3::from_array(triple)
}

fn rgb(triple: Triple) -> Rgb {
    Vec3::from_array(triple.map(|x| x as f32))
}

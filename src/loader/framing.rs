//! The scene around a mesh that is opened alone.

use glam::{DVec3, Vec3};

use crate::math::Aabb;
use crate::scene::description::{
    CameraDescription, ColorOrTexture, EnvironmentDescription, LightDescription, LightKind,
    NormalsKind, ObjectDescription, ObjectKind, OneOrTwo, SceneDescription,
};

/// A mesh with coordinates beyond this has no place for a camera and a light around it.
pub(super) const FARTHEST: f32 = 1e11;

/// A mesh smaller than this is seen from as far as one of this size.
const SMALLEST_SIZE: f64 = 1e-6;

/// Stands the mesh on a ground plane, frames it from the front and above, lights it by one large
/// soft light from the upper left. Without bounds it is a unit cube that is framed.
pub(super) fn scene_around(file: &str, bounds: Option<Aabb>) -> SceneDescription {
    let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    let bounds = bounds.filter(|bounds| !bounds.is_empty()).unwrap_or(unit);
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let center = 0.5 * (min + max);
    let diagonal = (max - min).length();
    // A mesh of one point, or one too small for where it is, still needs a size to be seen at.
    let size = diagonal.max(1e-6 * center.abs().max_element()).max(SMALLEST_SIZE);
    let eye = center + 1.5 * size * DVec3::new(0.45, 0.32, 1.0).normalize();
    let lamp = center + 2.2 * size * DVec3::new(-0.55, 1.0, 0.65).normalize();
    // About 4 units of irradiance at the mesh: radiance 0.64 from a grey that reflects half.
    let power = 4.0 * std::f64::consts::PI * (lamp - center).length_squared();
    let mut mesh = ObjectDescription::new("mesh", ObjectKind::Mesh);
    mesh.file = Some(file.to_owned());
    mesh.normals = NormalsKind::File;
    mesh.crease_angle = 40.0;
    let mut ground = ObjectDescription::new("ground", ObjectKind::Plane);
    ground.point = Some([center.x, min.y, center.z]);
    ground.normal = Some([0.0, 1.0, 0.0]);
    SceneDescription {
        render: Default::default(),
        camera: CameraDescription {
            eye: eye.to_array(),
            target: center.to_array(),
            up: [0.0, 1.0, 0.0],
            vertical_fov: 40.0,
            aperture_radius: 0.0,
            focal_distance: None,
            aperture_blades: 0,
        },
        tone_mapping: Default::default(),
        environment: EnvironmentDescription {
            ambient: [0.18, 0.2, 0.24],
            background: ColorOrTexture::Color([0.32, 0.36, 0.42]),
        },
        textures: Vec::new(),
        materials: Vec::new(),
        lights: vec![LightDescription {
            name: "key".to_owned(),
            kind: LightKind::Rectangle,
            position: lamp.to_array(),
            target: center.to_array(),
            up: [0.0, 1.0, 0.0],
            size: OneOrTwo::One(1.2 * size),
            power: [power, 0.96 * power, 0.9 * power],
            visible: false,
            enabled: true,
        }],
        objects: vec![mesh, ground],
    }
}

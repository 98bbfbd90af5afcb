//! The window driven by label and role, without a display.

mod asking;
mod bench;
mod disks;
mod editing;
mod every_control;
mod export;
mod extremes;
mod keys;
mod layout;
mod loading;
mod navigation;
mod panels;
pub(in crate::window) mod parameters;
mod picking;
mod promises;
mod random_user;
mod reload;
mod start;
mod views;
mod whole;

use crate::scene::description::{
    CameraDescription, ColorOrTexture, LightDescription, LightKind, MaterialDescription,
    ObjectDescription, ObjectKind, OneOrTwo, SceneDescription, TextureDescription, TextureKind,
};

/// A small scene with one of everything.
pub(super) fn small_scene() -> SceneDescription {
    let mut material = MaterialDescription::new("glaze");
    material.diffuse = ColorOrTexture::Color([0.1, 0.2, 0.6]);
    let mut ball = ObjectDescription::new("ball", ObjectKind::Sphere);
    ball.center = Some([0.0; 3]);
    ball.radius = Some(1.0);
    ball.material = Some("glaze".to_owned());
    SceneDescription {
        render: Default::default(),
        camera: CameraDescription {
            eye: [0.0, 1.0, 5.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            vertical_fov: 40.0,
            aperture_radius: 0.05,
            focal_distance: None,
            aperture_blades: 0,
        },
        tone_mapping: Default::default(),
        environment: Default::default(),
        textures: vec![TextureDescription {
            name: "veins".to_owned(),
            kind: TextureKind::Marble,
            scale: 3.0,
            octaves: 6,
            lacunarity: 2.0,
            gain: 0.5,
            distortion: 4.0,
            colors: Some(vec![[0.9; 3], [0.1; 3]]),
            file: None,
        }],
        materials: vec![material, MaterialDescription::new("plain")],
        lights: vec![LightDescription {
            name: "key".to_owned(),
            kind: LightKind::Rectangle,
            position: [2.0, 5.0, 3.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            size: OneOrTwo::One(1.0),
            power: [100.0; 3],
            visible: true,
            enabled: true,
        }],
        objects: vec![ball],
    }
}

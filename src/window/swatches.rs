//! Small live pictures in the panel: a ball of the material, a patch of the texture. Each is made
//! on a thread of its own; the newest order wins.

use super::background::Background;
use crate::geometry::AcceleratorKind;
use crate::render::{Film, RenderJob, RenderSettings, World, render_pass};
use crate::scene::description::{
    CameraDescription, ColorOrTexture, EnvironmentDescription, IntegratorKind, LightDescription,
    LightKind, MaterialDescription, ObjectDescription, ObjectKind, OneOrTwo, RenderDescription,
    SceneDescription, TextureDescription, TextureKind, ToneOperator,
};
use crate::scene::resolve::resolve;
use crate::scene::texture::Lookup;
use crate::scene::{Assets, Texture};
use crate::threads;
use crate::tone_mapping::map_to_srgb8;
use egui::{Color32, ColorImage, TextureHandle, TextureOptions, Ui, Vec2};
use glam::{DVec3, Vec2 as Uv, Vec3};
use std::io;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Weak};

/// Pixels along the side of the ball's picture.
const BALL_PX: u32 = 112;
/// Samples of the ball: enough for a calm picture in a fraction of a second.
const BALL_SAMPLES: u32 = 24;
/// Pixels of the texture's patch.
const PATCH_PX: [u32; 2] = [288, 72];
/// Width of the patch in scene units.
const PATCH_UNITS: f64 = 4.0;

/// The two pictures and the threads that make them.
pub(super) struct Swatches {
    ball: Swatch<BallKey>,
    patch: Swatch<PatchKey>,
}

/// What decides the ball's picture.
#[derive(Clone, Debug, PartialEq)]
struct BallKey {
    material: MaterialDescription,
    textures: Vec<TextureDescription>,
}

/// What decides the patch's picture.
#[derive(Clone, Debug, PartialEq)]
struct PatchKey {
    texture: TextureDescription,
}

struct Swatch<Key> {
    name: &'static str,
    thread: Background<(Key, Arc<Assets>), Option<ColorImage>>,
    /// What the picture asked for last is of, and with which files.
    asked: Option<(Key, Weak<Assets>)>,
    shown: Option<TextureHandle>,
}

impl Swatches {
    /// Starts both threads; `wake` is called when a picture is ready.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub(super) fn new(wake: impl Fn() + Clone + Send + 'static) -> io::Result<Self> {
        let pool = threads::pool("material ball", 1)?;
        Ok(Self {
            ball: Swatch::new("material ball", wake.clone(), move |key: &BallKey, assets| {
                pool.install(|| ball_picture(key, assets))
            })?,
            patch: Swatch::new("texture patch", wake, |key: &PatchKey, assets| {
                patch_picture(key, assets)
            })?,
        })
    }

    /// Shows a ball of that material.
    pub(super) fn ball_ui(
        &mut self,
        ui: &mut Ui,
        material: &MaterialDescription,
        textures: &[TextureDescription],
        assets: &Arc<Assets>,
    ) {
        let uses = |texture: &&TextureDescription| {
            material.diffuse == ColorOrTexture::Texture(texture.name.clone())
                || material.bump.as_ref().is_some_and(|bump| bump.texture == texture.name)
        };
        let textures = textures.iter().filter(uses).cloned().collect();
        let key = BallKey { material: material.clone(), textures };
        let size = Vec2::splat(BALL_PX as f32);
        self.ball.show(ui, key, assets, size, "a ball of this material");
    }

    /// Shows a patch of that texture.
    pub(super) fn patch_ui(
        &mut self,
        ui: &mut Ui,
        texture: &TextureDescription,
        assets: &Arc<Assets>,
    ) {
        let width = ui.available_width();
        let size = Vec2::new(width, (width * PATCH_PX[1] as f32 / PATCH_PX[0] as f32).round());
        let told = format!("{PATCH_UNITS} scene units of this texture");
        self.patch.show(ui, PatchKey { texture: texture.clone() }, assets, size, &told);
    }
}

#[cfg(test)]
impl Swatches {
    /// Whether the ball was last asked for with these files.
    pub(super) fn ball_is_of(&self, assets: &Arc<Assets>) -> bool {
        let asked = self.ball.asked.as_ref();
        asked.is_some_and(|(_, of)| Weak::ptr_eq(of, &Arc::downgrade(assets)))
    }
}

impl<Key: Clone + PartialEq + Send + 'static> Swatch<Key> {
    fn new(
        name: &'static str,
        wake: impl Fn() + Send + 'static,
        mut make: impl FnMut(&Key, &Assets) -> Option<ColorImage> + Send + 'static,
    ) -> io::Result<Self> {
        let work = move |(key, assets): (Key, Arc<Assets>)| make(&key, &assets);
        let thread = Background::new(name, work, wake)?;
        Ok(Self { name, thread, asked: None, shown: None })
    }

    fn show(&mut self, ui: &mut Ui, key: Key, assets: &Arc<Assets>, size: Vec2, told: &str) {
        let files = Arc::downgrade(assets);
        let is_asked = |(known, of): &(Key, _)| *known == key && Weak::ptr_eq(of, &files);
        if !self.asked.as_ref().is_some_and(is_asked) {
            self.asked = Some((key.clone(), files));
            self.thread.order((key, Arc::clone(assets)));
        }
        if let Some(image) = self.thread.take().flatten() {
            match &mut self.shown {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                None => {
                    let texture = ui.ctx().load_texture(self.name, image, TextureOptions::LINEAR);
                    self.shown = Some(texture);
                }
            }
        }
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, told));
        response.on_hover_text(told);
        match &self.shown {
            Some(texture) => {
                egui::Image::new(texture)
                    .corner_radius(4)
                    .fit_to_exact_size(size)
                    .paint_at(ui, rect);
            }
            None => {
                ui.painter().rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
            }
        }
    }
}

/// A ball of the material on a checkered ground under one soft light.
fn ball_picture(key: &BallKey, assets: &Assets) -> Option<ColorImage> {
    let description = ball_scene(key);
    let scene = Arc::new(resolve(&description, assets).ok()?);
    let settings = RenderSettings::new(&description.render, AcceleratorKind::default());
    let world = World::new(RenderJob { scene, width: BALL_PX, height: BALL_PX, settings });
    let mut film = Film::new(BALL_PX, BALL_PX).ok()?;
    render_pass(&world, &mut film, BALL_SAMPLES, &AtomicBool::new(false)).ok()?;
    let pixels = film.picture().pixels;
    Some(image_of(&pixels, [BALL_PX, BALL_PX], ToneOperator::Agx))
}

fn ball_scene(key: &BallKey) -> SceneDescription {
    let mut ground = MaterialDescription::new("ground of the ball");
    ground.diffuse = ColorOrTexture::Texture("checks of the ball".to_owned());
    let checks = TextureDescription {
        name: "checks of the ball".to_owned(),
        kind: TextureKind::Checker,
        scale: 2.0,
        octaves: 1,
        lacunarity: 2.0,
        gain: 0.5,
        distortion: 0.0,
        colors: Some(vec![[0.10; 3], [0.32; 3]]),
        file: None,
    };
    let mut ball = ObjectDescription::new("ball", ObjectKind::Sphere);
    ball.center = Some([0.0; 3]);
    ball.radius = Some(1.0);
    ball.material = Some(key.material.name.clone());
    let mut plane = ObjectDescription::new("ground", ObjectKind::Plane);
    plane.point = Some([0.0, -1.0, 0.0]);
    plane.normal = Some([0.0, 1.0, 0.0]);
    plane.material = Some(ground.name.clone());
    let light = LightDescription {
        name: "key".to_owned(),
        kind: LightKind::Rectangle,
        position: [-2.5, 4.0, 3.0],
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        size: OneOrTwo::One(1.6),
        power: [230.0; 3],
        visible: true,
        enabled: true,
    };
    let mut textures = key.textures.clone();
    textures.push(checks);
    SceneDescription {
        render: RenderDescription {
            integrator: IntegratorKind::Direct,
            max_depth: 6,
            ..RenderDescription::default()
        },
        camera: CameraDescription {
            eye: [0.0, 0.7, 4.2],
            target: [0.0, -0.02, 0.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov: 32.0,
            aperture_radius: 0.0,
            focal_distance: None,
            aperture_blades: 0,
        },
        tone_mapping: Default::default(),
        environment: EnvironmentDescription {
            ambient: [0.14; 3],
            background: ColorOrTexture::Color([0.16, 0.17, 0.19]),
        },
        textures,
        materials: vec![key.material.clone(), ground],
        lights: vec![light],
        objects: vec![ball, plane],
    }
}

/// The texture on the plane z = 0, or over its uv.
fn patch_picture(key: &PatchKey, assets: &Assets) -> Option<ColorImage> {
    let mut scene = ball_scene(&BallKey {
        material: MaterialDescription::new("none"),
        textures: vec![key.texture.clone()],
    });
    scene.objects.clear();
    let scene = resolve(&scene, assets).ok()?;
    let texture: &Texture = scene.textures.first()?;
    let [width, height] = PATCH_PX;
    let unit = PATCH_UNITS / f64::from(width);
    let pixels: Vec<[f32; 3]> = (0..width * height)
        .map(|index| {
            let (x, y) = (f64::from(index % width) + 0.5, f64::from(index / width) + 0.5);
            let point = DVec3::new(x * unit, -y * unit, 0.31);
            let uv = Uv::new((x * unit) as f32, (-y * unit) as f32);
            texture.eval(&Lookup { point, uv, uv_gradients: [Vec3::ZERO; 2] }).into()
        })
        .collect();
    Some(image_of(&pixels, PATCH_PX, ToneOperator::Linear))
}

fn image_of(pixels: &[[f32; 3]], [width, height]: [u32; 2], operator: ToneOperator) -> ColorImage {
    let mut bytes = vec![[0; 3]; pixels.len()];
    map_to_srgb8(pixels, 0.0, operator, &mut bytes);
    let colors = bytes.iter().map(|[r, g, b]| Color32::from_rgb(*r, *g, *b)).collect();
    ColorImage::new([width as usize, height as usize], colors)
}

//! What lies behind each pixel, told without light: the first thing that the ray through its middle
//! meets, and what finding it takes. For views of the scene, for picking, for looking closely.
//!
//! The rays are those of a pinhole: nothing here depends on the lens or on the samples.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::color::Rgb;
use crate::geometry::{Hit, TraversalCost};
use crate::math::{Ray, RayBatch};
use crate::render::plan::{TILE_SIZE, Tile, tiles};
use crate::render::shading::Shading;
use crate::render::{RenderJob, Stopped, World};
use crate::scene::Camera;

/// One value for every pixel of a picture, row 0 at the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PixelMap<T> {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height` values, row by row.
    pub pixels: Vec<T>,
}

/// What is met first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seen {
    /// Only the background.
    #[default]
    Nothing,
    /// Index among the enabled objects.
    Object(u32),
    /// A visible light; index among the enabled lights.
    Light(u32),
}

/// The first thing that a pixel's middle ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// What it is.
    pub seen: Seen,
    /// Which of a mesh's material slots.
    pub slot: u32,
    /// Distance along the viewing axis in scene units; infinite for suns and the background.
    pub depth: f32,
    /// Unit shading normal in the world on the viewer's side, bumps included; 0 where there is none.
    pub normal: Vec3,
    /// All that the surface reflects or lets through, in 0..=1: diffuse, gloss, mirror and glass.
    pub albedo: Rgb,
}

impl Feature {
    /// Nothing but the background.
    pub const NOTHING: Self = Self {
        seen: Seen::Nothing,
        slot: 0,
        depth: f32::INFINITY,
        normal: Vec3::ZERO,
        albedo: Rgb::ZERO,
    };
}

impl<T> PixelMap<T> {
    /// The value at a pixel, if it is in the picture.
    pub fn get(&self, x: u32, y: u32) -> Option<&T> {
        let is_inside = x < self.width && y < self.height;
        is_inside.then(|| &self.pixels[y as usize * self.width as usize + x as usize])
    }
}

impl World {
    /// The pinhole ray through (x, y) in pixels. Its direction's component along the axis is 1, so
    /// that parameters along it are depths.
    pub(super) fn pixel_ray(&self, x: f32, y: f32) -> Ray {
        let camera = &self.job.scene.camera;
        let size = Vec2::new(self.job.width as f32, self.job.height as f32);
        Ray::new(camera.eye, camera.pinhole_direction(Vec2::new(x, y), size))
    }

    /// What is seen along a ray of the camera that meets this surface.
    pub(super) fn feature(&self, ray: &Ray, hit: Option<Hit>) -> Feature {
        let surface_depth = hit.map_or(f32::INFINITY, |hit| hit.t);
        if let Some((light, depth)) = self.light_before(ray, surface_depth) {
            let normal = self.job.scene.lights[light].normal_at(ray.at(depth));
            return Feature {
                seen: Seen::Light(light as u32),
                depth,
                normal: normal.unwrap_or(Vec3::ZERO),
                ..Feature::NOTHING
            };
        }
        let Some(hit) = hit else { return Feature::NOTHING };
        let shading = Shading::new(self, ray, hit);
        let (glossy, material) = (&shading.glossy, shading.material);
        let reflected = glossy.diffuse + glossy.specular + material.reflection;
        Feature {
            seen: Seen::Object(hit.id.object),
            slot: shading.surface.slot,
            depth: hit.t,
            normal: shading.frame.z,
            albedo: (reflected + material.transmission).clamp(Vec3::ZERO, Vec3::ONE),
        }
    }

    /// The nearest visible light that a ray meets before a surface at `t_surface`; suns stand
    /// behind everything.
    fn light_before(&self, ray: &Ray, t_surface: f32) -> Option<(usize, f32)> {
        let lights = self.job.scene.lights.iter().enumerate();
        let met = lights.filter(|(_, light)| light.visible).filter_map(|(index, light)| {
            let (t, _) = light.intersect(ray)?;
            (t < t_surface || t_surface == f32::INFINITY).then_some((index, t))
        });
        met.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The features of every pixel, on the current pool. `stop` is looked at before every tile.
///
/// # Errors
/// [`Stopped`], also where the map does not fit into memory.
pub fn feature_map(world: &World, stop: &AtomicBool) -> Result<PixelMap<Feature>, Stopped> {
    map_tiles(world, stop, Feature::NOTHING, |rays, values| {
        let mut hits = Vec::new();
        world.geometry.intersect(rays, &mut hits);
        values.extend((0..rays.len()).map(|i| world.feature(&rays.ray(i), hits[i].hit())));
    })
}

/// What the first hit of every pixel costs a single ray, on the current pool. `stop` is looked at
/// before every tile.
///
/// # Errors
/// [`Stopped`], also where the map does not fit into memory.
pub fn cost_map(world: &World, stop: &AtomicBool) -> Result<PixelMap<TraversalCost>, Stopped> {
    map_tiles(world, stop, TraversalCost::default(), |rays, values| {
        let cost = |i| world.geometry.intersect_counted(&rays.ray(i)).1;
        values.extend((0..rays.len()).map(cost));
    })
}

/// Whether two jobs see the same first hits: they differ at most in the lens, in lights that no one
/// sees, and in how light is followed.
pub fn same_first_hits(a: &RenderJob, b: &RenderJob) -> bool {
    let pinhole = |camera: Camera| Camera {
        aperture_radius: 0.0,
        aperture_blades: 0,
        focal_distance: 1.0,
        ..camera
    };
    let (one, other) = (&a.scene, &b.scene);
    (a.width, a.height, a.settings.accelerator) == (b.width, b.height, b.settings.accelerator)
        && pinhole(one.camera) == pinhole(other.camera)
        && one.objects == other.objects
        && one.materials == other.materials
        && one.textures == other.textures
        && one.lights == other.lights
}

/// Fills a map tile by tile: `fill` appends one value for each ray.
fn map_tiles<T: Copy + Send + Sync>(
    world: &World,
    stop: &AtomicBool,
    empty: T,
    fill: impl Fn(&RayBatch, &mut Vec<T>) + Sync,
) -> Result<PixelMap<T>, Stopped> {
    let (width, height) = (world.job.width, world.job.height);
    let n_pixels = width as usize * height as usize;
    let mut pixels = Vec::new();
    pixels.try_reserve_exact(n_pixels).map_err(|_| Stopped)?;
    pixels.resize(n_pixels, empty);
    let band = (width * TILE_SIZE) as usize;
    pixels.par_chunks_mut(band).enumerate().try_for_each(|(index, rows)| {
        let n_rows = (rows.len() / width as usize) as u32;
        let top = index as u32 * TILE_SIZE;
        let (mut rays, mut values) = (RayBatch::default(), Vec::new());
        for tile in tiles(width, n_rows) {
            if stop.load(Ordering::Relaxed) {
                return Err(Stopped);
            }
            rays.clear();
            for (x, y) in tile.pixels() {
                rays.push(world.pixel_ray(x as f32 + 0.5, (top + y) as f32 + 0.5));
            }
            values.clear();
            fill(&rays, &mut values);
            copy_tile(&tile, &values, rows, width);
        }
        Ok(())
    })?;
    Ok(PixelMap { width, height, pixels })
}

fn copy_tile<T: Copy>(tile: &Tile, values: &[T], rows: &mut [T], width: u32) {
    for (y, row) in tile.rows().zip(values.chunks_exact(tile.width as usize)) {
        let first = (y * width + tile.x) as usize;
        rows[first..first + row.len()].copy_from_slice(row);
    }
}

//! Small helpers of the suite: scenes from TOML text, pictures from scenes, numbers to compare.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::DVec3;
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, TracedMesh};
use penumbra::io::scene_file;
use penumbra::render::{Film, RenderJob, RenderSettings, World, render_pass};
use penumbra::scene::assets::{Assets, MeshAsset, MeshKey};
use penumbra::scene::image::Image;
use penumbra::scene::resolve;

/// Makes a mesh.
pub(crate) type MakeMesh = fn() -> Mesh;

/// What a scene's files hold: meshes and images by the names that the text gives them.
#[derive(Default)]
pub(crate) struct Files {
    pub(crate) meshes: Vec<(&'static str, MakeMesh)>,
    pub(crate) images: Vec<(&'static str, Image)>,
}

/// The job that a scene file describes.
pub(crate) fn job(text: &str) -> RenderJob {
    job_with(text, Files::default(), AcceleratorKind::KdTree)
}

/// The same, with files and an accelerator.
pub(crate) fn job_with(text: &str, files: Files, accelerator: AcceleratorKind) -> RenderJob {
    let description = match scene_file::parse(text, &[]) {
        Ok(description) => description,
        Err(error) => panic!("{error} in\n{text}"),
    };
    let mut assets = Assets::default();
    for (name, image) in files.images {
        assets.images.insert(name.to_owned(), Arc::new(image));
    }
    for object in &description.objects {
        let Some(key) = MeshKey::of(object) else { continue };
        let (_, mesh) = files.meshes.iter().find(|(name, _)| *name == key.file).unwrap();
        let traced = Arc::new(TracedMesh::new(mesh()));
        assets.meshes.entry(key).or_insert(Arc::new(MeshAsset { traced, slots: vec![None] }));
    }
    let render = &description.render;
    RenderJob {
        width: render.width,
        height: render.height,
        settings: RenderSettings::new(render, accelerator),
        scene: Arc::new(resolve(&description, &assets).unwrap()),
    }
}

/// The film of a job after one pass of `n_samples`.
pub(crate) fn film(job: &RenderJob, n_samples: u32) -> Film {
    let world = World::new(job.clone());
    let mut film = Film::new(job.width, job.height).unwrap();
    let statistics = render_pass(&world, &mut film, n_samples, &AtomicBool::new(false)).unwrap();
    assert_eq!(statistics.n_invalid, 0, "every sample is a number");
    film
}

/// Mean radiance of a whole film.
pub(crate) fn mean(film: &Film) -> DVec3 {
    let pixels = film.picture().pixels;
    let total: DVec3 = pixels.iter().map(|p| DVec3::from_array(p.map(f64::from))).sum();
    total / pixels.len() as f64
}

/// One look at a scene through a keyhole.
#[derive(Clone)]
pub(crate) struct Look {
    pub(crate) eye: [f64; 3],
    pub(crate) target: [f64; 3],
    /// Keys of `[render]` beside size and samples, as TOML.
    pub(crate) render: &'static str,
    /// Samples of each of the 16 pixels.
    pub(crate) samples: u32,
}

impl Look {
    /// From `eye` to `target`, by the "direct" integrator.
    pub(crate) fn at(eye: [f64; 3], target: [f64; 3]) -> Self {
        Self { eye, target, render: "", samples: 256 }
    }

    /// The same with other settings.
    pub(crate) fn with(self, render: &'static str) -> Self {
        Self { render, ..self }
    }

    /// The same with other samples.
    pub(crate) fn samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// The scene as a file: this camera, and a body of lights, materials and objects.
    pub(crate) fn text(&self, body: &str) -> String {
        let Self { eye, target, render, .. } = self;
        let axis = DVec3::from_array(*target) - DVec3::from_array(*eye);
        let up = if axis.normalize().y.abs() > 0.9 { "[0, 0, -1]" } else { "[0, 1, 0]" };
        format!(
            "[render]\nwidth = 4\nheight = 4\n{render}\n\
             [camera]\neye = {eye:?}\ntarget = {target:?}\nup = {up}\nvertical_fov = 0.01\n{body}"
        )
    }

    /// Mean radiance that arrives.
    pub(crate) fn radiance(&self, body: &str) -> DVec3 {
        mean(&film(&job(&self.text(body)), self.samples))
    }
}

/// Radiance of a white Lambertian surface, times pi: the irradiance at the target.
pub(crate) fn irradiance(body: &str, eye: [f64; 3], target: [f64; 3]) -> f64 {
    Look::at(eye, target).radiance(body).x * std::f64::consts::PI
}

/// A white floor at y = 0.
pub(crate) const WHITE_FLOOR: &str = r#"
[[materials]]
name = "white"
diffuse = [1, 1, 1]
[[objects]]
type = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
material = "white"
"#;

/// Fails with both numbers where they differ by more than a share of the expected one.
#[track_caller]
pub(crate) fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let difference = (found - expected).abs();
    let limit = tolerance * expected.abs().max(1e-9);
    assert!(difference <= limit, "{what}: {found}, not {expected} within {tolerance}");
}

/// Irradiance by a uniform polygon of unit radiance, all of it above the horizon.
///
/// Source: J. H. Lambert, "Photometria", 1760.
pub(crate) fn lambert_polygon(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in corners.iter().enumerate() {
        let a = (*a - point).normalize();
        let b = (corners[(i + 1) % corners.len()] - point).normalize();
        sum += a.dot(b).acos() * a.cross(b).normalize().dot(normal);
    }
    0.5 * sum.abs()
}

/// Numbers in [0, 1) from a counter: the same in every run.
pub(crate) struct Numbers(u64);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number, by SplitMix64.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two bounds.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Uniform on the unit sphere.
    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let phi = self.between(0.0, std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z)
    }
}

/// A closed mesh: an icosahedron, its faces cut in four `levels` times, its vertices on the unit
/// sphere around the origin times `scale`, then moved.
pub(crate) fn icosphere(levels: u32, scale: f32, center: glam::Vec3) -> Mesh {
    let g = 0.5 * (1.0 + 5.0_f32.sqrt());
    let mut positions: Vec<glam::Vec3> = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        positions.push(glam::Vec3::new(a, b, 0.0));
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        positions.push(glam::Vec3::new(0.0, a, b));
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        positions.push(glam::Vec3::new(b, 0.0, a));
    }
    // Faces are the triples of vertices at distance 2 from each other, turned outwards.
    let near = |p: glam::Vec3, q: glam::Vec3| (p.distance(q) - 2.0).abs() < 1e-3;
    let mut triangles = Vec::new();
    for i in 0..12_usize {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let [a, b, c] = [positions[i], positions[j], positions[k]];
                if near(a, b) && near(b, c) && near(c, a) {
                    let outward = (b - a).cross(c - a).dot(a) > 0.0;
                    triangles.push(if outward { [i, j, k] } else { [i, k, j] }.map(|x| x as u32));
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i as usize] + positions[j as usize]) * 0.5);
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
        for p in &mut positions {
            *p = p.normalize();
        }
    }
    let positions = positions.iter().map(|p| p.normalize() * scale + center).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

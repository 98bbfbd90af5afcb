//! Every kind of emitter by chi-square: what is sampled against the density of what rays meet.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::Emission;
use crate::brdf::{Ward, WardForm};
use crate::color::Rgb;
use crate::geometry::mesh::Mesh;
use crate::geometry::{AcceleratorKind, Geometry, Hit, Instance, Nearest, Shape, TracedMesh};
use crate::math::sampler::{SampleNumbers, Sampler};
use crate::math::{Ray, RayBatch, Transform};
use crate::scene::material::ColorSource;
use crate::scene::texture::{Pattern, Texture};
use crate::scene::{Background, Camera, Material, Object, Scene};

fn glowing(emission: Rgb) -> Material {
    Material {
        diffuse: ColorSource::constant(Rgb::ZERO),
        specular: Rgb::ZERO,
        lobe: Ward { form: WardForm::Original, alpha_x: 0.1, alpha_y: 0.1 },
        tangent: Vec3::X,
        reflection: Rgb::ZERO,
        transmission: Rgb::ZERO,
        ior: 1.5,
        emission,
        bump: None,
    }
}

/// Objects whose slots glow with 1, 3 and 0.
fn scene(shapes: Vec<(Shape, Transform)>, background: Background, textures: Vec<Texture>) -> Scene {
    let object = |(shape, transform)| Object {
        instance: Instance::new(shape, transform),
        materials: vec![0, 1, 2],
    };
    Scene {
        camera: Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0),
        ambient: Rgb::ZERO,
        background,
        textures,
        materials: [1.0, 3.0, 0.0].map(|glow| glowing(Rgb::splat(glow))).into(),
        lights: Vec::new(),
        objects: shapes.into_iter().map(object).collect(),
    }
}

fn first_hits(geometry: &Geometry, from: Vec3, directions: &[Vec3]) -> Vec<Option<Hit>> {
    let mut rays = RayBatch::default();
    directions.iter().for_each(|d| rays.push(Ray::new(from, *d)));
    let mut hits = Vec::new();
    geometry.intersect(&rays, &mut hits);
    hits.iter().map(Nearest::hit).collect()
}

const N_COS: usize = 16;
const N_PHI: usize = 32;
const N_SUB: usize = 20;

/// Cells of equal solid angle over all directions.
fn cell(direction: Vec3) -> usize {
    let d = direction.as_dvec3();
    let row = ((1.0 - d.z) * 0.5 * N_COS as f64) as usize;
    let turn = (d.y.atan2(d.x) / TAU).rem_euclid(1.0);
    row.min(N_COS - 1) * N_PHI + ((turn * N_PHI as f64) as usize).min(N_PHI - 1)
}

/// One direction somewhere in each part of a cell: rows would miss what is thin and level.
fn fine_grid() -> Vec<Vec3> {
    let (rows, columns) = (N_COS * N_SUB, N_PHI * N_SUB);
    let mut directions = Vec::with_capacity(rows * columns);
    for row in 0..rows {
        for column in 0..columns {
            let numbers = Sampler::Random { seed: 3 }.numbers(column as u32, row as u32, 0);
            let [u, v] = numbers.pair(0).map(f64::from);
            let z = 1.0 - 2.0 * (row as f64 + v) / rows as f64;
            let (sin, cos) = (TAU * (column as f64 + u) / columns as f64).sin_cos();
            let across = (1.0 - z * z).sqrt();
            directions.push(DVec3::new(across * cos, across * sin, z).as_vec3());
        }
    }
    directions
}

#[track_caller]
fn assert_distributed(scene: &Scene, from: Vec3, normal: Vec3, what: &str) {
    const N_SAMPLES: u32 = 40_000;
    let emission = Emission::new(scene);
    let instances = scene.objects.iter().map(|object| object.instance.clone()).collect();
    let geometry = Geometry::new(instances, AcceleratorKind::WideBvh);
    let mut weights = Vec::new();
    let total = emission.weigh(from, normal, u32::MAX, &mut weights);
    assert!(total > 0.0, "{what}: nothing is looked for");
    let density = |direction: Vec3, hit: Option<Hit>| match hit {
        Some(hit) => {
            let surface = geometry.surface(&Ray::new(from, direction), hit);
            let object = &scene.objects[hit.id.object as usize];
            let radiance = scene.materials[object.material(surface.slot) as usize].emission;
            emission.pdf((from, normal, u32::MAX, total), direction, (hit, &surface, radiance))
        }
        None => emission.sky_pdf(total, direction),
    };
    let grid = fine_grid();
    let mut shares = vec![0.0; N_COS * N_PHI];
    for (direction, hit) in grid.iter().zip(first_hits(&geometry, from, &grid)) {
        shares[cell(*direction)] +=
            f64::from(density(*direction, hit)) * 2.0 * TAU / grid.len() as f64;
    }
    let mut samples = Vec::new();
    for i in 0..N_SAMPLES {
        let numbers: SampleNumbers = Sampler::Random { seed: 7 }.numbers(i % 256, i / 256, 0);
        let (choice, u) = (numbers.pair(0), numbers.pair(1));
        samples.extend(emission.sample(scene, from, (&weights, total), choice, u));
    }
    // What is hidden, or not met by rounding, is a cell of its own.
    let directions: Vec<Vec3> = samples.iter().map(|sample| sample.direction).collect();
    let mut counts = vec![0.0; N_COS * N_PHI];
    let mut n_met = 0.0;
    for (sample, hit) in samples.iter().zip(first_hits(&geometry, from, &directions)) {
        let distance = sample.reach.length();
        let is_met = match hit {
            Some(hit) => sample.t_max.is_finite() && (hit.t - distance).abs() < 1e-3 * distance,
            None => sample.t_max == f32::INFINITY,
        };
        if !is_met {
            continue;
        }
        let (found, met) = (sample.pdf.unwrap(), density(sample.direction, hit));
        n_met += f64::from((found - met).abs() < 0.02 * found);
        assert!(sample.weight.max_element() * found <= 3.0 * 1.001, "{what}: too bright");
        counts[cell(sample.direction)] += 1.0;
    }
    let n_counted: f64 = counts.iter().sum();
    assert!(n_met > 0.99 * n_counted, "{what}: densities agree for {n_met} of {n_counted}");
    let (accepted, met) = (shares.iter().sum::<f64>(), n_counted / f64::from(N_SAMPLES));
    assert!((accepted - met).abs() < 0.015, "{what}: {accepted} of the density, {met} are met");
    let (mut chi2, mut freedom, mut pooled) = (0.0, -1.0_f64, [0.0; 2]);
    for (count, share) in counts.iter().zip(&shares) {
        let expected = share / accepted * n_counted;
        // The grid's own error, at rims, is that of a few of its points.
        let error = 0.8 * expected / N_SUB as f64;
        if expected < 400.0 {
            pooled = [pooled[0] + count, pooled[1] + expected];
        } else {
            chi2 += (count - expected).powi(2) / (expected + error * error);
            freedom += 1.0;
        }
    }
    if pooled[1] > 0.0 {
        chi2 += (pooled[0] - pooled[1]).powi(2) / (pooled[1] + 1e-4 * pooled[1].powi(2));
        freedom += 1.0;
    }
    assert!(freedom >= 3.0, "{what}: only {freedom} degrees of freedom");
    let limit = freedom + 5.0 * (2.0 * freedom).sqrt();
    assert!(chi2 < limit, "{what}: chi-square {chi2} of {freedom}");
}

/// A bent sheet of two triangles, of different glow.
fn sheet() -> Shape {
    let positions = vec![
        Vec3::new(-1.0, -0.8, 0.3),
        Vec3::new(1.0, -1.0, 0.0),
        Vec3::new(0.9, 1.0, 0.0),
        Vec3::new(-1.1, 0.7, 0.2),
    ];
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mesh = Mesh { positions, triangles, slots: vec![0, 1], ..Mesh::default() };
    Shape::Mesh(Arc::new(TracedMesh::new(mesh)))
}

#[test]
fn emitters_are_sampled_with_their_density() {
    let still = Transform::IDENTITY;
    let moved = Transform::new(
        DVec3::new(0.2, -0.1, 0.3),
        DVec3::new(20.0, 40.0, -30.0),
        DVec3::new(1.4, 0.6, -0.9),
    );
    let shapes = [
        Shape::Sphere { center: DVec3::new(0.1, 0.0, 0.0), radius: 0.8 },
        Shape::Box { min: DVec3::new(-0.7, -0.5, -0.9), max: DVec3::new(0.6, 0.9, 0.4) },
        Shape::Cylinder { base: DVec3::NEG_Z, top: DVec3::new(0.3, 0.2, 0.7), radius: 0.5 },
        Shape::Cone { base: DVec3::NEG_Z, tip: DVec3::new(0.3, 0.2, 0.7), radius: 0.7 },
        sheet(),
    ];
    // Beside, above the base, above the tip's cone, below.
    let places = [Vec3::new(1.7, 0.3, -0.2), Vec3::new(0.3, 0.1, 1.8), Vec3::new(0.2, -0.4, -1.9)];
    for shape in shapes {
        for transform in [still, moved] {
            for (i, from) in places.into_iter().enumerate() {
                // The sheet is seen edge on from the first place: too thin for the grid.
                if i == 0 && matches!(shape, Shape::Mesh(_)) {
                    continue;
                }
                let background = Background::Color(Rgb::ZERO);
                let scene = scene(vec![(shape.clone(), transform)], background, Vec::new());
                let place = if transform.is_identity() { "still" } else { "moved" };
                let name = format!("{shape:?}");
                let what = format!("{}, {place}, from {from}", &name[..name.len().min(60)]);
                assert_distributed(&scene, from, -from.normalize(), &what);
            }
        }
    }
}

/// Several of them together with a sky, some behind others: the choice belongs to the density.
#[test]
fn the_choice_among_emitters_belongs_to_the_density() {
    let ball = |x: f64, radius: f64| {
        (Shape::Sphere { center: DVec3::new(x, 0.5, 0.0), radius }, Transform::IDENTITY)
    };
    let sky = Texture::Noise(crate::scene::texture::Noise {
        pattern: Pattern::Marble,
        scale: 0.7,
        octaves: crate::math::noise::Octaves { count: 1, lacunarity: 2.0, gain: 0.5 },
        distortion: 0.0,
        colors: vec![Rgb::splat(0.1), Rgb::splat(1.5)],
    });
    let shapes =
        vec![ball(2.0, 0.8), ball(-2.5, 1.2), ball(-6.0, 2.0), (sheet(), Transform::IDENTITY)];
    let scene = scene(shapes, Background::Texture(0), vec![sky]);
    let up = Vec3::new(0.0, 0.6, 0.8);
    assert_distributed(&scene, Vec3::new(0.0, -1.5, -0.5), up, "balls, a sheet and a sky");
}

/// What one of them is chosen by moves no mean, only noise: area times luminance over 4 and the squared
/// distance, times the best cosine of the ball around its bounds, at most that of a sky of its peak; of a
/// sky, half of what is above its mean.
#[test]
fn emitters_are_chosen_by_about_their_irradiance() {
    let ball = Shape::Sphere { center: DVec3::ZERO, radius: 0.8 };
    let block = Shape::Box { min: DVec3::new(-1.0, -0.5, -0.25), max: DVec3::new(1.0, 0.5, 0.25) };
    let tube = Shape::Cylinder { base: DVec3::NEG_Y, top: DVec3::Y, radius: 0.5 };
    let stretched =
        Transform::new(DVec3::ZERO, DVec3::new(0.0, 90.0, 0.0), DVec3::new(2.0, 2.0, 2.0));
    let pi = std::f64::consts::PI;
    for (shape, area, half) in [
        (ball, 4.0 * pi * 0.64, DVec3::splat(0.8)),
        (block, 2.0 * (2.0 + 0.5 + 1.0), DVec3::new(1.0, 0.5, 0.25)),
        (tube, pi * (2.0 + 0.5), DVec3::new(0.5, 1.0, 0.5)),
    ] {
        for (transform, scale) in [(Transform::IDENTITY, 1.0), (stretched, 2.0)] {
            let scene =
                scene(vec![(shape.clone(), transform)], Background::Color(Rgb::ZERO), Vec::new());
            let emission = Emission::new(&scene);
            let reach = 1.001 * scale * half.length();
            // Facing it, at right angles to it, and from just outside.
            for (distance, normal, cos) in [
                (9.0, Vec3::NEG_Y, 1.0),
                (9.0, Vec3::X, reach / 9.0),
                (1.02 * scale * half.y, Vec3::NEG_Y, 1.0),
            ] {
                let from = Vec3::Y * distance as f32;
                let found = emission.weigh(from, normal, u32::MAX, &mut Vec::new());
                // The brightest of its materials glows with 3.
                let irradiance = 3.0 * 0.25 * area * scale * scale / (distance * distance);
                let expected = cos * irradiance.min(3.0 * pi);
                let what = format!("{shape:?}, {scale}, {distance} away");
                assert!(
                    (f64::from(found) / expected - 1.0).abs() < 1e-4,
                    "{found}, not {expected}: {what}"
                );
            }
        }
    }
    // A checker of two colours by octants: half of the sky is 1 above the mean of 1.
    let checker = Texture::Checker { scale: 1.0, colors: [Rgb::ZERO, Rgb::splat(2.0)] };
    let scene = scene(Vec::new(), Background::Texture(0), vec![checker]);
    let found = Emission::new(&scene).weigh(Vec3::ZERO, Vec3::Y, u32::MAX, &mut Vec::new());
    assert!((f64::from(found) / pi - 1.0).abs() < 1e-3, "{found}: half of 2 pi");
}

/// From within a solid only scattered rays find it; a uniform sky is never looked for.
#[test]
fn what_scattered_rays_find_as_well_is_left_to_them() {
    let shapes = [
        Shape::Sphere { center: DVec3::ZERO, radius: 2.0 },
        Shape::Box { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) },
        Shape::Cylinder { base: DVec3::new(0.0, -2.0, 0.0), top: DVec3::Y, radius: 1.5 },
        Shape::Cone { base: DVec3::new(0.0, -2.0, 0.0), tip: 3.0 * DVec3::Y, radius: 1.5 },
    ];
    for shape in shapes {
        let scene = scene(
            vec![(shape, Transform::IDENTITY)],
            Background::Texture(0),
            vec![Texture::Solid(Rgb::ONE)],
        );
        let emission = Emission::new(&scene);
        let mut weights = Vec::new();
        assert_eq!(emission.weigh(Vec3::ZERO, Vec3::Y, u32::MAX, &mut weights), 0.0, "{weights:?}");
        assert!(
            emission.weigh(Vec3::X * 5.0, Vec3::NEG_X, u32::MAX, &mut weights) > 0.0,
            "from outside"
        );
    }
}

//! Rays from inside closed meshes: `escape [RAYS [SEED]]` says how many get out. None may.
//!
//! Balls, boxes and rings of many sizes, far from the origin and at it, turned and mirrored; rays
//! to anywhere, to corners and to the middles of edges, alone and in packets, by every tree.

#![expect(clippy::print_stdout, reason = "a program for a terminal")]

use std::f64::consts::TAU;
use std::process::ExitCode;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use penumbra::geometry::mesh::Mesh;
use penumbra::geometry::{AcceleratorKind, Geometry, Instance, Shape, TracedMesh};
use penumbra::math::{Ray, RayBatch, Transform};

/// Rays that are traced at once.
const BATCH: usize = 4096;
/// Of the rays, one in so many takes the kd-tree.
const KD_SHARE: u64 = 8;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>().expect("a number"));
    let n_rays = arguments.next().unwrap_or(1_000_000);
    let mut numbers =
        Numbers(arguments.next().unwrap_or(1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let (mut n_traced, mut n_escaped, mut n_worlds) = (0_u64, 0_u64, 0_u64);
    while n_traced < n_rays {
        let (mesh, corners, scale, center) = closed_mesh(&mut numbers);
        let axis = |n: &mut Numbers| n.between(0.3, 2.0) * if n.next() < 0.5 { 1.0 } else { -1.0 };
        let stretch = DVec3::new(axis(&mut numbers), axis(&mut numbers), axis(&mut numbers));
        let turn = DVec3::new(numbers.next(), numbers.next(), numbers.next()) * 360.0;
        let is_turned = numbers.next() < 0.7;
        let transform = match is_turned {
            true => Transform::new(numbers.direction() * f64::from(scale), turn, stretch),
            false => Transform::IDENTITY,
        };
        n_worlds += 1;
        let kind = match n_worlds % KD_SHARE {
            0 => AcceleratorKind::KdTree,
            _ => AcceleratorKind::WideBvh,
        };
        let instance = Instance::new(Shape::Mesh(Arc::new(TracedMesh::new(mesh))), transform);
        let geometry = Geometry::new(vec![instance], kind);
        let place = |p: Vec3| transform.world_from_object_point(p.as_dvec3()).as_vec3();
        for _ in 0..64 {
            let mut rays = RayBatch::default();
            let is_packet = numbers.next() < 0.5;
            let mut origin = center(&mut numbers);
            while rays.len() < BATCH {
                if !is_packet || rays.len() % 16 == 0 {
                    origin = center(&mut numbers);
                }
                let corner = corners[numbers.below(corners.len())];
                let other = corners[numbers.below(corners.len())];
                let target = match numbers.below(3) {
                    0 => corner,
                    1 => corner.midpoint(other),
                    _ => origin + numbers.direction().as_vec3() * scale,
                };
                let direction = place(target) - place(origin);
                if direction.length() > 1e-3 * scale {
                    rays.push(Ray::new(place(origin), direction));
                }
            }
            let mut hits = Vec::new();
            geometry.intersect(&rays, &mut hits);
            n_traced += hits.len() as u64;
            for (index, _) in hits.iter().enumerate().filter(|(_, hit)| !hit.is_hit()) {
                n_escaped += 1;
                if n_escaped <= 5 {
                    println!("escaped: {}, {:?}", kind.name(), rays.ray(index));
                }
            }
        }
    }
    println!("{n_traced} rays in {n_worlds} closed meshes: {n_escaped} escaped");
    if n_escaped == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// A mesh, its corners, its size, and a way to find points inside.
type Closed = (Mesh, Vec<Vec3>, f32, Box<dyn Fn(&mut Numbers) -> Vec3>);

fn closed_mesh(numbers: &mut Numbers) -> Closed {
    let scale = [1.0, 1.0, 1e-3, 1e6][numbers.below(4)];
    let far = if numbers.next() < 0.3 { 1e4 * scale } else { 0.0 };
    let middle = numbers.direction().as_vec3() * far;
    // Rings of points: a ball closes at its poles, a ring closes in itself.
    let is_ball = numbers.next() < 0.6;
    let (n_around, n_along) = (3 + numbers.below(60), 3 + numbers.below(60));
    let point = |i: usize, k: usize| {
        let (s, c) = (TAU * i as f64 / n_around as f64).sin_cos();
        if is_ball {
            let (sin, cos) = (TAU / 2.0 * k as f64 / n_along as f64).sin_cos();
            return DVec3::new(sin * c, cos, sin * s);
        }
        let (sin, cos) = (TAU * k as f64 / n_along as f64).sin_cos();
        DVec3::new((2.0 + cos) * c, sin, (2.0 + cos) * s)
    };
    let mut positions: Vec<Vec3> = Vec::new();
    let mut index = |p: DVec3| {
        positions.push(p.as_vec3() * scale + middle);
        positions.len() as u32 - 1
    };
    let poles = [index(point(0, 0)), index(point(0, n_along))];
    let grid: Vec<Vec<u32>> =
        (0..n_along).map(|k| (0..n_around).map(|i| index(point(i, k))).collect()).collect();
    let at = |i: usize, k: usize| match k {
        0 if is_ball => poles[0],
        k if k == n_along && is_ball => poles[1],
        k => grid[k % n_along][i % n_around],
    };
    let mut triangles = Vec::new();
    for k in 0..n_along {
        for i in 0..n_around {
            let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
            triangles.extend(
                [[a, b, c], [a, c, d]].into_iter().filter(|[x, y, z]| x != y && y != z && z != x),
            );
        }
    }
    // Inside whatever the number of sides: a triangle's inner circle has half its radius.
    let inside = move |numbers: &mut Numbers| {
        let offset = numbers.direction() * (0.2 * numbers.next());
        let p = if is_ball { offset } else { DVec3::new(0.0, 0.0, 0.0) + offset * 0.5 };
        let ring = (TAU / n_around as f64) * numbers.below(n_around) as f64;
        let on_ring = DVec3::new(2.0 * ring.cos(), 0.0, 2.0 * ring.sin());
        let p = if is_ball { p } else { p + on_ring };
        p.as_vec3() * scale + middle
    };
    let corners: Vec<Vec3> = triangles.iter().flatten().map(|id| positions[*id as usize]).collect();
    (Mesh { positions, triangles, ..Mesh::default() }, corners, scale, Box::new(inside))
}

struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (s, c) = (TAU * self.next()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * c, r * s, z)
    }
}

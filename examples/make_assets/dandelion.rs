//! A dandelion clock: what an aliased picture cannot show.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, dvec3};

use crate::hash::unit;
use crate::mesh::Mesh;

const N_SEEDS: u32 = 170;
const N_HAIRS: u32 = 10;
/// Middle of the clock above the ground.
const HEAD: DVec3 = dvec3(0.0, 2.6, 0.0);

/// The flower on a bent stem that stands on y = 0, 3.7 high.
pub(crate) fn dandelion() -> Mesh {
    let mut mesh = Mesh::new(4);
    add_stem(&mut mesh);
    add_core(&mut mesh);
    for seed in 0..N_SEEDS {
        add_seed(&mut mesh, seed);
    }
    mesh.closed()
}

/// A stalk with its umbrella of hairs, at an even place on the sphere.
fn add_seed(mesh: &mut Mesh, seed: u32) {
    // Even points on a sphere: equal steps in height, golden angle in turn.
    let height = 1.0 - 2.0 * (f64::from(seed) + 0.5) / f64::from(N_SEEDS);
    let turn = f64::from(seed) * PI * (3.0 - 5_f64.sqrt());
    let reach = (1.0 - height * height).sqrt();
    let out = dvec3(reach * libm::cos(turn), height, reach * libm::sin(turn));
    let length = 0.86 + 0.05 * unit(seed);
    let (foot, top) = (HEAD + 0.14 * out, HEAD + length * out);
    add_spike(mesh, HEAD + 0.34 * out, foot, 0.022);
    add_spike(mesh, foot, top, 0.007);
    let (x, y) = across(out);
    for hair in 0..N_HAIRS {
        let angle = TAU * (f64::from(hair) + unit(seed * 31 + hair)) / f64::from(N_HAIRS);
        let side = libm::cos(angle) * x + libm::sin(angle) * y;
        let rise = 0.1 + 0.1 * unit(seed * 57 + hair);
        let span = 0.2 + 0.04 * unit(seed * 91 + hair);
        add_spike(mesh, top, top + span * side + rise * out, 0.0055);
    }
}

/// A three-sided spike from its wide end to its tip.
fn add_spike(mesh: &mut Mesh, wide: DVec3, tip: DVec3, radius: f64) {
    let (x, y) = across((tip - wide).normalize());
    let base = [0.0, 1.0, 2.0].map(|third| {
        let angle = TAU * third / 3.0;
        mesh.point(wide + radius * (libm::cos(angle) * x + libm::sin(angle) * y))
    });
    let tip = mesh.point(tip);
    for i in 0..3 {
        mesh.face(&[base[i], base[(i + 1) % 3], tip]);
    }
    mesh.face(&[base[2], base[1], base[0]]);
}

fn add_stem(mesh: &mut Mesh) {
    let (n_along, n_around) = (20, 10);
    let mut rows: Vec<Vec<u32>> = vec![vec![mesh.point(dvec3(0.32, 0.0, 0.0))]];
    for i in 0..=n_along {
        let t = f64::from(i) / f64::from(n_along);
        let middle = dvec3(0.32 * (1.0 - t) * (1.0 - t), HEAD.y * t, 0.0);
        let radius = 0.05 - 0.012 * t;
        let row = (0..n_around).map(|j| {
            let angle = TAU * f64::from(j) / f64::from(n_around);
            mesh.point(middle + radius * dvec3(libm::sin(angle), 0.0, libm::cos(angle)))
        });
        rows.push(row.collect());
    }
    rows.push(vec![mesh.point(HEAD)]);
    mesh.skin(&rows, true);
}

fn add_core(mesh: &mut Mesh) {
    let (n_up, n_around) = (10, 16);
    let mut rows: Vec<Vec<u32>> = vec![];
    for i in 0..=n_up {
        let angle = PI * f64::from(i) / f64::from(n_up);
        let n = if i == 0 || i == n_up { 1 } else { n_around };
        let row = (0..n).map(|j| {
            let turn = TAU * f64::from(j) / f64::from(n_around);
            let ring = libm::sin(angle);
            let out = dvec3(ring * libm::sin(turn), -libm::cos(angle), ring * libm::cos(turn));
            mesh.point(HEAD + 0.15 * out)
        });
        rows.push(row.collect());
    }
    mesh.skin(&rows, true);
}

/// Two directions that make a right-handed frame with a third.
fn across(along: DVec3) -> (DVec3, DVec3) {
    let other = if along.y.abs() < 0.9 { DVec3::Y } else { DVec3::X };
    let x = other.cross(along).normalize();
    (x, along.cross(x))
}

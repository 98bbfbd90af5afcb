//! A wentletrap: a sea shell coiled like a winding stair, with thin ribs around its whorls.

use std::f64::consts::TAU;

use glam::{DVec3, dvec3};

use crate::mesh::Mesh;

/// Whorls from the tip to the mouth.
const N_WHORLS: u32 = 7;
/// Ribs around one whorl.
const N_RIBS: u32 = 12;
/// Points around the tube.
const N_AROUND: u32 = 26;
/// By what factor everything grows from whorl to whorl.
const GROWTH: f64 = 1.47;
/// Radius of the tube, in distances of its middle from the axis.
const TUBE: f64 = 0.95;
/// Fall of the tube's middle below the tip, likewise.
const FALL: f64 = 4.55;
/// Where rings of points stand between two ribs, as shares of the way: dense at the rib.
const STATIONS: [f64; 8] = [-0.36, -0.2, -0.1, -0.045, 0.0, 0.045, 0.1, 0.2];

/// The shell on its side on y = 0, 1.5 long, its tip to the right and its mouth to the front.
pub(crate) fn wentletrap() -> Mesh {
    let mut mesh = Mesh::new(4);
    let n_ribs = N_WHORLS * N_RIBS;
    let mut rows: Vec<Vec<u32>> = vec![vec![mesh.point(tube(0.0, 0.0, 0.0))]];
    for rib in 1..=n_ribs {
        for station in STATIONS {
            if rib == n_ribs && 0.05 < station {
                break;
            }
            // The lip is a rib too, the strongest.
            let strength = if rib == n_ribs { 1.3 } else { 1.0 };
            let swell = 1.0 + 0.15 * strength * ridge(station);
            rows.push(ring(&mut mesh, f64::from(rib) + station, swell));
        }
    }
    // From the lip back inside, so that the mouth is a hollow.
    for (back, swell) in [(0.0, 1.05), (0.15, 0.9), (0.8, 0.84), (2.0, 0.8), (3.5, 0.72)] {
        rows.push(ring(&mut mesh, f64::from(n_ribs) - back, swell));
    }
    rows.push(vec![mesh.point(tube(f64::from(n_ribs) - 4.5, 0.0, 0.0))]);
    mesh.skin(&rows, true);
    mesh.closed().map(laid_down).stand_centred()
}

fn ring(mesh: &mut Mesh, rib: f64, swell: f64) -> Vec<u32> {
    (0..N_AROUND)
        .map(|i| mesh.point(tube(rib, TAU * f64::from(i) / f64::from(N_AROUND), swell)))
        .collect()
}

/// Height of a rib across its own width: a thin blade on a gentle swelling.
fn ridge(station: f64) -> f64 {
    let blade = station / 0.05;
    let foot = station / 0.2;
    0.75 / (1.0 + blade * blade * blade * blade) + 0.25 * libm::exp(-foot * foot)
}

/// A point of the tube: how far along it, counted in ribs, the angle about its middle, and the
/// factor of its radius. The shell's axis is y, its tip up.
fn tube(rib: f64, around: f64, swell: f64) -> DVec3 {
    let whorl = rib / f64::from(N_RIBS);
    let size = libm::pow(GROWTH, whorl - f64::from(N_WHORLS));
    // Ribs lean: the upper edge of each lags behind.
    let turn = TAU * whorl - 0.16 * libm::sin(around);
    let outwards = dvec3(libm::cos(turn), 0.0, libm::sin(turn));
    let (out, up) = (libm::cos(around), libm::sin(around));
    let bulge = TUBE * swell * (1.0 + 0.06 * out);
    size * ((1.0 + bulge * out) * outwards + (0.97 * bulge * up - FALL) * DVec3::Y)
}

/// Turns the axis to lie along x with the cone's flank on the ground, and the mouth to the front.
fn laid_down(p: DVec3) -> DVec3 {
    let roll = 0.1;
    let (s, c) = (libm::sin(roll), libm::cos(roll));
    let rolled = dvec3(c * p.x + s * p.z, p.y, -s * p.x + c * p.z);
    let lying = dvec3(rolled.y, -rolled.x, rolled.z);
    let flank = libm::atan2(1.0 + TUBE, FALL + 0.35);
    let (s, c) = (libm::sin(flank), libm::cos(flank));
    0.268 * dvec3(c * lying.x + s * lying.y, -s * lying.x + c * lying.y, lying.z)
}

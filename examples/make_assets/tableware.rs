//! What comes from the lathe: things for a table, and a chess pawn.

use std::f64::consts::PI;

use glam::dvec3;

use crate::lathe::Outline;
use crate::mesh::Mesh;

/// An egg 0.45 wide and 0.6 high. Its half width is that of an ellipse, narrowed towards the top.
pub(crate) fn egg() -> Mesh {
    let n = 32;
    let mut outline = Outline::from(0.0, 0.0);
    for i in 1..=n {
        let angle = PI * f64::from(i) / f64::from(n);
        let height = -libm::cos(angle);
        let radius = if i == n { 0.0 } else { libm::sin(angle) * (1.0 - 0.17 * height) };
        outline = outline.line(0.222 * radius, 0.3 * (1.0 + height));
    }
    outline.turn(56)
}

/// A bowl 1.9 wide and 0.72 high, its wall 0.03 thick, on a small foot.
pub(crate) fn bowl() -> Mesh {
    Outline::from(0.0, 0.035)
        .line(0.3, 0.03)
        .curve([0.32, 0.02], [0.32, 0.0], [0.34, 0.0], 3)
        .curve([0.38, 0.0], [0.38, 0.03], [0.39, 0.06], 4)
        .curve([0.66, 0.11], [0.88, 0.36], [0.945, 0.7], 18)
        .curve([0.95, 0.725], [0.92, 0.73], [0.912, 0.702], 5)
        .curve([0.85, 0.39], [0.64, 0.15], [0.38, 0.1], 18)
        .curve([0.26, 0.08], [0.12, 0.075], [0.0, 0.075], 8)
        .turn(64)
}

/// A plate 2.4 wide with a flat rim.
pub(crate) fn plate() -> Mesh {
    Outline::from(0.0, 0.04)
        .line(0.66, 0.04)
        .curve([0.68, 0.0], [0.72, 0.0], [0.74, 0.04], 5)
        .curve([0.86, 0.06], [0.96, 0.1], [1.17, 0.15], 8)
        .curve([1.205, 0.158], [1.205, 0.185], [1.17, 0.18], 5)
        .curve([0.98, 0.13], [0.88, 0.12], [0.8, 0.085], 8)
        .curve([0.74, 0.06], [0.68, 0.06], [0.62, 0.06], 5)
        .line(0.3, 0.06)
        .line(0.0, 0.06)
        .turn(64)
}

/// A candlestick 0.85 high with a socket of radius 0.13 whose floor is at 0.72.
pub(crate) fn candlestick() -> Mesh {
    Outline::from(0.0, 0.0)
        .line(0.44, 0.0)
        .curve([0.48, 0.0], [0.48, 0.05], [0.44, 0.05], 6)
        .curve([0.36, 0.06], [0.34, 0.07], [0.32, 0.1], 5)
        .curve([0.26, 0.15], [0.08, 0.14], [0.07, 0.25], 10)
        .curve([0.07, 0.29], [0.14, 0.28], [0.14, 0.33], 7)
        .curve([0.14, 0.38], [0.07, 0.37], [0.065, 0.42], 7)
        .curve([0.06, 0.52], [0.08, 0.56], [0.1, 0.6], 7)
        .curve([0.13, 0.62], [0.26, 0.6], [0.28, 0.64], 7)
        .curve([0.29, 0.665], [0.27, 0.67], [0.25, 0.665], 4)
        .curve([0.21, 0.655], [0.17, 0.66], [0.165, 0.7], 5)
        .line(0.165, 0.82)
        .curve([0.165, 0.85], [0.13, 0.85], [0.13, 0.82], 5)
        .line(0.13, 0.72)
        .line(0.0, 0.72)
        .turn(48)
}

/// A candle of radius 0.125 and height 1, its top melted to a hollow with a soft rim.
pub(crate) fn candle() -> Mesh {
    let melted = Outline::from(0.0, 0.0)
        .line(0.125, 0.0)
        .line(0.125, 0.5)
        .line(0.123, 0.93)
        .curve([0.123, 1.0], [0.11, 1.0], [0.095, 0.985], 6)
        .curve([0.075, 0.955], [0.04, 0.945], [0.0, 0.945], 6)
        .turn(40);
    melted.map(|p| {
        let droop = if 0.9 < p.y { 0.12 * (p.x - 0.3 * p.z) } else { 0.0 };
        dvec3(p.x, p.y + droop, p.z)
    })
}

/// A flame 0.26 high that stands on y = 0.
pub(crate) fn flame() -> Mesh {
    Outline::from(0.0, 0.0)
        .curve([0.05, 0.0], [0.066, 0.045], [0.055, 0.085], 8)
        .curve([0.044, 0.13], [0.016, 0.18], [0.0, 0.26], 10)
        .turn(24)
}

/// A chess pawn 1.02 high on a foot of radius 0.34.
pub(crate) fn pawn() -> Mesh {
    let mut outline = Outline::from(0.0, 0.0)
        .line(0.32, 0.0)
        .curve([0.35, 0.0], [0.35, 0.09], [0.32, 0.09], 7)
        .curve([0.29, 0.1], [0.3, 0.13], [0.27, 0.15], 6)
        .curve([0.2, 0.2], [0.1, 0.3], [0.1, 0.58], 14)
        .curve([0.15, 0.58], [0.21, 0.59], [0.21, 0.615], 5)
        .curve([0.21, 0.64], [0.15, 0.65], [0.115, 0.66], 5);
    let (radius, middle, n) = (0.195, 0.825, 20);
    let start = libm::acos(-0.115 / radius) - PI / 2.0;
    let start = -(PI / 2.0 - start);
    for i in 1..=n {
        let angle = start + (PI / 2.0 - start) * f64::from(i) / f64::from(n);
        let r = if i == n { 0.0 } else { radius * libm::cos(angle) };
        outline = outline.line(r, middle + radius * libm::sin(angle));
    }
    outline.turn(56)
}

/// An urn 2.1 high on a round foot, with its lid.
pub(crate) fn urn() -> Mesh {
    Outline::from(0.0, 0.0)
        .line(0.4, 0.0)
        .line(0.42, 0.02)
        .line(0.42, 0.1)
        .line(0.4, 0.12)
        .curve([0.3, 0.13], [0.12, 0.2], [0.12, 0.32], 10)
        .curve([0.2, 0.32], [0.2, 0.4], [0.13, 0.4], 7)
        .curve([0.4, 0.44], [0.68, 0.75], [0.68, 1.12], 18)
        .curve([0.68, 1.4], [0.42, 1.42], [0.4, 1.56], 12)
        .curve([0.4, 1.6], [0.52, 1.59], [0.53, 1.62], 5)
        .curve([0.54, 1.66], [0.48, 1.67], [0.45, 1.67], 4)
        .curve([0.42, 1.8], [0.14, 1.78], [0.08, 1.86], 10)
        .curve([0.07, 1.89], [0.13, 1.9], [0.13, 1.97], 6)
        .curve([0.13, 2.04], [0.07, 2.1], [0.0, 2.1], 8)
        .turn(60)
}

/// A ring about the z axis, of inner radius 1 and outer radius 1.16: a frame for a round mirror.
pub(crate) fn ring() -> Mesh {
    let outline = Outline::from(1.0, 0.0)
        .line(1.0, -0.05)
        .line(1.13, -0.05)
        .curve([1.17, -0.05], [1.17, 0.04], [1.12, 0.05], 6)
        .curve([1.1, 0.03], [1.08, 0.03], [1.07, 0.06], 5)
        .curve([1.05, 0.09], [1.0, 0.06], [1.0, 0.0], 6);
    outline.turn(72).map(|p| dvec3(p.x, -p.z, p.y))
}

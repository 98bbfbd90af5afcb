//! Solids with flat faces: cube, pyramid, bevelled blocks, a book, a window frame.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, dvec2, dvec3};

use crate::mesh::Mesh;

/// A cube from -1 to 1 with eight shared vertices, so that it can be shaded flat or smooth.
pub(crate) fn cube() -> Mesh {
    let mut mesh = Mesh::new(4);
    for i in 0..8 {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        mesh.point(dvec3(sign(0), sign(1), sign(2)));
    }
    for face in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
    {
        mesh.face(&face);
    }
    mesh.closed()
}

/// A pyramid of height 1.27 on a square of side 2, with the slope of the one at Giza.
pub(crate) fn pyramid() -> Mesh {
    let mut mesh = Mesh::new(4);
    for (x, z) in [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        mesh.point(dvec3(x, 0.0, z));
    }
    mesh.point(dvec3(0.0, 1.27, 0.0));
    for i in 0..4 {
        mesh.face(&[i, (i + 1) % 4, 4]);
    }
    mesh.face(&[3, 2, 1, 0]);
    mesh.closed()
}

/// A block 0.5 x 1 x 0.5 with bevels, about the origin: wood's rings run about y.
pub(crate) fn block() -> Mesh {
    bevelled(dvec3(-0.25, -0.5, -0.25), dvec3(0.25, 0.5, 0.25), 0.025, 3).closed()
}

/// A window frame 8 wide and 10 high, its face at z = 0: six panes of two columns and three rows,
/// a sill before it.
pub(crate) fn window() -> Mesh {
    let mut mesh = Mesh::new(3);
    let mut bar = |low: [f64; 3], high: [f64; 3]| {
        mesh.append(&bevelled(low.into(), high.into(), 0.045, 2));
    };
    bar([-4.4, -0.4, -0.6], [-3.9, 10.4, 0.15]);
    bar([3.9, -0.4, -0.6], [4.4, 10.4, 0.15]);
    bar([-4.0, 9.9, -0.6], [4.0, 10.4, 0.15]);
    bar([-4.0, -0.4, -0.6], [4.0, 0.1, 0.15]);
    bar([-4.7, -0.65, -0.55], [4.7, -0.35, 0.9]);
    bar([-0.16, 0.0, -0.35], [0.16, 10.0, 0.0]);
    for height in [3.33, 6.67] {
        bar([-4.0, height - 0.12, -0.33], [4.0, height + 0.12, -0.04]);
    }
    for side in [-1.0, 1.0] {
        let (a, b) = (side * 3.75, side * 4.0);
        bar([f64::min(a, b), 0.0, -0.4], [f64::max(a, b), 10.0, 0.02]);
    }
    mesh.closed()
}

/// Two boards and a round spine, for the pages below: 1.5 wide, 0.32 high, 2.2 deep. The spine is
/// towards -x.
pub(crate) fn book_cover() -> Mesh {
    let (thick, high, right) = (0.035, 0.32, 0.75);
    let mut outer = vec![dvec2(right, 0.0)];
    let mut inner = vec![dvec2(right, thick)];
    for i in 0..=12 {
        let angle = -PI / 2.0 - PI * f64::from(i) / 12.0;
        let around = dvec2(0.45 * libm::cos(angle), libm::sin(angle));
        let middle = dvec2(-0.72, 0.5 * high);
        outer.push(middle + 0.5 * high * around);
        inner.push(middle + (0.5 * high - thick) * around);
    }
    outer.push(dvec2(right, high));
    inner.push(dvec2(right, high - thick));
    band(&inner, &outer, 1.1).closed()
}

/// The pages: their fore edge is hollow.
pub(crate) fn book_pages() -> Mesh {
    let (low, high) = (0.036, 0.284);
    let mut left = vec![];
    let mut right = vec![];
    for i in 0..=8 {
        let t = f64::from(i) / 8.0;
        let y = low + (high - low) * t;
        let bow = 1.0 - (2.0 * t - 1.0) * (2.0 * t - 1.0);
        right.push(dvec2(0.71 - 0.04 * bow, y));
        left.push(dvec2(-0.72 - 0.05 * bow, y));
    }
    band(&right, &left, 1.06).closed()
}

/// A band between two lines of the xy plane, extruded along z from `-half` to `half`. Seen from
/// +z, `outer` has `inner` on its left.
fn band(outer: &[DVec2], inner: &[DVec2], half: f64) -> Mesh {
    let mut mesh = Mesh::new(4);
    let loop_points: Vec<DVec2> = outer.iter().chain(inner.iter().rev()).copied().collect();
    let n = loop_points.len() as u32;
    for z in [half, -half] {
        for p in &loop_points {
            mesh.point(p.extend(z));
        }
    }
    for i in 0..n {
        let next = (i + 1) % n;
        mesh.face(&[i, i + n, next + n, next]);
    }
    for i in 0..outer.len() as u32 - 1 {
        let quad = [i, i + 1, n - 2 - i, n - 1 - i];
        mesh.face(&quad);
        mesh.face(&[quad[3] + n, quad[2] + n, quad[1] + n, quad[0] + n]);
    }
    mesh
}

/// A box whose edges are rounded with a radius in `n` steps: a cube's grid pushed outwards.
fn bevelled(low: DVec3, high: DVec3, radius: f64, n: u32) -> Mesh {
    let mut mesh = Mesh::new(4);
    let (core_low, core_high) = (low + radius, high - radius);
    // Along each axis: n + 1 angles of one rounded edge, then those of the other.
    let side = 2 * (n + 1);
    let coordinate = |i: u32| {
        let step = if i <= n { i } else { i - n - 1 };
        let angle = PI / 4.0 * (f64::from(step) / f64::from(n) - if i <= n { 1.0 } else { 0.0 });
        libm::tan(angle)
    };
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let rows: Vec<Vec<u32>> = (0..side)
                .map(|j| {
                    (0..side)
                        .map(|i| {
                            let (a, b) =
                                (if sign < 0.0 { j } else { i }, if sign < 0.0 { i } else { j });
                            let mut direction = DVec3::ZERO;
                            let mut corner = core_low;
                            direction[axis] = sign;
                            for (k, index) in [((axis + 1) % 3, a), ((axis + 2) % 3, b)] {
                                direction[k] = coordinate(index);
                                corner[k] = if index <= n { core_low[k] } else { core_high[k] };
                            }
                            corner[axis] =
                                if sign < 0.0 { core_low[axis] } else { core_high[axis] };
                            mesh.point(corner + radius * direction.normalize())
                        })
                        .collect()
                })
                .collect();
            mesh.skin(&rows, false);
        }
    }
    mesh.weld()
}

//! How cost grows with the number of triangles: a mesh of any size, a table and a plot.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use glam::{DVec3, Vec3};
use penumbra::geometry::AcceleratorKind;
use penumbra::geometry::mesh::Mesh;
use penumbra::math::portable::{cos_f64, sin_f64};

use crate::Row;
use crate::plot::{Panel, draw};

/// A (2, 3) torus knot with a rippled tube, of about that many triangles.
pub(crate) fn knot(n_triangles: u32) -> Mesh {
    // Twelve times as long as it is around, so that quads are about square.
    let around = (f64::from(n_triangles) / 2.0 / 12.0).sqrt().round().max(3.0) as u32;
    let along = n_triangles / 2 / around;
    let mut mesh = Mesh::default();
    let axis = |s: f64| {
        let radius = 2.0 + cos_f64(3.0 * s);
        DVec3::new(radius * cos_f64(2.0 * s), sin_f64(3.0 * s), radius * sin_f64(2.0 * s))
    };
    for i in 0..along {
        let s = TAU * f64::from(i) / f64::from(along);
        let forward = (axis(s + 1e-4) - axis(s - 1e-4)).normalize();
        let side = forward.cross(DVec3::Y).normalize();
        let up = side.cross(forward);
        for j in 0..around {
            let t = TAU * f64::from(j) / f64::from(around);
            let radius = 0.4 + 0.03 * sin_f64(9.0 * t) * cos_f64(40.0 * s);
            let p: DVec3 = axis(s) + radius * (side * cos_f64(t) + up * sin_f64(t));
            mesh.positions.push(Vec3::new(p.x as f32, p.y as f32, p.z as f32));
            let at = |i: u32, j: u32| (i % along) * around + j % around;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

const KINDS: [AcceleratorKind; 3] =
    [AcceleratorKind::WideBvh, AcceleratorKind::KdTree, AcceleratorKind::KdMidpoint];
const SETS: [&str; 4] = ["primary", "shadow", "shadow_block", "bounce"];

/// Writes `scaling.md`, of all threads, and `scaling.svg`, of the first number of threads.
pub(crate) fn write(rows: &[Row], directory: &Path) -> std::io::Result<()> {
    let mut table = String::from(
        "# How cost grows\n\n\
         Millions of rays a second, milliseconds of a build and megabytes of a tree on a torus knot, \
         whose triangles are made by the bench:\n\n\
         ```sh\ncargo bench --bench trace -- --scaling --report docs\n```\n\n\
         ![Plots of the table](scaling.svg)\n\n\
         | triangles | threads | tree | primary | shadow | shadow_block | bounce | build | memory |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for of_tree in rows.chunks(SETS.len()) {
        let Row { n_triangles, n_threads, accelerator, build_ms, n_bytes, .. } = of_tree[0];
        let _ = write!(table, "| {n_triangles} | {n_threads} | {} |", accelerator.name());
        for row in of_tree {
            let _ = write!(table, " {:.2} |", row.mrays_per_s);
        }
        let _ = writeln!(table, " {build_ms:.1} | {:.2} |", n_bytes as f64 * 1e-6);
    }
    let n_threads = rows.first().map_or(0, |row| row.n_threads);
    let curves = |set: &str, y: fn(&Row) -> f64| {
        KINDS.map(|kind| {
            let of_curve = |row: &&Row| {
                row.accelerator == kind && row.set == set && row.n_threads == n_threads
            };
            let point = |row: &Row| [row.n_triangles as f64, y(row)];
            rows.iter().filter(of_curve).map(point).collect()
        })
    };
    let mut panels: Vec<Panel> = SETS
        .iter()
        .map(|set| Panel { title: set, curves: curves(set, |row| row.mrays_per_s) })
        .collect();
    let first = SETS[0];
    panels.push(Panel { title: "build, ms", curves: curves(first, |row| row.build_ms) });
    let megabytes = curves(first, |row| row.n_bytes as f64 * 1e-6);
    panels.push(Panel { title: "tree, MB", curves: megabytes });
    let labels = KINDS.map(AcceleratorKind::name);
    let caption = "millions of rays a second, and cost of the tree, against triangles";
    std::fs::write(directory.join("scaling.md"), table)?;
    std::fs::write(directory.join("scaling.svg"), draw(&panels, labels, caption))
}

//! Light of objects that glow and of the sky, in "path": closed forms, and what stops it.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use penumbra::geometry::AcceleratorKind;
use penumbra::geometry::mesh::Mesh;
use penumbra::scene::image::Image;

use crate::common::{
    Files, Look, MakeMesh, WHITE_FLOOR, assert_close, film, job, job_with, lambert_polygon, mean,
};

const ONE_EVENT: &str = "integrator = 'path'\nmax_depth = 1";
const GLOW: &str = "[[materials]]\nname = 'glow'\nemission = [3, 2, 1]\n";
/// Looks at the origin of the floor from the side.
const ASIDE: [f64; 3] = [-0.3, 0.001, 0.2];

fn sheet() -> Mesh {
    let corner = |x, z| glam::Vec3::new(x, 0.0, z);
    let positions = vec![corner(-1., -0.5), corner(1., -0.5), corner(1., 0.5), corner(-1., 0.5)];
    Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}

/// The same in a thousand slivers, 500 times as long as they are wide.
fn slivers() -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..500_u16 {
        let [left, right] = [i, i + 1].map(|k| f32::from(k) / 250.0 - 1.0);
        let first = mesh.positions.len() as u32;
        let corner = |x, z| glam::Vec3::new(x, 0.0, z);
        mesh.positions.extend([corner(left, -0.5), corner(right, -0.5)]);
        mesh.positions.extend([corner(right, 0.5), corner(left, 0.5)]);
        mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|k| first + k)));
    }
    mesh
}

fn radiance(look: &Look, body: &str) -> DVec3 {
    let meshes: Vec<(_, MakeMesh)> = vec![("sheet", sheet), ("slivers", slivers)];
    let files = Files { meshes, ..Files::default() };
    mean(&film(&job_with(&look.text(body), files, AcceleratorKind::WideBvh), look.samples))
}

/// Faces of a box that face the origin, by Lambert's formula; so few samples would leave scattered
/// rays alone some percent away.
#[test]
fn a_glowing_box_lights_by_the_faces_it_shows() {
    let look = Look::at(ASIDE, [0.0; 3]).with(ONE_EVENT).samples(1024);
    for (low, high) in [
        (DVec3::new(1.0, 0.5, -0.2), DVec3::new(1.3, 2.0, 0.4)),
        (DVec3::new(-0.5, 1.5, -0.5), DVec3::new(0.7, 1.52, 0.5)),
        (DVec3::new(9.0, 4.0, 5.0), DVec3::new(9.1, 4.2, 5.3)),
    ] {
        let mut expected = 0.0;
        for axis in 0..3 {
            for (side, plane) in [(-1.0, low[axis]), (1.0, high[axis])] {
                if plane * side >= 0.0 {
                    continue;
                }
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |a: f64, b: f64| {
                    let mut p = DVec3::ZERO;
                    (p[axis], p[i], p[j]) = (plane, a, b);
                    p
                };
                let corners = [
                    corner(low[i], low[j]),
                    corner(high[i], low[j]),
                    corner(high[i], high[j]),
                    corner(low[i], high[j]),
                ];
                expected += lambert_polygon(DVec3::ZERO, DVec3::Y, &corners);
            }
        }
        let body = format!(
            "{WHITE_FLOOR}{GLOW}[[objects]]\ntype = 'box'\nmin = {:?}\nmax = {:?}\n\
             material = 'glow'\n",
            low.to_array(),
            high.to_array()
        );
        let found = radiance(&look, &body) * PI;
        for (found, emission) in found.to_array().into_iter().zip([3.0, 2.0, 1.0]) {
            assert_close(found, emission * expected, 6e-3, &format!("box from {low} to {high}"));
        }
    }
}

/// A mesh glows on both sides, however it is placed and cut.
#[test]
fn a_glowing_sheet_lights_on_both_sides() {
    let look = Look::at(ASIDE, [0.0; 3]).with(ONE_EVENT).samples(1024);
    for (turn, y, file) in [
        (0.0, 1.0, "sheet"),
        (180.0, 1.0, "sheet"),
        (0.0, 6.0, "sheet"),
        (180.0, 0.3, "sheet"),
        (0.0, 1.0, "slivers"),
        (180.0, 0.3, "slivers"),
    ] {
        let half = DVec3::new(0.8, 0.0, 1.5);
        let corner = |sx: f64, sz: f64| DVec3::new(0.4 + half.x * sx, y, half.z * sz);
        let corners = [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
        let expected = lambert_polygon(DVec3::ZERO, DVec3::Y, &corners);
        let body = format!(
            "{WHITE_FLOOR}{GLOW}[[objects]]\ntype = 'mesh'\nfile = '{file}'\nmaterial = 'glow'\n\
             scale = [0.8, 1, 3]\nrotate = [{turn}, 0, 0]\ntranslate = [0.4, {y}, 0]\n"
        );
        let found = radiance(&look, &body).x * PI;
        assert_close(
            found,
            3.0 * expected,
            6e-3,
            &format!("{file} turned by {turn} at height {y}"),
        );
        let none = radiance(&look.clone().with("integrator = 'path'\nmax_depth = 0"), &body);
        assert_eq!(none, DVec3::ZERO, "it takes an event");
    }
}

/// A sky with one bright spot: the irradiance, by quadrature of the texture itself.
#[test]
fn a_bright_spot_in_the_sky_is_found() {
    let image = || {
        let mut texels = vec![[0.05, 0.1, 0.2]; 64 * 32];
        texels[9 * 64 + 20] = [200.0, 180.0, 100.0];
        texels[2 * 64 + 50] = [100.0, 100.0, 100.0];
        Image { width: 64, height: 32, texels }
    };
    let sky = "[environment]\nbackground = 'sky'\n[[textures]]\nname = 'sky'\ntype = 'image'\n\
               file = 'sky'\n";
    let n = 1200;
    let mut expected = DVec3::ZERO;
    let texture = image();
    for i in 0..n {
        // Uniform in the squared sine: the cosine's own measure.
        let sin2 = (f64::from(i) + 0.5) / f64::from(n);
        let (across, up) = (sin2.sqrt(), (1.0 - sin2).sqrt());
        for j in 0..n {
            let phi = TAU * (f64::from(j) + 0.5) / f64::from(n);
            let d = DVec3::new(across * phi.cos(), up, across * phi.sin());
            let uv = glam::DVec2::new(0.5 + d.x.atan2(-d.z) / TAU, 0.5 + d.y.asin() / PI);
            expected += texture.lookup(uv).as_dvec3() / f64::from(n * n);
        }
    }
    for (diffuse, samples) in [("[1, 1, 1]", 1024), ("[0.5, 0.5, 0.5]", 1024)] {
        let body = format!("{sky}{}", WHITE_FLOOR.replace("[1, 1, 1]", diffuse));
        let look = Look::at(ASIDE, [0.0; 3]).with(ONE_EVENT).samples(samples);
        let files = Files { images: vec![("sky", image())], ..Files::default() };
        let job = job_with(&look.text(&body), files, AcceleratorKind::WideBvh);
        let found = mean(&film(&job, samples));
        let albedo = if diffuse == "[1, 1, 1]" { 1.0 } else { 0.5 };
        for channel in 0..3 {
            assert_close(found[channel], albedo * expected[channel], 4e-3, "the sky's irradiance");
        }
    }
}

/// A ray that looks for what glows is a ray of the path: visible lights and glass stop it, invisible
/// lights do not, and behind glass it is the next event's.
#[test]
fn visible_lights_and_glass_stop_the_way_to_what_glows() {
    let ball = "[[objects]]\ntype = 'sphere'\ncenter = [0, 4, 0]\nradius = 1\nmaterial = 'glow'\n";
    let of_ball = 3.0 / 16.0;
    let disk = |visible: bool| {
        format!(
            "[[lights]]\ntype = 'disk'\nposition = [0, 2, 0]\nsize = 4\npower = [1, 1, 1]\n\
             visible = {visible}\n"
        )
    };
    // A disk of radiance 1 / (pi 4 pi) that fills sin² = 1/2.
    let of_disk = 0.5 / (4.0 * PI * PI);
    let pane = "[[materials]]\nname = 'pane'\ntransmission = [1, 1, 1]\nior = 1\n[[objects]]\n\
                type = 'plane'\npoint = [0, 1, 0]\nnormal = [0, 1, 0]\nmaterial = 'pane'\n";
    let looks = |more: &str, render: &'static str| {
        let look = Look::at(ASIDE, [0.0; 3]).with(render).samples(2048);
        radiance(&look, &format!("{WHITE_FLOOR}{GLOW}{ball}{more}")).x
    };
    assert_close(looks("", ONE_EVENT), of_ball, 3e-3, "the ball alone");
    assert_close(looks(&disk(true), ONE_EVENT), of_disk, 3e-3, "behind a visible light");
    assert_close(looks(&disk(false), ONE_EVENT), of_ball + of_disk, 3e-3, "an invisible one");
    assert_eq!(looks(pane, ONE_EVENT), 0.0, "glass stops it");
    let two = "integrator = 'path'\nmax_depth = 2";
    assert_close(looks(pane, two), of_ball, 0.04, "through glass it takes two events");
}

/// Gloss under what glows: both ways of finding it add up to the same light as a `[[lights]]` sphere.
#[test]
fn gloss_sees_a_glowing_ball_as_it_sees_a_light() {
    for alpha in [0.03, 0.2, 0.8] {
        let floor = format!(
            "[[materials]]\nname = 'm'\ndiffuse = [0.2, 0.2, 0.2]\nspecular = [0.6, 0.6, 0.6]\n\
             ward = 'duer'\nalpha_x = {alpha}\nalpha_y = {alpha}\n[[objects]]\ntype = 'plane'\n\
             point = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n"
        );
        let ball = "[[objects]]\ntype = 'sphere'\ncenter = [1, 1.2, 0.2]\nradius = 0.3\n\
                    material = 'glow'\n";
        let power: [f64; 3] = [3.0, 2.0, 1.0].map(|e| e * 4.0 * PI * PI * 0.09);
        let light = format!(
            "[[lights]]\ntype = 'sphere'\nposition = [1, 1.2, 0.2]\nsize = 0.6\npower = {power:?}\n"
        );
        let look = Look::at([-1.0, 1.1, 0.0], [0.0; 3]).with(ONE_EVENT).samples(4096);
        let glowing = radiance(&look, &format!("{floor}{GLOW}{ball}"));
        let lit = radiance(&look, &format!("{floor}{light}"));
        for channel in 0..3 {
            assert_close(glowing[channel], lit[channel], 8e-3, &format!("alpha {alpha}"));
        }
    }
}

/// Of many lights a few are asked: the mean is the sum of what each brings alone.
#[test]
fn many_lights_add_up() {
    let kinds = ["point", "sphere", "disk", "rectangle"];
    let lights: Vec<String> = (0..24)
        .map(|i| {
            let f = f64::from(i);
            let (x, y, z) =
                (3.0 * (f * 1.7).sin(), 0.6 + 1.5 * (f * 0.9).sin().abs(), 3.0 * (f * 2.3).cos());
            format!(
                "[[lights]]\ntype = '{}'\nposition = [{x}, {y}, {z}]\ntarget = [0, 0, 0]\n\
                 size = {}\npower = [{}, 2, 1]\nvisible = false\n",
                kinds[i as usize % 4],
                0.05 + 0.4 * (f * 0.7).sin().abs(),
                1.0 + f % 5.0
            )
        })
        .collect();
    for (specular, alpha) in [(0.0, 0.1), (0.4, 0.05), (0.4, 0.4)] {
        let floor = format!(
            "[[materials]]\nname = 'm'\ndiffuse = [0.5, 0.5, 0.5]\n\
             specular = [{specular}, {specular}, {specular}]\nward = 'bounded'\nalpha_x = {alpha}\n\
             alpha_y = {alpha}\n[[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\n\
             normal = [0, 1, 0]\nmaterial = 'm'\n[[objects]]\ntype = 'sphere'\n\
             center = [0.4, 0.3, 0.1]\nradius = 0.2\nmaterial = 'm'\n"
        );
        let look = |samples| Look::at([-1.5, 1.0, 0.4], [0.0; 3]).samples(samples);
        let apart: DVec3 =
            lights.iter().map(|light| radiance(&look(512), &format!("{floor}{light}"))).sum();
        let together = radiance(&look(8192), &format!("{floor}{}", lights.concat()));
        for channel in 0..3 {
            let what = format!("specular {specular} of alpha {alpha}");
            assert_close(together[channel], apart[channel], 6e-3, &what);
        }
    }
}

/// Of more lights than eight only those that may bring something are asked, each with its chance:
/// beside dark ones a light is asked every time, and every pixel is the same to the last bit as when
/// it is alone, though it is found by other ways. A wall stands close behind those that face the floor.
#[test]
fn dark_lights_change_nothing() {
    let wall = "[[objects]]\ntype = 'plane'\npoint = [1.01, 2.02, 0.505]\nnormal = [2, 4, 1]\n";
    let lights = [
        ("type = 'rectangle'\nposition = [1, 2, 0.5]\nsize = [2, 1]", wall),
        ("type = 'disk'\nposition = [1, 2, 0.5]\nsize = 1.5", wall),
        ("type = 'sphere'\nposition = [1, 2, 0.5]\nsize = 1.5", ""),
        ("type = 'sun'\nposition = [1, 2, 0.5]\nsize = 30", ""),
        ("type = 'point'\nposition = [1, 2, 0.5]", wall),
        ("type = 'disk'\nposition = [1, 2, 0.5]", wall),
    ];
    let dark = "[[lights]]\ntype = 'rectangle'\nposition = [0, 3, 0]\nsize = 1\npower = [0, 0, 0]\n\
                visible = false\n";
    for form in ["original", "duer", "bounded"] {
        for (light, wall) in lights {
            let body = format!(
                "[render]\nwidth = 12\nheight = 9\n[camera]\neye = [-1.5, 1, 0.4]\n\
                 target = [0, 0, 0]\n[[materials]]\nname = 'm'\ndiffuse = [0.5, 0.4, 0.3]\n\
                 specular = [0.3, 0.4, 0.5]\nward = '{form}'\nalpha_x = 0.1\nalpha_y = 0.3\n\
                 [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n\
                 material = 'm'\n[[objects]]\ntype = 'sphere'\ncenter = [0.2, 0.3, 0.1]\n\
                 radius = 0.3\nmaterial = 'm'\n{wall}\
                 [[lights]]\n{light}\npower = [9, 8, 7]\nvisible = false\n"
            );
            let picture = |text: &str| film(&job(text), 16).picture();
            let (alone, among) = (picture(&body), picture(&format!("{body}{}", dark.repeat(8))));
            assert!(alone == among, "{form}: {light}");
        }
    }
}

/// Where a scattered ray finds the light with about the density of a ray that looks for it, both count
/// by half: a density told wrong by some percent would show. A ball that fills half of the sky's
/// weight, and a sky that is bright in two quadrants of four.
#[test]
fn both_ways_to_the_light_share_it() {
    let look = Look::at(ASIDE, [0.0; 3]).with(ONE_EVENT).samples(8192);
    let floor = "[[materials]]\nname = 'm'\ndiffuse = [0.8, 0.8, 0.8]\n[[objects]]\ntype = 'plane'\n\
                 point = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n";
    let ball = "[[objects]]\ntype = 'sphere'\ncenter = [0, 2, 0]\nradius = 1.7320508\n\
                material = 'glow'\n";
    let found = radiance(&look, &format!("{GLOW}{floor}{ball}"));
    assert_close(found.x, 0.8 * 3.0 * 0.75, 3e-3, "a ball");
    let sky = "[environment]\nbackground = 'sky'\n[[textures]]\nname = 'sky'\ntype = 'checker'\n\
               scale = 1\ncolors = [[0, 0, 0], [2, 2, 2]]\n";
    let found = radiance(&look, &format!("{sky}{floor}"));
    assert_close(found.x, 0.8 * 2.0 * 0.5, 3e-3, "a sky");
}

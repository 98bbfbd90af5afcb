//! Glass: what it lets through, bends and mirrors, and what it does to shadow rays.

use std::f64::consts::PI;

use glam::DVec3;

use crate::common::{Files, Look, assert_close, film, icosphere, job_with, mean};
use penumbra::geometry::AcceleratorKind;

/// Reflectance of unpolarised light, by Snell and Fresnel in double precision.
fn fresnel(cos_i: f64, ior: f64) -> f64 {
    let sin_t = (1.0 - cos_i * cos_i).sqrt() / ior;
    if sin_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin_t * sin_t).sqrt();
    let s = (cos_i - ior * cos_t) / (cos_i + ior * cos_t);
    let p = (ior * cos_i - cos_t) / (ior * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

const FLOOR: &str = "[[materials]]\nname = 'white'\ndiffuse = [1, 1, 1]\n\
                     [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n\
                     material = 'white'\n\
                     [[materials]]\nname = 'glass'\ntransmission = [0.9, 0.5, 0.2]\nior = 1.7\n";
const LAMP: &str = "[[lights]]\ntype = 'point'\nposition = [0.3, 5, 0.2]\npower = [40, 40, 40]\n";

/// In "direct" each surface of glass multiplies a shadow ray by its tint, undeviated; in "path"
/// glass stops it.
#[test]
fn glass_tints_shadow_rays_in_direct_and_stops_them_in_path() {
    let glasses: [(&str, i32); 5] = [
        ("type = 'plane'\npoint = [0, 1, 0]\nnormal = [0, 1, 0]", 1),
        ("type = 'box'\nmin = [-1, 1, -1]\nmax = [1, 2, 1]", 2),
        ("type = 'sphere'\ncenter = [0, 2, 0]\nradius = 0.9", 2),
        ("type = 'mesh'\nfile = 'ball'\ntranslate = [0, 2, 0]\nscale = 1.1", 2),
        ("type = 'cone'\nbase = [0, 1, 0]\ntip = [0, 4, 0]\nradius = 1", 2),
    ];
    let radiance = |text: &str| {
        let files = Files {
            meshes: vec![("ball", || icosphere(2, 1.0, glam::Vec3::ZERO))],
            ..Files::default()
        };
        mean(&film(&job_with(text, files, AcceleratorKind::KdTree), 16))
    };
    let eye = [6.0, 0.5, 0.0];
    let bare = radiance(&Look::at(eye, [0.0; 3]).text(&format!("{FLOOR}{LAMP}")));
    for (glass, n_surfaces) in glasses {
        let body = format!("{FLOOR}{LAMP}[[objects]]\n{glass}\nmaterial = 'glass'\n");
        let direct = radiance(&Look::at(eye, [0.0; 3]).text(&body));
        let tint = DVec3::new(0.9, 0.5, 0.2).powf(f64::from(n_surfaces));
        assert!((direct / bare - tint).length() < 1e-4, "{glass}: {}", direct / bare);
        let render = "integrator = 'path'\nmax_depth = 0";
        let path = radiance(&Look::at(eye, [0.0; 3]).with(render).text(&body));
        assert_eq!(path, DVec3::ZERO, "{glass} stops shadow rays of path");
    }
    // Something opaque behind two panes is opaque.
    let body = format!(
        "{FLOOR}{LAMP}[[objects]]\ntype = 'box'\nmin = [-1, 1, -1]\nmax = [1, 2, 1]\n\
         material = 'glass'\n[[objects]]\ntype = 'sphere'\ncenter = [0.2, 3.5, 0.1]\nradius = 0.3\n\
         material = 'white'\n"
    );
    assert_eq!(radiance(&Look::at(eye, [0.0; 3]).text(&body)), DVec3::ZERO, "opaque behind glass");
}

/// A pane lets through what all its inner reflections add up to: T = (1 - F) / (1 + F).
#[test]
fn a_pane_lets_through_the_sum_of_its_inner_reflections() {
    let pane = |depth| {
        let body = "[environment]\nbackground = 'halves'\n\
                    [[textures]]\nname = 'halves'\ntype = 'checker'\nscale = 0.5\n\
                    colors = [[1, 1, 1], [0, 0, 0]]\n\
                    [[materials]]\nname = 'glass'\ntransmission = [1, 1, 1]\nior = 1.6\n\
                    [[objects]]\ntype = 'box'\nmin = [-1000, -0.1, -1000]\nmax = [1000, 0, 1000]\n\
                    material = 'glass'\n";
        // Cells have the sides 2: directions of +x +y +z are even (white); those below are odd.
        Look::at([-3.0, 5.0, -2.0], [0.1, 0.0, 0.1]).with(depth).samples(4096).radiance(body).x
    };
    let way = DVec3::new(3.1, 5.0, 2.1);
    let f = fresnel(way.normalize().y, 1.6);
    // Mirrored: up, white. Through: down, black.
    let reflected = 2.0 * f / (1.0 + f);
    assert_close(pane("max_depth = 30"), reflected, 5e-3, "all inner reflections");
    assert_close(pane("max_depth = 1"), f, 5e-3, "the first reflection alone");
    let once = f + (1.0 - f) * (1.0 - f) * f;
    assert_close(pane("max_depth = 3"), once, 5e-3, "and the first from within");
    assert_close(pane("max_depth = 30\nintegrator = 'path'"), reflected, 5e-3, "path");
}

/// Where a ray goes that enters a ball of glass off its middle: twice refracted.
#[test]
fn a_ball_of_glass_bends_rays_by_snell_whichever_way_its_scale_is_mirrored() {
    let (height, ior) = (0.6_f64, 1.5);
    let inside = (height / ior).asin();
    let deviation = 2.0 * (height.asin() - inside);
    // All in the plane x = 0: the ray comes along -z at y = 0.6 and leaves downwards.
    let out = DVec3::new(0.0, -deviation.sin(), -deviation.cos());
    // It leaves the ball at the angle that the ray has turned about the centre.
    let turn = PI - 2.0 * inside;
    let (sin, cos) = (height.asin() + turn).sin_cos();
    let exit = DVec3::new(0.0, sin, cos);
    let target = exit + 4.0 * out;
    for ball in [
        "type = 'sphere'\ncenter = [0, 0, 0]\nradius = 1",
        "type = 'sphere'\ncenter = [0, 0, 0]\nradius = 0.5\nscale = [2, -2, 2]",
        "type = 'mesh'\nfile = 'ball'\nnormals = 'smooth'",
        "type = 'mesh'\nfile = 'ball'\nnormals = 'smooth'\nscale = [-1, 1, 1]",
    ] {
        let body = format!(
            "[[materials]]\nname = 'glass'\ntransmission = [1, 1, 1]\nior = 1.5\n\
             [[materials]]\nname = 'glow'\nemission = [1, 1, 1]\n\
             [[objects]]\n{ball}\nmaterial = 'glass'\n\
             [[objects]]\ntype = 'sphere'\ncenter = {:?}\nradius = 0.1\nmaterial = 'glow'\n",
            target.to_array()
        );
        let look = Look::at([0.0, height, 6.0], [0.0, height, 0.0]).with("max_depth = 2");
        let files = Files {
            meshes: vec![("ball", || icosphere(6, 1.0, glam::Vec3::ZERO))],
            ..Files::default()
        };
        let found =
            mean(&film(&job_with(&look.text(&body), files, AcceleratorKind::KdTree), 1024)).x;
        let f = fresnel((1.0 - height * height).sqrt(), ior);
        assert_close(found, (1.0 - f) * (1.0 - f), 0.02, ball);
    }
}

/// Beyond the critical angle everything is mirrored.
#[test]
fn total_reflection_is_total() {
    // From within a box, at the side wall: sin is 0.8 of 1 / 1.5 at least.
    let body = "[environment]\nbackground = [5, 5, 5]\n\
                [[materials]]\nname = 'glass'\ntransmission = [1, 1, 1]\nior = 1.5\n\
                [[materials]]\nname = 'glow'\nemission = [1, 1, 1]\n\
                [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'glass'\n\
                [[objects]]\ntype = 'plane'\npoint = [0, -2, 0]\nnormal = [0, 1, 0]\nmaterial = 'glow'\n";
    let below = Look::at([0.0, -1.0, 0.0], [1.2, 0.0, 0.0]).radiance(body).x;
    assert_close(below, 1.0, 1e-6, "beyond the critical angle");
    let steep = Look::at([0.0, -1.0, 0.0], [0.5, 0.0, 0.0]).samples(1024).radiance(body).x;
    let f = fresnel(1.0 / 1.25_f64.sqrt(), 1.0 / 1.5);
    assert_close(steep, f + (1.0 - f) * 5.0, 3e-3, "within it");
}

/// Light comes through glass in "path" by scattered rays that meet a visible light: the floor of a
/// room lit through a window without refraction is lit as without it.
#[test]
fn path_brings_light_through_glass_by_scattered_rays() {
    let body = |glass: &str, visible: bool| {
        format!(
            "[[materials]]\nname = 'white'\ndiffuse = [1, 1, 1]\n\
             [[materials]]\nname = 'glass'\ntransmission = [0.8, 0.8, 0.8]\nior = 1\n\
             [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'white'\n\
             [[lights]]\ntype = 'disk'\nposition = [0, 1, 0]\nsize = 2\npower = [9, 9, 9]\n\
             visible = {visible}\n{glass}"
        )
    };
    let pane = "[[objects]]\ntype = 'plane'\npoint = [0, 0.5, 0]\nnormal = [0, 1, 0]\n\
                material = 'glass'\n";
    let expected = 9.0 / (PI * PI) * 0.5;
    let look = |depth| Look::at([0.4, 0.3, 0.0], [0.0; 3]).with(depth).samples(2048);
    let open = look("integrator = 'path'\nmax_depth = 0").radiance(&body("", true)).x;
    assert_close(open, expected, 3e-3, "without glass");
    let through = look("integrator = 'path'\nmax_depth = 2").radiance(&body(pane, true)).x;
    assert_close(through, 0.8 * expected, 6e-3, "through glass");
    let early = look("integrator = 'path'\nmax_depth = 1").radiance(&body(pane, true)).x;
    assert_eq!(early, 0.0, "scattering and crossing are two events");
    let unseen = look("integrator = 'path'\nmax_depth = 2").radiance(&body(pane, false)).x;
    assert_eq!(unseen, 0.0, "an invisible light is not met");
    let direct = look("").radiance(&body(pane, false)).x;
    assert_close(direct, 0.8 * expected, 3e-3, "direct tints shadow rays");
}

/// A small visible lamp stands where Snell puts it, behind a thick pane: seen through two surfaces, each
/// tinting and letting through its share; where a straight line would find it there is nothing.
#[test]
fn a_lamp_behind_a_pane_is_seen_where_it_is_bent_to() {
    let (ior, angle) = (1.5, 50.0_f64.to_radians());
    let inside = (angle.sin() / ior).asin();
    let way = DVec3::new(angle.sin(), -angle.cos(), 0.0);
    let (eye, entry) = (DVec3::Y - 2.0 * way, DVec3::Y);
    let exit = DVec3::new(inside.tan(), 0.0, 0.0);
    let straight = entry + way / angle.cos();
    let seen = |from: DVec3, render| {
        let lamp = from + 3.0 * way;
        let body = format!(
            "[[materials]]\nname = 'glass'\ntransmission = [0.9, 0.8, 0.7]\nior = {ior}\n\
             [[objects]]\ntype = 'box'\nmin = [-50, 0, -50]\nmax = [50, 1, 50]\n\
             material = 'glass'\n[[lights]]\ntype = 'sphere'\nposition = {:?}\nsize = 0.2\n\
             power = [2, 2, 2]\n",
            lamp.to_array()
        );
        Look::at(eye.to_array(), entry.to_array()).with(render).samples(4096).radiance(&body)
    };
    let through = 1.0 - fresnel(angle.cos(), ior);
    let lamp = 2.0 / (4.0 * PI * PI * 0.01);
    for render in ["", "integrator = 'path'"] {
        let found = seen(exit, render);
        for (channel, tint) in [0.9_f64, 0.8, 0.7].into_iter().enumerate() {
            let expected = lamp * tint * tint * through * through;
            assert_close(found[channel], expected, 5e-3, &format!("channel {channel}, {render}"));
        }
        assert_eq!(seen(straight, render), DVec3::ZERO, "{render}: not bent");
    }
}

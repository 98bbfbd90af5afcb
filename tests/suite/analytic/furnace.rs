//! Closed rooms and white skies: energy is kept, and depth counts what the contract says.

use std::f64::consts::PI;

use glam::DVec3;

use crate::common::{Files, Look, assert_close, film, icosphere, job_with, mean};
use penumbra::geometry::AcceleratorKind;

fn partial_sum(rho: f64, depth: u32) -> f64 {
    (0..=depth).map(|k| rho.powi(k as i32)).sum()
}

/// Looks from within at a room of albedo rho and emission e: L = e (1 + rho + … + rho^D).
#[test]
fn a_closed_room_glows_by_the_partial_sum_of_its_albedo() {
    let rooms = [
        "type = 'sphere'\ncenter = [0, 0, 0]\nradius = 2",
        "type = 'box'\nmin = [-1, -2, -1]\nmax = [1, 3, 1]",
        "type = 'mesh'\nfile = 'room'\nscale = [2, 3, -2]\nrotate = [10, 20, 30]",
        "type = 'cylinder'\nbase = [0, -2, 0]\ntop = [0, 2, 0]\nradius = 1.5",
    ];
    for room in rooms {
        for (depth, render) in [
            (0, "integrator = 'path'\nmax_depth = 0"),
            (1, "integrator = 'path'\nmax_depth = 1"),
            (3, "integrator = 'path'\nmax_depth = 3"),
            (7, "integrator = 'path'\nmax_depth = 7"),
            (40, "integrator = 'path'\nmax_depth = 40"),
        ] {
            let body = format!(
                "[[materials]]\nname = 'm'\ndiffuse = [0.8, 0.5, 0.2]\nemission = [2, 2, 2]\n\
                 [[objects]]\n{room}\nmaterial = 'm'\n"
            );
            let look = Look::at([0.2, 0.1, 0.3], [0.9, -0.8, 0.4]).with(render);
            let files = Files {
                meshes: vec![("room", || icosphere(2, 1.0, glam::Vec3::ZERO))],
                ..Files::default()
            };
            let job = job_with(&look.text(&body), files, AcceleratorKind::KdTree);
            let found = mean(&film(&job, 256));
            for (found, rho) in found.to_array().into_iter().zip([0.8, 0.5, 0.2]) {
                let expected = 2.0 * partial_sum(rho, depth);
                assert_close(found, expected, 0.012, &format!("{rho} at depth {depth} in {room}"));
            }
        }
    }
}

/// The same through mirrors: reflection, transmission and scattering each count as one event.
#[test]
fn every_kind_of_scattering_counts_once() {
    let walls = [
        ("reflection = [0.6, 0.6, 0.6]", 0.6),
        ("reflection = [0.2, 0.2, 0.2]\ndiffuse = [0.3, 0.3, 0.3]", 0.5),
        ("reflection = [0.1, 0.1, 0.1]\ntransmission = [0.7, 0.7, 0.7]\nior = 1", 0.8),
    ];
    for (keys, rho) in walls {
        for (depth, render) in [
            (0, "integrator = 'path'\nmax_depth = 0"),
            (2, "integrator = 'path'\nmax_depth = 2"),
            (12, "integrator = 'path'\nmax_depth = 12"),
        ] {
            // Glass lets rays out into the next, equal room, and the next, and the last one.
            let mut body = format!("[[materials]]\nname = 'm'\nemission = [1, 1, 1]\n{keys}\n");
            for radius in 1..=14 {
                body += &format!(
                    "[[objects]]\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = {radius}\n\
                     material = 'm'\n"
                );
            }
            let look = Look::at([0.0; 3], [0.9, -0.8, 0.4]).with(render).samples(1024);
            let expected = partial_sum(rho, depth);
            assert_close(look.radiance(&body).x, expected, 0.012, &format!("{keys}, {depth}"));
        }
    }
}

/// Two facing mirrors that glow: partial sums of a geometric series, in "direct" as well.
#[test]
fn facing_mirrors_show_each_other_max_depth_times() {
    let body = "[[materials]]\nname = 'm'\nreflection = [0.9, 0.9, 0.9]\nemission = [1, 1, 1]\n\
                [[objects]]\ntype = 'plane'\npoint = [0, 0, 1]\nnormal = [0, 0, 1]\nmaterial = 'm'\n\
                [[objects]]\ntype = 'plane'\npoint = [0, 0, -1]\nnormal = [0, 0, 1]\nmaterial = 'm'\n";
    for (depth, render) in [
        (0, "max_depth = 0"),
        (1, "max_depth = 1"),
        (3, "max_depth = 3"),
        (3, "max_depth = 3\nintegrator = 'path'"),
    ] {
        let found = Look::at([0.0; 3], [0.1, 0.2, 1.0]).with(render).radiance(body).x;
        assert_close(found, partial_sum(0.9, depth), 1e-5, render);
    }
    let deep = Look::at([0.0; 3], [0.1, 0.2, 1.0]).with("max_depth = 60").samples(8192);
    assert_close(deep.radiance(body).x, partial_sum(0.9, 60), 0.01, "60 mirrors");
}

/// What a mirror shows belongs to the next event: its emission, direct light, visible lights and
/// background count exactly if k <= max_depth.
#[test]
fn what_the_kth_ray_meets_counts_up_to_max_depth() {
    let mirror = "[[materials]]\nname = 'mirror'\nreflection = [1, 1, 1]\n\
                  [[materials]]\nname = 'lit'\ndiffuse = [1, 1, 1]\n\
                  [[objects]]\ntype = 'plane'\npoint = [0, 0, -1]\nnormal = [0, 0, 1]\n\
                  material = 'mirror'\n";
    let wall = "[[objects]]\ntype = 'plane'\npoint = [0, 0, 5]\nnormal = [0, 0, 1]\n\
                material = 'lit'\n[[lights]]\ntype = 'sun'\nposition = [0, 0, -1]\n\
                target = [0, 0, 0]\npower = [3, 3, 3]\n";
    // The sun shines through the mirror's place only if nothing is there: light the wall by a point.
    let wall =
        wall.replace("type = 'sun'\nposition = [0, 0, -1]", "type = 'point'\nposition = [0, 0, 4]");
    let at_wall = 3.0 / (4.0 * PI) / PI;
    let sky = "[environment]\nbackground = [0.7, 0.7, 0.7]\n";
    let light =
        "[[lights]]\ntype = 'sphere'\nposition = [0, 0, 4]\nsize = 0.5\npower = [1, 1, 1]\n";
    let radiance = 1.0 / (4.0 * PI * PI * 0.0625);
    for (body, expected) in [
        (format!("{mirror}{wall}"), at_wall),
        (format!("{sky}{mirror}"), 0.7),
        (format!("{mirror}{light}"), radiance),
    ] {
        let look = |render| Look::at([0.0; 3], [0.0, 0.0, -1.0]).with(render).radiance(&body).x;
        assert_eq!(look("max_depth = 0"), 0.0, "nothing at depth 0");
        assert_close(look("max_depth = 1"), expected, 1e-4, "all of it at depth 1");
        let path = look("max_depth = 1\nintegrator = 'path'");
        assert_close(path, expected, 1e-4, "the same by path");
    }
}

/// Under a white sky nothing sends back more than it receives, and white things vanish.
#[test]
fn a_white_sky_makes_white_things_vanish() {
    let sky = "[environment]\nbackground = [1, 1, 1]\n";
    let sphere = "[[objects]]\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'm'\n";
    let of = |keys: &str, target: [f64; 3]| {
        let body = format!("{sky}[[materials]]\nname = 'm'\n{keys}\n{sphere}");
        let render = "integrator = 'path'\nmax_depth = 64";
        Look::at([0.0, 0.0, 5.0], target).with(render).samples(1024).radiance(&body).x
    };
    for target in [[0.0, 0.0, 1.0], [0.5, 0.4, 0.7], [0.0, 0.98, 0.0]] {
        assert_close(of("diffuse = [1, 1, 1]", target), 1.0, 2e-3, "white");
        assert_close(of("diffuse = [0.4, 0.4, 0.4]", target), 0.4, 2e-3, "grey");
        assert_close(of("reflection = [1, 1, 1]", target), 1.0, 1e-6, "mirror");
        assert_close(of("transmission = [1, 1, 1]", target), 1.0, 2e-3, "glass");
        assert_close(of("transmission = [1, 1, 1]\nior = 0.7", target), 1.0, 2e-3, "thin glass");
        for alpha in [0.02, 0.2, 0.6, 2.0] {
            let keys = format!(
                "specular = [1, 1, 1]\nward = 'bounded'\nalpha_x = {alpha}\nalpha_y = {alpha}"
            );
            let found = of(&keys, target);
            assert!(found < 1.004, "gloss of {alpha} gains energy: {found} at {target:?}");
            assert!(found > 0.97 || alpha > 0.1 || target[1] > 0.9, "and loses little: {found}");
        }
    }
}

/// "path" with depth 0 is "direct" without ambient, and so is every scene in which nothing that
/// scatters brings light.
#[test]
fn both_integrators_agree_where_the_contract_says_so() {
    let body = "[environment]\nbackground = [0.3, 0.2, 0.1]\n\
                [[materials]]\nname = 'm'\ndiffuse = [0.3, 0.5, 0.7]\nspecular = [0.3, 0.2, 0.1]\n\
                alpha_x = 0.1\nalpha_y = 0.4\nreflection = [0.1, 0.2, 0.3]\nemission = [0.1, 0, 0]\n\
                [[objects]]\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'm'\n\
                [[lights]]\ntype = 'disk'\nposition = [2, 4, 3]\nsize = 1\npower = [90, 90, 90]\n";
    let look = |render| Look::at([0.0, 0.0, 5.0], [0.3, 0.3, 0.8]).with(render).radiance(body);
    let (direct, path) = (look("max_depth = 0"), look("max_depth = 0\nintegrator = 'path'"));
    assert_eq!(direct, path, "to the last bit at depth 0");
    // A black room: what scatters meets nothing.
    let dark = body.replace("background = [0.3, 0.2, 0.1]", "background = [0, 0, 0]");
    let look = |render| {
        Look::at([0.0, 0.0, 5.0], [0.3, 0.3, 0.8]).with(render).samples(512).radiance(&dark)
    };
    let (direct, path) = (look("max_depth = 5"), look("max_depth = 5\nintegrator = 'path'"));
    for channel in 0..3 {
        assert_close(path[channel], direct[channel], 5e-3, "nothing scattered brings light");
    }
}

/// "direct" adds diffuse reflectance times ambient at every surface met, in mirrors too; "path"
/// ignores it, and "direct" is not lit by the sky or by things that glow.
#[test]
fn ambient_light_belongs_to_direct_alone() {
    let body = "[environment]\nambient = [0.5, 0.25, 1]\nbackground = [9, 9, 9]\n\
                [[materials]]\nname = 'm'\ndiffuse = [0.4, 0.8, 0.1]\nspecular = [0.9, 0.9, 0.9]\n\
                [[materials]]\nname = 'mirror'\nreflection = [0.5, 0.5, 0.5]\n\
                [[materials]]\nname = 'glow'\nemission = [7, 7, 7]\n\
                [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n\
                [[objects]]\ntype = 'plane'\npoint = [0, 0, -9]\nnormal = [0, 0, 1]\nmaterial = 'mirror'\n\
                [[objects]]\ntype = 'sphere'\ncenter = [5, 3, 0]\nradius = 1\nmaterial = 'glow'\n";
    let ambient = DVec3::new(0.2, 0.2, 0.1);
    let look = |target, render| Look::at([0.0, 1.0, 0.0], target).with(render).radiance(body);
    let floor = look([0.0, 0.0, -1.0], "");
    assert!((floor - ambient).length() < 1e-6, "{floor} on the floor");
    let in_mirror = look([0.0, 0.5, -9.0], "");
    assert!((in_mirror - 0.5 * ambient).length() < 1e-6, "{in_mirror} in the mirror");
    let path = look([0.0, 0.0, -1.0], "integrator = 'path'\nmax_depth = 0");
    assert_eq!(path, DVec3::ZERO, "path ignores it");
    let lit = look([0.0, 0.0, -1.0], "integrator = 'path'\nmax_depth = 1");
    assert!(lit.min_element() > 0.3, "path is lit by sky and glow: {lit}");
}

/// A diffuse floor lit by a glowing sphere: the configuration factor, by scattered rays alone.
#[test]
fn things_that_glow_light_others_by_their_configuration_factor() {
    let body = "[[materials]]\nname = 'glow'\nemission = [2, 2, 2]\n\
                [[materials]]\nname = 'white'\ndiffuse = [1, 1, 1]\n\
                [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, -1, 0]\nmaterial = 'white'\n\
                [[objects]]\ntype = 'sphere'\ncenter = [1, 2, 0]\nradius = 1\nmaterial = 'glow'\n";
    let render = "integrator = 'path'\nmax_depth = 1";
    let look = Look::at([-1.0, 1.0, 0.4], [0.0; 3]).with(render).samples(4096);
    // L = e sin² cos: no emission of its own, one event.
    let expected = 2.0 / 5.0 * (2.0 / 5.0_f64.sqrt());
    assert_close(look.radiance(body).x, expected, 5e-3, "a glowing sphere");
    // The same sphere as a visible light counts once, by shadow rays.
    let as_light = "[[materials]]\nname = 'white'\ndiffuse = [1, 1, 1]\n\
                    [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'white'\n";
    let power = 2.0 * 4.0 * PI * PI;
    for visible in [true, false] {
        let body = format!(
            "{as_light}[[lights]]\ntype = 'sphere'\nposition = [1, 2, 0]\nsize = 2\n\
             power = [{power}, {power}, {power}]\nvisible = {visible}\n"
        );
        let look = Look::at([-1.0, 1.0, 0.4], [0.0; 3]).with("integrator = 'path'\nmax_depth = 4");
        assert_close(look.radiance(&body).x, expected, 2e-3, "the same as a light");
    }
}

/// A visible light stops scattered rays: the sky behind it is not counted, nor is the light twice.
#[test]
fn visible_lights_hide_the_sky_from_scattered_rays() {
    let body = |visible: bool, power: f64| {
        format!(
            "[environment]\nbackground = [1, 1, 1]\n[[materials]]\nname = 'white'\n\
             diffuse = [1, 1, 1]\n[[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\n\
             normal = [0, 1, 0]\nmaterial = 'white'\n[[lights]]\ntype = 'disk'\n\
             position = [0, 1, 0]\nsize = 2\npower = [{power}, 0, 0]\nvisible = {visible}\n"
        )
    };
    let look = |body: &str| {
        let render = "integrator = 'path'\nmax_depth = 2";
        Look::at([3.0, 1.0, 0.4], [0.0; 3]).with(render).samples(2048).radiance(body)
    };
    // Half of the cosine-weighted sky is behind a disk of sin² = 1/2.
    let hidden = look(&body(true, 1.0));
    assert_close(hidden.y, 0.5, 4e-3, "the sky beside a visible disk");
    assert_close(hidden.x, 0.5 + 0.5 / (PI * PI), 4e-3, "and the disk itself");
    let seen = look(&body(false, 1.0));
    assert_close(seen.y, 1.0, 4e-3, "the sky through an invisible disk");
    assert_close(seen.x, 1.0 + 0.5 / (PI * PI), 4e-3, "and the disk itself");
}

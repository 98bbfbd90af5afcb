//! Corners where formulas divide by little: grazing angles, lobes from a needle to flatness, lights
//! that touch, lie in or enclose what they light, glass in glass.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use penumbra::brdf::WardForm;

use super::gloss::{FORMS, albedo, direction, reference};
use crate::common::{Look, WHITE_FLOOR, assert_close, irradiance, lambert_polygon};

/// Looks at a very small part of the floor around the origin.
const CLOSE: [f64; 3] = [-0.03, 0.05, 0.02];

fn floor(form: &str, [alpha_x, alpha_y]: [f64; 2]) -> String {
    format!(
        "[[materials]]\nname = 'm'\nspecular = [0.6, 0.6, 0.6]\nward = '{form}'\n\
         alpha_x = {alpha_x:e}\nalpha_y = {alpha_y:e}\n[[objects]]\ntype = 'plane'\n\
         point = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n"
    )
}

/// Where the eye is, so far from the normal, in the plane of x and y.
fn eye(theta: f64) -> DVec3 {
    DVec3::new(2.0 * theta.sin(), 2.0 * theta.cos(), 0.0)
}

/// A lobe that lies wholly on the light shows its radiance times the albedo, however narrow: down to
/// where a mirror cannot be told from it, and further.
#[test]
fn narrow_lobes_show_the_light_times_their_albedo() {
    for (form, name) in FORMS {
        for (alpha, theta) in [(1e-2, 0.3_f64), (1e-3, 0.3), (1e-3, 1.3), (1e-7, 0.3), (1e-12, 1.0)]
        {
            // The limit of a mirror, but for the normalisation of each form.
            let limit = if form == WardForm::Original { theta.cos() } else { 1.0 };
            let share = if alpha < 1e-4 {
                limit
            } else {
                albedo(form, alpha, alpha, direction(theta, 0.0))
            };
            let place = DVec3::new(-theta.sin(), theta.cos(), 0.0).to_array();
            let body = format!(
                "{}[[lights]]\ntype = 'disk'\nposition = {place:?}\nsize = 0.5\n\
                 power = [2, 2, 2]\nvisible = false\n",
                floor(name, [alpha, alpha])
            );
            let radiance = 2.0 / (PI * PI * 0.25 * 0.25);
            for render in ["", "integrator = 'path'\nmax_depth = 1"] {
                let look = Look::at(eye(theta).to_array(), [0.0; 3]).with(render);
                let what = format!("{name}, alpha {alpha:e} at {theta} ({render})");
                assert_close(look.radiance(&body).x, 0.6 * radiance * share, 6e-3, &what);
            }
        }
    }
}

/// Lobes as broad as can be and eyes as low as can be, under a light near the horizon: by quadrature.
#[test]
fn broad_and_grazing_lobes_agree_with_quadrature() {
    let center = DVec3::new(-1.5, 0.5, 0.3);
    let axis = -center.normalize();
    let u = axis.cross(DVec3::Y).normalize();
    let v = u.cross(axis);
    for (form, name) in FORMS {
        for (alpha, theta) in [
            ([10.0, 10.0], 0.5),
            ([10.0, 0.2], 1.2),
            ([0.15, 0.15], 85_f64.to_radians()),
            ([0.4, 0.1], 89_f64.to_radians()),
            ([1.0, 1.0], 89.5_f64.to_radians()),
        ] {
            let local = |v: DVec3| DVec3::new(v.x, -v.z, v.y);
            let wo = local(eye(theta).normalize());
            let (n, mut sum) = (500, 0.0);
            for i in 0..n * n {
                let at = |k: i32| 0.8 * ((f64::from(k) + 0.5) / f64::from(n) - 0.5);
                let place = center + u * at(i % n) + v * at(i / n);
                let wi = local(place.normalize());
                let cos = -axis.dot(place.normalize());
                sum += reference(form, alpha[0], alpha[1], wo, wi) * wi.z.max(0.0) * cos
                    / place.length_squared();
            }
            let expected = 0.6 * (2.0 / PI) * sum / f64::from(n * n);
            let body = format!(
                "{}[[lights]]\ntype = 'rectangle'\nposition = {:?}\nsize = 0.8\n\
                 power = [2, 2, 2]\nvisible = false\n",
                floor(name, alpha),
                center.to_array()
            );
            for render in ["", "integrator = 'path'\nmax_depth = 1"] {
                let look = Look::at(eye(theta).to_array(), [0.0; 3]).with(render).samples(1024);
                let what = format!("{name}, alpha {alpha:?} at {theta} ({render})");
                assert_close(look.radiance(&body).x, expected, 6e-3, &what);
            }
        }
    }
}

/// No roughness that a file may hold makes a sample that is no number.
#[test]
fn every_roughness_gives_numbers() {
    for (_, name) in FORMS {
        for alpha in [[1e-12, 1e-12], [1e9, 1e-3], [1e12, 1e-12], [1e-12, 0.2]] {
            let body = format!(
                "[environment]\nbackground = [1, 1, 1]\n{}[[lights]]\ntype = 'sphere'\n\
                 position = [-1, 1.5, 0]\nsize = 1.0\npower = [2, 2, 2]\n",
                floor(name, alpha)
            );
            for render in ["", "integrator = 'path'\nmax_depth = 3"] {
                for theta in [0.3, 1.57] {
                    let look = Look::at(eye(theta).to_array(), [0.0; 3]).with(render).samples(64);
                    let found = look.radiance(&body).x;
                    assert!(found.is_finite() && found >= 0.0, "{name}, {alpha:?}: {found}");
                }
            }
        }
    }
}

fn light(keys: &str) -> String {
    format!("{WHITE_FLOOR}[[lights]]\n{keys}\npower = [4, 4, 4]\nvisible = false\n")
}

/// A wall of light that stands on the floor, lit close to its foot; one that lies on the floor.
#[test]
fn lights_that_touch_the_surface_agree_with_their_closed_forms() {
    for distance in [1.0, 0.1, 1e-3] {
        let corner = |y: f64, z: f64| DVec3::new(distance, y, z);
        let corners = [corner(0.0, -0.5), corner(2.0, -0.5), corner(2.0, 0.5), corner(0.0, 0.5)];
        let expected = lambert_polygon(DVec3::ZERO, DVec3::Y, &corners) * 4.0 / (PI * 2.0);
        let keys = format!(
            "type = 'rectangle'\nposition = [{distance}, 1, 0]\ntarget = [-9, 1, 0]\n\
             size = [1, 2]"
        );
        let found = irradiance(&light(&keys), CLOSE, [0.0; 3]);
        assert_close(found, expected, 5e-3, &format!("a wall at {distance}"));
        // Lying close above, so that half of all directions are light.
        let keys = format!("type = 'disk'\nposition = [0, {distance}, 0]\nsize = 2");
        let expected = 4.0 / PI / (1.0 + distance * distance);
        let found = irradiance(&light(&keys), CLOSE, [0.0; 3]);
        assert_close(found, expected, 5e-3, &format!("a disk at height {distance}"));
        // A sphere on the floor, lit beside the point where it stands.
        let keys = format!("type = 'sphere'\nposition = [{distance}, 0.5, 0]\nsize = 1");
        let length = (distance * distance + 0.25_f64).sqrt();
        let expected = 4.0 / (4.0 * PI) * 0.5 / length.powi(3);
        let found = irradiance(&light(&keys), CLOSE, [0.0; 3]);
        assert_close(found, expected, 5e-3, &format!("a sphere beside {distance}"));
    }
    for (keys, what) in [
        (
            "type = 'disk'\nposition = [0, 0, 0]\ntarget = [0, 1, 0]\nsize = 1",
            "a disk on the floor",
        ),
        ("type = 'rectangle'\nposition = [0, 0, 0]\ntarget = [0, 1, 0]\nsize = 1", "facing up"),
        ("type = 'disk'\nposition = [0, 2, 0]\ntarget = [0, 3, 0]\nsize = 1", "turned away"),
        ("type = 'sphere'\nposition = [0, 0.2, 0]\nsize = 1", "around the point"),
        ("type = 'sphere'\nposition = [0, -3, 0]\nsize = 1", "below the floor"),
        ("type = 'sun'\nposition = [0, -1, 0]\nsize = 170", "below the horizon"),
    ] {
        let found = Look::at(CLOSE, [0.0; 3]).radiance(&light(keys));
        assert_eq!(found, DVec3::ZERO, "{what}");
    }
}

/// A sphere cut by the horizon: the visible part of its cap, by quadrature.
#[test]
fn lights_that_sink_below_the_floor_light_by_what_is_above() {
    for (x, y) in [(1.5, 0.0), (1.5, 0.4), (1.5, -0.4), (1.01, 0.0)] {
        let center = DVec3::new(x, y, 0.0);
        let axis = center.normalize();
        let cos = (1.0 - 1.0 / center.length_squared()).sqrt();
        let (side, up) = (DVec3::Z, axis.cross(DVec3::Z).normalize());
        let (n, mut sum) = (1200, 0.0);
        for i in 0..n * n {
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
            let drop = (1.0 - cos) * at(i % n);
            let (sin_phi, cos_phi) = (TAU * at(i / n)).sin_cos();
            let d = axis * (1.0 - drop)
                + (side * cos_phi + up * sin_phi) * (drop * (2.0 - drop)).sqrt();
            sum += d.y.max(0.0);
        }
        let expected = sum / f64::from(n * n) * TAU * (1.0 - cos) * 4.0 / (4.0 * PI * PI);
        let keys = format!("type = 'sphere'\nposition = [{x}, {y}, 0]\nsize = 2");
        let found = irradiance(&light(&keys), CLOSE, [0.0; 3]);
        assert_close(found, expected, 8e-3, &format!("a sphere at ({x}, {y})"));
    }
}

/// Clear things under a white sky cannot be seen, whatever is in what: glass in glass, a mirror in
/// glass, glass at total reflection, mirrored by a negative scale.
#[test]
fn glass_in_glass_vanishes_under_a_white_sky() {
    let materials = "[environment]\nbackground = [1, 1, 1]\n\
         [[materials]]\nname = 'glass'\ntransmission = [1, 1, 1]\nior = 1.5\n\
         [[materials]]\nname = 'dense'\ntransmission = [1, 1, 1]\nior = 2.4\n\
         [[materials]]\nname = 'thin'\ntransmission = [1, 1, 1]\nior = 0.6\n\
         [[materials]]\nname = 'mirror'\nreflection = [1, 1, 1]\n";
    let ball = |radius: f64, material: &str| {
        format!(
            "[[objects]]\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = {radius}\n\
             material = '{material}'\nscale = [1, -1, 1.2]\n"
        )
    };
    let rock = "[[objects]]\ntype = 'box'\nmin = [-0.3, -0.3, -0.3]\nmax = [0.3, 0.3, 0.3]\n\
                material = 'dense'\nrotate = [20, 30, 40]\n";
    for inner in [ball(0.5, "glass"), ball(0.5, "mirror"), ball(0.5, "thin"), rock.to_owned()] {
        for render in ["max_depth = 1024", "integrator = 'path'\nmax_depth = 1024"] {
            for target in [[0.0, 0.1, 0.0], [0.0, 0.45, 0.0], [0.0, 0.8, 0.1]] {
                let body = format!("{materials}{}{inner}", ball(1.0, "glass"));
                let look = Look::at([0.1, 0.3, 5.0], target).with(render).samples(64);
                let found = look.radiance(&body).x;
                // Light that total reflection keeps in a box never leaves it.
                let least = if inner == rock { 0.9 } else { 1.0 - 1e-4 };
                assert!((least..=1.0 + 1e-4).contains(&found), "{found} of {inner} ({render})");
            }
        }
    }
}

/// Every part of a material counts, and each once: what glows, scatters, mirrors and lets through. The
/// sky is red and what lies below is green, so that no part stands in for another.
#[test]
fn the_parts_of_a_material_are_added() {
    let body = "[environment]\nbackground = [2, 0, 0]\nambient = [0.5, 0.5, 0.5]\n\
         [[materials]]\nname = 'm'\nemission = [0.03, 0.02, 0.1]\nreflection = [0.2, 0.2, 0.2]\n\
         transmission = [0.3, 0.3, 0.3]\nior = 1\ndiffuse = [0.2, 0.2, 0.2]\n\
         [[materials]]\nname = 'glow'\nemission = [0, 3, 0]\n\
         [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n\
         [[objects]]\ntype = 'plane'\npoint = [0, -9, 0]\nnormal = [0, 1, 0]\nmaterial = 'glow'\n\
         [[lights]]\ntype = 'sun'\nposition = [0, 1, 0]\npower = [0, 0, 3]\n";
    let (sky, glow) = (DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 0.0));
    for (eye, above, below) in [([0.5, 1.0, 0.2], sky, glow), ([0.5, -1.0, 0.2], glow, sky)] {
        let is_lit = f64::from(u8::from(eye[1] > 0.0));
        let direct = DVec3::new(0.03, 0.02, 0.1) + DVec3::Z * 0.2 * 3.0 / PI * is_lit;
        let once = direct + 0.2 * above + 0.3 * below;
        for (render, more) in [
            ("max_depth = 1", DVec3::splat(0.1)),
            ("integrator = 'path'\nmax_depth = 1", 0.2 * above),
        ] {
            let look = Look::at(eye, [0.0; 3]).with(render).samples(8192);
            let (found, expected) = (look.radiance(body), once + more);
            for channel in 0..3 {
                let what = format!("channel {channel} from {eye:?} ({render})");
                assert_close(found[channel], expected[channel], 5e-3, &what);
            }
        }
    }
}

/// At the limit of a grazing view nothing is lost and nothing is no number.
#[test]
fn a_grazing_view_of_a_diffuse_floor_is_as_bright_as_any() {
    let keys = "type = 'disk'\nposition = [0, 2, 0]\nsize = 1";
    let above = irradiance(&light(keys), [0.0, 1.0, 0.1], [0.0; 3]);
    for theta in [FRAC_PI_2 - 3e-2, FRAC_PI_2 - 3e-3] {
        let low = irradiance(&light(keys), eye(theta).to_array(), [0.0; 3]);
        assert_close(low, above, 5e-3, &format!("{theta} from the normal"));
    }
}

//! Every kind of light against its closed form, its limits and its orientation.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::common::{Look, WHITE_FLOOR, assert_close, irradiance};

/// Looks at the origin of the floor from the side, past whatever hangs above it.
const ASIDE: [f64; 3] = [3.0, 1.0, 0.7];

fn light(keys: &str) -> String {
    format!("{WHITE_FLOOR}\n[[lights]]\n{keys}\n")
}

/// Irradiance by a uniform polygon of unit radiance, all of it above the horizon.
///
/// Source: J. H. Lambert, "Photometria", 1760.
fn lambert_polygon(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in corners.iter().enumerate() {
        let a = (*a - point).normalize();
        let b = (corners[(i + 1) % corners.len()] - point).normalize();
        sum += a.dot(b).acos() * a.cross(b).normalize().dot(normal);
    }
    0.5 * sum.abs()
}

#[test]
fn a_point_light_falls_off_with_the_square_and_the_cosine() {
    for (x, y) in [(0.0, 1.0), (0.0, 4.0), (2.0, 1.5), (-5.0, 0.5)] {
        let body = light(&format!("type = 'point'\nposition = [{x}, {y}, 0]\npower = [5, 5, 5]"));
        let d2: f64 = x * x + y * y;
        let expected = 5.0 / (4.0 * PI) / d2 * (y / d2.sqrt());
        assert_close(irradiance(&body, ASIDE, [0.0; 3]), expected, 1e-4, "point light");
    }
}

/// A sphere wholly above the horizon lights like a point in its centre, whatever its size.
#[test]
fn a_sphere_lights_like_a_point() {
    for size in [0.0, 1e-3, 0.5, 1.9] {
        let body = light(&format!(
            "type = 'sphere'\nposition = [1.5, 2, 0]\nsize = {size}\npower = [5, 5, 5]"
        ));
        let expected = 5.0 / (4.0 * PI) / 6.25 * 0.8;
        assert_close(irradiance(&body, ASIDE, [0.0; 3]), expected, 1e-3, "sphere");
    }
}

#[test]
fn a_disk_agrees_with_its_configuration_factor_on_and_off_its_axis() {
    for (size, offset) in [(1.0, 0.0), (4.0, 0.0), (1.0, 1.7), (3.0, 1.0)] {
        let body = light(&format!(
            "type = 'disk'\nposition = [{offset}, 1.2, 0]\ntarget = [{offset}, 0, 0]\n\
             size = {size}\npower = [5, 5, 5]"
        ));
        let (r2, a2, h2): (f64, f64, f64) = (size * size / 4.0, offset * offset, 1.44);
        let radiance = 5.0 / (PI * PI * r2);
        let root = ((a2 + h2 + r2).powi(2) - 4.0 * r2 * a2).sqrt();
        let expected = 0.5 * PI * radiance * (1.0 - (a2 + h2 - r2) / root);
        let on_axis = PI * radiance * r2 / (r2 + h2);
        assert!(offset != 0.0 || (expected / on_axis - 1.0).abs() < 1e-12, "the forms agree");
        assert_close(irradiance(&body, ASIDE, [0.0; 3]), expected, 2e-3, "disk");
    }
}

/// Width along n x up, height along u x n, for any axis: against Lambert's polygon.
#[test]
fn a_rectangle_agrees_with_lamberts_formula_however_it_is_turned() {
    let position = DVec3::new(0.6, 1.5, -0.4);
    for (target, up) in [
        (DVec3::ZERO, DVec3::Y),
        (DVec3::new(0.6, 0.0, -0.4), DVec3::Y),
        (DVec3::new(0.3, 0.2, 0.8), DVec3::new(1.0, 1.0, 0.0)),
        (DVec3::new(-2.0, 0.1, 0.4), DVec3::Z),
    ] {
        let n = (target - position).normalize();
        let mut across = n.cross(up.normalize());
        if across.length() < 1e-4 {
            across = n.cross(DVec3::NEG_Z);
        }
        let u = across.normalize();
        let (half_u, half_v) = (0.7 * u, 0.2 * u.cross(n));
        let corner = |su: f64, sv: f64| position + su * half_u + sv * half_v;
        let corners = [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
        let radiance = 5.0 / (PI * 1.4 * 0.4);
        let expected = radiance * lambert_polygon(DVec3::ZERO, DVec3::Y, &corners);
        let body = light(&format!(
            "type = 'rectangle'\nposition = {position:?}\ntarget = {target:?}\nup = {up:?}\n\
             size = [1.4, 0.4]\npower = [5, 5, 5]",
            position = position.to_array(),
            target = target.to_array(),
            up = up.to_array(),
        ));
        assert_close(irradiance(&body, ASIDE, [0.0; 3]), expected, 2e-3, "rectangle");
    }
}

/// So close that the light fills nearly half of all directions, and so low that it is seen edge on.
/// Sampling by area has weights without bound here; by solid angle a few hundred samples do.
#[test]
fn large_lights_close_by_agree_with_their_closed_forms() {
    for (x, y) in [(0.0, 0.01), (0.9, 0.02), (1.3, 0.1), (3.0, 0.03), (-0.2, 0.6)] {
        let body = |kind: &str, size: &str| {
            light(&format!(
                "type = '{kind}'\nposition = [{x}, {y}, 0]\ntarget = [{x}, 0, 0]\n\
                 up = [0, 0, 1]\nsize = {size}\npower = [5, 5, 5]\nvisible = false"
            ))
        };
        let look = Look::at([0.3, 1e-3, 0.2], [0.0; 3]).samples(1024);
        let found = |kind: &str, size: &str| PI * look.radiance(&body(kind, size)).x;
        // Seen from below, -y, which faces the floor; u and v are x and z.
        let corner = |sx: f64, sz: f64| DVec3::new(x + sx, y, 0.4 * sz);
        let corners = [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
        let expected = 5.0 / (PI * 1.6) * lambert_polygon(DVec3::ZERO, DVec3::Y, &corners);
        let what = format!("rectangle at ({x}, {y})");
        assert_close(found("rectangle", "[2, 0.8]"), expected, 4e-3, &what);
        let (a2, h2): (f64, f64) = (x * x, y * y);
        let root = ((a2 + h2 + 1.0).powi(2) - 4.0 * a2).sqrt();
        let expected = 0.5 * 5.0 / PI * (1.0 - (a2 + h2 - 1.0) / root);
        assert_close(found("disk", "2"), expected, 4e-3, &format!("disk at ({x}, {y})"));
    }
    // A sphere that rests a thousandth of its radius above the floor, and one high above it.
    for height in [1.001, 1.3, 4.0] {
        let body = light(&format!(
            "type = 'sphere'\nposition = [0, {height}, 0]\nsize = 2\npower = [5, 5, 5]\n\
             visible = false"
        ));
        let expected = 5.0 / (4.0 * PI) / (height * height);
        let found = PI * Look::at([2e-4, 2e-4, 0.0], [0.0; 3]).radiance(&body).x;
        assert_close(found, expected, 2e-3, &format!("sphere at {height}"));
    }
}

/// At constant power the size does not change the light far away, down to the limit of a point.
#[test]
fn size_does_not_change_the_far_field() {
    for kind in ["rectangle", "disk"] {
        for size in [0.0, 1e-20, 1e-9, 1e-3, 0.5] {
            let look = |target: &str| {
                let body = light(&format!(
                    "type = '{kind}'\nposition = [12, 16, 0]\ntarget = {target}\nsize = {size}\n\
                     power = [5, 5, 5]"
                ));
                irradiance(&body, ASIDE, [0.0; 3])
            };
            // The way down is (-0.6, -0.8, 0), the axis (0, -0.6, -0.8).
            let expected = 5.0 / PI * 0.48 * 0.8 / 400.0;
            assert_close(look("[12, 15.4, -0.8]"), expected, 2e-3, &format!("{kind} of {size}"));
            assert!(look("[12.8, 15.4, 0]") < 0.02 * expected, "{kind} of {size} edge on");
        }
    }
}

#[test]
fn a_sun_gives_a_facing_surface_its_power_whatever_its_size() {
    for size in [0.0, 1e-20, 1e-6, 0.5, 30.0, 120.0, 180.0] {
        let body = light(&format!(
            "type = 'sun'\nposition = [0, 1, 0]\ntarget = [0, 0, 0]\nsize = {size}\npower = [3, 3, 3]"
        ));
        let found = irradiance(&body, ASIDE, [0.0; 3]);
        assert_close(found, 3.0, 1e-3, &format!("sun of {size} degrees"));
    }
    // Light travels from position to target, tilted by 60 degrees.
    let tilt = 60.0_f64.to_radians();
    for size in [0.0, 0.5, 20.0] {
        let body = light(&format!(
            "type = 'sun'\nposition = [{}, {}, 0]\ntarget = [0, 0, 0]\nsize = {size}\n\
             power = [3, 3, 3]",
            7.0 * tilt.sin(),
            7.0 * tilt.cos()
        ));
        assert_close(irradiance(&body, ASIDE, [0.0; 3]), 1.5, 1e-3, "tilted sun");
    }
    let body = light(
        "type = 'sun'\nposition = [-0.8660254037844386, 0.5, 0]\nsize = 180\npower = [3, 3, 3]",
    );
    let expected = 3.0 * 0.5 * (1.0 + 0.5);
    assert_close(irradiance(&body, ASIDE, [0.0; 3]), expected, 3e-3, "half of a tilted sky");
}

/// The shadow of an edge: the floor sees the part of the rectangle that is not behind a box.
#[test]
fn a_penumbra_has_the_profile_of_the_visible_part() {
    let body = format!(
        "{}\n[[objects]]\ntype = 'box'\nmin = [0, 1, -50]\nmax = [50, 1.1, 50]\nmaterial = 'white'\n",
        light(
            "type = 'rectangle'\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nup = [0, 0, 1]\n\
             size = [1, 0.5]\npower = [9, 9, 9]"
        )
    );
    let radiance = 9.0 / (PI * 0.5);
    let mut in_penumbra = 0;
    for step in -6..=6 {
        let x = 0.1 * f64::from(step);
        let floor = DVec3::new(x, 0.0, 0.0);
        let (n_x, n_z) = (400, 40);
        let (mut expected, mut n_seen) = (0.0, 0);
        for i in 0..n_x * n_z {
            let s = (f64::from(i % n_x) + 0.5) / f64::from(n_x) - 0.5;
            let t = (f64::from(i / n_x) + 0.5) / f64::from(n_z) - 0.5;
            let way = DVec3::new(s, 3.0, 0.5 * t) - floor;
            // The box is met where its lower edge, or its upper one, is passed at x > 0.
            let at = |y: f64| floor.x + way.x * (y / 3.0);
            if at(1.0).max(at(1.1)) > 0.0 {
                continue;
            }
            n_seen += 1;
            let cos = way.y / way.length();
            expected += radiance * cos * cos / way.length_squared() * 0.5 / f64::from(n_x * n_z);
        }
        in_penumbra += i32::from(n_seen > 0 && n_seen < n_x * n_z);
        let found = irradiance(&body, [x - 0.5, 0.5, 0.3], [x, 0.0, 0.0]);
        let full = radiance * 0.5 / 9.0;
        assert!((found - expected).abs() < 0.004 * full, "{found}, not {expected} at {x}");
    }
    assert!(in_penumbra >= 4, "the profile crosses the penumbra: {in_penumbra} places");
}

/// Radiance of the light itself, seen by the camera from its emitting side only.
#[test]
fn visible_lights_are_seen_with_their_radiance_from_their_emitting_side() {
    let front: [f64; 3] = [0.2, 0.3, 5.0];
    let behind: [f64; 3] = [0.2, 0.3, -5.0];
    let area = 0.25 * PI;
    let cases = [
        ("type = 'rectangle'\ntarget = [0, 0, 1]\nsize = [2, 0.8]", 1.0 / (PI * 1.6)),
        ("type = 'disk'\ntarget = [0, 0, 1]\nsize = 1", 1.0 / (PI * area)),
        ("type = 'sphere'\nsize = 1", 1.0 / (4.0 * PI * PI * 0.25)),
    ];
    for (keys, radiance) in cases {
        let body = |visible: bool| {
            format!(
                "[environment]\nbackground = [0.25, 0.25, 0.25]\n[[lights]]\n{keys}\n\
                 position = [0, 0, 0]\npower = [8, 8, 8]\nvisible = {visible}\n"
            )
        };
        let look =
            |eye, visible| Look::at(eye, [0.1, 0.2, 0.0]).samples(4).radiance(&body(visible)).x;
        assert_close(look(front, true), 8.0 * radiance, 1e-5, keys);
        assert_close(look(front, false), 0.25, 1e-6, "an invisible light");
        let from_behind = if keys.contains("sphere") { 8.0 * radiance } else { 0.25 };
        assert_close(look(behind, true), from_behind, 1e-5, "from behind");
        let inside = Look::at([0.1, 0.2, 0.0], front).samples(4).radiance(&body(true)).x;
        assert_close(inside, 0.25, 1e-6, "from within or from its plane");
    }
}

/// The orientation of a visible rectangle: inside and just outside each of its borders.
#[test]
fn a_visible_rectangle_is_where_its_axes_say() {
    // n = -Z, u = n x Y = X... width 2 along x, height 1 along y.
    let body = "[[lights]]\ntype = 'rectangle'\nposition = [1, 2, 0]\ntarget = [1, 2, -3]\n\
                size = [2, 1]\npower = [1, 1, 1]\n";
    for (x, y, seen) in [
        (1.95, 2.45, true),
        (0.05, 1.55, true),
        (2.05, 2.0, false),
        (1.0, 2.55, false),
        (-0.05, 2.0, false),
        (1.0, 1.45, false),
    ] {
        let found = Look::at([x, y, -4.0], [x, y, 0.0]).samples(4).radiance(body).x;
        assert_eq!(found > 0.0, seen, "at ({x}, {y}) it shows {found}");
    }
}

/// A sun with extent hides the background, exactly to its rim, and only if it is visible.
#[test]
fn a_visible_sun_stands_in_front_of_the_background() {
    let body = |visible: bool| {
        format!(
            "[environment]\nbackground = [0.5, 0.5, 0.5]\n[[lights]]\ntype = 'sun'\n\
             position = [0, 0, 1]\nsize = 10\npower = [3, 3, 3]\nvisible = {visible}\n"
        )
    };
    let radiance = 3.0 / (PI * 5.0_f64.to_radians().sin().powi(2));
    for (angle, is_inside) in [(0.0, true), (4.9, true), (5.1, false), (180.0, false)] {
        let angle = f64::to_radians(angle);
        let target = [angle.sin(), 0.0, angle.cos()];
        let seen = Look::at([0.0; 3], target).samples(4);
        let expected = if is_inside { radiance } else { 0.5 };
        assert_close(seen.radiance(&body(true)).x, expected, 1e-4, "a visible sun");
        assert_close(seen.radiance(&body(false)).x, 0.5, 1e-6, "an invisible sun");
    }
}

/// Lights do not cast shadows: one in front of another changes nothing, whatever the surface.
#[test]
fn lights_do_not_hide_each_other_from_surfaces() {
    let near = "[[lights]]\ntype = 'disk'\nposition = [0, 1, 0]\nsize = 1.5\npower = [2, 2, 2]\n";
    let far = "[[lights]]\ntype = 'sphere'\nposition = [0, 4, 0]\nsize = 2\npower = [90, 90, 90]\n";
    let sun = "[[lights]]\ntype = 'sun'\nposition = [0, 9, 0.5]\nsize = 8\npower = [1, 1, 1]\n";
    for (gloss, alpha) in [([0.0; 3], 0.2), ([0.5; 3], 0.4), ([0.5; 3], 0.05)] {
        let surface = format!(
            "[[materials]]\nname = 'm'\ndiffuse = [0.3, 0.3, 0.3]\nspecular = {gloss:?}\n\
             alpha_x = {alpha}\nalpha_y = {alpha}\n[[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\n\
             normal = [0, 1, 0]\nmaterial = 'm'\n"
        );
        for render in ["max_depth = 0", "max_depth = 1\nintegrator = 'path'"] {
            let look = Look::at([0.3, 0.9, 0.9], [0.0; 3]).with(render).samples(4096);
            let parts: f64 =
                [near, far, sun].iter().map(|l| look.radiance(&format!("{l}{surface}")).x).sum();
            let all = look.radiance(&format!("{near}{far}{sun}{surface}")).x;
            assert_close(all, parts, 5e-3, &format!("gloss {gloss:?} of {alpha} ({render})"));
        }
    }
}

/// Between the cap's zenith and the horizon: what is below the surface does not light it.
#[test]
fn light_below_the_horizon_does_not_arrive() {
    let body = light("type = 'sun'\nposition = [1, -0.01, 0]\nsize = 0.5\npower = [3, 3, 3]");
    assert_eq!(irradiance(&body, ASIDE, [0.0; 3]), 0.0, "a sun that has set");
    // A sphere cut in half by the floor: the upper half of a cap seen edge on, in closed form.
    let body = light(
        "type = 'sphere'\nposition = [2, 0, 0]\nsize = 2\nvisible = false\npower = [5, 5, 5]",
    );
    let radiance = 5.0 / (4.0 * PI * PI);
    let (sin, angle) = (0.5_f64, (0.5_f64).asin());
    // Of a cap of half angle a whose centre is on the horizon: E = L (a - sin a cos a).
    let expected = radiance * (angle - sin * angle.cos());
    assert!(angle < FRAC_PI_2, "the cap is smaller than the sky");
    let found = PI * Look::at(ASIDE, [0.0; 3]).samples(8192).radiance(&body).x;
    assert_close(found, expected, 4e-3, "half a sphere");
}

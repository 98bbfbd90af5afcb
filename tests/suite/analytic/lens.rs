//! The camera: where points appear, and how large points out of focus become.

use std::f64::consts::PI;

use glam::{DVec3, Vec2};
use penumbra::scene::Camera;

use crate::common::{Numbers, assert_close, film, job, mean};

/// What the contract says of the pinhole ray, in double precision.
fn project(eye: DVec3, target: DVec3, up: DVec3, fov: f64, size: [f64; 2], p: DVec3) -> [f64; 2] {
    let forward = (target - eye).normalize();
    let right = forward.cross(up).normalize();
    let up = right.cross(forward);
    let q = (p - eye) / (p - eye).dot(forward);
    let tan = (0.5 * fov).tan();
    let x = q.dot(right) / tan / (size[0] / size[1]);
    let y = q.dot(up) / tan;
    [0.5 * (x + 1.0) * size[0], 0.5 * (1.0 - y) * size[1]]
}

#[test]
fn rays_go_through_the_points_that_they_show() {
    let mut numbers = Numbers::new(4);
    for _ in 0..500 {
        let eye = numbers.direction() * 5.0;
        let (target, up) = (numbers.direction(), numbers.direction());
        let fov = numbers.between(0.1, 2.5);
        let size = [numbers.between(100.0, 900.0), numbers.between(100.0, 900.0)].map(f64::ceil);
        let p = target + numbers.direction();
        let [x, y] = project(eye, target, up, fov, size, p);
        let camera = Camera::look_at(eye, target, up, fov);
        let (at, size) = (DVec3::new(x, y, 0.0).as_vec3(), size.map(|s| s as f32));
        let direction =
            camera.pinhole_direction(Vec2::new(at.x, at.y), Vec2::from_array(size)).as_dvec3();
        assert!((direction.dot((target - eye).normalize()) - 1.0).abs() < 1e-4, "{direction}");
        let miss = direction.normalize().cross((p - eye).normalize()).length();
        let spread = direction.length();
        assert!(miss < 1e-5 * spread, "{miss} beside {p} seen from {eye} through {fov}");
    }
}

/// One pixel before a sheet that ends within it: its mean is the share that the sheet covers, for edges
/// close to either border too.
#[test]
fn a_pixel_is_the_mean_over_its_square() {
    for share in [0.02, 0.31, 0.98] {
        let edge = 2.0 * share - 1.0;
        for (max, what) in [([edge, 9.0, -1.0], "from the left"), ([9.0, edge, -1.0], "from below")]
        {
            let job = job(&format!(
                "[render]\nwidth = 1\nheight = 1\n\
                 [camera]\neye = [0, 0, 0]\ntarget = [0, 0, -1]\nvertical_fov = 90\n\
                 [[materials]]\nname = 'm'\nemission = [1, 1, 1]\n\
                 [[objects]]\ntype = 'box'\nmin = [-9, -9, -1.001]\nmax = {max:?}\nmaterial = 'm'\n"
            ));
            let found = mean(&film(&job, 4096)).x;
            assert!((found - share).abs() < 2e-3, "{found} of {share} {what}");
        }
    }
}

/// All rays of one place of the picture cross in one point of the plane in focus, and start on the
/// lens.
#[test]
fn the_surface_in_focus_is_a_plane() {
    let (eye, target) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.5, -1.0, -4.0));
    let mut camera = Camera::look_at(eye, target, DVec3::Y, 1.2);
    camera.aperture_radius = 0.7;
    camera.focal_distance = 4.0;
    let forward = (target - eye).normalize();
    let size = Vec2::new(64.0, 48.0);
    let mut numbers = Numbers::new(9);
    for blades in [0, 3, 7] {
        camera.aperture_blades = blades;
        for _ in 0..500 {
            let at = Vec2::new(numbers.next() as f32 * 64.0, numbers.next() as f32 * 48.0);
            let lens = [numbers.next() as f32, numbers.next() as f32].map(|u| u.min(0.999_999));
            let ray = camera.ray(at, size, lens);
            let offset = ray.origin.as_dvec3() - eye;
            assert!(offset.dot(forward).abs() < 1e-5, "the lens stands at a right angle");
            assert!(offset.length() < 0.7 + 1e-5, "{offset} is beyond the lens");
            let meeting = eye + 4.0 * camera.pinhole_direction(at, size).as_dvec3();
            let way = meeting - ray.origin.as_dvec3();
            let miss = way.normalize().cross(ray.direction.as_dvec3().normalize()).length();
            assert!(miss < 1e-5, "{miss} beside the plane of focus");
        }
    }
}

/// A far, tiny, bright ball before a camera of 81 x 81 pixels.
fn picture_of_a_ball(distance: f64, focal_distance: f64, blades: u32) -> Vec<[f64; 2]> {
    let text = format!(
        "[render]\nwidth = 81\nheight = 81\n[camera]\neye = [0, 0, 0]\ntarget = [0, 0, -1]\n\
         vertical_fov = 20\naperture_radius = 0.1\nfocal_distance = {focal_distance}\n\
         aperture_blades = {blades}\n[[materials]]\nname = 'm'\nemission = [1, 1, 1]\n\
         [[objects]]\ntype = 'sphere'\ncenter = [0, 0, {}]\nradius = {}\nmaterial = 'm'\n",
        -distance,
        2e-3 * distance
    );
    let picture = film(&job(&text), 256).picture();
    let is_lit = |p: &[f32; 3]| p[0] > 0.0;
    let pixel = |i: usize| [(i % 81) as f64 - 40.0, 40.0 - (i / 81) as f64];
    let lit = picture.pixels.iter().enumerate().filter(|(_, p)| is_lit(p));
    lit.map(|(i, _)| pixel(i)).collect()
}

/// Diameter of the circle of confusion: 2 a |d - f| / d on the plane of focus, in pixels there.
#[test]
fn points_out_of_focus_become_circles_of_confusion() {
    for (distance, focal_distance) in [(2.0, 6.0), (4.0, 2.0), (10.0, 2.5), (3.0, 3.0)] {
        let lit = picture_of_a_ball(distance, focal_distance, 0);
        let height = 2.0 * focal_distance * 10.0_f64.to_radians().tan();
        let blur = 2.0 * 0.1 * f64::abs(distance - focal_distance) / distance / height * 81.0;
        let ball = 4e-3 / (2.0 * 10.0_f64.to_radians().tan()) * 81.0;
        let width = lit.iter().map(|p| p[0]).fold(0.0, f64::max) * 2.0 + 1.0;
        let expected = blur + ball;
        assert!((width - expected).abs() < 2.5, "{width} pixels, not {expected} at {distance}");
        let area = PI / 4.0 * (expected + 1.0).powi(2);
        assert!(lit.len() as f64 <= area + 4.0, "a disk: {} pixels of {area}", lit.len());
    }
}

/// Three blades, one corner of the lens up: what lies behind the plane of focus shows the lens as
/// it is seen from behind the picture, upright; what lies before it upside down.
#[test]
fn blades_have_a_corner_towards_up() {
    for (distance, focal_distance, sign) in [(10.0, 2.5, -1.0), (2.0, 6.0, 1.0)] {
        let lit = picture_of_a_ball(distance, focal_distance, 3);
        // Seen through a point of the lens at +y, a ball before the plane of focus lies lower on
        // that plane, so it appears lower; one behind it higher.
        let top = lit.iter().map(|p| -sign * p[1]).fold(f64::MIN, f64::max);
        let bottom = lit.iter().map(|p| sign * p[1]).fold(f64::MIN, f64::max);
        assert_close(top / bottom, 2.0, 0.25, &format!("corner and side at {distance}"));
        let width_at = |share: f64| {
            let level = |p: &&[f64; 2]| (-sign * p[1] - share * top).abs() < 1.0;
            lit.iter().filter(level).map(|p| p[0].abs()).fold(0.0, f64::max)
        };
        assert!(width_at(0.9) < 0.4 * width_at(-0.4), "the corner is narrow, the side wide");
    }
}

/// Where no focal distance is given, the target is in focus.
#[test]
fn the_target_is_in_focus_where_nothing_else_is_said() {
    let look = "[render]\nwidth = 8\nheight = 8\n[camera]\neye = [1, 2, 3]\ntarget = [-1, 4, -4]\n";
    let of = |rest: &str| job(&format!("{look}{rest}")).scene.camera.focal_distance;
    let expected = (4.0_f32 + 4.0 + 49.0).sqrt();
    assert!((of("") - expected).abs() < 1e-5, "{} for {expected}", of(""));
    assert_eq!(of("focal_distance = 2.5\n"), 2.5);
}

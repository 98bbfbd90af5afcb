//! First hits without light: what each pixel's middle shows, against closed forms.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
use penumbra::geometry::AcceleratorKind;
use penumbra::math::portable::tan_f64;
use penumbra::render::features::{cost_map, feature_map, same_first_hits};
use penumbra::render::{Feature, PixelMap, RenderJob, Seen, World};

use crate::common::{Files, film, job, job_with};

/// A ball on a floor, a lamp above it, a disabled ball before all of them.
const SCENE: &str = r#"
[render]
width = 33
height = 33
[camera]
eye = [0, 1, 6]
target = [0, 1, 0]
LENS
[[materials]]
name = "red"
diffuse = [0.6, 0.1, 0.1]
specular = [0.2, 0.2, 0.2]
reflection = [0.5, 0.0, 0.0]
[[lights]]
type = "sphere"
position = [0, 2.2, 2]
size = 0.4
power = [10, 10, 10]
[[objects]]
type = "sphere"
center = [0, 1, 5]
radius = 0.3
enabled = false
[[objects]]
type = "sphere"
center = [0, 1, 0]
radius = 1
material = "red"
[[objects]]
type = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
"#;

fn scene(lens: &str) -> RenderJob {
    job(&SCENE.replace("LENS", lens))
}

fn features(job: &RenderJob) -> PixelMap<Feature> {
    feature_map(&World::new(job.clone()), &AtomicBool::new(false)).unwrap()
}

#[test]
fn first_hits_are_where_geometry_says() {
    let map = features(&scene(""));
    let near = |a: Vec3, b: Vec3| (a - b).length() < 1e-4;

    let ball = map.get(16, 16).unwrap();
    assert_eq!(ball.seen, Seen::Object(0), "the disabled ball counts");
    assert!((ball.depth - 5.0).abs() < 1e-5, "the ball is {} away", ball.depth);
    assert!(near(ball.normal, Vec3::Z), "its normal is {}", ball.normal);
    // Diffuse, gloss and mirror add up, and stay below 1.
    assert!(near(ball.albedo, Vec3::new(1.0, 0.3, 0.3)), "its albedo is {}", ball.albedo);

    let floor = map.get(16, 32).unwrap();
    let slope = tan_f64(20.0_f64.to_radians()) as f32 * (65.0 / 33.0 - 1.0);
    assert_eq!(floor.seen, Seen::Object(1), "the floor");
    assert!((floor.depth - 1.0 / slope).abs() < 1e-4, "the floor is {} away", floor.depth);
    assert!(near(floor.normal, Vec3::Y), "its normal is {}", floor.normal);
    assert!(near(floor.albedo, Vec3::splat(0.5)), "its albedo is {}", floor.albedo);

    let lamp = map.get(16, 2).unwrap();
    assert_eq!(lamp.seen, Seen::Light(0), "the lamp");
    assert!((lamp.depth - 3.8).abs() < 0.02, "the lamp is {} away", lamp.depth);
    assert_eq!(*map.get(0, 0).unwrap(), Feature::NOTHING, "the sky");
    assert!(map.get(33, 0).is_none(), "beyond the edge");
}

#[test]
fn first_hits_know_nothing_of_the_lens_and_all_accelerators_agree() {
    let (closed, open) = (scene(""), scene("aperture_radius = 0.5\nfocal_distance = 2.0"));
    assert!(same_first_hits(&closed, &open), "the lens tells them apart");
    let expected = features(&closed);
    assert!(features(&open) == expected, "the lens moves them");
    let turned = job(&SCENE.replace("LENS", "vertical_fov = 41"));
    assert!(!same_first_hits(&closed, &turned), "another view counts as the same");
    for kind in AcceleratorKind::ALL {
        let job = job_with(&SCENE.replace("LENS", ""), Files::default(), kind);
        assert!(features(&job) == expected, "{} sees something else", kind.name());
    }
}

#[test]
fn picks_and_maps_say_the_same() {
    let job = scene("");
    let (world, map) = (World::new(job.clone()), features(&job));
    for (x, y) in [(16, 16), (16, 32), (16, 2), (5, 20), (0, 0)] {
        let picked = world.pick(x as f32 + 0.5, y as f32 + 0.5);
        let expected = *map.get(x, y).unwrap();
        let picked_feature = picked.map_or(Feature::NOTHING, |pick| pick.feature);
        assert_eq!(picked_feature, expected, "at {x}, {y}");
        if let Some(pick) = picked {
            let depth = 6.0 - pick.point[2];
            assert!((depth - expected.depth).abs() < 1e-4, "{depth} at {x}, {y}");
        }
    }
}

#[test]
fn costs_are_counted_for_every_pixel() {
    let world = World::new(scene(""));
    let map = cost_map(&world, &AtomicBool::new(false)).unwrap();
    for (index, cost) in map.pixels.iter().enumerate() {
        // The ball and the floor are tested, or the ball's box spares its test.
        let is_counted = (1..=2).contains(&cost.n_primitives) && cost.n_nodes <= 1;
        assert!(is_counted, "{cost:?} at pixel {index}");
    }
    let stopped = cost_map(&world, &AtomicBool::new(true));
    assert!(stopped.is_err(), "goes on although stopped");
}

/// The map of errors is that of the figure: its root mean square.
#[test]
fn the_noise_of_all_pixels_is_the_noise_of_the_picture() {
    let mut job = scene("aperture_radius = 0.3");
    for adaptive in [false, true] {
        job.settings.adaptive = adaptive;
        let film = film(&job, 48);
        let map = film.sampling();
        let squares = map.pixels.iter().map(|pixel| f64::from(pixel.error_percent).powi(2));
        let figure = (squares.sum::<f64>() / map.pixels.len() as f64).sqrt();
        let expected = film.noise_percent().unwrap();
        assert!((figure / expected - 1.0).abs() < 1e-3, "{figure} and {expected}");
        let counts = map.pixels.iter().map(|pixel| u64::from(pixel.n_samples));
        assert_eq!(counts.sum::<u64>(), 48 * 33 * 33, "samples in all");
        let (x, y) = (20, 9);
        assert_eq!(map.get(x, y).unwrap().n_samples, film.samples_at(x, y), "of one pixel");
        let is_even = map.pixels.iter().all(|pixel| pixel.n_samples == 48);
        assert_eq!(is_even, !adaptive, "evenly spread");
    }
}

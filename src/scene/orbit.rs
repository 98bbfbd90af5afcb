//! Moving a camera: turntable orbit, pan, dolly, look about, fly, framing, standard views.
//!
//! Pure functions from one [`CameraDescription`] to the next, in scene units and degrees; they
//! know no mouse and no window. What they give back is always a camera that a scene file accepts:
//! eye and target apart, the view never along `up`, every number finite. A move that would break
//! that gives the camera back as it was.

use crate::math::Aabb;
use crate::scene::description::{CameraDescription, Triple};
use glam::{DQuat, DVec3};

/// How near the view may come to the axis it turns about, in degrees.
const POLE_MARGIN_DEG: f64 = 0.1;
/// Room left around what is framed, as a factor of its radius.
const FRAMING_MARGIN: f64 = 1.05;

/// The directions of the picture in the world: unit vectors, mutually perpendicular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewAxes {
    /// From the eye into the scene.
    pub forward: DVec3,
    /// To the right of the picture.
    pub right: DVec3,
    /// To the top of the picture.
    pub up: DVec3,
}

/// The picture's directions, or `None` where the camera looks along its `up` or nowhere.
pub fn view_axes(camera: &CameraDescription) -> Option<ViewAxes> {
    let forward = (DVec3::from(camera.target) - DVec3::from(camera.eye)).try_normalize()?;
    let right = forward.cross(DVec3::from(camera.up).try_normalize()?);
    if right.length() < 1e-6 {
        return None;
    }
    let right = right.normalize();
    Some(ViewAxes { forward, right, up: right.cross(forward) })
}

/// Distance from the eye to the plane in focus: the one given, else the distance to the target.
pub fn focal_distance(camera: &CameraDescription) -> f64 {
    camera.focal_distance.unwrap_or_else(|| {
        (DVec3::from(camera.target) - DVec3::from(camera.eye)).length().max(f64::MIN_POSITIVE)
    })
}

/// Turns eye and target about `pivot`: `yaw_deg` about the camera's `up`, then `pitch_deg` about
/// the right of the picture. Positive yaw carries the eye to the right of the picture, positive
/// pitch carries it up. The pitch stops just before the view meets `up`.
pub fn orbited(
    camera: &CameraDescription,
    pivot: Triple,
    yaw_deg: f64,
    pitch_deg: f64,
) -> CameraDescription {
    let Some(rotation) = turn(camera, yaw_deg, -pitch_deg) else { return camera.clone() };
    let pivot = DVec3::from(pivot);
    let carried = |point: Triple| (pivot + rotation * (DVec3::from(point) - pivot)).to_array();
    let mut moved = camera.clone();
    moved.eye = carried(camera.eye);
    moved.target = carried(camera.target);
    accepted(camera, moved)
}

/// Turns the view about the eye. Positive yaw looks to the right, positive pitch looks up.
pub fn looked(camera: &CameraDescription, yaw_deg: f64, pitch_deg: f64) -> CameraDescription {
    let Some(rotation) = turn(camera, -yaw_deg, pitch_deg) else { return camera.clone() };
    let eye = DVec3::from(camera.eye);
    let mut moved = camera.clone();
    moved.target = (eye + rotation * (DVec3::from(camera.target) - eye)).to_array();
    accepted(camera, moved)
}

/// Moves the camera in the plane of the picture, in scene units to the right and up.
pub fn panned(camera: &CameraDescription, right: f64, up: f64) -> CameraDescription {
    flown(camera, right, up, 0.0)
}

/// Moves the camera along the picture's directions, in scene units.
pub fn flown(camera: &CameraDescription, right: f64, up: f64, forward: f64) -> CameraDescription {
    let Some(axes) = view_axes(camera) else { return camera.clone() };
    let step = axes.right * right + axes.up * up + axes.forward * forward;
    let mut moved = camera.clone();
    moved.eye = (DVec3::from(camera.eye) + step).to_array();
    moved.target = (DVec3::from(camera.target) + step).to_array();
    accepted(camera, moved)
}

/// Brings the eye to `factor` times its distance from `pivot`, along the line between them; the
/// direction of view stays. Below 1 is nearer. The target keeps its place where the eye moves
/// along the axis, so that a focus that follows the target keeps following it.
pub fn dollied(camera: &CameraDescription, pivot: Triple, factor: f64) -> CameraDescription {
    let eye = DVec3::from(camera.eye);
    let target = DVec3::from(camera.target);
    let pivot = DVec3::from(pivot);
    let step = (eye - pivot) * (factor - 1.0);
    let sideways = step.reject_from(target - eye);
    let mut moved = camera.clone();
    moved.eye = (eye + step).to_array();
    let carried_target = target + sideways;
    moved.target = carried_target.to_array();
    let passes_target = (carried_target - (eye + step)).dot(target - eye) <= 0.0;
    if passes_target {
        moved.target = (target + step).to_array();
    }
    accepted(camera, moved)
}

/// Moves the camera along its view so that the whole of `bounds` is in a picture of that aspect
/// (width / height), and looks at its middle. Empty bounds change nothing.
pub fn framed(camera: &CameraDescription, bounds: &Aabb, aspect: f64) -> CameraDescription {
    let Some(axes) = view_axes(camera) else { return camera.clone() };
    let Some((centre, radius)) = bounding_sphere(bounds) else { return camera.clone() };
    let half_height = (camera.vertical_fov.to_radians() / 2.0).tan();
    let narrower = (half_height * aspect.min(1.0)).atan();
    let distance = (radius * FRAMING_MARGIN / narrower.sin()).max(1e-6);
    let mut moved = camera.clone();
    moved.target = centre.to_array();
    moved.eye = (centre - axes.forward * distance).to_array();
    accepted(camera, moved)
}

/// A direction from which a scene is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandardView {
    /// From +Z.
    Front,
    /// From +X.
    Side,
    /// From +Y, as near to it as a turntable goes.
    Top,
}

/// Looks at `pivot` from a standard side, from as far as now, with +Y up.
pub fn standard_view(
    camera: &CameraDescription,
    pivot: Triple,
    view: StandardView,
) -> CameraDescription {
    let pivot = DVec3::from(pivot);
    let distance = (DVec3::from(camera.eye) - pivot).length();
    let from = match view {
        StandardView::Front => DVec3::Z,
        StandardView::Side => DVec3::X,
        StandardView::Top => {
            let tilt = POLE_MARGIN_DEG.to_radians();
            DVec3::new(0.0, tilt.cos(), tilt.sin())
        }
    };
    let mut moved = camera.clone();
    moved.up = [0.0, 1.0, 0.0];
    moved.target = pivot.to_array();
    moved.eye = (pivot + from * distance).to_array();
    accepted(camera, moved)
}

/// Where a point of the scene appears: x to the right and y down in a picture of `width` by
/// `height` pixels, and its depth along the axis. `None` behind the eye.
pub fn project(
    camera: &CameraDescription,
    point: Triple,
    width: f64,
    height: f64,
) -> Option<(f64, f64, f64)> {
    let axes = view_axes(camera)?;
    let from_eye = DVec3::from(point) - DVec3::from(camera.eye);
    let depth = from_eye.dot(axes.forward);
    if depth <= 1e-9 {
        return None;
    }
    let half_height = (camera.vertical_fov.to_radians() / 2.0).tan() * depth;
    let x = from_eye.dot(axes.right) / (half_height * width / height);
    let y = from_eye.dot(axes.up) / half_height;
    Some(((x + 1.0) / 2.0 * width, (1.0 - y) / 2.0 * height, depth))
}

/// Scene units that one pixel of a picture `height` pixels high spans at that depth.
pub fn units_per_pixel(camera: &CameraDescription, depth: f64, height: f64) -> f64 {
    2.0 * (camera.vertical_fov.to_radians() / 2.0).tan() * depth / height
}

/// Diameter of the blur of a point at that depth, in pixels of a picture `height` pixels high.
pub fn blur_px(camera: &CameraDescription, depth: f64, height: f64) -> f64 {
    let focus = focal_distance(camera);
    // |depth - focus| / depth, which is 1 for what is infinitely far.
    let in_plane_of_focus = 2.0 * camera.aperture_radius * (1.0 - focus / depth).abs();
    in_plane_of_focus / units_per_pixel(camera, focus, height)
}

/// Yaw about `up`, then pitch about the turned right, the pitch held off the poles.
fn turn(camera: &CameraDescription, yaw_deg: f64, pitch_deg: f64) -> Option<DQuat> {
    let axes = view_axes(camera)?;
    let axis = DVec3::from(camera.up).try_normalize()?;
    let elevation_deg = axes.forward.dot(axis).clamp(-1.0, 1.0).asin().to_degrees();
    let limit_deg = 90.0 - POLE_MARGIN_DEG;
    let pitch_deg = (elevation_deg + pitch_deg).clamp(-limit_deg, limit_deg) - elevation_deg;
    let pitch = DQuat::from_axis_angle(axes.right, pitch_deg.to_radians());
    Some(DQuat::from_axis_angle(axis, yaw_deg.to_radians()) * pitch)
}

fn bounding_sphere(bounds: &Aabb) -> Option<(DVec3, f64)> {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let finite = min.is_finite() && max.is_finite() && min.cmple(max).all();
    finite.then(|| ((min + max) / 2.0, (max - min).length() / 2.0))
}

/// The moved camera where a scene file would accept it, else the one before.
fn accepted(before: &CameraDescription, moved: CameraDescription) -> CameraDescription {
    let finite = moved.eye.iter().chain(&moved.target).all(|x| x.is_finite());
    if finite && view_axes(&moved).is_some() { moved } else { before.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> CameraDescription {
        CameraDescription {
            eye: [0.0, 1.0, 5.0],
            target: [0.0, 1.0, 0.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov: 40.0,
            aperture_radius: 0.0,
            focal_distance: None,
            aperture_blades: 0,
        }
    }

    fn distance(a: Triple, b: Triple) -> f64 {
        (DVec3::from(a) - DVec3::from(b)).length()
    }

    #[test]
    fn an_orbit_keeps_the_distance_to_its_pivot_and_a_level_horizon() {
        let pivot = [1.0, 0.5, -1.0];
        let moved = orbited(&camera(), pivot, 33.0, 21.0);
        let (before, after) = (distance(camera().eye, pivot), distance(moved.eye, pivot));
        assert!((before - after).abs() < 1e-9, "{before} became {after}");
        let right = view_axes(&moved).unwrap().right;
        assert!(right.y.abs() < 1e-9, "the horizon tilts by {}", right.y);
        assert!(distance(moved.eye, camera().eye) > 1.0, "the eye stayed at {:?}", moved.eye);
    }

    #[test]
    fn a_positive_orbit_carries_the_eye_right_and_up() {
        let right = orbited(&camera(), camera().target, 10.0, 0.0);
        assert!(right.eye[0] > 0.5, "eye at {:?}", right.eye);
        let up = orbited(&camera(), camera().target, 0.0, 10.0);
        assert!(up.eye[1] > 1.5, "eye at {:?}", up.eye);
    }

    #[test]
    fn an_orbit_stops_at_the_pole_and_comes_back() {
        let mut moved = camera();
        for _ in 0..100 {
            moved = orbited(&moved, [0.0; 3], 7.0, 40.0);
            let axes = view_axes(&moved).expect("the view never meets up");
            let elevation = (-axes.forward.y).asin().to_degrees();
            assert!(elevation <= 90.0 - POLE_MARGIN_DEG + 1e-6, "elevation {elevation}");
        }
        let back = orbited(&moved, [0.0; 3], 0.0, -60.0);
        assert!(back.eye[1] < moved.eye[1] - 1.0, "stuck at {:?}", back.eye);
    }

    #[test]
    fn a_point_under_the_pivot_stays_under_the_cursor_while_the_camera_turns_about_it() {
        let pivot = [0.8, 1.4, 0.3];
        let before = project(&camera(), pivot, 800.0, 600.0).unwrap();
        let moved = orbited(&camera(), pivot, 25.0, 0.0);
        let after = project(&moved, pivot, 800.0, 600.0).unwrap();
        let shift = (before.0 - after.0).abs() + (before.1 - after.1).abs();
        assert!(shift < 1e-6, "moved by {shift} pixels");
    }

    #[test]
    fn looking_about_leaves_the_eye_and_turns_to_the_right() {
        let moved = looked(&camera(), 15.0, 5.0);
        assert_eq!(moved.eye, camera().eye, "the eye moved");
        assert!(moved.target[0] > 0.5 && moved.target[1] > 1.1, "target {:?}", moved.target);
    }

    #[test]
    fn a_pan_by_one_pixel_moves_the_target_by_one_pixel() {
        let step = units_per_pixel(&camera(), 5.0, 600.0);
        let moved = panned(&camera(), step, 0.0);
        let (x, y, _) = project(&moved, camera().target, 800.0, 600.0).unwrap();
        assert!((x - 399.0).abs() < 1e-9 && (y - 300.0).abs() < 1e-9, "at {x}, {y}");
    }

    #[test]
    fn a_dolly_scales_the_distance_and_keeps_the_pivot_where_it_is_in_the_picture() {
        let pivot = [0.8, 1.4, 0.0];
        let before = project(&camera(), pivot, 800.0, 600.0).unwrap();
        let moved = dollied(&camera(), pivot, 0.5);
        let after = project(&moved, pivot, 800.0, 600.0).unwrap();
        let shift = (before.0 - after.0).abs() + (before.1 - after.1).abs();
        assert!(shift < 1e-6, "moved by {shift} pixels");
        let ratio = distance(moved.eye, pivot) / distance(camera().eye, pivot);
        assert!((ratio - 0.5).abs() < 1e-9, "ratio {ratio}");
    }

    #[test]
    fn no_dolly_ever_reaches_the_target() {
        let mut moved = camera();
        for _ in 0..2000 {
            moved = dollied(&moved, [0.0, 1.0, 0.0], 0.9);
            assert!(view_axes(&moved).is_some(), "eye {:?}", moved.eye);
        }
        let past = dollied(&camera(), [0.0, 1.0, -20.0], 0.2);
        let axes = view_axes(&past).unwrap();
        assert!(axes.forward.z < -0.99, "the view turned round: {:?}", axes.forward);
    }

    #[test]
    fn framing_brings_every_corner_into_the_picture() {
        let bounds = Aabb { min: [-3.0, -1.0, 2.0].into(), max: [4.0, 6.0, 3.0].into() };
        for aspect in [0.4, 1.0, 2.5] {
            let moved = framed(&camera(), &bounds, aspect);
            let (width, height) = (1000.0 * aspect, 1000.0);
            for corner in 0..8 {
                let pick = |axis: usize| {
                    let side = if corner >> axis & 1 == 0 { bounds.min } else { bounds.max };
                    f64::from(side[axis])
                };
                let point = [pick(0), pick(1), pick(2)];
                let (x, y, _) = project(&moved, point, width, height).unwrap();
                let inside = (0.0..=width).contains(&x) && (0.0..=height).contains(&y);
                assert!(inside, "corner {point:?} at {x}, {y} of {width} x {height}");
            }
        }
    }

    #[test]
    fn framing_nothing_changes_nothing() {
        assert_eq!(framed(&camera(), &Aabb::EMPTY, 1.0), camera(), "moved to frame nothing");
    }

    #[test]
    fn standard_views_look_along_their_axis_from_the_same_distance() {
        for (view, axis) in [
            (StandardView::Front, DVec3::NEG_Z),
            (StandardView::Side, DVec3::NEG_X),
            (StandardView::Top, DVec3::NEG_Y),
        ] {
            let moved = standard_view(&camera(), camera().target, view);
            let forward = view_axes(&moved).unwrap().forward;
            assert!(forward.dot(axis) > 0.99999, "{view:?} looks along {forward}");
            let away = distance(moved.eye, moved.target);
            assert!((away - 5.0).abs() < 1e-9, "{view:?} is {away} away");
        }
    }

    #[test]
    fn blur_is_what_similar_triangles_say() {
        let mut camera = camera();
        camera.aperture_radius = 0.1;
        // Twice as far as the focus: the cone is as wide as half the lens in the plane of focus.
        let pixel = units_per_pixel(&camera, 5.0, 600.0);
        let blur = blur_px(&camera, 10.0, 600.0);
        assert!((blur - 0.1 / pixel).abs() < 1e-9, "blur {blur}");
        assert_eq!(blur_px(&camera, 5.0, 600.0), 0.0, "the plane of focus is blurred");
    }

    #[test]
    fn moves_that_would_break_the_camera_leave_it() {
        assert_eq!(flown(&camera(), f64::NAN, 0.0, 0.0), camera(), "took NaN");
        assert_eq!(orbited(&camera(), [f64::INFINITY; 3], 1.0, 1.0), camera(), "took inf");
    }
}

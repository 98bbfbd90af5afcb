//! Camera and lens: aperture, focus, field of view, and what is sharp.

use super::lens_diagram::lens_diagram;
use super::{PickFor, subheading};
use crate::scene::description::CameraDescription;
use crate::scene::orbit;
use crate::window::figures::short;
use crate::window::parameter::parameter;
use crate::window::widgets::{Figure, LENGTH, row, switch, triple};
use egui::Ui;

/// Height of the sensor that equivalent f-numbers stand for, in millimetres.
const SENSOR_HEIGHT_MM: f64 = 24.0;
/// Blur below this share of the picture's height counts as sharp: a usual limit in photography.
const SHARP_BLUR: f64 = 1.0 / 1500.0;

/// Lens and place of the camera. `scene_unit_mm` is what one scene unit stands for in the shown
/// f-number; `picking` is set where the next click in the picture sets the focus; `lens_shown` is
/// whether what is sharp is marked in the picture.
pub(in crate::window) fn camera_ui(
    ui: &mut Ui,
    camera: &mut CameraDescription,
    scene_unit_mm: &mut f64,
    picking: &mut Option<PickFor>,
    lens_shown: &mut bool,
) {
    lens_ui(ui, camera, scene_unit_mm, picking);
    let help = "tints what is sharp, with lines where surfaces cross the plane of focus (green) and \
                the limits of sharpness (blue, orange); also while the lens is dragged";
    switch(ui, "Mark what is sharp", "", help, lens_shown);
    subheading(ui, "Place");
    let reach = orbit::focal_distance(camera);
    let speed = (reach * 0.004).max(1e-5);
    let before = camera.clone();
    triple(ui, "Eye", "camera.eye", "where the lens is", LENGTH, speed, &mut camera.eye);
    triple(
        ui,
        "Target",
        "camera.target",
        "the middle of the picture",
        LENGTH,
        speed,
        &mut camera.target,
    );
    triple(ui, "Up", "camera.up", "what is up in the picture", "", 0.01, &mut camera.up);
    if orbit::view_axes(camera).is_none() {
        // A view along its own up, or from a point to itself, is no camera.
        *camera = before;
    }
}

fn lens_ui(
    ui: &mut Ui,
    camera: &mut CameraDescription,
    scene_unit_mm: &mut f64,
    picking: &mut Option<PickFor>,
) {
    let focus = orbit::focal_distance(camera);
    let widest = (focus * 0.2).max(1e-3);
    Figure::new("Aperture", "camera.aperture_radius".to_owned(), 0.0..=widest)
        .allowed(0.0..=1e9)
        .logarithmic(widest * 1e-4)
        .unit(LENGTH)
        .help("radius of the lens: wider is more blur away from the focus, 0 is a pinhole")
        .show(ui, &mut camera.aperture_radius);
    let help = "the lens of a full-frame camera, 36 x 24 mm, that takes this picture: f-number and \
                focal length";
    row(ui, "Full frame", help, |ui| {
        ui.label(equivalent(camera, *scene_unit_mm)).on_hover_text(help);
    });
    row(ui, "Scene unit", "what one scene unit stands for in the f-number", |ui| {
        unit_ui(ui, scene_unit_mm);
    });
    focus_ui(ui, camera, focus, picking);
    Figure::new("Field of view", "camera.vertical_fov".to_owned(), 5.0..=120.0)
        .allowed(0.01..=179.99)
        .unit("°")
        .help("full angle from the bottom of the picture to its top")
        .show(ui, &mut camera.vertical_fov);
    blades_ui(ui, camera);
    lens_diagram(ui, camera, sharp_range(camera));
}

fn focus_ui(
    ui: &mut Ui,
    camera: &mut CameraDescription,
    focus: f64,
    picking: &mut Option<PickFor>,
) {
    let mut distance = focus;
    Figure::new("Focus", "camera.focal_distance".to_owned(), 0.0..=focus_span(camera))
        .allowed(1e-6..=1e12)
        .logarithmic(focus_span(camera) * 1e-3)
        .unit(LENGTH)
        .help("distance to the plane in focus, along the view")
        .show(ui, &mut distance);
    if distance != focus {
        camera.focal_distance = Some(distance);
    }
    row(ui, "", "", |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let is_picking = *picking == Some(PickFor::Focus);
        let button = egui::Button::selectable(is_picking, "Pick in picture");
        let pick = ui
            .add(button.frame_when_inactive(true))
            .on_hover_text("then click on what should be sharp (Ctrl+click does it at once)");
        if pick.clicked() {
            *picking = if is_picking { None } else { Some(PickFor::Focus) };
        }
        let follows = camera.focal_distance.is_none();
        let button = egui::Button::selectable(follows, "On target");
        let follow = ui.add(button.frame_when_inactive(true));
        let follow = follow.on_hover_text("the focus follows the camera's target");
        if follow.clicked() {
            camera.focal_distance = if follows { Some(focus) } else { None };
        }
        parameter(&follow, "On target", "camera.focal_distance");
    });
}

/// The far end of the focus slider: fixed while the focus is dragged, so that it does not run.
fn focus_span(camera: &CameraDescription) -> f64 {
    let away = (0..3).map(|axis| (camera.target[axis] - camera.eye[axis]).powi(2)).sum::<f64>();
    (away.sqrt() * 4.0).max(1e-3)
}

fn blades_ui(ui: &mut Ui, camera: &mut CameraDescription) {
    let mut blades = camera.aperture_blades;
    Figure::new("Blades", "camera.aperture_blades".to_owned(), 0.0..=16.0)
        .allowed(0.0..=16.0)
        .help("corners of the lens opening, seen in far lights: 0 is round, else 3 to 16")
        .show_integer(ui, &mut blades);
    if blades != camera.aperture_blades {
        // One and two corners enclose nothing: the step from round goes to three and back.
        let rising = camera.aperture_blades < blades;
        camera.aperture_blades = match blades {
            1 | 2 if rising => 3,
            1 | 2 => 0,
            other => other,
        };
    }
}

fn unit_ui(ui: &mut Ui, scene_unit_mm: &mut f64) {
    let units = [(1.0, "1 mm"), (10.0, "1 cm"), (100.0, "10 cm"), (1000.0, "1 m")];
    let shown = units.iter().find(|(mm, _)| mm == scene_unit_mm).map_or("", |(_, name)| name);
    let response = egui::ComboBox::from_id_salt("scene unit")
        .width(ui.available_width())
        .selected_text(shown)
        .show_ui(ui, |ui| {
            for (mm, name) in units {
                ui.selectable_value(scene_unit_mm, mm, name);
            }
        })
        .response
        .accessible_name("Scene unit");
    response.on_hover_text("what one scene unit stands for in the f-number");
}

/// Focal length of a full-frame camera with the same view, in millimetres.
fn focal_length_mm(camera: &CameraDescription) -> f64 {
    SENSOR_HEIGHT_MM / 2.0 / (camera.vertical_fov.to_radians() / 2.0).tan()
}

/// The lens of a full-frame camera that takes the same picture: f-number and focal length.
fn equivalent(camera: &CameraDescription, scene_unit_mm: f64) -> String {
    let focal_length = short(focal_length_mm(camera).round());
    format!("{} · {focal_length} mm", f_number(camera, scene_unit_mm))
}

/// The f-number of a full-frame camera with the same view and lens.
fn f_number(camera: &CameraDescription, scene_unit_mm: f64) -> String {
    if camera.aperture_radius <= 0.0 {
        return "pinhole".to_owned();
    }
    let number = focal_length_mm(camera) / (2.0 * camera.aperture_radius * scene_unit_mm);
    if number < 10.0 { format!("f/{number:.1}") } else { format!("f/{}", short(number.round())) }
}

/// Nearest and farthest distance that look sharp; `None` for the far end where it is infinite.
/// A pinhole is sharp everywhere.
pub(in crate::window) fn sharp_range(camera: &CameraDescription) -> (f64, Option<f64>) {
    let diameter = 2.0 * camera.aperture_radius;
    let focus = orbit::focal_distance(camera);
    if diameter <= 0.0 {
        return (0.0, None);
    }
    // The blur of a point at depth z is diameter |z - focus| / z in the plane of focus, where the
    // picture is 2 tan(fov / 2) focus high.
    let height = 2.0 * (camera.vertical_fov.to_radians() / 2.0).tan() * focus;
    let allowed = SHARP_BLUR * height / diameter;
    let far = (allowed < 1.0).then(|| focus / (1.0 - allowed));
    (focus / (1.0 + allowed), far)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(radius: f64) -> CameraDescription {
        CameraDescription {
            eye: [0.0, 0.0, 4.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            vertical_fov: 40.0,
            aperture_radius: radius,
            focal_distance: None,
            aperture_blades: 0,
        }
    }

    #[test]
    fn a_wide_lens_is_sharp_in_a_thin_slice_around_the_focus() {
        let (near, far) = sharp_range(&camera(0.1));
        let far = far.expect("a wide lens blurs the distance");
        assert!(near < 4.0 && 4.0 < far, "sharp from {near} to {far}");
        let (nearer, farther) = sharp_range(&camera(0.05));
        assert!(nearer < near && far < farther.unwrap(), "a closed lens is not sharper");
    }

    #[test]
    fn the_blur_at_the_limits_is_the_allowed_one() {
        let camera = camera(0.1);
        let (near, far) = sharp_range(&camera);
        let height = 2.0 * 20.0_f64.to_radians().tan() * 4.0;
        for depth in [near, far.unwrap()] {
            let blur = 0.2 * (depth - 4.0_f64).abs() / depth / height;
            assert!((blur - SHARP_BLUR).abs() < 1e-12, "blur {blur} at {depth}");
        }
    }

    #[test]
    fn a_pinhole_is_sharp_everywhere() {
        assert_eq!(sharp_range(&camera(0.0)), (0.0, None), "a pinhole blurs");
        assert_eq!(f_number(&camera(0.0), 1000.0), "pinhole", "a pinhole has an f-number");
    }

    #[test]
    fn the_f_number_of_a_known_lens() {
        // 33 mm on full frame at f/1.0 has an opening of 33 mm: radius 0.0165 m.
        let focal_length = 12.0 / 20.0_f64.to_radians().tan();
        let camera = camera(focal_length / 2000.0);
        assert_eq!(equivalent(&camera, 1000.0), "f/1.0 · 33 mm", "wrong lens");
    }
}

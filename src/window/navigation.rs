//! Mouse and keys over the picture, turned into moves of the camera.

use crate::scene::description::{CameraDescription, Triple};
use crate::scene::orbit;
use egui::{Event, Key, MouseWheelUnit, PointerButton, Response, Ui, Vec2};

/// Degrees of orbit for one point of dragging.
const ORBIT_DEG_PER_POINT: f64 = 0.4;
/// Degrees of looking about for one point of dragging.
const LOOK_DEG_PER_POINT: f64 = 0.15;
/// Logarithm of the distance for one point of scrolling: a notch is about a tenth.
const DOLLY_PER_POINT: f64 = 0.0022;
/// Points that one notch of a wheel stands for.
const POINTS_PER_NOTCH: f64 = 48.0;
/// Flying covers this share of the distance to the pivot in a second.
const FLY_PER_SECOND: f64 = 0.8;

/// What navigation remembers between frames. It is no part of the scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Navigation {
    /// The point the camera turns about; `None` is the camera's target.
    pub(super) pivot: Option<Triple>,
    /// Whether a drag is turning the camera now, so that the pivot is shown.
    pub(super) turning: bool,
}

impl Navigation {
    /// The point the camera turns about.
    pub(super) fn pivot(&self, camera: &CameraDescription) -> Triple {
        self.pivot.unwrap_or(camera.target)
    }

    /// Applies what the mouse did over the picture in this frame. `height` is the picture's, in
    /// points.
    pub(super) fn apply(
        &mut self,
        ui: &Ui,
        response: &Response,
        camera: &mut CameraDescription,
        height: f32,
    ) {
        let modifiers = ui.input(|input| input.modifiers);
        let motion = response.drag_delta();
        let dragged = |button| response.dragged_by(button) && motion != Vec2::ZERO;
        self.turning = response.dragged_by(PointerButton::Primary) && !modifiers.shift;
        if dragged(PointerButton::Primary) && !modifiers.shift && !modifiers.command {
            let (x, y) = (f64::from(motion.x), f64::from(motion.y));
            let pivot = self.pivot(camera);
            *camera =
                orbit::orbited(camera, pivot, -x * ORBIT_DEG_PER_POINT, y * ORBIT_DEG_PER_POINT);
        } else if dragged(PointerButton::Middle) || dragged(PointerButton::Primary) {
            self.pan(camera, motion, height);
        } else if dragged(PointerButton::Secondary) && modifiers.command {
            let factor = (f64::from(motion.y) * 0.01).exp();
            *camera = orbit::dollied(camera, self.pivot(camera), factor);
        } else if dragged(PointerButton::Secondary) {
            let (x, y) = (f64::from(motion.x), f64::from(motion.y));
            *camera = orbit::looked(camera, x * LOOK_DEG_PER_POINT, -y * LOOK_DEG_PER_POINT);
        }
        if response.hovered() {
            self.wheel(ui, camera);
        }
        if is_flying(ui.ctx(), response) {
            self.fly(ui, camera);
        }
    }

    fn pan(&self, camera: &mut CameraDescription, motion: Vec2, height: f32) {
        let distance = self.distance(camera);
        let unit = orbit::units_per_pixel(camera, distance, f64::from(height));
        *camera = orbit::panned(camera, -f64::from(motion.x) * unit, f64::from(motion.y) * unit);
    }

    /// The wheel and the pinch, as they come: egui's smoothed scrolling goes on after the hand has
    /// stopped, and would move the camera when the cursor comes over from a panel.
    fn wheel(&self, ui: &Ui, camera: &mut CameraDescription) {
        let factor = ui.input(|input| {
            input.events.iter().fold(1.0, |factor, event| match event {
                Event::MouseWheel { unit, delta, .. } => {
                    let points = f64::from(delta.y)
                        * match unit {
                            MouseWheelUnit::Point => 1.0,
                            MouseWheelUnit::Line => POINTS_PER_NOTCH,
                            MouseWheelUnit::Page => POINTS_PER_NOTCH * 8.0,
                        };
                    factor * (-points * DOLLY_PER_POINT).exp()
                }
                Event::Zoom(pinched) => factor / f64::from(*pinched),
                _ => factor,
            })
        });
        if factor != 1.0 && factor.is_finite() && 0.0 < factor {
            *camera = orbit::dollied(camera, self.pivot(camera), factor);
        }
    }

    fn fly(&self, ui: &Ui, camera: &mut CameraDescription) {
        let (direction, seconds, fast) = ui.input(|input| {
            let axis = |plus, minus| {
                f64::from(u8::from(input.key_down(plus)))
                    - f64::from(u8::from(input.key_down(minus)))
            };
            let direction = [axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S)];
            (direction, f64::from(input.stable_dt.min(0.1)), input.modifiers.shift)
        });
        if direction == [0.0; 3] {
            return;
        }
        let speed = self.distance(camera) * FLY_PER_SECOND * if fast { 4.0 } else { 1.0 };
        let [right, up, forward] = direction.map(|along| along * speed * seconds);
        *camera = orbit::flown(camera, right, up, forward);
        // Flying goes on while the key is down, with or without the mouse.
        ui.request_repaint();
    }

    /// Depth of the pivot along the view, kept above nothing so that moves never stall.
    fn distance(&self, camera: &CameraDescription) -> f64 {
        let target = orbit::project(camera, self.pivot(camera), 1.0, 1.0);
        let depth = target.map_or(0.0, |(_, _, depth)| depth);
        let to_target =
            (0..3).map(|axis| (camera.target[axis] - camera.eye[axis]).powi(2)).sum::<f64>().sqrt();
        if depth > to_target * 1e-3 { depth } else { to_target }
    }
}

/// Whether the right button is held over the picture, so that letters fly and do nothing else.
pub(super) fn is_flying(ctx: &egui::Context, response: &Response) -> bool {
    response.is_pointer_button_down_on() && ctx.input(|input| input.pointer.secondary_down())
}

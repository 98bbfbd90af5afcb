//! Every motion of the hand over the picture moves the camera as the table of keys says, and is one
//! step of undo.

use super::whole::{PATIENCE, scene_file, wait_until, window};
use crate::loader::Source;
use crate::scene::description::CameraDescription;
use crate::scene::orbit;
use crate::window::app::App;
use crate::window::headless::Headless;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Role, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;

const CTRL: Modifiers = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };

struct Hand {
    harness: Harness<'static, App>,
    _folder: tempfile::TempDir,
}

impl Hand {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
        wait_until(&mut harness, |app| app.picture_on_show().is_some());
        Self { harness, _folder: folder }
    }

    fn camera(&self) -> CameraDescription {
        self.harness.state().document.description.camera.clone()
    }

    fn picture(&self) -> egui::Rect {
        self.harness.get_by_role_and_label(Role::Canvas, "Picture").rect()
    }

    /// Presses or lets go.
    fn button(&mut self, at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
        self.harness.event(Event::PointerMoved(at));
        self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        self.harness.run_steps(1);
    }

    /// Drags from the middle of the picture.
    fn drag(&mut self, button: PointerButton, modifiers: Modifiers, by: Vec2) {
        let from = self.picture().center();
        self.harness.event(Event::ModifiersChanged(modifiers));
        self.button(from, button, true, modifiers);
        for step in 1..=8_u8 {
            let at = from + by * (f32::from(step) / 8.0);
            self.harness.event(Event::PointerMoved(at));
            self.harness.run_steps(1);
        }
        self.button(from + by, button, false, modifiers);
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.harness.run_steps(2);
    }

    /// Where a point of the scene is in the picture.
    fn place(&self, point: [f64; 3]) -> [f64; 2] {
        let size = self.picture().size();
        let (width, height) = (f64::from(size.x), f64::from(size.y));
        let (x, y, _) = orbit::project(&self.camera(), point, width, height).expect("in view");
        [x, y]
    }

    /// One step of undo leads back to that camera, one of redo back again.
    fn assert_one_step(&mut self, before: &CameraDescription, what: &str) {
        let after = self.camera();
        assert_ne!(after, *before, "{what} does nothing");
        self.harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        self.harness.run_steps(3);
        assert_eq!(self.camera(), *before, "{what} is not one step of undo");
        self.harness.key_press_modifiers(Modifiers::COMMAND, Key::Y);
        self.harness.run_steps(3);
        assert_eq!(self.camera(), after, "{what} cannot be made again");
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn what_is_in_front_follows_the_hand_that_orbits() {
    let mut hand = Hand::new();
    let (before, [x, y]) = (hand.camera(), hand.place([0.0, 0.2, 1.0]));
    hand.drag(PointerButton::Primary, Modifiers::NONE, vec2(60.0, 40.0));
    let after = hand.camera();
    let [new_x, new_y] = hand.place([0.0, 0.2, 1.0]);
    assert!(x + 5.0 < new_x && y + 5.0 < new_y, "from {x}, {y} to {new_x}, {new_y}");
    let (was, is) = (distance(before.eye, before.target), distance(after.eye, after.target));
    assert!((was - is).abs() < 1e-9, "the distance went from {was} to {is}");
    hand.assert_one_step(&before, "orbiting");
}

#[test]
fn what_is_panned_stays_under_the_hand() {
    for (button, modifiers) in
        [(PointerButton::Middle, Modifiers::NONE), (PointerButton::Primary, Modifiers::SHIFT)]
    {
        let mut hand = Hand::new();
        let (before, [x, y]) = (hand.camera(), hand.place([0.0; 3]));
        hand.drag(button, modifiers, vec2(80.0, -48.0));
        let [new_x, new_y] = hand.place([0.0; 3]);
        let off = (new_x - x - 80.0).abs().max((new_y - y + 48.0).abs());
        assert!(off < 1.0, "{button:?}: from {x}, {y} to {new_x}, {new_y}");
        hand.assert_one_step(&before, "panning");
    }
}

#[test]
fn the_right_button_looks_about_and_with_ctrl_goes_nearer() {
    let mut hand = Hand::new();
    let (before, [x, y]) = (hand.camera(), hand.place([0.0; 3]));
    hand.drag(PointerButton::Secondary, Modifiers::NONE, vec2(60.0, 24.0));
    assert_eq!(hand.camera().eye, before.eye, "looking about moves the eye");
    let [new_x, new_y] = hand.place([0.0; 3]);
    assert!(new_x + 5.0 < x && new_y + 5.0 < y, "from {x}, {y} to {new_x}, {new_y}");
    hand.assert_one_step(&before, "looking about");

    let mut hand = Hand::new();
    hand.drag(PointerButton::Secondary, CTRL, vec2(0.0, -40.0));
    let after = hand.camera();
    let share = distance(after.eye, after.target) / distance(before.eye, before.target);
    assert!((0.5..0.9).contains(&share), "{share} of the distance is left");
    let [x, y] = hand.place([0.0; 3]);
    let middle = hand.picture().size() / 2.0;
    let off = (x - f64::from(middle.x)).abs().max((y - f64::from(middle.y)).abs());
    assert!(off < 0.01, "the middle is {off} away");
    hand.assert_one_step(&before, "going nearer");
}

#[test]
fn letters_fly_while_the_right_button_is_down_and_do_nothing_else() {
    let toward = |key: Key| -> [f64; 3] {
        let mut hand = Hand::new();
        let before = hand.camera();
        let middle = hand.picture().center();
        hand.button(middle, PointerButton::Secondary, true, Modifiers::NONE);
        hand.harness.key_down(key);
        hand.harness.run_steps(3);
        hand.harness.key_up(key);
        hand.harness.run_steps(1);
        hand.button(middle, PointerButton::Secondary, false, Modifiers::NONE);
        let scene = &hand.harness.state().document.description;
        assert_eq!(scene.camera.aperture_radius, before.aperture_radius, "{key:?} is the lens");
        assert_eq!(scene.tone_mapping.exposure, 0.0, "{key:?} is the exposure");
        let after = hand.camera();
        hand.assert_one_step(&before, "flying");
        [0, 1, 2].map(|axis| after.eye[axis] - before.eye[axis])
    };
    for (key, axis, sign) in [
        (Key::W, 2, -1.0),
        (Key::S, 2, 1.0),
        (Key::A, 0, -1.0),
        (Key::D, 0, 1.0),
        (Key::Q, 1, -1.0),
        (Key::E, 1, 1.0),
    ] {
        let moved = toward(key);
        assert!(0.01 < moved[axis] * sign, "{key:?} moves by {moved:?}");
    }
}

#[test]
fn fingers_that_part_go_nearer_and_a_burst_of_scrolling_is_one_step() {
    let mut hand = Hand::new();
    let before = hand.camera();
    hand.harness.hover_at(hand.picture().center());
    hand.harness.run_steps(2);
    for _ in 0..5 {
        hand.harness.event(Event::Zoom(1.1));
        hand.harness.step();
    }
    let share = distance(hand.camera().eye, [0.0; 3]) / distance(before.eye, [0.0; 3]);
    let expected = 1.1_f64.powi(-5);
    assert!((share - expected).abs() < 1e-3, "{share} of the distance is left, not {expected}");
    // The harness lets a quarter of a second pass between frames: less than the rest that ends it.
    hand.assert_one_step(&before, "a burst of pinching");
}

#[test]
fn standard_views_look_along_the_axes_and_home_is_the_scenes_own_camera() {
    let mut hand = Hand::new();
    let home = hand.camera();
    let reach = distance(home.eye, home.target);
    for (key, axis) in [(Key::Num1, 2), (Key::Num3, 0), (Key::Num7, 1)] {
        let before = hand.camera();
        hand.harness.key_press_modifiers(CTRL, key);
        hand.harness.run_steps(3);
        let along = hand.camera().eye[axis] - hand.camera().target[axis];
        assert!((along - reach).abs() < reach * 1e-3, "{key:?}: {along} of {reach}");
        hand.assert_one_step(&before, "a standard view");
    }
    let before = hand.camera();
    hand.harness.key_press(Key::Backspace);
    hand.harness.run_steps(3);
    assert_eq!(hand.camera(), home, "not the scene's own camera");
    hand.assert_one_step(&before, "going home");
}

#[test]
fn ctrl_and_a_click_focus_on_what_is_there() {
    let mut hand = Hand::new();
    let before = hand.camera();
    let middle = hand.picture().center();
    hand.harness.event(Event::ModifiersChanged(CTRL));
    hand.button(middle, PointerButton::Primary, true, CTRL);
    hand.button(middle, PointerButton::Primary, false, CTRL);
    hand.harness.event(Event::ModifiersChanged(Modifiers::NONE));
    wait_until(&mut hand.harness, |app| app.document.description.camera.focal_distance.is_some());
    // A ball of radius 1 in the middle of the view.
    let expected = distance(before.eye, [0.0; 3]) - 1.0;
    let focus = hand.camera().focal_distance.unwrap();
    assert!((focus - expected).abs() < 0.01, "the focus is at {focus}, not at {expected}");
    hand.assert_one_step(&before, "focusing");
}

#[test]
fn a_double_click_makes_the_camera_turn_about_that_point() {
    let mut hand = Hand::new();
    let before = hand.camera();
    let middle = hand.picture().center();
    // The harness lets a quarter of a second pass with each event.
    hand.harness.ctx.options_mut(|options| {
        options.input_options.max_double_click_delay = 2.0;
    });
    for pressed in [true, false, true, false] {
        hand.harness.event(Event::PointerMoved(middle));
        hand.harness.event(Event::PointerButton {
            pos: middle,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        hand.harness.step();
    }
    wait_until(&mut hand.harness, |app| app.interface.navigation.pivot.is_some());
    assert_eq!(hand.camera(), before, "the view changed");
    let pivot = hand.harness.state().interface.navigation.pivot.unwrap();
    let to_surface = distance(before.eye, [0.0; 3]) - 1.0;
    let reach = distance(before.eye, pivot);
    assert!((reach - to_surface).abs() < 0.01, "{pivot:?} is {reach} away, not {to_surface}");
    hand.drag(PointerButton::Primary, Modifiers::NONE, vec2(60.0, 0.0));
    let after = distance(hand.camera().eye, pivot);
    assert!((after - reach).abs() < 1e-9, "turned about something else");
}

#[test]
fn the_wheel_goes_towards_the_point_that_the_camera_turns_about() {
    let mut hand = Hand::new();
    let pivot = [0.8, 0.5, 0.3];
    hand.harness.state_mut().interface.navigation.pivot = Some(pivot);
    let (before, [x, y]) = (hand.camera(), hand.place(pivot));
    hand.harness.hover_at(hand.picture().center());
    hand.harness.run_steps(2);
    hand.harness.event(Event::Zoom(1.5));
    hand.harness.run_steps(2);
    let share = distance(hand.camera().eye, pivot) / distance(before.eye, pivot);
    assert!((share - 1.0 / 1.5).abs() < 1e-3, "{share} of the distance is left");
    let [new_x, new_y] = hand.place(pivot);
    let off = (new_x - x).abs().max((new_y - y).abs());
    assert!(off < 0.01, "from {x}, {y} to {new_x}, {new_y}");
}

#[test]
fn the_whole_scene_and_the_scenes_own_camera_are_turned_about_their_target() {
    let mut hand = Hand::new();
    for key in [Key::Home, Key::Backspace] {
        hand.harness.state_mut().interface.navigation.pivot = Some([0.8, 0.5, 0.3]);
        hand.harness.key_press(key);
        hand.harness.run_steps(3);
        let pivot = hand.harness.state().interface.navigation.pivot;
        assert_eq!(pivot, None, "{key:?} leaves the point of before");
    }
}

#[test]
fn shift_flies_faster() {
    let flown = |modifiers| {
        let mut hand = Hand::new();
        let (before, middle) = (hand.camera(), hand.picture().center());
        hand.harness.event(Event::ModifiersChanged(modifiers));
        hand.button(middle, PointerButton::Secondary, true, modifiers);
        hand.harness.key_down_modifiers(modifiers, Key::W);
        hand.harness.run_steps(2);
        hand.harness.key_up_modifiers(modifiers, Key::W);
        hand.button(middle, PointerButton::Secondary, false, modifiers);
        distance(hand.camera().eye, before.eye)
    };
    let (slow, fast) = (flown(Modifiers::NONE), flown(Modifiers::SHIFT));
    assert!(0.01 < slow && slow * 1.5 < fast, "{slow} without, {fast} with it");
}

#[test]
fn two_clicks_with_ctrl_are_two_clicks_to_focus() {
    let mut hand = Hand::new();
    let middle = hand.picture().center();
    hand.harness.ctx.options_mut(|options| {
        options.input_options.max_double_click_delay = 2.0;
    });
    hand.harness.event(Event::ModifiersChanged(CTRL));
    for pressed in [true, false, true, false] {
        hand.button(middle, PointerButton::Primary, pressed, CTRL);
    }
    wait_until(&mut hand.harness, |app| {
        app.awaited_click.is_none() && app.document.description.camera.focal_distance.is_some()
    });
    let pivot = hand.harness.state().interface.navigation.pivot;
    assert_eq!(pivot, None, "the camera turns about it");
}

#[test]
fn standard_views_look_at_the_point_that_the_camera_turns_about() {
    let mut hand = Hand::new();
    let pivot = [0.8, 0.5, 0.3];
    hand.harness.state_mut().interface.navigation.pivot = Some(pivot);
    let reach = distance(hand.camera().eye, pivot);
    hand.harness.key_press_modifiers(CTRL, Key::Num1);
    hand.harness.run_steps(3);
    let camera = hand.camera();
    let off = distance(camera.target, pivot);
    assert!(off < 1e-9, "it looks at {:?}", camera.target);
    let after = distance(camera.eye, pivot);
    assert!((after - reach).abs() < 1e-9, "from {after} away, not {reach}");
}

#[test]
fn scrolling_that_begins_again_after_a_rest_is_a_step_of_its_own() {
    let mut hand = Hand::new();
    hand.harness.hover_at(hand.picture().center());
    hand.harness.run_steps(2);
    let pinch = |hand: &mut Hand| {
        hand.harness.event(Event::Zoom(1.1));
        // Longer than the rest that ends a burst.
        hand.harness.run_steps(4);
    };
    pinch(&mut hand);
    let between = hand.camera();
    pinch(&mut hand);
    hand.assert_one_step(&between, "the second burst");
}

/// As when a frame takes so long that all of a drag falls into it.
#[test]
fn drags_within_one_frame_turn_the_camera_once_each() {
    let folder = tempfile::tempdir().unwrap();
    let source = Source::File(scene_file(folder.path()));
    let mut window = Headless::new(source, [1024.0, 700.0]).unwrap();
    let since = std::time::Instant::now();
    while !window.has_picture() {
        assert!(since.elapsed() < PATIENCE, "waited in vain for a picture");
        window.frame();
        std::thread::yield_now();
    }
    let eye = |window: &Headless| window.app.document.description.camera.eye;
    let mut eyes = vec![eye(&window)];
    for _ in 0..3 {
        window.drag([60.0, 0.0]);
        window.release();
    }
    for _ in 0..12 {
        window.frame();
        if eyes.last() != Some(&eye(&window)) {
            eyes.push(eye(&window));
        }
    }
    assert_eq!(eyes.len(), 4, "the camera was at {eyes:?}");
    let steps: Vec<f64> = eyes.windows(2).map(|pair| distance(pair[0], pair[1])).collect();
    let same = steps.iter().all(|step| (step - steps[0]).abs() < 1e-9);
    assert!(same && 0.5 < steps[0], "the drags turned it by {steps:?}");
}

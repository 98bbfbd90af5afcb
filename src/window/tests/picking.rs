//! Clicks in the picture that a button asked for: where it is sharp, where a light is, what it
//! lights.

use super::whole::{scene_file, wait_until, window};
use crate::scene::description::Triple;
use crate::window::app::App;
use egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

const SIZE: [f32; 2] = [1024.0, 700.0];

fn ready(folder: &std::path::Path) -> Harness<'static, App> {
    let mut harness = window(&scene_file(folder), SIZE);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    harness
}

fn ask(harness: &mut Harness<'_, App>, button: &str) {
    harness.get_by_role_and_label(Role::Button, button).click_accesskit();
    harness.run_steps(3);
    assert!(harness.state().interface.picking.is_some(), "{button} waits for no click");
}

/// Clicks on the ball in the middle of the picture; gives back the point of its surface there.
fn click_on_ball(harness: &mut Harness<'_, App>) -> Triple {
    let at = harness.get_by_role_and_label(Role::Canvas, "Picture").rect().center();
    // Apart from a click before, or the two are a double click.
    harness.run_steps(8);
    harness.drag_at(at);
    harness.run_steps(1);
    harness.drop_at(at);
    harness.run_steps(2);
    wait_until(harness, |app| app.awaited_click.is_none());
    // A ball of radius 1 about the target.
    let eye = harness.state().document.description.camera.eye;
    let length = eye.iter().map(|x| x * x).sum::<f64>().sqrt();
    eye.map(|x| x / length)
}

fn assert_near(found: Triple, expected: Triple, what: &str) {
    let off = (0..3).map(|axis| (found[axis] - expected[axis]).abs()).fold(0.0, f64::max);
    assert!(off < 0.02, "{what} is at {found:?}, not at {expected:?}");
}

#[test]
fn a_button_and_a_click_focus_and_the_next_click_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = ready(folder.path());
    ask(&mut harness, "Pick in picture");
    click_on_ball(&mut harness);
    let camera = harness.state().document.description.camera.clone();
    let expected = 26.0_f64.sqrt() - 1.0;
    let focus = camera.focal_distance.expect("there is a focus");
    assert!((focus - expected).abs() < 0.01, "the focus is at {focus}, not at {expected}");
    harness.state_mut().document.description.camera.focal_distance = Some(2.0);
    harness.run_steps(2);
    click_on_ball(&mut harness);
    let focus = harness.state().document.description.camera.focal_distance;
    assert_eq!(focus, Some(2.0), "a click that nobody asked for focuses");
}

#[test]
fn a_light_is_aimed_and_put_where_the_hand_clicks_in_one_step_each() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = ready(folder.path());
    let before = harness.state().document.description.clone();
    ask(&mut harness, "Aim it…");
    let point = click_on_ball(&mut harness);
    assert_near(harness.state().document.description.lights[0].target, point, "the target");
    let aimed = harness.state().document.description.clone();
    ask(&mut harness, "Put it…");
    click_on_ball(&mut harness);
    let eye = before.camera.eye;
    // Off the surface, so that it shines.
    let off = [0, 1, 2].map(|axis| point[axis] + (eye[axis] - point[axis]) * 0.12);
    assert_near(harness.state().document.description.lights[0].position, off, "the light");
    for expected in [aimed, before] {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(3);
        assert_eq!(harness.state().document.description, expected, "not one step each");
    }
}

#[test]
fn a_click_opens_the_groups_of_what_is_there_and_brings_them_into_sight() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = ready(folder.path());
    let group = |harness: &Harness<'_, App>, title: &str| {
        let node = harness.get_by_role_and_label(Role::DisclosureTriangle, title);
        let is_open = node.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True);
        (is_open, node.rect())
    };
    harness.get_by_role_and_label(Role::DisclosureTriangle, "Materials").click_accesskit();
    harness.run_steps(8);
    for title in ["Materials", "Scene"] {
        assert!(!group(&harness, title).0, "{title} is open before the click");
    }
    click_on_ball(&mut harness);
    harness.run_steps(12);
    let (is_open, materials) = group(&harness, "Materials");
    assert!(is_open && group(&harness, "Scene").0, "a group stays closed");
    let ball = harness.get_by_role_and_label(Role::SpinButton, "Alpha x").rect();
    for (name, rect) in [("the title", materials), ("alpha x", ball)] {
        let seen = 38.0 <= rect.top() && rect.bottom() <= SIZE[1] - 26.0;
        assert!(seen, "{name} is at {rect:?}");
    }
}

#[test]
fn a_group_in_sight_stays_where_it_is_when_it_is_clicked_for() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 1100.0]);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    let title = |harness: &Harness<'_, App>| {
        harness.get_by_role_and_label(Role::DisclosureTriangle, "Materials").rect().top()
    };
    let scroll = |harness: &mut Harness<'_, App>, points: f32| {
        harness.hover_at(egui::pos2(900.0, 600.0));
        harness.run_steps(2);
        harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, points),
            source: egui::MouseWheelSource::Wheel,
            phase: egui::TouchPhase::Move,
            modifiers: Modifiers::NONE,
        });
        harness.run_steps(12);
    };
    click_on_ball(&mut harness);
    harness.run_steps(12);
    // Whole in sight, and neither at the top nor at the foot.
    let to_go = 160.0 - title(&harness);
    scroll(&mut harness, to_go);
    let before = title(&harness);
    assert!((100.0..220.0).contains(&before), "the title is at {before}");
    click_on_ball(&mut harness);
    harness.run_steps(12);
    assert_eq!(title(&harness), before, "the panel moved for nothing");
}

#[test]
fn escape_lets_go_of_a_click_that_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = ready(folder.path());
    ask(&mut harness, "Put it…");
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(harness.state().interface.picking.is_none(), "it still waits");
    let before = harness.state().document.description.clone();
    click_on_ball(&mut harness);
    assert_eq!(harness.state().document.description, before, "the light went there");
}

#[test]
fn a_light_is_chosen_by_its_mark_with_a_click_and_with_a_drag() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = ready(folder.path());
    let app = harness.state_mut();
    app.interface.lights_shown = true;
    let lights = &mut app.document.description.lights;
    for (name, position) in [("rim", [-0.8, 0.4, 0.0]), ("beyond", [60.0, 0.0, 0.0])] {
        let mut light = lights[0].clone();
        (light.name, light.position) = (name.to_owned(), position);
        lights.push(light);
    }
    lights[0].position = [0.8, 0.4, 0.0];
    harness.run_steps(8);
    let mark = |harness: &Harness<'_, App>, label: &str| {
        harness.get_by_role_and_label(Role::Button, label).rect().center()
    };
    let chosen = |harness: &Harness<'_, App>| harness.state().interface.selection.light;
    assert_eq!(chosen(&harness), 0, "at first");
    for (label, expected) in [
        ("Light rim in the picture", 1),
        ("Light beyond beyond the picture", 2),
        ("Light key in the picture", 0),
    ] {
        let at = mark(&harness, label);
        harness.drag_at(at);
        harness.run_steps(1);
        harness.drop_at(at);
        harness.run_steps(2);
        assert_eq!(chosen(&harness), expected, "after a click on {label}");
        harness.run_steps(8);
    }
    let at = mark(&harness, "Light rim in the picture");
    harness.drag_at(at);
    harness.run_steps(1);
    for step in [8.0, 16.0] {
        harness.hover_at(at + egui::vec2(step, 0.0));
        harness.run_steps(1);
    }
    assert_eq!(chosen(&harness), 1, "while it is dragged");
    harness.drop_at(at + egui::vec2(16.0, 0.0));
    harness.run_steps(2);
    assert_eq!(chosen(&harness), 1, "after a drag");
    let positions = |app: &App| -> Vec<f64> {
        app.document.description.lights.iter().map(|light| light.position[0]).collect()
    };
    let [key, rim, beyond] = positions(harness.state())[..] else { panic!("other lights") };
    assert!((key, beyond) == (0.8, 60.0) && -0.8 < rim, "it moved {key}, {rim}, {beyond}");
}

//! Every control that is shown says who it is and does something.

use std::time::{Duration, Instant};

use super::bench::Bench;
use super::parameters::{for_each_view, full_scene};
use super::whole::{scene_file, wait_until, window};
use crate::session::Phase;
use crate::window::app::App;
use crate::window::panels::SizeMode;
use egui::{Event, Key, Modifiers, Role, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

/// What a hand can use.
const ROLES: [Role; 7] = [
    Role::Button,
    Role::CheckBox,
    Role::ComboBox,
    Role::ColorWell,
    Role::Slider,
    Role::SpinButton,
    Role::TextInput,
];

/// A control: its role, its name, and how many of both come before it.
type Control = (Role, String, usize);

/// Every control that can be used now. One of several that is chosen already does nothing.
fn controls<State>(harness: &Harness<'_, State>) -> Vec<Control> {
    let mut found: Vec<(Control, bool)> = Vec::new();
    for role in ROLES {
        for node in harness.query_all_by_role(role) {
            let node = node.accesskit_node();
            let name = node.label().unwrap_or_default();
            let is_chosen =
                role == Role::Button && node.toggled() == Some(egui::accesskit::Toggled::True);
            let nth = found.iter().filter(|(one, _)| one.0 == role && one.1 == name).count();
            found.push(((role, name, nth), !is_chosen && !node.is_disabled()));
        }
    }
    found.into_iter().filter(|(_, is_usable)| *is_usable).map(|(one, _)| one).collect()
}

/// Uses a control as its role says.
fn drive<State>(harness: &mut Harness<'_, State>, (role, name, nth): &Control, value: f64) {
    let mut all = harness.get_all_by_role_and_label(*role, name);
    let node = all.nth(*nth).expect("a control that was there");
    match role {
        Role::Slider | Role::SpinButton => node.set_value_accesskit(value),
        _ => node.click(),
    }
    drop(all);
    harness.run_steps(3);
    if *role == Role::TextInput {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.event(Event::Text("other".to_owned()));
        harness.key_press(Key::Enter);
        harness.run_steps(3);
    }
}

fn n_nodes<State>(harness: &Harness<'_, State>) -> usize {
    harness.query_all_by(|_| true).count()
}

#[test]
fn every_control_of_the_panels_is_named_and_does_something() {
    let mut n_driven = 0;
    for_each_view(&full_scene(), |harness: &mut Harness<'_, Bench>| {
        let before = harness.state().clone();
        for control in controls(harness) {
            assert!(!control.1.trim().is_empty(), "a {:?} without a name", control.0);
            let mut has_effect = false;
            for value in [3.0, 0.37, 5.0, 1.0] {
                harness.state_mut().clone_from(&before);
                harness.run_steps(2);
                let n_before = n_nodes(harness);
                drive(harness, &control, value);
                has_effect = format!("{:?}", harness.state()) != format!("{before:?}")
                    || n_nodes(harness) != n_before;
                if has_effect {
                    break;
                }
            }
            assert!(has_effect, "{control:?} does nothing");
            n_driven += 1;
            // Whatever it opened.
            harness.key_press(Key::Escape);
            harness.run_steps(3);
        }
        harness.state_mut().clone_from(&before);
    });
    assert!(450 < n_driven, "only {n_driven} controls were driven");
}

/// What the window is like, but for what it says.
fn look(harness: &Harness<'_, App>) -> String {
    let app = harness.state();
    let generation = app.work.session.latest().map(|frame| frame.generation);
    let (interface, scene) = (&app.interface, &app.document.description);
    let files = (app.files.has_scene, app.pinned.is_some(), app.snapshot_wanted);
    format!("{interface:?} {scene:?} {files:?} {generation:?} {}", n_nodes(harness))
}

/// A window at rest, with something to undo and something to do again.
fn window_at_rest(path: &std::path::Path, size: [f32; 2]) -> Harness<'static, App> {
    let mut harness = window(path, size);
    let folder = path.parent().unwrap().to_owned();
    let app = harness.state_mut();
    // As where the system has no dialogs: a box opens.
    app.dialogs.chooser = Box::new(|_, _| Box::pin(std::future::ready(None)));
    app.interface.export.folder = Some(folder);
    // A picture that costs nothing.
    app.interface.size_mode = SizeMode::Fixed;
    let scene = &mut app.document.description;
    (scene.render.width, scene.render.height) = (48, 27);
    scene.camera.eye = [3.0, 2.0, 4.0];
    for key in [Key::D, Key::E] {
        harness.key_press(key);
        harness.run_steps(2);
    }
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    // What was said passes by.
    harness.run_steps(32);
    wait_until(&mut harness, |app| {
        let shown = app.picture_on_show().map(|image| image.size);
        let size = app.viewport.size.map(|side| side as usize);
        app.work.session.status().phase == Phase::Done && shown == Some(size)
    });
    harness.run_steps(2);
    harness
}

/// Uses a control; gives back whether anything came of it.
fn has_effect(harness: &mut Harness<'_, App>, control: &Control) -> bool {
    let before = look(harness);
    drive(harness, control, 2.0);
    let mut asked_for = false;
    // What is written or rendered meanwhile takes as long as the machine is busy.
    let patience = Instant::now() + Duration::from_secs(20);
    while Instant::now() < patience {
        asked_for |= look(harness) != before;
        let commands = &harness.output().platform_output.commands;
        asked_for |= !commands.is_empty();
        asked_for |= !harness.output().viewport_output[&ViewportId::ROOT].commands.is_empty();
        if asked_for {
            return true;
        }
        harness.step();
        std::thread::sleep(Duration::from_millis(1));
    }
    false
}

#[test]
fn every_button_of_the_bars_and_every_line_of_the_menus_does_something() {
    const SIZE: [f32; 2] = [1024.0, 700.0];
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let panel_hidden = |harness: &mut Harness<'_, App>| {
        harness.state_mut().interface.panel_shown = false;
        harness.run_steps(3);
    };
    let mut n_driven = 0;
    for menu in [None, Some("File"), Some("View")] {
        let open = || {
            let mut harness = window_at_rest(&path, SIZE);
            panel_hidden(&mut harness);
            let bars = controls(&harness);
            if let Some(menu) = menu {
                harness.get_by_role_and_label(Role::Button, menu).click();
                harness.run_steps(4);
            }
            (harness, bars)
        };
        let (harness, bars) = open();
        let mut lines = controls(&harness);
        if menu.is_some() {
            lines.retain(|line| !bars.contains(line));
        }
        drop(harness);
        for line in lines {
            assert!(!line.1.trim().is_empty(), "a {:?} without a name", line.0);
            let (mut harness, _) = open();
            assert!(has_effect(&mut harness, &line), "{menu:?}: {line:?} does nothing");
            n_driven += 1;
        }
    }
    assert!(35 < n_driven, "only {n_driven} were driven");
}

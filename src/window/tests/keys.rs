//! Keys beside menus, and keys that are held.

use super::whole::{scene_file, wait_until, window, window_with};
use crate::loader::Source;
use crate::window::app::App;
use crate::window::state::Remembered;
use crate::window::views::View;
use egui::{Event, Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;

const SIZE: [f32; 2] = [1024.0, 700.0];

/// Holds a key for so many frames, as a keyboard sends it.
fn hold(harness: &mut Harness<'_, App>, key: Key, n_frames: usize) {
    let event = |pressed| Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    for _ in 0..n_frames {
        harness.event(event(true));
        harness.run_steps(1);
    }
    harness.event(event(false));
    harness.run_steps(2);
}

#[test]
fn a_key_that_is_held_switches_once_and_steps_again_and_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    for n_frames in [2, 3] {
        hold(&mut harness, Key::Space, n_frames);
        let is_paused = harness.state().interface.is_paused;
        assert_eq!(is_paused, n_frames == 2, "held for {n_frames} frames it switches back");
    }
    hold(&mut harness, Key::E, 4);
    let exposure = harness.state().document.description.tone_mapping.exposure;
    assert_eq!(exposure, 2.0, "a held key does not step");
}

#[test]
fn keys_alone_do_nothing_in_a_text_field_and_all_they_do_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let view = |harness: &Harness<'_, App>| harness.state().interface.display.view;
    for (role, name) in [(Role::Slider, "Aperture"), (Role::Button, "Pick in picture")] {
        harness.get_by_role_and_label(role, name).focus();
        harness.run_steps(2);
        for (key, shown) in [(Key::Num2, View::Albedo), (Key::Num1, View::Picture)] {
            harness.key_press(key);
            harness.run_steps(2);
            assert_eq!(view(&harness), shown, "{key:?} while {name} has the focus");
        }
    }
    harness.key_press(Key::Space);
    harness.run_steps(2);
    let interface = &harness.state().interface;
    assert!(interface.picking.is_some(), "Space does not press the button that has the focus");
    assert!(!interface.is_paused, "Space does two things");
    harness.get_by_role_and_label(Role::SpinButton, "Aperture").click();
    harness.run_steps(3);
    harness.key_press(Key::Num2);
    harness.run_steps(2);
    assert_eq!(view(&harness), View::Picture, "a key alone acts in a text field");
}

#[test]
fn the_loupe_stays_for_as_long_as_its_key_is_held() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    let press = |pressed| Event::Key {
        key: Key::L,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    for n_repeats in 0..9 {
        harness.event(press(true));
        harness.run_steps(1);
        assert!(harness.state().interface.loupe.shown, "gone after {n_repeats} repeats");
    }
    harness.event(press(false));
    harness.run_steps(2);
    assert!(!harness.state().interface.loupe.shown, "it stays after a long press");
}

#[test]
fn escape_closes_an_open_menu_and_nothing_behind_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    harness.state_mut().toasts.fail("something went wrong");
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::Button, "File").click();
    harness.run_steps(4);
    assert!(harness.query_by_label_contains("Close scene").is_some(), "no menu");
    harness.key_press(Key::Escape);
    harness.run_steps(4);
    assert!(harness.query_by_label_contains("Close scene").is_none(), "the menu stays open");
    assert!(harness.query_by_label("something went wrong").is_some(), "the message went too");
    harness.key_press(Key::Escape);
    harness.run_steps(4);
    assert!(harness.query_by_label("something went wrong").is_none(), "the message stays");
}

#[test]
fn a_click_beside_an_open_menu_only_closes_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    harness.state_mut().interface.panel_shown = false;
    harness.run_steps(3);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    let at = harness.get_by_role_and_label(Role::Canvas, "Picture").rect().center();
    for chooses in [false, true] {
        if !chooses {
            harness.get_by_role_and_label(Role::Button, "View").click();
            harness.run_steps(4);
            assert!(harness.query_by_label_contains("Pin and compare").is_some(), "no menu");
        }
        // Apart from the click before, or the two are a double click.
        harness.run_steps(8);
        harness.drag_at(at);
        harness.run_steps(1);
        harness.drop_at(at);
        harness.run_steps(2);
        wait_until(&mut harness, |app| app.awaited_click.is_none());
        let told = harness.query_by_label_contains("ball, glaze: shown in the panel").is_some();
        assert_eq!(told, chooses, "the click went to the picture: {told}");
        assert!(harness.query_by_label_contains("Pin and compare").is_none(), "the menu stays");
    }
}

#[test]
fn keys_come_from_the_file_and_what_is_wrong_in_it_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let own = folder.path().join("own");
    std::fs::create_dir(&own).unwrap();
    std::fs::write(own.join("keys.toml"), "toggle-lens = \"L\"\npuase = \"P\"\n").unwrap();
    let mut harness = window_with(&path, [1024.0, 700.0], Some(own));
    assert!(harness.query_by_label_contains("did you mean pause?").is_some(), "not told");
    let open = harness.state().document.description.camera.aperture_radius;
    for (key, closes) in [(Key::D, false), (Key::L, true), (Key::L, false), (Key::D, false)] {
        harness.key_press(key);
        harness.run_steps(2);
        let radius = harness.state().document.description.camera.aperture_radius;
        assert_eq!(radius, if closes { 0.0 } else { open }, "{key:?} leaves another lens");
    }
}

#[test]
fn text_and_controls_grow_shrink_and_are_as_large_at_the_next_start() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZE);
    assert_eq!(harness.ctx.pixels_per_point(), 1.0, "at first");
    for (key, scale) in [(Key::Plus, 1.1), (Key::Equals, 1.2), (Key::Minus, 1.1)] {
        harness.key_press_modifiers(Modifiers::COMMAND, key);
        harness.run_steps(3);
        assert_eq!(harness.ctx.pixels_per_point(), scale, "after {key:?}");
        assert_eq!(harness.state().interface.scale, scale, "after {key:?}");
    }
    let remembered = Remembered::of(&harness.state().interface);
    let ctx = egui::Context::default();
    let source = Source::Gallery("pyramid");
    let next = App::new(&ctx, remembered, source, None).unwrap();
    ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
    assert_eq!((next.interface.scale, ctx.zoom_factor()), (1.1, 1.1), "at the next start");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Num0);
    harness.run_steps(3);
    assert_eq!(harness.ctx.pixels_per_point(), 1.0, "as the system has it");
}

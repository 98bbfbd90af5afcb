//! The picture's views, the loupe, the lens in the picture, the pinned picture alone, and pixels of
//! fine screens.

use super::whole::{drag, scene_file, wait_until, window, window_at};
use crate::scene::description::ColorOrTexture;
use crate::window::app::App;
use crate::window::panels::SizeMode;
use crate::window::views::View;
use egui::{Key, Role, ThemePreference};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

const KEYS: [Key; 8] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8];

fn is_done(app: &App) -> bool {
    app.work.session.status().phase == crate::session::Phase::Done
}

fn picture(harness: &Harness<'_, App>) -> egui::Rect {
    harness.get_by_role_and_label(Role::Canvas, "Picture").rect()
}

/// Each key shows its view, with a legend that names figures and unit, from the samples that are
/// there.
#[test]
fn the_number_keys_show_the_views_without_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    wait_until(&mut harness, is_done);
    let before = harness.state().work.session.status();
    let mut images = Vec::new();
    for (key, view) in KEYS.into_iter().zip(View::ALL) {
        harness.key_press(key);
        harness.run_steps(2);
        assert_eq!(harness.state().interface.display.view, view, "{key:?} shows another view");
        let shown = |app: &App| match view {
            View::Picture => app.picture.legend().is_none(),
            other => app.picture.legend().is_some_and(|legend| legend.view == other),
        };
        wait_until(&mut harness, shown);
        let told = match view {
            View::Picture => None,
            View::Albedo => Some("0 to 1"),
            View::Normals => Some("+X"),
            View::Depth => Some("scene units"),
            View::Blur => Some("px wide"),
            View::Cost => Some("nodes and tests"),
            View::Samples => Some("4 in every pixel"),
            View::Noise => Some("%"),
        };
        if let Some(told) = told {
            let legend = harness.get_all_by_role(Role::Image).find_map(|node| {
                let label = node.accesskit_node().label()?;
                label.starts_with(view.name()).then_some(label)
            });
            let label = legend.unwrap_or_default();
            assert!(label.contains(told), "{view:?} is explained by {label:?}");
        }
        images.push(harness.state().picture_on_show().unwrap().pixels.clone());
    }
    for (index, one) in images.iter().enumerate() {
        for (other_index, other) in images.iter().enumerate().skip(index + 1) {
            // Equal counts in all pixels say nothing else.
            assert!(one != other, "views {} and {} look the same", index + 1, other_index + 1);
        }
    }
    let after = harness.state().work.session.status();
    assert_eq!(before.generation, after.generation, "rendered again");
    assert_eq!(after.samples, 4, "samples were lost");
}

/// Letters stand for what is under the cursor: name of the object, its material, its depth.
#[test]
fn the_loupe_tells_all_that_is_known_of_a_pixel() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1200.0, 800.0]);
    wait_until(&mut harness, is_done);
    harness.hover_at(picture(&harness).center());
    harness.run_steps(2);
    let count = |harness: &Harness<'_, App>, told: &str| harness.query_all_by_label(told).count();
    let before = ["ball", "glaze"].map(|told| count(&harness, told));
    harness.key_press(Key::L);
    wait_until(&mut harness, |app| {
        app.work.session.latest().is_some_and(|frame| frame.maps.features.is_some())
    });
    assert!(harness.query_by_label("Loupe").is_some(), "no loupe");
    for (told, before) in ["ball", "glaze"].into_iter().zip(before) {
        assert_eq!(count(&harness, told), before + 1, "{told} is not told");
    }
    // The ball's front is its radius before the target, which is in focus.
    let distance = 26.0_f64.sqrt();
    let app = harness.state();
    let probed = app.probe.answer().expect("nothing is known");
    assert!((probed.depth - (distance - 1.0)).abs() < 0.01, "depth {}", probed.depth);
    let height = f64::from(app.viewport.size[1]);
    let in_focus = 2.0 * 20.0_f64.to_radians().tan() * distance;
    let expected = 0.1 * 1.0 / (distance - 1.0) / in_focus * height;
    assert!((probed.blur_px - expected).abs() < 0.05, "{} not {expected} px", probed.blur_px);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(harness.query_by_label("Loupe").is_none(), "Esc leaves it open");
}

#[test]
fn what_is_sharp_is_marked_while_the_lens_is_dragged_and_where_it_is_switched_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1200.0, 800.0]);
    let is_marked =
        |harness: &Harness<'_, App>| harness.query_by_label_contains("Lens: sharp").is_some();
    assert!(!is_marked(&harness), "marked from the start");
    let slider = harness.get_by_role_and_label(Role::Slider, "Focus").rect();
    harness.drag_at(slider.center());
    harness.run_steps(1);
    harness.hover_at(slider.center() + egui::vec2(20.0, 0.0));
    harness.run_steps(2);
    assert!(is_marked(&harness), "not marked while the focus is dragged");
    harness.drop_at(slider.center() + egui::vec2(20.0, 0.0));
    harness.run_steps(2);
    assert!(!is_marked(&harness), "marked after the drag");
    harness.get_by_role_and_label(Role::CheckBox, "Mark what is sharp").click();
    harness.run_steps(2);
    assert!(is_marked(&harness), "the switch does nothing");
}

#[test]
fn the_pinned_picture_is_shown_alone_while_its_key_is_held() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1200.0, 800.0]);
    wait_until(&mut harness, is_done);
    let is_alone =
        |harness: &Harness<'_, App>| harness.query_by_label("Pinned picture alone").is_some();
    harness.key_press(Key::X);
    harness.run_steps(2);
    harness.key_down(Key::Backtick);
    harness.run_steps(2);
    assert!(is_alone(&harness), "held, yet not shown");
    harness.key_up(Key::Backtick);
    harness.run_steps(2);
    assert!(!is_alone(&harness), "shown after the key was let go");
}

/// A picture that follows the window has one pixel for each of the screen's, however fine.
#[test]
fn pictures_are_rendered_in_the_pixels_of_the_screen() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for per_point in [1.0, 1.5, 2.0] {
        let mut harness = window_at(&path, [700.0, 460.0], per_point, ThemePreference::Dark);
        wait_until(&mut harness, |app| {
            let image = app.picture_on_show().map(|image| image.size[0]);
            is_done(app) && image == Some(app.viewport.size[0] as usize)
        });
        let rect = picture(&harness);
        let app = harness.state();
        let expected = [rect.width() * per_point, rect.height() * per_point].map(f32::round);
        assert_eq!(app.viewport.size.map(|side| side as f32), expected, "at {per_point}");
        let image = app.picture_on_show().unwrap();
        assert_eq!(image.size.map(|side| side as f32), expected, "shown at {per_point}");
        assert!((app.viewport.zoom_percent - 100.0).abs() < 1e-3, "{}", app.viewport.zoom_percent);
        harness.state_mut().interface.display.zoom = crate::window::viewport::Zoom::Double;
        harness.run_steps(2);
        let zoom = harness.state().viewport.zoom_percent;
        assert!((zoom - 200.0).abs() < 1e-3, "{zoom} at {per_point}");
        let bar = harness.get_by_role_and_label(Role::ScrollBar, "Scroll sideways").rect();
        drag(&mut harness, bar.center(), egui::vec2(500.0, 0.0));
        let scroll = harness.state().interface.display.scroll;
        assert_eq!((scroll.x, scroll.y), (1.0, 0.5), "the bar moves the picture elsewhere");
    }
}

#[test]
fn a_click_shows_the_object_and_its_material_in_the_panel() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1400.0, 900.0]);
    wait_until(&mut harness, |app| app.picture_on_show().is_some());
    let scene = &mut harness.state_mut().document.description;
    // One that is not there, before the one that is.
    let mut absent = scene.objects[0].clone();
    absent.name = "absent".to_owned();
    absent.enabled = false;
    scene.objects.insert(0, absent);
    scene.objects[1].material = Some("plain".to_owned());
    scene.materials[1].diffuse = ColorOrTexture::Texture("waves".to_owned());
    let mut waves = scene.textures[0].clone();
    waves.name = "waves".to_owned();
    scene.textures.push(waves);
    let before = scene.clone();
    harness.run_steps(3);
    let picture = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
    for (at, object) in [(picture.left_top() + egui::vec2(4.0, 4.0), 0), (picture.center(), 1)] {
        harness.drag_at(at);
        harness.run_steps(1);
        harness.drop_at(at);
        harness.run_steps(2);
        wait_until(&mut harness, |app| app.awaited_click.is_none());
        let chosen = &harness.state().interface.selection;
        assert_eq!((chosen.object, chosen.material, chosen.texture), (object, object, object));
        let told = harness.query_by_label_contains("shown in the panel");
        assert!(told.is_none(), "what the panel shows is said as well");
    }
    assert_eq!(harness.state().document.description, before, "a click is an edit");
}

#[test]
fn a_picture_keeps_the_scenes_shape_in_a_window_of_any_other() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(SizeMode::default(), SizeMode::Fit, "another size at first");
    for (size, is_wide) in [([1400.0, 560.0], true), ([900.0, 900.0], false)] {
        let mut harness = window(&scene_file(folder.path()), size);
        harness.state_mut().interface.size_mode = SizeMode::Fit;
        wait_until(&mut harness, |app| {
            let frame = app.work.session.latest();
            frame.is_some_and(|frame| [frame.job.width, frame.job.height] == app.viewport.size)
        });
        let room = harness.get_by_role_and_label(Role::Canvas, "Picture").rect().size();
        let [width, height] = harness.state().viewport.size.map(|side| side as f32);
        assert!((width / height - 16.0 / 9.0).abs() < 0.01, "{width}x{height}: another shape");
        let left = [room.x - width, room.y - height];
        let (free, full) = if is_wide { (left[0], left[1]) } else { (left[1], left[0]) };
        assert!(full.abs() <= 1.0 && 10.0 < free, "{width}x{height} in {room:?}");
    }
}

#[test]
fn what_is_sharp_is_marked_while_the_lens_is_dragged_and_no_longer() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), [1024.0, 700.0]);
    let marks = |harness: &Harness<'_, App>| harness.state().marks_sharpness(&harness.ctx);
    assert!(!marks(&harness), "at rest");
    for (slider, is_lens) in [("Aperture", true), ("Field of view", false), ("Focus", true)] {
        let at = harness.get_by_role_and_label(Role::Slider, slider).rect().center();
        harness.drag_at(at);
        harness.run_steps(1);
        for step in [6.0, 12.0] {
            harness.hover_at(at + egui::vec2(step, 0.0));
            harness.run_steps(1);
        }
        assert_eq!(marks(&harness), is_lens, "while {slider} is dragged");
        harness.drop_at(at + egui::vec2(12.0, 0.0));
        harness.run_steps(2);
        assert!(!marks(&harness), "after {slider} was dragged");
    }
    // A key is no hand that drags, also while its edit is the newest.
    harness.key_press(Key::D);
    harness.step();
    assert!(!marks(&harness), "after a key");
    harness.run_steps(3);
    assert!(!marks(&harness), "after a key");
}

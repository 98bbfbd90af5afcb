//! Nothing overlaps, is cut off or leaves the window, small and large, menus and boxes too.

use super::whole::{scene_file, wait_until, window_at, window_of};
use crate::window::app::App;
use crate::window::dialogs::Purpose;
use crate::window::files::Pending;
use crate::window::state::{InterfaceState, Remembered};
use egui::{Key, Modifiers, Rect, Role, ThemePreference};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::path::Path;

/// Sizes in pixels, how many of them make a point, and a theme. The smallest is 1024x700 points.
type Look = ([f32; 2], f32, ThemePreference);
const LOOKS: [Look; 6] = [
    ([1024.0, 700.0], 1.0, ThemePreference::Dark),
    ([1024.0, 700.0], 1.0, ThemePreference::Light),
    ([1920.0, 1080.0], 1.0, ThemePreference::Light),
    ([3840.0, 2160.0], 1.0, ThemePreference::Dark),
    ([2048.0, 1400.0], 2.0, ThemePreference::Dark),
    ([3840.0, 2160.0], 2.0, ThemePreference::Light),
];
/// What a hand can use, and the picture.
const ROLES: [Role; 9] = [
    Role::Button,
    Role::Slider,
    Role::SpinButton,
    Role::CheckBox,
    Role::ComboBox,
    Role::ColorWell,
    Role::DisclosureTriangle,
    Role::TextInput,
    Role::Canvas,
];

/// A window that looks so, on the scene at that path.
fn at(path: &Path, (pixels, per_point, theme): Look) -> Harness<'static, App> {
    let harness = window_at(path, pixels.map(|n| n / per_point), per_point, theme);
    let is_dark = harness.ctx.global_style().visuals.dark_mode;
    assert_eq!(is_dark, theme == ThemePreference::Dark, "another theme");
    harness
}

/// Every control with its name and place.
fn controls(harness: &Harness<'_, App>) -> Vec<(String, Rect)> {
    ROLES
        .iter()
        .flat_map(|role| harness.query_all_by_role(*role))
        .map(|node| {
            let label = node.accesskit_node().label().unwrap_or_default();
            (label, node.rect())
        })
        .collect()
}

/// Every control, every text and every picture.
fn everything(harness: &Harness<'_, App>) -> Vec<(String, Rect)> {
    let texts = harness.query_all_by_role(Role::Label);
    let pictures = harness.query_all_by_role(Role::Image);
    let others = texts.chain(pictures).map(|node| {
        let label = node.accesskit_node().label().or(node.accesskit_node().value());
        (label.unwrap_or_default(), node.rect())
    });
    controls(harness).into_iter().chain(others).collect()
}

fn open_all(harness: &mut Harness<'_, App>) {
    for title in ["Render", "Textures", "Display", "Scene"] {
        let header = harness.get_by_role_and_label(Role::DisclosureTriangle, title);
        header.scroll_to_me();
        harness.run_steps(6);
        harness.get_by_role_and_label(Role::DisclosureTriangle, title).click();
        harness.run_steps(6);
    }
}

fn assert_apart(all: &[(String, Rect)], what: &str) {
    for (index, (name, rect)) in all.iter().enumerate() {
        for (other_name, other) in &all[index + 1..] {
            let shared = rect.intersect(*other);
            let overlap = 0.6 < shared.width() && 0.6 < shared.height();
            assert!(!overlap, "{what}: {name} {rect:?} and {other_name} {other:?}");
        }
    }
}

fn assert_inside(all: &[(String, Rect)], window: Rect, what: &str) {
    for (name, rect) in all {
        assert!(window.expand(0.5).contains_rect(*rect), "{what}: {name} at {rect:?} leaves it");
    }
}

#[test]
fn every_control_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = at(&scene_file(folder.path()), LOOKS[0]);
    open_all(&mut harness);
    for (name, rect) in controls(&harness) {
        assert!(!name.trim().is_empty(), "a control at {rect:?} has no name");
    }
    // All that can have the focus, whatever its role.
    harness.check_accessibility();
}

#[test]
fn nothing_of_the_panel_and_the_bars_leaves_the_window_or_overlaps() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for size in LOOKS {
        let mut harness = at(&path, size);
        open_all(&mut harness);
        let window = harness.ctx.content_rect();
        let picture = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
        let mut panel = everything(&harness);
        for (name, rect) in &panel {
            let inside = -0.5 <= rect.left() && rect.right() <= window.right() + 0.5;
            assert!(inside, "{name} at {rect:?} leaves {size:?}");
        }
        // The panel scrolls: what is beside the picture only in part is cut off there.
        panel.retain(|(_, rect)| picture.top() <= rect.top() && rect.bottom() <= picture.bottom());
        assert!(20 < panel.len(), "the panel shows {panel:?}");
        assert_apart(&panel, &format!("the panel at {size:?}"));
        // Without the panel only the bars are left.
        harness.key_press(Key::N);
        harness.run_steps(3);
        let bars = everything(&harness);
        assert!(9 < bars.len(), "the bars show {bars:?}");
        assert_inside(&bars, window, &format!("the bars at {size:?}"));
        assert_apart(&bars, &format!("the bars at {size:?}"));
    }
}

#[test]
fn the_bar_has_room_for_its_buttons_in_a_window_of_any_width() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for width in [427.0, 683.0, 759.0, 760.0, 800.0, 919.0, 920.0, 1024.0, 1199.0, 1200.0, 1400.0] {
        let mut harness = window_at(&path, [width, 620.0], 1.0, ThemePreference::Dark);
        harness.state_mut().interface.panel_shown = false;
        harness.run_steps(4);
        let what = format!("{width} points");
        let bar = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(width, 38.0));
        let mut parts = everything(&harness);
        parts.retain(|(_, rect)| rect.top() < bar.bottom() && rect.bottom() <= bar.bottom());
        assert_inside(&parts, bar, &what);
        assert_apart(&parts, &what);
        for name in ["File", "View", "Undo", "Redo", "Pause", "Render…", "Help", "Panel"] {
            assert!(parts.iter().any(|(part, _)| part == name), "{what}: {name} is gone");
        }
        let n_named =
            ["Zoom", "Exposure"].map(|name| parts.iter().filter(|(part, _)| part == name).count());
        assert_eq!(n_named, [usize::from(1200.0 <= width); 2], "{what}: names");
    }
}

#[test]
fn the_picture_takes_what_the_bars_and_the_panel_leave() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for size in LOOKS {
        let harness = at(&path, size);
        let picture = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
        let share = picture.area() / harness.ctx.content_rect().area();
        assert!(0.55 < share, "the picture has {share} of {size:?}");
    }
}

/// What appeared since `before`.
fn new_ones(harness: &Harness<'_, App>, before: &[(String, Rect)]) -> Vec<(String, Rect)> {
    everything(harness).into_iter().filter(|one| !before.contains(one)).collect()
}

#[test]
fn menus_open_whole_and_their_lines_lie_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for size in LOOKS {
        for (menu, submenu, least) in [("File", Some("Recent"), 9), ("View", Some("Theme"), 10)] {
            let mut harness = at(&path, size);
            let window = harness.ctx.content_rect();
            let before = everything(&harness);
            harness.get_by_role_and_label(Role::Button, menu).click();
            harness.run_steps(4);
            let lines = new_ones(&harness, &before);
            let what = format!("{menu} at {size:?}");
            assert!(least <= lines.len(), "{what}: {lines:?}");
            assert_inside(&lines, window, &what);
            assert_apart(&lines, &what);
            let Some(submenu) = submenu else { continue };
            let before = everything(&harness);
            harness.get_by_label_contains(submenu).click();
            harness.run_steps(4);
            let lines = new_ones(&harness, &before);
            let what = format!("{menu} > {submenu} at {size:?}");
            assert!(!lines.is_empty(), "{what} is empty");
            assert_inside(&lines, window, &what);
            assert_apart(&lines, &what);
        }
    }
}

/// Something that opens a box or a page.
type Opening = fn(&mut Harness<'_, App>);

const BOXES: [(&str, Opening); 13] = [
    ("the help", |harness| harness.key_press(Key::H)),
    ("the box that renders", |harness| harness.key_press_modifiers(Modifiers::SHIFT, Key::F12)),
    ("the start page", |harness| harness.key_press_modifiers(Modifiers::COMMAND, Key::G)),
    ("the question about edits", |harness| {
        harness.key_press(Key::D);
        harness.run_steps(2);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::W);
    }),
    ("the question about a picture at work", |harness| {
        harness.state_mut().interface.export.samples = Some(1_048_576);
        harness.state_mut().export_wanted = true;
        wait_until(harness, |app| app.exporter.progress().is_some());
        harness.state_mut().files.pending = Some(Pending::Close);
    }),
    ("the loupe", |harness| {
        harness.key_press(Key::L);
        let picture = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
        // Where it has least room.
        harness.hover_at(picture.right_bottom() - egui::Vec2::splat(3.0));
        wait_until(harness, |app| {
            let is_full = app.work.session.latest().is_some_and(|frame| frame.scale == 1);
            is_full && app.probe.answer().is_some()
        });
    }),
    ("marks of lights", |harness| {
        let app = harness.state_mut();
        app.interface.lights_shown = true;
        let mut beyond = app.document.description.lights[0].clone();
        beyond.name = "far above and to the side of all that is in the picture".to_owned();
        beyond.position = [90.0, 60.0, -9.0];
        app.document.description.lights[0].position = [0.0, 0.5, 0.0];
        app.document.description.lights.push(beyond);
    }),
    ("the box for a path", |harness| {
        harness.state_mut().dialogs.type_path(Purpose::Open, "");
    }),
    ("the offer of a copy", |harness| harness.state_mut().recovery.pretend_to_find("copy.png")),
    ("the offer of a copy and the box for a path", |harness| {
        harness.state_mut().recovery.pretend_to_find("copy.png");
        harness.run_steps(2);
        harness.state_mut().dialogs.type_path(Purpose::Open, "");
    }),
    ("the pinned picture", |harness| {
        wait_until(harness, |app| app.picture_on_show().is_some());
        harness.key_press(Key::X);
        harness.run_steps(2);
        for key in [Key::D, Key::E, Key::T] {
            harness.key_press(key);
            harness.run_steps(2);
        }
    }),
    ("a view with its legend", |harness| {
        harness.key_press(Key::Num4);
        wait_until(harness, |app| app.picture.legend().is_some());
    }),
    ("messages", |harness| {
        let toasts = &mut harness.state_mut().toasts;
        toasts.fail("/a/rather/long/path/to/a/scene.toml:12:7: there is no material \"glaze\"");
        toasts.warn("something was repaired");
        toasts.say("saved");
    }),
];

#[test]
fn boxes_and_pages_are_whole_and_their_parts_lie_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for size in LOOKS {
        for (what, open) in BOXES {
            let mut harness = at(&path, size);
            let before = everything(&harness);
            open(&mut harness);
            harness.run_steps(4);
            harness.check_accessibility();
            let window = harness.ctx.content_rect();
            let mut parts = new_ones(&harness, &before);
            assert!(!parts.is_empty(), "{what} at {size:?} shows nothing");
            let what = format!("{what} at {size:?}");
            if what.contains("page") || what.contains("help") {
                // They scroll where the window is low.
                parts.retain(|(_, rect)| rect.bottom() < window.bottom() - 100.0);
            }
            assert_inside(&parts, window, &what);
            // A line of the recent files holds two texts.
            parts.retain(|(name, _)| !path.ends_with(name) && !name.starts_with('/'));
            assert_apart(&parts, &what);
        }
    }
}

#[test]
fn groups_that_open_leave_the_panel_as_wide_as_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for width in [324.0, 328.0, 420.0, 520.0] {
        let state = InterfaceState { panel_width: width, ..InterfaceState::default() };
        let mut harness = window_of(&path, [1280.0, 900.0], Remembered::of(&state));
        let before = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
        assert_eq!(harness.state().interface.panel_width, width, "at first");
        open_all(&mut harness);
        let after = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
        assert_eq!(after, before, "the picture beside a panel of {width}");
        assert_eq!(harness.state().interface.panel_width, width, "with all groups open");
    }
}

#[test]
fn figures_however_long_leave_the_panel_as_wide_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for look in LOOKS {
        let mut harness = at(&path, look);
        open_all(&mut harness);
        let picture = |harness: &Harness<'_, App>| {
            harness.get_by_role_and_label(Role::Canvas, "Picture").rect()
        };
        let before = picture(&harness);
        let scene = &mut harness.state_mut().document.description;
        scene.camera.eye = [-0.123456789, -12345.678912, 1234567.891];
        scene.camera.target = [-1.0 / 3.0, -1.234e-7, -9.87654321e22];
        scene.camera.focal_distance = Some(1234.56789);
        scene.camera.aperture_radius = 0.0123456789;
        scene.lights[0].position = [-100.0 / 3.0, -1000.0 / 3.0, -10000.0 / 3.0];
        scene.lights[0].power = [123456.789, 1.0, 0.1];
        scene.objects[0].rotate = [-123.456, -0.0123456, 359.87654];
        scene.tone_mapping.exposure = -12.3456;
        harness.run_steps(6);
        assert_eq!(picture(&harness), before, "the panel grows at {look:?}");
        let mut panel = everything(&harness);
        let visible = |rect: &Rect| before.top() <= rect.top() && rect.bottom() <= before.bottom();
        panel.retain(|(_, rect)| visible(rect));
        assert_apart(&panel, &format!("long figures at {look:?}"));
    }
}

//! Nothing overlaps, is cut off or leaves the window, small and large, menus and boxes too.

use super::whole::{scene_file, window_at};
use crate::window::app::App;
use egui::{Key, Modifiers, Rect, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::path::Path;

/// Sizes in pixels, with how many of them make a point. The smallest is 1024x700 points.
const SIZES: [([f32; 2], f32); 5] = [
    ([1024.0, 700.0], 1.0),
    ([1920.0, 1080.0], 1.0),
    ([3840.0, 2160.0], 1.0),
    ([2048.0, 1400.0], 2.0),
    ([3840.0, 2160.0], 2.0),
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

/// A window of that many pixels on the scene at that path.
fn at(path: &Path, (pixels, per_point): ([f32; 2], f32)) -> Harness<'static, App> {
    window_at(path, pixels.map(|n| n / per_point), per_point)
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

/// Every control and every text.
fn everything(harness: &Harness<'_, App>) -> Vec<(String, Rect)> {
    let texts = harness.query_all_by_role(Role::Label).map(|node| {
        let label = node.accesskit_node().label().or(node.accesskit_node().value());
        (label.unwrap_or_default(), node.rect())
    });
    controls(harness).into_iter().chain(texts).collect()
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
    let mut harness = at(&scene_file(folder.path()), SIZES[0]);
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
    for size in SIZES {
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
fn the_picture_takes_what_the_bars_and_the_panel_leave() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for size in SIZES {
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
    for size in SIZES {
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

#[test]
fn boxes_and_pages_are_whole_and_their_parts_lie_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    let cases: [(&str, Key, Modifiers); 4] = [
        ("the help", Key::H, Modifiers::NONE),
        ("the box that renders", Key::F12, Modifiers::SHIFT),
        ("the start page", Key::G, Modifiers::COMMAND),
        ("the question about edits", Key::W, Modifiers::COMMAND),
    ];
    for size in SIZES {
        for (what, key, modifiers) in cases {
            let mut harness = at(&path, size);
            if what == "the question about edits" {
                harness.key_press(Key::D);
                harness.run_steps(2);
            }
            let before = everything(&harness);
            harness.key_press_modifiers(modifiers, key);
            harness.run_steps(4);
            harness.check_accessibility();
            let window = harness.ctx.content_rect();
            let mut parts = new_ones(&harness, &before);
            assert!(3 <= parts.len(), "{what} at {size:?} shows {parts:?}");
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

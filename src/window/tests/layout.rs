//! Nothing overlaps, is cut off or leaves the window, small and large.

use super::whole::{scene_file, window};
use crate::window::app::App;
use egui::{Rect, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

const SIZES: [[f32; 2]; 3] = [[1024.0, 700.0], [1920.0, 1080.0], [3840.0, 2160.0]];
/// Names of what a hand can use.
const ROLES: [Role; 8] = [
    Role::Button,
    Role::Slider,
    Role::SpinButton,
    Role::CheckBox,
    Role::ComboBox,
    Role::ColorWell,
    Role::DisclosureTriangle,
    Role::Canvas,
];

/// Every control with its name and place.
fn controls(harness: &Harness<'_, App>) -> Vec<(String, Rect)> {
    ROLES
        .iter()
        .flat_map(|role| harness.get_all_by_role(*role))
        .map(|node| {
            let label = node.accesskit_node().label().unwrap_or_default();
            (label, node.rect())
        })
        .collect()
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

#[test]
fn every_control_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(&scene_file(folder.path()), SIZES[0]);
    open_all(&mut harness);
    for (name, rect) in controls(&harness) {
        assert!(!name.trim().is_empty(), "a control at {rect:?} has no name");
    }
}

#[test]
fn nothing_leaves_the_window_sideways() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for size in SIZES {
        let mut harness = window(&path, size);
        open_all(&mut harness);
        for (name, rect) in controls(&harness) {
            let inside = -0.5 <= rect.left() && rect.right() <= size[0] + 0.5;
            assert!(inside, "{name} at {rect:?} leaves {size:?}");
        }
    }
}

#[test]
fn no_two_controls_overlap() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for size in SIZES {
        let mut harness = window(&path, size);
        open_all(&mut harness);
        // The panel scrolls: what is beside the picture only in part is cut off there.
        let picture = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
        let beside = |rect: &Rect| picture.top() <= rect.top() && rect.bottom() <= picture.bottom();
        let bars: Vec<_> = ["File", "Help", "Panel"]
            .iter()
            .map(|name| harness.get_by_role_and_label(Role::Button, name).rect().bottom())
            .collect();
        let above = |rect: &Rect| bars.iter().any(|bottom| (rect.bottom() - bottom).abs() < 0.6);
        let all: Vec<_> = controls(&harness)
            .into_iter()
            .filter(|(_, rect)| beside(rect) || above(rect))
            .collect();
        for (index, (name, rect)) in all.iter().enumerate() {
            for (other_name, other) in &all[index + 1..] {
                let shared = rect.intersect(*other);
                let overlap = 0.6 < shared.width() && 0.6 < shared.height();
                assert!(!overlap, "{name} {rect:?} and {other_name} {other:?} at {size:?}");
            }
        }
    }
}

#[test]
fn the_picture_takes_what_the_bars_and_the_panel_leave() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path());
    for size in SIZES {
        let harness = window(&path, size);
        let picture = harness.get_by_role_and_label(Role::Canvas, "Picture").rect();
        let share = picture.area() / (size[0] * size[1]);
        assert!(0.55 < share, "the picture has {share} of {size:?}");
    }
}

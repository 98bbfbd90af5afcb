//! What the window remembers beside the scene: how it is laid out and what is chosen in it.

use super::export_settings::ExportSettings;
use super::loupe::Loupe;
use super::navigation::Navigation;
use super::panels::{DisplayState, Limits, PickFor, Selection, SizeMode};
use crate::threads;
use egui::ThemePreference;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Width of the panel at first, in points.
pub(super) const PANEL_WIDTH: f32 = 328.0;
/// How much larger than usual text and controls can be.
const SCALES: std::ops::RangeInclusive<f32> = 0.5..=3.0;
/// Files named in the menu of recent ones.
const MOST_RECENT: usize = 10;

/// State of the interface. Nothing in it changes the picture of a given job.
#[derive(Clone, Debug)]
pub(super) struct InterfaceState {
    /// Which parts are being edited.
    pub(super) selection: Selection,
    /// Zoom of the picture.
    pub(super) display: DisplayState,
    /// How large the picture is.
    pub(super) size_mode: SizeMode,
    /// Index in the list of accelerators.
    pub(super) accelerator: usize,
    /// The point the camera turns about.
    pub(super) navigation: Navigation,
    /// What the next click in the picture is for, if it is for anything.
    pub(super) picking: Option<PickFor>,
    /// Whether lights are marked in the picture.
    pub(super) lights_shown: bool,
    /// Whether what is sharp is marked in the picture.
    pub(super) lens_shown: bool,
    /// The magnifier under the cursor.
    pub(super) loupe: Loupe,
    /// When refining stops before its samples are reached.
    pub(super) limits: Limits,
    /// Whether refining is held.
    pub(super) is_paused: bool,
    /// Whether the panel is shown.
    pub(super) panel_shown: bool,
    /// Whether the list of keys is shown.
    pub(super) help_shown: bool,
    /// What one scene unit stands for in f-numbers, in millimetres.
    pub(super) scene_unit_mm: f64,
    /// The lens radius that D gives back, in scene units.
    pub(super) lens_when_open: Option<f64>,
    /// Files opened before, newest first.
    pub(super) recent: Vec<PathBuf>,
    /// Whether the start page is shown in the picture's place.
    pub(super) start_shown: bool,
    /// Whether the box that renders a picture is shown.
    pub(super) export_shown: bool,
    /// What is set in that box.
    pub(super) export: ExportSettings,
    /// Threads that render; `None` leaves one processor to the window itself.
    pub(super) n_threads: Option<usize>,
    /// Dark, light, or as the system.
    pub(super) theme: ThemePreference,
    /// Width of the panel in points.
    pub(super) panel_width: f32,
    /// How much larger than usual text and controls are.
    pub(super) scale: f32,
}

impl Default for InterfaceState {
    fn default() -> Self {
        Self {
            selection: Selection::default(),
            display: DisplayState::default(),
            size_mode: SizeMode::default(),
            accelerator: 0,
            navigation: Navigation::default(),
            picking: None,
            lights_shown: false,
            lens_shown: false,
            loupe: Loupe::default(),
            limits: Limits::default(),
            is_paused: false,
            panel_shown: true,
            help_shown: false,
            scene_unit_mm: 100.0,
            lens_when_open: None,
            recent: Vec::new(),
            start_shown: false,
            export_shown: false,
            export: ExportSettings::default(),
            n_threads: None,
            theme: ThemePreference::System,
            panel_width: PANEL_WIDTH,
            scale: 1.0,
        }
    }
}

/// The part of the state that outlives the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Remembered {
    panel_shown: bool,
    size: SizeMode,
    scene_unit_mm: f64,
    recent: Vec<PathBuf>,
    export: ExportSettings,
    n_threads: Option<usize>,
    theme: ThemePreference,
    panel_width: f32,
    scale: f32,
}

impl Default for Remembered {
    fn default() -> Self {
        Self::of(&InterfaceState::default())
    }
}

impl Remembered {
    /// What of this state is kept.
    pub(super) fn of(state: &InterfaceState) -> Self {
        Self {
            panel_shown: state.panel_shown,
            size: state.size_mode,
            scene_unit_mm: state.scene_unit_mm,
            // A name that is no text cannot be written down.
            recent: state.recent.iter().filter(|path| path.to_str().is_some()).cloned().collect(),
            export: state.export.clone(),
            n_threads: state.n_threads,
            theme: state.theme,
            panel_width: state.panel_width,
            scale: state.scale,
        }
    }

    /// A fresh state with what was kept.
    pub(super) fn restore(self) -> InterfaceState {
        InterfaceState {
            panel_shown: self.panel_shown,
            size_mode: self.size,
            scene_unit_mm: self.scene_unit_mm,
            recent: self.recent,
            export: self.export,
            n_threads: self.n_threads.map(|n| n.clamp(1, threads::available())),
            theme: self.theme,
            panel_width: self.panel_width,
            scale: held(self.scale),
            ..InterfaceState::default()
        }
    }
}

impl InterfaceState {
    /// Threads that render: as chosen, or as many as go with a window.
    pub(super) fn n_threads(&self) -> usize {
        self.n_threads.unwrap_or_else(threads::beside_window)
    }

    /// Makes text and controls larger by so many tenths of their usual size.
    pub(super) fn enlarge(&mut self, tenths: f32) {
        self.scale = held(((self.scale * 10.0).round() + tenths) / 10.0);
    }

    /// Forgets what belongs to the scene that was open.
    pub(super) fn forget_scene(&mut self) {
        self.selection = Selection::default();
        self.navigation = Navigation::default();
        self.picking = None;
        self.lens_when_open = None;
        self.export.samples = None;
        self.start_shown = false;
    }

    /// Puts a file at the head of the recent ones.
    pub(super) fn remember_file(&mut self, path: PathBuf) {
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }
}

/// A scale that leaves the window usable.
fn held(scale: f32) -> f32 {
    if scale.is_finite() { scale.clamp(*SCALES.start(), *SCALES.end()) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recent_files_are_named_once_newest_first() {
        let mut state = InterfaceState::default();
        for name in ["a", "b", "a"] {
            state.remember_file(PathBuf::from(name));
        }
        assert_eq!(state.recent, [PathBuf::from("a"), PathBuf::from("b")], "another order");
    }

    #[test]
    fn what_is_remembered_comes_back() {
        let mut state = InterfaceState { panel_shown: false, ..InterfaceState::default() };
        state.size_mode = SizeMode::Fixed;
        state.theme = ThemePreference::Light;
        state.panel_width = 400.0;
        state.enlarge(2.0);
        state.export.format = crate::io::output::OutputFormat::Exr;
        state.remember_file(PathBuf::from("a.toml"));
        let kept = Remembered::of(&state);
        assert_eq!(Remembered::of(&kept.clone().restore()), kept, "something was lost");
    }
    #[test]
    fn text_grows_by_tenths_and_stays_readable() {
        let mut state = InterfaceState::default();
        for (tenths, expected) in [(1.0, 1.1), (1.0, 1.2), (-4.0, 0.8), (-9.0, 0.5), (99.0, 3.0)] {
            state.enlarge(tenths);
            assert_eq!(state.scale, expected, "after {tenths} tenths");
        }
        for broken in [f32::NAN, f32::INFINITY, 0.0, -1.0, 1e9] {
            let kept = Remembered { scale: broken, ..Remembered::default() };
            let scale = kept.restore().scale;
            assert!(SCALES.contains(&scale), "{broken} becomes {scale}");
        }
    }
}

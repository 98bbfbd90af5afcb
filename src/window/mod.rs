//! The desktop window: a viewport that sharpens while it is watched, and a panel with every
//! setting of the scene.
//!
//! Each frame the panels edit the document's description in place; it is resolved, made a job and
//! compared with the last one by the session. The window's own thread traces, loads, builds and
//! waits for nothing. Only this module names egui.

mod actions;
mod app;
mod background;
mod color;
mod compare;
mod dialogs;
mod export;
mod export_dialog;
mod export_settings;
mod fields;
mod figures;
mod files;
mod gesture;
mod handles;
mod headless;
mod help;
mod icons;
mod incoming;
mod keys;
mod keys_file;
mod layout;
mod lens_overlay;
mod live;
mod loupe;
mod navigation;
mod output;
mod panels;
mod parameter;
mod picture;
mod presets;
mod probe;
mod questions;
mod recent;
mod recovery;
mod relocate;
mod scroll;
mod settings;
mod start;
mod state;
mod status;
mod structure;
mod swatches;
mod theme;
mod toasts;
mod toolbar;
mod viewport;
mod views;
mod watch;
mod widgets;
mod work;

pub use headless::{Headless, HeadlessFrame};

use crate::loader::Source;
use std::path::PathBuf;

/// Names the program to the system, and its folder.
const APP_ID: &str = "penumbra";
/// The gallery scene that opens where no file is named.
const FIRST_SCENE: &str = "final";

/// Why the window could not be shown.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// No display to open a window on.
    #[error(
        "there is no display to open a window on; `penumbra render` makes pictures without one"
    )]
    NoDisplay,
    /// The display refuses.
    #[error("cannot open a window: {reason}; `penumbra render` makes pictures without one")]
    NoWindow {
        /// What the system said.
        reason: String,
    },
}

/// Where the program keeps what it remembers from one run to the next; `None` where the system has
/// no such place.
pub fn own_folder() -> Option<PathBuf> {
    eframe::storage_dir(APP_ID)
}

/// Opens the window on a scene, a mesh or a snapshot, or on the gallery's final scene, and stays
/// until it is closed.
///
/// # Errors
/// Where there is no display, or no way to draw on it.
pub fn run(file: Option<PathBuf>) -> Result<(), WindowError> {
    let first = file.map_or(Source::Gallery(FIRST_SCENE), Source::File);
    let options = eframe::NativeOptions {
        renderer: eframe::Renderer::Glow,
        viewport: egui::ViewportBuilder::default()
            .with_app_id(APP_ID)
            .with_title("Penumbra")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([800.0, 520.0])
            .with_drag_and_drop(true),
        // What is rendered is shown bit by bit as it was made.
        dithering: false,
        ..eframe::NativeOptions::default()
    };
    let create: eframe::AppCreator<'_> = Box::new(move |cc| {
        theme::install(&cc.egui_ctx);
        let own = own_folder();
        let remembered = settings::load(own.as_deref());
        Ok(Box::new(app::App::new(&cc.egui_ctx, remembered, first, own)?))
    });
    eframe::run_native(APP_ID, options, create).map_err(|error| match error {
        eframe::Error::WinitEventLoop(_) => WindowError::NoDisplay,
        eframe::Error::NoGlutinConfigs(_, error) => {
            WindowError::NoWindow { reason: format!("there is no OpenGL ({error})") }
        }
        other => WindowError::NoWindow { reason: other.to_string() },
    })
}

#[cfg(test)]
mod tests;

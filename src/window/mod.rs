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
mod event_loop;
mod export;
mod export_dialog;
mod export_settings;
mod fault;
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
mod layout;
mod lens_overlay;
mod live;
mod loupe;
mod navigation;
mod output;
mod pacing;
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
use dialogs::PathDialogs;
use event_loop::Listening;
use fault::FaultKeeper;
use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;
use winit::event_loop::EventLoop;
use winit::platform::run_on_demand::EventLoopExtRunOnDemand as _;

/// Hears what the system says before there is a window.
static FAULT: FaultKeeper = FaultKeeper::new();
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
    // Why there is no window, until there is one: what goes wrong before is kept by nobody else.
    // It is heard only where nobody else listens to the log.
    if log::set_logger(&FAULT).is_ok() {
        log::set_max_level(log::LevelFilter::Error);
    }
    let failure = Rc::new(RefCell::new(Some("there is no OpenGL".to_owned())));
    let told = Rc::clone(&failure);
    let create: eframe::AppCreator<'_> = Box::new(move |cc| {
        theme::install(&cc.egui_ctx);
        let own = own_folder();
        let remembered = settings::load(own.as_deref());
        let is_first_start = !settings::are_there(own.as_deref());
        let app = app::App::new(&cc.egui_ctx, remembered, first, own);
        *told.borrow_mut() = app.as_ref().err().map(ToString::to_string);
        let mut app = app?;
        if is_first_start {
            app.greet();
        }
        app.dialogs = PathDialogs::like(rfd::AsyncFileDialog::new().set_parent(cc));
        Ok(Box::new(app))
    });
    let mut event_loop =
        EventLoop::with_user_event().build().map_err(|_| WindowError::NoDisplay)?;
    let window = eframe::create_native(APP_ID, options, create, &event_loop);
    let ended = event_loop.run_app_on_demand(&mut Listening(window));
    let told = failure.take().or(ended.err().map(|error| error.to_string()));
    let told = told.map(|reason| no_window(reason, FAULT.take()));
    match told {
        Some(reason) => Err(WindowError::NoWindow { reason }),
        None => Ok(()),
    }
}

/// Why there is no window, with what the driver says of it.
fn no_window(reason: String, driver: Option<String>) -> String {
    match driver {
        Some(driver) if driver != reason => format!("{reason}: {driver}"),
        Some(_) | None => reason,
    }
}

#[cfg(test)]
mod tests;

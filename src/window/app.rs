//! The window's state and its frame: panels edit the scene, the scene becomes a job, the newest
//! picture is shown. Nothing here traces, loads, waits or maps tones.

use super::compare::Pinned;
use super::dialogs::PathDialogs;
use super::export::Exporter;
use super::files::FileWork;
use super::gesture::Gesture;
use super::keys::{self, Action, Keys};
use super::lens_overlay::LensOverlay;
use super::pacing::Pacing;
use super::picture::PictureDisplay;
use super::probe::Probe;
use super::recent::RecentPictures;
use super::recovery::Recovery;
use super::settings::Settings;
use super::start::{Thumbnails, drop_hint};
use super::state::{InterfaceState, Remembered};
use super::structure::Part;
use super::swatches::Swatches;
use super::toasts::Toasts;
use super::viewport::Click;
use super::watch::Watcher;
use super::work::RenderWork;
use crate::document::Document;
use crate::loader::{Loader, Source};
use crate::scene::description::{CameraDescription, SceneDescription};
use crate::session::Session;
use egui::Ui;
use std::path::PathBuf;

/// The whole window.
pub(super) struct App {
    pub(super) document: Document,
    pub(super) interface: InterfaceState,
    settings: Settings,
    pub(super) files: FileWork,
    pub(super) work: RenderWork,
    pub(super) dialogs: PathDialogs,
    pub(super) toasts: Toasts,
    /// The camera the scene was opened with.
    pub(super) home_camera: CameraDescription,
    /// The click whose answer from the renderer is awaited.
    pub(super) awaited_click: Option<Click>,
    /// The part, by name, whose file is being chosen.
    pub(super) file_wanted: Option<(Part, String)>,
    pub(super) gesture: Gesture,
    pacing: Pacing,
    /// Whether the next full picture is written to a file.
    pub(super) snapshot_wanted: bool,
    /// Whether a picture of a size of its own is to be rendered.
    pub(super) export_wanted: bool,
    pub(super) exporter: Exporter,
    pub(super) thumbnails: Thumbnails,
    pub(super) recent_pictures: RecentPictures,
    pub(super) keys: Keys,
    /// Where keys of one's own are read from, if there is such a place.
    pub(super) keys_file: Option<PathBuf>,
    /// The picture that the live one is compared with.
    pub(super) pinned: Option<Pinned>,
    pub(super) probe: Probe,
    pub(super) lens_overlay: LensOverlay,
    /// The motion of the hand that last changed the lens.
    pub(super) lens_gesture: Option<u64>,
    pub(super) watcher: Watcher,
    pub(super) recovery: Recovery,
    pub(super) picture: PictureDisplay,
    pub(super) swatches: Swatches,
    pub(super) viewport: ViewportFacts,
}

/// What the viewport was like in the last frame.
pub(super) struct ViewportFacts {
    /// Size in pixels of the picture being rendered.
    pub(super) size: [u32; 2],
    /// Screen pixels per picture pixel, times 100.
    pub(super) zoom_percent: f64,
    /// The picture pixel under the cursor.
    pub(super) hovered_pixel: Option<[u32; 2]>,
    /// Whether letters fly.
    pub(super) flying: bool,
    /// Where it is, in points.
    pub(super) rect: egui::Rect,
}

impl App {
    /// A window that starts loading `first`; `ctx` is woken when there is something new.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub(super) fn new(
        ctx: &egui::Context,
        remembered: Remembered,
        first: Source,
        own_folder: Option<PathBuf>,
    ) -> std::io::Result<Self> {
        let n_threads = remembered.clone().restore().n_threads();
        let session = Session::new(n_threads, waking(ctx))?;
        Self::with_session(ctx, remembered, first, own_folder, session)
    }

    /// The same around any session: tests script one.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub(super) fn with_session(
        ctx: &egui::Context,
        remembered: Remembered,
        first: Source,
        own_folder: Option<PathBuf>,
        session: Session,
    ) -> std::io::Result<Self> {
        let wake = || waking(ctx);
        let mut files = FileWork::new(Loader::new(wake())?);
        files.open(first);
        let empty = empty_scene();
        let keys_file = own_folder.as_ref().map(|folder| folder.join(keys::file::NAME));
        let (keys, complaints) = keys_file.as_deref().map(keys::file::load).unwrap_or_default();
        let mut toasts = Toasts::default();
        if let (false, Some(path)) = (complaints.is_empty(), &keys_file) {
            toasts.fail(format!("{}\n{}", path.display(), complaints.join("\n")));
        }
        let settings = Settings::new(own_folder.as_deref(), remembered.clone(), ctx);
        let interface = remembered.restore();
        ctx.set_theme(interface.theme);
        ctx.set_zoom_factor(interface.scale);
        // The table of keys says what they do.
        ctx.options_mut(|options| options.zoom_with_keyboard = false);
        Ok(Self {
            home_camera: empty.camera.clone(),
            document: Document::new(empty, None),
            interface,
            settings,
            files,
            work: RenderWork::new(session),
            dialogs: PathDialogs::default(),
            toasts,
            keys,
            keys_file,
            awaited_click: None,
            file_wanted: None,
            snapshot_wanted: false,
            export_wanted: false,
            exporter: Exporter::default(),
            thumbnails: Thumbnails::new(wake())?,
            recent_pictures: RecentPictures::new(own_folder.as_deref()),
            pinned: None,
            probe: Probe::default(),
            lens_overlay: LensOverlay::new(wake())?,
            lens_gesture: None,
            watcher: Watcher::new(wake())?,
            recovery: Recovery::new(own_folder),
            gesture: Gesture::default(),
            pacing: Pacing::default(),
            picture: PictureDisplay::new(wake())?,
            swatches: Swatches::new(wake())?,
            viewport: ViewportFacts {
                size: [1, 1],
                zoom_percent: 100.0,
                hovered_pixel: None,
                flying: false,
                rect: egui::Rect::ZERO,
            },
        })
    }

    /// Says what a hand can do, to someone who is here for the first time.
    pub(super) fn greet(&mut self) {
        let keys = self.keys.shown(Action::Help);
        self.toasts.hint(format!(
            "Drag to orbit, scroll to go nearer, Ctrl + click to focus. {keys} lists all keys."
        ));
    }

    /// Size in pixels of the picture being rendered.
    pub(super) fn picture_size(&self) -> [u32; 2] {
        self.viewport.size
    }
}

impl App {
    /// Takes what other threads have finished; also while the window is hidden.
    pub(super) fn take_news(&mut self, ctx: &egui::Context) {
        self.take_results(ctx);
        self.take_export(ctx);
        self.reload_if_changed();
        self.keep_copy(ctx);
        if let Some(fault) = self.settings.take_fault() {
            self.toasts.fail(fault);
        }
        self.guard_close(ctx);
    }

    /// Keeps what outlives the window.
    pub(super) fn keep_settings(&mut self) {
        self.settings.keep(&Remembered::of(&self.interface));
    }

    /// Deals the input out to frames: with this one, and with those that follow at once.
    pub(super) fn pace(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        self.pacing.pace(&mut input.events);
        if self.pacing.is_waiting() {
            ctx.request_repaint();
        }
    }

    /// One frame of the window.
    pub(super) fn frame_ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.gesture.update(&ctx);
        let mut scene = self.document.description.clone();
        for action in self.keys.pressed(&ctx, self.viewport.flying) {
            self.do_action(&ctx, &mut scene, action);
        }
        self.take_dropped_file(&ctx);
        self.layout_ui(ui, &mut scene);
        self.take_pick(&ctx, &mut scene);
        self.render(&ctx, scene);
        self.export_box(&ctx);
        self.help_overlay(&ctx);
        self.ask_for_part_file(&ctx);
        self.ask_for_paths(&ctx);
        self.offer_copy(&ctx);
        self.ask_about_unsaved(&ctx);
        if !self.interface.start_shown {
            drop_hint(&ctx, self.viewport.rect);
        }
        let foot = self.viewport.rect.center_bottom() - egui::Vec2::new(0.0, 16.0);
        self.toasts.show(&ctx, foot);
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.take_news(ctx);
    }

    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        self.pace(ctx, input);
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.frame_ui(ui);
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        self.recovery.forget();
    }

    fn save(&mut self, _storage: &mut dyn eframe::Storage) {
        self.keep_settings();
    }
}

/// Asks for a frame of the window, from any thread.
fn waking(ctx: &egui::Context) -> impl Fn() + Clone + Send + Sync + 'static {
    let ctx = ctx.clone();
    move || ctx.request_repaint()
}

/// What is edited until the first scene is there.
pub(super) fn empty_scene() -> SceneDescription {
    SceneDescription {
        render: Default::default(),
        camera: CameraDescription {
            eye: [0.0, 1.0, 5.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            vertical_fov: 40.0,
            aperture_radius: 0.0,
            focal_distance: None,
            aperture_blades: 0,
        },
        tone_mapping: Default::default(),
        environment: Default::default(),
        textures: Vec::new(),
        materials: Vec::new(),
        lights: Vec::new(),
        objects: Vec::new(),
    }
}

//! The window's state and its frame: panels edit the scene, the scene becomes a job, the newest
//! picture is shown. Nothing here traces, loads, waits or maps tones.

use super::dialogs::PathDialogs;
use super::files::FileWork;
use super::gesture::Gesture;
use super::panels::{self, RenderFacts};
use super::picture::PictureDisplay;
use super::state::{InterfaceState, Remembered};
use super::status::{PixelUnderCursor, StatusLine, Work, status_ui};
use super::swatches::Swatches;
use super::toasts::Toasts;
use super::toolbar::{ToolbarChoice, ToolbarFacts, toolbar_ui};
use super::viewport::{Click, physical_size, viewport_ui};
use super::work::{RenderWork, picture_size};
use super::{help, keys};
use crate::document::Document;
use crate::geometry::{AcceleratorKind, TreeStatistics};
use crate::io::gallery::GALLERY;
use crate::io::scene_file;
use crate::loader::{Loader, Source};
use crate::scene::description::{CameraDescription, SceneDescription};
use crate::session::{Frame, Phase, Session};
use crate::threads;
use egui::{Margin, Panel, Ui};
use std::sync::Arc;

/// The whole window.
pub(super) struct App {
    pub(super) document: Document,
    pub(super) interface: InterfaceState,
    pub(super) files: FileWork,
    pub(super) work: RenderWork,
    pub(super) dialogs: PathDialogs,
    pub(super) toasts: Toasts,
    /// The camera the scene was opened with.
    pub(super) home_camera: CameraDescription,
    /// The click whose answer from the renderer is awaited.
    pub(super) awaited_click: Option<Click>,
    pub(super) gesture: Gesture,
    /// Whether the next full picture is written to a file.
    pub(super) snapshot_wanted: bool,
    picture: PictureDisplay,
    swatches: Swatches,
    viewport: ViewportFacts,
}

/// What the viewport was like in the last frame.
struct ViewportFacts {
    size: [u32; 2],
    zoom_percent: f64,
    hovered_pixel: Option<[u32; 2]>,
    flying: bool,
    rect: egui::Rect,
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
    ) -> std::io::Result<Self> {
        let wake = || {
            let ctx = ctx.clone();
            move || ctx.request_repaint()
        };
        // One processor is left to the window itself.
        let n_threads = threads::available().saturating_sub(1).max(1);
        let session = Session::new(n_threads, wake())?;
        let mut files = FileWork::new(Loader::new(wake())?);
        files.open(first);
        let empty = empty_scene();
        Ok(Self {
            home_camera: empty.camera.clone(),
            document: Document::new(empty, None),
            interface: remembered.restore(),
            files,
            work: RenderWork::new(session),
            dialogs: PathDialogs::default(),
            toasts: Toasts::default(),
            awaited_click: None,
            snapshot_wanted: false,
            gesture: Gesture::default(),
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

    /// Size in pixels of the picture being rendered.
    pub(super) fn picture_size(&self) -> [u32; 2] {
        self.viewport.size
    }

    /// The bars, the panel and the picture, editing `scene` in place.
    fn layout_ui(&mut self, ui: &mut Ui, scene: &mut SceneDescription) {
        let frame = self.work.session.latest();
        let chosen = self.toolbar(ui, scene);
        self.status_bar(ui, frame.as_deref());
        let panel_shown = self.interface.panel_shown;
        let side = Panel::right("settings")
            .default_size(328.0)
            .size_range(272.0..=520.0)
            .resizable(true)
            .frame(egui::Frame::side_top_panel(ui.style()).inner_margin(Margin {
                left: 8,
                right: 2,
                top: 2,
                bottom: 0,
            }));
        if panel_shown {
            side.show(ui, |ui| {
                egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    self.panel_ui(ui, scene);
                });
            });
        }
        egui::CentralPanel::no_frame().show(ui, |ui| self.central_ui(ui, scene));
        if let Some(chosen) = chosen {
            self.do_choice(ui.ctx(), scene, chosen);
        }
    }

    fn toolbar(&mut self, ui: &mut Ui, scene: &mut SceneDescription) -> Option<ToolbarChoice> {
        let titles: Vec<&str> = GALLERY.iter().map(|entry| entry.title).collect();
        let facts = ToolbarFacts {
            title: &self.files.title,
            has_unsaved: self.document.is_dirty(),
            undo: self.document.undo_label(),
            redo: self.document.redo_label(),
            is_paused: self.interface.is_paused,
            panel_shown: self.interface.panel_shown,
            gallery: &titles,
            recent: &self.interface.recent,
        };
        let display = &mut self.interface.display;
        let tone = &mut scene.tone_mapping;
        Panel::top("toolbar")
            .exact_size(38.0)
            .show(ui, |ui| toolbar_ui(ui, &facts, tone, display))
            .inner
    }

    fn status_bar(&mut self, ui: &mut Ui, frame: Option<&Frame>) {
        let line = self.status_line(frame);
        let pixel = self.viewport.hovered_pixel.and_then(|at| pixel_at(frame?, at));
        let margin = Margin { left: 8, right: 8, top: 0, bottom: 0 };
        Panel::bottom("status")
            .exact_size(26.0)
            .frame(egui::Frame::side_top_panel(ui.style()).inner_margin(margin))
            .show(ui, |ui| {
                if self.files.loading.is_some() {
                    self.loading_ui(ui);
                } else {
                    status_ui(ui, &line, pixel);
                }
            });
    }

    fn loading_ui(&mut self, ui: &mut Ui) {
        let name = self.files.loading.clone().unwrap_or_default();
        ui.horizontal_centered(|ui| {
            ui.spinner();
            ui.label(egui::RichText::new(format!("loading {name}")).strong());
            if ui.button("Cancel").on_hover_text("keeps the scene that is open (Esc)").clicked() {
                self.files.cancel_loading();
            }
        });
    }

    fn panel_ui(&mut self, ui: &mut Ui, scene: &mut SceneDescription) {
        let status = self.work.session.status();
        let interface = &mut self.interface;
        let (swatches, assets) = (&mut self.swatches, &self.work.assets);
        let facts = RenderFacts {
            accelerators: &AcceleratorKind::ALL.map(AcceleratorKind::name),
            tree: tree_lines(status.trees.as_ref()),
            noise: &self.work.noise,
        };
        let summary = format!("{} samples", scene.render.samples);
        panels::section(ui, "Render", &summary, false, |ui| {
            let (size, accelerator) = (&mut interface.size_mode, &mut interface.accelerator);
            panels::render_ui(ui, &mut scene.render, size, accelerator, &facts);
        });
        panels::section(ui, "Camera & lens", "", true, |ui| {
            let (unit, picking) = (&mut interface.scene_unit_mm, &mut interface.picking_focus);
            panels::camera_ui(ui, &mut scene.camera, unit, picking);
        });
        let summary = scene.lights.len().to_string();
        panels::section(ui, "Lights", &summary, true, |ui| {
            panels::lights_ui(ui, scene, &mut interface.selection);
        });
        let summary = scene.materials.len().to_string();
        panels::section(ui, "Materials", &summary, true, |ui| {
            panels::materials_ui(ui, scene, &mut interface.selection, |ui, material, textures| {
                swatches.ball_ui(ui, material, textures, assets);
            });
        });
        let summary = scene.textures.len().to_string();
        panels::section(ui, "Textures", &summary, false, |ui| {
            panels::textures_ui(ui, scene, &mut interface.selection, |ui, texture| {
                swatches.patch_ui(ui, texture, assets);
            });
        });
        panels::section(ui, "Display", "", false, |ui| {
            let statistics = self.picture.statistics();
            let tone = &mut scene.tone_mapping;
            panels::display_ui(ui, tone, &mut interface.display, statistics);
        });
        let summary = scene.objects.len().to_string();
        panels::section(ui, "Scene", &summary, false, |ui| {
            panels::objects_ui(ui, scene, &mut interface.selection);
            panels::report_ui(ui, &self.files.report);
        });
    }

    fn central_ui(&mut self, ui: &mut Ui, scene: &mut SceneDescription) {
        let viewport = physical_size(ui.available_rect_before_wrap(), ui.pixels_per_point());
        let size = picture_size(scene, self.interface.size_mode, viewport);
        let output = viewport_ui(
            ui,
            &mut scene.camera,
            &mut self.interface.navigation,
            self.picture.shown().as_ref(),
            size,
            self.interface.display.zoom,
            self.interface.picking_focus,
        );
        if let Some(click) = output.click {
            let (Click::Focus(x, y) | Click::TurnAbout(x, y)) = click;
            self.work.session.pick(x, y);
            self.awaited_click = Some(click);
            self.interface.picking_focus = false;
        }
        self.viewport = ViewportFacts {
            size,
            zoom_percent: output.zoom_percent,
            hovered_pixel: output.hovered_pixel,
            flying: output.flying,
            rect: output.rect,
        };
    }

    fn status_line(&self, frame: Option<&Frame>) -> StatusLine {
        let status = self.work.session.status();
        let work = match &status.phase {
            Phase::Idle => Work::Idle,
            Phase::Building => Work::Building,
            Phase::Preview | Phase::Refining => Work::Rendering,
            Phase::Paused => Work::Paused,
            Phase::Done => Work::Done,
            Phase::Failed(reason) => Work::Failed(reason.clone()),
        };
        let size = frame.map_or(self.viewport.size, |frame| [frame.job.width, frame.job.height]);
        StatusLine {
            work,
            samples: (status.samples, status.goal_samples),
            noise_percent: status.noise_percent,
            seconds: status.seconds,
            seconds_left: status.seconds_left,
            rays_per_second: status.rays_per_second,
            n_threads: status.n_threads,
            size,
            zoom_percent: self.viewport.zoom_percent,
        }
    }

    /// Makes what the panels did a step of undo. What no scene file could say is not taken over:
    /// the scene stays at its last valid state.
    fn take_edit(&mut self, scene: SceneDescription) {
        if scene == self.document.description {
            return;
        }
        if let Err(fault) = scene_file::validate(&scene) {
            self.toasts.say(fault.to_string());
            return;
        }
        let label = edit_label(&self.document.description, &scene);
        self.document.description = scene;
        self.document.checkpoint(label, Some(self.gesture.id()));
    }

    /// The bytes on show.
    pub(super) fn picture_on_show(&self) -> Option<&Arc<egui::ColorImage>> {
        self.picture.image()
    }

    /// Takes over what changed in `scene`, makes it the job, and shows the newest picture.
    fn render(&mut self, ctx: &egui::Context, scene: SceneDescription) {
        self.take_edit(scene);
        if self.files.has_scene {
            let description = &self.document.description;
            let submitted = self.work.submit(description, &self.interface, self.viewport.size);
            match submitted {
                Ok(()) => self.files.missing = None,
                Err(missing) => self.load_missing(missing),
            }
        }
        self.work.session.set_paused(self.interface.is_paused);
        if let Some(frame) = self.work.session.latest() {
            self.picture.show(&frame, &self.document.description.tone_mapping);
            if frame.scale == 1 {
                self.work.note_noise(frame.generation, frame.samples, frame.noise_percent);
            }
            self.take_snapshot(ctx, &frame);
        }
        self.picture.update(ctx);
    }
}

impl App {
    /// Takes what other threads have finished; also while the window is hidden.
    pub(super) fn take_news(&mut self, ctx: &egui::Context) {
        self.take_results(ctx);
        self.guard_close(ctx);
    }

    /// One frame of the window.
    pub(super) fn frame_ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.gesture.update(&ctx);
        let mut scene = self.document.description.clone();
        for action in keys::pressed(&ctx, self.viewport.flying) {
            self.do_action(&ctx, &mut scene, action);
        }
        self.take_dropped_file(&ctx);
        self.layout_ui(ui, &mut scene);
        self.take_pick(&mut scene);
        self.render(&ctx, scene);
        if self.interface.help_shown {
            help::help_ui(&ctx, &mut self.interface.help_shown);
        }
        self.ask_for_paths(&ctx);
        self.ask_about_unsaved(&ctx);
        let foot = self.viewport.rect.center_bottom() - egui::Vec2::new(0.0, 16.0);
        self.toasts.show(&ctx, foot);
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.take_news(ctx);
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.frame_ui(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, Remembered::KEY, &Remembered::of(&self.interface));
    }
}

/// What undo would say it undoes.
fn edit_label(before: &SceneDescription, after: &SceneDescription) -> &'static str {
    if before.camera != after.camera {
        "camera"
    } else if before.lights != after.lights {
        "light"
    } else if before.materials != after.materials {
        "material"
    } else if before.textures != after.textures {
        "texture"
    } else if before.objects != after.objects {
        "object"
    } else if before.environment != after.environment {
        "background"
    } else if before.tone_mapping != after.tone_mapping {
        "exposure and curve"
    } else {
        "render settings"
    }
}

/// What is edited until the first scene is there.
fn empty_scene() -> SceneDescription {
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

/// The linear value of a pixel of the picture, from a frame that may be coarser.
fn pixel_at(frame: &Frame, [x, y]: [u32; 2]) -> Option<PixelUnderCursor> {
    let picture = &frame.picture;
    let (column, row) = (x / frame.scale.max(1), y / frame.scale.max(1));
    if picture.width <= column || picture.height <= row {
        return None;
    }
    let index = row as usize * picture.width as usize + column as usize;
    let linear = *picture.pixels.get(index)?;
    Some(PixelUnderCursor { at: [x, y], linear })
}

/// Size and cost of the trees, name and value.
fn tree_lines(tree: Option<&TreeStatistics>) -> Vec<(&'static str, String)> {
    let Some(tree) = tree else { return Vec::new() };
    vec![
        ("Built in", format!("{:.0} ms", tree.build_secs * 1e3)),
        ("Nodes", tree.n_nodes.to_string()),
        ("Memory", format!("{:.1} MB", tree.n_bytes as f64 / 1e6)),
    ]
}

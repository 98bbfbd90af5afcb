//! Where things are in the window: bars, panel, picture. All of them edit one description in place.

use super::app::{App, ViewportFacts};
use super::figures::bytes_text;
use super::handles::lights_in_picture;
use super::keys::Action;
use super::loupe::{LoupeFacts, loupe_ui};
use super::panels::{self, Convergence, RenderFacts};
use super::parameter::take_reset;
use super::probe::{described, feature_at, pixel_at};
use super::start::start_ui;
use super::status::{StatusLine, Work, loading_ui, status_ui};
use super::toolbar::{ToolbarChoice, ToolbarFacts, toolbar_ui};
use super::viewport::{ViewportOutput, physical_size, viewport_ui};
use super::views::legend_ui;
use super::work::picture_size;
use crate::geometry::{AcceleratorKind, TreeStatistics};
use crate::scene::description::SceneDescription;
use crate::session::{Frame, Phase};
use crate::threads;
use egui::{Margin, Panel, Rect, Ui};

/// How wide the panel can be, in points: what its lines need, and what is left to the picture.
const PANEL_RANGE: std::ops::RangeInclusive<f32> = 324.0..=520.0;

impl App {
    /// The bars, the panel and the picture, editing `scene` in place.
    pub(super) fn layout_ui(&mut self, ui: &mut Ui, scene: &mut SceneDescription) {
        let frame = self.work.session.latest();
        let chosen = self.toolbar(ui, scene);
        self.status_bar(ui, frame.as_deref());
        let panel_shown = self.interface.panel_shown && !self.interface.start_shown;
        let side = Panel::right("settings")
            .default_size(self.interface.panel_width)
            .size_range(PANEL_RANGE)
            .resizable(true)
            .frame(egui::Frame::side_top_panel(ui.style()).inner_margin(Margin {
                left: 8,
                right: 2,
                top: 2,
                bottom: 0,
            }));
        if panel_shown {
            let shown = side.show(ui, |ui| {
                egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    self.panel_ui(ui, scene);
                });
            });
            self.interface.panel_width = shown.response.rect.width();
            if let Err(reason) = take_reset(ui.ctx(), scene) {
                self.toasts.fail(reason);
            }
        }
        egui::CentralPanel::no_frame().show(ui, |ui| {
            if self.interface.start_shown {
                self.start_page(ui);
            } else {
                self.central_ui(ui, scene);
            }
        });
        self.interface.theme = ui.options(|options| options.theme_preference);
        if let Some(chosen) = chosen {
            self.do_choice(ui.ctx(), scene, chosen);
        }
    }

    fn toolbar(&mut self, ui: &mut Ui, scene: &mut SceneDescription) -> Option<ToolbarChoice> {
        let facts = ToolbarFacts {
            title: &self.files.title,
            has_unsaved: self.document.is_dirty(),
            undo: self.document.undo_label(),
            redo: self.document.redo_label(),
            is_paused: self.interface.is_paused,
            panel_shown: self.interface.panel_shown,
            start_shown: self.interface.start_shown,
            keys: &self.keys,
            picture: self.exporter.progress(),
            view: self.interface.display.view,
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
                let Some(name) = &self.files.loading else {
                    return status_ui(ui, &line, pixel, self.probe.answer());
                };
                if loading_ui(ui, name, &self.files.loader.progress()) {
                    self.files.cancel_loading();
                }
            });
    }

    fn panel_ui(&mut self, ui: &mut Ui, scene: &mut SceneDescription) {
        let status = self.work.session.status();
        let mut n_threads = self.interface.n_threads();
        let interface = &mut self.interface;
        let (swatches, assets) = (&mut self.swatches, &self.work.assets);
        let facts = RenderFacts {
            n_processors: threads::available(),
            accelerators: &AcceleratorKind::ALL.map(AcceleratorKind::name),
            tree: tree_lines(status.trees.as_ref()),
            convergence: Convergence {
                noise: self.work.noise_of(status.generation),
                seconds: status.seconds,
                is_rendering: matches!(status.phase, Phase::Preview | Phase::Refining),
            },
        };
        let summary = format!("{} samples", scene.render.samples);
        panels::section(ui, "Render", &summary, false, |ui| {
            let (size, accelerator) = (&mut interface.size_mode, &mut interface.accelerator);
            let (limits, before) = (&mut interface.limits, n_threads);
            let render = &mut scene.render;
            panels::render_ui(ui, render, size, accelerator, &mut n_threads, limits, &facts);
            if n_threads != before {
                interface.n_threads = Some(n_threads);
            }
        });
        panels::section(ui, "Camera & lens", "", true, |ui| {
            let (unit, picking) = (&mut interface.scene_unit_mm, &mut interface.picking);
            panels::camera_ui(ui, &mut scene.camera, unit, picking, &mut interface.lens_shown);
        });
        let summary = scene.lights.len().to_string();
        panels::section(ui, "Lights", &summary, true, |ui| {
            let (picking, shown) = (&mut interface.picking, &mut interface.lights_shown);
            panels::lights_ui(ui, scene, &mut interface.selection, picking, shown);
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

    fn start_page(&mut self, ui: &mut Ui) {
        let (recent, can_return) = (&self.interface.recent, self.files.has_scene);
        self.thumbnails.update(ui.ctx(), self.recent_pictures.places(recent));
        let chosen = start_ui(ui, &self.thumbnails, recent, can_return);
        self.viewport.hovered_pixel = None;
        self.viewport.flying = false;
        self.viewport.rect = ui.max_rect();
        if let Some(choice) = chosen {
            self.do_start(ui.ctx(), choice);
        }
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
            &mut self.interface.display,
            self.interface.picking,
        );
        if let Some(click) = output.click.filter(|_| !self.gesture.closes_menu()) {
            let (x, y) = click.at();
            self.work.session.pick(x, y);
            self.awaited_click = Some(click);
            self.interface.picking = None;
        }
        let (picture, clip) = (output.picture, output.rect);
        if self.interface.lights_shown {
            let selected = &mut self.interface.selection.light;
            lights_in_picture(ui, picture, clip, scene, selected);
        }
        let frame = self.work.session.latest();
        if self.marks_sharpness(ui.ctx()) {
            let features = frame.as_ref().and_then(|frame| frame.maps.features.as_ref());
            self.lens_overlay.show(ui, picture, clip, &scene.camera, features);
        } else {
            self.lens_overlay.hide();
        }
        let covers = self.pinned_ui(ui, picture, clip, scene);
        if let Some(legend) = self.picture.legend().filter(|_| !covers) {
            legend_ui(ui, clip, legend);
        }
        self.look_closely(ui, &output, frame.as_deref(), scene);
        self.viewport = ViewportFacts {
            size,
            zoom_percent: output.zoom_percent,
            hovered_pixel: output.hovered_pixel,
            flying: output.flying,
            rect: output.rect,
        };
    }

    /// The pinned picture beside the live one, or alone while its key is held: true where it
    /// covers the live one.
    fn pinned_ui(
        &mut self,
        ui: &mut Ui,
        picture: Rect,
        clip: Rect,
        scene: &mut SceneDescription,
    ) -> bool {
        let is_held = self.keys.is_held(ui.ctx(), Action::ShowPinned);
        let Some(pinned) = &mut self.pinned else { return false };
        if is_held {
            pinned.show_alone(ui, picture, clip);
        } else if let Some(choice) = pinned.show(ui, picture, clip, scene) {
            self.do_compare(scene, choice);
        }
        is_held
    }

    /// What is under the cursor: for the status bar, and large in the loupe.
    fn look_closely(
        &mut self,
        ui: &mut Ui,
        output: &ViewportOutput,
        frame: Option<&Frame>,
        scene: &SceneDescription,
    ) {
        let [_, height] = self.viewport.size;
        let known = output.hovered_pixel.zip(frame).and_then(|(at, frame)| {
            let feature = feature_at(frame, at)?;
            Some(described(feature, scene, &self.work.assets, height))
        });
        let is_free = self.awaited_click.is_none();
        self.probe.follow(ui.ctx(), output.hovered_pixel, known, is_free, &self.work.session);
        let is_held = self.keys.is_held(ui.ctx(), Action::Loupe);
        self.interface.loupe.follow(is_held, ui.input(|input| input.time));
        let pixel = output.hovered_pixel.and_then(|at| pixel_at(frame?, at));
        if let (true, Some(pixel)) = (self.interface.loupe.shown, pixel)
            && let (Some(image), Some(cursor)) =
                (self.picture.image(), ui.ctx().pointer_hover_pos())
        {
            let (size, probed) = (self.viewport.size, self.probe.answer());
            let facts = LoupeFacts { image, size, pixel, probed };
            loupe_ui(ui, output.rect, cursor, &facts);
        }
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
            noise: status.noise,
            seconds: status.seconds,
            seconds_left: status.seconds_left,
            rays_per_second: status.rays_per_second,
            n_invalid: status.n_invalid,
            n_threads: status.n_threads,
            size,
            zoom_percent: self.viewport.zoom_percent,
        }
    }
}

/// Size and cost of the trees, name and value.
fn tree_lines(tree: Option<&TreeStatistics>) -> Vec<(&'static str, String)> {
    let Some(tree) = tree else { return Vec::new() };
    vec![
        ("Built in", format!("{:.0} ms", tree.build_secs * 1e3)),
        ("Nodes", tree.n_nodes.to_string()),
        ("Memory", bytes_text(tree.n_bytes as f64)),
    ]
}

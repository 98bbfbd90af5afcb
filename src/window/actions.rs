//! What each action does.

use super::app::App;
use super::compare::{CompareChoice, Pinned};
use super::dialogs::Purpose;
use super::export_dialog::{ExportChoice, ExportFacts, export_ui};
use super::help::{HelpChoice, help_ui};
use super::keys::{self, Action};
use super::start::StartChoice;
use super::toolbar::ToolbarChoice;
use crate::io::gallery::GALLERY;
use crate::io::output::create_file;
use crate::io::scene_file;
use crate::loader::Source;
use crate::scene::description::{SceneDescription, ToneOperator};
use crate::scene::orbit::{self, StandardView};
use egui::ViewportCommand;

impl App {
    /// Does what a key, a button or a menu asks for.
    pub(super) fn do_action(
        &mut self,
        ctx: &egui::Context,
        scene: &mut SceneDescription,
        action: Action,
    ) {
        let needs_scene = !matches!(
            action,
            Action::Open
                | Action::Gallery
                | Action::TogglePanel
                | Action::FullScreen
                | Action::LargerText
                | Action::SmallerText
                | Action::UsualText
                | Action::Help
                | Action::Cancel
        );
        if needs_scene && !self.files.has_scene {
            self.toasts.say("there is no scene yet; open one");
            return;
        }
        match action {
            Action::FrameAll => self.frame_all(scene),
            Action::HomeCamera => {
                scene.camera = self.home_camera.clone();
                self.interface.navigation.pivot = None;
            }
            Action::ViewFront => self.standard_view(scene, StandardView::Front),
            Action::ViewSide => self.standard_view(scene, StandardView::Side),
            Action::ViewTop => self.standard_view(scene, StandardView::Top),
            Action::Pause => self.interface.is_paused = !self.interface.is_paused,
            Action::Restart => self.work.session.restart(),
            Action::Brighter => step_exposure(scene, 0.5),
            Action::Darker => step_exposure(scene, -0.5),
            Action::NextOperator => {
                scene.tone_mapping.operator = next_operator(scene.tone_mapping.operator);
            }
            Action::ToggleLens => self.toggle_lens(scene),
            Action::Snapshot => self.snapshot(),
            Action::RenderPicture => self.interface.export_shown = !self.interface.export_shown,
            Action::Save => self.save_scene(ctx),
            Action::SaveAs => self.ask_where_to_save(ctx),
            Action::Open => self.dialogs.ask(ctx, Purpose::Open, ""),
            Action::Gallery => self.interface.start_shown = !self.interface.start_shown,
            Action::CloseScene => {
                self.ask_to_close_scene(ctx);
                scene.clone_from(&self.document.description);
            }
            Action::CopyImage => self.copy_picture(ctx),
            Action::Undo => {
                if let Some(step) = self.document.undo() {
                    self.toasts.say_anew("undone: ", &step);
                }
                scene.clone_from(&self.document.description);
            }
            Action::Redo => {
                if let Some(step) = self.document.redo() {
                    self.toasts.say_anew("done again: ", &step);
                }
                scene.clone_from(&self.document.description);
            }
            Action::Compare => self.toggle_compare(ctx),
            Action::ShowPinned if self.pinned.is_none() => {
                self.toasts.say("pin a picture first, then hold the key to see it");
            }
            // Shown as long as the key is down.
            Action::ShowPinned => {}
            Action::Show(view) => self.interface.display.view = view,
            Action::Loupe => self.interface.loupe.press(ctx.input(|input| input.time)),
            Action::TogglePanel => self.interface.panel_shown = !self.interface.panel_shown,
            Action::FullScreen => {
                let full = ctx.input(|input| input.viewport().fullscreen.unwrap_or(false));
                ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!full));
            }
            Action::LargerText => self.enlarge_text(ctx, 1.0),
            Action::SmallerText => self.enlarge_text(ctx, -1.0),
            Action::UsualText => {
                self.interface.scale = 1.0;
                self.enlarge_text(ctx, 0.0);
            }
            Action::Help => self.interface.help_shown = !self.interface.help_shown,
            Action::Cancel => self.cancel(ctx),
        }
    }

    /// Does what was chosen in the toolbar.
    pub(super) fn do_choice(
        &mut self,
        ctx: &egui::Context,
        scene: &mut SceneDescription,
        choice: ToolbarChoice,
    ) {
        match choice {
            ToolbarChoice::Do(action) => self.do_action(ctx, scene, action),
            ToolbarChoice::File(path) => self.open(Source::File(path)),
            ToolbarChoice::PathBox => self.dialogs.type_path(Purpose::Open, ""),
            ToolbarChoice::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
        }
    }

    /// Does what was chosen on the start page.
    pub(super) fn do_start(&mut self, ctx: &egui::Context, choice: StartChoice) {
        match choice {
            StartChoice::Open => self.dialogs.ask(ctx, Purpose::Open, ""),
            StartChoice::File(path) => self.open(Source::File(path)),
            StartChoice::Back => self.interface.start_shown = false,
            StartChoice::Gallery(index) => {
                if let Some(entry) = GALLERY.get(index) {
                    self.open(Source::Gallery(entry.name));
                }
            }
        }
    }

    /// Shows the box that renders a picture, where it is wanted, and does what is chosen in it.
    pub(super) fn export_box(&mut self, ctx: &egui::Context) {
        if !self.interface.export_shown || self.interface.start_shown {
            return;
        }
        let facts = ExportFacts {
            live: self.viewport.size,
            samples: self.document.description.render.samples,
            title: &self.files.title,
            progress: self.exporter.progress(),
        };
        match export_ui(ctx, &mut self.interface.export, &facts) {
            None => {}
            Some(ExportChoice::Render) => self.export_wanted = true,
            Some(ExportChoice::Stop) => self.exporter.stop(),
            Some(ExportChoice::Close) => self.interface.export_shown = false,
            Some(ExportChoice::ChooseFolder) => {
                let folder = self.interface.export.folder().display().to_string();
                self.dialogs.ask(ctx, Purpose::PictureFolder, &folder);
            }
        }
    }

    /// Shows the list of keys, where it is wanted.
    pub(super) fn help_overlay(&mut self, ctx: &egui::Context) {
        if !self.interface.help_shown {
            return;
        }
        match help_ui(ctx, &self.keys, self.keys_file.as_deref()) {
            None => {}
            Some(HelpChoice::Close) => self.interface.help_shown = false,
            Some(HelpChoice::MakeKeysFile) => {
                let Some(path) = self.keys_file.clone() else { return };
                match create_file(&path, keys::file::template().as_bytes()) {
                    Ok(()) => self.toasts.say(format!(
                        "{} is there; edit it and start Penumbra again",
                        path.display()
                    )),
                    Err(error) => self.toasts.fail(error.to_string()),
                }
            }
        }
    }

    /// Shows the box for a path and takes what the dialogs answered.
    pub(super) fn ask_for_paths(&mut self, ctx: &egui::Context) {
        if let Some(answered) = self.dialogs.take_answer(ctx, self.viewport.rect) {
            self.take_path(ctx, answered);
        }
    }

    fn enlarge_text(&mut self, ctx: &egui::Context, tenths: f32) {
        self.interface.enlarge(tenths);
        ctx.set_zoom_factor(self.interface.scale);
        let percent = format!("{:.0} %", self.interface.scale * 100.0);
        self.toasts.say_anew("text at ", &percent);
    }

    fn cancel(&mut self, ctx: &egui::Context) {
        let closed = std::mem::take(&mut self.interface.help_shown)
            || self.dismiss_path_box()
            || self.stop_asking()
            || self.interface.picking.take().is_some()
            || std::mem::take(&mut self.interface.loupe.shown)
            || self.files.cancel_loading()
            || self.toasts.dismiss()
            || std::mem::take(&mut self.interface.export_shown)
            || (self.files.has_scene && std::mem::take(&mut self.interface.start_shown));
        let full = ctx.input(|input| input.viewport().fullscreen.unwrap_or(false));
        if !closed && full {
            ctx.send_viewport_cmd(ViewportCommand::Fullscreen(false));
        }
    }

    fn dismiss_path_box(&mut self) -> bool {
        let was_open = self.dialogs.dismiss();
        if was_open {
            self.give_up_saving();
        }
        was_open
    }

    /// Pins the picture on show, or lets the pinned one go.
    fn toggle_compare(&mut self, ctx: &egui::Context) {
        if self.pinned.take().is_some() {
            return;
        }
        match self.picture.fitted() {
            Some(image) => {
                let description = self.document.description.clone();
                self.pinned = Some(Pinned::new(ctx, image, description));
            }
            None => self.toasts.say("there is no picture to pin yet"),
        }
    }

    /// Does what was chosen at the pinned picture.
    pub(super) fn do_compare(&mut self, scene: &mut SceneDescription, choice: CompareChoice) {
        self.gesture.next();
        match choice {
            CompareChoice::RestoreOne(path, value) => {
                match scene_file::with_value(scene, &path, value) {
                    Ok(restored) => *scene = restored,
                    Err(error) => self.toasts.say(error.to_string()),
                }
            }
            CompareChoice::Restore => {
                if let Some(pinned) = self.pinned.take() {
                    *scene = pinned.description;
                }
            }
            CompareChoice::Close => self.pinned = None,
        }
    }

    fn frame_all(&mut self, scene: &mut SceneDescription) {
        let [width, height] = self.picture_size();
        let aspect = f64::from(width) / f64::from(height.max(1));
        scene.camera = orbit::framed(&scene.camera, &self.work.bounds(), aspect);
        self.interface.navigation.pivot = None;
    }

    fn standard_view(&mut self, scene: &mut SceneDescription, view: StandardView) {
        let pivot = self.interface.navigation.pivot(&scene.camera);
        scene.camera = orbit::standard_view(&scene.camera, pivot, view);
    }

    fn toggle_lens(&mut self, scene: &mut SceneDescription) {
        let radius = scene.camera.aperture_radius;
        if radius > 0.0 {
            self.interface.lens_when_open = Some(radius);
            scene.camera.aperture_radius = 0.0;
        } else {
            let usual = orbit::focal_distance(&scene.camera) * 0.01;
            scene.camera.aperture_radius = self.interface.lens_when_open.unwrap_or(usual);
        }
    }

    /// Asks where to save, and suggests the scene's own file, or one of its name at home.
    fn ask_where_to_save(&mut self, ctx: &egui::Context) {
        let own = self.files.scene_path.clone();
        let suggestion = own.clone().unwrap_or_else(|| {
            let name = format!("{}.toml", self.files.title);
            let home = || std::env::home_dir().unwrap_or_default().join(&name);
            self.files.folder.disk_path(&name).unwrap_or_else(home)
        });
        self.dialogs.own_file = own;
        self.dialogs.ask(ctx, Purpose::SaveScene, &suggestion.display().to_string());
    }

    pub(super) fn save_scene(&mut self, ctx: &egui::Context) {
        match self.files.scene_path.clone() {
            Some(path) => self.save_to(ctx, path),
            None => self.ask_where_to_save(ctx),
        }
    }
}

fn step_exposure(scene: &mut SceneDescription, stops: f64) {
    scene.tone_mapping.exposure = (scene.tone_mapping.exposure + stops).clamp(-64.0, 64.0);
}

fn next_operator(operator: ToneOperator) -> ToneOperator {
    match operator {
        ToneOperator::Agx => ToneOperator::Aces,
        ToneOperator::Aces => ToneOperator::Reinhard,
        ToneOperator::Reinhard => ToneOperator::Linear,
        ToneOperator::Linear => ToneOperator::Agx,
    }
}

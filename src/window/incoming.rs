//! What comes back from the threads that work for the window, and from other programs.

use super::app::{App, empty_scene};
use super::files::{Written, file_title};
use super::keys::Action;
use super::panels::{self, PickFor};
use super::probe::{described, part_of};
use super::status::Probed;
use super::structure::Part;
use super::viewport::Click;
use crate::document::Document;
use crate::loader::{LoadError, Loaded, Source};
use crate::render::Feature;
use crate::scene::Assets;
use crate::scene::description::{ColorOrTexture, SceneDescription};
use crate::scene::resolve::ResolveError;
use egui::ViewportCommand;
use std::path::PathBuf;
use std::sync::Arc;

/// Lines of a load report that are told at once; the panel has them all.
const MOST_REPORTED: usize = 3;

impl App {
    /// Takes what the loader and the writers have finished.
    pub(super) fn take_results(&mut self, ctx: &egui::Context) {
        match self.files.loader.take() {
            None | Some(Err(LoadError::Cancelled)) => {}
            Some(Ok(loaded)) if self.files.is_completing => self.take_assets(loaded),
            Some(Ok(loaded)) if self.files.is_reloading => self.take_reloaded(loaded),
            Some(Ok(loaded)) => self.take_scene(ctx, loaded),
            Some(Err(failure)) => {
                self.files.loading = None;
                self.files.is_completing = false;
                if std::mem::take(&mut self.files.is_reloading) {
                    self.toasts.settle(&mut self.files.reload_fault);
                    self.files.reload_fault = Some(failure.to_string());
                }
                self.toasts.fail(failure.to_string());
            }
        }
        while let Some(written) = self.files.take_written() {
            match written {
                Written::Scene { path, description } => {
                    self.toasts.say(format!("saved {}", path.display()));
                    self.files.title = file_title(&path);
                    self.interface.remember_file(path.clone());
                    if *description == self.document.description {
                        self.document.mark_saved(&path);
                    }
                    self.files.source = Some(Source::File(path.clone()));
                    self.files.scene_path = Some(path);
                    self.recent_pictures.forget();
                    self.watch_files();
                    self.go_on(ctx);
                }
                Written::Snapshot(path) => {
                    self.toasts.say(format!("snapshot {}", path.display()));
                }
                Written::RecentPicture => {
                    self.recent_pictures.note_written();
                    self.thumbnails.look_again();
                }
                Written::Copy => self.recovery.note_written(),
                Written::NoCopy(reason) => {
                    if self.recovery.note_failed() {
                        self.toasts.fail(reason);
                    }
                }
                Written::Failed(reason) => {
                    self.files.pending = None;
                    self.files.is_saving_first = false;
                    self.toasts.fail(reason);
                }
            }
        }
    }

    /// Answers the question that a click in the picture asked of the renderer.
    pub(super) fn take_pick(&mut self, ctx: &egui::Context, scene: &mut SceneDescription) {
        let Some(picked) = self.work.session.take_picked() else { return };
        let asked = self.awaited_click.filter(|click| click.at() == (picked.x, picked.y));
        let Some(click) = asked else {
            self.probe.take(&picked, scene, &self.work.assets, self.picture_size()[1]);
            return;
        };
        self.awaited_click = None;
        let Some(pick) = picked.pick else {
            if matches!(click, Click::Choose(..)) {
                return;
            }
            self.toasts.say("there is nothing under the cursor");
            return;
        };
        let (point, depth) = (pick.point.map(f64::from), f64::from(pick.feature.depth));
        let eye = scene.camera.eye;
        let light = scene.lights.get_mut(self.interface.selection.light);
        match (click, light) {
            (Click::TurnAbout(..), _) => {
                self.interface.navigation.pivot = Some(point);
                self.toasts.say("the camera turns about this point now");
            }
            (Click::Choose(..), _) => self.choose(ctx, scene, &pick.feature),
            (Click::For(PickFor::Focus, ..), _) => scene.camera.focal_distance = Some(depth),
            (Click::For(PickFor::LightTarget, ..), Some(light)) => light.target = point,
            (Click::For(PickFor::LightPosition, ..), Some(light)) => {
                // Off the surface towards the eye, so that it shines.
                let towards = |axis: usize| point[axis] + (eye[axis] - point[axis]) * 0.12;
                light.position = [towards(0), towards(1), towards(2)];
            }
            (Click::For(PickFor::LightTarget | PickFor::LightPosition, ..), None) => {}
        }
        self.gesture.next();
    }

    /// Shows in the panel what was clicked on: the light, or the object with what it is made of.
    fn choose(&mut self, ctx: &egui::Context, scene: &SceneDescription, feature: &Feature) {
        let selection = &mut self.interface.selection;
        let told = described(feature, scene, &self.work.assets, 1);
        match part_of(feature, scene) {
            None => return,
            Some((Part::Light, index)) => {
                selection.light = index;
                panels::reveal(ctx, &["Lights"]);
            }
            Some((_, index)) => {
                selection.object = index;
                let mut materials = scene.materials.iter();
                panels::reveal(ctx, &["Scene"]);
                if let Some(index) = materials.position(|one| one.name == told.material) {
                    panels::reveal(ctx, &["Materials", "Scene"]);
                    selection.material = index;
                    if let ColorOrTexture::Texture(name) = &scene.materials[index].diffuse {
                        let mut textures = scene.textures.iter();
                        let texture = textures.position(|texture| texture.name == *name);
                        selection.texture = texture.unwrap_or(selection.texture);
                    }
                }
            }
        }
        if self.interface.panel_shown {
            return;
        }
        // The panel would say it.
        let Probed { object, material, .. } = told;
        let made_of = if material.is_empty() { String::new() } else { format!(", {material}") };
        let hint = self.keys.hint("shown in the panel", Action::TogglePanel);
        self.toasts.say(format!("{object}{made_of}: {hint}"));
    }

    /// Opens a file that was dropped on the window.
    pub(super) fn take_dropped_file(&mut self, ctx: &egui::Context) {
        let dropped: Option<PathBuf> =
            ctx.input(|input| input.raw.dropped_files.first().map(|file| file.path().to_owned()));
        if let Some(path) = dropped {
            self.open(Source::File(path));
        }
    }

    fn take_scene(&mut self, ctx: &egui::Context, loaded: Loaded) {
        let Loaded { source, folder, description, assets, files, report, snapshot: _ } = loaded;
        self.files.loading = None;
        self.files.has_scene = true;
        let is_copy = self.recovery.is_copy(&source);
        self.files.title = if is_copy { "restored".to_owned() } else { source.stem() };
        self.files.folder = folder;
        self.files.source = Some(source.clone());
        self.files.missing = None;
        self.files.records = files;
        self.files.scene_path = None;
        if let Source::File(path) = &source
            && !is_copy
        {
            self.interface.remember_file(path.clone());
            if path.extension().is_some_and(|ending| ending == "toml") {
                self.files.scene_path = Some(path.clone());
            }
        }
        if !report.is_empty() {
            let mut told =
                report.iter().take(MOST_REPORTED).cloned().collect::<Vec<_>>().join("\n");
            if MOST_REPORTED < report.len() {
                told += &format!("\nand {} more, listed under Scene", report.len() - MOST_REPORTED);
            }
            self.toasts.warn(told);
        }
        self.files.report = report;
        self.home_camera = description.camera.clone();
        self.interface.forget_scene();
        self.recent_pictures.forget();
        self.pinned = None;
        self.awaited_click = None;
        self.work.session.abandon();
        self.work.set_assets(Arc::new(assets));
        self.document = if self.recovery.is_copy(&source) {
            // No file of the user's holds it.
            self.recovery.note_restored();
            Document::unsaved(description, empty_scene())
        } else {
            Document::new(description, self.files.scene_path.clone())
        };
        self.gesture.next();
        self.watch_files();
        ctx.send_viewport_cmd(ViewportCommand::Title(format!("{} – Penumbra", self.files.title)));
    }

    /// Closes the scene and shows the start page.
    pub(super) fn close_scene(&mut self, ctx: &egui::Context) {
        self.files.close_scene();
        self.interface.forget_scene();
        self.interface.start_shown = true;
        self.interface.export_shown = false;
        self.pinned = None;
        self.awaited_click = None;
        self.snapshot_wanted = false;
        self.work.session.clear();
        self.picture.clear();
        self.work.set_assets(Arc::default());
        self.document = Document::new(empty_scene(), None);
        self.gesture.next();
        self.watch_files();
        ctx.send_viewport_cmd(ViewportCommand::Title("Penumbra".to_owned()));
    }

    /// Takes the files that an edit made necessary; the edit itself is in the document.
    fn take_assets(&mut self, loaded: Loaded) {
        self.files.loading = None;
        self.files.is_completing = false;
        self.files.records = loaded.files;
        self.work.set_assets(Arc::new(loaded.assets));
    }

    /// Takes over what another program made of the open scene, in one step of undo. A camera that
    /// was moved stays, unless the file moved it too; and so do all edits, where only a mesh or an
    /// image is another, also where the scene is made up around that mesh.
    fn take_reloaded(&mut self, loaded: Loaded) {
        self.files.loading = None;
        self.files.is_reloading = false;
        self.toasts.settle(&mut self.files.reload_fault);
        self.files.folder = loaded.folder;
        self.files.records = loaded.files;
        self.files.report = loaded.report;
        self.work.set_assets(Arc::new(loaded.assets));
        self.recent_pictures.forget();
        self.watch_files();
        let mut description = loaded.description;
        let file_camera = description.camera.clone();
        if loaded.source.is_mesh() {
            self.home_camera = file_camera;
            self.document.rebase(description);
            self.toasts.say("reloaded: another program changed a file of the scene");
            return;
        }
        let saved = self.document.saved();
        let has_camera_moved = file_camera != self.home_camera && file_camera != saved.camera;
        if !has_camera_moved {
            description.camera = saved.camera.clone();
        }
        if description == *saved {
            self.toasts.say("reloaded: another program changed a file of the scene");
            return;
        }
        if !has_camera_moved {
            description.camera = self.document.description.camera.clone();
        }
        let had_edits = self.document.is_dirty();
        self.home_camera = file_camera;
        self.document.reload(description);
        if had_edits {
            self.toasts
                .warn("reloaded: another program changed the scene; undo brings your edits back");
        } else {
            self.toasts.say("reloaded: another program changed the scene");
        }
    }

    /// Loads the open scene again where another program changed one of its files.
    pub(super) fn reload_if_changed(&mut self) {
        let is_busy = self.files.loading.is_some();
        if is_busy || !self.watcher.take_news() {
            return;
        }
        if let Some(source) = self.files.source.clone() {
            self.files.open(source);
            self.files.is_reloading = true;
        }
    }

    /// Watches the files of the open scene, as they are now.
    fn watch_files(&self) {
        let scene = match &self.files.source {
            // The copy for a crash is written by this window itself.
            Some(source) if self.recovery.is_copy(source) => None,
            Some(Source::File(path)) => Some(path.clone()),
            Some(Source::Gallery(_)) | None => None,
        };
        let used = self
            .files
            .records
            .iter()
            .filter_map(|record| self.files.folder.disk_path(&record.file));
        self.watcher.watch(scene.into_iter().chain(used).collect());
    }

    /// Loads what the edited scene names and nobody has read yet.
    pub(super) fn load_missing(&mut self, missing: ResolveError) {
        let is_file = match &missing {
            ResolveError::Mesh(_) | ResolveError::Image(_) => true,
            ResolveError::Invalid { .. } => false,
        };
        if self.files.missing.as_ref() == Some(&missing) {
            return;
        }
        if !is_file {
            self.toasts.fail(format!("cannot render this scene: {missing}"));
        } else if let Some(source) = self.files.source.clone() {
            self.files.is_completing = true;
            self.files.loading = Some("what the edit needs".to_owned());
            self.files.loader.complete(Loaded {
                source,
                folder: self.files.folder.clone(),
                description: self.document.description.clone(),
                assets: Assets::clone(&self.work.assets),
                files: self.files.records.clone(),
                report: Vec::new(),
                snapshot: None,
            });
        }
        self.files.missing = Some(missing);
    }
}

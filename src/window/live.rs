//! The live picture: what was edited becomes a step of undo, the scene a job, and the newest
//! picture is shown.

use super::app::App;
use crate::io::scene_file;
use crate::scene::description::{CameraDescription, SceneDescription};
use crate::session::{Session, Wanted};
use crate::threads;
use std::sync::Arc;

impl App {
    /// Makes what the panels did a step of undo. What no scene file could say is not taken over:
    /// the scene stays at its last valid state.
    pub(super) fn take_edit(&mut self, scene: SceneDescription) {
        if scene == self.document.description {
            return;
        }
        if let Err(fault) = scene_file::validate(&scene) {
            self.toasts.say(fault.to_string());
            return;
        }
        if lens_of(&self.document.description.camera) != lens_of(&scene.camera) {
            self.lens_gesture = Some(self.gesture.id());
        }
        self.document.description = scene;
        self.document.checkpoint(Some(self.gesture.id()));
    }

    /// Whether what is sharp is marked in the picture: where that is switched on, and while the
    /// lens is dragged.
    pub(super) fn marks_sharpness(&self, ctx: &egui::Context) -> bool {
        let is_dragging = self.lens_gesture == Some(self.gesture.id())
            && ctx.input(|input| input.pointer.any_down());
        self.interface.lens_shown || is_dragging
    }

    /// The maps that something on the screen is made of.
    fn wanted(&self, ctx: &egui::Context) -> Wanted {
        let looks_behind = self.interface.loupe.shown || self.marks_sharpness(ctx);
        let features = Wanted { features: looks_behind, ..Wanted::NOTHING };
        self.interface.display.view.wanted().and(features)
    }

    /// Gives the renderer as many threads as are chosen. The old one ends on a thread of its own, so
    /// that the window does not wait for it.
    fn fit_threads(&mut self, ctx: &egui::Context) {
        let n_threads = self.interface.n_threads();
        if n_threads == self.work.session.status().n_threads {
            return;
        }
        let wake = ctx.clone();
        match Session::new(n_threads, move || wake.request_repaint()) {
            Ok(session) => {
                let old = std::mem::replace(&mut self.work.session, session);
                if threads::spawn("retire", move || drop(old)).is_err() {
                    self.toasts.fail("the system has no thread left");
                }
            }
            Err(error) => {
                self.interface.n_threads = Some(self.work.session.status().n_threads);
                self.toasts.fail(format!("cannot change the number of threads: {error}"));
            }
        }
    }

    /// The bytes on show.
    pub(super) fn picture_on_show(&self) -> Option<&Arc<egui::ColorImage>> {
        self.picture.image()
    }

    /// Takes over what changed in `scene`, makes it the job, and shows the newest picture.
    pub(super) fn render(&mut self, ctx: &egui::Context, scene: SceneDescription) {
        self.take_edit(scene);
        self.fit_threads(ctx);
        if self.files.has_scene {
            let description = &self.document.description;
            let submitted = self.work.submit(description, &self.interface, self.viewport.size);
            match submitted {
                Ok(()) => self.files.missing = None,
                Err(missing) => self.load_missing(missing),
            }
        }
        self.start_export(ctx);
        self.work.session.set_paused(self.interface.is_paused || !self.files.has_scene);
        self.work.session.want(self.wanted(ctx));
        let frame = self.work.session.latest().filter(|_| self.files.has_scene);
        if let Some(frame) = frame {
            let view = self.interface.display.view;
            self.picture.show(ctx, &frame, view, &self.document.description.tone_mapping);
            if frame.scale == 1 {
                self.work.note_noise(frame.generation, frame.samples, frame.noise);
            }
            self.take_snapshot(ctx, &frame);
            self.keep_recent_picture(ctx, &frame);
        }
        self.picture.update(ctx);
    }
}

/// What decides what is sharp.
fn lens_of(camera: &CameraDescription) -> (f64, Option<f64>) {
    (camera.aperture_radius, camera.focal_distance)
}

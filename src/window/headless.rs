//! The window without a screen, a frame at a time: what the benches measure.

use super::app::App;
use super::panels::SizeMode;
use super::state::Remembered;
use super::theme;
use crate::loader::Source;
use crate::scene::description::SceneDescription;
use crate::session::Phase;
use egui::{Event, ImageData, PointerButton, Pos2, Vec2, ViewportId};
use std::time::Duration;

/// Seconds between two frames of a usual display.
const FRAME_SECS: f64 = 1.0 / 60.0;

/// A whole window that draws to nothing.
pub struct Headless {
    pub(super) app: App,
    ctx: egui::Context,
    size: Vec2,
    time: f64,
    events: Vec<Event>,
    pointer: Option<Pos2>,
}

/// What a frame leaves to the graphics card.
pub struct HeadlessFrame {
    images: Vec<ImageData>,
    /// Triangles to be drawn.
    pub n_triangles: usize,
    /// Whether the window asked for another frame at once.
    pub wants_another: bool,
}

impl HeadlessFrame {
    /// Copies what is to be uploaded, as a driver does; gives back how many bytes it is.
    pub fn copy_images(&self, into: &mut Vec<egui::Color32>) -> usize {
        into.clear();
        for ImageData::Color(image) in &self.images {
            into.extend_from_slice(&image.pixels);
        }
        size_of_val(into.as_slice())
    }
}

impl Headless {
    /// A window of that size in points that starts loading; pictures have the size that the scene
    /// gives.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn new(source: Source, size: [f32; 2]) -> std::io::Result<Self> {
        let ctx = egui::Context::default();
        theme::install(&ctx);
        let mut app = App::new(&ctx, Remembered::default(), source, None)?;
        app.interface.size_mode = SizeMode::Fixed;
        Ok(Self { app, ctx, size: size.into(), time: 0.0, events: Vec::new(), pointer: None })
    }

    /// Everything that the window's own thread does for one frame, up to the graphics card.
    pub fn frame(&mut self) -> HeadlessFrame {
        self.time += FRAME_SECS;
        let mut input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(Pos2::ZERO, self.size)),
            time: Some(self.time),
            events: std::mem::take(&mut self.events),
            ..egui::RawInput::default()
        };
        let app = &mut self.app;
        app.pace(&self.ctx, &mut input);
        let mut output = self.ctx.run_ui(input, |ui| {
            app.take_news(ui.ctx());
            app.frame_ui(ui);
        });
        let primitives = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        let n_triangles = primitives.iter().map(|primitive| match &primitive.primitive {
            egui::epaint::Primitive::Mesh(mesh) => mesh.indices.len() / 3,
            egui::epaint::Primitive::Callback(_) => 0,
        });
        let deltas = output.textures_delta.set.values().flatten();
        let images = deltas.map(|delta| delta.image.clone()).collect();
        output.textures_delta.clear();
        let root = output.viewport_output.get(&ViewportId::ROOT);
        HeadlessFrame {
            images,
            n_triangles: n_triangles.sum(),
            wants_another: root.is_some_and(|root| root.repaint_delay == Duration::ZERO),
        }
    }

    /// Moves the pressed mouse over the middle of the picture by so many points in the next frame.
    pub fn drag(&mut self, by: [f32; 2]) {
        let middle = self.app.viewport.rect.center();
        let press = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        if self.pointer.is_none() {
            self.events.extend([Event::PointerMoved(middle), press(middle, true)]);
        }
        let to = self.pointer.unwrap_or(middle) + Vec2::from(by);
        self.events.push(Event::PointerMoved(to));
        self.pointer = Some(to);
    }

    /// Lets the mouse go in the next frame.
    pub fn release(&mut self) {
        if let Some(pos) = self.pointer.take() {
            self.events.push(Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed: false,
                modifiers: egui::Modifiers::NONE,
            });
            self.events.push(Event::PointerGone);
        }
    }

    /// Edits the scene as a panel would.
    pub fn edit(&mut self, edit: impl FnOnce(&mut SceneDescription)) {
        edit(&mut self.app.document.description);
    }

    /// Whether the scene is loaded and its first full picture is there.
    pub fn has_picture(&self) -> bool {
        self.app.files.has_scene
            && self.app.work.session.latest().is_some_and(|frame| frame.scale == 1)
    }

    /// Whether the picture has all its samples.
    pub fn is_done(&self) -> bool {
        self.app.work.session.status().phase == Phase::Done
    }
}

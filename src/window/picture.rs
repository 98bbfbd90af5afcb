//! From the newest frame to a texture: tone mapping and false colours on a thread of their own,
//! newest wins.
//!
//! The window's thread only hands over what should be shown and takes what is ready; a swap of a
//! pointer under a lock is all that either thread waits for.

use super::background::Background;
use super::panels::PictureStatistics;
use super::viewport::Shown;
use super::views::{Legend, View, paint};
use crate::scene::description::{ToneMappingDescription, ToneOperator};
use crate::session::Frame;
use crate::tone_mapping::map_to_srgb8;
use egui::{Color32, ColorImage, TextureFilter, TextureHandle, TextureOptions};
use std::sync::Arc;

/// The picture on show and the thread that prepares the next.
pub(super) struct PictureDisplay {
    thread: Background<Order, Option<Displayed>>,
    asked: Option<Order>,
    texture: Option<TextureHandle>,
    size: [u32; 2],
    image: Option<Arc<ColorImage>>,
    statistics: Option<PictureStatistics>,
    legend: Option<Legend>,
}

/// What decides the bytes of a displayed picture.
#[derive(Clone)]
struct Order {
    frame: Arc<Frame>,
    view: View,
    exposure: f64,
    operator: ToneOperator,
}

impl Order {
    /// Whether the same bytes would come out.
    fn is_same(&self, other: &Self) -> bool {
        let same_tone = (self.exposure, self.operator) == (other.exposure, other.operator);
        self.view == other.view
            && self.view.same(&self.frame, &other.frame)
            && (same_tone || self.view != View::Picture)
    }
}

struct Displayed {
    image: Arc<ColorImage>,
    size: [u32; 2],
    is_coarse: bool,
    /// Of the picture; other views have none.
    statistics: Option<PictureStatistics>,
    /// Of a view that is not the picture.
    legend: Option<Legend>,
}

impl PictureDisplay {
    /// Starts the thread; `wake` is called when a picture is ready.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let mut bytes = Vec::new();
        let prepare = move |order: Order| match order.view {
            View::Picture => Some(display(&order, &mut bytes)),
            view => display_view(&order.frame, view),
        };
        Ok(Self {
            thread: Background::new("display", prepare, wake)?,
            asked: None,
            texture: None,
            size: [1, 1],
            image: None,
            statistics: None,
            legend: None,
        })
    }

    /// Asks for a view of this frame to be shown, with that tone mapping if it is the picture;
    /// asking again changes nothing.
    pub(super) fn show(&mut self, frame: &Arc<Frame>, view: View, tone: &ToneMappingDescription) {
        let ToneMappingDescription { exposure, operator } = *tone;
        let order = Order { frame: Arc::clone(frame), view, exposure, operator };
        if self.asked.as_ref().is_some_and(|asked| asked.is_same(&order)) {
            return;
        }
        self.asked = Some(order.clone());
        self.thread.order(order);
    }

    /// Brings a picture that is ready to the graphics card.
    pub(super) fn update(&mut self, ctx: &egui::Context) {
        // Without what a view needs, what was shown before stays.
        let Some(ready) = self.thread.take().flatten() else { return };
        let options = texture_options(ready.is_coarse);
        let image = Arc::clone(&ready.image);
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(ctx.load_texture("picture", image, options)),
        }
        self.size = ready.size;
        self.image = Some(ready.image);
        self.statistics = ready.statistics;
        self.legend = ready.legend;
    }

    /// The picture on show, once there is one.
    pub(super) fn shown(&self) -> Option<Shown<'_>> {
        self.texture.as_ref().map(|texture| Shown { texture, size: self.size })
    }

    /// The bytes on show.
    pub(super) fn image(&self) -> Option<&Arc<ColorImage>> {
        self.image.as_ref()
    }

    /// What the colours on show mean, where they are not the picture's own.
    pub(super) fn legend(&self) -> Option<&Legend> {
        self.legend.as_ref()
    }

    /// Histogram of the picture on show.
    pub(super) fn statistics(&self) -> Option<&PictureStatistics> {
        self.statistics.as_ref()
    }
}

fn display(order: &Order, bytes: &mut Vec<[u8; 3]>) -> Displayed {
    let picture = &order.frame.picture;
    bytes.clear();
    bytes.resize(picture.pixels.len(), [0; 3]);
    map_to_srgb8(&picture.pixels, order.exposure as f32, order.operator, bytes);
    let mut histogram = [[0_u32; 64]; 3];
    let pixels = bytes
        .iter()
        .map(|rgb| {
            for (counts, value) in histogram.iter_mut().zip(rgb) {
                counts[usize::from(*value / 4)] += 1;
            }
            Color32::from_rgb(rgb[0], rgb[1], rgb[2])
        })
        .collect();
    let size = [picture.width as usize, picture.height as usize];
    Displayed {
        image: Arc::new(ColorImage::new(size, pixels)),
        size: [order.frame.job.width, order.frame.job.height],
        is_coarse: 1 < order.frame.scale,
        statistics: Some(PictureStatistics { histogram }),
        legend: None,
    }
}

/// A view other than the picture, where the frame has what it needs.
fn display_view(frame: &Frame, view: View) -> Option<Displayed> {
    let painted = paint(view, frame)?;
    let size = [frame.job.width, frame.job.height];
    Some(Displayed {
        is_coarse: painted.image.size[0] < size[0] as usize,
        image: Arc::new(painted.image),
        size,
        statistics: None,
        legend: Some(painted.legend),
    })
}

/// A full picture shows its pixels when enlarged; a coarse one is smoothed.
fn texture_options(is_coarse: bool) -> TextureOptions {
    let magnification = if is_coarse { TextureFilter::Linear } else { TextureFilter::Nearest };
    TextureOptions { magnification, ..TextureOptions::LINEAR }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Picture;
    use crate::render::{RenderJob, RenderSettings};
    use crate::scene::{Assets, resolve};
    use crate::session::Maps;
    use crate::window::tests::small_scene;

    /// A picture of one grey, smaller than its job by `scale`.
    fn frame(sequence: u64, scale: u32) -> Arc<Frame> {
        let description = small_scene();
        let scene = Arc::new(resolve(&description, &Assets::default()).unwrap());
        let settings = RenderSettings::new(&description.render, Default::default());
        let side = 16 / scale;
        let pixels = vec![[0.5; 3]; (side * side) as usize];
        Arc::new(Frame {
            generation: sequence,
            sequence,
            job: RenderJob { scene, width: 16, height: 16, settings },
            scale,
            picture: Picture { width: side, height: side, pixels },
            samples: 1,
            noise: None,
            maps: Maps::default(),
        })
    }

    #[test]
    fn a_coarse_picture_of_a_newer_scene_takes_the_place_of_a_sharp_one() {
        let (sender, woken) = std::sync::mpsc::channel();
        let wake = move || sender.send(()).unwrap();
        let mut display = PictureDisplay::new(wake).unwrap();
        let ctx = egui::Context::default();
        for (sequence, scale) in [(1, 1), (2, 4), (3, 1)] {
            let tone = ToneMappingDescription::default();
            display.show(&frame(sequence, scale), View::Picture, &tone);
            woken.recv().unwrap();
            display.update(&ctx);
            let side = 16 / scale as usize;
            let shown = display.image().map(|image| image.size);
            assert_eq!(shown, Some([side, side]), "frame {sequence} is not shown");
            assert_eq!(display.shown().unwrap().size, [16, 16], "it stands for another size");
        }
    }
}

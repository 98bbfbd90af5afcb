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
    fitted: Option<Arc<ColorImage>>,
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
    /// Most pixels along a side that the graphics card takes.
    max_side: usize,
}

impl Order {
    /// Whether the same bytes would come out.
    fn is_same(&self, other: &Self) -> bool {
        let same_tone = (self.exposure, self.operator) == (other.exposure, other.operator);
        self.view == other.view
            && self.max_side == other.max_side
            && self.view.same(&self.frame, &other.frame)
            && (same_tone || self.view != View::Picture)
    }
}

struct Displayed {
    image: Arc<ColorImage>,
    /// The same, or smaller where the graphics card wants it so.
    fitted: Arc<ColorImage>,
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
            view => display_view(&order, view),
        };
        Ok(Self {
            thread: Background::new("display", prepare, wake)?,
            asked: None,
            texture: None,
            size: [1, 1],
            image: None,
            fitted: None,
            statistics: None,
            legend: None,
        })
    }

    /// Asks for a view of this frame to be shown, with that tone mapping if it is the picture;
    /// asking again changes nothing.
    pub(super) fn show(
        &mut self,
        ctx: &egui::Context,
        frame: &Arc<Frame>,
        view: View,
        tone: &ToneMappingDescription,
    ) {
        let ToneMappingDescription { exposure, operator } = *tone;
        let max_side = ctx.input(|input| input.max_texture_side);
        let order = Order { frame: Arc::clone(frame), view, exposure, operator, max_side };
        if self.asked.as_ref().is_some_and(|asked| asked.is_same(&order)) {
            return;
        }
        self.asked = Some(order.clone());
        self.thread.order(order);
    }

    /// Brings a picture that is ready to the graphics card.
    pub(super) fn update(&mut self, ctx: &egui::Context) {
        // Without what a view needs, what was shown before stays; what nobody asks for any more is
        // not shown at all.
        let ready = self.thread.take().flatten().filter(|_| self.asked.is_some());
        let Some(ready) = ready else { return };
        let options = texture_options(ready.is_coarse);
        let image = Arc::clone(&ready.fitted);
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(ctx.load_texture("picture", image, options)),
        }
        self.size = ready.size;
        self.image = Some(ready.image);
        self.fitted = Some(ready.fitted);
        self.statistics = ready.statistics;
        self.legend = ready.legend;
    }

    /// Shows nothing, and keeps nothing of what was shown.
    pub(super) fn clear(&mut self) {
        self.thread.forget();
        self.asked = None;
        self.texture = None;
        self.size = [1, 1];
        self.image = None;
        self.fitted = None;
        self.statistics = None;
        self.legend = None;
    }

    /// The picture on show, once there is one.
    pub(super) fn shown(&self) -> Option<Shown<'_>> {
        self.texture.as_ref().map(|texture| Shown { texture, size: self.size })
    }

    /// The bytes on show.
    pub(super) fn image(&self) -> Option<&Arc<ColorImage>> {
        self.image.as_ref()
    }

    /// The bytes on show as the graphics card takes them: fewer, where the picture is too large.
    pub(super) fn fitted(&self) -> Option<&Arc<ColorImage>> {
        self.fitted.as_ref()
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
    let image = Arc::new(ColorImage::new(size, pixels));
    Displayed {
        fitted: fitted(&image, order.max_side),
        image,
        size: [order.frame.job.width, order.frame.job.height],
        is_coarse: 1 < order.frame.scale,
        statistics: Some(PictureStatistics { histogram }),
        legend: None,
    }
}

/// A view other than the picture, where the frame has what it needs.
fn display_view(order: &Order, view: View) -> Option<Displayed> {
    let painted = paint(view, &order.frame)?;
    let size = [order.frame.job.width, order.frame.job.height];
    let image = Arc::new(painted.image);
    Some(Displayed {
        is_coarse: image.size[0] < size[0] as usize,
        fitted: fitted(&image, order.max_side),
        image,
        size,
        statistics: None,
        legend: Some(painted.legend),
    })
}

/// An image of at most so many pixels a side: the same, or the means of squares of pixels.
fn fitted(image: &Arc<ColorImage>, max_side: usize) -> Arc<ColorImage> {
    let [width, height] = image.size;
    let side = width.max(height).div_ceil(max_side.max(1));
    if side <= 1 {
        return Arc::clone(image);
    }
    let size = [width.div_ceil(side), height.div_ceil(side)];
    let mean = |x: usize, y: usize| {
        let (columns, rows) = (x * side..width.min((x + 1) * side), y * side..height);
        let mut sums = [0_usize; 3];
        for row in rows.take(side) {
            for pixel in &image.pixels[row * width..][columns.clone()] {
                for (sum, value) in sums.iter_mut().zip(pixel.to_array()) {
                    *sum += usize::from(value);
                }
            }
        }
        let n = columns.len() * side.min(height - y * side);
        let [r, g, b] = sums.map(|sum| (sum / n) as u8);
        Color32::from_rgb(r, g, b)
    };
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    Arc::new(ColorImage::new(size, pixels.map(|(x, y)| mean(x, y)).collect()))
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
            display.show(&ctx, &frame(sequence, scale), View::Picture, &tone);
            woken.recv().unwrap();
            display.update(&ctx);
            let side = 16 / scale as usize;
            let shown = display.image().map(|image| image.size);
            assert_eq!(shown, Some([side, side]), "frame {sequence} is not shown");
            assert_eq!(display.shown().unwrap().size, [16, 16], "it stands for another size");
        }
    }

    #[test]
    fn pictures_too_large_for_the_graphics_card_are_shown_smaller() {
        let grey = |x: usize, y: usize| Color32::from_gray((10 * x + y) as u8);
        let pixels = (0..3).flat_map(|y| (0..5).map(move |x| grey(x, y)));
        let image = Arc::new(ColorImage::new([5, 3], pixels.collect()));
        assert!(Arc::ptr_eq(&fitted(&image, 5), &image), "one that fits is shown as it is");
        let small = fitted(&image, 4);
        assert_eq!(small.size, [3, 2], "half as many a side");
        let values: Vec<u8> = small.pixels.iter().map(|pixel| pixel.r()).collect();
        // (0 + 10 + 1 + 11) / 4, and at the borders the mean of what is there.
        assert_eq!(values, [5, 25, 40, 7, 27, 42], "means");
        assert_eq!(fitted(&image, 1).size, [1, 1], "one pixel for all");
    }
}

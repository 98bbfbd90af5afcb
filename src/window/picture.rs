//! From the newest frame to a texture: tone mapping on a thread of its own, newest wins.
//!
//! The window's thread only hands over what should be shown and takes what is ready; a swap of a
//! pointer under a lock is all that either thread waits for.

use super::panels::PictureStatistics;
use super::viewport::Shown;
use crate::scene::description::{ToneMappingDescription, ToneOperator};
use crate::session::Frame;
use crate::threads;
use crate::tone_mapping::map_to_srgb8;
use egui::{Color32, ColorImage, TextureFilter, TextureHandle, TextureOptions};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// The picture on show and the thread that prepares the next.
pub(super) struct PictureDisplay {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    asked: Option<Key>,
    texture: Option<TextureHandle>,
    size: [u32; 2],
    statistics: Option<PictureStatistics>,
}

/// What decides the bytes of a displayed picture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    generation: u64,
    sequence: u64,
    exposure: f64,
    operator: ToneOperator,
}

struct Order {
    frame: Arc<Frame>,
    exposure: f64,
    operator: ToneOperator,
}

struct Displayed {
    image: ColorImage,
    size: [u32; 2],
    is_coarse: bool,
    statistics: PictureStatistics,
}

#[derive(Default)]
struct Shared {
    mailbox: Mutex<Mailbox>,
    changed: Condvar,
}

#[derive(Default)]
struct Mailbox {
    order: Option<Order>,
    ready: Option<Displayed>,
    closing: bool,
}

impl PictureDisplay {
    /// Starts the thread; `wake` is called when a picture is ready.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let for_thread = Arc::clone(&shared);
        let thread = threads::spawn("display", move || prepare_pictures(&for_thread, wake))?;
        Ok(Self {
            shared,
            thread: Some(thread),
            asked: None,
            texture: None,
            size: [1, 1],
            statistics: None,
        })
    }

    /// Asks for this frame to be shown with that tone mapping; asking again changes nothing.
    pub(super) fn show(&mut self, frame: &Arc<Frame>, tone: &ToneMappingDescription) {
        let key = Key {
            generation: frame.generation,
            sequence: frame.sequence,
            exposure: tone.exposure,
            operator: tone.operator,
        };
        if self.asked == Some(key) {
            return;
        }
        self.asked = Some(key);
        let frame = Arc::clone(frame);
        let order = Order { frame, exposure: tone.exposure, operator: tone.operator };
        self.shared.lock().order = Some(order);
        self.shared.changed.notify_one();
    }

    /// Brings a picture that is ready to the graphics card.
    pub(super) fn update(&mut self, ctx: &egui::Context) {
        let Some(ready) = self.shared.lock().ready.take() else { return };
        let options = texture_options(ready.is_coarse);
        match &mut self.texture {
            Some(texture) => texture.set(ready.image, options),
            None => self.texture = Some(ctx.load_texture("picture", ready.image, options)),
        }
        self.size = ready.size;
        self.statistics = Some(ready.statistics);
    }

    /// The picture on show, once there is one.
    pub(super) fn shown(&self) -> Option<Shown<'_>> {
        self.texture.as_ref().map(|texture| Shown { texture, size: self.size })
    }

    /// Histogram of the picture on show.
    pub(super) fn statistics(&self) -> Option<&PictureStatistics> {
        self.statistics.as_ref()
    }
}

impl Drop for PictureDisplay {
    fn drop(&mut self) {
        self.shared.lock().closing = true;
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic there has nothing left to break here.
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Mailbox> {
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The newest order, waited for; `None` when the window closes.
    fn next_order(&self) -> Option<Order> {
        let mut mailbox = self.lock();
        loop {
            if mailbox.closing {
                return None;
            }
            if let Some(order) = mailbox.order.take() {
                return Some(order);
            }
            mailbox = self.changed.wait(mailbox).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

fn prepare_pictures(shared: &Shared, wake: impl Fn()) {
    let mut bytes = Vec::new();
    while let Some(order) = shared.next_order() {
        let displayed = display(&order, &mut bytes);
        shared.lock().ready = Some(displayed);
        wake();
    }
}

fn display(order: &Order, bytes: &mut Vec<[u8; 3]>) -> Displayed {
    let picture = &order.frame.picture;
    bytes.clear();
    bytes.resize(picture.pixels.len(), [0; 3]);
    map_to_srgb8(&picture.pixels, order.exposure, order.operator, bytes);
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
        image: ColorImage::new(size, pixels),
        size: [order.frame.job.width, order.frame.job.height],
        is_coarse: 1 < order.frame.scale,
        statistics: PictureStatistics { histogram },
    }
}

/// A full picture shows its pixels when enlarged; a coarse one is smoothed.
fn texture_options(is_coarse: bool) -> TextureOptions {
    let magnification = if is_coarse { TextureFilter::Linear } else { TextureFilter::Nearest };
    TextureOptions { magnification, ..TextureOptions::LINEAR }
}

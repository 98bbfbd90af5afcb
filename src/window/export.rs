//! A picture of any size, rendered to its end behind the live one and written to a file or put on
//! the clipboard. The same way to a file as `penumbra render`.

use super::app::App;
use super::export_settings::Destination;
use super::output::{check_numbered, write_numbered};
use super::panels::Limits;
use crate::io::folder::{FileRecord, Folder};
use crate::io::output::OutputFormat;
use crate::io::snapshot;
use crate::render::{Noise, RenderJob, World};
use crate::scene::description::SceneDescription;
use crate::session::Goal;
use crate::session::develop::{DevelopError, develop, encode};
use crate::threads;
use crate::tone_mapping::srgb_bytes;
use egui::{Color32, ColorImage};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

/// How far a picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ExportProgress {
    /// Samples so far, and at the end.
    pub(super) samples: (u32, u32),
    /// Estimated noise.
    pub(super) noise: Option<Noise>,
    /// Estimated seconds to the end.
    pub(super) seconds_left: Option<f64>,
}

impl ExportProgress {
    /// The part that is done, 0..=1.
    pub(super) fn share(&self) -> f32 {
        self.samples.0 as f32 / self.samples.1.max(1) as f32
    }
}

/// The picture being rendered, if there is one.
#[derive(Default)]
pub(super) struct Exporter {
    running: Option<Running>,
}

struct Running {
    stop: Arc<AtomicBool>,
    progress: Arc<Mutex<ExportProgress>>,
    result: Receiver<Exported>,
    thread: Option<JoinHandle<()>>,
}

/// The end of a picture.
pub(super) enum Exported {
    /// It is in that file.
    File {
        /// Where.
        path: PathBuf,
        /// In words: size, samples, time.
        told: String,
    },
    /// It goes to the clipboard.
    Clipboard {
        /// As a display shows it.
        image: ColorImage,
        /// In words: size, samples, time.
        told: String,
    },
    /// Stopped on request; nothing was written.
    Stopped,
    /// Nothing was written, for that reason.
    Failed(String),
}

/// Everything a picture is made of.
struct Order {
    job: RenderJob,
    goal: Goal,
    description: SceneDescription,
    records: Vec<FileRecord>,
    scene_folder: Folder,
    title: String,
    folder: PathBuf,
    format: OutputFormat,
    destination: Destination,
}

impl Exporter {
    /// How far the picture is; `None` where there is none.
    pub(super) fn progress(&self) -> Option<ExportProgress> {
        let running = self.running.as_ref()?;
        Some(*running.progress.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Stops the picture; nothing is written then.
    pub(super) fn stop(&self) {
        if let Some(running) = &self.running {
            running.stop.store(true, Ordering::Relaxed);
        }
    }

    /// The end of the picture, once.
    pub(super) fn take(&mut self) -> Option<Exported> {
        let running = self.running.as_ref()?;
        let ended = match running.result.try_recv() {
            Ok(ended) => ended,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => Exported::Failed("the picture is lost".to_owned()),
        };
        self.running = None;
        Some(ended)
    }

    /// Starts a picture; `ctx` is woken after each pass and at the end.
    fn start(&mut self, ctx: &egui::Context, order: Order) -> std::io::Result<()> {
        let pool = threads::background_pool("picture", threads::available())?;
        let stop = Arc::new(AtomicBool::new(false));
        let progress = Arc::new(Mutex::new(ExportProgress {
            samples: (0, order.goal.samples),
            noise: None,
            seconds_left: None,
        }));
        let (sender, result) = channel();
        let (theirs, shown, ctx) = (Arc::clone(&stop), Arc::clone(&progress), ctx.clone());
        let thread = threads::spawn("picture", move || {
            let tell = |news: ExportProgress| {
                *shown.lock().unwrap_or_else(PoisonError::into_inner) = news;
                ctx.request_repaint();
            };
            let made = AssertUnwindSafe(|| make(&order, &pool, &theirs, tell));
            let ended = catch_unwind(made).unwrap_or_else(|panic| {
                let text = threads::panic_text(&*panic);
                Exported::Failed(format!("the renderer failed: {text}"))
            });
            // The window may be gone; then nobody waits for the answer.
            let _ = sender.send(ended);
            ctx.request_repaint();
        })?;
        self.running = Some(Running { stop, progress, result, thread: Some(thread) });
        Ok(())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            threads::part_from(thread);
        }
    }
}

/// Renders, encodes and writes.
fn make(
    order: &Order,
    pool: &rayon::ThreadPool,
    stop: &AtomicBool,
    mut tell: impl FnMut(ExportProgress),
) -> Exported {
    let ending = order.format.ending();
    // Before hours are spent on a picture that has no place to go.
    if order.destination == Destination::File
        && let Err(reason) = check_numbered(&order.folder, &order.title, ending)
    {
        return Exported::Failed(reason);
    }
    let start = Instant::now();
    let Ok(world) = pool.install(|| World::build(order.job.clone(), stop)) else {
        return Exported::Stopped;
    };
    let developed = develop(&world, pool, order.goal, start, stop, |film| {
        let seconds = start.elapsed().as_secs_f64();
        tell(ExportProgress {
            samples: (film.n_samples(), order.goal.samples),
            noise: film.noise(),
            seconds_left: order.goal.seconds_left(film, seconds),
        });
    });
    let film = match developed {
        Ok(developed) => developed.film,
        Err(DevelopError::Stopped) => return Exported::Stopped,
        Err(error) => return Exported::Failed(error.to_string()),
    };
    let (width, height, n_samples) = (film.width(), film.height(), film.n_samples());
    let seconds = super::figures::duration(start.elapsed().as_secs_f64());
    let told = format!("{width}×{height}, {n_samples} samples, {seconds}");
    let tone = &order.description.tone_mapping;
    if order.destination == Destination::Clipboard {
        let srgb = srgb_bytes(&film.picture(), tone);
        let pixels = srgb.chunks_exact(3).map(|rgb| Color32::from_rgb(rgb[0], rgb[1], rgb[2]));
        let image = ColorImage::new([width as usize, height as usize], pixels.collect());
        return Exported::Clipboard { image, told };
    }
    let (description, folder) = (&order.description, Some(&order.scene_folder));
    let size = (width, height);
    let texts = match snapshot::texts(description, size, n_samples, &order.records, folder) {
        Ok(texts) => texts,
        Err(error) => return Exported::Failed(error.to_string()),
    };
    let path = order.folder.join(&order.title);
    let bytes = match encode(&path, order.format, &film.picture(), tone, &texts) {
        Ok(bytes) => bytes,
        Err(error) => return Exported::Failed(error.to_string()),
    };
    match write_numbered(&order.folder, &order.title, ending, &bytes) {
        Ok(path) => Exported::File { path, told },
        Err(reason) => {
            // The disk may have filled up meanwhile.
            let kept = write_numbered(&std::env::temp_dir(), &order.title, ending, &bytes);
            let kept = kept.map(|path| format!("; the picture is in {}", path.display()));
            Exported::Failed(reason + &kept.unwrap_or_default())
        }
    }
}

impl App {
    /// Starts the picture that was asked for, of the scene as it is now.
    pub(super) fn start_export(&mut self, ctx: &egui::Context) {
        if !std::mem::take(&mut self.export_wanted) || self.exporter.running.is_some() {
            return;
        }
        let Some(job) = self.work.job() else {
            self.toasts.fail("there is no scene to render yet");
            return;
        };
        let settings = &self.interface.export;
        let [width, height] = settings.pixels(self.viewport.size);
        let samples = settings.samples.unwrap_or(self.document.description.render.samples);
        let Limits { seconds, noise_percent } = settings.limits;
        let order = Order {
            job: RenderJob { width, height, ..job.clone() },
            goal: Goal { samples, seconds, noise_percent },
            description: self.document.description.clone(),
            records: self.files.records.clone(),
            scene_folder: self.files.folder.clone(),
            title: self.files.title.clone(),
            folder: settings.folder(),
            format: settings.format,
            destination: settings.destination,
        };
        if let Err(error) = self.exporter.start(ctx, order) {
            self.toasts.fail(format!("cannot start rendering: {error}"));
        }
    }

    /// Takes a picture that is finished.
    pub(super) fn take_export(&mut self, ctx: &egui::Context) {
        match self.exporter.take() {
            None => {}
            Some(Exported::File { path, told }) => {
                self.toasts.say(format!("{} ({told})", path.display()));
            }
            Some(Exported::Clipboard { image, told }) => {
                ctx.copy_image(image);
                self.toasts.say(format!("the picture is on the clipboard ({told})"));
            }
            Some(Exported::Stopped) => self.toasts.say("stopped; no picture was written"),
            Some(Exported::Failed(reason)) => self.toasts.fail(reason),
        }
    }
}

//! The live render: one driver thread that always works on the newest job.
//!
//! A job is a value; the mailbox has one place, and the newest job wins. Each job begins with a
//! coarse preview that no edit cancels, so that a fast drag always shows something; then full-size
//! passes, which stop at the next tile when a newer job waits. What is finished is published as an
//! `Arc<Frame>`; the slot keeps the older picture until the first of the new one is there. When
//! the goal is reached, or while paused, everything sleeps. No lock is held while rendering or
//! while waking the caller.

pub mod admit;
pub mod develop;
mod driver;
mod goal;
mod maps;
mod renderer;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use crate::color::Picture;
use crate::geometry::TreeStatistics;
use crate::render::{Noise, Pick, RenderJob};
use crate::threads;

pub use goal::Goal;
pub use maps::{Maps, Wanted};
pub use renderer::{PoolRenderer, Renderer};

/// A published picture. Never changes.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Counts the jobs; never goes back.
    pub generation: u64,
    /// Counts the frames; never goes back.
    pub sequence: u64,
    /// What it is a picture of, at full size.
    pub job: RenderJob,
    /// By how much it is smaller than the job's size; 1 is full size.
    pub scale: u32,
    /// Linear pixels.
    pub picture: Picture,
    /// Samples a pixel.
    pub samples: u32,
    /// Estimated noise.
    pub noise: Option<Noise>,
    /// What was wanted beside the picture, as far as it is there.
    pub maps: Maps,
}

/// What the session is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Phase {
    /// Nothing to do yet.
    #[default]
    Idle,
    /// Building the trees of a job.
    Building,
    /// Making the coarse picture.
    Preview,
    /// Adding samples.
    Refining,
    /// Waiting because it was told to.
    Paused,
    /// The goal is reached.
    Done,
    /// The job failed; the next one starts clean.
    Failed(String),
}

/// Figures for the status bar.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// What is being done.
    pub phase: Phase,
    /// Generation of the job.
    pub generation: u64,
    /// Samples a pixel at full size.
    pub samples: u32,
    /// Samples at which it is done.
    pub goal_samples: u32,
    /// Seconds spent rendering this job.
    pub seconds: f64,
    /// Estimate of the seconds to the goal.
    pub seconds_left: Option<f64>,
    /// Rays of all kinds a second, in the last pass.
    pub rays_per_second: f64,
    /// Estimated noise.
    pub noise: Option<Noise>,
    /// Samples that were not finite and counted as black.
    pub n_invalid: u64,
    /// Threads that render.
    pub n_threads: usize,
    /// Trees of the job.
    pub trees: Option<TreeStatistics>,
}

/// An answer to [`Session::pick`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// The pixel that was asked for.
    pub x: f32,
    /// The pixel that was asked for.
    pub y: f32,
    /// What is there; `None` for the background.
    pub pick: Option<Pick>,
}

/// A renderer at work behind a window. Dropping it stops and waits.
#[derive(Debug)]
pub struct Session {
    shared: Arc<Shared>,
    picks: Option<Sender<(f32, f32)>>,
    threads: Vec<JoinHandle<()>>,
}

/// What the caller and the driver share. Locks are held for pointer swaps only.
struct Shared {
    orders: Mutex<Orders>,
    changed: Condvar,
    /// Stops refinement, not previews.
    stop_refining: AtomicBool,
    /// Stops previews too.
    stop_preview: AtomicBool,
    slot: Mutex<Option<Arc<Frame>>>,
    status: Mutex<Status>,
    picked: Mutex<Option<Picked>>,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").finish_non_exhaustive()
    }
}

/// What the caller wants.
#[derive(Debug)]
struct Orders {
    mailbox: Option<RenderJob>,
    /// The job last submitted, to tell news from repetition.
    submitted: Option<RenderJob>,
    generation: u64,
    goal: Goal,
    wanted: Wanted,
    is_paused: bool,
    /// Whether what the driver has is to be forgotten.
    is_cleared: bool,
    is_closing: bool,
}

impl Session {
    /// Starts a session with `n_threads` render threads. `wake` is called, without locks, whenever
    /// there is something new to see.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn new(n_threads: usize, wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        Self::with_renderer(PoolRenderer::new(n_threads)?, wake)
    }

    /// A session around any renderer: tests script one.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn with_renderer<R: Renderer>(
        renderer: R,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> std::io::Result<Self> {
        let goal = Goal { samples: 1, seconds: None, noise_percent: None };
        let shared = Arc::new(Shared {
            orders: Mutex::new(Orders {
                mailbox: None,
                submitted: None,
                generation: 0,
                goal,
                wanted: Wanted::default(),
                is_paused: false,
                is_cleared: false,
                is_closing: false,
            }),
            changed: Condvar::new(),
            stop_refining: AtomicBool::new(false),
            stop_preview: AtomicBool::new(false),
            slot: Mutex::new(None),
            status: Mutex::new(Status { n_threads: renderer.n_threads(), ..Status::default() }),
            picked: Mutex::new(None),
            wake: Box::new(wake),
        });
        let renderer = Arc::new(renderer);
        let world = Arc::new(Mutex::new(None::<Arc<R::World>>));
        let (picks, requests) = mpsc::channel();
        let driver = {
            let (shared, renderer, world) =
                (Arc::clone(&shared), Arc::clone(&renderer), Arc::clone(&world));
            threads::spawn("session", move || driver::run(&shared, &*renderer, &world))?
        };
        let picker = {
            let shared = Arc::clone(&shared);
            threads::spawn("pick", move || answer(&requests, &shared, &*renderer, &world))?
        };
        Ok(Self { shared, picks: Some(picks), threads: vec![driver, picker] })
    }

    /// Asks for a picture. The job last submitted again changes nothing but the goal; another one
    /// takes its place at once. Never waits for the renderer.
    pub fn submit(&self, job: &RenderJob, goal: Goal) {
        let mut orders = self.shared.orders();
        let is_new = orders.submitted.as_ref() != Some(job);
        if !is_new && orders.goal == goal {
            return;
        }
        orders.goal = goal;
        if is_new {
            orders.place(job.clone());
            self.shared.stop_refining.store(true, Ordering::Relaxed);
        }
        drop(orders);
        self.shared.changed.notify_one();
    }

    /// Renders the current job again from its first sample.
    pub fn restart(&self) {
        let mut orders = self.shared.orders();
        let Some(job) = orders.submitted.clone() else { return };
        orders.place(job);
        self.shared.stop_refining.store(true, Ordering::Relaxed);
        drop(orders);
        self.shared.changed.notify_one();
    }

    /// Asks for maps beside the pictures, of this job and of those to come. They come with the
    /// frames; no sample is lost for them but those of the pass they interrupt.
    pub fn want(&self, wanted: Wanted) {
        let mut orders = self.shared.orders();
        if orders.wanted == wanted {
            return;
        }
        if !orders.wanted.covers(wanted) {
            self.shared.stop_refining.store(true, Ordering::Relaxed);
        }
        orders.wanted = wanted;
        drop(orders);
        self.shared.changed.notify_one();
    }

    /// Gives up what is being built or rendered, its preview too: nobody waits for a picture of this
    /// scene any more. Whatever is submitted next is new.
    pub fn abandon(&self) {
        let mut orders = self.shared.orders();
        orders.submitted = None;
        orders.mailbox = None;
        self.shared.stop_preview.store(true, Ordering::Relaxed);
        self.shared.stop_refining.store(true, Ordering::Relaxed);
        drop(orders);
    }

    /// Gives up everything and forgets every picture: once what is under way has stopped, nothing
    /// of the scene is in memory any more.
    pub fn clear(&self) {
        self.abandon();
        self.shared.orders().is_cleared = true;
        self.shared.changed.notify_one();
    }

    /// While paused, a new job gets its preview and its first full sample, and no more.
    pub fn set_paused(&self, is_paused: bool) {
        let mut orders = self.shared.orders();
        if orders.is_paused == is_paused {
            return;
        }
        orders.is_paused = is_paused;
        if is_paused {
            self.shared.stop_refining.store(true, Ordering::Relaxed);
        }
        drop(orders);
        self.shared.changed.notify_one();
    }

    /// The newest picture.
    pub fn latest(&self) -> Option<Arc<Frame>> {
        lock(&self.shared.slot).clone()
    }

    /// The newest figures.
    pub fn status(&self) -> Status {
        lock(&self.shared.status).clone()
    }

    /// Asks what the middle ray of a pixel of the current job meets; the answer comes to
    /// [`Session::take_picked`], with a wake.
    pub fn pick(&self, x: f32, y: f32) {
        if let Some(picks) = &self.picks {
            // The thread at the other end lives as long as this session.
            let _ = picks.send((x, y));
        }
    }

    /// The newest answer, once.
    pub fn take_picked(&self) -> Option<Picked> {
        lock(&self.shared.picked).take()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.shared.orders().is_closing = true;
        self.shared.stop_preview.store(true, Ordering::Relaxed);
        self.shared.stop_refining.store(true, Ordering::Relaxed);
        self.shared.changed.notify_one();
        self.picks = None;
        self.threads.drain(..).for_each(threads::part_from);
    }
}

impl Orders {
    fn place(&mut self, job: RenderJob) {
        self.submitted = Some(job.clone());
        self.mailbox = Some(job);
        self.generation += 1;
    }
}

impl Shared {
    fn orders(&self) -> MutexGuard<'_, Orders> {
        lock(&self.orders)
    }

    fn update_status(&self, update: impl FnOnce(&mut Status)) {
        update(&mut lock(&self.status));
    }

    fn wake(&self) {
        (self.wake)();
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The thread that answers picks, so that they never wait for a pass.
fn answer<R: Renderer>(
    requests: &Receiver<(f32, f32)>,
    shared: &Shared,
    renderer: &R,
    world: &Mutex<Option<Arc<R::World>>>,
) {
    while let Ok(mut request) = requests.recv() {
        while let Ok(newer) = requests.try_recv() {
            request = newer;
        }
        let world = lock(world).clone();
        let (x, y) = request;
        // A panic is the answer to one question only.
        let pick = AssertUnwindSafe(|| world.and_then(|world| renderer.pick(&world, x, y)));
        let pick = catch_unwind(pick).unwrap_or(None);
        *lock(&shared.picked) = Some(Picked { x, y, pick });
        shared.wake();
    }
}

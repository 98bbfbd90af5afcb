//! The thread that turns the newest job into pictures.

mod previews;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::io::{crash, printable_path};
use crate::render::features::same_first_hits;
use crate::render::{Film, PassStatistics, RenderJob, plan};
use crate::session::admit::admit;
use crate::session::{Frame, Goal, Maps, Phase, Renderer, Shared, Wanted, lock};
use crate::threads;

/// A pass is kept shorter than this where one sample allows.
const PASS_SECS: f64 = 0.25;
/// Pictures are published at most this often, but for the first and the last of a job.
const PUBLISH_INTERVAL: Duration = Duration::from_millis(33);
/// Samples a second before anything has been measured.
const FIRST_GUESS_RATE: f64 = 4e5;
/// First hits a second before anything has been measured.
const FIRST_GUESS_MAP_RATE: f64 = 2e6;

/// A job at work.
struct Work<W> {
    generation: u64,
    job: RenderJob,
    world: Arc<W>,
    film: Film,
    maps: Maps,
    /// Whether maps are given up: they do not fit into memory.
    has_no_maps: bool,
    n_invalid: u64,
    /// Seconds spent in passes.
    seconds: f64,
    /// Samples of the full-size picture in the slot; 0 before the first.
    published_samples: u32,
    last_publish: Instant,
}

/// What the driver keeps from one job to the next.
struct Driver<'a, R: Renderer> {
    shared: &'a Shared,
    renderer: &'a R,
    world: &'a Mutex<Option<Arc<R::World>>>,
    /// Samples a second, as last measured.
    rate: f64,
    /// First hits a second, as last measured.
    map_rate: f64,
    rays_per_second: f64,
    sequence: u64,
}

enum Next {
    Close,
    Forget,
    Begin(u64, RenderJob),
    Survey,
    GoOn,
}

pub(super) fn run<R: Renderer>(
    shared: &Shared,
    renderer: &R,
    world: &Mutex<Option<Arc<R::World>>>,
) {
    let mut driver = Driver {
        shared,
        renderer,
        world,
        rate: FIRST_GUESS_RATE,
        map_rate: FIRST_GUESS_MAP_RATE,
        rays_per_second: 0.0,
        sequence: 0,
    };
    let mut work: Option<Work<R::World>> = None;
    loop {
        match driver.wait(work.as_mut()) {
            Next::Close => return,
            Next::Forget => {
                work = None;
                driver.forget();
            }
            Next::Begin(generation, job) => {
                // The old film's memory goes before the new one's is taken.
                let maps = work.take().filter(|old| same_first_hits(&old.job, &job));
                let kept = |old: Work<R::World>| Maps { sampling: None, ..old.maps };
                let maps = maps.map_or_else(Maps::default, kept);
                let begun = catch_unwind(AssertUnwindSafe(|| driver.begin(generation, job, maps)));
                work = driver.contained(begun).flatten();
            }
            Next::Survey => {
                let Some(current) = &mut work else { continue };
                let surveyed = catch_unwind(AssertUnwindSafe(|| driver.finish_maps(current)));
                if driver.contained(surveyed).is_none() {
                    work = None;
                }
            }
            Next::GoOn => {
                let Some(current) = &mut work else { continue };
                let stop = &shared.stop_refining;
                let passed = catch_unwind(AssertUnwindSafe(|| driver.refine(current, stop)));
                if driver.contained(passed).is_none() {
                    work = None;
                }
            }
        }
    }
}

impl<R: Renderer> Driver<'_, R> {
    /// Sleeps until there is something to do.
    fn wait(&mut self, mut work: Option<&mut Work<R::World>>) -> Next {
        let mut orders = self.shared.orders();
        loop {
            if orders.is_closing {
                return Next::Close;
            }
            if std::mem::take(&mut orders.is_cleared) {
                return Next::Forget;
            }
            if let Some(job) = orders.mailbox.take() {
                self.shared.stop_refining.store(false, Ordering::Relaxed);
                self.shared.stop_preview.store(false, Ordering::Relaxed);
                return Next::Begin(orders.generation, job);
            }
            let wanted = orders.wanted;
            let phase = match work.as_deref() {
                None => None,
                Some(work) if work.unfinished(wanted) != Wanted::NOTHING => {
                    self.shared.stop_refining.store(false, Ordering::Relaxed);
                    return Next::Survey;
                }
                Some(work) if is_reached(&orders.goal, work) => Some(Phase::Done),
                Some(work) if orders.is_paused && work.film.n_samples() > 0 => Some(Phase::Paused),
                Some(_) => {
                    self.shared.stop_refining.store(false, Ordering::Relaxed);
                    return Next::GoOn;
                }
            };
            let goal = orders.goal;
            drop(orders);
            if let (Some(phase), Some(work)) = (phase, work.as_deref_mut()) {
                self.rest(phase, goal, work);
            }
            orders = self.shared.orders();
            let is_still_idle = orders.mailbox.is_none()
                && !orders.is_closing
                && !orders.is_cleared
                && orders.goal == goal
                && orders.wanted == wanted
                && work.as_deref().is_none_or(|work| {
                    is_reached(&orders.goal, work)
                        || (orders.is_paused && work.film.n_samples() > 0)
                });
            if is_still_idle {
                orders = self.shared.changed.wait(orders).unwrap_or_else(PoisonError::into_inner);
            }
        }
    }

    /// Lets go of the world and of the picture.
    fn forget(&self) {
        let world = lock(self.world).take();
        let shown = lock(&self.shared.slot).take();
        // Freeing takes longer than a pointer swap: not under the locks.
        drop((world, shown));
        self.set_phase(Phase::Idle);
    }

    /// Tells that nothing is being done, once; the last picture is always shown.
    fn rest(&mut self, phase: Phase, goal: Goal, work: &mut Work<R::World>) {
        if work.published_samples != work.film.n_samples() {
            let frame = self.frame(work, 1, &work.film);
            self.publish(work, frame);
        }
        let mut is_news = false;
        self.shared.update_status(|status| {
            is_news = status.phase != phase || status.goal_samples != goal.samples;
            status.phase = phase;
            status.goal_samples = goal.samples;
            status.seconds_left = None;
            status.samples = work.film.n_samples();
        });
        if is_news {
            self.shared.wake();
        }
    }

    fn set_phase(&self, phase: Phase) {
        self.shared.update_status(|status| status.phase = phase);
        self.shared.wake();
    }

    /// A panic fails one job only, and says what it was.
    fn contained<T>(&self, result: std::thread::Result<T>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(panic) => {
                let text = threads::panic_text(&*panic);
                let report = crash::newest_report()
                    .map_or(String::new(), |path| format!("; see {}", printable_path(&path)));
                self.set_phase(Phase::Failed(format!("the renderer failed: {text}{report}")));
                None
            }
        }
    }

    /// Builds the world of a job and shows its previews.
    fn begin(&mut self, generation: u64, job: RenderJob, maps: Maps) -> Option<Work<R::World>> {
        let goal = self.shared.orders().goal;
        self.shared.update_status(|status| {
            status.phase = Phase::Building;
            status.generation = generation;
            status.samples = 0;
            status.goal_samples = goal.samples;
            status.seconds = 0.0;
            status.seconds_left = None;
            status.noise = None;
            status.n_invalid = 0;
        });
        if let Err(error) = admit(&job) {
            self.set_phase(Phase::Failed(error.to_string()));
            return None;
        }
        let Ok(world) = self.renderer.prepare(&job, &self.shared.stop_preview) else {
            self.set_phase(Phase::Idle);
            return None;
        };
        let world = Arc::new(world);
        *lock(self.world) = Some(Arc::clone(&world));
        let trees = self.renderer.trees(&world);
        self.shared.update_status(|status| {
            status.phase = Phase::Preview;
            status.trees = Some(trees);
        });
        let film = match self.renderer.film(&world) {
            Ok(film) => film,
            Err(error) => {
                self.set_phase(Phase::Failed(error.to_string()));
                return None;
            }
        };
        let mut work = Work {
            generation,
            job,
            world,
            film,
            maps,
            has_no_maps: false,
            n_invalid: 0,
            seconds: 0.0,
            published_samples: 0,
            last_publish: Instant::now(),
        };
        self.preview(&mut work);
        Some(work)
    }

    /// One pass at full size.
    fn refine(&mut self, work: &mut Work<R::World>, stop: &AtomicBool) {
        let goal = self.shared.orders().goal;
        let before = work.film.n_samples();
        let mut n_samples = plan::pass_samples(before, goal.samples);
        let n_pixels = f64::from(work.job.width) * f64::from(work.job.height);
        let affordable = (self.rate * PASS_SECS / n_pixels) as u32;
        n_samples = n_samples.min(affordable.max(1));
        let phase = if before == 0 { Phase::Preview } else { Phase::Refining };
        self.shared.update_status(|status| status.phase = phase);
        let start = Instant::now();
        let passed = self.renderer.pass(&work.world, &mut work.film, n_samples, stop);
        let seconds = start.elapsed().as_secs_f64();
        work.seconds += seconds;
        let Ok(statistics) = passed else { return };
        work.n_invalid += statistics.n_invalid;
        self.measure(&work.film, n_samples, statistics, seconds);
        self.shared.update_status(|status| {
            status.samples = work.film.n_samples();
            status.goal_samples = goal.samples;
            status.seconds = work.seconds;
            status.noise = work.film.noise();
            status.n_invalid = work.n_invalid;
            status.rays_per_second = self.rays_per_second;
            status.seconds_left = goal.seconds_left(&work.film, work.seconds);
        });
        let is_last = is_reached(&goal, work);
        let is_first = before == 0;
        if is_first || is_last || work.last_publish.elapsed() >= PUBLISH_INTERVAL {
            let frame = self.frame(work, 1, &work.film);
            self.publish(work, frame);
        }
    }

    fn measure(&mut self, film: &Film, n_samples: u32, pass: PassStatistics, seconds: f64) {
        let seconds = seconds.max(1e-6);
        let n = f64::from(film.width()) * f64::from(film.height()) * f64::from(n_samples);
        // A few pixels say little, and one slow preview is no reason for a coarser next one: the
        // rate rises at once and falls by halves.
        if n >= 256.0 {
            let measured = n / seconds;
            self.rate = measured.max(0.5 * (self.rate + measured));
        }
        self.rays_per_second = pass.n_rays as f64 / seconds;
    }

    fn frame(&mut self, work: &Work<R::World>, scale: u32, film: &Film) -> Frame {
        self.sequence += 1;
        let is_wanted = self.shared.orders().wanted.sampling;
        let sampling = is_wanted.then(|| Arc::new(self.renderer.sampling(film)));
        Frame {
            generation: work.generation,
            sequence: self.sequence,
            job: work.job.clone(),
            scale,
            picture: film.picture(),
            samples: film.n_samples(),
            noise: film.noise(),
            maps: Maps { sampling, ..work.maps.clone() },
        }
    }

    fn publish(&self, work: &mut Work<R::World>, frame: Frame) {
        if frame.scale == 1 {
            work.published_samples = frame.samples;
        }
        work.maps.sampling.clone_from(&frame.maps.sampling);
        let older = lock(&self.shared.slot).replace(Arc::new(frame));
        // Freeing a large picture takes longer than a pointer swap: not under the lock.
        drop(older);
        work.last_publish = Instant::now();
        self.shared.wake();
    }
}

impl<W> Work<W> {
    /// The maps that are still to be made in full size.
    fn unfinished(&self, wanted: Wanted) -> Wanted {
        if self.has_no_maps {
            return Wanted::NOTHING;
        }
        let sampling = wanted.sampling && 0 < self.film.n_samples();
        self.maps.unfinished(Wanted { sampling, ..wanted }, &self.job)
    }
}

fn is_reached<W>(goal: &Goal, work: &Work<W>) -> bool {
    goal.is_reached(&work.film, work.seconds)
}

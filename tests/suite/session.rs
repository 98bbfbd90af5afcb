//! The session's rules, held against a scripted renderer that waits at gates, and against the
//! real one.
//!
//! No clocks and no sleeps: a test waits for what it expects to happen. The limit on waiting only
//! turns a deadlock into a failure.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use penumbra::geometry::AcceleratorKind;
use penumbra::io::scene_file::parse;
use penumbra::math::sampler::Sampler;
use penumbra::render::{RenderJob, RenderSettings};
use penumbra::scene::{Assets, resolve};
use penumbra::session::{Frame, Goal, Phase, Session, Status};

use script::{Call, Question, Script};

mod maps;
mod real;
mod rest;
mod rules;
mod script;

/// Longer than anything here takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// Small enough that its first full-size sample is its preview.
const SMALL: u32 = 8;
/// Large enough that its first preview is a smaller picture.
const LARGE: u32 = 300;

/// A job of this many pixels a side, known by its seed.
fn job(seed: u32, side: u32) -> RenderJob {
    job_of(crate::cli::BALL, seed, side)
}

fn job_of(scene: &str, seed: u32, side: u32) -> RenderJob {
    let description = parse(scene, &[]).unwrap();
    let scene = resolve(&description, &Assets::default()).unwrap();
    let mut settings = RenderSettings::new(&description.render, AcceleratorKind::default());
    settings.sampler = Sampler::Sobol { seed };
    RenderJob { scene: Arc::new(scene), width: side, height: side, settings }
}

fn seed_of(job: &RenderJob) -> u32 {
    match job.settings.sampler {
        Sampler::Sobol { seed } | Sampler::Random { seed } => seed,
    }
}

fn goal(samples: u32) -> Goal {
    Goal { samples, seconds: None, noise_percent: None }
}

fn full_passes(calls: &[Call]) -> Vec<(u32, u32)> {
    let pass = |call: &Call| match call.question {
        Question::Pass { before, n_samples } => Some((before, n_samples)),
        Question::Prepare | Question::Preview | Question::Features { .. } | Question::Costs => None,
    };
    calls.iter().filter_map(pass).collect()
}

/// A session with a scripted renderer, and everything it has shown.
struct Stage {
    /// Dropped first: then the session, which waits for its renderer, is not kept waiting.
    calls: Receiver<Call>,
    session: Session,
    wakes: Receiver<()>,
    frames: Arc<Mutex<Vec<Arc<Frame>>>>,
}

impl Stage {
    fn new() -> Self {
        let (script, calls) = Script::new();
        let (wake, wakes) = channel();
        let session = Session::with_renderer(script, move || {
            // Nobody may be listening any more.
            let _ = wake.send(());
        })
        .unwrap();
        Self { calls, session, wakes, frames: Arc::default() }
    }

    fn submit(&self, seed: u32, side: u32, samples: u32) {
        self.session.submit(&job(seed, side), goal(samples));
    }

    /// The next thing that the session asks of its renderer.
    fn call(&self) -> Call {
        self.calls.recv_timeout(PATIENCE).expect("the session asks nothing")
    }

    /// Lets everything run up to the first full-size pass of this job, which waits.
    fn full_pass_of(&self, seed: u32) -> Call {
        loop {
            let call = self.call();
            if call.seed == seed && call.is_full_pass() {
                return call;
            }
            call.run();
        }
    }

    /// Lets everything run until a condition holds.
    fn run_until(&self, mut holds: impl FnMut(&Status) -> bool) -> Vec<Call> {
        let mut done = Vec::new();
        loop {
            while let Ok(call) = self.calls.try_recv() {
                done.push(call.run());
            }
            self.note();
            if holds(&self.session.status()) {
                return done;
            }
            match self.wakes.recv_timeout(Duration::from_millis(1)) {
                Ok(()) | Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => panic!("the session is gone"),
            }
        }
    }

    fn run_until_phase(&self, phase: &Phase) -> Vec<Call> {
        self.run_until(|status| status.phase == *phase)
    }

    /// Waits, without letting anything run, until a condition holds.
    fn wait(&self, what: &str, mut holds: impl FnMut(&Session) -> bool) {
        while !holds(&self.session) {
            self.wakes.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("no {what}"));
        }
    }

    /// Keeps the picture in the slot, if it is a new one.
    fn note(&self) {
        let mut frames = self.frames.lock().unwrap();
        if let Some(frame) = self.session.latest()
            && frames.last().is_none_or(|last| !Arc::ptr_eq(last, &frame))
        {
            frames.push(frame);
        }
    }

    /// Asserts that nothing is asked of the renderer, after a question that takes the way through
    /// the session's threads.
    fn assert_asleep(&self) {
        self.session.pick(3.0, 4.0);
        self.wait("answer to a pick", |session| session.take_picked().is_some());
        let call = self.calls.try_recv().ok();
        assert!(call.is_none(), "asked for {call:?}");
    }
}

//! A renderer that tells what is asked of it and waits to be told what to do.

use std::sync::atomic::{AtomicBool, Ordering};

use penumbra::geometry::{TraversalCost, TreeStatistics};
use penumbra::render::features::{cost_map, feature_map};
use penumbra::render::film::FilmTooLarge;
use penumbra::render::{
    Feature, Film, PassStatistics, Pick, PixelMap, RenderJob, Sampling, Stopped, World, render_pass,
};
use penumbra::session::Renderer;

use super::{Receiver, Sender, channel, seed_of};

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Question {
    /// To make a job ready.
    Prepare,
    /// To add samples to a smaller picture.
    Preview,
    /// To add so many samples to a film that has so many.
    Pass { before: u32, n_samples: u32 },
    /// For the first hits of all pixels.
    Features { is_coarse: bool },
    /// For what they cost.
    Costs,
}

/// One question, which waits for its answer.
#[derive(Debug)]
pub(super) struct Call {
    pub(super) question: Question,
    /// Of the job.
    pub(super) seed: u32,
    answer: Sender<Answer>,
    replies: Receiver<bool>,
}

#[derive(Clone, Copy, Debug)]
enum Answer {
    Run,
    Panic,
    UntilStopped,
    TellWhetherStopped,
}

impl Call {
    pub(super) fn is_full_pass(&self) -> bool {
        matches!(self.question, Question::Pass { .. })
    }

    /// Does what is asked.
    pub(super) fn run(self) -> Self {
        let _ = self.answer.send(Answer::Run);
        self
    }

    /// Fails.
    pub(super) fn panic(self) {
        let _ = self.answer.send(Answer::Panic);
    }

    /// Goes on until it is told to stop, which it obeys.
    pub(super) fn until_stopped(self) {
        let _ = self.answer.send(Answer::UntilStopped);
    }

    /// Whether it has been told to stop. It goes on waiting.
    pub(super) fn is_stopped(&self) -> bool {
        let _ = self.answer.send(Answer::TellWhetherStopped);
        self.replies.recv().unwrap()
    }
}

/// See the module.
pub(super) struct Script {
    calls: Sender<Call>,
}

impl Script {
    pub(super) fn new() -> (Self, Receiver<Call>) {
        let (calls, received) = channel();
        (Self { calls }, received)
    }

    /// Waits for what to do; a test that has ended wants everything to run.
    fn ask(&self, question: Question, seed: u32, stop: &AtomicBool) -> Result<(), Stopped> {
        let ((answer, answers), (reply, replies)) = (channel(), channel());
        drop(self.calls.send(Call { question, seed, answer, replies }));
        while let Ok(answer) = answers.recv() {
            match answer {
                Answer::Run => return Ok(()),
                Answer::Panic => panic!("as scripted"),
                Answer::UntilStopped => {
                    while !stop.load(Ordering::Relaxed) {
                        std::thread::yield_now();
                    }
                    return Err(Stopped);
                }
                Answer::TellWhetherStopped => {
                    let _ = reply.send(stop.load(Ordering::Relaxed));
                }
            }
        }
        Ok(())
    }
}

/// A world that knows whether it is that of a smaller picture.
pub(super) struct ScriptedWorld {
    world: World,
    is_coarse: bool,
}

impl Renderer for Script {
    type World = ScriptedWorld;

    fn prepare(&self, job: &RenderJob, stop: &AtomicBool) -> Result<ScriptedWorld, Stopped> {
        self.ask(Question::Prepare, seed_of(job), stop)?;
        Ok(ScriptedWorld { world: World::new(job.clone()), is_coarse: false })
    }

    fn coarse(&self, world: &ScriptedWorld, scale: u32) -> ScriptedWorld {
        ScriptedWorld { world: World::new(world.world.job.coarse(scale)), is_coarse: true }
    }

    fn film(&self, world: &ScriptedWorld) -> Result<Film, FilmTooLarge> {
        Film::new(world.world.job.width, world.world.job.height)
    }

    fn pass(
        &self,
        world: &ScriptedWorld,
        film: &mut Film,
        n_samples: u32,
        stop: &AtomicBool,
    ) -> Result<PassStatistics, Stopped> {
        let question = if world.is_coarse {
            Question::Preview
        } else {
            Question::Pass { before: film.n_samples(), n_samples }
        };
        self.ask(question, seed_of(&world.world.job), stop)?;
        render_pass(&world.world, film, n_samples, &AtomicBool::new(false))
    }

    fn features(
        &self,
        world: &ScriptedWorld,
        stop: &AtomicBool,
    ) -> Result<PixelMap<Feature>, Stopped> {
        let question = Question::Features { is_coarse: world.is_coarse };
        self.ask(question, seed_of(&world.world.job), stop)?;
        feature_map(&world.world, &AtomicBool::new(false))
    }

    fn costs(
        &self,
        world: &ScriptedWorld,
        stop: &AtomicBool,
    ) -> Result<PixelMap<TraversalCost>, Stopped> {
        self.ask(Question::Costs, seed_of(&world.world.job), stop)?;
        cost_map(&world.world, &AtomicBool::new(false))
    }

    fn sampling(&self, film: &Film) -> PixelMap<Sampling> {
        film.sampling()
    }

    fn pick(&self, world: &ScriptedWorld, x: f32, y: f32) -> Option<Pick> {
        assert!(x >= 0.0, "as scripted: no pixel {x}");
        world.world.pick(x, y)
    }

    fn trees(&self, world: &ScriptedWorld) -> TreeStatistics {
        world.world.geometry.statistics()
    }

    fn n_threads(&self) -> usize {
        1
    }
}

//! The session with the real renderer: the same pixels as the command line, whatever happens on
//! the way.

use std::sync::atomic::{AtomicBool, Ordering};

use penumbra::color::Picture;
use penumbra::render::{Film, World, render_pass};

use super::{Goal, PATIENCE, Phase, RenderJob, Session, channel, goal, job_of, seed_of};
use crate::cli::{BALL, Place, linear};

/// What a render from nothing in one pass gives.
fn cold(job: &RenderJob, n_samples: u32) -> Picture {
    let world = World::new(job.clone());
    let mut film = Film::new(job.width, job.height).unwrap();
    render_pass(&world, &mut film, n_samples, &AtomicBool::new(false)).unwrap();
    film.picture()
}

/// Waits for the end of the newest job, and gives its picture.
fn finish(session: &Session, wakes: &super::Receiver<()>, job: &RenderJob) -> Picture {
    loop {
        let status = session.status();
        if let Phase::Failed(text) = &status.phase {
            panic!("{text}");
        }
        let frame = session.latest().filter(|frame| frame.job == *job && frame.scale == 1);
        if status.phase == Phase::Done
            && let Some(frame) = frame
        {
            assert_eq!(frame.samples, status.samples, "the last picture is shown");
            return frame.picture.clone();
        }
        wakes.recv_timeout(PATIENCE).expect("the session has stopped");
    }
}

fn session(n_threads: usize) -> (Session, super::Receiver<()>) {
    let (wake, wakes) = channel();
    let session = Session::new(n_threads, move || {
        // Nobody may be listening any more.
        let _ = wake.send(());
    })
    .unwrap();
    (session, wakes)
}

#[test]
fn the_session_and_the_command_line_agree_to_the_bit() {
    for integrator in ["direct", "path"] {
        let scene = BALL.replace("samples = 4", &format!("integrator = \"{integrator}\""));
        let place = Place::with(&[("ball.toml", &scene)]);
        let options = ["--width", "40", "--height", "40", "-s", "21", "--seed", "5"];
        place.ok(&[&["render", "ball.toml", "-o", "a.exr"], &options[..]].concat());
        let exr = linear(&place.path("a.exr"));
        let expected: Vec<[f32; 3]> = exr.pixels().map(|pixel| pixel.0).collect();
        let job = job_of(&scene, 5, 40);
        for n_threads in [1, 2, 5] {
            let (session, wakes) = session(n_threads);
            session.submit(&job, goal(21));
            let picture = finish(&session, &wakes, &job);
            assert_eq!(session.status().n_threads, n_threads, "threads");
            let same = picture.pixels == expected;
            assert!(same, "{integrator} with {n_threads} threads");
        }
    }
}

/// Sixty edits at random moments, with pauses, restarts, picks and new goals.
#[test]
fn random_edits_end_in_the_picture_of_a_cold_render() {
    for seed in 1..=3_u64 {
        let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ seed);
        let (session, wakes) = session(1 + seed as usize % 3);
        let mut job = job_of(BALL, 0, 24);
        for step in 0..60 {
            let side = [8, 24, 150, 400][random.below(4) as usize];
            job = job_of(BALL, step, side);
            let samples = 1 + random.below(40) as u32;
            match random.below(8) {
                0 => session.set_paused(true),
                1 => session.restart(),
                2 => session.pick(random.below(400) as f32, 3.0),
                3 => session
                    .submit(&job, Goal { samples, seconds: Some(1e-3), noise_percent: Some(50.0) }),
                4..=6 => session.submit(&job, goal(samples)),
                _ => session.set_paused(false),
            }
            for _ in 0..random.below(4) {
                let _ = wakes.try_recv();
                std::thread::yield_now();
            }
            if random.below(5) == 0 {
                // Something is always shown, sooner or later.
                session.set_paused(false);
                session.submit(&job, goal(samples));
                let shows = |s: &Session| s.latest().is_some_and(|frame| frame.job == job);
                while !shows(&session) {
                    wakes.recv_timeout(PATIENCE).expect("nothing is shown");
                }
            }
        }
        session.set_paused(false);
        session.submit(&job, goal(23));
        let picture = finish(&session, &wakes, &job);
        let samples = session.status().samples;
        let is_cold = picture == cold(&job, samples);
        assert!(is_cold, "script {seed}, job {}, {samples} samples", seed_of(&job));
    }
}

#[test]
fn a_stopped_pass_leaves_the_film_untouched() {
    let job = job_of(BALL, 3, 200);
    let world = World::new(job.clone());
    let mut film = Film::new(200, 200).unwrap();
    let before = film.picture();
    let stopped = render_pass(&world, &mut film, 1, &AtomicBool::new(true));
    assert!(stopped.is_err() && film.picture() == before, "stopped before it began");
    let mut n_stopped = 0;
    for delay in 0..40 {
        let stop = AtomicBool::new(false);
        let (n_before, before) = (film.n_samples(), film.picture());
        let result = std::thread::scope(|scope| {
            scope.spawn(|| {
                for _ in 0..delay * 20 {
                    std::thread::yield_now();
                }
                stop.store(true, Ordering::Relaxed);
            });
            render_pass(&world, &mut film, 2, &stop)
        });
        if result.is_ok() {
            assert_eq!(film.n_samples(), n_before + 2, "a whole pass");
        } else {
            n_stopped += 1;
            let is_untouched = film.n_samples() == n_before && film.picture() == before;
            assert!(is_untouched, "stopped after {delay}");
        }
    }
    assert!(n_stopped > 0, "no pass was stopped");
    let is_cold = film.n_samples() == 0 || film.picture() == cold(&job, film.n_samples());
    assert!(is_cold, "after {} samples", film.n_samples());
}

/// A small generator with a period of 2^64 - 1: G. Marsaglia, "Xorshift RNGs", 2003.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % n
    }
}

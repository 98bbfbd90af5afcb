//! Which work goes first, and what is shown meanwhile: one test a rule.

use super::script::Question;
use super::{
    Arc, Call, LARGE, PATIENCE, Phase, SMALL, Script, Session, Stage, channel, full_passes, goal,
    job, seed_of,
};

#[test]
fn the_newest_job_wins() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 1);
    let first = stage.call();
    for seed in 2..=9 {
        stage.submit(seed, SMALL, 1);
    }
    first.run();
    let mut calls = stage.run_until(|status| status.generation == 9 && status.phase == Phase::Done);
    calls.retain(|call| call.question == Question::Prepare);
    let seeds: Vec<u32> = calls.iter().map(|call| call.seed).collect();
    assert_eq!(seeds, [9], "after the first");
    let frame = stage.session.latest().unwrap();
    assert_eq!((frame.generation, seed_of(&frame.job)), (9, 9), "what is shown");
}

#[test]
fn an_edit_stops_refinement() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 100);
    let first = stage.full_pass_of(1);
    first.run();
    let second = stage.full_pass_of(1);
    assert!(!second.is_stopped(), "before the edit");
    stage.submit(2, SMALL, 1);
    assert!(second.is_stopped(), "after the edit");
    second.until_stopped();
    stage.run_until(|status| status.generation == 2 && status.phase == Phase::Done);
}

#[test]
fn an_edit_does_not_stop_the_preview() {
    for side in [SMALL, LARGE] {
        let stage = Stage::new();
        stage.submit(1, side, 100);
        let prepare = stage.call();
        assert_eq!(prepare.question, Question::Prepare, "at first");
        stage.submit(2, side, 100);
        prepare.run();
        let preview = stage.call();
        assert!(!preview.is_stopped(), "the preview at {side} pixels a side, edited before");
        stage.submit(3, side, 100);
        assert!(!preview.is_stopped(), "the preview at {side} pixels a side, edited meanwhile");
        preview.run();
        stage.wait("preview", |session| session.latest().is_some());
        let frame = stage.session.latest().unwrap();
        assert_eq!(seed_of(&frame.job), 1, "the preview of the first job is shown");
        assert_eq!(frame.scale > 1, side == LARGE, "at scale {}", frame.scale);
    }
}

#[test]
fn another_scene_stops_the_preview_too() {
    for side in [SMALL, LARGE] {
        let stage = Stage::new();
        stage.submit(1, side, 100);
        stage.call().run();
        let preview = stage.call();
        stage.submit(2, side, 1);
        assert!(!preview.is_stopped(), "an edit at {side} pixels a side");
        stage.session.abandon();
        assert!(preview.is_stopped(), "another scene at {side} pixels a side");
        stage.submit(3, side, 1);
        preview.until_stopped();
        let calls = stage.run_until(|status| status.generation == 3 && status.phase == Phase::Done);
        let is_shown = stage.session.latest().is_some_and(|frame| seed_of(&frame.job) == 3);
        assert!(is_shown, "the next job has its picture after {} calls", calls.len());
    }
}

#[test]
fn another_scene_and_closing_stop_the_building_of_trees() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 1);
    let prepare = stage.call();
    assert_eq!(prepare.question, Question::Prepare, "trees come first");
    stage.submit(2, SMALL, 1);
    assert!(!prepare.is_stopped(), "an edit lets the trees be built");
    stage.session.abandon();
    assert!(prepare.is_stopped(), "another scene does not");
    prepare.until_stopped();
    stage.wait("end of the build", |session| session.status().phase == Phase::Idle);
    stage.assert_asleep();
    // The same again is new now.
    stage.submit(2, SMALL, 1);
    let calls = stage.run_until(|status| status.generation == 3 && status.phase == Phase::Done);
    assert!(calls.iter().all(|call| call.seed == 2), "of what was given up: {calls:?}");
    stage.submit(3, SMALL, 1);
    stage.call().until_stopped();
    drop(stage.session);
}

/// A drag at the pace of the renderer: every job gets its picture.
#[test]
fn a_drag_always_shows_something() {
    for side in [SMALL, LARGE] {
        let stage = Stage::new();
        stage.submit(1, side, 100);
        for seed in 1..20 {
            let is_preview = |call: &Call| call.seed == seed && call.question != Question::Prepare;
            loop {
                let call = stage.call();
                let was_preview = is_preview(&call);
                if was_preview {
                    stage.submit(seed + 1, side, 100);
                }
                if call.is_stopped() {
                    assert!(!was_preview, "the first picture of job {seed} was stopped");
                    call.until_stopped();
                } else {
                    call.run();
                }
                if was_preview {
                    break;
                }
            }
            let shows = |session: &Session| {
                session.latest().is_some_and(|frame| seed_of(&frame.job) == seed)
            };
            stage.wait("picture of the drag", shows);
        }
    }
}

#[test]
fn generations_and_sequences_never_go_back() {
    let stage = Stage::new();
    let mut generation = 0;
    for seed in 1..30 {
        generation += 1;
        stage.submit(seed, if seed % 3 == 0 { 100 } else { SMALL }, 3);
        stage.run_until(|status| {
            seed % 4 != 0 || (status.generation == generation && status.samples > 1)
        });
        if seed % 5 == 0 {
            generation += 1;
            stage.session.restart();
        }
    }
    stage.run_until(|status| status.generation == generation && status.phase == Phase::Done);
    let frames = stage.frames.lock().unwrap();
    assert!(frames.len() > 10, "{} frames", frames.len());
    for pair in frames.windows(2) {
        assert!(pair[0].sequence < pair[1].sequence, "sequence");
        assert!(pair[0].generation <= pair[1].generation, "generation");
        if pair[0].generation == pair[1].generation && pair[1].scale == 1 {
            let rises = pair[0].scale > 1 || pair[0].samples < pair[1].samples;
            assert!(rises, "{} samples after {}", pair[1].samples, pair[0].samples);
        }
    }
}

#[test]
fn the_slot_keeps_the_older_picture_until_the_first_of_the_new_one() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 2);
    stage.run_until_phase(&Phase::Done);
    let older = stage.session.latest().unwrap();
    stage.submit(2, LARGE, 2);
    let prepare = stage.call();
    assert!(Arc::ptr_eq(&older, &stage.session.latest().unwrap()), "while preparing");
    prepare.run();
    let preview = stage.call();
    assert!(Arc::ptr_eq(&older, &stage.session.latest().unwrap()), "while previewing");
    preview.run();
    stage.wait("new picture", |session| !Arc::ptr_eq(&older, &session.latest().unwrap()));
    assert_eq!(seed_of(&stage.session.latest().unwrap().job), 2, "the new one");
}

#[test]
fn the_film_holds_whole_passes_only() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 64);
    let calls = stage.run_until_phase(&Phase::Done);
    let mut reached = 0;
    for (before, n_samples) in full_passes(&calls) {
        assert_eq!(before, reached, "a pass begins where the last ended");
        reached += n_samples;
    }
    assert_eq!(reached, 64, "in all");
    stage.session.restart();
    let first = stage.full_pass_of(1);
    first.run();
    let second = stage.full_pass_of(1);
    stage.session.set_paused(true);
    second.until_stopped();
    stage.run_until_phase(&Phase::Paused);
    assert_eq!(stage.session.status().samples, 1, "a stopped pass adds nothing");
    stage.session.set_paused(false);
    let again = stage.full_pass_of(1);
    assert_eq!(again.question, Question::Pass { before: 1, n_samples: 1 }, "the same pass again");
    again.run();
}

#[test]
fn a_panic_fails_one_job_only() {
    let stage = Stage::new();
    for (seed, when) in [(1, 0), (2, 1), (3, 2)] {
        stage.submit(seed, SMALL, 4);
        for _ in 0..when {
            stage.call().run();
        }
        stage.call().panic();
        stage.wait("failure", |s| matches!(s.status().phase, Phase::Failed(_)));
        let Phase::Failed(text) = stage.session.status().phase else { unreachable!() };
        assert!(text.contains("as scripted"), "{text}");
        stage.assert_asleep();
        stage.submit(seed + 100, SMALL, 4);
        stage.run_until_phase(&Phase::Done);
        let frame = stage.session.latest().unwrap();
        let expected = (seed + 100, 4);
        assert_eq!((seed_of(&frame.job), frame.samples), expected, "the next job is clean");
    }
    stage.submit(1, SMALL, 4);
    stage.call().panic();
    stage.wait("failure", |s| matches!(s.status().phase, Phase::Failed(_)));
    stage.submit(1, SMALL, 4);
    stage.assert_asleep();
    stage.session.restart();
    stage.run_until_phase(&Phase::Done);
}

#[test]
fn dropping_stops_and_joins_whatever_is_being_done() {
    for n_calls in 0..4 {
        for side in [SMALL, LARGE] {
            let stage = Stage::new();
            stage.submit(1, side, 100);
            for _ in 0..n_calls {
                stage.call().run();
            }
            let call = stage.call();
            if call.question == Question::Prepare {
                call.run();
            } else {
                call.until_stopped();
            }
            // A deadlock would never end here.
            let Stage { session, calls, .. } = stage;
            drop(calls);
            drop(session);
        }
    }
    drop(Stage::new());
}

/// Everything can be called from within `wake`: no lock is held there.
#[test]
fn wake_holds_no_lock() {
    let (script, calls) = Script::new();
    let (to_waker, session_for_waker) = channel::<&'static Session>();
    let (told, tells) = channel();
    let waker = std::sync::Mutex::new((session_for_waker, None::<&'static Session>));
    let wake = move || {
        let session = {
            let mut waker = waker.lock().unwrap();
            if waker.1.is_none() {
                waker.1 = waker.0.recv().ok();
            }
            waker.1.unwrap()
        };
        let status = session.status();
        session.latest();
        session.take_picked();
        session.submit(&job(1, SMALL), goal(8));
        session.set_paused(false);
        drop(told.send(status.phase));
    };
    // Threads of a leaked session sleep; one that is dropped by its own thread could not be joined.
    let session: &'static Session =
        Box::leak(Box::new(Session::with_renderer(script, wake).unwrap()));
    session.submit(&job(1, SMALL), goal(8));
    to_waker.send(session).unwrap();
    session.pick(1.0, 1.0);
    let answering = std::thread::Builder::new();
    let answering = answering.spawn(move || while calls.recv().map(Call::run).is_ok() {});
    while tells.recv_timeout(PATIENCE).expect("a deadlock") != Phase::Done {}
    assert_eq!(session.latest().unwrap().samples, 8, "the last picture");
    drop(answering);
}

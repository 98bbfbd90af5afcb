//! One test a rule.

use penumbra::render::Seen;
use penumbra::session::Wanted;

use super::script::Question;
use super::{Arc, Call, PATIENCE, Phase, Script, Session, Stage, channel, goal, job, seed_of};

/// Small enough that its first full-size sample is its preview.
const SMALL: u32 = 8;
/// Large enough that its first preview is a smaller picture.
const LARGE: u32 = 300;

fn full_passes(calls: &[Call]) -> Vec<(u32, u32)> {
    let pass = |call: &Call| match call.question {
        Question::Pass { before, n_samples } => Some((before, n_samples)),
        Question::Prepare | Question::Preview | Question::Features { .. } | Question::Costs => None,
    };
    calls.iter().filter_map(pass).collect()
}

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

#[test]
fn an_equal_job_submits_nothing() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 2);
    stage.run_until_phase(&Phase::Done);
    let frame = stage.session.latest().unwrap();
    for _ in 0..10 {
        stage.submit(1, SMALL, 2);
    }
    stage.assert_asleep();
    assert_eq!(stage.session.status().generation, 1, "generation");
    assert!(Arc::ptr_eq(&frame, &stage.session.latest().unwrap()), "the same picture");
}

#[test]
fn a_new_goal_goes_on_without_a_restart() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 3);
    let calls = stage.run_until_phase(&Phase::Done);
    assert_eq!(full_passes(&calls), [(0, 1), (1, 1), (2, 1)], "up to 3");
    stage.submit(1, SMALL, 6);
    let calls = stage.run_until(|status| status.phase == Phase::Done && status.samples == 6);
    assert_eq!(full_passes(&calls), [(3, 1), (4, 2)], "from 3 to 6");
    assert_eq!(stage.session.status().generation, 1, "the same generation");
    stage.submit(1, SMALL, 2);
    stage.assert_asleep();
    assert_eq!(stage.session.latest().unwrap().samples, 6, "more than a smaller goal");
}

/// While paused, a new job gets its preview and its first sample, and no more.
#[test]
fn paused_it_shows_one_sample_and_sleeps() {
    for side in [SMALL, LARGE] {
        let stage = Stage::new();
        stage.session.set_paused(true);
        stage.submit(1, side, 8);
        let calls = stage.run_until_phase(&Phase::Paused);
        assert_eq!(full_passes(&calls), [(0, 1)], "one sample at {side} pixels a side");
        let n_previews = calls.iter().filter(|c| c.question == Question::Preview).count();
        assert_eq!(n_previews > 0, side == LARGE, "{n_previews} previews");
        stage.assert_asleep();
        stage.submit(1, side, 9);
        stage.assert_asleep();
        assert_eq!(stage.session.latest().unwrap().samples, 1, "what is shown");
        stage.session.set_paused(false);
        stage.run_until_phase(&Phase::Done);
        assert_eq!(stage.session.latest().unwrap().samples, 9, "after the pause");
        assert_eq!(stage.session.status().generation, 1, "the same generation");
    }
}

/// Pictures are published at most so often, but the last one always.
#[test]
fn the_last_picture_before_a_rest_is_shown() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 1000);
    for before in [0, 1, 2, 4, 8] {
        let call = stage.full_pass_of(1);
        assert!(
            matches!(call.question, Question::Pass { before: b, .. } if b == before),
            "{call:?}"
        );
        call.run();
    }
    let last = stage.full_pass_of(1);
    stage.session.set_paused(true);
    last.until_stopped();
    stage.wait("pause", |session| session.status().phase == Phase::Paused);
    assert_eq!(stage.session.status().samples, 16, "reached");
    assert_eq!(stage.session.latest().unwrap().samples, 16, "shown when paused");
    stage.session.set_paused(false);
    let next = stage.full_pass_of(1);
    stage.submit(1, SMALL, 20);
    next.run();
    stage.wait("end", |session| session.status().phase == Phase::Done);
    let reached = stage.session.status().samples;
    assert!(reached >= 20, "{reached} samples");
    assert_eq!(stage.session.latest().unwrap().samples, reached, "shown at the new goal");
}

#[test]
fn done_it_sleeps() {
    let stage = Stage::new();
    stage.assert_asleep();
    stage.submit(1, SMALL, 2);
    stage.run_until_phase(&Phase::Done);
    stage.assert_asleep();
    stage.session.set_paused(true);
    stage.session.set_paused(false);
    stage.assert_asleep();
    assert_eq!(stage.session.status().phase, Phase::Done, "phase");
}

#[test]
fn a_restart_begins_at_the_first_sample() {
    let stage = Stage::new();
    stage.session.restart();
    stage.assert_asleep();
    stage.submit(1, SMALL, 4);
    let first = stage.run_until_phase(&Phase::Done);
    let picture = stage.session.latest().unwrap().picture.clone();
    stage.session.restart();
    let second = stage.run_until(|s| s.phase == Phase::Done && s.generation == 2);
    assert_eq!(full_passes(&first), full_passes(&second), "the same passes");
    assert_eq!(stage.session.latest().unwrap().picture, picture, "the same picture");
}

#[test]
fn picks_are_answered_while_a_pass_runs() {
    let stage = Stage::new();
    stage.session.pick(4.0, 4.0);
    stage.wait("answer", |s| s.take_picked().is_some_and(|picked| picked.pick.is_none()));
    stage.submit(1, SMALL, 4);
    let held = stage.full_pass_of(1);
    stage.session.pick(4.0, 4.0);
    let mut answer = None;
    stage.wait("answer", |session| {
        answer = session.take_picked();
        answer.is_some()
    });
    let pick = answer.unwrap().pick.expect("the ball is in the middle");
    assert_eq!(pick.feature.seen, Seen::Object(0), "the ball");
    // A question that fails is answered too, and does not end the answering.
    stage.session.pick(-1.0, 0.0);
    stage.wait("answer", |s| s.take_picked().is_some_and(|picked| picked.pick.is_none()));
    stage.session.pick(4.0, 4.0);
    stage.wait("answer", |s| s.take_picked().is_some_and(|picked| picked.pick.is_some()));
    held.run();
}

const FEATURES: Wanted = Wanted { features: true, ..Wanted::NOTHING };

/// A view that is opened while the picture is refined: the pass gives way, the map comes, and the
/// samples go on where they were.
#[test]
fn maps_come_without_a_restart() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 100);
    stage.full_pass_of(1).run();
    let second = stage.full_pass_of(1);
    stage.session.want(FEATURES);
    assert!(second.is_stopped(), "the pass goes on");
    second.until_stopped();
    let asked = stage.call();
    assert_eq!(asked.question, Question::Features { is_coarse: false }, "asked instead");
    asked.run();
    let shows_map =
        |session: &Session| session.latest().is_some_and(|frame| frame.maps.features.is_some());
    stage.wait("map", shows_map);
    let frame = stage.session.latest().unwrap();
    let map = frame.maps.features.clone().unwrap();
    assert_eq!((map.width, map.height), (SMALL, SMALL), "its size");
    assert_eq!(map.get(SMALL / 2, SMALL / 2).unwrap().seen, Seen::Object(0), "the ball");
    assert_eq!((frame.generation, frame.samples), (1, 1), "started anew");
    let again = stage.full_pass_of(1);
    assert_eq!(again.question, Question::Pass { before: 1, n_samples: 1 }, "not the same pass");
    again.run();
    stage.session.want(Wanted::NOTHING);
    stage.run_until_phase(&Phase::Done);
    assert_eq!(stage.session.status().generation, 1, "started anew");
}

/// Also when it is done: the map comes, with the same picture, and then it sleeps.
#[test]
fn maps_are_made_when_the_picture_is_done() {
    let stage = Stage::new();
    stage.submit(1, SMALL, 2);
    stage.run_until_phase(&Phase::Done);
    let before = stage.session.latest().unwrap();
    stage.session.want(Wanted { costs: true, ..FEATURES });
    for expected in [Question::Features { is_coarse: false }, Question::Costs] {
        let call = stage.call();
        assert_eq!(call.question, expected, "asked");
        call.run();
    }
    stage.wait("map", |session| session.latest().unwrap().maps.costs.is_some());
    let after = stage.session.latest().unwrap();
    assert_eq!((&after.picture, after.samples), (&before.picture, 2), "another picture");
    assert!(before.sequence < after.sequence, "the sequence stands still");
    stage.assert_asleep();
}

/// A view of a large picture is there at once, coarse, and then sharp.
#[test]
fn a_large_map_comes_coarse_first() {
    const WIDE: u32 = 800;
    let stage = Stage::new();
    stage.session.set_paused(true);
    stage.submit(1, WIDE, 4);
    stage.run_until_phase(&Phase::Paused);
    stage.session.want(FEATURES);
    let mut widths = Vec::new();
    for is_coarse in [true, false] {
        let call = stage.call();
        assert_eq!(call.question, Question::Features { is_coarse }, "asked");
        let known = stage.session.latest().unwrap();
        call.run();
        stage.wait("map", |session| !Arc::ptr_eq(&known, &session.latest().unwrap()));
        widths.push(stage.session.latest().unwrap().maps.features.as_ref().unwrap().width);
    }
    assert!(widths[0] < WIDE && widths[1] == WIDE, "maps of widths {widths:?}");
    stage.assert_asleep();
}

/// A drag over a view: each job has a coarse map with its first picture, which no edit stops.
#[test]
fn a_drag_over_a_view_always_shows_something() {
    const WIDE: u32 = 800;
    let stage = Stage::new();
    stage.session.want(FEATURES);
    stage.submit(1, WIDE, 100);
    for seed in 1..6 {
        loop {
            let call = stage.call();
            let is_map = call.question == Question::Features { is_coarse: true };
            if call.seed == seed && is_map {
                stage.session.submit(&other_view(seed + 1, WIDE), goal(100));
                assert!(!call.is_stopped(), "the first map of job {seed} was stopped");
            }
            let was_preview = call.question == Question::Preview && call.seed == seed;
            if call.is_stopped() {
                call.until_stopped();
            } else {
                drop(call.run());
            }
            if was_preview {
                break;
            }
        }
        let shows = |session: &Session| {
            let frame = session.latest();
            frame.is_some_and(|frame| seed_of(&frame.job) == seed && frame.maps.features.is_some())
        };
        stage.wait("map of the drag", shows);
    }
}

/// First hits do not depend on the lens: the maps of the job before serve again.
#[test]
fn an_edit_of_the_lens_keeps_the_maps() {
    let stage = Stage::new();
    stage.session.want(FEATURES);
    stage.submit(1, SMALL, 1);
    stage.run_until_phase(&Phase::Done);
    let before = stage.session.latest().unwrap().maps.features.clone().unwrap();
    let mut wider = job(1, SMALL);
    let mut scene = (*wider.scene).clone();
    scene.camera.aperture_radius = 0.5;
    scene.camera.focal_distance = 2.0;
    wider.scene = Arc::new(scene);
    stage.session.submit(&wider, goal(1));
    let calls = stage.run_until(|status| status.generation == 2 && status.phase == Phase::Done);
    assert!(calls.iter().all(|call| call.question != Question::Features { is_coarse: false }));
    let after = stage.session.latest().unwrap().maps.features.clone().unwrap();
    assert!(Arc::ptr_eq(&before, &after), "made again");
    stage.session.submit(&other_view(2, SMALL), goal(1));
    stage.run_until(|status| status.generation == 3 && status.phase == Phase::Done);
    let moved = stage.session.latest().unwrap().maps.features.clone().unwrap();
    assert!(!Arc::ptr_eq(&after, &moved), "kept for another view");
}

/// A job whose camera stands elsewhere.
fn other_view(seed: u32, side: u32) -> penumbra::render::RenderJob {
    let mut moved = job(seed, side);
    let mut scene = (*moved.scene).clone();
    scene.camera.eye.x += 0.01 * seed as f32;
    moved.scene = Arc::new(scene);
    moved
}

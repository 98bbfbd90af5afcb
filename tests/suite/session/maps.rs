//! Maps for views, and picks: one test a rule.

use penumbra::render::Seen;
use penumbra::session::Wanted;

use super::script::Question;
use super::{Arc, Phase, SMALL, Session, Stage, goal, job, seed_of};

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

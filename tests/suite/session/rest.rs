//! When there is nothing to do, less, or more of the same: one test a rule.

use super::script::Question;
use super::{Arc, LARGE, Phase, SMALL, Stage, full_passes};

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

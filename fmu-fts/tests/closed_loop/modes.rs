//! Modes, and when the cancellation learns.

use crate::machine::{Build, RPM, STEP};
use crate::run::Loop;
use fmu_fts::interface::{Fault, Mode, Output, Parameters, State};

fn tracking() -> Loop {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 3);
    run.run_to(2.0);
    assert_eq!(run.output.state, State::Track);
    run
}

#[test]
fn idle_gives_no_torque() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 3);
    run.input.mode = Mode::Idle;
    for _ in 0..100 {
        run.step();
        assert_eq!((run.output.torque, run.output.state), (0.0, State::Idle));
        assert_eq!(run.output.error.tracking, 0.0);
    }
}

#[test]
fn nothing_happens_before_it_is_enabled_and_a_task_starts_with_it() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 3);
    run.input.enable = false;
    run.run_to(0.01);
    assert_eq!((run.output.torque, run.output.state), (0.0, State::Idle));
    run.input.enable = true;
    run.run_to(1.0);
    assert_eq!(run.output.state, State::Track);
    run.input.enable = false;
    run.step();
    assert_eq!((run.output.state, run.output.fault), (State::Retract, Fault::None));
    run.run_to(1.5);
    assert_eq!((run.output.torque, run.output.state, run.output.fault), (0.0, State::Idle, Fault::None));
    run.input.enable = true;
    run.step();
    assert_eq!(run.output.state, State::Approach);
    assert!(run.output.torque.abs() < 1.0, "{}", run.output.torque);
}

#[test]
fn hold_goes_to_the_angle_and_stays() {
    for mode in [Mode::Hold, Mode::CalibrateFlats, Mode::CalibrateToroid] {
        let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 3);
        run.input.mode = mode;
        run.input.hold_angle = 0.5;
        run.run_to(0.49);
        // in air, with the ripple on: below the paper's error at the twelfth harmonic
        assert!(run.measure(0.01).rms < 2.0);
        assert!((run.output.reference.angle - 0.5).abs() < 1e-12);
        assert!((run.output.reference.depth - 0.08 * (0.5523f64).sin()).abs() < 1e-12);
        run.input.hold_angle = -0.2;
        run.run_to(2.0);
        assert!((run.output.reference.angle + 0.2).abs() < 1e-12);
        assert!(run.output.error.tracking.abs() < 10e-6);
    }
}

#[test]
fn a_part_is_cut_at_constant_speed_and_the_tool_moves_freely_otherwise() {
    let p = Parameters::START;
    for cut in [true, false] {
        let mut run = Loop::new(&p, &Build::NOMINAL, 3);
        (run.input.mode, run.input.hold_angle) = (Mode::CalibrateToroid, 0.3);
        run.run_to(0.9);
        (run.input.calibration_cut, run.input.hold_angle) = (cut, 0.2);
        let (begin, mut fastest, mut before) = (run.time(), 0.0f64, run.output.reference.angle);
        while run.output.reference.angle != 0.2 {
            assert!(run.time() < 10.0 && run.output.fault == Fault::None, "{cut} {} {:?}", run.time(), run.output);
            run.step();
            fastest = fastest.max((run.output.reference.angle - before).abs() / STEP);
            before = run.output.reference.angle;
        }
        let (speed, time) = (p.calibration.sweep_speed, run.time() - begin);
        if cut {
            assert!((fastest / speed - 1.0).abs() < 1e-6, "{fastest}");
            assert!((0.1 / speed..0.1 / speed + 0.05).contains(&time), "{time}");
        } else {
            assert!(fastest > 1.5 * speed && time < 0.1 / speed, "{fastest} {time}");
        }
    }
}

#[test]
fn the_depth_that_the_harmonics_omit_is_reported() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 3);
    run.step();
    assert!(run.output.path_truncation > 0.0 && run.output.path_truncation < 10e-9, "{}", run.output.path_truncation);
    assert_eq!(run.controller.truncation(), run.output.path_truncation);
}

#[test]
fn the_way_from_rest_to_tracking_has_no_jump() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 3);
    let mut before: Option<Output> = None;
    let mut states = Vec::new();
    while run.time() < 0.5 {
        run.step();
        if let Some(before) = before.filter(|before| before.state != State::Idle) {
            let moved = run.output.reference.angle - before.reference.angle;
            assert!(moved.abs() < 5.0 * STEP, "{moved} rad at {} s", run.time());
        }
        if states.last() != Some(&run.output.state) {
            states.push(run.output.state);
        }
        assert!(run.output.error.tracking.abs() < 50e-6, "{} m", run.output.error.tracking);
        before = Some(run.output.clone());
    }
    assert_eq!(states, [State::Idle, State::Approach, State::Track]);
}

#[test]
fn from_tracking_to_hold_and_back() {
    let mut run = tracking();
    run.input.mode = Mode::Hold;
    run.run_to(3.0);
    assert_eq!((run.output.state, run.output.reference.angle), (State::Hold, 0.0));
    run.input.mode = Mode::Track;
    run.run_to(5.0);
    assert_eq!(run.output.state, State::Track);
    assert!(run.measure(0.3).rms < 0.6);
}

#[test]
fn ready_follows_without_learning() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 3);
    run.input.mode = Mode::Approach;
    run.run_to(2.0);
    assert_eq!(run.output.state, State::Ready);
    assert!(run.output.afc_frozen);
    // feedforward alone
    let rms = run.measure(0.2).rms;
    assert!(rms > 3.0 && rms < 12.0, "{rms}");
    run.input.mode = Mode::Track;
    run.step();
    assert!(!run.output.afc_frozen);
    run.run_to(4.0);
    run.input.mode = Mode::Approach;
    // what was learned stays in use
    assert!(run.measure(0.3).rms < 0.6);
    assert!(run.output.afc_frozen);
}

#[test]
fn disabling_the_cancellation_discards_what_was_learned() {
    let mut run = tracking();
    assert!(run.measure(0.1).rms < 0.6);
    run.input.afc_enable = false;
    run.step();
    assert!(run.output.afc_frozen);
    assert!(run.measure(0.1).rms > 3.0);
    // enabled again it starts from zero and learns
    run.input.afc_enable = true;
    assert!(run.measure(0.05).rms > 2.0);
    run.run_to(run.time() + 1.4);
    assert!(run.measure(0.1).rms < 0.6);
}

#[test]
fn nothing_is_learned_at_a_crawl() {
    let slow = Build { speed: |_| 50.0 * RPM, ..Build::NOMINAL };
    let mut run = Loop::new(&Parameters::START, &slow, 3);
    run.run_to(1.0);
    assert_eq!(run.output.state, State::Track);
    assert!(run.output.afc_frozen);
}

#[test]
fn a_stopping_spindle_does_no_damage() {
    let stop = |t: f64| 600.0 * RPM * (1.0 - (t - 2.0) / 0.5).clamp(0.0, 1.0);
    let mut run = Loop::new(&Parameters::START, &Build { speed: stop, ..Build::NOMINAL }, 3);
    run.run_to(2.0);
    let during = run.measure(0.5);
    assert!(during.peak < 20.0, "{during:?}");
    let after = run.measure(1.0);
    assert!(after.peak < 10.0, "{after:?}");
    assert_eq!((run.output.state, run.output.fault), (State::Track, Fault::None));
}

#[test]
fn a_saturated_loop_learns_nothing() {
    let mut p = Parameters::START;
    // the path needs 0.45 N.m
    p.servo.torque_max = 0.46;
    p.limits.torque_ratio = 1.0;
    p.surface.outer_radius = 0.031;
    (p.limits.following_error, p.limits.saturated_ratio) = (0.1, 1.0);
    (p.limits.disturbance, p.limits.drive_gain_ratio) = (0.2, 0.0);
    let mut run = Loop::new(&p, &Build { gain: 0.7, ..Build::NOMINAL }, 3);
    let (mut saturated, mut learned) = (0, 0);
    while run.time() < 1.0 {
        let before = run.output.saturated;
        run.step();
        if before && run.output.state == State::Track {
            saturated += 1;
            learned += i32::from(!run.output.afc_frozen);
        }
    }
    assert!(saturated > 50, "{saturated}");
    assert_eq!(learned, 0);
}

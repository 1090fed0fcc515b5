//! Drives that are weak, late, or pulled at.

use fmu_dob::interface::{Fault, Parameters, State};

use crate::faults::{running, switches_off};
use crate::run::{Loop, NO_WORKPIECE};

#[test]
fn a_pull_that_the_drive_cannot_hold_switches_it_off() {
    let mut p = Parameters::START;
    p.guard_force = 99.0;
    let mut run = running(&p, 8, State::Learn);
    while run.output.state == State::Learn {
        run.slide.push -= 0.2;
        run.step();
    }
    println!("{:?} at {} N", run.output.fault, run.slide.push);
    // the thrust goes into the pull: a drive too weak for it
    assert!(matches!(run.output.fault, Fault::Overload | Fault::WeakDrive), "{:?}", run.output);
    let fault = run.output.fault;
    switches_off(run, fault);
}

#[test]
fn the_drive_is_on_before_the_first_sample() {
    assert!(Loop::new(&Parameters::START, 29, NO_WORKPIECE).output.drive_enable);
}

#[test]
fn a_drive_that_weakens_in_the_retract_is_detected_before_done() {
    let mut run = Loop::new(&Parameters::START, 31, 90e-6);
    assert!(run.run_to(State::Retract, 2.0));
    (0..300).for_each(|_| run.step());
    run.slide.strength = 0.3;
    while !matches!(run.output.state, State::Done | State::Fault) {
        run.step();
    }
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::WeakDrive), "{:?}", run.output);
}

#[test]
fn the_tracking_error_stays_what_it_was_when_the_drive_went_off() {
    let mut run = running(&Parameters::START, 32, State::Detect);
    run.slide.strength = 0.0;
    run.slide.push = -1.0;
    assert!(run.run_to(State::Fault, run.time() + 1.0));
    let error_at_power_off = run.output.tracking_error;
    assert!((5e-6..60e-6).contains(&error_at_power_off.abs()), "{:?} {error_at_power_off} m", run.output.fault);
    (0..100).for_each(|_| run.step());
    assert_eq!(run.output.tracking_error, error_at_power_off);
}

#[test]
fn a_stage_that_is_pulled_from_its_reference_is_detected() {
    let mut p = Parameters::START;
    p.limits.following_error = 5e-7;
    let mut run = running(&p, 35, State::Detect);
    // 200 N/s, 1.6 ms late: 0.3 N on 10 kg and 188 rad/s are 0.9 um
    while run.output.state == State::Detect {
        run.slide.push -= 0.02;
        run.step();
    }
    // the thrust goes into the pull, far below the largest disturbance
    assert!(run.slide.push > -10.0, "{} N", run.slide.push);
    // a pull that grows with the thrust against it looks like a drive that does less and less
    switches_off(run, Fault::WeakDrive);
}

#[test]
fn a_weak_drive_is_detected_by_the_start_of_the_approach() {
    let mut p = Parameters::START;
    // a third of the command
    p.stage.force_constant *= 3.0;
    let mut run = Loop::new(&p, 36, NO_WORKPIECE);
    assert!(run.run_to(State::Approach, 1.0));
    let from = run.output.reference.position;
    assert!(run.run_to(State::Fault, run.time() + 0.1), "{:?}", run.output);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::WeakDrive, false));
    let travel = run.output.reference.position - from;
    assert!(travel < 3e-6, "{travel} m");
}

#[test]
fn the_reference_is_where_the_stage_is_while_the_drive_is_off() {
    let mut run = running(&Parameters::START, 39, State::Detect);
    let from = run.slide.position();
    run.controller.begin_long_step();
    run.slide.push = 1.0;
    for _ in 0..1000 {
        run.step();
        assert!(!run.output.drive_enable && (run.output.reference.position - run.slide.position()).abs() < 2e-6);
    }
    let travel = run.slide.position() - from;
    assert!(travel.abs() > 1e-4, "{travel} m");
}

/// A loop in `Retract` whose drive then is `late` samples late and has `strength`, run until the cycle ends.
fn late_during_retract(current_max: f64, late: usize, strength: f64) -> Loop {
    let mut p = Parameters::START;
    p.stage.current_max = current_max;
    let mut run = Loop::new(&p, 40, 90e-6);
    assert!(run.run_to(State::Retract, 3.0), "{:?}", run.output);
    run.slide.delay += late;
    run.slide.strength = strength;
    while run.output.state == State::Retract {
        run.step();
        assert!(run.time() < 4.0, "{:?}", run.output);
    }
    run
}

#[test]
fn done_waits_for_a_stage_that_oscillates_until_it_is_at_rest() {
    let nominal = late_during_retract(5.0, 0, 1.0).time();
    let mut run = late_during_retract(5.0, 6, 1.0);
    assert_eq!((run.output.state, run.output.fault), (State::Done, Fault::None), "{:?}", run.output);
    assert!(run.time() > nominal + 5e-3, "{} s {nominal} s", run.time());
    let positions: Vec<f64> = (0..100).map(|_| (run.step(), run.slide.position()).1).collect();
    let travel = positions.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b))
        - positions.iter().fold(f64::INFINITY, |a, b| a.min(*b));
    // 0.4 N at 130 Hz are 60 nm in both directions
    assert!(travel < 120e-9, "{travel} m");
}

#[test]
fn a_loop_that_oscillates_below_the_limit_of_the_current_is_detected_before_done() {
    for current_max in [5.0, 0.3] {
        let run = late_during_retract(current_max, 7, 1.15);
        assert!(run.output.current.abs() < current_max);
        switches_off(run, Fault::Oscillation);
    }
}

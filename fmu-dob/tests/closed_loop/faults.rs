//! Faults on the slide: the named fault, a safe motion, finite outputs.

use fmu_dob::interface::{Fault, Input, Parameters, State};

use crate::hostile::finite;
use crate::run::{Loop, NO_WORKPIECE};

/// Distance of the retract at 100 um/s, m.
pub const RETRACT: f64 = 90.12e-6;

/// A loop in `state`, without a workpiece.
pub fn running(p: &Parameters, seed: u64, state: State) -> Loop {
    let mut run = Loop::new(p, seed, NO_WORKPIECE);
    assert!(run.run_to(state, 2.0), "{:?}", run.output);
    run
}

/// Checks the fault and that the stage then retreats from where it was and holds.
fn retreats(mut run: Loop, fault: Fault) {
    assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    let from = run.output.reference.position;
    for _ in 0..3000 {
        run.step();
        assert!(finite(&run.output));
        assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    }
    let distance = from - run.output.reference.position;
    assert!((distance - RETRACT).abs() < 0.2e-6, "retreat of {distance} m");
    assert!(run.output.drive_enable);
    assert_eq!(run.output.reference.velocity, 0.0);
    assert!(run.output.tracking_error.abs() < 20e-9, "{} m", run.output.tracking_error);
    assert!(!run.output.contact);
}

/// Checks the fault, and that the drive is off from then on.
pub fn switches_off(mut run: Loop, fault: Fault) {
    assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    for _ in 0..1000 {
        assert!(finite(&run.output) && !run.output.contact);
        assert_eq!((run.output.current, run.output.drive_enable), (0.0, false));
        run.step();
        assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    }
}

#[test]
fn travel_limit_without_contact() {
    let mut p = Parameters::START;
    p.approach.travel_max = 1e-4;
    let mut run = running(&p, 1, State::Detect);
    assert!(run.run_to(State::Fault, 2.0));
    let travel = run.output.reference.position;
    assert!(travel > 0.99e-4 && travel < 1e-4 + 20e-9, "{travel} m");
    retreats(run, Fault::TravelLimit);
}

/// One step without a position.
fn lose_position(run: &mut Loop) {
    run.step_with(|input| input.position_valid = false);
    assert!(finite(&run.output));
}

#[test]
fn lost_reading_of_ten_samples() {
    let mut run = running(&Parameters::START, 2, State::Detect);
    for k in 0..10 {
        lose_position(&mut run);
        assert_eq!(run.output.state == State::Fault, k >= 3, "sample {k}");
    }
    switches_off(run, Fault::PositionLost);
}

#[test]
fn lost_reading_in_every_approaching_state() {
    for state in [State::Approach, State::Learn, State::Detect] {
        let mut run = running(&Parameters::START, 3, state);
        (0..4).for_each(|_| lose_position(&mut run));
        switches_off(run, Fault::PositionLost);
    }
}

#[test]
fn three_lost_samples_are_bridged() {
    let mut run = running(&Parameters::START, 4, State::Detect);
    for k in 0..3000 {
        let lost = k % 300 < 3;
        run.step_with(|input| {
            input.position_valid = !lost;
            input.position = if lost { f64::NAN } else { input.position };
        });
        assert!(finite(&run.output));
        assert_eq!(run.output.state, State::Detect, "sample {k}: {:?}", run.output);
        assert!(run.output.tracking_error.abs() < 15e-9);
    }
}

#[test]
fn a_long_blackout_is_survived() {
    let mut run = running(&Parameters::START, 5, State::Detect);
    for _ in 0..5000 {
        lose_position(&mut run);
    }
    // the stage has drifted, and nothing holds it; after a reset it is brought to rest where it is
    assert_eq!((run.output.current, run.output.drive_enable), (0.0, false));
    (0..100).for_each(|_| run.step());
    reset(&mut run);
    (0..5000).for_each(|_| run.step_with(|input| input.enable = false));
    assert_eq!((run.output.state, run.output.drive_enable), (State::Idle, true), "{:?}", run.output);
    assert!(run.output.tracking_error.abs() < 20e-9, "{} m", run.output.tracking_error);
}

/// Four samples with a spindle speed that is no number.
pub fn lose_spindle(run: &mut Loop) {
    (0..4).for_each(|_| run.step_with(|input| input.spindle_speed = f64::NAN));
}

#[test]
fn nonsense_is_bridged_for_three_samples_and_then_reported() {
    for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        let mut run = running(&Parameters::START, 6, State::Detect);
        for set in [|input: &mut Input, x| input.position = x, |input: &mut Input, x| input.spindle_speed = x] {
            (0..3).for_each(|_| run.step_with(|input| set(input, nonsense)));
            (0..2000).for_each(|_| run.step());
            assert_eq!((run.output.state, run.output.contact), (State::Detect, false), "{:?}", run.output);
        }
        (0..4).for_each(|_| run.step_with(|input| input.position = nonsense));
        switches_off(run, Fault::PositionLost);
        let mut run = running(&Parameters::START, 7, State::Learn);
        (0..4).for_each(|_| run.step_with(|input| input.spindle_speed = nonsense));
        retreats(run, Fault::SpindleLost);
    }
}

#[test]
fn loud_noise_is_rejected() {
    let mut p = Parameters::START;
    p.limits.slope_sigma_max = 0.1;
    let mut run = running(&p, 9, State::Learn);
    assert!(run.run_to(State::Fault, 2.0));
    assert!(run.output.threshold.sigma > 0.1);
    retreats(run, Fault::LearnRejected);
}

#[test]
fn drifting_force_is_rejected() {
    let mut run = running(&Parameters::START, 10, State::Learn);
    // a pull whose slope grows all the time: the deviation has a slope that is not around zero
    let mut k = 0.0;
    while run.output.state == State::Learn {
        run.slide.push = -8.0 * (k * 1e-4f64).powi(2);
        k += 1.0;
        run.step();
    }
    retreats(run, Fault::LearnRejected);
}

#[test]
fn a_fault_at_rest_moves_nothing() {
    let mut run = Loop::new(&Parameters::START, 11, NO_WORKPIECE);
    (0..100).for_each(|_| run.step());
    let held = run.output.reference.position;
    lose_spindle(&mut run);
    for _ in 0..2000 {
        run.step_with(|input| input.enable = false);
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::SpindleLost));
        assert_eq!(run.output.reference.position, held);
    }
}

#[test]
fn no_position_from_the_beginning() {
    let mut run = Loop::new(&Parameters::START, 12, NO_WORKPIECE);
    for k in 0..1000 {
        run.step_with(|input| {
            input.position_valid = false;
            input.enable = k == 500;
        });
        assert_eq!(run.output.current, 0.0);
    }
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::PositionLost));
    // the position returns: hold it, and start on request
    (0..2000).for_each(|_| run.step_with(|input| input.enable = false));
    assert_eq!(run.output.reference.velocity, 0.0);
    reset(&mut run);
    (0..2000).for_each(|_| run.step_with(|input| input.enable = false));
    run.step();
    assert_eq!((run.output.state, run.output.fault), (State::Approach, Fault::None));
    assert!(run.output.drive_enable);
}

/// One sample with `reset_fault`, disabled.
pub fn reset(run: &mut Loop) {
    run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
}

#[test]
fn a_long_communication_step_switches_the_drive_off_until_it_is_short() {
    for state in [State::Idle, State::Detect, State::Retract] {
        let mut run = Loop::new(&Parameters::START, 26, 90e-6);
        assert!(run.run_to(state, 3.0));
        run.controller.begin_long_step();
        run.step();
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::LongStep), "{state:?}");
        assert_eq!((run.output.current, run.output.drive_enable), (0.0, false));
        (0..100).for_each(|_| run.step());
        run.controller.begin_long_step();
        run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
        assert_eq!(run.output.fault, Fault::LongStep);
        run.step();
        reset(&mut run);
        assert_eq!((run.output.state, run.output.drive_enable), (State::Idle, true));
    }
}

#[test]
fn a_more_severe_fault_takes_over_and_no_other() {
    let mut run = running(&Parameters::START, 33, State::Detect);
    lose_spindle(&mut run);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::SpindleLost, true));
    (0..4).for_each(|_| lose_position(&mut run));
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::PositionLost, false));
    // one as grave, and one that is not
    run.controller.begin_long_step();
    lose_spindle(&mut run);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::PositionLost, false));
}

#[test]
fn a_force_that_remains_after_the_retract_rejects_the_contact() {
    for push in [0.0, 0.6] {
        let mut run = Loop::new(&Parameters::START, 30, 90e-6);
        assert!(run.run_to(State::Retract, 3.0), "{:?}", run.output);
        run.slide.push = push;
        while run.output.state == State::Retract {
            run.step();
            assert!(run.time() < 4.0, "{:?}", run.output);
        }
        let expected = if push > 0.0 { (State::Fault, Fault::ContactRejected) } else { (State::Done, Fault::None) };
        assert_eq!((run.output.state, run.output.fault), expected, "{push}: {:?}", run.output);
    }
}

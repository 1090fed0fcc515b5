//! `enable` and `reset_fault`: what begins, what ends, and what does not move.

use fmu_centering::interface::{Fault, Input, Parameters, State};

use crate::run::{Loop, running};

const P: Parameters = Parameters::PAPER;

#[test]
fn without_enable_it_stops_and_retracts_from_every_state() {
    for state in [State::Approach, State::Follow, State::Collect, State::Wait, State::Push, State::Settle] {
        let mut run = running(&P, state);
        let mut before = run.output.slide.velocity_setpoint;
        for k in 0..3000 {
            run.step_with(|input| input.enable = false);
            assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
            let step = run.output.slide.velocity_setpoint - before;
            assert!(step.abs() <= 2.57e-3, "{state:?}, step {k}: velocity jumps by {step} m/s");
            before = run.output.slide.velocity_setpoint;
        }
        assert!(run.output.slide.position_setpoint.abs() < 1e-6 && before == 0.0);
    }
}

#[test]
fn enable_that_drops_in_a_push_ends_the_push_immediately() {
    let mut run = running(&P, State::Push);
    (0..20).for_each(|_| run.step());
    let from = run.output.slide.position_setpoint;
    let mut furthest: f64 = from;
    for _ in 0..1000 {
        run.step_with(|input| input.enable = false);
        furthest = furthest.max(run.output.slide.position_setpoint);
    }
    assert!(furthest - from < 2e-6, "{} m", furthest - from);
}

#[test]
fn enable_again_during_the_retract_starts_again() {
    let mut run = running(&P, State::Wait);
    (0..100).for_each(|_| run.step_with(|input| input.enable = false));
    run.step();
    assert_eq!(run.output.state, State::Approach);
    assert!(run.run_to(State::Centered, 90.0), "{:?}", run.output);
    (0..3000).for_each(|_| run.step_with(|input| input.enable = false));
    assert!(run.output.slide.position_setpoint.abs() < 1e-6, "{} m", run.output.slide.position_setpoint);
}

/// In `Fault` after an invalid probe signal in `Wait`, back at rest, with `enable` set all the time.
fn faulted() -> Loop {
    let mut run = running(&P, State::Wait);
    run.spoil(|input| input.probe_position = f64::NAN);
    (0..3000).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::ProbeLost));
    run
}

/// Steps 1 s with `change`, in which nothing moves in `state`.
fn stays(run: &mut Loop, state: State, change: impl Fn(&mut Input)) {
    let position = run.output.slide.position_setpoint;
    for _ in 0..1000 {
        run.step_with(&change);
        assert_eq!(run.output.state, state);
        assert_eq!((run.output.slide.position_setpoint, run.output.slide.velocity_setpoint), (position, 0.0));
    }
}

#[test]
fn nothing_moves_after_a_reset_until_enable_rises_again() {
    let mut run = faulted();
    stays(&mut run, State::Fault, |input| input.enable = false);
    stays(&mut run, State::Fault, |_| ());
    run.step_with(|input| input.reset_fault = true);
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    // enable is set, but has no edge
    stays(&mut run, State::Idle, |input| input.reset_fault = true);
    stays(&mut run, State::Idle, |_| ());
    stays(&mut run, State::Idle, |input| input.enable = false);
    run.step();
    assert_eq!((run.output.state, run.output.fault), (State::Approach, Fault::None));
    assert!(run.run_to(State::Centered, 90.0));
}

#[test]
fn an_edge_of_enable_together_with_the_reset_begins_nothing() {
    let mut run = faulted();
    run.step_with(|input| input.enable = false);
    run.step_with(|input| input.reset_fault = true);
    stays(&mut run, State::Idle, |_| ());
}

#[test]
fn a_reset_during_the_retract_is_too_early() {
    let mut run = running(&P, State::Wait);
    run.spoil(|input| input.probe_position = f64::NAN);
    (0..3000).for_each(|k| run.step_with(|input| input.reset_fault = k == 0 || k == 100));
    assert_eq!(run.output.state, State::Fault);
    run.step_with(|input| input.reset_fault = true);
    assert_eq!(run.output.state, State::Idle);
}

#[test]
fn a_slide_that_stopped_without_its_encoder_stays_there_after_the_reset() {
    let mut run = running(&P, State::Wait);
    run.spoil(|input| input.slide_position = f64::NAN);
    (0..1000).for_each(|_| run.step());
    assert!(run.output.slide.position_setpoint > 0.04, "{} m", run.output.slide.position_setpoint);
    run.step_with(|input| input.reset_fault = true);
    stays(&mut run, State::Idle, |_| ());
}

#[test]
fn a_fault_that_is_still_there_is_not_reset() {
    let mut run = running(&P, State::Wait);
    run.spoil(|input| input.probe_position = f64::NAN);
    for k in 0..100 {
        run.step_with(|input| {
            input.probe_position = f64::NAN;
            input.reset_fault = k % 2 == 1;
        });
        assert_eq!(run.output.state, State::Fault);
    }
}

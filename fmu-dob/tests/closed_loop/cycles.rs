//! Start, end and restart of a cycle.

use fmu_dob::interface::{ContactSource, Fault, Parameters, State};

use crate::faults::{RETRACT, lose_spindle, reset, running};
use crate::run::{Loop, NO_WORKPIECE};

#[test]
fn disabling_decelerates_retracts_and_is_done() {
    for state in [State::Approach, State::Learn, State::Detect] {
        let mut run = running(&Parameters::START, 13, state);
        (0..100).for_each(|_| run.step());
        let from = run.output.reference.position;
        // one sample is enough, and the edge after it comes too early
        run.step_with(|input| input.enable = false);
        assert_eq!(run.output.state, State::Retract);
        assert!(run.run_to(State::Done, 2.0));
        assert!(run.output.aborted && !run.output.contact);
        let distance = from - run.output.reference.position;
        assert!((distance - RETRACT).abs() < 0.2e-6, "{distance} m");
        (0..1000).for_each(|_| run.step());
        assert_eq!(run.output.state, State::Done);
    }
}

#[test]
fn disabling_after_the_contact_changes_nothing() {
    let outcome = |enable| {
        let mut run = Loop::new(&Parameters::START, 16, 90e-6);
        assert!(run.run_to(State::Contact, 2.0));
        while run.output.state != State::Done {
            run.step_with(|input| input.enable = enable);
        }
        run.output
    };
    assert!(outcome(false).contact && !outcome(false).aborted);
    assert_eq!(outcome(false), outcome(true));
}

#[test]
fn begins_again_after_done_and_after_a_reset() {
    let mut run = running(&Parameters::START, 14, State::Detect);
    run.step_with(|input| input.enable = false);
    assert!(run.run_to(State::Done, 2.0));
    run.step_with(|input| input.enable = false);
    run.step();
    assert_eq!((run.output.state, run.output.aborted), (State::Approach, false));
    lose_spindle(&mut run);
    (0..2000).for_each(|_| run.step());
    reset(&mut run);
    run.step();
    assert_eq!(run.output.state, State::Approach);
    assert!(run.run_to(State::Detect, 4.0));
}

#[test]
fn a_reset_needs_a_rising_edge_at_rest_and_moves_nothing() {
    let mut run = running(&Parameters::START, 15, State::Detect);
    lose_spindle(&mut run);
    // the edge before the end of the retract is ignored, and is no edge later
    (0..2000).for_each(|_| run.step_with(|input| input.reset_fault = true));
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::SpindleLost));
    // a new approach needs the reset first
    run.step_with(|input| input.enable = false);
    run.step();
    assert_eq!(run.output.state, State::Fault);
    // not while the reason is still there
    lose_spindle(&mut run);
    run.step_with(|input| (input.reset_fault, input.spindle_speed) = (true, f64::NAN));
    assert_eq!(run.output.state, State::Fault);
    run.step();
    let held = run.output.reference.position;
    run.step_with(|input| input.reset_fault = true);
    for _ in 0..2000 {
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
        assert_eq!((run.output.reference.position, run.output.reference.velocity), (held, 0.0));
        // still enabled since before the fault
        run.step();
    }
}

#[test]
fn a_new_approach_discards_the_forces_before() {
    let mut run = running(&Parameters::START, 24, State::Detect);
    for _ in 0..1500 {
        run.slide.push -= 0.9 / 1500.0;
        run.step();
    }
    run.slide.push = 0.0;
    run.step_with(|input| input.enable = false);
    assert!(run.run_to(State::Done, 2.0), "{:?}", run.output);
    run.step_with(|input| input.enable = false);
    // the end of the pull would look like a push
    assert!(run.run_to(State::Detect, 3.0), "{:?}", run.output);
    assert!(!run.output.contact);
}

#[test]
fn the_next_approach_is_armed_before_it_touches_again() {
    let p = Parameters::START;
    let mut run = Loop::new(&p, 25, 90e-6);
    for _ in 0..2 {
        assert!(run.run_to(State::Done, 3.0), "{:?}", run.output);
        assert_eq!(run.output.contact_source, ContactSource::Glr);
        run.step_with(|input| input.enable = false);
        run.step();
    }
}

#[test]
fn an_edge_waits_for_a_stage_at_rest() {
    // the sample of the edge is bridged
    let mut run = Loop::new(&Parameters::START, 27, NO_WORKPIECE);
    (0..200).for_each(|_| run.step_with(|input| input.enable = false));
    run.step_with(|input| (input.enable, input.position_valid) = (true, false));
    assert_eq!(run.output.state, State::Idle);
    assert!(run.run_to(State::Approach, 0.03), "{:?}", run.output);
    // it comes before the stage is found
    let mut run = Loop::new(&Parameters::START, 27, NO_WORKPIECE);
    run.step_with(|input| input.enable = false);
    (0..100).for_each(|_| run.step_with(|input| input.enable = true));
    assert_eq!(run.output.state, State::Approach);
    // it falls again: nothing is begun later
    let mut run = Loop::new(&Parameters::START, 27, NO_WORKPIECE);
    (0..1000).for_each(|k| run.step_with(|input| input.enable = k == 1));
    assert_eq!(run.output.state, State::Idle);
}

#[test]
fn a_reset_discards_the_answer_of_the_drive() {
    let mut run = running(&Parameters::START, 28, State::Detect);
    (0..100).for_each(|_| run.step_with(|input| input.enable = false));
    (0..10).for_each(|_| run.step_with(|input| (input.enable, input.position_valid) = (false, false)));
    assert_eq!(run.output.fault, Fault::PositionLost);
    (0..100).for_each(|_| run.step_with(|input| input.enable = false));
    // a stage that nothing drove looks like a weak drive
    let ratio = run.output.drive_gain_ratio;
    assert!(ratio < 0.5, "{ratio}");
    reset(&mut run);
    assert_eq!(run.output.drive_gain_ratio, 1.0);
}

#[test]
fn a_cycle_that_is_requested_as_soon_as_a_commission_is_aborted_waits_for_a_stage_at_rest() {
    for seed in 160..166 {
        let mut run = Loop::new(&Parameters::START, seed, NO_WORKPIECE);
        (0..200).for_each(|_| run.step_with(|input| input.enable = false));
        for _ in 0..12 {
            (0..3003).for_each(|_| run.step_with(|input| (input.enable, input.commission) = (false, true)));
            let mut cycle = run.clone();
            cycle.step_with(|input| input.enable = false);
            assert_eq!(cycle.output.state, State::Idle);
            // its reference is at rest after at most 1 ms, the stage is not
            let begins = (0..300).find(|_| {
                cycle.step();
                cycle.output.state == State::Approach
            });
            assert!(begins.is_some_and(|after| after >= 95), "{begins:?}");
            assert!(cycle.run_to(State::Learn, 30.0), "{seed}: {:?}", cycle.output);
        }
    }
}

//! Faults, disabling and restart on the slide: the named fault, a safe motion, finite outputs.

use fmu_dob::interface::{ContactSource, Fault, Input, Parameters, State};

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
    let way = from - run.output.reference.position;
    assert!((way - RETRACT).abs() < 0.2e-6, "retreat of {way} m");
    assert!(run.output.drive_enable);
    assert_eq!(run.output.reference.velocity, 0.0);
    assert!(run.output.tracking_error.abs() < 20e-9, "{} m", run.output.tracking_error);
    assert!(!run.output.contact);
}

/// Checks the fault, and that the drive is off from then on.
fn switches_off(mut run: Loop, fault: Fault) {
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
    switches_off(run, Fault::LostReading);
}

#[test]
fn lost_reading_in_every_approaching_state() {
    for state in [State::Approach, State::Learn, State::Detect] {
        let mut run = running(&Parameters::START, 3, state);
        (0..4).for_each(|_| lose_position(&mut run));
        switches_off(run, Fault::LostReading);
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
fn lose_spindle(run: &mut Loop) {
    (0..4).for_each(|_| run.step_with(|input| input.spindle_speed = f64::NAN));
}

#[test]
fn nonsense_is_bridged_for_three_samples_and_then_told() {
    for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        let mut run = running(&Parameters::START, 6, State::Detect);
        for set in [|input: &mut Input, x| input.position = x, |input: &mut Input, x| input.spindle_speed = x] {
            (0..3).for_each(|_| run.step_with(|input| set(input, nonsense)));
            (0..2000).for_each(|_| run.step());
            assert_eq!((run.output.state, run.output.contact), (State::Detect, false), "{:?}", run.output);
        }
        (0..4).for_each(|_| run.step_with(|input| input.position = nonsense));
        switches_off(run, Fault::LostReading);
        let mut run = running(&Parameters::START, 7, State::Learn);
        (0..4).for_each(|_| run.step_with(|input| input.spindle_speed = nonsense));
        retreats(run, Fault::LostSpindle);
    }
}

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
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::LostSpindle));
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
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::LostReading));
    // it comes back: hold where it is, and begin when asked
    (0..2000).for_each(|_| run.step_with(|input| input.enable = false));
    assert_eq!(run.output.reference.velocity, 0.0);
    reset(&mut run);
    (0..2000).for_each(|_| run.step_with(|input| input.enable = false));
    run.step();
    assert_eq!((run.output.state, run.output.fault), (State::Approach, Fault::None));
    assert!(run.output.drive_enable);
}

/// One sample with `reset_fault`, disabled.
fn reset(run: &mut Loop) {
    run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
}

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
        let way = from - run.output.reference.position;
        assert!((way - RETRACT).abs() < 0.2e-6, "{way} m");
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
    // the edge comes before the retreat is over: it does not count, and is no edge later
    (0..2000).for_each(|_| run.step_with(|input| input.reset_fault = true));
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::LostSpindle));
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
fn a_new_approach_forgets_the_forces_before() {
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
fn a_reset_forgets_the_answer_of_the_drive() {
    let mut run = running(&Parameters::START, 28, State::Detect);
    (0..100).for_each(|_| run.step_with(|input| input.enable = false));
    (0..10).for_each(|_| run.step_with(|input| (input.enable, input.position_valid) = (false, false)));
    assert_eq!(run.output.fault, Fault::LostReading);
    (0..100).for_each(|_| run.step_with(|input| input.enable = false));
    // a stage that nothing drove looks like a weak drive
    let share = run.output.drive_share;
    assert!(share < 0.5, "{share}");
    reset(&mut run);
    assert_eq!(run.output.drive_share, 1.0);
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
fn the_drive_is_on_before_the_first_sample() {
    assert!(Loop::new(&Parameters::START, 29, NO_WORKPIECE).output.drive_enable);
}

#[test]
fn a_drive_that_weakens_on_the_way_back_is_told_before_done() {
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
    let strayed = run.output.tracking_error;
    assert!((5e-6..60e-6).contains(&strayed.abs()), "{:?} {strayed} m", run.output.fault);
    (0..100).for_each(|_| run.step());
    assert_eq!(run.output.tracking_error, strayed);
}

#[test]
fn a_graver_fault_takes_over_and_no_other() {
    let mut run = running(&Parameters::START, 33, State::Detect);
    lose_spindle(&mut run);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::LostSpindle, true));
    (0..4).for_each(|_| lose_position(&mut run));
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::LostReading, false));
    // one as grave, and one that is not
    run.controller.begin_long_step();
    lose_spindle(&mut run);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::LostReading, false));
}

#[test]
fn a_stage_that_is_pulled_from_its_reference_is_told() {
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
fn a_weak_drive_is_told_by_the_start_of_the_approach() {
    let mut p = Parameters::START;
    // a third of what it is told
    p.stage.force_constant *= 3.0;
    let mut run = Loop::new(&p, 36, NO_WORKPIECE);
    assert!(run.run_to(State::Approach, 1.0));
    let from = run.output.reference.position;
    assert!(run.run_to(State::Fault, run.time() + 0.1), "{:?}", run.output);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::WeakDrive, false));
    let way = run.output.reference.position - from;
    assert!(way < 3e-6, "{way} m");
}

#[test]
fn the_reference_lies_where_the_stage_is_while_the_drive_is_off() {
    let mut run = running(&Parameters::START, 39, State::Detect);
    let from = run.slide.place();
    run.controller.begin_long_step();
    run.slide.push = 1.0;
    for _ in 0..1000 {
        run.step();
        assert!(!run.output.drive_enable && (run.output.reference.position - run.slide.place()).abs() < 2e-6);
    }
    let way = run.slide.place() - from;
    assert!(way.abs() > 1e-4, "{way} m");
}

#[test]
fn a_force_that_is_left_behind_the_retract_rejects_the_contact() {
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

/// A loop in `Retract` whose drive then is `late` samples late and has `strength`, run until the job ends.
fn late_on_the_way_back(current_max: f64, late: usize, strength: f64) -> Loop {
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
fn done_waits_for_a_stage_that_swings_until_it_stands() {
    let nominal = late_on_the_way_back(5.0, 0, 1.0).time();
    let mut run = late_on_the_way_back(5.0, 6, 1.0);
    assert_eq!((run.output.state, run.output.fault), (State::Done, Fault::None), "{:?}", run.output);
    assert!(run.time() > nominal + 5e-3, "{} s {nominal} s", run.time());
    let places: Vec<f64> = (0..100).map(|_| (run.step(), run.slide.place()).1).collect();
    let way =
        places.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)) - places.iter().fold(f64::INFINITY, |a, b| a.min(*b));
    // 0.4 N at 130 Hz are 60 nm to and fro
    assert!(way < 120e-9, "{way} m");
}

#[test]
fn a_loop_that_swings_below_the_limit_of_the_current_is_told_before_done() {
    for current_max in [5.0, 0.3] {
        let run = late_on_the_way_back(current_max, 7, 1.15);
        assert!(run.output.current.abs() < current_max);
        switches_off(run, Fault::Oscillation);
    }
}

//! Faults while something is learned: what was learned before stays.

use fmu_deburr::interface::{Fault, LearningLaw, Mode, Parameters, State};
use fmu_deburr::learning::speeds::Speeds;

use crate::robot::Build;
use crate::setup::{Loop, assert_rests_with, trained};

#[test]
fn a_fault_in_the_sample_in_which_learning_is_requested_discards_nothing() {
    let mut run = trained();
    run.input.mode = Mode::Idle;
    run.step();
    (run.input.mode, run.input.enable) = (Mode::Learn, false);
    run.step();
    assert_eq!((run.output.state, run.output.bank.patterns), (State::Off, 5));
}

#[test]
fn a_pattern_beyond_its_limit_ends_the_learning_and_the_others_stay() {
    let mut p = Parameters::START;
    p.limits.pulses_max = 500.0;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    assert!(!run.finish(Mode::Learn));
    assert_rests_with(&run, Fault::PatternTooLarge);
    assert_eq!(run.output.bank.patterns, 0);
}

/// A robot with a bank that learns again, during its motion in the second repetition of the second speed.
fn learning_anew() -> (Loop, fmu_deburr::bank::pattern_bank::PatternBank) {
    let mut run = trained();
    let before = run.controller.bank().clone();
    run.parameters.learn.repetitions = 2;
    run.input.mode = Mode::Idle;
    (0..2).for_each(|_| run.step());
    run.input.mode = Mode::Learn;
    while run.output.learn.speed_index < 2 || run.output.learn.repetition < 1 || run.output.path.distance < 0.08 {
        run.step();
    }
    (run, before)
}

#[test]
fn a_fault_in_the_middle_of_learning_keeps_what_is_learned_and_the_rest_of_before() {
    type Bend = fn(&mut Loop, &fmu_deburr::path::Joints);
    let cases: [(Fault, Bend); 3] = [
        (Fault::PositionFrozen, |run, stuck| {
            run.set_positions(stuck);
            run.controller.tick(&run.input, &run.parameters, &mut run.output);
            run.robot.advance(&run.output.axis.map(|axis| axis.velocity));
        }),
        (Fault::WeakDrive, |run, _| {
            run.read();
            run.controller.tick(&run.input, &run.parameters, &mut run.output);
            run.robot.advance(&run.output.axis.map(|axis| 0.2 * axis.velocity));
        }),
        (Fault::DriveSign, |run, _| {
            run.read();
            run.controller.tick(&run.input, &run.parameters, &mut run.output);
            run.robot.advance(&run.output.axis.map(|axis| -axis.velocity));
        }),
    ];
    for (fault, bend) in cases {
        let (mut run, before) = learning_anew();
        let stuck = run.robot.read();
        let from = run.robot.positions();
        for _ in 0..200 {
            bend(&mut run, &stuck);
            if run.output.state == State::Fault {
                break;
            }
        }
        assert_rests_with(&run, fault);
        assert!(!run.output.drive_enable);
        // 80 mm/s for the samples until then
        let moved = (run.robot.positions()[2] - from[2]).abs();
        assert!(moved < 0.012, "{fault:?}: {moved}");
        assert_eq!(run.output.bank.patterns, 5);
        let now = run.controller.bank();
        assert_ne!(now.pattern(0), before.pattern(0), "the first speed is learned");
        (1..5).for_each(|speed| assert_eq!(now.pattern(speed), before.pattern(speed), "{fault:?} {speed}"));
    }
}

#[test]
fn learning_that_is_started_again_after_a_fault_begins_with_the_first_speed() {
    let (mut run, _) = learning_anew();
    run.controller.begin_long_step();
    run.step();
    assert_rests_with(&run, Fault::LongStep);
    run.input.mode = Mode::Idle;
    (0..100).for_each(|_| run.step());
    run.input.reset_fault = true;
    (0..2).for_each(|_| run.step());
    run.input.mode = Mode::Learn;
    run.step();
    assert_eq!((run.output.state, run.output.bank.patterns), (State::Approach, 0));
    assert_eq!((run.output.learn.speed_index, run.output.learn.repetition), (1, 0));
    assert!(run.finish(Mode::Learn));
    assert_eq!(run.output.bank.patterns, 5);
}

#[test]
fn a_pattern_that_grows_ends_its_speed_in_the_middle_of_the_path_and_is_no_fault() {
    let mut p = Parameters::START;
    // read so far ahead, an error at high frequencies is enlarged by each repetition
    (p.learn.law, p.learn.lead, p.learn.repetitions) = (LearningLaw::LeadFilter, 8, 60);
    (p.learn.identify, p.learn.tolerance, p.learn.decrease) = (false, 0.0, 0.0);
    p.learn.factors = Speeds::new(&[1.0, 0.4]).unwrap();
    let mut run = Loop::new(&p, &Build::NOMINAL);
    run.step();
    run.input.mode = Mode::Learn;
    let mut before = run.output.clone();
    let (mut reached, mut minimum) = (Vec::new(), Vec::new());
    while !matches!(run.output.state, State::Done | State::Fault) {
        run.step();
        // a repetition that is not finished ends with a stop
        if (before.state, run.output.state) == (State::Run, State::Stop) {
            reached.push(before.learn.repetition);
            minimum.push(before.learn.best);
        }
        before = run.output.clone();
    }
    assert_eq!((run.output.state, run.output.fault, run.output.bank.patterns), (State::Done, Fault::None, 2));
    assert!(reached.len() == 2 && reached.iter().all(|repetition| *repetition < 60), "{reached:?}");
    assert!(minimum.iter().zip(&reached).all(|(best, last)| best < last), "{minimum:?} {reached:?}");
}

//! After a fault and without `enable`: nothing moves by itself.

use fmu_deburr::interface::{Fault, Mode, Parameters, State};

use crate::robot::Build;
use crate::setup::{Loop, assert_rests_with, running};

/// A robot whose fault was reset with a mode set, at rest.
fn recovered() -> Loop {
    let mut run = running(Mode::DryRun);
    run.controller.begin_long_step();
    (0..100).for_each(|_| run.step());
    // what is asked for now is no task
    run.input.mode = Mode::Learn;
    run.step();
    run.input.reset_fault = true;
    (0..300).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    run
}

#[test]
fn after_a_fault_nothing_moves_before_another_mode_or_another_enable() {
    let mut run = recovered();
    run.input.mode = Mode::DryRun;
    run.step();
    assert_eq!(run.output.state, State::Approach);
    let mut run = recovered();
    for enable in [false, true] {
        run.input.enable = enable;
        run.step();
    }
    run.step();
    assert_eq!(run.output.state, State::Approach);
}

#[test]
fn a_mode_that_changed_without_enable_does_not_begin_with_it() {
    let mut run = running(Mode::DryRun);
    run.input.enable = false;
    (0..100).for_each(|_| run.step());
    run.input.mode = Mode::Learn;
    run.step();
    run.input.enable = true;
    (0..100).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Idle);
    // asked for again, it does
    for mode in [Mode::Idle, Mode::Learn] {
        run.input.mode = mode;
        run.step();
    }
    assert_eq!(run.output.state, State::Approach);
}

#[test]
fn a_mode_that_is_set_before_the_first_enable_begins_with_it() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL);
    (run.input.enable, run.input.mode) = (false, Mode::DryRun);
    (0..10).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Off);
    run.input.enable = true;
    (0..2).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Approach);
}

#[test]
fn a_mode_that_has_stayed_begins_again_with_enable() {
    let mut run = running(Mode::DryRun);
    run.input.enable = false;
    (0..100).for_each(|_| run.step());
    run.input.enable = true;
    (0..2).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Approach);
}

#[test]
fn a_reset_needs_a_rising_edge_without_its_cause_and_axes_at_rest() {
    let mut run = running(Mode::DryRun);
    run.input.reset_fault = true;
    for _ in 0..5 {
        run.controller.begin_long_step();
        run.step();
    }
    // the edge came before or with the cause
    (0..100).for_each(|_| run.step());
    assert_rests_with(&run, Fault::LongStep);
    run.input.reset_fault = false;
    run.step();
    // pushed by hand at 20 mm/s
    run.input.reset_fault = true;
    let mut positions = run.robot.read();
    for _ in 0..50 {
        positions[2] += 2e-4;
        run.set_positions(&positions);
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
        assert_rests_with(&run, Fault::LongStep);
    }
    // that edge was too early
    (0..100).for_each(|_| run.controller.tick(&run.input, &run.parameters, &mut run.output));
    assert_rests_with(&run, Fault::LongStep);
    for reset in [false, true] {
        run.input.reset_fault = reset;
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
    }
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
}

#[test]
fn without_enable_a_motion_stops_on_its_path_and_then_everything_is_off() {
    let mut run = running(Mode::DryRun);
    let mut speed = run.output.path.speed;
    assert!(speed > 0.09);
    run.input.enable = false;
    loop {
        run.step();
        let now = run.output.path.speed;
        assert!((0.0..0.0051).contains(&(speed - now)), "{speed} {now}");
        speed = now;
        if run.output.state != State::Stop {
            break;
        }
    }
    assert_eq!((run.output.state, speed), (State::Off, 0.0));
    assert!(run.output.axis.iter().all(|axis| axis.velocity == 0.0));
    (0..100).for_each(|_| run.step());
    // when enabled again it holds its position
    (run.input.enable, run.input.mode) = (true, Mode::Idle);
    (0..10).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Idle);
    assert!(run.output.axis.iter().all(|axis| axis.error == 0.0));
}

#[test]
fn a_moment_without_enable_ends_the_cycle() {
    let mut run = running(Mode::DryRun);
    run.input.enable = false;
    run.step();
    run.input.enable = true;
    let mut visited = Vec::new();
    for _ in 0..300 {
        run.step();
        visited.push(run.output.state);
    }
    visited.dedup();
    assert_eq!(visited, [State::Stop, State::Off, State::Idle]);
}

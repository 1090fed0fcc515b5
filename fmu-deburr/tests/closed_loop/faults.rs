//! Faults: the right one, at once, with zero commands, and back again.

use fmu_deburr::interface::{Fault, Mode, Parameters, State};

use crate::robot::Build;
use crate::setup::{Loop, taught};

/// A robot that runs the path without patterns.
fn running(mode: Mode) -> Loop {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    run.step();
    run.input.mode = mode;
    while run.output.state != State::Run {
        run.step();
    }
    (0..100).for_each(|_| run.step());
    run
}

fn stands_with(run: &Loop, fault: Fault) {
    assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    assert!(run.output.axis.iter().all(|axis| axis.velocity == 0.0));
}

fn everything_is_finite(run: &Loop) {
    for axis in run.output.axis {
        for value in [axis.velocity, axis.reference, axis.error, axis.compensation, axis.rms, axis.peak] {
            assert!(value.is_finite());
        }
    }
}

#[test]
fn nonsense_in_any_input_stops_the_axes_in_the_same_sample() {
    for nonsense in [f64::NAN, f64::INFINITY, -1e300] {
        for which in 0..3 {
            let mut run = running(Mode::DryRun);
            let mut positions = run.robot.read();
            match which {
                0 => positions[4] = nonsense,
                1 => run.input.spindle_speed = nonsense,
                _ => run.input.speed_override = if nonsense == -1e300 { f64::NAN } else { nonsense },
            }
            run.set_positions(&positions);
            run.controller.tick(&run.input, &run.parameters, &mut run.output);
            stands_with(&run, Fault::InvalidInput);
            everything_is_finite(&run);
        }
    }
}

#[test]
fn a_drive_that_does_not_move_is_a_control_error() {
    let mut run = running(Mode::DryRun);
    let stuck = run.robot.read();
    for _ in 0..1000 {
        run.set_positions(&stuck);
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
        if run.output.state == State::Fault {
            break;
        }
    }
    stands_with(&run, Fault::ControlError);
}

#[test]
fn a_command_at_its_limit_is_told_and_is_no_fault() {
    let mut run = running(Mode::DryRun);
    assert!(!run.output.saturated);
    // 0.1 rad times 100 1/s are more than the axis can do
    run.parameters.servo_gain[3] = 100.0;
    let mut positions = run.robot.read();
    positions[3] -= 0.1;
    run.set_positions(&positions);
    run.controller.tick(&run.input, &run.parameters, &mut run.output);
    assert_eq!(run.output.axis[3].velocity, run.parameters.axis[3].velocity_max);
    assert!(run.output.saturated && run.output.state == State::Run, "{:?}", run.output);
}

#[test]
fn a_tool_that_stalls_ends_deburring_but_not_a_dry_run() {
    for (mode, state) in [(Mode::Deburr, State::Fault), (Mode::DryRun, State::Run)] {
        let mut run = running(mode);
        run.input.spindle_speed = 900.0;
        run.step();
        assert_eq!(run.output.state, state);
    }
}

#[test]
fn without_patterns_nothing_is_deburred_blindly() {
    for mode in [Mode::Playback, Mode::Deburr] {
        let mut run = Loop::new(&Parameters::START, &Build::NOMINAL);
        run.step();
        run.input.mode = mode;
        run.step();
        stands_with(&run, Fault::BankEmpty);
        // a reset alone moves nothing
        run.input.reset_fault = true;
        (0..100).for_each(|_| run.step());
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    }
}

/// A robot whose fault was reset with a mode set, at rest.
fn recovered() -> Loop {
    let mut run = running(Mode::DryRun);
    run.input.spindle_speed = f64::NAN;
    (0..100).for_each(|_| run.step());
    // what is asked for now is no job
    (run.input.mode, run.input.spindle_speed) = (Mode::Learn, 1885.0);
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
fn a_mode_that_is_set_already_begins_when_enable_rises() {
    let mut run = running(Mode::DryRun);
    run.input.enable = false;
    (0..100).for_each(|_| run.step());
    run.input.mode = Mode::Playback;
    run.step();
    assert_eq!(run.output.state, State::Off);
    run.input.enable = true;
    (0..2).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Approach);
}

#[test]
fn a_reset_needs_a_rising_edge_without_its_cause_and_axes_at_rest() {
    let mut run = running(Mode::DryRun);
    (run.input.reset_fault, run.input.spindle_speed) = (true, f64::NAN);
    run.step();
    run.step();
    // the edge came before or with the cause
    run.input.spindle_speed = 1885.0;
    (0..100).for_each(|_| run.step());
    stands_with(&run, Fault::InvalidInput);
    run.input.reset_fault = false;
    run.step();
    // pushed by hand at 20 mm/s
    run.input.reset_fault = true;
    let mut positions = run.robot.read();
    for _ in 0..50 {
        positions[2] += 2e-4;
        run.set_positions(&positions);
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
        stands_with(&run, Fault::InvalidInput);
    }
    // that edge was too early
    (0..100).for_each(|_| run.controller.tick(&run.input, &run.parameters, &mut run.output));
    stands_with(&run, Fault::InvalidInput);
    for reset in [false, true] {
        run.input.reset_fault = reset;
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
    }
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
}

#[test]
fn a_fault_in_the_sample_in_which_learning_is_asked_for_forgets_nothing() {
    let mut run = taught();
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
    stands_with(&run, Fault::PatternTooLarge);
    assert_eq!(run.output.bank.patterns, 0);
}

#[test]
fn without_enable_a_motion_stops_on_its_way_and_then_everything_is_off() {
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
    // enabled again it holds where it stands
    (run.input.enable, run.input.mode) = (true, Mode::Idle);
    (0..10).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Idle);
    assert!(run.output.axis.iter().all(|axis| axis.error == 0.0));
}

#[test]
fn a_moment_without_enable_ends_the_job() {
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

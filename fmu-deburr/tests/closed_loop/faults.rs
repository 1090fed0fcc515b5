//! Faults of the axes and of the task: the right one, immediately, with zero commands.

mod learning;
mod lost_counts;
mod rests;
mod tool;

use fmu_deburr::interface::{Fault, Input, Mode, Parameters, State};

use crate::robot::Build;
use crate::setup::{Loop, assert_rests_with, running};

fn everything_is_finite(run: &Loop) {
    for axis in run.output.axis {
        for value in [axis.velocity, axis.reference, axis.error, axis.compensation, axis.rms, axis.peak] {
            assert!(value.is_finite());
        }
    }
}

#[test]
fn nonsense_in_any_input_is_bridged_for_three_samples() {
    let inputs = [
        (0, f64::NAN, Fault::PositionLost),
        (0, f64::INFINITY, Fault::PositionLost),
        (0, -1e300, Fault::PositionLost),
        (1, f64::NAN, Fault::SpindleLost),
        (1, f64::NEG_INFINITY, Fault::SpindleLost),
        (1, 1e300, Fault::SpindleLost),
        (2, f64::NAN, Fault::InvalidInput),
        (2, f64::INFINITY, Fault::InvalidInput),
    ];
    for (which, nonsense, fault) in inputs {
        for (samples, expected) in [(3, Fault::None), (4, fault)] {
            let mut run = running(Mode::DryRun);
            for k in 0..20 {
                run.read();
                let lost = k < samples;
                match which {
                    0 if lost => run.input.axis[2].position = nonsense,
                    1 => run.input.spindle_speed = if lost { nonsense } else { 1885.0 },
                    2 => run.input.speed_override = if lost { nonsense } else { 1.0 },
                    _ => {}
                }
                run.controller.tick(&run.input, &run.parameters, &mut run.output);
                run.robot.advance(&run.output.axis.map(|axis| axis.velocity));
                everything_is_finite(&run);
            }
            // only an axis of which the position is not known is let go
            let driven = expected != Fault::PositionLost;
            assert_eq!((run.output.fault, run.output.drive_enable), (expected, driven), "{which} {nonsense}");
            if !driven {
                assert_rests_with(&run, fault);
            }
        }
    }
}

#[test]
fn a_frozen_measurement_is_named_before_what_it_causes() {
    let mut run = running(Mode::DryRun);
    let stuck = run.robot.read();
    for _ in 0..1000 {
        run.set_positions(&stuck);
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
        if run.output.state == State::Fault {
            break;
        }
    }
    assert_rests_with(&run, Fault::PositionFrozen);
    assert!(!run.output.drive_enable);
}

/// Steps with measurements or commands that are bent until something happens; how far the tip axis 3 is off then, m.
fn bent(mode: Mode, bend: impl Fn(&mut Loop, usize)) -> (Fault, f64) {
    let mut run = running(mode);
    for k in 0..400 {
        bend(&mut run, k);
        let off = (run.output.axis[2].reference - run.robot.positions()[2]).abs();
        if run.output.state == State::Fault {
            assert!(!run.output.drive_enable && run.output.axis.iter().all(|axis| axis.velocity == 0.0));
            everything_is_finite(&run);
            return (run.output.fault, off);
        }
    }
    (run.output.fault, 0.0)
}

/// One step with other commands than the controller's.
fn commanded(run: &mut Loop, change: impl Fn(&mut fmu_deburr::path::Joints)) {
    run.read();
    run.controller.tick(&run.input, &run.parameters, &mut run.output);
    let mut velocity = run.output.axis.map(|axis| axis.velocity);
    change(&mut velocity);
    run.robot.advance(&velocity);
}

#[test]
fn a_drive_that_does_something_else_is_named_by_what_it_does() {
    // gain, largest speed, distance from the reference
    let cases = [
        (Fault::DriveSign, -1.0, 1.0, 0.03),
        (Fault::WeakDrive, 0.3, 1.0, 0.015),
        (Fault::WeakDrive, 1.0, 0.02, 0.015),
        (Fault::PositionFrozen, 0.0, 1.0, 0.015),
    ];
    for (fault, gain, fastest, maximum) in cases {
        let bend = |velocity: &mut fmu_deburr::path::Joints| {
            velocity[2] = (gain * velocity[2]).clamp(-fastest, fastest);
        };
        let (found, off) = bent(Mode::DryRun, |run, _| commanded(run, bend));
        assert_eq!(found, fault);
        assert!(off < maximum, "{fault:?}: {off}");
    }
}

#[test]
fn a_jump_of_a_reading_is_bridged_for_three_samples_and_moves_nothing() {
    for (samples, expected) in [(1, Fault::None), (3, Fault::None), (400, Fault::PositionJump)] {
        for jump in [0.02, -0.5] {
            let (found, off) = bent(Mode::DryRun, |run, k| {
                let mut positions = run.robot.read();
                positions[2] += if k < samples { jump } else { 0.0 };
                run.set_positions(&positions);
                run.controller.tick(&run.input, &run.parameters, &mut run.output);
                run.robot.advance(&run.output.axis.map(|axis| axis.velocity));
                assert!(run.output.axis[2].velocity.abs() < 0.12, "{samples} {jump} {k}");
            });
            assert_eq!(found, expected, "{samples} {jump}: {off}");
        }
    }
}

#[test]
fn a_reading_that_drifts_is_reported_before_done() {
    let (found, _) = bent(Mode::DryRun, |run, k| {
        let mut positions = run.robot.read();
        positions[2] += 2e-5 * k as f64;
        run.set_positions(&positions);
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
        run.robot.advance(&run.output.axis.map(|axis| axis.velocity));
    });
    assert_eq!(found, Fault::FollowingError);
}

#[test]
fn a_loop_that_is_not_stable_is_an_oscillation() {
    let mut p = Parameters::START;
    p.servo_gain[2] = 90.0;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    run.step();
    run.input.mode = Mode::DryRun;
    let mut off: f64 = 0.0;
    for _ in 0..1000 {
        run.step();
        off = off.max((run.output.axis[2].reference - run.robot.positions()[2]).abs());
    }
    assert_rests_with(&run, Fault::Oscillation);
    assert!(off < 0.02, "{off}");
}

#[test]
fn a_delay_that_is_not_the_configured_one_is_named() {
    for (delay, io_delay) in [(0, 1), (1, 0), (2, 1)] {
        let mut p = Parameters::START;
        p.io_delay = io_delay;
        let mut run = Loop::new(&p, &Build { delay, ..Build::NOMINAL });
        assert!(!run.finish(Mode::Learn));
        assert_eq!((run.output.fault, run.output.numbers.value), (Fault::WrongDelay, delay as f64));
    }
}

#[test]
fn a_drive_that_is_weak_is_switched_off_also_where_the_delay_is_wrong() {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    let mut run = Loop::new(&p, &Build { delay: 2, ..Build::NOMINAL });
    run.step();
    run.input.mode = Mode::DryRun;
    while run.output.path.distance < 0.05 {
        run.step();
    }
    for _ in 0..100 {
        commanded(&mut run, |velocity| velocity[0] *= 0.3);
    }
    assert!(matches!(run.output.fault, Fault::WeakDrive | Fault::FollowingError), "{:?}", run.output.fault);
    assert!(!run.output.drive_enable);
}

#[test]
fn a_cycle_that_takes_too_long_ends_whatever_it_does() {
    for mode in [Mode::DryRun, Mode::Learn] {
        let mut run = running(mode);
        (run.input.mode, run.parameters.limits.cycle_time) = (Mode::Idle, 5.0);
        (0..100).for_each(|_| run.step());
        run.input.mode = mode;
        run.input.speed_override = 0.001;
        (0..1000).for_each(|_| run.step());
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::NoProgress));
    }
}

#[test]
fn time_that_is_held_does_not_count() {
    let mut run = running(Mode::DryRun);
    run.parameters.limits.cycle_time = 20.0;
    run.input.hold = true;
    (0..4000).for_each(|_| run.step());
    run.input.hold = false;
    (0..1000).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.fault), (State::Done, Fault::None));
}

#[test]
fn a_more_severe_fault_takes_over_and_a_less_severe_one_does_not() {
    let mut run = running(Mode::Deburr);
    run.input.spindle_speed = 1600.0;
    while run.output.fault == Fault::None {
        run.step();
    }
    assert_eq!((run.output.state, run.output.fault, run.output.drive_enable), (State::Stop, Fault::SpindleSlow, true));
    let stuck = run.robot.read();
    while run.output.fault == Fault::SpindleSlow {
        run.set_positions(&stuck);
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
    }
    assert_rests_with(&run, Fault::PositionFrozen);
    assert!(!run.output.drive_enable);
    run.input.mode = Mode::Playback;
    (0..10).for_each(|_| run.step());
    assert_rests_with(&run, Fault::PositionFrozen);
    run.input.reset_fault = true;
    (0..10).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.drive_enable), (State::Idle, true));
}

#[test]
fn a_run_that_is_too_slow_for_its_cycle_time_makes_no_progress() {
    let mut p = Parameters::START;
    (p.lookup.enable, p.limits.cycle_time) = (false, 6.0);
    let mut run = Loop::new(&p, &Build::NOMINAL);
    run.step();
    (run.input.mode, run.input.speed_override) = (Mode::DryRun, 0.01);
    let (mut samples, mut on_path) = (0, 0);
    while run.output.fault == Fault::None && samples < 2000 {
        run.step();
        samples += i32::from(run.output.state != State::Idle);
        on_path += i32::from(run.output.state == State::Run);
    }
    assert_eq!(run.output.fault, Fault::NoProgress, "{:?}", run.output);
    assert!((samples - 600).abs() < 3 && on_path > 100, "{samples} {on_path}");
}

#[test]
fn a_command_at_its_limit_is_reported_and_is_no_fault() {
    let mut run = running(Mode::DryRun);
    assert!(!run.output.saturated);
    run.parameters.axis[2].velocity_max = 0.03;
    run.step();
    assert_eq!(run.output.axis[2].velocity.abs(), 0.03);
    assert!(run.output.saturated && run.output.state == State::Run, "{:?}", run.output);
}

#[test]
fn without_patterns_nothing_is_deburred_blindly() {
    for mode in [Mode::Playback, Mode::Deburr] {
        let mut run = Loop::new(&Parameters::START, &Build::NOMINAL);
        run.step();
        run.input.mode = mode;
        run.step();
        assert_rests_with(&run, Fault::BankEmpty);
        // a reset alone moves nothing
        run.input.reset_fault = true;
        (0..100).for_each(|_| run.step());
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    }
}

#[test]
fn a_communication_step_that_is_too_long_is_reported_in_its_first_sample() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL);
    run.input.mode = Mode::DryRun;
    run.controller.begin_long_step();
    run.step();
    assert_rests_with(&run, Fault::LongStep);
    assert!(!run.output.drive_enable);
    run.input.reset_fault = true;
    (0..2).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
}

#[test]
fn a_fault_counts_in_a_stop_without_enable_and_not_while_off() {
    let mut run = running(Mode::DryRun);
    run.input.enable = false;
    run.step();
    assert_eq!(run.output.state, State::Stop);
    run.controller.begin_long_step();
    run.step();
    assert_rests_with(&run, Fault::LongStep);
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL);
    (run.input.enable, run.input.speed_override) = (false, f64::NAN);
    (0..10).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.fault), (State::Off, Fault::None));
}

#[test]
fn of_two_faults_with_the_same_end_the_first_stays() {
    let mut run = running(Mode::DryRun);
    run.input.spindle_speed = f64::INFINITY;
    (0..4).for_each(|_| run.step());
    run.input.speed_override = f64::NAN;
    for _ in 0..20 {
        run.step();
        assert_eq!(run.output.fault, Fault::SpindleLost);
    }
}

#[test]
fn a_tool_speed_or_an_override_that_is_lost_ends_after_the_retract() {
    type Lose = fn(&mut Input);
    let lost: [(Fault, Lose); 3] = [
        (Fault::SpindleLost, |input| input.spindle_speed = f64::NAN),
        (Fault::SpindleJump, |input| input.spindle_speed = 0.0),
        (Fault::InvalidInput, |input| input.speed_override = f64::NAN),
    ];
    for (fault, lose) in lost {
        let mut p = Parameters::START;
        p.lookup.enable = false;
        let mut run = Loop::new(&p, &Build::NOMINAL);
        run.input.mode = Mode::Deburr;
        while run.output.path.distance < 0.05 {
            run.step();
        }
        lose(&mut run.input);
        (0..4).for_each(|_| run.step());
        let height = run.robot.positions()[1];
        assert_eq!((run.output.fault, run.output.state), (fault, State::Stop));
        (0..300).for_each(|_| run.step());
        assert_rests_with(&run, fault);
        assert!(run.output.drive_enable);
        assert!((run.robot.positions()[1] - height - p.transfer.clearance).abs() < 1e-4, "{fault:?}");
    }
}

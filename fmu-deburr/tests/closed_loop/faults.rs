//! Faults: the right one, at once, with zero commands, and back again.

use fmu_deburr::interface::{Fault, Mode, Parameters, State};
use fmu_deburr::path::{Block, Pose, TaughtPath, Vector};

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
    for nonsense in [f64::INFINITY, f64::NEG_INFINITY, -1e300] {
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
fn a_reading_that_is_no_number_is_bridged_for_three_samples() {
    for (samples, expected) in [(3, Fault::None), (4, Fault::LostReading)] {
        for axis in [true, false] {
            let mut run = running(Mode::DryRun);
            for k in 0..20 {
                run.read();
                let lost = if k < samples { f64::NAN } else { 0.0 };
                run.input.axis[2].position += if axis { lost } else { 0.0 };
                run.input.spindle_speed = 1885.0 + if axis { 0.0 } else { lost };
                run.controller.tick(&run.input, &run.parameters, &mut run.output);
                run.robot.advance(&run.output.axis.map(|axis| axis.velocity));
                everything_is_finite(&run);
            }
            assert_eq!((run.output.fault, run.output.drive_enable), (expected, expected == Fault::None), "{axis}");
        }
    }
}

#[test]
fn a_reading_that_stands_is_named_before_what_it_causes() {
    let mut run = running(Mode::DryRun);
    let stuck = run.robot.read();
    for _ in 0..1000 {
        run.set_positions(&stuck);
        run.controller.tick(&run.input, &run.parameters, &mut run.output);
        if run.output.state == State::Fault {
            break;
        }
    }
    stands_with(&run, Fault::FrozenReading);
    assert!(!run.output.drive_enable);
}

/// Steps with readings or commands that are bent until something happens; how far the tip axis 3 is off then, m.
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
        (Fault::FrozenReading, 0.0, 1.0, 0.015),
    ];
    for (fault, gain, fastest, most) in cases {
        let bend = |velocity: &mut fmu_deburr::path::Joints| {
            velocity[2] = (gain * velocity[2]).clamp(-fastest, fastest);
        };
        let (found, off) = bent(Mode::DryRun, |run, _| commanded(run, bend));
        assert_eq!(found, fault);
        assert!(off < most, "{fault:?}: {off}");
    }
}

#[test]
fn a_jump_of_a_reading_is_bridged_for_three_samples_and_moves_nothing() {
    for (samples, expected) in [(1, Fault::None), (3, Fault::None), (400, Fault::ReadingJump)] {
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
fn a_reading_that_drifts_is_told_before_done() {
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
    stands_with(&run, Fault::Oscillation);
    assert!(off < 0.02, "{off}");
}

#[test]
fn a_delay_that_is_not_the_one_told_is_named() {
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

/// There and back again, without end.
fn cyclic(p: &Parameters, build: &Build, mode: Mode) -> Loop {
    let pose = |y: f64| Pose { tip: Vector::new(0.75, y, -0.2), axis: Vector::new(0.0, 0.0, -1.0) };
    let blocks = [0.0, 0.1, 0.0].map(pose).windows(2).map(|ends| Block::line(&ends[0], &ends[1]).unwrap()).collect();
    let mut run = Loop::with_path(p, build, TaughtPath::new(blocks, 0.1, true, 0.2).unwrap());
    run.step();
    run.input.mode = mode;
    run
}

#[test]
fn every_lap_tests_the_delay_and_the_tool() {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    let cut = |k: usize| if k % 50 < 25 { 1800.0 } else { 1885.0 };
    // the tool cuts up to a lap
    let cases = [(1, 0, Fault::NoCut, 1), (1, 2, Fault::NoCut, 3), (2, usize::MAX, Fault::WrongDelay, 1)];
    for (delay, laps_cut, expected, laps) in cases {
        let mut run = cyclic(&p, &Build { delay, ..Build::NOMINAL }, Mode::Deburr);
        for k in 0..4000 {
            run.input.spindle_speed = if (run.output.path.laps as usize) < laps_cut { cut(k) } else { 1885.0 };
            run.step();
            if run.output.fault != Fault::None {
                break;
            }
        }
        assert_eq!((run.output.fault, run.output.path.laps), (expected, laps), "{delay} {laps_cut}");
    }
}

#[test]
fn nothing_that_was_cut_is_told_and_the_tool_drawn_back() {
    let mut run = running(Mode::Deburr);
    let height = run.robot.positions()[1];
    (0..3000).for_each(|_| run.step());
    stands_with(&run, Fault::NoCut);
    assert!(run.output.drive_enable);
    assert!((run.robot.positions()[1] - height - run.parameters.transfer.clearance).abs() < 1e-4);
}

#[test]
fn a_job_that_takes_too_long_ends_whatever_it_does() {
    for mode in [Mode::DryRun, Mode::Learn] {
        let mut run = running(mode);
        (run.input.mode, run.parameters.limits.job_time) = (Mode::Idle, 5.0);
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
    run.parameters.limits.job_time = 20.0;
    run.input.hold = true;
    (0..4000).for_each(|_| run.step());
    run.input.hold = false;
    (0..1000).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.fault), (State::Done, Fault::None));
}

#[test]
fn a_graver_fault_takes_over_and_a_lighter_one_does_not() {
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
    stands_with(&run, Fault::FrozenReading);
    assert!(!run.output.drive_enable);
    run.input.mode = Mode::Playback;
    (0..10).for_each(|_| run.step());
    stands_with(&run, Fault::FrozenReading);
    run.input.reset_fault = true;
    (0..10).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.drive_enable), (State::Idle, true));
}

#[test]
fn a_command_at_its_limit_is_told_and_is_no_fault() {
    let mut run = running(Mode::DryRun);
    assert!(!run.output.saturated);
    run.parameters.axis[2].velocity_max = 0.03;
    run.step();
    assert_eq!(run.output.axis[2].velocity.abs(), 0.03);
    assert!(run.output.saturated && run.output.state == State::Run, "{:?}", run.output);
}

#[test]
fn a_tool_that_stalls_stops_and_leaves_the_part_but_not_in_a_dry_run() {
    for (mode, expected) in [(Mode::Deburr, vec![State::Stop, State::Retract, State::Fault]), (Mode::DryRun, vec![])] {
        let mut run = running(mode);
        let height = run.robot.positions()[1];
        run.input.spindle_speed = 1600.0;
        let mut visited = Vec::new();
        for _ in 0..250 {
            run.step();
            if run.output.state != State::Run {
                visited.push(run.output.state);
            }
        }
        visited.dedup();
        visited.retain(|state| *state != State::Done);
        assert_eq!(visited, expected);
        if mode == Mode::Deburr {
            assert_eq!((run.output.fault, run.output.drive_enable), (Fault::SpindleSlow, true));
            assert!((run.robot.positions()[1] - height - 0.02).abs() < 1e-4);
        }
    }
}

#[test]
fn bad_samples_of_the_tool_do_not_end_a_casting() {
    let mut run = running(Mode::Deburr);
    let speed = run.output.path.speed;
    for bad in [0.0, 900.0, 5000.0] {
        run.input.spindle_speed = bad;
        (0..3).for_each(|_| run.step());
        run.input.spindle_speed = 1885.0;
        (0..3).for_each(|_| run.step());
        assert_eq!((run.output.fault, run.output.path.speed), (Fault::None, speed));
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
    run.input.spindle_speed = f64::INFINITY;
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
    (run.input.reset_fault, run.input.spindle_speed) = (true, f64::INFINITY);
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

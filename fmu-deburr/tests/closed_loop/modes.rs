//! Modes and switches: hold, stop, override, load control, laps.

mod registration;

use fmu_deburr::interface::{BankStatus, Fault, Mode, Parameters, State};
use fmu_deburr::learning::speeds::Speeds;

use crate::robot::Build;
use crate::setup::{Loop, trained};

fn bare() -> Loop {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    run.step();
    run
}

fn run_until(run: &mut Loop, condition: impl Fn(&Loop) -> bool) {
    for _ in 0..10_000 {
        if condition(run) {
            return;
        }
        run.step();
    }
    panic!("never: {:?}", run.output);
}

#[test]
fn references_never_jump_whatever_is_requested() {
    let mut run = bare();
    let modes = [Mode::DryRun, Mode::Idle, Mode::Learn, Mode::Deburr, Mode::Idle, Mode::Learn, Mode::DryRun];
    let mut before = [0.0; 6];
    for k in 0..12_000 {
        run.input.mode = modes[k / 397 % modes.len()];
        run.input.hold = k / 173 % 3 == 2;
        run.input.speed_override = 0.2 + 0.8 * f64::from(u8::from(k / 71 % 2 == 0));
        run.step();
        assert_ne!(run.output.state, State::Fault);
        let now = run.output.axis.map(|axis| axis.reference);
        for i in 0..6 {
            let maximum = 0.011 * run.parameters.axis[i].velocity_max * 0.5;
            assert!(k == 0 || (now[i] - before[i]).abs() < maximum, "sample {k}, axis {}: {now:?} {before:?}", i + 1);
        }
        before = now;
    }
}

#[test]
fn a_held_run_rests_on_the_path_and_goes_on() {
    let mut run = bare();
    run.input.mode = Mode::DryRun;
    run_until(&mut run, |run| run.output.path.distance > 0.1);
    run.input.hold = true;
    (0..100).for_each(|_| run.step());
    let distance = run.output.path.distance;
    assert!(run.output.path.speed == 0.0 && distance < 0.12 && run.output.state == State::Run);
    (0..100).for_each(|_| run.step());
    assert_eq!(run.output.path.distance, distance);
    assert!(run.output.axis.iter().all(|axis| axis.error.abs() < 1e-4));
    run.input.hold = false;
    run_until(&mut run, |run| run.output.path.done);
    assert_eq!(run.output.path.distance, run.output.path.length);
}

#[test]
fn a_held_repetition_is_done_again_and_learns_the_same() {
    let mut p = Parameters::START;
    (p.learn.repetitions, p.learn.factors) = (2, Speeds::new(&[1.0]).unwrap());
    let mut straight = Loop::new(&p, &Build::NOMINAL);
    assert!(straight.finish(Mode::Learn));
    let mut held = Loop::new(&p, &Build::NOMINAL);
    held.step();
    held.input.mode = Mode::Learn;
    run_until(&mut held, |run| run.output.learn.repetition == 1 && run.output.path.distance > 0.1);
    held.input.hold = true;
    (0..300).for_each(|_| held.step());
    assert_eq!(held.output.state, State::Stop);
    held.input.hold = false;
    run_until(&mut held, |run| run.output.learn.done);
    assert!((held.output.learn.cost - straight.output.learn.cost).abs() < 1e-6);
}

#[test]
fn the_bank_is_written_after_learning_and_whenever_it_is_requested() {
    let mut run = trained();
    assert!(run.controller.take_export() && !run.controller.take_export());
    // from Done, again, and from Idle
    for mode in [Mode::Export, Mode::DryRun, Mode::Export, Mode::Idle, Mode::Export] {
        run.input.mode = mode;
        run.step();
        assert_eq!(run.controller.take_export(), mode == Mode::Export, "{mode:?}");
        run_until(&mut run, |run| matches!(run.output.state, State::Done | State::Idle));
    }
}

#[test]
fn idle_stops_on_the_path_and_stays_there() {
    let mut run = bare();
    run.input.mode = Mode::DryRun;
    run_until(&mut run, |run| run.output.path.distance > 0.1);
    run.input.mode = Mode::Idle;
    run_until(&mut run, |run| run.output.state == State::Idle);
    (0..100).for_each(|_| run.step());
    let [a, b] = [run.robot.positions(), {
        run.step();
        run.robot.positions()
    }];
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9) && run.output.path.distance < 0.12);
}

#[test]
fn a_slow_tool_slows_the_feed_and_a_free_one_does_not() {
    let mut run = bare();
    run.input.mode = Mode::Deburr;
    run_until(&mut run, |run| run.output.path.distance > 0.08);
    assert!((run.output.path.speed - 0.1).abs() < 1e-12);
    for k in 0..60 {
        // a constant position would be a frozen one
        run.input.spindle_speed = 0.98 * run.parameters.load.spindle_speed - 0.2 * f64::from(k);
        run.step();
    }
    assert!(run.output.path.speed < 0.01 && run.output.load.overload, "{:?}", run.output.path);
    run.input.spindle_speed = 1.04 * run.parameters.load.spindle_speed;
    (0..60).for_each(|_| run.step());
    assert!((run.output.path.speed - 0.1).abs() < 1e-12 && !run.output.load.overload);
}

#[test]
fn blocks_are_counted_with_the_distance_from_their_teaching_point() {
    let mut run = bare();
    run.input.mode = Mode::DryRun;
    for (block, start) in [(1, 0.0), (2, 0.12), (3, 0.14356)] {
        run_until(&mut run, |run| run.output.state == State::Run && run.output.path.block == block);
        let path = &run.output.path;
        assert!((path.distance - path.block_distance - start).abs() < 1e-5, "{path:?}");
    }
}

#[test]
fn a_bank_that_learning_has_begun_to_change_is_not_reported_as_that_of_a_file() {
    let mut p = Parameters::START;
    (p.learn.repetitions, p.learn.identify) = (0, false);
    p.learn.factors = Speeds::new(&[1.0, 0.5]).unwrap();
    let mut run = Loop::new(&p, &Build::NOMINAL);
    run.output.bank.status = BankStatus::Imported;
    run.step();
    assert_eq!(run.output.bank.status, BankStatus::Imported);
    run.input.mode = Mode::Learn;
    run.step();
    assert_eq!((run.output.bank.status, run.output.bank.patterns), (BankStatus::Empty, 0));
    run_until(&mut run, |run| run.output.bank.patterns == 1);
    run.input.mode = Mode::Idle;
    run_until(&mut run, |run| run.output.state == State::Idle);
    assert_eq!((run.output.bank.status, run.output.learn.done), (BankStatus::Learned, false));
    // the export is reported until the bank changes again
    run.input.mode = Mode::Export;
    run.step();
    assert!(run.controller.take_export());
    run.output.bank.status = BankStatus::Exported;
    run.step();
    assert_eq!(run.output.bank.status, BankStatus::Exported);
}

#[test]
fn a_bank_that_learning_has_not_changed_before_it_was_aborted_is_still_that_of_a_file() {
    let mut p = Parameters::START;
    p.learn.from_bank = true;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    assert!(run.finish(Mode::Learn) && run.controller.take_export());
    run.output.bank.status = BankStatus::Exported;
    for mode in [Mode::Idle, Mode::Learn] {
        run.input.mode = mode;
        run.step();
    }
    assert_eq!(run.output.state, State::Approach);
    run.input.mode = Mode::Idle;
    run_until(&mut run, |run| run.output.state == State::Idle);
    assert_eq!((run.output.bank.status, run.output.learn.done), (BankStatus::Exported, false));
}

#[test]
fn time_at_an_override_of_zero_does_not_count_but_when_it_learns() {
    let cycle = |mode: Mode, ratio: f64, hold: bool| {
        let mut p = Parameters::START;
        p.limits.cycle_time = 1.0;
        let mut run = Loop::new(&p, &Build::NOMINAL);
        run.step();
        (run.input.mode, run.input.speed_override, run.input.hold) = (mode, ratio, hold);
        let ended = (0..300).position(|_| {
            run.step();
            run.output.fault == Fault::NoProgress
        });
        (ended.is_some(), ended.is_none_or(|samples| (100..=102).contains(&samples)))
    };
    // learning has its own speeds
    for (mode, ratio, hold, ends) in [
        (Mode::DryRun, 0.0, false, false),
        (Mode::DryRun, 0.01, false, true),
        (Mode::DryRun, 1.0, true, false),
        (Mode::Learn, 0.0, false, true),
        (Mode::Learn, 1.0, true, false),
    ] {
        assert_eq!(cycle(mode, ratio, hold), (ends, true), "{mode:?} {ratio} {hold}");
    }
}

#[test]
fn the_outputs_of_an_axis_are_the_servo_law_in_its_units() {
    let mut p = Parameters::START;
    p.bank.compute = true;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    run.step();
    run.input.mode = Mode::Playback;
    run_until(&mut run, |run| run.output.path.distance > 0.05);
    for _ in 0..50 {
        run.step();
        for (i, axis) in run.output.axis.iter().enumerate() {
            let velocity = p.servo_gain[i] * (axis.error + axis.compensation);
            assert!((axis.velocity - velocity).abs() < 1e-12, "axis {}: {axis:?}", i + 1);
            // both are whole counts
            let read = run.input.axis[i].position;
            assert!((axis.reference - axis.error - read).abs() <= p.axis[i].pulse, "axis {}: {axis:?}", i + 1);
        }
        assert!(run.output.axis[0].compensation.abs() > 1e-4);
    }
}

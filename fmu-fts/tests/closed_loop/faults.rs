//! Faults: the named fault, its reaction, finite outputs, with any input.

use control_blocks::Reaction;
use fmu_fts::controller::Controller;
use fmu_fts::interface::{Fault, Input, Mode, Output, Parameters, State};
use fmu_fts::texts::Tables;
use rand::{RngExt, SeedableRng};

use crate::machine::{Build, RPM};
use crate::run::Loop;

fn finite(o: &Output) -> bool {
    let reals = [
        o.torque,
        o.reference.depth,
        o.reference.angle,
        o.error.tracking,
        o.error.rms,
        o.error.peak,
        o.spindle_speed,
        o.path_torque,
        o.response.bandwidth,
    ];
    reals.iter().chain(&o.error.harmonic).all(|x| x.is_finite())
}

/// Checks the fault, that it stays until it is reset, that nothing moves by itself then, and that everything works again;
/// without `torque` there is none.
fn recovers(mut run: Loop, fault: Fault, torque: bool) {
    // an arm that moves is braked before its drive is off
    let braked = run.time() + 0.01;
    while run.output.drive_enable && fault.reaction() == Reaction::DriveOff && run.time() < braked {
        run.step();
    }
    for _ in 0..100 {
        assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
        assert_eq!(run.output.drive_enable, fault.reaction() != Reaction::DriveOff);
        assert!(torque || run.output.torque == 0.0);
        assert!(finite(&run.output));
        run.step();
    }
    // a reset during the retract would be lost
    run.run_to(run.time() + if torque { 0.6 } else { 0.0 });
    reset(&mut run);
    for _ in 0..100 {
        assert_eq!((run.output.state, run.output.fault, run.output.torque), (State::Idle, Fault::None, 0.0));
        assert!(run.output.drive_enable);
        run.step();
    }
    // another mode, or the same enabled again
    run.input.enable = run.input.mode != Mode::Hold;
    run.step();
    assert_eq!(run.output.state, State::Idle);
    (run.input.enable, run.input.mode) = (true, Mode::Hold);
    run.run_to(run.time() + 0.6);
    assert_eq!((run.output.state, run.output.fault), (State::Hold, Fault::None));
}

/// A rising edge of `reset_fault`.
fn reset(run: &mut Loop) {
    for level in [false, true] {
        run.input.reset_fault = level;
        run.step();
    }
}

#[test]
fn only_a_rising_edge_resets_a_fault() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 4);
    run.input.reset_fault = true;
    run.run_to(0.02);
    (0..5).for_each(|_| run.step_with(|input| input.slide_position = f64::NAN));
    for k in 0..100 {
        // neither the level, nor another mode, nor the switch
        run.input.mode = if k < 50 { Mode::Idle } else { Mode::Hold };
        run.input.enable = k % 20 < 10;
        run.step();
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::SlideLost));
    }
    run.run_to(0.5);
    reset(&mut run);
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
}

#[test]
fn a_communication_step_that_is_too_long_is_detected_in_its_first_sample() {
    for before in [0.0, 0.5] {
        let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 4);
        run.run_to(before);
        run.controller.begin_long_step();
        run.step();
        // of several commands the last alone would be seen: no pulse of the brake
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::LongStep));
        assert_eq!((run.output.torque, run.output.drive_enable), (0.0, false));
        reset(&mut run);
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    }
}

#[test]
fn a_fault_that_persists_is_raised_again_with_the_next_task() {
    let fast = Build { speed: |_| 2400.0 * RPM, ..Build::NOMINAL };
    let mut run = Loop::new(&Parameters::START, &fast, 4);
    run.run_to(0.01);
    assert_eq!(run.output.fault, Fault::Infeasible);
    reset(&mut run);
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    for enable in [false, true] {
        run.input.enable = enable;
        run.step();
    }
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::Infeasible));
}

#[test]
fn an_infeasible_path_is_rejected_before_anything_moves() {
    let fast = Build { speed: |_| 2400.0 * RPM, ..Build::NOMINAL };
    let mut run = Loop::new(&Parameters::START, &fast, 4);
    for _ in 0..100 {
        run.step();
        assert!(run.output.torque.abs() < 1e-9, "{}", run.output.torque);
    }
    assert!((run.output.path_torque - 13.85).abs() < 0.05, "{}", run.output.path_torque);
    recovers(run, Fault::Infeasible, false);
}

#[test]
fn a_path_that_becomes_infeasible_is_left_before_the_arm_runs_away() {
    let ramp = |t: f64| (1200.0 + 1200.0 * (t - 1.0).clamp(0.0, 1.0)) * RPM;
    let mut run = Loop::new(&Parameters::START, &Build { speed: ramp, ..Build::NOMINAL }, 4);
    while run.output.fault == Fault::None {
        assert!(run.time() < 2.0);
        assert!(run.output.error.tracking.abs() < 100e-6);
        run.step();
    }
    let (depth, mut deepest) = (run.machine.tip_depth(), f64::NEG_INFINITY);
    let mut out = run.clone();
    while out.time() < run.time() + 0.6 {
        out.step();
        deepest = deepest.max(out.machine.tip_depth());
    }
    // 1.75 mm of path about the middle, and 1 mm out of the part
    assert!(deepest < depth + 3.6e-3 && out.machine.tip_depth() < deepest - 2.5e-3, "{deepest} {depth}");
    recovers(run, Fault::Infeasible, true);
}

#[test]
fn outside_the_table_is_a_fault() {
    for radius in [0.0505, -0.0002] {
        let run = Build { radius, ..Build::NOMINAL };
        let mut run = Loop::new(&Parameters::START, &run, 4);
        run.run_to(0.01);
        recovers(run, Fault::OutsideTable, false);
    }
}

#[test]
fn an_arm_that_does_not_follow_is_a_fault() {
    // the path without its feedforward: feedback alone is 9 % off
    let mut p = Parameters::START;
    p.limits.following_error = 120e-6;
    // without the thrust that takes away an arm that is let go
    let mut run = Loop::new(&p, &Build { cutting: [0.0, 0.1, 0.03], ..Build::NOMINAL }, 4);
    run.run_to(1.0);
    run.input.feedforward_enable = false;
    run.input.afc_enable = false;
    while run.output.fault == Fault::None {
        assert!(run.time() < 1.5);
        run.step();
    }
    assert!(run.output.error.tracking.abs() < 150e-6);
    // the error is reported until the fault is reset
    for _ in 0..200 {
        run.step();
        assert!(run.output.drive_enable || run.output.error.tracking.abs() > 120e-6, "{}", run.output.error.tracking);
    }
    assert!(!run.output.drive_enable);
    recovers(run, Fault::FollowingError, false);
}

#[test]
fn nonsense_is_bridged_and_then_a_fault_in_every_state() {
    type Location = fn(&mut Input) -> &mut f64;
    // and whether a held arm needs it
    let changes: [(Location, Fault, bool); 4] = [
        (|i| &mut i.arm_angle, Fault::PositionLost, true),
        (|i| &mut i.spindle_angle, Fault::SpindleLost, false),
        (|i| &mut i.slide_position, Fault::SlideLost, false),
        (|i| &mut i.hold_angle, Fault::InvalidInput, true),
    ];
    for mode in &Mode::ALL[1..] {
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            for (change, fault, held) in changes {
                let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 4);
                run.input.mode = *mode;
                run.run_to(0.02);
                for _ in 0..Parameters::START.limits.lost_samples {
                    run.step_with(|input| *change(input) = nonsense);
                    assert_eq!(run.output.fault, Fault::None, "{mode:?}");
                }
                run.step_with(|input| *change(input) = nonsense);
                let faulty = held || matches!(mode, Mode::Approach | Mode::Track);
                assert_eq!(run.output.fault, if faulty { fault } else { Fault::None }, "{mode:?}");
                if faulty {
                    run.step();
                    recovers(run, fault, fault != Fault::PositionLost);
                }
            }
        }
    }
}

#[test]
fn bad_inputs_never_give_nan() {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(5);
    let mut p = Parameters::START;
    p.limits.following_error = 0.1;
    let mut controller = Controller::new(&p, &Tables::default()).unwrap();
    let (mut input, mut output) = (Input { enable: true, ..Input::START }, Output::START);
    for _ in 0..100_000 {
        let mut wild = |usual: f64| match random.random_range(0..200) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -1e308,
            3 => 1e9,
            4..20 => 1e3 * random.random_range(-1.0..1.0),
            _ => usual + 1e-3 * random.random_range(-1.0..1.0),
        };
        input.arm_angle = wild(output.reference.angle);
        input.spindle_angle = wild(input.spindle_angle + 6e-3);
        input.slide_position = wild(0.04);
        input.hold_angle = wild(0.0);
        input.probe_depth = wild(0.0);
        input.probe_lateral = wild(0.0);
        for switch in [
            &mut input.enable,
            &mut input.reset_fault,
            &mut input.afc_enable,
            &mut input.feedforward_enable,
            &mut input.probe_capture,
            &mut input.calibration_solve,
        ] {
            *switch ^= random.random_range(0..50) == 0;
        }
        if random.random_range(0..100) == 0 {
            input.mode = Mode::ALL[random.random_range(0..Mode::ALL.len())];
        }
        controller.tick(&input, &p, &mut output);
        assert!(finite(&output), "{input:?} {output:?}");
        assert!(output.torque.abs() <= p.servo.torque_max);
    }
}

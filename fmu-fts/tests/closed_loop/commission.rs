//! The state `Commission`: its results on unmeasured machines, and its bounds.

use std::f64::consts::TAU;

use fmu_fts::interface::{Fault, Input, Mode, Parameters, State};
use rand::{RngExt, SeedableRng};

use crate::machine::{Build, RPM};
use crate::run::Loop;

/// Longest commission, s.
const LIMIT: f64 = 20.0;
/// The spindle is at rest, and the tool is in air.
const AT_REST: Build = Build { speed: |_| 0.0, cutting: [0.0; 3], ..Build::NOMINAL };
/// An arm with off-nominal inertia, stiffness and delay.
const OTHER: Build = Build { gain: 0.75, flexure: 1000.0, damping: 0.016, coulomb: 0.012, delay: 2, ..AT_REST };

/// Requests only a commissioning run.
fn ask(input: &mut Input) {
    (input.enable, input.mode, input.commission) = (false, Mode::Idle, true);
}

/// Asks for nothing.
fn rest(input: &mut Input) {
    (input.enable, input.mode) = (false, Mode::Idle);
}

/// Steps into the commissioning run, and `time` s on.
fn begin(run: &mut Loop, time: f64) {
    (0..200).for_each(|_| run.step_with(rest));
    run.step_with(ask);
    assert_eq!(run.output.state, State::Commission, "{:?}", run.output);
    let until = run.time() + time;
    while run.time() < until {
        run.step_with(ask);
    }
}

/// Runs until the commissioning run is over; the largest travel of the tool (m) and the largest torque (N.m).
fn commission(run: &mut Loop) -> [f64; 2] {
    begin(run, 0.0);
    let (start, mut maximum) = (run.machine.tip_depth(), [0.0f64; 2]);
    while run.output.state == State::Commission {
        maximum = [maximum[0].max((run.machine.tip_depth() - start).abs()), maximum[1].max(run.output.torque.abs())];
        run.step_with(ask);
        assert!(run.time() < LIMIT, "{:?}", run.output);
    }
    maximum
}

/// A machine within 30 % of nominal: inertia and drive gain, of which the ratio matters.
fn unknown(seed: u64) -> Build {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut within = || random.random_range(0.7..1.3);
    Build {
        gain: within() / within(),
        flexure: 1200.0 * within(),
        damping: 0.02 * within(),
        coulomb: 0.01 * within(),
        delay: (seed % 3) as usize,
        ..AT_REST
    }
}

fn applied() -> Parameters {
    let mut p = Parameters::START;
    p.commission.apply = true;
    p
}

#[test]
fn unknown_machines_are_measured_within_their_deviations() {
    for seed in 70..79 {
        let build = unknown(seed);
        let mut run = Loop::new(&Parameters::START, &build, seed);
        let [travel, torque] = commission(&mut run);
        let m = &run.output.measured;
        assert_eq!((run.output.state, run.output.fault, m.valid), (State::Idle, Fault::None, true), "{seed}: {m:?}");
        assert!(travel < 1.75e-3 && torque < 1.4, "{seed}: {travel} {torque}");
        let [inertia, viscous, dry] = [8e-4, 2e-3, build.coulomb].map(|of| of / build.gain);
        let (delay, frequency) = (build.delay as f64, TAU * build.flexure);
        // measured value and its standard deviation, the ground truth, and the largest error and standard deviation
        for (measured, actual, maximum) in [
            ([m.inertia, m.inertia_std], inertia, [1e-3 * inertia, 2e-3 * inertia]),
            ([m.viscous_friction, m.viscous_friction_std], viscous, [0.03 * viscous, 0.5 * viscous]),
            ([m.dry_friction, m.dry_friction_std], dry, [0.01 * dry, 0.1 * dry]),
            ([m.io_delay, m.io_delay_std], delay, [0.005, 0.02]),
            ([m.tip_frequency, m.tip_frequency_std], frequency, [5e-3 * frequency, 0.015 * frequency]),
            ([m.tip_inertia, m.tip_inertia_std], 0.4375, [0.01, 0.05]),
            ([m.tip_damping, m.tip_damping_std], build.damping, [2e-3, 0.02]),
        ] {
            let error = (measured[0] - actual).abs();
            assert!(
                error < maximum[0] && error < measured[1] && measured[1] < maximum[1],
                "{seed}: {measured:?}, {actual}"
            );
        }
    }
}

#[test]
fn what_was_measured_is_used_on_request_and_the_lens_is_then_cut_as_ever() {
    for apply in [false, true] {
        let mut p = applied();
        p.commission.apply = apply;
        let mut run = Loop::new(
            &p,
            &Build { cutting: [2.0, 0.1, 0.03], speed: |t| if t < 11.0 { 0.0 } else { 600.0 * RPM }, ..OTHER },
            83,
        );
        commission(&mut run);
        let m = run.output.measured;
        let folder = tempfile::tempdir().unwrap();
        let mut named = p.clone();
        named.commission.export = folder.path().join("found.json").to_str().unwrap().into();
        run.controller.export(&named).unwrap();
        let text = std::fs::read_to_string(&named.commission.export).unwrap();
        assert!(text.contains(&format!("\"servo.inertia\": {:e},", m.inertia)), "{text}");
        run.step_with(rest);
        assert_eq!(run.parameters.servo.inertia, if apply { m.inertia } else { 8e-4 });
        assert_eq!((run.parameters.io_delay, run.parameters.tip == p.tip), if apply { (2, false) } else { (1, true) });
        assert_eq!(run.parameters.servo.bandwidth, p.servo.bandwidth);
        let expected = if apply { m.tip_frequency } else { p.tip.frequency };
        assert_eq!(run.output.response.tip_frequency, expected);
        while run.time() < 11.2 {
            run.step_with(rest);
        }
        (run.input.enable, run.input.mode) = (true, Mode::Track);
        run.run_to(15.0);
        let measured = run.measure(0.5);
        println!("{apply}: {measured:.3?}, drive ratio {:.2}", run.output.path_torque_ratio);
        assert_eq!((run.output.state, run.output.fault), (State::Track, Fault::None));
        assert!(measured.rms < 0.6, "{apply}: {measured:?}");
        // the torque that the path takes is now the one that is expected
        assert_eq!((run.output.path_torque_ratio - 1.0).abs() < 0.05, apply, "{}", run.output.path_torque_ratio);
    }
}

#[test]
fn a_delay_that_is_no_whole_number_of_samples_costs_the_bandwidth_that_it_must() {
    // 0.4 samples of delay in the current loop, configured or not: the loop is the same
    let bandwidths = [2000.0, 4000.0].map(|hertz| {
        let mut p = applied();
        (p.servo.current_bandwidth, p.commission.sensitivity_max) = (TAU * hertz, 1.45);
        let mut run = Loop::new(&p, &AT_REST, 95);
        commission(&mut run);
        run.step_with(rest);
        assert_eq!((run.output.measured.valid, run.parameters.io_delay), (true, 1), "{:?}", run.output.measured);
        run.parameters.servo.bandwidth
    });
    // not more, and one or two of the steps of 4 % less
    let ratio = bandwidths[1] / bandwidths[0];
    assert!((0.9..=1.0).contains(&ratio), "{ratio}");
}

#[test]
fn it_is_aborted_into_rest_and_the_configured_values() {
    type Break = fn(&mut Input);
    let actions: [Break; 3] = [
        |input| input.commission = false,
        |input| (input.enable, input.commission) = (true, true),
        |input| (input.enable, input.mode, input.commission) = (true, Mode::Track, true),
    ];
    let p = applied();
    for time in [0.005, 0.4, 3.0, 7.0] {
        for action in actions {
            let mut run = Loop::new(&p, &OTHER, 84);
            begin(&mut run, time);
            let quiet = |input: &mut Input| {
                rest(input);
                action(input);
            };
            run.step_with(quiet);
            assert!(matches!(run.output.state, State::Retract | State::Idle), "{time}: {:?}", run.output.state);
            // an oscillation fades in its glide, and nothing starts again without a new edge
            (0..3000).for_each(|_| run.step_with(quiet));
            assert_eq!((run.output.state, run.output.fault, run.output.torque), (State::Idle, Fault::None, 0.0));
            assert!(!run.output.measured.valid);
            assert_eq!(run.parameters, p);
        }
    }
}

#[test]
fn it_never_starts_by_itself_and_no_task_starts_after_it() {
    let mut run = Loop::new(&Parameters::START, &AT_REST, 85);
    for _ in 0..1000 {
        // true from the first sample on is no edge
        run.step_with(ask);
        assert_eq!(run.output.state, State::Idle);
    }
    // the arm holds, and a commissioning run waits for `Idle`
    let hold = |input: &mut Input| (input.enable, input.mode, input.commission) = (true, Mode::Hold, true);
    run.step_with(|input| (input.enable, input.mode) = (true, Mode::Hold));
    (0..100).for_each(|_| run.step_with(hold));
    assert_eq!(run.output.state, State::Hold);
}

#[test]
fn it_starts_from_done_and_the_task_before_does_not_start_again() {
    let mut run = Loop::new(&Parameters::START, &Build { cutting: [0.0; 3], ..Build::NOMINAL }, 86);
    run.run_to(0.6);
    assert_eq!(run.output.state, State::Track);
    run.feed(0.2);
    while run.output.state == State::Track {
        run.step();
    }
    run.feed(0.0);
    run.run_to(run.time() + 0.5);
    assert_eq!(run.output.state, State::Done);
    let still_requested = |input: &mut Input| input.commission = true;
    run.step_with(still_requested);
    assert_eq!(run.output.state, State::Commission);
    (0..20_000).for_each(|_| run.step_with(still_requested));
    assert_eq!(run.output.state, State::Commission, "{:?}", run.output.fault);
    (0..5000).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    // another task does
    run.input.mode = Mode::Hold;
    run.step();
    assert_eq!(run.output.state, State::Hold);
}

#[test]
fn another_commission_finds_the_same_again() {
    let mut run = Loop::new(&applied(), &OTHER, 87);
    commission(&mut run);
    let first = run.output.measured;
    let start = run.time();
    (0..1000).for_each(|_| run.step_with(rest));
    run.step_with(ask);
    while run.output.state == State::Commission {
        assert!(run.time() < start + LIMIT, "{:?}", run.output);
        run.step_with(ask);
    }
    let second = run.output.measured;
    assert!(second.valid, "{second:?}");
    assert!((second.inertia / first.inertia - 1.0).abs() < 1e-4, "{first:?} {second:?}");
    assert!((second.tip_frequency / first.tip_frequency - 1.0).abs() < 2e-3, "{first:?} {second:?}");
}

#[test]
fn an_uncertain_or_unsuitable_result_is_rejected_with_its_values() {
    let unsure = |p: &mut Parameters| p.commission.std_max = 1e-6;
    let stiff = |p: &mut Parameters| p.commission.sensitivity_max = 1.3;
    type Change = fn(&mut Parameters);
    let cases: [(Change, Build); 6] = [
        (|p| p.commission.delay_std_max = 0.001, AT_REST),
        (|_| (), Build { delay: 4, ..AT_REST }),
        (unsure, AT_REST),
        (stiff, OTHER),
        (|_| (), Build { gain: 0.47, ..AT_REST }),
        (|_| (), Build { flexure: 1750.0, ..AT_REST }),
    ];
    for (change, build) in cases {
        let mut p = applied();
        change(&mut p);
        let mut run = Loop::new(&p, &build, 88);
        commission(&mut run);
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::CommissionRejected), "{build:?}");
        let m = &run.output.measured;
        assert!(!m.valid && (m.inertia * build.gain / 8e-4 - 1.0).abs() < 0.01, "{build:?}: {m:?}");
        (0..10_000).for_each(|_| run.step_with(rest));
        assert_eq!(run.parameters, p);
        assert!(run.output.drive_enable && run.output.torque == 0.0);
        run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    }
}

#[test]
fn a_drive_that_is_lost_or_turns_round_is_found_before_the_arm_has_gone_far() {
    // a lost drive is found by the error that it leaves, with its name, and by nothing where the tones are smaller than
    // the error that is a fault
    for (time, faults) in [
        (0.3, [(0.0, Fault::WeakDrive), (-1.0, Fault::DriveSign)]),
        (2.6, [(0.0, Fault::WeakDrive), (-1.0, Fault::DriveSign)]),
        (6.0, [(0.0, Fault::CommissionRejected), (-1.0, Fault::DriveSign)]),
    ] {
        for (gain, fault) in faults {
            let mut run = Loop::new(&applied(), &AT_REST, 89);
            begin(&mut run, 0.0);
            let depth = run.machine.tip_depth();
            begin_over(&mut run, time);
            run.machine.set_gain(gain);
            while run.output.state == State::Commission {
                run.step_with(ask);
                assert!(run.time() < LIMIT, "{:?}", run.output);
            }
            assert_eq!(run.output.fault, fault, "{time} {gain}");
            // the message shows the evaluated ratio
            assert!(fault == Fault::CommissionRejected || run.output.numbers.drive_ratio < 0.4, "{time} {gain}");
            // its travel of 1.75 mm and the following error of 1 mm
            let travel = (run.machine.tip_depth() - depth).abs();
            assert!(travel < 2.75e-3, "{time} {gain}: {travel}");
        }
    }
}

/// Continues a commissioning run for `time` s.
fn begin_over(run: &mut Loop, time: f64) {
    let until = run.time() + time;
    while run.time() < until {
        run.step_with(ask);
    }
    assert_eq!(run.output.state, State::Commission);
}

#[test]
fn state_bytes_continue_a_commission_bit_for_bit() {
    for time in [0.01, 4.0, 9.9] {
        let mut run = Loop::new(&applied(), &OTHER, 90);
        begin(&mut run, time);
        let mut copy = run.reloaded();
        while run.output.state == State::Commission {
            run.step_with(ask);
            copy.step_with(ask);
            assert_eq!(copy.output, run.output);
        }
        assert!(run.output.measured.valid);
    }
}

#[test]
fn a_lost_reading_now_and_then_does_not_matter_and_a_lost_encoder_ends_it() {
    let mut run = Loop::new(&Parameters::START, &OTHER, 91);
    begin(&mut run, 0.0);
    let mut k = 0;
    while run.output.state == State::Commission {
        k += 1;
        run.step_with(|input| {
            ask(input);
            if k % 100 == 0 {
                input.arm_angle = f64::NAN;
            }
        });
    }
    assert!(run.output.measured.valid, "{:?}", run.output);
    let m = &run.output.measured;
    assert!((m.inertia * OTHER.gain / 8e-4 - 1.0).abs() < 1e-3 && (m.io_delay - 2.0).abs() < 0.01, "{m:?}");
    assert!((m.tip_frequency / (TAU * OTHER.flexure) - 1.0).abs() < 5e-3, "{m:?}");
    let mut run = Loop::new(&Parameters::START, &OTHER, 92);
    begin(&mut run, 3.0);
    for _ in 0..10 {
        run.step_with(|input| {
            ask(input);
            input.arm_angle = f64::NAN;
        });
    }
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::PositionLost, false));
}

#[test]
fn a_frozen_encoder_ends_the_run_where_oscillations_are_small() {
    let mut run = Loop::new(&Parameters::START, &OTHER, 94);
    begin(&mut run, 6.0);
    let (held, begin) = (run.input.arm_angle, run.time());
    while run.output.state == State::Commission {
        run.step_with(|input| {
            ask(input);
            input.arm_angle = held;
        });
    }
    assert_eq!(run.output.fault, Fault::CommissionRejected);
    assert!(run.time() - begin < 1.25, "{}", run.time() - begin);
}

#[test]
fn a_rigid_arm_stays_rigid() {
    let mut p = applied();
    (p.tip.frequency, p.tip.inertia) = (0.0, 0.0);
    let build = Build { flexure: 20_000.0, gain: 0.8, ..AT_REST };
    let mut run = Loop::new(&p, &build, 93);
    commission(&mut run);
    let m = &run.output.measured;
    assert_eq!((run.output.fault, m.valid, m.tip_frequency), (Fault::None, true, 0.0), "{m:?}");
    assert!((m.inertia * build.gain / 8e-4 - 1.0).abs() < 0.01 && (m.io_delay - 1.0).abs() < 0.1, "{m:?}");
}

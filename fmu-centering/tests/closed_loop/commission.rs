//! The state `Commission`: results on unknown machines, and the bounds of the motion.

use std::f64::consts::TAU;

use fmu_centering::interface::{Fault, Input, Parameters, State};
use rand::{RngExt, SeedableRng};

use crate::ring::{NOMINAL, Ring, Servo};
use crate::run::Loop;

const P: Parameters = Parameters::START;

/// Requests only a commissioning run.
fn ask(input: &mut Input) {
    (input.enable, input.commission) = (false, true);
}

/// Requests nothing.
fn rest(input: &mut Input) {
    input.enable = false;
}

/// A machine with this servo.
fn machine(p: &Parameters, servo: Servo) -> Loop {
    let mut ring = Ring::new(3, 3e-4, 1.0);
    ring.servo = Some(servo);
    Loop::new(p, ring)
}

/// Steps into the commissioning run, and `time` s on.
fn begin(run: &mut Loop, time: f64) {
    run.step_with(rest);
    run.step_with(ask);
    assert_eq!(run.output.state, State::Commission, "{:?}", run.output);
    let until = run.time() + time;
    while run.time() < until {
        run.step_with(ask);
    }
}

/// Runs until the end of the commissioning run; travel of the slide, back and towards the ring, m.
fn commission(run: &mut Loop) -> [f64; 2] {
    begin(run, 0.0);
    let start = run.ring.slide();
    let mut reach = [0.0f64; 2];
    while run.output.state == State::Commission {
        run.step_with(ask);
        let position = run.ring.slide() - start;
        reach = [reach[0].min(position), reach[1].max(position)];
        assert!(run.time() < 30.0, "{:?}", run.output);
    }
    reach
}

/// An off-nominal servo: bandwidth within 30 %, any delay from 0 to 2, other damping, with integral action or without.
fn unknown(seed: u64) -> Servo {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    Servo {
        frequency: random.random_range(28.0..52.0),
        damping: random.random_range(0.4..1.0),
        integral: if random.random_bool(0.5) { random.random_range(2.0..20.0) } else { 0.0 },
        delay: random.random_range(0..3),
        ratio: 1.0,
        steps: 20,
    }
}

#[test]
fn unknown_machines_are_measured_and_the_slide_keeps_to_its_travel() {
    for seed in 0..16 {
        let servo = unknown(seed);
        let mut run = machine(&P, servo);
        let [back, ahead] = commission(&mut run);
        let m = &run.output.measured;
        assert_eq!((run.output.state, run.output.fault, m.valid), (State::Idle, Fault::None, true), "{servo:?}: {m:?}");
        // what samples of 1 ms do to a servo of 50 Hz
        assert!((m.slide_bandwidth / (TAU * servo.frequency) - 1.0).abs() < 0.01, "{servo:?}: {m:?}");
        assert!((m.slide_damping / servo.damping - 1.0).abs() < 0.02, "{servo:?}: {m:?}");
        assert!((m.slide_integral - servo.integral).abs() < 0.5 + 3.0 * m.slide_integral_std, "{servo:?}: {m:?}");
        assert!((m.io_delay - servo.delay as f64).abs() < 0.02 + 3.0 * m.io_delay_std, "{servo:?}: {m:?}");
        assert!(m.slide_bandwidth_std < 0.02 * m.slide_bandwidth && m.io_delay_std < 0.02, "{m:?}");
        // 1.6 mm and what the slide goes beyond its setpoint: 1.7 a / w^2 at the damping 0.4
        assert!(back > -1.8e-4 && ahead < 1.6e-3 + 1.8e-4, "{servo:?}: {back} to {ahead} m");
        assert!(run.time() < 10.0 && run.ring.gap() > 0.06, "{} s", run.time());
    }
}

#[test]
fn the_deviations_are_those_of_servos_that_compute_in_steps_of_their_own() {
    let mut errors: [Vec<f64>; 4] = Default::default();
    for seed in 40..70 {
        // all with an integral action, in steps of 0.1 ms
        let servo = Servo { steps: 1, integral: 2.0 + 0.6 * (seed - 40) as f64, ..unknown(seed) };
        let mut run = machine(&P, servo);
        commission(&mut run);
        let m = &run.output.measured;
        let found = [
            (m.slide_bandwidth - TAU * servo.frequency, m.slide_bandwidth_std),
            (m.slide_damping - servo.damping, m.slide_damping_std),
            (m.slide_integral - servo.integral, m.slide_integral_std),
            (m.io_delay - servo.delay as f64, m.io_delay_std),
        ];
        errors.iter_mut().zip(found).for_each(|(errors, (error, deviation))| errors.push(error / deviation));
    }
    // deviations that were three times too small or too large would show
    for (what, errors) in ["bandwidth", "damping", "integral", "delay"].iter().zip(errors) {
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        println!("{what}: {rms:.2} rms");
        assert!((0.5..1.5).contains(&rms) && errors.iter().all(|error| error.abs() < 4.0), "{what}: {rms} {errors:?}");
    }
}

#[test]
fn what_was_measured_is_used_on_request_and_kept_in_a_file() {
    for apply in [false, true] {
        let mut p = P;
        p.commission.apply = apply;
        let mut run = machine(&p, Servo { frequency: 28.0, delay: 2, ..NOMINAL });
        commission(&mut run);
        let in_force = run.in_force();
        let expected = if apply { (28.0, 2) } else { (40.0, 1) };
        assert!((in_force.slide.bandwidth / TAU / expected.0 - 1.0).abs() < 0.01 && in_force.io_delay == expected.1);
        let folder = tempfile::tempdir().unwrap();
        p.commission.export = folder.path().join("found.json").to_str().unwrap().into();
        run.controller.export(&p).unwrap();
        let file = std::fs::read_to_string(&p.commission.export).unwrap();
        let found = format!("\"slide.bandwidth\": {:e},", run.output.measured.slide_bandwidth);
        assert!(file.contains(&found) && file.contains("\"io_delay\": 2"), "{file} {found}");
        // without the result the ring is not centered sooner
        let measured = run.output.measured;
        run.step_with(rest);
        let centered = run.run_to(State::Centered, run.time() + 30.0);
        assert!(centered || !apply, "{:?}", run.output);
        assert!(!centered || run.ring.eccentricity() < 2.65e-6);
        // the approach identifies less
        assert_eq!(run.output.measured, measured);
    }
}

#[test]
fn it_is_aborted_by_commission_and_by_enable_into_rest_and_the_configured_values() {
    let mut p = P;
    p.commission.apply = true;
    for time in [0.01, 0.1, 1.0, 4.0] {
        for enable in [false, true] {
            let mut run = machine(&p, Servo { frequency: 30.0, ..NOMINAL });
            let start = run.output.slide.position_setpoint;
            begin(&mut run, time);
            let mut before = run.output.slide.velocity_setpoint;
            for k in 0..1000 {
                // nothing begins again without a new edge
                run.step_with(|input| (input.enable, input.commission) = (enable, enable));
                assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None), "{time} {enable} {k}");
                let speed = run.output.slide.velocity_setpoint;
                assert!((speed - before).abs() <= 2.56e-3 * 1.001, "{time}: {before} to {speed} m/s");
                before = speed;
            }
            assert!(before == 0.0 && (run.output.slide.position_setpoint - start).abs() < 1e-12);
            assert!(!run.output.measured.valid);
            assert_eq!(run.in_force(), p);
        }
    }
}

#[test]
fn a_good_one_that_is_followed_by_a_faulty_one_counts_no_more() {
    let mut p = P;
    p.commission.apply = true;
    let mut run = machine(&p, Servo { frequency: 30.0, ..NOMINAL });
    commission(&mut run);
    assert_ne!(run.in_force(), p);
    begin(&mut run, 1.0);
    run.step_with(rest);
    assert_eq!((run.in_force(), run.output.state), (p, State::Idle));
}

#[test]
fn it_never_begins_by_itself_and_waits_for_rest() {
    let mut run = machine(&P, NOMINAL);
    for _ in 0..1000 {
        // true from the first sample on is no edge
        run.step_with(ask);
        assert_eq!(run.output.state, State::Idle);
    }
    (0..300).for_each(|_| run.step_with(|input| input.commission = false));
    assert_eq!(run.output.state, State::Approach);
    // during the return an edge stays pending, and is discarded when it falls
    for waits in [true, false] {
        let mut run = run.clone();
        run.step_with(rest);
        run.step_with(ask);
        assert_eq!(run.output.state, State::Idle);
        run.step_with(|input| (input.enable, input.commission) = (false, waits));
        for _ in 0..2000 {
            run.step_with(|input| (input.enable, input.commission) = (false, waits));
            assert!(run.output.state == State::Idle || run.output.slide.velocity_setpoint.abs() < 0.07);
        }
        assert_eq!(run.output.state, if waits { State::Commission } else { State::Idle });
    }
}

#[test]
fn a_table_is_not_turned_for_it_and_a_ring_that_is_met_ends_it() {
    let mut run = machine(&Parameters { spindle_speed: 2.0, ..P }, NOMINAL);
    begin(&mut run, 1.0);
    assert_eq!(run.output.spindle_speed_setpoint, 0.0);
    for _ in 0..20 {
        run.step_with(|input| {
            ask(input);
            input.probe_position = 3e-4;
        });
    }
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::CommissionRejected));
}

#[test]
fn a_configured_bound_of_travel_and_of_acceleration_is_kept() {
    let mut p = P;
    (p.commission.travel, p.commission.acceleration) = (8e-4, 1.0);
    let mut run = machine(&p, Servo { frequency: 35.0, ..NOMINAL });
    begin(&mut run, 0.0);
    let (mut maximum, mut before) = (0.0f64, run.output.slide.velocity_setpoint);
    while run.output.state == State::Commission {
        run.step_with(ask);
        let setpoint = &run.output.slide;
        maximum = maximum.max(setpoint.position_setpoint);
        assert!(setpoint.position_setpoint >= -1e-12);
        assert!((setpoint.velocity_setpoint - before).abs() < 1.001e-3);
        before = setpoint.velocity_setpoint;
    }
    assert!((maximum / 8e-4 - 1.0).abs() < 1e-9, "{maximum}");
    assert!(run.output.measured.valid && (run.output.measured.slide_bandwidth / TAU / 35.0 - 1.0).abs() < 0.005);
}

#[test]
fn an_excitation_that_is_too_weak_is_rejected_with_its_numbers() {
    let mut p = P;
    p.commission.travel = 2e-7;
    let mut run = machine(&p, NOMINAL);
    commission(&mut run);
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::CommissionRejected));
    assert!(!run.output.measured.valid, "{:?}", run.output.measured);
    (0..1000).for_each(|_| run.step_with(rest));
    assert!(run.output.drive_enable && run.output.slide.velocity_setpoint == 0.0);
    run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    // rejected values do not remain next to those of the approach
    run.step_with(rest);
    run.step();
    assert_eq!(run.output.state, State::Approach);
    assert_eq!(run.output.measured.io_delay, 0.0);
}

#[test]
fn a_servo_that_is_not_the_one_that_was_meant_is_rejected() {
    for (frequency, configured) in [(40.0, 90.0), (40.0, 18.0)] {
        let mut p = P;
        p.slide.bandwidth = TAU * configured;
        let mut run = machine(&p, Servo { frequency, ..NOMINAL });
        commission(&mut run);
        assert_eq!(run.output.fault, Fault::CommissionRejected, "{configured}: {:?}", run.output);
        assert!((run.output.measured.slide_bandwidth / TAU / frequency - 1.0).abs() < 0.01);
        assert_eq!(run.in_force(), p);
    }
}

#[test]
fn a_servo_that_oscillates_or_creeps_is_rejected() {
    for (damping, fault) in
        [(0.2, Fault::CommissionRejected), (0.3, Fault::None), (1.8, Fault::None), (2.2, Fault::CommissionRejected)]
    {
        let mut run = machine(&P, Servo { damping, ..NOMINAL });
        commission(&mut run);
        assert_eq!(run.output.fault, fault, "{damping}: {:?}", run.output);
        // a servo that creeps shows little of it in strokes that reverse at the frequency of one that does not
        assert!((run.output.measured.slide_damping / damping - 1.0).abs() < 0.04, "{:?}", run.output.measured);
    }
}

#[test]
fn a_drive_that_is_lost_or_turns_round_is_found_immediately() {
    // in the first stroke there is no response before it; later the slide has moved half of its travel and stops or reverses
    for (time, lost, reversed) in [
        (0.0, &[Fault::PositionFrozen, Fault::WeakDrive][..], &[Fault::DriveSign][..]),
        (
            2.0,
            &[Fault::PositionFrozen, Fault::WeakDrive, Fault::FollowingError],
            &[Fault::DriveSign, Fault::FollowingError],
        ),
    ] {
        for (ratio, faults) in [(0.0, lost), (-1.0, reversed)] {
            let mut run = machine(&P, NOMINAL);
            begin(&mut run, time);
            let position = run.ring.slide();
            run.ring.servo = Some(Servo { ratio, ..NOMINAL });
            let until = run.time() + 1.0;
            while run.output.state == State::Commission && run.time() < until {
                run.step_with(ask);
            }
            assert!(faults.contains(&run.output.fault), "{time} {ratio}: {:?}", run.output);
            assert!(!run.output.drive_enable && (run.ring.slide() - position).abs() < 3e-3);
        }
    }
}

#[test]
fn a_round_with_a_lost_reading_is_done_again_and_too_many_end_it() {
    let lose = |every: u32| {
        let mut run = machine(&P, Servo { frequency: 33.0, ..NOMINAL });
        begin(&mut run, 0.0);
        let mut k = 0;
        while run.output.state == State::Commission {
            k += 1;
            run.step_with(|input| {
                ask(input);
                input.slide_position = if k % every == every / 2 { f64::NAN } else { input.slide_position };
            });
        }
        run
    };
    let few = lose(6000);
    assert!(few.output.measured.valid && (few.output.measured.slide_bandwidth / TAU / 33.0 - 1.0).abs() < 0.004);
    assert!(few.time() > 11.0, "{} s", few.time());
    let many = lose(1000);
    assert_eq!((many.output.fault, many.output.measured.valid), (Fault::NoProgress, false));
}

#[test]
fn every_other_reading_that_is_lost_ends_it_by_its_name() {
    type Spoil = fn(&mut Input);
    let spoils: [(Spoil, Fault); 4] = [
        (|input| input.slide_position = f64::NAN, Fault::PositionLost),
        (|input| input.slide_position += 0.01, Fault::PositionJump),
        (|input| input.probe_position = f64::NAN, Fault::ProbeLost),
        (|input| input.spindle_angle = f64::NAN, Fault::SpindleLost),
    ];
    for (spoil, fault) in spoils {
        let mut run = machine(&P, NOMINAL);
        begin(&mut run, 1.0);
        run.spoil(|input| {
            ask(input);
            spoil(input);
        });
        assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    }
}

#[test]
fn state_bytes_continue_a_commission_bit_for_bit() {
    let mut p = P;
    p.commission.apply = true;
    for time in [0.05, 2.9, 5.0] {
        let mut run = machine(&p, Servo { frequency: 45.0, ..NOMINAL });
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

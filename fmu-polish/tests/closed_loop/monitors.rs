//! Measurements and drives that fail in the middle of a cycle: the fault that is named, and how hard the tool presses
//! meanwhile.

mod ends;

use fmu_polish::axes::Axes;
use fmu_polish::interface::{Fault, Input, Parameters, State};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::robot::Build;
use crate::run::Loop;

const P: Parameters = Parameters::START;

/// Falsifies the inputs of a sample.
type Spoil = fn(&mut Input);

/// Reaction of the controller to falsified inputs.
#[derive(Debug)]
struct Failure {
    fault: Fault,
    /// time from the first falsified sample to the fault, s; NaN without a fault
    after: f64,
    /// largest true normal force from the first falsified sample to 0.5 s after the fault, N
    maximum: f64,
    drive_enable: bool,
}

/// A cycle in which `change` falsifies the inputs from 0.3 s after `state` was reached.
fn fails(p: &Parameters, build: Build, state: State, mut change: impl FnMut(&mut Input, u32)) -> Failure {
    let mut run = Loop::new(p, build, 500);
    assert!(run.run_to(state, 5.0), "{state:?}: {:?}", run.output);
    if state == State::Follow {
        (0..300).for_each(|_| run.step());
    }
    let (begin, mut maximum, mut after) = (run.time(), 0.0f64, None);
    for k in 0..40_000 {
        run.step_with(|input| change(input, k));
        maximum = maximum.max(run.robot.normal_force);
        if run.output.state == State::Fault {
            after = after.or(Some(run.time() - begin));
        }
        if run.output.state == State::Done || after.is_some_and(|after| run.time() > begin + after + 0.5) {
            break;
        }
    }
    let (fault, drive_enable) = (run.output.fault, run.output.drive_enable);
    assert!(fault == Fault::None || (run.output.pulses == Axes::all(0)), "{:?}", run.output);
    Failure { fault, after: after.unwrap_or(f64::NAN), maximum, drive_enable }
}

#[test]
fn a_constant_force_is_frozen_and_the_tool_leaves() {
    for (state, value, limit) in [
        (State::Idle, 0.0, 0.0),
        (State::Approach, 0.0, 8.0),
        (State::Settle, 1.0, 12.0),
        (State::Settle, 4.5, 12.0),
        (State::Follow, 5.0, 6.0),
        (State::Follow, 4.5, 14.0),
        (State::Follow, 4.0, 16.0),
        (State::Unload, 3.0, 8.0),
    ] {
        let p = P;
        let failure = fails(&p, Build::NOMINAL, state, |input, k| {
            input.force.z = value;
            // it ends the cycle
            input.enable = state != State::Unload || k == 0;
        });
        assert_eq!((failure.fault, failure.drive_enable), (Fault::ForceFrozen, true), "{state:?} {value}: {failure:?}");
        assert!(failure.maximum <= limit, "{state:?} {value}: {failure:?}");
    }
}

#[test]
fn a_force_constant_at_the_touch_that_then_jumps_ends_the_cycle() {
    // 0.2 mm of air are 0.4 s of the approach
    for (from, samples) in [(350, 120), (350, 200), (390, 60)] {
        let failure = fails(&P, Build::NOMINAL, State::Approach, |input, k| {
            if (from..from + samples).contains(&k) {
                input.force.z = 0.0;
            }
        });
        assert_eq!((failure.fault, failure.drive_enable), (Fault::ForceJump, true), "{from} {samples}: {failure:?}");
        assert!(failure.maximum < 0.178 * 0.5 * f64::from(samples), "{from} {samples}: {failure:?}");
    }
}

#[test]
fn a_last_bit_that_flickers_hides_no_frozen_force() {
    for (state, value, limit) in [(State::Settle, 1.0, 10.0), (State::Follow, 4.0, 18.0)] {
        let failure = fails(&P, Build::NOMINAL, state, |input, k| {
            input.force.z = value + if k % 7 < 3 { 0.178 } else { 0.0 };
        });
        assert_eq!(failure.fault, Fault::ForceFrozen, "{state:?} {value}: {failure:?}");
        assert!(failure.maximum <= limit, "{state:?} {value}: {failure:?}");
    }
}

#[test]
fn noise_about_a_frozen_force_hides_nothing() {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(516);
    // a signal that falls as slowly as the path may is detected by its friction: 0.2 of 16 N are 0.68 of the signal
    for (value, expected) in [(4.0, Fault::ForceFrozen), (4.5, Fault::InvalidPath)] {
        let failure = fails(&P, Build::NOMINAL, State::Follow, |input, _| {
            let noise: f64 = StandardNormal.sample(&mut random);
            input.force.z = value + 0.05 * noise;
        });
        assert_eq!(failure.fault, expected, "{value}: {failure:?}");
        assert!(failure.maximum <= 24.0, "{value}: {failure:?}");
    }
}

#[test]
fn a_force_that_is_gone_is_a_lost_contact_and_not_a_lean() {
    let failure = fails(&P, Build::NOMINAL, State::Follow, |input, _| input.force.z = 0.0);
    assert!(failure.fault == Fault::ContactLost && failure.maximum < 14.0, "{failure:?}");
}

#[test]
fn a_frozen_encoder_switches_the_drives_off() {
    for (state, axis) in [(State::Approach, 2), (State::Follow, 0), (State::Follow, 1)] {
        let mut held = None;
        let failure = fails(&P, Build::NOMINAL, state, |input, _| {
            let fields = [&mut input.position.x, &mut input.position.y, &mut input.position.z];
            *fields[axis] = *held.get_or_insert(*fields[axis]);
        });
        assert_eq!((failure.fault, failure.drive_enable), (Fault::PositionFrozen, false), "{axis}: {failure:?}");
        assert!(failure.maximum < 6.0 && failure.after < 1.0, "{axis}: {failure:?}");
    }
}

#[test]
fn wrong_drives_are_named_by_their_ratio() {
    for (pulses, expected) in [
        (Vector3::new(1.0, 1.0, -1.0), Fault::DriveSign),
        (Vector3::new(1.0, -1.0, 1.0), Fault::DriveSign),
        (Vector3::new(1.0, 1.0, 0.3), Fault::WeakDrive),
        (Vector3::new(0.3, 1.0, 1.0), Fault::WeakDrive),
        (Vector3::new(1.0, 1.0, 0.0), Fault::PositionFrozen),
        (Vector3::new(1.0, 0.0, 1.0), Fault::PositionFrozen),
    ] {
        let failure = fails(&P, Build { pulses, ..Build::NOMINAL }, State::Idle, |_, _| ());
        assert_eq!((failure.fault, failure.drive_enable), (expected, false), "{pulses:?}: {failure:?}");
        assert!(failure.maximum < 8.0, "{pulses:?}: {failure:?}");
    }
}

#[test]
fn one_bad_sample_moves_nothing_and_ends_nothing() {
    let spoil: [Spoil; 6] = [
        |input| input.force.z = f64::NAN,
        |input| input.force.z += 50.0,
        |input| input.force.z -= 8.0,
        |input| input.position.x += 0.3e-3,
        |input| input.position.z = f64::INFINITY,
        |input| input.feed_override = f64::NAN,
    ];
    for change in spoil {
        for state in [State::Idle, State::Approach, State::Settle, State::Follow] {
            let failure = fails(&P, Build::NOMINAL, state, |input, k| {
                if k % 400 == 50 {
                    change(input);
                }
            });
            assert!(failure.fault == Fault::None && failure.maximum < 6.0, "{state:?}: {failure:?}");
        }
    }
}

#[test]
fn what_stays_bad_is_lost_or_has_jumped() {
    // with valid positions the tool retracts without a force signal
    let cases: [(Fault, bool, Spoil); 5] = [
        (Fault::ForceLost, true, |input| input.force.y = f64::NAN),
        (Fault::ForceJump, true, |input| input.force.y = 90.0),
        (Fault::PositionLost, false, |input| input.position.z = f64::NAN),
        (Fault::PositionJump, false, |input| input.position.y += 20e-3),
        (Fault::FollowingError, false, |input| input.position.y += 0.15e-3),
    ];
    for (expected, driven, change) in cases {
        for state in [State::Approach, State::Settle, State::Follow] {
            let failure = fails(&P, Build::NOMINAL, state, |input, _| change(input));
            assert_eq!((failure.fault, failure.drive_enable), (expected, driven), "{state:?}: {failure:?}");
            assert!(failure.after < 0.01 && failure.maximum < 6.0, "{state:?}: {failure:?}");
        }
    }
}

#[test]
fn a_sensor_that_gives_nothing_before_the_cycle_is_reported_and_a_late_one_is_not() {
    let cases: [(Fault, Spoil); 2] = [
        (Fault::ForceLost, |input| input.force.x = f64::NAN),
        (Fault::PositionLost, |input| input.position.y = f64::NAN),
    ];
    for (expected, change) in cases {
        // `enable` rises in sample 3: the sensor is good two samples later, or never
        for (good, fault) in [(5, Fault::None), (u32::MAX, expected)] {
            let mut run = Loop::new(&P, Build::NOMINAL, 515);
            for k in 0..20 {
                run.step_with(|input| {
                    input.enable = k >= 3;
                    if k < good {
                        change(input);
                    }
                });
                let o = &run.output;
                assert_eq!(o.pulses, Axes::all(0), "{k}");
                // the samples before the request count too
                assert_eq!(o.fault, if k >= 5 { fault } else { Fault::None }, "{expected:?} in sample {k}");
            }
            if fault == Fault::None {
                assert!(run.run_to(State::Follow, 5.0));
            }
        }
    }
}

#[test]
fn an_override_that_is_no_number_takes_the_tool_out() {
    let failure = fails(&P, Build::NOMINAL, State::Follow, |input, _| input.force_override = f64::INFINITY);
    assert_eq!((failure.fault, failure.drive_enable), (Fault::InvalidInput, true));
}

#[test]
fn an_override_may_be_lost_for_the_configured_number_of_samples() {
    let mut run = Loop::new(&P, Build::NOMINAL, 514);
    assert!(run.run_to(State::Follow, 5.0));
    let lost = |input: &mut Input| input.feed_override = f64::NAN;
    for _ in 0..P.limits.lost_samples {
        run.step_with(lost);
        assert_eq!(run.output.state, State::Follow);
    }
    run.step_with(lost);
    assert_eq!(run.output.fault, Fault::InvalidInput);
}

#[test]
fn settling_has_its_whole_time() {
    let mut p = P;
    p.impedance.damping = 5e6;
    let mut run = Loop::new(&p, Build::NOMINAL, 515);
    assert!(run.run_to(State::Settle, 5.0));
    let begin = run.time();
    assert!(run.run_to(State::Fault, 10.0));
    assert_eq!(run.output.fault, Fault::SettleTimeout);
    // the sample after the last one of them
    let samples = ((run.time() - begin) / p.sample_period).round() as u32;
    assert_eq!(samples, 2002);
}

#[test]
fn an_encoder_that_drifts_is_a_following_error() {
    let failure = fails(&P, Build::NOMINAL, State::Follow, |input, k| input.position.y += 0.2e-6 * f64::from(k));
    assert_eq!(failure.fault, Fault::FollowingError, "{failure:?}");
    assert!(failure.after < 0.6, "{failure:?}");
}

#[test]
fn a_noisy_sensor_is_named_and_five_times_the_noise_is_not() {
    // a uniform distribution by the golden ratio, of deviation `size`
    let noise = |k: u32, size: f64| size * 12f64.sqrt() * ((f64::from(k) * 0.618_033_988_75).fract() - 0.5);
    for (size, expected) in [(1.0, Fault::NoisyForce), (0.25, Fault::None)] {
        let failure = fails(&P, Build::NOMINAL, State::Follow, |input, k| input.force.z += noise(k, size));
        assert_eq!(failure.fault, expected, "{size}: {failure:?}");
        assert!(failure.maximum < 8.0, "{size}: {failure:?}");
    }
}

#[test]
fn a_sensor_at_its_end_is_named() {
    let p = Parameters { sensor_range: 30.0, ..P };
    let mut force = 5.0;
    let failure = fails(&p, Build::NOMINAL, State::Follow, |input, _| {
        force = f64::min(force + 8.0, 30.0);
        input.force.x = force;
    });
    assert!(matches!(failure.fault, Fault::ForceLimit | Fault::Saturation), "{failure:?}");
}

#[test]
fn a_sensor_that_shows_a_third_is_a_wrong_stiffness() {
    let failure = fails(&P, Build::NOMINAL, State::Idle, |input, _| {
        input.force.z *= 0.35;
    });
    assert_eq!(failure.fault, Fault::WrongStiffness, "{failure:?}");
    assert!(failure.maximum < 5.5 / 0.35, "{failure:?}");
}

#[test]
fn another_mold_is_a_force_error() {
    let failure = fails(&P, Build { shift: Vector3::new(0.6e-3, 0.0, 0.0), ..Build::NOMINAL }, State::Idle, |_, _| ());
    assert!(failure.fault == Fault::ForceError && failure.maximum < 9.0, "{failure:?}");
}

/// The fault of a cycle in which the contact becomes `stiffer` times as stiff and the force comes `late` samples too late.
fn swinging(bandwidth: f64, stiffer: f64, late: usize) -> Fault {
    let mut p = P;
    p.impedance.bandwidth = bandwidth;
    let mut run = Loop::new(&p, Build::NOMINAL, 512);
    assert!(run.run_to(State::Follow, 5.0));
    (0..300).for_each(|_| run.step());
    run.robot.build.stiffness *= stiffer;
    let mut forces = vec![run.input.force; late];
    while run.output.state == State::Follow {
        run.step_with(|input| {
            forces.push(input.force);
            input.force = forces.remove(0);
        });
        assert!(run.robot.normal_force < P.limits.force, "{} N", run.robot.normal_force);
    }
    run.output.fault
}

#[test]
fn a_loop_that_oscillates_is_named_by_it_and_not_by_its_error() {
    for (bandwidth, stiffer, late) in [(35.0, 1.0, 40), (80.0, 1.0, 15), (80.0, 1.0, 20), (80.0, 3.0, 0)] {
        assert_eq!(swinging(bandwidth, stiffer, late), Fault::Oscillation, "{bandwidth} {stiffer} {late}");
    }
    // with its margin it tolerates both
    assert_eq!(swinging(35.0, 3.0, 0), Fault::None);
    assert_eq!(swinging(35.0, 1.0, 20), Fault::None);
}

#[test]
fn a_force_that_flickers_about_its_zero_on_the_approach_presses_no_harder_than_the_limit() {
    let mut run = Loop::new(&P, Build::NOMINAL, 513);
    assert!(run.run_to(State::Approach, 1.0));
    let (mut k, mut maximum) = (0, 0.0f64);
    while run.output.state == State::Approach {
        k += 1;
        run.step_with(|input| input.force.z = if k % 7 < 3 { 0.0 } else { -0.178 });
        maximum = maximum.max(run.robot.normal_force);
    }
    assert_eq!(run.output.fault, Fault::ApproachTimeout);
    assert!((20.0..P.limits.force).contains(&maximum), "{maximum} N");
}

#[test]
fn a_gain_that_is_tuned_to_oscillation_is_rejected_immediately() {
    let mut run = Loop::new(&P, Build::NOMINAL, 501);
    assert!(run.run_to(State::Follow, 5.0));
    run.parameters.impedance.gain = 20.0;
    run.step();
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::UnstableLoop));
    assert!(run.output.drive_enable);
}

#[test]
fn a_drive_is_not_evaluated_by_bridged_measurements() {
    let mut p = P;
    p.limits.lost_samples = 30;
    for axis in [0, 1] {
        let failure = fails(&p, Build::NOMINAL, State::Follow, |input, k| {
            // longer than half a period of the stick-slip
            if k % 400 < 25 {
                *[&mut input.position.x, &mut input.position.y][axis] = f64::NAN;
            }
        });
        assert!(failure.fault == Fault::None && failure.maximum < 6.0, "{axis}: {failure:?}");
    }
}

#[test]
fn the_motion_ratio_of_a_drive_and_the_time_of_a_cycle_are_reported() {
    let mut run = Loop::new(&P, Build { pulses: Vector3::new(1.0, 1.0, 0.3), ..Build::NOMINAL }, 510);
    assert!(run.run_to(State::Fault, 5.0));
    let ratio = run.output.numbers.ratio.unwrap();
    assert!(run.output.fault == Fault::WeakDrive && (0.2..0.4).contains(&ratio), "{ratio}");
    let mut p = P;
    p.limits.cycle_time = 1.5;
    let mut run = Loop::new(&p, Build::NOMINAL, 511);
    assert!(run.run_to(State::Fault, 5.0));
    let numbers = run.output.numbers;
    assert!(run.output.fault == Fault::NoProgress && numbers.time > numbers.time_limit, "{numbers:?}");
    assert!((numbers.time_limit - 1.5).abs() < 1e-9 && numbers.time < 1.51, "{numbers:?}");
}

//! Faulty positions: frozen, jumping, drifting; and the reported faults.

use std::f64::consts::TAU;

use fmu_dob::interface::{ContactSource, DetectorKind, Fault, Input, Parameters, State};
use fmu_dob::monitoring::numbers::Unseen;

use crate::run::{Loop, NO_WORKPIECE};

fn running(p: &Parameters, seed: u64, state: State) -> Loop {
    let mut run = Loop::new(p, seed, NO_WORKPIECE);
    assert!(run.run_to(state, 3.0), "{:?}", run.output);
    (0..50).for_each(|_| run.step());
    run
}

/// Steps with a changed input until a fault or a contact; returns the travel of the slide in that time, m.
fn until_fault(run: &mut Loop, samples: u32, mut change: impl FnMut(&mut Input)) -> f64 {
    let from = run.slide.position();
    let mut travel: f64 = 0.0;
    for _ in 0..samples {
        run.step_with(&mut change);
        travel = travel.max((run.slide.position() - from).abs());
        if run.output.state == State::Fault || run.output.contact {
            break;
        }
    }
    travel
}

#[test]
fn a_frozen_encoder_is_detected_before_it_looks_like_a_contact() {
    for &detector in DetectorKind::ALL {
        for speed in [1e-5, 3e-5, 1e-4, 1e-3] {
            for seed in 60..63 {
                let mut p = Parameters { detector, ..Parameters::START };
                p.approach.velocity = speed;
                let armed = running(&p, seed, State::Detect);
                for flicker in [0.0, 1e-9] {
                    let mut run = armed.clone();
                    let (mut held, mut k) = (None, 0);
                    let travel = until_fault(&mut run, 1000, |input| {
                        k += 1;
                        input.position = *held.get_or_insert(input.position) + flicker * f64::from(k % 2);
                    });
                    let outcome = (run.output.fault, run.output.contact, run.output.drive_enable);
                    assert_eq!(outcome, (Fault::PositionFrozen, false, false), "{detector:?} {speed} {flicker} {seed}");
                    // what it moves in the samples until then, and what it has been turned away
                    assert!(travel < 10.0 * speed * 1e-4 + 20e-9, "{detector:?} {speed} {flicker}: {travel} m");
                }
            }
        }
    }
}

#[test]
fn a_slow_stage_that_noise_stops_for_a_moment_is_neither_frozen_nor_a_contact() {
    let mut p = Parameters::START;
    p.approach.velocity = 1e-5;
    for seed in 60..66 {
        let mut run = running(&p, seed, State::Detect);
        // 7 of the 7.5 nm, and then the actual position
        let mut held = None;
        for _ in 0..8 {
            run.step_with(|input| input.position = *held.get_or_insert(input.position));
        }
        (0..2000).for_each(|_| run.step());
        let outcome = (run.output.state, run.output.fault, run.output.contact);
        assert_eq!(outcome, (State::Detect, Fault::None, false), "{seed}");
    }
}

#[test]
fn a_frozen_encoder_is_detected_while_learning_and_in_the_retract() {
    for state in [State::Approach, State::Learn, State::Retract] {
        let mut run = Loop::new(&Parameters::START, 64, 90e-6);
        assert!(run.run_to(state, 3.0));
        (0..400).for_each(|_| run.step());
        let mut held = None;
        for _ in 0..100 {
            run.step_with(|input| input.position = *held.get_or_insert(input.position));
        }
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::PositionFrozen), "{state:?}");
    }
}

#[test]
fn a_link_that_falls_behind_is_detected_as_late_and_another_jump_back_is_not() {
    for state in [State::Learn, State::Detect] {
        for seed in 70..73 {
            let armed = running(&Parameters::START, seed, state);
            for late in [3usize, 4, 10, 31] {
                let mut run = armed.clone();
                let mut sent = Vec::new();
                (0..40).for_each(|_| run.step_with(|input| sent.push(input.position)));
                until_fault(&mut run, 10, |input| {
                    sent.push(input.position);
                    input.position = sent[sent.len() - 1 - late];
                });
                assert_eq!(run.output.fault, Fault::PositionDelayed, "{state:?} {late}");
                assert_eq!((run.output.numbers.late_by, run.output.drive_enable), (late as u32, false));
                let mut run = armed.clone();
                // half a step off any measured value
                until_fault(&mut run, 10, |input| input.position -= 1e-8 * late as f64 + 0.5e-9);
                assert_eq!(run.output.fault, Fault::PositionJump, "{state:?} {late}");
            }
        }
    }
}

#[test]
fn an_encoder_in_another_unit_is_no_force() {
    for scale in [100.0, 1e3, 1e6] {
        for seed in 73..76 {
            let mut run = Loop::new(&Parameters::START, seed, NO_WORKPIECE);
            let travel = until_fault(&mut run, 100, |input| input.position *= scale);
            assert_eq!(run.output.fault, Fault::PositionJump, "{scale} {seed}");
            assert!(travel < 1e-6, "{scale} {seed}: {travel} m");
        }
    }
}

#[test]
fn a_stage_that_falls_is_no_reading_that_jumps() {
    let p = Parameters::START;
    let mut run = Loop::new(&p, 76, NO_WORKPIECE);
    let mut k = 0.0;
    // 98 N on 10 kg, more than half the drive
    until_fault(&mut run, 100, |input| {
        input.position += 0.5 * 9.8 * (k * p.sample_period).powi(2);
        k += 1.0;
    });
    assert!(matches!(run.output.fault, Fault::Overload | Fault::DriveSign), "{:?}", run.output);
}

#[test]
fn an_encoder_that_freezes_at_rest_is_detected_before_or_as_the_approach_begins() {
    // long before, just before, and with a last bit that flickers
    for (at, enable, flicker) in [(4000, 9000, 0.0), (4000, 4050, 0.0), (4000, 4050, 1e-9), (0, 300, 0.0)] {
        let mut run = Loop::new(&Parameters::START, 65, NO_WORKPIECE);
        let mut held = None;
        let mut from = None;
        for k in 0..10_000 {
            run.step_with(|input| {
                input.enable = k >= enable;
                if k >= at {
                    input.position = *held.get_or_insert(input.position) + flicker * f64::from(k % 2);
                }
            });
            if k >= at {
                from.get_or_insert(run.slide.position());
            }
            if run.output.state == State::Fault {
                break;
            }
        }
        let travel = (run.slide.position() - from.unwrap()).abs();
        println!("frozen at {at}, enabled at {enable}: moved {travel} m");
        assert_eq!(run.output.fault, Fault::PositionFrozen, "{at} {enable}");
    }
}

#[test]
fn an_encoder_that_freezes_as_the_stage_comes_to_rest_after_a_retract_is_detected() {
    let mut rested = Loop::new(&Parameters::START, 67, 90e-6);
    assert!(rested.run_to(State::Retract, 5.0), "{:?}", rested.output);
    let mut still = (f64::NAN, 0);
    while still.1 < 3 {
        let reference = rested.output.reference.position;
        rested.step();
        still = if rested.output.reference.position == still.0 {
            (reference, still.1 + 1)
        } else {
            (rested.output.reference.position, 0)
        };
    }
    for wait in [100, 200, 300, 500, 600, 1000, 1500] {
        let mut run = rested.clone();
        (0..wait).for_each(|_| run.step());
        let (mut held, from, mut after) = (None, run.slide.position(), 0);
        // a contact that is doubted first is outdone by it
        while run.output.fault != Fault::PositionFrozen && after < 400 {
            run.step_with(|input| input.position = *held.get_or_insert(input.position));
            after += 1;
        }
        let travel = (run.slide.position() - from).abs();
        assert_eq!((run.output.fault, run.output.drive_enable), (Fault::PositionFrozen, false), "{wait}: {travel}");
        assert!(after <= 302 && travel < 40e-6, "{wait}: {after} {travel}");
    }
}

#[test]
fn a_quiet_stage_whose_encoder_has_hardly_any_noise_may_rest_for_a_minute() {
    // of 0.5 nm
    for noise in [0.05, 0.1] {
        for seed in 77..80 {
            let mut run = Loop::new(&Parameters::START, seed, 90e-6);
            run.slide.noise = noise;
            assert!(run.run_to(State::Done, 5.0), "{:?}", run.output);
            (0..700_000).for_each(|_| run.step());
            assert_eq!((run.output.state, run.output.fault), (State::Done, Fault::None), "{noise} {seed}");
        }
    }
}

#[test]
fn one_bad_sample_is_no_contact_and_moves_nothing() {
    for &detector in DetectorKind::ALL {
        for seed in 66..68 {
            let armed = running(&Parameters { detector, ..Parameters::START }, seed, State::Detect);
            for offset in [3e-9, 5e-9, 8e-9, 12e-9, 20e-9, 50e-9, 1e-7, 1e-6, 1e-3] {
                for sign in [1.0, -1.0] {
                    let mut run = armed.clone();
                    run.step_with(|input| input.position += sign * offset);
                    let travel = until_fault(&mut run, 2000, |_| ());
                    let outcome = (run.output.state, run.output.contact_source);
                    assert_eq!(
                        outcome,
                        (State::Detect, ContactSource::None),
                        "{detector:?} {} nm, {seed}: {:?}",
                        sign * offset * 1e9,
                        run.output
                    );
                    assert!((travel - 2e-5).abs() < 1e-7);
                }
            }
        }
    }
}

#[test]
fn a_position_that_jumps_for_good_is_detected_or_no_contact() {
    for &detector in DetectorKind::ALL {
        for seed in 71..74 {
            let armed = running(&Parameters { detector, ..Parameters::START }, seed, State::Detect);
            for offset in [9e-9, 10e-9, 11e-9, 13e-9, 15e-9, 17e-9, 20e-9, 25e-9, 30e-9, 40e-9, 1e-6, 1e-3] {
                for sign in [1.0, -1.0] {
                    let mut run = armed.clone();
                    let travel = until_fault(&mut run, 1000, |input| input.position += sign * offset);
                    let what = format!("{detector:?} {} nm, {seed}", sign * offset * 1e9);
                    assert!(!run.output.contact, "{what}: {:?}", run.output);
                    if run.output.state == State::Fault {
                        assert_eq!(run.output.fault, Fault::PositionJump, "{what}");
                        assert!(travel < 5e-8, "{what}: {travel} m");
                    } else {
                        // followed, by no more than that
                        assert!(offset < 18e-9 && (travel - 1e-5).abs() < 4e-8, "{what}: {travel} m");
                    }
                }
            }
        }
    }
}

#[test]
fn a_jump_while_settling_is_detected() {
    let mut run = running(&Parameters::START, 70, State::Approach);
    (0..1000).for_each(|_| run.step());
    until_fault(&mut run, 100, |input| input.position += 50e-9);
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::PositionJump), "{:?}", run.output);
}

#[test]
fn a_step_of_the_encoder_does_not_blind_the_guard() {
    let mut run = Loop::new(&Parameters::START, 75, 85e-6);
    assert!(run.run_to(State::Detect, 3.0));
    // a spike every 10 ms: the detector never trusts what it sees
    let mut k = 0;
    while run.output.state == State::Detect {
        k += 1;
        run.step_with(|input| input.position += if k % 100 == 0 { 9e-9 } else { 0.0 });
    }
    assert_eq!(run.output.contact_source, ContactSource::ForceGuard, "{:?}", run.output);
    assert!(run.run_to(State::Fault, 3.0) && run.slide.depth < 1.5e-6, "{} m", run.slide.depth);
    assert_eq!(run.output.fault, Fault::LateContact);
    assert_eq!(run.output.numbers.late.unwrap().unseen, Unseen::Doubted);
}

#[test]
fn the_spindle_signal_does_not_vanish_in_a_sample() {
    let mut run = running(&Parameters::START, 72, State::Detect);
    until_fault(&mut run, 100, |input| input.spindle_speed = 0.0);
    assert_eq!((run.output.fault, run.output.contact), (Fault::SpindleJump, false));
    assert!(run.output.drive_enable);
}

#[test]
fn a_wobbling_spindle_lets_every_detector_arm_and_find_its_contact() {
    for &detector in DetectorKind::ALL {
        for seed in 73..76 {
            let p = Parameters { detector, ..Parameters::START };
            let mut run = Loop::new(&p, seed, 120e-6);
            let mut k = 0;
            while run.output.state != State::Done {
                // 0.3 % at 1 Hz, and 0.1 % from sample to sample
                let (slow, fast) = ((1e-4 * TAU * f64::from(k)).sin(), f64::from(k * k % 7) / 3.0 - 1.0);
                run.step_with(|input| input.spindle_speed *= 1.0 + 3e-3 * slow + 1e-3 * fast);
                k += 1;
                assert!(k < 40_000, "{detector:?} {seed} {:?}", run.output);
            }
            assert_eq!(format!("{:?}", run.output.contact_source), format!("{detector:?}"), "{seed}");
            assert!(run.slide.depth > 0.0 && run.slide.depth < 1.5e-6, "{detector:?} {seed}: {} m", run.slide.depth);
        }
    }
}

#[test]
fn learning_that_does_not_end_is_detected() {
    let mut p = Parameters { detector: DetectorKind::Glr, ..Parameters::START };
    p.limits.learn_time = 0.6;
    let (mut run, mut learned) = (Loop::new(&p, 74, NO_WORKPIECE), 0);
    // 10 % up and down, slowly enough for a spindle: repeated new gains
    for k in 0..40_000 {
        let wobble = 1.0 + 0.1 * (4e-4 * TAU * f64::from(k)).sin();
        run.step_with(|input| input.spindle_speed *= wobble);
        if run.output.state == State::Fault {
            break;
        }
        learned += u32::from(run.output.state == State::Learn);
    }
    // the limit itself is no fault
    assert_eq!(learned, 6001);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::LearnTimeout, true));
}

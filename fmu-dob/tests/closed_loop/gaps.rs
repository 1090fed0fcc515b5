//! Positions that are lost for a few samples anywhere in a cycle, and the samples after them.

use fmu_dob::interface::{DetectorKind, Fault, Input, Parameters, State};

use crate::run::{Loop, NO_WORKPIECE};

/// Loses `samples` positions.
fn lose(run: &mut Loop, samples: u32) {
    (0..samples).for_each(|_| run.step_with(|input| input.position_valid = false));
}

/// Steps until the cycle is done or a fault is reported, for at most `time` s; returns the fault.
fn fault_within(run: &mut Loop, time: f64) -> Fault {
    let limit = run.time() + time;
    while !matches!(run.output.state, State::Done | State::Fault) && run.time() < limit {
        run.step();
    }
    run.output.fault
}

/// Loops at positions of a complete cycle: each sample from the contact to the end, each tenth at the start, few at a
/// constant speed.
fn starts(mut run: Loop) -> Vec<Loop> {
    let mut starts = Vec::new();
    for k in 0.. {
        let every = match run.output.state {
            State::Contact | State::Retract => 1,
            State::Approach if run.output.reference.velocity.abs() < 0.999 * run.parameters.approach.velocity => 10,
            State::Done => return starts,
            _ => 400,
        };
        if k % every == 0 {
            starts.push(run.clone());
        }
        run.step();
        assert_eq!(run.output.fault, Fault::None, "{:?}", run.output);
    }
    starts
}

#[test]
fn three_lost_positions_are_bridged_anywhere_in_a_cycle_and_four_are_detected() {
    for (direction, strength, seed) in [(1, 1.0, 20), (-1, 1.0, 21), (1, 0.7, 22), (-1, 1.3, 23)] {
        let mut p = Parameters::START;
        p.approach.direction = direction;
        let mut run = Loop::new(&p, seed, 90e-6);
        run.slide.strength = strength;
        for start in starts(run) {
            for lost in 1..=4 {
                let mut run = start.clone();
                lose(&mut run, lost);
                let expected = if lost < 4 { Fault::None } else { Fault::PositionLost };
                let what = format!("{strength} {:?} {} s, {lost}", start.output.state, start.time());
                assert_eq!(fault_within(&mut run, 0.25), expected, "{what}: {:?}", run.output);
            }
        }
    }
}

#[test]
fn more_may_be_lost_where_the_limit_says_so() {
    let mut p = Parameters::START;
    p.limits.lost_samples = 6;
    for strength in [1.0, 1.3] {
        let mut run = Loop::new(&p, 24, 90e-6);
        run.slide.strength = strength;
        for start in starts(run).into_iter().filter(|start| start.output.state == State::Retract) {
            let mut run = start.clone();
            lose(&mut run, 6);
            assert_eq!(fault_within(&mut run, 0.25), Fault::None, "{strength} {} s: {:?}", start.time(), run.output);
        }
    }
}

/// Positions changed by `fake` after a gap of `lost` in `Detect`, for `samples`.
fn after_a_gap(detector: DetectorKind, lost: u32, samples: u32, mut fake: impl FnMut(&mut Input, &[f64])) -> Loop {
    let mut run = Loop::new(&Parameters { detector, ..Parameters::START }, 71, NO_WORKPIECE);
    assert!(run.run_to(State::Detect, 3.0));
    let mut recent = Vec::new();
    (0..50).for_each(|_| run.step_with(|input| recent.push(input.position)));
    for _ in 0..lost {
        run.step_with(|input| {
            recent.push(input.position);
            input.position_valid = false;
        });
    }
    for _ in 0..samples {
        run.step_with(|input| {
            recent.push(input.position);
            fake(input, &recent);
        });
        if run.output.contact || run.output.state == State::Fault {
            break;
        }
    }
    run
}

#[test]
fn what_follows_a_gap_is_detected() {
    for &detector in DetectorKind::ALL {
        for lost in 1..=3 {
            let reported = |fake: &mut dyn FnMut(&mut Input, &[f64])| {
                let run = after_a_gap(detector, lost, 30, fake);
                assert!(!run.output.contact && !run.output.drive_enable, "{detector:?} {lost}: {:?}", run.output);
                run.output.fault
            };
            for jump in [-1e-3, -1e-6, -25e-9, 25e-9, 1e-6, 1e-3] {
                assert_eq!(reported(&mut |input, _| input.position += jump), Fault::PositionJump, "{lost} {jump}");
            }
            let mut held = None;
            let frozen = reported(&mut |input, recent| {
                input.position = *held.get_or_insert(recent[recent.len() - 2 - lost as usize]);
            });
            assert_eq!(frozen, Fault::PositionFrozen, "{lost}");
        }
    }
}

use std::f64::consts::PI;

use super::*;

const LOST: Input = Input { position_valid: false, ..Input::START };
const RESTING: Expected = Expected {
    motion: 0.0,
    bridged: 0.0,
    unforeseen: 0.0,
    reference: 0.0,
    requested: 0.0,
    lag: 0.0,
    diverged: 0.0,
    may_wait: true,
    steady_spindle: true,
};
/// 10 nm in a sample
const CRUISING: Expected = Expected { motion: 1e-8, bridged: 1e-8, reference: 1e-6, requested: 1e-8, ..RESTING };

fn at(position: f64) -> Input {
    Input { position, ..Input::START }
}

fn read(reader: &mut Reader, input: &Input) -> Reading {
    reader.read(&Parameters::START, input, &RESTING)
}

/// A reader that has followed 100 samples of 10 nm.
fn cruising() -> Reader {
    let mut reader = Reader::default();
    for k in 0..100 {
        let reading = reader.read(&Parameters::START, &at(1e-8 * f64::from(k)), &CRUISING);
        assert!(reading.position.is_some() && reading.alive);
    }
    reader
}

#[test]
fn a_position_is_found_at_first_and_after_more_than_the_bridged_samples() {
    let mut reader = Reader::default();
    assert!(read(&mut reader, &at(0.1)).found);
    assert!(!read(&mut reader, &at(0.1)).found);
    for k in 1..=3 {
        assert_eq!(read(&mut reader, &LOST).lost, k);
    }
    assert!(!read(&mut reader.clone(), &at(0.1)).found);
    assert_eq!(read(&mut reader, &LOST).lost, 4);
    // wherever it is then
    let reading = read(&mut reader, &at(0.2));
    assert_eq!((reading.found, reading.position), (true, Some(0.2)));
}

#[test]
fn a_sample_where_the_stage_cannot_be_is_lost() {
    for jump in [-1e-3, -1.3e-8, 1.1e-8, 1e-3] {
        let mut reader = cruising();
        let bad = reader.read(&Parameters::START, &at(1e-6 + jump), &CRUISING);
        assert_eq!((bad.position, bad.lost, bad.loss), (None, 1, Loss::Jumps));
        let good = reader.read(&Parameters::START, &at(1.01e-6), &CRUISING);
        assert_eq!((good.position, good.lost), (Some(1.01e-6), 0));
    }
    let near = cruising().read(&Parameters::START, &at(1e-6 + 0.9e-8), &CRUISING);
    assert!(near.position.is_some());
}

#[test]
fn after_a_gap_the_stage_is_where_the_nominal_one_is() {
    let gap = Expected { motion: 5e-8, ..CRUISING };
    let accepted = |error: f64| {
        let mut reader = cruising();
        (0..2).for_each(|_| _ = reader.read(&Parameters::START, &LOST, &gap));
        reader.read(&Parameters::START, &at(1.02e-6 + error), &gap).position.is_some()
    };
    assert!(accepted(9.9e-9) && accepted(-9.9e-9) && !accepted(1.01e-8) && !accepted(-1.01e-8));
    // a jump is no gap
    let mut jumped = cruising();
    jumped.read(&Parameters::START, &at(1e-3), &gap);
    assert!(jumped.read(&Parameters::START, &at(1.09e-6), &gap).position.is_some());
}

#[test]
fn a_position_that_is_frozen_while_it_should_move_is_lost_even_with_a_last_bit_that_flickers() {
    for flicker in [0.0, 1e-9] {
        let mut reader = cruising();
        let stuck = (0..4u32).map(|k| {
            let input = at(99e-8 + flicker * f64::from(k % 2));
            reader.read(&Parameters::START, &input, &CRUISING)
        });
        let seen: Vec<_> = stuck.map(|reading| (reading.position, reading.lost, reading.loss)).collect();
        assert_eq!(seen, [1, 2, 3, 4].map(|lost| (None, lost, Loss::Frozen)));
    }
}

#[test]
fn a_stage_that_is_diverged_may_be_at_rest() {
    let mut reader = cruising();
    // lagging its reference by 100 nm, and decelerated to a stop
    let diverged = Expected { motion: 0.0, reference: 1.1e-6, ..CRUISING };
    for _ in 0..4 {
        assert!(reader.read(&Parameters::START, &at(99e-8), &diverged).position.is_some());
    }
}

#[test]
fn a_stage_may_lag_its_reference_by_what_it_is_late() {
    let mut reader = cruising();
    let late = Expected { motion: 0.0, lag: 1e-8, ..CRUISING };
    let reading = reader.read(&Parameters::START, &at(99e-8), &late);
    assert!(reading.position.is_some() && !reading.alive);
}

#[test]
fn a_quarter_revolution_is_that_of_the_spindle_and_no_longer_than_what_is_waited_for() {
    for (spindle_speed, expected) in [(0.0, 0.0), (-2000.0, 0.25e-3 * PI), (1100.0, PI / 2200.0), (900.0, 1.5e-3)] {
        let mut reader = Reader::default();
        read(&mut reader, &Input { spindle_speed, ..at(0.1) });
        assert!((reader.standstill() - expected).abs() < 1e-18, "{spindle_speed}");
    }
}

#[test]
fn a_spindle_cannot_change_its_speed_immediately_while_it_must_be_steady() {
    let turning = |spindle_speed| Input { spindle_speed, ..at(0.1) };
    let mut reader = Reader::default();
    assert_eq!(read(&mut reader, &turning(3000.0)).spindle_lost, 0);
    assert_eq!(read(&mut reader, &turning(3015.0)).spindle_lost, 0);
    for k in 1..=5 {
        let reading = read(&mut reader, &turning(0.0));
        assert_eq!((reading.spindle_speed, reading.spindle_lost), (3015.0, k));
    }
    let before_a_cycle = Expected { steady_spindle: false, ..RESTING };
    let reading = reader.read(&Parameters::START, &turning(0.0), &before_a_cycle);
    assert_eq!((reading.spindle_speed, reading.spindle_lost), (0.0, 0));
}

#[test]
fn nonsense_is_lost_or_invalid_and_never_used() {
    for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1e3] {
        let mut reader = Reader::default();
        read(&mut reader, &at(0.1));
        for k in 1..=3 {
            let reading = read(&mut reader, &at(nonsense));
            assert_eq!((reading.position, reading.lost, reading.loss, reading.invalid), (None, k, Loss::Invalid, 0));
        }
    }
    for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1e5] {
        let mut reader = Reader::default();
        read(&mut reader, &Input { spindle_speed: 3000.0, ..at(0.1) });
        for k in 1..=3 {
            let reading = read(&mut reader, &Input { spindle_speed: nonsense, ..at(0.1) });
            assert_eq!((reading.spindle_speed, reading.invalid, reading.lost), (3000.0, k, 0));
        }
        assert_eq!(read(&mut reader, &Input { spindle_speed: 3000.0, ..at(0.1) }).invalid, 0);
    }
}

#[test]
fn what_is_far_from_where_it_should_be_is_only_partly_used_and_is_no_proof_for_a_while() {
    let mut reader = cruising();
    let next = |reader: &mut Reader, k: u32, error: f64| {
        let reading = reader.read(&Parameters::START, &at(1e-8 * f64::from(k) + error), &CRUISING);
        (reading.position.map(|z| (1e12 * (z - 1e-8 * f64::from(k))).round()), reading.whole)
    };
    let whole = next(&mut reader, 100, 0.0).1;
    assert_eq!(next(&mut reader, 101, 4.9e-9), (Some(4900.0), whole + 1));
    // 5 nm of the 8 that are missing
    assert_eq!(next(&mut reader, 102, -3.1e-9), (Some(-100.0), 0));
    assert_eq!(next(&mut reader, 103, -3.1e-9), (Some(-3100.0), 1));
}

#[test]
fn enable_and_reset_count_on_their_edges_and_enable_not_at_first() {
    let mut reader = Reader::default();
    let both = Input { enable: true, reset_fault: true, ..Input::START };
    let edges: Vec<_> = [&both, &both, &Input::START, &both]
        .map(|input| read(&mut reader, input))
        .map(|reading| (reading.enabled, reading.begin, reading.reset))
        .into();
    assert_eq!(edges, [(true, false, true), (true, false, false), (false, false, false), (true, true, true)]);
}

#[test]
fn direction_turns_the_axis() {
    let mut p = Parameters::START;
    p.approach.direction = -1;
    assert_eq!(Reader::default().read(&p, &at(0.2), &RESTING).position, Some(-0.2));
}

#[test]
fn a_stage_that_was_hardly_diverged_may_not_be_frozen() {
    let mut reader = cruising();
    // lagging its reference by 20 nm, within 10 nm without a change and four times 7.5 nm
    let near = Expected { motion: 0.0, reference: 1.01e-6, ..CRUISING };
    let stuck = reader.read(&Parameters::START, &at(99e-8), &near);
    assert_eq!((stuck.position, stuck.loss), (None, Loss::Frozen));
}

#[test]
fn a_position_is_frozen_beyond_its_limit_unless_the_stage_is_farther_diverged_than_that_explains() {
    let mut p = Parameters::START;
    let unit = 2f64.powi(-28);
    p.limits.frozen = unit;
    let is_frozen = |samples: u32, diverged: f64| {
        let mut reader = Reader::default();
        let expected = Expected { requested: unit, lag: 2.0 * unit, reference: diverged * unit, ..RESTING };
        let last = (0..=samples).map(|_| reader.read(&p, &at(0.0), &expected)).last().unwrap();
        last.position.is_none() && last.loss == Loss::Frozen
    };
    // one of `limits.frozen` and two of the tolerated lag
    assert_eq!([is_frozen(3, 0.0), is_frozen(4, 0.0)], [false, true]);
    // four without a change, two of lag, four times `limits.frozen`
    assert_eq!([is_frozen(4, 10.0), is_frozen(4, 11.0)], [true, false]);
}

#[test]
fn a_stage_that_was_ahead_is_at_rest_until_its_reference_has_come_by() {
    let mut p = Parameters::START;
    let unit = 2f64.powi(-28);
    p.limits.frozen = unit;
    let frozen = |samples: u32, ahead: f64, may_wait: bool| {
        let mut reader = Reader::default();
        let last = (0..=samples).map(|k| {
            let reference = (f64::from(k) - ahead) * unit;
            let expected = Expected { requested: unit, lag: 2.0 * unit, reference, may_wait, ..RESTING };
            reader.read(&p, &at(0.0), &expected)
        });
        let last = last.last().unwrap();
        last.position.is_none() && last.loss == Loss::Frozen
    };
    let is_frozen = |samples: u32, ahead: f64| frozen(samples, ahead, true);
    // two of lag, two samples and four times `limits.frozen` follow the reference
    assert_eq!([is_frozen(3, 8.0), is_frozen(4, 8.0)], [false, true]);
    assert_eq!([is_frozen(12, 9.0), is_frozen(13, 9.0)], [false, true]);
    assert_eq!([is_frozen(23, 20.0), is_frozen(24, 20.0)], [false, true]);
    // elsewhere none waits
    assert_eq!([frozen(12, 9.0, false), frozen(15, 20.0, false)], [true, true]);
}

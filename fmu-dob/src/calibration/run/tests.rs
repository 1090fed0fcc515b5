use std::f64::consts::TAU;

use super::*;

/// A calibration whose touches are `late` (m), at a surface position of 50 um; returns its state afterwards.
fn calibrated(p: &Parameters, late: impl Fn(f64, u32) -> f64) -> CalibrationRun {
    let mut calibration = CalibrationRun::new(p);
    calibration.begin(p);
    for touch in 0..20 {
        assert!(!calibration.over() && !calibration.rejected);
        let velocity = calibration.approach(p).velocity;
        calibration.take(p, &Measured::START, p.direction() * p.calibration.position + late(velocity, touch), 0.0);
    }
    calibration
}

fn parameters(change: impl Fn(&mut Parameters)) -> Parameters {
    let mut p = Parameters::START;
    (p.calibration.position, p.calibration.touches_max) = (5e-5, 4);
    change(&mut p);
    p
}

#[test]
fn a_good_calibration_is_in_force_where_it_is_to_be_and_derived_in_any_case() {
    for (apply, direction) in [(false, 1), (true, 1), (true, -1)] {
        let p = parameters(|p| (p.calibration.apply, p.approach.direction) = (apply, direction));
        let actual = Bias { constant: 2e-7, fast: 1e-7, slow: 0.0 };
        let calibration = calibrated(&p, |v, _| actual.at(v));
        assert!(calibration.calibrated.valid && calibration.over() && !calibration.rejected);
        let mut later = p.clone();
        later.contact.bias = 7e-7;
        let expected = if apply { 3e-7 } else { 7e-7 };
        assert!((calibration.bias(&later).at(1e-4) - expected).abs() < 1e-12, "{apply}");
        let derived = calibration.derived();
        assert!((derived[0].1 - 2e-7).abs() < 1e-12);
        assert_eq!(derived[3], ("calibration.velocity_max", 3e-4));
    }
}

#[test]
fn each_limit_is_the_last_value_that_is_accepted() {
    let p = parameters(|p| p.limits.touch_scatter = 1.2e-8);
    let good = |late: &dyn Fn(f64, u32) -> f64| {
        let calibration = calibrated(&p, late);
        assert_ne!(calibration.calibrated.valid, calibration.rejected);
        calibration.calibrated.valid
    };
    // four touches that alternate by x have the standard deviation x (4/3)^(1/2)
    let oscillation = |x: f64| move |_: f64, touch: u32| 2e-7 + if (touch / 5).is_multiple_of(2) { x } else { -x };
    assert!(good(&oscillation(1.03e-8)) && !good(&oscillation(1.05e-8)));
    // too soft, and before the touch
    assert!(good(&|v, _| 9.9e-7 - 1e-4 * v) && !good(&|_, _| 1.01e-6));
    // what the parts leave out, and as much of their own at an end: 8.4 nm
    assert!(good(&|_, _| -2.4e-8) && !good(&|_, _| -2.6e-8));
    let uncertain = |deviation: f64| {
        let p = parameters(|p| p.calibration.position_std = deviation);
        calibrated(&p, |_, _| 2e-7).calibrated.valid
    };
    assert!(uncertain(2.86e-8) && !uncertain(2.9e-8));
}

#[test]
fn touches_that_are_uncertain_are_made_once_more_while_that_may_help() {
    let touches = |maximum: i32, first: f64| {
        let p = parameters(|p| (p.calibration.touches_max, p.calibration.apply) = (maximum, true));
        let mut calibration = CalibrationRun::new(&p);
        calibration.begin(&p);
        let mut made = 0;
        while !calibration.ended() {
            calibration.take(&p, &Measured::START, p.calibration.position + if made < 5 { first } else { 2e-7 }, 0.0);
            made += 1;
            // the slowest is next, unless this was the last
            let next = if calibration.ended() { p.approach.velocity } else { calibration.approach(&p).velocity };
            assert!(calibration.ended() || made % 5 != 0 || next == 1e-5, "{made}");
        }
        assert_eq!(calibration.approach_after(&p), p.approach);
        let uncertainty = calibration.deviation(1e-4);
        assert_eq!(uncertainty > 0.0, calibration.calibrated.valid);
        (made, calibration.calibrated.valid, calibration.calibrated.touches)
    };
    // one of four is 121 nm off, 60.5 nm of scatter; of five 54 nm
    assert_eq!(touches(4, 3.21e-7), (20, false, 20));
    assert_eq!(touches(8, 3.21e-7), (25, true, 25));
    assert_eq!(touches(8, 2e-7), (20, true, 20));
    // one that is too far off is never sure, and a bias that cannot be is none of scatter
    assert_eq!(touches(6, 6e-7), (30, false, 30));
    assert_eq!(touches(8, 4e-6), (20, false, 20));
}

#[test]
fn a_slowest_speed_that_is_never_certain_is_left_out_once_all_touches_are_made() {
    let actual = Bias { constant: 2e-7, fast: 1e-7, slow: 0.0 };
    let p = parameters(|p| (p.calibration.touches_max, p.calibration.apply) = (6, true));
    // one speed is late by 300 nm in every second round, and by `more` besides
    let end = |odd: usize, more: f64| {
        let mut calibration = CalibrationRun::new(&p);
        calibration.begin(&p);
        while !calibration.ended() {
            let (touch, velocity) = (calibration.calibrated.touches as usize, calibration.approach(&p).velocity);
            let late = if touch % 5 == odd { more + 3e-7 * (touch / 5 % 2) as f64 } else { 0.0 };
            calibration.take(&p, &Measured::START, p.calibration.position + actual.at(velocity) + late, 0.0);
        }
        calibration
    };
    // in the last, too late for `limits.bias`
    for more in [0.0, 1e-6] {
        let calibration = end(0, more);
        assert!(calibration.calibrated.valid && calibration.calibrated.touches == 30, "{:?}", calibration.calibrated);
        assert!((calibration.calibrated.velocity_min - 2.34e-5).abs() < 1e-7, "{:?}", calibration.calibrated);
        assert!((calibration.bias(&p).at(1e-4) - 3e-7).abs() < 1e-12);
        assert!(calibration.deviation(3e-5) < 2e-8 && calibration.deviation(1e-5) > 1.5e-7 + more);
    }
    // a rejected calibration reports the result of all speeds
    let rejected = end(1, 0.0);
    assert!(rejected.rejected && !rejected.calibrated.valid && rejected.calibrated.touches == 30);
    assert!(
        rejected.calibrated.velocity_min == 1e-5 && rejected.calibrated.scatter > 6e-8,
        "{:?}",
        rejected.calibrated
    );
    // no speed is left out where all are certain
    assert_eq!(calibrated(&p, |v, _| actual.at(v)).calibrated.velocity_min, 1e-5);
}

#[test]
fn one_that_is_aborted_or_rejected_leaves_what_was_configured() {
    let p = parameters(|p| p.calibration.apply = true);
    for aborted in [true, false] {
        let mut calibration = calibrated(&p, |_, _| 2e-7);
        calibration.end();
        calibration.begin(&p);
        assert!(!calibration.calibrated.valid && calibration.calibrated.bias == 0.0);
        if aborted {
            calibration.take(&p, &Measured::START, 5.03e-5, 0.0);
            assert!(calibration.abort() && !calibration.abort());
            assert!(calibration.over());
        } else {
            (0..20).for_each(|_| calibration.take(&p, &Measured::START, 6e-5, 0.0));
            assert!(calibration.rejected && calibration.calibrated.bias > 9e-6);
        }
        calibration.end();
        assert_eq!(calibration.bias(&p), Bias::of(&p));
    }
}

#[test]
fn it_rests_for_its_fraction_of_a_revolution_before_a_touch_and_for_none_at_its_end() {
    let p = parameters(|_| ());
    let mut calibration = CalibrationRun::new(&p);
    calibration.begin(&p);
    let at_rest_after = |calibration: &mut CalibrationRun| (0..99).find(|_| calibration.rested());
    for touch in 0..20 {
        // 0.4 of 10 ms more in each round
        let expected = [0, 40, 80, 20][touch / 5];
        assert_eq!(at_rest_after(&mut calibration), Some(expected), "{touch}");
        calibration.take(&p, &Measured::START, 5.02e-5, TAU / 0.01);
    }
    assert_eq!(at_rest_after(&mut calibration), Some(0));
    calibration.begin(&p);
    (0..6).for_each(|_| calibration.take(&p, &Measured::START, 5.02e-5, TAU / 0.01));
    calibration.abort();
    assert_eq!(at_rest_after(&mut calibration), Some(0));
}

#[test]
fn during_a_calibration_the_approach_is_that_of_the_parameters() {
    let p = parameters(|_| ());
    let mut calibration = CalibrationRun::new(&p);
    assert_eq!(calibration.approach(&p), p.approach);
    assert!(!calibration.abort() && !calibration.aborted());
    calibration.begin(&p);
    let slowest = Approach { velocity: 1e-5, ..p.approach };
    assert_eq!(calibration.approach(&p), slowest);
    for touch in 0..20 {
        let (last, after) = (touch == 19, calibration.approach_after(&p));
        calibration.take(&p, &Measured::START, 5.02e-5, 0.0);
        assert_eq!(after, if last { p.approach } else { calibration.approach(&p) });
    }
    calibration.begin(&p);
    assert!(calibration.abort());
    assert_eq!(calibration.approach_after(&p), p.approach);
}

#[test]
fn a_cycle_is_no_faster_than_was_calibrated_with_a_limit_of_the_force_and_is_in_force() {
    for (force_max, apply, expected) in [(0.8, true, 3e-4), (0.0, true, 1e-3), (0.8, false, 1e-3)] {
        let p = parameters(|p| {
            (p.calibration.force_max, p.calibration.apply, p.approach.velocity) = (force_max, apply, 1e-3);
        });
        let mut calibration = calibrated(&p, |_, _| 2e-7);
        assert_eq!(calibration.approach_after(&p).velocity, expected);
        calibration.end();
        assert_eq!([calibration.approach(&p).velocity, calibration.approach_after(&p).velocity], [expected; 2]);
        let slower = Approach { velocity: 5e-5, ..p.approach };
        assert_eq!(calibration.approach(&Parameters { approach: slower, ..p.clone() }), slower);
        // aborted: the configured bias is active
        calibration.begin(&p);
        calibration.abort();
        assert_eq!(calibration.approach(&p).velocity, 1e-3);
        calibration.end();
        assert_eq!(calibration.approach(&p).velocity, 1e-3);
    }
}

/// A touch of that many samples, after which 10 kg are at rest without thrust: F over v is 1.25 times the mass over the
/// time.
fn touch(calibration: &mut CalibrationRun, p: &Parameters, samples: u32) {
    let nominal = p.direction() * p.calibration.position;
    calibration.sense(p, &Measured::START, Some(nominal - 1e-9), 0.0, false);
    (0..samples).for_each(|_| calibration.sense(p, &Measured::START, Some(nominal + 1e-8), 0.0, false));
    (0..70).for_each(|_| calibration.sense(p, &Measured::START, Some(nominal - 1e-8), 0.0, true));
    calibration.take(p, &Measured::START, nominal + 1e-8, 0.0);
}

#[test]
fn touches_that_press_too_hard_even_at_the_slowest_speeds_end_the_calibration() {
    for direction in [1, -1] {
        let p = parameters(|p| (p.calibration.force_max, p.approach.direction) = (0.8, direction));
        let mut calibration = CalibrationRun::new(&p);
        calibration.begin(&p);
        // 23.4 um/s are touched in any case
        for last in [false, true] {
            touch(&mut calibration, &p, 4);
            assert_eq!((calibration.rejected, calibration.ended(), calibration.over()), (last, last, false));
        }
        let tolerated = calibration.tolerated.unwrap();
        assert!(tolerated < 3e-5, "{tolerated}");
        calibration.begin(&p);
        assert!(!calibration.rejected && calibration.tolerated.is_none());
    }
}

#[test]
fn where_a_longer_retract_is_needed_than_was_gone_the_stage_comes_to_rest_first() {
    // 9.4 N at 300 um/s, and twice that
    let p = parameters(|p| p.calibration.force_max = 24.0);
    let mut calibration = CalibrationRun::new(&p);
    calibration.begin(&p);
    for samples in [4, 4, 4, 4, 2] {
        assert_eq!((0..9999).find(|_| calibration.rested()), Some(0));
        touch(&mut calibration, &p, samples);
    }
    let velocity = calibration.approach(&p).velocity;
    assert!((2.6e-4..2.8e-4).contains(&velocity), "{velocity} m/s");
    assert_eq!((0..9999).find(|_| calibration.rested()), Some(1064));
}

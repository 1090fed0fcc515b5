//! Drives that are identified in one run of the bare servo, and what of the patterns that follow from it is left to learn.

use fmu_deburr::interface::{Mode, Parameters, State};

use crate::robot::Build;
use crate::setup::{Loop, parameters};

/// Machine time of a task, s.
fn time(run: &mut Loop, mode: Mode) -> f64 {
    run.input.mode = mode;
    let mut samples = 0;
    while !matches!(run.output.state, State::Done | State::Fault) {
        run.step();
        samples += 1;
    }
    assert_eq!(run.output.state, State::Done, "{:?}", run.output.fault);
    0.01 * f64::from(samples)
}

/// Largest error of the axes 1 and 3 at the tip at five speeds, mm.
fn worst(run: &mut Loop) -> f64 {
    [1.0, 0.9, 0.7, 0.5, 0.3].into_iter().fold(0.0, |maximum, factor| {
        let errors = run.largest_errors(Mode::Playback, |_| factor);
        errors[0].max(errors[2]).max(maximum)
    })
}

#[test]
fn one_run_leaves_hundredths_on_machines_that_are_three_tenths_off() {
    let mut p = parameters(&Parameters::START, 1);
    p.learn.repetitions = 0;
    for gain in [0.7, 1.0, 1.3] {
        for dynamics in [0.7, 1.0, 1.3] {
            let mut run = Loop::new(&p, &Build { gain, dynamics, ..Build::NOMINAL });
            run.step();
            let time = time(&mut run, Mode::Learn);
            assert!(time <= 10.0 && run.output.bank.patterns == 5, "{time} s, {:?}", run.output.bank);
            for axis in [0, 2] {
                let estimate = &run.output.axis[axis];
                let lag = 2.0 * 0.52 / (280.0 * dynamics);
                assert!((estimate.gain - gain).abs() < 3.0 * estimate.gain_std, "{gain} {dynamics}: {estimate:?}");
                assert!((estimate.lag - lag).abs() < 3.0 * estimate.lag_std, "{gain} {dynamics}: {estimate:?}");
                assert!(estimate.gain_std < 0.002 && estimate.lag_std < 5e-4, "{estimate:?}");
            }
            let error = worst(&mut run);
            println!("gain {gain}, dynamics {dynamics}: {time:.1} s, {error:.3} mm");
            assert!(error <= 0.03, "{gain} {dynamics}: {error}");
        }
    }
}

#[test]
fn an_axis_at_rest_keeps_the_nominal_drive_and_says_that_nothing_is_known() {
    let mut p = parameters(&Parameters::START, 1);
    p.learn.repetitions = 0;
    let mut run = Loop::new(&p, &Build { gain: 0.8, ..Build::NOMINAL });
    assert!(run.finish(Mode::Learn));
    for axis in [1, 3, 4, 5] {
        let estimate = &run.output.axis[axis];
        assert!(estimate.gain == 1.0 && (estimate.gain_std - 0.3).abs() < 1e-9, "{estimate:?}");
        assert!((estimate.lag - 2.0 * 0.52 / 280.0).abs() < 1e-9, "{estimate:?}");
    }
}

#[test]
fn a_speed_that_is_good_enough_is_not_repeated_and_one_that_no_longer_falls_ends() {
    let count = |change: fn(&mut Parameters)| {
        let mut p = parameters(&Parameters::START, 1);
        change(&mut p);
        let mut run = Loop::new(&p, &Build { gain: 0.8, ..Build::NOMINAL });
        run.step();
        time(&mut run, Mode::Learn)
    };
    // a run at each of five speeds, and that of the bare servo
    let enough = count(|_| ());
    assert!((45.0..60.0).contains(&enough), "{enough}");
    // each speed once more, at least, to see that it does not fall; 914 s are all repetitions
    let falls = count(|p| p.learn.tolerance = 0.0);
    assert!((90.0..600.0).contains(&falls), "{falls}");
    let all = count(|p| (p.learn.tolerance, p.learn.decrease) = (0.0, 0.0));
    assert!(all > 900.0, "{all}");
}

#[test]
fn learning_that_is_interrupted_after_the_first_run_leaves_what_was_identified() {
    let mut run = Loop::new(&parameters(&Parameters::START, 1), &Build { gain: 1.2, ..Build::NOMINAL });
    run.step();
    run.input.mode = Mode::Learn;
    while run.output.learn.repetition == 0 {
        run.step();
    }
    assert_eq!(run.output.bank.patterns, 0);
    run.input.mode = Mode::Idle;
    while run.output.state != State::Idle {
        run.step();
    }
    assert_eq!(run.output.bank.patterns, 5);
    assert!(worst(&mut run) <= 0.03);
}

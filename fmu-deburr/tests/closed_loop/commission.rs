//! The state `Commission`: its results on unmeasured robots, and their use.

mod bounds;
mod faults;
mod friction;

use fmu_deburr::interface::{BankStatus, Fault, Mode, Parameters, State};
use rand::{RngExt, SeedableRng};

use crate::robot::Build;
use crate::setup::{Loop, swinging};

/// Tool speed without load, rad/s.
const IDLE: f64 = 1884.0;

/// A loop at rest in `Idle`, `raised` above the path.
fn resting(p: &Parameters, build: &Build) -> Loop {
    let mut run = Loop::new(p, build);
    run.input.spindle_speed = IDLE;
    (0..20).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Idle);
    run
}

fn applied() -> Parameters {
    let mut p = Parameters::START;
    p.commission.apply = true;
    p
}

/// Steps into the commissioning run, and this number of samples on.
fn begin(run: &mut Loop, samples: usize) {
    run.input.commission = true;
    for _ in 0..200 {
        run.step();
        if run.output.state == State::Commission {
            break;
        }
    }
    assert_eq!(run.output.state, State::Commission);
    (0..samples).for_each(|_| run.step());
}

/// Runs until the commissioning run is over; its time, s.
fn commission(run: &mut Loop) -> f64 {
    begin(run, 0);
    let mut samples = 0;
    while matches!(run.output.state, State::Commission | State::Stop) {
        run.step();
        samples += 1;
        assert!(samples < 12_000, "{:?}", run.output);
    }
    0.01 * f64::from(samples)
}

/// A robot that is not what the controller was configured: gain and dynamics within 30 %, any delay from 0 to 2.
fn unknown(seed: u64) -> Build {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    Build {
        gain: random.random_range(0.7..1.3),
        dynamics: random.random_range(0.7..1.3),
        damping: random.random_range(0.7..1.3),
        delay: random.random_range(0..3),
        noise: random.random_range(0.0..0.5),
        friction: 0.0,
    }
}

/// Largest error of the axes 1 and 3 at the tip at five speeds, mm.
fn worst(run: &mut Loop) -> f64 {
    [1.0, 0.9, 0.7, 0.5, 0.3].into_iter().fold(0.0, |maximum, factor| {
        let errors = run.largest_errors(Mode::Playback, |_| factor);
        errors[0].max(errors[2]).max(maximum)
    })
}

#[test]
fn unknown_robots_are_measured_within_their_deviations_and_follow_immediately() {
    let (mut gains, mut lags, mut frequencies, mut delays) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for seed in 70..100 {
        let build = unknown(seed);
        let mut run = resting(&applied(), &build);
        let time = commission(&mut run);
        let m = run.output.measured;
        assert_eq!((run.output.state, run.output.fault, m.valid), (State::Idle, Fault::None, true), "{build:?}: {m:?}");
        assert!(time < 40.0, "{time}");
        assert_eq!(m.io_delay.round() as usize, build.delay, "{build:?}: {m:?}");
        let lag = 2.0 * 0.52 * build.damping / (280.0 * build.dynamics);
        for axis in &m.axis {
            gains.push((axis.gain - build.gain) / axis.gain_std);
            lags.push((axis.lag - lag) / axis.lag_std);
            assert!(axis.gain_std < 1e-3 && axis.lag_std < 3e-4, "{build:?}: {axis:?}");
            let off = axis.natural_frequency - 280.0 * build.dynamics;
            frequencies.push(off / axis.natural_frequency_std);
            delays.push((axis.delay - build.delay as f64) / axis.delay_std);
        }
        assert_eq!((run.output.bank.status, run.output.bank.patterns), (BankStatus::Computed, 5));
        // some of them run the path as well
        if seed < 82 {
            let error = worst(&mut run);
            println!("{build:?}: {time:.1} s, {error:.3} mm");
            assert!(error <= 0.03, "{build:?}: {error}");
        }
    }
    // deviations that were three times too small or too large would show; these drives have neither friction nor steps
    // of their own
    for (what, errors, minimum, maximum) in [
        ("gain", gains, 0.25, 1.0),
        ("lag", lags, 0.1, 0.4),
        ("natural frequency", frequencies, 0.3, 1.2),
        ("delay", delays, 0.5, 1.5),
    ] {
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        println!("{what}: {rms:.2} rms");
        assert!(
            (minimum..maximum).contains(&rms) && errors.iter().all(|error| error.abs() < 4.0),
            "{what}: {rms} {errors:?}"
        );
    }
}

#[test]
fn a_feed_that_oscillates_is_followed_as_well() {
    let mut run = resting(&applied(), &Build { gain: 0.8, dynamics: 0.75, damping: 1.2, delay: 2, ..Build::NOMINAL });
    commission(&mut run);
    let errors = run.largest_errors(Mode::Playback, swinging(1.0));
    assert!(errors[0] < 0.05 && errors[2] < 0.05, "{errors:?}");
}

#[test]
fn learning_goes_on_from_there() {
    let mut p = applied();
    p.learn.repetitions = 0;
    let mut run = resting(&p, &Build { gain: 1.25, dynamics: 0.8, delay: 2, ..Build::NOMINAL });
    commission(&mut run);
    let found = run.output.axis[2];
    assert!(run.finish(Mode::Learn));
    let learned = run.output.axis[2];
    assert!(
        (learned.gain - found.gain).abs() < 1e-3 && (learned.lag - found.lag).abs() < 1e-4,
        "{found:?} {learned:?}"
    );
    // the results of the commissioning run remain on the path
    assert_eq!(
        (run.output.axis[1].gain, run.output.bank.status),
        (run.output.measured.axis[1].gain, BankStatus::Learned)
    );
    assert!(worst(&mut run) <= 0.03);
}

#[test]
fn a_delay_that_the_other_parameters_do_not_fit_is_rejected() {
    let mut p = Parameters::START;
    // memory for the configured samples and no more
    p.learn.lead_in = p.learn.lead + p.io_delay;
    let mut run = resting(&p, &Build { delay: 2, ..Build::NOMINAL });
    commission(&mut run);
    let m = &run.output.measured;
    assert_eq!(run.output.fault, Fault::CommissionRejected, "{:?}", run.output);
    assert!(!m.valid && m.io_delay.round() == 2.0, "{m:?}");
    // two are as configured
    p.io_delay = 2;
    p.learn.lead_in += 1;
    let mut run = resting(&p, &Build { delay: 2, ..Build::NOMINAL });
    commission(&mut run);
    assert!(run.output.measured.valid, "{:?}", run.output);
}

#[test]
fn only_on_request_is_what_was_measured_used() {
    let mut run = resting(&Parameters::START, &Build { gain: 0.8, ..Build::NOMINAL });
    commission(&mut run);
    assert!(run.output.measured.valid && (run.output.measured.axis[2].gain - 0.8).abs() < 2e-3);
    let mut in_force = run.parameters.clone();
    run.controller.bring_into_force(&mut in_force);
    assert_eq!(in_force, run.parameters);
    assert_eq!((run.output.bank.patterns, run.output.axis[2].gain), (0, 1.0));
}

#[test]
fn a_delay_is_as_certain_as_its_lag_and_the_lag_of_the_nominal_drive() {
    let mut run = resting(&Parameters::START, &Build::NOMINAL);
    commission(&mut run);
    let m = run.output.measured;
    // 0.262 of 2 zeta/wn, in samples
    let spread = 0.262 * 2.0 * 0.52 / 280.0 / 0.01;
    let late = m.axis.map(|axis| axis.lag_std / run.parameters.sample_period);
    assert!((0..6).all(|i| (m.axis[i].delay_std / late[i].hypot(spread) - 1.0).abs() < 1e-9), "{m:?}");
    // of six as configured apart, of nominal drives that are not
    let mean = late.iter().map(|late| late.powi(2)).sum::<f64>().sqrt() / 6.0;
    assert!((m.io_delay_std / mean.hypot(spread) - 1.0).abs() < 1e-9, "{m:?}");
}

#[test]
fn the_file_of_the_results_is_taken_as_parameters() {
    let build = Build { gain: 1.2, dynamics: 0.8, damping: 1.1, delay: 2, noise: 0.3, friction: 1e-5 };
    let mut run = resting(&applied(), &build);
    run.input.spindle_speed = 1700.0;
    commission(&mut run);
    let folder = tempfile::tempdir().unwrap();
    run.parameters.commission.export = folder.path().join("found.json").to_str().unwrap().into();
    run.controller.export(&run.parameters).unwrap();
    let text = std::fs::read_to_string(&run.parameters.commission.export).unwrap();
    let found: std::collections::BTreeMap<String, f64> = serde_json::from_str(&text).unwrap();
    assert_eq!(found["io_delay"], 2.0);
    assert_eq!(found["expert.model.axis3.gain"], run.output.measured.axis[2].gain);
    let ratio = found["load.spindle_speed"] / run.parameters.load.spindle_speed;
    assert!((ratio - found["load.idle_speed"] / run.parameters.load.idle_speed).abs() < 1e-12);
    // configured before, without a commissioning run
    let mut p = Parameters::START;
    (p.io_delay, p.bank.compute) = (2, true);
    for (i, axis) in p.model.axis.iter_mut().enumerate() {
        axis.gain = found[&format!("expert.model.axis{}.gain", i + 1)];
        axis.lag = found[&format!("expert.model.axis{}.lag", i + 1)];
        axis.natural_frequency = found[&format!("expert.model.axis{}.natural_frequency", i + 1)];
        axis.friction = found[&format!("expert.model.axis{}.friction", i + 1)];
    }
    let mut other = resting(&p, &build);
    assert_eq!(other.controller.bank().patterns(), run.controller.bank().patterns());
    assert!(worst(&mut other) <= 0.03);
}

#[test]
fn state_bytes_continue_a_commission_bit_for_bit() {
    for samples in [0, 300, 2700] {
        let mut run = resting(&applied(), &Build { gain: 1.1, noise: 0.0, ..Build::NOMINAL });
        begin(&mut run, samples);
        let mut copy = run.reloaded();
        while run.output.state == State::Commission {
            run.step();
            copy.step();
            assert_eq!(copy.output, run.output);
        }
        assert!(run.output.measured.valid);
        for _ in 0..5 {
            run.step();
            copy.step();
        }
        assert_eq!(copy.output, run.output);
        assert_eq!(copy.controller.bank().patterns(), run.controller.bank().patterns());
    }
}

//! Friction of the drives: found by a commissioning run, and made up for where an axis reverses.

use fmu_deburr::interface::{Fault, Mode, State};

use super::{applied, commission, resting, unknown};
use crate::robot::{Build, LEVERS};
use crate::setup::Loop;

/// Way at the tip by which the drives are held back, m; the corner of the test piece reverses axis 3.
const HELD_DRIVE: f64 = 1.8e-5;

#[test]
fn friction_is_found_within_its_deviation_and_none_is_found_where_there_is_none() {
    for held in [0.0, 6e-6, HELD_DRIVE] {
        let (mut squares, mut count) = (0.0, 0.0);
        for seed in 300..308 {
            let build = Build { friction: held, ..unknown(seed) };
            let mut run = resting(&applied(), &build);
            commission(&mut run);
            let m = run.output.measured;
            assert!(m.valid, "{build:?}: {m:?}");
            for (axis, lever) in m.axis.iter().zip(LEVERS) {
                let off = axis.friction - held / lever;
                assert!(off.abs() < 4.0 * axis.friction_std, "{build:?}: {axis:?}");
                assert!(axis.friction_std * lever < 3e-6, "{build:?}: {axis:?}");
                squares += (off / axis.friction_std).powi(2);
                count += 1.0;
            }
        }
        let rms = f64::sqrt(squares / count);
        println!("{held}: {rms:.2} rms");
        assert!((0.2..1.3).contains(&rms), "{held}: {rms}");
    }
}

/// Largest error of axis 3 at five speeds after the first 10 mm of the path, where its drive may have rested on either
/// side, m.
fn in_the_corner(run: &mut Loop) -> f64 {
    let mut maximum = 0.0;
    for factor in [1.0, 0.9, 0.7, 0.5, 0.3] {
        run.input.mode = Mode::Idle;
        run.step();
        run.step();
        (run.input.mode, run.input.speed_override) = (Mode::Playback, factor);
        while !matches!(run.output.state, State::Done | State::Fault) {
            run.step();
            if run.output.state == State::Run && run.output.path.distance > 0.01 {
                maximum = f64::max(maximum, run.output.axis[2].error.abs());
            }
        }
        assert_eq!(run.output.fault, Fault::None);
    }
    maximum
}

#[test]
fn an_axis_that_reverses_is_followed_as_if_it_had_no_friction() {
    for seed in [310, 311] {
        let build = Build { friction: HELD_DRIVE, dynamics: 0.75, noise: 0.3, ..unknown(seed) };
        let mut run = resting(&applied(), &build);
        commission(&mut run);
        let with = in_the_corner(&mut run);
        // the same patterns without what friction asks for
        let mut configured = run.parameters.clone();
        run.controller.bring_into_force(&mut configured);
        configured.model.axis.iter_mut().for_each(|axis| axis.friction = 0.0);
        configured.bank.compute = true;
        let without = in_the_corner(&mut resting(&configured, &build));
        println!("{seed}: {with} m with, {without} m without");
        // three counts of 5 um
        assert!(with < 1.6e-5 && without > 2.9e-5, "{seed}: {with} {without}");
    }
}

#[test]
fn drives_without_friction_get_the_patterns_that_they_would_get_anyway() {
    for seed in 320..330 {
        let mut run = resting(&applied(), &unknown(seed));
        commission(&mut run);
        let mut in_force = run.parameters.clone();
        run.controller.bring_into_force(&mut in_force);
        let friction = in_force.model.axis.each_ref().map(|axis| axis.friction);
        assert_eq!((run.output.state, friction), (State::Idle, [0.0; 6]), "{seed}: {:?}", run.output.measured);
    }
}

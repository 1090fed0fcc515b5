//! Faults of drives and measurements during a commissioning run, and results that it rejects.

use fmu_deburr::interface::{Fault, Parameters, State};

use super::{IDLE, applied, begin, commission, resting};
use crate::robot::Build;
use crate::setup::Loop;

#[test]
fn what_is_not_certain_enough_is_rejected_with_its_axis_and_the_configured_values_are_used() {
    let rejected = |change: fn(&mut Parameters), build: Build, idle: f64| {
        let mut p = applied();
        change(&mut p);
        let mut run = resting(&p, &build);
        run.input.spindle_speed = idle;
        commission(&mut run);
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::CommissionRejected), "{:?}", run.output);
        assert!(!run.output.measured.valid && run.output.drive_enable);
        let mut in_force = run.parameters.clone();
        run.controller.bring_into_force(&mut in_force);
        assert_eq!(in_force, run.parameters);
        let axis = run.output.numbers.axis;
        (run.input.commission, run.robot.noise) = (false, 0.0);
        (0..20).for_each(|_| run.step());
        run.input.reset_fault = true;
        (0..3).for_each(|_| run.step());
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
        axis
    };
    // half a millimeter is too little, and so is much noise
    assert_eq!(rejected(|p| p.commission.travel = 5e-4, Build { noise: 3.0, ..Build::NOMINAL }, IDLE), 1);
    assert_eq!(rejected(|p| p.commission.std_max = 5e-5, Build { noise: 2.0, ..Build::NOMINAL }, IDLE), 1);
    // a tool that is off, and drives that are later than tolerated
    assert_eq!(rejected(|_| (), Build::NOMINAL, 0.0), -1);
    assert_eq!(rejected(|_| (), Build { delay: 4, ..Build::NOMINAL }, IDLE), 0);
}

#[test]
fn a_drive_that_is_lost_reverses_or_does_not_move_is_found_immediately() {
    for samples in [40, 700, 2000] {
        for (gain, faults) in [
            (0.0, &[Fault::PositionFrozen, Fault::WeakDrive][..]),
            (-1.0, &[Fault::DriveSign]),
            (0.2, &[Fault::WeakDrive]),
        ] {
            let mut run = resting(&applied(), &Build::NOMINAL);
            begin(&mut run, samples);
            run.robot.gain = gain;
            let start = run.robot.positions();
            for _ in 0..400 {
                if run.output.state != State::Commission {
                    break;
                }
                run.step();
            }
            assert!(faults.contains(&run.output.fault), "{samples} {gain}: {:?}", run.output);
            assert!(!run.output.drive_enable && run.output.axis.iter().all(|axis| axis.velocity == 0.0));
            let far = (0..6).fold(0.0f64, |far, i| far.max((run.robot.positions()[i] - start[i]).abs()));
            assert!(far < 0.34, "{samples} {gain}: {far}");
            (0..200).for_each(|_| run.step());
            assert_eq!((run.output.state, run.output.measured.valid), (State::Fault, false));
        }
    }
}

#[test]
fn bad_readings_are_bridged_for_a_while_and_then_named() {
    type Spoil = fn(&mut Loop);
    let cases: [(Spoil, Fault); 4] = [
        (|run| run.input.axis[2].position = f64::NAN, Fault::PositionLost),
        (|run| run.input.axis[2].position += 0.02, Fault::PositionJump),
        (|run| run.input.spindle_speed = f64::NAN, Fault::SpindleLost),
        (|run| run.input.speed_override = f64::NAN, Fault::InvalidInput),
    ];
    for (spoil, fault) in cases {
        let mut run = resting(&applied(), &Build { gain: 0.8, ..Build::NOMINAL });
        begin(&mut run, 0);
        for k in 0.. {
            run.read();
            (run.input.spindle_speed, run.input.speed_override) = (IDLE, 1.0);
            // two samples of a hundred, now and then
            if k % 100 > 97 {
                spoil(&mut run);
            }
            run.tick();
            if run.output.state != State::Commission {
                break;
            }
        }
        assert!(run.output.measured.valid, "{fault:?}: {:?}", run.output);
        assert!(
            run.output.measured.axis.iter().all(|axis| (axis.gain - 0.8).abs() < 4e-3),
            "{:?}",
            run.output.measured
        );
        run.input.commission = false;
        run.step();
        begin(&mut run, 300);
        for _ in 0..60 {
            run.read();
            spoil(&mut run);
            run.tick();
        }
        assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    }
}

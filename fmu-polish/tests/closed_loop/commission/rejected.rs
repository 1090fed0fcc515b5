//! Results that a commissioning run rejects, and failures while it measures.

use super::*;

#[test]
fn what_the_other_parameters_do_not_bear_is_rejected_and_never_used() {
    for apply in [false, true] {
        let mut p = Parameters::START;
        // the maximum for the configured drives, and too much for the actual ones
        (p.commission.apply, p.position.gain) = (apply, Axes::all(75.0));
        let mut run = Loop::new(&p, Build { drive_gain: 0.7, ..Build::NOMINAL }, 772);
        begin(&mut run, 0.0);
        while run.output.state == State::Commission {
            run.step_with(ask);
            assert_eq!(run.parameters.drive, p.drive, "{:?}", run.output);
        }
        let m = run.output.measured;
        assert_eq!(run.output.fault, Fault::CommissionRejected, "{:?}", run.output);
        // as certain as the guides allow
        assert!(!m.valid && (0.5..0.9).contains(&m.drive_gain) && m.drive_gain_std < 0.15 * m.drive_gain, "{m:?}");
        (0..1000).for_each(|_| run.step_with(rest));
        assert_eq!((run.parameters.clone(), run.robot.normal_force), (p, 0.0));
    }
}

#[test]
fn what_cannot_be_identified_is_rejected_with_its_numbers_and_the_tool_leaves() {
    let cases: [fn(&mut Parameters, &mut Build); 4] = [
        |p, _| p.commission.std_max = 1e-4,
        |p, _| p.commission.delay_std_max = 1e-3,
        // a contact four times as soft as configured
        |p, build| (p.limits.stiffness_ratio, build.stiffness) = (4.0, 60e3),
        |_, build| build.friction = 0.0,
    ];
    for (i, change) in cases.into_iter().enumerate() {
        let (mut p, mut build) = (applied(), Build::NOMINAL);
        change(&mut p, &mut build);
        let mut run = Loop::new(&p, build, 770);
        commission(&mut run);
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::CommissionRejected), "{i}");
        assert!(!run.output.measured.valid && run.output.drive_enable);
        (0..1000).for_each(|_| run.step_with(rest));
        assert!(run.robot.normal_force == 0.0 && run.output.velocity.normal == 0.0);
        run.step_with(|input| (input.enable, input.commission, input.reset_fault) = (false, false, true));
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
        assert_eq!(run.parameters, p);
    }
}

#[test]
fn a_loop_without_its_margin_with_what_was_found_is_rejected() {
    let mut p = applied();
    // enough on the robot that was configured
    p.impedance.bandwidth = 100.0;
    let slow = Build { drive_gain: 0.55, feedforward: 0.3, late: 1, ..Build::NOMINAL };
    let mut run = Loop::new(&p, slow, 771);
    commission(&mut run);
    assert_eq!(run.output.fault, Fault::CommissionRejected, "{:?}", run.output);
    let m = run.output.measured;
    assert!(m.stiffness > 0.0 && !m.valid);
}

#[test]
fn drives_and_sensors_that_fail_are_found_while_it_measures() {
    type Break = fn(&mut Loop, &mut Input);
    let drive: Break = |run, _| run.robot.build.pulses.z = 0.0;
    let reversed: Break = |run, _| run.robot.build.pulses.x = -1.0;
    let cases: [(f64, Break, &[Fault]); 7] = [
        (3.0, drive, &[Fault::PositionFrozen, Fault::WeakDrive, Fault::FollowingError]),
        (3.0, reversed, &[Fault::DriveSign, Fault::FollowingError]),
        (3.0, |_, input| input.position.x = f64::NAN, &[Fault::PositionLost]),
        (5.3, |_, input| input.force.z = 0.0, &[Fault::ForceFrozen]),
        (8.0, |_, input| input.force.z = f64::NAN, &[Fault::ForceLost]),
        (8.0, |_, input| input.force.z = 3.0, &[Fault::ForceFrozen, Fault::ForceError]),
        (16.0, |_, input| input.estop = true, &[Fault::EmergencyStop]),
    ];
    for (i, (time, change, faults)) in cases.into_iter().enumerate() {
        let mut run = Loop::new(&Parameters::START, Build::NOMINAL, 780);
        begin(&mut run, time);
        let (until, mut maximum) = (run.time() + 2.0, 0.0f64);
        while run.output.state == State::Commission && run.time() < until {
            let mut broken = Input::START;
            change(&mut run, &mut broken);
            run.step_with(|input| {
                ask(input);
                let Input { position, force, estop, .. } = broken.clone();
                input.estop = estop;
                if position.x.is_nan() {
                    input.position.x = position.x;
                }
                if force.z != 0.0 || time == 5.3 {
                    input.force.z = force.z;
                }
            });
            maximum = maximum.max(run.robot.normal_force);
        }
        assert!(faults.contains(&run.output.fault), "{i}: {:?}", run.output);
        assert!(maximum < 16.0, "{i}: {maximum}");
    }
}

#[test]
fn one_bad_sample_now_and_then_does_not_matter() {
    let mut run = Loop::new(&Parameters::START, Build::NOMINAL, 790);
    begin(&mut run, 0.0);
    let mut k = 0;
    while run.output.state == State::Commission {
        k += 1;
        run.step_with(|input| {
            ask(input);
            if k % 100 == 0 {
                (input.force.x, input.position.y) = (f64::NAN, 0.3);
            }
        });
    }
    let m = &run.output.measured;
    assert!(m.valid && (m.stiffness / 178e3 - 1.0).abs() < 0.02 && (m.friction / 0.2 - 1.0).abs() < 0.03, "{m:?}");
}

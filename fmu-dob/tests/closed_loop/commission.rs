//! The state `Commission`: its results on unknown machines, and its bounds.

use fmu_dob::interface::{DetectorKind, Fault, Input, Parameters, State};
use rand::{RngExt, SeedableRng};

use crate::run::{Loop, NO_WORKPIECE};
use crate::slide::SPINDLE_SPEED;

/// Longest commission, s.
const LIMIT: f64 = 30.0;

/// Requests a commissioning run only.
fn ask(input: &mut Input) {
    (input.enable, input.commission) = (false, true);
}

/// Asks for nothing.
fn rest(input: &mut Input) {
    input.enable = false;
}

/// Steps into the commissioning run, and `time` s on.
fn begin(run: &mut Loop, time: f64) {
    (0..200).for_each(|_| run.step_with(rest));
    while run.output.state != State::Commission {
        run.step_with(ask);
        assert!(run.time() < 2.0, "{:?}", run.output);
    }
    let until = run.time() + time;
    while run.time() < until {
        run.step_with(ask);
    }
}

/// Runs until the end of the commissioning run; returns the travel of the stage in both directions.
fn commission(run: &mut Loop) -> [f64; 2] {
    begin(run, 0.0);
    let start = run.slide.position();
    let mut reach = [0.0f64; 2];
    while run.output.state == State::Commission {
        run.step_with(ask);
        let position = run.slide.position() - start;
        reach = [reach[0].min(position), reach[1].max(position)];
        assert!(run.time() < LIMIT, "{:?}", run.output);
    }
    reach
}

/// An off-nominal machine: mass and thrust within 30 %, any delay from 0 to 2, other noise.
fn unknown(p: &Parameters, seed: u64) -> Loop {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut run = Loop::new(p, seed, NO_WORKPIECE);
    run.slide.mass = random.random_range(7.0..13.0);
    run.slide.strength = random.random_range(0.7..1.3) * 20.0 / 19.4;
    run.slide.delay = random.random_range(0..3);
    run.slide.noise = random.random_range(0.5..2.0);
    run.slide.loop_speed = random.random_range(0.7..1.3);
    run.slide.ripple = 0.01 * random.random_range(0.0..std::f64::consts::TAU).sin();
    run
}

/// Thrust constant for the nominal mass.
fn thrust(run: &Loop) -> f64 {
    19.4 * run.slide.strength * 10.0 / run.slide.mass
}

#[test]
fn unknown_machines_are_measured_within_their_deviations() {
    let p = Parameters::START;
    let mut errors: [Vec<f64>; 4] = Default::default();
    for seed in 120..150 {
        let mut run = unknown(&p, seed);
        let [back, ahead] = commission(&mut run);
        let m = &run.output.measured;
        assert_eq!((run.output.state, run.output.fault, m.valid), (State::Idle, Fault::None, true), "{seed}: {m:?}");
        // 90 um of retract, and never ahead except for the noise of the servo
        assert!(back > -91e-6 && ahead < 0.3e-6, "{seed}: {back} {ahead}");
        let noise = f64::hypot(0.5e-9 * run.slide.noise, 1e-9 / 12f64.sqrt());
        // the slide's steps of 50 us move it as if commands acted half a sample earlier
        let found = [
            (m.force_constant - thrust(&run), m.force_constant_std),
            (m.io_delay - run.slide.delay as f64 + 0.5, m.io_delay_std),
            (m.damping - 10.0 * 10.0 / run.slide.mass, m.damping_std),
            (m.position_noise - noise, m.position_noise_std),
        ];
        errors.iter_mut().zip(found).for_each(|(errors, (error, deviation))| errors.push(error / deviation));
        assert!((m.position_noise / noise - 1.0).abs() < 0.05, "{seed}: {m:?}");
        assert!(m.force_constant_std < 1e-2 * m.force_constant, "{seed}: {m:?}");
        assert!(m.io_delay_std < 0.3, "{seed}: {m:?}");
        assert!(m.damping_std < 2.0, "{seed}: {m:?}");
        let deviations =
            [m.stiffness_std, m.force_noise_std, m.disturbance_walk_std, m.force_sigma_std, m.slope_sigma_std];
        assert!(deviations.iter().all(|deviation| *deviation > 0.0), "{seed}: {m:?}");
    }
    // deviations that were three times too small or too large would show
    for (what, errors) in ["thrust", "delay", "friction", "noise"].iter().zip(errors) {
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        println!("{what}: {rms:.2} rms");
        assert!((0.5..1.5).contains(&rms) && errors.iter().all(|error| error.abs() < 4.0), "{what}: {rms} {errors:?}");
    }
}

#[test]
fn before_a_slow_approach_it_is_as_certain_and_before_a_fast_one_a_stage_that_reverses_is_no_frozen_encoder() {
    let mut p = Parameters::START;
    for velocity in [1e-5, 2e-4, 3e-4] {
        p.approach.velocity = velocity;
        for seed in 150..158 {
            let mut run = unknown(&p, seed);
            commission(&mut run);
            let outcome = (run.output.fault, run.output.measured.valid);
            assert_eq!(outcome, (Fault::None, true), "{velocity} {seed}: {:?}", run.output.measured);
        }
    }
}

#[test]
fn a_stage_that_still_returns_as_a_slow_stroke_goes_away_is_no_frozen_encoder() {
    let mut p = Parameters::START;
    p.approach.velocity = 1e-5;
    // it comes as fast as the stroke goes, and stands for 3 ms
    for seed in [1009, 1033, 1207, 1290] {
        let mut run = unknown(&p, seed);
        commission(&mut run);
        assert_eq!((run.output.fault, run.output.measured.valid), (Fault::None, true), "{seed}");
    }
}

#[test]
fn what_was_measured_is_used_on_request_and_the_next_touch_is_as_ever() {
    for apply in [false, true] {
        let mut p = Parameters::START;
        p.commission.apply = apply;
        let mut run = Loop::new(&p, 83, 90e-6);
        run.slide.mass = 12.5;
        commission(&mut run);
        let mut in_force = p.clone();
        run.controller.bring_into_force(&mut in_force);
        let expected = if apply { thrust(&run) } else { 20.0 };
        assert!((in_force.stage.force_constant / expected - 1.0).abs() < 0.015, "{in_force:?}");
        assert_eq!(in_force.guard_force, 0.4);
        assert_eq!(in_force.limits.slope_sigma_max == 5.0, !apply);
        let folder = tempfile::tempdir().unwrap();
        p.commission.export = folder.path().join("found.json").to_str().unwrap().into();
        run.controller.export(&p).unwrap();
        let outcome = std::fs::read_to_string(&p.commission.export).unwrap();
        let found = format!("\"stage.force_constant\": {:e},", run.output.measured.force_constant);
        assert!(outcome.contains(&found), "{outcome} {found}");
        // at rest, and `enable` rises
        let until = run.time() + 0.1;
        while run.time() < until {
            run.step_with(rest);
        }
        let limit = run.time() + 3.0;
        assert!(run.run_to(State::Done, limit), "{apply}: {:?}", run.output);
        assert!(run.slide.depth > 0.0 && run.slide.depth < 0.45e-6, "{apply}: {} m", run.slide.depth);
        // the gain ratio of the drive is now 1
        let ratio = run.output.drive_gain_ratio;
        assert_eq!((ratio - 1.0).abs() < 0.06, apply, "{apply}: {ratio}");
    }
}

#[test]
fn it_is_aborted_by_commission_and_by_enable_into_rest_and_what_was_configured() {
    let mut p = Parameters::START;
    p.commission.apply = true;
    // in the first motion, in the excitation, and in a stroke with the new thrust constant
    for time in [0.04, 1.0, 3.0, 9.0] {
        for enable in [false, true] {
            let mut run = Loop::new(&p, 84, NO_WORKPIECE);
            run.slide.mass = 12.0;
            begin(&mut run, time);
            assert_eq!(run.output.state, State::Commission);
            run.step_with(|input| (input.enable, input.commission) = (enable, enable));
            assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
            for _ in 0..3000 {
                // nothing begins again without a new edge
                run.step_with(|input| (input.enable, input.commission) = (enable, enable));
                assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None), "{time} {enable}");
            }
            assert!(run.output.reference.velocity == 0.0 && run.output.tracking_error.abs() < 2e-8, "{:?}", run.output);
            assert!(!run.output.measured.valid);
            let mut in_force = p.clone();
            run.controller.bring_into_force(&mut in_force);
            assert_eq!(in_force, p);
        }
    }
}

#[test]
fn it_never_begins_by_itself() {
    let mut run = Loop::new(&Parameters::START, 85, NO_WORKPIECE);
    for _ in 0..1000 {
        // true from the first sample on is no edge
        run.step_with(ask);
        assert_eq!(run.output.state, State::Idle);
    }
}

#[test]
fn every_servo_and_detector_and_both_directions_are_commissioned() {
    let mut integral = Parameters::START;
    integral.servo.disturbance_compensation = false;
    let slope = Parameters { detector: DetectorKind::Slope, ..Parameters::START };
    for mut p in [integral, slope] {
        p.commission.apply = true;
        let mut run = Loop::new(&p, 86, NO_WORKPIECE);
        run.slide.mass = 8.0;
        commission(&mut run);
        assert_eq!((run.output.state, run.output.measured.valid), (State::Idle, true), "{:?}", run.output);
        assert!((run.output.measured.force_constant / thrust(&run) - 1.0).abs() < 0.015);
        let limit = run.time() + 1.5;
        assert!(run.run_to(State::Detect, limit), "{:?}", run.output);
    }
}

#[test]
fn a_weight_is_held_by_the_same_current_when_another_thrust_constant_comes_into_force() {
    for compensation in [true, false] {
        let mut p = Parameters::START;
        (p.commission.apply, p.servo.disturbance_compensation) = (true, compensation);
        let mut run = Loop::new(&p, 93, NO_WORKPIECE);
        (run.slide.mass, run.slide.strength) = (13.0, 0.8);
        // the weight comes slowly, and the servo takes it
        for k in 0..10_000 {
            run.slide.push = 5e-4 * f64::from(k);
            run.step_with(rest);
        }
        begin(&mut run, 0.0);
        while run.parameters.stage.force_constant == 20.0 {
            run.step_with(ask);
            assert_eq!(run.output.state, State::Commission, "{:?}", run.output);
        }
        let mut maximum = 0.0f64;
        for _ in 0..500 {
            run.step_with(ask);
            maximum = maximum.max((run.slide.position() - run.output.reference.position).abs());
        }
        // two fifths of 5 N would be 5.7 um
        assert!(maximum < 0.5e-6, "{compensation}: {maximum}");
    }
}

#[test]
fn an_excitation_that_is_too_weak_is_rejected_with_its_numbers() {
    let mut p = Parameters::START;
    (p.commission.force, p.commission.delay_std_max) = (0.4, 0.01);
    let mut run = Loop::new(&p, 87, NO_WORKPIECE);
    commission(&mut run);
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::CommissionRejected));
    let m = &run.output.measured;
    assert!(!m.valid && m.io_delay_std > p.commission.delay_std_max, "{m:?}");
    (0..2000).for_each(|_| run.step_with(rest));
    assert!(run.output.drive_enable && run.output.reference.velocity == 0.0);
    run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
}

#[test]
fn noise_in_which_no_touch_is_sensed_is_rejected_and_no_limit_grows_with_it() {
    for apply in [false, true] {
        let mut p = Parameters::START;
        p.commission.apply = apply;
        let mut run = Loop::new(&p, 94, NO_WORKPIECE);
        run.slide.noise = 12.0;
        commission(&mut run);
        assert_eq!(run.output.fault, Fault::CommissionRejected, "{:?}", run.output);
        assert!(!run.output.measured.valid && run.output.measured.slope_sigma > 0.0, "{:?}", run.output.measured);
        run.step_with(rest);
        let mut in_force = p.clone();
        run.controller.bring_into_force(&mut in_force);
        assert_eq!(in_force, p);
    }
}

#[test]
fn what_the_other_parameters_do_not_allow_is_rejected_and_never_used() {
    for apply in [false, true] {
        let mut p = Parameters::START;
        // nearly the maximum of the configured drive, and more than that of this one
        (p.commission.apply, p.commission.force) = (apply, 0.95 * p.stage.force_constant * p.stage.current_max);
        let mut run = Loop::new(&p, 96, NO_WORKPIECE);
        run.slide.strength = 0.8;
        begin(&mut run, 0.0);
        while run.output.state == State::Commission {
            run.step_with(ask);
            assert_eq!(run.parameters.stage, p.stage);
        }
        assert_eq!(run.output.fault, Fault::CommissionRejected, "{:?}", run.output);
        let m = &run.output.measured;
        assert!(!m.valid && (m.force_constant / thrust(&run) - 1.0).abs() < 0.015, "{m:?}");
        (0..100).for_each(|_| run.step_with(rest));
        assert_eq!(run.parameters, p);
    }
}

#[test]
fn the_file_is_the_same_whether_what_was_measured_is_used_or_not() {
    let files = [false, true].map(|apply| {
        let folder = tempfile::tempdir().unwrap();
        let mut p = Parameters::START;
        p.commission.apply = apply;
        p.commission.export = folder.path().join("found.json").to_str().unwrap().into();
        let mut run = Loop::new(&p, 95, NO_WORKPIECE);
        run.slide.mass = 12.5;
        commission(&mut run);
        run.controller.export(&p).unwrap();
        std::fs::read_to_string(&p.commission.export).unwrap()
    });
    assert_eq!(files[0], files[1]);
}

#[test]
fn a_machine_beyond_half_or_twice_what_was_configured_is_rejected() {
    let mut run = Loop::new(&Parameters::START, 88, NO_WORKPIECE);
    run.slide.mass = 4.2;
    commission(&mut run);
    assert_eq!(run.output.fault, Fault::CommissionRejected, "{:?}", run.output);
    assert!((run.output.measured.force_constant / thrust(&run) - 1.0).abs() < 0.015);
}

#[test]
fn a_drive_that_is_lost_or_reverses_is_found_immediately() {
    for time in [0.5, 3.0, 9.0] {
        for (strength, faults) in
            [(0.0, &[Fault::WeakDrive, Fault::FollowingError, Fault::Overload][..]), (-1.0, &[Fault::DriveSign])]
        {
            let mut run = Loop::new(&Parameters::START, 89, NO_WORKPIECE);
            begin(&mut run, time);
            let (until, position) = (run.time() + 1.0, run.slide.position());
            run.slide.strength = strength;
            while run.output.state == State::Commission && run.time() < until {
                run.step_with(ask);
            }
            assert!(faults.contains(&run.output.fault), "{time} {strength}: {:?}", run.output);
            assert!(!run.output.drive_enable && run.output.current == 0.0);
            // 90 um of the plan and 20 um of following error
            assert!((run.slide.position() - position).abs() < 1.5e-4, "{time} {strength}");
        }
    }
}

#[test]
fn state_bytes_continue_a_commission_bit_for_bit() {
    let mut p = Parameters::START;
    p.commission.apply = true;
    for time in [0.05, 4.0, 8.5] {
        let mut run = Loop::new(&p, 90, NO_WORKPIECE);
        begin(&mut run, time);
        let mut copy = run.reloaded();
        while run.output.state == State::Commission {
            run.step_with(ask);
            copy.step_with(ask);
            assert_eq!(copy.output, run.output);
        }
        assert!(run.output.measured.valid);
    }
}

#[test]
fn a_lost_sample_now_and_then_does_not_matter() {
    let mut run = Loop::new(&Parameters::START, 91, NO_WORKPIECE);
    begin(&mut run, 0.0);
    let mut k = 0;
    while run.output.state == State::Commission {
        k += 1;
        run.step_with(|input| {
            ask(input);
            input.position_valid = k % 100 > 1;
        });
    }
    assert!(run.output.measured.valid, "{:?}", run.output);
    assert!((run.output.measured.force_constant / thrust(&run) - 1.0).abs() < 0.015);
}

#[test]
fn a_spindle_that_is_lost_or_falls_immediately_ends_it() {
    for (reading, fault) in [(f64::NAN, Fault::SpindleLost), (0.1 * SPINDLE_SPEED, Fault::SpindleJump)] {
        let mut run = Loop::new(&Parameters::START, 92, NO_WORKPIECE);
        begin(&mut run, 2.0);
        for _ in 0..10 {
            run.step_with(|input| {
                ask(input);
                input.spindle_speed = reading;
            });
        }
        assert_eq!(run.output.fault, fault);
    }
}

//! The bias calibrated by touches: what it makes of the contact position, what it keeps to, and how it ends.

use fmu_dob::interface::{ContactSource, Fault, Input, Parameters, State};

use crate::run::Loop;
use crate::slide::SPINDLE_SPEED;

/// Where the work is, m.
const POSITION: f64 = 3e-5;

/// Asks for a calibration and for nothing else.
fn ask(input: &mut Input) {
    (input.enable, input.calibrate) = (false, true);
}

/// Asks for nothing.
fn rest(input: &mut Input) {
    input.enable = false;
}

fn parameters() -> Parameters {
    let mut p = Parameters::START;
    (p.calibration.position, p.calibration.apply) = (POSITION, true);
    p
}

/// Steps until the calibration has begun.
fn begin(run: &mut Loop) {
    (0..200).for_each(|_| run.step_with(rest));
    let limit = run.time() + 1.0;
    while run.output.state != State::Calibrate {
        run.step_with(ask);
        assert!(run.time() < limit, "{:?}", run.output);
    }
}

/// Runs until the calibration is over.
fn calibrate(run: &mut Loop) {
    begin(run);
    while !matches!(run.output.state, State::Idle | State::Fault) {
        run.step_with(ask);
        assert!(run.time() < 60.0, "{:?}", run.output);
    }
}

/// Touches once at a speed (um/s); returns the distance (m) of the contact from the surface, as detected and without
/// the bias.
fn touch(run: &mut Loop, speed: f64) -> [f64; 2] {
    run.parameters.approach.velocity = 1e-6 * speed;
    (0..200).for_each(|_| run.step_with(rest));
    let limit = run.time() + 30.0;
    assert!(run.run_to(State::Approach, limit) && run.run_to(State::Done, limit), "{:?}", run.output);
    assert_eq!(run.output.contact_source, ContactSource::Glr);
    [run.output.contact_position - POSITION, run.output.contact_position_estimate - POSITION]
}

#[test]
fn a_calibrated_bias_gives_the_first_touch_at_speeds_that_were_and_were_not_calibrated() {
    let p = parameters();
    let mut errors = Vec::new();
    for seed in 130..133 {
        let mut run = Loop::new(&p, seed, POSITION);
        run.slide.mass = [7.5, 12.5, 10.0][seed as usize % 3];
        run.slide.stiffness = [2e5, 6e5, 1.5e5][seed as usize % 3];
        calibrate(&mut run);
        let calibrated = run.output.calibrated;
        assert_eq!(
            (run.output.state, run.output.fault, calibrated.valid),
            (State::Idle, Fault::None, true),
            "{calibrated:?}"
        );
        assert_eq!(calibrated.touches, 20);
        // as far as an approach at 100 um/s needs to arm
        assert!(run.slide.position() < POSITION - 8.9e-5, "{} m", run.slide.position());
        assert!(calibrated.std < 3e-8 && calibrated.scatter < 6e-8, "{calibrated:?}");
        // as far as one arms at 300 um/s
        run.parameters.retract.distance = 3e-4;
        for speed in [10.0, 35.0, 170.0, 300.0] {
            let [found, corrected] = touch(&mut run, speed);
            println!("{seed}: {speed} um/s, {:.1} nm late, {:.1} nm with the bias", 1e9 * found, 1e9 * corrected);
            assert!(found > 1e-7, "{found} m");
            errors.push(corrected / run.output.contact_position_std);
        }
    }
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    println!("{rms:.2} of the reported standard deviations");
    assert!((0.3..1.7).contains(&rms) && errors.iter().all(|error| error.abs() < 4.0), "{rms} {errors:?}");
}

#[test]
fn a_commission_after_a_calibration_leaves_the_bias_in_force_and_the_positions_as_certain() {
    let mut p = parameters();
    p.commission.apply = true;
    let mut errors = Vec::new();
    for (seed, mass, strength) in [(144, 7.5, 1.2), (145, 12.5, 0.8), (146, 10.0, 1.0)] {
        let mut run = Loop::new(&p, seed, POSITION);
        (run.slide.mass, run.slide.strength) = (mass, strength);
        calibrate(&mut run);
        (0..200).for_each(|_| run.step_with(rest));
        while !run.output.measured.valid {
            run.step_with(|input| (input.enable, input.commission) = (false, true));
            assert!(run.time() < 99.0, "{:?}", run.output);
        }
        let found = run.output.measured.force_constant;
        assert!((found / (19.4 * strength * 10.0 / mass) - 1.0).abs() < 0.05, "{found}");
        run.parameters.retract.distance = 3e-4;
        for speed in [15.0, 40.0, 100.0, 250.0] {
            let [late, corrected] = touch(&mut run, speed);
            assert!(late - corrected > 1e-7, "{corrected}");
            errors.push(corrected / run.output.contact_position_std);
        }
    }
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    println!("{rms:.2} of the reported standard deviations");
    assert!((0.3..1.7).contains(&rms) && errors.iter().all(|error| error.abs() < 4.0), "{rms} {errors:?}");
}

#[test]
fn what_was_calibrated_is_used_on_request_only_and_written_in_any_case() {
    let files = [false, true].map(|apply| {
        let mut p = parameters();
        (p.calibration.touches, p.calibration.apply, p.contact.bias) = (2, apply, 5e-7);
        (p.calibration.velocity_min, p.limits.touch_scatter, p.calibration.std_max) = (6e-5, 1e-6, 1e-6);
        let folder = tempfile::tempdir().unwrap();
        p.calibration.export = folder.path().join("bias.json").to_str().unwrap().into();
        let mut run = Loop::new(&p, 134, 8e-5);
        run.parameters.calibration.position = 8e-5;
        calibrate(&mut run);
        assert!(run.output.calibrated.valid, "{:?}", run.output.calibrated);
        run.controller.export_bias(&p).unwrap();
        let [found, corrected] = touch(&mut run, 100.0);
        let calibrated =
            run.output.calibrated.bias + run.output.calibrated.bias_fast + 1e4 * run.output.calibrated.bias_slow;
        let expected = if apply { calibrated } else { 5e-7 };
        assert!((found - corrected - expected).abs() < 1e-12, "{apply}: {} {expected}", found - corrected);
        std::fs::read_to_string(&p.calibration.export).unwrap()
    });
    assert!(files[0] == files[1] && files[0].contains("\"contact.bias_fast\""), "{files:?}");
}

#[test]
fn it_never_begins_by_itself_and_every_touch_keeps_to_the_travel_of_an_approach() {
    let mut run = Loop::new(&parameters(), 135, POSITION);
    for _ in 0..500 {
        // true from the first sample on is no edge
        run.step_with(ask);
        assert_eq!(run.output.state, State::Idle);
    }
    let mut p = parameters();
    (p.calibration.velocity_min, p.approach.travel_max) = (9e-5, 2.8e-4);
    // the workpiece is not at the configured position
    let mut run = Loop::new(&p, 136, 3e-4);
    calibrate(&mut run);
    assert_eq!((run.output.fault, run.output.calibrated.touches), (Fault::TravelLimit, 0), "{:?}", run.output);
    assert!(!run.output.calibrated.valid);
}

#[test]
fn a_travel_too_short_for_the_fastest_touch_is_rejected_before_the_stage_moves() {
    // 271.1 um back, 1 um that a contact may be late, 22.5 nm to stop
    for (travel_max, reached) in [(2.720e-4, false), (2.722e-4, true)] {
        let mut p = parameters();
        (p.approach.travel_max, p.calibration.velocity_min) = (travel_max, 3e-5);
        let mut run = Loop::new(&p, 141, POSITION);
        begin(&mut run);
        let position = run.output.reference.position;
        while run.output.calibrated.touches < 5 && run.output.state != State::Fault {
            run.step_with(ask);
        }
        let output = &run.output;
        if reached {
            assert_eq!((output.fault, output.calibrated.touches), (Fault::None, 5), "{output:?}");
            // what is tuned counts from the next touch on
            run.parameters.approach.travel_max = 2.720e-4;
            run.step_with(ask);
            assert_eq!(
                (run.output.fault, run.output.calibrated.touches),
                (Fault::CalibrationRejected, 5),
                "{:?}",
                run.output
            );
        } else {
            assert_eq!((output.fault, output.calibrated.touches), (Fault::CalibrationRejected, 0), "{output:?}");
            (0..2000).for_each(|_| run.step_with(ask));
            assert_eq!(run.output.reference.position, position);
        }
    }
}

#[test]
fn aborted_it_retracts_from_the_touch_and_not_from_where_it_is() {
    let mut p = parameters();
    p.calibration.velocity_min = 6e-5;
    // an approach at 100 um/s needs 90 um, touches at 90 and 300 um/s 81 and 271 um
    let cases = [
        (0, State::Retract, 90.12e-6),
        (1, State::Calibrate, 90.12e-6),
        (3, State::Retract, 271.08e-6),
        (4, State::Calibrate, 271.08e-6),
    ];
    let mut run = Loop::new(&p, 142, 6e-5);
    run.parameters.calibration.position = 6e-5;
    begin(&mut run);
    let not_yet = run.output.reference.position;
    let end = |run: &mut Loop, failed: bool| {
        let calibrating = run.output.state == State::Calibrate;
        if failed && calibrating {
            // too short for what comes
            run.parameters.approach.travel_max = 1e-4;
        }
        for _ in 0..6000 {
            run.step_with(|input| {
                (input.enable, input.calibrate) = (false, failed);
                if failed && !calibrating {
                    input.spindle_speed = f64::NAN;
                }
            });
        }
        let fault = match (failed, calibrating) {
            (false, _) => Fault::None,
            (true, false) => Fault::SpindleLost,
            (true, true) => Fault::CalibrationRejected,
        };
        assert_eq!(run.output.fault, fault);
        run.output.reference.position
    };
    let mut none = run.reloaded();
    assert_eq!(end(&mut none, false), not_yet);
    for (touches, state, expected) in cases {
        while (run.output.calibrated.touches, run.output.state) != (touches, state) {
            run.step_with(ask);
        }
        let touch = run.output.contact_position;
        if state == State::Retract {
            (0..300).for_each(|_| run.step_with(ask));
        }
        for failed in [false, true] {
            let distance = touch - end(&mut run.reloaded(), failed);
            assert!((distance - expected).abs() < 0.3e-6, "{touches} {state:?} {failed}: {distance} m");
        }
    }
}

#[test]
fn it_is_aborted_by_calibrate_and_by_enable_and_then_a_cycle_is_armed_before_it_touches() {
    for (enable, state) in
        [(false, State::Detect), (true, State::Detect), (false, State::Contact), (true, State::Retract)]
    {
        let mut run = Loop::new(&parameters(), 137, POSITION);
        begin(&mut run);
        while run.output.state != state || run.output.calibrated.touches < 1 {
            run.step_with(ask);
        }
        run.step_with(|input| (input.enable, input.calibrate) = (enable, enable));
        let until = run.time() + 0.5;
        while run.time() < until {
            // nothing begins again without a new edge
            run.step_with(|input| (input.enable, input.calibrate) = (enable, enable));
        }
        let output = &run.output;
        assert_eq!(
            (output.state, output.fault, output.calibrated.valid),
            (State::Idle, Fault::None, false),
            "{output:?}"
        );
        assert_eq!(output.aborted, state == State::Detect);
        // 100 um/s, with the configured values: no bias
        let [found, corrected] = touch(&mut run, 100.0);
        assert_eq!(found, corrected);
    }
}

#[test]
fn a_wrong_position_soft_workpiece_and_touches_that_scatter_are_rejected_with_their_numbers() {
    type Change = fn(&mut Parameters, &mut Loop);
    let cases: [(Change, &str); 3] = [
        (|p, _| p.calibration.position = POSITION + 1e-6, "not below zero"),
        (|p, run| (p.limits.bias, run.slide.stiffness) = (4e-7, 7e4), "`limits.bias` = `0.0000004 m`"),
        (|p, _| p.limits.touch_scatter = 2e-9, "`limits.touch_scatter` = `0.000000002 m`"),
    ];
    for (change, why) in cases {
        let mut p = parameters();
        (p.calibration.touches, p.calibration.touches_max) = (2, 2);
        let mut run = Loop::new(&p, 138, POSITION);
        change(&mut p, &mut run);
        run.parameters = p;
        calibrate(&mut run);
        let output = &run.output;
        assert_eq!((output.state, output.fault), (State::Fault, Fault::CalibrationRejected), "{why}: {output:?}");
        assert!(
            !output.calibrated.valid && output.calibrated.touches == 10 && output.drive_enable,
            "{why}: {output:?}"
        );
        // it retracts as far as an approach needs to arm
        (0..2000).for_each(|_| run.step_with(rest));
        run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
        let [found, estimate] = touch(&mut run, 100.0);
        assert_eq!(found, estimate);
    }
}

#[test]
fn what_fails_in_a_touch_ends_the_calibration_and_the_next_cycle_is_armed_before_it_touches() {
    let mut run = Loop::new(&parameters(), 139, POSITION);
    begin(&mut run);
    while run.output.state != State::Detect {
        run.step_with(ask);
    }
    for _ in 0..10 {
        run.step_with(|input| {
            ask(input);
            input.spindle_speed = 0.1 * SPINDLE_SPEED;
        });
    }
    assert_eq!(run.output.fault, Fault::SpindleJump);
    (0..3000).for_each(|_| run.step_with(ask));
    run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
    assert_eq!((run.output.state, run.output.calibrated.valid), (State::Idle, false));
    touch(&mut run, 100.0);
}

/// Measures the machine and uses what was found.
fn commission(run: &mut Loop) {
    (0..200).for_each(|_| run.step_with(rest));
    while !run.output.measured.valid {
        run.step_with(|input| (input.enable, input.commission) = (false, true));
        assert!(run.time() < 20.0 && run.output.fault == Fault::None, "{:?}", run.output);
    }
    while run.output.state != State::Idle {
        run.step_with(rest);
    }
}

#[test]
fn hard_workpiece_is_touched_slower_in_the_calibration_and_in_the_cycle_after_it() {
    // the first presses with more than 0.8 N at 300 um/s
    for (force_max, stiffness, slower) in [(0.0, 1.9e6, false), (0.8, 1.9e6, true), (0.8, 2e5, false)] {
        let mut p = parameters();
        (p.calibration.force_max, p.approach.velocity, p.commission.apply) = (force_max, 3e-4, true);
        let mut run = Loop::new(&p, 143, POSITION);
        run.slide.stiffness = stiffness;
        commission(&mut run);
        begin(&mut run);
        let mut force = 0.0f64;
        while !matches!(run.output.state, State::Idle | State::Fault) {
            run.step_with(ask);
            force = force.max(run.slide.contact_force);
        }
        let calibrated = run.output.calibrated;
        assert!(calibrated.valid && run.output.fault == Fault::None, "{:?}", run.output);
        (0..200).for_each(|_| run.step_with(rest));
        let (limit, mut fastest) = (run.time() + 20.0, 0.0f64);
        run.step();
        while run.output.state != State::Done {
            run.step();
            fastest = fastest.max(run.output.reference.velocity);
            force = force.max(run.slide.contact_force);
            assert!(run.time() < limit, "{:?}", run.output);
        }
        println!("{stiffness:.1e} N/m: {force:.2} N at up to {:.0} um/s", 1e6 * fastest);
        assert_eq!((fastest, calibrated.velocity_max < 2.9e-4), (calibrated.velocity_max, slower));
        assert_eq!(force > 0.8, stiffness > 1e6 && !slower, "{force} N");
        // not so slow that nothing of the requested range remains
        assert!(!slower || force > 0.3, "{force} N");
        // within the reported uncertainty, at the active speed
        let error = run.output.contact_position_estimate - POSITION;
        assert!(error.abs() < 4.0 * run.output.contact_position_std, "{error} m");
    }
}

#[test]
fn workpiece_too_hard_for_the_slowest_speeds_is_rejected_with_its_numbers_after_a_touch_or_two() {
    let mut p = parameters();
    (p.calibration.force_max, p.calibration.apply) = (0.05, true);
    let mut run = Loop::new(&p, 144, POSITION);
    run.slide.stiffness = 1.9e6;
    calibrate(&mut run);
    let output = &run.output;
    assert_eq!((output.state, output.fault), (State::Fault, Fault::CalibrationRejected), "{output:?}");
    assert!(!output.calibrated.valid && output.calibrated.touches <= 2 && output.drive_enable, "{output:?}");
    assert!(output.numbers.tolerated.is_some_and(|speed| speed < 3e-5), "{:?}", output.numbers);
    // an approach touches at the configured speed, and is armed before
    (0..2000).for_each(|_| run.step_with(rest));
    run.step_with(|input| (input.enable, input.reset_fault) = (false, true));
    let [found, corrected] = touch(&mut run, 100.0);
    assert_eq!(found, corrected);
}

#[test]
fn state_bytes_continue_a_calibration_bit_for_bit() {
    let mut p = parameters();
    (p.calibration.touches, p.calibration.velocity_min) = (2, 9e-5);
    (p.limits.touch_scatter, p.calibration.std_max, p.calibration.force_max) = (1e-6, 1e-6, 10.0);
    let mut run = Loop::new(&p, 140, 9e-5);
    run.parameters.calibration.position = 9e-5;
    begin(&mut run);
    while run.output.calibrated.touches < 3 {
        run.step_with(ask);
    }
    let mut copy = run.reloaded();
    while run.output.state != State::Idle {
        run.step_with(ask);
        copy.step_with(ask);
        assert_eq!(copy.output, run.output);
    }
    assert!(run.output.calibrated.valid);
}

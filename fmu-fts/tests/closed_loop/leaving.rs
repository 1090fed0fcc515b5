//! Off the path: onto a held angle, and out of the part.

use fmu_fts::interface::{Fault, Mode, Parameters, State, SurfaceKind};

use crate::machine::{Build, RPM};
use crate::run::Loop;

/// The 0x4 lens at 600, 1200 and 2400 rpm, and 3 cm at 870 rpm.
fn cuts() -> [(Parameters, Build); 4] {
    let lens = |speed: fn(f64) -> f64, radius: f64| {
        let mut p = Parameters::START;
        p.surface.outer_radius = 0.032;
        (p, Build { speed, radius, ..Build::NOMINAL })
    };
    let mut wave = lens(|_| 870.0 * RPM, 0.03);
    wave.0.surface.kind = SurfaceKind::Wave;
    (wave.0.surface.wave_harmonic, wave.0.surface.wave_amplitude) = (2, 0.015);
    [lens(|_| 600.0 * RPM, 0.03), lens(|_| 1200.0 * RPM, 0.03), lens(|_| 2400.0 * RPM, 0.03), wave]
}

/// Smallest and largest depth of the tool within `duration` s.
fn range(run: &mut Loop, duration: f64) -> (f64, f64) {
    let (until, mut range) = (run.time() + duration, (f64::INFINITY, f64::NEG_INFINITY));
    while run.time() < until {
        run.step();
        let depth = run.machine.tip_depth();
        range = (range.0.min(depth), range.1.max(depth));
    }
    range
}

#[test]
fn the_tool_goes_beyond_neither_the_path_nor_the_held_angle() {
    leaves_within_five_percent(&Build::NOMINAL);
    for (gain, flexure) in [(0.8, 1080.0), (0.8, 1320.0), (1.2, 1080.0), (1.2, 1320.0)] {
        leaves_within_five_percent(&Build { gain, flexure, ..Build::NOMINAL });
    }
}

/// From all cuts to a held angle, on a machine with the arm of `arm`.
fn leaves_within_five_percent(arm: &Build) {
    for (p, cut) in cuts() {
        let build = Build { gain: arm.gain, flexure: arm.flexure, ..cut };
        let mut tracking = Loop::new(&p, &build, 11);
        tracking.run_to(1.0);
        let (minimum, maximum) = range(&mut tracking, 0.11);
        let (middle, beyond) = (0.5 * (minimum + maximum), 0.05 * 0.5 * (maximum - minimum));
        for mode in [Mode::Hold, Mode::Identify, Mode::CalibrateFlats] {
            for phase in 0..6 {
                let mut run = tracking.clone();
                run.run_to(run.time() + 0.0061 * f64::from(phase));
                run.input.mode = mode;
                run.input.hold_angle = (middle / 0.08).asin() - 0.0523;
                // before the oscillation of the identification starts
                let (low, high) = range(&mut run, 0.3);
                let kept = low > minimum - beyond && high < maximum + beyond;
                assert!(kept, "{mode:?} {phase}: {low} {high}, path {minimum} {maximum}");
                assert_eq!(run.output.fault, Fault::None);
                if mode == Mode::Hold {
                    let (low, high) = range(&mut run, 0.1);
                    assert!(low > middle - 20e-6 && high < middle + 20e-6, "{low} {high}, held {middle}");
                }
            }
        }
    }
}

#[test]
fn an_aborted_oscillation_fades() {
    let mut p = Parameters::START;
    p.identify.grid = "20, 60, 200".parse().unwrap();
    let mut begun = Loop::new(&p, &Build::NOMINAL, 11);
    (begun.input.mode, begun.input.hold_angle) = (Mode::Identify, 0.1);
    begun.run_to(0.5);
    let held = 0.08 * 0.1523f64.sin();
    for broken in 0..8 {
        let mut run = begun.clone();
        run.run_to(0.55 + 0.07 * f64::from(broken));
        run.input.mode = Mode::Hold;
        let (low, high) = range(&mut run, 0.3);
        // the loop passes on up to 1.3 of an amplitude of 1.75 mm
        assert!(low > held - 2.4e-3 && high < held + 2.4e-3, "{low} {high}, held {held}");
        run.input.mode = Mode::Identify;
        run.run_to(run.time() + 3.0);
        assert_eq!((run.output.identify_progress, run.output.fault), (1.0, Fault::None));
    }
}

#[test]
fn after_the_end_of_the_table_the_tool_is_out_of_the_part_and_nothing_is_wrong() {
    let mut p = Parameters::START;
    p.surface.inner_radius = 0.0295;
    let mut run = Loop::new(&p, &Build { radius: 0.0301, ..Build::NOMINAL }, 11);
    run.run_to(0.6);
    let deepest = range(&mut run, 0.11).0;
    run.feed(5e-3);
    while run.output.state == State::Track {
        assert!(run.time() < 1.0);
        run.step();
    }
    assert_eq!((run.output.state, run.output.fault, run.output.drive_enable), (State::Done, Fault::None, true));
    run.run_to(run.time() + 0.35);
    let (low, high) = range(&mut run, 0.1);
    assert!(high < deepest - 0.8e-3 && high - low < 10e-6, "{low} {high}, path from {deepest}");
    // what was asked for is done
    run.input.enable = false;
    run.step();
    assert_eq!(run.output.state, State::Idle);
}

#[test]
fn out_of_the_table_where_the_path_was_joined_nothing_is_done() {
    let mut p = Parameters::START;
    p.surface.outer_radius = 0.0303;
    let mut run = Loop::new(&p, &Build::NOMINAL, 11);
    run.run_to(0.6);
    run.feed(-5e-3);
    while run.output.state == State::Track {
        assert!(run.time() < 1.0);
        run.step();
    }
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::OutsideTable));
    assert!(run.output.drive_enable);
}

#[test]
fn a_reset_during_the_retract_waits_for_its_end() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 11);
    run.run_to(0.6);
    run.input.hold_angle = f64::NAN;
    run.run_to(0.61);
    run.input.hold_angle = 0.0;
    let mut before = run.machine.tip_depth();
    loop {
        run.input.reset_fault ^= true;
        run.step();
        let moved = (run.machine.tip_depth() - before).abs();
        before = run.machine.tip_depth();
        if run.output.state == State::Idle {
            assert!(run.time() > 0.8 && moved < 1e-6, "{} s: {moved} m in a sample", run.time());
            break;
        }
        assert!(run.time() < 1.0);
    }
}

#[test]
fn a_lost_spindle_ends_out_of_the_part_under_control() {
    for (p, build) in cuts() {
        let mut run = Loop::new(&p, &build, 11);
        run.run_to(1.0);
        let (minimum, maximum) = range(&mut run, 0.11);
        let (stuck, mut high) = (run.input.spindle_angle, f64::NEG_INFINITY);
        while run.time() < 1.8 {
            run.step_with(|input| input.spindle_angle = stuck);
            high = high.max(run.machine.tip_depth());
            if run.time() > 1.7 {
                assert!(run.machine.tip_depth() < minimum - 0.9e-3);
            }
        }
        assert!(high < maximum + 0.05 * (maximum - minimum), "{high} {maximum}");
        assert_eq!((run.output.fault, run.output.drive_enable), (Fault::SpindleFrozen, true));
        // a second fault in the end is not ignored, and asks for more
        for _ in 0..5 {
            run.step_with(|input| input.arm_angle = f64::NAN);
        }
        let outputs = (run.output.fault, run.output.drive_enable, run.output.torque);
        assert_eq!(outputs, (Fault::PositionLost, false, 0.0));
    }
}

#[test]
fn a_controller_disabled_during_the_retract_goes_on_and_releases_the_arm_outside() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 11);
    run.run_to(0.6);
    let minimum = range(&mut run, 0.11).0;
    run.input.hold_angle = f64::NAN;
    run.run_to(run.time() + 0.01);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::InvalidInput, true));
    run.input.enable = false;
    let high = range(&mut run, 0.4).1;
    assert!(high < minimum + 3.6e-3, "{high} {minimum}");
    // enabled again it stays where it is
    run.input.enable = true;
    for _ in 0..100 {
        run.step();
        assert_eq!((run.output.torque, run.output.state), (0.0, State::Fault));
        assert!(run.machine.tip_depth() < minimum - 0.9e-3);
    }
}

#[test]
fn a_task_that_is_switched_off_retracts_out_of_the_part() {
    for (p, build) in cuts() {
        let mut run = Loop::new(&p, &build, 11);
        run.run_to(1.0);
        let (minimum, maximum) = range(&mut run, 0.11);
        for enable in [false, true] {
            let mut run = run.clone();
            (run.input.enable, run.input.mode) = (enable, if enable { Mode::Idle } else { Mode::Track });
            let mut high = f64::NEG_INFINITY;
            run.step();
            while run.output.state == State::Retract {
                run.step();
                high = high.max(run.machine.tip_depth());
            }
            assert!(high < maximum + 0.05 * (maximum - minimum), "{high} {maximum}");
            assert!(run.machine.tip_depth() < minimum - 0.9e-3);
            let outputs = (run.output.state, run.output.fault, run.output.torque, run.output.drive_enable);
            assert_eq!(outputs, (State::Idle, Fault::None, 0.0, true));
            // it is let go there: the thrust takes it only farther out
            assert!(range(&mut run, 0.1).1 < minimum - 0.9e-3);
        }
    }
}

#[test]
fn an_approach_that_is_switched_off_ends_out_of_the_part() {
    let p = Parameters::START;
    let mut run = Loop::new(&p, &Build::NOMINAL, 11);
    let mut cut = run.clone();
    cut.run_to(1.0);
    let minimum = range(&mut cut, 0.11).0;
    run.run_to(0.5 * p.approach_time);
    assert_eq!(run.output.state, State::Approach);
    run.input.enable = false;
    run.step();
    while run.output.state == State::Retract {
        run.step();
    }
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    assert!(run.machine.tip_depth() < minimum - 0.9e-3, "{} m, path from {minimum} m", run.machine.tip_depth());
}

#[test]
fn a_held_arm_that_is_switched_off_is_stopped_and_let_go() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 11);
    (run.input.mode, run.input.hold_angle) = (Mode::Hold, 0.5);
    run.run_to(0.2);
    let from = run.machine.tip_depth();
    run.input.enable = false;
    run.step();
    assert_eq!(run.output.state, State::Retract);
    run.run_to(0.23);
    assert_eq!((run.output.state, run.output.torque), (State::Idle, 0.0));
    // 2 rad/s at most, half way of that in 20 ms
    assert!((run.machine.tip_depth() - from).abs() < 1.8e-3);
}

#[test]
fn an_arm_whose_encoder_is_lost_is_braked_before_the_drive_is_off() {
    for (p, build) in cuts() {
        for gain in [0.8, 1.0, 1.2] {
            // torque of the pulse, over the inertia that is there
            let build = Build { gain, ..build.clone() };
            let mut tracking = Loop::new(&p, &build, 11);
            tracking.run_to(1.0);
            let (minimum, maximum) = range(&mut tracking, 0.11);
            for phase in 0..6 {
                let mut run = tracking.clone();
                run.run_to(run.time() + 0.0061 * f64::from(phase));
                let (mut high, until) = (f64::NEG_INFINITY, run.time() + 0.2);
                while run.time() < until {
                    run.step_with(|input| input.arm_angle = f64::NAN);
                    high = high.max(run.machine.tip_depth());
                }
                assert_eq!((run.output.fault, run.output.drive_enable), (Fault::PositionLost, false));
                // coasting, 3 cm at 870 rpm would go round in circles
                assert!(high < maximum + 0.05 * (maximum - minimum), "gain {gain}, {phase}: {high} {maximum}");
            }
        }
    }
}

/// The fault of a run, and whether its drive stays on for a pulse of torque, and the deepest in the 0.3 s from now on.
fn ended(mut run: Loop) -> (Fault, bool, f64) {
    let (until, mut high, mut first) = (run.time() + 0.3, f64::NEG_INFINITY, None);
    while run.time() < until {
        run.step();
        high = high.max(run.machine.tip_depth());
        if run.output.fault != Fault::None {
            first.get_or_insert((run.output.fault, run.output.drive_enable && run.output.torque != 0.0));
        }
    }
    assert!(!run.output.drive_enable && run.output.torque == 0.0);
    let (fault, braked) = first.unwrap();
    (fault, braked, high)
}

#[test]
fn an_arm_that_its_drive_leaves_behind_is_braked_where_that_was_seen_to_obey() {
    let (p, build) = &cuts()[2];
    let mut tracking = Loop::new(p, build, 17);
    tracking.run_to(1.0);
    let maximum = range(&mut tracking, 0.11).1;
    for phase in 0..12 {
        tracking.run_to(tracking.time() + 0.0011);
        let with = |gain: f64| {
            let mut run = tracking.clone();
            run.machine.set_gain(gain);
            ended(run)
        };
        let (fault, braked, high) = with(0.6);
        assert_eq!((fault, braked), (Fault::FollowingError, true), "{phase}");
        // coasting, it went 6 mm beyond the path
        assert!(high < maximum + 2e-3, "{phase}: {high} {maximum}");
        assert!(!with(0.0).1, "{phase}: {:?}", with(0.0));
        // coasting, one that has turned went round; at 2.2 m/s the opposite pulse and five samples take 6 mm
        let (fault, _, high) = with(-1.0);
        assert!(fault == Fault::DriveSign && high < maximum + 6e-3, "{phase}: {fault:?} {high} {maximum}");
    }
}

#[test]
fn an_arm_that_lags_without_enough_torque_to_evaluate_its_drive_is_released() {
    let (mut p, build) = cuts()[0].clone();
    p.limits.following_error = 120e-6;
    let mut run = Loop::new(&p, &build, 17);
    run.run_to(1.0);
    (run.input.feedforward_enable, run.input.afc_enable) = (false, false);
    let (fault, braked, _) = ended(run);
    assert_eq!((fault, braked), (Fault::FollowingError, false));
}

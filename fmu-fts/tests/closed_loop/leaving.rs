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

/// Least and largest depth of the tool within `duration` s.
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
    for (p, build) in cuts() {
        let mut tracking = Loop::new(&p, &build, 11);
        tracking.run_to(1.0);
        let (least, most) = range(&mut tracking, 0.11);
        let (middle, beyond) = (0.5 * (least + most), 0.05 * 0.5 * (most - least));
        for mode in [Mode::Hold, Mode::Identify, Mode::CalibrateFlats] {
            for phase in 0..6 {
                let mut run = tracking.clone();
                run.run_to(run.time() + 0.0061 * f64::from(phase));
                run.input.mode = mode;
                run.input.hold_angle = (middle / 0.08).asin() - 0.0523;
                // before the swing of the identification begins
                let (low, high) = range(&mut run, 0.3);
                let kept = low > least - beyond && high < most + beyond;
                assert!(kept, "{mode:?} {phase}: {low} {high}, path {least} {most}");
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
fn a_swing_that_is_broken_off_fades() {
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
        // the loop passes on up to 1.3 of a swing of 1.75 mm
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
fn a_reset_on_the_way_out_of_the_part_waits_for_its_end() {
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
        let (least, most) = range(&mut run, 0.11);
        let (stuck, mut high) = (run.input.spindle_angle, f64::NEG_INFINITY);
        while run.time() < 1.8 {
            run.step_with(|input| input.spindle_angle = stuck);
            high = high.max(run.machine.tip_depth());
            if run.time() > 1.7 {
                assert!(run.machine.tip_depth() < least - 0.9e-3);
            }
        }
        assert!(high < most + 0.05 * (most - least), "{high} {most}");
        assert_eq!((run.output.fault, run.output.drive_enable), (Fault::LostSpindle, true));
        // a second fault in the end is not ignored, and asks for more
        for _ in 0..5 {
            run.step_with(|input| input.arm_angle = f64::NAN);
        }
        let told = (run.output.fault, run.output.drive_enable, run.output.torque);
        assert_eq!(told, (Fault::LostReading, false, 0.0));
    }
}

#[test]
fn what_is_switched_off_in_the_end_stays_off() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 11);
    run.run_to(0.6);
    run.input.hold_angle = f64::NAN;
    run.run_to(0.61);
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::InvalidInput, true));
    run.input.enable = false;
    run.step();
    run.input.enable = true;
    for _ in 0..100 {
        run.step();
        assert_eq!((run.output.torque, run.output.drive_enable, run.output.state), (0.0, false, State::Fault));
    }
}

//! Every fault: its name, what the tool does then, and how the controller gets out of it.

use fmu_polish::axes::Axes;
use fmu_polish::interface::{Fault, Input, Mode, Parameters, State};
use nalgebra::Vector3;

use crate::robot::Build;
use crate::run::Loop;

const P: Parameters = Parameters::START;

fn with(change: impl FnOnce(&mut Parameters)) -> Parameters {
    let mut p = P;
    change(&mut p);
    p
}

/// A cycle that has come to `state`, and then went on for 0.3 s.
fn running(p: &Parameters, build: Build, seed: u64, state: State) -> Loop {
    let mut run = Loop::new(p, build, seed);
    assert!(run.run_to(state, 5.0), "{:?} {:?}", run.output.state, run.output.fault);
    if state == State::Follow {
        (0..300).for_each(|_| run.step());
    }
    run
}

/// The fault is detected within `limit` s, the tool retracts along the normal, and is at rest.
fn retracts(mut run: Loop, fault: Fault, limit: f64) {
    let until = run.time() + limit;
    assert!(run.run_to(State::Fault, until), "{fault:?} expected, {:?}", run.output);
    assert_eq!(run.output.fault, fault);
    let (from, normal) = (run.robot.position(), run.output.normal.vector());
    (0..400).for_each(|_| run.step());
    let distance = (run.robot.position() - from).dot(&normal);
    assert!((distance - P.retract.distance).abs() < 60e-6, "{fault:?}: out by {distance} m");
    assert_eq!(run.output.velocity.z, 0.0);
    resets(run, fault);
}

/// The fault is detected immediately, and nothing moves afterwards.
fn stays(mut run: Loop, fault: Fault, change: impl Fn(&mut Input)) {
    run.step_with(&change);
    assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    for _ in 0..200 {
        run.step_with(&change);
        assert_eq!(run.output.pulses, Axes::all(0), "{fault:?}");
        let v = run.output.velocity;
        assert_eq!((v.x, v.y, v.z), (0.0, 0.0, 0.0));
    }
    resets(run, fault);
}

/// A rising edge of `reset_fault` ends the fault at rest, and nothing moves by itself after it.
fn resets(mut run: Loop, fault: Fault) {
    run.step();
    assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    for _ in 0..200 {
        run.step_with(|input| input.reset_fault = true);
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
        assert_eq!(run.output.pulses, Axes::all(0), "{fault:?}");
    }
}

#[test]
fn force_limit_at_a_step_up() {
    let mut run = running(&P, Build::NOMINAL, 50, State::Follow);
    run.robot.build.shift.z += 0.15e-3;
    retracts(run, Fault::ForceLimit, 0.02);
}

#[test]
fn the_force_limit_counts_what_acts_across_the_normal() {
    let mut run = running(&P, Build::NOMINAL, 69, State::Follow);
    let mut across = 0.0;
    for _ in 0..12 {
        across += 3.0;
        run.step_with(|input| input.force.x += across);
    }
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::ForceLimit));
}

#[test]
fn settle_timeout_when_the_force_is_out_of_reach() {
    let p = with(|p| p.impedance.damping = 5e6);
    retracts(running(&p, Build::NOMINAL, 51, State::Settle), Fault::SettleTimeout, 2.1);
}

#[test]
fn lost_contact_when_the_mold_drops() {
    let mut run = running(&P, Build::NOMINAL, 52, State::Follow);
    run.robot.build.shift.z -= 0.4e-3;
    retracts(run, Fault::ContactLost, 0.2);
}

#[test]
fn invalid_path_when_the_force_is_not_along_the_normal() {
    let p = with(|p| (p.limits.force_angle, p.stick_slip.mode) = (0.3, Mode::Off));
    let build = Build { friction: 0.6, ..Build::NOMINAL };
    retracts(running(&p, build, 53, State::Settle), Fault::InvalidPath, 1.0);
}

#[test]
fn approach_timeout_without_a_mold() {
    let build = Build { shift: Vector3::new(0.0, 0.0, -2.1e-3), ..Build::NOMINAL };
    retracts(Loop::new(&P, build, 54), Fault::ApproachTimeout, 4.5);
}

#[test]
fn position_error_when_nothing_brings_the_tool_back() {
    let p = with(|p| {
        (p.stick_slip.mode, p.limits.position_error) = (Mode::Off, 50e-6);
        p.position.gain = Axes::ZERO;
    });
    // the axes move as commanded, from a position that is 80 um across the path
    let mut run = Loop::displaced(&p, Build::NOMINAL, 55, Vector3::new(0.0, 80e-6, 0.0));
    assert!(run.run_to(State::Follow, 5.0), "{:?}", run.output);
    retracts(run, Fault::PositionError, 0.1);
}

#[test]
fn surface_error_when_the_mold_sinks_slowly() {
    let p = with(|p| p.limits.surface_error = 0.1e-3);
    let mut run = running(&p, Build::NOMINAL, 56, State::Follow);
    for _ in 0..2000 {
        run.robot.build.shift.z -= 0.2e-6;
        run.step();
        if run.output.state == State::Fault {
            break;
        }
    }
    assert_eq!(run.output.fault, Fault::SurfaceError);
    // this is the surface, not the ball, which presses into it
    let sunk = -run.robot.build.shift.z;
    assert!((sunk / p.limits.surface_error - 1.0).abs() < 0.1, "{sunk}");
}

#[test]
fn stroke() {
    let p = with(|p| p.stroke.y = 1.2e-3);
    let short = |run: &mut Loop| run.parameters.stroke.y = 1e-6;
    let mut run = running(&p, Build::NOMINAL, 57, State::Follow);
    short(&mut run);
    stays(run, Fault::Stroke, |_| ());
}

#[test]
fn emergency_stop_in_every_state() {
    for state in [State::Idle, State::Approach, State::Settle, State::Follow, State::Unload, State::Retract] {
        let run = if matches!(state, State::Unload | State::Retract) {
            let mut run = running(&P, Build::NOMINAL, 58, State::Follow);
            run.input.enable = false;
            assert!(run.run_to(state, 10.0));
            run.input.enable = true;
            run
        } else {
            running(&P, Build::NOMINAL, 58, state)
        };
        stays(run, Fault::EmergencyStop, |input| input.estop = true);
    }
}

/// A loop that has just met its force limit.
fn beyond_the_force_limit(seed: u64) -> Loop {
    let mut run = running(&P, Build::NOMINAL, seed, State::Follow);
    run.robot.build.shift.z += 0.15e-3;
    let until = run.time() + 0.1;
    assert!(run.run_to(State::Fault, until));
    run
}

#[test]
fn an_emergency_stop_ends_a_retract_after_a_fault() {
    let run = beyond_the_force_limit(61);
    stays(run, Fault::EmergencyStop, |input| input.estop = true);
}

#[test]
fn a_reset_is_a_rising_edge_at_rest_and_the_next_cycle_one_of_enable() {
    let mut run = running(&P, Build::NOMINAL, 67, State::Approach);
    run.step_with(|input| (input.estop, input.reset_fault) = (true, true));
    for _ in 0..100 {
        run.step_with(|input| input.reset_fault = true);
        assert_eq!(run.output.fault, Fault::EmergencyStop);
    }
    run.step();
    run.step_with(|input| input.reset_fault = true);
    assert_eq!(run.output.state, State::Idle);
    let until = run.time() + 0.5;
    assert!(!run.run_to(State::Approach, until));
    run.step_with(|input| input.enable = false);
    let until = run.time() + 0.5;
    assert!(run.run_to(State::Approach, until), "{:?}", run.output.fault);
}

#[test]
fn a_reset_during_the_retract_does_not_count() {
    let mut run = beyond_the_force_limit(68);
    run.step_with(|input| input.reset_fault = true);
    (0..400).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::ForceLimit));
}

#[test]
fn a_machine_that_was_moved_by_hand_begins_where_it_is() {
    let mut run = Loop::new(&P, Build::NOMINAL, 69);
    for k in 0..10 {
        run.step_with(|input| {
            input.enable = false;
            input.position.x += if k < 8 { 0.1 } else { 0.0 };
        });
    }
    // the zero of the sensor takes 100 samples
    (0..102).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Approach, "{:?}", run.output.fault);
}

#[test]
fn a_machine_that_was_moved_after_a_cycle_begins_where_it_is_with_one_sample_without_enable() {
    let mut run = Loop::new(&P, Build::NOMINAL, 71);
    assert!(run.run_to(State::Done, 20.0));
    for k in 0..130 {
        run.step_with(|input| (input.position.x, input.enable) = (input.position.x + 0.1, k != 20));
    }
    // the zero of the sensor is taken there
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::NotAtStart));
}

#[test]
fn an_enable_that_rose_in_a_fault_starts_nothing_after_it() {
    let mut run = running(&P, Build::NOMINAL, 70, State::Approach);
    run.step_with(|input| (input.estop, input.enable) = (true, false));
    for _ in 0..10 {
        run.step_with(|input| input.position.x += 0.1);
    }
    run.step_with(|input| (input.position.x, input.reset_fault) = (0.1, true));
    for _ in 0..300 {
        run.step_with(|input| input.position.x += 0.1);
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    }
}

#[test]
fn tare_rejected_while_the_tool_touches() {
    let build = Build { height: -20e-6, ..Build::NOMINAL };
    let mut run = Loop::new(&P, build, 62);
    assert!(run.run_to(State::Fault, 0.2));
    assert_eq!(run.output.fault, Fault::TareRejected);
    resets(run, Fault::TareRejected);
}

#[test]
fn not_at_start() {
    let mut run = Loop::new(&P, Build::NOMINAL, 63);
    while run.output.state == State::Idle {
        run.step_with(|input| input.position.x += 1e-3);
    }
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::NotAtStart));
    resets(run, Fault::NotAtStart);
}

#[test]
fn without_enable_the_tool_leaves_and_the_next_cycle_starts_again() {
    let mut run = running(&P, Build::NOMINAL, 64, State::Follow);
    run.input.enable = false;
    assert!(run.run_to(State::Retract, 5.0) && run.run_to(State::Idle, 5.0));
    assert!(run.output.progress > 0.0 && run.robot.normal_force == 0.0);
    run.input.enable = true;
    assert!(run.run_to(State::Approach, 5.0) || run.output.fault == Fault::NotAtStart, "{:?}", run.output);
}

#[test]
fn after_a_finished_cycle_enable_must_fall_first() {
    let mut run = Loop::new(&P, Build::NOMINAL, 65);
    assert!(run.cycle(20.0).is_some());
    (0..100).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.done, run.output.progress), (State::Done, true, 1.0));
    run.input.enable = false;
    (0..2).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.done), (State::Idle, false));
}

#[test]
fn overrides_stop_the_feed_and_change_the_force() {
    let mut run = running(&P, Build::NOMINAL, 66, State::Follow);
    run.input.feed_override = 0.0;
    (0..500).for_each(|_| run.step());
    let before = run.output.progress;
    run.input.force_override = 1.4;
    (0..1500).for_each(|_| run.step());
    assert_eq!((run.output.progress, run.output.velocity.tangential), (before, 0.0));
    assert!((run.robot.normal_force - 7.0).abs() < 0.2, "{} N", run.robot.normal_force);
    assert_eq!(run.output.force.setpoint, 7.0);
}

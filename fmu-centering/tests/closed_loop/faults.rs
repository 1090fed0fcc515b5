//! Faults on the ring: the fault that is raised, and a safe retract.

use std::f64::consts::TAU;

use fmu_centering::interface::{Fault, Parameters, State};

use crate::ring::{Ring, SPEED};
use crate::run::{Loop, finite, running};

const P: Parameters = Parameters::PAPER;

/// Steps to the fault and checks that the slide then returns to its start, without touching the ring again.
pub fn retreats(mut run: Loop, fault: Fault, within: f64) -> Loop {
    let limit = run.time() + within;
    assert!(run.run_to(State::Fault, limit), "{:?}", run.output);
    assert_eq!(run.output.fault, fault);
    let (center, mut before) = (run.ring.center, run.output.slide);
    for k in 0..3000 {
        run.step();
        assert!(finite(&run.output));
        assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
        let step = run.output.slide.velocity_setpoint - before.velocity_setpoint;
        assert!(step.abs() <= 2.57e-3, "step {k}: velocity jumps by {step} m/s");
        before = run.output.slide;
    }
    let moved = (run.ring.center[0] - center[0]).hypot(run.ring.center[1] - center[1]);
    assert!(moved < 50e-6, "the ring was moved by {moved} m");
    assert_eq!(run.output.slide.velocity_setpoint, 0.0);
    assert!(run.output.slide.position_setpoint.abs() < 1e-6, "{} m", run.output.slide.position_setpoint);
    run
}

#[test]
fn no_part_within_the_travel() {
    let mut ring = Ring::new(1, 0.0, 0.0);
    ring.present = false;
    let mut run = Loop::new(&P, ring);
    let mut furthest: f64 = 0.0;
    while run.output.state != State::Fault {
        run.step();
        furthest = furthest.max(run.output.slide.position_setpoint);
    }
    assert!(run.time() < 2.0 && furthest < P.approach.travel_max, "{furthest} m after {} s", run.time());
    retreats(run, Fault::NoPart, 0.0);
}

#[test]
fn a_ring_that_disappears_is_not_chased() {
    for state in [State::Follow, State::Collect, State::Wait, State::Settle, State::Centered] {
        let mut run = running(&P, state);
        run.ring.present = false;
        let run = retreats(run, Fault::NoPart, 0.5);
        assert!(run.time() < 60.0);
    }
}

#[test]
fn a_ring_that_disappears_ends_a_push_of_either_law() {
    for p in [Parameters::PAPER, Parameters::START] {
        let mut run = running(&p, State::Push);
        run.ring.present = false;
        retreats(run, Fault::NoPart, 0.5);
    }
}

#[test]
fn a_probe_that_bounces_for_a_moment_spoils_no_model() {
    let mut run = running(&P, State::Collect);
    let begin = run.time();
    while run.output.state == State::Collect {
        let free = (0.5..0.58).contains(&(run.time() - begin));
        run.step_with(|input| input.probe_position *= f64::from(u8::from(!free)));
    }
    assert!(run.run_to(State::Wait, begin + 4.0), "{:?}", run.output);
    // of 0.2 mm 0.3 %: where in the turn the probe bounces decides, 0.56 um here
    assert!((run.output.eccentricity - run.ring.eccentricity()).abs() < 0.6e-6, "{:?}", run.output);
}

#[test]
fn a_spindle_axis_outside_the_ring_is_too_small_a_ring() {
    // the operator configures the wrong ring: 0.1 mm instead of 50 mm
    let mut p = P;
    p.ring.radius = 1e-3;
    p.ring.eccentricity_max = 0.9e-3;
    retreats(Loop::new(&p, Ring::new(2, 1.5e-3, 0.0)), Fault::RingTooSmall, 20.0);
}

#[test]
fn a_ring_that_does_not_contain_the_axis_is_lost_during_the_stroke() {
    // r = 10 mm, 11 mm off: no part on the far side
    let mut ring = Ring::new(2, 0.011, 0.0);
    ring.radius = 0.010;
    let mut p = P;
    p.ring.radius = 0.010;
    p.ring.eccentricity_max = 0.009;
    let mut run = Loop::new(&p, ring);
    assert!(run.run_to(State::Fault, 20.0), "{:?}", run.output);
    assert_eq!(run.output.fault, Fault::NoPart);
}

#[test]
fn a_frozen_probe_has_a_name_and_is_never_a_centered_ring() {
    for (p, pushes) in [(P, 0), (P, 1), (Parameters::START, 0), (Parameters::START, 1)] {
        let mut run = running(&p, State::Collect);
        while run.output.push.count < pushes || run.output.state != State::Collect {
            run.step();
        }
        let (frozen, begin) = (run.output.pusher_gap, run.time());
        while run.output.state != State::Fault {
            run.step_with(|input| input.probe_position = p.probe.at_pusher - frozen);
            assert!(!run.output.centered && run.time() < begin + 4.0, "{pushes}: {:?}", run.output);
        }
        assert_eq!(run.output.fault, Fault::ProbeFrozen);
    }
}

#[test]
fn a_probe_beyond_its_stroke() {
    let mut run = running(&P, State::Wait);
    // a single one is a spike
    run.step_with(|input| input.probe_position = 0.0251);
    (0..10).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Wait);
    // pressed in at the speed of the slide
    let mut probe = 0.0195;
    while run.output.state != State::Fault {
        probe += 1.2e-4;
        run.step_with(|input| input.probe_position = probe);
    }
    assert!(probe < 0.0253, "{probe} m");
    retreats(run, Fault::ProbeRange, 0.0);
}

#[test]
fn a_spindle_faster_than_friction_allows() {
    // 3 mm: 122 rpm
    let mut ring = Ring::new(3, 3e-3, 0.0);
    ring.speed = SPEED * 130.0 / 20.0;
    retreats(Loop::new(&P, ring), Fault::Centrifugal, 20.0);
    // it speeds up later
    let mut run = Loop::new(&P, Ring::new(3, 3e-3, 0.0));
    assert!(run.run_to(State::Wait, 20.0));
    run.ring.speed = SPEED * 130.0 / 20.0;
    retreats(run, Fault::Centrifugal, 1.0);
}

#[test]
fn a_ring_that_cannot_be_moved_exhausts_the_pushes() {
    let mut p = P;
    p.limits.pushes = 3;
    let mut ring = Ring::new(4, 1e-4, 0.0);
    ring.compliance = 1e-3;
    let run = retreats(Loop::new(&p, ring), Fault::PushBudget, 60.0);
    assert_eq!(run.output.push.count, 3);
}

#[test]
fn a_tolerance_below_the_resolution_of_the_probe_is_reported() {
    let mut p = Parameters::START;
    p.tolerance = 1e-9;
    let run = retreats(Loop::new(&p, Ring::new(6, 1e-4, 0.5)), Fault::Unresolved, 60.0);
    assert!(run.output.eccentricity_std > p.tolerance);
    assert!(run.ring.eccentricity() < 5e-7, "{} m", run.ring.eccentricity());
}

#[test]
fn pushes_that_move_the_ring_aside_are_given_up() {
    // the surface of a ring 20 mm off comes at 42 mm/s, the paper's push goes at 3.5 mm/s
    let mut run = Loop::new(&P, Ring::new(4, 0.02, 0.0));
    assert!(run.run_to(State::Fault, 60.0), "{:?}", run.output);
    assert_eq!((run.output.fault, run.output.push.count), (Fault::Divergence, 1));
}

#[test]
fn a_spindle_that_stops_moves_nothing_by_either_law() {
    for p in [Parameters::PAPER, Parameters::START] {
        for (state, samples) in [(State::Collect, 0), (State::Collect, 700), (State::Wait, 0)] {
            let mut run = running(&p, state);
            (0..samples).for_each(|_| run.step());
            run.ring.speed = 0.0;
            let center = run.ring.center;
            while run.output.state != State::Fault {
                run.step();
                assert!(finite(&run.output) && run.output.state != State::Push, "{:?}", run.output);
            }
            assert_eq!((run.output.fault, run.ring.center), (Fault::SpindleFrozen, center));
        }
    }
}

#[test]
fn a_spindle_that_stops_or_reverses_for_ever_has_a_name() {
    for state in [State::Collect, State::Wait] {
        let mut run = running(&P, state);
        run.ring.speed = 0.0;
        retreats(run, Fault::SpindleFrozen, 1.6);
        let mut run = running(&P, state);
        let begin = run.time();
        while run.output.state != State::Fault {
            run.ring.speed = SPEED * (4.0 * (run.time() - begin)).cos();
            run.step();
            assert!(run.time() < begin + 10.0, "{:?}", run.output);
        }
        assert_eq!(run.output.fault, Fault::SpindleUneven);
    }
    // it never turned
    let mut ring = Ring::new(5, 2e-4, 0.5);
    ring.speed = 0.0;
    retreats(Loop::new(&P, ring), Fault::SpindleFrozen, 5.0);
}

#[test]
fn a_spindle_that_reverses_once_while_waiting_is_used_in_its_new_direction() {
    let mut run = running(&P, State::Wait);
    run.ring.speed = -SPEED;
    assert!(run.run_to(State::Centered, 90.0), "{:?}", run.output);
    assert!(run.ring.eccentricity() <= 2.65e-6);
}

#[test]
fn a_wrapped_angle_gives_the_same_as_an_unwrapped_one() {
    let trace = |unwrapped: bool| {
        let mut run = Loop::new(&P, Ring::new(6, 2e-4, 0.5));
        let mut revolutions = 0.0;
        let mut before = 0.0;
        while run.output.state != State::Centered {
            run.step_with(|input| {
                revolutions += if input.spindle_angle < before - 3.0 { TAU } else { 0.0 };
                before = input.spindle_angle;
                input.spindle_angle += if unwrapped { revolutions } else { 0.0 };
            });
        }
        run.output.time_to_center
    };
    assert_eq!(trace(false), trace(true));
}

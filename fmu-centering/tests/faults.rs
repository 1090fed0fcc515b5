//! Faults and hostile inputs on the ring: the named fault, a safe motion, finite outputs.

mod ring;

use std::f64::consts::TAU;

use fmu_centering::controller::Controller;
use fmu_centering::interface::Parameters;
use fmu_centering::interface::{Fault, State};
use fmu_centering::interface::{Input, Output};
use rand::{RngExt, SeedableRng};
use ring::closed_loop::Loop;
use ring::{Ring, SPEED};

const P: Parameters = Parameters::PAPER;

fn finite(o: &Output) -> bool {
    let reals = [
        o.slide.position_setpoint,
        o.slide.velocity_setpoint,
        o.time_to_centre,
        o.eccentricity,
        o.eccentricity_angle,
        o.eccentricity_sigma,
        o.spindle_speed,
        o.pusher_gap,
        o.push.distance,
        o.push.velocity,
        o.push.lead_angle,
        o.push.offset,
        o.push.overshoot,
        o.push.overshoot_max,
    ];
    reals.iter().all(|x| x.is_finite())
}

/// A loop in `state`, with a ring 0.2 mm off.
fn running(state: State) -> Loop {
    running_with(&P, state)
}

fn running_with(p: &Parameters, state: State) -> Loop {
    let mut run = Loop::new(p, Ring::new(1, 2e-4, 0.5));
    assert!(run.run_to(state, 60.0), "{:?}", run.output);
    run
}

/// Steps to the fault and checks that the slide then goes back to where it started, without touching the ring again.
fn retreats(mut run: Loop, fault: Fault, within: f64) -> Loop {
    let limit = run.time() + within;
    assert!(run.run_to(State::Fault, limit), "{:?}", run.output);
    assert_eq!(run.output.fault, fault);
    let (centre, mut before) = (run.ring.centre, run.output.slide);
    for k in 0..3000 {
        run.step();
        assert!(finite(&run.output));
        assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
        let step = run.output.slide.velocity_setpoint - before.velocity_setpoint;
        assert!(step.abs() <= 2.57e-3, "step {k}: velocity jumps by {step} m/s");
        before = run.output.slide;
    }
    let moved = (run.ring.centre[0] - centre[0]).hypot(run.ring.centre[1] - centre[1]);
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
    for state in [State::Follow, State::Collect, State::Wait, State::Settle, State::Centred] {
        let mut run = running(state);
        run.ring.present = false;
        let run = retreats(run, Fault::NoPart, 0.5);
        assert!(run.time() < 60.0);
    }
}

#[test]
fn a_ring_that_disappears_ends_a_push_of_either_mode() {
    for p in [Parameters::PAPER, Parameters::START] {
        let mut run = running_with(&p, State::Push);
        run.ring.present = false;
        retreats(run, Fault::NoPart, 0.5);
    }
}

#[test]
fn a_probe_that_bounces_for_a_moment_spoils_no_model() {
    let mut run = running(State::Collect);
    let begin = run.time();
    while run.output.state == State::Collect {
        let free = (0.5..0.58).contains(&(run.time() - begin));
        run.step_with(|input| input.probe_position *= f64::from(u8::from(!free)));
    }
    assert!(run.run_to(State::Wait, begin + 4.0), "{:?}", run.output);
    assert!((run.output.eccentricity - run.ring.eccentricity()).abs() < 0.5e-6, "{:?}", run.output);
}

#[test]
fn a_spindle_axis_outside_the_ring_is_too_small_a_ring() {
    // the operator tells the wrong ring: 0.1 mm instead of 50 mm
    let mut p = P;
    p.ring.radius = 1e-3;
    p.ring.eccentricity_max = 0.9e-3;
    retreats(Loop::new(&p, Ring::new(2, 1.5e-3, 0.0)), Fault::RingTooSmall, 20.0);
}

#[test]
fn a_ring_that_does_not_contain_the_axis_is_lost_on_the_way() {
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
fn a_frozen_probe_is_an_invalid_input_and_never_a_centred_ring() {
    for (p, pushes) in [(P, 0), (P, 1), (Parameters::START, 0), (Parameters::START, 1)] {
        let mut run = running_with(&p, State::Collect);
        while run.output.push.count < pushes || run.output.state != State::Collect {
            run.step();
        }
        let (frozen, begin) = (run.output.pusher_gap, run.time());
        while run.output.state != State::Fault {
            run.step_with(|input| input.probe_position = p.probe.at_pusher - frozen);
            assert!(!run.output.centred && run.time() < begin + 4.0, "{pushes}: {:?}", run.output);
        }
        assert_eq!(run.output.fault, Fault::InvalidInput);
    }
}

#[test]
fn a_probe_beyond_its_stroke() {
    let mut run = running(State::Wait);
    run.step_with(|input| input.probe_position = 0.0251);
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
fn a_tolerance_below_what_the_probe_can_tell_has_a_name() {
    let mut p = Parameters::START;
    p.tolerance = 1e-9;
    let run = retreats(Loop::new(&p, Ring::new(6, 1e-4, 0.5)), Fault::Unresolved, 60.0);
    assert!(run.output.eccentricity_sigma > p.tolerance);
    assert!(run.ring.eccentricity() < 5e-7, "{} m", run.ring.eccentricity());
}

#[test]
fn pushes_that_shove_the_ring_aside_are_given_up() {
    // the surface of a ring 20 mm off comes at 42 mm/s, the paper's push goes at 3.5 mm/s
    let mut run = Loop::new(&P, Ring::new(4, 0.02, 0.0));
    assert!(run.run_to(State::Fault, 60.0), "{:?}", run.output);
    assert_eq!((run.output.fault, run.output.push.count), (Fault::Diverged, 1));
}

#[test]
fn a_spindle_that_stops_or_reverses_for_ever_has_a_name() {
    for state in [State::Collect, State::Wait] {
        let mut run = running(state);
        run.ring.speed = 0.0;
        retreats(run, Fault::Spindle, 1.6);
        let mut run = running(state);
        let begin = run.time();
        while run.output.state != State::Fault {
            run.ring.speed = SPEED * (4.0 * (run.time() - begin)).cos();
            run.step();
            assert!(run.time() < begin + 10.0, "{:?}", run.output);
        }
        assert_eq!(run.output.fault, Fault::Spindle);
    }
    // it never turned
    let mut ring = Ring::new(5, 2e-4, 0.5);
    ring.speed = 0.0;
    retreats(Loop::new(&P, ring), Fault::Spindle, 5.0);
}

#[test]
fn a_spindle_that_reverses_once_while_waiting_is_used_in_its_new_direction() {
    let mut run = running(State::Wait);
    run.ring.speed = -SPEED;
    assert!(run.run_to(State::Centred, 90.0), "{:?}", run.output);
    assert!(run.ring.eccentricity() <= 2.65e-6);
}

#[test]
fn a_wrapped_angle_gives_the_same_as_an_unwrapped_one() {
    let trace = |unwrapped: bool| {
        let mut run = Loop::new(&P, Ring::new(6, 2e-4, 0.5));
        let mut turns = 0.0;
        let mut before = 0.0;
        while run.output.state != State::Centred {
            run.step_with(|input| {
                turns += if input.spindle_angle < before - 3.0 { TAU } else { 0.0 };
                before = input.spindle_angle;
                input.spindle_angle += if unwrapped { turns } else { 0.0 };
            });
        }
        run.output.time_to_centre
    };
    assert_eq!(trace(false), trace(true));
}

#[test]
fn nonsense_from_any_encoder_is_an_invalid_input() {
    for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        for state in [State::Approach, State::Collect, State::Wait, State::Push, State::Centred] {
            let mut run = running(state);
            run.step_with(|input| input.probe_position = nonsense);
            retreats(run, Fault::InvalidInput, 0.0);
            let mut run = running(state);
            run.step_with(|input| input.spindle_angle = nonsense);
            retreats(run, Fault::InvalidInput, 0.0);
        }
    }
}

#[test]
fn a_slide_that_does_not_know_where_it_is_stops() {
    for state in [State::Approach, State::Push] {
        let mut run = running(state);
        for k in 0..1000 {
            run.step_with(|input| input.slide_position = f64::NAN);
            assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::InvalidInput));
            assert!(finite(&run.output) && (k < 60 || run.output.slide.velocity_setpoint == 0.0));
        }
    }
}

#[test]
fn a_jump_of_an_encoder_is_an_invalid_input_but_not_while_idle() {
    let mut run = running(State::Wait);
    run.step_with(|input| input.spindle_angle += 2.0);
    retreats(run, Fault::InvalidInput, 0.0);
    let mut run = running(State::Collect);
    run.step_with(|input| input.slide_position += 0.01);
    retreats(run, Fault::InvalidInput, 0.0);
    let mut controller = Controller::new(&P).unwrap();
    controller.tick(&P, 0.0, &Input::START);
    let elsewhere = Input { slide_position: 0.3, spindle_angle: 2.0, ..Input::START };
    let output = controller.tick(&P, 1e-3, &elsewhere);
    assert_eq!((output.state, output.slide.position_setpoint), (State::Idle, 0.3));
}

#[test]
fn without_enable_it_stops_and_goes_back_from_every_state() {
    for state in [State::Approach, State::Follow, State::Collect, State::Wait, State::Push, State::Settle] {
        let mut run = running(state);
        let mut before = run.output.slide.velocity_setpoint;
        for k in 0..3000 {
            run.step_with(|input| input.enable = false);
            assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
            let step = run.output.slide.velocity_setpoint - before;
            assert!(step.abs() <= 2.57e-3, "{state:?}, step {k}: velocity jumps by {step} m/s");
            before = run.output.slide.velocity_setpoint;
        }
        assert!(run.output.slide.position_setpoint.abs() < 1e-6 && before == 0.0);
    }
}

#[test]
fn enable_that_drops_in_a_push_ends_the_push_at_once() {
    let mut run = running(State::Push);
    (0..20).for_each(|_| run.step());
    let from = run.output.slide.position_setpoint;
    let mut furthest: f64 = from;
    for _ in 0..1000 {
        run.step_with(|input| input.enable = false);
        furthest = furthest.max(run.output.slide.position_setpoint);
    }
    assert!(furthest - from < 2e-6, "{} m", furthest - from);
}

#[test]
fn enable_again_on_the_way_back_begins_anew() {
    let mut run = running(State::Wait);
    (0..100).for_each(|_| run.step_with(|input| input.enable = false));
    run.step();
    assert_eq!(run.output.state, State::Approach);
    assert!(run.run_to(State::Centred, 90.0), "{:?}", run.output);
    (0..3000).for_each(|_| run.step_with(|input| input.enable = false));
    assert!(run.output.slide.position_setpoint.abs() < 1e-6, "{} m", run.output.slide.position_setpoint);
}

#[test]
fn a_fault_ends_with_reset_and_then_needs_a_new_enable() {
    let mut run = running(State::Wait);
    run.step_with(|input| input.probe_position = f64::NAN);
    (0..100).for_each(|_| run.step_with(|input| input.enable = false));
    (0..100).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Fault);
    run.step_with(|input| input.reset_fault = true);
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::InvalidInput));
    (0..100).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Idle, "enable has no edge");
    run.step_with(|input| input.enable = false);
    run.step();
    assert_eq!((run.output.state, run.output.fault), (State::Approach, Fault::None));
    assert!(run.run_to(State::Centred, 90.0));
}

#[test]
fn a_fault_that_is_still_there_is_not_reset() {
    let mut run = running(State::Wait);
    for k in 0..100 {
        run.step_with(|input| {
            input.probe_position = f64::NAN;
            input.reset_fault = k % 2 == 1;
        });
        assert_eq!(run.output.state, State::Fault);
    }
}

#[test]
fn nonsense_before_the_first_good_sample_moves_nothing() {
    let mut controller = Controller::new(&P).unwrap();
    let good = Input { slide_position: 0.2, ..Input::START };
    let blind = Input { slide_position: f64::NAN, ..good.clone() };
    assert_eq!(controller.tick(&P, 0.0, &blind).state, State::Fault);
    for _ in 0..100 {
        let output = controller.tick(&P, 0.0, &good);
        assert_eq!((output.slide.position_setpoint, output.slide.velocity_setpoint), (0.2, 0.0));
    }
}

/// Whatever comes in, what goes out is finite and within the limits.
#[test]
fn hostile_inputs_never_give_a_wild_output() {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(7);
    let mut controller = Controller::new(&P).unwrap();
    let wild = [f64::NAN, f64::INFINITY, -1e308, 1e3, -1e3, 100.0, 0.0, 5e-324, 1e-9, 0.02, 0.0195, 3.0];
    let mut seen = [0; 10];
    for k in 0..400_000 {
        let calm = (k / 4000) % 2 == 0;
        let mut pick = |calm_value: f64| if calm { calm_value } else { wild[random.random_range(0..wild.len())] };
        let input = Input {
            spindle_angle: pick(2e-3 * f64::from(k)),
            slide_position: pick(0.08),
            probe_position: pick(0.0195),
            enable: random.random_bool(if calm { 0.999 } else { 0.5 }),
            reset_fault: random.random_bool(0.5),
        };
        let output = controller.tick(&P, f64::from(k) * 1e-3, &input);
        assert!(finite(&output), "sample {k}: {output:?}");
        assert!(output.slide.velocity_setpoint.abs() <= P.slide.velocity_max + 1e-12);
        seen[output.state as usize - 1] += 1;
    }
    println!("samples in each state: {seen:?}");
    assert!(seen[9] > 0 && seen[3] > 0);
}

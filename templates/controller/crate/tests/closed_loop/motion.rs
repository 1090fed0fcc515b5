//! The motion to the target, both control laws, and the end of `enable`.

use fmu___name__::interface::{Parameters, State};

use crate::run::{FRICTION, Loop};

#[test]
fn the_slide_arrives_and_recovers_from_a_load() {
    let p = Parameters::START;
    let mut run = Loop::new(&p);
    assert!(run.run_to(State::Done, 2.0), "{:?}", run.output);
    run.slide.load = -5.0;
    (0..1000).for_each(|_| run.step());
    assert!((run.slide.position - p.motion.target).abs() <= p.settle.band, "{:?}", run.output);
    assert_eq!(run.output.state, State::Done);
}

#[test]
fn the_published_variant_leaves_friction_over_stiffness() {
    let p = Parameters::PAPER;
    let mut run = Loop::new(&p);
    assert!(!run.run_to(State::Done, 2.0));
    let limit = FRICTION / (p.slide.mass * p.servo.bandwidth.powi(2));
    let error = run.output.following_error;
    assert!(error > p.settle.band && error <= limit, "{error} m, limit {limit} m");
    assert_eq!(run.output.state, State::Run);
}

#[test]
fn without_enable_the_slide_stops_and_the_next_edge_continues() {
    let p = Parameters::START;
    let mut run = Loop::new(&p);
    (0..500).for_each(|_| run.step());
    let from = run.slide.position;
    (0..300).for_each(|_| run.step_with(|input| input.enable = false));
    let distance = run.slide.position - from;
    assert!(distance > 0.0 && distance < p.motion.velocity_max * p.motion.stop_time, "{distance} m");
    assert_eq!((run.output.state, run.slide.velocity), (State::Idle, 0.0));
    assert!(run.run_to(State::Done, 3.0), "{:?}", run.output);
}

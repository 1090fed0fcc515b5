//! The way to the target, both laws, and the end of `enable`.

use fmu___name__::interface::{Parameters, State};

use crate::run::{FRICTION, Loop};

#[test]
fn the_slide_arrives_and_a_load_does_not_move_it_for_long() {
    let p = Parameters::START;
    let mut run = Loop::new(&p);
    assert!(run.run_to(State::Done, 2.0), "{:?}", run.output);
    run.slide.load = -5.0;
    (0..1000).for_each(|_| run.step());
    assert!((run.slide.position - p.motion.target).abs() <= p.settle.band, "{:?}", run.output);
    assert_eq!(run.output.state, State::Done);
}

#[test]
fn the_law_of_the_paper_leaves_friction_over_stiffness() {
    let p = Parameters::PAPER;
    let mut run = Loop::new(&p);
    assert!(!run.run_to(State::Done, 2.0));
    let most = FRICTION / (p.slide.mass * p.servo.bandwidth.powi(2));
    let error = run.output.following_error;
    assert!(error > p.settle.band && error <= most, "{error} m, at most {most} m");
    assert_eq!(run.output.state, State::Run);
}

#[test]
fn without_enable_the_slide_stops_on_the_way_and_the_next_edge_goes_on() {
    let p = Parameters::START;
    let mut run = Loop::new(&p);
    (0..500).for_each(|_| run.step());
    let from = run.slide.position;
    (0..300).for_each(|_| run.step_with(|input| input.enable = false));
    let way = run.slide.position - from;
    assert!(way > 0.0 && way < p.motion.velocity_max * p.motion.stop_time, "{way} m");
    assert_eq!((run.output.state, run.slide.velocity), (State::Idle, 0.0));
    assert!(run.run_to(State::Done, 3.0), "{:?}", run.output);
}

//! The force guard in addition to the detector, and forces that are no contact.

use fmu_dob::interface::{ContactSource, Fault, Parameters, State};
use fmu_dob::monitoring::numbers::Unseen;

use crate::faults::{RETRACT, running};
use crate::run::{Loop, NO_WORKPIECE};

#[test]
fn the_cogging_of_the_whole_travel_is_no_contact() {
    let mut p = Parameters::START;
    p.approach.velocity = 1e-3;
    for seed in 40..45 {
        let mut run = running(&p, seed, State::Detect);
        assert!(run.run_to(State::Fault, 6.0), "{:?}", run.output);
        assert_eq!(run.output.fault, Fault::TravelLimit);
    }
}

/// The guard stops the approach, and the cycle does not end in `Done` after the retract.
fn caught_and_reported(run: &mut Loop) {
    assert!(run.run_to(State::Contact, 3.0), "{:?}", run.output);
    assert_eq!(run.output.contact_source, ContactSource::ForceGuard);
    assert!(run.run_to(State::Fault, 3.0), "{:?}", run.output);
    assert_eq!((run.output.fault, run.output.drive_enable, run.output.contact), (Fault::LateContact, true, false));
}

#[test]
fn a_workpiece_so_soft_that_it_is_detected_late_is_never_done() {
    let (p, stiffness) = (Parameters::START, 5e3);
    let mut run = Loop::new(&p, 24, p.approach.velocity * p.learn.settle_time);
    run.slide.stiffness = stiffness;
    caught_and_reported(&mut run);
    let details = run.output.numbers.late.unwrap();
    assert_eq!(details.unseen, Unseen::Unarmed);
    // the force of the guard
    assert!((p.guard_force..1.2 * p.guard_force).contains(&details.force), "{details:?}");
    // 40 um on two flutes
    let sensed = p.guard_force / (2.0 * stiffness);
    assert!((0.8 * sensed..1.2 * sensed).contains(&run.slide.depth), "{} m", run.slide.depth);
}

#[test]
fn contact_before_the_detector_is_armed_is_caught_by_the_guard() {
    let p = Parameters::START;
    let mut deepest = 0.0;
    for k in 0..60 {
        let ratio = 0.1 + 0.88 * f64::from(k) / 60.0;
        let surface = p.approach.velocity * (p.learn.settle_time + ratio * p.learn.time);
        let mut run = Loop::new(&p, 1500 + k as u64, surface);
        caught_and_reported(&mut run);
        deepest = f64::max(deepest, run.slide.depth);
    }
    println!("contact while learning: depth at most {deepest} m");
    assert!(deepest <= 1.5e-6, "depth {deepest} m");
}

#[test]
fn a_contact_that_the_armed_detector_has_missed_is_detected_after_the_retract() {
    let mut run = running(&Parameters::START, 30, State::Detect);
    // too slow for every slope
    while run.output.state == State::Detect {
        run.slide.push += 1e-5;
        run.step();
    }
    assert_eq!((run.output.state, run.output.contact_source), (State::Contact, ContactSource::ForceGuard));
    let from = run.output.reference.position;
    run.slide.push = 0.0;
    assert!(run.run_to(State::Fault, run.time() + 1.0), "{:?}", run.output);
    assert_eq!((run.output.fault, run.output.drive_enable, run.output.contact), (Fault::LateContact, true, false));
    assert_eq!(run.output.numbers.late.unwrap().unseen, Unseen::Missed);
    assert!((run.output.numbers.late.unwrap().position - from).abs() < 1e-6, "{:?} {from}", run.output.numbers);
    let distance = from - run.output.reference.position;
    assert!((distance - RETRACT).abs() < 0.2e-6, "retreat of {distance} m");
}

#[test]
fn contact_while_settling_is_caught_by_the_guard() {
    // from the first instant of the motion on; 1 mm/s with a few micrometers of delay
    for (velocity, deepest) in [(10e-6, 2.2e-6), (100e-6, 2.6e-6), (1e-3, 6e-6)] {
        let mut p = Parameters::START;
        p.approach.velocity = velocity;
        for (time, seed) in [(0.0, 19), (0.005, 20), (0.05, 21), (0.15, 22), (0.22, 23)] {
            let mut run = Loop::new(&p, seed, velocity * time);
            caught_and_reported(&mut run);
            println!("{velocity} m/s, contact after {time} s: depth {} m", run.slide.depth);
            assert!(run.slide.depth <= deepest, "{velocity} m/s, {time} s: depth {} m", run.slide.depth);
        }
    }
}

#[test]
fn the_guard_compares_with_the_second_half_of_settling() {
    let mut run = running(&Parameters::START, 18, State::Approach);
    // a pull of 0.9 N that is gone after 0.1 of 0.25 s
    for k in 0..1000 {
        run.slide.push = -0.9 * f64::min(1.0, f64::from(k.min(1000 - k)) / 300.0);
        run.step();
    }
    run.slide.push = 0.0;
    assert!(run.run_to(State::Detect, 2.0), "{:?}", run.output);
}

#[test]
fn a_push_while_the_force_at_rest_is_taken_is_no_contact() {
    let mut run = Loop::new(&Parameters::START, 34, NO_WORKPIECE);
    assert!(run.run_to(State::Approach, 1.0));
    run.slide.push = 2.0;
    for _ in 0..150 {
        run.step();
        assert_eq!(run.output.state, State::Approach, "{:?}", run.output);
    }
}

#[test]
fn inertia_is_allowed_for_at_the_start_alone() {
    let mut run = running(&Parameters::START, 35, State::Approach);
    // 50 ms later the 0.15 N of the acceleration count no more
    (0..500).for_each(|_| run.step());
    for k in 0..700 {
        run.slide.push = 0.48 * f64::min(1.0, f64::from(k) / 500.0);
        run.step();
    }
    assert_eq!(run.output.contact_source, ContactSource::ForceGuard, "{:?}", run.output);
}

//! Complete cycles on the quasi-static ring, in both directions, from any start.

use fmu_centering::interface::{Fault, Parameters, State};

use crate::ring::{Ring, SPEED};
use crate::run::Loop;

/// A ring centered; it must be.
fn centered(p: &Parameters, ring: Ring) -> Loop {
    let mut run = Loop::new(p, ring);
    let done = run.run_to(State::Centered, 90.0);
    assert!(done, "{:?}, actual {} m", run.output, run.ring.eccentricity());
    run
}

#[test]
fn the_papers_law_centers_rings_up_to_0_6_mm() {
    for seed in 0..12 {
        let (eccentricity, phase) = (1e-4 + 5e-4 * seed as f64 / 11.0, 0.5 * seed as f64);
        let run = centered(&Parameters::PAPER, Ring::new(seed, eccentricity, phase));
        let true_eccentricity = run.ring.eccentricity();
        println!(
            "{:.0} um: {:.1} s, {} pushes, overshoot {:.1} um, {:.2} um, actual {:.2} um",
            1e6 * eccentricity,
            run.output.time_to_center,
            run.output.push.count,
            1e6 * run.output.push.overshoot_max,
            1e6 * run.output.eccentricity,
            1e6 * true_eccentricity
        );
        assert!(true_eccentricity <= 2.5e-6 + 0.15e-6, "{true_eccentricity} m");
        assert!((run.output.eccentricity - true_eccentricity).abs() < 0.15e-6);
        assert!(run.longest_wait <= 1.1, "{} revolutions", run.longest_wait);
        assert!(run.output.time_to_center <= 60.0, "{} s", run.output.time_to_center);
        assert!(run.output.push.overshoot_max < 25e-6);
    }
}

#[test]
fn the_approach_goes_over_into_following_without_braking_twice() {
    let mut run = Loop::new(&Parameters::PAPER, Ring::new(7, 3e-4, 1.0));
    assert!(run.run_to(State::Follow, 2.0));
    let mut before = run.output.slide.velocity_setpoint;
    // brakes to `follow.velocity_max` from the first sample on
    assert!((before - (0.12 - 2.56e-3)).abs() < 1e-12, "{before} m/s");
    while run.output.state == State::Follow {
        run.step();
        let now = run.output.slide.velocity_setpoint;
        assert!(now <= before + 2e-4, "from {before} to {now} m/s");
        assert!(run.ring.gap() > 4.5e-4, "{} m", run.ring.gap());
        before = now;
    }
}

#[test]
fn a_centered_ring_is_not_pushed() {
    let run = centered(&Parameters::PAPER, Ring::new(1, 1e-6, 0.3));
    assert_eq!(run.output.push.count, 0);
    assert!(run.output.time_to_center < 6.0, "{} s", run.output.time_to_center);
}

#[test]
fn after_centering_it_follows_and_waits_for_enable() {
    let mut run = centered(&Parameters::PAPER, Ring::new(2, 1e-4, 0.3));
    let time = run.output.time_to_center;
    for _ in 0..5000 {
        run.step();
        assert_eq!((run.output.state, run.output.time_to_center), (State::Centered, time));
        assert!((run.ring.gap() - 5e-4).abs() < 2e-5, "{} m", run.ring.gap());
    }
    (0..2000).for_each(|_| run.step_with(|input| input.enable = false));
    assert!(run.output.state == State::Idle && run.output.centered);
    assert_eq!(run.output.slide.velocity_setpoint, 0.0);
    assert!(run.output.slide.position_setpoint.abs() < 1e-6, "back where it was");
    // again
    run.step();
    assert!(run.output.state == State::Approach && !run.output.centered && run.output.push.count == 0);
    assert!(run.run_to(State::Centered, 60.0));
    assert_eq!(run.output.push.count, 0);
}

#[test]
fn reverse_rotation_is_the_mirror() {
    let mirrored = |sign: f64| {
        let mut ring = Ring::new(3, 4e-4, sign * 0.9);
        ring.speed *= sign;
        ring.lobe_phase *= sign;
        let run = centered(&Parameters::PAPER, ring);
        (run.output, run.ring.center)
    };
    let (forth, back) = (mirrored(1.0), mirrored(-1.0));
    assert_eq!(forth.0.push.count, back.0.push.count);
    assert!((forth.0.time_to_center - back.0.time_to_center).abs() < 1e-3);
    assert!((forth.0.spindle_speed + back.0.spindle_speed).abs() < 1e-3);
    assert!((forth.0.eccentricity - back.0.eccentricity).abs() < 0.05e-6);
    assert!((forth.1[0] - back.1[0]).abs() < 0.05e-6 && (forth.1[1] + back.1[1]).abs() < 0.05e-6);
}

#[test]
fn slow_and_fast_spindles_are_centered_without_a_longer_wait() {
    for rpm in [5.0, 13.7, 20.0, 33.3, 45.0, -45.0] {
        let mut ring = Ring::new(4, 3e-4, 2.0);
        ring.speed = SPEED * rpm / 20.0;
        let mut run = Loop::new(&Parameters::PAPER, ring);
        assert!(run.run_to(State::Centered, 300.0), "{rpm} rpm: {:?}", run.output);
        assert!(run.longest_wait <= 1.1, "{rpm} rpm: {} revolutions", run.longest_wait);
    }
}

#[test]
fn what_the_paper_does_not_do_ends_with_a_name() {
    // a heavy ring on a soft servo: the loss is larger than the limit of what may be learned
    let mut ring = Ring::new(6, 1.5e-4, 1.0);
    ring.compliance = 4e-4;
    let mut run = Loop::new(&Parameters::PAPER, ring);
    assert!(run.run_to(State::Fault, 300.0), "{:?}", run.output);
    assert_eq!(run.output.fault, Fault::PushBudget);
    assert_eq!(run.output.push.count, 25);
}

//! Tips that bend before the ball slides: what is measured of it, and what K_v makes of it.

use fmu_polish::interface::{Fault, Mode, Parameters, State};
use nalgebra::Vector3;

use crate::robot::Build;
use crate::run::Loop;

const P: Parameters = Parameters::START;

/// On the path: the mean speed (m/s) at which the ball actually slides in the last second and as it is measured, and what
/// is added to K_v (m/s).
fn slides(p: &Parameters, build: Build) -> (f64, f64, f64) {
    let mut run = Loop::new(p, build, 600);
    assert!(run.run_to(State::Follow, 5.0));
    (0..1000).for_each(|_| run.step());
    let (before, mut measured) = (run.robot.slid, 0.0);
    for _ in 0..1000 {
        run.step();
        measured += 1e-3 * run.output.sliding.speed;
    }
    assert_eq!(run.output.state, State::Follow, "{:?}", run.output.fault);
    (run.robot.slid - before, measured, run.output.sliding.added)
}

fn tip(lateral: f64, friction: f64) -> Build {
    Build { lateral, friction, ..Build::NOMINAL }
}

#[test]
fn the_speed_is_measured_on_any_tip_and_without_its_stiffness() {
    let mut p = P;
    p.stick_slip.sliding = 0.0;
    for (lateral, friction) in [(209e3, 0.1), (209e3, 0.4), (100e3, 0.2), (60e3, 0.2), (60e3, 0.4), (30e3, 0.3)] {
        let (actual, measured, added) = slides(&p, tip(lateral, friction));
        assert!((measured / actual - 1.0).abs() < 0.15, "{lateral} {friction}: {measured} {actual}");
        assert_eq!(added, 0.0);
    }
}

#[test]
fn a_soft_tip_slides_by_more_velocity_and_a_good_one_as_it_is() {
    assert_eq!(slides(&P, Build::NOMINAL).2, 0.0);
    for (lateral, friction) in [(100e3, 0.4), (60e3, 0.4), (50e3, 0.3)] {
        let (actual, _, added) = slides(&P, tip(lateral, friction));
        assert!((5.5e-3..7e-3).contains(&actual) && added > 1e-3, "{lateral} {friction}: {actual} {added}");
    }
}

#[test]
fn friction_is_reported_in_newton() {
    let mut run = Loop::new(&P, tip(100e3, 0.3), 601);
    assert!(run.run_to(State::Follow, 5.0));
    assert_eq!((run.output.sliding.speed, run.output.sliding.friction), (0.0, 0.0));
    (0..1000).for_each(|_| run.step());
    assert!((run.output.sliding.friction - 1.5).abs() < 0.1, "{:?}", run.output.sliding);
}

#[test]
fn a_ball_that_never_slides_is_named_with_its_numbers() {
    let mut p = P;
    // the paper's 500 Hz
    p.stick_slip.half_period = 1;
    let mut run = Loop::new(&p, Build::NOMINAL, 602);
    assert!(run.run_to(State::Follow, 5.0));
    let begin = run.time();
    assert!(run.run_to(State::Fault, 20.0));
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::NoSliding, true));
    let (sliding, after) = (run.output.sliding, run.time() - begin);
    assert!(sliding.added == p.stick_slip.velocity_max - p.stick_slip.velocity, "{sliding:?}");
    // 0.6 s to raise it by 10 mm/s, one to see that it does not help
    assert!((1.5..3.0).contains(&after) && sliding.speed < 3e-3, "{after} s: {sliding:?}");
}

#[test]
fn without_a_desired_speed_and_with_a_ratio_nothing_is_raised_nor_named() {
    let changes: [fn(&mut Parameters); 4] = [
        |p| p.stick_slip.sliding = 0.0,
        |p| p.stick_slip.ratio = 1.0,
        |p| p.stick_slip.mode = Mode::Off,
        |p| p.stick_slip.velocity = 0.0,
    ];
    for change in changes {
        let mut p = P;
        change(&mut p);
        let mut run = Loop::new(&p, tip(30e3, 0.4), 603);
        assert!(run.run_to(State::Unload, 20.0), "{:?}", run.output.fault);
        assert_eq!(run.output.sliding.added, 0.0);
    }
}

#[test]
fn no_more_is_added_than_the_feed_leaves_of_slow_drives() {
    let mut p = P;
    p.velocity_max = 0.015;
    let mut run = Loop::new(&p, tip(30e3, 0.4), 606);
    let mut maximum: f64 = 0.0;
    while !matches!(run.output.state, State::Fault | State::Unload) {
        run.step();
        maximum = maximum.max(run.output.sliding.added);
    }
    assert!((maximum - (p.velocity_max - p.feed.velocity - p.stick_slip.velocity)).abs() < 1e-12, "{maximum}");
}

#[test]
fn a_friction_that_is_not_sensed_says_nothing() {
    let mut run = Loop::new(&P, tip(30e3, 0.04), 604);
    assert!(run.run_to(State::Unload, 20.0), "{:?}", run.output.fault);
    assert_eq!(run.output.sliding.added, 0.0);
}

#[test]
fn a_new_cycle_starts_with_the_configured_values() {
    let mut run = Loop::new(&P, tip(60e3, 0.4), 605);
    assert!(run.run_to(State::Done, 20.0));
    assert!(run.output.sliding.added > 1e-3);
    run.input.enable = false;
    assert!(run.run_to(State::Idle, 20.0));
    run.robot = Loop::new(&P, tip(60e3, 0.4), 605).robot;
    (0..5).for_each(|_| run.step());
    run.input.enable = true;
    assert!(run.run_to(State::Follow, 30.0), "{:?}", run.output.fault);
    assert_eq!(run.output.sliding.added, 0.0);
}

fn circular() -> Parameters {
    let mut p = P;
    p.stick_slip.mode = Mode::Circular;
    p
}

#[test]
fn a_circle_slides_half_as_far_again_and_more_the_softer_the_tip_and_the_force_stays() {
    for (lateral, friction, minimum) in [(209e3, 0.2, 1.57), (100e3, 0.2, 1.65), (60e3, 0.2, 1.8)] {
        let cycles = [&P, &circular()].map(|p| {
            let mut p = p.clone();
            p.stick_slip.sliding = 0.0;
            Loop::new(&p, tip(lateral, friction), 610).cycle(20.0).unwrap()
        });
        let [line, circle] = cycles;
        assert!(circle.gain > minimum * line.gain, "{lateral} {friction}: {line:?} {circle:?}");
        assert!(circle.deviation < 0.056 && circle.minimum > 4.7, "{lateral} {friction}: {circle:?}");
    }
}

#[test]
fn a_circle_is_measured_and_raised_where_the_tip_is_soft() {
    for (lateral, friction) in [(209e3, 0.2), (60e3, 0.4), (30e3, 0.3)] {
        let (actual, measured, _) = slides(&circular(), tip(lateral, friction));
        assert!((measured / actual - 1.0).abs() < 0.2 && actual > 5.4e-3, "{lateral} {friction}: {measured} {actual}");
    }
}

#[test]
fn a_ball_that_sticks_on_a_circle_is_named() {
    let mut run = Loop::new(&circular(), tip(12e3, 0.4), 611);
    assert!(run.run_to(State::Fault, 20.0), "{:?}", run.output.sliding);
    assert_eq!(run.output.fault, Fault::NoSliding);
    assert!(run.output.sliding.speed < 3e-3, "{:?}", run.output.sliding);
}

#[test]
fn a_sensor_faster_than_configured_causes_no_apparent_sliding_on_a_circle() {
    let mut p = circular();
    for (ratio, lateral, friction) in [(0.55, 22e3, 0.32), (0.6, 30e3, 0.4), (0.55, 16e3, 0.22), (1.0, 22e3, 0.32)] {
        p.sensor_bandwidth = ratio * P.sensor_bandwidth;
        let cycle = Loop::new(&p, tip(lateral, friction), 614).cycle(20.0).unwrap();
        assert!(cycle.gain >= 2.5, "{ratio} {lateral} {friction}: {cycle:?}");
    }
}

#[test]
fn a_circle_is_about_the_path() {
    let mut run = Loop::new(&circular(), Build::NOMINAL, 612);
    assert!(run.run_to(State::Follow, 5.0));
    (0..500).for_each(|_| run.step());
    // whole periods
    let (mut mean, mut maximum) = (0.0, 0.0f64);
    for _ in 0..500 {
        run.step();
        mean += run.output.error.lateral / 500.0;
        maximum = maximum.max(run.output.error.lateral.abs());
    }
    assert!(mean.abs() < 2e-6 && (40e-6..60e-6).contains(&maximum), "{mean} {maximum}");
}

#[test]
fn what_a_sweep_climbs_on_a_displaced_mold_is_learned_as_it_rotates() {
    for p in [P, circular()] {
        let mut learning = p.clone();
        learning.repetitive.ripple_gain = 0.09;
        let build = Build { shift: Vector3::new(1e-4, 0.0, 0.0), ..Build::NOMINAL };
        let [without, with] = [p, learning].map(|p| Loop::new(&p, build, 613).cycle(20.0).unwrap());
        assert!(with.deviation < 0.75 * without.deviation, "{without:?} {with:?}");
    }
}

/// The half period may be raised to `longest` samples; the path takes 8 s.
fn longest(sweep: Mode, longest: i32) -> Parameters {
    let mut p = P;
    (p.stick_slip.mode, p.stick_slip.half_period_max, p.feed.velocity) = (sweep, longest, 1e-3);
    p
}

/// A cycle in which the half period has just been raised.
fn lengthened(p: &Parameters, build: Build, seed: u64) -> Loop {
    let mut run = Loop::new(p, build, seed);
    while run.output.sliding.lengthened == 0 {
        run.step();
        assert!(run.output.state != State::Fault, "{:?}", run.output.fault);
    }
    run
}

#[test]
fn what_slides_too_little_at_the_largest_velocity_slides_in_longer_half_periods() {
    for (sweep, lateral, friction) in [(Mode::Cross, 20e3, 0.4), (Mode::Cross, 12e3, 0.25), (Mode::Circular, 12e3, 0.4)]
    {
        let mut run = Loop::new(&longest(sweep, 0), tip(lateral, friction), 615);
        assert!(!run.run_to(State::Unload, 20.0) && run.output.fault == Fault::NoSliding, "{lateral}");
        let mut run = Loop::new(&longest(sweep, 20), tip(lateral, friction), 615);
        assert!(run.run_to(State::Follow, 5.0));
        let (mut slid, mut forces) = (vec![run.robot.slid], Vec::new());
        while run.output.state == State::Follow {
            run.step();
            slid.push(run.robot.slid);
            forces.push(run.robot.normal_force);
        }
        let last = slid[slid.len() - 1] - slid[slid.len() - 1001];
        let uneven = forces[forces.len() - 1000..].iter().map(|force| (force - 5.0).powi(2)).sum::<f64>() / 1e3;
        // the ripple is learned at the new frequency
        let maximum = if sweep == Mode::Cross { 0.14 } else { 0.21 };
        assert!(uneven.sqrt() < maximum, "{sweep:?} {lateral}: {} N", uneven.sqrt());
        assert_eq!((run.output.fault, run.output.sliding.lengthened), (Fault::None, 10), "{lateral}: {last}");
        assert!(last > 5e-3, "{sweep:?} {lateral} {friction}: {last} m in the last second, {:?}", run.output.sliding);
    }
}

#[test]
fn a_longer_sweep_starts_where_the_short_one_ends_with_the_configured_velocity() {
    // 25 is neither a multiple of the short one nor a part of the sweep before
    let mut run = lengthened(&longest(Mode::Cross, 25), tip(12e3, 0.25), 616);
    assert_eq!(run.output.sliding.added, 0.0);
    // whole periods, before K_v is raised again
    let (mut mean, mut maximum) = (0.0, 0.0f64);
    for _ in 0..150 {
        run.step();
        mean += run.output.error.lateral / 150.0;
        maximum = maximum.max(run.output.error.lateral.abs());
        assert_eq!(run.output.velocity.stick_slip.abs(), 10e-3);
    }
    assert!(mean.abs() < 10e-6 && (60e-6..150e-6).contains(&maximum), "{mean} {maximum}");
}

#[test]
fn a_longer_circle_starts_half_its_width_off_the_path_and_returns() {
    let mut run = lengthened(&longest(Mode::Circular, 20), tip(12e3, 0.4), 619);
    let mut maximum: f64 = 0.0;
    let means: Vec<f64> = (0..25)
        .map(|_| {
            let mut mean = 0.0;
            for _ in 0..40 {
                run.step();
                mean += run.output.error.lateral / 40.0;
                maximum = maximum.max(run.output.error.lateral.abs());
            }
            mean
        })
        .collect();
    assert_eq!((run.output.state, run.output.fault), (State::Follow, Fault::None));
    assert!((60e-6..110e-6).contains(&means[0].abs()) && means[24].abs() < 10e-6, "{means:?}");
    assert!(maximum < P.limits.position_error, "{maximum}");
}

#[test]
fn a_ball_that_sticks_in_the_longest_half_period_too_is_named() {
    let mut run = Loop::new(&longest(Mode::Cross, 20), tip(5e3, 0.4), 617);
    assert!(run.run_to(State::Fault, 20.0));
    assert_eq!((run.output.fault, run.output.sliding.lengthened), (Fault::NoSliding, 10));
}

#[test]
fn a_cycle_after_a_raised_half_period_is_as_any_other() {
    for sweep in [Mode::Cross, Mode::Circular] {
        let p = longest(sweep, 25);
        let build = Build { shift: Vector3::new(1e-4, 0.0, 0.0), ..Build::NOMINAL };
        let fresh = Loop::new(&p, build, 620).cycle(20.0).unwrap().deviation;
        let mut run = lengthened(&p, tip(12e3, 0.4), 620);
        run.input.enable = false;
        assert!(run.run_to(State::Idle, 20.0));
        run.robot = Loop::new(&p, build, 620).robot;
        (0..20).for_each(|_| run.step());
        (run.input.enable, run.output.done) = (true, false);
        let again = run.cycle(40.0).unwrap().deviation;
        assert!((again / fresh - 1.0).abs() < 0.05, "{sweep:?}: {again} {fresh}");
        assert_eq!((run.output.sliding.lengthened, run.parameters.stick_slip.half_period), (0, 10));
    }
}

#[test]
fn what_is_tuned_off_gives_the_half_period_back() {
    let mut run = lengthened(&longest(Mode::Cross, 20), tip(12e3, 0.25), 621);
    run.parameters.stick_slip.sliding = 0.0;
    (0..41).for_each(|_| run.step());
    assert_eq!((run.output.sliding.lengthened, run.parameters.stick_slip.half_period), (0, 10));
}

#[test]
fn a_force_that_freezes_in_longer_half_periods_is_frozen() {
    for (value, limit) in [(5.0, 6.0), (4.0, 18.0)] {
        let mut run = lengthened(&longest(Mode::Cross, 20), tip(12e3, 0.25), 618);
        (0..400).for_each(|_| run.step());
        let mut maximum: f64 = 0.0;
        while run.output.state == State::Follow {
            run.step_with(|input| input.force.z = value);
            maximum = maximum.max(run.robot.normal_force);
        }
        assert_eq!(run.output.fault, Fault::ForceFrozen, "{value}: {maximum}");
        assert!(maximum <= limit, "{value}: {maximum}");
    }
}

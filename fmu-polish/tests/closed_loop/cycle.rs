//! Whole cycles: default control law, the published control law, the paper's stick-slip, robots that are off-nominal.

use fmu_polish::axes::Axes;
use fmu_polish::interface::{Fault, FeedSource, ForceMode, Mode, Parameters, State};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};

use crate::common::HOLLOW;
use crate::robot::Build;
use crate::run::{Cycle, Loop};

/// The force control as printed: no integral, no adaptation, no cancellation, no estimate.
fn printed() -> Parameters {
    let mut p = Parameters::START;
    p.force.mode = ForceMode::Norm;
    p.force.integral_time = 0.0;
    p.impedance.adaptive = false;
    p.ripple_gain = 0.0;
    p.repetitive.gain = 0.0;
    p.misalignment_enable = false;
    p.stick_slip.sliding = 0.0;
    p
}

fn without(mut p: Parameters) -> Parameters {
    p.stick_slip.mode = Mode::Off;
    p
}

fn finished(name: &str, run: &mut Loop) -> Cycle {
    let cycle = run.cycle(30.0);
    println!("{name}: {cycle:?}");
    let end = (run.output.state, run.output.fault, run.output.progress);
    cycle.unwrap_or_else(|| panic!("{name} ended in {end:?}"))
}

fn cycle(name: &str, p: &Parameters, build: Build, seed: u64) -> Cycle {
    finished(name, &mut Loop::new(p, build, seed))
}

#[test]
fn the_default_mode_holds_the_force_and_slides_far() {
    let cycle = cycle("default", &Parameters::START, Build::NOMINAL, 101);
    assert!(cycle.settle <= 0.5 && cycle.overshoot <= 0.2, "{cycle:?}");
    assert!((cycle.mean - 5.0).abs() <= 0.05 && cycle.deviation <= 0.06 && cycle.minimum > 4.0, "{cycle:?}");
    assert!(cycle.gain >= 3.0 && cycle.in_plane <= 10e-6, "{cycle:?}");
}

#[test]
fn a_cycle_that_starts_with_an_override_settles_at_its_fraction_of_the_force() {
    for ratio in [0.5, 1.5] {
        let mut run = Loop::new(&Parameters::START, Build::NOMINAL, 101);
        run.input.force_override = ratio;
        let cycle = finished("override", &mut run);
        assert!((cycle.mean - 5.0 * ratio).abs() <= 0.05 && cycle.settle <= 0.75, "{ratio}: {cycle:?}");
    }
}

#[test]
fn the_law_as_printed_holds_the_norm_of_the_force() {
    let cycle = cycle("printed", &without(printed()), Build::NOMINAL, 102);
    // friction is part of the norm: N = F_d / sqrt(1 + mu^2)
    assert!((cycle.mean - 5.0 / 1.04f64.sqrt()).abs() <= 0.04, "{cycle:?}");
    assert!(cycle.deviation <= 0.06 && cycle.settle <= 0.5 && cycle.overshoot <= 0.5, "{cycle:?}");
}

#[test]
fn sign_flips_in_every_sample_do_nothing() {
    let mut p = printed();
    let none = cycle("none", &without(p.clone()), Build::NOMINAL, 103);
    p.stick_slip.half_period = 1;
    for velocity in [2e-3, 10e-3, 40e-3] {
        p.stick_slip.velocity = velocity;
        let flips = cycle("500 Hz", &p, Build::NOMINAL, 103);
        assert!((flips.gain / none.gain - 1.0).abs() <= 0.02, "{velocity} m/s: {}", flips.gain / none.gain);
    }
}

/// The paper's method, each key by hand.
fn paper() -> Parameters {
    let mut p = printed();
    p.position.gain = Axes { x: 0.0, y: 0.0, z: 1.0 };
    p.position.select = Axes { x: false, y: false, z: true };
    p.position.projected = false;
    p.stick_slip.mode = Mode::Paper;
    p.stick_slip.half_period = 1;
    p
}

#[test]
fn one_parameter_switches_to_the_law_of_the_paper() {
    let mut one = Loop::new(&Parameters::PAPER, Build::NOMINAL, 114);
    let mut other = Loop::new(&paper(), Build::NOMINAL, 114);
    while !one.output.done {
        one.step();
        other.step();
        assert_eq!(one.output, other.output);
        assert!(one.time() < 30.0 && one.output.fault == Fault::None, "{:?}", one.output);
    }
}

#[test]
fn the_paper_mode_works() {
    let cycle = cycle("paper", &paper(), Build::NOMINAL, 104);
    // weak coupling along z pulls at the force
    assert!((cycle.mean - 5.0).abs() <= 0.6 && cycle.deviation <= 0.1 && cycle.in_plane <= 20e-6, "{cycle:?}");
}

#[test]
fn the_ratio_keeps_the_gain_at_another_feed() {
    let mut p = Parameters::START;
    p.stick_slip.ratio = 5.0;
    let slow = cycle("2 mm/s", &p, Build::NOMINAL, 106);
    p.feed.velocity = 4e-3;
    let fast = cycle("4 mm/s", &p, Build::NOMINAL, 106);
    assert!((fast.gain / slow.gain - 1.0).abs() <= 0.15, "{} {}", slow.gain, fast.gain);
}

#[test]
fn the_feed_of_the_file() {
    let mut p = without(Parameters::START);
    p.feed.source = FeedSource::File;
    // another one, which must have no effect
    p.feed.velocity = 1e-4;
    cycle("feed of the file", &p, Build::NOMINAL, 107);
}

#[test]
fn the_stiffness_is_found() {
    for stiffness in [95e3, 178e3, 240e3] {
        let mut run = Loop::new(&Parameters::START, Build { stiffness, ..Build::NOMINAL }, 108);
        let cycle = finished("stiffness", &mut run);
        let estimate = run.output.stiffness_estimate;
        assert!((estimate / stiffness - 1.0).abs() <= 0.1, "{stiffness}: {estimate}");
        assert!(cycle.deviation <= 0.06 && cycle.overshoot <= 0.2, "{stiffness}: {cycle:?}");
    }
}

#[test]
fn a_fast_approach_does_not_spoil_the_stiffness() {
    for velocity in [2e-3, 5e-3] {
        let mut p = Parameters::START;
        p.approach.velocity = velocity;
        let mut run = Loop::new(&p, Build::NOMINAL, 112);
        let cycle = finished("fast approach", &mut run);
        let estimate = run.output.stiffness_estimate;
        assert!((estimate / 178e3 - 1.0).abs() <= 0.1 && cycle.overshoot < 2.5, "{velocity}: {estimate} {cycle:?}");
    }
}

#[test]
fn a_shifted_mold_is_found_and_followed() {
    let shift = Vector3::new(50e-6, -50e-6, 70e-6);
    let build = Build { shift, ..Build::NOMINAL };
    let mut run = Loop::new(&Parameters::START, build, 109);
    let better = finished("shifted", &mut run);
    let plain = cycle("shifted, printed", &printed(), build, 109);
    assert!(better.deviation <= 0.5 * plain.deviation && better.minimum > 4.0, "{better:?} {plain:?}");
    // a sphere shows only where its middle is
    let m = run.output.misalignment;
    let middle = m.shift.vector() + Vector3::new(m.rx, m.ry, m.rz).cross(&Vector3::new(0.0, 0.0, HOLLOW));
    assert!((middle - shift).amax() <= 10e-6, "{middle}");
}

#[test]
fn a_mold_is_found_where_the_tool_is_and_not_where_the_path_is() {
    // drives of half the gain are 6 ms late: 48 um at this feed, and 8 degrees of a revolution of 0.35 mm
    let shift = Vector3::new(0.1e-3, -0.1e-3, 0.0);
    let build = Build { shift, drive_gain: 0.5, ..Build::NOMINAL };
    let mut p = without(Parameters::START);
    p.feed.velocity = 8e-3;
    let mut run = Loop::new(&p, build, 115);
    let late = finished("late drives", &mut run);
    let m = run.output.misalignment;
    let middle = m.shift.vector() + Vector3::new(m.rx, m.ry, m.rz).cross(&Vector3::new(0.0, 0.0, HOLLOW));
    assert!((middle - shift).xy().amax() <= 5e-6, "{middle} {late:?}");
}

#[test]
fn what_repeats_from_turn_to_turn_is_learned() {
    let build = Build { drive_friction: 6.0, drive_gain: 0.6, ..Build::NOMINAL };
    let mut p = without(Parameters::START);
    p.feed.velocity = 20e-3;
    let learned = cycle("learned", &p, build, 118);
    p.repetitive.gain = 0.0;
    let plain = cycle("not learned", &p, build, 118);
    assert!(learned.deviation < 0.7 * plain.deviation, "{learned:?} {plain:?}");
}

#[test]
fn a_tool_away_from_the_start_of_the_path_comes_to_it_while_the_force_settles() {
    let aside = 80e-6;
    for gain in [0.0, 2.0, 5.0] {
        let mut p = Parameters::START;
        p.position.gain = Axes::all(gain);
        let mut run = Loop::displaced(&p, Build::NOMINAL, 119, Vector3::new(0.0, aside, 0.0));
        assert!(run.run_to(State::Settle, 5.0), "{:?}", run.output.fault);
        let touched = run.time();
        assert!(run.run_to(State::Follow, 5.0), "{:?}", run.output.fault);
        let left = run.output.error.tangential.hypot(run.output.error.lateral) / aside;
        // eq. 6 is a first-order lag
        let derived = (-gain * (run.time() - touched)).exp();
        assert!((left - derived).abs() < 0.05, "{gain}: {left} {derived}");
    }
}

#[test]
fn the_force_is_gone_before_the_tool_leaves() {
    let mut run = Loop::new(&Parameters::START, Build::NOMINAL, 116);
    assert!(run.run_to(State::Retract, 20.0));
    assert!(run.robot.normal_force < 1.0, "{} N", run.robot.normal_force);
}

#[test]
fn the_cancellation_works_without_delay_and_with_other_drives() {
    for (io_delay, drive_gain) in [(1, 0.8), (1, 1.2), (2, 1.0)] {
        let mut p = Parameters::START;
        // one sample of delay in the phase is 18 degrees at 50 Hz
        p.io_delay = io_delay;
        let build = Build { drive_gain, drive_friction: 6.0, ..Build::NOMINAL };
        let with = cycle("cancelled", &p, build, 110);
        p.ripple_gain = 0.0;
        let plain = cycle("not canceled", &p, build, 110);
        assert!(with.deviation <= plain.deviation + 0.01, "{io_delay} {drive_gain}: {with:?} {plain:?}");
    }
}

#[test]
fn a_cancellation_for_other_drives_ends_itself_and_does_no_damage() {
    let mut p = Parameters::START;
    // seven samples are 126 degrees at 50 Hz
    p.io_delay = 8;
    let mut run = Loop::new(&p, Build { drive_friction: 6.0, ..Build::NOMINAL }, 113);
    let cycle = finished("other drives", &mut run);
    assert!(run.output.ripple_stopped && cycle.deviation <= 0.3 && cycle.minimum > 3.0, "{cycle:?}");
}

#[test]
fn thirty_robots_that_are_not_nominal() {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(111);
    for seed in 0..30 {
        let mut between = |low: f64, high: f64| random.random_range(low..high);
        let build = Build {
            stiffness: between(92e3, 242e3),
            friction: between(0.1, 0.4),
            drive_friction: between(0.5, 4.0),
            drive_gain: between(0.8, 1.2),
            shift: Vector3::new(between(-1e-4, 1e-4), between(-1e-4, 1e-4), between(-1e-4, 1e-4)),
            ..Build::NOMINAL
        };
        let cycle = cycle(&format!("{build:?}"), &Parameters::START, build, 200 + seed);
        assert!(cycle.settle <= 0.5 && cycle.overshoot <= 0.2, "{cycle:?}");
        assert!(cycle.deviation <= 0.35 && cycle.minimum > 2.5, "{cycle:?}");
        assert!(cycle.gain >= 2.3 && cycle.in_plane <= 15e-6, "{cycle:?}");
    }
}

#[test]
#[ignore = "ten hours of polishing, some minutes of computing"]
fn ten_hours_without_a_false_fault() {
    let (mut seconds, mut cycles) = (0.0, 0);
    while seconds < 36e3 {
        let mut run = Loop::new(&Parameters::START, Build::NOMINAL, 100_000 + cycles);
        assert!(run.cycle(30.0).is_some(), "job {cycles}: {:?}", run.output.fault);
        (seconds, cycles) = (seconds + run.time(), cycles + 1);
    }
    println!("measured: hours | fmu-polish | hours=10 jobs={cycles}");
}

/// The tables of the README.
#[test]
#[ignore = "prints tables"]
fn tables() {
    for half_period in [1, 2, 5, 10, 20] {
        let mut line = format!("measured: polish-gain | {half_period} |");
        for velocity in [5, 10, 20] {
            let mut p = Parameters::START;
            (p.stick_slip.half_period, p.stick_slip.sliding) = (half_period, 0.0);
            p.stick_slip.velocity = 1e-3 * f64::from(velocity);
            line += &format!(" at_{velocity}={}", Loop::new(&p, Build::NOMINAL, 300).cycle(30.0).unwrap().gain);
        }
        println!("{line}");
    }
    for damping in [20, 10, 5] {
        let mut p = without(printed());
        p.impedance.damping = 1e3 * f64::from(damping);
        let cycle = Loop::new(&p, Build::NOMINAL, 301).cycle(30.0).unwrap();
        println!("measured: polish-damping | {damping} | settle={} overshoot={}", cycle.settle, cycle.overshoot);
    }
}

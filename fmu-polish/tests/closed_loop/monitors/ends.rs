//! How a cycle begins and how it ends: the edge of `enable`, the retract, and its time.

use super::*;

#[test]
fn a_force_that_returns_during_the_retract_is_not_done() {
    let mut run = Loop::new(&P, Build::NOMINAL, 502);
    assert!(run.run_to(State::Retract, 20.0));
    let until = run.time() + 3.0;
    while run.output.state == State::Retract && run.time() < until {
        run.step_with(|input| input.force.z += 2.0);
    }
    assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::UnloadTimeout));
    assert!(!run.output.done);
    // it is out already
    let counts = run.output.counts;
    (0..300).for_each(|_| run.step());
    assert_eq!(run.output.counts, counts);
}

#[test]
fn a_long_retract_is_no_timeout() {
    let mut p = P;
    // 5 s, more than twice `settle.time_max`
    p.retract.velocity = 0.1e-3;
    let mut run = Loop::new(&p, Build::NOMINAL, 506);
    assert!(run.run_to(State::Done, 20.0), "{:?}", run.output);
    assert!(run.output.done);
}

#[test]
fn one_sample_without_a_force_is_not_unloaded() {
    let mut run = Loop::new(&P, Build::NOMINAL, 507);
    assert!(run.run_to(State::Unload, 20.0));
    run.step_with(|input| input.force = Axes::all(0.0));
    assert_eq!(run.output.state, State::Unload);
    (0..10).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Unload);
}

#[test]
fn a_knock_before_the_cycle_is_no_noise_in_it() {
    let mut run = Loop::new(&P, Build::NOMINAL, 508);
    for k in 0..100 {
        run.step_with(|input| {
            input.enable = false;
            input.force.z += if k % 2 == 0 { 5.0 } else { -5.0 };
        });
    }
    assert!(run.run_to(State::Approach, 1.0), "{:?}", run.output);
}

#[test]
fn a_spike_with_the_edge_of_enable_moves_no_zero() {
    let mut run = Loop::new(&P, Build::NOMINAL, 509);
    run.step();
    run.step_with(|input| input.force.z += 50.0);
    assert!(run.run_to(State::Approach, 1.0), "{:?}", run.output);
    let forces: Vec<f64> = std::iter::repeat_with(|| {
        run.step();
        run.output.force.measured
    })
    .take(100)
    .collect();
    let mean = forces.iter().sum::<f64>() / forces.len() as f64;
    // a hundredth of the spike is 0.5 N
    assert!(mean.abs() < 0.1, "{mean}");
}

#[test]
fn a_cycle_without_progress_ends_by_its_time_and_one_that_goes_on_does_not() {
    for (ratio, fault) in [(0.0, Fault::NoProgress), (0.5, Fault::None)] {
        let failure = fails(&P, Build::NOMINAL, State::Follow, |input, _| input.feed_override = ratio);
        // 8 mm at 2 mm/s, four times, and some 8 s around it
        assert_eq!(failure.fault, fault, "{failure:?}");
        assert!(failure.maximum < 6.0, "{failure:?}");
    }
}

#[test]
fn a_more_severe_fault_during_the_retract_switches_the_drives_off() {
    let mut run = Loop::new(&P, Build::NOMINAL, 503);
    assert!(run.run_to(State::Follow, 5.0));
    run.robot.build.shift.z += 0.15e-3;
    assert!(run.run_to(State::Fault, 5.0));
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::ForceLimit, true));
    (0..6).for_each(|_| run.step_with(|input| input.position.x = f64::NAN));
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::PositionLost, false));
    (0..200).for_each(|_| run.step());
    // it stays off, and named, until the reset; then nothing moves by itself
    assert_eq!((run.output.fault, run.output.drive_enable), (Fault::PositionLost, false));
    run.step_with(|input| input.reset_fault = true);
    assert_eq!((run.output.state, run.output.drive_enable), (State::Idle, true));
    (0..300).for_each(|_| run.step());
    assert_eq!((run.output.state, run.output.pulses), (State::Idle, Axes::all(0)));
}

#[test]
fn an_enable_that_is_on_from_the_start_moves_nothing() {
    let mut fresh = Loop::new(&P, Build::NOMINAL, 504);
    fresh.skip_first_edge();
    (0..500).for_each(|_| fresh.step());
    assert_eq!((fresh.output.state, fresh.output.pulses), (State::Idle, Axes::all(0)));
}

#[test]
fn the_counts_are_the_sum_of_all_pulses() {
    let mut run = Loop::new(&P, Build::NOMINAL, 505);
    let mut sum = Vector3::<i32>::zeros();
    for _ in 0..3000 {
        run.step();
        let pulses = run.output.pulses;
        sum += Vector3::new(pulses.x, pulses.y, pulses.z);
        assert_eq!(run.output.counts, sum.into());
    }
    assert!(sum.z < -150, "{sum}");
}

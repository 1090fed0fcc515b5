//! Positions that freeze in a rest: detected by their noise in earlier rests; external vibration is not such noise.

use fmu_deburr::interface::{Fault, Mode, Parameters, State};

use crate::robot::Build;
use crate::setup::{Loop, assert_rests_with};

/// A robot whose encoders have a noise of half a count, after a task and two seconds of rest.
fn worked() -> Loop {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    let mut run = Loop::new(&p, &Build { noise: 0.5, ..Build::NOMINAL });
    assert!(run.finish(Mode::DryRun));
    (0..200).for_each(|_| run.step());
    run
}

/// Continues to `wait` samples in the rest before the next task.
fn settling(run: &mut Loop, wait: u32) {
    for mode in [Mode::Idle, Mode::DryRun] {
        run.input.mode = mode;
        run.step();
    }
    while run.output.state != State::Settle {
        run.step();
    }
    (0..wait).for_each(|_| run.step());
}

/// Samples until a fault, the measurement of the axis `axis` (from 0) frozen; none of 400.
fn frozen(run: &mut Loop, axis: usize) -> Option<u32> {
    let stuck = run.robot.read()[axis];
    (0..400).find(|_| {
        let mut positions = run.robot.read();
        positions[axis] = stuck;
        run.set_positions(&positions);
        run.tick();
        run.output.fault != Fault::None
    })
}

#[test]
fn one_that_freezes_in_the_rest_before_a_cycle_is_reported_whether_the_cycle_goes_on_or_is_ended() {
    for axis in [1, 4] {
        for wait in [0, 5, 10, 20, 30, 50, 70] {
            for idle in [false, true] {
                let mut run = worked();
                settling(&mut run, wait);
                if idle {
                    run.input.mode = Mode::Idle;
                }
                let after = frozen(&mut run, axis);
                assert_rests_with(&run, Fault::PositionFrozen);
                assert_eq!(run.output.numbers.axis, axis as i32 + 1);
                assert!(!run.output.drive_enable && after.is_some_and(|after| (49..140).contains(&after)), "{after:?}");
            }
        }
    }
}

#[test]
fn one_that_freezes_between_two_cycles_is_reported_and_a_live_one_may_be_constant_there_for_ever() {
    let mut run = worked();
    let after = frozen(&mut run, 4);
    assert_rests_with(&run, Fault::PositionFrozen);
    assert!(after.is_some_and(|after| after < 140), "{after:?}");
    for noise in [0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 1.0] {
        let mut run = Loop::new(&Parameters::START, &Build { noise, ..Build::NOMINAL });
        (0..60_000).for_each(|_| run.step());
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None), "{noise}");
    }
}

#[test]
fn what_a_tool_or_a_motion_has_shaken_may_be_constant() {
    // it runs down between two tasks, and the next one is in air
    let mut run = worked();
    (run.input.spindle_speed, run.robot.noise) = (0.0, 0.0);
    (0..1000).for_each(|_| run.step());
    assert!(run.finish(Mode::DryRun), "{:?}", run.output.numbers);
    // what runs down shakes less and less
    for start in 0..10 {
        let mut run = worked();
        let idle = run.input.spindle_speed;
        (0..7 * start).for_each(|_| run.step());
        for k in 1..=300 {
            let fraction = 1.0 - f64::from(k) / 300.0;
            (run.input.spindle_speed, run.robot.noise) = (idle * fraction, (2.0 * fraction).max(0.1));
            run.step();
        }
        (0..1000).for_each(|_| run.step());
        assert_eq!(
            (run.output.state, run.output.fault),
            (State::Done, Fault::None),
            "{start}: {:?}",
            run.output.numbers
        );
    }
    // an axis at rest is shaken by those that move
    let mut p = Parameters::START;
    p.lookup.enable = false;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    for mode in [Mode::DryRun, Mode::Idle, Mode::DryRun, Mode::Idle] {
        run.input.mode = mode;
        for _ in 0..1500 {
            run.robot.noise = if run.output.state == State::Approach { 0.5 } else { 0.0 };
            run.step();
            assert_eq!(run.output.fault, Fault::None, "{:?}", run.output.numbers);
        }
    }
    assert_eq!(run.output.state, State::Idle);
}

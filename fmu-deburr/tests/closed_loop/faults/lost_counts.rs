//! Measurements that creep in small steps: lost counts in a run, and nothing while the robot waits for its next task.

use fmu_deburr::interface::{Fault, Mode, Parameters, State};

use crate::robot::Build;
use crate::setup::{Loop, assert_rests_with, running};

/// Counts of axis 3 in a step, 0.15 mm: seven of them are more than `error_max`.
const STEP: f64 = 30.0;

/// One sample, with an error of the position of axis 3 in counts.
fn offset_axis(run: &mut Loop, counts: f64) {
    let mut positions = run.robot.read();
    positions[2] += counts * run.parameters.axis[2].pulse;
    run.set_positions(&positions);
    run.tick();
}

#[test]
fn counts_that_are_lost_in_a_run_are_reported_at_a_millimetre() {
    for side in [1.0, -1.0] {
        let mut run = running(Mode::DryRun);
        let mut lost = 0.0;
        for k in 0..1000 {
            lost = STEP * f64::from(k / 20);
            offset_axis(&mut run, side * lost);
            if run.output.fault != Fault::None {
                break;
            }
        }
        assert_rests_with(&run, Fault::PositionJump);
        let lost = lost * run.parameters.axis[2].pulse;
        assert!(!run.output.drive_enable && lost > 1e-3 && lost < 1.3e-3, "{lost} m");
    }
}

#[test]
fn a_reading_that_creeps_for_hours_between_two_cycles_is_no_fault_and_the_next_cycle_is_done() {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    for (first, waits) in [(Mode::Idle, State::Idle), (Mode::DryRun, State::Done)] {
        let mut run = Loop::new(&p, &Build::NOMINAL);
        assert!(first == Mode::Idle || run.finish(first));
        // a step each minute, here each second
        for k in 0..6000 {
            offset_axis(&mut run, STEP * f64::from(k / 100));
            assert_eq!(run.output.fault, Fault::None, "{:?}", run.output.numbers);
        }
        assert_eq!(run.output.state, waits);
        for mode in [Mode::Idle, Mode::Playback] {
            run.input.mode = mode;
            offset_axis(&mut run, 59.0 * STEP);
        }
        while !matches!(run.output.state, State::Done | State::Fault) {
            offset_axis(&mut run, 59.0 * STEP);
        }
        assert_eq!((run.output.state, run.output.fault), (State::Done, Fault::None), "{:?}", run.output.numbers);
    }
}

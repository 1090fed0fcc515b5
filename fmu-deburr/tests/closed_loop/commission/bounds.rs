//! How a commissioning run begins, what it keeps to while it moves, and how it is aborted.

use fmu_deburr::interface::{BankStatus, Fault, Mode, Parameters, State};

use super::{applied, begin, commission, resting, worst};
use crate::robot::Build;
use crate::setup::Loop;

#[test]
fn it_is_aborted_into_rest_and_the_configured_values() {
    type Cause = fn(&mut Loop);
    let causes: [(Cause, State); 4] = [
        (|run| run.input.commission = false, State::Idle),
        (|run| run.input.hold = true, State::Idle),
        (|run| run.input.mode = Mode::DryRun, State::Idle),
        (|run| run.input.enable = false, State::Off),
    ];
    // in a stroke, in a rest, and in strokes of other axes
    for samples in [20, 90, 700, 2500] {
        for (cause, end) in causes {
            let mut run = resting(&applied(), &Build { gain: 0.9, ..Build::NOMINAL });
            begin(&mut run, samples);
            cause(&mut run);
            let mut speed = run.output.axis.each_ref().map(|axis| axis.reference);
            let mut before = [0.0; 6];
            for k in 0..100 {
                run.step();
                let now = run.output.axis.each_ref().map(|axis| axis.reference);
                let step: [f64; 6] = std::array::from_fn(|i| now[i] - speed[i]);
                // 0.5 m/s2 at the tip, levers of 0.1 m and more, and counts
                assert!(k == 0 || end == State::Off || (0..6).all(|i| (step[i] - before[i]).abs() < 5.6e-4), "{k}");
                (speed, before) = (now, step);
            }
            assert_eq!((run.output.state, run.output.fault), (end, Fault::None), "{samples}");
            // nothing begins again without a new edge
            (run.input.hold, run.input.enable) = (false, true);
            (0..300).for_each(|_| run.step());
            assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None), "{samples}");
            assert!(run.output.axis.iter().all(|axis| axis.velocity.abs() < 1e-4) && !run.output.measured.valid);
            let mut in_force = run.parameters.clone();
            run.controller.bring_into_force(&mut in_force);
            assert_eq!(in_force, run.parameters);
        }
    }
}

#[test]
fn a_second_one_that_is_aborted_takes_back_what_the_first_has_found() {
    let mut run = resting(&applied(), &Build { gain: 0.8, delay: 2, ..Build::NOMINAL });
    commission(&mut run);
    assert_eq!(run.output.bank.patterns, 5);
    run.input.commission = false;
    run.step();
    begin(&mut run, 100);
    run.input.commission = false;
    (0..100).for_each(|_| run.step());
    assert_eq!(
        (run.output.state, run.output.bank.status, run.output.bank.patterns),
        (State::Idle, BankStatus::Empty, 0)
    );
    assert_eq!(run.output.axis[2].gain, 1.0);
}

#[test]
fn it_never_begins_by_itself() {
    let mut run = Loop::new(&Parameters::START, &Build::NOMINAL);
    // true from the first sample on is no edge
    run.input.commission = true;
    for _ in 0..300 {
        run.step();
        assert!(matches!(run.output.state, State::Off | State::Idle));
    }
    // nor is one before `enable`, or in a task
    (run.input.enable, run.input.commission) = (false, false);
    (0..5).for_each(|_| run.step());
    run.input.commission = true;
    run.step();
    run.input.enable = true;
    (0..100).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Idle);
    run.input.mode = Mode::DryRun;
    for k in 0..3000 {
        run.input.commission = run.output.state == State::Run && k % 2 == 0 || run.output.state == State::Done;
        run.step();
        assert_ne!(run.output.state, State::Commission);
        if run.output.state == State::Done {
            break;
        }
    }
}

#[test]
fn the_tip_keeps_to_its_travel_and_never_goes_down() {
    let p = applied();
    let mut run = resting(&p, &Build { delay: 2, gain: 1.3, ..Build::NOMINAL });
    let start = run.robot.positions();
    let tip = p.arm.forward(&start).tip;
    begin(&mut run, 0);
    let (mut far, mut low) = (0.0f64, 0.0f64);
    while run.output.state == State::Commission {
        run.step();
        let now = p.arm.forward(&run.robot.positions()).tip;
        (far, low) = (far.max((now - tip).norm()), low.min(now.z - tip.z));
    }
    // 1.64 v^2 / a, and what a chord is shorter than an arc
    assert!(far > 0.03 && far < 0.0331, "{far}");
    // the bare servo overshoots by a thousandth
    assert!(low > -6e-5, "{low}");
    let end = run.robot.positions();
    assert!((0..6).all(|i| (end[i] - start[i]).abs() < 5e-5), "{start:?} {end:?}");
}

#[test]
fn after_a_run_it_first_comes_out_of_the_part() {
    let p = applied();
    let mut run = resting(&p, &Build::NOMINAL);
    assert!(run.finish(Mode::DryRun));
    let tip = p.arm.forward(&run.robot.positions()).tip;
    begin(&mut run, 0);
    let mut rises = true;
    while run.output.state == State::Commission {
        run.step();
        let moved = p.arm.forward(&run.robot.positions()).tip - tip;
        rises &= moved.z > p.transfer.clearance - 2e-4 || moved.x.hypot(moved.y) < 2e-5;
    }
    assert!(rises && run.output.measured.valid, "{:?}", run.output);
    assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    // `mode` is still that of the run, and begins nothing
    (0..100).for_each(|_| run.step());
    assert_eq!(run.output.state, State::Idle);
    assert!(worst(&mut run) <= 0.03);
}

#[test]
fn it_does_not_take_longer_than_it_may() {
    let mut p = applied();
    p.commission.time = 28.0;
    let mut run = resting(&p, &Build::NOMINAL);
    // changed after the start
    run.parameters.commission.time = 8.0;
    commission(&mut run);
    assert_eq!((run.output.fault, run.output.numbers.limit), (Fault::NoProgress, 8.0));
}

//! No sample allocates: in no state, with no detector or control law, and in no fault.

#[expect(dead_code, reason = "the closed loop uses more of it")]
#[path = "closed_loop/run.rs"]
mod run;
#[expect(dead_code, reason = "the closed loop uses more of it")]
#[path = "closed_loop/slide.rs"]
mod slide;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use fmu_dob::interface::{DetectorKind, Fault, Input, Parameters, State};
use run::Loop;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Out of reach, m.
const NO_WORKPIECE: f64 = 1.0;

/// Changes the inputs of a step to cause a fault; no change where parameters or the stage cause it.
type Cause = fn(&mut Input);

/// Steps to each of the states in turn; no step may allocate.
fn pass(run: &mut Loop, states: &[State]) {
    for &state in states {
        assert!(assert_no_alloc(|| run.run_to(state, 4.0)), "{state:?}: {:?}", run.output);
    }
}

fn cycle(p: &Parameters) {
    use State::{Approach, Contact, Detect, Done, Idle, Learn, Retract};
    let mut run = Loop::new(p, 51, 90e-6);
    pass(&mut run, &[Idle, Approach, Learn, Detect, Contact, Retract, Done]);
}

#[test]
fn a_cycle_of_each_detector() {
    for &detector in DetectorKind::ALL {
        cycle(&Parameters { detector, ..Parameters::START });
    }
}

#[test]
fn a_cycle_of_the_paper() {
    cycle(&Parameters::PAPER);
}

#[test]
fn a_disabled_cycle_with_integral_action() {
    let mut p = Parameters::START;
    p.servo.disturbance_compensation = false;
    let mut run = Loop::new(&p, 52, NO_WORKPIECE);
    pass(&mut run, &[State::Detect]);
    assert_no_alloc(|| run.step_with(|input| input.enable = false));
    pass(&mut run, &[State::Retract, State::Done]);
    assert!(run.output.aborted);
}

#[test]
fn a_commission_that_is_applied() {
    for detector in [DetectorKind::Slope, DetectorKind::Glr] {
        let mut p = Parameters { detector, ..Parameters::START };
        p.commission.apply = true;
        let mut run = Loop::new(&p, 54, NO_WORKPIECE);
        assert_no_alloc(|| {
            (0..200).for_each(|_| run.step_with(|input| input.enable = false));
            while !run.output.measured.valid && run.output.fault == Fault::None {
                run.step_with(|input| (input.enable, input.commission) = (false, true));
            }
        });
        assert!(run.output.measured.valid, "{:?}", run.output);
        run.step_with(|input| (input.enable, input.commission) = (false, true));
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    }
}

#[test]
fn a_calibration_that_is_applied() {
    let mut p = Parameters::START;
    (p.calibration.position, p.calibration.apply, p.calibration.touches) = (9e-5, true, 2);
    (p.calibration.velocity_min, p.limits.touch_scatter, p.calibration.std_max) = (9e-5, 1e-6, 1e-6);
    let mut run = Loop::new(&p, 55, 9e-5);
    assert_no_alloc(|| {
        (0..200).for_each(|_| run.step_with(|input| input.enable = false));
        while !run.output.calibrated.valid && run.output.fault == Fault::None {
            run.step_with(|input| (input.enable, input.calibrate) = (false, true));
        }
    });
    assert!(run.output.calibrated.valid, "{:?}", run.output);
}

#[test]
fn every_fault_and_its_reset() {
    let p = Parameters::START;
    let (mut short, mut strict, mut weak) = (p.clone(), p.clone(), p.clone());
    short.approach.travel_max = 8e-5;
    strict.limits.slope_sigma_max = 0.1;
    (weak.stage.current_max, weak.limits.saturated_time) = (0.05, 5e-4);
    let cases: [(Fault, &Parameters, Cause); 7] = [
        (Fault::TravelLimit, &short, |_| ()),
        (Fault::PositionLost, &p, |input| input.position_valid = false),
        (Fault::Saturation, &weak, |_| ()),
        (Fault::LearnRejected, &strict, |_| ()),
        (Fault::PositionFrozen, &p, |input| input.position = input.position.min(4e-5)),
        (Fault::SpindleLost, &p, |input| input.spindle_speed = f64::NAN),
        (Fault::LateContact, &p, |_| ()),
    ];
    for (fault, p, cause) in cases {
        // 20 um of travel before the detector is armed
        let surface = if fault == Fault::LateContact { 2e-5 } else { NO_WORKPIECE };
        let mut run = Loop::new(p, 53, surface);
        run.slide.push = if fault == Fault::Saturation { -2.0 } else { 0.0 };
        while run.output.state != State::Fault {
            assert!(run.time() < 4.0, "{fault:?}: {:?}", run.output);
            assert_no_alloc(|| run.step_with(cause));
        }
        assert_eq!(run.output.fault, fault);
        run.slide.push = 0.0;
        assert_no_alloc(|| (0..3000).for_each(|_| run.step()));
        assert_no_alloc(|| run.step_with(|input| input.reset_fault = true));
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None), "{fault:?}");
    }
}

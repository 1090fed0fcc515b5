//! No control step allocates: in no state of a cycle with either control law, and in no fault.

#[path = "closed_loop/run.rs"]
mod run;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use fmu___name__::interface::{Fault, Parameters, State};
use run::Loop;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Injects the cause of a fault.
type Cause = fn(&mut Loop);

#[test]
fn a_cycle_of_both_control_laws() {
    let mut paper = Parameters::PAPER;
    // without an integral, friction leaves more than the default band
    paper.settle.band = 5e-4;
    for p in [Parameters::START, paper] {
        let mut run = Loop::new(&p);
        assert!(assert_no_alloc(|| run.run_to(State::Done, 3.0)), "{:?}", run.output);
        assert_no_alloc(|| (0..200).for_each(|_| run.step_with(|input| input.enable = false)));
        assert_eq!(run.output.state, State::Idle);
    }
}

#[test]
fn every_fault_and_its_reset() {
    let causes: [(Fault, Cause); 2] = [
        (Fault::FollowingError, |run| run.slide.load = -100.0),
        (Fault::PositionLost, |run| run.step_with(|input| input.position = f64::NAN)),
    ];
    for (fault, cause) in causes {
        let mut run = Loop::new(&Parameters::START);
        assert!(run.run_to(State::Run, 0.1));
        assert!(assert_no_alloc(|| {
            cause(&mut run);
            run.run_to(State::Fault, 1.0)
        }));
        assert_eq!(run.output.fault, fault);
        run.slide.load = 0.0;
        assert_no_alloc(|| {
            (0..1000).for_each(|_| run.step());
            run.step_with(|input| input.reset_fault = true);
        });
        assert_eq!(run.output.state, State::Idle);
    }
}

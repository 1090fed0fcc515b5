//! Every fault by its cause, its reset, and hostile inputs.

use fmu___name__::interface::{Fault, Parameters, State};

use crate::run::Loop;

fn in_fault(fault: Fault) -> Loop {
    let mut run = Loop::new(&Parameters::START);
    assert!(run.run_to(State::Run, 0.1));
    match fault {
        Fault::None => unreachable!("no fault has no cause"),
        Fault::FollowingError => run.slide.load = -100.0,
        Fault::PositionLost => run.step_with(|input| input.position = f64::NAN),
    }
    assert!(run.run_to(State::Fault, 1.0), "{:?}", run.output);
    assert_eq!((run.output.fault, run.output.force), (fault, 0.0));
    run.slide.load = 0.0;
    run
}

#[test]
fn every_fault_is_acknowledged_at_rest_and_then_waits_for_enable() {
    for &fault in &Fault::ALL[1..] {
        let mut run = in_fault(fault);
        run.slide.velocity += 0.5;
        run.step_with(|input| input.reset_fault = true);
        assert_eq!(run.output.state, State::Fault, "still moving");
        (0..1000).for_each(|_| run.step());
        assert_eq!(run.output.state, State::Fault, "not reset");
        run.step_with(|input| input.reset_fault = true);
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
        (0..100).for_each(|_| run.step());
        assert_eq!(run.output.state, State::Idle, "`enable` has not risen");
        run.step_with(|input| input.enable = false);
        assert!(run.run_to(State::Done, 5.0), "{:?}", run.output);
    }
}

#[test]
fn no_input_makes_an_output_infinite() {
    for hostile in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 1e300, -1e300, 99.0] {
        let mut run = Loop::new(&Parameters::START);
        for k in 0..3000 {
            run.step_with(|input| {
                input.position = if k % 7 == 3 { hostile } else { input.position };
                (input.enable, input.reset_fault) = (k % 50 > 1, k % 100 == 99);
            });
            let shown = format!("{:?}", run.output);
            let finite = shown.split(|c: char| !c.is_alphanumeric()).all(|word| word != "NaN" && word != "inf");
            assert!(finite, "{hostile}: {shown}");
        }
    }
}

//! `law = Paper` is the paper's law by one parameter.

use fmu_centering::interface::{Law, Parameters, State};

use crate::ring::Ring;
use crate::run::Loop;

/// All outputs of every sample as bytes, until the ring is centred.
fn trace(p: &Parameters) -> Vec<Vec<u8>> {
    let mut run = Loop::new(p, Ring::new(5, 2e-4, 0.5));
    let mut trace = Vec::new();
    while run.output.state != State::Centred {
        assert!(run.time() < 60.0, "{:?}", run.output);
        run.step();
        trace.push(postcard::to_allocvec(&run.output).unwrap());
    }
    trace
}

#[test]
fn one_parameter_is_the_paper() {
    let switched = Parameters { law: Law::Paper, ..Parameters::START };
    assert_eq!(switched, Parameters::PAPER);
    assert!(trace(&switched) != trace(&Parameters::START));
}

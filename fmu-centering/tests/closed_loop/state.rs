//! State bytes and reproducibility.

use fmu_centering::controller::Controller;
use fmu_centering::interface::{Input, Output, Parameters, State};

use crate::ring::Ring;
use crate::run::Loop;

const P: Parameters = Parameters::PAPER;

/// Continues a loop in `state` from its bytes beside itself, to the end of the centring.
fn continued(p: &Parameters, state: State) {
    let mut run = Loop::new(p, Ring::new(1, 2e-4, 0.5));
    assert!(run.run_to(state, 60.0));
    (0..20).for_each(|_| run.step());
    let bytes = postcard::to_allocvec(&run.controller).unwrap();
    let mut copy: Controller = postcard::from_bytes(&bytes).unwrap();
    let mut output = Output::START;
    while run.output.state != State::Centred {
        let mut seen = Input::START;
        run.step_with(|input| seen = input.clone());
        copy.tick(&seen, p, &mut output);
        assert_eq!(output, run.output);
    }
    assert!(run.ring.eccentricity() <= 2.65e-6);
}

#[test]
fn state_bytes_continue_bit_for_bit() {
    for state in [State::Approach, State::Collect, State::Wait, State::Push, State::Settle] {
        continued(&Parameters::PAPER, state);
        continued(&Parameters::START, state);
    }
}

#[test]
fn same_seed_same_numbers() {
    let trace = || {
        let mut run = Loop::new(&P, Ring::new(2, 2e-4, 0.5));
        let step = |_| {
            run.step();
            run.output.slide.position_setpoint.to_bits()
        };
        (0..20_000).map(step).collect::<Vec<u64>>()
    };
    assert!(trace() == trace());
}

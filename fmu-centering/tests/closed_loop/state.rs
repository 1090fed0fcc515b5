//! State bytes and reproducibility.

use fmu_centering::interface::{Parameters, State};

use crate::ring::Ring;
use crate::run::Loop;

const P: Parameters = Parameters::PAPER;

/// Continues a loop in `state` from its bytes and itself, to the end of the cycle.
fn continued(p: &Parameters, state: State) {
    let mut run = Loop::new(p, Ring::new(1, 2e-4, 0.5));
    assert!(run.run_to(state, 60.0));
    (0..20).for_each(|_| run.step());
    let mut copy = run.reloaded();
    while run.output.state != State::Centered {
        run.step();
        copy.step();
        assert_eq!(copy.output, run.output);
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
    let mut runs = [2; 2].map(|seed| Loop::new(&P, Ring::new(seed, 2e-4, 0.5)));
    for _ in 0..20_000 {
        runs.iter_mut().for_each(Loop::step);
        assert_eq!(runs[0].output, runs[1].output);
    }
}

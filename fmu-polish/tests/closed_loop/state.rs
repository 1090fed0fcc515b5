//! The state between two samples holds everything.

use fmu_polish::controller::Controller;
use fmu_polish::interface::{Parameters, State};

use crate::robot::Build;
use crate::run::Loop;

#[test]
fn state_bytes_continue_bit_for_bit() {
    let p = Parameters::START;
    for (state, more) in [(State::Idle, 50), (State::Settle, 100), (State::Follow, 1511), (State::Retract, 3)] {
        let mut run = Loop::new(&p, Build::NOMINAL, 90);
        assert!(run.run_to(state, 20.0));
        (0..more).for_each(|_| run.step());
        let bytes = postcard::to_allocvec(&run.controller).unwrap();
        let mut copy: Controller = postcard::from_bytes(&bytes).unwrap();
        let mut output = run.output.clone();
        for k in 0..2000 {
            run.step();
            copy.tick(&run.input, &p, &mut output);
            assert_eq!(output, run.output, "{state:?}, sample {k}");
        }
    }
}

#[test]
fn same_seed_same_numbers() {
    let trace = || {
        let mut run = Loop::new(&Parameters::START, Build::NOMINAL, 91);
        let step = |_| {
            run.step();
            run.output.velocity.z.to_bits()
        };
        (0..4000).map(step).collect::<Vec<u64>>()
    };
    assert!(trace() == trace());
}

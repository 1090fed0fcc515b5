//! The state between two samples holds everything.

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
        let mut copy = run.reloaded();
        for k in 0..2000 {
            run.step();
            copy.step();
            assert_eq!(copy.output, run.output, "{state:?}, sample {k}");
        }
    }
}

#[test]
fn same_seed_same_numbers() {
    let mut runs = [91; 2].map(|seed| Loop::new(&Parameters::START, Build::NOMINAL, seed));
    for _ in 0..4000 {
        runs.iter_mut().for_each(Loop::step);
        assert_eq!(runs[0].output, runs[1].output);
    }
}

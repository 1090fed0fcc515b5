//! The state between two samples holds everything.

use fmu_fts::interface::{Mode, Parameters};

use crate::machine::Build;
use crate::run::Loop;

#[test]
fn same_seed_same_numbers() {
    let mut runs = [7; 2].map(|seed| Loop::new(&Parameters::START, &Build::NOMINAL, seed));
    for _ in 0..8000 {
        runs.iter_mut().for_each(Loop::step);
        assert_eq!(runs[0].output, runs[1].output);
    }
}

#[test]
fn state_bytes_continue_bit_for_bit() {
    let p = Parameters::START;
    // while holding, during the approach, and while learning
    for (mode, time) in [(Mode::Hold, 0.1), (Mode::Track, 0.1), (Mode::Track, 0.7)] {
        let mut run = Loop::new(&p, &Build::NOMINAL, 6);
        run.input.mode = mode;
        run.input.hold_angle = 0.3;
        run.run_to(time);
        let mut copy = run.reloaded();
        for k in 0..5000 {
            run.step();
            copy.step();
            assert_eq!(copy.output, run.output, "sample {k}");
        }
    }
}

//! State bytes and reproducibility.

use fmu_dob::interface::{DetectorKind, Parameters, State};

use crate::run::Loop;

#[test]
fn state_bytes_continue_bit_for_bit() {
    for &detector in DetectorKind::ALL {
        let p = Parameters { detector, ..Parameters::START };
        let mut run = Loop::new(&p, 34, 90e-6);
        assert!(run.run_to(State::Detect, 2.0));
        let mut copy = run.reloaded();
        while run.output.state != State::Done {
            run.step();
            copy.step();
            assert_eq!(copy.output, run.output);
        }
    }
}

#[test]
fn same_seed_same_numbers() {
    let mut runs = [35; 2].map(|seed| Loop::new(&Parameters::START, seed, 90e-6));
    for _ in 0..12_000 {
        runs.iter_mut().for_each(Loop::step);
        assert_eq!(runs[0].output, runs[1].output);
    }
}

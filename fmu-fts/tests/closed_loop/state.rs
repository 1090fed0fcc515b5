//! The state between two samples holds everything.

use fmu_fts::controller::Controller;
use fmu_fts::interface::{Mode, Parameters};

use crate::machine::Build;
use crate::run::Loop;

#[test]
fn state_bytes_continue_bit_for_bit() {
    let p = Parameters::START;
    // while holding, on the way to the path, and while learning
    for (mode, time) in [(Mode::Hold, 0.1), (Mode::Track, 0.1), (Mode::Track, 0.7)] {
        let mut run = Loop::new(&p, &Build::NOMINAL, 6);
        run.input.mode = mode;
        run.input.hold_angle = 0.3;
        run.run_to(time);
        let bytes = postcard::to_allocvec(&run.controller).unwrap();
        let mut copy: Controller = postcard::from_bytes(&bytes).unwrap();
        let mut output = run.output.clone();
        for k in 0..5000 {
            run.step();
            copy.tick(&run.input, &p, &mut output);
            assert_eq!(output, run.output, "sample {k}");
        }
    }
}

#[test]
fn same_seed_same_numbers() {
    let trace = || {
        let mut run = Loop::new(&Parameters::START, &Build::NOMINAL, 7);
        let step = |_| {
            run.step();
            run.output.torque.to_bits()
        };
        (0..8000).map(step).collect::<Vec<u64>>()
    };
    assert!(trace() == trace());
}

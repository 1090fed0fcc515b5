//! The state between two samples holds everything.

use fmu_deburr::controller::Controller;
use fmu_deburr::interface::{LearningLaw, Mode, Parameters};

use crate::robot::Build;
use crate::setup::Loop;

#[test]
fn state_bytes_continue_bit_for_bit() {
    for law in [LearningLaw::Plain, LearningLaw::LeadFilter, LearningLaw::NormOptimal] {
        let mut p = Parameters::START;
        p.learn.law = law;
        // on the way to the start, in the first run, in the middle of learning
        for steps in [100, 400, 4321] {
            let mut run = Loop::new(&p, &Build::NOMINAL);
            run.input.mode = Mode::Learn;
            (0..steps).for_each(|_| run.step());
            let bytes = postcard::to_allocvec(&run.controller).unwrap();
            let mut copy: Controller = postcard::from_bytes(&bytes).unwrap();
            let mut output = run.output.clone();
            for k in 0..2000 {
                run.step();
                copy.tick(&run.input, &p, &mut output);
                assert_eq!(output, run.output, "{law:?}, sample {k} after {steps}");
            }
        }
    }
}

//! The state between two samples holds everything.

use fmu_deburr::interface::{LearningLaw, Mode, Parameters};

use crate::robot::Build;
use crate::setup::Loop;

#[test]
fn state_bytes_continue_bit_for_bit() {
    for law in [LearningLaw::Plain, LearningLaw::LeadFilter, LearningLaw::NormOptimal] {
        let mut p = Parameters::START;
        p.learn.law = law;
        // during the motion to the start, in the first run, in the middle of learning
        for steps in [100, 400, 4321] {
            let mut run = Loop::new(&p, &Build::NOMINAL);
            run.input.mode = Mode::Learn;
            (0..steps).for_each(|_| run.step());
            let mut copy = run.reloaded();
            for k in 0..2000 {
                run.step();
                copy.step();
                assert_eq!(copy.output, run.output, "{law:?}, sample {k} after {steps}");
            }
        }
    }
}

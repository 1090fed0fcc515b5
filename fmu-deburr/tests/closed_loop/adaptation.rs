//! A bank of one machine on another, and what three repetitions make of it.

use fmu_deburr::interface::{LearningLaw, Mode, Parameters};
use fmu_deburr::path::Joints;

use crate::robot::Build;
use crate::setup::{Loop, parameters, swinging};

/// Largest errors with the bank of the nominal machine, learned on for some repetitions, mm.
fn adapted(nominal: &Loop, build: &Build, law: LearningLaw, repetitions: i32) -> Joints {
    let mut p = nominal.parameters.clone();
    (p.learn.law, p.learn.from_bank, p.learn.repetitions) = (law, true, repetitions);
    // a foreign bank is to be seen
    p.limits.axis.iter_mut().for_each(|axis| axis.pattern_error = 0.1);
    let mut run = Loop::new(&p, build);
    run.controller.path_and_bank().1.take_over(nominal.controller.bank(), 1e9).unwrap();
    assert!(run.finish(Mode::Learn));
    run.largest_errors(Mode::Playback, swinging(1.0))
}

#[test]
fn three_repetitions_adapt_a_bank_to_another_machine() {
    let mut nominal = Loop::new(&parameters(&Parameters::START, 1), &Build::NOMINAL);
    assert!(nominal.finish(Mode::Learn));
    for (gain, dynamics) in [(0.8, 0.8), (1.2, 0.8), (1.2, 1.2)] {
        let build = Build { gain, dynamics, delay: 1 };
        let foreign = adapted(&nominal, &build, LearningLaw::LeadFilter, 0);
        assert!(foreign[0] > 0.8, "{foreign:.3?}");
        let filter = adapted(&nominal, &build, LearningLaw::LeadFilter, 3);
        assert!(filter[0] < 0.10 && filter[2] < 0.10, "{gain} {dynamics}: {filter:.3?}");
        let optimal = adapted(&nominal, &build, LearningLaw::NormOptimal, 3);
        assert!(optimal[0] < 0.03 && optimal[2] < 0.03, "{gain} {dynamics}: {optimal:.3?}");
    }
}

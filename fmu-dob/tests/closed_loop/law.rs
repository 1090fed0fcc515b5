//! `law = Paper` is the paper's law by one parameter.

use fmu_dob::interface::{DetectorKind, Parameters, State, ThresholdMode};

use crate::run::Loop;

/// State, and all outputs as bytes, of every sample until the stage is done.
fn trace(p: &Parameters) -> Vec<Vec<u8>> {
    let mut run = Loop::new(p, 17, 90e-6);
    let mut trace = Vec::new();
    while run.output.state != State::Done {
        assert!(run.time() < 3.0, "{:?}", run.output);
        run.step();
        trace.push(postcard::to_allocvec(&run.output).unwrap());
    }
    trace
}

#[test]
fn the_switch_equals_the_keys_by_hand() {
    let mut by_hand = Parameters { detector: DetectorKind::Slope, ..Parameters::START };
    (by_hand.threshold.mode, by_hand.threshold.alpha) = (ThresholdMode::Fixed, 4.0);
    assert!(trace(&Parameters::PAPER) == trace(&by_hand));
    assert!(trace(&Parameters::PAPER) != trace(&Parameters::START));
}

//! `law = Paper` selects the published control law by one parameter.

use fmu_dob::interface::{DetectorKind, Law, Parameters, State, ThresholdMode};

use crate::run::Loop;

#[test]
fn the_switch_equals_the_keys_by_hand() {
    let mut by_hand = Parameters { law: Law::Paper, detector: DetectorKind::Slope, ..Parameters::START };
    (by_hand.threshold.mode, by_hand.threshold.alpha) = (ThresholdMode::Fixed, 4.0);
    assert_eq!(by_hand, Parameters::PAPER);
    let mut loops = [Parameters { law: Law::Default, ..by_hand }, Parameters::PAPER].map(|p| Loop::new(&p, 17, 90e-6));
    while loops[0].output.state != State::Done {
        loops.iter_mut().for_each(Loop::step);
        assert!(loops[0].time() < 3.0 && loops[0].output == loops[1].output, "{:?}", loops[0].output);
    }
}

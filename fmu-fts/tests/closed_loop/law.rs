//! One parameter switches to the published control law.

use fmu_fts::interface::{Law, Parameters};

use crate::machine::Build;
use crate::run::Loop;

#[test]
fn the_law_of_the_paper_is_its_keys_set_by_hand() {
    let mut by_hand = Parameters { law: Law::Paper, ..Parameters::START };
    by_hand.afc.cancelled = "2, 4, 6, 8, 10".parse().unwrap();
    (by_hand.afc.tau, by_hand.afc.phase_advance, by_hand.tip.compensation) = (0.2, false, false);
    by_hand.feedforward_adaptive = false;
    assert_eq!(by_hand, Parameters::PAPER);
    let mut loops =
        [Parameters { law: Law::Default, ..by_hand }, Parameters::PAPER].map(|p| Loop::new(&p, &Build::NOMINAL, 2));
    for sample in 0..8000 {
        loops.iter_mut().for_each(Loop::step);
        assert_eq!(loops[0].output, loops[1].output, "sample {sample}");
    }
}

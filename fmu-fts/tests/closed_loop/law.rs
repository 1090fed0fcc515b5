//! One parameter switches to the law of the paper.

use fmu_fts::interface::{Law, Parameters};
use fmu_fts::lists::frequencies::Frequencies;
use fmu_fts::lists::harmonics::Harmonics;

use crate::machine::Build;
use crate::run::Loop;

/// Parameters as the FMU has them before anything is set.
fn start() -> Parameters {
    let mut p = Parameters::START;
    p.afc.harmonics = Harmonics::DEFAULT_TEXT.to_owned();
    p.identify.frequencies = Frequencies::DEFAULT_TEXT.to_owned();
    p
}

fn in_force(p: &Parameters) -> Parameters {
    let mut p = p.in_force();
    p.read_lists().unwrap();
    p
}

#[test]
fn the_law_of_the_paper_is_its_keys_set_by_hand() {
    let by_law = in_force(&Parameters { law: Law::Paper, ..start() });
    let mut by_hand = start();
    by_hand.afc.harmonics = "2, 4, 6, 8, 10".to_owned();
    (by_hand.afc.tau, by_hand.afc.phase_advance, by_hand.tip.compensation) = (0.2, false, false);
    let by_hand = in_force(&by_hand);
    assert_eq!(by_law, Parameters { law: Law::Paper, ..by_hand.clone() });
    assert_eq!(by_law.afc.cancelled, Parameters::PAPER.afc.cancelled);
    let mut loops = [by_law, by_hand].map(|p| Loop::new(&p, &Build::NOMINAL, 2));
    for sample in 0..8000 {
        loops.iter_mut().for_each(Loop::step);
        assert_eq!(loops[0].output, loops[1].output, "sample {sample}");
    }
}

#[test]
fn under_the_law_of_the_paper_what_was_set_stays() {
    let mut p = Parameters { law: Law::Paper, ..start() };
    (p.afc.tau, p.afc.harmonics) = (0.5, "3".to_owned());
    let p = in_force(&p);
    assert_eq!((p.afc.tau, p.afc.harmonics.as_str(), p.afc.phase_advance), (0.5, "3", false));
    assert_eq!(in_force(&start()).afc.cancelled, Harmonics::DEFAULT);
}

//! `law = Paper` selects the published control law by one parameter.

use fmu_centering::interface::{Law, Parameters, State};

use crate::ring::Ring;
use crate::run::Loop;

#[test]
fn one_parameter_is_the_paper_and_changes_what_the_slide_does() {
    assert_eq!(Parameters { law: Law::Paper, ..Parameters::START }, Parameters::PAPER);
    let mut loops = [Parameters::START, Parameters::PAPER].map(|p| Loop::new(&p, Ring::new(5, 2e-4, 0.5)));
    let centered = loops.each_mut().map(|run| {
        while run.output.state != State::Centered {
            assert!(run.time() < 60.0, "{:?}", run.output);
            run.step();
        }
        run.time()
    });
    assert_ne!(centered[0], centered[1]);
}

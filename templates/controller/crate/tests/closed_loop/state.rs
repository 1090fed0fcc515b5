//! Saved states: a restored controller is bit-identical.

use fmu___name__::controller::Controller;
use fmu___name__::interface::{Input, Output, Parameters, State};

use crate::run::Loop;

#[test]
fn state_bytes_continue_bit_for_bit() {
    let p = Parameters::START;
    for state in [State::Idle, State::Run, State::Done] {
        let mut run = Loop::new(&p);
        run.step();
        assert!(run.run_to(state, 2.0));
        let bytes = postcard::to_allocvec(&run.controller).unwrap();
        let mut copy: Controller = postcard::from_bytes(&bytes).unwrap();
        let mut output = Output::START;
        for _ in 0..500 {
            let mut seen = Input::START;
            run.step_with(|input| seen = input.clone());
            copy.tick(&seen, &p, &mut output);
            assert_eq!(output, run.output);
        }
    }
}

//! State bytes and reproducibility.

use fmu_dob::controller::Controller;
use fmu_dob::interface::{DetectorKind, Input, Parameters, State};

use crate::run::Loop;

#[test]
fn state_bytes_continue_bit_for_bit() {
    for &detector in DetectorKind::ALL {
        let p = Parameters { detector, ..Parameters::START };
        let mut run = Loop::new(&p, 34, 90e-6);
        assert!(run.run_to(State::Detect, 2.0));
        let bytes = postcard::to_allocvec(&run.controller).unwrap();
        let mut copy: Controller = postcard::from_bytes(&bytes).unwrap();
        let mut output = run.output.clone();
        while run.output.state != State::Done {
            let mut seen = Input::START;
            run.step_with(|input| seen = input.clone());
            copy.tick(&seen, &p, &mut output);
            assert_eq!(output, run.output);
        }
    }
}

#[test]
fn same_seed_same_numbers() {
    let trace = || {
        let mut run = Loop::new(&Parameters::START, 35, 90e-6);
        let step = |_| {
            run.step();
            run.output.current.to_bits()
        };
        (0..12_000).map(step).collect::<Vec<u64>>()
    };
    assert!(trace() == trace());
}

//! The closed loop itself: state bytes, reproducibility.

mod ring;

use fmu_centering::controller::Controller;
use fmu_centering::machine::State;
use fmu_centering::parameters::Parameters;
use fmu_centering::signals::Input;
use ring::Ring;
use ring::closed_loop::Loop;

const P: Parameters = Parameters::PAPER;

#[test]
fn state_bytes_continue_bit_for_bit() {
    for state in [State::Approach, State::Collect, State::Wait, State::Push, State::Settle] {
        let mut run = Loop::new(&P, Ring::new(1, 2e-4, 0.5));
        assert!(run.run_to(state, 60.0));
        (0..20).for_each(|_| run.step());
        let bytes = postcard::to_allocvec(&run.controller).unwrap();
        let mut copy: Controller = postcard::from_bytes(&bytes).unwrap();
        while run.output.state != State::Centred {
            let time = run.time();
            let mut seen = Input::START;
            run.step_with(|input| seen = input.clone());
            assert_eq!(copy.tick(&P, time, &seen), run.output);
        }
        assert!(run.ring.eccentricity() <= 2.65e-6);
    }
}

#[test]
fn same_seed_same_numbers() {
    let trace = || {
        let mut run = Loop::new(&P, Ring::new(2, 2e-4, 0.5));
        let step = |_| {
            run.step();
            run.output.slide.position_setpoint.to_bits()
        };
        (0..20_000).map(step).collect::<Vec<u64>>()
    };
    assert!(trace() == trace());
}

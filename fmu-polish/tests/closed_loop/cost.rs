//! Cost of one sample; run it with `--release -- --ignored --nocapture`.

use std::time::Instant;

use fmu_polish::machine::State;
use fmu_polish::parameters::Parameters;

use crate::robot::Build;
use crate::run::Loop;

#[test]
#[ignore = "measures time"]
fn cost_of_a_sample() {
    for (name, p) in [("default", Parameters::DEFAULT), ("paper", Parameters::PAPER)] {
        let mut run = Loop::new(&p, Build::NOMINAL, 1);
        assert!(run.run_to(State::Follow, 5.0));
        let mut controller = run.controller.clone();
        let mut output = run.output.clone();
        let (count, begin) = (2000, Instant::now());
        for _ in 0..count {
            controller.tick(&p, &run.input, &mut output);
        }
        println!("{name}: {:.0} ns", begin.elapsed().as_secs_f64() / f64::from(count) * 1e9);
    }
}

//! Cost of one sample: `cargo test --release -p fmu-fts --test closed_loop -- cost --ignored --nocapture`.

use std::time::Instant;

use fmu_fts::parameters::Parameters;

use crate::machine::Build;
use crate::run::Loop;

#[test]
#[ignore = "a measurement: cost of one tick"]
fn tick_takes_less_than_two_microseconds() {
    let mut most = Parameters::DEFAULT;
    (most.path.harmonics, most.feedforward.harmonics) = (64, 64);
    most.afc.harmonics = "1-64".parse().unwrap();
    for (name, p) in [("paper", Parameters::PAPER), ("default", Parameters::DEFAULT), ("64 harmonics", most)] {
        let mut run = Loop::new(&p, &Build::NOMINAL, 8);
        run.run_to(0.5);
        let (mut controller, mut output, mut inputs, mut expected) =
            (run.controller.clone(), run.output.clone(), Vec::new(), 0.0);
        for _ in 0..20_000 {
            run.step();
            inputs.push(run.input.clone());
            expected += run.output.torque;
        }
        let (mut best, mut sum) = (f64::INFINITY, 0.0);
        // the best of many short runs: other programs cost time, too
        for inputs in inputs.chunks(200) {
            let begin = Instant::now();
            for input in inputs {
                controller.tick(&p, input, &mut output);
                sum += output.torque;
            }
            best = best.min(begin.elapsed().as_secs_f64() / inputs.len() as f64);
        }
        println!("{name}: {:.0} ns", 1e9 * best);
        assert_eq!(sum, expected);
        assert!(best < 2e-6 || name == "64 harmonics", "{best} s");
    }
}

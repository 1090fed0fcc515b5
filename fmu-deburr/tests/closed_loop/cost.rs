//! Measurements: `cargo test --release -p fmu-deburr --test closed_loop -- cost --ignored --nocapture`.

use std::time::Instant;

use fmu_deburr::machine::{Mode, State};
use fmu_deburr::parameters::{Law, Parameters};

use crate::robot::Build;
use crate::setup::{Loop, parameters, swinging};

#[test]
#[ignore = "a measurement: cost of one tick"]
fn samples_and_renewals() {
    for law in [Law::Plain, Law::LeadFilter, Law::NormOptimal] {
        let mut p = parameters(&Parameters::DEFAULT, 1);
        p.learn.law = law;
        let mut run = Loop::new(&p, &Build::NOMINAL);
        run.step();
        let (mut sum, mut worst, mut count) = (0.0, 0.0, 0.0);
        for mode in [Mode::Learn, Mode::Playback] {
            run.input.mode = mode;
            run.step();
            while run.output.state != State::Done {
                run.input.set_positions(&run.robot.read());
                let begin = Instant::now();
                run.controller.tick(&p, &run.input, &mut run.output);
                let spent = begin.elapsed().as_secs_f64();
                run.robot.advance(&run.output.axes().map(|axis| axis.velocity));
                (sum, worst, count) = (sum + spent, f64::max(worst, spent), count + 1.0);
            }
            println!("{law:?} {mode:?}: mean {:.0} ns, most {:.2} ms", 1e9 * sum / count, 1e3 * worst);
        }
    }
}

#[test]
#[ignore = "a measurement: the table of the README"]
fn errors() {
    for (name, base, stop) in [
        ("paper", Parameters::PAPER, false),
        ("paper, stop at best", Parameters::PAPER, true),
        ("default", Parameters::DEFAULT, true),
        ("norm-optimal, 3 repetitions", Parameters::DEFAULT, true),
    ] {
        for delay in [0, 1] {
            let mut p = parameters(&base, delay);
            p.learn.stop_at_best = stop;
            if name.starts_with("norm") {
                (p.learn.law, p.learn.repetitions) = (Law::NormOptimal, 3);
            }
            if name.starts_with("paper") {
                p.lookup.preview = -0.01 * f64::from(delay);
            }
            let mut run = Loop::new(&p, &Build { delay: delay as usize, ..Build::NOMINAL });
            assert!(run.finish(Mode::Learn));
            let mut worst = |speed: &dyn Fn(f64) -> f64| {
                let errors = run.largest_errors(Mode::Playback, speed);
                format!("{:.3}/{:.3}", errors[0], errors[2])
            };
            let steady = [1.0, 0.9, 0.7, 0.5, 0.3, 0.167].map(|factor| worst(&move |_| factor));
            let swings = [0.5, 1.0, 2.0].map(|hertz| worst(&swinging(hertz)));
            println!("{name}, delay {delay}: {steady:?} {swings:?}");
        }
    }
}

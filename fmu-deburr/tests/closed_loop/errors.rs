//! The table of the README: `cargo test --release -p fmu-deburr --test closed_loop -- errors --ignored --nocapture`.

use fmu_deburr::interface::{LearningLaw, Mode, Parameters};

use crate::robot::Build;
use crate::setup::{Loop, from_zero, parameters, swinging};

#[test]
#[ignore = "a measurement: the table of the README"]
fn errors() {
    let change = |base: Parameters, change: fn(&mut Parameters)| {
        let mut p = base;
        change(&mut p);
        p
    };
    for (name, base) in [
        ("paper", Parameters::PAPER),
        ("paper, stop at best", change(Parameters::PAPER, |p| p.learn.stop_at_best = true)),
        ("filter, 19 repetitions", change(from_zero(Parameters::START), |p| p.learn.law = LearningLaw::LeadFilter)),
        ("norm-optimal, 3 repetitions", change(from_zero(Parameters::START), |p| p.learn.repetitions = 3)),
        ("default", Parameters::START),
        ("identified, nothing learned", change(Parameters::START, |p| p.learn.repetitions = 0)),
        ("computed", change(Parameters::START, |p| p.bank.compute = true)),
    ] {
        for delay in [0, 1] {
            let mut p = parameters(&base, delay);
            if name.starts_with("paper") {
                p.lookup.preview = -0.01 * f64::from(delay);
            }
            let mut run = Loop::new(&p, &Build { delay: delay as usize, ..Build::NOMINAL });
            assert!(p.bank.compute || run.finish(Mode::Learn));
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

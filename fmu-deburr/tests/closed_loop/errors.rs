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
        ("paper, best repetition", change(Parameters::PAPER, |p| p.learn.stop_at_best = true)),
        ("filter, 19 repetitions", change(from_zero(Parameters::START), |p| p.learn.law = LearningLaw::LeadFilter)),
        ("norm-optimal, 3 repetitions", change(from_zero(Parameters::START), |p| p.learn.repetitions = 3)),
        ("default", Parameters::START),
        ("identified, nothing learned", change(Parameters::START, |p| p.learn.repetitions = 0)),
        ("computed, nothing learned", change(Parameters::START, |p| p.bank.compute = true)),
    ] {
        for delay in [0, 1] {
            let mut p = parameters(&base, delay);
            if name.starts_with("paper") {
                p.lookup.preview = -0.01 * f64::from(delay);
            }
            let mut run = Loop::new(&p, &Build { delay: delay as usize, ..Build::NOMINAL });
            assert!(p.bank.compute || run.finish(Mode::Learn));
            let mut line = format!("measured: deburr-speeds | {name}, delay {delay} |");
            let mut worst = |at: &str, speed: &dyn Fn(f64) -> f64| {
                let errors = run.largest_errors(Mode::Playback, speed);
                line += &format!(" {at}_1={} {at}_3={}", errors[0], errors[2]);
            };
            for percent in [100, 90, 70, 50, 30, 17] {
                let factor = if percent == 17 { 0.167 } else { f64::from(percent) / 100.0 };
                worst(&format!("at_{percent}"), &move |_| factor);
            }
            for (at, hertz) in [("half_hertz", 0.5), ("one_hertz", 1.0), ("two_hertz", 2.0)] {
                worst(at, &swinging(hertz));
            }
            println!("{line}");
        }
    }
}

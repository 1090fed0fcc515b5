//! Learning and playback on the test piece.

use fmu_deburr::machine::Mode;
use fmu_deburr::parameters::Parameters;

use crate::robot::Build;
use crate::setup::{Loop, parameters};

/// 6:1 in speed, `hertz` times a second.
fn swinging(hertz: f64) -> impl Fn(f64) -> f64 {
    move |time| 0.583 + 0.4165 * (std::f64::consts::TAU * hertz * time).sin()
}

#[test]
#[ignore = "a measurement"]
fn survey() {
    for delay in [0, 1] {
        for (name, base) in [("paper", Parameters::PAPER), ("default", Parameters::DEFAULT)] {
            for stop in [false, true] {
                let mut p = parameters(&base, delay);
                p.learn.stop_at_best = stop;
                let mut run = Loop::new(&p, &Build { delay: delay as usize, ..Build::NOMINAL });
                let bare = run.largest_errors(Mode::DryRun, |_| 1.0);
                println!("{name} d={delay} stop={stop}: bare {bare:.3?}");
                assert!(run.finish(Mode::Learn));
                let paper = p.clone();
                if name == "default" && stop {
                    for preview in -delay..=2 {
                        run.parameters.lookup.preview = preview;
                        for hertz in [0.5, 1.0, 2.0] {
                            println!(
                                "  preview {preview}, {hertz} Hz: {:.4?}",
                                run.largest_errors(Mode::Playback, swinging(hertz))
                            );
                        }
                    }
                    run.parameters = paper;
                }
                for factor in [1.0, 0.9, 0.7, 0.5, 0.3, 0.167, 0.1] {
                    println!("  {factor}: {:.4?}", run.largest_errors(Mode::Playback, |_| factor));
                }
                for hertz in [0.5, 1.0, 2.0] {
                    println!("  {hertz} Hz: {:.4?}", run.largest_errors(Mode::Playback, swinging(hertz)));
                }
            }
        }
    }
}

//! One parameter brings the paper's method into force.

use fmu_deburr::interface::{LearningLaw, Mode, Parameters, State};

use crate::robot::Build;
use crate::setup::{Loop, from_zero, swinging};

/// For a robot that acts immediately.
fn short(mut p: Parameters) -> Parameters {
    (p.io_delay, p.learn.repetitions) = (0, 2);
    p
}

#[test]
fn the_paper_law_is_its_keys_by_hand_bit_for_bit() {
    let mut by_hand = short(from_zero(Parameters::START));
    (by_hand.learn.law, by_hand.learn.lead, by_hand.learn.stop_at_best) = (LearningLaw::Plain, 0, false);
    (by_hand.lookup.preview, by_hand.limits) = (0.0, Parameters::PAPER.limits);
    let build = Build { delay: 0, ..Build::NOMINAL };
    let mut loops = [short(Parameters::PAPER), by_hand].map(|p| Loop::new(&p, &build));
    for mode in [Mode::Learn, Mode::Playback] {
        loops.iter_mut().for_each(|run| run.input.mode = mode);
        for k in 0.. {
            for run in &mut loops {
                run.input.speed_override = swinging(1.0)(0.01 * f64::from(k));
                run.step();
            }
            assert_eq!(loops[0].output, loops[1].output, "{mode:?}, sample {k}");
            if k > 2 && loops[0].output.state == State::Done {
                break;
            }
        }
    }
    assert_ne!(loops[0].output.bank.patterns, 0);
}

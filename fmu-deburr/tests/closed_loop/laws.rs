//! One parameter brings the paper's method into force.

use fmu_deburr::interface::{Law, LearningLaw, Mode, Parameters, State};

use crate::robot::Build;
use crate::setup::{Loop, swinging};

fn in_force(change: impl FnOnce(&mut Parameters)) -> Parameters {
    let mut p = Parameters::START;
    (p.io_delay, p.learn.repetitions) = (0, 2);
    change(&mut p);
    p.in_force()
}

#[test]
fn the_paper_law_is_its_keys_by_hand_bit_for_bit() {
    let switched = in_force(|p| p.law = Law::Paper);
    let by_hand = in_force(|p| {
        (p.learn.law, p.learn.lead, p.learn.stop_at_best) = (LearningLaw::Plain, 0, false);
        p.lookup.preview = 0.0;
    });
    let build = Build { delay: 0, ..Build::NOMINAL };
    let mut loops = [switched, by_hand].map(|p| Loop::new(&p, &build));
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

#[test]
fn the_paper_law_leaves_what_was_set_and_the_default_law_everything() {
    let p = in_force(|p| (p.law, p.learn.law, p.lookup.preview) = (Law::Paper, LearningLaw::NormOptimal, 0.01));
    assert_eq!((p.learn.law, p.lookup.preview, p.learn.lead), (LearningLaw::NormOptimal, 0.01, 0));
    assert_eq!(in_force(|_| ()).learn, Parameters { ..in_force(|p| p.learn.lead = 2) }.learn);
}

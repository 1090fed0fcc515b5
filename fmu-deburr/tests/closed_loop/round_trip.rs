//! Fig. 7: repetitive control of a round trip of axis 3, without end and without return moves.

use fmu_deburr::interface::{LearningLaw, Mode, Parameters, State};
use fmu_deburr::learning::speeds::Speeds;
use fmu_deburr::path::{Block, Pose, Vector};
use fmu_deburr::path::{CORNER, ProgrammedPath};

use crate::robot::Build;
use crate::setup::{Loop, from_zero, parameters};

/// 0.8 m out and back along the arm at up to 500 mm/s; 1.2 s of acceleration, smoothed over 120 ms.
fn round_trip() -> ProgrammedPath {
    let pose = |x: f64| Pose { tip: Vector::new(x, 0.0, -0.2), axis: Vector::new(0.0, 0.0, -1.0) };
    let blocks = vec![Block::line(&pose(0.4), &pose(1.2)).unwrap(), Block::line(&pose(1.2), &pose(0.4)).unwrap()];
    ProgrammedPath::new(blocks, 0.5, true, CORNER).unwrap()
}

/// Error of the bare servo over that of each repetition, axis 3.
fn ratios(base: &Parameters, delay: i32, repetitions: i32) -> Vec<f64> {
    let mut p = parameters(base, delay);
    (p.feed.acceleration, p.feed.smoothing) = (0.5 / 1.2, 12);
    p.learn.factors = Speeds::new(&[1.0]).unwrap();
    (p.learn.repetitions, p.learn.stop_at_best) = (repetitions, false);
    let mut run = Loop::with_path(&p, &Build { delay: delay as usize, ..Build::NOMINAL }, round_trip());
    run.input.mode = Mode::Learn;
    let (mut rms, mut seen) = (Vec::new(), 0.0);
    while run.output.state != State::Done {
        run.step();
        assert_ne!(run.output.state, State::Fault);
        if run.output.axis[2].rms != seen {
            seen = run.output.axis[2].rms;
            rms.push(seen);
        }
    }
    rms.iter().map(|value| rms[0] / value).collect()
}

/// Repetition with the smallest error.
fn best(ratios: &[f64]) -> usize {
    (0..ratios.len()).fold(0, |best, k| if ratios[k] > ratios[best] { k } else { best })
}

#[test]
fn the_plain_law_has_its_best_near_the_eleventh_repetition_and_grows_thereafter() {
    let ratios = ratios(&Parameters::PAPER, 0, 24);
    let best = best(&ratios);
    assert!((8..=18).contains(&best), "{ratios:.0?}");
    assert!(ratios[11] >= 500.0 && ratios[24] < 0.9 * ratios[best], "{ratios:.0?}");
}

#[test]
fn with_one_sample_of_delay_it_needs_one_sample_of_lead() {
    let with_lead = ratios(&Parameters::PAPER, 1, 24);
    assert!((9..=13).contains(&best(&with_lead)) && with_lead[best(&with_lead)] > 400.0, "{with_lead:.0?}");
    let mut p = Parameters::PAPER;
    p.learn.lead = -1;
    let without = ratios(&p, 1, 24);
    assert!(without[best(&without)] < 0.5 * with_lead[best(&with_lead)], "{without:.0?}");
}

#[test]
fn the_filter_goes_down_to_the_last_count() {
    for delay in [0, 1] {
        let mut p = from_zero(Parameters::START);
        p.learn.law = LearningLaw::LeadFilter;
        let ratios = ratios(&p, delay, 19);
        assert!(ratios[11] > 5000.0, "{ratios:.0?}");
        assert!(ratios.windows(2).take(13).all(|pair| pair[1] > pair[0]), "{ratios:.0?}");
    }
}

//! Norm-optimal learning: few repetitions, also on off-nominal machines.

use fmu_deburr::interface::{LearningLaw, Mode, Parameters, State};
use fmu_deburr::learning::speeds::Speeds;

use crate::robot::Build;
use crate::setup::{Loop, from_zero, parameters};

/// Error at the tip of the repetitions 0, 1, 2, ... at the programmed speed, um.
fn costs(weight: f64, build: &Build, repetitions: i32) -> Vec<f64> {
    let mut p = parameters(&from_zero(Parameters::START), build.delay as i32);
    (p.learn.law, p.learn.weight, p.learn.repetitions) = (LearningLaw::NormOptimal, weight, repetitions);
    p.learn.factors = Speeds::new(&[1.0]).unwrap();
    let mut run = Loop::new(&p, build);
    run.input.mode = Mode::Learn;
    let mut costs = Vec::new();
    while run.output.state != State::Done {
        run.step();
        assert_ne!(run.output.state, State::Fault);
        let cost = 1e6 * run.output.learn.cost;
        if costs.last() != Some(&cost) && cost > 0.0 {
            costs.push(cost);
        }
    }
    costs
}

#[test]
fn on_the_nominal_machine_three_repetitions_leave_three_micrometres() {
    for delay in [0, 1] {
        let costs = costs(0.01, &Build { delay, ..Build::NOMINAL }, 3);
        assert!(costs[3] < 3.0, "{costs:.1?}");
    }
}

#[test]
fn a_machine_that_is_a_fifth_off_costs_one_or_two_repetitions_more() {
    for (gain, dynamics) in [(0.8, 0.8), (0.8, 1.2), (1.2, 0.8), (1.2, 1.2)] {
        let costs = costs(0.01, &Build { gain, dynamics, ..Build::NOMINAL }, 8);
        assert!(costs[3] < 8.0 && costs[5] < 3.0, "{gain} {dynamics}: {costs:.1?}");
        let minimum = costs.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(costs[costs.len() - 1] <= minimum + 1.0, "{gain} {dynamics}: {costs:.1?}");
    }
}

#[test]
fn more_weight_is_slower() {
    let machine = Build { gain: 0.8, ..Build::NOMINAL };
    let after_two = |weight| costs(weight, &machine, 2)[2];
    let [light, middle, heavy] = [0.01, 0.1, 1.0].map(after_two);
    assert!(light < 0.5 * middle && middle < 0.2 * heavy, "{light} {middle} {heavy}");
}

/// `cargo test --release -p fmu-deburr --test closed_loop -- every_weight --ignored --nocapture`
#[test]
#[ignore = "a measurement: a table of the README"]
fn every_weight() {
    for weight in [0.001, 0.01, 0.1, 1.0] {
        let mut line = format!("measured: deburr-weights | {weight} |");
        for (machine, factor) in [("nominal", 1.0), ("slow", 0.8), ("fast", 1.2)] {
            let build = Build { gain: factor, dynamics: factor, ..Build::NOMINAL };
            for (renewal, cost) in costs(weight, &build, 4).iter().enumerate() {
                line += &format!(" {machine}_{renewal}={cost}");
            }
        }
        println!("{line}");
    }
}

//! Hours without a fault: `cargo test --release -p fmu-deburr --test closed_loop -- nominal --ignored --nocapture`.

use std::f64::consts::TAU;

use fmu_deburr::interface::{AxisInput, Fault, Mode, Parameters, State};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::robot::{Build, STEP};
use crate::setup::Loop;

/// The tool idle, its slip in the largest burr at the programmed speed, and the noise and step of its measurement, rad/s.
const IDLE: f64 = 1885.0;
const SLIP: f64 = 150.0;
const NOISE: f64 = 0.5;
const RESOLUTION: f64 = 0.511;
/// Time constant of the tool, s.
const TOOL_TIME: f64 = 0.15;
/// Noise of the encoders, pulses.
const ENCODER_NOISE: f64 = 1.0;
/// Waves of the burr along the path, 1/m.
const WAVES: [f64; 2] = [23.0, 61.0];

/// Tool that a burr slows down, drawn again for each casting.
struct Tool {
    speed: f64,
    phases: [f64; 2],
}

impl Tool {
    fn advance(&mut self, distance: f64, feed: f64) {
        let wave = |i: usize| (TAU * WAVES[i] * distance + self.phases[i]).sin();
        // gaps where both waves are low
        let burr = (0.4 + 0.4 * wave(0) + 0.2 * wave(1)).max(0.0);
        let aim = IDLE - SLIP * burr * feed / 0.1;
        self.speed += STEP * (aim - self.speed) / TOOL_TIME;
    }
}

/// Deburrs castings with noisy measurements for a time, with computed patterns; returns their number.
fn castings_without_a_fault(hours: f64) -> u32 {
    let mut random = Pcg64Mcg::seed_from_u64(71_002);
    let mut p = Parameters::START;
    p.bank.compute = true;
    let pulses = p.pulses();
    let mut run = Loop::new(&p, &Build::NOMINAL);
    let mut tool = Tool { speed: IDLE, phases: [0.0; 2] };
    let (mut samples, mut castings) = (0_u32, 0);
    while f64::from(samples) * STEP < 3600.0 * hours {
        tool.phases = std::array::from_fn(|_| random.random_range(0.0..TAU));
        for mode in [Mode::Idle, Mode::Deburr] {
            run.input.mode = mode;
            loop {
                let mut normal = || StandardNormal.sample(&mut random);
                let read = run.robot.read();
                run.input.axis = std::array::from_fn(|i| {
                    let noise: f64 = normal();
                    AxisInput { position: read[i] + (ENCODER_NOISE * noise).round() * pulses[i] }
                });
                let noise: f64 = normal();
                run.input.spindle_speed = ((tool.speed + NOISE * noise) / RESOLUTION).round() * RESOLUTION;
                run.controller.tick(&run.input, &run.parameters, &mut run.output);
                run.robot.advance(&run.output.axis.map(|axis| axis.velocity));
                let cuts = run.output.state == State::Run;
                tool.advance(run.output.path.distance, if cuts { run.output.path.speed } else { 0.0 });
                samples += 1;
                assert_eq!(run.output.fault, Fault::None, "casting {castings}: {:?}", run.output.numbers);
                if mode == Mode::Idle || run.output.state == State::Done {
                    break;
                }
            }
        }
        castings += 1;
    }
    castings
}

#[test]
fn a_few_castings_have_no_fault() {
    assert!(castings_without_a_fault(0.01) > 2);
}

#[test]
#[ignore = "a measurement: the hours of the README"]
fn ten_hours_have_no_fault() {
    println!("measured: hours | fmu-deburr | hours=10 jobs={}", castings_without_a_fault(10.0));
}

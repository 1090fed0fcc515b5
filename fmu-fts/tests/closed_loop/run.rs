//! The controller on the machine, one communication step at a time.

use fmu_fts::controller::{Controller, Tables};
use fmu_fts::machine::Mode;
use fmu_fts::parameters::Parameters;
use fmu_fts::signals::{Input, Output};

use crate::machine::{Build, Machine, STEP};

/// The closed loop.
pub struct Loop {
    /// Plant.
    pub machine: Machine,
    /// Law.
    pub controller: Controller,
    /// Inputs that a test may change.
    pub input: Input,
    /// The last outputs.
    pub output: Output,
    /// Depth error of the tool in the last sample, m.
    pub tip_error: f64,
    parameters: Parameters,
    steps: u32,
    turned: f64,
}

/// Errors over some time, um.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Root mean square of the error by the encoder.
    pub rms: f64,
    /// Largest error by the encoder.
    pub peak: f64,
    /// Root mean square of the error of the tool, without its mean.
    pub tip: f64,
    /// Largest torque, N.m.
    pub torque: f64,
}

impl Loop {
    /// A machine from `seed` and a controller that is asked to track.
    pub fn new(p: &Parameters, build: &Build, seed: u64) -> Self {
        Self {
            machine: Machine::new(build, seed),
            controller: Controller::new(p, &Tables::default()).unwrap(),
            input: Input { mode: Mode::Track, ..Input::START },
            output: Output::START,
            tip_error: 0.0,
            parameters: p.clone(),
            steps: 0,
            turned: 0.0,
        }
    }

    /// Time of the next step, s.
    pub fn time(&self) -> f64 {
        f64::from(self.steps) * STEP
    }

    /// One communication step; the tool is in the part from 0.5 s on.
    pub fn step(&mut self) {
        let [arm_angle, spindle_angle, slide_position] = self.machine.read();
        let arm_angle = arm_angle + self.turned;
        self.input = Input { arm_angle, spindle_angle, slide_position, ..self.input.clone() };
        self.step_with_inputs();
    }

    /// One communication step with the inputs as they are.
    pub fn step_with_inputs(&mut self) {
        self.machine.in_part = self.time() > 0.5;
        self.controller.tick(&self.parameters, &self.input, &mut self.output);
        self.tip_error = self.output.reference.depth - self.machine.tip_depth();
        self.machine.advance(self.output.torque);
        self.steps += 1;
    }

    /// Swings the arm by `angle` (rad): from now on its encoder reads so much more.
    pub fn turn_arm(&mut self, angle: f64) {
        self.turned = angle;
    }

    /// Steps until the time `until` s.
    pub fn run_to(&mut self, until: f64) {
        while self.time() < until {
            self.step();
        }
    }

    /// Steps for `duration` s and measures.
    pub fn measure(&mut self, duration: f64) -> Measured {
        let (mut squares, mut peak, mut torque, mut tips) = (0.0, 0.0, 0.0, Vec::new());
        let until = self.time() + duration;
        while self.time() < until {
            self.step();
            let error = self.output.error.tracking;
            squares += error * error;
            peak = f64::max(peak, error.abs());
            torque = f64::max(torque, self.output.torque.abs());
            tips.push(self.tip_error);
        }
        let count = tips.len() as f64;
        let mean = tips.iter().sum::<f64>() / count;
        let variance = tips.iter().map(|tip| (tip - mean) * (tip - mean)).sum::<f64>() / count;
        Measured { rms: 1e6 * (squares / count).sqrt(), peak: 1e6 * peak, tip: 1e6 * variance.sqrt(), torque }
    }
}

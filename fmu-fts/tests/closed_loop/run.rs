//! The controller on the machine, one communication step at a time.

use std::collections::VecDeque;

use fmu_fts::controller::Controller;
use fmu_fts::interface::{Input, Mode, Output, Parameters};
use fmu_fts::texts::Tables;

use crate::machine::{Build, Machine, STEP};

/// The closed loop.
#[derive(Clone)]
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
    /// depths of the tool, as old as the reference is last, m
    tips: VecDeque<f64>,
    /// Parameters in force.
    pub parameters: Parameters,
    steps: u32,
    rotation: f64,
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
    /// Root mean square of the reference depth, without its mean.
    pub path: f64,
    /// Largest torque, N.m.
    pub torque: f64,
}

impl Loop {
    /// A machine from `seed` and a controller that is asked to track.
    pub fn new(p: &Parameters, build: &Build, seed: u64) -> Self {
        Self {
            machine: Machine::new(build, seed),
            controller: Controller::new(p, &Tables::default()).unwrap(),
            input: Input { enable: true, mode: Mode::Track, ..Input::START },
            output: Output::START,
            tip_error: 0.0,
            tips: vec![0.0; p.arm_delay as usize].into(),
            parameters: p.clone(),
            steps: 0,
            rotation: 0.0,
        }
    }

    /// Time of the next step, s.
    pub fn time(&self) -> f64 {
        f64::from(self.steps) * STEP
    }

    /// One communication step; the tool is in the part from 0.5 s on.
    pub fn step(&mut self) {
        let [arm_angle, spindle_angle, slide_position] = self.machine.read();
        let arm_angle = arm_angle + self.rotation;
        self.input = Input { arm_angle, spindle_angle, slide_position, ..self.input.clone() };
        self.step_with_inputs();
    }

    /// One communication step with inputs that `change` has changed.
    pub fn step_with(&mut self, change: impl Fn(&mut Input)) {
        let [arm_angle, spindle_angle, slide_position] = self.machine.read();
        let good = self.input.clone();
        self.input = Input { arm_angle, spindle_angle, slide_position, ..good.clone() };
        change(&mut self.input);
        self.step_with_inputs();
        self.input = good;
    }

    /// One communication step with the inputs as they are.
    pub fn step_with_inputs(&mut self) {
        self.machine.in_part = self.time() > 0.5;
        self.controller.bring_into_force(&mut self.parameters);
        self.controller.tick(&self.input, &self.parameters, &mut self.output);
        self.tips.push_front(self.machine.tip_depth());
        self.tip_error = self.output.reference.depth - self.tips.pop_back().unwrap_or_default();
        self.machine.advance(self.output.torque);
        self.steps += 1;
    }

    /// The same loop, with the controller from its state bytes.
    pub fn reloaded(&self) -> Self {
        let bytes = postcard::to_allocvec(&self.controller).unwrap();
        Self { controller: postcard::from_bytes(&bytes).unwrap(), ..self.clone() }
    }

    /// Moves the slide besides its feed, m/s.
    pub fn feed(&mut self, speed: f64) {
        self.machine.feed = speed;
    }

    /// Rotates the arm by `angle` (rad): from now on its encoder shows that much more.
    pub fn rotate_arm(&mut self, angle: f64) {
        self.rotation = angle;
    }

    /// Steps until the time `until` s.
    pub fn run_to(&mut self, until: f64) {
        while self.time() < until {
            self.step();
        }
    }

    /// Steps for `duration` s and measures.
    pub fn measure(&mut self, duration: f64) -> Measured {
        let (mut errors, mut tips, mut depths, mut torque) = (Vec::new(), Vec::new(), Vec::new(), 0.0);
        let until = self.time() + duration;
        while self.time() < until {
            self.step();
            errors.push(1e6 * self.output.error.tracking);
            tips.push(1e6 * self.tip_error);
            depths.push(1e6 * self.output.reference.depth);
            torque = f64::max(torque, self.output.torque.abs());
        }
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        let peak = errors.iter().fold(0.0, |peak: f64, error| peak.max(error.abs()));
        Measured { rms, peak, tip: deviation(&tips), path: deviation(&depths), torque }
    }
}

/// Root mean square without the mean.
fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count).sqrt()
}

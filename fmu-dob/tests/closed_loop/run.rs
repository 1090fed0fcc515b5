//! The controller on the slide, one communication step at a time.

use fmu_dob::controller::Controller;
use fmu_dob::interface::{Input, Output, Parameters, State};

use crate::slide::{SPINDLE_SPEED, STEP, Slide};

/// Surface out of reach, m.
pub const NO_WORKPIECE: f64 = 1.0;
/// Idle steps before the approach begins.
const IDLE: u32 = 200;

/// The closed loop.
#[derive(Clone)]
pub struct Loop {
    /// Plant.
    pub slide: Slide,
    /// Law.
    pub controller: Controller,
    /// The last outputs.
    pub output: Output,
    /// Active parameters of the controller.
    pub parameters: Parameters,
    steps: u32,
}

impl Loop {
    /// A slide from `seed` with its workpiece at `surface` m, the controller idle.
    pub fn new(parameters: &Parameters, seed: u64, surface: f64) -> Self {
        Self {
            slide: Slide::new(seed, surface),
            controller: Controller::new(parameters).unwrap(),
            output: Output::START,
            parameters: parameters.clone(),
            steps: 0,
        }
    }

    /// Time of the next step, s.
    pub fn time(&self) -> f64 {
        f64::from(self.steps) * STEP
    }

    /// One communication step; the approach begins after 0.02 s.
    pub fn step(&mut self) {
        self.step_with(|_| ());
    }

    /// One communication step with changed inputs.
    pub fn step_with(&mut self, change: impl FnOnce(&mut Input)) {
        let direction = self.parameters.direction();
        let mut input = Input {
            position: direction * self.slide.encoder(),
            spindle_speed: SPINDLE_SPEED,
            enable: self.steps >= IDLE,
            ..Input::START
        };
        change(&mut input);
        self.controller.bring_into_force(&mut self.parameters);
        self.controller.tick(&input, &self.parameters, &mut self.output);
        self.slide.advance(direction * self.output.current);
        self.steps += 1;
    }

    /// Steps until `state`; false if that takes longer than to the time `limit` s.
    pub fn run_to(&mut self, state: State, limit: f64) -> bool {
        while self.output.state != state && self.time() <= limit {
            self.step();
        }
        self.output.state == state
    }

    /// The same loop, with the controller from its state bytes.
    pub fn reloaded(&self) -> Self {
        let bytes = postcard::to_allocvec(&self.controller).unwrap();
        Self { controller: postcard::from_bytes(&bytes).unwrap(), ..self.clone() }
    }
}

//! The controller on a small plant, one communication step at a time.

use fmu___name__::controller::Controller;
use fmu___name__::interface::{Input, Output, Parameters, State};

/// Communication step, s.
const STEP: f64 = 1e-3;
/// Moving mass, kg: 5 % above the configured value.
const MASS: f64 = 2.1;
/// Dry friction, N.
pub const FRICTION: f64 = 2.0;
/// Idle steps before the start.
const IDLE: u32 = 10;

/// A mass on a slide with dry friction.
#[derive(Clone, Default)]
pub struct Slide {
    /// m
    pub position: f64,
    /// m/s
    pub velocity: f64,
    /// External force, N.
    pub load: f64,
}

impl Slide {
    /// One step. Friction reduces the velocity but never reverses it.
    fn advance(&mut self, force: f64) {
        let free = self.velocity + (force + self.load) / MASS * STEP;
        let friction = FRICTION / MASS * STEP;
        self.velocity = free - free.clamp(-friction, friction);
        self.position += self.velocity * STEP;
    }
}

/// The closed loop; a force acts one step later.
pub struct Loop {
    pub slide: Slide,
    pub controller: Controller,
    /// Outputs of the last step.
    pub output: Output,
    p: Parameters,
    /// Steps so far.
    steps: u32,
}

impl Loop {
    /// A slide at rest and an idle controller with the parameters `p`.
    pub fn new(p: &Parameters) -> Self {
        let controller = Controller::new(p).unwrap();
        Self { slide: Slide::default(), controller, output: Output::START, p: p.clone(), steps: 0 }
    }

    /// One step; `enable` rises after 0.01 s.
    pub fn step(&mut self) {
        self.step_with(|_| ());
    }

    /// One step with changed inputs.
    pub fn step_with(&mut self, change: impl FnOnce(&mut Input)) {
        let mut input = Input { position: self.slide.position, enable: self.steps >= IDLE, reset_fault: false };
        change(&mut input);
        let before = self.output.force;
        self.controller.tick(&input, &self.p, &mut self.output);
        self.slide.advance(before);
        self.steps += 1;
    }

    /// Steps until `state`, for a maximum of `seconds`; true if it was reached.
    pub fn run_to(&mut self, state: State, seconds: f64) -> bool {
        let limit = self.steps + (seconds / STEP) as u32;
        while self.output.state != state && self.steps <= limit {
            self.step();
        }
        self.output.state == state
    }
}

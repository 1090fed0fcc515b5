//! The controller on the machine, one communication step at a time.

use fmu_centering::controller::Controller;
use fmu_centering::interface::{Input, Output, Parameters, State};

use crate::ring::{Ring, STEP};

/// Idle steps before the start.
const IDLE: u32 = 10;

/// The closed loop.
#[derive(Clone)]
pub struct Loop {
    /// Plant.
    pub ring: Ring,
    /// Law.
    pub controller: Controller,
    /// The last outputs.
    pub output: Output,
    /// Largest number of revolutions in one wait.
    pub longest_wait: f64,
    parameters: Parameters,
    steps: u32,
    wait: f64,
}

impl Loop {
    /// A machine with the controller idle.
    pub fn new(parameters: &Parameters, ring: Ring) -> Self {
        Self {
            ring,
            controller: Controller::new(parameters).unwrap(),
            output: Output::START,
            longest_wait: 0.0,
            parameters: parameters.clone(),
            steps: 0,
            wait: 0.0,
        }
    }

    /// Parameters in force.
    pub fn in_force(&self) -> Parameters {
        let mut p = self.parameters.clone();
        self.controller.bring_into_force(&mut p);
        p
    }

    /// The same loop, with the controller from its state bytes.
    pub fn reloaded(&self) -> Self {
        let bytes = postcard::to_allocvec(&self.controller).unwrap();
        Self { controller: postcard::from_bytes(&bytes).unwrap(), ..self.clone() }
    }

    /// Time of the next step, s.
    pub fn time(&self) -> f64 {
        f64::from(self.steps) * STEP
    }

    /// One communication step; `enable` comes after 0.01 s.
    pub fn step(&mut self) {
        self.step_with(|_| ());
    }

    /// One communication step with changed inputs.
    pub fn step_with(&mut self, change: impl FnOnce(&mut Input)) {
        let [spindle_angle, slide_position, probe_position] = self.ring.read();
        let enable = self.steps >= IDLE;
        let mut input = Input { spindle_angle, slide_position, probe_position, enable, ..Input::START };
        change(&mut input);
        self.controller.bring_into_force(&mut self.parameters);
        self.controller.tick(&input, &self.parameters, &mut self.output);
        self.ring.advance(self.output.slide.position_setpoint, self.output.slide.velocity_setpoint);
        self.steps += 1;
        let waiting = self.output.state == State::Wait;
        self.wait = if waiting { self.wait + self.ring.speed.abs() * STEP / std::f64::consts::TAU } else { 0.0 };
        self.longest_wait = self.longest_wait.max(self.wait);
    }

    /// Steps with inputs that are changed for longer than is bridged.
    pub fn spoil(&mut self, change: impl Fn(&mut Input)) {
        (0..=self.parameters.limits.lost_samples).for_each(|_| self.step_with(&change));
    }

    /// Steps until `state`; false if that takes longer than to the time `limit` s.
    pub fn run_to(&mut self, state: State, limit: f64) -> bool {
        while self.output.state != state && self.time() <= limit {
            self.step();
        }
        self.output.state == state
    }
}

/// A loop in `state`, with a ring 0.2 mm off.
pub fn running(p: &Parameters, state: State) -> Loop {
    let mut run = Loop::new(p, Ring::new(1, 2e-4, 0.5));
    assert!(run.run_to(state, 60.0), "{:?}", run.output);
    run
}

/// Whether all outputs are finite.
pub fn finite(o: &Output) -> bool {
    let reals = [
        o.slide.position_setpoint,
        o.slide.velocity_setpoint,
        o.time_to_center,
        o.eccentricity,
        o.eccentricity_angle,
        o.eccentricity_std,
        o.spindle_speed,
        o.pusher_gap,
        o.push.distance,
        o.push.velocity,
        o.push.lead_angle,
        o.push.offset,
        o.push.overshoot,
        o.push.overshoot_max,
    ];
    reals.iter().all(|x| x.is_finite())
}

//! The controller on the robot, one communication step at a time.

use assert_no_alloc::assert_no_alloc;
use fmu_polish::controller::Controller;
use fmu_polish::interface::{Input, Output, Parameters, State};
use fmu_polish::path::cl_file::points;
use nalgebra::Vector3;

use crate::common::{file, spiral};
use crate::robot::{Build, Robot, STEP};

/// Points of the path: 8 mm.
pub const POINTS: usize = 400;
/// Time after the feed began from which forces count, s.
const RUN_IN: f64 = 0.3;

/// The closed loop.
#[derive(Clone)]
pub struct Loop {
    /// Plant.
    pub robot: Robot,
    /// Law.
    pub controller: Controller,
    /// The last inputs.
    pub input: Input,
    /// The last outputs.
    pub output: Output,
    /// Parameters of the controller.
    pub parameters: Parameters,
    steps: u32,
}

/// Quality of a complete cycle: settling, force, sliding and path error.
#[derive(Clone, Copy, Debug)]
pub struct Cycle {
    /// From the first touch to the start of the feed, s.
    pub settle: f64,
    /// Largest force beyond the target before the feed, N.
    pub overshoot: f64,
    /// Mean of the true force, N.
    pub mean: f64,
    /// Its standard deviation, N.
    pub deviation: f64,
    /// Smallest force while it polishes, N.
    pub minimum: f64,
    /// Travel that the ball slid, over the path of its center.
    pub gain: f64,
    /// Position error in the tangent plane, means of 50 ms, rms, m.
    pub in_plane: f64,
}

impl Loop {
    /// A robot from `seed` above the spiral.
    pub fn new(p: &Parameters, build: Build, seed: u64) -> Self {
        Self::displaced(p, build, seed, Vector3::zeros())
    }

    /// The same, the robot `offset` m from there.
    pub fn displaced(p: &Parameters, build: Build, seed: u64, offset: Vector3<f64>) -> Self {
        let path = points(file(&spiral(POINTS)).as_bytes(), p).unwrap();
        let controller = Controller::new(p, &path).unwrap();
        let start = path[0].contact + (p.tool_radius + build.height) * path[0].normal;
        let robot = Robot::new(build, start + offset, seed);
        let input = Input { enable: true, ..Input::START };
        Self { robot, controller, input, output: Output::START, parameters: p.clone(), steps: 0 }
    }

    /// From now on `enable` is what it is, from the first sample on.
    pub fn skip_first_edge(&mut self) {
        self.steps += 1;
    }

    /// Time of the next step, s.
    pub fn time(&self) -> f64 {
        f64::from(self.steps) * STEP
    }

    /// One communication step; the cycle starts with the first.
    pub fn step(&mut self) {
        self.step_with(|_| ());
    }

    /// One communication step with changed inputs.
    pub fn step_with(&mut self, change: impl FnOnce(&mut Input)) {
        self.input.position = self.robot.position().into();
        self.input.force = self.robot.force().into();
        let mut input = self.input.clone();
        change(&mut input);
        // a cycle begins with a rising edge
        input.enable &= self.steps > 0;
        let Self { controller, parameters, output, .. } = self;
        // `tests/allocation.rs` has an allocator that ends the test here
        assert_no_alloc(|| {
            controller.bring_into_force(parameters);
            controller.tick(&input, parameters, output);
        });
        let pulses = self.output.pulses;
        self.robot.advance(Vector3::new(pulses.x, pulses.y, pulses.z), self.output.drive_enable);
        self.steps += 1;
    }

    /// Steps until `state`; false if that takes longer than to the time `limit` s.
    pub fn run_to(&mut self, state: State, limit: f64) -> bool {
        while self.output.state != state && self.time() <= limit {
            self.step();
        }
        self.output.state == state
    }

    /// Runs a whole cycle; none if it does not complete.
    pub fn cycle(&mut self, limit: f64) -> Option<Cycle> {
        let (mut touched, mut followed, mut maximum) = (f64::NAN, f64::NAN, 0.0f64);
        let (mut forces, mut errors, mut minimum) = (Vec::new(), Vec::new(), f64::MAX);
        let (mut slid, mut distance, mut before) = (0.0, 0.0, None);
        while !self.output.done {
            if self.time() > limit || self.output.state == State::Fault {
                return None;
            }
            self.step();
            let (force, time) = (self.robot.normal_force, self.time());
            if touched.is_nan() && force > 0.0 {
                touched = time;
            }
            match self.output.state {
                State::Settle => maximum = maximum.max(force),
                State::Follow => {
                    if followed.is_nan() {
                        (followed, slid) = (time, self.robot.slid);
                    }
                    minimum = minimum.min(force);
                    let desired = self.output.desired.vector();
                    distance += before.map_or(0.0, |last: Vector3<f64>| (desired - last).norm());
                    before = Some(desired);
                    if time > followed + RUN_IN {
                        forces.push(force);
                        errors.push((self.output.error.tangential, self.output.error.lateral));
                    }
                }
                State::Unload if before.take().is_some() => slid = self.robot.slid - slid,
                _ => (),
            }
        }
        let mean = forces.iter().sum::<f64>() / forces.len() as f64;
        let variance = forces.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / forces.len() as f64;
        Some(Cycle {
            settle: followed - touched,
            overshoot: maximum - self.parameters.force.target,
            mean,
            deviation: variance.sqrt(),
            minimum,
            gain: slid / distance,
            in_plane: rms_of_means(&errors, 50),
        })
    }

    /// The same loop, with the controller restored from its state bytes.
    pub fn reloaded(&self) -> Self {
        let bytes = postcard::to_allocvec(&self.controller).unwrap();
        Self { controller: postcard::from_bytes(&bytes).unwrap(), ..self.clone() }
    }
}

/// Root mean square of the lengths of the means over `window` samples.
fn rms_of_means(errors: &[(f64, f64)], window: usize) -> f64 {
    let squares: Vec<f64> = errors
        .chunks_exact(window)
        .map(|chunk| {
            let (a, b) = chunk.iter().fold((0.0, 0.0), |(a, b), e| (a + e.0, b + e.1));
            (a * a + b * b) / (window * window) as f64
        })
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

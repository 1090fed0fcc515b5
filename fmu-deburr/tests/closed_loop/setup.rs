//! The controller on the robot, one communication step at a time.

use std::path::Path;

use fmu_deburr::controller::Controller;
use fmu_deburr::interface::{AxisInput, Fault, Input, Mode, Output, Parameters, State};
use fmu_deburr::path::path_file;
use fmu_deburr::path::{AXES, Joints};

use crate::robot::{Build, Robot};

/// The closed loop.
#[derive(Clone)]
pub struct Loop {
    /// Plant.
    pub robot: Robot,
    /// Law.
    pub controller: Controller,
    /// Inputs that a test may change.
    pub input: Input,
    /// The last outputs.
    pub output: Output,
    /// Parameters of the control law.
    pub parameters: Parameters,
}

/// Parameters for a robot whose commands act after `delay` samples.
pub fn parameters(base: &Parameters, delay: i32) -> Parameters {
    let mut p = base.clone();
    p.io_delay = delay;
    p
}

/// Learning from zero, with all repetitions.
pub fn from_zero(mut p: Parameters) -> Parameters {
    (p.learn.identify, p.learn.tolerance, p.learn.decrease) = (false, 0.0, 0.0);
    p
}

/// A loop that has learned, without a repetition.
pub fn trained() -> Loop {
    let mut p = from_zero(Parameters::START);
    p.learn.repetitions = 0;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    assert!(run.finish(Mode::Learn));
    run
}

/// 6:1 in speed, `hertz` times a second.
pub fn swinging(hertz: f64) -> impl Fn(f64) -> f64 {
    move |time| (3.5 + 2.5 * (std::f64::consts::TAU * hertz * time).sin()) / 6.0
}

impl Loop {
    /// The test piece of the resources.
    pub fn new(p: &Parameters, build: &Build) -> Self {
        let resources = Path::new(env!("CARGO_MANIFEST_DIR")).join("resources");
        Self::with_path(p, build, path_file::read(p, Some(&resources)).unwrap())
    }

    /// Another path.
    pub fn with_path(p: &Parameters, build: &Build, path: fmu_deburr::path::ProgrammedPath) -> Self {
        Self {
            robot: Robot::new(build, &[-0.1, 0.02, 0.7, 0.0, 0.0, 0.0]),
            controller: Controller::new(p, path).unwrap(),
            input: Input { enable: true, ..Input::START },
            output: Output::START,
            parameters: p.clone(),
        }
    }

    /// The same loop, with the control law from its state bytes.
    pub fn reloaded(&self) -> Self {
        let bytes = postcard::to_allocvec(&self.controller).unwrap();
        Self { controller: postcard::from_bytes(&bytes).unwrap(), ..self.clone() }
    }

    /// Takes the encoder measurements in.
    pub fn read(&mut self) {
        let positions = self.robot.read();
        self.set_positions(&positions);
    }

    /// Takes other measurements in.
    pub fn set_positions(&mut self, positions: &Joints) {
        self.input.axis = positions.map(|position| AxisInput { position });
    }

    /// One communication step.
    pub fn step(&mut self) {
        self.read();
        self.tick();
    }

    /// The same with the inputs as they are.
    pub fn tick(&mut self) {
        let mut in_force = self.parameters.clone();
        self.controller.bring_into_force(&mut in_force);
        self.controller.tick(&self.input, &in_force, &mut self.output);
        self.robot.advance(&self.output.axis.map(|axis| axis.velocity));
    }

    /// Steps with a mode until its task is done; true if it was.
    pub fn finish(&mut self, mode: Mode) -> bool {
        self.input.mode = Mode::Idle;
        self.step();
        self.step();
        self.input.mode = mode;
        for _ in 0..1_000_000 {
            self.step();
            if matches!(self.output.state, State::Done | State::Fault) {
                break;
            }
        }
        if self.output.state == State::Fault {
            println!("{:?}: {:?}", self.output.fault, self.output.numbers);
        }
        self.output.state == State::Done
    }

    /// Runs a task; returns the largest control error on the path of each axis, mm at the tip.
    pub fn largest_errors(&mut self, mode: Mode, speed: impl Fn(f64) -> f64) -> Joints {
        self.input.mode = Mode::Idle;
        self.step();
        self.step();
        self.input.mode = mode;
        let (mut largest, mut time) = ([0.0; AXES], 0.0);
        while !matches!(self.output.state, State::Done | State::Fault) {
            self.input.speed_override = speed(time);
            self.step();
            if self.output.state == State::Run {
                time += 0.01;
                let levers = self.parameters.arm.levers(&self.robot.positions());
                for (i, axis) in self.output.axis.iter().enumerate() {
                    largest[i] = f64::max(largest[i], 1e3 * (axis.error * levers[i]).abs());
                }
            }
        }
        assert_eq!(self.output.state, State::Done, "{:?} {:?}", self.output.fault, self.output.numbers);
        self.input.speed_override = 1.0;
        largest
    }
}

/// A robot that runs the path without patterns.
pub fn running(mode: Mode) -> Loop {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    let mut run = Loop::new(&p, &Build::NOMINAL);
    run.step();
    run.input.mode = mode;
    while run.output.state != State::Run {
        run.step();
    }
    (0..100).for_each(|_| run.step());
    run
}

/// In the fault, with zero commands, or with a pose that is held by commands as small as the last counts.
pub fn assert_rests_with(run: &Loop, fault: Fault) {
    assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
    let minimum = if run.output.drive_enable { 2e-4 } else { 0.0 };
    assert!(run.output.axis.iter().all(|axis| axis.velocity.abs() <= minimum), "{:?}", run.output.axis);
}

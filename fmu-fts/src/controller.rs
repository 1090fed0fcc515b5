//! One sample of the whole law: read, decide, refer, act, report.

use control_blocks::ParameterError;
use serde::{Deserialize, Serialize};

use crate::check::check;
use crate::design::design;
use crate::hold::Hold;
use crate::kinematics::Arm;
use crate::lead_lag::{LeadLag, Recursion};
use crate::machine::{Events, Fault, Mode, State, next};
use crate::parameters::Parameters;
use crate::quintic::Motion;
use crate::reading::{Reader, Reading};
use crate::signals::{Input, Output};
use crate::spindle::Spindle;

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    arm: Arm,
    compensator: LeadLag,
    reader: Reader,
    spindle: Spindle,
    state: State,
    fault: Fault,
    hold: Hold,
    /// what the arm should do in this sample
    reference: Motion,
    recursion: Recursion,
}

impl Controller {
    /// Controller before its first sample.
    ///
    /// # Errors
    /// When a parameter does not fit the others.
    pub fn new(p: &Parameters) -> Result<Self, ParameterError> {
        check(p)?;
        Ok(Self {
            arm: Arm::new(p),
            compensator: design(p)?,
            reader: Reader::default(),
            spindle: Spindle::default(),
            state: State::Idle,
            fault: Fault::None,
            hold: Hold::at(0.0),
            reference: Motion::default(),
            recursion: Recursion::default(),
        })
    }

    /// One sample; the parameters must be those of [`Controller::new`].
    pub fn tick(&mut self, p: &Parameters, input: &Input, output: &mut Output) {
        let (reading, valid) = self.reader.read(input);
        self.spindle.update(p, reading.spindle_angle);
        self.decide(p, input.mode, &reading, valid);
        self.refer(p, &reading);
        let torque = self.act(p, &reading);
        self.report(torque, &reading, output);
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, mode: Mode, reading: &Reading, valid: bool) {
        let events = Events { fault: self.find_fault(p, reading, valid), arrived: false };
        let state = next(self.state, mode, &events);
        if state != self.state {
            self.enter(p, state, &events, reading);
            self.state = state;
        }
    }

    /// The gravest fault of this sample.
    fn find_fault(&self, p: &Parameters, reading: &Reading, valid: bool) -> Option<Fault> {
        let error = self.arm.length * (self.reference.angle - reading.arm_angle);
        let behind = self.state.closed() && error.abs() > p.limit.following_error;
        (!valid).then_some(Fault::InvalidInput).or(behind.then_some(Fault::FollowingError))
    }

    /// What happens once, when `state` begins.
    fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading) {
        self.fault = events.fault.filter(|_| state == State::Fault).unwrap_or(Fault::None);
        if !self.state.closed() {
            self.reference = Motion { angle: reading.arm_angle, ..Motion::default() };
            self.recursion = Recursion::default();
        }
        if !state.on_path() {
            self.hold.go(p, self.reference, reading.hold_angle);
        }
    }

    /// What the arm should do.
    fn refer(&mut self, p: &Parameters, reading: &Reading) {
        self.reference = match self.state {
            State::Idle | State::Fault => Motion { angle: reading.arm_angle, ..Motion::default() },
            State::Hold | State::Calibrate | State::Identify => self.hold.step(p, reading.hold_angle),
            State::Approach | State::Ready | State::Track => self.reference,
        };
    }

    /// Position loop.
    fn act(&mut self, p: &Parameters, reading: &Reading) -> f64 {
        if !self.state.closed() {
            return 0.0;
        }
        let error = self.reference.angle - reading.arm_angle;
        self.recursion.update(&self.compensator, error, p.servo.torque_max)
    }

    fn report(&self, torque: f64, reading: &Reading, output: &mut Output) {
        output.torque = torque;
        output.state = self.state;
        output.fault = self.fault;
        output.reference.angle = self.reference.angle;
        output.reference.depth = self.arm.depth(self.reference.angle);
        output.error.tracking = self.arm.lever(reading.arm_angle) * (self.reference.angle - reading.arm_angle);
        output.spindle_speed = self.spindle.speed;
        output.saturated = self.state.closed() && self.recursion.saturated;
    }
}

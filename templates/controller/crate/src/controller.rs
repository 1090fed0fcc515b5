//! One control step: measure, supervise, plan, control.

use control_blocks::{Consecutive, ParameterError, ticks};
use serde::{Deserialize, Serialize};

use crate::check::check;
use crate::faults;
use crate::interface::{Fault, Input, Output, Parameters, State};
use crate::machine::{Events, next};
use crate::motion::Setpoint;
use crate::reading::{Reader, Reading};
use crate::servo::PositionServo;

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    reader: Reader,
    setpoint: Setpoint,
    servo: PositionServo,
    /// Consecutive samples within `settle.band`.
    settled: Consecutive,
    state: State,
    fault: Fault,
}

impl Controller {
    /// Controller before its first sample.
    ///
    /// # Errors
    /// When a parameter does not fit the others.
    pub fn new(p: &Parameters) -> Result<Self, ParameterError> {
        check(p)?;
        Ok(Self {
            reader: Reader::default(),
            setpoint: Setpoint::resting(0.0),
            servo: PositionServo::default(),
            settled: Consecutive::default(),
            state: State::Idle,
            fault: Fault::None,
        })
    }

    /// One control step. The parameters must be those of [`Controller::new`].
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        let reading = self.reader.read(p, input);
        self.follow(&reading);
        self.decide(p, &reading);
        *output = self.drive(p, &reading);
    }

    /// Sets the setpoint to the position while the servo is off.
    fn follow(&mut self, reading: &Reading) {
        if reading.first || self.state == State::Fault {
            self.setpoint = Setpoint::resting(reading.position);
            self.servo = PositionServo::default();
        }
    }

    /// Updates the state machine.
    fn decide(&mut self, p: &Parameters, reading: &Reading) {
        let error = self.setpoint.at().position - reading.position;
        let settled = self.settled.update(self.setpoint.over() && error.abs() <= p.settle.band);
        let events = Events {
            enabled: reading.enabled,
            start: reading.start,
            reset: reading.reset && reading.at_rest,
            fault: faults::find(p, reading, error),
            arrived: settled > ticks(p.settle.time, p.sample_period),
        };
        let state = next(self.state, &events);
        if state != self.state {
            self.enter(p, state);
            self.fault = events.fault.unwrap_or(Fault::None);
            self.state = state;
        }
    }

    fn enter(&mut self, p: &Parameters, state: State) {
        match state {
            State::Idle => self.setpoint.stop(p),
            State::Run => self.setpoint.go(p),
            State::Done | State::Fault => {}
        }
    }

    /// Advances the setpoint and computes the outputs; a missing output is a compile error.
    fn drive(&mut self, p: &Parameters, reading: &Reading) -> Output {
        let desired = self.setpoint.at();
        self.setpoint.advance(p.sample_period);
        let following_error = desired.position - reading.position;
        let force = match self.state {
            State::Fault => 0.0,
            _ => self.servo.force(p, following_error, desired.acceleration),
        };
        Output { force, setpoint: desired.position, following_error, state: self.state, fault: self.fault }
    }
}

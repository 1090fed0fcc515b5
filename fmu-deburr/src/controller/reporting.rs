//! Writes every output of a sample.

use control_blocks::Reaction;

use crate::controller::Controller;
use crate::interface::{AxisOutput, BankStatus, Mode, Output, Parameters, State};
use crate::path::kinematics::{AXES, Joints};
use crate::servo;

impl Controller {
    /// Writes the outputs of the sample.
    pub(super) fn report(&self, p: &Parameters, velocity: &Joints, output: &mut Output) {
        let reference = servo::pulses(p, &self.joints);
        let Output {
            axis,
            saturated,
            state,
            fault,
            drive_enable,
            path,
            learn,
            load,
            bank,
            numbers,
            measured,
            registration,
            probe,
        } = output;
        *axis = std::array::from_fn(|i| AxisOutput {
            velocity: velocity[i],
            reference: reference[i] * p.axis[i].pulse,
            error: self.error[i] * p.axis[i].pulse,
            compensation: self.compensation[i] * p.axis[i].pulse,
            rms: self.learner.errors.rms[i],
            peak: self.learner.errors.peak[i],
            gain: self.feedforward.drives[i].gain[0],
            gain_std: self.feedforward.drives[i].gain[1],
            lag: self.feedforward.drives[i].lag[0],
            lag_std: self.feedforward.drives[i].lag[1],
        });
        *saturated = (0..AXES).any(|i| velocity[i].abs() >= p.axis[i].velocity_max);
        (*state, *fault, *numbers) = (self.state, self.fault, self.numbers);
        *measured = self.commissioning_run.measured;
        (*registration, *probe) = (self.registrar.found, self.registering);
        *drive_enable = self.state != State::Fault || self.fault.reaction() != Reaction::DriveOff;
        *path = self.run.report(&self.path, self.on_path, self.state == State::Done && self.task.moves());
        *learn = self.learner.report(p, self.task == Mode::Learn || self.learned, self.learned);
        *load = self.load.report(p, self.state == State::Run);
        bank.patterns = self.bank.patterns().len() as i32;
        bank.status = match self.learning || self.changed {
            true if bank.patterns == 0 => BankStatus::Empty,
            true => BankStatus::Learned,
            false => self.origin,
        };
    }
}

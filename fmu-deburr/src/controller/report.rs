//! What the controller tells about a sample.

use super::Controller;
use crate::feed::Point;
use crate::kinematics::{AXES, Joints};
use crate::machine::{Mode, State};
use crate::parameters::Parameters;
use crate::servo;
use crate::signals::{BankStatus, Output};

impl Controller {
    /// Writes the outputs of this sample.
    pub(super) fn report(&self, p: &Parameters, velocity: &Joints, output: &mut Output) {
        let (axes, reference) = (p.axes(), servo::pulses(p, &self.joints));
        let errors = &self.learner.errors;
        for (i, out) in output.axes_mut().into_iter().enumerate() {
            let pulse = axes[i].pulse;
            out.velocity = velocity[i];
            out.reference = reference[i] * pulse;
            out.error = self.error[i] * pulse;
            out.compensation = self.compensation[i] * pulse;
            (out.rms, out.peak) = (errors.rms[i], errors.peak[i]);
        }
        output.saturated = (0..AXES).any(|i| velocity[i].abs() >= axes[i].velocity_max);
        (output.state, output.fault) = (self.state, self.fault);
        self.report_path(output);
        let running = self.job == Mode::Learn || self.learned;
        output.learn.speed_index =
            if running { self.learner.speed.min(p.learn.speeds.list().len() - 1) as i32 + 1 } else { 0 };
        output.learn.repetition = self.learner.repetition;
        output.learn.best = self.learner.best_repetition;
        output.learn.cost = errors.cost;
        output.learn.done = self.learned;
        output.load.feed = self.load.feed();
        output.load.overload = self.state == State::Run && self.load.overloaded(p);
        output.bank.patterns = self.bank.patterns().len() as i32;
        if self.learned && matches!(output.bank.status, BankStatus::Empty | BankStatus::Imported) {
            output.bank.status = BankStatus::Learned;
        }
    }

    fn report_path(&self, output: &mut Output) {
        let point = if self.on_path { self.run.point() } else { Point::default() };
        let place = self.path.place(point.distance);
        let out = &mut output.path;
        (out.distance, out.speed) = (point.distance, point.speed);
        (out.block, out.block_distance) = (place.block as i32 + 1, place.distance);
        out.length = self.path.length();
        out.laps = self.run.laps as i32;
        out.done = self.state == State::Done && self.job.moves();
        out.tip = self.path.at(point.distance).tip.into();
    }
}

//! The outputs of a sample.

use crate::controller::Controller;
use crate::interface::{ErrorOutput, FormOutput, Output, Parameters, ReferenceOutput, ResponseOutput, State};
use crate::monitoring::numbers::Numbers;
use crate::path::feasibility::needed_torque;
use crate::reading::Reading;
use crate::tracking::tracker::Target;

impl Controller {
    pub(super) fn report(
        &mut self,
        p: &Parameters,
        torque: f64,
        target: &Target,
        reading: &Reading,
        output: &mut Output,
    ) {
        let (revolution, path, speed) = (self.tracker.last_revolution(), self.tracker.path(), self.spindle.speed);
        let lag = target.motion.position - reading.arm_angle;
        output.torque = torque;
        output.state = self.state;
        output.fault = self.ending.fault();
        output.drive_enable = self.ending.drive_enable();
        output.drive_gain_ratio = self.watch.ratio(p).unwrap_or(1.0);
        output.reference = ReferenceOutput { depth: target.depth, angle: target.motion.position };
        output.error = ErrorOutput {
            // the message of a fault shows the last error
            tracking: match self.state {
                State::Fault if !self.closed() => self.watch.following_error(),
                _ => self.arm.lever(reading.arm_angle) * lag,
            },
            rms: revolution.rms,
            peak: revolution.peak,
            harmonic: revolution.amplitudes,
        };
        output.spindle_speed = speed;
        output.saturated = self.closed() && self.recursion.saturated;
        output.path_torque = needed_torque(p, path, speed);
        output.path_torque_ratio = self.tracker.torque_ratio();
        output.path_truncation = path.truncation;
        output.numbers = Numbers {
            drive_ratio: self.watch.minimum_ratio(p),
            late: self.late,
            fed: self.feed.lost(),
            table: path.ends(),
            ..self.watch.numbers()
        };
        output.calibration = self.calibration.report();
        output.form = FormOutput { corrected: path.correction().is_some(), ..self.calibration.form() };
        output.measured = self.commissioning.measured;
        output.identify_progress = self.identification.progress();
        if let Some(response) = self.response.take() {
            output.response = ResponseOutput::of(&response, self.tracker.response(), &self.tracker.flexure());
        }
    }
}

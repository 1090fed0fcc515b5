//! Actions at the start of a state.

use control_blocks::{Progress, Reaction};

use crate::controller::Controller;
use crate::detection::contact::DetectedContact;
use crate::detection::guard::ForceGuard;
use crate::detection::touch::TwoStageTouch;
use crate::interface::{ContactSource, Fault, Parameters, State};
use crate::limits::following_limit;
use crate::machine::Events;
use crate::monitoring::numbers::{LateContact, Numbers};
use crate::monitoring::rest_force::RestForce;
use crate::motion::servo::Integrator;
use crate::motion::travel::retract_between;
use crate::reading::Reading;

impl Controller {
    /// Actions at the start of `state`.
    pub(super) fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading) {
        if self.state == State::Commission && !self.identification.finished {
            self.identification.abort();
        }
        match (state, reading.position) {
            (State::Commission, _) => {
                self.identification.begin(p, self.motion.reference.position, self.observer.force());
                self.monitors.cycle = Progress::default();
                self.monitors.drive.begin();
            }
            (State::Approach, Some(position)) => self.restart(p, position),
            (State::Calibrate, _) if self.state == State::Retract => {
                if let Some(contact) = self.contact.filter(|_| !self.calibration.aborted()) {
                    self.calibration.take(p, &self.identification.measured, contact.position, reading.spindle_speed);
                    self.depart_farther(p);
                }
            }
            (State::Calibrate, _) => {
                // nothing was touched yet from which to go back
                self.motion.hold();
                self.calibration.begin(p);
            }
            (State::Learn, _) => self.guard.learn(),
            (State::Detect, _) => self.touch = TwoStageTouch::default(),
            (State::Confirm, _) => {
                let reference = self.motion.reference.position;
                self.motion.retract_by(self.touch.retract_distance(&self.motion.approach, reference));
            }
            (State::Contact, Some(position)) => {
                self.depart(p);
                let time = self.samples as f64 * p.sample_period;
                let bias = self.calibration.bias(p).at(self.motion.approach.velocity);
                let deviation = self.calibration.deviation(self.motion.approach.velocity);
                self.contact = events.contact.map(|source| DetectedContact { source, position, bias, deviation, time });
                self.numbers.late =
                    events.contact.filter(|source| *source == ContactSource::ForceGuard).map(|_| LateContact {
                        position: p.direction() * position,
                        force: self.force.notched - self.guard.before(),
                        unseen: self.unseen(p, reading),
                    });
            }
            (State::Fault, _) => {
                let just_aborted = self.calibration.abort();
                if self.state.approaching() {
                    self.depart(p);
                } else if just_aborted {
                    self.depart_farther(p);
                }
                if self.state.at_work() {
                    self.contact = None;
                }
                if let Some(fault) = events.fault {
                    self.stop(p, fault, reading);
                }
                self.calibration.end();
            }
            (State::Retract, _) if self.state.approaching() => {
                self.depart(p);
                self.aborted = true;
            }
            (State::Idle, _) if self.state == State::Fault => self.recover(reading),
            (State::Idle, _) if self.state == State::Calibrate => self.calibration.end(),
            _ => {}
        }
    }

    /// Sets the start of the retract, far enough that the next approach can arm its detector.
    pub(super) fn depart(&mut self, p: &Parameters) {
        if self.calibration.active {
            self.motion.retract_by(retract_between(p, &self.calibration.approach_after(p)));
        } else {
            self.motion.depart(p);
        }
    }

    /// A touch may change the next approach, or end the calibration cycle, which may also be aborted in a retract: the
    /// next approach may then need a longer distance to arm than planned.
    pub(super) fn depart_farther(&mut self, p: &Parameters) {
        self.motion.retract_farther(retract_between(p, &self.calibration.approach(p)));
    }

    /// Discards the last approach and starts a new one at rest at `position` m.
    fn restart(&mut self, p: &Parameters, position: f64) {
        self.motion.start(p, position, &self.calibration.approach(p));
        self.deviation.clear();
        self.detector.reset(position);
        self.guard = ForceGuard::default();
        (self.aborted, self.contact, self.waiting, self.numbers) = (false, None, true, Numbers::START);
        (self.monitors.relief, self.monitors.cycle) = (RestForce::default(), Progress::default());
    }

    /// Sets the fault and stops the motion.
    pub(super) fn stop(&mut self, p: &Parameters, fault: Fault, reading: &Reading) {
        self.fault = fault;
        self.numbers.residual_force = self.residual_force();
        self.numbers.force_constant = p.stage.force_constant;
        self.numbers.oscillations = self.monitors.oscillation.count();
        self.numbers.late_by = reading.late.unwrap_or(0);
        self.numbers.bend = if reading.lost > 0 { 0.0 } else { self.reader.recent.bend() };
        self.numbers.biases = self.calibration.extremes();
        self.numbers.tolerated = self.calibration.tolerated;
        self.numbers.following_limit = following_limit(p) + self.motion.late(p);
        self.numbers.lasted = self.lasted(p);
        self.numbers.time_limit = self.time_limit(p);
        if fault.reaction() == Reaction::DriveOff {
            self.error_at_power_off = reading.position.map_or(0.0, |z| self.motion.reference.position - z);
            self.integrator = Integrator::default();
            self.reader.forgive();
            self.motion.rest_at(reading.position.unwrap_or(self.motion.reference.position));
        }
    }

    /// After a reset: a free stage is brought to rest, and the previous response of the drive is discarded.
    fn recover(&mut self, reading: &Reading) {
        if let (Reaction::DriveOff, Some(position)) = (self.fault.reaction(), reading.position) {
            self.motion.reseat(position, self.observer.velocity());
            self.motion.hold();
        }
        self.amplifier.forget();
        self.monitors.drive.begin();
        self.fault = Fault::None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::{Approach, Input};
    use crate::motion::travel::cycle_limit;

    #[test]
    fn the_limit_that_is_detected_is_the_one_that_was_evaluated() {
        let p = Parameters::START;
        let mut controller = Controller::new(&p).unwrap();
        let expected = controller.expect(&p);
        let reading = controller.reader.read(&p, &Input::START, &expected);
        controller.calibration.begin(&p);
        controller.motion.start(&p, 0.0, &controller.calibration.approach(&p));
        controller.state = State::Detect;
        // 500 s of approach at 10 um/s, ten times as long as in a cycle at 100 um/s
        let slowest = Approach { velocity: p.calibration.velocity_min, ..p.approach };
        let limit = cycle_limit(&p, &slowest);
        let samples = (limit / p.sample_period) as u64;
        (0..samples).for_each(|_| controller.monitors.cycle.count());
        assert_eq!(controller.find_fault(&p, false, false, &reading), None);
        controller.monitors.cycle.count();
        assert_eq!(controller.find_fault(&p, false, false, &reading), Some(Fault::NoProgress));
        controller.stop(&p, Fault::NoProgress, &reading);
        let Numbers { lasted, time_limit, .. } = controller.numbers;
        assert!(limit > 630.0 && time_limit == limit, "{time_limit} s");
        assert!(lasted > limit && lasted < limit + 1.5 * p.sample_period, "{lasted} s");
        // a commissioning run has its own limit
        controller.state = State::Commission;
        controller.stop(&p, Fault::NoProgress, &reading);
        assert!((controller.numbers.time_limit - 14.6).abs() < 0.05, "{:?}", controller.numbers);
    }
}

//! Actions at the start of a state: a motion, a push, a new cycle, the return.

use control_blocks::Reaction;

use crate::controller::Controller;
use crate::interface::{Fault, Parameters, PushReport, State};
use crate::law::Launch;
use crate::limits::trial_move;
use crate::machine::Events;
use crate::monitoring::{DriveMonitor, EarlyContact, ProbeTrial};

impl Controller {
    /// Actions at the start of `state`.
    pub(super) fn enter(&mut self, p: &Parameters, state: State, events: &Events, launch: Option<Launch>) {
        if self.state == State::Commission && !self.identification.finished {
            self.identification.abort();
        }
        match state {
            // nothing moves by itself after a reset
            State::Idle if self.state == State::Fault => self.fault = Fault::None,
            State::Idle => self.leave(p),
            State::Fault => {
                self.fault = events.fault.unwrap_or(self.fault);
                self.leave(p);
            }
            State::Approach => self.restart(p),
            State::Commission => {
                self.motion.start(self.sample.slide);
                self.progress.restart();
                self.drive = DriveMonitor::default();
                // results of an approach are not those of this run
                (self.servo, self.probe_delay) = Default::default();
                self.identification.begin(p, &mut self.motion);
            }
            State::Push => {
                self.probe_delay.end(p);
                self.early_contact = EarlyContact::default();
                self.launch(p, launch);
            }
            State::Settle => {
                self.probe_delay.begin();
                self.retract(p);
            }
            State::Confirm => {
                self.trial = ProbeTrial::default();
                self.note_trial();
                self.try_probe(p, -trial_move(p));
            }
            State::Centered => {
                self.motion.release();
                self.centered = Some(self.clock.time(p));
            }
            // immediately: otherwise the slide would brake until the next period
            State::Follow => {
                self.probe_delay.begin();
                self.follower.update(p, &self.calm);
            }
            State::Collect | State::Model | State::Wait => {}
        }
    }

    /// Returns to the start of the approach, if the slide is driven.
    pub(super) fn leave(&mut self, p: &Parameters) {
        match self.fault.reaction() {
            Reaction::Retract | Reaction::Stop => self.motion.retreat(p),
            Reaction::DriveOff => self.motion.release(),
        }
    }

    /// Discards the last cycle and starts a new one.
    pub(super) fn restart(&mut self, p: &Parameters) {
        self.motion.start(self.sample.slide);
        self.law.restart(p);
        self.progress.restart();
        (self.frozen, self.drive, self.trial) = Default::default();
        (self.servo_estimator, self.servo, self.probe_delay) = Default::default();
        (self.fault, self.estimate, self.first, self.best, self.before) = (Fault::None, None, None, None, None);
        self.line = None;
        self.identification.forget_rejected();
        (self.report, self.started, self.centered) = (PushReport::START, self.clock.time(p), None);
    }

    /// Starts a push.
    fn launch(&mut self, p: &Parameters, launch: Option<Launch>) {
        let Some(launch) = launch else { return };
        if let Some(end) = launch.end {
            self.motion.go(p, end, launch.velocity);
        }
        self.before = self.estimate.map(|ring| ring.center);
        self.report.count += 1;
        self.report.distance = launch.distance;
        self.report.velocity = launch.velocity;
        self.report.lead_angle = launch.lead;
    }

    /// Retracts immediately after a push; if the probe has lost the ring, the distance is unknown and the slide stops.
    pub(super) fn retract(&mut self, p: &Parameters) {
        if self.sample.probe < p.probe.contact {
            return self.motion.release();
        }
        let back = self.motion.setpoint.position - (p.probe.at_pusher - p.null());
        self.motion.go(p, back, p.slide.velocity_max);
    }
}

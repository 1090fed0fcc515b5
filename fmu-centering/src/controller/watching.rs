//! Faults of a sample, the active fault, and the test of the probe before `Centered`.

use control_blocks::Reaction;

use crate::commission::plan;
use crate::controller::Controller;
use crate::faults::{Watched, most_severe};
use crate::interface::{Fault, Measured, Parameters, State};
use crate::limits::{cycle_time, slowest_servo, trial_move};
use crate::machine::Events;
use crate::monitoring::{Phase, plausible_ratio};
use crate::sensing::{Freedom, Reading};

/// Velocity of the slide in the test of the probe (m/s), and the time after which it is at rest there, s.
const TRIAL_VELOCITY: f64 = 0.01;
const TRIAL_REST: f64 = 0.03;

impl Controller {
    /// Whether the slide must follow its setpoint; in `Idle`, at rest, it may be moved by hand.
    pub(super) fn watched(&self, p: &Parameters) -> bool {
        self.state != State::Idle || !self.motion.resting(p)
    }

    /// Possible causes of motion until the next sample.
    pub(super) fn freedom(&self, p: &Parameters) -> Freedom {
        match self.state {
            State::Idle if !self.watched(p) => Freedom::Hand,
            State::Idle | State::Push | State::Settle | State::Fault => Freedom::Pushed,
            _ => Freedom::Held,
        }
    }

    /// The fault of the highest severity in this sample.
    pub(super) fn find_fault(&mut self, p: &Parameters, reading: &Reading, rotation: f64) -> Option<Fault> {
        let frozen =
            reading.fresh && self.frozen.update(p, self.phase(), &self.sample, rotation) && self.state.active();
        let pushing = self.state == State::Push;
        if pushing {
            self.early_contact.update(self.calm.probe);
        }
        let hit = pushing && self.early_contact.met(p).is_some();
        let diverged = pushing && self.law.diverged(p);
        // a ring that was found moves away by at most the stroke of the probe
        let slack = if self.state == State::Approach { 0.0 } else { p.probe.stroke };
        let travel = p.approach.travel_max + slack;
        let view = Watched {
            state: self.state,
            probe: self.calm.probe,
            // during the ramp of the table no state can end
            rotation: if self.table.steady(p) { rotation } else { 0.0 },
            speed: self.spindle.speed(),
            surface: self.follower.surface(),
            beyond_travel: self.motion.beyond(p, travel),
            estimate: self.estimate.as_ref(),
        };
        let centering = self.state.active() && self.state != State::Centered;
        let commission = self.state == State::Commission;
        if centering || commission {
            self.progress.count();
        }
        let longest = if commission { plan::time(p) } else { cycle_time(p, view.speed) };
        let late = (centering || commission) && self.progress.samples() > u64::from(p.ticks(longest));
        // strokes require a free probe
        let rejected = commission && (self.identification.rejected || self.calm.probe > p.probe.contact);
        let found = [
            (self.long_step && (self.state.active() || commission)).then_some(Fault::LongStep),
            reading.fault,
            (frozen || diverged).then_some(if hit { Fault::EarlyContact } else { Fault::ProbeFrozen }),
            self.drive.fault(p),
            self.supervisor.check(p, &view),
            (self.state.active() && self.table.disobeys(p)).then_some(Fault::SpindleSpeed),
            late.then_some(Fault::NoProgress),
            rejected.then_some(Fault::CommissionRejected),
        ];
        most_severe(&found)
    }

    /// Relative motion of slide and ring.
    fn phase(&self) -> Phase {
        match self.state {
            State::Push => Phase::Push,
            State::Settle if self.motion.moving() => Phase::Retract,
            _ => Phase::Follow,
        }
    }

    /// A later fault may require a reaction of higher severity.
    pub(super) fn escalate(&mut self, p: &Parameters, fault: Option<Fault>) {
        if let Some(fault) = fault.filter(|fault| fault.reaction() > self.fault.reaction())
            && self.state == State::Fault
        {
            self.fault = fault;
            self.leave(p);
        }
    }

    /// Whether the drive of the slide may be on.
    pub(super) fn driven(&self) -> bool {
        self.state != State::Fault || self.fault.reaction() != Reaction::DriveOff
    }

    /// Uses the servo as identified during the approach, and checks whether the control law can work with it.
    pub(super) fn check_servo(&mut self, p: &Parameters, events: &mut Events) {
        if self.state != State::Follow || !events.settled {
            return;
        }
        self.servo = self.servo_estimator.servo(p.sample_period);
        if p.learns_servo() && self.servo.is_some_and(|servo| servo.is_certain() && servo.bandwidth < slowest_servo(p))
        {
            events.fault = Some(Fault::SlowServo);
        }
    }

    /// Bandwidth of the servo with which strokes are planned, rad/s: as identified during the approach, if that is
    /// certain and no result of a commissioning run is active; otherwise that of the active parameters.
    pub(super) fn bandwidth(&self, p: &Parameters) -> f64 {
        let commissioned = p.commission.apply && self.commissioned();
        let found = self.servo.filter(|servo| servo.is_certain() && p.learns_servo() && !commissioned);
        found.map_or(p.slide.bandwidth, |servo| servo.bandwidth)
    }

    /// Measured values of the machine: of a commissioning run, or without a good one of the approach.
    pub(super) fn measured(&self) -> Measured {
        match self.servo.filter(|_| !self.commissioned()) {
            Some(servo) => Measured {
                valid: servo.is_certain(),
                slide_bandwidth: servo.bandwidth,
                slide_bandwidth_std: servo.deviation,
                ..Measured::START
            },
            None => self.identification.measured,
        }
    }

    /// Moves the slide out and in, and evaluates the response of the probe.
    pub(super) fn confirm(&mut self, p: &Parameters, events: &mut Events) {
        if self.state != State::Confirm || !self.motion.arrived(p, TRIAL_REST) {
            return;
        }
        self.note_trial();
        match self.trial.ratio() {
            None => self.try_probe(p, trial_move(p)),
            Some(ratio) if plausible_ratio(ratio) => events.confirmed = true,
            Some(_) => events.fault = Some(Fault::ProbeFrozen),
        }
    }

    /// A position of that test, minus the motion of the ring towards the probe.
    pub(super) fn note_trial(&mut self) {
        let rotation = self.estimate.map_or(0.0, |ring| ring.center.along(self.spindle.angle()));
        self.trial.note(self.sample.slide, self.calm.probe - rotation);
    }

    /// One move of that test, m.
    pub(super) fn try_probe(&mut self, p: &Parameters, distance: f64) {
        self.motion.go(p, self.motion.setpoint.position + distance, TRIAL_VELOCITY.min(p.approach.velocity));
    }
}

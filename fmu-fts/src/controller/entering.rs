//! Actions on entry to a state: the loop closes, the arm moves onto the path or off it, measurements start or stop.

use control_blocks::Trajectory;

use crate::controller::Controller;
use crate::interface::{Fault, Parameters, State};
use crate::machine::Events;
use crate::monitoring::feed::FeedWatch;
use crate::monitoring::watch::Watch;
use crate::motion::hold::{HoldMotion, duration};
use crate::reading::Reading;
use crate::servo::lead_lag::Recursion;

impl Controller {
    /// Enters `state` and performs its entry actions: closes the loop, starts or stops motions and measurements.
    pub(super) fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading) {
        let closed = self.closed();
        let fault = events.fault.filter(|_| state == State::Fault).unwrap_or(Fault::None);
        self.ending.begin(p, fault, closed && state == State::Fault, self.last_motion(p));
        if self.state == State::Commission && !self.commissioning.finished {
            self.commissioning.abort();
        }
        if !closed || state == State::Commission {
            self.begin(p, reading.arm_angle);
        }
        match state {
            State::Idle => self.tracker.forget(),
            State::Hold | State::Calibrate => self.leave(p, reading.hold_angle),
            State::Identify => {
                self.leave(p, reading.hold_angle);
                if !self.identification.oscillating() {
                    self.identification.restart();
                }
            }
            State::Commission => {
                self.commissioning.begin();
                self.request.spend();
                self.cycle.restart();
                self.slow = true;
            }
            State::Retract if self.tracker.gone(p) => {
                self.stop_oscillation();
                self.hold.stop(p);
            }
            State::Fault | State::Done | State::Retract => {
                let out = self.out_of_the_part(p);
                self.leave(p, out);
            }
            State::Approach => {
                self.identification.stop();
                self.correct(p);
                self.tracker.approach(p);
                self.feed = FeedWatch::default();
            }
            State::Ready | State::Track if self.state == State::Approach => self.joined = reading.slide_position,
            State::Ready | State::Track => (),
        }
        if state == State::Fault && !self.ending.retracting() {
            self.tracker.forget();
        }
        if state == State::Track {
            self.calibration.cut_lens(self.tracker.path());
        }
        self.state = state;
    }

    /// Another path begins: the form of the lens that was probed counts, unless something of the path before is in the
    /// motion.
    fn correct(&mut self, p: &Parameters) {
        if p.form.apply && self.tracker.gone(p) {
            self.tracker.correct(self.calibration.correction());
        }
    }

    /// Closes the loop where the arm is; one that moves is stopped first.
    fn begin(&mut self, p: &Parameters, arm_angle: f64) {
        self.motion = Trajectory { velocity: self.reader.arm_velocity(p), ..Trajectory::resting(arm_angle) };
        self.hold = HoldMotion::stopping(p, self.motion);
        (self.recursion, self.watch) = (Recursion::default(), Watch::default());
        self.tracker.rest();
        self.identification.restart();
    }

    /// Off the path and out of an oscillation, to rest at `goal` (rad).
    fn leave(&mut self, p: &Parameters, goal: f64) {
        self.stop_oscillation();
        if self.tracker.arrived(p) {
            // nothing of what was held before is in the motion
            self.hold = HoldMotion::at(goal);
            self.tracker.leave(p, duration(p, self.motion.position, goal));
            return;
        }
        if !self.hold.stops(p) {
            self.hold.redirect(p, goal);
        }
        if !self.tracker.gone(p) {
            self.tracker.leave(p, duration(p, self.motion.position, goal));
        }
    }

    /// Angle (rad) at which the tool is `limits.retract` out of the part; where the other end of the arm is, as it is.
    fn out_of_the_part(&self, p: &Parameters) -> f64 {
        let angle = self.motion.position;
        if self.arm.lever(angle) <= 0.0 {
            return angle;
        }
        let depth = self.arm.depth(angle);
        let minimum = if self.tracker.gone(p) { depth } else { depth.min(self.tracker.lowest()) };
        self.arm.angle(minimum - p.limits.retract)
    }
}

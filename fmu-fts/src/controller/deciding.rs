//! Decides the next state from the requested mode, the events and the fault of a sample.

use crate::controller::Controller;
use crate::faults::{self, Situation};
use crate::interface::{Input, Mode, Parameters, State};
use crate::machine::{Events, next};
use crate::monitoring::cycle::late;
use crate::path::feasibility::infeasible;
use crate::reading::Reading;

impl Controller {
    /// The requested mode; `Idle` while the arm is held for a commissioning run.
    fn requested(&mut self, input: &Input) -> Mode {
        let mode = self.request.read(input);
        if !self.slow {
            return mode;
        }
        self.request.spend();
        Mode::Idle
    }

    /// Whether `commission` and `enable` rise.
    fn edges(&mut self, input: &Input) -> [bool; 2] {
        let now = [input.commission, input.enable];
        let before = self.before.replace(now).unwrap_or(now);
        [0, 1].map(|i| now[i] && !before[i])
    }

    /// State machine.
    pub(super) fn decide(&mut self, p: &Parameters, input: &Input, reading: &Reading) {
        let mode = self.requested(input);
        if self.request.renewed() {
            self.cycle.restart();
        }
        let [commission, enable] = self.edges(input);
        let requested = self.commission_request.update(self.state.waits(), commission, input.commission);
        // the message of a fault shows the last value
        if self.state != State::Fault {
            self.late = late(p, self.tracker.path(), self.measurements(), self.state, &self.cycle);
        }
        let events = Events {
            fault: faults::find(p, &self.situation(p, mode, reading)),
            reset: self.reset_fault.rises(input.reset_fault),
            at_rest: !self.ending.braking() && (!self.closed() || self.stopped(p)),
            renewed: self.request.renewed(),
            commission: requested && self.reader.arm_velocity(p) == 0.0,
            abort: !input.commission || enable || self.request.renewed(),
            commissioned: self.commissioning.finished,
            arm_known: self.reader.arm_known(),
            spindle_known: self.spindle_known(p),
            cut_over: self.left(reading) && self.tracker.path().cut_over(self.joined, reading.slide_position),
            arrived: self.tracker.arrived(p),
        };
        let state = next(self.state, mode, &events);
        if state != self.state {
            if self.state == State::Fault {
                self.request.spend();
            }
            self.enter(p, state, &events, reading);
        } else if self.state == State::Fault {
            self.ending.escalate(p, events.fault, self.last_motion(p));
            if !input.enable && self.stopped(p) {
                self.ending.release();
            }
        }
        if !self.closed() {
            self.reader.restart_arm();
            self.slow = false;
        }
        if !self.closed() || self.tracker.gone(p) {
            self.reader.restart();
        }
    }

    /// Findings of the monitors and of the state of the controller, from which the fault of this sample is selected.
    fn situation(&self, p: &Parameters, mode: Mode, reading: &Reading) -> Situation<'_> {
        let path = self.tracker.path();
        let requested =
            matches!(mode, Mode::Approach | Mode::Track) && !matches!(self.state, State::Fault | State::Done);
        Situation {
            missing: self.reader.missing(),
            long_step: self.long_step,
            found: if self.closed() { self.watch.find(p, self.arm.length) } else { None },
            feed_lost: self.on_path() && self.feed.lost().is_some(),
            overdue: self.state != State::Fault && self.late.is_some(),
            rejected: self.state == State::Commission && self.commissioning.rejected,
            path: requested.then_some(path),
            outside: self.left(reading) && !(self.on_path() && path.cut_over(self.joined, reading.slide_position)),
            spindle_speed: if self.reader.spindle_begins() { 0.0 } else { self.spindle.speed },
        }
    }

    /// Whether a path can start: a speed above its limit may come from a bad sample, and waits for the next one.
    fn spindle_known(&self, p: &Parameters) -> bool {
        let doubtful = self.reader.spindle_begins() && infeasible(p, self.tracker.path(), self.spindle.speed);
        self.spindle.known() && self.reader.spindle_known() && !doubtful
    }

    /// Whether the slide is seen where the path has no table.
    fn left(&self, reading: &Reading) -> bool {
        self.reader.spindle_known() && !self.tracker.path().covers(reading.slide_position)
    }
}

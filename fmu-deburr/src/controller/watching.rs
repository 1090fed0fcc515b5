//! Runs the monitors in each sample and keeps the active fault, which only one of higher severity replaces.

use control_blocks::Reaction;

use crate::controller::Controller;
use crate::faults::{self, Signs};
use crate::interface::{Fault, Input, Mode, Parameters, State};
use crate::monitoring::axis::{Expectation, Outcome};
use crate::monitoring::finding::Finding;
use crate::path::kinematics::Joints;
use crate::reading::Reading;

/// Ratios to the speed without load: the tool runs above the first, and is stopped below the second.
const TOOL: (f64, f64) = (0.5, 0.02);

impl Controller {
    /// Looks at the axes while their loops are closed: what is wrong, and whether a pattern grows.
    pub(super) fn watch_axes(&mut self, p: &Parameters, reading: &Reading, motions: &Joints) -> (Finding, bool) {
        if !self.closed() {
            return (Finding::NONE, false);
        }
        if self.state == State::Run {
            self.delay.update(p, &reading.positions, &self.sent);
            if self.run.rests(p) {
                self.watch.rests(p, &reading.positions);
            }
        }
        if self.state.waits() {
            self.watch.forget_slips();
        }
        let (runs, compensates) = (self.state == State::Run, self.compensates(p, self.task));
        let expected = match self.task {
            // the error that has ended a repetition fades while it stops
            Mode::Learn if runs && self.learner.repetition > 0 || self.state == State::Stop => Expectation::Learned,
            _ if runs && compensates => Expectation::Compensated,
            _ => Expectation::Bare,
        };
        match self.watch.look(p, &reading.positions, motions, &self.error, expected) {
            Outcome::Good => (Finding::NONE, false),
            Outcome::Grown => (Finding::NONE, runs),
            Outcome::Wrong(finding) => (self.cause(p, finding), false),
        }
    }

    /// Looks at how the measurements flicker in rests and while a task continues; `held` is one that waits along its path.
    fn watch_flicker(&mut self, p: &Parameters, reading: &Reading, held: bool) -> Finding {
        let goes_on = matches!(self.state, State::Approach | State::Settle | State::Run) && !held;
        let (rests, on_path) = (goes_on || self.state.waits(), self.state == State::Run);
        let tool = reading.spindle_speed / p.load.idle_speed;
        let (runs, stopped) = (tool > TOOL.0, tool.abs() < TOOL.1);
        let resting = if !(runs || stopped) {
            // what it shakes while it runs up or down is no noise
            self.watch.forget_rests();
            Finding::NONE
        } else if rests {
            self.watch.look_at_rests(p, &reading.positions, runs, on_path)
        } else {
            self.watch.pause_rests();
            Finding::NONE
        };
        if !goes_on {
            self.watch.pause();
            return resting;
        }
        let found = self.watch.look_at_flicker(p, &reading.positions, !(self.cuts() && self.tool.loaded()));
        if found.is_fault() { found } else { resting }
    }

    /// Patterns do not match where the response has another delay than configured; a fault of higher severity than a wrong
    /// delay remains.
    fn cause(&self, p: &Parameters, finding: Finding) -> Finding {
        let late = self.delay.found(p);
        if finding.fault == Fault::PatternMismatch && late.is_fault() { late } else { finding }
    }

    /// Keeps the best pattern of a speed at which the error grows.
    pub(super) fn abandon_repetition(&mut self, p: &Parameters) -> bool {
        let speed = self.learner.speed;
        let next = self.learner.abandon(p, self.bank.pattern_mut(speed));
        self.end_speed(speed, next);
        true
    }

    /// Looks at the tool while it cuts, and before at how its measurement flickers.
    fn watch_tool(&mut self, p: &Parameters, reading: &Reading) -> Finding {
        let speed = reading.spindle_speed;
        if !self.cuts() {
            self.frozen_spindle.idles(speed);
            return Finding::NONE;
        }
        let reads = self.frozen_spindle.cuts(p, speed);
        let cuts = self.tool.update(p, speed, self.run.point().speed * p.sample_period);
        if reads.is_fault() { reads } else { cuts }
    }

    pub(super) fn find_fault(
        &mut self,
        p: &Parameters,
        reading: &Reading,
        inputs: Finding,
        axes: Finding,
        input: &Input,
    ) -> Finding {
        let long_step = std::mem::take(&mut self.long_step);
        let starts = input.enable && self.state.waits() && input.mode != self.task;
        let empty = self.compensates(p, input.mode) && self.bank.patterns().is_empty();
        let flicker = self.watch_flicker(p, reading, input.hold || reading.speed_override == 0.0);
        let axes = if axes.is_fault() { axes } else { flicker };
        let tool = self.watch_tool(p, reading);
        let commissions = self.state == State::Commission;
        let registers = self.state == State::Register;
        let works = commissions || registers || self.task.moves() && !self.state.waits() && self.state.closed();
        faults::find(
            p,
            &Signs {
                inputs: if long_step { Finding::plain(Fault::LongStep) } else { inputs },
                axes,
                run: std::mem::replace(&mut self.ended, Finding::NONE),
                nothing_learned: starts && empty,
                commission: if commissions { self.commissioning_run.rejected } else { None },
                registration: if registers { self.registrar.wrong } else { Finding::NONE },
                tool,
                task: if works { (self.elapsed.samples(), self.budget) } else { (0, 0) },
            },
        )
    }

    /// Makes `found` the active fault if `counts` is true and none of the same or a higher severity is active. Returns
    /// the reaction to the active fault; none without one.
    pub(super) fn escalate(&mut self, found: Finding, counts: bool) -> Option<Reaction> {
        let more_severe = self.fault == Fault::None || found.fault.reaction() > self.fault.reaction();
        if counts && found.is_fault() && more_severe {
            (self.fault, self.numbers) = (found.fault, found.numbers);
        }
        (self.fault != Fault::None).then(|| self.fault.reaction())
    }
}

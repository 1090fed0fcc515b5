//! Moves the reference on: to the start of the path, along it, and what it learns there.

use control_blocks::ticks;

use crate::controller::Controller;
use crate::interface::{Fault, Input, Mode, Parameters, State};
use crate::learning::learner::Next;
use crate::machine::Progress;
use crate::monitoring::delay::DelayMonitor;
use crate::monitoring::finding::Finding;
use crate::path::kinematics::{AXES, Joints};
use crate::reading::Reading;

impl Controller {
    /// Moves the reference on and finds its compensation.
    pub(super) fn advance(&mut self, p: &Parameters, reading: &Reading, input: &Input) {
        let hold = input.hold;
        self.compensation = [0.0; AXES];
        let waits = hold || self.task != Mode::Learn && reading.speed_override == 0.0;
        let measures = matches!(self.state, State::Commission | State::Register);
        if measures || !waits && self.task.moves() && !self.state.waits() {
            self.elapsed.count();
        }
        match self.state {
            State::Approach => self.follow_route(p, hold),
            State::Retract => {
                self.follow_route(p, false);
                self.inside = self.progress == Progress::Busy;
            }
            State::Settle => {
                let near = (0..AXES).all(|i| self.error[i].abs() * p.axis[i].pulse <= p.limits.axis[i].error_max);
                let rested = self.rested.update(near);
                self.finish_if(rested >= ticks(p.transfer.settle_time, p.sample_period));
            }
            State::Commission => self.follow_commission(p),
            State::Register => self.follow_registration(p),
            State::Stop if self.commissioning && self.route.over() => {
                let stopped = self.commissioning_run.experiment.stop(&mut self.joints, p.sample_period);
                self.finish_if(stopped);
            }
            State::Stop if self.registering && self.route.over() => {
                let stopped = self.stop_registration(p);
                self.finish_if(stopped);
            }
            State::Stop if !self.on_path => {
                self.follow_route(p, true);
                self.finish_if(self.route.stopped() || self.route.over());
            }
            State::Stop => {
                self.follow(p, 0.0);
                self.finish_if(self.run.stopped());
            }
            State::Run => {
                let target = self.target(p, reading);
                self.follow(p, if hold { 0.0 } else { target });
            }
            State::Off | State::Idle | State::Done | State::Fault => {}
        }
    }

    pub(super) fn follow_route(&mut self, p: &Parameters, hold: bool) {
        self.joints = self.route.step(p.sample_period, hold);
        self.inside = self.route.inside();
        self.finish_if(self.route.over());
    }

    /// Desired speed on the path, m/s.
    fn target(&mut self, p: &Parameters, reading: &Reading) -> f64 {
        let programmed = self.path.speed * reading.speed_override;
        match self.task {
            Mode::Learn => self.bank.factor(self.learner.speed) * self.path.speed,
            Mode::Deburr if p.load.enable => self.load.step(p, reading.spindle_speed, self.run.speed(), programmed),
            _ => programmed,
        }
    }

    /// One sample on the path.
    fn follow(&mut self, p: &Parameters, target: f64) {
        let laps = self.run.laps;
        let goes_on = self.run.step(p, &self.path, target);
        let (runs, lap) = (self.state == State::Run, self.run.laps > laps);
        let repetition_over = if self.path.cyclic { laps > 0 && lap } else { !goes_on };
        if lap && self.task != Mode::Learn {
            self.elapsed.restart();
        }
        if runs && (lap || !goes_on) {
            self.ended = self.after_run(p);
            self.delay = DelayMonitor::new(p);
            self.tool.restart();
        }
        if self.task == Mode::Learn && runs && repetition_over && !self.ended.is_fault() {
            self.end_repetition(p);
        } else {
            self.finish_if(!goes_on);
        }
        if self.progress == Progress::Busy {
            let pose = self.path.at(self.run.point().distance);
            self.joints = p.arm.inverse(&pose, &self.joints).unwrap_or(self.joints);
            self.compensation = self.compensate(p).map(f64::round);
        }
    }

    /// First fault at the end of a run or lap: rest error or frozen position, wrong delay, or a path without a cut in
    /// `Deburr`; otherwise none.
    fn after_run(&self, p: &Parameters) -> Finding {
        let tool = if self.task == Mode::Deburr { self.tool.after_run(p) } else { Finding::NONE };
        let found = [self.watch.after_run(p), self.delay.found(p), tool];
        found.into_iter().find(Finding::is_fault).unwrap_or(Finding::NONE)
    }

    /// Ends a repetition.
    fn end_repetition(&mut self, p: &Parameters) {
        let speed = self.learner.speed;
        let next = match self.learner.identifies(p) {
            true => self.identify(p),
            false => self.learner.finish(p, self.bank.pattern_mut(speed)),
        };
        if next == Next::TooLarge {
            self.ended = Finding::plain(Fault::PatternTooLarge);
        }
        self.end_speed(speed, next);
        self.progress = match next {
            Next::Repeat if self.path.cyclic => Progress::Busy,
            Next::Done => Progress::Over,
            Next::Repeat | Next::NextSpeed | Next::TooLarge => Progress::Again,
        };
    }

    /// Identifies the drives from the run of the bare servo, and fills all patterns with what they need.
    fn identify(&mut self, p: &Parameters) -> Next {
        let Self { feedforward, bank, path, start, learner, .. } = self;
        let pattern = bank.pattern(0);
        feedforward.identify(p, path, start, pattern, learner.record_of(pattern));
        let next = learner.finish_bare(p, pattern);
        bank.fill(|pattern| feedforward.fill(p, path, start, pattern));
        if bank.largest() > p.limits.pulses_max {
            bank.limit(0);
            return Next::TooLarge;
        }
        if next == Next::Repeat {
            self.kept.renew(&mut self.bank);
        }
        next
    }

    /// Takes the pattern of a speed over when it is learned.
    pub(super) fn end_speed(&mut self, speed: usize, next: Next) {
        if matches!(next, Next::NextSpeed | Next::Done) {
            self.bank.learned(speed);
            self.changed = true;
        }
        if next == Next::Done {
            (self.learning, self.learned, self.export) = (false, true, true);
        }
    }

    /// Compensation of this sample on the path, pulses, not rounded.
    fn compensate(&self, p: &Parameters) -> Joints {
        match self.task {
            Mode::Learn => {
                let pattern = self.bank.pattern(self.learner.speed);
                match self.run.index(pattern) {
                    Some(index) if self.state == State::Run => pattern.compensation(index as isize),
                    _ => self.run.compensation(p, &self.path, std::slice::from_ref(pattern)),
                }
            }
            task if self.compensates(p, task) => self.run.compensation(p, &self.path, self.bank.patterns()),
            _ => [0.0; AXES],
        }
    }
}

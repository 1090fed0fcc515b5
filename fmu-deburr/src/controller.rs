//! One sample of the whole law: read, decide, refer, compensate, command, report.

mod report;

use control_blocks::{Edge, ParameterError};
use serde::{Deserialize, Serialize};

use crate::bank::Bank;
use crate::check::check;
use crate::feasible;
use crate::kinematics::{AXES, Joints};
use crate::learning::{Learner, Next};
use crate::load::LoadControl;
use crate::machine::{Asked, Fault, Mode, Progress, State, next};
use crate::parameters::Parameters;
use crate::path::Path;
use crate::pattern::Pattern;
use crate::reading::{Reader, Reading};
use crate::run::Run;
use crate::servo;
use crate::signals::{Input, Output};
use crate::transfer::Transfer;

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    path: Path,
    /// axes at the start of the path
    start: Joints,
    bank: Bank,
    learner: Learner,
    learned: bool,
    load: LoadControl,
    reader: Reader,
    reset: Edge,
    state: State,
    fault: Fault,
    /// what is being done
    job: Mode,
    progress: Progress,
    transfer: Transfer,
    run: Run,
    /// the run, not the transfer, was the last motion
    on_path: bool,
    rested: u32,
    /// reference, rad or m
    joints: Joints,
    /// control error and compensation of the last sample, pulses
    error: Joints,
    compensation: Joints,
    too_large: bool,
    /// the bank is to be written
    export: bool,
}

impl Controller {
    /// Controller before its first sample; `file` is the name of the path for messages.
    ///
    /// # Errors
    /// When a parameter does not fit the others, or the robot cannot follow the path.
    pub fn new(p: &Parameters, path: Path, file: &str) -> Result<Self, ParameterError> {
        check(p, &path)?;
        let start = feasible::start(p, &path, file)?;
        let bank = Bank::plan(p, &path)?;
        let learner = Learner::new(p, bank.longest());
        let (load, run) = (LoadControl::new(path.speed), Run::new(p, &path));
        Ok(Self {
            path,
            start,
            bank,
            learner,
            learned: false,
            load,
            reader: Reader::START,
            reset: Edge::default(),
            state: State::Off,
            fault: Fault::None,
            job: Mode::Idle,
            progress: Progress::Busy,
            transfer: Transfer::at(&[0.0; AXES]),
            run,
            on_path: false,
            rested: 0,
            joints: [0.0; AXES],
            error: [0.0; AXES],
            compensation: [0.0; AXES],
            too_large: false,
            export: false,
        })
    }

    /// The taught path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The control patterns.
    pub fn bank(&self) -> &Bank {
        &self.bank
    }

    /// The control patterns, to be read from a file.
    pub fn bank_mut(&mut self) -> &mut Bank {
        &mut self.bank
    }

    /// Whether the bank is to be written now; asked for once.
    pub fn take_export(&mut self) -> bool {
        std::mem::take(&mut self.export)
    }

    /// One sample: reads the inputs, writes the outputs.
    pub fn tick(&mut self, p: &Parameters, input: &Input, output: &mut Output) {
        let (reading, valid) = self.reader.read(input);
        let asked = Asked {
            enable: input.enable,
            mode: input.mode,
            hold: input.hold,
            reset: self.reset.rises(input.reset_fault),
        };
        let fault = self.find_fault(p, &reading, valid, input.mode);
        let before = self.state;
        self.state = next(before, self.job, &asked, self.progress, fault != Fault::None);
        let resting = matches!(before, State::Idle | State::Done);
        let begins = resting && matches!(self.state, State::Approach | State::Done) && input.mode != self.job;
        if begins {
            self.begin(p, input.mode);
        }
        if self.state != before || begins {
            self.enter(p, &reading, before, input.mode, fault);
        }
        if self.state == State::Idle && input.mode == Mode::Idle {
            self.job = Mode::Idle;
        }
        self.advance(p, &reading, input.hold);
        let velocity = self.act(p, &reading);
        self.report(p, &velocity, output);
    }

    fn find_fault(&mut self, p: &Parameters, reading: &Reading, valid: bool, mode: Mode) -> Fault {
        let starts = matches!(self.state, State::Idle | State::Done) && mode != self.job;
        let compensates = matches!(mode, Mode::Playback | Mode::Deburr) && p.lookup.enable;
        let cuts = self.state == State::Run && self.job == Mode::Deburr;
        if !valid {
            Fault::InvalidInput
        } else if self.state.closed() && servo::strayed(p, &self.error).is_some() {
            Fault::ControlError
        } else if std::mem::take(&mut self.too_large) {
            Fault::PatternTooLarge
        } else if starts && compensates && self.bank.patterns().is_empty() {
            Fault::BankEmpty
        } else if cuts && reading.spindle_speed < p.spindle.speed_min {
            Fault::SpindleSlow
        } else {
            Fault::None
        }
    }

    fn enter(&mut self, p: &Parameters, reading: &Reading, before: State, mode: Mode, fault: Fault) {
        self.fault = fault;
        self.progress = Progress::Busy;
        match self.state {
            State::Idle if !before.closed() => self.joints = reading.positions,
            State::Approach => {
                self.transfer = Transfer::new(p, &self.joints, &self.start);
                self.on_path = false;
            }
            State::Settle => self.rested = 0,
            State::Run => {
                self.run = Run::new(p, &self.path);
                self.load = LoadControl::new(self.path.speed);
                self.learner.restart();
                self.on_path = true;
            }
            _ => {}
        }
        match self.state {
            // afterwards nothing moves before another mode is asked for
            State::Off | State::Fault => self.job = mode,
            State::Idle if before.closed() => self.job = Mode::Idle,
            _ => {}
        }
        if !before.closed() {
            self.error = [0.0; AXES];
        }
    }

    /// A new job.
    fn begin(&mut self, p: &Parameters, mode: Mode) {
        self.job = mode;
        self.export |= mode == Mode::Export;
        if mode == Mode::Learn {
            self.learned = false;
            self.learner.start();
            if !p.learn.from_bank {
                self.bank.clear();
            }
        }
    }

    /// Moves the reference on and finds its compensation.
    fn advance(&mut self, p: &Parameters, reading: &Reading, hold: bool) {
        self.compensation = [0.0; AXES];
        match self.state {
            State::Approach => {
                self.joints = self.transfer.step(p.sample_period, hold);
                self.finish_if(self.transfer.over());
            }
            State::Settle => {
                self.rested = self.rested.saturating_add(1);
                self.finish_if(self.rested >= p.ticks(p.transfer.settle_time));
            }
            State::Stop if !self.on_path => {
                self.joints = self.transfer.step(p.sample_period, true);
                self.finish_if(self.transfer.over() || self.transfer.stands());
            }
            State::Stop => {
                self.follow(p, 0.0);
                self.finish_if(self.run.stands());
            }
            State::Run => {
                let target = self.target(p, reading);
                self.follow(p, if hold { 0.0 } else { target });
            }
            State::Off | State::Idle | State::Done | State::Fault => {}
        }
    }

    fn finish_if(&mut self, over: bool) {
        self.progress = if over { Progress::Over } else { Progress::Busy };
    }

    /// Wanted speed on the path, m/s.
    fn target(&mut self, p: &Parameters, reading: &Reading) -> f64 {
        let taught = self.path.speed * reading.share;
        match self.job {
            Mode::Learn => self.bank.factor(self.learner.speed) * self.path.speed,
            Mode::Deburr if p.load.enable => self.load.step(p, reading.spindle_speed, self.run.speed(), taught),
            _ => taught,
        }
    }

    /// One sample on the path.
    fn follow(&mut self, p: &Parameters, target: f64) {
        let laps = self.run.laps;
        let goes_on = self.run.step(p, &self.path, target);
        let repetition_over = if self.path.cyclic { laps > 0 && self.run.laps > laps } else { !goes_on };
        if self.job == Mode::Learn && self.state == State::Run && repetition_over {
            self.renew(p);
        } else {
            self.finish_if(!goes_on);
        }
        if self.progress == Progress::Busy {
            let pose = self.path.at(self.run.point().distance);
            self.joints = p.arm.inverse(&pose, &self.joints).unwrap_or(self.joints);
            self.compensation = self.compensate(p).map(f64::round);
        }
    }

    /// Ends a repetition.
    fn renew(&mut self, p: &Parameters) {
        let speed = self.learner.speed;
        let next = self.learner.finish(p, self.bank.pattern_mut(speed));
        self.too_large |= next == Next::TooLarge;
        if matches!(next, Next::NextSpeed | Next::Done) {
            self.bank.learned(speed);
        }
        self.progress = match next {
            Next::Repeat if self.path.cyclic => Progress::Busy,
            Next::Done => Progress::Over,
            Next::Repeat | Next::NextSpeed | Next::TooLarge => Progress::Again,
        };
        if next == Next::Done {
            (self.learned, self.export) = (true, true);
        }
    }

    /// Compensation of this sample on the path, pulses, not rounded.
    fn compensate(&self, p: &Parameters) -> Joints {
        match self.job {
            Mode::Learn => {
                let pattern = self.bank.pattern(self.learner.speed);
                match self.run.index(pattern) {
                    Some(index) if self.state == State::Run => pattern.compensation(index as isize),
                    _ => self.run.compensation(p, &self.path, std::slice::from_ref(pattern)),
                }
            }
            Mode::Playback | Mode::Deburr if p.lookup.enable => {
                self.run.compensation(p, &self.path, self.bank.patterns())
            }
            _ => [0.0; AXES],
        }
    }

    /// Velocity commands, rad/s or m/s.
    fn act(&mut self, p: &Parameters, reading: &Reading) -> Joints {
        if !self.state.closed() {
            return [0.0; AXES];
        }
        let (reference, encoder) = (servo::pulses(p, &self.joints), servo::pulses(p, &reading.positions));
        self.error = std::array::from_fn(|i| reference[i] - encoder[i]);
        let learns = self.job == Mode::Learn && self.state == State::Run && self.progress == Progress::Busy;
        if learns && (!self.path.cyclic || self.run.laps > 0) {
            let pattern: &Pattern = self.bank.pattern(self.learner.speed);
            if let Some(index) = self.run.index(pattern) {
                self.learner.record(index, &self.error, &p.pulses(), &p.arm.levers(&self.joints));
            }
        }
        servo::command(p, &self.error, &self.compensation)
    }
}

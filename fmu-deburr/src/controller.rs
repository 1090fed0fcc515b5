//! One sample of the whole law: read, decide, refer, compensate, command, report.

use control_blocks::{Edge, ParameterError, ticks};
use serde::{Deserialize, Serialize};

use crate::bank::pattern_bank::PatternBank;
use crate::check::check;
use crate::faults::{self, Signs};
use crate::interface::{AxisOutput, BankStatus, Fault, Input, Mode, Output, Parameters, State};
use crate::learning::learner::{Learner, Next};
use crate::load::LoadControl;
use crate::machine::{Events, Progress, next};
use crate::path::feasible;
use crate::path::kinematics::{AXES, Joints};
use crate::path::taught_path::TaughtPath;
use crate::path::transfer::TransferMotion;
use crate::reading::{Reader, Reading};
use crate::run::Run;
use crate::servo;

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    path: TaughtPath,
    /// axes at the start of the path
    start: Joints,
    bank: PatternBank,
    learner: Learner,
    learned: bool,
    load: LoadControl,
    reader: Reader,
    reset: Edge,
    /// `enable` was false during the present stop
    disabled: bool,
    state: State,
    fault: Fault,
    /// what is being done
    job: Mode,
    progress: Progress,
    transfer: TransferMotion,
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
    /// the bank is not that of a file any more
    changed: bool,
}

impl Controller {
    /// Controller before its first sample, on a path that was read.
    ///
    /// # Errors
    /// When a parameter does not fit the others, or the robot cannot follow the path.
    pub fn new(p: &Parameters, path: TaughtPath) -> Result<Self, ParameterError> {
        check(p, &path)?;
        let start = feasible::start(p, &path)?;
        let bank = PatternBank::plan(p, &path)?;
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
            disabled: false,
            state: State::Off,
            fault: Fault::None,
            job: Mode::Idle,
            progress: Progress::Busy,
            transfer: TransferMotion::at(&[0.0; AXES]),
            run,
            on_path: false,
            rested: 0,
            joints: [0.0; AXES],
            error: [0.0; AXES],
            compensation: [0.0; AXES],
            too_large: false,
            export: false,
            changed: false,
        })
    }

    /// The taught path.
    pub fn path(&self) -> &TaughtPath {
        &self.path
    }

    /// The control patterns.
    pub fn bank(&self) -> &PatternBank {
        &self.bank
    }

    /// The taught path, and the control patterns to be read from a file.
    pub fn path_and_bank(&mut self) -> (&TaughtPath, &mut PatternBank) {
        (&self.path, &mut self.bank)
    }

    /// Whether the bank is to be written now; asked for once.
    pub fn take_export(&mut self) -> bool {
        self.changed &= !self.export;
        std::mem::take(&mut self.export)
    }

    /// One sample: reads the inputs, writes the outputs.
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        let before = self.reader.positions();
        let (reading, valid) = self.reader.read(input);
        let at_rest = servo::at_rest(p, &reading.positions, &before);
        self.decide(p, input, &reading, valid, at_rest);
        self.advance(p, &reading, input.hold);
        let velocity = self.command(p, &reading);
        self.report(p, &velocity, output);
    }

    /// Finds faults, and goes on to the next state.
    fn decide(&mut self, p: &Parameters, input: &Input, reading: &Reading, valid: bool, at_rest: bool) {
        let fault = self.find_fault(p, reading, valid, input);
        let (before, mode) = (self.state, input.mode);
        self.disabled = !input.enable || self.disabled && before == State::Stop;
        self.state = next(
            before,
            &Events {
                enable: input.enable,
                disabled: self.disabled,
                mode,
                job: self.job,
                hold: input.hold,
                reset: self.reset.rises(input.reset_fault) && at_rest,
                fault: fault != Fault::None,
                progress: self.progress,
            },
        );
        let begins = before.waits() && matches!(self.state, State::Approach | State::Done) && mode != self.job;
        if begins {
            self.begin(p, mode);
        }
        if self.state != before || begins {
            self.enter(p, reading, before, fault);
        }
        // nothing moves by itself after a fault, or after an edge of `enable` that came during a stop
        let ignored = !self.state.closed() || before == State::Fault;
        if self.state == State::Off && !input.enable {
            self.job = Mode::Idle;
        } else if ignored || self.state == State::Idle && mode == Mode::Idle {
            self.job = mode;
        }
    }

    fn find_fault(&mut self, p: &Parameters, reading: &Reading, valid: bool, input: &Input) -> Fault {
        let starts = input.enable && self.state.waits() && input.mode != self.job;
        let compensates = matches!(input.mode, Mode::Playback | Mode::Deburr) && p.lookup.enable;
        let signs = Signs {
            valid,
            error: if self.state.closed() { &self.error } else { &[0.0; AXES] },
            too_large: std::mem::take(&mut self.too_large),
            nothing_learned: starts && compensates && self.bank.patterns().is_empty(),
            cuts: self.state == State::Run && self.job == Mode::Deburr,
            spindle_speed: reading.spindle_speed,
        };
        faults::find(p, &signs)
    }

    fn enter(&mut self, p: &Parameters, reading: &Reading, before: State, fault: Fault) {
        self.fault = fault;
        self.progress = Progress::Busy;
        match self.state {
            State::Idle if before.closed() => self.job = Mode::Idle,
            State::Idle => self.joints = reading.positions,
            State::Approach => {
                self.transfer = TransferMotion::new(p, &self.joints, &self.start);
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
                self.changed = true;
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
                self.finish_if(self.rested >= ticks(p.transfer.settle_time, p.sample_period));
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
        self.changed = true;
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
    fn command(&mut self, p: &Parameters, reading: &Reading) -> Joints {
        if !self.state.closed() {
            return [0.0; AXES];
        }
        let (reference, encoder) = (servo::pulses(p, &self.joints), servo::pulses(p, &reading.positions));
        self.error = std::array::from_fn(|i| reference[i] - encoder[i]);
        let learns = self.job == Mode::Learn && self.state == State::Run && self.progress == Progress::Busy;
        if learns && (!self.path.cyclic || self.run.laps > 0) {
            let pattern = self.bank.pattern(self.learner.speed);
            if let Some(index) = self.run.index(pattern) {
                self.learner.record(index, &self.error, &p.pulses(), &p.arm.levers(&self.joints));
            }
        }
        servo::command(p, &self.error, &self.compensation)
    }

    fn report(&self, p: &Parameters, velocity: &Joints, output: &mut Output) {
        let reference = servo::pulses(p, &self.joints);
        let Output { axis, saturated, state, fault, path, learn, load, bank } = output;
        *axis = std::array::from_fn(|i| AxisOutput {
            velocity: velocity[i],
            reference: reference[i] * p.axis[i].pulse,
            error: self.error[i] * p.axis[i].pulse,
            compensation: self.compensation[i] * p.axis[i].pulse,
            rms: self.learner.errors.rms[i],
            peak: self.learner.errors.peak[i],
        });
        *saturated = (0..AXES).any(|i| velocity[i].abs() >= p.axis[i].velocity_max);
        (*state, *fault) = (self.state, self.fault);
        *path = self.run.report(&self.path, self.on_path, self.state == State::Done && self.job.moves());
        *learn = self.learner.report(p, self.job == Mode::Learn || self.learned, self.learned);
        *load = self.load.report(p, self.state == State::Run);
        bank.patterns = self.bank.patterns().len() as i32;
        if self.changed {
            bank.status = if bank.patterns == 0 { BankStatus::Empty } else { BankStatus::Learned };
        }
    }
}

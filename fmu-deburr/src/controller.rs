//! One control step: measure, decide, plan, compensate, command, report.

mod commissioning;
mod following;
mod registering;
mod reporting;
mod watching;

use control_blocks::{Consecutive, Edge, ParameterError, Progress as Elapsed, Reaction, SentCommands, WaitingRequest};
use serde::{Deserialize, Serialize};

use crate::bank::kept::KeptPatterns;
use crate::bank::pattern_bank::PatternBank;
use crate::check::check;
use crate::commission::commissioning_run::CommissioningRun;
use crate::interface::{BankStatus, Fault, Input, Mode, Output, Parameters, State};
use crate::learning::feedforward::Feedforward;
use crate::learning::learner::Learner;
use crate::load::LoadControl;
use crate::machine::{Events, Progress, next};
use crate::monitoring::budget::budget;
use crate::monitoring::delay::DelayMonitor;
use crate::monitoring::finding::{Finding, Numbers};
use crate::monitoring::frozen_spindle::FrozenSpindle;
use crate::monitoring::tool::ToolMonitor;
use crate::monitoring::watch::Watch;
use crate::path::feasible;
use crate::path::kinematics::{AXES, Joints};
use crate::path::programmed_path::ProgrammedPath;
use crate::path::route::Route;
use crate::reading::{Reader, Reading, ReadingContext};
use crate::registration::plan;
use crate::registration::registrar::Registrar;
use crate::run::Run;
use crate::servo;

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    path: ProgrammedPath,
    /// axes at the start of the path, where the part lies and as programmed
    start: Joints,
    programmed_start: Joints,
    bank: PatternBank,
    kept: KeptPatterns,
    feedforward: Feedforward,
    learner: Learner,
    commissioning_run: CommissioningRun,
    /// a commissioning run continues, or stops
    commissioning: bool,
    /// an edge of `commission` waits for axes at rest
    commission_request: WaitingRequest,
    commission: Edge,
    registrar: Registrar,
    /// a registration continues, or stops
    registering: bool,
    /// an edge of `register` waits for axes at rest
    register_request: WaitingRequest,
    register: Edge,
    /// something is being learned; all of it was learned
    learning: bool,
    learned: bool,
    load: LoadControl,
    reader: Reader,
    watch: Watch,
    delay: DelayMonitor,
    tool: ToolMonitor,
    frozen_spindle: FrozenSpindle,
    reset: Edge,
    /// the inputs of this sample hold for more than one
    long_step: bool,
    /// `enable` was false during the present stop
    disabled: bool,
    state: State,
    /// the pose is held in `Fault`
    holds: bool,
    fault: Fault,
    numbers: Numbers,
    /// present or last task; a `mode` that is equal to it starts nothing
    task: Mode,
    /// `mode` of the last sample with `enable`; none before the first one
    requested: Option<Mode>,
    /// samples of the task, and how many it may take
    elapsed: Elapsed,
    budget: u64,
    progress: Progress,
    route: Route,
    run: Run,
    /// the run, not the route, was the last motion
    on_path: bool,
    /// the tool may be in the part
    inside: bool,
    rested: Consecutive,
    /// reference, rad or m
    joints: Joints,
    sent: [SentCommands; AXES],
    /// control error and compensation of the last sample, pulses
    error: Joints,
    compensation: Joints,
    /// fault at the end of a run or lap, for the next sample
    ended: Finding,
    /// the bank is to be written
    export: bool,
    /// the bank is not that of a file any more
    changed: bool,
    /// where the bank was from before
    origin: BankStatus,
}

impl Controller {
    /// Controller before its first sample, on a path that was read.
    ///
    /// # Errors
    /// When a parameter does not fit the others, or the robot cannot follow the path.
    pub fn new(p: &Parameters, path: ProgrammedPath) -> Result<Self, ParameterError> {
        check(p, &path)?;
        let start = feasible::start(p, &path)?;
        plan::check(p, &path, &start)?;
        let registrar = Registrar::new(path.touches.len());
        let mut bank = PatternBank::plan(p, &path)?;
        let mut feedforward = Feedforward::new(p, bank.longest());
        if p.bank.compute {
            bank.fill(|pattern| feedforward.fill(p, &path, &start, pattern));
        }
        let (learner, commissioning_run) = (Learner::new(p, bank.longest()), CommissioningRun::new(p, path.speed));
        let (load, run, kept) =
            (LoadControl::new(path.speed), Run::new(p, &path, &[0.0; AXES]), KeptPatterns::new(&bank));
        Ok(Self {
            path,
            start,
            programmed_start: start,
            bank,
            kept,
            feedforward,
            learner,
            commissioning_run,
            commissioning: false,
            commission_request: WaitingRequest::default(),
            commission: Edge::default(),
            registrar,
            registering: false,
            register_request: WaitingRequest::default(),
            register: Edge::default(),
            learning: false,
            learned: false,
            load,
            reader: Reader::default(),
            watch: Watch::new(p),
            delay: DelayMonitor::new(p),
            tool: ToolMonitor::default(),
            frozen_spindle: FrozenSpindle::default(),
            reset: Edge::default(),
            long_step: false,
            disabled: false,
            state: State::Off,
            holds: false,
            fault: Fault::None,
            numbers: Numbers::START,
            task: Mode::Idle,
            requested: None,
            elapsed: Elapsed::default(),
            budget: 0,
            progress: Progress::Busy,
            route: Route::at(&[0.0; AXES]),
            run,
            on_path: false,
            inside: false,
            rested: Consecutive::NONE,
            joints: [0.0; AXES],
            sent: [SentCommands::default(); AXES],
            error: [0.0; AXES],
            compensation: [0.0; AXES],
            ended: Finding::NONE,
            export: false,
            changed: false,
            origin: BankStatus::Empty,
        })
    }

    /// The programmed path.
    pub fn path(&self) -> &ProgrammedPath {
        &self.path
    }

    /// The control patterns.
    pub fn bank(&self) -> &PatternBank {
        &self.bank
    }

    /// The programmed path, and the control patterns to be read from a file.
    pub fn path_and_bank(&mut self) -> (&ProgrammedPath, &mut PatternBank) {
        (&self.path, &mut self.bank)
    }

    /// Whether the bank is to be written now; asked for once.
    pub fn take_export(&mut self) -> bool {
        self.changed &= !self.export;
        std::mem::take(&mut self.export)
    }

    /// The next samples have the inputs of one communication step that is too long.
    pub fn begin_long_step(&mut self) {
        self.long_step = true;
    }

    /// One sample: reads the inputs, writes the outputs. The parameters must be those of [`Controller::new`] with
    /// [`Controller::bring_into_force`], except the tunable ones.
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        if !self.learning && !self.changed {
            self.origin = output.bank.status;
        }
        if self.commissioning_run.take_renewed() {
            self.renew(p);
        }
        let before = self.reader.positions();
        let motions = self.sent.map(|sent| sent.before(p.io_delay as usize) * p.sample_period);
        let context = ReadingContext { motions: &motions, closed: self.closed(), cuts: self.cuts() };
        let (reading, found) = self.reader.read(p, input, &context);
        let at_rest = servo::at_rest(p, &reading.positions, &before);
        let (axes, grown) = self.watch_axes(p, &reading, &motions);
        let grown = grown && self.abandon_repetition(p);
        self.observe_registration(p, &reading, input.contact);
        let found = self.find_fault(p, &reading, found, axes, input);
        self.decide(p, input, &reading, found, (at_rest, grown));
        self.advance(p, &reading, input);
        let velocity = self.command(p, &reading);
        self.observe_commission(p, &reading);
        self.report(p, &velocity, output);
    }

    /// The position loop is closed: after a fault with live drives the pose is held where the reaction ended.
    fn closed(&self) -> bool {
        self.state.closed() || self.state == State::Fault && self.holds && self.fault.reaction() != Reaction::DriveOff
    }

    /// The tool cuts.
    fn cuts(&self) -> bool {
        self.state == State::Run && self.task == Mode::Deburr
    }

    /// A task that uses patterns.
    fn compensates(&self, p: &Parameters, task: Mode) -> bool {
        matches!(task, Mode::Playback | Mode::Deburr) && p.lookup.enable
    }

    /// Enters the next state.
    fn decide(&mut self, p: &Parameters, input: &Input, reading: &Reading, found: Finding, signs: (bool, bool)) {
        let (at_rest, grown) = signs;
        let (before, mode) = (self.state, input.mode);
        let end = self.escalate(found, before != State::Off || input.enable);
        // nothing begins from a position that is not known
        let enable = input.enable && self.reader.placed();
        self.disabled = !enable || self.disabled && before == State::Stop;
        let edge = self.commission.rises(input.commission);
        let requested = self.commission_request.update(before.waits(), edge, input.commission);
        let edge = self.register.rises(input.register);
        let touches = self.register_request.update(before.waits(), edge, input.register);
        let requested_on = if before == State::Register { input.register } else { input.commission };
        self.state = next(
            before,
            &Events {
                enable,
                disabled: self.disabled,
                mode,
                task: self.task,
                hold: input.hold,
                reset: self.reset.rises(input.reset_fault) && at_rest,
                end,
                commission: requested && at_rest && !input.hold,
                register: touches && at_rest && !input.hold,
                abort: !requested_on || input.hold,
                measuring: self.commissioning || self.registering,
                fault: found.is_fault(),
                inside: self.inside,
                grown,
                learned: self.task == Mode::Learn && self.learned,
                progress: self.progress,
            },
        );
        let begins = before.waits() && matches!(self.state, State::Approach | State::Done) && mode != self.task;
        if begins {
            self.begin(p, mode);
        }
        if self.state != before || begins {
            self.enter(p, reading, before);
        }
        self.take_mode(before, mode, enable);
        self.commissioning &= matches!(self.state, State::Commission | State::Stop | State::Retract);
        self.registering &= matches!(self.state, State::Register | State::Stop | State::Retract);
        if self.learning && (self.task != Mode::Learn || !self.state.closed()) {
            (self.learning, self.changed) = (false, self.kept.end(&mut self.bank) || self.changed);
        }
    }

    /// Takes over `mode` as the task, without starting it, where a change of `mode` must not start a motion. In `Off`,
    /// a mode that is unchanged since the last sample with `enable` starts with the next `enable`.
    fn take_mode(&mut self, before: State, mode: Mode, enable: bool) {
        // after a fault, a commissioning run or a registration, or after an edge of `enable` that came during a stop
        let measured = (self.commissioning || self.registering) && self.state == State::Idle;
        let ignored = !self.state.closed() || before == State::Fault || measured;
        if self.state == State::Off && !enable {
            // a mode that changes now does not begin with `enable`
            self.task = if self.requested.is_none_or(|requested| requested == mode) { Mode::Idle } else { mode };
        } else if ignored || self.state == State::Idle && mode == Mode::Idle {
            self.task = mode;
        }
        if enable {
            self.requested = Some(mode);
        }
    }

    fn enter(&mut self, p: &Parameters, reading: &Reading, before: State) {
        self.progress = Progress::Busy;
        if before == State::Commission && !self.commissioning_run.finished {
            self.commissioning_run.abort();
        }
        if before == State::Fault {
            (self.fault, self.numbers) = (Fault::None, Numbers::START);
        }
        match self.state {
            State::Idle if before.closed() => self.task = Mode::Idle,
            State::Idle => {
                self.joints = reading.positions;
                self.watch.restart(p, &reading.positions);
            }
            State::Approach => {
                // repetitions are learned in air
                self.route = match before {
                    State::Run => Route::straight(p, &self.joints, &self.start, true),
                    _ => Route::around(p, &self.joints, &self.start, self.inside),
                };
                self.on_path = false;
                self.watch.forget_slips();
            }
            State::Retract => (self.route, self.on_path) = (Route::out(p, &self.joints), false),
            State::Settle => {
                self.rested = Consecutive::NONE;
                self.watch.settle();
            }
            State::Fault => self.holds = before.closed(),
            State::Run => self.begin_run(p),
            State::Commission => self.begin_commission(p),
            State::Register => self.begin_registration(p, reading),
            _ => {}
        }
        if !before.closed() {
            self.error = [0.0; AXES];
        }
    }

    fn begin_run(&mut self, p: &Parameters) {
        self.run = Run::new(p, &self.path, &self.feedforward.later(p));
        self.load = LoadControl::new(self.path.speed);
        self.learner.restart();
        self.watch.begin_run();
        self.delay = DelayMonitor::new(p);
        self.tool.restart();
        (self.on_path, self.inside) = (true, true);
    }

    /// A new job.
    fn begin(&mut self, p: &Parameters, mode: Mode) {
        self.task = mode;
        self.frozen_spindle = FrozenSpindle::default();
        self.watch.begin_task();
        self.elapsed.restart();
        self.budget = budget(p, &self.path, mode);
        self.export |= mode == Mode::Export;
        if mode == Mode::Learn {
            (self.learning, self.learned) = (true, false);
            self.learner.start();
            self.kept.begin(&mut self.bank, p.learn.from_bank);
        }
    }

    fn finish_if(&mut self, over: bool) {
        self.progress = if over { Progress::Over } else { Progress::Busy };
    }

    /// Velocity commands, rad/s or m/s.
    fn command(&mut self, p: &Parameters, reading: &Reading) -> Joints {
        if !self.closed() {
            self.sent.iter_mut().for_each(|sent| sent.send(0.0));
            return [0.0; AXES];
        }
        let (reference, encoder) = (servo::pulses(p, &self.joints), servo::pulses(p, &reading.positions));
        self.error = std::array::from_fn(|i| reference[i] - encoder[i]);
        let learns = self.task == Mode::Learn && self.state == State::Run && self.progress == Progress::Busy;
        if learns && (!self.path.cyclic || self.run.laps > 0) {
            let pattern = self.bank.pattern(self.learner.speed);
            if let Some(index) = self.run.index(pattern) {
                self.learner.record(index, &self.error, &p.pulses(), &p.arm.levers(&self.joints));
            }
        }
        let velocity = servo::command(p, &self.error, &self.compensation);
        self.watch.command(p, &reference, &self.compensation, &velocity);
        self.sent.iter_mut().zip(velocity).for_each(|(sent, velocity)| sent.send(velocity));
        velocity
    }
}

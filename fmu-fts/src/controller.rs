//! One sample of the whole law: read, decide, refer, act, report.

use control_blocks::{Edge, ParameterError, Progress, Trajectory, WaitingRequest, export_commission};
use serde::{Deserialize, Serialize};

use crate::calibration::calibrator::Calibrator;
use crate::calibration::cut::Moment;
use crate::check::check;
use crate::commission::commissioner::Commissioner;
use crate::faults::{self, Situation};
use crate::identify::experiment::Identification;
use crate::identify::tone::Expected;
use crate::interface::{ErrorOutput, Fault, FormOutput, Input, Mode, Output, Parameters};
use crate::interface::{ReferenceOutput, ResponseOutput, State};
use crate::machine::{Events, Request, next};
use crate::monitoring::feed::FeedWatch;
use crate::monitoring::numbers::Numbers;
use crate::monitoring::watch::{Sample, Watch, late};
use crate::motion::ending::Ending;
use crate::motion::hold::{HoldMotion, duration};
use crate::motion::sweep::sweep;
use crate::path::depth_table::DepthTable;
use crate::path::feasibility::{infeasible, needed_torque};
use crate::path::kinematics::Arm;
use crate::path::path_table::PathTable;
use crate::reading::{Reader, Reading};
use crate::servo::design::{design, shape};
use crate::servo::dry_friction::dry_friction;
use crate::servo::lead_lag::{LeadLag, Recursion};
use crate::servo::loop_model::LoopModel;
use crate::servo::loop_response::LoopResponse;
use crate::servo::response::FrequencyResponse;
use crate::texts::Tables;
use crate::tracking::phasors::Phasors;
use crate::tracking::spindle::Spindle;
use crate::tracking::tracker::{Layers, Tracker, Wanted};

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    arm: Arm,
    compensator: LeadLag,
    reader: Reader,
    long_step: bool,
    request: Request,
    reset_fault: Edge,
    forget: Edge,
    spindle: Spindle,
    state: State,
    ending: Ending,
    watch: Watch,
    feed: FeedWatch,
    job: Progress,
    /// time and limit (s) of a job that takes too long
    late: Option<[f64; 2]>,
    /// the last command, N.m
    torque: f64,
    hold: HoldMotion,
    tracker: Tracker,
    /// slide position at which the arm came onto the path, m
    joined: f64,
    /// motion of the hub that is wanted
    motion: Trajectory,
    recursion: Recursion,
    /// the response is new and not told yet
    response: Option<FrequencyResponse>,
    /// that of `response.file`
    told_response: Option<FrequencyResponse>,
    identification: Identification,
    commissioner: Commissioner,
    /// `commission` and `enable` in the last sample
    before: Option<[bool; 2]>,
    /// an edge of `commission` waits for an arm at rest
    commission_asked: WaitingRequest,
    /// the arm is held by the compensator of the commission
    slow: bool,
    calibration: Calibrator,
}

impl Controller {
    /// Controller before its first sample.
    ///
    /// # Errors
    /// When a parameter does not fit the others.
    pub fn new(p: &Parameters, tables: &Tables) -> Result<Self, ParameterError> {
        check(p)?;
        let (arm, compensator) = (Arm::new(p), design(p)?);
        let depth = match &tables.depth {
            Some(table) => table,
            None => &DepthTable::of_surface(p)?,
        };
        let path = PathTable::new(arm, depth, p.feedforward_harmonics as usize);
        let model = LoopModel::new(p, compensator);
        let mut tracker = Tracker::new(p, path, LoopResponse::nominal(model));
        tables.response.iter().for_each(|measured| tracker.take(p, measured));
        let identification = Identification::new(p, |omega| expected(&tracker, omega));
        let known = tracker.response().tabulated(p.identify.grid.iter());
        Ok(Self {
            arm,
            compensator,
            reader: Reader::default(),
            long_step: false,
            request: Request::default(),
            reset_fault: Edge::default(),
            forget: Edge::default(),
            spindle: Spindle::default(),
            state: State::Idle,
            ending: Ending::default(),
            watch: Watch::default(),
            feed: FeedWatch::default(),
            job: Progress::default(),
            late: None,
            torque: 0.0,
            hold: HoldMotion::at(0.0),
            tracker,
            joined: 0.0,
            motion: Trajectory::default(),
            recursion: Recursion::default(),
            identification,
            response: Some(tables.response.unwrap_or(known)),
            told_response: tables.response,
            commissioner: Commissioner::new(p),
            before: None,
            commission_asked: WaitingRequest::default(),
            slow: false,
            calibration: Calibrator::new(p),
        })
    }

    /// The next samples have the inputs of one communication step that is too long.
    pub fn begin_long_step(&mut self) {
        self.long_step = true;
    }

    /// Puts what a commission has measured into the parameters, where `commission.apply` says so; before each sample.
    pub fn bring_into_force(&self, p: &mut Parameters) {
        self.commissioner.put(p);
    }

    /// Writes what the last good commission derives into the file `commission.export`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn export(&self, p: &Parameters) -> Result<(), ParameterError> {
        export_commission(&p.commission.export, &self.commissioner.derived())
    }

    /// One sample; the parameters must be those of [`Controller::new`] with [`Controller::bring_into_force`].
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        if self.commissioner.take_renewed() {
            self.renew(p);
        }
        // a flexure that is measured at its resonance pushes the hub with more than the torque
        let acting = if self.slow { p.servo.torque_max } else { self.torque };
        let reading = self.reader.read(p, input, acting);
        self.spindle.update(p, reading.spindle_angle, self.reader.spindle_begins());
        let phasors = self.tracker.locate(p, reading.slide_position, &self.spindle);
        self.decide(p, input, &reading);
        let layers = self.layers(p, input);
        let wanted = self.refer(p, &reading, layers, &phasors);
        let torque = self.act(p, &wanted, &reading);
        self.torque = torque;
        self.monitor(p, torque, &wanted, &reading, layers.learning);
        self.calibrate(p, input, &reading, torque);
        self.report(p, torque, &wanted, &reading, output);
        output.afc_frozen = !layers.learning;
        self.long_step = false;
        if self.state == State::Commission {
            self.commissioner.observe(p, reading.arm_angle);
        }
        if self.on_path() {
            self.feed.update(p, self.spindle.angle, reading.slide_position);
            self.tracker.judge(output.error.tracking, &self.spindle, &phasors);
        }
    }

    /// Largest depth (m) that the harmonics of the path leave out.
    pub fn truncation(&self) -> f64 {
        self.tracker.path().truncation
    }

    /// Another machine is in force: the loop, and what it is expected to do.
    fn renew(&mut self, p: &Parameters) {
        self.compensator = shape(&p.into()).0;
        self.tracker.renew(p, LoopModel::new(p, self.compensator));
        let told = self.told_response.filter(|_| self.commissioner.as_told());
        told.iter().for_each(|measured| self.tracker.take(p, measured));
        let Self { tracker, identification, .. } = self;
        identification.expect(p, |omega| expected(tracker, omega));
        self.response = Some(told.unwrap_or_else(|| tracker.response().tabulated(p.identify.grid.iter())));
    }

    /// What is asked for; while the arm is held for a commission, no job.
    fn asked(&mut self, input: &Input) -> Mode {
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
    fn decide(&mut self, p: &Parameters, input: &Input, reading: &Reading) {
        let mode = self.asked(input);
        if self.request.renewed() {
            self.job.restart();
        }
        let [commission, enable] = self.edges(input);
        let asked = self.commission_asked.update(self.state.waits(), commission, input.commission);
        // of a fault the last is told
        if self.state != State::Fault {
            self.late = late(p, self.tracker.path(), self.measurements(), self.state, &self.job);
        }
        let events = Events {
            fault: faults::find(p, &self.situation(p, mode, reading)),
            reset: self.reset_fault.rises(input.reset_fault),
            at_rest: !self.ending.braking() && (!self.closed() || self.stands(p)),
            renewed: self.request.renewed(),
            commission: asked && self.reader.arm_velocity(p) == 0.0,
            break_off: !input.commission || enable || self.request.renewed(),
            commissioned: self.commissioner.finished,
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
            self.ending.escalate(p, events.fault, self.reader.arm_velocity(p));
            if !input.enable && self.stands(p) {
                self.ending.release();
            }
        }
        if !self.closed() {
            self.reader.begin_arm_anew();
            self.slow = false;
        }
        if !self.closed() || self.tracker.gone(p) {
            self.reader.begin_anew();
        }
    }

    /// What faults are found from.
    fn situation(&self, p: &Parameters, mode: Mode, reading: &Reading) -> Situation<'_> {
        let path = self.tracker.path();
        let wanted = matches!(mode, Mode::Approach | Mode::Track) && !matches!(self.state, State::Fault | State::Done);
        Situation {
            missing: self.reader.missing(),
            long_step: self.long_step,
            found: if self.closed() { self.watch.find(p, self.arm.length) } else { None },
            feed_lost: self.on_path() && self.feed.lost().is_some(),
            overdue: self.state != State::Fault && self.late.is_some(),
            rejected: self.state == State::Commission && self.commissioner.rejected,
            path: wanted.then_some(path),
            outside: self.left(reading) && !(self.on_path() && path.cut_over(self.joined, reading.slide_position)),
            spindle_speed: if self.reader.spindle_begins() { 0.0 } else { self.spindle.speed },
        }
    }

    /// Whether the arm is on the path: the end of the table may be the end of the cut.
    fn on_path(&self) -> bool {
        matches!(self.state, State::Ready | State::Track)
    }

    /// Whether a path can begin: a speed that is too much for it may be one of a bad reading, and waits for the next.
    fn spindle_known(&self, p: &Parameters) -> bool {
        let doubtful = self.reader.spindle_begins() && infeasible(p, self.tracker.path(), self.spindle.speed);
        self.spindle.known() && self.reader.spindle_known() && !doubtful
    }

    /// Whether the slide is seen where the path has no table.
    fn left(&self, reading: &Reading) -> bool {
        self.reader.spindle_known() && !self.tracker.path().covers(reading.slide_position)
    }

    /// Whether the arm has come to rest beside the path.
    fn stands(&self, p: &Parameters) -> bool {
        self.tracker.gone(p) && self.motion.velocity == 0.0 && !self.swinging()
    }

    /// Whether the arm swings to be measured.
    fn swinging(&self) -> bool {
        self.identification.swinging() || self.commissioner.experiment.swinging()
    }

    /// Ends a swing.
    fn stop_swing(&mut self) {
        self.identification.stop();
        self.commissioner.experiment.stop();
    }

    /// Times (s) of an identification, and the longest of a commission.
    fn measurements(&self) -> [f64; 2] {
        [self.identification.duration(), self.commissioner.limit()]
    }

    /// Whether the position loop is closed.
    fn closed(&self) -> bool {
        match self.state {
            State::Idle => false,
            State::Fault => self.ending.retracting(),
            _ => true,
        }
    }

    /// What happens once, when `state` begins.
    fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading) {
        let closed = self.closed();
        let fault = events.fault.filter(|_| state == State::Fault).unwrap_or(Fault::None);
        self.ending.begin(p, fault, closed && state == State::Fault, self.reader.arm_velocity(p));
        if self.state == State::Commission && !self.commissioner.finished {
            self.commissioner.break_off();
        }
        if !closed || state == State::Commission {
            self.begin(p, reading.arm_angle);
        }
        match state {
            State::Idle => self.tracker.forget(),
            State::Hold | State::Calibrate => self.leave(p, reading.hold_angle),
            State::Identify => {
                self.leave(p, reading.hold_angle);
                if !self.identification.swinging() {
                    self.identification.restart();
                }
            }
            State::Commission => {
                self.commissioner.begin();
                self.request.spend();
                self.job.restart();
                self.slow = true;
            }
            State::Retract if self.tracker.gone(p) => {
                self.stop_swing();
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
        self.state = state;
    }

    /// Another path begins: the form of the lens that was probed counts, unless something of the path before is in the motion.
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

    /// Off the path and out of a swing, to rest at `goal` (rad).
    fn leave(&mut self, p: &Parameters, goal: f64) {
        self.stop_swing();
        if self.tracker.arrived(p) {
            // nothing of what was held before is in the motion
            self.hold = HoldMotion::at(goal);
            self.tracker.leave(p, duration(p, self.motion.position, goal));
            return;
        }
        if !self.hold.stops(p) {
            self.hold.turn(p, goal);
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
        let least = if self.tracker.gone(p) { depth } else { depth.min(self.tracker.lowest()) };
        self.arm.angle(least - p.limits.retract)
    }

    /// Which layers work in this sample.
    fn layers(&mut self, p: &Parameters, input: &Input) -> Layers {
        if self.forget.rises(input.afc_reset) || !input.afc_enable {
            self.tracker.forget();
        }
        let steady = !self.recursion.saturated && self.reader.known() && self.spindle.speed.abs() >= p.afc.speed_min;
        Layers {
            feedforward: input.feedforward_enable,
            cancellation: input.afc_enable,
            learning: input.afc_enable && steady && self.state == State::Track,
        }
    }

    /// What the arm should do.
    fn refer(&mut self, p: &Parameters, reading: &Reading, layers: Layers, phasors: &Phasors) -> Wanted {
        let wanted = if self.closed() {
            let held = self.held(p, reading);
            let held = self.swing(p, held, reading);
            if self.tracker.gone(p) {
                self.still(held)
            } else {
                self.tracker.follow(p, held, reading.arm_angle, layers, phasors)
            }
        } else {
            self.still(Trajectory::resting(reading.arm_angle))
        };
        self.motion = wanted.motion;
        wanted
    }

    /// The motion beside the path.
    fn held(&mut self, p: &Parameters, reading: &Reading) -> Trajectory {
        match self.state {
            State::Calibrate if reading.cutting && self.tracker.gone(p) && !self.identification.swinging() => {
                let motion = sweep(p, self.motion, reading.hold_angle);
                // what comes after the cut begins here
                self.hold.go(p, motion, reading.hold_angle);
                motion
            }
            State::Hold | State::Calibrate | State::Identify => self.hold.step(p, reading.hold_angle),
            _ => self.hold.coast(p),
        }
    }

    /// A motion that needs no correction.
    fn still(&self, motion: Trajectory) -> Wanted {
        Wanted { motion, depth: self.arm.depth(motion.position), set_point: motion.position }
    }

    /// Once the arm holds its angle it swings about it, until the frequency response is complete and in use; what is broken
    /// off fades.
    fn swing(&mut self, p: &Parameters, centre: Trajectory, reading: &Reading) -> Trajectory {
        let measures = matches!(self.state, State::Identify | State::Commission);
        let ready = measures && self.hold.arrived(p) && self.tracker.gone(p);
        let experiment = if self.slow { &mut self.commissioner.experiment } else { &mut self.identification };
        let begins = ready && !experiment.done();
        if begins && experiment.broken_off() {
            experiment.restart();
        }
        if !begins && !experiment.swinging() {
            return centre;
        }
        let position = centre.position + experiment.step(reading.arm_angle - centre.position, self.recursion.saturated);
        if self.state == State::Identify && self.identification.done() {
            self.tracker.take(p, self.identification.response());
            self.response = Some(*self.identification.response());
        }
        Trajectory { position, velocity: (position - self.motion.position) / p.sample_period, acceleration: 0.0 }
    }

    /// What the next sample is judged by.
    fn monitor(&mut self, p: &Parameters, torque: f64, wanted: &Wanted, reading: &Reading, learning: bool) {
        let sample = Sample {
            wanted: wanted.motion.position,
            arm_angle: reading.arm_angle,
            torque,
            swinging: self.swinging(),
            learning,
            rms: self.tracker.last_turn().rms,
            spindle_speed: self.spindle.speed,
        };
        if self.closed() {
            self.watch.update(p, self.arm.length, &sample);
            // what is measured and held has no end
            let over = self.state == State::Identify && self.identification.done();
            if !over {
                self.job.count();
            }
        }
    }

    /// Samples of a calibration and its fits.
    fn calibrate(&mut self, p: &Parameters, input: &Input, reading: &Reading, torque: f64) {
        if self.state == State::Calibrate {
            let &Reading { arm_angle, slide_position, .. } = reading;
            self.calibration.step(p, input, Moment { arm_angle, torque, slide_position }, self.tracker.path());
        } else {
            self.calibration.rest();
        }
    }

    /// Position loop.
    fn act(&mut self, p: &Parameters, wanted: &Wanted, reading: &Reading) -> f64 {
        if !self.closed() {
            return self.ending.torque();
        }
        let (error, limit) = (wanted.set_point - reading.arm_angle, p.servo.torque_max);
        if self.slow {
            return self.recursion.update(self.commissioner.compensator(), error, limit);
        }
        let torque = self.recursion.update(&self.compensator, error, limit) + dry_friction(p, wanted.motion);
        torque.clamp(-limit, limit)
    }

    fn report(&mut self, p: &Parameters, torque: f64, wanted: &Wanted, reading: &Reading, output: &mut Output) {
        let (turn, path, speed) = (self.tracker.last_turn(), self.tracker.path(), self.spindle.speed);
        let behind = wanted.motion.position - reading.arm_angle;
        output.torque = torque;
        output.state = self.state;
        output.fault = self.ending.fault();
        output.drive_enable = self.ending.drive_enable();
        output.drive_share = self.watch.share(p).unwrap_or(1.0);
        output.reference = ReferenceOutput { depth: wanted.depth, angle: wanted.motion.position };
        output.error = ErrorOutput {
            // of a fault the last error is told
            tracking: match self.state {
                State::Fault if !self.closed() => self.watch.following_error(),
                _ => self.arm.lever(reading.arm_angle) * behind,
            },
            rms: turn.rms,
            peak: turn.peak,
            harmonic: turn.harmonic.map(|c| c.norm()),
        };
        output.spindle_speed = speed;
        output.saturated = self.closed() && self.recursion.saturated;
        output.path_torque = needed_torque(p, path, speed);
        output.path_torque_share = self.tracker.torque_share();
        output.path_truncation = path.truncation;
        output.numbers = Numbers { late: self.late, fed: self.feed.lost(), table: path.ends(), ..self.watch.numbers() };
        output.calibration = self.calibration.report();
        output.form = FormOutput { corrected: path.correction().is_some(), ..self.calibration.form() };
        output.measured = self.commissioner.measured;
        output.identify_progress = self.identification.progress();
        if let Some(response) = self.response.take() {
            output.response = ResponseOutput::of(&response, self.tracker.response(), &self.tracker.flexure());
        }
    }
}

/// What a swing at `omega` (rad/s) is expected to do.
fn expected(tracker: &Tracker, omega: f64) -> Expected {
    Expected {
        response: tracker.response().at(omega),
        stiffness: tracker.response().model().arm(omega).norm().recip(),
        hub_over_tool: tracker.flexure().hub_over_tool(omega).norm(),
    }
}

//! One control step: measure, decide, plan, control, report.

mod deciding;
mod entering;
mod referring;
mod reporting;

use control_blocks::{Edge, ParameterError, Progress, Trajectory, WaitingRequest, export_commission};
use serde::{Deserialize, Serialize};

use crate::calibration::calibrator::Calibrator;
use crate::calibration::cut::Moment;
use crate::check::check;
use crate::commission::run::CommissioningRun;
use crate::identify::experiment::Identification;
use crate::identify::tone::Expected;
use crate::interface::{Input, Output, Parameters, State};
use crate::machine::Request;
use crate::monitoring::feed::FeedWatch;
use crate::monitoring::watch::{Sample, Watch};
use crate::motion::ending::{Ending, LastMotion};
use crate::motion::hold::HoldMotion;
use crate::path::depth_table::DepthTable;
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
use crate::tracking::spindle::Spindle;
use crate::tracking::tracker::{Target, Tracker};

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    arm: Arm,
    compensator: LeadLag,
    reader: Reader,
    long_step: bool,
    request: Request,
    reset_fault: Edge,
    spindle: Spindle,
    state: State,
    ending: Ending,
    watch: Watch,
    feed: FeedWatch,
    cycle: Progress,
    /// time and limit (s) of a task that takes too long
    late: Option<[f64; 2]>,
    /// the last command, N.m
    torque: f64,
    hold: HoldMotion,
    tracker: Tracker,
    /// slide position at which the arm came onto the path, m
    joined: f64,
    /// reference motion of the hub
    motion: Trajectory,
    recursion: Recursion,
    /// the response is new and not reported yet
    response: Option<FrequencyResponse>,
    /// that of `response.file`
    file_response: Option<FrequencyResponse>,
    identification: Identification,
    commissioning: CommissioningRun,
    /// `commission` and `enable` in the last sample
    before: Option<[bool; 2]>,
    /// an edge of `commission` waits for an arm at rest
    commission_request: WaitingRequest,
    /// the arm is held by the compensator of the commissioning run
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
            spindle: Spindle::default(),
            state: State::Idle,
            ending: Ending::default(),
            watch: Watch::default(),
            feed: FeedWatch::default(),
            cycle: Progress::default(),
            late: None,
            torque: 0.0,
            hold: HoldMotion::at(0.0),
            tracker,
            joined: 0.0,
            motion: Trajectory::default(),
            recursion: Recursion::default(),
            identification,
            response: Some(tables.response.unwrap_or(known)),
            file_response: tables.response,
            commissioning: CommissioningRun::new(p),
            before: None,
            commission_request: WaitingRequest::default(),
            slow: false,
            calibration: Calibrator::new(p),
        })
    }

    /// The next samples have the inputs of one communication step that is too long.
    pub fn begin_long_step(&mut self) {
        self.long_step = true;
    }

    /// Puts the results of a commissioning run into the parameters if `commission.apply` is true; before each sample.
    pub fn bring_into_force(&self, p: &mut Parameters) {
        self.commissioning.put(p);
    }

    /// Writes the derived parameters of the last successful run into the file `commission.export`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn export(&self, p: &Parameters) -> Result<(), ParameterError> {
        export_commission(&p.commission.export, &self.commissioning.derived())
    }

    /// One sample; the parameters must be those of [`Controller::new`] with [`Controller::bring_into_force`].
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        if self.commissioning.take_renewed() {
            self.renew(p);
        }
        // a flexure that is measured at its resonance pushes the hub with more than the torque
        let acting = if self.slow { p.servo.torque_max } else { self.torque };
        let reading = self.reader.read(p, input, acting);
        self.spindle.update(p, reading.spindle_angle, self.reader.spindle_begins());
        let phasors = self.tracker.locate(p, reading.slide_position, &self.spindle);
        self.decide(p, input, &reading);
        let layers = self.layers(input);
        let target = self.refer(p, &reading, layers, &phasors);
        let torque = self.act(p, &target, &reading);
        self.torque = torque;
        self.monitor(p, torque, &target, &reading, layers.learning);
        self.calibrate(p, input, &reading, torque);
        self.report(p, torque, &target, &reading, output);
        output.afc_frozen = !layers.learning;
        self.long_step = false;
        if self.state == State::Commission {
            self.commissioning.observe(p, reading.arm_angle);
        }
        if self.on_path() {
            self.feed.update(p, self.spindle.angle, reading.slide_position);
            self.tracker.evaluate(output.error.tracking, &self.spindle, &phasors);
        }
    }

    /// Whether a lens was fitted in the last sample, well or not.
    pub fn lens_fitted(&self) -> bool {
        self.calibration.lens_fitted()
    }

    /// Whether there is a correction for the next path.
    pub fn corrects(&self, p: &Parameters) -> bool {
        p.form.apply && self.calibration.correction().is_some()
    }

    /// Largest depth (m) that the harmonics of the path leave out.
    pub fn truncation(&self) -> f64 {
        self.tracker.path().truncation
    }

    /// Another machine is in force: the loop, and what it is expected to do.
    fn renew(&mut self, p: &Parameters) {
        self.compensator = shape(&p.into()).0;
        self.tracker.renew(p, LoopModel::new(p, self.compensator));
        let nominal = self.file_response.filter(|_| self.commissioning.configured());
        nominal.iter().for_each(|measured| self.tracker.take(p, measured));
        let Self { tracker, identification, .. } = self;
        identification.expect(p, |omega| expected(tracker, omega));
        self.response = Some(nominal.unwrap_or_else(|| tracker.response().tabulated(p.identify.grid.iter())));
    }

    /// Whether the arm is on the path: the end of the table may be the end of the cut.
    fn on_path(&self) -> bool {
        matches!(self.state, State::Ready | State::Track)
    }

    /// Whether the arm is at rest off the path.
    fn stopped(&self, p: &Parameters) -> bool {
        self.tracker.gone(p) && self.motion.velocity == 0.0 && !self.oscillating()
    }

    /// Whether the arm oscillates for a measurement.
    fn oscillating(&self) -> bool {
        self.identification.oscillating() || self.commissioning.experiment.oscillating()
    }

    /// Ends an oscillation.
    fn stop_oscillation(&mut self) {
        self.identification.stop();
        self.commissioning.experiment.stop();
    }

    /// Times (s) of an identification, and of the longest commissioning run.
    fn measurements(&self) -> [f64; 2] {
        [self.identification.duration(), self.commissioning.limit()]
    }

    /// Whether the position loop is closed.
    fn closed(&self) -> bool {
        match self.state {
            State::Idle => false,
            State::Fault => self.ending.retracting(),
            _ => true,
        }
    }

    /// Arm velocity and response of the drive, from which the braking pulse of a fault is computed.
    fn last_motion(&self, p: &Parameters) -> LastMotion {
        LastMotion { velocity: self.reader.arm_velocity(p), answer: self.watch.answer(p) }
    }

    /// Monitors this sample for the faults of the next one.
    fn monitor(&mut self, p: &Parameters, torque: f64, target: &Target, reading: &Reading, learning: bool) {
        let sample = Sample {
            reference: target.motion.position,
            arm_angle: reading.arm_angle,
            torque,
            oscillating: self.oscillating(),
            learning,
            rms: self.tracker.last_revolution().rms,
            spindle_speed: self.spindle.speed,
        };
        if self.closed() {
            self.watch.update(p, self.arm.length, &sample);
            // what is measured and held has no end
            let over = self.state == State::Identify && self.identification.done();
            if !over {
                self.cycle.count();
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
    fn act(&mut self, p: &Parameters, target: &Target, reading: &Reading) -> f64 {
        if !self.closed() {
            return self.ending.torque();
        }
        let (error, limit) = (target.set_point - reading.arm_angle, p.servo.torque_max);
        if self.slow {
            return self.recursion.update(self.commissioning.compensator(), error, limit);
        }
        let torque = self.recursion.update(&self.compensator, error, limit) + dry_friction(p, target.motion);
        torque.clamp(-limit, limit)
    }
}

/// Expected response to an oscillation at `omega` (rad/s).
fn expected(tracker: &Tracker, omega: f64) -> Expected {
    Expected {
        response: tracker.response().at(omega),
        stiffness: tracker.response().model().arm(omega).norm().recip(),
        hub_over_tool: tracker.flexure().hub_over_tool(omega).norm(),
    }
}

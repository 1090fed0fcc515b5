//! One control step: measure, supervise, control, move, report.

mod commissioning;
mod reporting;

use control_blocks::{ParameterError, Reaction, WaitingRequest, ramp, ticks};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::check::check;
use crate::commission::identification::Identification;
use crate::faults::{self, Evidence};
use crate::force::contact::{ContactMonitor, Measurement};
use crate::force::normal_motion::{NormalMeasurement, NormalMotion, PathState};
use crate::force::orientation::Orientation;
use crate::force::sensor::ForceSensor;
use crate::interface::{Fault, Input, Output, Parameters, State};
use crate::machine::{Events, more_severe, next};
use crate::monitoring::axis::AxisMonitor;
use crate::monitoring::cycle::{CycleTime, budget};
use crate::monitoring::force::{ForceMonitor, ForceSample};
use crate::monitoring::rest::RestMonitor;
use crate::motion::position::PositionFeedback;
use crate::motion::pulses::Remainder;
use crate::motion::sliding::Sliding;
use crate::motion::stick_slip;
use crate::motion::velocity::VelocityParts;
use crate::path::centre_path::{CentrePath, PathPosition};
use crate::path::cl_data::Point;
use crate::path::feed::next_feed;
use crate::reading::{Reader, Reading};

/// Time after the touch in which force and way do not belong together, s.
const TOUCH_TIME: f64 = 0.02;

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    path: CentrePath,
    reader: Reader,
    sensor: ForceSensor,
    state: State,
    fault: Fault,
    /// samples since the state began
    ticks: u32,
    /// the zero of the sensor is being taken
    taring: bool,
    /// in the fault state: is at rest
    halted: bool,
    /// way of approach or retract, m
    travelled: f64,
    contact: ContactMonitor,
    path_position: PathPosition,
    /// velocity of the contact point along the path, m/s
    feed: f64,
    /// target force, N
    setpoint: f64,
    normal: NormalMotion,
    feedback: PositionFeedback,
    /// samples of the sweep
    k: u32,
    /// half period (samples) that was configured
    half_period: i32,
    sliding: Sliding,
    remainder: Remainder,
    /// way along the path in the last sample, m
    distance: f64,
    axes: AxisMonitor,
    rest: RestMonitor,
    force: ForceMonitor,
    time: CycleTime,
    identification: Identification,
    /// an edge of `commission` waits for axes at rest
    commission_request: WaitingRequest,
    long_step: bool,
}

impl Controller {
    /// Controller before its first sample, for the checked points of a path.
    ///
    /// # Errors
    /// When a parameter does not fit the others.
    pub fn new(p: &Parameters, points: &[Point]) -> Result<Self, ParameterError> {
        check(p)?;
        Ok(Self {
            path: CentrePath::new(p, points),
            reader: Reader::new(),
            sensor: ForceSensor::new(),
            state: State::Idle,
            fault: Fault::None,
            ticks: 0,
            taring: false,
            halted: false,
            travelled: 0.0,
            contact: ContactMonitor::default(),
            path_position: PathPosition::default(),
            feed: 0.0,
            setpoint: 0.0,
            normal: NormalMotion::new(p),
            feedback: PositionFeedback::new(),
            k: 0,
            half_period: p.stick_slip.half_period,
            sliding: Sliding::default(),
            remainder: Remainder::new(),
            distance: 0.0,
            axes: AxisMonitor::new(p),
            rest: RestMonitor::default(),
            force: ForceMonitor::default(),
            time: CycleTime::default(),
            identification: Identification::new(p),
            commission_request: WaitingRequest::default(),
            long_step: false,
        })
    }

    /// The path.
    pub fn path(&self) -> &CentrePath {
        &self.path
    }

    /// The next samples have the inputs of one communication step that is too long.
    pub fn begin_long_step(&mut self) {
        self.long_step = true;
    }

    /// One sample; parameters that are not tunable must be those of [`Controller::new`] with
    /// [`Controller::bring_into_force`].
    pub fn tick(&mut self, input: &Input, parameters: &Parameters, output: &mut Output) {
        let p = parameters;
        if self.at_rest() {
            self.reader.rest(p, input);
        }
        let reading = self.reader.read(p, input, self.growth(p));
        let now = self.measure(p, &reading);
        self.decide(p, &reading, &now);
        self.long_step = false;
        let parts = self.act(p, &reading, &now);
        *output = self.report(p, &now, &parts);
        if self.state == State::Commission {
            self.learn(p, &reading, &now, output);
        }
    }

    /// Nothing is commanded and nothing measured: what moves the machine now is not this controller.
    fn at_rest(&self) -> bool {
        match self.state {
            State::Idle => !self.taring,
            State::Done => true,
            State::Fault => self.halted,
            _ => false,
        }
    }

    /// Largest growth of the force in a sample, N. On the approach no more than its own velocity makes: a measurement
    /// that has grown more was frozen during the motion, or the tool has hit an obstacle.
    fn growth(&self, p: &Parameters) -> f64 {
        let (stiffness, velocity) = match self.role() {
            State::Approach => (p.limits.stiffness_ratio * self.normal.stiffness, p.approach.velocity),
            _ => (self.normal.stiffness, p.velocity_max),
        };
        stiffness * velocity * p.sample_period
    }

    fn measure(&mut self, p: &Parameters, reading: &Reading) -> Measurement {
        let frame = self.path.frame(self.path_position);
        let force = self.sensor.measure(p, &reading.force, &frame.normal);
        let offset = frame.centre - reading.position;
        let error = frame.error(&offset);
        let surface = force.normal / self.normal.stiffness - error.normal;
        Measurement { frame, force, force_error: self.setpoint - force.controlled, offset, error, surface }
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, reading: &Reading, now: &Measurement) {
        let steady = self.setpoint >= p.force.target * reading.force_override;
        self.contact.update(p, self.role(), now, steady);
        self.time.update(self.state, self.taring);
        let zero = self.tare(p, reading);
        self.axes.update(p, &reading.position);
        self.rest.update(p, &reading.position);
        self.direct(reading, zero);
        let waits = matches!(self.state, State::Idle | State::Done);
        let requested = self.commission_request.update(waits, reading.begin_commission, reading.commission);
        let events = Events {
            fault: self.fault(p, reading, now, zero),
            commission: requested && reading.fresh && self.at_rest() && self.rest.at_rest(p),
            commissioned: self.identification.experiment.over(),
            enabled: reading.enabled,
            reset: reading.reset,
            ready: zero.is_some(),
            contact: self.contact.contact(),
            settled: self.contact.settled(p),
            arrived: self.path_position.s >= self.path.length(),
            unloaded: self.contact.unloaded(),
            retracted: self.retracted(p),
        };
        self.escalate(&events);
        let state = next(self.state, &events);
        self.ticks = self.ticks.saturating_add(1);
        if state != self.state {
            self.enter(p, state, &events, reading, now);
            (self.state, self.ticks) = (state, 0);
        }
    }

    fn fault(
        &mut self,
        p: &Parameters,
        reading: &Reading,
        now: &Measurement,
        zero: Option<Vector3<f64>>,
    ) -> Option<Fault> {
        let stiffness = self.normal.stiffness;
        let (state, normal) = (self.role(), Orientation::of(p).shown(&now.frame.normal));
        let sample =
            ForceSample { state, raw: &reading.force, now, normal: &normal, stiffness, distance: self.distance };
        self.force.update(p, &sample);
        let stable = !self.state.pressing() || self.normal.stable(p);
        let (stiffness_ratio, overdue) = (self.normal.stiffness_ratio(p), self.time.over());
        let Self { taring, halted, long_step, ref contact, ref axes, ref force, .. } = *self;
        let (sample, taring, (ticks, travelled)) = (&sample, taring || zero.is_some(), self.progress());
        faults::find(
            p,
            &Evidence {
                state,
                taring,
                ticks,
                travelled,
                halted,
                reading,
                now,
                zero,
                contact,
                axes,
                force,
                sample,
                stiffness_ratio,
                stable,
                slides: !self.sliding.too_little,
                rejected: self.state == State::Commission && self.identification.rejected,
                overdue,
                long_step,
            },
        )
    }

    /// A more severe fault during the retract takes over, and ends the motion.
    fn escalate(&mut self, events: &Events) {
        if let (State::Fault, Some(found)) = (self.state, events.fault) {
            self.fault = more_severe(self.fault, found);
            self.halted |= self.fault.reaction() != Reaction::Retract;
        }
    }

    /// The tool is retracted; after a cycle without a fault the force must also be gone.
    fn retracted(&self, p: &Parameters) -> bool {
        let out = self.travelled >= p.retract.distance;
        self.halted || (out && (self.state != State::Retract || self.contact.free()))
    }

    /// Takes the zero of the sensor (N) after `enable`; none until there are enough samples.
    fn tare(&mut self, p: &Parameters, reading: &Reading) -> Option<Vector3<f64>> {
        if !matches!(self.state, State::Idle | State::Commission) || !reading.fresh {
            return None;
        }
        if self.state == State::Idle {
            if reading.start {
                self.restart(p, reading, budget(p, &self.path));
            }
            self.taring &= reading.enabled;
        }
        let zero = if self.taring { self.sensor.tare(p, &reading.force) } else { None };
        self.taring &= zero.is_none();
        zero
    }

    /// Discards the last cycle; the new one may take `time` s.
    fn restart(&mut self, p: &Parameters, reading: &Reading, time: f64) {
        self.sensor.restart();
        self.axes.restart(p, &reading.position);
        self.force.restart();
        self.time.restart(p, time);
        self.taring = true;
        self.fault = Fault::None;
        self.path_position = PathPosition::default();
        self.sliding = Sliding::default();
        self.normal = NormalMotion::new(p);
    }

    /// Prepares `state`: called once, at the transition to it, before `self.state` changes.
    fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading, now: &Measurement) {
        // a retract continues
        if (self.state, state) != (State::Retract, State::Fault) {
            self.travelled = 0.0;
        }
        let moving = self.role().moving();
        if self.state == State::Commission {
            self.identification.end();
        }
        match state {
            State::Fault => {
                self.fault = events.fault.unwrap_or(Fault::None);
                self.taring = false;
                self.halted = self.fault.reaction() != Reaction::Retract || !moving;
            }
            State::Idle => (self.fault, self.halted, self.taring) = (Fault::None, false, false),
            State::Approach => self.contact = ContactMonitor::default(),
            State::Settle => {
                self.setpoint = now.force.controlled.max(0.0);
                self.feedback = PositionFeedback::new();
                self.normal.touch(p);
            }
            State::Follow => {
                self.normal.follow(p);
                (self.feed, self.k) = (0.0, 0);
            }
            State::Unload => self.normal.unload(),
            State::Commission => self.commission(p, reading),
            State::Retract | State::Done => (),
        }
        self.distance = 0.0;
        if !state.pressing() {
            self.setpoint = 0.0;
        }
    }

    /// The velocity in the present state.
    fn act(&mut self, p: &Parameters, reading: &Reading, now: &Measurement) -> VelocityParts {
        match self.state {
            State::Idle | State::Done => VelocityParts::default(),
            State::Approach => self.travel(p, -p.approach.velocity),
            State::Fault if self.halted => VelocityParts::default(),
            State::Retract | State::Fault if self.travelled >= p.retract.distance => VelocityParts::default(),
            State::Retract | State::Fault => self.travel(p, p.retract.velocity),
            State::Settle | State::Unload => self.settle(p, reading, now),
            State::Follow => self.follow(p, reading, now),
            State::Commission => self.experiment(p, now),
        }
    }

    /// Moves along the normal.
    fn travel(&mut self, p: &Parameters, velocity: f64) -> VelocityParts {
        self.travelled += velocity.abs() * p.sample_period;
        VelocityParts { normal: velocity, ..VelocityParts::default() }
    }

    /// Builds the force up, or takes it away.
    fn settle(&mut self, p: &Parameters, reading: &Reading, now: &Measurement) -> VelocityParts {
        let error = self.force_error(p, reading, now);
        // not while the approach dies out
        if self.state == State::Settle && self.ticks > ticks(TOUCH_TIME, p.sample_period) {
            self.normal.observe_stiffness(p, &reading.position, &now.frame.normal, now.force.normal);
        }
        let normal = self.normal.settle(p, error);
        VelocityParts {
            normal: self.towards(p, now, normal),
            position: self.feedback.step(p, &now.offset, &now.frame.normal),
            ..VelocityParts::default()
        }
    }

    /// Without a force the tool goes towards the mold no faster than on the approach, m/s.
    fn towards(&self, p: &Parameters, now: &Measurement, velocity: f64) -> f64 {
        if touching(p, now) { velocity } else { velocity.max(-p.approach.velocity) }
    }

    /// Moves the target force and gives the force error, N.
    fn force_error(&mut self, p: &Parameters, reading: &Reading, now: &Measurement) -> f64 {
        let target = if self.state == State::Unload { 0.0 } else { p.force.target * reading.force_override };
        self.setpoint = ramp(self.setpoint, target, p.force.target / p.settle.ramp_time * p.sample_period);
        self.setpoint - now.force.controlled
    }

    /// eq. 1 with eq. 16: v = v_t + v_n + v_p + v_v.
    fn follow(&mut self, p: &Parameters, reading: &Reading, now: &Measurement) -> VelocityParts {
        let error = self.force_error(p, reading, now);
        self.feed = next_feed(p, self.feed, reading.feed_override, now.frame.feed_max);
        if self.k == 0 {
            self.normal.restart_sweep(p);
        }
        self.k = self.k.wrapping_add(1).max(1);
        let (force, position, touching) = (now.force.normal, reading.position, touching(p, now));
        self.sliding.update(p, &position, now, touching);
        let contact = NormalMeasurement { error, force, position, touching };
        let (feed, sweep) = (self.feed, self.sliding.swept(p, self.feed));
        let at = PathState { path: &self.path, path_position: self.path_position, frame: &now.frame, feed, sweep };
        let normal = self.normal.step(p, &contact, self.k, &at);
        let (factor, sideways) = stick_slip::motion(&p.stick_slip, self.k, &now.frame);
        let parts = VelocityParts {
            normal: self.towards(p, now, normal),
            // eq. 2
            tangential: feed * now.frame.ratio,
            position: self.feedback.step(p, &now.offset, &now.frame.normal),
            // eq. 16
            stick_slip: factor * sweep,
            sideways,
        };
        if self.sliding.restarts(p, self.k) {
            self.k = 0;
        }
        self.distance = feed * p.sample_period;
        self.path_position = self.path.seek(self.path_position, self.path_position.s + self.distance);
        parts
    }
}

/// There is a force to speak of.
fn touching(p: &Parameters, now: &Measurement) -> bool {
    now.force.controlled >= p.limits.lost_force
}

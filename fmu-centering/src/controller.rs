//! One control step: measure, estimate spindle and ring, decide, move, report.

mod entering;
mod watching;

use control_blocks::{Consecutive, ParameterError, Progress, WaitingRequest, export_commission};
use serde::{Deserialize, Serialize};

use crate::center::{Center, Estimate};
use crate::check::check;
use crate::commission::Identification;
use crate::faults::{Supervisor, cause, evaluate, line_moved};
use crate::interface::{Fault, Input, MonitorReport, Output, Parameters, PushReport, Setpoint, State};
use crate::law::{ActiveLaw, Decision, Observation};
use crate::machine::{Events, next};
use crate::monitoring::{DriveMonitor, EarlyContact, FrozenProbe, Numbers, ProbeTrial};
use crate::motion::{Follower, Motion, Table};
use crate::sensing::{Calm, Clock, Due, ProbeDelay, Reader, Reading, Sample, Servo, ServoEstimator, Spindle};

/// Time without motion after which a slide without drive is at rest, s.
const STILL_TIME: f64 = 0.1;

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    reader: Reader,
    clock: Clock,
    spindle: Spindle,
    follower: Follower,
    frozen: FrozenProbe,
    early_contact: EarlyContact,
    drive: DriveMonitor,
    /// of the approach, and its result at the end
    servo_estimator: ServoEstimator,
    servo: Option<Servo>,
    probe_delay: ProbeDelay,
    trial: ProbeTrial,
    progress: Progress,
    law: ActiveLaw,
    supervisor: Supervisor,
    motion: Motion,
    table: Table,
    state: State,
    fault: Fault,
    /// the last good sample, and without single spikes
    sample: Sample,
    calm: Calm,
    /// intended distance of the setpoint beyond the ring, since the last push, m
    ahead: f64,
    /// consecutive samples within the band of settling
    settled: Consecutive,
    estimate: Option<Estimate>,
    /// eccentricity of the first model, m
    first: Option<f64>,
    /// the most certain model so far
    best: Option<Estimate>,
    /// motion of the line of a centered ring and its limit (m), where it exceeds the limit
    line: Option<[f64; 2]>,
    /// ring position before the last push, until the model after it
    before: Option<Center>,
    report: PushReport,
    started: f64,
    centered: Option<f64>,
    identification: Identification,
    /// an edge of `commission` waits for a slide at rest
    commission_request: WaitingRequest,
    long_step: bool,
}

impl Controller {
    /// Controller before its first sample.
    ///
    /// # Errors
    /// When a parameter does not fit the others.
    pub fn new(p: &Parameters) -> Result<Self, ParameterError> {
        check(p)?;
        Ok(Self {
            reader: Reader::default(),
            clock: Clock::default(),
            spindle: Spindle::new(p),
            follower: Follower::default(),
            frozen: FrozenProbe::default(),
            early_contact: EarlyContact::default(),
            drive: DriveMonitor::default(),
            servo_estimator: ServoEstimator::default(),
            servo: None,
            probe_delay: ProbeDelay::default(),
            trial: ProbeTrial::default(),
            progress: Progress::default(),
            law: ActiveLaw::new(p),
            supervisor: Supervisor::default(),
            motion: Motion::default(),
            table: Table::default(),
            state: State::Idle,
            fault: Fault::None,
            sample: Sample::default(),
            calm: Calm::default(),
            ahead: 0.0,
            settled: Consecutive::default(),
            estimate: None,
            first: None,
            best: None,
            line: None,
            before: None,
            report: PushReport::START,
            started: 0.0,
            centered: None,
            identification: Identification::new(p),
            commission_request: WaitingRequest::default(),
            long_step: false,
        })
    }

    /// The next samples have the inputs of one communication step that is too long.
    pub fn begin_long_step(&mut self) {
        self.long_step = true;
    }

    /// Puts the result of a commissioning run into the parameters if `commission.apply` is set; called before each sample.
    pub fn bring_into_force(&self, p: &mut Parameters) {
        self.identification.put(p);
    }

    /// Writes the parameters derived by the last good run to the file `commission.export`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn export(&self, p: &Parameters) -> Result<(), ParameterError> {
        export_commission(&p.commission.export, &self.identification.derived())
    }

    /// Whether there is a good commissioning run.
    pub fn commissioned(&self) -> bool {
        self.identification.measured.valid
    }

    /// One sample. The parameters must be those of [`Controller::new`] with [`Controller::bring_into_force`].
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        let reading = self.reader.read(p, input, self.freedom(p));
        let due = self.clock.advance(p);
        let rotation = self.observe(p, &reading, due);
        self.decide(p, &reading, due, rotation);
        self.long_step = false;
        self.move_on(p, due);
        *output = self.report(p);
    }

    /// Updates spindle, surface and model; the rotation (rad) since the last sample.
    fn observe(&mut self, p: &Parameters, reading: &Reading, due: Due) -> f64 {
        if let Some(slide) = reading.slide {
            self.motion.reseat(slide, reading.jumped && self.state == State::Idle);
        }
        let Some(sample) = reading.sample else { return 0.0 };
        (self.sample, self.calm) = (sample, reading.calm);
        if self.watched(p) {
            self.drive.update(p, &self.motion.setpoint, self.ahead, sample.slide);
            if matches!(self.state, State::Approach | State::Follow) {
                let delay = f64::from(p.io_delay);
                self.servo_estimator.update(p.sample_period, delay, &self.motion.setpoint, sample.slide);
            }
        } else {
            self.drive = DriveMonitor::default();
        }
        if self.state == State::Commission {
            self.identification.observe(p, &mut self.motion, sample.slide, reading.slide.is_none());
        }
        if reading.jumped {
            self.spindle.restart();
        }
        let rotation = self.spindle.update(sample.angle);
        if due.control {
            self.follower.update(p, &self.calm);
        }
        // a bridged sample is no measurement
        if reading.fresh {
            let now = self.observation(p, due);
            self.law.observe(p, &now);
        }
        self.probe_delay.update(p, rotation, &sample, reading.fresh);
        rotation
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, reading: &Reading, due: Due, rotation: f64) {
        let mut events = Events {
            enabled: reading.enabled,
            start: reading.start,
            reset: reading.reset,
            at_rest: self.motion.resting(p) && (self.driven() || self.drive.still() > p.ticks(STILL_TIME)),
            fault: self.find_fault(p, reading, rotation),
            touched: self.calm.probe > p.probe.contact,
            settled: self.settle(p),
            collected: self.law.collected(),
            stroke_over: self.state == State::Push && self.law.stroke_over(p, &self.motion),
            commission: self.commission_request.update(
                self.state == State::Idle,
                reading.begin_commission,
                reading.commission,
            ),
            abort: !reading.commission || reading.start,
            commissioned: self.identification.finished,
            ..Events::default()
        };
        let now = self.observation(p, due);
        if events.fault.is_none() {
            self.conclude(p, &now, &mut events);
            self.confirm(p, &mut events);
            self.check_servo(p, &mut events);
        }
        events.fault = events.fault.map(|fault| cause(fault, self.probe_delay.late()));
        self.escalate(p, events.fault);
        let ready = self.state == State::Wait && matches!(events.decision, None | Some(Decision::Push));
        let ready = ready && self.table.steady(p);
        let launch = if ready { self.law.launch(p, &now) } else { None };
        events.launched = launch.is_some();
        let state = next(self.state, &events);
        if state != self.state {
            self.supervisor.enter(state);
            self.enter(p, state, &events, launch);
            self.law.enter(p, state, &now);
            self.state = state;
        }
    }

    /// Ends the retract after a push, and counts the time for which the probe has settled.
    fn settle(&mut self, p: &Parameters) -> bool {
        if self.state == State::Settle && self.motion.arrived(p, 0.0) {
            self.motion.release();
        }
        let (band, time) = p.settling();
        let inside = self.calm.probe >= p.probe.contact && (self.calm.probe - p.null()).abs() <= band;
        let following = matches!(self.state, State::Follow | State::Settle) && !self.motion.moving();
        let settles = inside && following;
        self.settled.update(settles) >= p.ticks(time) && settles
    }

    /// Fits the model, and evaluates the ring.
    fn conclude(&mut self, p: &Parameters, now: &Observation, events: &mut Events) {
        match self.law.conclude(p, now) {
            None => {}
            Some(Err(fault)) => events.fault = Some(fault),
            Some(Ok((ring, decision))) => {
                events.decision = Some(decision);
                if let Some(ring) = ring {
                    events.fault = self.note(p, &ring, decision);
                }
            }
        }
    }

    /// Stores a new estimate; its fault, if any.
    fn note(&mut self, p: &Parameters, ring: &Estimate, decision: Decision) -> Option<Fault> {
        self.estimate = Some(*ring);
        match decision {
            Decision::Measure => return None,
            Decision::Unresolved => return Some(Fault::Unresolved),
            Decision::Centered | Decision::Push => {}
        }
        if let Some(before) = self.before.take() {
            self.report.overshoot = ring.center.overshoot(&before);
            self.report.overshoot_max = self.report.overshoot_max.max(self.report.overshoot);
        }
        let best = *self.best.get_or_insert(*ring);
        if ring.sigma < best.sigma {
            self.best = Some(*ring);
        }
        let first = *self.first.get_or_insert(ring.center.eccentricity());
        self.line = line_moved(p, &best, ring);
        if self.line.is_some() {
            return Some(if self.frozen.tip_frozen() { Fault::ProbeFrozen } else { Fault::ProbeJump });
        }
        evaluate(p, self.spindle.speed(), self.report.count, first, ring)
    }

    /// Observations for the control law.
    fn observation(&self, p: &Parameters, due: Due) -> Observation {
        Observation {
            state: self.state,
            due,
            angle: self.spindle.angle(),
            speed: self.spindle.speed(),
            sample: self.sample,
            setpoint: self.motion.setpoint,
            bandwidth: self.bandwidth(p),
            late: self.probe_delay.late().is_some(),
        }
    }

    /// Moves the setpoint for one sample.
    fn move_on(&mut self, p: &Parameters, due: Due) {
        self.table.update(p, self.state.active(), self.spindle.speed());
        if !self.driven() {
            return self.motion.yield_to(self.sample.slide);
        }
        let now = self.observation(p, due);
        let press = if self.state == State::Push { self.law.press(p, &now) } else { None };
        match press {
            Some(setpoint) => self.motion.setpoint = setpoint,
            None => self.motion.step(p, self.target_velocity(p)),
        }
        self.ahead = match self.state {
            State::Push => self.law.ahead(),
            // the deflection by the ring recovers during the retract
            State::Settle | State::Fault | State::Idle => self.ahead,
            _ => 0.0,
        };
    }

    /// Velocity of the slide when it is not on a move, m/s.
    fn target_velocity(&self, p: &Parameters) -> f64 {
        match self.state {
            State::Approach => p.approach.velocity,
            State::Idle | State::Push | State::Confirm | State::Fault | State::Commission => 0.0,
            _ => self.follower.velocity(),
        }
    }

    fn report(&self, p: &Parameters) -> Output {
        let ring = self.estimate.as_ref();
        Output {
            slide: Setpoint {
                position_setpoint: self.motion.setpoint.position,
                velocity_setpoint: self.motion.setpoint.velocity,
            },
            spindle_speed_setpoint: self.table.setpoint(),
            state: self.state,
            fault: self.fault,
            drive_enable: self.driven(),
            centered: self.centered.is_some(),
            time_to_center: self.centered.map_or(0.0, |time| time - self.started),
            eccentricity: ring.map_or(0.0, |ring| ring.center.eccentricity()),
            eccentricity_angle: ring.map_or(0.0, |ring| ring.center.nearest()),
            eccentricity_std: ring.map_or(0.0, |ring| ring.sigma),
            spindle_speed: self.spindle.speed(),
            pusher_gap: p.probe.at_pusher - self.sample.probe,
            push: PushReport { offset: self.law.offset(), ..self.report },
            monitor: MonitorReport {
                following_error: self.drive.error(),
                drive_gain_ratio: self.drive.ratio(p),
                probe_gain_ratio: self.trial.ratio().unwrap_or(1.0),
                cycle_time: self.progress.samples() as f64 * p.sample_period,
            },
            measured: self.measured(),
            numbers: Numbers {
                following_limit: self.drive.allowed(),
                forward: self.supervisor.forward(),
                endless: self.supervisor.endless(),
                line: self.line,
                first: self.first.unwrap_or_default(),
                probe_delay: self.probe_delay.late().unwrap_or_default(),
                met: self.early_contact.met(p).unwrap_or_default(),
            },
        }
    }
}

#[cfg(test)]
mod tests;

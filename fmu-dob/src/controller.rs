//! One control step: measure, estimate, decide, plan, control, report.

mod evaluating;
mod transitions;

use control_blocks::{ParameterError, Reaction, RunningLine, WaitingRequest, export_commission, export_values, ticks};
use serde::{Deserialize, Serialize};

use crate::calibration::run::CalibrationRun;
use crate::check::check;
use crate::commission::identification::Identification;
use crate::commission::plan;
use crate::detection::contact::DetectedContact;
use crate::detection::detector::{Detector, Sample, samples};
use crate::detection::guard::ForceGuard;
use crate::detection::touch::{self, TwoStageTouch};
use crate::force::deviation::MovingDeviation;
use crate::force::notch::NotchCascade;
use crate::force::observer::DisturbanceObserver;
use crate::interface::{ContactSource, Fault, ForceOutput, Input, Output, Parameters, ReferenceOutput, State};
use crate::machine::{Events, next};
use crate::monitoring::drive::DriveResponse;
use crate::monitoring::monitors::Monitors;
use crate::monitoring::numbers::Numbers;
use crate::motion::reference::Motion;
use crate::motion::servo::{self, Amplifier, Integrator};
use crate::reading::{Reader, Reading};
use crate::spans::Spans;

/// The controller between two samples. Everything inside is in the frame where the workpiece is in
/// the positive direction; only [`Reader`] and the outputs know `approach.direction`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    /// samples since initialization
    samples: u64,
    spans: Spans,
    /// the communication step that begins is longer than a sample
    long_step: bool,
    reader: Reader,
    observer: DisturbanceObserver,
    /// samples since the position was found
    known: u32,
    notch: NotchCascade,
    deviation: MovingDeviation,
    slope: RunningLine,
    force: ForceOutput,
    detector: Detector,
    guard: ForceGuard,
    touch: TwoStageTouch,
    monitors: Monitors,
    identification: Identification,
    calibration: CalibrationRun,
    state: State,
    /// samples of the present state at constant speed
    ticks: u32,
    fault: Fault,
    /// a pending edge of `enable` waits for a stage at rest
    enable_pending: WaitingRequest,
    /// an edge of `commission` does
    commission_pending: WaitingRequest,
    /// an edge of `calibrate` does
    calibrate_pending: WaitingRequest,
    aborted: bool,
    /// the approach has not begun to move: the force at rest is taken first
    waiting: bool,
    contact: Option<DetectedContact>,
    motion: Motion,
    /// tracking error when the drive was switched off, m
    error_at_power_off: f64,
    numbers: Numbers,
    integrator: Integrator,
    amplifier: Amplifier,
}

impl Controller {
    /// Controller before its first sample.
    ///
    /// # Errors
    /// When a parameter does not fit the others.
    pub fn new(p: &Parameters) -> Result<Self, ParameterError> {
        check(p)?;
        Ok(Self {
            samples: 0,
            spans: Spans::new(p),
            long_step: false,
            reader: Reader::default(),
            observer: DisturbanceObserver::new(p),
            known: 0,
            notch: NotchCascade::new(p),
            deviation: MovingDeviation::new(samples(p.deviation_window, p.sample_period)),
            slope: RunningLine::zeroed(samples(p.slope_window, p.sample_period)),
            force: ForceOutput::START,
            detector: Detector::new(p),
            guard: ForceGuard::default(),
            touch: TwoStageTouch::default(),
            monitors: Monitors::new(p),
            identification: Identification::new(p),
            calibration: CalibrationRun::new(p),
            state: State::Idle,
            ticks: 0,
            fault: Fault::None,
            enable_pending: WaitingRequest::default(),
            commission_pending: WaitingRequest::default(),
            calibrate_pending: WaitingRequest::default(),
            aborted: false,
            waiting: false,
            contact: None,
            motion: Motion::new(p),
            error_at_power_off: 0.0,
            numbers: Numbers::START,
            integrator: Integrator::default(),
            amplifier: Amplifier::new(p),
        })
    }

    /// The next samples have the inputs of one communication step that is too long.
    pub fn begin_long_step(&mut self) {
        self.long_step = true;
    }

    /// Puts the active values of the commissioning run into the parameters; call it before each sample.
    pub fn bring_into_force(&mut self, p: &mut Parameters) {
        self.identification.put(p);
    }

    /// Writes the derived parameters of the last successful commissioning run into the file `commission.export`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn export(&self, p: &Parameters) -> Result<(), ParameterError> {
        export_commission(&p.commission.export, &self.identification.derived())
    }

    /// Writes the bias of the last successful calibration cycle into the file `calibration.export`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn export_bias(&self, p: &Parameters) -> Result<(), ParameterError> {
        export_values("calibration.export", &p.calibration.export, &self.calibration.derived())
    }

    /// One sample. The parameters must be those of [`Controller::new`] with [`Controller::bring_into_force`], except
    /// the tunable ones, which are sampled when an approach starts and at a contact.
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        if self.identification.take_renewed() {
            self.renew(p);
        }
        let expected = self.expect(p);
        let reading = self.reader.read(p, input, &expected);
        self.estimate(p, &reading);
        self.watch(p, &reading);
        self.decide(p, &reading);
        self.follow(p, &reading);
        let current = self.act(p, &reading);
        if self.state == State::Commission {
            self.identification.observe(p, reading.position, current, &self.force, &self.motion.reference);
        }
        self.report(p, &reading, current, output);
        self.samples += 1;
        self.long_step = false;
    }

    /// Other values are active: converts the estimates, for the same motion and current.
    fn renew(&mut self, p: &Parameters) {
        let ratio = p.stage.force_constant / self.observer.force_constant();
        self.observer = self.observer.renewed(p);
        self.integrator.scale(ratio);
        self.identification.rescale(ratio);
        self.monitors.drive = DriveResponse::new(p);
        self.detector.renew(p);
    }

    /// Whether the drive is off, by a fault.
    fn off(&self) -> bool {
        self.state == State::Fault && self.fault.reaction() == Reaction::DriveOff
    }

    /// Whether the position has been there for long enough to know the velocity.
    fn tracked(&self) -> bool {
        self.known >= self.spans.tracked
    }

    /// Whether the stage has come to rest as the reference has, so long that it has no effect on the observer; always
    /// true without a drive.
    fn has_come_to_rest(&self) -> bool {
        self.off() || self.monitors.rest.lasts(self.spans.forgotten)
    }

    /// Disturbance observer, notches, deviation, slope, detector; a lost position is bridged by the nominal stage.
    fn estimate(&mut self, p: &Parameters, reading: &Reading) {
        let acted = self.amplifier.acted(p);
        self.calibration.sense(p, &self.identification.measured, reading.position, acted, self.contact.is_some());
        if let Some(position) = reading.position {
            self.known = self.known.saturating_add(1);
            if reading.found {
                self.known = 0;
                self.motion.reseat(position, 0.0);
                self.observer.reseat(position, 0.0);
            }
            self.observer.update(position, acted);
            let disturbance = self.observer.force();
            let notched = self.notch.update(disturbance, reading.spindle_speed);
            let deviation = self.deviation.update(notched);
            self.slope.update(deviation);
            let slope = self.slope.slope(p.sample_period);
            self.force = ForceOutput { disturbance, notched, deviation, slope };
        } else {
            self.observer.coast(acted);
        }
        self.monitors.drive.update(p.stage.force_constant * acted, self.observer.force(), reading.whole > 0);
        let ForceOutput { slope, .. } = self.force;
        let Reading { position, spindle_speed, .. } = *reading;
        self.detector.update(&Sample { position, acted, spindle_speed, slope });
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, reading: &Reading) {
        let elapsed = self.count(p, reading);
        let settled = self.motion.retreated(p) && self.monitors.relief.known(p);
        let waits = self.state.waits();
        if (!reading.calibrate || reading.begin) && self.calibration.abort() && !self.state.approaching() {
            self.depart_farther(p);
        }
        let contact = reading.position.and_then(|_| self.find_contact(p, reading));
        let (suspected, dismissed) = self.doubt(p, reading);
        let events = Events {
            begin: self.enable_pending.update(waits, reading.begin, reading.enabled),
            commission: self.commission_pending.update(waits, reading.begin_commission, reading.commission),
            calibrate: self.calibrate_pending.update(waits, reading.begin_calibration, reading.calibrate),
            calibration: self.calibration.active,
            calibrated: self.calibration.over(),
            abort: !reading.commission || reading.begin,
            commissioned: self.identification.finished,
            enabled: if self.calibration.active { !self.calibration.aborted() } else { reading.enabled },
            reset: reading.reset,
            restful: reading.position.is_some() && self.tracked() && self.motion.at_rest() && self.has_come_to_rest(),
            fault: self.find_fault(p, elapsed, settled, reading),
            contact,
            suspected,
            dismissed,
            elapsed,
            reversed: self.motion.reference.velocity <= 0.0,
            retreated: match self.state {
                State::Retract => settled,
                State::Calibrate => self.motion.retreated(p) && self.calibration.rested(),
                _ => self.motion.retreated(p),
            },
        };
        let state = next(self.state, &events);
        if state != self.state {
            self.enter(p, state, &events, reading);
            (self.state, self.ticks) = (state, 0);
        } else if let (State::Fault, Some(higher)) = (state, events.fault)
            && higher.reaction() > self.fault.reaction()
        {
            self.stop(p, higher, reading);
        }
    }

    /// Counts the samples at constant speed and learns from them; true when the state has had enough.
    fn count(&mut self, p: &Parameters, reading: &Reading) -> bool {
        if self.state == State::Approach && self.waiting && reading.position.is_some() {
            self.waiting = !self.guard.tare(p, self.force.notched);
            self.monitors.drive.begin();
        }
        if reading.position.is_none() || !self.motion.cruising() {
            return false;
        }
        self.ticks = self.ticks.saturating_add(1);
        match self.state {
            State::Approach => {
                let enough = ticks(p.learn.settle_time, p.sample_period);
                // the guard compares with the second half of settling
                if self.ticks > enough / 2 {
                    self.guard.settle(self.force.notched);
                }
                self.ticks >= enough
            }
            State::Learn => {
                self.detector.learn();
                let enough = self.ticks >= ticks(p.learn.time, p.sample_period) && self.detector.ready();
                if enough {
                    self.detector.arm(p);
                }
                enough
            }
            State::Confirm => {
                if self.ticks == ticks(touch::SETTLE_TIME, p.sample_period) {
                    self.detector.clear();
                }
                false
            }
            _ => false,
        }
    }

    /// Moves the reference; with the drive off it follows the stage.
    fn follow(&mut self, p: &Parameters, reading: &Reading) {
        let cruised = self.motion.reference.acceleration == 0.0 && !self.motion.at_rest();
        match reading.position {
            Some(position) if self.off() => self.motion.rest_at(position),
            _ if self.state == State::Commission => {
                let next = self.identification.experiment.reference(&self.motion.reference, p.sample_period);
                self.motion.follow(next);
            }
            position => self.motion.step(p, self.state, position.is_some(), self.waiting),
        }
        // the drive is evaluated by its last deceleration, far from the workpiece
        if self.state == State::Retract && cruised && self.motion.reference.acceleration != 0.0 {
            self.monitors.drive.begin();
        }
    }

    /// Servo: acceleration, force, current; nothing while the drive is off. While a lost position is bridged there is
    /// no feedback: feed-forward, and the last disturbance or integral, which is held, because it carries the weight.
    fn act(&mut self, p: &Parameters, reading: &Reading) -> f64 {
        if self.off() {
            return self.amplifier.send(0.0);
        }
        let reference = self.motion.reference;
        let exciting = self.state == State::Commission && self.identification.experiment.exciting();
        let servo = if exciting { &self.identification.experiment.plan.servo } else { &p.servo };
        let mut acceleration = reference.acceleration;
        if let Some(position) = reading.position {
            acceleration = servo::acceleration(servo, &reference, position, self.observer.velocity());
        }
        let mut force = p.stage.mass * acceleration;
        if exciting {
            // no model but the force that holds the stage
            let maximum = plan::force(p);
            force = self.identification.held() + force.clamp(-maximum, maximum);
        } else if p.servo.disturbance_compensation {
            force += self.observer.force();
        } else {
            let error = reading.position.map_or(0.0, |z| reference.position - z);
            let limited = self.amplifier.limited() > 0;
            force += p.stage.mass * self.integrator.update(p, error, limited);
        }
        self.amplifier.send(force / p.stage.force_constant)
    }

    fn report(&self, p: &Parameters, reading: &Reading, current: f64, output: &mut Output) {
        let direction = p.direction();
        let reference = self.motion.reference;
        let error = reading.position.map_or(0.0, |z| reference.position - z);
        let error = if self.off() { self.error_at_power_off } else { error };
        let contact = self.contact.as_ref();
        *output = Output {
            current: direction * current,
            state: self.state,
            fault: self.fault,
            drive_enable: !self.off(),
            aborted: self.aborted,
            contact: contact.is_some(),
            contact_source: contact.map_or(ContactSource::None, |c| c.source),
            contact_position: contact.map_or(0.0, |c| direction * c.position),
            contact_position_estimate: contact.map_or(0.0, |c| direction * c.estimate()),
            contact_position_std: contact.map_or(0.0, |c| c.deviation),
            contact_time: contact.map_or(0.0, |c| c.time),
            force: self.force,
            threshold: self.detector.learned(),
            reference: ReferenceOutput {
                position: direction * reference.position,
                velocity: direction * reference.velocity,
            },
            tracking_error: direction * error,
            measured: self.identification.measured,
            calibrated: self.calibration.calibrated,
            drive_gain_ratio: self.monitors.drive.ratio().unwrap_or(1.0),
            numbers: self.numbers,
        };
    }
}

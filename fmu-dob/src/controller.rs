//! One sample of the whole law: read, estimate, decide, move, act, report.

use control_blocks::ParameterError;
use serde::{Deserialize, Serialize};

use crate::check::check;
use crate::contact::Touch;
use crate::detector::{Detector, Sample};
use crate::deviation::MovingDeviation;
use crate::guard::ForceGuard;
use crate::machine::{ContactSource, Events, Fault, State, next};
use crate::motion::Motion;
use crate::notch::NotchCascade;
use crate::observer::DisturbanceObserver;
use crate::parameters::Parameters;
use crate::reading::{Reader, Reading};
use crate::servo::{self, Amplifier, Integrator};
use crate::signals::{Force, Input, Output, Reference};
use crate::slope::RunningSlope;

/// The controller between two samples. Everything inside is in the frame where the workpiece is in
/// the positive direction; only [`Reader`] and the outputs know `approach.direction`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    reader: Reader,
    observer: DisturbanceObserver,
    notch: NotchCascade,
    deviation: MovingDeviation,
    slope: RunningSlope,
    force: Force,
    detector: Detector,
    guard: ForceGuard,
    state: State,
    /// samples of the present state at constant speed
    ticks: u32,
    fault: Fault,
    aborted: bool,
    touch: Option<Touch>,
    motion: Motion,
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
            reader: Reader::default(),
            observer: DisturbanceObserver::new(p),
            notch: NotchCascade::new(p),
            deviation: MovingDeviation::new(p.deviation.window as usize),
            slope: RunningSlope::new(p.slope.window as usize, p.sample_period),
            force: Force::ZERO,
            detector: Detector::new(p),
            guard: ForceGuard::default(),
            state: State::Idle,
            ticks: 0,
            fault: Fault::None,
            aborted: false,
            touch: None,
            motion: Motion::new(p),
            integrator: Integrator::default(),
            amplifier: Amplifier::new(p),
        })
    }

    /// One sample at `time` s. The parameters must be those of [`Controller::new`], but for the tunable
    /// ones, which count at the moment of `start` and of a contact.
    pub fn tick(&mut self, p: &Parameters, time: f64, input: &Input) -> Output {
        let reading = self.reader.read(p.direction(), input);
        self.estimate(p, &reading);
        self.decide(p, time, input.abort, &reading);
        self.motion.step(p, self.state, reading.position.is_some());
        let current = self.act(p, &reading);
        self.report(p, &reading, current)
    }

    /// Disturbance observer, notches, deviation, slope, detector; a lost position is bridged by coasting.
    fn estimate(&mut self, p: &Parameters, reading: &Reading) {
        let acted = self.amplifier.acted();
        if let Some(position) = reading.position {
            if reading.found {
                self.motion.reseat(position, 0.0);
                self.observer.reseat(position, 0.0);
            }
            self.observer.update(position, acted);
            let disturbance = self.observer.force();
            let notched = self.notch.update(disturbance, reading.spindle_speed);
            let deviation = self.deviation.update(notched);
            let slope = self.slope.update(deviation);
            self.force = Force { disturbance, notched, deviation, slope };
        } else {
            self.observer.coast(p.sample_period);
        }
        self.detector.update(&Sample {
            position: reading.position,
            acted,
            spindle_speed: reading.spindle_speed,
            notched: self.force.notched,
            deviation: self.force.deviation,
            slope: self.force.slope,
        });
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, time: f64, abort: bool, reading: &Reading) {
        let elapsed = self.count(p, reading);
        let events = Events {
            start: reading.start,
            abort,
            restful: reading.position.is_some() && self.motion.at_rest(),
            fault: self.find_fault(p, elapsed, reading),
            contact: reading.position.and_then(|_| self.find_contact(p)),
            elapsed,
            turned: self.motion.reference.velocity <= 0.0,
            retreated: self.motion.retreated(p),
        };
        self.aborted |= abort && (self.state.approaching() || matches!(self.state, State::Contact | State::Retract));
        let state = next(self.state, &events);
        if state != self.state {
            self.enter(p, state, &events, reading, time);
            (self.state, self.ticks) = (state, 0);
        }
    }

    /// Counts the samples at constant speed and learns from them; true when the state has had enough.
    fn count(&mut self, p: &Parameters, reading: &Reading) -> bool {
        if reading.position.is_none() || !self.motion.cruising() {
            return false;
        }
        self.ticks = self.ticks.saturating_add(1);
        match self.state {
            State::Approach => {
                let enough = p.ticks(p.learn.settle_time);
                // the guard compares with the second half of settling
                if self.ticks > enough / 2 {
                    self.guard.settle(self.force.notched);
                }
                self.ticks >= enough
            }
            State::Learn => {
                self.detector.learn();
                let enough = self.ticks >= p.ticks(p.learn.time) && self.detector.ready();
                if enough {
                    self.detector.arm(p);
                }
                enough
            }
            _ => false,
        }
    }

    /// The gravest fault of this sample.
    fn find_fault(&self, p: &Parameters, elapsed: bool, reading: &Reading) -> Option<Fault> {
        let saturated = self.amplifier.saturated().then_some(Fault::Saturation);
        let travelled = self.state.approaching() && self.motion.beyond_travel(p);
        let rejected =
            self.state == State::Learn && elapsed && !self.detector.learned().believable(p.learn.slope_sigma_max);
        reading
            .fault
            .or(saturated)
            .or(travelled.then_some(Fault::TravelLimit))
            .or(rejected.then_some(Fault::LearnRejected))
    }

    /// Contact by the armed detector or by the guard.
    fn find_contact(&mut self, p: &Parameters) -> Option<ContactSource> {
        let guarded = match self.state {
            State::Approach => {
                let steady = self.motion.cruising() && self.deviation.full();
                steady && self.force.deviation > p.guard.force
            }
            State::Learn | State::Detect => self.guard.exceeded(&p.guard, self.force.notched),
            _ => return None,
        };
        if self.state == State::Detect && self.detector.test(p) {
            Some(self.detector.source())
        } else {
            guarded.then_some(ContactSource::ForceGuard)
        }
    }

    /// What happens once, when `state` begins.
    fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading, time: f64) {
        match (state, reading.position) {
            (State::Approach, Some(position)) => self.restart(p, position),
            (State::Contact, Some(position)) => {
                self.motion.depart(p);
                self.touch = events.contact.map(|source| Touch { source, position, bias: p.contact.bias, time });
            }
            (State::Fault, _) => self.fail(p, events, reading),
            (State::Retract, _) if self.state.approaching() => self.motion.depart(p),
            _ => {}
        }
    }

    /// Forgets the last approach and begins a new one at rest at `position` m.
    fn restart(&mut self, p: &Parameters, position: f64) {
        self.motion.start(position, &p.approach);
        self.deviation.clear();
        self.detector.reset(position);
        self.guard = ForceGuard::default();
        (self.fault, self.aborted, self.touch) = (Fault::None, false, None);
    }

    /// Names the fault; retreats if the stage was approaching, and does not press on after a saturation.
    fn fail(&mut self, p: &Parameters, events: &Events, reading: &Reading) {
        if let Some(fault) = events.fault {
            self.fault = fault;
        }
        if let (Fault::Saturation, Some(position)) = (self.fault, reading.position) {
            self.motion.reseat(position, self.observer.velocity());
        }
        if self.state.approaching() {
            self.motion.depart(p);
        }
    }

    /// Servo: acceleration, force, current; feed-forward alone while the position is lost.
    fn act(&mut self, p: &Parameters, reading: &Reading) -> f64 {
        let reference = self.motion.reference;
        let mut acceleration = reference.acceleration;
        if let Some(position) = reading.position {
            acceleration = servo::acceleration(p, &reference, position, self.observer.velocity());
        }
        let mut force = p.stage.mass * acceleration;
        if p.servo.disturbance_compensation {
            force += self.observer.force();
        } else {
            let error = reading.position.map_or(0.0, |z| reference.position - z);
            let limited = self.amplifier.limited();
            force += p.stage.mass * self.integrator.update(p, error, limited);
        }
        self.amplifier.tell(p, force / p.stage.force_constant)
    }

    fn report(&self, p: &Parameters, reading: &Reading, current: f64) -> Output {
        let direction = p.direction();
        let reference = self.motion.reference;
        let error = reading.position.map_or(0.0, |z| reference.position - z);
        let touch = self.touch.as_ref();
        Output {
            current: direction * current,
            state: self.state,
            fault: self.fault,
            aborted: self.aborted,
            contact: touch.is_some(),
            contact_source: touch.map_or(ContactSource::None, |t| t.source),
            contact_position: touch.map_or(0.0, |t| direction * t.position),
            contact_position_estimate: touch.map_or(0.0, |t| direction * t.estimate()),
            contact_time: touch.map_or(0.0, |t| t.time),
            force: self.force,
            threshold: self.detector.learned(),
            reference: Reference { position: direction * reference.position, velocity: direction * reference.velocity },
            tracking_error: direction * error,
        }
    }
}

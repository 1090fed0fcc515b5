//! One sample of the whole law: read, estimate, decide, move, act, report.

use control_blocks::{ParameterError, RunningLine, ticks};
use serde::{Deserialize, Serialize};

use crate::check::check;
use crate::detection::contact::DetectedContact;
use crate::detection::detector::{Detector, Sample};
use crate::detection::guard::ForceGuard;
use crate::faults::{self, Symptoms};
use crate::force::deviation::MovingDeviation;
use crate::force::notch::NotchCascade;
use crate::force::observer::DisturbanceObserver;
use crate::interface::{ContactSource, Fault, ForceOutput, Input, Output, Parameters, ReferenceOutput, State};
use crate::machine::{Events, next};
use crate::motion::reference::Motion;
use crate::motion::servo::{self, Amplifier, Integrator};
use crate::reading::{Reader, Reading};

/// The controller between two samples. Everything inside is in the frame where the workpiece is in
/// the positive direction; only [`Reader`] and the outputs know `approach.direction`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    /// samples since the initialisation
    samples: u64,
    reader: Reader,
    observer: DisturbanceObserver,
    notch: NotchCascade,
    deviation: MovingDeviation,
    slope: RunningLine,
    force: ForceOutput,
    detector: Detector,
    guard: ForceGuard,
    state: State,
    /// samples of the present state at constant speed
    ticks: u32,
    fault: Fault,
    aborted: bool,
    contact: Option<DetectedContact>,
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
            samples: 0,
            reader: Reader::default(),
            observer: DisturbanceObserver::new(p),
            notch: NotchCascade::new(p),
            deviation: MovingDeviation::new(p.deviation_window as usize),
            slope: RunningLine::zeroed(p.slope_window as usize),
            force: ForceOutput::START,
            detector: Detector::new(p),
            guard: ForceGuard::default(),
            state: State::Idle,
            ticks: 0,
            fault: Fault::None,
            aborted: false,
            contact: None,
            motion: Motion::new(p),
            integrator: Integrator::default(),
            amplifier: Amplifier::default(),
        })
    }

    /// One sample. The parameters must be those of [`Controller::new`], but for the tunable ones, which count at the
    /// moment when an approach begins and of a contact.
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        let reading = self.reader.read(p, input);
        self.estimate(p, &reading);
        self.decide(p, &reading);
        self.motion.step(p, self.state, reading.position.is_some());
        let current = self.act(p, &reading);
        self.report(p, &reading, current, output);
        self.samples += 1;
    }

    /// Disturbance observer, notches, deviation, slope, detector; a lost position is bridged by coasting.
    fn estimate(&mut self, p: &Parameters, reading: &Reading) {
        let acted = self.amplifier.acted(p);
        if let Some(position) = reading.position {
            if reading.found {
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
            self.observer.coast(p.sample_period);
        }
        let ForceOutput { notched, deviation, slope, .. } = self.force;
        let Reading { position, spindle_speed, .. } = *reading;
        self.detector.update(p, &Sample { position, acted, spindle_speed, notched, deviation, slope });
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, reading: &Reading) {
        let elapsed = self.count(p, reading);
        let events = Events {
            begin: reading.begin,
            enabled: reading.enabled,
            reset: reading.reset,
            restful: reading.position.is_some() && self.motion.at_rest(),
            fault: self.find_fault(p, elapsed, reading),
            contact: reading.position.and_then(|_| self.find_contact(p)),
            elapsed,
            turned: self.motion.reference.velocity <= 0.0,
            retreated: self.motion.retreated(p),
        };
        let state = next(self.state, &events);
        if state != self.state {
            self.enter(p, state, &events, reading);
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
            _ => false,
        }
    }

    /// The gravest fault of this sample.
    fn find_fault(&self, p: &Parameters, elapsed: bool, reading: &Reading) -> Option<Fault> {
        let symptoms = Symptoms {
            reading,
            limited: self.amplifier.limited(),
            travelled: self.state.approaching() && self.motion.beyond_travel(p),
            learned: (self.state == State::Learn && elapsed).then(|| self.detector.learned()),
        };
        faults::find(p, &symptoms)
    }

    /// Contact by the armed detector or by the guard.
    fn find_contact(&mut self, p: &Parameters) -> Option<ContactSource> {
        let guarded = match self.state {
            State::Approach => {
                let steady = self.motion.cruising() && self.deviation.full();
                steady && self.force.deviation > p.guard_force
            }
            State::Learn | State::Detect => self.guard.exceeded(p.guard_force, self.force.notched),
            _ => return None,
        };
        if self.state == State::Detect && self.detector.test(p) {
            Some(self.detector.source())
        } else {
            guarded.then_some(ContactSource::ForceGuard)
        }
    }

    /// What happens once, when `state` begins.
    fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading) {
        match (state, reading.position) {
            (State::Approach, Some(position)) => self.restart(p, position),
            (State::Contact, Some(position)) => {
                self.motion.depart(p);
                let time = self.samples as f64 * p.sample_period;
                self.contact =
                    events.contact.map(|source| DetectedContact { source, position, bias: p.contact_bias, time });
            }
            (State::Fault, _) => self.fail(p, events, reading),
            (State::Retract, _) if self.state.approaching() => {
                self.motion.depart(p);
                self.aborted = true;
            }
            (State::Idle, _) => self.fault = Fault::None,
            _ => {}
        }
    }

    /// Forgets the last approach and begins a new one at rest at `position` m.
    fn restart(&mut self, p: &Parameters, position: f64) {
        self.motion.start(position, &p.approach);
        self.deviation.clear();
        self.detector.reset(position);
        self.guard = ForceGuard::default();
        (self.aborted, self.contact) = (false, None);
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
            let limited = self.amplifier.limited() > 0;
            force += p.stage.mass * self.integrator.update(p, error, limited);
        }
        self.amplifier.send(p, force / p.stage.force_constant)
    }

    fn report(&self, p: &Parameters, reading: &Reading, current: f64, output: &mut Output) {
        let direction = p.direction();
        let reference = self.motion.reference;
        let error = reading.position.map_or(0.0, |z| reference.position - z);
        let contact = self.contact.as_ref();
        *output = Output {
            current: direction * current,
            state: self.state,
            fault: self.fault,
            aborted: self.aborted,
            contact: contact.is_some(),
            contact_source: contact.map_or(ContactSource::None, |c| c.source),
            contact_position: contact.map_or(0.0, |c| direction * c.position),
            contact_position_estimate: contact.map_or(0.0, |c| direction * c.estimate()),
            contact_time: contact.map_or(0.0, |c| c.time),
            force: self.force,
            threshold: self.detector.learned(),
            reference: ReferenceOutput {
                position: direction * reference.position,
                velocity: direction * reference.velocity,
            },
            tracking_error: direction * error,
        };
    }
}

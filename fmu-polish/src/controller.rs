//! One sample of the whole law: read, measure, decide, move, report.

use control_blocks::ParameterError;
use serde::{Deserialize, Serialize};

use crate::check::check;
use crate::cl_file::Point;
use crate::feed::Feed;
use crate::force::{Gauge, SetPoint};
use crate::machine::{Events, Fault, State, next};
use crate::motion::Parts;
use crate::parameters::Parameters;
use crate::path::{Path, Place};
use crate::position::Feedback;
use crate::press::{Contact, Press, Way};
use crate::pulses::Remainder;
use crate::reading::{Reader, Reading};
use crate::signals::{Error, Force, Input, Misalignment, Output, Ripple, Stiffness};
use crate::stick_slip;
use crate::watch::{Sight, Watch};

/// Time after the touch in which force and way do not belong together, s.
const TOUCH_TIME: f64 = 0.02;

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    path: Path,
    reader: Reader,
    gauge: Gauge,
    state: State,
    fault: Fault,
    /// samples since the state began
    ticks: u32,
    /// the zero of the sensor is being taken
    taring: bool,
    /// in the fault state: stands still
    halted: bool,
    /// way of approach or retract, m
    travelled: f64,
    watch: Watch,
    place: Place,
    feed: Feed,
    set_point: SetPoint,
    press: Press,
    feedback: Feedback,
    /// samples of stick-slip
    k: u32,
    remainder: Remainder,
}

impl Controller {
    /// Controller before its first sample, for the checked points of a path.
    ///
    /// # Errors
    /// When a parameter does not fit the others.
    pub fn new(p: &Parameters, points: &[Point]) -> Result<Self, ParameterError> {
        check(p)?;
        Ok(Self {
            path: Path::new(p, points),
            reader: Reader::new(),
            gauge: Gauge::new(),
            state: State::Idle,
            fault: Fault::None,
            ticks: 0,
            taring: false,
            halted: false,
            travelled: 0.0,
            watch: Watch::new(),
            place: Place::default(),
            feed: Feed::default(),
            set_point: SetPoint::default(),
            press: Press::new(p),
            feedback: Feedback::new(),
            k: 0,
            remainder: Remainder::new(),
        })
    }

    /// The path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// One sample; parameters that are not tunable must be those of [`Controller::new`].
    pub fn tick(&mut self, p: &Parameters, input: &Input, output: &mut Output) {
        let reading = self.reader.read(input);
        let now = self.measure(p, &reading);
        self.decide(p, &reading, &now);
        let parts = self.act(p, &reading, &now);
        let velocity = parts.sum(&now.frame, p.limits.velocity);
        output.pulses = self.remainder.step(p, &velocity).into();
        output.velocity = parts.report(&velocity);
        self.report(&now, output);
    }

    fn measure(&mut self, p: &Parameters, reading: &Reading) -> Sight {
        let frame = self.path.frame(self.place);
        let force = self.gauge.measure(p, &reading.force, &frame.normal);
        let offset = frame.centre - reading.position;
        let error = Error::along(&offset, &frame);
        let surface = force.normal / self.press.stiffness - error.normal;
        let force_error = self.set_point.force - force.controlled;
        Sight { frame, force, force_error, offset, error, surface, ticks: self.ticks, travelled: self.travelled }
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, reading: &Reading, now: &Sight) {
        let steady = self.set_point.force >= p.force.target * reading.force_override;
        self.watch.update(p, self.state, now, steady);
        let (ready, refused) = self.prepare(p, reading, now);
        let events = Events {
            fault: self.stop(p, reading).or(refused).or_else(|| self.watch.fault(p, self.state, now)),
            enabled: reading.enabled,
            reset: reading.reset,
            ready,
            contact: self.watch.contact(p),
            settled: self.watch.settled(p),
            arrived: self.place.s >= self.path.length(),
            unloaded: self.unloaded(p, now),
            retracted: self.halted || self.travelled >= p.retract.distance,
        };
        self.halted |= self.state == State::Fault && events.fault.is_some();
        let state = next(self.state, &events);
        self.ticks = self.ticks.saturating_add(1);
        if state != self.state {
            self.enter(p, state, &events, now);
            (self.state, self.ticks) = (state, 0);
        }
    }

    /// What stops the machine at once.
    fn stop(&self, p: &Parameters, reading: &Reading) -> Option<Fault> {
        let beyond = reading.position.abs() - 0.5 * p.stroke.vector();
        let outside = self.state != State::Idle && self.state != State::Done && beyond.max() > 0.0;
        (reading.stopped.then_some(Fault::EmergencyStop))
            .or((!reading.valid).then_some(Fault::InvalidInput))
            .or((outside && !(self.state == State::Fault && self.halted)).then_some(Fault::Stroke))
    }

    /// Takes the zero of the sensor after `enable`: whether the approach may begin, and what forbids it.
    fn prepare(&mut self, p: &Parameters, reading: &Reading, now: &Sight) -> (bool, Option<Fault>) {
        if self.state != State::Idle || !reading.valid {
            return (false, None);
        }
        if reading.start {
            self.restart(p);
        }
        self.taring &= reading.enabled;
        let zero = if self.taring { self.gauge.tare(p, &reading.force) } else { None };
        let Some(zero) = zero else { return (false, None) };
        self.taring = false;
        let height = -now.error.normal;
        let beside = (now.offset - now.frame.normal * now.error.normal).norm();
        let away = beside > p.approach.offset_max || height < -p.approach.offset_max;
        let refused =
            (zero.norm() > p.tare.force_max).then_some(Fault::TareRejected).or(away.then_some(Fault::NotAtStart));
        (refused.is_none(), refused)
    }

    /// Forgets the last job.
    fn restart(&mut self, p: &Parameters) {
        self.gauge.restart();
        self.taring = true;
        self.fault = Fault::None;
        self.place = Place::default();
        self.press = Press::new(p);
    }

    /// The force is gone, or does not want to go.
    fn unloaded(&self, p: &Parameters, now: &Sight) -> bool {
        now.force.controlled < 0.5 * p.approach.contact_force || self.ticks > p.ticks(p.settle.time_max)
    }

    /// What happens once, when `state` begins.
    fn enter(&mut self, p: &Parameters, state: State, events: &Events, now: &Sight) {
        self.travelled = 0.0;
        match state {
            State::Fault => {
                self.fault = events.fault.unwrap_or(Fault::None);
                self.halted = !(self.fault.retracts() && self.state.moving());
            }
            State::Idle => (self.fault, self.halted, self.taring) = (Fault::None, false, false),
            State::Approach => self.watch = Watch::new(),
            State::Settle => {
                self.set_point.force = now.force.controlled.max(0.0);
                self.feedback = Feedback::new();
                self.press.touch(p);
            }
            State::Follow => {
                self.press.follow(p);
                (self.feed, self.k) = (Feed::default(), 0);
            }
            State::Unload => self.press.unload(),
            State::Retract | State::Done => (),
        }
        if !state.pressing() {
            self.set_point.force = 0.0;
        }
    }

    /// The velocity in the present state.
    fn act(&mut self, p: &Parameters, reading: &Reading, now: &Sight) -> Parts {
        match self.state {
            State::Idle | State::Done => Parts::default(),
            State::Approach => self.travel(p, -p.approach.velocity),
            State::Retract => self.travel(p, p.retract.velocity),
            State::Fault if self.halted || self.travelled >= p.retract.distance => Parts::default(),
            State::Fault => self.travel(p, p.retract.velocity),
            State::Settle | State::Unload => self.settle(p, reading, now),
            State::Follow => self.follow(p, reading, now),
        }
    }

    /// Moves along the normal.
    fn travel(&mut self, p: &Parameters, velocity: f64) -> Parts {
        self.travelled += velocity.abs() * p.sample_period;
        Parts { normal: velocity, ..Parts::default() }
    }

    /// Builds the force up, or takes it away.
    fn settle(&mut self, p: &Parameters, reading: &Reading, now: &Sight) -> Parts {
        let error = self.want(p, reading, now);
        // not while the approach swings out
        if self.state == State::Settle && self.ticks > p.ticks(TOUCH_TIME) {
            self.press.feel(p, &reading.position, &now.frame.normal, now.force.normal);
        }
        Parts {
            normal: self.press.settle(p, error),
            position: self.feedback.step(p, &now.offset, &now.frame.normal),
            ..Parts::default()
        }
    }

    /// Moves the wanted force and gives the force error, N.
    fn want(&mut self, p: &Parameters, reading: &Reading, now: &Sight) -> f64 {
        let target = if self.state == State::Unload { 0.0 } else { p.force.target * reading.force_override };
        self.set_point.step(target, p.force.target / p.settle.ramp_time, p.sample_period);
        self.set_point.force - now.force.controlled
    }

    /// eq. 1 with eq. 16: v = v_t + v_n + v_p + v_v.
    fn follow(&mut self, p: &Parameters, reading: &Reading, now: &Sight) -> Parts {
        let error = self.want(p, reading, now);
        self.feed.step(p, reading.feed_override, now.frame.feed_max);
        self.k = self.k.wrapping_add(1).max(1);
        let contact = Contact { error, force: now.force.normal, offset: -now.error.normal };
        let feed = self.feed.velocity;
        let way = Way { path: &self.path, place: self.place, frame: &now.frame, feed };
        let parts = Parts {
            normal: self.press.step(p, &contact, self.k, &way),
            // eq. 2
            tangential: feed * now.frame.ratio,
            position: self.feedback.step(p, &now.offset, &now.frame.normal),
            // eq. 16
            stick_slip: stick_slip::sign(&p.stick_slip, self.k) * stick_slip::velocity(&p.stick_slip, feed),
            sideways: stick_slip::direction(p.stick_slip.mode, &now.frame),
        };
        self.place = self.path.advance(self.place, self.place.s + feed * p.sample_period);
        parts
    }

    fn report(&self, now: &Sight, output: &mut Output) {
        let (shift, turn) = (self.press.misalignment.shift(), self.press.misalignment.rotation());
        output.force = Force {
            measured: now.force.controlled,
            setpoint: self.set_point.force,
            error: self.set_point.force - now.force.controlled,
        };
        output.desired = now.frame.centre.into();
        output.normal = now.frame.normal.into();
        output.tangent = now.frame.tangent.into();
        output.error = now.error;
        output.progress = (self.place.s / self.path.length()).min(1.0);
        output.state = self.state;
        output.fault = self.fault;
        output.in_contact = self.state.pressing();
        output.done = self.state == State::Done && self.place.s >= self.path.length();
        output.stiffness = Stiffness { estimate: self.press.stiffness };
        output.misalignment = Misalignment { x: shift.x, y: shift.y, z: shift.z, rx: turn.x, ry: turn.y, rz: turn.z };
        output.ripple = Ripple { frozen: self.press.ripple.frozen() };
    }
}

//! One sample of the whole law: read, estimate the spindle and the ring, decide, move, report.

use control_blocks::ParameterError;
use serde::{Deserialize, Serialize};

use crate::centre::Estimate;
use crate::check::check;
use crate::follow::Follower;
use crate::machine::{Events, Fault, State, Verdict, next};
use crate::model::{Observation, RingModel};
use crate::motion::Motion;
use crate::offset::{Learner, Stroke};
use crate::parameters::Parameters;
use crate::plan::{Planner, Push, Scene};
use crate::rates::{Clock, Due};
use crate::reading::{Reader, Reading, Sample};
use crate::signals::{Input, Output, PushReport, Setpoint};
use crate::spindle::Spindle;
use crate::supervision::{Supervisor, View, judge};

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    reader: Reader,
    clock: Clock,
    spindle: Spindle,
    follower: Follower,
    model: RingModel,
    planner: Planner,
    learner: Learner,
    supervisor: Supervisor,
    motion: Motion,
    state: State,
    fault: Fault,
    /// the last good sample
    sample: Sample,
    /// samples in a row within the band of settling
    settled: u32,
    estimate: Option<Estimate>,
    /// eccentricity of the first model, m
    first: Option<f64>,
    /// the last push, until the model after it
    stroke: Option<Stroke>,
    report: PushReport,
    started: f64,
    centred: Option<f64>,
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
            model: RingModel::new(p),
            planner: Planner::new(p),
            learner: Learner::default(),
            supervisor: Supervisor::default(),
            motion: Motion::default(),
            state: State::Idle,
            fault: Fault::None,
            sample: Sample { angle: 0.0, slide: 0.0, probe: 0.0 },
            settled: 0,
            estimate: None,
            first: None,
            stroke: None,
            report: PushReport::NONE,
            started: 0.0,
            centred: None,
        })
    }

    /// One sample at `time` s. The parameters must be those of [`Controller::new`].
    pub fn tick(&mut self, p: &Parameters, time: f64, input: &Input) -> Output {
        let reading = self.reader.read(p, input);
        let due = self.clock.advance(p);
        let turned = self.observe(p, &reading, due);
        self.decide(p, time, &reading, due, turned);
        self.motion.step(p, self.wished_velocity(p));
        self.report(p)
    }

    /// Spindle, surface and model; the angle (rad) turned since the last sample.
    fn observe(&mut self, p: &Parameters, reading: &Reading, due: Due) -> f64 {
        if let Some(slide) = reading.slide {
            self.motion.place(slide, reading.jumped && self.state == State::Idle);
        }
        let Some(sample) = reading.sample else { return 0.0 };
        self.sample = sample;
        if reading.jumped {
            self.spindle.restart();
        }
        let turned = self.spindle.update(sample.angle);
        if due.control {
            self.follower.update(p, &sample);
        }
        // a probe without contact shows the slide, not the surface
        let collect = due.collect && self.state == State::Collect && sample.probe >= p.probe.contact;
        self.model.update(p, &Observation { angle: self.spindle.angle(), tip: sample.tip(), collect });
        turned
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, time: f64, reading: &Reading, due: Due, turned: f64) {
        let mut events = Events {
            enabled: reading.enabled,
            start: reading.start,
            reset: reading.reset,
            fault: self.find_fault(p, reading, turned),
            touched: self.sample.probe > p.probe.contact,
            settled: self.settle(p),
            collected: self.model.complete(),
            stroke_over: self.motion.arrived(p, p.push.dwell),
            ..Events::default()
        };
        if self.state == State::Model && due.model && events.fault.is_none() {
            self.conclude(p, &mut events);
        }
        let push = self.plan(p, due);
        events.launched = push.is_some();
        let state = next(self.state, &events);
        if state != self.state {
            self.supervisor.enter();
            self.enter(p, state, time, &events, reading, push);
            self.state = state;
        }
    }

    /// The gravest fault of this sample.
    fn find_fault(&mut self, p: &Parameters, reading: &Reading, turned: f64) -> Option<Fault> {
        let invalid = reading.sample.is_none() || (reading.jumped && self.state.active());
        let view = View {
            state: self.state,
            probe: self.sample.probe,
            turned,
            speed: self.spindle.speed(),
            surface: self.follower.surface(),
            beyond_travel: self.motion.beyond_travel(p),
            estimate: self.estimate.as_ref(),
        };
        let fault = self.supervisor.check(p, &view);
        if invalid { Some(Fault::InvalidInput) } else { fault }
    }

    /// Ends the retract after a push, and counts how long the probe is where it should be.
    fn settle(&mut self, p: &Parameters) -> bool {
        if self.state == State::Settle && self.motion.arrived(p, 0.0) {
            self.motion.release();
        }
        let inside = (self.sample.probe - p.null()).abs() <= p.follow.settle_band;
        let following = matches!(self.state, State::Follow | State::Settle) && !self.motion.moving();
        self.settled = if inside && following { self.settled.saturating_add(1) } else { 0 };
        inside && following && self.settled >= p.ticks(p.follow.settle_time)
    }

    /// Makes the model, learns from the last push, and judges the ring.
    fn conclude(&mut self, p: &Parameters, events: &mut Events) {
        let Some(ring) = self.model.estimate() else {
            events.fault = Some(Fault::Spindle);
            return;
        };
        if let Some(stroke) = self.stroke.take() {
            self.learner.learn(&p.offset, &stroke, &ring);
            self.report.overshoot = ring.centre.overshoot(&stroke.before.centre);
            self.report.overshoot_max = self.report.overshoot_max.max(self.report.overshoot);
        }
        self.estimate = Some(ring);
        let eccentricity = ring.centre.eccentricity();
        let first = *self.first.get_or_insert(eccentricity);
        events.fault = judge(p, self.spindle.speed(), self.report.count, first, &ring);
        let centred = eccentricity <= p.tolerance;
        events.verdict = Some(if centred { Verdict::Centred } else { Verdict::Push });
    }

    /// The push, in the tick of its launch.
    fn plan(&mut self, p: &Parameters, due: Due) -> Option<Push> {
        let estimate = self.estimate.as_ref().filter(|_| self.state == State::Wait)?;
        let scene = Scene {
            estimate,
            angle: self.spindle.angle(),
            speed: self.spindle.speed(),
            sample: self.sample,
            offset: self.learner.offset(),
            control: due.control,
        };
        self.planner.update(p, &scene)
    }

    /// What happens once, when `state` begins.
    fn enter(
        &mut self,
        p: &Parameters,
        state: State,
        time: f64,
        events: &Events,
        reading: &Reading,
        push: Option<Push>,
    ) {
        match state {
            State::Idle => self.leave(p, reading),
            State::Fault => {
                self.fault = events.fault.unwrap_or(self.fault);
                self.leave(p, reading);
            }
            State::Approach => self.restart(p, time),
            State::Collect => self.model.begin(),
            State::Wait => self.planner.begin(),
            State::Push => self.launch(p, push),
            State::Settle => self.end_stroke(p),
            State::Centred => self.centred = Some(time),
            // at once, or the slide would brake until the next beat
            State::Follow => self.follower.update(p, &self.sample),
            State::Model => {}
        }
    }

    /// Goes back to where the approach began; stops only, if the slide does not know where it is.
    fn leave(&mut self, p: &Parameters, reading: &Reading) {
        if reading.slide.is_some() {
            self.motion.retreat(p);
        } else {
            self.motion.release();
        }
    }

    /// Forgets the last centring and begins a new one.
    fn restart(&mut self, p: &Parameters, time: f64) {
        self.motion.start(self.sample.slide);
        self.learner = Learner::default();
        self.model = RingModel::new(p);
        (self.fault, self.estimate, self.first, self.stroke) = (Fault::None, None, None, None);
        (self.report, self.started, self.centred) = (PushReport::NONE, time, None);
    }

    /// Begins the stroke of a push.
    fn launch(&mut self, p: &Parameters, push: Option<Push>) {
        if let (Some(push), Some(before)) = (push, self.estimate) {
            self.motion.go(p, push.end, push.velocity);
            self.stroke = Some(Stroke { before, remaining: 0.0 });
            self.report.count += 1;
            self.report.distance = push.distance;
            self.report.velocity = push.velocity;
            self.report.lead_angle = push.lead;
        }
    }

    /// Notes what is left of the gap and retracts at once.
    fn end_stroke(&mut self, p: &Parameters) {
        if let Some(stroke) = &mut self.stroke {
            stroke.remaining = p.probe.at_pusher - self.sample.probe;
        }
        let back = self.motion.setpoint.position - p.follow.gap;
        self.motion.go(p, back, p.slide.velocity_max);
    }

    /// Velocity of the slide when it is not on a move, m/s.
    fn wished_velocity(&self, p: &Parameters) -> f64 {
        match self.state {
            State::Approach => p.approach.velocity,
            State::Idle | State::Push | State::Fault => 0.0,
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
            state: self.state,
            fault: self.fault,
            centred: self.centred.is_some(),
            time_to_centre: self.centred.map_or(0.0, |time| time - self.started),
            eccentricity: ring.map_or(0.0, |ring| ring.centre.eccentricity()),
            eccentricity_angle: ring.map_or(0.0, |ring| ring.centre.nearest()),
            eccentricity_sigma: ring.map_or(0.0, |ring| ring.sigma),
            spindle_speed: self.spindle.speed(),
            pusher_gap: p.probe.at_pusher - self.sample.probe,
            push: PushReport { offset: self.learner.offset(), ..self.report },
        }
    }
}

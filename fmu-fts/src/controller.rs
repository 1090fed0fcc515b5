//! One sample of the whole law: read, decide, refer, act, report.

use control_blocks::{Edge, ParameterError, Trajectory};
use serde::{Deserialize, Serialize};

use crate::calibration::calibrator::Calibrator;
use crate::calibration::cut::Moment;
use crate::check::check;
use crate::faults::{self, Situation};
use crate::identify::experiment::Identification;
use crate::identify::tone::Expected;
use crate::interface::{ErrorOutput, Fault, Input, Mode, Output, Parameters};
use crate::interface::{ReferenceOutput, ResponseOutput, State};
use crate::machine::{Events, Request, next};
use crate::motion::hold::HoldMotion;
use crate::motion::sweep::sweep;
use crate::path::depth_table::DepthTable;
use crate::path::feasibility::needed_torque;
use crate::path::kinematics::Arm;
use crate::path::path_table::PathTable;
use crate::reading::{Reader, Reading};
use crate::servo::compensation::dry_friction;
use crate::servo::design::design;
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
    request: Request,
    reset_fault: Edge,
    forget: Edge,
    spindle: Spindle,
    state: State,
    fault: Fault,
    hold: HoldMotion,
    tracker: Tracker,
    /// motion of the hub that is wanted
    motion: Trajectory,
    recursion: Recursion,
    /// the response is new and not told yet
    response: Option<FrequencyResponse>,
    identification: Identification,
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
        let mut response = LoopResponse::nominal(model);
        tables.response.iter().for_each(|measured| response.correct(measured));
        let grid: Vec<f64> = p.identify.grid.iter().collect();
        let identification = Identification::new(p, |omega| expected(&response, omega));
        let known = FrequencyResponse::from_model(&grid, |omega| response.at(omega));
        Ok(Self {
            arm,
            compensator,
            reader: Reader::default(),
            request: Request::default(),
            reset_fault: Edge::default(),
            forget: Edge::default(),
            spindle: Spindle::default(),
            state: State::Idle,
            fault: Fault::None,
            hold: HoldMotion::at(0.0),
            tracker: Tracker::new(p, path, response),
            motion: Trajectory::default(),
            recursion: Recursion::default(),
            identification,
            response: Some(tables.response.unwrap_or(known)),
            calibration: Calibrator::new(p),
        })
    }

    /// One sample; the parameters must be those of [`Controller::new`].
    pub fn tick(&mut self, input: &Input, p: &Parameters, output: &mut Output) {
        let (reading, valid) = self.reader.read(input);
        self.spindle.update(p, reading.spindle_angle);
        let phasors = self.tracker.locate(p, reading.slide_position, &self.spindle);
        self.decide(p, input, &reading, valid);
        let layers = self.layers(p, input);
        let wanted = self.refer(p, &reading, layers, &phasors);
        let torque = self.act(p, &wanted, &reading);
        self.calibrate(p, input, &reading, torque);
        self.report(p, torque, &wanted, &reading, output);
        output.afc_frozen = !layers.learning;
        if matches!(self.state, State::Ready | State::Track) {
            self.tracker.judge(output.error.tracking, &self.spindle, &phasors);
        }
    }

    /// Largest depth (m) that the harmonics of the path leave out.
    pub fn truncation(&self) -> f64 {
        self.tracker.path().truncation
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, input: &Input, reading: &Reading, valid: bool) {
        let mode = self.request.read(input);
        let events = Events {
            fault: faults::find(p, &self.situation(mode, reading, valid)),
            reset: self.reset_fault.rises(input.reset_fault),
            spindle_known: self.spindle.known(),
            arrived: self.tracker.arrived(p),
        };
        let state = next(self.state, mode, &events);
        if state != self.state {
            if self.state == State::Fault {
                self.request.spend();
            }
            self.enter(p, state, &events, reading);
            self.state = state;
        }
    }

    /// What faults are found from.
    fn situation(&self, mode: Mode, reading: &Reading, valid: bool) -> Situation<'_> {
        let error = self.arm.length * (self.motion.position - reading.arm_angle);
        Situation {
            valid,
            following_error: if self.state.closed() { error } else { 0.0 },
            path: matches!(mode, Mode::Approach | Mode::Track).then_some(self.tracker.path()),
            slide_position: reading.slide_position,
            spindle_speed: self.spindle.speed,
        }
    }

    /// What happens once, when `state` begins.
    fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading) {
        self.fault = events.fault.filter(|_| state == State::Fault).unwrap_or(Fault::None);
        if !self.state.closed() {
            self.hold = HoldMotion::at(reading.arm_angle);
            self.motion = Trajectory::resting(reading.arm_angle);
            self.recursion = Recursion::default();
        }
        // from any motion, that of an identification broken off, too
        if self.state == State::Identify || matches!(state, State::Hold | State::Identify | State::Calibrate) {
            self.hold.go(p, self.motion, reading.hold_angle);
        }
        match state {
            State::Idle | State::Fault => self.tracker.forget(),
            State::Hold | State::Calibrate => (),
            State::Identify => self.identification.restart(),
            State::Approach => self.tracker.approach(),
            State::Ready | State::Track => (),
        }
    }

    /// Which layers work in this sample.
    fn layers(&mut self, p: &Parameters, input: &Input) -> Layers {
        if self.forget.rises(input.afc_reset) || !input.afc_enable {
            self.tracker.forget();
        }
        let steady = !self.recursion.saturated && self.spindle.speed.abs() >= p.afc.speed_min;
        Layers {
            feedforward: input.feedforward_enable,
            cancellation: input.afc_enable,
            learning: input.afc_enable && steady && self.state == State::Track,
        }
    }

    /// What the arm should do.
    fn refer(&mut self, p: &Parameters, reading: &Reading, layers: Layers, phasors: &Phasors) -> Wanted {
        let wanted = match self.state {
            State::Idle | State::Fault => self.still(Trajectory::resting(reading.arm_angle)),
            State::Calibrate if reading.cutting => {
                let motion = sweep(p, self.motion, reading.hold_angle);
                // what comes after the cut begins here
                self.hold.go(p, motion, reading.hold_angle);
                self.still(motion)
            }
            State::Hold | State::Calibrate => {
                let motion = self.hold.step(p, reading.hold_angle);
                self.still(motion)
            }
            State::Identify => {
                let motion = self.swing(p, reading);
                self.still(motion)
            }
            State::Approach | State::Ready | State::Track => {
                let held = self.hold.coast(p);
                self.tracker.follow(p, held, reading.arm_angle, layers, phasors)
            }
        };
        self.motion = wanted.motion;
        wanted
    }

    /// A motion that needs no correction.
    fn still(&self, motion: Trajectory) -> Wanted {
        Wanted { motion, depth: self.arm.depth(motion.position), set_point: motion.position }
    }

    /// Once the arm holds its angle it swings about it, until the frequency response is complete and in use.
    fn swing(&mut self, p: &Parameters, reading: &Reading) -> Trajectory {
        let centre = self.hold.step(p, reading.hold_angle);
        if !self.hold.arrived(p) || self.identification.done() {
            return centre;
        }
        let saturated = self.recursion.saturated;
        let position = centre.position + self.identification.step(reading.arm_angle - centre.position, saturated);
        if self.identification.done() {
            self.tracker.response().correct(self.identification.response());
            self.response = Some(*self.identification.response());
        }
        Trajectory { position, velocity: (position - self.motion.position) / p.sample_period, acceleration: 0.0 }
    }

    /// Samples of a calibration and its fits.
    fn calibrate(&mut self, p: &Parameters, input: &Input, reading: &Reading, torque: f64) {
        if self.state == State::Calibrate {
            let &Reading { arm_angle, slide_position, .. } = reading;
            self.calibration.step(p, input, Moment { arm_angle, torque, slide_position });
        } else {
            self.calibration.rest();
        }
    }

    /// Position loop.
    fn act(&mut self, p: &Parameters, wanted: &Wanted, reading: &Reading) -> f64 {
        if !self.state.closed() {
            return 0.0;
        }
        let (error, limit) = (wanted.set_point - reading.arm_angle, p.servo.torque_max);
        let torque = self.recursion.update(&self.compensator, error, limit) + dry_friction(p, wanted.motion);
        torque.clamp(-limit, limit)
    }

    fn report(&mut self, p: &Parameters, torque: f64, wanted: &Wanted, reading: &Reading, output: &mut Output) {
        let (turn, path, speed) = (self.tracker.last_turn(), self.tracker.path(), self.spindle.speed);
        let behind = wanted.motion.position - reading.arm_angle;
        output.torque = torque;
        output.state = self.state;
        output.fault = self.fault;
        output.reference = ReferenceOutput { depth: wanted.depth, angle: wanted.motion.position };
        output.error = ErrorOutput {
            tracking: self.arm.lever(reading.arm_angle) * behind,
            rms: turn.rms,
            peak: turn.peak,
            harmonic: turn.harmonic.map(|c| c.norm()),
        };
        output.spindle_speed = speed;
        output.saturated = self.state.closed() && self.recursion.saturated;
        output.path_torque = needed_torque(p, path, speed);
        output.path_truncation = path.truncation;
        output.calibration = self.calibration.report();
        output.identify_progress = self.identification.progress();
        if let Some(response) = self.response.take() {
            output.response = ResponseOutput::of(&response, self.tracker.response());
        }
    }
}

/// What a swing at `omega` (rad/s) is expected to do.
fn expected(response: &LoopResponse, omega: f64) -> Expected {
    Expected { response: response.at(omega), stiffness: response.model().arm(omega).norm().recip() }
}

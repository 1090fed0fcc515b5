//! One sample of the whole law: read, decide, refer, act, report.

use control_blocks::{Edge, ParameterError};
use serde::{Deserialize, Serialize};

use crate::calibration::Calibration;
use crate::check::check;
use crate::cut::Moment;
use crate::depth_table::DepthTable;
use crate::design::design;
use crate::dry_friction::dry_friction;
use crate::feasibility::{available_torque, needed_torque};
use crate::hold::Hold;
use crate::identify::Identification;
use crate::kinematics::Arm;
use crate::lead_lag::{LeadLag, Recursion};
use crate::loop_model::LoopModel;
use crate::loop_response::LoopResponse;
use crate::machine::{Events, Fault, Mode, State, next};
use crate::parameters::Parameters;
use crate::path::Path;
use crate::phasors::Phasors;
use crate::quintic::Motion;
use crate::reading::{Reader, Reading};
use crate::response::FrequencyResponse;
use crate::signals::{IdentifyOutput, Input, Output, ResponseOutput};
use crate::spindle::Spindle;
use crate::sweep::sweep;
use crate::tone::Expected;
use crate::tracker::{Layers, Tracker, Wanted};

/// Tables that come from files; none by default.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// Depth of the path, for `surface.kind` = File.
    pub depth: Option<DepthTable>,
    /// Measured response of the position loop.
    pub response: Option<FrequencyResponse>,
}

/// The controller between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Controller {
    arm: Arm,
    compensator: LeadLag,
    reader: Reader,
    reset: Edge,
    spindle: Spindle,
    state: State,
    fault: Fault,
    hold: Hold,
    tracker: Tracker,
    /// motion of the hub that is wanted
    motion: Motion,
    recursion: Recursion,
    /// the response is new and not told yet
    response: Option<FrequencyResponse>,
    identification: Identification,
    calibration: Calibration,
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
        let path = Path::new(arm, depth, p.feedforward.harmonics as usize);
        let model = LoopModel::new(p, compensator);
        let mut response = LoopResponse::nominal(model);
        tables.response.iter().for_each(|measured| response.correct(measured));
        let grid: Vec<f64> = p.identify.frequencies.iter().collect();
        let identification = Identification::new(p, |omega| expected(&response, omega));
        let known = FrequencyResponse::from_model(&grid, |omega| response.at(omega));
        Ok(Self {
            arm,
            compensator,
            reader: Reader::default(),
            reset: Edge::default(),
            spindle: Spindle::default(),
            state: State::Idle,
            fault: Fault::None,
            hold: Hold::at(0.0),
            tracker: Tracker::new(p, path, response),
            motion: Motion::default(),
            recursion: Recursion::default(),
            identification,
            response: Some(tables.response.unwrap_or(known)),
            calibration: Calibration::new(p),
        })
    }

    /// One sample; the parameters must be those of [`Controller::new`].
    pub fn tick(&mut self, p: &Parameters, input: &Input, output: &mut Output) {
        let (reading, valid) = self.reader.read(input);
        self.spindle.update(p, reading.spindle_angle);
        let phasors = self.tracker.locate(p, reading.slide_position, &self.spindle);
        self.decide(p, input.mode, &reading, valid);
        let layers = self.layers(p, input);
        let wanted = self.refer(p, &reading, layers, &phasors);
        let torque = self.act(p, &wanted, &reading);
        self.calibrate(p, input, &reading, torque);
        self.report(p, torque, &wanted, &reading, output);
        output.afc.frozen = !layers.learning;
        if matches!(self.state, State::Ready | State::Track) {
            self.tracker.judge(output.error.tracking, &self.spindle, &phasors);
        }
    }

    /// The path.
    pub fn path(&self) -> &Path {
        self.tracker.path()
    }

    /// State machine.
    fn decide(&mut self, p: &Parameters, mode: Mode, reading: &Reading, valid: bool) {
        let events = Events {
            fault: self.find_fault(p, mode, reading, valid),
            spindle_known: self.spindle.known(),
            arrived: self.tracker.arrived(p),
        };
        let state = next(self.state, mode, &events);
        if state != self.state {
            self.enter(p, state, &events, reading);
            self.state = state;
        }
    }

    /// The gravest fault of this sample.
    fn find_fault(&self, p: &Parameters, mode: Mode, reading: &Reading, valid: bool) -> Option<Fault> {
        let error = self.arm.length * (self.motion.angle - reading.arm_angle);
        let behind = self.state.closed() && error.abs() > p.limit.following_error;
        let asked = matches!(mode, Mode::Approach | Mode::Track);
        let outside = asked && !self.tracker.path().covers(reading.slide_position);
        let infeasible = asked && needed_torque(p, self.tracker.path(), self.spindle.speed) > available_torque(p);
        (!valid)
            .then_some(Fault::InvalidInput)
            .or(behind.then_some(Fault::FollowingError))
            .or(outside.then_some(Fault::OutsideTable))
            .or(infeasible.then_some(Fault::Infeasible))
    }

    /// What happens once, when `state` begins.
    fn enter(&mut self, p: &Parameters, state: State, events: &Events, reading: &Reading) {
        self.fault = events.fault.filter(|_| state == State::Fault).unwrap_or(Fault::None);
        if !self.state.closed() {
            self.hold = Hold::at(reading.arm_angle);
            self.motion = Motion { angle: reading.arm_angle, ..Motion::default() };
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
        if self.reset.rises(input.afc.reset) || !input.afc.enable {
            self.tracker.forget();
        }
        let steady = !self.recursion.saturated && self.spindle.speed.abs() >= p.afc.speed_min;
        Layers {
            feedforward: input.feedforward.enable,
            cancellation: input.afc.enable,
            learning: input.afc.enable && steady && self.state == State::Track,
        }
    }

    /// What the arm should do.
    fn refer(&mut self, p: &Parameters, reading: &Reading, layers: Layers, phasors: &Phasors) -> Wanted {
        let wanted = match self.state {
            State::Idle | State::Fault => self.still(Motion { angle: reading.arm_angle, ..Motion::default() }),
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
    fn still(&self, motion: Motion) -> Wanted {
        Wanted { motion, depth: self.arm.depth(motion.angle), set_point: motion.angle }
    }

    /// Once the arm holds its angle it swings about it, until the frequency response is complete and in use.
    fn swing(&mut self, p: &Parameters, reading: &Reading) -> Motion {
        let centre = self.hold.step(p, reading.hold_angle);
        if !self.hold.arrived(p) || self.identification.done() {
            return centre;
        }
        let saturated = self.recursion.saturated;
        let angle = centre.angle + self.identification.step(reading.arm_angle - centre.angle, saturated);
        if self.identification.done() {
            self.tracker.response().correct(self.identification.response());
            self.response = Some(*self.identification.response());
        }
        Motion { angle, velocity: (angle - self.motion.angle) / p.sample_period, acceleration: 0.0 }
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
        output.torque = torque;
        output.state = self.state;
        output.fault = self.fault;
        output.reference.depth = wanted.depth;
        output.reference.angle = wanted.motion.angle;
        output.error.tracking = self.arm.lever(reading.arm_angle) * (wanted.motion.angle - reading.arm_angle);
        let turn = self.tracker.last_turn();
        output.error.rms = turn.rms;
        output.error.peak = turn.peak;
        output.error.harmonic = turn.harmonic.map(|c| c.norm());
        output.spindle_speed = self.spindle.speed;
        output.saturated = self.state.closed() && self.recursion.saturated;
        output.path.torque = needed_torque(p, self.tracker.path(), self.spindle.speed);
        output.calibration = self.calibration.report();
        output.identify = IdentifyOutput { progress: self.identification.progress() };
        if let Some(response) = self.response.take() {
            output.response = ResponseOutput::of(&response, self.tracker.response());
        }
    }
}

/// What a swing at `omega` (rad/s) is expected to do.
fn expected(response: &LoopResponse, omega: f64) -> Expected {
    Expected { response: response.at(omega), stiffness: response.model().arm(omega).norm().recip() }
}

//! Reference of the arm in a sample: held, on the path, in transition, or oscillating for a measurement.

use std::f64::consts::TAU;

use control_blocks::Trajectory;

use crate::controller::Controller;
use crate::interface::{Input, Parameters, State};
use crate::motion::sweep::sweep;
use crate::reading::Reading;
use crate::tracking::phasors::Phasors;
use crate::tracking::tracker::{Layers, Target};

/// Spindle speed (rad/s) below which nothing is learned: 60 rpm. A slower revolution takes longer than `afc.tau`.
const SPEED_MIN: f64 = TAU;

impl Controller {
    /// Which layers work in this sample.
    pub(super) fn layers(&mut self, input: &Input) -> Layers {
        if !input.afc_enable {
            self.tracker.forget();
        }
        let steady = !self.recursion.saturated && self.reader.known() && self.spindle.speed.abs() >= SPEED_MIN;
        Layers {
            feedforward: input.feedforward_enable,
            cancellation: input.afc_enable,
            learning: input.afc_enable && steady && self.state == State::Track,
        }
    }

    /// Advances the reference by one sample and returns the target of the arm. While the loop is open, the target is
    /// the measured angle.
    pub(super) fn refer(&mut self, p: &Parameters, reading: &Reading, layers: Layers, phasors: &Phasors) -> Target {
        let target = if self.closed() {
            let held = self.held(p, reading);
            let held = self.oscillate(p, held, reading);
            if self.tracker.gone(p) {
                self.still(held)
            } else {
                self.tracker.follow(p, held, reading.arm_angle, layers, phasors)
            }
        } else {
            self.still(Trajectory::resting(reading.arm_angle))
        };
        self.motion = target.motion;
        target
    }

    /// The motion off the path.
    fn held(&mut self, p: &Parameters, reading: &Reading) -> Trajectory {
        match self.state {
            State::Calibrate if reading.cutting && self.tracker.gone(p) && !self.identification.oscillating() => {
                let motion = sweep(p, self.motion, reading.hold_angle);
                // what comes after the cut begins here
                self.hold.go(p, motion, reading.hold_angle);
                motion
            }
            State::Hold | State::Calibrate | State::Identify => self.hold.step(p, reading.hold_angle),
            _ => self.hold.coast(p),
        }
    }

    /// A motion that needs no correction.
    fn still(&self, motion: Trajectory) -> Target {
        Target { motion, depth: self.arm.depth(motion.position), set_point: motion.position }
    }

    /// Once the arm holds its angle it oscillates about it, until the frequency response is complete and in use; an aborted
    /// oscillation fades.
    fn oscillate(&mut self, p: &Parameters, center: Trajectory, reading: &Reading) -> Trajectory {
        let measures = matches!(self.state, State::Identify | State::Commission);
        let ready = measures && self.hold.arrived(p) && self.tracker.gone(p);
        let experiment = if self.slow { &mut self.commissioning.experiment } else { &mut self.identification };
        let begins = ready && !experiment.done();
        if begins && experiment.aborted() {
            experiment.restart();
        }
        if !begins && !experiment.oscillating() {
            return center;
        }
        let position = center.position + experiment.step(reading.arm_angle - center.position, self.recursion.saturated);
        if self.state == State::Identify && self.identification.done() {
            self.tracker.take(p, self.identification.response());
            self.response = Some(*self.identification.response());
        }
        Trajectory { position, velocity: (position - self.motion.position) / p.sample_period, acceleration: 0.0 }
    }
}

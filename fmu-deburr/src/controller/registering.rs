//! The state `Register`: what begins, moves and ends it, and the path and patterns that follow from it.

use control_blocks::ticks;

use crate::bank::pattern_bank::PatternBank;
use crate::controller::Controller;
use crate::interface::{Fault, Parameters, State};
use crate::monitoring::finding::{Finding, Numbers};
use crate::path::displacement::Displacement;
use crate::path::feasible::{self, Obstacle};
use crate::path::kinematics::Joints;
use crate::path::route::Route;
use crate::reading::Reading;
use crate::registration::plan;

impl Controller {
    /// The control patterns for the path as programmed, wherever the part lies.
    pub fn programmed_bank(&self, p: &Parameters) -> PatternBank {
        let mut other = self.clone();
        other.restore_programmed(p);
        other.bank
    }

    /// Begins on the path as programmed.
    pub(super) fn begin_registration(&mut self, p: &Parameters, reading: &Reading) {
        self.restore_programmed(p);
        self.registrar.begin(p.arm.forward(&reading.positions).tip);
        (self.on_path, self.registering) = (false, true);
        self.elapsed.restart();
        self.budget = u64::from(ticks(plan::time(p, &self.path, &self.joints, self.inside), p.sample_period));
        self.go_to_touch(p);
    }

    fn go_to_touch(&mut self, p: &Parameters) {
        if let Some(touch) = self.registrar.touch(&self.path.touches) {
            self.route = Route::around(p, &self.joints, &plan::outside(p, touch, &self.joints), self.inside);
        }
    }

    /// Takes what this sample has read, before it looks for faults.
    pub(super) fn observe_registration(&mut self, p: &Parameters, reading: &Reading, contact: bool) {
        if self.state == State::Register {
            self.registrar.observe(p, p.arm.forward(&reading.positions).tip, contact);
        }
    }

    /// Moves the reference on.
    pub(super) fn follow_registration(&mut self, p: &Parameters) {
        if self.registrar.touch(&self.path.touches).is_none() {
            return;
        }
        if self.registrar.travels() {
            self.follow_route(p, false);
            if self.route.over() {
                self.registrar.arrive();
            }
        } else {
            let pose = self.registrar.advance(p, &self.path.touches, &self.joints);
            self.joints = p.arm.inverse(&pose, &self.joints).unwrap_or(self.joints);
            if self.registrar.travels() {
                self.go_to_touch(p);
            }
        }
        self.finish_if(false);
        if let Some(displacement) = self.registrar.displacement {
            match self.displace(p, displacement) {
                Ok(()) => {
                    self.registrar.found.valid = true;
                    self.finish_if(true);
                }
                Err(Obstacle { distance, .. }) => {
                    let numbers = Numbers { axis: 3, value: distance, limit: self.path.length(), ratio: None };
                    self.registrar.reject(Finding { fault: Fault::Misplaced, numbers });
                }
            }
        }
    }

    /// Slows down during the motion to the part or back from it; whether it is at rest.
    pub(super) fn stop_registration(&mut self, p: &Parameters) -> bool {
        if self.path.touches.is_empty() {
            return true;
        }
        let (pose, stopped) = self.registrar.brake(p, &self.path.touches);
        self.joints = p.arm.inverse(&pose, &self.joints).unwrap_or(self.joints);
        stopped
    }

    /// The part lies elsewhere: the path follows it, and the patterns change by what the drives need for the other motion.
    fn displace(&mut self, p: &Parameters, displacement: Displacement) -> Result<(), Obstacle> {
        let before = std::mem::replace(&mut self.path.displacement, displacement);
        let start = feasible::walk(p, &self.path);
        self.path.displacement = before;
        self.move_path(p, displacement, start?);
        Ok(())
    }

    /// The part lies as programmed, where the path was found to be one that the robot can follow before the first sample.
    fn restore_programmed(&mut self, p: &Parameters) {
        self.move_path(p, Displacement::default(), self.programmed_start);
    }

    fn move_path(&mut self, p: &Parameters, displacement: Displacement, start: Joints) {
        if displacement == self.path.displacement {
            return;
        }
        let Self { feedforward, bank, path, .. } = self;
        for (displacement, start, sign) in [(path.displacement, self.start, -1.0), (displacement, start, 1.0)] {
            path.displacement = displacement;
            bank.change(|pattern| feedforward.add(p, path, &start, sign, pattern));
        }
        self.start = start;
    }
}

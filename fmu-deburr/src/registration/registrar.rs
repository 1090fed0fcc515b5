//! Sequence of the touches, each a fast approach until contact, a retract, a slow approach and a retract.

use control_blocks::{Consecutive, Quintic, Trajectory};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters, Registration};
use crate::monitoring::finding::{Finding, Numbers};
use crate::path::displacement::Displacement;
use crate::path::geometry::{Pose, Vector};
use crate::path::kinematics::Joints;
use crate::path::touch::Touch;
use crate::registration::fit::{Touched, fit};
use crate::registration::plan::{back_time, deviation};

/// Phase of a touch: motion of the tip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// Moves to the start of the approach.
    Travel,
    /// Moves towards the part until contact.
    Seek,
    /// Decelerates after the contact.
    Brake,
    /// Retracts to the start of the slow approach, or after that one to the start of the touch.
    Back,
}

/// Registration of the part; [`Self::begin`] starts another one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Registrar {
    /// Outputs: displacement with standard deviations, residual, finished touches. `valid` once the path follows it.
    pub found: Registration,
    /// Fault that ends the registration, or none.
    pub wrong: Finding,
    /// Displacement of the part; none until the fit of all touches is accepted.
    pub displacement: Option<Displacement>,
    touched: Vec<Touched>,
    /// number of the touch, from 0
    touch: usize,
    phase: Phase,
    /// second, slow approach of the touch
    slow: bool,
    /// distance of the reference from the start of the approach, m
    now: Trajectory,
    back: Quintic,
    /// time of the return, s
    time: f64,
    contact: Consecutive,
    /// tip by the last measurement, and where the contact began, m
    tip: Vector,
    position: Vector,
}

impl Registrar {
    /// Nothing registered so far, with memory for a number of touches.
    pub fn new(touches: usize) -> Self {
        Self {
            found: Registration::START,
            wrong: Finding::NONE,
            displacement: None,
            touched: vec![Touched::default(); touches],
            touch: 0,
            phase: Phase::Travel,
            slow: false,
            now: Trajectory::default(),
            back: Quintic::resting(0.0),
            time: 0.0,
            contact: Consecutive::NONE,
            tip: Vector::zeros(),
            position: Vector::zeros(),
        }
    }

    /// Begins with the tip at a position.
    pub fn begin(&mut self, tip: Vector) {
        (self.found, self.displacement) = (Registration::START, None);
        self.wrong = if self.touched.is_empty() { Finding::plain(Fault::NoTouches) } else { Finding::NONE };
        (self.touch, self.phase, self.contact, self.tip) = (0, Phase::Travel, Consecutive::NONE, tip);
    }

    /// The touch that is in turn; none when there is nothing left to do.
    pub fn touch<'a>(&self, touches: &'a [Touch]) -> Option<&'a Touch> {
        touches.get(self.touch).filter(|_| !self.wrong.is_fault() && self.displacement.is_none())
    }

    /// Whether the tip moves to the start of an approach.
    pub fn travels(&self) -> bool {
        self.phase == Phase::Travel
    }

    /// The tip is at the start of the approach.
    pub fn arrive(&mut self) {
        self.seek(0.0, false);
    }

    /// Takes where the tip is by the measurements, and whether it detects something.
    pub fn observe(&mut self, p: &Parameters, tip: Vector, contact: bool) {
        let bridged = p.limits.lost_samples.unsigned_abs();
        if self.contact.update(contact) == 1 {
            self.position = (self.tip + tip) * 0.5;
        }
        self.tip = tip;
        if self.travels() && self.contact.count() > bridged {
            self.stop_with(Fault::UnexpectedContact, 0.0, 0.0);
        }
    }

    /// Moves the reference of the touch in turn on; the pose that it has then.
    pub fn advance(&mut self, p: &Parameters, touches: &[Touch], joints: &Joints) -> Pose {
        let touch = &touches[self.touch];
        let (register, dt) = (&p.register, p.sample_period);
        let in_contact = self.contact.count() > p.limits.lost_samples.unsigned_abs();
        match self.phase {
            Phase::Travel => {}
            Phase::Seek if in_contact => {
                if self.slow {
                    self.take(p, touch, joints);
                }
                self.phase = Phase::Brake;
            }
            Phase::Seek => {
                let started = self.back.goal() + register.retract;
                let maximum = if self.slow { started + register.retract } else { 2.0 * touch.approach };
                if self.now.position >= maximum {
                    self.stop_with(Fault::NoPart, self.now.position, maximum);
                }
                let speed = if self.slow { register.touch_speed } else { register.speed };
                self.now.step(speed, p.feed.acceleration, dt);
            }
            Phase::Brake => {
                self.stop(p);
                if self.now.velocity == 0.0 {
                    let distance =
                        if self.slow { 0.0 } else { (touch.distance(&self.position) - register.retract).max(0.0) };
                    self.back = Quintic::new(self.now, distance, back_time(p, self.now.position - distance));
                    (self.phase, self.time) = (Phase::Back, 0.0);
                }
            }
            Phase::Back => {
                self.time += dt;
                self.now = self.back.at(self.time);
                if self.back.over(self.time) {
                    self.come_back(p, touches, in_contact);
                }
            }
        }
        touch.at(self.now.position)
    }

    /// Slows the reference of the touch down; its pose, and whether it is at rest.
    pub fn brake(&mut self, p: &Parameters, touches: &[Touch]) -> (Pose, bool) {
        self.stop(p);
        (touches[self.touch.min(touches.len() - 1)].at(self.now.position), self.now.velocity == 0.0)
    }

    fn stop(&mut self, p: &Parameters) {
        self.now.step(0.0, p.feed.acceleration, p.sample_period);
    }

    fn seek(&mut self, from: f64, slow: bool) {
        (self.phase, self.slow, self.now) = (Phase::Seek, slow, Trajectory::resting(from));
        // what was detected before is not where this touch begins
        self.contact = Consecutive::NONE;
    }

    fn come_back(&mut self, p: &Parameters, touches: &[Touch], in_contact: bool) {
        if in_contact {
            self.stop_with(Fault::ContactFrozen, self.back.goal(), 0.0);
        } else if !self.slow {
            self.seek(self.back.goal(), true);
        } else {
            self.touch += 1;
            self.found.touches = self.touch as i32;
            self.phase = Phase::Travel;
            if self.touch == touches.len() {
                self.finish(p, touches);
            }
        }
    }

    /// Takes the position where the contact began.
    fn take(&mut self, p: &Parameters, touch: &Touch, joints: &Joints) {
        let position = self.position + touch.normal * p.register.pretravel;
        self.touched[self.touch] = Touched { position: position.xy(), deviation: deviation(p, &touch.normal, joints) };
    }

    fn finish(&mut self, p: &Parameters, touches: &[Touch]) {
        let Ok(fit) = fit(touches, &self.touched) else {
            self.wrong = Finding::plain(Fault::TouchMismatch);
            return;
        };
        let (displacement, [x_std, y_std, angle_std]) = (fit.displacement, fit.deviations);
        let (worst, residual) = (fit.worst.0, fit.worst.1.abs());
        (self.found.x, self.found.y, self.found.angle) =
            (displacement.shift.x, displacement.shift.y, displacement.angle);
        (self.found.x_std, self.found.y_std) = (x_std, y_std);
        (self.found.angle_std, self.found.residual) = (angle_std, residual);
        let (shift, rotation) = (displacement.shift.norm(), displacement.angle.abs());
        let finding =
            |fault, axis, value, limit| Finding { fault, numbers: Numbers { axis, value, limit, ratio: None } };
        self.wrong = if residual > p.limits.touch_residual {
            finding(Fault::TouchMismatch, worst as i32 + 1, residual, p.limits.touch_residual)
        } else if shift > p.limits.shift {
            finding(Fault::Misplaced, 1, shift, p.limits.shift)
        } else if rotation > p.limits.angle {
            finding(Fault::Misplaced, 2, rotation, p.limits.angle)
        } else {
            self.displacement = Some(displacement);
            return;
        };
    }

    /// The path that would follow cannot be run.
    pub fn reject(&mut self, wrong: Finding) {
        (self.wrong, self.displacement) = (wrong, None);
    }

    fn stop_with(&mut self, fault: Fault, value: f64, limit: f64) {
        self.wrong = Finding { fault, numbers: Numbers { axis: self.touch as i32 + 1, value, limit, ratio: None } };
    }
}

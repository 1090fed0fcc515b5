//! How a fault ends: out of the part under control, or with the drive off.
//!
//! The arm has no brake. If its drive responds, a pulse of torque removes its last known speed v before the drive is
//! off: the whole `servo.torque_max` for J |v| / T_max, during which it moves J v^2 / (2 T_max). A relative error s of
//! the inertia leaves the speed s v. A drive that is seen to be reversed gets the opposite pulse.

use control_blocks::Reaction;
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};

/// Longest pulse, s: that of 87 rad/s, more than any path has.
const PULSE_MAX: f64 = 0.01;

/// The fault in force and its end; by default none.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Ending {
    fault: Fault,
    end: Reaction,
    /// the position loop is closed
    retracting: bool,
    brake: Pulse,
}

/// A torque (N.m) for some samples.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Pulse {
    torque: f64,
    left: u32,
    /// it acts in this sample
    acts: bool,
}

/// Velocity of the arm and response of its drive in the sample in which the loop opens.
#[derive(Clone, Copy, Debug)]
pub struct LastMotion {
    /// Velocity, rad/s.
    pub velocity: f64,
    /// Observed response to a torque: 1 nominal, -1 reversed, 0 uncertain.
    pub answer: f64,
}

impl Default for Ending {
    fn default() -> Self {
        Self { fault: Fault::None, end: Reaction::Retract, retracting: false, brake: Pulse::default() }
    }
}

impl Ending {
    /// Begins the end of a fault; of an arm that was under control before (`closed`).
    pub fn begin(&mut self, p: &Parameters, fault: Fault, closed: bool, arm: LastMotion) {
        *self = Self { fault, end: fault.reaction(), retracting: closed, brake: Pulse::default() };
        self.switch_off(p, arm);
    }

    /// A later fault may ask for more and never for less.
    pub fn escalate(&mut self, p: &Parameters, fault: Option<Fault>, arm: LastMotion) {
        if let Some(fault) = fault.filter(|fault| fault.reaction() > self.end) {
            (self.fault, self.end) = (fault, fault.reaction());
            self.switch_off(p, arm);
        }
    }

    /// Releases an arm that is at rest out of the part.
    pub fn release(&mut self) {
        self.retracting = false;
    }

    /// The fault in force.
    pub fn fault(&self) -> Fault {
        self.fault
    }

    /// Whether the arm is under control.
    pub fn retracting(&self) -> bool {
        self.retracting
    }

    /// Whether the arm is being braked.
    pub fn braking(&self) -> bool {
        self.brake.left > 0 || self.brake.acts
    }

    /// Whether the drive may be on.
    pub fn drive_enable(&self) -> bool {
        self.end < Reaction::DriveOff || self.braking()
    }

    /// Torque (N.m) of a sample in which the loop is open.
    pub fn torque(&mut self) -> f64 {
        self.brake.acts = self.brake.left > 0;
        self.brake.left = self.brake.left.saturating_sub(1);
        if self.brake.acts { self.brake.torque } else { 0.0 }
    }

    fn switch_off(&mut self, p: &Parameters, arm: LastMotion) {
        if self.end < Reaction::DriveOff {
            return;
        }
        if self.retracting {
            self.brake = Pulse::against(p, arm.velocity * self.fault.answer(arm.answer));
        }
        self.retracting = false;
    }
}

impl Pulse {
    /// Takes a speed (rad/s) from the arm, in whole samples.
    fn against(p: &Parameters, velocity: f64) -> Self {
        let (impulse, dt, maximum) = (p.servo.inertia * velocity, p.sample_period, p.servo.torque_max);
        let samples = ((impulse.abs() / maximum).min(PULSE_MAX) / dt).ceil();
        let torque = (-impulse / (samples.max(1.0) * dt)).clamp(-maximum, maximum);
        Self { torque, left: samples as u32, acts: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOVES: LastMotion = LastMotion { velocity: 5.0, answer: 1.0 };

    /// Torques after a fault of an arm that moves with `velocity`, and the samples for which the drive is on.
    fn ended(fault: Fault, closed: bool, velocity: f64) -> (Vec<f64>, usize) {
        of(fault, closed, LastMotion { velocity, ..MOVES })
    }

    fn of(fault: Fault, closed: bool, arm: LastMotion) -> (Vec<f64>, usize) {
        let (p, mut ending) = (Parameters::START, Ending::default());
        ending.begin(&p, fault, closed, arm);
        let (mut torques, mut on) = (Vec::new(), 0);
        for _ in 0..200 {
            torques.push(ending.torque());
            on += usize::from(ending.drive_enable());
        }
        (torques, on)
    }

    #[test]
    fn the_pulse_takes_the_speed_with_no_more_than_the_torque() {
        let p = Parameters::START;
        for velocity in [34.0, -34.0, 2.75, -0.1] {
            let (torques, on) = ended(Fault::PositionLost, true, velocity);
            let taken: f64 = torques.iter().sum::<f64>() * p.sample_period / p.servo.inertia;
            assert!((taken + velocity).abs() < 1e-9, "{velocity}: {taken}");
            assert!(torques.iter().all(|torque| torque.abs() <= p.servo.torque_max));
            let shortest = p.servo.inertia * velocity.abs() / p.servo.torque_max / p.sample_period;
            assert!((on as f64) < shortest + 1.0, "{velocity}: {on} samples");
        }
    }

    #[test]
    fn an_arm_that_cannot_be_braked_is_off_immediately() {
        for fault in [Fault::DriveSign, Fault::WeakDrive, Fault::Oscillation, Fault::LongStep] {
            assert_eq!(ended(fault, true, 5.0), (vec![0.0; 200], 0), "{fault:?}");
        }
        // an arm at rest, or one without control
        assert_eq!(ended(Fault::PositionLost, true, 0.0), (vec![0.0; 200], 0));
        assert_eq!(ended(Fault::PositionLost, false, 5.0), (vec![0.0; 200], 0));
        // an absurd speed
        assert_eq!(ended(Fault::PositionJump, true, 1e6).1, 100);
    }

    #[test]
    fn an_arm_that_is_behind_is_braked_where_its_drive_was_seen_to_obey() {
        for (fault, unseen) in [(Fault::FollowingError, 0), (Fault::Saturation, 0), (Fault::PositionLost, 6)] {
            let on = [1.0, 0.0].map(|answer| of(fault, true, LastMotion { answer, ..MOVES }).1);
            assert_eq!(on, [6, unseen], "{fault:?}");
        }
    }

    #[test]
    fn a_drive_that_has_turned_is_braked_by_the_opposite_pulse() {
        let pulse = |fault, answer| of(fault, true, LastMotion { answer, ..MOVES }).0;
        let opposite: Vec<_> = pulse(Fault::PositionLost, -1.0).iter().map(|torque| -torque).collect();
        assert!(opposite[0] > 0.0);
        assert_eq!(pulse(Fault::DriveSign, -1.0), opposite);
        for fault in [Fault::FollowingError, Fault::Saturation, Fault::WeakDrive] {
            assert_eq!(pulse(fault, -1.0), vec![0.0; 200], "{fault:?}");
        }
    }

    #[test]
    fn a_more_severe_fault_takes_over_and_a_less_severe_one_never_does() {
        let (p, mut ending) = (Parameters::START, Ending::default());
        ending.begin(&p, Fault::SpindleLost, true, MOVES);
        assert_eq!((ending.retracting(), ending.braking(), ending.drive_enable()), (true, false, true));
        ending.escalate(&p, Some(Fault::NoProgress), MOVES);
        assert_eq!((ending.fault(), ending.retracting()), (Fault::SpindleLost, true));
        ending.escalate(&p, Some(Fault::PositionJump), MOVES);
        assert_eq!((ending.fault(), ending.retracting(), ending.braking()), (Fault::PositionJump, false, true));
        while ending.torque() < 0.0 {
            assert!(ending.drive_enable());
        }
        assert!(!ending.drive_enable() && !ending.braking());
        ending.escalate(&p, Some(Fault::SpindleLost), MOVES);
        assert_eq!((ending.fault(), ending.drive_enable()), (Fault::PositionJump, false));
    }

    #[test]
    fn what_is_let_go_may_keep_its_drive() {
        let (p, mut ending) = (Parameters::START, Ending::default());
        ending.begin(&p, Fault::SlideLost, true, MOVES);
        ending.release();
        assert_eq!((ending.retracting(), ending.drive_enable(), ending.torque()), (false, true, 0.0));
    }
}

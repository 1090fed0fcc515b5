//! Whether the arm encoder is valid: it must respond to the reference motion, and at rest to the torque.
//!
//! On a path a valid arm angle leaves one anchor after the other; it stays at one only at a reversal, late. At
//! rest only a torque can move the arm: beyond twice the disturbances, from one sign to the other, it would accelerate
//! with (|u - u_a| - 2 d) / J, u_a the torque at the anchor. The torque counts without what is faster than 50 Hz: the
//! noise of an encoder makes torques that take the arm nowhere, 5 N.m at 3 kHz by 18 urad.

use std::f64::consts::TAU;

use control_blocks::Frozen;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::monitoring::drive::disturbance;

/// Path at the tool without a response of a valid encoder at a reversal, m: the 500 Hz at 500 m/s2, which feedback
/// alone hardly answers.
const UNANSWERED: f64 = 5e-5;

/// Corner of the torque that must move the arm, rad/s.
const CORNER: f64 = TAU * 50.0;

/// The two expectations.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LifeWatch {
    by_path: Frozen,
    by_torque: Frozen,
    reference: Option<f64>,
    /// velocity since the anchor, rad/s
    drift: f64,
    /// without its fast part: now and at the anchor, N.m
    torque: Option<f64>,
    anchor: f64,
}

impl LifeWatch {
    /// Takes the reference and the measured angle (rad) and the torque (N.m) of a sample.
    pub fn update(&mut self, p: &Parameters, reference: f64, arm_angle: f64, torque: f64) {
        let (band, dt) = (p.limits.arm_spread, p.sample_period);
        let motion = reference - self.reference.replace(reference).unwrap_or(reference);
        self.by_path.update(arm_angle, motion, band);
        self.by_torque.update(arm_angle, self.drift * dt, band);
        let before = self.torque.unwrap_or(torque);
        let torque = before + (torque - before) * (1.0 - (-CORNER * dt).exp());
        self.torque = Some(torque);
        if self.by_torque.still() == 0 {
            (self.drift, self.anchor) = (0.0, torque);
        }
        let change = torque - self.anchor;
        let excess = (change.abs() - 2.0 * disturbance(p)).max(0.0);
        self.drift += dt * excess.copysign(change) / p.servo.inertia;
    }

    /// Motion of the tool (m) that the encoder has not answered, over the one that it must answer.
    pub fn unanswered(&self, p: &Parameters, length: f64) -> f64 {
        let angle = self.by_path.unanswered().max(self.by_torque.unanswered());
        length * angle / (UNANSWERED + length * p.limits.arm_spread)
    }

    /// Samples without a change of the arm angle.
    pub fn still(&self) -> u32 {
        self.by_path.still()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENGTH: f64 = 0.08;

    /// The most that is unanswered in 1 s.
    fn maximum(reference: impl Fn(f64) -> f64, read: impl Fn(f64) -> f64, torque: impl Fn(f64) -> f64) -> f64 {
        let (p, mut watch) = (Parameters::START, LifeWatch::default());
        let unanswered = (0..10_000).map(|k| {
            let t = 1e-4 * f64::from(k);
            watch.update(&p, reference(t), read(t), torque(t));
            watch.unanswered(&p, LENGTH)
        });
        unanswered.fold(0.0, f64::max)
    }

    #[test]
    fn an_arm_that_follows_late_is_valid() {
        // 100 um of following error at 1.75 mm and 20 Hz
        let path = |t: f64| 0.0219 * (125.7 * t).sin();
        assert!(maximum(path, |t| path(t) - 1.25e-3 * (125.7 * t).cos(), |_| 0.0) < 0.8);
    }

    #[test]
    fn an_encoder_that_is_frozen_or_flickers_is_detected_by_the_path() {
        let path = |t: f64| 0.004 * (125.7 * t).sin();
        assert!(maximum(path, |_| 0.0, |_| 0.0) > 1.0);
        assert!(maximum(path, |t| 7.5e-7 * ((1e4 * t) as i32 % 2) as f64, |_| 0.0) > 1.0);
    }

    #[test]
    fn at_rest_a_torque_detects_it_after_the_time_in_which_it_would_move_the_arm() {
        let (p, mut watch) = (Parameters::START, LifeWatch::default());
        for (torque, sign) in [(2.0, 1.0), (5.0, -1.0)] {
            watch = LifeWatch { by_path: watch.by_path, ..LifeWatch::default() };
            (0..100).for_each(|_| watch.update(&p, 0.3, 0.3, 0.0));
            let detected = (0..1000).take_while(|_| {
                watch.update(&p, 0.3, 0.3, sign * torque);
                watch.unanswered(&p, LENGTH) <= 1.0
            });
            let detected = detected.count() as f64 * p.sample_period;
            // (|u| - 2 d) t^2 / 2 J, late by the low-pass of 50 Hz
            let angle = UNANSWERED / LENGTH + p.limits.arm_spread;
            let expected = (2.0 * angle * p.servo.inertia / (torque - 2.0 * disturbance(&p))).sqrt();
            assert!(detected > expected && detected < expected + 1.5 / (TAU * 50.0), "{torque}: {detected} {expected}");
        }
    }

    #[test]
    fn at_rest_only_a_torque_beyond_the_disturbances_detects_it() {
        assert_eq!(maximum(|_| 0.3, |_| 0.3, |t| 0.2 * (100.0 * t).sin()), 0.0);
        assert_eq!(maximum(|_| 0.3, |_| 0.3, |t| 5.0 * (1.2e4 * t).sin()), 0.0);
        assert!(maximum(|_| 0.3, |_| 0.3, |t| t) > 1.0);
    }
}

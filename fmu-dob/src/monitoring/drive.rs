//! Ratio of measured to commanded acceleration: the sign and the strength of the drive.
//!
//! The disturbance estimate is the part of the thrust that does not accelerate the stage, so Q [K_tn I] - F is the
//! inertial force M_n z'' after both low-passes. Its ratio to the thrust after the same low-passes is the gain ratio of
//! the drive. Both signals are high-pass filtered: a weight takes thrust permanently and accelerates nothing. At an
//! `approach.velocity` below about 60 um/s the default acceleration is too small to evaluate; the drive is then
//! evaluated after the retract only.

use control_blocks::Response;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Time constant of the high-pass: older values are treated as steady, s.
const MEMORY: f64 = 0.1;
/// Minimum root of the sum of squares of the thrust for an evaluation, in `guard.force`: the noise of the force is at
/// most a quarter of that limit, so that the ratio is known to 0.1.
const EXCITATION: f64 = 2.5;

/// Response of the drive.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DriveResponse {
    force_weight: f64,
    velocity_weight: f64,
    slow_weight: f64,
    memory: f64,
    minimum: f64,
    thrust: f64,
    late_thrust: f64,
    /// of the commanded and of the inertial force
    answers: [f64; 2],
    steady: [f64; 2],
    response: Response,
    /// a position since the start was only partly used
    doubted: bool,
}

impl DriveResponse {
    /// Nothing commanded so far.
    pub fn new(p: &Parameters) -> Self {
        let ratio = |g: f64| g * p.sample_period / (1.0 + g * p.sample_period);
        Self {
            force_weight: ratio(p.observer.bandwidth),
            velocity_weight: ratio(p.observer.velocity_bandwidth),
            slow_weight: ratio(MEMORY.recip()),
            memory: MEMORY / p.sample_period,
            minimum: (EXCITATION * p.guard_force).powi(2),
            thrust: 0.0,
            late_thrust: 0.0,
            answers: [0.0; 2],
            steady: [0.0; 2],
            response: Response::default(),
            doubted: false,
        }
    }

    /// Takes the thrust of the current that acted (N) and the disturbance estimate (N); `whole`: the position was used
    /// in full, otherwise it may differ for another reason than the drive.
    pub fn update(&mut self, thrust: f64, disturbance: f64, whole: bool) {
        self.doubted |= !whole;
        self.thrust += self.force_weight * (thrust - self.thrust);
        self.late_thrust += self.velocity_weight * (self.thrust - self.late_thrust);
        self.answers = [self.late_thrust, self.thrust - disturbance];
        for (steady, answer) in self.steady.iter_mut().zip(self.answers) {
            *steady += self.slow_weight * (answer - *steady);
        }
        let [modelled, measured] = [0, 1].map(|i| self.answers[i] - self.steady[i]);
        self.response.update(modelled, measured, self.memory);
    }

    /// A motion starts: the present values are the steady part, and the past is discarded.
    pub fn begin(&mut self) {
        (self.steady, self.response, self.doubted) = (self.answers, Response::default(), false);
    }

    /// Force (N) that accelerates the stage, after the low-passes of the observer.
    pub fn inertia(&self) -> f64 {
        self.answers[1]
    }

    /// Ratio of measured to commanded acceleration; none while too little was commanded. Partly used positions do not
    /// show a weak drive, because they reduce the motion themselves, but they show one that pushes the wrong way.
    pub fn ratio(&self) -> Option<f64> {
        self.response.ratio(self.minimum).filter(|ratio| !self.doubted || *ratio < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::observer::DisturbanceObserver;

    /// Ratio after a push in both directions on a stage with `strength` times the commanded force, under a weight of 3
    /// N.
    fn ratio(strength: f64, amplitude: f64) -> Option<f64> {
        let p = Parameters::START;
        let (mut observer, mut drive) = (DisturbanceObserver::new(&p), DriveResponse::new(&p));
        let (dt, constant) = (p.sample_period, p.stage.force_constant);
        let (mut z, mut v) = (0.0, 0.0);
        for k in 0..4000 {
            if k == 3900 {
                drive.begin();
            }
            let push = if (3900..3920).contains(&k) { amplitude } else { 0.0 };
            let current = (3.0 / strength + push) / constant;
            let acceleration = (strength * constant * current - 3.0) / p.stage.mass;
            z += v * dt + 0.5 * acceleration * dt * dt;
            v += acceleration * dt;
            observer.update(z, current);
            drive.update(constant * current, observer.force(), true);
        }
        drive.ratio()
    }

    #[test]
    fn the_ratio_is_the_strength_and_its_sign() {
        for strength in [1.0, 0.3, -1.0, 1.5] {
            let ratio = ratio(strength, 5.0).unwrap();
            assert!((ratio - strength).abs() < 0.05, "{strength}: {ratio}");
        }
    }

    #[test]
    fn a_weak_push_shows_nothing() {
        assert_eq!(ratio(1.0, 0.1), None);
    }

    #[test]
    fn a_partly_used_position_shows_no_weak_drive_but_one_that_goes_the_wrong_direction() {
        let p = Parameters::START;
        let mut drive = DriveResponse::new(&p);
        let mut push = |answer: f64, doubted: Option<u32>| {
            drive.begin();
            (0..400u32).for_each(|k| {
                let thrust = if k < 200 { 20.0 } else { -20.0 };
                drive.update(thrust, (1.0 - answer) * thrust, doubted != Some(k));
            });
            drive.ratio()
        };
        assert!(push(0.3, None).is_some());
        assert_eq!(push(0.3, Some(57)), None);
        assert!(push(-1.0, Some(57)).is_some_and(|ratio| ratio < -0.2));
        assert!(push(0.3, None).is_some());
    }
}

//! Gain of the drive: acceleration of the arm over that of the torque command.
//!
//! The second difference of three arm angles responds to the mean of the two commands that acted between them,
//! y_k - 2 y_(k-1) + y_(k-2) = T_s^2 (u_(k-1-d) + u_(k-2-d)) / (2 J). Both sides lose what is slower than 20 ms, a
//! thrust that only the torque balances, and what is faster than 200 Hz, where the arm is no rigid body and encoders
//! are noisy.
//!
//! The present gain cannot wait for 200 Hz: a reversed drive loses the arm within two milliseconds. Without that filter
//! only a large torque identifies it: one above the disturbances and above the noise of a second difference, sqrt(6)
//! times that of an arm angle.

use std::f64::consts::TAU;

use control_blocks::{DELAY_MAX, Response, SentCommands};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Time constant of what is too slow, s.
const SLOW: f64 = 0.02;
/// Corner of what is too fast, rad/s.
const FAST: f64 = TAU * 200.0;
/// Time after which a motion is discarded, s; and the time in which only the cause is evaluated.
const MEMORY: f64 = 0.01;
const SHORT: f64 = 0.002;
/// Time constant of what it does now, s: after a millisecond a seventh of what was before is left.
const NOW: f64 = 5e-4;
/// Three standard deviations of a second difference, over the spread of angles at rest, six standard deviations.
const NOISE: f64 = 3.0 * 2.449_489_742_783_178 / 6.0;

/// A signal without its slow and its fast part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Band {
    slow: f64,
    first: f64,
    second: f64,
}

impl Band {
    /// The signal without its slow part; and without both.
    fn update(&mut self, value: f64, dt: f64) -> [f64; 2] {
        let keep = (-FAST * dt).exp();
        self.slow += (value - self.slow) * (dt / SLOW);
        let quick = value - self.slow;
        self.first = keep * self.first + (1.0 - keep) * quick;
        self.second = keep * self.second + (1.0 - keep) * self.first;
        [quick, self.second]
    }
}

/// The commands in transit and the last arm angles.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct DriveWatch {
    sent: SentCommands,
    readings: [Option<f64>; 2],
    commanded: Band,
    done: Band,
    response: Response,
    now: Response,
    latest: Response,
    moving: Response,
    /// the last ratio of `now`, and the samples since
    seen: Option<(f64, u32)>,
}

impl DriveWatch {
    /// Takes the reading of the arm (rad) of this sample, then the torque (N.m) that it is answered with.
    pub fn update(&mut self, p: &Parameters, arm_angle: f64, torque: f64) {
        let dt = p.sample_period;
        let [before, earlier] = self.readings;
        self.readings = [Some(arm_angle), before];
        let late = p.loop_delay() as usize;
        let torques = self.sent.before(late) + self.sent.before((late + 1).min(DELAY_MAX));
        self.sent.send(torque);
        if let Some((before, earlier)) = before.zip(earlier) {
            let [commanded_now, commanded] = self.commanded.update(0.5 * torques / p.servo.inertia, dt);
            let [done_now, done] = self.done.update((arm_angle - 2.0 * before + earlier) / (dt * dt), dt);
            self.now.update(commanded_now, done_now, NOW / dt);
            self.response.update(commanded, done, MEMORY / dt);
            self.latest.update(commanded, done, SHORT / dt);
            if arm_angle != before {
                self.moving = self.latest;
            }
            let kept = self.seen.map(|(ratio, age)| (ratio, age + 1));
            self.seen = self.now(p).map(|ratio| (ratio, 0)).or(kept.filter(|&(_, age)| f64::from(age) * dt < MEMORY));
        }
    }

    /// The same of the last millisecond, with what is fast; none while disturbances could take it below
    /// `expert.limits.drive_gain_ratio`, or three deviations of the noise a drive that does nothing above it.
    pub fn now(&self, p: &Parameters) -> Option<f64> {
        let (dt, minimum_ratio) = (p.sample_period, p.limits.drive_gain_ratio);
        if minimum_ratio == 0.0 {
            return None;
        }
        let noise = NOISE * p.limits.arm_spread / (dt * dt * minimum_ratio);
        self.now.ratio(undisturbed(p, NOW).max(noise * noise))
    }

    /// The last ratio of [`Self::now`], for `MEMORY` after it: a torque that moves the arm 1 mm off its path in that time
    /// is large enough to give one.
    pub fn seen(&self) -> Option<f64> {
        self.seen.map(|(ratio, _)| ratio)
    }

    /// The ratio that identifies the cause: that of `now` without its margin for noise, or the latest.
    pub fn cause(&self, p: &Parameters) -> Option<f64> {
        self.now.ratio(undisturbed(p, NOW)).or(self.latest(p))
    }

    /// Ratio of [`Self::now`], or, while the torque is too small for it, the filtered ratio with a memory of 2 ms. None
    /// while the torque of that time does not exceed the disturbances.
    pub fn latest(&self, p: &Parameters) -> Option<f64> {
        let minimum = disturbance(p) / p.servo.inertia;
        self.now(p).or(self.latest.ratio(SHORT / p.sample_period * minimum * minimum))
    }

    /// The same, over 2 ms, when the reading last changed: an arm that its drive has left comes to rest, an encoder
    /// freezes in motion.
    pub fn moving(&self, p: &Parameters) -> Option<f64> {
        let minimum = disturbance(p) / p.servo.inertia;
        self.moving.ratio(SHORT / p.sample_period * minimum * minimum)
    }

    /// Acceleration of the arm over that of the torque; none while the torque u is so small that disturbances d could
    /// move the ratio, at worst 1 - d / u, of a good drive below `expert.limits.drive_gain_ratio`.
    pub fn ratio(&self, p: &Parameters) -> Option<f64> {
        self.response.ratio(undisturbed(p, MEMORY))
    }
}

/// Square of accelerations in the time `memory` (s), of a torque that disturbances cannot take below
/// `expert.limits.drive_gain_ratio`.
fn undisturbed(p: &Parameters, memory: f64) -> f64 {
    let minimum = disturbance(p) / (p.servo.inertia * (1.0 - p.limits.drive_gain_ratio));
    memory / p.sample_period * minimum * minimum
}

/// Torque of friction and cut that may come without a command, N.m.
pub fn disturbance(p: &Parameters) -> f64 {
    if p.limits.disturbance > 0.0 { p.limits.disturbance } else { 0.03 * p.servo.torque_max }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ratio of a rigid arm with `gain` under a torque over the time, after 0.1 s.
    fn ratio(gain: f64, torque: impl Fn(f64) -> f64, resolution: f64) -> Option<f64> {
        let (p, dt) = (Parameters::START, 1e-4);
        let mut watch = DriveWatch::default();
        let (mut angle, mut velocity, mut before) = (0.0, 0.0, 0.0);
        for k in 0..1000 {
            let command = torque(dt * f64::from(k));
            watch.update(&p, f64::round(angle / resolution) * resolution, command);
            // one sample of delay
            let acceleration = gain * before / p.servo.inertia;
            angle += dt * (velocity + 0.5 * dt * acceleration);
            velocity += dt * acceleration;
            before = command;
        }
        watch.ratio(&p)
    }

    #[test]
    fn the_band_passes_what_is_neither_slow_nor_fast() {
        // s T / (1 + s T) / (1 + s / w)^2, sampled finely
        let dt = 1e-6;
        for hertz in [1.0, 8.0, 40.0, 200.0, 2000.0] {
            let (mut band, omega, mut sum) = (Band::default(), TAU * hertz, nalgebra::Complex::new(0.0, 0.0));
            let (settle, period) = (0.2 / dt, (1.0 / (hertz * dt)) as u32);
            let begin = (settle as u32).div_ceil(period) * period;
            for k in 0..begin + period {
                let phase = omega * dt * f64::from(k);
                let [_, passed] = band.update(phase.cos(), dt);
                if k >= begin {
                    sum += nalgebra::Complex::new(phase.cos(), -phase.sin()) * passed * 2.0 / f64::from(period);
                }
            }
            let s = nalgebra::Complex::new(0.0, omega);
            let expected = s * SLOW / (s * SLOW + 1.0) / (s / FAST + 1.0).powi(2);
            assert!((sum - expected).norm() < 5e-3, "{hertz} Hz: {sum} {expected}");
        }
    }

    #[test]
    fn the_ratio_is_that_of_the_drive() {
        for gain in [1.0, 0.3, 0.0, -1.0] {
            for (hertz, torque) in [(20.0, 2.0), (80.0, 2.0), (500.0, 5.0)] {
                let oscillation = |t: f64| torque * (TAU * hertz * t).cos();
                for resolution in [1e-9, 7.5e-7, 1.2e-5] {
                    let ratio = ratio(gain, oscillation, resolution).unwrap();
                    assert!((ratio - gain).abs() < 0.06, "{gain} {hertz} Hz {resolution}: {ratio}");
                }
            }
        }
    }

    #[test]
    fn a_disturbance_that_is_allowed_never_makes_a_good_drive_weak() {
        // the command balances the whole 0.21 N.m, in addition to a motion
        for motion in [0.05, 0.1, 0.14, 0.2, 0.4] {
            let (p, dt, mut watch) = (Parameters::START, 1e-4, DriveWatch::default());
            let (mut angle, mut velocity, mut before) = (0.0, 0.0, 0.0);
            for k in 0..3000 {
                let phase = (TAU * 40.0 * dt * f64::from(k)).cos();
                watch.update(&p, angle, (motion + disturbance(&p)) * phase);
                angle += dt * velocity;
                velocity += dt * before / p.servo.inertia;
                before = motion * phase;
                assert!(watch.ratio(&p).is_none_or(|ratio| ratio >= p.limits.drive_gain_ratio), "{motion}");
            }
        }
    }

    #[test]
    fn the_present_and_the_last_moving_ratio_need_more_torque_than_the_disturbances() {
        let (p, dt) = (Parameters::START, 1e-4);
        for (torque, identified) in [(0.2, false), (5.0, true)] {
            let (mut watch, mut angle, mut velocity, mut before) = (DriveWatch::default(), 0.0, 0.0, 0.0);
            for k in 0..1000 {
                let command = torque * (TAU * 80.0 * dt * f64::from(k)).cos();
                watch.update(&p, angle, command);
                let acceleration = before / p.servo.inertia;
                angle += dt * (velocity + 0.5 * dt * acceleration);
                velocity += dt * acceleration;
                before = command;
            }
            for ratio in [watch.latest(&p), watch.moving(&p)] {
                assert_eq!(ratio.is_some_and(|ratio| (ratio - 1.0).abs() < 0.05), identified, "{torque}: {ratio:?}");
                assert_eq!(ratio.is_some(), identified, "{torque}: {ratio:?}");
            }
        }
    }

    #[test]
    fn the_present_ratio_needs_more_torque_than_disturbances_and_noise() {
        // a torque that turns each millisecond
        let now = |p: &Parameters, gain: f64, torque: f64| {
            let (dt, mut watch) = (p.sample_period, DriveWatch::default());
            let (mut angle, mut velocity, mut before) = (0.0, 0.0, 0.0);
            for k in 0..200 {
                let command = if (k / 10) % 2 == 0 { torque } else { -torque };
                watch.update(p, angle, command);
                let acceleration = if k < 180 { 1.0 } else { gain } * before / p.servo.inertia;
                angle += dt * (velocity + 0.5 * dt * acceleration);
                velocity += dt * acceleration;
                before = command;
            }
            watch.now(p)
        };
        let mut p = Parameters::START;
        for gain in [1.0, 0.5, 0.0, -1.0] {
            // after two milliseconds 2 % of what was before is left
            assert!(now(&p, gain, 5.0).is_some_and(|ratio| (ratio - gain).abs() < 0.07), "{gain}");
        }
        // 0.21 N.m are 0.35 N.m for a ratio of 0.4; the spread of 20 um requires 2.2 N.m
        assert_eq!([1.8, 2.9].map(|torque| now(&p, 1.0, torque).is_some()), [false, true]);
        p.limits.arm_spread = 1e-6;
        assert_eq!([0.3, 0.5].map(|torque| now(&p, 1.0, torque).is_some()), [false, true]);
        // where the drive is not watched
        p.limits.drive_gain_ratio = 0.0;
        assert_eq!(now(&p, 1.0, 5.0), None);
    }

    #[test]
    fn a_small_torque_gives_no_ratio() {
        assert_eq!(ratio(1.0, |t| 0.2 * (TAU * 20.0 * t).cos(), 1e-9), None);
        assert_eq!(ratio(0.0, |_| 5.0, 1e-9), None);
    }
}

//! The servo of the slide, identified from setpoint and encoder while both move anyway.
//!
//! A position-velocity servo accelerates its slide by x'' = w^2 e + 2 zeta w e' with e = r - x; a setpoint that acts t later
//! or earlier than configured adds b r' with b = -w^2 t. All four signals go through the same filter 1 / (1 + T p)^2,
//! whose p is that of the bilinear transform, so that derivatives are exact in the filter's own terms and no encoder is
//! differentiated. Then x'' is linear in w^2, 2 zeta w and b: least squares with their covariance.
//!
//! More terms are determined only by a motion made for them, in a commissioning run. Integral action adds w^2 / T_i times
//! the integral of e. A wrong delay leaves r' of e, r'' of e', and r of that integral; a constant error of the position
//! leaves 1. The fit uses the first terms or all of them.
//!
//! Residuals of filtered signals are correlated for twice the time of the filter; they are used as one. Integral action
//! that the fit lacks increases them and with them the standard deviation: 2 % at an integral time of 50 ms.

use control_blocks::{DELAY_MAX, SentCommands, Trajectory};
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use crate::interface::{Law, Parameters};

/// Time constant of the filter, s: a servo of 40 Hz (default; it weights and does not bias).
const FILTER_TIME: f64 = 4e-3;
/// Terms of the regression: e, e', r', r'', the integral of e, r, and a constant.
pub const TERMS: usize = 7;
/// Terms for an ordinary motion.
const FEW_TERMS: usize = 3;
/// Largest relative standard deviation of a usable bandwidth: feed-forward has twice that error.
const DEVIATION_MAX: f64 = 0.05;

/// A signal after two lags.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Filtered {
    once: f64,
    twice: f64,
}

impl Filtered {
    /// Adds the mean of the signal over the last `dt` s.
    fn update(&mut self, mean: f64, dt: f64) {
        let ratio = 2.0 * FILTER_TIME / dt;
        let lag = |before: f64, mean: f64| ((ratio - 1.0) * before + 2.0 * mean) / (ratio + 1.0);
        let before = self.once;
        self.once = lag(before, mean);
        self.twice = lag(self.twice, 0.5 * (before + self.once));
    }

    /// Derivative of the filtered signal.
    fn rate(&self) -> f64 {
        (self.once - self.twice) / FILTER_TIME
    }

    /// Second derivative of the filtered signal, with the signal `now`.
    fn rate_of_rate(&self, now: f64) -> f64 {
        ((now - self.once) / FILTER_TIME - self.rate()) / FILTER_TIME
    }
}

impl Parameters {
    /// Whether the control law uses the measured servo.
    pub fn learns_servo(&self) -> bool {
        self.law == Law::Default && self.learn.servo && self.slide.bandwidth > 0.0
    }
}

/// Bandwidth of a servo and its standard deviation, rad/s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Servo {
    /// Natural frequency.
    pub bandwidth: f64,
    /// Standard deviation of the natural frequency.
    pub deviation: f64,
}

impl Servo {
    /// Whether it is certain enough to be used.
    pub fn is_certain(&self) -> bool {
        self.deviation <= DEVIATION_MAX * self.bandwidth
    }
}

/// Factors of the first `N` terms, and their covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit<const N: usize> {
    /// Factors.
    pub value: SVector<f64, N>,
    /// Their covariance.
    pub covariance: SMatrix<f64, N, N>,
}

impl<const N: usize> Fit<N> {
    /// Natural frequency of the servo; none if it does not follow.
    pub fn servo(&self) -> Option<Servo> {
        let stiffness = self.value[0];
        if stiffness <= 0.0 {
            return None;
        }
        let bandwidth = stiffness.sqrt();
        let servo = Servo { bandwidth, deviation: self.covariance[(0, 0)].sqrt() / (2.0 * bandwidth) };
        (servo.bandwidth.is_finite() && servo.deviation.is_finite()).then_some(servo)
    }
}

/// Sums of the regression; by default before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ServoEstimator {
    /// reference position and position of the sample before, m
    positions: Option<[f64; 2]>,
    /// means of position (m) and velocity (m/s) over the sample of each setpoint
    sent: [SentCommands; 2],
    position: Filtered,
    velocity: Filtered,
    slide: Filtered,
    /// integral of the filtered error, m.s
    integral: f64,
    error: f64,
    information: SMatrix<f64, TERMS, TERMS>,
    product: SVector<f64, TERMS>,
    square: f64,
    samples: u32,
}

impl ServoEstimator {
    /// Adds the last setpoint and the slide position (m) that responds to it, `delay` samples later.
    pub fn update(&mut self, dt: f64, delay: f64, setpoint: &Trajectory, slide: f64) {
        let [start, before] = *self.positions.get_or_insert_with(|| {
            self.sent[0] = SentCommands::resting(setpoint.position);
            [slide, slide]
        });
        self.positions = Some([start, slide]);
        let means = [setpoint.position + 0.5 * setpoint.velocity * dt, setpoint.velocity];
        for (sent, mean) in self.sent.iter_mut().zip(means) {
            sent.send(mean);
        }
        let [position, velocity] = self.sent.map(|sent| between(&sent, delay));
        self.position.update(position - start, dt);
        self.velocity.update(velocity, dt);
        self.slide.update(0.5 * (before + slide) - start, dt);
        let error = self.position.twice - self.slide.twice;
        self.integral += 0.5 * (self.error + error) * dt;
        self.error = error;
        let [position, velocity, acceleration] = [self.position.twice, self.velocity.twice, self.velocity.rate()];
        let late = velocity - self.slide.rate();
        let terms = SVector::from([error, late, velocity, acceleration, self.integral, position, 1.0]);
        let acceleration = self.slide.rate_of_rate(slide - start);
        self.information += terms * terms.transpose();
        self.product += terms * acceleration;
        self.square += acceleration * acceleration;
        self.samples += 1;
    }

    /// The servo, if the motion so far identifies it.
    pub fn servo(&self, dt: f64) -> Option<Servo> {
        self.fit::<FEW_TERMS>(dt)?.servo()
    }

    /// The first `N` terms, if the motion so far determines them.
    pub fn fit<const N: usize>(&self, dt: f64) -> Option<Fit<N>> {
        let information = self.information.fixed_view::<N, N>(0, 0).into_owned();
        let product = self.product.fixed_rows::<N>(0).into_owned();
        // in units in which each term alone has the information 1
        let unit = information.diagonal().map(|x| x.sqrt().recip());
        let scaled = information.component_mul(&(unit * unit.transpose()));
        let inverse = scaled.cholesky()?.inverse().component_mul(&(unit * unit.transpose()));
        let value = inverse * product;
        let alike = (2.0 * FILTER_TIME / dt).max(1.0);
        let independent = f64::from(self.samples) / alike - N as f64;
        if independent < 1.0 {
            return None;
        }
        // of as many residuals as are independent
        let variance = (self.square - value.dot(&product)).max(0.0) / independent;
        Some(Fit { value, covariance: inverse * variance })
    }
}

/// Setpoint `delay` samples before the newest, also between two samples.
fn between(sent: &SentCommands, delay: f64) -> f64 {
    let (whole, part) = (delay as usize, delay.fract());
    sent.before(whole) * (1.0 - part) + sent.before((whole + 1).min(DELAY_MAX)) * part
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const P: Parameters = Parameters::START;

    /// A slide whose servo has the natural frequency `hertz`, damping 0.7 and an integral action of `integral` s, in an
    /// approach: to 5 mm/s at `slide.acceleration_max`, and to rest. Result with 0.1 um of noise and one sample of
    /// delay.
    fn found(hertz: f64, integral: f64, seed: u64) -> Option<Servo> {
        const FINE: u32 = 50;
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let (w, dt) = (TAU * hertz, P.sample_period);
        let (mut x, mut v, mut sum) = (0.05, 0.0, 0.0);
        let mut setpoint = Trajectory { position: 0.05, ..Trajectory::default() };
        let mut waiting = std::collections::VecDeque::from(vec![setpoint; P.io_delay.unsigned_abs() as usize]);
        let mut estimator = ServoEstimator::default();
        for k in 0..1500 {
            let noise: f64 = StandardNormal.sample(&mut random);
            estimator.update(dt, f64::from(P.io_delay), &setpoint, x + 1e-7 * noise);
            setpoint.step(if k < 1000 { 5e-3 } else { 0.0 }, P.slide.acceleration_max, dt);
            waiting.push_back(setpoint);
            let acts = waiting.pop_front().unwrap();
            for i in 0..FINE {
                let fine = dt / f64::from(FINE);
                let position = acts.position + acts.velocity * fine * f64::from(i);
                let error = position - x;
                sum += error * fine / integral;
                let force = w * w * (error + sum) + 1.4 * w * (acts.velocity - v);
                v += force * fine;
                x += v * fine;
            }
        }
        estimator.servo(P.sample_period)
    }

    #[test]
    fn the_bandwidth_is_found_far_from_the_configured_values_with_its_deviation() {
        for hertz in [24.0, 30.0, 40.0, 60.0] {
            let servos: Vec<Servo> = (0..8).map(|seed| found(hertz, 1e9, seed).unwrap()).collect();
            for servo in servos {
                let error = servo.bandwidth / (TAU * hertz) - 1.0;
                assert!(error.abs() < 0.05 && servo.is_certain(), "{hertz} Hz: {error} {servo:?}");
            }
        }
    }

    #[test]
    fn the_deviation_covers_the_spread_of_the_noise() {
        let servos: Vec<Servo> = (0..24).map(|seed| found(40.0, 1e9, seed).unwrap()).collect();
        let mean = servos.iter().map(|servo| servo.bandwidth).sum::<f64>() / 24.0;
        let spread = (servos.iter().map(|servo| (servo.bandwidth - mean).powi(2)).sum::<f64>() / 23.0).sqrt();
        let reported = servos.iter().map(|servo| servo.deviation).sum::<f64>() / 24.0;
        assert!((1.0..4.0).contains(&(reported / spread)), "{reported} {spread}");
    }

    #[test]
    fn an_integral_action_that_it_does_not_know_widens_the_deviation() {
        let [plain, strong] = [1e9, 0.05].map(|integral| found(30.0, integral, 3).unwrap());
        assert!(strong.deviation > 2.0 * plain.deviation, "{plain:?} {strong:?}");
        assert!((strong.bandwidth / (TAU * 30.0) - 1.0).abs() < 0.1, "{strong:?}");
    }

    #[test]
    fn between_two_samples_a_ramp_that_was_sent_is_a_ramp() {
        let mut sent = SentCommands::resting(0.0);
        (0..20).for_each(|k| sent.send(f64::from(k)));
        for delay in [0.0, 0.25, 1.0, 2.5, 7.9, DELAY_MAX as f64] {
            assert!((between(&sent, delay) - (19.0 - delay)).abs() < 1e-12, "{delay}");
        }
    }

    #[test]
    fn residuals_that_are_alike_count_as_one() {
        // samples that are correlated within twice the time of the filter are used as one
        for dt in [1e-3, 5e-4] {
            let alike = 2.0 * FILTER_TIME / dt;
            let mut estimator = ServoEstimator::default();
            let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(1);
            let mut position = 0.0;
            let first = (1..1000).find(|_| {
                let [velocity, noise]: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut random));
                position += 5e-3 * velocity * dt;
                let setpoint = Trajectory { position, velocity: 5e-3 * velocity, acceleration: 0.0 };
                estimator.update(dt, 1.0, &setpoint, position + 1e-5 * noise);
                estimator.fit::<FEW_TERMS>(dt).is_some()
            });
            assert_eq!(first.map(f64::from), Some(alike * (FEW_TERMS + 1) as f64), "{dt} s");
        }
    }

    #[test]
    fn a_slide_that_does_not_move_shows_nothing() {
        let mut estimator = ServoEstimator::default();
        let rest = Trajectory { position: 0.1, ..Trajectory::default() };
        (0..1000).for_each(|_| estimator.update(P.sample_period, 1.0, &rest, 0.1));
        assert_eq!(estimator.servo(P.sample_period), None);
    }

    #[test]
    fn only_the_default_law_with_a_configured_servo_learns_it() {
        let with = |change: fn(&mut Parameters)| {
            let mut p = P;
            p.learn.servo = true;
            change(&mut p);
            p.learns_servo()
        };
        assert!(with(|_| ()) && !with(|p| p.learn.servo = false));
        assert!(!with(|p| p.slide.bandwidth = 0.0) && !with(|p| p.law = Law::Paper));
    }
}

//! Tapping: a heavy ring is not pushed but hit by the slide, which rebounds.
//!
//! A soft servo stores the static friction, and a heavy ring jumps when friction gives way, so a push cannot end precisely.
//! An impact does not press: the ring slides a distance that grows smoothly with the speed of the slide.

use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use crate::limits::GRAVITY;

/// Coefficient of restitution of the contact, plus 1 (derived: one damping ratio of 0.15).
const REBOUND: f64 = 1.6;
/// Kinetic friction of steel on steel, for a first estimate of the mass.
const FRICTION: f64 = 0.16;
/// Relative standard deviation of both coefficients before the first tap.
const GUESS: f64 = 0.5;
/// Relative change of both coefficients from tap to tap.
const WALK: f64 = 0.05;
/// Relative scatter of the speed of a tap.
const SCATTER: f64 = 0.03;

/// The machine that hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hammer {
    /// Moving mass of the slide, kg.
    pub mass: f64,
    /// Stiffness of the servo, N/m.
    pub servo: f64,
    /// Stiffness of the pusher tip, N/m.
    pub tip: f64,
}

/// Speed of the tap (m/s) that moves the ring by d (m): v0 + k sqrt(d), both coefficients learned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TapLaw {
    mean: Vector2<f64>,
    covariance: Matrix2<f64>,
}

impl TapLaw {
    /// First estimate from the `deflection` (m) of the servo when it pushed this ring.
    pub fn guess(hammer: &Hammer, deflection: f64) -> Self {
        let friction = deflection * hammer.servo;
        let ring = friction / (FRICTION * GRAVITY);
        let reduced = ring * hammer.mass / (ring + hammer.mass);
        // a half sine of force; friction reduces the momentum as long as it lasts
        let contact = std::f64::consts::PI * (reduced / hammer.tip).sqrt();
        let momentum = REBOUND * reduced;
        // then the ring slides: d = F_k / (2 m) (u m / F_k)^2
        let mean = Vector2::new(friction * contact, (2.0 * friction * ring).sqrt()) / momentum;
        Self { mean, covariance: Matrix2::from_diagonal(&mean.map(|x| (GUESS * x).powi(2))) }
    }

    /// Speed (m/s) for the distance `d` (m).
    pub fn speed(&self, d: f64) -> f64 {
        self.mean.dot(&terms(d))
    }

    /// The tap law after a tap with `speed` (m/s) has moved the ring by `d` (m), known to `sigma` (m).
    #[must_use]
    pub fn after(&self, speed: f64, d: f64, sigma: f64) -> Self {
        let terms = terms(d);
        let prior = self.covariance + Matrix2::from_diagonal(&self.mean.map(|x| (WALK * x).powi(2)));
        // d is known to sigma, so its root is known to sigma / (2 root)
        let blur = self.mean.y * sigma / (2.0 * terms.y.max(sigma.sqrt()));
        let cross = prior * terms;
        let gain = cross / (terms.dot(&cross) + (SCATTER * speed).powi(2) + blur.powi(2));
        let mean = self.mean + gain * (speed - self.speed(d));
        // a faster blow always moves more
        let mean = Vector2::new(mean.x.max(0.0), mean.y.max(0.1 * self.mean.y));
        let covariance = prior - gain * cross.transpose();
        Self { mean, covariance: 0.5 * (covariance + covariance.transpose()) }
    }
}

fn terms(d: f64) -> Vector2<f64> {
    Vector2::new(1.0, d.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 8 kg on a servo of 40 Hz before 70 kg, whose kinetic friction of 109.8 N deflects it by 0.217 mm.
    const HAMMER: Hammer = Hammer { mass: 8.0, servo: 505_323.745_335_775_14, tip: 5e6 };
    const DEFLECTION: f64 = 2.173_624_354_957_139_7e-4;

    fn guess() -> TapLaw {
        TapLaw::guess(&HAMMER, DEFLECTION)
    }

    #[test]
    fn the_first_guess_is_the_balance_of_momentum_and_friction() {
        // 11.49 kg v = 109.8 N x 3.76 ms + sqrt(2 x 109.8 N x 70 kg x d)
        for (d, speed) in [(-1e-6, 0.035_995_8), (0.0, 0.035_995_8), (1e-5, 0.070_133_0), (1e-4, 0.143_947_1)] {
            assert!((guess().speed(d) - speed).abs() < 1e-7, "{d} m: {} m/s", guess().speed(d));
        }
        let uncertainty = guess().covariance.diagonal().map(f64::sqrt);
        assert!((uncertainty - 0.5 * guess().mean).norm() < 1e-12);
    }

    #[test]
    fn one_blow_is_taken_in_as_a_kalman_filter_does() {
        // a ring that stays identifies v0 only
        let (speed, sigma) = (0.05, 1e-8);
        let before = guess();
        let after = before.after(speed, 0.0, sigma);
        let prior = (0.25 + 0.0025) * before.mean.x.powi(2);
        let noise = (0.03 * speed).powi(2) + (before.mean.y * sigma / 2e-4).powi(2);
        let gain = prior / (prior + noise);
        assert!((after.mean.x - before.mean.x - gain * (speed - before.mean.x)).abs() < 1e-12);
        assert!((after.covariance[(0, 0)] / (prior * (1.0 - gain)) - 1.0).abs() < 1e-9);
        assert_eq!(after.mean.y, before.mean.y);
    }

    #[test]
    fn what_is_known_badly_teaches_less() {
        let d = 4e-5;
        let sharp = guess().after(0.15, d, 1e-8).speed(d) - guess().speed(d);
        let vague = guess().after(0.15, d, 2e-5).speed(d) - guess().speed(d);
        assert!(0.0 < vague && vague < 0.9 * sharp, "{vague} m/s against {sharp}");
    }

    #[test]
    fn blows_teach_the_law_of_the_ring() {
        let ring = |d: f64| 0.02 + 16.0 * d.sqrt();
        let mut law = guess();
        for d in [1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 3e-5] {
            law = law.after(ring(d), d, 1e-7);
        }
        for d in [5e-6, 2e-5, 8e-5] {
            assert!((law.speed(d) / ring(d) - 1.0).abs() < 0.05, "{d} m: {} of {} m/s", law.speed(d), ring(d));
        }
    }

    #[test]
    fn a_faster_blow_always_moves_more() {
        let law = guess().after(1e-3, 1e-3, 1e-7);
        assert!(law.mean.x >= 0.0 && law.mean.y >= 0.1 * guess().mean.y);
        assert!(law.speed(1e-5) < law.speed(2e-5));
    }
}

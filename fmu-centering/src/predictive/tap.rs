//! Tapping: a heavy ring is not pushed but hit by the slide, which springs back.
//!
//! A soft servo stores the static friction and lets a heavy ring jump when it gives way, so a push cannot end finely.
//! A blow does not press: the ring slides a distance that grows smoothly with the speed of the slide.

use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use crate::limits::GRAVITY;

/// Share of the speed that the contact gives back, plus 1 (derived: one damping ratio of 0.15).
const REBOUND: f64 = 1.6;
/// Kinetic friction of steel on steel, for a first guess of the mass.
const FRICTION: f64 = 0.16;
/// Relative standard deviation of both coefficients before the first blow.
const GUESS: f64 = 0.5;
/// Relative change of both coefficients from blow to blow.
const WALK: f64 = 0.05;
/// Relative scatter of the speed of a blow.
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

/// Speed of the blow (m/s) that moves the ring by d (m): v0 + k sqrt(d), both coefficients learned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TapLaw {
    mean: Vector2<f64>,
    covariance: Matrix2<f64>,
}

impl TapLaw {
    /// First guess from the `deflection` (m) of the servo when it pushed this ring.
    pub fn guess(hammer: &Hammer, deflection: f64) -> Self {
        let friction = deflection * hammer.servo;
        let ring = friction / (FRICTION * GRAVITY);
        let reduced = ring * hammer.mass / (ring + hammer.mass);
        // a half sine of force; friction takes its share as long as it lasts
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

    /// The law after a blow with `speed` (m/s) has moved the ring by `d` (m), known to `sigma` (m).
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

//! The polishing force: the sensor without its zero, filtered, and what of it is controlled (eq. 5).

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::parameters::Parameters;

/// What of the measured force is controlled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ForceMode {
    /// Its norm, friction included.
    Norm = 1,
    /// Its part along the normal.
    Projected = 2,
}

/// A measured force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Force on the tool, N.
    pub vector: Vector3<f64>,
    /// Its norm, N.
    pub norm: f64,
    /// Its part along the normal, N.
    pub normal: f64,
    /// The controlled one of both, N.
    pub controlled: f64,
}

/// Zero and filter of the sensor.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Gauge {
    sum: Vector3<f64>,
    samples: u32,
    zero: Vector3<f64>,
    filtered: Vector3<f64>,
}

impl Gauge {
    /// Without a zero.
    pub fn new() -> Self {
        let none = Vector3::zeros();
        Self { sum: none, samples: 0, zero: none, filtered: none }
    }

    /// Forgets the zero.
    pub fn restart(&mut self) {
        *self = Self::new();
    }

    /// Takes one raw force (N) for the zero; the zero, when there are enough.
    pub fn tare(&mut self, p: &Parameters, raw: &Vector3<f64>) -> Option<Vector3<f64>> {
        self.sum += raw;
        self.samples += 1;
        let enough = self.samples >= p.ticks(p.tare.time).max(1);
        enough.then(|| {
            self.zero = self.sum / f64::from(self.samples);
            self.filtered = Vector3::zeros();
            self.zero
        })
    }

    /// The force (N) behind one raw force, where the unit normal is `normal`.
    pub fn measure(&mut self, p: &Parameters, raw: &Vector3<f64>, normal: &Vector3<f64>) -> Measured {
        let keep = match p.force.filter_bandwidth {
            0.0 => 0.0,
            bandwidth => (-bandwidth * p.sample_period).exp(),
        };
        self.filtered = self.filtered * keep + (raw - self.zero) * (1.0 - keep);
        let (vector, norm, along) = (self.filtered, self.filtered.norm(), self.filtered.dot(normal));
        let controlled = match p.force.mode {
            ForceMode::Norm => norm,
            ForceMode::Projected => along,
        };
        Measured { vector, norm, normal: along, controlled }
    }
}

impl Default for Gauge {
    fn default() -> Self {
        Self::new()
    }
}

/// The wanted force: it moves with a limited rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SetPoint {
    /// Wanted force, N.
    pub force: f64,
}

impl SetPoint {
    /// Moves towards `target` (N) at `rate` (N/s) for one sample of `dt` s.
    pub fn step(&mut self, target: f64, rate: f64, dt: f64) {
        let change = rate * dt;
        self.force += (target - self.force).clamp(-change, change);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::DEFAULT;

    fn mode(mode: ForceMode) -> Parameters {
        Parameters { force: crate::parameters::Force { mode, ..P.force }, ..P }
    }

    #[test]
    fn norm_counts_friction_and_projection_does_not() {
        let (raw, normal) = (Vector3::new(0.8, 0.0, 4.0), Vector3::z());
        let norm = Gauge::new().measure(&mode(ForceMode::Norm), &raw, &normal);
        assert!((norm.controlled - 4.0 * 1.04f64.sqrt()).abs() < 1e-12);
        let along = Gauge::new().measure(&mode(ForceMode::Projected), &raw, &normal);
        assert_eq!(along.controlled, 4.0);
        assert_eq!((along.norm, norm.normal), (norm.controlled, 4.0));
    }

    #[test]
    fn the_zero_is_the_mean_of_the_tare() {
        let mut gauge = Gauge::new();
        let weight = Vector3::new(0.0, 0.1, -0.3);
        for k in 0..100 {
            let noise = if k % 2 == 0 { 0.05 } else { -0.05 };
            let zero = gauge.tare(&P, &weight.add_scalar(noise));
            assert_eq!(zero.is_some(), k == 99);
        }
        let measured = gauge.measure(&P, &(weight + Vector3::z()), &Vector3::z());
        assert!((measured.vector - Vector3::z()).norm() < 1e-12);
    }

    #[test]
    fn the_set_point_keeps_its_rate_and_arrives() {
        let mut set_point = SetPoint { force: 0.6 };
        for _ in 0..200 {
            let before = set_point.force;
            set_point.step(5.0, 25.0, 1e-3);
            assert!(set_point.force - before <= 0.025 + 1e-12);
        }
        assert_eq!(set_point.force, 5.0);
    }
}

//! The polishing force: the sensor without its zero, filtered, and what of it is controlled (eq. 5).

use control_blocks::ticks;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::orientation::Orientation;
use crate::interface::{ForceMode, Parameters};

/// A measured force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredForce {
    /// Force on the tool, N.
    pub vector: Vector3<f64>,
    /// The same before the low-pass, N.
    pub unfiltered: Vector3<f64>,
    /// Its norm, N.
    pub norm: f64,
    /// Its part along the normal, N.
    pub normal: f64,
    /// The controlled one of both, N.
    pub controlled: f64,
}

/// Zero and filter of the sensor.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ForceSensor {
    sum: Vector3<f64>,
    samples: u32,
    zero: Vector3<f64>,
    filtered: Vector3<f64>,
}

impl ForceSensor {
    /// Without a zero.
    pub fn new() -> Self {
        let none = Vector3::zeros();
        Self { sum: none, samples: 0, zero: none, filtered: none }
    }

    /// Discards the zero.
    pub fn restart(&mut self) {
        *self = Self::new();
    }

    /// Takes one raw force (N) for the zero; the zero, when there are enough.
    pub fn tare(&mut self, p: &Parameters, raw: &Vector3<f64>) -> Option<Vector3<f64>> {
        self.sum += raw;
        self.samples += 1;
        let enough = self.samples >= ticks(p.tare_time, p.sample_period).max(1);
        enough.then(|| {
            self.zero = self.sum / f64::from(self.samples);
            self.filtered = Vector3::zeros();
            self.zero
        })
    }

    /// The zero that was taken last, N.
    pub fn zero(&self) -> &Vector3<f64> {
        &self.zero
    }

    /// The force (N) for one raw force, where the unit normal is `normal`.
    pub fn measure(&mut self, p: &Parameters, raw: &Vector3<f64>, normal: &Vector3<f64>) -> MeasuredForce {
        let keep = match p.force.filter_bandwidth {
            0.0 => 0.0,
            bandwidth => (-bandwidth * p.sample_period).exp(),
        };
        let unfiltered = Orientation::of(p).work(&(raw - self.zero));
        self.filtered = self.filtered * keep + unfiltered * (1.0 - keep);
        let (vector, norm, along) = (self.filtered, self.filtered.norm(), self.filtered.dot(normal));
        let controlled = match p.force.mode {
            ForceMode::Norm => norm,
            ForceMode::Projected => along,
        };
        MeasuredForce { vector, unfiltered, norm, normal: along, controlled }
    }
}

impl Default for ForceSensor {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    fn mode(mode: ForceMode) -> Parameters {
        Parameters { force: crate::interface::Force { mode, ..P.force }, ..P }
    }

    #[test]
    fn norm_counts_friction_and_projection_does_not() {
        let (raw, normal) = (Vector3::new(0.8, 0.0, 4.0), Vector3::z());
        let norm = ForceSensor::new().measure(&mode(ForceMode::Norm), &raw, &normal);
        assert!((norm.controlled - 4.0 * 1.04f64.sqrt()).abs() < 1e-12);
        let along = ForceSensor::new().measure(&mode(ForceMode::Projected), &raw, &normal);
        assert_eq!(along.controlled, 4.0);
        assert_eq!((along.norm, norm.normal), (norm.controlled, 4.0));
    }

    #[test]
    fn the_low_pass_has_its_bandwidth_and_leaves_the_unfiltered_force() {
        let p = Parameters { force: crate::interface::Force { filter_bandwidth: 50.0, ..P.force }, ..P };
        let mut sensor = ForceSensor::new();
        for k in 1..100 {
            let measured = sensor.measure(&p, &Vector3::z(), &Vector3::z());
            let expected = 1.0 - (-50.0 * 1e-3 * f64::from(k)).exp();
            assert!((measured.normal - expected).abs() < 1e-12 && measured.unfiltered == Vector3::z(), "{measured:?}");
        }
    }

    #[test]
    fn the_zero_is_the_mean_of_the_tare() {
        let mut sensor = ForceSensor::new();
        let weight = Vector3::new(0.0, 0.1, -0.3);
        for k in 0..100 {
            let noise = if k % 2 == 0 { 0.05 } else { -0.05 };
            let zero = sensor.tare(&P, &weight.add_scalar(noise));
            assert_eq!(zero.is_some(), k == 99);
        }
        let measured = sensor.measure(&P, &(weight + Vector3::z()), &Vector3::z());
        assert!((measured.vector - Vector3::z()).norm() < 1e-12);
    }
}

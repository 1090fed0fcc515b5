//! Rigid misalignment of the mold from where the surface is met, by recursive least squares, and its feedforward.

use nalgebra::{Matrix6, Vector3, Vector6};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::path::centre_path::Frame;

/// Length that makes rotations as large as shifts, m.
const LEVER: f64 = 1e-3;
/// Variance of a measured distance, m2: 4 um, since the axes turn round and the force of a sample is not that of the next.
const NOISE: f64 = 1.6e-11;
/// Variance of each parameter at the start, m2: 0.1 mm, and 0.1 rad. The limits of a mold are unlikely values:
/// a wider prior spoils the first revolutions of a spiral, where shift and rotation have the same effect.
const START: f64 = 1e-8;
/// Forgetting factor of the least squares: a memory of 20 s at 1 kHz. Shorter memories are noisy.
const FORGETTING: f64 = 0.99995;
/// Largest sum of the variances, m2; forgetting stops there.
const TRACE_MAX: f64 = 6.0 * START;

/// The estimate: shift (m) and rotation (rad times the lever).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MisalignmentEstimate {
    estimate: Vector6<f64>,
    covariance: Matrix6<f64>,
}

impl MisalignmentEstimate {
    /// Nothing known.
    pub fn new() -> Self {
        Self { estimate: Vector6::zeros(), covariance: Matrix6::identity() * START }
    }

    /// Takes the distance `distance` (m) of the surface from the path along the normal at `frame`.
    pub fn update(&mut self, frame: &Frame, distance: f64) {
        let phi = regressor(frame);
        let spread = self.covariance * phi;
        let gain = spread / (NOISE + phi.dot(&spread));
        self.estimate += gain * (distance - phi.dot(&self.estimate));
        let mut covariance = self.covariance - gain * spread.transpose();
        // directions that are not excited would grow for ever
        if covariance.trace() < TRACE_MAX * FORGETTING {
            covariance /= FORGETTING;
        }
        // stays symmetric whatever the rounding
        self.covariance = (covariance + covariance.transpose()) * 0.5;
    }

    /// Velocity (m/s) of the surface along the normal from `here` to `next`, one sample later at the feed `feed` (m/s): no
    /// steeper than a mold can be; otherwise a frozen force would look like a surface that falls ever faster.
    pub fn velocity(&self, p: &Parameters, here: &Frame, next: &Frame, feed: f64) -> f64 {
        let change = self.estimate.dot(&(regressor(next) - regressor(here)));
        let maximum = p.limits.surface_slope * feed;
        (change / p.sample_period).clamp(-maximum, maximum)
    }

    /// Shift of the mold, m.
    pub fn shift(&self) -> Vector3<f64> {
        self.estimate.fixed_rows::<3>(0).into()
    }

    /// Rotation of the mold, rad.
    pub fn rotation(&self) -> Vector3<f64> {
        self.estimate.fixed_rows::<3>(3) / LEVER
    }
}

impl Default for MisalignmentEstimate {
    fn default() -> Self {
        Self::new()
    }
}

/// A mold shifted by d and turned by w moves its surface by n . d + w . (c x n) along the normal.
fn regressor(frame: &Frame) -> Vector6<f64> {
    let (n, rotation) = (frame.normal, frame.contact.cross(&frame.normal) / LEVER);
    Vector6::new(n.x, n.y, n.z, rotation.x, rotation.y, rotation.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// A spiral in a bowl that is no sphere.
    fn frame(k: u32) -> Frame {
        let (r, a) = (1e-7 * f64::from(k), 1e-2 * f64::from(k));
        let (x, y) = (r * a.cos(), r * a.sin());
        let normal = Vector3::new(-x / 3e-3, -y / 5e-3 + 0.05 * (3.0 * a).sin(), 1.0).normalize();
        let contact = Vector3::new(x, y, x * x / 6e-3 + y * y / 10e-3);
        Frame { centre: contact, contact, normal, tangent: Vector3::x(), ratio: 1.0, feed_max: 1.0 }
    }

    #[test]
    fn shift_and_rotation_are_found() {
        let (d, w) = (Vector3::new(50e-6, -30e-6, 70e-6), Vector3::new(0.02, -0.01, 0.005));
        let mut misalignment = MisalignmentEstimate::new();
        for k in 0..15_000 {
            let f = frame(k);
            let noise = if k % 2 == 0 { 0.5e-6 } else { -0.5e-6 };
            misalignment.update(&f, f.normal.dot(&(d + w.cross(&f.contact))) + noise);
        }
        assert!((misalignment.shift() - d).amax() < 1e-6, "{}", misalignment.shift());
        assert!((misalignment.rotation() - w).amax() < 1e-3, "{}", misalignment.rotation());
        let (here, next) = (frame(9000), frame(9001));
        let actual = |f: &Frame| f.normal.dot(&(d + w.cross(&f.contact)));
        let expected = (actual(&next) - actual(&here)) / P.sample_period;
        assert!((misalignment.velocity(&P, &here, &next, 1.0) - expected).abs() < 1e-5);
    }

    #[test]
    fn what_is_old_is_discarded_with_its_time() {
        // a mold that sinks after 10 s of turns on the same winding; the memory is 20 s
        let mut misalignment = MisalignmentEstimate::new();
        let at = |k: u32| frame(5_000 + k % 628);
        for k in 0..20_096 {
            let depth = if k < 10_048 { 50e-6 } else { 0.0 };
            misalignment.update(&at(k), depth * at(k).normal.z);
        }
        let estimate: f64 = (0..628).map(|k| regressor(&at(k)).dot(&misalignment.estimate)).sum();
        // what was before weighs e^-0.5 - e^-1 of 1 - e^-1, without forgetting half
        let ratio = estimate / 628.0 / 50e-6;
        assert!((ratio - 0.378).abs() < 0.03, "{ratio}");
    }

    #[test]
    fn without_excitation_nothing_grows_without_bound() {
        let mut misalignment = MisalignmentEstimate::new();
        let f = frame(0);
        for k in 0..1_000_000 {
            misalignment.update(&f, if k % 2 == 0 { 2e-6 } else { 0.0 });
        }
        assert!(misalignment.covariance.trace() <= TRACE_MAX * 1.001);
        assert!(misalignment.estimate.amax() < 2e-6);
    }
}

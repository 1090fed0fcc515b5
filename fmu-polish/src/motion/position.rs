//! Position feedback with switch matrix and clamped integral (eq. 6), by default in the tangent plane alone.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Limit of the integrated position error, m s: 0.1 mm for 2 s. It bounds what a blocked axis winds up.
const INTEGRAL_MAX: f64 = 0.2e-3;

/// Integral of the position error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PositionFeedback {
    integral: Vector3<f64>,
}

impl PositionFeedback {
    /// With nothing integrated.
    pub fn new() -> Self {
        Self { integral: Vector3::zeros() }
    }

    /// v_p (m/s) for the position error E_p = x_d - x (m), where the unit normal is `normal`.
    pub fn step(&mut self, p: &Parameters, error: &Vector3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
        let law = &p.position;
        let free = |v: &Vector3<f64>| if law.projected { v - normal * normal.dot(v) } else { *v };
        let (select, error, limit) = (law.select, free(error), INTEGRAL_MAX);
        let select = Vector3::new(select.x, select.y, select.z).map(|on| f64::from(u8::from(on)));
        self.integral = (self.integral + error * p.sample_period).map(|sum| sum.clamp(-limit, limit));
        // eq. 6; the paper's K_i is this one times the sample period
        let command = law.gain.vector().component_mul(&error) + law.integral.vector().component_mul(&self.integral);
        free(&select.component_mul(&command))
    }
}

impl Default for PositionFeedback {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axes::Axes;
    use crate::interface::Position;

    fn with(change: impl FnOnce(&mut Position)) -> Parameters {
        let mut p = Parameters::START;
        change(&mut p.position);
        p
    }

    #[test]
    fn projected_feedback_never_pushes_along_the_normal() {
        let p = with(|q| q.gain = Axes { x: 3.0, y: 5.0, z: 9.0 });
        let normal = Vector3::new(0.3, -0.4, 0.8).normalize();
        let v = PositionFeedback::new().step(&p, &Vector3::new(1e-5, 2e-5, -3e-5), &normal);
        assert!(v.norm() > 1e-5 && v.dot(&normal).abs() < 1e-18);
    }

    #[test]
    fn the_paper_switches_axes() {
        let v = PositionFeedback::new().step(&Parameters::PAPER, &Vector3::new(1e-5, 2e-5, 4e-5), &Vector3::z());
        assert_eq!(v, Vector3::new(0.0, 0.0, 4e-5));
    }

    #[test]
    fn the_integral_is_that_of_the_error_over_time() {
        let p = with(|q| {
            (q.gain, q.integral) = (Axes::ZERO, Axes { x: 2.0, y: 3.0, z: 0.0 });
            (q.projected, q.select) = (false, Axes::all(true));
        });
        let mut feedback = PositionFeedback::new();
        let steps = (0..500).map(|_| feedback.step(&p, &Vector3::new(1e-5, -2e-5, 7e-5), &Vector3::z()));
        let (last, time) = (steps.last().unwrap(), 500.0 * p.sample_period);
        assert!((last - Vector3::new(2e-5, -6e-5, 0.0) * time).norm() < 1e-16, "{last}");
    }

    #[test]
    fn the_integral_has_a_limit() {
        let p = with(|q| {
            q.gain = Axes::ZERO;
            q.integral = Axes::all(10.0);
        });
        let mut feedback = PositionFeedback::new();
        let mut v = Vector3::zeros();
        for _ in 0..10_000 {
            v = feedback.step(&p, &Vector3::new(1e-3, 0.0, 0.0), &Vector3::z());
        }
        assert_eq!(v.x, 10.0 * INTEGRAL_MAX);
    }
}

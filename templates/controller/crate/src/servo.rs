//! Position servo of a mass m with the following error e:
//!
//! ```text
//! force = m (a + w^2 e + 2 zeta w de/dt + w^2 w_i integral of e)
//! ```
//!
//! It gives e'' + 2 zeta w e' + w^2 e = 0 for a free mass and w_i = 0. Friction F then leaves the error F / (m w^2).

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// State of the servo between two samples.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PositionServo {
    /// m
    error: f64,
    /// N
    integral: f64,
}

impl PositionServo {
    /// Force (N) for a following error (m) at the setpoint's acceleration (m/s2).
    pub fn force(&mut self, p: &Parameters, error: f64, acceleration: f64) -> f64 {
        let (w, mass) = (p.servo.bandwidth, p.slide.mass);
        let rate = (error - self.error) / p.sample_period;
        let desired = mass * (acceleration + w * w * error + 2.0 * p.servo.damping * w * rate) + self.integral;
        let force = desired.clamp(-p.slide.force_max, p.slide.force_max);
        // anti-windup: no integration at the force limit
        if force == desired {
            self.integral += mass * w * w * p.servo.integral_bandwidth * error * p.sample_period;
        }
        self.error = error;
        force
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    #[test]
    fn a_constant_error_gives_stiffness_and_then_the_integral() {
        let mut servo = PositionServo { error: 1e-4, integral: 0.0 };
        let stiffness = P.slide.mass * P.servo.bandwidth.powi(2);
        let first = servo.force(&P, 1e-4, 0.0);
        assert!((first / (stiffness * 1e-4) - 1.0).abs() < 1e-12, "{first}");
        let growth = servo.force(&P, 1e-4, 0.0) / first - 1.0;
        assert!((growth / (P.servo.integral_bandwidth * P.sample_period) - 1.0).abs() < 1e-9, "{growth}");
    }

    #[test]
    fn the_integral_stops_at_the_force_limit() {
        let mut servo = PositionServo::default();
        for _ in 0..1000 {
            assert_eq!(servo.force(&P, 1.0, 0.0), P.slide.force_max);
        }
        assert_eq!(servo.integral, 0.0);
    }
}

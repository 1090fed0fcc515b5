//! Position servo of a mass m with the following error e:
//!
//! ```text
//! force = m (a + w^2 e + 2 zeta w de/dt + w^2 w_i integral of e)
//! ```
//!
//! so that e'' + 2 zeta w e' + w^2 e = 0 on a free mass with w_i = 0. A friction F leaves F / (m w^2) then.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// The servo between two samples; by default without error and integral.
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
        let wanted = mass * (acceleration + w * w * error + 2.0 * p.servo.damping * w * rate) + self.integral;
        let force = wanted.clamp(-p.slide.force_max, p.slide.force_max);
        // at the limit the integral stands still
        if force == wanted {
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
    fn a_standing_error_meets_the_stiffness_and_then_the_integral() {
        let mut servo = PositionServo { error: 1e-4, integral: 0.0 };
        let stiffness = P.slide.mass * P.servo.bandwidth.powi(2);
        let first = servo.force(&P, 1e-4, 0.0);
        assert!((first / (stiffness * 1e-4) - 1.0).abs() < 1e-12, "{first}");
        let growth = servo.force(&P, 1e-4, 0.0) / first - 1.0;
        assert!((growth / (P.servo.integral_bandwidth * P.sample_period) - 1.0).abs() < 1e-9, "{growth}");
    }

    #[test]
    fn at_the_limit_the_integral_stands_still() {
        let mut servo = PositionServo::default();
        for _ in 0..1000 {
            assert_eq!(servo.force(&P, 1.0, 0.0), P.slide.force_max);
        }
        assert_eq!(servo.integral, 0.0);
    }
}

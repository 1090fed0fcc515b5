//! Error in the rest after a run: a drifting position holds the axis away from its reference, by the drift over Kp.
//!
//! The mean is compared with the mean of the decaying lag of the servo without patterns, so that a slow drive is no drift.

use serde::{Deserialize, Serialize};

use crate::path::kinematics::{AXES, Joints};

/// Mean differences, and what they may be, rad or m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RestError {
    sum: Joints,
    allowed: Joints,
    count: u32,
}

impl RestError {
    /// Takes one sample.
    pub fn update(&mut self, difference: &Joints, allowed: &Joints) {
        for i in 0..AXES {
            self.sum[i] += difference[i];
            self.allowed[i] += allowed[i];
        }
        self.count += 1;
    }

    /// Means of the differences and of what is allowed; zeros without a sample.
    pub fn means(&self) -> (Joints, Joints) {
        let count = f64::from(self.count.max(1));
        (self.sum.map(|sum| sum / count), self.allowed.map(|sum| sum / count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_noise_is_its_middle() {
        let mut rest = RestError::default();
        assert_eq!(rest.means(), ([0.0; AXES], [0.0; AXES]));
        for k in 0..30 {
            rest.update(&[if k % 2 == 0 { 1.2e-4 } else { -0.8e-4 }; AXES], &[1e-3 * f64::from(k); AXES]);
        }
        let (mean, allowed) = rest.means();
        assert!(mean.iter().all(|mean| (mean - 2e-5).abs() < 1e-12));
        assert!(allowed.iter().all(|allowed| (allowed - 14.5e-3).abs() < 1e-12));
    }
}

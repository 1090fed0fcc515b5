//! Uncertainty of the position measured by one touch, as a function of its speed.

use serde::{Deserialize, Serialize};

use crate::calibration::bias::SPEEDS;

/// Scatter and uncertainty of the bias at each calibrated speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Speeds that were calibrated, the slowest first, m/s.
    pub speeds: [f64; SPEEDS],
    /// Scatter of a touch at each of them, m.
    pub touch: [f64; SPEEDS],
    /// Standard deviation of the bias at each of them, m.
    pub bias: [f64; SPEEDS],
}

impl Spread {
    /// The fastest speed that was calibrated, m/s.
    pub fn fastest(&self) -> f64 {
        self.speeds[SPEEDS - 1]
    }

    /// Standard deviation (m) of the position measured by a touch at `velocity` m/s: the variance is interpolated over
    /// the logarithm of the speed between calibrated speeds, and constant beyond them.
    pub fn at(&self, velocity: f64) -> f64 {
        let faster = self.speeds.iter().position(|speed| *speed >= velocity).unwrap_or(SPEEDS - 1).max(1);
        let [from, to] = [faster - 1, faster];
        let fraction = (velocity / self.speeds[from]).ln() / (self.speeds[to] / self.speeds[from]).ln();
        let fraction = fraction.clamp(0.0, 1.0);
        let variance = |i: usize| self.touch[i].powi(2) + self.bias[i].powi(2);
        ((1.0 - fraction) * variance(from) + fraction * variance(to)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_that_of_a_calibrated_speed_and_is_between_two_elsewhere() {
        let speeds = [1.0, 2.0, 4.0, 8.0, 16.0].map(|k| 1e-5 * k);
        let spread = Spread { speeds, touch: [3e-8, 1e-8, 1e-8, 2e-8, 6e-8], bias: [0.0; SPEEDS] };
        let near = |velocity: f64, expected: f64| {
            assert!((spread.at(velocity) / expected - 1.0).abs() < 1e-9, "{velocity}: {}", spread.at(velocity));
        };
        speeds.into_iter().zip(spread.touch).for_each(|(velocity, touch)| near(velocity, touch));
        // half of 900 and 100, and of 400 and 3600 nm2
        near(1e-5 * 2f64.sqrt(), 5f64.sqrt() * 1e-8);
        near(8e-5 * 2f64.sqrt(), 20f64.sqrt() * 1e-8);
        near(1e-6, 3e-8);
        near(1e-3, 6e-8);
        let uncertain = Spread { bias: [4e-8, 0.0, 0.0, 0.0, 8e-8], ..spread };
        assert!((uncertain.at(1e-5) - 5e-8).abs() < 1e-20 && (uncertain.at(1.6e-4) - 1e-7).abs() < 1e-20);
    }
}

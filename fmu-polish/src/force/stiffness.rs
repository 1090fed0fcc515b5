//! Stiffness of tool and contact: the slope of force over way while the force builds up.

use serde::{Deserialize, Serialize};

/// Forces below this say nothing, N.
const FORCE_MIN: f64 = 0.8;
/// Part of the target up to which samples are taken.
const TARGET_RATIO: f64 = 0.9;
/// Minimum and maximum of the estimated stiffness, over the nominal one.
const RATIO: (f64, f64) = (0.25, 4.0);
/// Fewest samples.
const SAMPLES_MIN: f64 = 10.0;
/// Minimum standard deviation of the travel, m.
const SPREAD_MIN: f64 = 1e-6;

/// Sums of the least squares; by default none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Slope {
    origin: Option<(f64, f64)>,
    count: f64,
    position: f64,
    force: f64,
    position_square: f64,
    position_force: f64,
}

impl Slope {
    /// Adds the force `force` (N) at the travel `position` (m) into the material, while the target is `target` N.
    pub fn update(&mut self, position: f64, force: f64, target: f64) {
        if force >= FORCE_MIN && force <= TARGET_RATIO * target {
            self.take(position, force);
        }
    }

    /// Takes the force `force` (N) at the way `position` (m).
    pub fn take(&mut self, position: f64, force: f64) {
        let (position_0, force_0) = *self.origin.get_or_insert((position, force));
        let (x, y) = (position - position_0, force - force_0);
        self.count += 1.0;
        self.position += x;
        self.force += y;
        self.position_square += x * x;
        self.position_force += x * y;
    }

    /// Stiffness, N/m, near `nominal`; `nominal` itself if the samples say nothing.
    pub fn stiffness(&self, nominal: f64) -> f64 {
        self.slope().map_or(nominal, |slope| slope.clamp(RATIO.0 * nominal, RATIO.1 * nominal))
    }

    /// Slope, N/m, if the samples determine it.
    pub fn slope(&self) -> Option<f64> {
        let n = self.count;
        let spread = n * self.position_square - self.position * self.position;
        if n < SAMPLES_MIN || spread < (n * SPREAD_MIN).powi(2) {
            return None;
        }
        Some((n * self.position_force - self.position * self.force) / spread)
    }

    /// Slope (N/m) that lines of different heights have in common, where the noise of each way has the deviation
    /// `noise` (m): it would flatten them.
    pub fn common(lines: &[Self], noise: f64) -> Option<f64> {
        let sums = lines.iter().filter(|line| line.count > 0.0).fold((0.0, 0.0), |(products, squares), line| {
            let n = line.count;
            let square = line.position_square - line.position * line.position / n - n * noise * noise;
            (products + line.position_force - line.position * line.force / n, squares + square)
        });
        (sums.1 > 0.0).then(|| sums.0 / sums.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_line_in_noise_and_pulses() {
        let mut slope = Slope::default();
        for k in 0..200 {
            let position = 1e-7 * f64::from(k);
            let noise = if k % 2 == 0 { 0.05 } else { -0.05 };
            slope.update(0.3 + (position * 1e6).round() * 1e-6, 240e3 * position + noise, 5.0);
        }
        assert!((slope.stiffness(178e3) / 240e3 - 1.0).abs() < 0.03, "{}", slope.stiffness(178e3));
    }

    #[test]
    fn lines_of_different_heights_have_their_slope_in_common_and_steps_of_the_way_do_not_flatten_it() {
        for (step, tolerance) in [(1e-9, 1e-3), (1e-6, 0.02)] {
            let mut lines = [Slope::default(); 40];
            for (i, line) in lines.iter_mut().enumerate() {
                // 4 um, from anywhere within a step
                (0..8).for_each(|k| {
                    let position = 0.5e-6 * f64::from(k) + 0.37e-6 * i as f64;
                    line.take((position / step).round() * step, 200e3 * position - 7.0 * i as f64);
                });
            }
            let found = Slope::common(&lines, step / 12f64.sqrt()).unwrap();
            assert!((found / 200e3 - 1.0).abs() < tolerance, "{step}: {found}");
        }
        assert_eq!(Slope::common(&[Slope::default(); 2], 0.0), None);
    }

    #[test]
    fn too_little_says_nothing() {
        let mut slope = Slope::default();
        assert_eq!(slope.stiffness(178e3), 178e3);
        (0..100).for_each(|_| slope.update(0.1, 2.0, 5.0));
        assert_eq!(slope.stiffness(178e3), 178e3);
    }

    #[test]
    fn forces_count_from_the_least_one_on_and_ten_of_them_suffice() {
        let slopes = [(0.8, 10, 2e5), (0.8, 9, 1e5), (0.79, 10, 1e5)];
        for (minimum, count, stiffness) in slopes {
            let mut slope = Slope::default();
            // one of them at the minimum force
            for k in 0..count {
                slope.update(1e-5 * f64::from(k), minimum + 2.0 * f64::from(k), 50.0);
            }
            assert!((slope.stiffness(1e5) / stiffness - 1.0).abs() < 1e-9, "{minimum} {count}");
        }
    }

    #[test]
    fn nonsense_is_limited() {
        let mut slope = Slope::default();
        (0..100).for_each(|k| slope.update(1e-6 * f64::from(k), 4.0 - 0.01 * f64::from(k), 5.0));
        assert_eq!(slope.stiffness(100e3), 25e3);
    }
}

//! Allan variance: white noise and random walk in a signal.
//!
//! With the means m_j of blocks of n samples that follow each other the Allan variance is the mean of (m_(j+1) - m_j)^2
//! / 2. Of white noise with the standard deviation r it is r^2 / n; of a random walk with steps of the standard
//! deviation q it is q^2 (2 n^2 + 1) / (6 n), since the difference of two blocks weighs the steps with a triangle. A
//! short and a long block determine both.

use serde::{Deserialize, Serialize};

/// Allan variance at one block length; by default without samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AllanVariance {
    samples: u32,
    sum: f64,
    before: Option<f64>,
    squares: f64,
    pairs: f64,
}

impl AllanVariance {
    /// Adds one sample; `length` is that of the blocks, samples.
    pub fn push(&mut self, length: u32, x: f64) {
        self.samples += 1;
        self.sum += x;
        if self.samples >= length.max(1) {
            let mean = self.sum / f64::from(self.samples);
            if let Some(before) = self.before.replace(mean) {
                self.squares += 0.5 * (mean - before).powi(2);
                self.pairs += 1.0;
            }
            (self.samples, self.sum) = (0, 0.0);
        }
    }

    /// The variance, 0 without two blocks.
    pub fn variance(&self) -> f64 {
        self.squares / self.pairs.max(1.0)
    }
}

/// Variances (walk q^2 of a step, white r^2 of a sample) that make the Allan variances `short` and `long` at blocks of the
/// lengths `short.0` < `long.0`; never negative.
pub fn walk_and_white(short: (u32, f64), long: (u32, f64)) -> (f64, f64) {
    let (n, m) = (f64::from(short.0), f64::from(long.0));
    // n A(n) = r^2 + q^2 n walk(n)
    let slope = m * of_walk(long.0) - n * of_walk(short.0);
    let step = ((m * long.1 - n * short.1) / slope).max(0.0);
    (step, (n * short.1 - step * n * of_walk(short.0)).max(0.0))
}

/// Allan variance that both together have at blocks of `length` samples, from their variances as [`walk_and_white`]
/// returns them.
pub fn of_walk_and_white((walk, white): (f64, f64), length: u32) -> f64 {
    walk * of_walk(length) + white / f64::from(length)
}

/// Allan variance of a random walk with steps of variance 1, at blocks of `length` samples.
fn of_walk(length: u32) -> f64 {
    (2.0 * f64::from(length).powi(2) + 1.0) / (6.0 * f64::from(length))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform noise of the variance 1/3 from a linear congruence.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn variances(walk: f64, white: f64) -> (f64, f64) {
        let (mut seed, mut position) = (7, 0.0);
        let (mut short, mut long) = (AllanVariance::default(), AllanVariance::default());
        for _ in 0..2_000_000 {
            position += walk * noise(&mut seed);
            let x = position + white * noise(&mut seed);
            short.push(100, x);
            long.push(1000, x);
        }
        walk_and_white((100, short.variance()), (1000, long.variance()))
    }

    #[test]
    fn white_noise_and_a_random_walk_are_distinguished() {
        for (walk, white) in [(0.0, 2.0), (0.01, 2.0), (0.1, 1.0), (0.3, 0.0)] {
            let found = variances(walk, white);
            let near = |x: f64, expected: f64, spread: f64| (3.0 * x - expected * expected).abs() < spread;
            assert!(near(found.0, walk, 0.1 * walk * walk + 1e-5), "{walk}, {white}: {found:?}");
            assert!(near(found.1, white, 0.1 * white * white + 30.0 * walk * walk), "{walk}, {white}: {found:?}");
        }
    }

    #[test]
    fn the_identified_parts_reproduce_the_variances() {
        for variances in [(3e-4, 2.0), (0.0, 1.0), (0.5, 0.0)] {
            let [short, long] = [10, 70].map(|n| (n, of_walk_and_white(variances, n)));
            let found = walk_and_white(short, long);
            assert!((found.0 - variances.0).abs() < 1e-12 && (found.1 - variances.1).abs() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn two_blocks_are_needed() {
        let mut allan = AllanVariance::default();
        (0..7).for_each(|k| allan.push(4, f64::from(k)));
        assert_eq!(allan.variance(), 0.0);
        allan.push(4, 7.0);
        // means 1.5 and 5.5
        assert_eq!(allan.variance(), 8.0);
    }

    #[test]
    fn nothing_is_negative() {
        assert_eq!(walk_and_white((10, 1.0), (100, 0.0)), (0.0, 10.0));
        let (walk, white) = walk_and_white((10, 0.0), (100, 1.0));
        assert!(walk > 0.0 && white == 0.0);
    }
}

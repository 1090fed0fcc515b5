//! Noise of position and force at the approach speed, stroke by stroke.
//!
//! The fourth difference of the position has 1 + 16 + 36 + 16 + 1 = 70 times the variance of white noise, and nothing
//! of a motion that is slower than some hundred samples. Variances are additive, so the strokes are averaged as
//! variances. The scatter s of n strokes gives the uncertainty of the mean: Student's distribution of n - 1 degrees of
//! freedom has (n - 1) / (n - 3) times the variance s^2 / n. The root of a variance V with standard deviation d has the
//! standard deviation (V + d)^(1/2) - V^(1/2).

use control_blocks::{AllanVariance, Welford, of_walk_and_white, ticks, walk_and_white};
use serde::{Deserialize, Serialize};

use crate::commission::plan::STROKES;
use crate::interface::{ForceOutput, Parameters};

/// Lengths of the blocks of the Allan variances, s: longer than the observer's memory, shorter than a stroke.
const BLOCKS: [f64; 3] = [0.01, 0.025, 0.05];
/// Variance of the fourth difference over that of white noise.
const FOURTH: f64 = 70.0;
/// Sum of the squares of its autocorrelation.
const ALIKE: f64 = 12_870.0 / (FOURTH * FOURTH);
/// Maximum of the unexplained part in the middle block, as the logarithm of a variance.
const UNEXPLAINED_MAX: f64 = 10.0;
/// Results of each stroke, as variances: noise of position and force, random walk of the force, sigma of the slope.
const NUMBERS: usize = 4;
const POSITION: usize = 0;
const WHITE: usize = 1;
const WALK: usize = 2;
const SLOPE: usize = 3;

/// A number and its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measure {
    /// The number.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// Noise of the strokes so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Noise {
    blocks: [u32; 3],
    /// the newest positions of this stroke, the newest first
    positions: [Option<f64>; 4],
    fourth: Welford,
    /// fourth differences of all strokes
    fourths: f64,
    slope: Welford,
    allan: [AllanVariance; 3],
    /// Allan variances of the strokes
    variances: [Welford; 3],
    force: Welford,
    strokes: [Welford; NUMBERS],
}

impl Noise {
    /// Nothing so far.
    pub fn new(p: &Parameters) -> Self {
        Self {
            blocks: BLOCKS.map(|time| ticks(time, p.sample_period).max(1)),
            positions: [None; 4],
            fourth: Welford::default(),
            fourths: 0.0,
            slope: Welford::default(),
            allan: Default::default(),
            variances: Default::default(),
            force: Welford::default(),
            strokes: Default::default(),
        }
    }

    /// Takes a position (m), if there is one, and the forces of a sample at constant speed.
    pub fn take(&mut self, position: Option<f64>, force: &ForceOutput) {
        if let (Some(z), [Some(a), Some(b), Some(c), Some(d)]) = (position, self.positions) {
            self.fourth.push(z - 4.0 * a + 6.0 * b - 4.0 * c + d);
        }
        self.positions.rotate_right(1);
        self.positions[0] = position;
        self.slope.push(force.slope);
        self.force.push(force.notched);
        for (allan, length) in self.allan.iter_mut().zip(self.blocks) {
            allan.push(length, force.notched);
        }
    }

    /// Ends a stroke.
    pub fn close(&mut self) {
        let variances = self.allan.each_ref().map(AllanVariance::variance);
        self.variances.iter_mut().zip(variances).for_each(|(mean, variance)| mean.push(variance));
        // that white noise alone, or a walk alone, would have: none is negative, and all scatter
        let white = f64::from(self.blocks[0]) * variances[0];
        let walk = variances[2] / of_walk_and_white((1.0, 0.0), self.blocks[2]);
        let numbers = [self.fourth.sigma().powi(2) / FOURTH, white, walk, self.slope.sigma().powi(2)];
        self.strokes.iter_mut().zip(numbers).for_each(|(stroke, number)| stroke.push(number));
        self.fourths += self.fourth.count();
        self.positions = [None; 4];
        (self.fourth, self.slope, self.allan) = Default::default();
    }

    /// Noise of the position, m. Fourth differences of white noise are alike to C(8, 4 + k) / 70, so that the variance
    /// of n of them is known to (2 / n sum over k of the squares)^(1/2) of it; that sum is C(16, 8) / 70^2.
    pub fn position(&self) -> Measure {
        let variance = self.strokes[POSITION].mean();
        root(variance, variance * (2.0 * ALIKE / self.fourths.max(1.0)).sqrt())
    }

    /// White force in one sample, N.
    pub fn white_force(&self) -> Measure {
        self.explained(WHITE)
    }

    /// Random walk of the force in one sample, N.
    pub fn walk(&self) -> Measure {
        self.explained(WALK)
    }

    /// Standard deviation of the slope, N/s.
    pub fn slope(&self) -> Measure {
        self.measure(SLOPE)
    }

    /// Standard deviation of the force over all strokes (N): what is slow has one value for each of them.
    pub fn force(&self) -> Measure {
        let sigma = self.force.sigma();
        Measure { value: sigma, deviation: sigma / f64::from(2 * STROKES).sqrt() }
    }

    fn walk_and_white(&self, [short, _, long]: [f64; 3]) -> (f64, f64) {
        walk_and_white((self.blocks[0], short), (self.blocks[2], long))
    }

    /// A value of the force; the part of the middle variance that random walk and white noise do not explain widens its
    /// uncertainty.
    fn explained(&self, number: usize) -> Measure {
        let variances = self.variances.each_ref().map(Welford::mean);
        let (walk, white) = self.walk_and_white(variances);
        let between = of_walk_and_white((walk, white), self.blocks[1]);
        let unexplained = (variances[1] / between).ln().abs().min(UNEXPLAINED_MAX);
        // of the means, as that of no stroke is less than 0
        let variance = if number == WHITE { white } else { walk };
        let Measure { value, deviation } = root(variance, self.spread(number));
        Measure { value, deviation: f64::hypot(deviation, unexplained * value) }
    }

    fn measure(&self, number: usize) -> Measure {
        root(self.strokes[number].mean(), self.spread(number))
    }

    /// Standard deviation of the mean of a number of all strokes.
    fn spread(&self, number: usize) -> f64 {
        let strokes = f64::from(STROKES);
        self.strokes[number].sigma() * ((strokes - 1.0) / (strokes - 3.0) / strokes).sqrt()
    }
}

/// Root of a variance that is known to `spread`.
fn root(variance: f64, spread: f64) -> Measure {
    Measure { value: variance.sqrt(), deviation: (variance + spread).sqrt() - variance.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn white_noise_on_a_motion_and_a_force_that_drifts_are_detected() {
        let p = Parameters::START;
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let (mut noise, mut wander) = (Noise::new(&p), 0.0);
        for _ in 0..STROKES {
            for k in 0..20_000 {
                let t = f64::from(k) * p.sample_period;
                wander += 2e-4 * normal();
                let force = ForceOutput {
                    notched: wander + 0.02 * normal(),
                    slope: 3.0 + 0.5 * normal(),
                    ..ForceOutput::START
                };
                let displacement = 1e-4 * t + 1e-6 * (300.0 * t).sin() + 2e-9 * normal();
                noise.take((k % 50 != 0).then_some(displacement), &force);
            }
            noise.close();
        }
        for (measure, expected, spread) in [
            (noise.position(), 2e-9, 0.02),
            (noise.white_force(), 0.02, 0.15),
            (noise.walk(), 2e-4, 0.15),
            (noise.slope(), 0.5, 0.02),
        ] {
            assert!((measure.value / expected - 1.0).abs() < spread, "{measure:?} {expected}");
            assert!(measure.deviation < spread * expected && measure.deviation > 0.0, "{measure:?}");
        }
        let force = noise.force();
        assert!(force.value > 0.02 && force.deviation == force.value / f64::from(2 * STROKES).sqrt(), "{force:?}");
    }

    #[test]
    fn a_force_that_oscillates_is_neither_white_nor_a_walk() {
        let p = Parameters::START;
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(6);
        let mut noise = Noise::new(&p);
        for stroke in 0..STROKES {
            for k in 0..5000 {
                let t = f64::from(k) * p.sample_period + 0.013 * f64::from(stroke);
                let normal: f64 = StandardNormal.sample(&mut random);
                let notched = 0.02 * (2.0 * std::f64::consts::PI * 18.0 * t).sin() + 0.005 * normal;
                noise.take(Some(0.0), &ForceOutput { notched, ..ForceOutput::START });
            }
            noise.close();
        }
        // all results are below three of their standard deviations
        for measure in [noise.white_force(), noise.walk()] {
            assert!(measure.value <= 3.0 * measure.deviation, "{measure:?}");
        }
        assert!(noise.white_force().value > 0.05, "{:?}", noise.white_force());
    }
}

//! Detects whether the noise of the encoder changes its value wherever the stage is, from samples in motion and at
//! rest.
//!
//! At the edge of a step the smallest noise changes the last bit, and elsewhere none does. The second difference of
//! three consecutive samples is noise plus the negligible acceleration of a sample: rounding alone makes it at most two
//! steps. One sample in fifty beyond that shows a noise of at least three tenths of a step. With this noise the value
//! stays equal for 300 samples with a probability of 1e-13, at any position. A value that is held for some samples, as
//! by an importer with a longer step, jumps in motion: only changes in both samples are counted.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// A second difference beyond this is more than rounding, in steps.
const ROUNDING: f64 = 2.5;
/// Fraction of the samples that shows noise, and number of evaluated samples.
const LIVES: f64 = 0.02;
const MEMORY: f64 = 1000.0;

/// Evidence of noise so far; by default none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Life {
    /// the last two consecutive positions, m
    before: [Option<f64>; 2],
    ratio: f64,
    /// The value has noise wherever the stage is.
    pub anywhere: bool,
}

impl Life {
    /// Takes a position (m) at rest or at a steady speed, none otherwise.
    pub fn update(&mut self, p: &Parameters, position: Option<f64>) {
        if let ([Some(first), Some(second)], Some(third)) = (self.before, position) {
            let changes = first != second && second != third;
            let bent = changes && (third - 2.0 * second + first).abs() > ROUNDING * p.stage.encoder_resolution;
            self.ratio += (f64::from(u8::from(bent)) - self.ratio) / MEMORY;
            self.anywhere |= self.ratio > LIVES;
        }
        self.before = [self.before[1], position];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const P: Parameters = Parameters::START;

    /// Whether noise (steps) is detected on a stage that moves by `speed` steps per sample and is measured every `held`
    /// samples.
    fn lives(noise: f64, speed: f64, held: u32) -> bool {
        let (mut random, mut life, mut reading) = (rand_pcg::Pcg64Mcg::seed_from_u64(23), Life::default(), 0.0);
        for k in 0..100_000 {
            let normal: f64 = StandardNormal.sample(&mut random);
            let position: f64 = 0.37 + speed * f64::from(k) + noise * normal;
            if k % held == 0 {
                reading = position.round() * P.stage.encoder_resolution;
            }
            life.update(&P, (k % 50 > 0).then_some(reading));
        }
        life.anywhere
    }

    #[test]
    fn noise_of_half_a_step_is_life_in_motion_and_at_rest_and_rounding_is_none() {
        for speed in [0.0, 0.01, 0.5, 0.73, 10.0, 123.456] {
            let detected = [0.0, 0.1, 0.2, 0.5, 0.6, 3.0].map(|noise| lives(noise, speed, 1));
            assert_eq!(detected, [false, false, false, true, true, true], "{speed}");
            assert!([2, 5, 10].iter().all(|held| !lives(0.0, speed, *held)), "{speed}");
        }
    }
}

//! A reading that lives wherever the stage stands, by noise that is told in motion and at rest.
//!
//! At the edge of a step the least noise changes the last bit, and elsewhere none. The second difference of three readings in a row is noise but for
//! the acceleration, which is nothing in a sample: rounding alone makes it at most two steps. One in fifty beyond that is a noise of three tenths of a
//! step at least, of which a reading stays at one number for 300 samples with 1e-13, wherever it is. A reading that is held for some samples, as by an
//! importer with a longer step, jumps in motion: only what changes in both samples counts.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// A second difference beyond this is more than rounding, in steps.
const ROUNDING: f64 = 2.5;
/// Share of the readings by which one lives, and how many tell it.
const LIVES: f64 = 0.02;
const TOLD: f64 = 1000.0;

/// What the readings have said so far; by default nothing.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Life {
    /// the last two readings in a row, m
    before: [Option<f64>; 2],
    share: f64,
    /// It lives, wherever the stage stands.
    pub anywhere: bool,
}

impl Life {
    /// Takes a reading (m) at rest or at a steady speed, none elsewhere.
    pub fn update(&mut self, p: &Parameters, position: Option<f64>) {
        if let ([Some(first), Some(second)], Some(third)) = (self.before, position) {
            let changes = first != second && second != third;
            let bent = changes && (third - 2.0 * second + first).abs() > ROUNDING * p.stage.encoder_resolution;
            self.share += (f64::from(u8::from(bent)) - self.share) / TOLD;
            self.anywhere |= self.share > LIVES;
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

    /// Whether a reading with so much noise (steps) lives, of a stage that moves by `speed` steps in a sample and is read every `held` samples.
    fn lives(noise: f64, speed: f64, held: u32) -> bool {
        let (mut random, mut life, mut reading) = (rand_pcg::Pcg64Mcg::seed_from_u64(23), Life::default(), 0.0);
        for k in 0..100_000 {
            let normal: f64 = StandardNormal.sample(&mut random);
            let place: f64 = 0.37 + speed * f64::from(k) + noise * normal;
            if k % held == 0 {
                reading = place.round() * P.stage.encoder_resolution;
            }
            life.update(&P, (k % 50 > 0).then_some(reading));
        }
        life.anywhere
    }

    #[test]
    fn noise_of_half_a_step_is_life_in_motion_and_at_rest_and_rounding_is_none() {
        for speed in [0.0, 0.01, 0.5, 0.73, 10.0, 123.456] {
            let told = [0.0, 0.1, 0.2, 0.5, 0.6, 3.0].map(|noise| lives(noise, speed, 1));
            assert_eq!(told, [false, false, false, true, true, true], "{speed}");
            assert!([2, 5, 10].iter().all(|held| !lives(0.0, speed, *held)), "{speed}");
        }
    }
}

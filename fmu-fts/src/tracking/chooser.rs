//! Chooses the harmonics to be canceled: those of the tracking error that repeat with the same phase.
//!
//! A disturbance that does not turn with the spindle has another phase in every revolution; learning would only amplify
//! it. Over some turns the mean of a harmonic c is compared with its scatter s: it repeats if |mean c| > LEVEL s /
//! sqrt(TURNS).

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::interface::ERROR_HARMONICS;
use crate::lists::harmonics::Harmonics;

/// Revolutions that are evaluated together.
const REVOLUTIONS: u32 = 8;
/// Mean over its standard deviation; noise alone reaches it in one of 300 cases.
const LEVEL: f64 = 3.0;

/// Sums over the present turns and the choice so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Chooser {
    revolutions: u32,
    sums: [Complex<f64>; ERROR_HARMONICS],
    squares: [f64; ERROR_HARMONICS],
    chosen: Harmonics,
}

impl Default for Chooser {
    fn default() -> Self {
        let sums = [Complex::new(0.0, 0.0); ERROR_HARMONICS];
        Self { revolutions: 0, sums, squares: [0.0; ERROR_HARMONICS], chosen: Harmonics::NONE }
    }
}

impl Chooser {
    /// Takes the harmonics of the error over one full turn, n = 1 first.
    pub fn add(&mut self, revolution: &[Complex<f64>; ERROR_HARMONICS]) {
        for ((sum, square), c) in self.sums.iter_mut().zip(&mut self.squares).zip(revolution) {
            *sum += c;
            *square += c.norm_sqr();
        }
        self.revolutions += 1;
        if self.revolutions == REVOLUTIONS {
            let repeats = (1..=ERROR_HARMONICS).filter(|n| self.repeats(n - 1));
            *self = Self { chosen: repeats.fold(self.chosen, Harmonics::with), ..Self::default() };
        }
    }

    /// The harmonics that have repeated so far.
    pub fn chosen(&self) -> Harmonics {
        self.chosen
    }

    fn repeats(&self, i: usize) -> bool {
        let count = f64::from(REVOLUTIONS);
        let mean = self.sums[i].norm_sqr() / (count * count);
        let variance = (self.squares[i] - count * mean) / (count - 1.0);
        mean > LEVEL * LEVEL * variance / count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    fn chosen(revolutions: u32, harmonic: impl Fn(usize, f64) -> Complex<f64>) -> Harmonics {
        let mut chooser = Chooser::default();
        for revolution in 0..revolutions {
            chooser.add(&std::array::from_fn(|i| harmonic(i + 1, f64::from(revolution))));
        }
        chooser.chosen()
    }

    #[test]
    fn what_repeats_is_chosen_after_eight_turns_and_stays() {
        let error = |n: usize, revolution: f64| {
            let amplitude = if n == 2 || n == 12 { 1e-6 } else { 0.0 };
            Complex::new(amplitude + 1e-7 * (revolution * n as f64).sin(), 1e-7 * (1.7 * revolution * n as f64).cos())
        };
        assert_eq!(chosen(7, error), Harmonics::NONE);
        let first = chosen(8, error);
        assert!(first.contains(2) && first.contains(12), "{first:?}");
        assert_eq!(chosen(8, |n, _| error(n, 0.0) * 0.0), Harmonics::NONE);
    }

    #[test]
    fn a_phase_that_runs_away_is_not_chosen() {
        // 120 Hz at 580 rpm: 12.41 cycles per revolution
        let error = |n: usize, revolution: f64| {
            Complex::from_polar(if n == 12 { 1e-6 } else { 1e-9 }, 0.41 * std::f64::consts::TAU * revolution)
        };
        assert_eq!(chosen(80, error), Harmonics::NONE);
    }

    #[test]
    fn noise_is_hardly_ever_chosen() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(9);
        let mut count = 0;
        for _ in 0..1000 {
            let mut chooser = Chooser::default();
            for _ in 0..REVOLUTIONS {
                // twelve uniform numbers make a normal one
                let mut normal = || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
                chooser.add(&std::array::from_fn(|_| Complex::new(normal(), normal())));
            }
            count += chooser.chosen().iter().count();
        }
        // of 24 000
        assert!(count < 150, "{count}");
    }
}

//! Transition matrix F of the Kalman filter; most of its elements are 0.
//!
//! A force moves the stage, and each harmonic (c_h, s_h), of which c_h is a force, turns by its angle. Sums go from the
//! first state to the last, as those of a full matrix would.

use std::array;

use serde::{Deserialize, Serialize};

use crate::interface::HARMONICS_MAX;

/// Position, velocity, disturbance, then sine and cosine of each harmonic.
pub const STATES: usize = 3 + 2 * HARMONICS_MAX;

/// The matrix F by its elements that are not 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Transition {
    /// sample period, s
    period: f64,
    /// motion (m) and velocity (m/s) that 1 N of the disturbance adds in a sample
    disturbed: [f64; 2],
    harmonics: [Harmonic; HARMONICS_MAX],
}

/// A harmonic: by default of frequency zero and without effect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Harmonic {
    /// motion (m) and velocity (m/s) that 1 N of it adds in a sample
    adds: [f64; 2],
    sine: f64,
    cosine: f64,
}

impl Default for Harmonic {
    fn default() -> Self {
        Self { adds: [0.0; 2], sine: 0.0, cosine: 1.0 }
    }
}

impl Transition {
    /// A free stage, no harmonic turns: with the sample `period` (s), and motion (m) and velocity (m/s) that 1 N of
    /// disturbance adds in it.
    pub fn free(period: f64, disturbed: [f64; 2]) -> Self {
        Self { period, disturbed, ..Self::default() }
    }

    /// The `harmonic` turns by `theta` rad in a sample, and is a force as the disturbance is; the first is 1.
    pub fn rotate(&mut self, harmonic: usize, theta: f64) {
        let (sine, cosine) = theta.sin_cos();
        self.harmonics[harmonic - 1] = Harmonic { adds: self.disturbed, sine, cosine };
    }

    /// F x.
    pub fn of(&self, mut x: [f64; STATES]) -> [f64; STATES] {
        let mut forced = [x[0] + x[1] * self.period + x[2] * self.disturbed[0], x[1] + x[2] * self.disturbed[1]];
        for (Harmonic { adds, sine, cosine }, pair) in self.harmonics.iter().zip(x[3..].chunks_exact_mut(2)) {
            let [c, s] = [pair[0], pair[1]];
            forced = [forced[0] + c * adds[0], forced[1] + c * adds[1]];
            (pair[0], pair[1]) = (c * cosine + s * -sine, c * sine + s * cosine);
        }
        [x[0], x[1]] = forced;
        x
    }

    /// F P F', row by row, of a P that is given column by column.
    pub fn around(&self, p: [[f64; STATES]; STATES]) -> [[f64; STATES]; STATES] {
        let left = p.map(|column| self.of(column));
        array::from_fn(|i| self.of(array::from_fn(|j| left[j][i])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{SMatrix, SVector};

    #[test]
    fn it_is_the_full_matrix_to_the_bit() {
        let (period, disturbed, theta) = (1e-4, [-5e-10, -1e-5], 0.3);
        let mut transition = Transition::free(period, disturbed);
        transition.rotate(2, theta);
        let mut full = SMatrix::<f64, STATES, STATES>::identity();
        full[(0, 1)] = period;
        for force in [2, 5] {
            (full[(0, force)], full[(1, force)]) = disturbed.into();
        }
        let (sine, cosine) = theta.sin_cos();
        (full[(5, 5)], full[(5, 6)]) = (cosine, -sine);
        (full[(6, 5)], full[(6, 6)]) = (sine, cosine);

        let m = SMatrix::from_fn(|i, j| (1.0 + i as f64 * 3.7 + j as f64 * 1.3).sin());
        assert_eq!(SVector::from(transition.of(m.data.0[0])), full * m.column(0));
        assert_eq!(transition.around(m.data.0), (full * m * full.transpose()).transpose().data.0);
    }
}

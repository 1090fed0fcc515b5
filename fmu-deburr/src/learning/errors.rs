//! Control errors of one repetition: the largest and the root mean square, of each axis and at the tip.

use serde::{Deserialize, Serialize};

use crate::path::kinematics::{AXES, Joints};

/// Control error of one repetition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Root mean square, rad or m.
    pub rms: Joints,
    /// Largest magnitude, rad or m.
    pub peak: Joints,
    /// Root mean square of the sum over all axes at the tip, m.
    pub cost: f64,
    /// Largest of any axis, at the tip, m.
    pub tip: f64,
}

/// Sums over the samples of a repetition; by default none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct ErrorSums {
    sums: Errors,
    count: usize,
}

impl ErrorSums {
    /// Takes the control error of a sample (pulses); `levers` are the motions of the tip per axis.
    pub fn take(&mut self, error: &Joints, pulses: &Joints, levers: &Joints) {
        self.count += 1;
        for i in 0..AXES {
            let error = error[i] * pulses[i];
            self.sums.rms[i] += error * error;
            self.sums.peak[i] = self.sums.peak[i].max(error.abs());
            self.sums.cost += (error * levers[i]) * (error * levers[i]);
            self.sums.tip = self.sums.tip.max((error * levers[i]).abs());
        }
    }

    /// Root mean squares and peaks over all samples so far; zeros without a sample.
    pub fn errors(&self) -> Errors {
        let count = self.count.max(1) as f64;
        let Errors { rms, cost, .. } = self.sums;
        Errors { rms: rms.map(|sum| (sum / count).sqrt()), cost: (cost / count).sqrt(), ..self.sums }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_reported_in_physical_units() {
        let mut sums = ErrorSums::default();
        (0..50).for_each(|k| sums.take(&[if k % 2 == 0 { 3.0 } else { -4.0 }; AXES], &[1e-6; AXES], &[2.0; AXES]));
        let Errors { rms, peak, cost, tip } = sums.errors();
        assert!((rms[0] - 12.5_f64.sqrt() * 1e-6).abs() < 1e-15 && (peak[5] - 4e-6).abs() < 1e-15);
        // six axes of which each moves the tip by twice its error
        assert!((cost - 2.0 * 75.0_f64.sqrt() * 1e-6).abs() < 1e-15 && (tip - 8e-6).abs() < 1e-15);
    }

    #[test]
    fn no_sample_is_no_error() {
        assert_eq!(ErrorSums::default().errors(), Errors::default());
    }
}

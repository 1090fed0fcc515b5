//! Noise of a measurement from its second difference, which slow signals do not affect. White noise of the standard
//! deviation s has d = y(k) - 2 y(k-1) + y(k-2) with the variance 6 s^2.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Memory, s.
const NOISE_TIME: f64 = 0.1;
/// Variance of the second difference over that of the noise.
const DIFFERENCES: f64 = 6.0;
/// Limit of a difference, in standard deviations: one spike is no noise.
const CLIP: f64 = 4.0;

/// Noise of one measurement, in its unit; by default none is known.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Noise {
    /// the last two measurements
    last: Option<(f64, f64)>,
    variance: f64,
}

impl Noise {
    /// Adds a measurement; `largest` is the largest standard deviation without limitation.
    pub fn update(&mut self, p: &Parameters, reading: f64, largest: f64) {
        if let Some((one, two)) = self.last {
            let maximum = DIFFERENCES * (CLIP * largest).powi(2);
            let difference = (reading - 2.0 * one + two).powi(2).min(maximum);
            self.variance += memory(p, NOISE_TIME) * (difference / DIFFERENCES - self.variance);
        }
        self.last = Some((reading, self.last.map_or(reading, |(one, _)| one)));
    }

    /// Standard deviation.
    pub fn deviation(&self) -> f64 {
        self.variance.sqrt()
    }
}

/// Fraction of a new sample in a mean over `time` s.
pub fn memory(p: &Parameters, time: f64) -> f64 {
    -(-p.sample_period / time).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const P: Parameters = Parameters::START;
    const LARGEST: f64 = 0.35;

    #[test]
    fn noise_is_reported_as_its_standard_deviation_on_any_signal() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        let sigma = 0.5 * LARGEST;
        // in 100 ms there are 100 samples, a third of them independent
        for slope in [0.0, 1e-3] {
            let mut noise = Noise::default();
            for k in 0..2000 {
                let white: f64 = StandardNormal.sample(&mut random);
                noise.update(&P, slope * f64::from(k) + sigma * white, LARGEST);
            }
            assert!((noise.deviation() / sigma - 1.0).abs() < 0.3, "{slope}: {noise:?}");
        }
    }

    #[test]
    fn one_spike_counts_as_four_deviations() {
        let mut noise = Noise::default();
        (0..5).for_each(|k| noise.update(&P, if k == 2 { 1e3 } else { 0.0 }, LARGEST));
        // three differences, each with the fraction of a sample in 100 ms
        assert!((noise.deviation() / (CLIP * LARGEST * 0.03f64.sqrt()) - 1.0).abs() < 0.02, "{noise:?}");
    }
}

//! The published model of the ring: from samples of the surface to the position of its center.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::center::{Center, Estimate};
use crate::paper::kalman::ScalarKalman;
use crate::sine_fit::SineSums;

/// The published model: Kalman filter, then a sine over one revolution, in either direction.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SineModel {
    filter: ScalarKalman,
    sums: SineSums,
    /// smallest and largest angle so far, rad
    range: Option<[f64; 2]>,
}

impl SineModel {
    /// Adds one sample of the collection loop: smoothed unwrapped spindle angle (rad), tip position (m).
    pub fn update(&mut self, angle: f64, tip: f64) {
        let filtered = self.filter.update(tip);
        self.sums.add(angle, filtered);
        let [low, high] = self.range.unwrap_or([angle; 2]);
        self.range = Some([low.min(angle), high.max(angle)]);
    }

    /// Whether the collection is complete.
    pub fn complete(&self) -> bool {
        self.range.is_some_and(|[low, high]| high - low >= TAU)
    }

    /// The model of the collected samples; none if they do not determine it.
    pub fn estimate(&self) -> Option<Estimate> {
        let sine = self.sums.fit()?;
        Some(Estimate { center: Center::from_sine(&sine), mean: sine.mean, sigma: sine.sigma })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use control_blocks::wrap;

    /// Collects a sine of 0.1 mm nearest at 1 rad at 66 Hz and `speed` rad/s; samples until complete.
    fn collected(speed: f64) -> (SineModel, u32) {
        let p = Parameters::PAPER;
        let mut model = SineModel::default();
        let mut count = 0;
        while !model.complete() && count < 10_000 {
            let angle = 100.0 + speed * f64::from(count) / p.rates.collect;
            model.update(angle, 0.03 - 1e-4 * (angle - 1.0).cos());
            count += 1;
        }
        (model, count)
    }

    #[test]
    fn one_revolution_is_collected_in_either_direction() {
        for speed in [2.0944, -2.0944] {
            let (model, count) = collected(speed);
            // 198 samples per revolution at 20 rpm, and the one that closes it
            assert_eq!(count, 199);
            let estimate = model.estimate().unwrap();
            assert!((estimate.mean - 0.03).abs() < 1e-6);
            assert!((estimate.center.eccentricity() - 1e-4).abs() < 1e-6, "{estimate:?}");
        }
    }

    #[test]
    fn the_filter_lags_behind_the_turning_as_its_gain_says() {
        // 1.56 samples: 2.84 deg at 20 rpm, with the direction of rotation
        for speed in [2.0944, -2.0944] {
            let center = collected(speed).0.estimate().unwrap().center;
            let lag = wrap(center.nearest() - 1.0).to_degrees() * speed.signum();
            assert!((lag - 2.84).abs() < 0.15, "{lag} deg");
        }
    }

    #[test]
    fn a_spindle_that_turns_back_completes_nothing() {
        let mut model = SineModel::default();
        for k in 0..10_000 {
            let angle = 3.0 * (0.01 * f64::from(k)).sin();
            model.update(angle, 0.03);
        }
        assert!(!model.complete());
    }
}

//! Frequency response of the position loop as it is used: the nominal loop, corrected by what was measured.
//!
//! The correction is the measured response over the nominal one. It changes slowly with the frequency, so that a few
//! points are enough where the response itself would need many.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::servo::loop_model::LoopModel;
use crate::servo::response::FrequencyResponse;

/// The response in use.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LoopResponse {
    model: LoopModel,
    correction: FrequencyResponse,
}

impl LoopResponse {
    /// The response of the nominal loop.
    pub fn nominal(model: LoopModel) -> Self {
        Self { model, correction: FrequencyResponse::EMPTY }
    }

    /// Takes a measured response; it replaces the one before.
    pub fn correct(&mut self, measured: &FrequencyResponse) {
        self.correction = FrequencyResponse::EMPTY;
        for point in measured.points() {
            self.correction.push(point.frequency, point.value() / self.model.closed(point.frequency));
        }
    }

    /// T at `omega` (rad/s, of either sign).
    pub fn at(&self, omega: f64) -> Complex<f64> {
        let correction = self.correction.at(omega.abs());
        self.model.closed(omega) * if omega < 0.0 { correction.conj() } else { correction }
    }

    /// T at these ascending frequencies, rad/s.
    pub fn tabulated(&self, frequencies: impl Iterator<Item = f64>) -> FrequencyResponse {
        let mut table = FrequencyResponse::EMPTY;
        frequencies.for_each(|omega| table.push(omega, self.at(omega)));
        table
    }

    /// The nominal loop.
    pub fn model(&self) -> &LoopModel {
        &self.model
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use crate::servo::design::design;
    use std::f64::consts::TAU;

    fn model(change: impl FnOnce(&mut Parameters)) -> LoopModel {
        let compensator = design(&Parameters::START).unwrap();
        let mut p = Parameters::START;
        change(&mut p);
        LoopModel::new(&p, compensator)
    }

    #[test]
    fn without_measurement_it_is_the_nominal_loop() {
        let response = LoopResponse::nominal(model(|_| ()));
        for omega in [-900.0, 0.0, 30.0, 3000.0] {
            assert_eq!(response.at(omega), response.model().closed(omega));
        }
    }

    #[test]
    fn twelve_points_find_a_loop_that_is_20_percent_off_to_2_percent() {
        // the arm is lighter, the flexure softer than nominal
        let real = model(|p| (p.servo.inertia, p.tip.frequency) = (0.8 * p.servo.inertia, 0.9 * p.tip.frequency));
        let mut measured = FrequencyResponse::EMPTY;
        for hertz in [10.0, 20.0, 40.0, 60.0, 90.0, 120.0, 160.0, 220.0, 300.0, 400.0, 500.0, 600.0] {
            measured.push(TAU * hertz, real.closed(TAU * hertz));
        }
        let mut response = LoopResponse::nominal(model(|_| ()));
        response.correct(&measured);
        for k in 1..60 {
            let omega = TAU * 10.0 * f64::from(k);
            let error = (response.at(omega) / real.closed(omega) - 1.0).norm();
            assert!(error < 0.02, "{} Hz: {error}", 10 * k);
            assert!((response.at(-omega) - response.at(omega).conj()).norm() < 1e-15);
        }
    }
}

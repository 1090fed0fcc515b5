//! Gain ratio of a machine to its commands: sign, strength, and missing response.
//!
//! Least squares of the measured response m on the modeled one c with exponential forgetting over n samples:
//! P' = (1 - 1/n) P + c m, Q' = (1 - 1/n) Q + c^2, ratio = P / Q. It is 1 for the machine that the model describes,
//! negative for a reversed sign, 0 for a disabled drive, below 1 for a weak one. With a noise of variance s^2 in
//! m the ratio has the standard deviation s / sqrt(Q), so it is meaningful only where Q > (s / accuracy)^2.

use serde::{Deserialize, Serialize};

/// Sums of the least squares; zero at first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Response {
    product: f64,
    square: f64,
}

impl Response {
    /// Adds one sample: response of the model and of the machine; `memory` in samples, at least 1.
    pub fn update(&mut self, modelled: f64, measured: f64, memory: f64) {
        let keep = 1.0 - memory.max(1.0).recip();
        self.product = keep * self.product + modelled * measured;
        self.square = keep * self.square + modelled * modelled;
    }

    /// Ratio of the measured to the modeled response; none below `excitation_min`, in the unit of the square.
    pub fn ratio(&self, excitation_min: f64) -> Option<f64> {
        let excitation_min = excitation_min.max(f64::MIN_POSITIVE);
        // divided in any case: a compiler that divides before the comparison raises no exception
        let ratio = self.product / self.square.max(excitation_min);
        (self.square > excitation_min).then_some(ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(of: f64, offset: f64) -> Option<f64> {
        let mut response = Response::default();
        for k in 0..2000 {
            let modelled = (f64::from(k) * 0.3).sin();
            response.update(modelled, of * modelled + offset * (f64::from(k) * 1.9).cos(), 500.0);
        }
        response.ratio(1.0)
    }

    #[test]
    fn the_ratio_is_that_of_the_machine() {
        for of in [1.0, 0.4, 0.0, -1.0, 1.7] {
            assert!((ratio(of, 0.0).unwrap() - of).abs() < 1e-12);
            assert!((ratio(of, 0.2).unwrap() - of).abs() < 0.01);
        }
    }

    #[test]
    fn without_excitation_nothing_is_said() {
        let mut response = Response::default();
        (0..1000).for_each(|_| response.update(1e-3, 5.0, 100.0));
        // the square tends to n c^2
        assert_eq!(response.ratio(1.01e-4), None);
        assert!(response.ratio(0.99e-4).is_some());
        assert_eq!(Response::default().ratio(0.0), None);
    }

    #[test]
    fn what_is_old_is_discarded() {
        let mut response = Response::default();
        (0..1000).for_each(|_| response.update(1.0, 1.0, 50.0));
        (0..500).for_each(|_| response.update(1.0, -1.0, 50.0));
        // 1 - 2 (1 - 0.98^500)
        assert!((response.ratio(1.0).unwrap() + 1.0).abs() < 1e-3);
    }
}

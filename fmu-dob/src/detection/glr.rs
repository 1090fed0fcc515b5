//! Generalised likelihood ratio: how well a contact that began n samples ago explains the innovations since.

use serde::{Deserialize, Serialize};

use crate::detection::kalman::{KalmanFilter, PredictionError};
use crate::interface::Parameters;

/// Bank of contact instants, one per sample of age, matched against the innovation of a unit force ramp.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OnsetBank {
    sample_period: f64,
    /// innovation response s_n of the filter to a force ramp of 1 N/s, m
    template: Vec<f64>,
    /// energy E_n, the sum of s_i^2 up to the newest sample of the template
    energy: f64,
    /// 1 / (2 E_n), by age
    weight: Vec<f64>,
    /// correlation T_n of the innovations with the template, by age
    correlation: Vec<f64>,
    built: usize,
    error: PredictionError,
}

impl OnsetBank {
    /// Empty bank.
    pub fn new(p: &Parameters) -> Self {
        let onsets = p.glr.onsets as usize;
        Self {
            sample_period: p.sample_period,
            template: vec![0.0; onsets],
            energy: 0.0,
            weight: vec![0.0; onsets],
            correlation: vec![0.0; onsets],
            built: 0,
            error: PredictionError::zeros(),
        }
    }

    /// Builds one sample of the template per call, once the gain of the filter is constant.
    pub fn build(&mut self, filter: &KalmanFilter) {
        if !filter.settled() {
            (self.built, self.energy, self.error) = (0, 0.0, PredictionError::zeros());
        } else if !self.ready() {
            let n = self.built;
            let force = (n as f64 + 0.5) * self.sample_period;
            let (response, error) = filter.error_step(&self.error, force);
            self.energy += response * response;
            self.template[n] = response;
            self.weight[n] = 0.5 / self.energy;
            (self.built, self.error) = (n + 1, error);
        }
    }

    /// Whether the template is complete.
    pub fn ready(&self) -> bool {
        self.built == self.template.len()
    }

    /// Forgets all innovations.
    pub fn clear(&mut self) {
        self.correlation.fill(0.0);
    }

    /// Largest log-likelihood ratio T_n^2 / (2 E_n sigma^2) of contact sign, after one more innovation (m).
    pub fn update(&mut self, innovation: f64, sigma: f64) -> f64 {
        // every onset is one sample older: T_n = T_(n-1) + s_n nu
        let last = self.correlation.len() - 1;
        self.correlation.copy_within(..last, 1);
        self.correlation[0] = 0.0;
        let mut largest = 0.0;
        for ((t, s), weight) in self.correlation.iter_mut().zip(&self.template).zip(&self.weight) {
            *t += s * innovation;
            let ratio = *t * t.abs() * weight;
            if ratio > largest {
                largest = ratio;
            }
        }
        largest / (sigma * sigma)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ready_bank() -> OnsetBank {
        let p = Parameters::START;
        let mut filter = KalmanFilter::new(&p);
        let mut bank = OnsetBank::new(&p);
        for _ in 0..3000 {
            filter.update(Some(0.0), 0.0, 3141.6);
            bank.build(&filter);
        }
        assert!(bank.ready());
        bank
    }

    #[test]
    fn matched_ramp_collects_all_its_energy() {
        let mut bank = ready_bank();
        let (sigma, slope) = (1e-9f64, 20.0);
        let ages = 120;
        let expected = (slope / sigma).powi(2) * bank.template[..ages].iter().map(|s| s * s).sum::<f64>() / 2.0;
        let response: Vec<f64> = bank.template[..ages].iter().map(|s| slope * s).collect();
        let ratio = response.iter().map(|nu| bank.update(*nu, sigma)).last();
        assert!((ratio.unwrap() / expected - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_template_begins_with_half_a_sample_of_the_ramp() {
        // 1 N/s for half a sample: 50 uN on 10 kg for 0.1 ms
        let first = ready_bank().template[0];
        assert!((first / -2.5e-14 - 1.0).abs() < 1e-9, "{first}");
    }

    #[test]
    fn pull_instead_of_push_is_no_contact() {
        let mut bank = ready_bank();
        let pull: Vec<f64> = bank.template[..60].iter().map(|s| -20.0 * s).collect();
        let ratio = pull.iter().map(|nu| bank.update(*nu, 1e-9)).last();
        assert!(ratio.unwrap() < 1.0, "{ratio:?}");
    }

    #[test]
    fn old_onsets_leave_the_bank() {
        let mut bank = ready_bank();
        bank.update(-1e-6, 1e-9);
        let quiet = (0..300).map(|_| bank.update(0.0, 1e-9)).last().unwrap();
        assert_eq!(quiet, 0.0);
    }

    #[test]
    fn a_cleared_bank_remembers_nothing() {
        let (fresh, mut bank) = (ready_bank(), ready_bank());
        (0..50).for_each(|_| _ = bank.update(-1e-6, 1e-9));
        bank.clear();
        assert_eq!(bank.update(-1e-9, 1e-9), fresh.clone().update(-1e-9, 1e-9));
    }
}

//! Generalized likelihood ratio: how well a contact that started n samples ago explains the innovations since then.
//!
//! T_n is the correlation of the innovations with the response to a force ramp since then. In white noise its variance
//! is E_n sigma^2, with the energy E_n of that response. Real noise is not white: interpolation of the encoder, floor
//! and wobble are slow. The variance of each T_n is therefore learned as well, and the larger one is used: L = T_n^2 /
//! (2 var T_n).

use serde::{Deserialize, Serialize};

use crate::detection::ages::Ages;
use crate::detection::kalman::{KalmanFilter, PredictionError};
use crate::interface::Parameters;

/// Bank of contact instants, one per sample of age, matched against the innovation of a unit force ramp.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OnsetBank {
    sample_period: f64,
    /// innovation response s_n of the filter to a force ramp of 1 N/s, m
    template: Vec<f64>,
    /// energy E_n, the sum of s_i^2 up to the newest sample of the template
    energy: Vec<f64>,
    /// correlation T_n of the innovations with the template, by age
    correlation: Ages,
    /// sum of T_n^2 while the noise is learned, by age
    squares: Vec<f64>,
    /// 1 / (2 var T_n), by age
    weight: Vec<f64>,
    /// T_n at which L is the alarm level, by age
    level: Vec<f64>,
    built: usize,
    error: PredictionError,
    /// innovations since the correlation was cleared, while learning
    seen: usize,
}

impl OnsetBank {
    /// Empty bank.
    pub fn new(p: &Parameters) -> Self {
        let empty = || vec![0.0; p.glr.onsets as usize];
        Self {
            sample_period: p.sample_period,
            template: empty(),
            energy: empty(),
            correlation: Ages::new(p.glr.onsets as usize),
            squares: empty(),
            weight: empty(),
            level: empty(),
            built: 0,
            error: PredictionError::zeros(),
            seen: 0,
        }
    }

    /// Builds one sample of the template per call, once the gain of the filter is constant.
    pub fn build(&mut self, filter: &KalmanFilter) {
        if !filter.settled() {
            (self.built, self.error) = (0, PredictionError::zeros());
        } else if !self.ready() {
            let n = self.built;
            let force = (n as f64 + 0.5) * self.sample_period;
            let (response, error) = filter.error_step(&self.error, force);
            let before = if n > 0 { self.energy[n - 1] } else { 0.0 };
            (self.template[n], self.energy[n]) = (response, before + response * response);
            (self.built, self.error) = (n + 1, error);
        }
    }

    /// Whether the template is complete.
    pub fn ready(&self) -> bool {
        self.built == self.template.len()
    }

    /// Discards all innovations and the learned variances.
    pub fn reset(&mut self) {
        self.clear();
        self.squares.fill(0.0);
        self.seen = 0;
    }

    /// Discards all innovations.
    pub fn clear(&mut self) {
        self.correlation.clear();
    }

    /// Learns how much the correlations with one more innovation (m) of mere noise scatter.
    pub fn learn(&mut self, innovation: f64) {
        self.seen += 1;
        // a correlation is whole once as many innovations are in it as its age
        let whole = self.seen >= self.correlation.count();
        let squares = self.squares.iter_mut();
        correlate(&mut self.correlation, &self.template, innovation, squares, |t, sum| {
            *sum += if whole { t * t } else { 0.0 };
        });
    }

    /// Weighs the ages by what was learned, with the standard deviation `sigma` (m) of the innovation and the alarm
    /// level `threshold` of L.
    pub fn arm(&mut self, sigma: f64, threshold: f64) {
        let count = (self.seen + 1).saturating_sub(self.correlation.count()).max(1) as f64;
        for ((weight, energy), squares) in self.weight.iter_mut().zip(&self.energy).zip(&self.squares) {
            *weight = 0.5 / f64::max(energy * sigma * sigma, squares / count);
        }
        self.level.iter_mut().zip(&self.weight).for_each(|(level, weight)| *level = (threshold / weight).sqrt());
    }

    /// Takes one more innovation (m); whether L of contact sign is above the alarm level at any age. T_n says so by
    /// itself, at half of the cost.
    pub fn update(&mut self, innovation: f64) -> bool {
        let mut above = false;
        correlate(&mut self.correlation, &self.template, innovation, &self.level, |t, level| above |= t > *level);
        above
    }

    /// Largest log-likelihood ratio of contact sign; 0 after [`Self::clear`].
    pub fn ratio(&self) -> f64 {
        let ratios = self.correlation.values().iter().zip(&self.weight).map(|(t, weight)| t * t.abs() * weight);
        ratios.fold(0.0, f64::max)
    }
}

/// Every onset is one sample older, T_n = T_(n-1) + s_n nu; each correlation is shown with what belongs to its age.
fn correlate<T>(
    correlation: &mut Ages,
    template: &[f64],
    innovation: f64,
    of_age: impl IntoIterator<Item = T>,
    mut show: impl FnMut(f64, T),
) {
    for ((t, s), own) in correlation.grow_older().iter_mut().zip(template).zip(of_age) {
        *t += s * innovation;
        show(*t, own);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const SIGMA: f64 = 1e-9;
    const LEVEL: f64 = 15.0;

    /// L after one more innovation.
    fn ratio(bank: &mut OnsetBank, innovation: f64) -> f64 {
        bank.update(innovation);
        bank.ratio()
    }

    fn empty_bank() -> OnsetBank {
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

    /// A bank that has learned from white noise of `SIGMA` only.
    fn ready_bank() -> OnsetBank {
        let mut bank = empty_bank();
        bank.arm(SIGMA, LEVEL);
        bank
    }

    #[test]
    fn matched_ramp_collects_all_its_energy() {
        let mut bank = ready_bank();
        let slope = 20.0;
        let ages = 120;
        let expected = (slope / SIGMA).powi(2) * bank.template[..ages].iter().map(|s| s * s).sum::<f64>() / 2.0;
        let response: Vec<f64> = bank.template[..ages].iter().map(|s| slope * s).collect();
        let ratio = response.iter().map(|nu| ratio(&mut bank, *nu)).last();
        assert!((ratio.unwrap() / expected - 1.0).abs() < 1e-9);
        assert_eq!(ratio, Some(bank.ratio()));
    }

    #[test]
    fn noise_that_goes_on_alike_weighs_the_same_however_long_it_is_learned() {
        let learned = |samples: usize| {
            let mut bank = empty_bank();
            // alternating: every correlation keeps its size
            (0..samples).for_each(|k| bank.learn(if k % 2 == 0 { 1e-6 } else { -1e-6 }));
            bank.arm(0.0, LEVEL);
            bank.weight
        };
        let ages = empty_bank().correlation.count();
        let (once, twice, often) = (learned(ages), learned(ages + 1), learned(ages + 100));
        assert!(
            once.iter()
                .zip(&twice)
                .zip(&often)
                .all(|((a, b), c)| (b / a - 1.0).abs() < 1e-9 && (c / a - 1.0).abs() < 1e-9)
        );
    }

    #[test]
    fn the_template_begins_with_half_a_sample_of_the_ramp() {
        // 1 N/s for half a sample: 50 uN on 10 kg for 0.1 ms
        let first = ready_bank().template[0];
        assert!((first / -2.5e-14 - 1.0).abs() < 1e-9, "{first}");
    }

    #[test]
    fn the_alarm_is_that_of_the_ratio_in_noise_that_crosses_its_level() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(12);
        let mut bank = empty_bank();
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        (0..5000).for_each(|_| bank.learn(SIGMA * normal()));
        bank.arm(SIGMA, 3.0);
        let alarms = (0..100_000).filter(|_| {
            let above = bank.update(SIGMA * normal());
            assert_eq!(above, bank.ratio() > 3.0);
            above
        });
        let alarms = alarms.count();
        assert!((1000..90_000).contains(&alarms), "{alarms}");
    }

    #[test]
    fn pull_instead_of_push_is_no_contact() {
        let mut bank = ready_bank();
        let pull: Vec<f64> = bank.template[..60].iter().map(|s| -20.0 * s).collect();
        let ratio = pull.iter().map(|nu| ratio(&mut bank, *nu)).last();
        assert!(ratio.unwrap() < 1.0, "{ratio:?}");
    }

    #[test]
    fn old_onsets_leave_the_bank() {
        let mut bank = ready_bank();
        bank.update(-1e-6);
        let quiet = (0..300).map(|_| ratio(&mut bank, 0.0)).last().unwrap();
        assert_eq!(quiet, 0.0);
    }

    #[test]
    fn a_cleared_bank_stores_nothing() {
        let (fresh, mut bank) = (ready_bank(), ready_bank());
        (0..50).for_each(|_| _ = bank.update(-1e-6));
        bank.clear();
        assert_eq!(bank.ratio(), 0.0);
        assert_eq!(ratio(&mut bank, -1e-9), ratio(&mut fresh.clone(), -1e-9));
    }

    #[test]
    fn white_noise_counts_by_the_energy_of_the_template() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(11);
        let mut bank = empty_bank();
        (0..200_000).for_each(|_| bank.learn(SIGMA * Distribution::<f64>::sample(&StandardNormal, &mut random)));
        bank.arm(SIGMA, LEVEL);
        for ((weight, energy), age) in bank.weight.iter().zip(&bank.energy).zip(0..) {
            let ratio = 0.5 / (energy * SIGMA * SIGMA) / weight;
            // never less than what white noise is, and hardly more
            assert!((1.0..1.15).contains(&ratio), "age {age}: {ratio}");
        }
    }

    #[test]
    fn what_oscillates_slowly_while_the_noise_is_learned_is_no_contact_afterwards() {
        let oscillation = |k: i32| 0.3 * SIGMA * (0.02 * f64::from(k)).sin();
        let largest = |mut bank: OnsetBank| (0..5000).map(|k| ratio(&mut bank, oscillation(k))).fold(0.0, f64::max);
        let mut learned = empty_bank();
        (0..5000).for_each(|k| learned.learn(oscillation(k)));
        learned.arm(SIGMA, LEVEL);
        learned.clear();
        let (naive, learned) = (largest(ready_bank()), largest(learned));
        // a sine is at most sqrt(2) of its own rms
        assert!(learned < 1.05 && naive > 3.0, "{learned} {naive}");
    }

    #[test]
    fn a_reset_discards_what_was_learned() {
        let mut bank = empty_bank();
        (0..5000).for_each(|_| bank.learn(1e-8));
        bank.reset();
        bank.arm(SIGMA, LEVEL);
        let fresh = ready_bank();
        assert_eq!(bank.weight, fresh.weight);
        assert_eq!((bank.correlation.values(), bank.seen), (fresh.correlation.values(), 0));
    }
}

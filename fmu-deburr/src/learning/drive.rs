//! A drive as configured, eq. 1 with a gain and a delay, and the estimate of a drive from its weights.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Weights of an axis.
pub(crate) const TAPS: usize = 3;
/// Standard deviation of the gain of a drive that was not identified.
const SPREAD: f64 = 0.3;
/// Smallest lag that is reported from none, s.
pub(crate) const LAG_MIN: f64 = 1e-5;

/// Weights of the rates from the sample `first` after the present one on, with their covariance.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Sample of the first weight, after the present one.
    pub first: isize,
    /// Weights, samples.
    pub weights: [f64; TAPS],
    /// Their covariance.
    pub covariance: [[f64; TAPS]; TAPS],
}

/// A velocity drive as configured, and the position loop around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalDrive {
    /// Gain Kp of the position loop, 1/s.
    pub servo_gain: f64,
    /// Velocity over commanded velocity.
    pub gain: f64,
    /// Natural frequency wn, rad/s.
    pub frequency: f64,
    /// Damping ratio zeta.
    pub damping: f64,
    /// Samples between a command and its action.
    pub delay: usize,
    /// Sample period T, s.
    pub period: f64,
}

impl Parameters {
    /// Lag 2 zeta/wn of the nominal drive, s.
    pub(crate) fn nominal_lag(&self) -> f64 {
        2.0 * self.model_damping / self.model_natural_frequency
    }
}

impl NominalDrive {
    /// The drive of the axis `axis` (from 0); where its lag is reported, frequency or damping follow.
    pub fn new(p: &Parameters, axis: usize) -> Self {
        let nominal = &p.model.axis[axis];
        let lag = nominal.lag.max(LAG_MIN);
        let (frequency, damping) = match (nominal.natural_frequency > 0.0, nominal.lag > 0.0) {
            (true, true) => (nominal.natural_frequency, 0.5 * lag * nominal.natural_frequency),
            (true, false) => (nominal.natural_frequency, p.model_damping),
            (false, true) => (2.0 * p.model_damping / lag, p.model_damping),
            (false, false) => (p.model_natural_frequency, p.model_damping),
        };
        Self {
            servo_gain: p.servo_gain[axis],
            gain: nominal.gain,
            frequency,
            damping,
            delay: p.io_delay as usize,
            period: p.sample_period,
        }
    }

    /// Lag 2 zeta/wn beyond the delay, s.
    pub fn lag(&self) -> f64 {
        2.0 * self.damping / self.frequency
    }

    /// Lag of the bare servo of a drive of gain 1, 1/(Kp T), samples.
    pub fn bare_lag(&self) -> f64 {
        1.0 / (self.servo_gain * self.period)
    }

    /// Sample of the first weight, after the present one, and the weights with which this drive follows.
    pub fn weights(&self) -> (isize, [f64; TAPS]) {
        let (delay, angle) = (self.delay as f64, self.frequency * self.period);
        let (lambda, mu) = (2.0 * self.damping / angle, angle.powi(-2));
        let (mean, square) = (delay + lambda, delay * delay + 2.0 * delay * lambda + 2.0 * mu - 1.0 / 6.0);
        let middle = mean.ceil();
        // moments about the middle weight
        let (skew, wide) = (mean - middle, square - 2.0 * middle * mean + middle * middle);
        let shape = [(wide - skew) / 2.0, 1.0 - wide, (wide + skew) / 2.0];
        (middle as isize - 1, shape.map(|fraction| fraction * (self.bare_lag() / self.gain)))
    }

    /// Standard deviation of each weight before a run.
    pub fn spread(&self) -> f64 {
        SPREAD * self.bare_lag() / (TAPS as f64).sqrt()
    }

    /// Covariance of the weights before a run.
    fn uncertain(&self) -> [[f64; TAPS]; TAPS] {
        let variance = self.spread().powi(2);
        std::array::from_fn(|i| std::array::from_fn(|k| if i == k { variance } else { 0.0 }))
    }
}

/// Gain, lag and natural frequency of a drive, each with its standard deviation; nominal or identified.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Velocity over commanded velocity, and its standard deviation.
    pub gain: [f64; 2],
    /// Lag beyond the delay, 2 zeta/wn of eq. 1, and its standard deviation, s.
    pub lag: [f64; 2],
    /// Natural frequency wn, and its standard deviation, rad/s; zeros where it is not observable.
    pub frequency: [f64; 2],
}

impl Drive {
    /// The nominal drive, with the standard deviations before a run.
    pub fn nominal(nominal: &NominalDrive) -> Self {
        let (first, weights) = nominal.weights();
        let unknown = Self::of(nominal, &Weights { first, weights, covariance: nominal.uncertain() });
        let frequency = [nominal.frequency, unknown.frequency[1]];
        Self { gain: [nominal.gain, unknown.gain[1]], lag: [nominal.lag(), unknown.lag[1]], frequency }
    }

    /// Drive with these weights: gain from their sum, lag and natural frequency from their moments, standard deviations
    /// from their covariance. The delay is that of `nominal`.
    pub fn of(nominal: &NominalDrive, found: &Weights) -> Self {
        let Weights { first, weights, covariance } = found;
        let sum: f64 = weights.iter().sum();
        let position = |tap: usize| (first + tap as isize) as f64;
        let mean = (0..TAPS).map(|tap| position(tap) * weights[tap]).sum::<f64>() / sum;
        // d(mean)/d(weight) = (place - mean) / sum
        let deviation = |slope: &dyn Fn(usize) -> f64| {
            let pairs = (0..TAPS).flat_map(|i| (0..TAPS).map(move |k| (i, k)));
            pairs.map(|(i, k)| slope(i) * covariance[i][k] * slope(k)).sum::<f64>().max(0.0).sqrt()
        };
        let square = (0..TAPS).map(|tap| position(tap).powi(2) * weights[tap]).sum::<f64>() / sum;
        let delay = nominal.delay as f64;
        // mu = 1/(wn T)^2, from the second moment d^2 + 2 d lambda + 2 mu - 1/6
        let mu = 0.5 * (square - 2.0 * delay * mean + delay * delay + 1.0 / 6.0);
        let by_weight = |tap| 0.5 * (position(tap).powi(2) - square - 2.0 * delay * (position(tap) - mean)) / sum;
        let frequency = if mu > 0.0 { mu.sqrt().recip() / nominal.period } else { 0.0 };
        let gain = nominal.bare_lag() / sum;
        let late = deviation(&|tap| (position(tap) - mean) / sum);
        Self {
            gain: [gain, gain * deviation(&|_| 1.0 / sum)],
            lag: [mean - delay, late].map(|samples| samples * nominal.period),
            frequency: [frequency, if mu > 0.0 { 0.5 * frequency * deviation(&by_weight) / mu } else { 0.0 }],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_have_the_moments_of_the_drive_and_say_them_again() {
        let mut p = Parameters::START;
        for (delay, gain, lag) in [(0, 1.0, 0.0), (1, 0.7, 2e-3), (2, 1.3, 6.9e-3), (3, 2.0, 0.012)] {
            p.io_delay = delay;
            (p.model.axis[3].gain, p.model.axis[3].lag) = (gain, lag);
            p.model.axis[3].natural_frequency = if delay > 1 { 200.0 } else { 0.0 };
            let nominal = NominalDrive::new(&p, 3);
            assert!(delay < 2 || nominal.frequency == 200.0);
            assert!((nominal.lag() - if lag > 0.0 { lag } else { p.nominal_lag() }).abs() < 1e-15);
            let (first, weights) = nominal.weights();
            let moment = |order: i32| -> f64 {
                (0..TAPS).map(|tap| weights[tap] * ((first + tap as isize) as f64).powi(order)).sum()
            };
            let lambda = nominal.lag() / p.sample_period;
            let mu = (nominal.frequency * p.sample_period).powi(-2);
            let (sum, d) = (1.0 / (gain * 13.0 * 0.01), f64::from(delay));
            let square = d * d + 2.0 * d * lambda + 2.0 * mu - 1.0 / 6.0;
            assert!((moment(0) / sum - 1.0).abs() < 1e-12 && (moment(1) / sum - d - lambda).abs() < 1e-12);
            assert!((moment(2) / sum - square).abs() < 1e-12);
            let reported = Drive::of(&nominal, &Weights { first, weights, covariance: nominal.uncertain() });
            assert!(
                (reported.gain[0] - gain).abs() < 1e-12 && (reported.lag[0] - nominal.lag()).abs() < 1e-12,
                "{reported:?}"
            );
            assert!((reported.frequency[0] / nominal.frequency - 1.0).abs() < 1e-9, "{reported:?}");
            assert_eq!(Drive::nominal(&nominal).gain[0], gain);
        }
    }

    #[test]
    fn the_deviations_are_the_slopes_of_what_is_said() {
        let mut p = Parameters::START;
        p.io_delay = 2;
        let nominal = NominalDrive::new(&p, 3);
        let (first, weights) = nominal.weights();
        for tap in 0..TAPS {
            let step = 1e-6 * nominal.bare_lag();
            let (mut covariance, mut moved) = ([[0.0; TAPS]; TAPS], weights);
            covariance[tap][tap] = step * step;
            moved[tap] += step;
            let reported = [weights, moved].map(|weights| Drive::of(&nominal, &Weights { first, weights, covariance }));
            for of in [|drive: &Drive| drive.gain, |drive: &Drive| drive.lag, |drive: &Drive| drive.frequency] {
                let [[before, deviation], [after, _]] = [of(&reported[0]), of(&reported[1])];
                let change = (after - before).abs();
                assert!((deviation / change - 1.0).abs() < 1e-3, "{tap}: {deviation} {change}");
            }
        }
    }
}

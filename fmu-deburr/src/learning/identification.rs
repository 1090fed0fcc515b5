//! A drive from a run without patterns: the weights with which it would have followed, and their uncertainty.
//!
//! The response of the loop to rates of the reference are the rates of the position, so the error of the run shows the
//! residual of any weights w: e - sum w dy. Noise is in e and in dy. The instruments, responses of the nominal loop to
//! the reference, contain none and keep it out of the weights. The prior is the nominal drive with its uncertainty. An
//! axis that hardly moves keeps the nominal weights, as the standard deviation of `weights` shows. That of
//! `weights_of_noise` includes the noise only, without the prior.
//!
//! Friction F after a velocity loop adds to the error in proportion to F', only where it reverses, because its effect on the
//! position is in dy. A sample of a stroke therefore weighs less the slower it is: at low speed friction reverses and
//! the axis sticks.

use crate::learning::drive::{NominalDrive, TAPS, Weights};
use crate::learning::nominal::Nominal;
use crate::learning::regression::Regression;

/// A run of one axis with the bare servo, counts; a lap may follow the other.
pub(crate) trait BareRun {
    /// Weight of a sample in which the configured loop has this ratio of its fastest rate.
    fn weight(fraction: f64) -> f64;
    /// Number of samples.
    fn count(&self) -> usize;
    /// The sample that stands for the sample `index`; none outside the run.
    fn inside(&self, index: isize) -> Option<usize>;
    /// How far the reference moves after sample `k`.
    fn rate(&self, k: usize) -> f64;
    /// Control error of sample `k`.
    fn error(&self, k: usize) -> f64;
}

/// A run that was evaluated.
pub(crate) struct Identification<'a, R> {
    run: &'a R,
    /// response of the configured loop to the rates of the reference
    modelled: &'a [f64],
    first: isize,
    /// fastest of these
    fastest: f64,
    /// weights of the configured drive, and their variance
    nominal: ([f64; TAPS], f64),
    regression: Regression,
    weights: [f64; TAPS],
}

impl<'a, R: BareRun> Identification<'a, R> {
    /// Evaluates a run of a drive with this configuration, with memory for all its samples.
    pub fn new(nominal: &NominalDrive, run: &'a R, room: &'a mut [f64]) -> Self {
        let modelled = &mut room[..run.count()];
        modelled.iter_mut().enumerate().for_each(|(k, value)| *value = run.rate(k));
        Nominal::of(nominal).apply(modelled, false);
        let fastest = modelled.iter().fold(f64::MIN_POSITIVE, |maximum, rate| maximum.max(rate.abs()));
        let (first, prior) = nominal.weights();
        let nominal = (prior, nominal.spread().powi(2));
        let regression = Regression::new(&nominal.0, nominal.1);
        let mut this = Self { run, modelled, first, fastest, nominal, regression, weights: prior };
        for k in 0..this.samples() {
            let (instruments, answers) = (this.instruments(k), this.answers(k));
            this.regression.add(&instruments, &answers, this.error(k));
        }
        this.weights = this.regression.solve();
        this
    }

    /// The weights; the covariance takes what is left for noise of its size that is new in each sample.
    pub fn weights(&self) -> Weights {
        let left: f64 = (0..self.samples()).map(|k| self.left(k).powi(2)).sum();
        let variance = left / self.run.count().saturating_sub(TAPS).max(1) as f64;
        self.with(self.regression.covariance(variance))
    }

    /// The weights; the covariance takes what is left for noise of the measurements, new in each sample.
    ///
    /// The servo answers to noise n of the position as to any error, and the drive follows: e = sum w dy holds for
    /// that, too. What is left is the noise of dy, u[k] = -sum w (n[k+j+1] - n[k+j]), j the samples of the weights:
    /// differences, of which slow instruments see next to nothing. So sum z u is the sum of n[m] times what the same
    /// filter, backward, makes of z, and the variance of n is that of u over the squares of the filter.
    pub fn weights_of_noise(&self) -> Weights {
        let [a, b, c] = self.weights;
        let squares: f64 = [a, b - a, c - b, c].iter().map(|fraction| fraction * fraction).sum();
        let (left, weight) = (0..self.samples()).fold((0.0, 0.0), |(left, sum), k| {
            let weight = self.weight(k);
            (left + weight * self.left(k).powi(2), sum + weight)
        });
        let variance = left / squares / (weight - TAPS as f64).max(1.0);
        self.with(self.regression.covariance_of(variance, (0..self.samples()).map(|m| self.seen(m))))
    }

    /// The weights that the loop of such a drive would show, evaluated in the same way, with memory for all its samples.
    pub fn weights_of(&self, drive: &NominalDrive, room: &mut [f64]) -> [f64; TAPS] {
        let rates = &mut room[..self.run.count()];
        rates.iter_mut().enumerate().for_each(|(k, value)| *value = self.run.rate(k));
        Nominal::of(drive).apply(rates, false);
        let (mut regression, mut error) = (Regression::new(&self.nominal.0, self.nominal.1), 0.0);
        for k in 0..self.samples() {
            let answers = self.taps(k, |k| self.run.inside(k).map_or(0.0, |k| rates[k]));
            regression.add(&self.instruments(k), &answers, error);
            error += self.run.rate(k as usize) - rates[k as usize];
        }
        regression.solve()
    }

    /// Sum of the weights, samples.
    pub fn bare_lag(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// How many sums of what the weights leave, consecutive, hold the noise of one measurement: it is in each of them
    /// by one of the weights.
    pub fn shared(&self) -> f64 {
        self.bare_lag().powi(2) / self.weights.iter().map(|weight| weight * weight).sum::<f64>()
    }

    /// How the noise of sample `m` comes into sum z u.
    fn seen(&self, m: isize) -> [f64; TAPS] {
        let mut sum = [0.0; TAPS];
        for (tap, weight) in self.weights.iter().enumerate() {
            let at = m - self.first - tap as isize;
            let (late, early) = (self.instruments(at), self.instruments(at - 1));
            (0..TAPS).for_each(|i| sum[i] += weight * (late[i] - early[i]));
        }
        sum
    }

    fn with(&self, covariance: [[f64; TAPS]; TAPS]) -> Weights {
        Weights { first: self.first, weights: self.weights, covariance }
    }

    pub fn samples(&self) -> isize {
        self.run.count() as isize
    }

    /// Rates of the configured loop at the weights of sample `k`, counts.
    pub fn modelled_rates(&self, k: isize) -> [f64; TAPS] {
        self.taps(k, |k| self.modelled(k))
    }

    /// Fastest of these.
    pub fn fastest(&self) -> f64 {
        self.fastest
    }

    fn taps(&self, k: isize, signal: impl Fn(isize) -> f64) -> [f64; TAPS] {
        std::array::from_fn(|tap| signal(k + self.first + tap as isize))
    }

    fn error(&self, k: isize) -> f64 {
        self.run.inside(k).map_or(0.0, |k| self.run.error(k))
    }

    fn instruments(&self, k: isize) -> [f64; TAPS] {
        let weight = self.weight(k);
        self.taps(k, |k| weight * self.modelled(k))
    }

    fn weight(&self, k: isize) -> f64 {
        R::weight(self.modelled(k + self.first + 1).abs() / self.fastest)
    }

    fn modelled(&self, k: isize) -> f64 {
        self.run.inside(k).map_or(0.0, |k| self.modelled[k])
    }

    /// How far the position moves after each of the samples.
    fn answers(&self, k: isize) -> [f64; TAPS] {
        self.taps(k, |k| {
            self.run.inside(k).map_or(0.0, |inside| self.run.rate(inside) - self.error(k + 1) + self.error(k))
        })
    }

    /// Residual of sample `k`, counts: the control error minus the weighted motions of the position around it.
    pub fn left(&self, k: isize) -> f64 {
        self.error(k) - self.answers(k).iter().zip(&self.weights).map(|(answer, weight)| answer * weight).sum::<f64>()
    }
}

//! Patterns from the drives alone: what an axis has to be told beyond its error, so that it is where its reference is.
//!
//! The loop is in place where the command is that of a drive which follows: Kp c = (e^(sT) - 1) Theta r. With eq. 1 behind a
//! hold and d samples of delay, in x = s T, lambda = 2 zeta/(wn T) and mu = 1/(wn T)^2,
//!
//! ```text
//! Theta = e^(d x) (1 + lambda x + mu x^2) (1 - x^2/12 + ...) / (gain Kp T)
//! ```
//!
//! So c is a sum of three rates of the reference around the lag d + lambda, whose weights have the same sum (gain), the same
//! mean (lag) and the same second moment, d^2 + 2 d lambda + 2 mu - 1/6. The weights are identified in a run, or these.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::learning::nominal::Nominal;
use crate::learning::pattern::Pattern;
use crate::learning::rates::Rates;
use crate::learning::regression::Regression;
use crate::path::kinematics::{AXES, Joints};
use crate::path::taught_path::TaughtPath;

/// Weights of an axis.
pub(crate) const TAPS: usize = 3;
/// Standard deviation of the gain of a drive that was not identified.
const SPREAD: f64 = 0.3;
/// Standard deviation from which on the gain is that of the nominal drive.
const KNOWN: f64 = 0.1;
/// Gains that can be told from a drive; others end the run, `FollowingError`.
const CREDIBLE: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// What is known of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Velocity over commanded velocity, and its standard deviation.
    pub gain: [f64; 2],
    /// Lag beyond the delay, 2 zeta/wn of eq. 1, and its standard deviation, s.
    pub lag: [f64; 2],
}

/// Feedforward of all axes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Feedforward {
    /// sample of the first weight, after the present one
    first: isize,
    weights: [[f64; TAPS]; AXES],
    /// What the weights say of the drives.
    pub drives: [Drive; AXES],
    rates: Rates,
    /// rates that the nominal loop makes of those of the reference
    modelled: Vec<f64>,
}

impl Feedforward {
    /// Of the nominal drives, for patterns of up to `samples` samples.
    pub fn new(p: &Parameters, samples: usize) -> Self {
        let (delay, turn) = (f64::from(p.io_delay), p.model_natural_frequency * p.sample_period);
        let (lambda, mu) = (2.0 * p.model_damping / turn, turn.powi(-2));
        let (mean, square) = (delay + lambda, delay * delay + 2.0 * delay * lambda + 2.0 * mu - 1.0 / 6.0);
        let middle = mean.ceil();
        // moments about the middle weight
        let (skew, wide) = (mean - middle, square - 2.0 * middle * mean + middle * middle);
        let shape = [(wide - skew) / 2.0, 1.0 - wide, (wide + skew) / 2.0];
        let weights: [[f64; TAPS]; AXES] = std::array::from_fn(|i| shape.map(|share| share * lag(p, i)));
        let first = middle as isize - 1;
        let mut drives = [Drive::default(); AXES];
        for (axis, drive) in drives.iter_mut().enumerate() {
            *drive = told(p, first, &weights[axis], &uncertain(p, axis), axis);
            (drive.gain[0], drive.lag[0]) = (1.0, nominal_lag(p));
        }
        Self { first, weights, drives, rates: Rates::new(samples), modelled: vec![0.0; samples] }
    }

    /// Fills a pattern; `start` are the axes at the start of the path, rad or m.
    pub fn fill(&mut self, p: &Parameters, path: &TaughtPath, start: &Joints, pattern: &mut Pattern) {
        self.rates.walk(p, path, start, pattern);
        for (k, sample) in pattern.samples.iter_mut().enumerate() {
            sample.compensation = [0.0; AXES];
            for tap in 0..TAPS {
                let rates = self.rates.at(k as isize + self.first + tap as isize);
                (0..AXES).for_each(|i| sample.compensation[i] += self.weights[i][tap] * rates[i]);
            }
        }
    }

    /// Takes the weights from the control errors (counts) of a run of the bare servo along a pattern.
    ///
    /// What the loop makes of rates of the reference are the rates of the position, so the error of the run tells what any
    /// weights w leave: e - sum w dy. Noise is in e and in dy; an instrument that knows of none, what the nominal loop makes of
    /// the reference, keeps it out of the weights. How far they may be from the nominal ones is told beforehand: an axis that
    /// hardly moves keeps the nominal ones, and says so by its standard deviation.
    pub fn identify(
        &mut self,
        p: &Parameters,
        path: &TaughtPath,
        start: &Joints,
        pattern: &Pattern,
        errors: &[Joints],
    ) {
        let prior = Self::new(p, 0);
        self.rates.walk(p, path, start, pattern);
        for axis in 0..AXES {
            let (weights, covariance) = self.regress(p, axis, errors, &prior.weights[axis]);
            let drive = told(p, self.first, &weights, &covariance, axis);
            let believed = CREDIBLE.contains(&drive.gain[0]) && drive.gain[1] < KNOWN;
            (self.weights[axis], self.drives[axis]) =
                if believed { (weights, drive) } else { (prior.weights[axis], prior.drives[axis]) };
        }
    }

    /// How much later than the nominal one each drive is, s.
    pub fn later(&self, p: &Parameters) -> Joints {
        self.drives.map(|drive| drive.lag[0] - nominal_lag(p))
    }

    fn regress(
        &mut self,
        p: &Parameters,
        axis: usize,
        errors: &[Joints],
        prior: &[f64; TAPS],
    ) -> ([f64; TAPS], [[f64; TAPS]; TAPS]) {
        let (rates, count) = (&self.rates, self.rates.count());
        let modelled = &mut self.modelled[..count];
        modelled.iter_mut().enumerate().for_each(|(k, value)| *value = rates.at(k as isize)[axis]);
        Nominal::new(p, axis).apply(modelled, false);
        let error = |k: isize| rates.inside(k).map_or(0.0, |k| errors[k][axis]);
        let answer = |k: isize| rates.inside(k).map_or(0.0, |_| rates.at(k)[axis] - error(k + 1) + error(k));
        let instrument = |k: isize| rates.inside(k).map_or(0.0, |k| modelled[k]);
        let mut regression = Regression::new(prior, spread(p, axis).powi(2));
        let samples = || {
            (0..count as isize).map(|k| {
                let taps =
                    |signal: &dyn Fn(isize) -> f64| std::array::from_fn(|tap| signal(k + self.first + tap as isize));
                (taps(&instrument), taps(&answer), error(k))
            })
        };
        samples().for_each(|(instrument, answer, error)| regression.add(&instrument, &answer, error));
        let weights = regression.solve();
        let left = samples().map(|(_, answer, error)| {
            (error - answer.iter().zip(&weights).map(|(answer, weight)| answer * weight).sum::<f64>()).powi(2)
        });
        let variance = left.sum::<f64>() / count.saturating_sub(TAPS).max(1) as f64;
        (weights, regression.covariance(variance))
    }
}

/// Lag 2 zeta/wn of the nominal drive, s.
fn nominal_lag(p: &Parameters) -> f64 {
    2.0 * p.model_damping / p.model_natural_frequency
}

/// Lag of the bare servo in samples, 1/(Kp T), of a drive of gain 1.
fn lag(p: &Parameters, axis: usize) -> f64 {
    1.0 / (p.servo_gain[axis] * p.sample_period)
}

/// Standard deviation of each weight before a run.
fn spread(p: &Parameters, axis: usize) -> f64 {
    SPREAD * lag(p, axis) / (TAPS as f64).sqrt()
}

/// Covariance of the weights before a run.
fn uncertain(p: &Parameters, axis: usize) -> [[f64; TAPS]; TAPS] {
    let variance = spread(p, axis).powi(2);
    std::array::from_fn(|i| std::array::from_fn(|k| if i == k { variance } else { 0.0 }))
}

/// What weights and their covariance say of the drive.
fn told(p: &Parameters, first: isize, weights: &[f64; TAPS], covariance: &[[f64; TAPS]; TAPS], axis: usize) -> Drive {
    let sum: f64 = weights.iter().sum();
    let place = |tap: usize| (first + tap as isize) as f64;
    let mean = (0..TAPS).map(|tap| place(tap) * weights[tap]).sum::<f64>() / sum;
    // d(mean)/d(weight) = (place - mean) / sum
    let deviation = |slope: &dyn Fn(usize) -> f64| {
        let pairs = (0..TAPS).flat_map(|i| (0..TAPS).map(move |k| (i, k)));
        pairs.map(|(i, k)| slope(i) * covariance[i][k] * slope(k)).sum::<f64>().max(0.0).sqrt()
    };
    let gain = lag(p, axis) / sum;
    Drive {
        gain: [gain, gain * deviation(&|_| 1.0 / sum)],
        lag: [(mean - f64::from(p.io_delay)), deviation(&|tap| (place(tap) - mean) / sum)].map(|n| n * p.sample_period),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;
    use crate::path::feasible;
    use crate::path::geometry::Block;

    /// A pattern, and what the drives of `machine` make of a run with it: the control errors, counts.
    fn run(p: &Parameters, machine: &Parameters, path: &TaughtPath, pattern: &Pattern, laps: usize) -> Vec<Joints> {
        let start = feasible::start(p, path).unwrap();
        let mut rates = Rates::new(pattern.len());
        rates.walk(p, path, &start, pattern);
        let count = pattern.len();
        let mut errors = vec![[0.0; AXES]; laps * count];
        for axis in 0..AXES {
            let mut way = 0.0;
            let ways: Vec<f64> = (0..laps * count)
                .map(|k| {
                    way += rates.at((k % count) as isize)[axis];
                    way - rates.at((k % count) as isize)[axis]
                })
                .collect();
            let mut signal: Vec<f64> =
                (0..laps * count).map(|k| ways[k] + pattern.samples[k % count].compensation[axis]).collect();
            Nominal::new(machine, axis).apply(&mut signal, false);
            let left = ways.iter().zip(&signal).map(|(way, position)| way - position);
            errors.iter_mut().zip(left).for_each(|(error, left)| error[axis] = left);
        }
        errors.split_off((laps - 1) * count)
    }

    fn largest(errors: &[Joints]) -> f64 {
        errors.iter().flatten().fold(0.0, |most, error| most.max(error.abs()))
    }

    fn nominal(p: &Parameters, path: &TaughtPath) -> Pattern {
        let mut pattern = Pattern::plan(p, path, 0.8).unwrap();
        Feedforward::new(p, pattern.len()).fill(p, path, &feasible::start(p, path).unwrap(), &mut pattern);
        assert!(pattern.largest() > 100.0);
        pattern
    }

    #[test]
    fn the_nominal_loop_follows_within_a_count_with_and_without_delay() {
        for io_delay in [0, 1, 3] {
            let mut p = Parameters::START;
            p.io_delay = io_delay;
            let path = straight(0.1);
            let left = largest(&run(&p, &p, &path, &nominal(&p, &path), 1));
            assert!(left < 1.0, "{io_delay}: {left}");
        }
    }

    #[test]
    fn laps_follow_each_other() {
        let (p, there) = (Parameters::START, straight(0.1));
        let ends = [there.at(0.0), there.at(0.1), there.at(0.0)];
        let blocks = ends.windows(2).map(|pair| Block::line(&pair[0], &pair[1]).unwrap()).collect();
        let path = TaughtPath::new(blocks, 0.1, true, 0.2).unwrap();
        let left = largest(&run(&p, &p, &path, &nominal(&p, &path), 2));
        assert!(left < 1.0, "{left}");
    }

    /// A drive that is not the nominal one.
    fn machine(gain: f64, frequency: f64, damping: f64) -> Parameters {
        let mut p = Parameters::START;
        p.servo_gain = p.servo_gain.map(|kp| kp * gain);
        (p.model_natural_frequency, p.model_damping) = (frequency, damping);
        p
    }

    #[test]
    fn one_run_tells_gain_and_lag_and_what_the_drive_needs_at_any_speed() {
        let (p, path) = (Parameters::START, straight(0.1));
        let start = feasible::start(&p, &path).unwrap();
        for (gain, frequency, damping) in
            [(0.7, 196.0, 0.676), (0.7, 364.0, 0.364), (1.3, 196.0, 0.364), (1.3, 364.0, 0.676)]
        {
            let machine = machine(gain, frequency, damping);
            let bare = Pattern::plan(&p, &path, 1.0).unwrap();
            let errors: Vec<Joints> =
                run(&p, &machine, &path, &bare, 1).iter().map(|error| error.map(f64::round)).collect();
            let mut feedforward = Feedforward::new(&p, 1000);
            feedforward.identify(&p, &path, &start, &bare, &errors);
            let Drive { gain: [told, deviation], lag: [lag, late] } = feedforward.drives[2];
            assert!((told - gain).abs() < 3.0 * deviation && deviation < 3e-3, "{gain}: {told} {deviation}");
            assert!((lag - 2.0 * damping / frequency).abs() < 3.0 * late && late < 1e-3, "{frequency}: {lag} {late}");
            for factor in [1.0, 0.3] {
                let mut pattern = Pattern::plan(&p, &path, factor).unwrap();
                feedforward.fill(&p, &path, &start, &mut pattern);
                let left = largest(&run(&p, &machine, &path, &pattern, 1));
                assert!(left < 2.5, "{gain} {frequency} {damping} {factor}: {left}");
            }
        }
    }

    #[test]
    fn drives_that_are_later_are_looked_up_later_and_nominal_ones_not_by_a_bit() {
        for io_delay in [0, 1, 3] {
            let mut p = Parameters::START;
            p.io_delay = io_delay;
            assert_eq!(Feedforward::new(&p, 0).later(&p), [0.0; AXES]);
        }
        let (p, path) = (Parameters::START, straight(0.1));
        let start = feasible::start(&p, &path).unwrap();
        let bare = Pattern::plan(&p, &path, 1.0).unwrap();
        let machine = machine(1.0, 200.0, 0.6);
        let mut feedforward = Feedforward::new(&p, bare.len());
        feedforward.identify(&p, &path, &start, &bare, &run(&p, &machine, &path, &bare, 1));
        let later = 2.0 * 0.6 / 200.0 - 2.0 * 0.52 / 280.0;
        let found = feedforward.later(&p);
        assert!((found[2] - later).abs() < 0.05 * later && found[1] == 0.0, "{found:?} {later}");
    }

    #[test]
    fn a_gain_that_no_drive_has_is_not_believed() {
        let (p, path) = (Parameters::START, straight(0.1));
        let start = feasible::start(&p, &path).unwrap();
        let bare = Pattern::plan(&p, &path, 1.0).unwrap();
        let errors = run(&p, &machine(0.4, 280.0, 0.52), &path, &bare, 1);
        let mut feedforward = Feedforward::new(&p, bare.len());
        let nominal = feedforward.clone();
        feedforward.identify(&p, &path, &start, &bare, &errors);
        assert_eq!((feedforward.weights, feedforward.drives), (nominal.weights, nominal.drives));
    }
}

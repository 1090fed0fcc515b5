//! Patterns from the drives alone: the command in addition to the error that keeps an axis at its reference.
//!
//! The loop is in place where the command is that of a drive which follows: Kp c = (e^(sT) - 1) Theta r. With eq. 1 after a
//! hold and d samples of delay, in x = s T, lambda = 2 zeta/(wn T) and mu = 1/(wn T)^2,
//!
//! ```text
//! Theta = e^(d x) (1 + lambda x + mu x^2) (1 - x^2/12 + ...) / (gain Kp T)
//! ```
//!
//! So c is a sum of three rates of the reference around the lag d + lambda, whose weights have the same sum (gain), the same
//! mean (lag) and the same second moment, d^2 + 2 d lambda + 2 mu - 1/6. The weights are identified in a run, or follow
//! from the nominal drive.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::learning::drive::{Drive, NominalDrive, TAPS};
use crate::learning::friction::for_each_reversal;
use crate::learning::identification::{BareRun, Identification};
use crate::learning::pattern::Pattern;
use crate::learning::rates::Rates;
use crate::path::kinematics::{AXES, Joints};
use crate::path::programmed_path::ProgrammedPath;

/// Standard deviation from which on the gain is that of the nominal drive.
const GAIN_STD_MAX: f64 = 0.1;
/// Gains of a drive that are accepted; others end the run with `FollowingError`.
pub(crate) const CREDIBLE: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// Feedforward of all axes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Feedforward {
    /// sample of the first weight of each axis, after the present one
    first: [isize; AXES],
    weights: [[f64; TAPS]; AXES],
    /// Drives to which the weights belong: nominal, or identified from a run of the bare servo.
    pub drives: [Drive; AXES],
    rates: Rates,
    /// rates that the nominal loop makes of those of the reference
    modelled: Vec<f64>,
}

/// One axis of a run of the bare servo along a pattern.
struct PathRun<'a> {
    rates: &'a Rates,
    errors: &'a [Joints],
    axis: usize,
}

impl BareRun for PathRun<'_> {
    // what friction leaves is learned afterwards
    fn weight(_: f64) -> f64 {
        1.0
    }

    fn count(&self) -> usize {
        self.rates.count()
    }

    fn inside(&self, index: isize) -> Option<usize> {
        self.rates.inside(index)
    }

    fn rate(&self, k: usize) -> f64 {
        self.rates.at(k as isize)[self.axis]
    }

    fn error(&self, k: usize) -> f64 {
        self.errors[k][self.axis]
    }
}

impl Feedforward {
    /// Of the drives as configured, for patterns of up to `samples` samples.
    pub fn new(p: &Parameters, samples: usize) -> Self {
        let mut this = Self {
            first: [0; AXES],
            weights: [[0.0; TAPS]; AXES],
            drives: [Drive::default(); AXES],
            rates: Rates::new(samples),
            modelled: vec![0.0; samples],
        };
        this.configure(p);
        this
    }

    /// The drives are those as configured now.
    pub fn configure(&mut self, p: &Parameters) {
        for axis in 0..AXES {
            let nominal = NominalDrive::new(p, axis);
            (self.first[axis], self.weights[axis]) = nominal.weights();
            self.drives[axis] = Drive::nominal(&nominal);
        }
    }

    /// Fills a pattern; `start` are the axes at the start of the path, rad or m.
    pub fn fill(&mut self, p: &Parameters, path: &ProgrammedPath, start: &Joints, pattern: &mut Pattern) {
        self.rates.walk(p, path, start, pattern);
        for (k, sample) in pattern.samples.iter_mut().enumerate() {
            sample.compensation = self.compensation(k);
        }
        self.add_reversals(p, 1.0, pattern);
    }

    /// Adds the same to a pattern, `sign` times.
    pub fn add(&mut self, p: &Parameters, path: &ProgrammedPath, start: &Joints, sign: f64, pattern: &mut Pattern) {
        self.rates.walk(p, path, start, pattern);
        for (k, sample) in pattern.samples.iter_mut().enumerate() {
            let more = self.compensation(k);
            sample.compensation = std::array::from_fn(|i| sample.compensation[i] + sign * more[i]);
        }
        self.add_reversals(p, sign, pattern);
    }

    /// Adds what friction asks for where an axis of the walk reverses, `sign` times.
    fn add_reversals(&self, p: &Parameters, sign: f64, pattern: &mut Pattern) {
        for axis in 0..AXES {
            let held = p.model.axis[axis].friction / p.axis[axis].pulse;
            if held > 0.0 {
                let needed = sign * held * self.weights[axis].iter().sum::<f64>();
                for_each_reversal(&self.rates, axis, |position, change| {
                    pattern.add(axis, position - p.io_delay as f64 - 0.5, change * needed);
                });
            }
        }
    }

    /// Compensation of sample `k` of the walk without that of friction, pulses, not rounded.
    fn compensation(&self, k: usize) -> Joints {
        std::array::from_fn(|i| {
            let rate = |tap: usize| self.rates.at(k as isize + self.first[i] + tap as isize)[i];
            (0..TAPS).fold(0.0, |sum, tap| sum + self.weights[i][tap] * rate(tap))
        })
    }

    /// Takes the weights from the control errors (counts) of a run of the bare servo along a pattern.
    pub fn identify(
        &mut self,
        p: &Parameters,
        path: &ProgrammedPath,
        start: &Joints,
        pattern: &Pattern,
        errors: &[Joints],
    ) {
        self.configure(p);
        self.rates.walk(p, path, start, pattern);
        for axis in 0..AXES {
            let (nominal, run) = (NominalDrive::new(p, axis), PathRun { rates: &self.rates, errors, axis });
            let found = Identification::new(&nominal, &run, &mut self.modelled).weights();
            let drive = Drive::of(&nominal, &found);
            if CREDIBLE.contains(&drive.gain[0]) && drive.gain[1] < GAIN_STD_MAX {
                (self.weights[axis], self.drives[axis]) = (found.weights, drive);
            }
        }
    }

    /// How much later than the nominal one each drive is, s.
    pub fn later(&self, p: &Parameters) -> Joints {
        self.drives.map(|drive| drive.lag[0] - p.nominal_lag())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::nominal::Nominal;
    use crate::learning::pattern::tests::straight;
    use crate::path::feasible;
    use crate::path::geometry::Block;

    /// A pattern, and what the drives of `machine` make of a run with it: the control errors, counts.
    fn run(p: &Parameters, machine: &Parameters, path: &ProgrammedPath, pattern: &Pattern, laps: usize) -> Vec<Joints> {
        let start = feasible::start(p, path).unwrap();
        let mut rates = Rates::new(pattern.len());
        rates.walk(p, path, &start, pattern);
        let count = pattern.len();
        let mut errors = vec![[0.0; AXES]; laps * count];
        for axis in 0..AXES {
            let mut distance = 0.0;
            let distances: Vec<f64> = (0..laps * count)
                .map(|k| {
                    distance += rates.at((k % count) as isize)[axis];
                    distance - rates.at((k % count) as isize)[axis]
                })
                .collect();
            let mut signal: Vec<f64> =
                (0..laps * count).map(|k| distances[k] + pattern.samples[k % count].compensation[axis]).collect();
            Nominal::new(machine, axis).apply(&mut signal, false);
            let left = distances.iter().zip(&signal).map(|(distance, position)| distance - position);
            errors.iter_mut().zip(left).for_each(|(error, left)| error[axis] = left);
        }
        errors.split_off((laps - 1) * count)
    }

    fn largest(errors: &[Joints]) -> f64 {
        errors.iter().flatten().fold(0.0, |maximum, error| maximum.max(error.abs()))
    }

    fn nominal(p: &Parameters, path: &ProgrammedPath) -> Pattern {
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
        let path = ProgrammedPath::new(blocks, 0.1, true, 0.2).unwrap();
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
    fn one_run_identifies_gain_and_lag_and_what_the_drive_needs_at_any_speed() {
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
            let Drive { gain: [found, deviation], lag: [lag, late], .. } = feedforward.drives[2];
            assert!((found - gain).abs() < 3.0 * deviation && deviation < 3e-3, "{gain}: {found} {deviation}");
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
    fn a_gain_that_no_drive_has_is_not_accepted() {
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

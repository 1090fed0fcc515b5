//! Learning of the patterns: repetitions at one speed after the other, each followed by a renewal of the pattern.

use serde::{Deserialize, Serialize};

use crate::interface::{LearnOutput, Parameters};
use crate::learning::errors::{ErrorSums, Errors};
use crate::learning::pattern::Pattern;
use crate::learning::renewal::Renewal;
use crate::path::kinematics::{AXES, Joints};

/// Ratio to the error without patterns at which the learning of a speed ends.
const DIVERGED: f64 = 3.0;

/// Continuation of the learning at the end of a repetition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Another repetition at the same speed.
    Repeat,
    /// The speed is learned, the next one follows.
    NextSpeed,
    /// All speeds are learned.
    Done,
    /// The pattern became larger than `expert.limits.pulses_max`.
    TooLarge,
}

/// Learning between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Learner {
    /// Number of the speed, from 0.
    pub speed: usize,
    /// Number of the repetition, 0 is the bare servo.
    pub repetition: i32,
    /// Repetition with the smallest error so far.
    pub best_repetition: i32,
    /// Errors of the last finished repetition.
    pub errors: Errors,
    best_cost: f64,
    first_cost: f64,
    best: Vec<Joints>,
    record: Vec<Joints>,
    sums: ErrorSums,
    renewal: Renewal,
}

impl Learner {
    /// With memory for patterns of up to `samples` samples.
    pub fn new(p: &Parameters, samples: usize) -> Self {
        Self {
            speed: 0,
            repetition: 0,
            best_repetition: 0,
            errors: Errors::default(),
            best_cost: f64::INFINITY,
            first_cost: 0.0,
            best: vec![[0.0; AXES]; samples],
            record: vec![[0.0; AXES]; samples],
            sums: ErrorSums::default(),
            renewal: Renewal::new(p, samples),
        }
    }

    /// The drives are those as configured now.
    pub fn configure(&mut self, p: &Parameters) {
        self.renewal.configure(p);
    }

    /// Begins with the first speed.
    pub fn start(&mut self) {
        (self.speed, self.repetition, self.best_repetition) = (0, 0, 0);
        self.restart();
    }

    /// Begins the repetition again.
    pub fn restart(&mut self) {
        self.sums = ErrorSums::default();
    }

    /// Takes the control error of the sample `index` (pulses); `levers` are the motions of the tip per axis.
    pub fn record(&mut self, index: usize, error: &Joints, pulses: &Joints, levers: &Joints) {
        self.record[index] = *error;
        self.sums.take(error, pulses, levers);
    }

    /// Whether the present run is the one without patterns that identifies the drives.
    pub fn identifies(&self, p: &Parameters) -> bool {
        p.learn.identify && !p.learn.from_bank && (self.speed, self.repetition) == (0, 0)
    }

    /// Control errors (pulses) of the repetition that has come to its end.
    pub fn record_of(&self, pattern: &Pattern) -> &[Joints] {
        &self.record[..pattern.len()]
    }

    /// Ends the run of the bare servo, after which the drives fill all patterns in place of a renewal.
    pub fn finish_bare(&mut self, p: &Parameters, pattern: &Pattern) -> Next {
        self.evaluate(pattern);
        if p.learn.repetitions == 0 {
            self.speed = p.learn.factors.list().len();
            return Next::Done;
        }
        self.repetition = 1;
        Next::Repeat
    }

    /// Ends a repetition: evaluates it and renews the pattern.
    pub fn finish(&mut self, p: &Parameters, pattern: &mut Pattern) -> Next {
        let minimum = self.evaluate(pattern);
        let diverged = self.first_cost > 0.0 && self.errors.cost > DIVERGED * self.first_cost;
        if self.repetition < p.learn.repetitions && !diverged && !self.converged(p, minimum) {
            self.renewal.renew(p, &self.record, pattern);
            self.repetition += 1;
            if pattern.largest() <= p.limits.pulses_max {
                return Next::Repeat;
            }
            self.restore(pattern);
            return Next::TooLarge;
        }
        if p.learn.stop_at_best || diverged {
            self.restore(pattern);
        }
        self.next_speed(p)
    }

    /// Ends a speed within a repetition, because the error grows: the best pattern stays.
    pub fn abandon(&mut self, p: &Parameters, pattern: &mut Pattern) -> Next {
        self.restore(pattern);
        self.restart();
        self.next_speed(p)
    }

    fn next_speed(&mut self, p: &Parameters) -> Next {
        self.speed += 1;
        self.repetition = 0;
        if self.speed < p.learn.factors.list().len() { Next::NextSpeed } else { Next::Done }
    }

    /// Outputs of the learning; `running` says whether something is learned or was learned in this task, `done` whether
    /// all is.
    pub(crate) fn report(&self, p: &Parameters, running: bool, done: bool) -> LearnOutput {
        let last = p.learn.factors.list().len() - 1;
        LearnOutput {
            speed_index: if running { self.speed.min(last) as i32 + 1 } else { 0 },
            repetition: self.repetition,
            best: self.best_repetition,
            cost: self.errors.cost,
            done,
        }
    }

    /// Whether the error is small enough, or no longer falls; `minimum` is the smallest one before.
    fn converged(&self, p: &Parameters, minimum: f64) -> bool {
        let falls = p.learn.decrease == 0.0 || self.errors.cost <= (1.0 - p.learn.decrease) * minimum;
        self.errors.tip < p.learn.tolerance || !falls
    }

    /// Takes the errors of a repetition; the smallest one before.
    fn evaluate(&mut self, pattern: &Pattern) -> f64 {
        self.errors = self.sums.errors();
        self.restart();
        if self.repetition == 0 {
            (self.first_cost, self.best_cost) = (self.errors.cost, f64::INFINITY);
        }
        let minimum = self.best_cost;
        if self.errors.cost < self.best_cost {
            (self.best_cost, self.best_repetition) = (self.errors.cost, self.repetition);
            self.best.iter_mut().zip(&pattern.samples).for_each(|(best, sample)| *best = sample.compensation);
        }
        minimum
    }

    fn restore(&self, pattern: &mut Pattern) {
        pattern.samples.iter_mut().zip(&self.best).for_each(|(sample, best)| sample.compensation = *best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;

    fn setup(p: &Parameters) -> (Learner, Pattern) {
        let pattern = Pattern::plan(p, &straight(0.05), 1.0).unwrap();
        (Learner::new(p, pattern.len()), pattern)
    }

    fn repeat(learner: &mut Learner, p: &Parameters, pattern: &mut Pattern, error: impl Fn(usize) -> f64) -> Next {
        for k in 0..pattern.len() {
            learner.record(k, &[error(k); AXES], &[1e-6; AXES], &[1.0; AXES]);
        }
        learner.finish(p, pattern)
    }

    #[test]
    fn the_best_repetition_stays_when_requested() {
        for (stop_at_best, kept) in [(true, 1.0), (false, 3.0)] {
            let mut p = Parameters::PAPER;
            (p.learn.stop_at_best, p.learn.repetitions, p.io_delay) = (stop_at_best, 3, 0);
            let (mut learner, mut pattern) = setup(&p);
            let sizes = [100.0, 1.0, 30.0, 50.0];
            let ends: Vec<_> = sizes.iter().map(|size| repeat(&mut learner, &p, &mut pattern, |_| *size)).collect();
            assert_eq!(ends, [Next::Repeat, Next::Repeat, Next::Repeat, Next::NextSpeed]);
            assert_eq!(learner.best_repetition, 1);
            // pattern of run 1: 100, of run 3: 131
            let expected = if kept == 1.0 { 100.0 } else { 131.0 };
            assert_eq!(pattern.samples[7].compensation[3], expected);
        }
    }

    #[test]
    fn of_equal_repetitions_the_first_is_the_best() {
        let mut p = Parameters::PAPER;
        p.io_delay = 0;
        let (mut learner, mut pattern) = setup(&p);
        (0..3).for_each(|_| assert_eq!(repeat(&mut learner, &p, &mut pattern, |_| 5.0), Next::Repeat));
        assert_eq!(learner.best_repetition, 0);
    }

    #[test]
    fn three_times_the_first_error_ends_the_speed_with_the_best_pattern() {
        let mut p = Parameters::PAPER;
        p.io_delay = 0;
        let (mut learner, mut pattern) = setup(&p);
        repeat(&mut learner, &p, &mut pattern, |_| 10.0);
        assert_eq!(repeat(&mut learner, &p, &mut pattern, |_| 31.0), Next::NextSpeed);
        assert_eq!(pattern.samples[0].compensation[0], 0.0);
        assert_eq!((learner.speed, learner.repetition), (1, 0));
    }

    #[test]
    fn up_to_three_times_the_first_error_it_learns_on_and_so_it_does_after_a_first_run_without_error() {
        let mut p = Parameters::PAPER;
        p.io_delay = 0;
        let (mut learner, mut pattern) = setup(&p);
        let once = repeat(&mut learner, &p, &mut pattern, |_| 1.0);
        let first = learner.errors.cost;
        assert_eq!((once, repeat(&mut learner, &p, &mut pattern, |_| 2.99)), (Next::Repeat, Next::Repeat));
        assert!((learner.errors.cost - 2.99 * first).abs() < 1e-9 * first);
        let (mut learner, mut pattern) = setup(&p);
        for size in [0.0, 10.0] {
            assert_eq!(repeat(&mut learner, &p, &mut pattern, |_| size), Next::Repeat);
        }
    }

    #[test]
    fn a_speed_ends_with_an_error_within_the_tolerance_or_one_that_no_longer_falls() {
        let ends = |tolerance: f64, decrease: f64, sizes: &[f64]| {
            let mut p = Parameters::PAPER;
            (p.learn.tolerance, p.learn.decrease) = (tolerance, decrease);
            let (mut learner, mut pattern) = setup(&p);
            sizes.iter().map(|size| repeat(&mut learner, &p, &mut pattern, |_| *size)).collect::<Vec<_>>()
        };
        let (again, over) = (Next::Repeat, Next::NextSpeed);
        // counts of a micrometer
        assert_eq!(ends(0.0, 0.0, &[9.0, 9.0, 10.0, 9.0]), [again; 4]);
        assert_eq!(ends(8.001e-6, 0.0, &[9.0, 8.0]), [again, over]);
        assert_eq!(ends(8.001e-6, 0.0, &[8.0]), [over]);
        assert_eq!(ends(0.0, 0.1, &[100.0, 89.0, 80.0, 72.1]), [again, again, again, over]);
    }

    #[test]
    fn a_speed_that_is_abandoned_keeps_its_best_pattern() {
        let p = Parameters::PAPER;
        let (mut learner, mut pattern) = setup(&p);
        for size in [10.0, 4.0] {
            repeat(&mut learner, &p, &mut pattern, |_| size);
        }
        assert_eq!(learner.abandon(&p, &mut pattern), Next::NextSpeed);
        assert_eq!((pattern.samples[0].compensation[0], learner.speed, learner.repetition), (10.0, 1, 0));
    }

    #[test]
    fn a_pattern_beyond_16_bits_is_reported() {
        let p = Parameters::PAPER;
        let (mut learner, mut pattern) = setup(&p);
        assert_eq!(repeat(&mut learner, &p, &mut pattern, |_| 40_000.0), Next::TooLarge);
        assert_eq!(pattern.largest(), 0.0);
    }

    #[test]
    fn the_outputs_count_speeds_from_one_and_stay_at_the_last() {
        let p = Parameters::PAPER;
        let (mut learner, mut pattern) = setup(&p);
        assert_eq!(learner.report(&p, false, false).speed_index, 0);
        for index in 1..=5 {
            let report = learner.report(&p, true, false);
            assert_eq!((report.speed_index, report.done), (index, false));
            repeat(&mut learner, &p, &mut pattern, |_| 7.0);
            assert_eq!(learner.report(&p, true, false).repetition, 1);
            let next = learner.abandon(&p, &mut pattern);
            assert_eq!(next, if index == 5 { Next::Done } else { Next::NextSpeed });
        }
        let report = learner.report(&p, true, true);
        assert_eq!((report.speed_index, report.done, report.cost), (5, true, learner.errors.cost));
    }
}

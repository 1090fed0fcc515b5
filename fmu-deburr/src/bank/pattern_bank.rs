//! The bank: the control patterns of all speeds, and the path and machine to which they belong.

use control_blocks::ParameterError;
use serde::{Deserialize, Serialize};

use crate::fingerprint::Fingerprint;
use crate::interface::Parameters;
use crate::learning::pattern::Pattern;
use crate::path::kinematics::Joints;
use crate::path::programmed_path::{CORNER, ProgrammedPath};

/// Path, machine and speeds of a bank; its patterns are not valid for another path or machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Fingerprint of the path, its feed, the geometry of the robot and its gains.
    pub path: u64,
    /// Pulse of each axis, rad or m.
    pub pulses: Joints,
    /// Sample period, s.
    pub period: f64,
    /// Samples between a command and its action.
    pub io_delay: u16,
    /// Multiples of the programmed speed.
    pub factors: Vec<f64>,
}

impl Identity {
    /// Checks that a bank of the identity `other` fits this one. It may have the first of the speeds only.
    ///
    /// # Errors
    /// The first difference, as a text for the user.
    pub fn accepts(&self, other: &Self) -> Result<(), String> {
        let differs =
            |what: &str, found: String, expected: String| Err(format!("{what} `{found}`, must be `{expected}`"));
        if other.period != self.period {
            return differs("its sample period is", format!("{} s", other.period), format!("{} s", self.period));
        }
        if other.io_delay != self.io_delay {
            return differs("its `io_delay` is", other.io_delay.to_string(), self.io_delay.to_string());
        }
        if other.pulses != self.pulses {
            return differs("its pulses are", format!("{:?}", other.pulses), format!("{:?}", self.pulses));
        }
        if !self.factors.starts_with(&other.factors) {
            return differs("its speeds are", format!("{:?}", other.factors), format!("{:?}", self.factors));
        }
        if other.path != self.path {
            let (found, expected) = (format!("{:016x}", other.path), format!("{:016x}", self.path));
            return differs("it belongs to another path, feed or robot: its fingerprint is", found, expected);
        }
        Ok(())
    }
}

/// Patterns from the fastest to the slowest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatternBank {
    identity: Identity,
    patterns: Vec<Pattern>,
    /// how many of them are learned
    usable: usize,
}

impl PatternBank {
    /// Patterns of zeros for all speeds.
    ///
    /// # Errors
    /// When the path takes too long at one of them.
    pub fn plan(p: &Parameters, path: &ProgrammedPath) -> Result<Self, ParameterError> {
        let plan = |factor: &f64| Pattern::plan(p, path, *factor);
        let patterns = p.learn.factors.list().iter().map(plan).collect::<Result<Vec<_>, _>>();
        let patterns = patterns.map_err(|limit| ParameterError {
            name: "learn.speeds",
            value: format!("{:?}", p.learn.factors.list()),
            limit: format!("speeds at which the path is not too long: {limit}"),
            hint: "leave out the slowest speed, or split the path",
        })?;
        Ok(Self { identity: identity(p, path), patterns, usable: 0 })
    }

    /// Fills all patterns, and all can be used.
    pub fn fill(&mut self, fill: impl FnMut(&mut Pattern)) {
        self.patterns.iter_mut().for_each(fill);
        self.usable = self.patterns.len();
    }

    /// Changes the patterns that can be used.
    pub fn change(&mut self, change: impl FnMut(&mut Pattern)) {
        self.patterns[..self.usable].iter_mut().for_each(change);
    }

    /// The patterns are for commands that act after this number of samples.
    pub fn set_delay(&mut self, io_delay: i32) {
        self.identity.io_delay = io_delay as u16;
    }

    /// Largest compensation of all patterns, pulses.
    pub fn largest(&self) -> f64 {
        self.patterns.iter().map(Pattern::largest).fold(0.0, f64::max)
    }

    /// Patterns that can be used, from the fastest on.
    pub fn patterns(&self) -> &[Pattern] {
        &self.patterns[..self.usable]
    }

    /// Patterns of all speeds, learned or not.
    pub fn planned(&self) -> &[Pattern] {
        &self.patterns
    }

    /// Path, machine and speeds to which the bank belongs.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Number of samples of the longest pattern.
    pub fn longest(&self) -> usize {
        self.patterns.iter().map(Pattern::len).max().unwrap_or(0)
    }

    /// Multiple of the programmed speed of the pattern `index`, or of the last one.
    pub fn factor(&self, index: usize) -> f64 {
        self.pattern(index).factor
    }

    /// The pattern `index`, or the last one.
    pub fn pattern(&self, index: usize) -> &Pattern {
        &self.patterns[index.min(self.patterns.len() - 1)]
    }

    /// The pattern `index`, or the last one, to be renewed.
    pub fn pattern_mut(&mut self, index: usize) -> &mut Pattern {
        let last = self.patterns.len() - 1;
        &mut self.patterns[index.min(last)]
    }

    /// The pattern `index` is learned.
    pub fn learned(&mut self, index: usize) {
        self.usable = self.usable.max(index + 1);
    }

    /// Takes over the compensations of a bank that was read.
    ///
    /// # Errors
    /// Message for the user if it belongs to something else, is not consistent, or has values beyond `pulses_max`.
    pub fn take_over(&mut self, other: &Self, pulses_max: f64) -> Result<(), String> {
        self.identity.accepts(&other.identity)?;
        let consistent = other.usable <= other.patterns.len() && other.patterns.len() == self.patterns.len();
        if !consistent || !self.patterns.iter().zip(&other.patterns).all(|(a, b)| a.fits(b)) {
            return Err("its samples are not those of this path".to_owned());
        }
        let values = other.patterns.iter().flat_map(|pattern| &pattern.samples).flat_map(|sample| sample.compensation);
        if let Some(value) = values.into_iter().find(|value| value.is_nan() || value.abs() > pulses_max) {
            return Err(format!(
                "it has the compensation `{value}` pulses, limit `expert.limits.pulses_max` = `{pulses_max}`"
            ));
        }
        for (pattern, other) in self.patterns.iter_mut().zip(&other.patterns) {
            let samples = pattern.samples.iter_mut().zip(&other.samples);
            samples.for_each(|(sample, other)| sample.compensation = other.compensation);
        }
        self.usable = other.usable;
        Ok(())
    }

    /// Only the first `usable` patterns are learned.
    pub fn limit(&mut self, usable: usize) {
        self.usable = usable.min(self.patterns.len());
    }
}

/// Identity of a bank for this path and these parameters.
fn identity(p: &Parameters, path: &ProgrammedPath) -> Identity {
    let mut print = Fingerprint::default();
    path.fingerprint(&mut print);
    let numbers = [CORNER, p.feed.acceleration, p.feed.smoothing.into(), p.learn.lead_in.into()];
    let geometry = [p.learn.lead_out.into(), p.arm.height, p.arm.reach, p.arm.tool_offset];
    numbers.iter().chain(&geometry).chain(&p.servo_gain).for_each(|value| print.add(*value));
    Identity {
        path: print.value(),
        pulses: p.pulses(),
        period: p.sample_period,
        io_delay: p.io_delay as u16,
        factors: p.learn.factors.list().to_vec(),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;
    use crate::learning::speeds::Speeds;

    /// The path of the test banks.
    pub(crate) fn path() -> ProgrammedPath {
        straight(0.1)
    }

    /// A bank with `value(k)` in the sample `k` of each pattern.
    pub(crate) fn numbered(value: impl Fn(usize) -> f64) -> PatternBank {
        let mut bank = PatternBank::plan(&Parameters::START, &path()).unwrap();
        for index in 0..5 {
            for (k, sample) in bank.pattern_mut(index).samples.iter_mut().enumerate() {
                sample.compensation = std::array::from_fn(|i| value(k) + i as f64);
            }
            bank.learned(index);
        }
        bank
    }

    #[test]
    fn the_same_machine_takes_a_bank_over() {
        let mut bank = PatternBank::plan(&Parameters::START, &path()).unwrap();
        assert!(bank.patterns().is_empty());
        bank.take_over(&numbered(|k| k as f64), 32_767.0).unwrap();
        assert_eq!(bank, numbered(|k| k as f64));
    }

    #[test]
    fn a_bank_of_something_else_is_rejected_with_the_difference() {
        let rejected = |change: fn(&mut Parameters), length: f64| {
            let mut p = Parameters::START;
            change(&mut p);
            let mut bank = PatternBank::plan(&p, &straight(length)).unwrap();
            bank.take_over(&numbered(|_| 1.0), 32_767.0).unwrap_err()
        };
        let cases = [
            (rejected(|p| p.sample_period = 0.005, 0.1), "sample period is `0.01 s`, must be `0.005 s`"),
            (rejected(|p| p.io_delay = 0, 0.1), "`io_delay` is `1`, must be `0`"),
            (rejected(|p| p.axis[2].pulse = 1e-5, 0.1), "pulses are"),
            (rejected(|p| p.learn.factors = Speeds::new(&[1.0, 0.5]).unwrap(), 0.1), "speeds are"),
            (rejected(|_| (), 0.1001), "another path"),
            (rejected(|p| p.feed.acceleration = 0.6, 0.1), "another path, feed or robot"),
            (rejected(|p| p.arm.tool_offset = 0.21, 0.1), "fingerprint is"),
        ];
        for (message, part) in cases {
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn values_that_no_pattern_has_are_rejected() {
        let mut bank = PatternBank::plan(&Parameters::START, &path()).unwrap();
        for value in [f64::NAN, f64::INFINITY, 40_000.0] {
            assert!(bank.take_over(&numbered(|_| value), 32_767.0).is_err());
        }
    }

    #[test]
    fn everything_that_the_path_depends_on_is_in_the_fingerprint() {
        let of = |change: fn(&mut Parameters)| {
            let mut p = Parameters::START;
            change(&mut p);
            identity(&p, &path()).path
        };
        let changes: [fn(&mut Parameters); 9] = [
            |_| (),
            |p| p.feed.acceleration += 0.01,
            |p| p.feed.smoothing += 1,
            |p| p.learn.lead_in += 1,
            |p| p.learn.lead_out += 1,
            |p| p.arm.height += 0.01,
            |p| p.arm.reach += 0.01,
            |p| p.arm.tool_offset += 0.01,
            |p| p.servo_gain[5] += 1.0,
        ];
        let prints = changes.map(of);
        assert!((0..9).all(|i| (0..i).all(|k| prints[i] != prints[k])));
    }

    #[test]
    fn values_up_to_the_limit_are_taken_and_patterns_counted() {
        let mut bank = PatternBank::plan(&Parameters::START, &path()).unwrap();
        // the sixth axis has 5 pulses more
        assert!(bank.take_over(&numbered(|_| 100.0), 105.0).is_ok());
        let message = bank.take_over(&numbered(|_| -101.0), 100.0).unwrap_err();
        assert!(message.contains("`-101` pulses, limit `expert.limits.pulses_max` = `100`"), "{message}");
        bank.limit(2);
        assert_eq!((bank.patterns().len(), bank.planned().len()), (2, 5));
        bank.learned(0);
        assert_eq!(bank.patterns().len(), 2);
        bank.learned(3);
        assert_eq!(bank.patterns().len(), 4);
        bank.limit(9);
        assert_eq!(bank.patterns().len(), 5);
        assert_eq!((bank.factor(1), bank.factor(4), bank.factor(7)), (0.8, 0.2, 0.2));
        assert_eq!(bank.longest(), bank.pattern(4).len());
        let mut other = numbered(|_| 1.0);
        other.usable = 6;
        assert!(bank.take_over(&other, 1e9).is_err());
        (other.usable, bank.usable) = (3, 0);
        assert!(bank.take_over(&other, 1e9).is_ok() && bank.patterns().len() == 3);
    }
}

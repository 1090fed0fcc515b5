//! The bank: the control patterns of all speeds, and what they belong to.

use control_blocks::ParameterError;
use serde::{Deserialize, Serialize};

use crate::fingerprint::Fingerprint;
use crate::kinematics::{AXES, Joints};
use crate::parameters::Parameters;
use crate::path::Path;
use crate::pattern::Pattern;

/// What a bank belongs to; another path or machine needs another bank.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Fingerprint of the path, its feed and the geometry of the robot.
    pub path: u64,
    /// Pulse of each axis, rad or m.
    pub pulses: Joints,
    /// Sample period, s.
    pub period: f64,
    /// Multiples of the taught speed.
    pub factors: Vec<f64>,
}

/// Patterns from the fastest to the slowest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bank {
    identity: Identity,
    patterns: Vec<Pattern>,
    /// how many of them are learned
    usable: usize,
}

impl Bank {
    /// Patterns of zeros for all speeds.
    ///
    /// # Errors
    /// When the path takes too long at one of them.
    pub fn plan(p: &Parameters, path: &Path) -> Result<Self, ParameterError> {
        let plan = |factor: &f64| Pattern::plan(p, path, *factor);
        let patterns = p.learn.speeds.list().iter().map(plan).collect::<Result<Vec<_>, _>>();
        let patterns = patterns.map_err(|limit| ParameterError {
            name: "learn.speeds",
            value: format!("{:?}", p.learn.speeds.list()),
            limit: format!("speeds at which the path is not too long: {limit}"),
            hint: "leave out the slowest speed, or split the path",
        })?;
        Ok(Self { identity: identity(p, path), patterns, usable: 0 })
    }

    /// Patterns that can be used, from the fastest on.
    pub fn patterns(&self) -> &[Pattern] {
        &self.patterns[..self.usable]
    }

    /// What the bank belongs to.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Number of samples of the longest pattern.
    pub fn longest(&self) -> usize {
        self.patterns.iter().map(Pattern::len).max().unwrap_or(0)
    }

    /// Multiple of the taught speed of the pattern `index`, or of the last one.
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

    /// Forgets everything that was learned.
    pub fn clear(&mut self) {
        self.usable = 0;
        let samples = self.patterns.iter_mut().flat_map(|pattern| &mut pattern.samples);
        samples.for_each(|sample| sample.compensation = [0.0; AXES]);
    }
}

/// What a bank for this path and these parameters belongs to.
fn identity(p: &Parameters, path: &Path) -> Identity {
    let mut print = Fingerprint::default();
    path.fingerprint(&mut print);
    let numbers = [p.feed.acceleration, f64::from(p.feed.smoothing), f64::from(p.learn.lead_in)];
    let geometry = [f64::from(p.learn.lead_out), p.arm.height, p.arm.reach, p.arm.tool_offset];
    numbers.iter().chain(&geometry).for_each(|value| print.add(*value));
    Identity {
        path: print.value(),
        pulses: p.pulses(),
        period: p.sample_period,
        factors: p.learn.speeds.list().to_vec(),
    }
}

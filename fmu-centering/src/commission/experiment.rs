//! Motion of a commissioning run: rounds of strokes from the start position, towards the ring and back.

use control_blocks::{DELAY_MAX, Trajectory};
use serde::{Deserialize, Serialize};

use crate::commission::plan::{self, REST, ROUNDS};
use crate::commission::response::response;
use crate::interface::{Measured, Parameters};
use crate::motion::Motion;
use crate::sensing::ServoEstimator;

/// Result of a round.
#[derive(Clone, Debug)]
pub struct Round {
    /// It was the last one.
    pub last: bool,
    /// The servo, if the motion identifies it.
    pub found: Option<Measured>,
    /// Difference of the identified delay from the one at the start of the round, samples.
    pub shift: f64,
}

/// One experiment, sample by sample; by default before the first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Experiment {
    estimator: ServoEstimator,
    /// delay with which this round is fitted, samples
    delay: f64,
    round: u32,
    /// number of the active stroke
    stroke: usize,
    /// start position, m
    start: f64,
    /// a measurement of this round was lost
    spoilt: bool,
}

impl Experiment {
    /// Starts with the first stroke from the setpoint at rest.
    pub fn begin(p: &Parameters, motion: &mut Motion) -> Self {
        let new = Self { delay: f64::from(p.io_delay), start: motion.setpoint.position, ..Self::default() };
        new.lead(p, motion);
        new
    }

    /// Adds the last setpoint and the slide position (m), measured or bridged.
    pub fn observe(&mut self, p: &Parameters, setpoint: &Trajectory, slide: f64, bridged: bool) {
        self.estimator.update(p.sample_period, self.delay, setpoint, slide);
        self.spoilt |= bridged;
    }

    /// Starts the next stroke when one is complete; the result of a round that ends with it.
    pub fn advance(&mut self, p: &Parameters, motion: &mut Motion) -> Option<Round> {
        let last = plan::stroke(self.stroke + 1).is_none();
        if !motion.arrived(p, if last { REST } else { 0.0 }) {
            return None;
        }
        self.stroke = if last { 0 } else { self.stroke + 1 };
        let round = last.then(|| self.close(p)).flatten();
        self.lead(p, motion);
        round
    }

    /// Starts the motion of this stroke.
    fn lead(&self, p: &Parameters, motion: &mut Motion) {
        if let Some((position, speed)) = plan::stroke(self.stroke) {
            let end = self.start + position * plan::travel(p);
            motion.go_gently(end, speed * p.approach.velocity, plan::acceleration(p));
        }
    }

    /// Ends a round; a round with a lost measurement is repeated and has no result.
    fn close(&mut self, p: &Parameters) -> Option<Round> {
        let estimator = std::mem::take(&mut self.estimator);
        if std::mem::take(&mut self.spoilt) {
            return None;
        }
        self.round += 1;
        let found = estimator.fit(p.sample_period).and_then(|fit| response(p, &fit, self.delay));
        let delay = found.as_ref().map_or(self.delay, |found| found.io_delay.clamp(0.0, DELAY_MAX as f64));
        let shift = delay - std::mem::replace(&mut self.delay, delay);
        Some(Round { last: self.round == ROUNDS, found, shift })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_motions_take_the_configured_time_and_are_not_faster_than_an_approach() {
        let p = Parameters::START;
        let mut motion = Motion::default();
        motion.start(0.1);
        let mut experiment = Experiment::begin(&p, &mut motion);
        let (mut samples, mut last) = (0u32, false);
        while !last {
            motion.step(&p, 0.0);
            samples += 1;
            let setpoint = motion.setpoint;
            assert!(setpoint.velocity.abs() <= p.approach.velocity && samples < 20_000);
            experiment.observe(&p, &setpoint, setpoint.position, false);
            last = experiment.advance(&p, &mut motion).is_some_and(|round| round.last);
        }
        // a stroke ends with a sample
        let strokes = f64::from(ROUNDS) * (0..).map_while(plan::stroke).count() as f64;
        let early = plan::shortest_time(&p) - f64::from(samples) * p.sample_period;
        assert!((0.0..=strokes * p.sample_period).contains(&early), "{early} s");
    }
}

//! The commissioning run as seen by the controller: results, and the active values.

use control_blocks::ActiveValues;
use serde::{Deserialize, Serialize};

use crate::commission::experiment::{Experiment, Round};
use crate::commission::values::Values;
use crate::interface::{Measured, Parameters};
use crate::motion::Motion;

/// Consecutive commissioning runs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Identification {
    experiment: Experiment,
    /// Measured values, also of a rejected run.
    pub measured: Measured,
    /// The result cannot be used.
    pub rejected: bool,
    /// The experiment is finished, and its result is good.
    pub finished: bool,
    values: ActiveValues<Values>,
}

impl Identification {
    /// Nothing measured so far.
    pub fn new(p: &Parameters) -> Self {
        Self {
            experiment: Experiment::default(),
            measured: Measured::START,
            rejected: false,
            finished: false,
            values: ActiveValues::new(Values::of(p)),
        }
    }

    /// Starts from the setpoint at rest.
    pub fn begin(&mut self, p: &Parameters, motion: &mut Motion) {
        self.experiment = Experiment::begin(p, motion);
        (self.measured, self.rejected, self.finished) = (Measured::START, false, false);
    }

    /// Aborts the run: the configured values apply.
    pub fn abort(&mut self) {
        self.values.restore();
        self.measured.valid = false;
    }

    /// Discards rejected values.
    pub fn forget_rejected(&mut self) {
        if !self.measured.valid {
            self.measured = Measured::START;
        }
    }

    /// Replaces the values of the parameters by the active ones.
    pub fn put(&self, p: &mut Parameters) {
        self.values.now().put(p);
    }

    /// Names and values of the parameters that a good run derives.
    pub fn derived(&self) -> [(&'static str, f64); 2] {
        self.values.derived().entries()
    }

    /// Adds the slide position (m), measured or bridged, with the last setpoint, and continues the motion.
    pub fn observe(&mut self, p: &Parameters, motion: &mut Motion, slide: f64, bridged: bool) {
        self.experiment.observe(p, &motion.setpoint, slide, bridged);
        if let Some(round) = self.experiment.advance(p, motion) {
            self.conclude(p, round);
        }
    }

    /// Uses the result of a round.
    fn conclude(&mut self, p: &Parameters, round: Round) {
        let Round { last, found, shift } = round;
        self.measured = found.unwrap_or(Measured::START);
        if !last {
            return;
        }
        let configured = self.values.configured();
        self.rejected = !configured.accept(p, &self.measured, shift);
        if !self.rejected {
            (self.measured.valid, self.finished) = (true, true);
            self.values.conclude(configured.derived(&self.measured), p.commission.apply);
        }
    }
}

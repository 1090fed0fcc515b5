//! The commission as the controller sees it: what was found, and which values are in force.

use control_blocks::InForce;
use serde::{Deserialize, Serialize};

use crate::commission::experiment::{Experiment, Round};
use crate::commission::values::Values;
use crate::interface::{Measured, Parameters};
use crate::motion::Motion;

/// One commission after the other.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Identification {
    experiment: Experiment,
    /// What was measured, also of a commission that was rejected.
    pub measured: Measured,
    /// The result cannot be used.
    pub rejected: bool,
    /// The experiment has come to its end, and its result is good.
    pub finished: bool,
    values: InForce<Values>,
}

impl Identification {
    /// Nothing measured so far.
    pub fn new(p: &Parameters) -> Self {
        Self {
            experiment: Experiment::default(),
            measured: Measured::START,
            rejected: false,
            finished: false,
            values: InForce::new(Values::of(p)),
        }
    }

    /// Begins where the setpoint is at rest.
    pub fn begin(&mut self, p: &Parameters, motion: &mut Motion) {
        self.experiment = Experiment::begin(p, motion);
        (self.measured, self.rejected, self.finished) = (Measured::START, false, false);
    }

    /// Ends before its end: what was told counts.
    pub fn abort(&mut self) {
        self.values.restore();
        self.measured.valid = false;
    }

    /// Forgets what was rejected.
    pub fn forget_rejected(&mut self) {
        if !self.measured.valid {
            self.measured = Measured::START;
        }
    }

    /// Puts the values in force in place of those that the parameters have.
    pub fn put(&self, p: &mut Parameters) {
        self.values.now().put(p);
    }

    /// Names and values of what a good commission derives.
    pub fn derived(&self) -> [(&'static str, f64); 2] {
        self.values.derived().entries()
    }

    /// Takes the position of the slide (m), read or bridged, beside the last setpoint, and leads the slide on.
    pub fn observe(&mut self, p: &Parameters, motion: &mut Motion, slide: f64, bridged: bool) {
        self.experiment.observe(p, &motion.setpoint, slide, bridged);
        if let Some(round) = self.experiment.advance(p, motion) {
            self.conclude(p, round);
        }
    }

    /// Takes what a round has told.
    fn conclude(&mut self, p: &Parameters, round: Round) {
        let Round { last, found, shift } = round;
        self.measured = found.unwrap_or(Measured::START);
        if !last {
            return;
        }
        let told = self.values.told();
        self.rejected = !told.accept(p, &self.measured, shift);
        if !self.rejected {
            (self.measured.valid, self.finished) = (true, true);
            self.values.conclude(told.derived(&self.measured), p.commission.apply);
        }
    }
}

//! The commissioning run inside the controller: oscillation, results and active values.

use control_blocks::{ActiveValues, ticks};
use serde::{Deserialize, Serialize};

use crate::check::{min_tip_frequency, minimum_time_constant};
use crate::commission::arm::{IdentifiedArm, find};
use crate::commission::plan::{self, Plan};
use crate::commission::values::{Values, acceptable};
use crate::identify::experiment::Identification;
use crate::interface::{Measured, Parameters};
use crate::servo::design::{LoopMargins, shape};
use crate::servo::lead_lag::LeadLag;
use crate::servo::loop_model::LoopModel;
use crate::servo::nominal::Nominal;

/// Ratio of the bandwidth of each trial to the one before, and the smallest ratio to the desired bandwidth.
const NARROWER: f64 = 0.96;
const BANDWIDTH_MIN: f64 = 0.3;

/// Time in which an oscillating arm must be seen to move, s: three tones, because the hub hardly moves at the zero of
/// the flexure.
const REST_MAX: f64 = 1.2;

/// Commissioning run; [`Self::begin`] starts another one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CommissioningRun {
    /// The tones of the present or last run.
    pub experiment: Identification,
    /// Identified arm with standard deviations; [`Measured::START`] until it is identified.
    pub measured: Measured,
    /// The result is rejected, or the arm does not move.
    pub rejected: bool,
    /// The run is complete and its result is good.
    pub finished: bool,
    plan: Plan,
    /// its longest time, s
    limit: f64,
    values: ActiveValues<Values>,
    /// those with the arm that was measured, whose bandwidth is being found
    candidate: Values,
    /// last arm angle (rad), and the number of samples without a change
    angle: f64,
    still: u32,
}

impl CommissioningRun {
    /// Nothing measured so far.
    pub fn new(p: &Parameters) -> Self {
        let (plan, nominal) = (Plan::new(p), Values::of(p));
        Self {
            experiment: plan.experiment(p),
            measured: Measured::START,
            rejected: false,
            finished: false,
            plan,
            limit: plan::time(p),
            values: ActiveValues::new(nominal),
            candidate: nominal,
            angle: 0.0,
            still: 0,
        }
    }

    /// Starts at rest, under the loop of the nominal arm.
    pub fn begin(&mut self) {
        self.experiment.restart();
        self.measured = Measured::START;
        (self.rejected, self.finished, self.still) = (false, false, 0);
    }

    /// Aborts: the configured values become active.
    pub fn abort(&mut self) {
        self.values.restore();
        self.measured.valid = false;
    }

    /// Longest time that it may take, s.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// The compensator that holds the arm meanwhile.
    pub fn compensator(&self) -> &LeadLag {
        self.plan.model.compensator()
    }

    /// Values in force, in place of those that the parameters have.
    pub fn put(&self, p: &mut Parameters) {
        self.values.now().put(p);
    }

    /// Whether other values are in force since this was last asked.
    pub fn take_renewed(&mut self) -> bool {
        self.values.take_renewed()
    }

    /// Whether the configured values are active.
    pub fn configured(&self) -> bool {
        self.values.as_configured()
    }

    /// Names and values that a successful run derives.
    pub fn derived(&self) -> [(&'static str, f64); 8] {
        self.values.derived().entries()
    }

    /// After a sample with the arm at `angle` (rad): once the oscillation is over, the response identifies the arm, and
    /// then, one trial per sample, the bandwidth. An arm without a change of its angle identifies nothing.
    pub fn observe(&mut self, p: &Parameters, angle: f64) {
        let before = std::mem::replace(&mut self.angle, angle);
        self.still = if angle == before { self.still + 1 } else { 0 };
        self.rejected |= self.still > ticks(REST_MAX, p.sample_period);
        if self.finished || self.rejected || !self.experiment.done() {
            return;
        }
        if self.measured == Measured::START { self.identify(p) } else { self.shape(p) }
    }

    fn identify(&mut self, p: &Parameters) {
        if let Ok(arm) = find(&self.plan, self.experiment.response()) {
            self.measured = measured(&arm);
        }
        let nominal = self.values.configured();
        self.rejected = !acceptable(p, &nominal.nominal, &self.measured);
        self.candidate = nominal.derived(&self.measured);
    }

    /// The desired bandwidth, or the largest below it that leaves the margins and suits the other parameters.
    fn shape(&mut self, p: &Parameters) {
        let (compensator, _) = shape(&self.candidate.nominal);
        // the design uses whole samples; its margins use the measured delay
        let late = self.measured.io_delay - f64::from(self.candidate.nominal.io_delay);
        let model = LoopModel::new(self.candidate.nominal, compensator);
        let margins = LoopMargins::of(&self.candidate.nominal, &model, late);
        let Nominal { servo, tip, .. } = &mut self.candidate.nominal;
        let soft = tip.frequency > 0.0 && tip.frequency < min_tip_frequency(servo.bandwidth);
        if soft || !margins.enough() || margins.sensitivity > p.commission.sensitivity_max {
            servo.bandwidth *= NARROWER;
            self.rejected = servo.bandwidth < BANDWIDTH_MIN * self.values.configured().nominal.servo.bandwidth
                || p.afc.tau < minimum_time_constant(p, servo.bandwidth);
            return;
        }
        (self.measured.valid, self.finished) = (true, true);
        self.values.conclude(self.candidate, p.commission.apply);
    }
}

/// The outputs of an arm.
fn measured(arm: &IdentifiedArm) -> Measured {
    let IdentifiedArm { inertia, viscous_friction, dry_friction, delay, frequency, damping, tip_ratio } = *arm;
    Measured {
        valid: false,
        inertia: inertia[0],
        inertia_std: inertia[1],
        viscous_friction: viscous_friction[0],
        viscous_friction_std: viscous_friction[1],
        dry_friction: dry_friction[0],
        dry_friction_std: dry_friction[1],
        io_delay: delay[0],
        io_delay_std: delay[1],
        tip_frequency: frequency[0],
        tip_frequency_std: frequency[1],
        tip_inertia: tip_ratio[0],
        tip_inertia_std: tip_ratio[1],
        tip_damping: damping[0],
        tip_damping_std: damping[1],
    }
}

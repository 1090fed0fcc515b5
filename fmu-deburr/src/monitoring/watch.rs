//! All axes against the models of their loops.

use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::axis::{AxisMonitor, Expectation, Motion, Verdict};
use crate::monitoring::finding::{Finding, Numbers};
use crate::monitoring::rest::RestError;
use crate::path::kinematics::{AXES, Joints};

/// Six monitors, and what is left in the rest after a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Watch {
    axes: [AxisMonitor; AXES],
    rest: RestError,
}

impl Watch {
    /// At rest at zero.
    pub fn new(p: &Parameters) -> Self {
        Self { axes: std::array::from_fn(|i| AxisMonitor::new(p, i)), rest: RestError::default() }
    }

    /// The loops close at rest at these positions, rad or m.
    pub fn restart(&mut self, p: &Parameters, positions: &Joints) {
        for (i, axis) in self.axes.iter_mut().enumerate() {
            axis.restart(positions[i], p.axis[i].pulse);
        }
    }

    /// Looks at all axes: positions, commanded motions (rad or m) and errors (counts). The first that is wrong.
    pub fn look(
        &mut self,
        p: &Parameters,
        positions: &Joints,
        motions: &Joints,
        error: &Joints,
        expected: Expectation,
    ) -> Verdict {
        let mut first = Verdict::Good;
        for (i, axis) in self.axes.iter_mut().enumerate() {
            let motion = Motion { position: positions[i], commanded: motions[i], error: error[i] * p.axis[i].pulse };
            let verdict = axis.look(p, i, &motion, expected);
            if first == Verdict::Good || matches!((first, verdict), (Verdict::Grown, Verdict::Wrong(_))) {
                first = verdict;
            }
        }
        first
    }

    /// Takes what was sent: references and compensations in counts, and velocity commands (rad/s or m/s).
    pub fn command(&mut self, p: &Parameters, reference: &Joints, compensation: &Joints, velocity: &Joints) {
        for (i, axis) in self.axes.iter_mut().enumerate() {
            axis.command(p, i, reference[i], compensation[i], velocity[i]);
        }
    }

    /// Begins a run.
    pub fn begin_run(&mut self) {
        self.rest = RestError::default();
    }

    /// Takes a sample of the rest after a run.
    pub fn rests(&mut self, p: &Parameters, positions: &Joints) {
        let residual = std::array::from_fn(|i| self.axes[i].residual(positions[i], p.axis[i].pulse));
        self.rest.update(&residual, &std::array::from_fn(|i| self.axes[i].allowance()));
    }

    /// What is wrong with a run that has come to rest: an axis that does not stand where its loop brings it.
    pub fn after_run(&self, p: &Parameters) -> Finding {
        let (mean, allowed) = self.rest.means();
        let limit = |i: usize| p.limits.axis[i].rest_error + allowed[i];
        (0..AXES).find(|i| mean[*i].abs() > limit(*i)).map_or(Finding::NONE, |i| {
            let numbers = Numbers { axis: i as i32 + 1, value: mean[i].abs(), limit: limit(i), share: None };
            Finding { fault: Fault::FollowingError, numbers }
        })
    }
}

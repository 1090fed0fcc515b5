//! The commission as the controller sees it: what moves, what was found, and which values are in force.

use control_blocks::Trajectory;
use serde::{Deserialize, Serialize};

use crate::commission::experiment::{Experiment, Milestone};
use crate::commission::plan::DELAY_SPREAD;
use crate::commission::response::{loop_spread, response, ripple};
use crate::commission::values::{Values, acceptable};
use crate::interface::{ForceOutput, Measured, Parameters};
use crate::motion::stability::longest_delay;

/// One commission after the other.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Commissioner {
    /// The present or last experiment.
    pub experiment: Experiment,
    /// What was measured.
    pub measured: Measured,
    /// The result cannot be used.
    pub rejected: bool,
    /// The experiment has come to its end.
    pub finished: bool,
    told: Values,
    /// what the last good commission derives
    derived: Values,
    in_force: Values,
    renewed: bool,
    longest_delay: i32,
    /// force that holds the stage, N
    held: f64,
}

impl Commissioner {
    /// Nothing measured so far.
    pub fn new(p: &Parameters) -> Self {
        let told = Values::of(p);
        Self {
            experiment: Experiment::new(p, 0.0),
            measured: Measured::START,
            rejected: false,
            finished: false,
            told,
            derived: told,
            in_force: told,
            renewed: false,
            longest_delay: longest_delay(p, p.io_delay as usize + DELAY_SPREAD),
            held: 0.0,
        }
    }

    /// Begins at rest at `start` m with what was told; `held` is the force (N) that holds the stage.
    pub fn begin(&mut self, p: &Parameters, start: f64, held: f64) {
        self.experiment = Experiment::new(p, start);
        (self.measured, self.held) = (Measured::START, held);
        (self.rejected, self.finished) = (false, false);
    }

    /// Ends before its end: what was told counts.
    pub fn break_off(&mut self) {
        self.bring_into_force(self.told);
        self.measured.valid = false;
    }

    /// Values in force, in place of those that the parameters have.
    pub fn put(&self, p: &mut Parameters) {
        self.in_force.put(p);
    }

    /// Whether other values are in force since this was last asked.
    pub fn take_renewed(&mut self) -> bool {
        std::mem::take(&mut self.renewed)
    }

    /// Names and values of what a good commission derives.
    pub fn derived(&self) -> [(&'static str, f64); 8] {
        self.derived.entries()
    }

    /// Force (N) that holds the stage.
    pub fn held(&self) -> f64 {
        self.held
    }

    /// The same current means another force: `ratio` is the new thrust constant over the one before.
    pub fn rescale(&mut self, ratio: f64) {
        self.held *= ratio;
    }

    /// Takes what this sample has read (m), sent (A) and estimated.
    pub fn observe(
        &mut self,
        p: &Parameters,
        position: Option<f64>,
        current: f64,
        force: &ForceOutput,
        reference: &Trajectory,
    ) {
        match self.experiment.observe(p, position, current, force, reference) {
            Milestone::None => {}
            Milestone::Excited => self.identify(p),
            Milestone::Finished => self.finish(p),
        }
    }

    /// Thrust, delay, friction and stiffness; they are in force for the strokes, so that the noise is that of the law with them.
    fn identify(&mut self, p: &Parameters) {
        if let Ok(found) = response(p, &self.experiment.plan, &self.experiment.spectra) {
            let (value, mass) = (found.value, p.stage.mass);
            self.measured = Measured {
                force_constant: mass * value[0],
                force_constant_deviation: f64::hypot(mass * found.sigma(0), ripple(mass * value[0])),
                io_delay: value[1],
                io_delay_deviation: found.sigma(1).hypot(loop_spread(p)),
                damping: mass * value[2],
                damping_deviation: mass * found.sigma(2),
                stiffness: mass * value[3],
                stiffness_deviation: mass * found.sigma(3),
                ..Measured::START
            };
        }
        // near what is in force, with which it is held, and near what was told, so that one commission after another goes nowhere
        let near = [p.stage.force_constant, self.told.force_constant];
        self.rejected = !near.into_iter().all(|told| acceptable(p, told, self.longest_delay, &self.measured));
        if !self.rejected {
            self.bring_into_force(self.told.with_response(&self.measured));
        }
    }

    fn finish(&mut self, p: &Parameters) {
        let noise = &self.experiment.noise;
        let [position, white, walk, force, slope] =
            [noise.position(), noise.white_force(), noise.walk(), noise.force(), noise.slope()];
        self.measured = Measured {
            position_noise: position.value,
            position_noise_deviation: position.deviation,
            force_noise: white.value,
            force_noise_deviation: white.deviation,
            disturbance_walk: walk.value,
            disturbance_walk_deviation: walk.deviation,
            force_sigma: force.value,
            force_sigma_deviation: force.deviation,
            slope_sigma: slope.value,
            slope_sigma_deviation: slope.deviation,
            ..self.measured
        };
        self.rejected = !self.told.quiet(p, &self.measured);
        if self.rejected {
            return;
        }
        (self.measured.valid, self.finished) = (true, true);
        self.derived = self.told.with_response(&self.measured).with_noise(p, &self.measured);
        self.bring_into_force(if p.commission.apply { self.derived } else { self.told });
    }

    fn bring_into_force(&mut self, values: Values) {
        self.renewed |= values != self.in_force;
        self.in_force = values;
    }
}

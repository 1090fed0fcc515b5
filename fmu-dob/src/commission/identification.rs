//! The commissioning run: its motion, its result, and the active values.

use control_blocks::{ActiveValues, Trajectory, tolerated_delays};
use serde::{Deserialize, Serialize};

use crate::check::check_derived;
use crate::commission::experiment::{Experiment, Milestone};
use crate::commission::response::{loop_spread, response, ripple};
use crate::commission::values::{Values, acceptable};
use crate::interface::{ForceOutput, Measured, Parameters};
use crate::motion::stability::longest_delay;

/// Consecutive commissioning runs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Identification {
    /// The present or last experiment.
    pub experiment: Experiment,
    /// Measured values.
    pub measured: Measured,
    /// The result cannot be used.
    pub rejected: bool,
    /// The experiment has come to its end, and its result is good.
    pub finished: bool,
    values: ActiveValues<Values>,
    longest_delay: i32,
    /// force that holds the stage, N
    held: f64,
}

impl Identification {
    /// Nothing measured so far.
    pub fn new(p: &Parameters) -> Self {
        Self {
            experiment: Experiment::new(p, 0.0),
            measured: Measured::START,
            rejected: false,
            finished: false,
            values: ActiveValues::new(Values::of(p)),
            longest_delay: longest_delay(p, *tolerated_delays(p.io_delay).end() as usize),
            held: 0.0,
        }
    }

    /// Begins at rest at `start` m with what is in force; `held` is the force (N) that holds the stage.
    pub fn begin(&mut self, p: &Parameters, start: f64, held: f64) {
        self.experiment = Experiment::new(p, start);
        (self.measured, self.held) = (Measured::START, held);
        (self.rejected, self.finished) = (false, false);
    }

    /// Aborts the run: the configured values are restored.
    pub fn abort(&mut self) {
        self.values.restore();
        self.measured.valid = false;
    }

    /// Puts the values in force in place of those that the parameters have; what was found since the last sample only
    /// if the parameters with it fit each other. The response is active during the strokes, so that the noise is that
    /// of the control law with it.
    pub fn put(&mut self, p: &mut Parameters) {
        if let Some(found) = self.values.take_proposed() {
            found.put(p);
            self.rejected = check_derived(p).is_err();
            match (self.rejected, self.experiment.over()) {
                (true, _) => {}
                (false, false) => self.values.bring(found),
                (false, true) => {
                    (self.measured.valid, self.finished) = (true, true);
                    self.values.conclude(found, p.commission.apply);
                }
            }
        }
        self.values.now().put(p);
    }

    /// Whether other values are in force since this was last asked.
    pub fn take_renewed(&mut self) -> bool {
        self.values.take_renewed()
    }

    /// Names and values of the parameters that a successful run derives.
    pub fn derived(&self) -> [(&'static str, f64); 9] {
        self.values.derived().entries()
    }

    /// Force (N) that holds the stage.
    pub fn held(&self) -> f64 {
        self.held
    }

    /// The same current is another force: `ratio` is the new thrust constant over the previous one.
    pub fn rescale(&mut self, ratio: f64) {
        self.held *= ratio;
    }

    /// Takes position (m), current (A) and estimates of this sample.
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

    /// Thrust, delay, friction and stiffness.
    fn identify(&mut self, p: &Parameters) {
        if let Ok(found) = response(p, &self.experiment.plan, &self.experiment.spectra) {
            let (value, mass) = (found.value, p.stage.mass);
            self.measured = Measured {
                force_constant: mass * value[0],
                force_constant_std: f64::hypot(mass * found.sigma(0), ripple(mass * value[0])),
                io_delay: value[1],
                io_delay_std: found.sigma(1).hypot(loop_spread(p)),
                damping: mass * value[2],
                damping_std: mass * found.sigma(2),
                stiffness: mass * value[3],
                stiffness_std: mass * found.sigma(3),
                ..Measured::START
            };
        }
        // near the active values, with which the stage is held, and near the configured ones, so that repeated runs do
        // not drift
        let configured = self.values.configured();
        let near = [p.stage.force_constant, configured.force_constant];
        self.rejected =
            !near.into_iter().all(|configured| acceptable(p, configured, self.longest_delay, &self.measured));
        if !self.rejected {
            self.values.propose(configured.with_response(&self.measured));
        }
    }

    fn finish(&mut self, p: &Parameters) {
        let noise = &self.experiment.noise;
        let [position, white, walk, force, slope] =
            [noise.position(), noise.white_force(), noise.walk(), noise.force(), noise.slope()];
        self.measured = Measured {
            position_noise: position.value,
            position_noise_std: position.deviation,
            force_noise: white.value,
            force_noise_std: white.deviation,
            disturbance_walk: walk.value,
            disturbance_walk_std: walk.deviation,
            force_sigma: force.value,
            force_sigma_std: force.deviation,
            slope_sigma: slope.value,
            slope_sigma_std: slope.deviation,
            ..self.measured
        };
        let configured = self.values.configured();
        self.rejected = !configured.quiet(p, &self.measured);
        if !self.rejected {
            self.values.propose(configured.derived(p, &self.measured));
        }
    }
}

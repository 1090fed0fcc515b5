//! The commissioning run inside the controller: motion, results and active values.

use std::f64::consts::PI;

use control_blocks::{ActiveValues, Welford, whole_delay};
use serde::{Deserialize, Serialize};

use crate::check::check_delay;
use crate::commission::estimation::Response;
use crate::commission::experiment::Experiment;
use crate::commission::plan::room;
use crate::commission::values::{ENTRIES, Rejection, Values, rejection};
use crate::interface::{Measured, MeasuredAxis, Parameters};
use crate::learning::drive::Drive;
use crate::path::kinematics::{AXES, Joints};

/// Steps of a measurement of the tool speed, 12 bits, and its range over the idle speed, at most: coarser ones are
/// beyond what is reported.
const READING_STEPS: f64 = 4096.0;
const READING_RANGE: f64 = 1.25;

/// Commissioning run; [`Self::begin`] starts another one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CommissioningRun {
    /// The present or last experiment.
    pub experiment: Experiment,
    /// Delay, drives and tool speed with standard deviations; [`Measured::START`] until all strokes are evaluated.
    pub measured: Measured,
    /// Reason why the result is rejected; none before the end of a run and after a good one.
    pub rejected: Option<Rejection>,
    /// The experiment is complete and its result is accepted.
    pub finished: bool,
    responses: [Response; AXES],
    tool: Welford,
    /// samples of the tool
    samples: u32,
    values: ActiveValues<Values>,
    room: Vec<f64>,
}

impl CommissioningRun {
    /// Nothing measured so far; `speed` is that of the path, m/s.
    pub fn new(p: &Parameters, speed: f64) -> Self {
        Self {
            experiment: Experiment::new(p, speed),
            measured: Measured::START,
            rejected: None,
            finished: false,
            responses: [Response::NONE; AXES],
            tool: Welford::default(),
            samples: 0,
            values: ActiveValues::new(Values::of(p)),
            room: vec![0.0; 2 * room(p, speed)],
        }
    }

    /// Begins at rest at `start` (rad or m) with what is in force.
    pub fn begin(&mut self, p: &Parameters, speed: f64, start: &Joints) {
        self.experiment.begin(p, speed, start);
        (self.measured, self.rejected, self.finished) = (Measured::START, None, false);
        (self.tool, self.samples) = (Welford::default(), 0);
    }

    /// Ends before its end: what was configured counts.
    pub fn abort(&mut self) {
        self.values.restore();
    }

    /// Puts the values in force in place of those that the parameters have; what was derived since the last sample only
    /// if the parameters with it fit each other.
    pub fn put(&mut self, p: &mut Parameters) {
        if let Some(derived) = self.values.take_proposed() {
            derived.put(p);
            self.finished = check_delay(p).is_ok();
            self.measured.valid = self.finished;
            if self.finished {
                self.values.conclude(derived, p.commission.apply);
            } else {
                self.rejected = Some(Rejection::Values);
            }
        }
        self.values.now().put(p);
    }

    /// Whether other values are in force since this was last asked.
    pub fn take_renewed(&mut self) -> bool {
        self.values.take_renewed()
    }

    /// Whether what was measured is in force.
    pub fn applied(&self) -> bool {
        !self.values.as_configured()
    }

    /// Sets the uncertainty of the active drives.
    pub fn report_std(&self, drives: &mut [Drive; AXES]) {
        if self.applied() {
            for (drive, measured) in drives.iter_mut().zip(&self.measured.axis) {
                (drive.gain[1], drive.lag[1]) = (measured.gain_std, measured.lag_std);
            }
        }
    }

    /// Names and values that a successful run derives, with the speeds of `p`.
    pub fn derived(&self, p: &Parameters) -> [(&'static str, f64); ENTRIES] {
        self.values.derived().entries(p)
    }

    /// Takes the control errors (counts) and the tool speed (rad/s) of this sample.
    pub fn observe(&mut self, p: &Parameters, error: &Joints, tool: f64) {
        self.tool.push(tool);
        self.samples += 1;
        if self.experiment.observe(p, error) {
            let axis = self.experiment.axis;
            self.responses[axis] = Response::of(p, axis, &self.experiment.strokes, &mut self.room);
            self.experiment.go_on();
            if self.experiment.axis == AXES {
                self.finish(p);
            }
        }
    }

    fn finish(&mut self, p: &Parameters) {
        self.measured = self.evaluate(p);
        let configured = self.values.configured();
        self.rejected = rejection(p, &configured, &self.measured);
        if self.rejected.is_none() {
            self.values.propose(configured.derived(&self.measured));
        }
    }

    fn evaluate(&self, p: &Parameters) -> Measured {
        let (dt, count) = (p.sample_period, AXES as f64);
        let (delays, spread) = (self.responses.map(|one| [one.delay(p), one.late[1] / dt]), Response::delay_spread(p));
        let (idle, noise) = (self.tool.mean(), self.tool.sigma());
        let (samples, step) = (f64::from(self.samples), unseen_step(idle, p.load.idle_speed, noise));
        let mut measured = Measured {
            io_delay: delays.iter().map(|delay| delay[0]).sum::<f64>() / count,
            // all drives may differ alike from the nominal one
            io_delay_std: spread.hypot(delays.iter().map(|delay| delay[1].powi(2)).sum::<f64>().sqrt() / count),
            idle_speed: idle,
            idle_speed_std: step.hypot(noise / samples.sqrt()),
            spindle_noise: noise,
            spindle_noise_std: step.hypot(noise / (2.0 * samples).sqrt()),
            ..Measured::START
        };
        let whole = f64::from(whole_delay(measured.io_delay)) * dt;
        measured.axis = std::array::from_fn(|i| MeasuredAxis {
            gain: self.responses[i].gain[0],
            gain_std: self.responses[i].gain[1],
            lag: self.responses[i].late[0] - whole,
            lag_std: self.responses[i].late[1],
            natural_frequency: self.responses[i].frequency[0],
            natural_frequency_std: self.responses[i].frequency[1],
            friction: self.responses[i].friction[0],
            friction_std: self.responses[i].friction[1],
            delay: delays[i][0],
            delay_std: spread.hypot(delays[i][1]),
        });
        measured
    }
}

/// Standard deviation (rad/s) that the steps of a measurement leave to mean and noise of a speed, of a tool that was
/// configured to idle at `configured`. Noise s carries a mean across the steps d: of the deviation d/12^(1/2) of a
/// speed that is still it leaves exp(-2 pi^2 s^2/d^2) (Widrow, Kollar 2008).
fn unseen_step(speed: f64, configured: f64, noise: f64) -> f64 {
    // a stopped tool is at no step
    if speed == 0.0 {
        return 0.0;
    }
    let step = READING_RANGE * speed.abs().max(configured) / READING_STEPS;
    let rounding = step * step / 12.0;
    let carried = (noise * noise - rounding).max(0.0);
    rounding.sqrt() * (-2.0 * (PI / step).powi(2) * carried).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_tool_at_rest_is_as_certain_as_its_noise() {
        assert_eq!([unseen_step(0.0, 1885.0, 0.0), unseen_step(0.0, 1885.0, 0.1)], [0.0, 0.0]);
    }

    #[test]
    fn the_speed_of_the_tool_is_as_certain_as_the_steps_of_its_reading_let_it_be() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(11);
        // of tools that idle at 0.7 to 1.3 times what is reported; the measurement goes to 20,000 rpm
        let (configured, step) = (1885.0, 2094.4 / READING_STEPS);
        let (mut squares, mut maximum) = (0.0, 0.0f64);
        for _ in 0..1000 {
            let (speed, noise) = (configured * random.random_range(0.7..1.3), random.random_range(0.0..1.0));
            let mut read = Welford::default();
            for _ in 0..1000 {
                let normal: f64 = StandardNormal.sample(&mut random);
                read.push(((speed + noise * normal) / step).round() * step);
            }
            let std = unseen_step(read.mean(), configured, read.sigma()).hypot(read.sigma() / 1000f64.sqrt());
            let off = (read.mean() - speed) / std;
            (squares, maximum) = (squares + off * off / 1000.0, maximum.max(off.abs()));
        }
        assert!((0.6..1.3).contains(&squares.sqrt()) && maximum < 5.0, "{} {maximum}", squares.sqrt());
    }
}

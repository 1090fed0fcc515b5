//! The touches of a calibration cycle: the speed of each one, and the bias that follows from all of them.
//!
//! All speeds are touched in turn, so that a workpiece which a touch dents shows as scatter. On a hard workpiece the
//! first round lowers the remaining speeds to those that `calibration.force_max` allows.

use std::array;
use std::f64::consts::TAU;

use control_blocks::{NoEstimate, Observation, Welford, least_squares};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::calibration::bias::{Bias, SPEEDS};
use crate::calibration::press::Hardness;
use crate::calibration::spread::Spread;
use crate::interface::{Calibrated, Parameters};

/// Minimum ratio of the fastest speed to the slowest.
pub const RATIO: f64 = 3.0;

/// Tolerated ratio of actual to configured mass; each force is larger by the same ratio.
const HEAVIER: f64 = 1.3;
/// Safety factor for other touches at the same speed: the flutes are at another angle.
const SCATTER: f64 = 1.2;
/// Safety factor on the extrapolated force: earlier touches may have hit the flutes where they hardly cut.
const FASTER: f64 = 1.6;
/// If touches are discarded a second time, the next speeds are lower than the allowed one by this factor, so that the
/// cycle ends.
const AGAIN: f64 = 0.9;

/// Model error of the three parts at a speed, standard deviation, m: the most likely value in addition to the scatter
/// of the five means, on 29 machines whose mass and thrust constant are wrong by up to 30 %, with workpieces of 0.1 to
/// 2 N/um.
const LEFT_OUT: f64 = 6e-9;

/// Fraction of a spindle revolution by which the pause before each touch grows from round to round. The pauses between
/// two touches at the same flute add up: up to four of them shift each round by 0.4 to 1.6 revolutions, so that five
/// rounds are distributed evenly over the half revolution of two flutes.
const LATER: f64 = 0.4;
/// A longer revolution is not waited for, s.
const REVOLUTION_MAX: f64 = 0.1;

/// Degrees of freedom of the pooled scatter in the scatter of one speed: more than one, because two touches have no
/// variance, and few, because one speed may scatter several times as much as the others.
const POOLED: f64 = 2.0;

/// Number of slowest speeds that may be left out: one more speed remains than the bias has parts.
pub const SLOWER_MAX: usize = SPEEDS - 4;

/// Maximum number of touches at each speed.
fn maximum(p: &Parameters) -> u32 {
    p.calibration.touches.max(p.calibration.touches_max).unsigned_abs()
}

/// Touches of one calibration cycle so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TouchSeries {
    /// the slowest first, m/s
    speeds: [f64; SPEEDS],
    /// those that are used
    touches: u32,
    /// those at discarded speeds
    given_up: u32,
    /// rounds beyond `expert.calibration.touches`
    more: u32,
    late: [Welford; SPEEDS],
    hardness: Hardness,
}

impl TouchSeries {
    /// No touches so far, and the speeds of the parameters.
    pub fn new(p: &Parameters) -> Self {
        let slowest = p.calibration.velocity_min;
        Self {
            speeds: array::from_fn(|i| between(slowest, p.calibration.velocity_max, i, SPEEDS - 1)),
            touches: 0,
            given_up: 0,
            more: 0,
            late: [Welford::default(); SPEEDS],
            hardness: Hardness::default(),
        }
    }

    /// Touches so far.
    pub fn touches(&self) -> u32 {
        self.touches + self.given_up
    }

    /// Speed of the next touch, m/s.
    pub fn velocity(&self) -> f64 {
        self.speeds[self.next()]
    }

    /// Lowers the remaining speeds of the first round where the next touch would exceed `calibration.force_max`, and
    /// the fastest one where the last touch has come near it; the force is proportional to the speed. Touched speeds
    /// below the limit are kept. Speeds that every calibration needs are touched in any case.
    ///
    /// # Errors
    /// When that leaves too little of the range: the fastest allowed speed, m/s.
    pub fn lower(&mut self, p: &Parameters) -> Result<(), f64> {
        let (next, minimum) = (self.touches as usize, RATIO * p.calibration.velocity_min);
        let speed = self.speeds[next.min(SPEEDS - 1)];
        if p.calibration.force_max == 0.0 || next > SPEEDS || speed < minimum {
            return Ok(());
        }
        let new = speed > self.hardness.fastest();
        let slope = if new { FASTER * self.hardness.steepest() } else { self.hardness.slope() };
        let fastest = p.calibration.force_max / (HEAVIER * SCATTER * slope);
        if speed <= fastest {
            return Ok(());
        }
        if fastest < minimum {
            return Err(fastest);
        }
        let fastest = if self.given_up > 0 { (AGAIN * fastest).max(minimum) } else { fastest };
        let stay = self.speeds[..next].iter().take_while(|speed| **speed < fastest).count().max(1);
        let from = self.speeds[stay - 1];
        for i in stay..SPEEDS {
            self.speeds[i] = between(from, fastest, i + 1 - stay, SPEEDS - stay);
            self.late[i] = Welford::default();
        }
        (self.touches, self.given_up) = (stay as u32, self.given_up + (next - stay) as u32);
        Ok(())
    }

    /// Speed of the touch after that (m/s), if there may be one.
    pub fn after(&self, p: &Parameters) -> Option<f64> {
        let last = self.touches + 1 >= SPEEDS as u32 * maximum(p);
        (!last).then(|| self.speeds[(self.next() + 1) % SPEEDS])
    }

    /// Pause (s) at rest before the next touch, at `spindle_speed` rad/s. A slow touch is detected where a flute cuts,
    /// and the rest of the cycle takes equally long. Without the pause each speed would touch at one spindle angle, and
    /// its mean would have a constant error.
    pub fn pause(&self, spindle_speed: f64) -> f64 {
        let round = f64::from(self.touches / SPEEDS as u32);
        if TAU < REVOLUTION_MAX * spindle_speed.abs() {
            (LATER * round).fract() * TAU / spindle_speed.abs()
        } else {
            0.0
        }
    }

    /// Whether all rounds are complete.
    pub fn over(&self, p: &Parameters) -> bool {
        self.touches >= SPEEDS as u32 * (p.calibration.touches.unsigned_abs() + self.more)
    }

    /// Starts one more round at all speeds, if allowed; returns whether it is.
    pub fn once_more(&mut self, p: &Parameters) -> bool {
        let may = self.touches() + SPEEDS as u32 <= SPEEDS as u32 * maximum(p);
        self.more += u32::from(may);
        may
    }

    /// Takes the bias (m) of a touch at [`Self::velocity`], and its force (N).
    pub fn take(&mut self, p: &Parameters, late: f64, force: f64) {
        self.hardness.push(self.velocity(), force, self.velocity() >= RATIO * p.calibration.velocity_min);
        self.late[self.next()].push(late);
        self.touches += 1;
    }

    /// Minimum and maximum mean of a speed, from speed `slowest` on, m.
    pub fn extremes(&self, slowest: usize) -> [f64; 2] {
        self.late[slowest..].iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[minimum, maximum], late| {
            [minimum.min(late.mean()), maximum.max(late.mean())]
        })
    }

    /// The bias from the touches from speed `slowest` on, and the uncertainty of a position measured by one more touch.
    /// The scatter s of a speed combines its own, weighted by its degrees of freedom, with the pooled one, weighted by
    /// [`POOLED`], because few touches may scatter little by chance. The mean of n touches has s / n^(1/2), in addition
    /// to the model error of the three parts. Larger residuals widen the uncertainty of the parts. A touch has at least
    /// the standard deviation of an encoder step. At a slower speed the uncertainty is that of the three parts there,
    /// plus the residual of its touches.
    ///
    /// # Errors
    /// When the three parts cannot be distinguished.
    pub fn conclude(&self, p: &Parameters, slowest: usize) -> Result<(Calibrated, Spread), NoEstimate> {
        let touches = f64::from(self.touches / SPEEDS as u32);
        let step = p.stage.encoder_resolution / 12f64.sqrt();
        let own = self.late.map(|late| late.sigma().powi(2) + step * step);
        let evaluated = (SPEEDS - slowest) as f64;
        let pooled = own[slowest..].iter().sum::<f64>() / evaluated;
        let freedom = touches - 1.0;
        let squares: [f64; SPEEDS] =
            array::from_fn(|i| POOLED * if i < slowest { own[i] } else { pooled } + freedom * own[i]);
        let likely = squares.map(|squares| (squares / (POOLED + freedom)).sqrt());
        // the result of one more touch has Student's distribution: the mean of its possible variance
        let touch = squares.map(|squares| (squares / (POOLED + freedom - 2.0)).sqrt());
        // parts in units of their values at the middle speed
        let units = Bias::parts_at((self.speeds[0] * self.speeds[SPEEDS - 1]).sqrt());
        let parts = |i: usize| SVector::from(Bias::parts_at(self.speeds[i])).component_div(&SVector::from(units));
        let found = least_squares(SVector::zeros(), SPEEDS - slowest, |k, value| {
            let i = slowest + k;
            let sigma = f64::hypot(likely[i] / touches.sqrt(), LEFT_OUT);
            Observation { residual: (parts(i).dot(value) - self.late[i].mean()) / sigma, gradient: parts(i) / sigma }
        })?;
        let variance = |i: usize| parts(i).dot(&(found.covariance * parts(i)));
        let uncertain = p.calibration.position_std;
        let deviations: [f64; SPEEDS] = array::from_fn(|i| variance(i).sqrt().hypot(LEFT_OUT).hypot(uncertain));
        let deviation = deviations[slowest..].iter().copied().fold(0.0, f64::max);
        let calibrated = Calibrated {
            valid: false,
            touches: self.touches() as i32,
            velocity_min: self.speeds[slowest],
            velocity_max: self.speeds[SPEEDS - 1],
            bias: found.value[0] / units[0],
            bias_std: (found.sigma(0) / units[0]).hypot(uncertain),
            bias_fast: found.value[1] / units[1],
            bias_fast_std: found.sigma(1) / units[1],
            bias_slow: found.value[2] / units[2],
            bias_slow_std: found.sigma(2) / units[2],
            std: deviation,
            scatter: pooled.sqrt(),
            scatter_std: (pooled / (2.0 * evaluated * freedom)).sqrt(),
        };
        let off = |i: usize| parts(i).dot(&found.value) - self.late[i].mean();
        let bias = array::from_fn(|i| if i < slowest { deviations[i].hypot(off(i)) } else { deviation });
        Ok((calibrated, Spread { speeds: self.speeds, touch, bias }))
    }

    fn next(&self) -> usize {
        self.touches as usize % SPEEDS
    }
}

/// Speed `i` of `n` after `from` (m/s) in equal ratios, the last at `to`.
fn between(from: f64, to: f64, i: usize, n: usize) -> f64 {
    from * (to / from).powf(i as f64 / n as f64)
}

impl Calibrated {
    /// The calibrated bias.
    pub fn parts(&self) -> Bias {
        Bias { constant: self.bias, fast: self.bias_fast, slow: self.bias_slow }
    }
}

#[cfg(test)]
mod tests;

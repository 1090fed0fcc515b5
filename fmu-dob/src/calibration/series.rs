//! The touches of a calibration: at which speed each is, and what all of them say about the bias.
//!
//! It goes through all speeds and then again, so that work which a touch dents shows as scatter. On hard work the first round lowers the speeds
//! that are still to come to what `calibration.force_max` bears.

use std::array;
use std::f64::consts::TAU;

use control_blocks::{NoEstimate, Observation, Welford, least_squares};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::calibration::bias::{Bias, SPEEDS};
use crate::calibration::press::Hardness;
use crate::calibration::spread::Spread;
use crate::interface::{Calibrated, Parameters};

/// Least ratio of the fastest speed to the slowest.
pub const RATIO: f64 = 3.0;

/// A stage may be so many times heavier than told, and each force as many times larger.
const HEAVIER: f64 = 1.3;
/// So many times harder than one touch at a speed others may press there, as the flutes lie at another angle.
const SCATTER: f64 = 1.2;
/// So many times harder than slower ones tell a touch may press: where those met the flutes at an angle at which they hardly cut.
const FASTER: f64 = 1.6;
/// Where touches are given up again, the next are slower than what is bearable by this share, so that this comes to an end.
const AGAIN: f64 = 0.9;

/// What the three parts leave out at a speed, as deviation, m: the likeliest beside the scatter of the five means of 29 machines whose mass
/// and thrust constant are wrong by up to 30 %, on work of 0.1 to 2 N/um.
const LEFT_OUT: f64 = 6e-9;

/// Share of a turn of the spindle for which the stage stands longer before each touch of a round than before one of the round before. The touches between
/// two that a flute holds add up: up to four of them come 0.4 to 1.6 turns later in each round, so that five rounds spread evenly over the half of a
/// turn with two flutes.
const LATER: f64 = 0.4;
/// A turn that takes longer is not waited for, s.
const TURN_MAX: f64 = 0.1;

/// Degrees of freedom with which the scatter of all speeds counts beside that of one: more than one, or two touches have no variance, and few, as one
/// speed may scatter several times as much as the others.
const POOLED: f64 = 2.0;

/// So many of the slowest speeds a conclusion may leave out: one more are left than the bias has parts.
pub const SLOWER_MAX: usize = SPEEDS - 4;

/// Touches at each speed at most.
fn most(p: &Parameters) -> u32 {
    p.calibration.touches.max(p.calibration.touches_max).unsigned_abs()
}

/// Touches so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TouchSeries {
    /// the slowest first, m/s
    speeds: [f64; SPEEDS],
    /// those that count
    touches: u32,
    /// those at speeds that were given up
    given_up: u32,
    /// rounds beyond `expert.calibration.touches`
    more: u32,
    late: [Welford; SPEEDS],
    hardness: Hardness,
}

impl TouchSeries {
    /// None so far, and the speeds of the parameters.
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

    /// Lowers the speeds of the first round that are still to come, where the next touch would press harder than `calibration.force_max`, and the fastest
    /// where that has come near it; the force grows as the speed. Those that were touched and are slower than what is bearable stay. What is no faster than any
    /// calibration needs is touched in any case.
    ///
    /// # Errors
    /// When that leaves too little of the range: the fastest speed that is bearable, m/s.
    pub fn lower(&mut self, p: &Parameters) -> Result<(), f64> {
        let (next, least) = (self.touches as usize, RATIO * p.calibration.velocity_min);
        let speed = self.speeds[next.min(SPEEDS - 1)];
        if p.calibration.force_max == 0.0 || next > SPEEDS || speed < least {
            return Ok(());
        }
        let new = speed > self.hardness.fastest();
        let slope = if new { FASTER * self.hardness.steepest() } else { self.hardness.slope() };
        let fastest = p.calibration.force_max / (HEAVIER * SCATTER * slope);
        if speed <= fastest {
            return Ok(());
        }
        if fastest < least {
            return Err(fastest);
        }
        let fastest = if self.given_up > 0 { (AGAIN * fastest).max(least) } else { fastest };
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
        let last = self.touches + 1 >= SPEEDS as u32 * most(p);
        (!last).then(|| self.speeds[(self.next() + 1) % SPEEDS])
    }

    /// How long (s) the stage stands before the next touch, at `spindle_speed` rad/s. A slow touch is found where a flute cuts, and all that
    /// follows takes equally long: without this each speed would touch at one angle of the spindle, and its mean be wrong by what that makes.
    pub fn pause(&self, spindle_speed: f64) -> f64 {
        let round = f64::from(self.touches / SPEEDS as u32);
        if TAU < TURN_MAX * spindle_speed.abs() { (LATER * round).fract() * TAU / spindle_speed.abs() } else { 0.0 }
    }

    /// Whether all speeds were touched as often as they are to be.
    pub fn over(&self, p: &Parameters) -> bool {
        self.touches >= SPEEDS as u32 * (p.calibration.touches.unsigned_abs() + self.more)
    }

    /// Touches at all speeds once more, if that may be; whether it may.
    pub fn once_more(&mut self, p: &Parameters) -> bool {
        let may = self.touches() + SPEEDS as u32 <= SPEEDS as u32 * most(p);
        self.more += u32::from(may);
        may
    }

    /// Takes how far (m) behind the first touch a contact was found at [`Self::velocity`], and how hard (N) it pressed.
    pub fn take(&mut self, p: &Parameters, late: f64, force: f64) {
        self.hardness.push(self.velocity(), force, self.velocity() >= RATIO * p.calibration.velocity_min);
        self.late[self.next()].push(late);
        self.touches += 1;
    }

    /// Least and largest mean of a speed, from speed `slowest` on, m.
    pub fn extremes(&self, slowest: usize) -> [f64; 2] {
        self.late[slowest..].iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], late| {
            [least.min(late.mean()), most.max(late.mean())]
        })
    }

    /// What the touches from speed `slowest` on say of the bias, and how far a place that one more touch tells may be off. The scatter s of a speed is
    /// its own with as much weight as it has degrees of freedom, and that of all these speeds with [`POOLED`], as few touches scatter little by
    /// chance. That of a mean of n is s / n^(1/2), beside what the three parts leave out; where they leave more than both unexplained, they are less
    /// sure. A touch has at least the deviation of an encoder's step. At a slower speed the bias is as unsure as the three parts are there, and as far off
    /// as its touches were.
    ///
    /// # Errors
    /// When they do not tell the three parts apart.
    pub fn conclude(&self, p: &Parameters, slowest: usize) -> Result<(Calibrated, Spread), NoEstimate> {
        let touches = f64::from(self.touches / SPEEDS as u32);
        let step = p.stage.encoder_resolution / 12f64.sqrt();
        let own = self.late.map(|late| late.sigma().powi(2) + step * step);
        let judged = (SPEEDS - slowest) as f64;
        let pooled = own[slowest..].iter().sum::<f64>() / judged;
        let freedom = touches - 1.0;
        let squares: [f64; SPEEDS] =
            array::from_fn(|i| POOLED * if i < slowest { own[i] } else { pooled } + freedom * own[i]);
        let likely = squares.map(|squares| (squares / (POOLED + freedom)).sqrt());
        // what one more touch does is Student's: the mean of what its variance may be
        let touch = squares.map(|squares| (squares / (POOLED + freedom - 2.0)).sqrt());
        // parts in units of what they give at the speed in the middle
        let units = Bias::parts_at((self.speeds[0] * self.speeds[SPEEDS - 1]).sqrt());
        let parts = |i: usize| SVector::from(Bias::parts_at(self.speeds[i])).component_div(&SVector::from(units));
        let found = least_squares(SVector::zeros(), SPEEDS - slowest, |k, value| {
            let i = slowest + k;
            let sigma = f64::hypot(likely[i] / touches.sqrt(), LEFT_OUT);
            Observation { residual: (parts(i).dot(value) - self.late[i].mean()) / sigma, gradient: parts(i) / sigma }
        })?;
        let variance = |i: usize| parts(i).dot(&(found.covariance * parts(i)));
        let unsure = p.calibration.position_std;
        let deviations: [f64; SPEEDS] = array::from_fn(|i| variance(i).sqrt().hypot(LEFT_OUT).hypot(unsure));
        let deviation = deviations[slowest..].iter().copied().fold(0.0, f64::max);
        let calibrated = Calibrated {
            valid: false,
            touches: self.touches() as i32,
            velocity_min: self.speeds[slowest],
            velocity_max: self.speeds[SPEEDS - 1],
            bias: found.value[0] / units[0],
            bias_std: (found.sigma(0) / units[0]).hypot(unsure),
            bias_fast: found.value[1] / units[1],
            bias_fast_std: found.sigma(1) / units[1],
            bias_slow: found.value[2] / units[2],
            bias_slow_std: found.sigma(2) / units[2],
            std: deviation,
            scatter: pooled.sqrt(),
            scatter_std: (pooled / (2.0 * judged * freedom)).sqrt(),
        };
        let off = |i: usize| parts(i).dot(&found.value) - self.late[i].mean();
        let bias = array::from_fn(|i| if i < slowest { deviations[i].hypot(off(i)) } else { deviation });
        Ok((calibrated, Spread { speeds: self.speeds, touch, bias }))
    }

    fn next(&self) -> usize {
        self.touches as usize % SPEEDS
    }
}

/// Speed `i` of `n` behind `from` (m/s), which lie in equal ratios, the last at `to`.
fn between(from: f64, to: f64, i: usize, n: usize) -> f64 {
    from * (to / from).powf(i as f64 / n as f64)
}

impl Calibrated {
    /// The bias that was calibrated.
    pub fn parts(&self) -> Bias {
        Bias { constant: self.bias, fast: self.bias_fast, slow: self.bias_slow }
    }
}

#[cfg(test)]
mod tests;

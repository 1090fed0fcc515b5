//! A frozen position of an axis at rest, which flickered before.
//!
//! At rest no motion is without response. The command that compensates the offset of the drive is the same whether the
//! axis is at rest or creeps. A valid position flickers by its noise. Null hypothesis: the noise continues. Its
//! variance s^2, in steps, is half the mean square of its changes minus 1/12 of a step, here minus two standard
//! deviations of the estimate, 2 sqrt(3/n). In the middle of a step, where a position is constant for longest, it
//! changes in a sample with the probability e = 2/(1 + exp(0.851/s)) (logistic approximation of the normal one). It is
//! constant for n samples with (1 - e)^n, which bounds n at the levels 1e-9 in a sample and 1e-6 at the end of a run.
//!
//! A position that flickers between two adjacent steps only shows that the axis is at the edge of a step. Noise is what
//! reverses by two steps, beyond the motion of the loop model. It must be white: the mean product of two consecutive
//! changes is -1/2 of their mean square, 0 for a drift, and more for an oscillation. It must be as large until the
//! position freezes; otherwise an oscillation has decayed. Noise before all axes came to rest may have been their
//! motion. It reduces the uncertainty of the variance if the noise at rest is no smaller by one standard deviation, but
//! adds no reversal. A position that never reversed gives no evidence.
//!
//! A rest before a task is too short to measure the noise and to detect its absence. A second estimate is therefore
//! kept over the rests of all axes, across tasks, as long as the tool runs or is stopped as before: noise of one rest
//! is expected in the next.

use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::finding::{Finding, Numbers};

/// Chance of a live measurement to stand for as long, decades: in each sample of a task, at the end of a run, and in
/// each sample of a robot that waits for days.
const DECADES: f64 = 9.0;
const DECADES_ONCE: f64 = 6.0;
const DECADES_DAYS: f64 = 12.0;
/// Shortest constant interval that is a fault, s (default; six time constants 1/Kp).
const FROZEN_MIN: f64 = 0.5;
/// Smallest change that is a reversal, in the smallest change that was read: two steps.
const REVERSAL: f64 = 1.5;
/// Reversals that must show it, and their ratio to the samples: at the edge of a step a position reverses now and then
/// with a noise that does not leave the middle of one.
const REVERSALS_MIN: f64 = 3.0;
const REVERSALS_RATIO: f64 = 0.01;
/// Ratio of the mean square that two changes consecutive have less than, in the middle between noise and a position
/// that drifts.
const INDEPENDENT: f64 = -0.25;
/// Last samples before the stand, and the ratio of the mean square below which an oscillation dies away in them.
const RECENT: f64 = 25.0;
const DIED_AWAY: f64 = 0.4;
/// Largest number of stored samples: beyond it, the older half is discarded, so that noise that decreases within
/// minutes is followed.
const MEMORY: u32 = 10_000;
/// Variance of a step, and deviations of the noise for which it may be less.
const STEP: f64 = 1.0 / 12.0;
const UNCERTAIN: f64 = 2.0;

/// Where an axis is, rad or m.
#[derive(Clone, Copy, Debug)]
pub struct AxisPosition {
    /// Encoder measurement.
    pub position: f64,
    /// Model of its loop.
    pub model: f64,
}

/// One position, since the start of the task or since the tool was started or stopped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flicker {
    before: Option<f64>,
    /// smallest change that was read, rad or m; infinite before the first
    bit: f64,
    /// extreme position since the last reversal, the model at that time (rad or m), and whether it increased
    farthest: f64,
    model: f64,
    up: bool,
    /// samples since the measurement changed, and whether it has turned in this rest
    still: u32,
    reversed: bool,
    /// change of the last sample, rad or m
    last: f64,
    /// squares of the changes, products of two consecutive, (rad or m)^2, the recent mean of the squares, in how many
    /// samples, and reversals among them
    squares: f64,
    products: f64,
    recent: f64,
    observed: u32,
    reversals: u32,
    /// squares before all axes came to rest, (rad or m)^2, and in how many samples
    earlier: (f64, u32),
}

impl Default for Flicker {
    /// Nothing read.
    fn default() -> Self {
        Self {
            before: None,
            bit: f64::INFINITY,
            farthest: 0.0,
            model: 0.0,
            up: true,
            still: 0,
            reversed: false,
            last: 0.0,
            squares: 0.0,
            products: 0.0,
            recent: 0.0,
            observed: 0,
            reversals: 0,
            earlier: (0.0, 0),
        }
    }
}

impl Flicker {
    /// Takes a measurement of the axis `axis` (from 0) and the position of the model of its loop, rad or m: whether the
    /// axis `rests`, and whether it is `undisturbed`, so that only noise reverses it; what is wrong with it.
    pub fn update(
        &mut self,
        p: &Parameters,
        axis: usize,
        axis_position: AxisPosition,
        rests: bool,
        undisturbed: bool,
    ) -> Finding {
        self.take(p, axis, axis_position, rests, undisturbed);
        self.frozen(p, axis, DECADES)
    }

    /// The same of a measurement that is watched for days, where no task continues as well.
    pub fn watch(
        &mut self,
        p: &Parameters,
        axis: usize,
        axis_position: AxisPosition,
        rests: bool,
        undisturbed: bool,
    ) -> Finding {
        self.take(p, axis, axis_position, rests, undisturbed);
        self.frozen(p, axis, DECADES_DAYS)
    }

    fn take(&mut self, p: &Parameters, axis: usize, axis_position: AxisPosition, rests: bool, undisturbed: bool) {
        let AxisPosition { position, model } = axis_position;
        let change = self.before.replace(position).map_or(0.0, |before| position - before);
        self.still = self.still.saturating_add(1);
        let measures = rests && undisturbed;
        if rests {
            self.note_reversal(axis_position, measures);
        } else {
            (self.reversed, self.farthest, self.model) = (false, position, model);
        }
        if change != 0.0 {
            self.bit = self.bit.min(change.abs().max(p.axis[axis].pulse));
            if measures {
                let left = (-f64::from(self.still) / RECENT).exp();
                self.recent = left * self.recent + change * change / RECENT;
                self.squares += change * change;
                self.products += change * self.last;
                self.observed = self.observed.saturating_add(self.still);
                if self.observed > MEMORY {
                    self.forget_half();
                }
            }
            self.still = 0;
        }
        self.last = change;
    }

    /// All that was seen counts half.
    fn forget_half(&mut self) {
        (self.squares, self.products) = (0.5 * self.squares, 0.5 * self.products);
        (self.observed, self.reversals) = (self.observed / 2, self.reversals / 2);
    }

    /// A constant position during a hold is ignored, and so is the motion until the task continues.
    pub fn pause(&mut self) {
        (self.before, self.still, self.reversed, self.last) = (None, 0, false, 0.0);
    }

    /// Measures the noise again, because all axes come to rest and their motion may have shaken the axis. The squares
    /// so far are kept as `earlier`, and the constant interval continues.
    pub fn settle(&mut self) {
        let Self { bit, farthest, model, still, squares, observed, .. } = *self;
        *self = Self { bit, farthest, model, still, earlier: (squares, observed), ..Self::default() };
    }

    /// `PositionFrozen` if the position of the axis `axis` (from 0) has been constant for too long at the end of a run:
    /// a valid position is so with a probability of 1e-6. Otherwise none.
    pub fn after_run(&self, p: &Parameters, axis: usize) -> Finding {
        self.frozen(p, axis, DECADES_ONCE)
    }

    fn note_reversal(&mut self, AxisPosition { position, model }: AxisPosition, measures: bool) {
        if (position >= self.farthest) == self.up {
            (self.farthest, self.model) = (position, model);
        } else if (position - self.farthest).abs() - (model - self.model).abs() > REVERSAL * self.bit {
            // the first one in a rest is of the motion before
            self.reversals = self.reversals.saturating_add(u32::from(measures && self.reversed));
            (self.farthest, self.model, self.up, self.reversed) = (position, model, !self.up, true);
        }
    }

    fn frozen(&self, p: &Parameters, axis: usize, decades: f64) -> Finding {
        let seconds = |samples: f64| samples * p.sample_period;
        let frozen_time = seconds(f64::from(self.still));
        // asked in every sample of every axis
        if frozen_time <= FROZEN_MIN {
            return Finding::NONE;
        }
        let lasts = self.recent * f64::from(self.observed) > DIED_AWAY * self.squares;
        let independent = self.products < INDEPENDENT * self.squares;
        let reversals = f64::from(self.reversals) >= REVERSALS_MIN.max(REVERSALS_RATIO * f64::from(self.observed));
        if !reversals || !lasts || !independent {
            return Finding::NONE;
        }
        let maximum = seconds(self.maximum(decades)).max(FROZEN_MIN);
        if frozen_time <= maximum {
            return Finding::NONE;
        }
        let numbers = Numbers { axis: axis as i32 + 1, value: frozen_time, limit: maximum, ratio: None };
        Finding { fault: Fault::PositionFrozen, numbers }
    }

    /// Samples for which a valid position is constant with the probability 10^-`decades`.
    fn maximum(&self, decades: f64) -> f64 {
        let (squares, observed) = self.shown();
        let variance = squares / (2.0 * observed * self.bit * self.bit);
        let minimum = variance * (1.0 - UNCERTAIN * deviation(observed)) - STEP;
        let leaves = 2.0 / (1.0 + (0.851 / minimum.max(1e-4).sqrt()).exp());
        -decades * std::f64::consts::LN_10 / (-leaves).ln_1p()
    }

    /// Squares of the changes, (rad or m)^2, and in how many samples.
    fn shown(&self) -> (f64, f64) {
        let (squares, observed) = (self.squares, f64::from(self.observed.max(1)));
        let (before, long) = (self.earlier.0, f64::from(self.earlier.1));
        let as_large = squares * long >= before * observed * (1.0 - deviation(observed));
        if as_large { (squares + before, observed + long) } else { (squares, observed) }
    }
}

/// Relative standard deviation of the mean square of `observed` changes.
fn deviation(observed: f64) -> f64 {
    (3.0 / observed).sqrt()
}

#[cfg(test)]
mod tests;

//! The reading of an axis that stands where nothing is commanded, although it flickered before.
//!
//! There no motion goes unanswered, and a command that makes up for the offset of the drive is the same whether the axis stands or
//! creeps. A live reading still flickers by its noise. Its variance s^2, in steps, is half the mean square of its changes less the 1/12
//! of the steps, here less two deviations of the estimate, 2 sqrt(3/n). In the middle of a step, where a reading stands for longest, it leaves it
//! in a sample with the chance e = 2/(1 + exp(0.851/s)) (the logistic curve for the normal one), and stands for n samples with (1 - e)^n,
//! which bounds n: 1e-9 in a sample, 1e-6 once, at the end of a run.
//!
//! One that flickers between neighbours shows only that its axis stands at the edge of a step: noise is what turns by two steps, beyond
//! what the model of the loop moves. Noise forgets: the product of two changes in a row is -1/2 of their square on average, and 0 where
//! the place wanders, or more where it swings. It has to be as large until the reading stands, or a swing has died away. Before all axes
//! came to rest it may have been of their motion: that makes the variance surer, where the rest has shown no less by a deviation,
//! and no turn. One that never turns tells nothing.
//!
//! A rest before a job is too short to tell noise and to miss it as well. So a second one of these is kept of the rests of all axes, whatever
//! job comes between them, as long as the tool runs or stands as it did: noise of a reading that was there in one is there in the next.

use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::finding::{Finding, Numbers};

/// Chance of a live reading to stand for as long, decades: in each sample of a job, at the end of a run, and in each sample of a robot that waits for days.
const DECADES: f64 = 9.0;
const DECADES_ONCE: f64 = 6.0;
const DECADES_DAYS: f64 = 12.0;
/// Shortest stand that is a fault, s (our choice: six time constants 1/Kp).
const STAND_MIN: f64 = 0.5;
/// Way back that is a turn, in the smallest change that was read: two steps.
const TURN: f64 = 1.5;
/// Turns that have to show it, and in what share of the samples: at the edge of a step a reading turns now and then with a noise that does not
/// leave the middle of one.
const TURNS_MIN: f64 = 3.0;
const TURNS_SHARE: f64 = 0.01;
/// Share of the mean square that two changes in a row have less than, in the middle between noise and a place that wanders.
const FORGETS: f64 = -0.25;
/// Last samples before the stand, and the share of the mean square below which a swing dies away in them.
const RECENT: f64 = 25.0;
const DIED_AWAY: f64 = 0.4;
/// Most samples that are remembered: beyond, the older half is as good as forgotten, as noise that falls in minutes has not gone.
const MEMORY: u32 = 10_000;
/// Variance of a step, and deviations of the noise for which it may be less.
const STEP: f64 = 1.0 / 12.0;
const UNSURE: f64 = 2.0;

/// Where an axis is, rad or m.
#[derive(Clone, Copy, Debug)]
pub struct Places {
    /// Encoder reading.
    pub position: f64,
    /// Model of its loop.
    pub model: f64,
}

/// One reading, since its job began or since the tool has run or stood.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flicker {
    before: Option<f64>,
    /// smallest change that was read, rad or m; infinite before the first
    bit: f64,
    /// farthest reading since the last turn, where the model was then (rad or m), and whether it went up
    farthest: f64,
    model: f64,
    up: bool,
    /// samples since the reading changed, and whether it has turned in this rest
    still: u32,
    turned: bool,
    /// change of the last sample, rad or m
    last: f64,
    /// squares of the changes, products of two in a row, (rad or m)^2, the recent mean of the squares, in how many samples, and
    /// turns among them
    squares: f64,
    products: f64,
    recent: f64,
    seen: u32,
    turns: u32,
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
            turned: false,
            last: 0.0,
            squares: 0.0,
            products: 0.0,
            recent: 0.0,
            seen: 0,
            turns: 0,
            earlier: (0.0, 0),
        }
    }
}

impl Flicker {
    /// Takes a reading of the axis `axis` (from 0) and the place of the model of its loop, rad or m: whether the axis `rests`, and
    /// whether it is `undisturbed`, so that nothing but noise turns it; what is wrong with it.
    pub fn update(&mut self, p: &Parameters, axis: usize, places: Places, rests: bool, undisturbed: bool) -> Finding {
        self.take(p, axis, places, rests, undisturbed);
        self.stands(p, axis, DECADES)
    }

    /// The same of a reading that is watched for days, where no job goes on as well.
    pub fn watch(&mut self, p: &Parameters, axis: usize, places: Places, rests: bool, undisturbed: bool) -> Finding {
        self.take(p, axis, places, rests, undisturbed);
        self.stands(p, axis, DECADES_DAYS)
    }

    fn take(&mut self, p: &Parameters, axis: usize, places: Places, rests: bool, undisturbed: bool) {
        let Places { position, model } = places;
        let change = self.before.replace(position).map_or(0.0, |before| position - before);
        self.still = self.still.saturating_add(1);
        let measures = rests && undisturbed;
        if rests {
            self.turn(places, measures);
        } else {
            (self.turned, self.farthest, self.model) = (false, position, model);
        }
        if change != 0.0 {
            self.bit = self.bit.min(change.abs().max(p.axis[axis].pulse));
            if measures {
                let left = (-f64::from(self.still) / RECENT).exp();
                self.recent = left * self.recent + change * change / RECENT;
                self.squares += change * change;
                self.products += change * self.last;
                self.seen = self.seen.saturating_add(self.still);
                if self.seen > MEMORY {
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
        (self.seen, self.turns) = (self.seen / 2, self.turns / 2);
    }

    /// What stands while the job is held does not count, nor does the way until it goes on.
    pub fn pause(&mut self) {
        (self.before, self.still, self.turned, self.last) = (None, 0, false, 0.0);
    }

    /// What has shaken the axis may have ended: noise shows itself anew.
    pub fn settle(&mut self) {
        let Self { bit, farthest, model, still, squares, seen, .. } = *self;
        *self = Self { bit, farthest, model, still, earlier: (squares, seen), ..Self::default() };
    }

    /// What is wrong with the reading of the axis `axis` (from 0) at the end of a run.
    pub fn after_run(&self, p: &Parameters, axis: usize) -> Finding {
        self.stands(p, axis, DECADES_ONCE)
    }

    fn turn(&mut self, Places { position, model }: Places, measures: bool) {
        if (position >= self.farthest) == self.up {
            (self.farthest, self.model) = (position, model);
        } else if (position - self.farthest).abs() - (model - self.model).abs() > TURN * self.bit {
            // the first one in a rest is of the motion before
            self.turns = self.turns.saturating_add(u32::from(measures && self.turned));
            (self.farthest, self.model, self.up, self.turned) = (position, model, !self.up, true);
        }
    }

    fn stands(&self, p: &Parameters, axis: usize, decades: f64) -> Finding {
        let seconds = |samples: f64| samples * p.sample_period;
        let stands = seconds(f64::from(self.still));
        // asked in every sample of every axis
        if stands <= STAND_MIN {
            return Finding::NONE;
        }
        let lasts = self.recent * f64::from(self.seen) > DIED_AWAY * self.squares;
        let forgets = self.products < FORGETS * self.squares;
        let turns = f64::from(self.turns) >= TURNS_MIN.max(TURNS_SHARE * f64::from(self.seen));
        if !turns || !lasts || !forgets {
            return Finding::NONE;
        }
        let most = seconds(self.most(decades)).max(STAND_MIN);
        if stands <= most {
            return Finding::NONE;
        }
        let numbers = Numbers { axis: axis as i32 + 1, value: stands, limit: most, ratio: None };
        Finding { fault: Fault::PositionFrozen, numbers }
    }

    /// Samples for which a live reading stands with the chance 10^-`decades`.
    fn most(&self, decades: f64) -> f64 {
        let (squares, seen) = self.shown();
        let variance = squares / (2.0 * seen * self.bit * self.bit);
        let least = variance * (1.0 - UNSURE * deviation(seen)) - STEP;
        let leaves = 2.0 / (1.0 + (0.851 / least.max(1e-4).sqrt()).exp());
        -decades * std::f64::consts::LN_10 / (-leaves).ln_1p()
    }

    /// Squares of the changes, (rad or m)^2, and in how many samples.
    fn shown(&self) -> (f64, f64) {
        let (squares, seen) = (self.squares, f64::from(self.seen.max(1)));
        let (before, long) = (self.earlier.0, f64::from(self.earlier.1));
        let as_large = squares * long >= before * seen * (1.0 - deviation(seen));
        if as_large { (squares + before, seen + long) } else { (squares, seen) }
    }
}

/// Relative deviation of the mean square of so many changes.
fn deviation(seen: f64) -> f64 {
    (3.0 / seen).sqrt()
}

#[cfg(test)]
mod tests;

//! The calibration cycle: the next touch, the result, and the active bias.

use control_blocks::{ActiveValues, SIGNIFICANT, ticks};
use serde::{Deserialize, Serialize};

use crate::calibration::bias::Bias;
use crate::calibration::press::{Drive, Press};
use crate::calibration::series::{SLOWER_MAX, TouchSeries};
use crate::calibration::spread::Spread;
use crate::interface::{Approach, Calibrated, Measured, Parameters};
use crate::monitoring::rest::SETTLING;

/// Consecutive calibration cycles.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CalibrationRun {
    /// Results of the last calibration cycle; `valid` is false until the cycle succeeds.
    pub calibrated: Calibrated,
    /// A calibration cycle is active.
    pub active: bool,
    /// The touches give no acceptable bias, or `calibration.force_max` allows only speeds that are too slow.
    pub rejected: bool,
    /// Fastest speed that `calibration.force_max` allows, m/s; none unless it is too slow to calibrate.
    pub tolerated: Option<f64>,
    aborted: bool,
    /// samples for which the stage stays at rest before the next touch
    pause: u32,
    series: TouchSeries,
    press: Press,
    bias: ActiveValues<Bias>,
    /// uncertainty of the active bias, where it was calibrated
    spread: Option<Spread>,
}

impl CalibrationRun {
    /// Nothing learned so far.
    pub fn new(p: &Parameters) -> Self {
        Self {
            calibrated: Calibrated::START,
            active: false,
            rejected: false,
            tolerated: None,
            aborted: false,
            pause: 0,
            series: TouchSeries::new(p),
            press: Press::default(),
            bias: ActiveValues::new(Bias::of(p)),
            spread: None,
        }
    }

    /// Begins.
    pub fn begin(&mut self, p: &Parameters) {
        (self.calibrated, self.series) = (Calibrated::START, TouchSeries::new(p));
        (self.active, self.rejected, self.tolerated) = (true, false, None);
        (self.aborted, self.pause) = (false, 0);
    }

    /// Is to end before its end; whether that is news.
    pub fn abort(&mut self) -> bool {
        let news = self.active && !self.aborted && !self.rejected && !self.calibrated.valid;
        self.aborted |= news;
        news
    }

    /// Whether it is to end before its end.
    pub fn aborted(&self) -> bool {
        self.aborted
    }

    /// Whether there is no touch to be made any more.
    pub fn over(&self) -> bool {
        self.aborted || self.calibrated.valid
    }

    /// Whether it has come to its end, good or not.
    pub fn ended(&self) -> bool {
        self.over() || self.rejected
    }

    /// Ends; an unsuccessful cycle restores the configured bias.
    pub fn end(&mut self) {
        if self.active && !self.calibrated.valid {
            self.bias.restore();
            self.spread = None;
        }
        self.active = false;
    }

    /// The next approach: that of the parameters, no faster than was calibrated with `calibration.force_max`, and in a
    /// calibration at the speed that is next.
    pub fn approach(&self, p: &Parameters) -> Approach {
        let touch = self.active && !self.ended();
        let velocity = if touch { self.series.velocity() } else { self.cycle_velocity(p) };
        Approach { velocity, ..p.approach }
    }

    /// The approach after the current touch: the next one of the cycle, or a normal one after it.
    pub fn approach_after(&self, p: &Parameters) -> Approach {
        let after = self.series.after(p).filter(|_| !self.ended());
        Approach { velocity: after.unwrap_or_else(|| self.cycle_velocity(p)), ..p.approach }
    }

    /// Speed of a normal approach, m/s; after a calibration that may still fail the configured one.
    fn cycle_velocity(&self, p: &Parameters) -> f64 {
        let limited = p.calibration.force_max > 0.0 && (self.calibrated.valid || !self.active);
        let limit = self.spread.filter(|_| limited).map(|spread| spread.fastest());
        limit.map_or(p.approach.velocity, |fastest| p.approach.velocity.min(fastest))
    }

    /// Takes one sample at `position` m, towards the workpiece, if it is known, with the current that acted (A), and
    /// evaluates the force of the touch with a force limit; `measured` is the result of a commissioning run, if any.
    pub fn sense(&mut self, p: &Parameters, measured: &Measured, position: Option<f64>, acted: f64, found: bool) {
        if self.active && p.calibration.force_max > 0.0 {
            let depth = position.map(|position| position - p.direction() * p.calibration.position);
            self.press.update(p, &Drive::of(p, measured), depth, acted, self.series.velocity(), found);
        }
    }

    /// One sample at rest before the next touch; whether it is to be made now.
    pub fn rested(&mut self) -> bool {
        let rested = self.pause == 0 || self.over();
        self.pause = self.pause.saturating_sub(1);
        rested
    }

    /// Takes a contact (m, towards the work) of the approach that has just ended, with a spindle at `spindle_speed`
    /// rad/s.
    pub fn take(&mut self, p: &Parameters, measured: &Measured, contact: f64, spindle_speed: f64) {
        let late = contact - p.direction() * p.calibration.position;
        self.series.take(p, late, self.press.force(&Drive::of(p, measured)));
        self.calibrated.touches = self.series.touches() as i32;
        let next = self.series.velocity();
        self.tolerated = self.series.lower(p).err();
        self.rejected = self.tolerated.is_some();
        // what needs a longer way than was gone back leaves a motion
        let settle = if self.series.velocity() > next { SETTLING / p.servo.bandwidth } else { 0.0 };
        self.pause = ticks(self.series.pause(spindle_speed).max(settle), p.sample_period);
        if self.series.over(p) {
            self.conclude(p);
        }
    }

    /// Minimum and maximum mean bias of a speed, m.
    pub fn extremes(&self) -> [f64; 2] {
        self.series.extremes(0)
    }

    /// The active bias: the calibrated one with `calibration.apply`, otherwise that of the parameters, which are
    /// tunable.
    pub fn bias(&self, p: &Parameters) -> Bias {
        if self.bias.as_configured() { Bias::of(p) } else { self.bias.now() }
    }

    /// Standard deviation (m) of the position measured by a touch at `velocity` m/s with the active bias; 0 without
    /// calibration.
    pub fn deviation(&self, velocity: f64) -> f64 {
        self.spread.map_or(0.0, |spread| spread.at(velocity))
    }

    /// Names and values of what a good calibration has learned.
    pub fn derived(&self) -> [(&'static str, f64); 4] {
        let [constant, fast, slow] = self.bias.derived().entries();
        [constant, fast, slow, ("calibration.velocity_max", self.calibrated.velocity_max)]
    }

    /// Evaluates all touches. If they are too uncertain and no more are allowed, the slowest speed is left out: on a
    /// soft workpiece the detection of a slow touch depends on the noise, and the bias at the other speeds may be
    /// certain without it.
    fn conclude(&mut self, p: &Parameters) {
        let series = &self.series;
        let can_be = |slowest| {
            let found = series.conclude(p, slowest).ok();
            found.filter(|(calibrated, _)| possible(p, calibrated, series.extremes(slowest)))
        };
        let good = |slowest| can_be(slowest).filter(|(calibrated, _)| is_certain(p, calibrated));
        let (whole, faster) = (good(0), (1..=SLOWER_MAX).find_map(good));
        let uncertain = whole.is_none() && (0..=SLOWER_MAX).any(|slowest| can_be(slowest).is_some());
        self.calibrated = series.conclude(p, 0).map_or(self.calibrated, |(calibrated, _)| calibrated);
        if uncertain && self.series.once_more(p) {
            return;
        }
        match whole.or(faster) {
            Some((calibrated, spread)) => {
                self.calibrated = Calibrated { valid: true, ..calibrated };
                self.bias.conclude(calibrated.parts(), p.calibration.apply);
                self.spread = p.calibration.apply.then_some(spread);
            }
            None => self.rejected = true,
        }
    }
}

/// Whether the touches are alike and the bias sure.
fn is_certain(p: &Parameters, calibrated: &Calibrated) -> bool {
    calibrated.scatter <= p.limits.touch_scatter && calibrated.std <= p.calibration.std_max
}

/// Whether the bias is one that can be: none is found before the touch, beyond what place and scatter explain, nor so
/// late that the work is too soft.
fn possible(p: &Parameters, calibrated: &Calibrated, [minimum, maximum]: [f64; 2]) -> bool {
    minimum >= -SIGNIFICANT * calibrated.std && maximum <= p.limits.bias
}

#[cfg(test)]
mod tests;

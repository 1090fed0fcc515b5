//! The parameters that a commissioning run derives, and how.

use control_blocks::{DELAY_SPREAD, RATIO_MAX, is_certain, tolerated_delays, whole_delay, within_factor};
use serde::{Deserialize, Serialize};

use crate::interface::{Measured, MeasuredAxis, Parameters};
use crate::learning::drive::LAG_MIN;
use crate::learning::feedforward::CREDIBLE;
use crate::path::kinematics::{AXES, Joints};

/// Samples by which an axis may be later or earlier than all, the same that `WrongDelay` allows.
const APART: f64 = 0.75;
/// Samples by which a drive may seem to act before its command: one without a lag, and noise.
const EARLY: f64 = 0.1;
/// Largest standard deviation of delay and lag of a drive together, samples: 0.5 ms, 0.01 mm at 0.35 m/s2.
pub const DELAY_STD_MAX: f64 = 0.05;

/// A natural frequency is used where its standard deviation is at most this ratio of it.
const FREQUENCY_STD_MAX: f64 = 0.2;
/// So is friction.
const FRICTION_STD_MAX: f64 = 0.3;
/// Names of the parameters of the drives.
const GAINS: [&str; AXES] = [
    "expert.model.axis1.gain",
    "expert.model.axis2.gain",
    "expert.model.axis3.gain",
    "expert.model.axis4.gain",
    "expert.model.axis5.gain",
    "expert.model.axis6.gain",
];
const LAGS: [&str; AXES] = [
    "expert.model.axis1.lag",
    "expert.model.axis2.lag",
    "expert.model.axis3.lag",
    "expert.model.axis4.lag",
    "expert.model.axis5.lag",
    "expert.model.axis6.lag",
];
const FREQUENCIES: [&str; AXES] = [
    "expert.model.axis1.natural_frequency",
    "expert.model.axis2.natural_frequency",
    "expert.model.axis3.natural_frequency",
    "expert.model.axis4.natural_frequency",
    "expert.model.axis5.natural_frequency",
    "expert.model.axis6.natural_frequency",
];
const FRICTIONS: [&str; AXES] = [
    "expert.model.axis1.friction",
    "expert.model.axis2.friction",
    "expert.model.axis3.friction",
    "expert.model.axis4.friction",
    "expert.model.axis5.friction",
    "expert.model.axis6.friction",
];
/// How many parameters a commissioning run derives.
pub const ENTRIES: usize = 4 * AXES + 4;

/// All parameters that a commissioning run derives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    io_delay: i32,
    gain: Joints,
    lag: Joints,
    frequency: Joints,
    friction: Joints,
    idle_speed: f64,
    /// ratio to the configured target and limit speeds
    scale: f64,
}

impl Values {
    /// Those of the parameters.
    pub fn of(p: &Parameters) -> Self {
        Self {
            io_delay: p.io_delay,
            gain: p.model.axis.each_ref().map(|axis| axis.gain),
            lag: p.model.axis.each_ref().map(|axis| axis.lag),
            frequency: p.model.axis.each_ref().map(|axis| axis.natural_frequency),
            friction: p.model.axis.each_ref().map(|axis| axis.friction),
            idle_speed: p.load.idle_speed,
            scale: p.load.scale,
        }
    }

    /// Puts them into the parameters.
    pub fn put(&self, p: &mut Parameters) {
        p.io_delay = self.io_delay;
        for (i, axis) in p.model.axis.iter_mut().enumerate() {
            (axis.gain, axis.lag) = (self.gain[i], self.lag[i]);
            (axis.natural_frequency, axis.friction) = (self.frequency[i], self.friction[i]);
        }
        (p.load.idle_speed, p.load.scale) = (self.idle_speed, self.scale);
    }

    /// Those with what was measured. Target and limit of the tool's speed keep their ratio of the idle speed: the slip
    /// of an induction motor is a ratio of the speed that it has without load.
    pub fn derived(self, measured: &Measured) -> Self {
        Self {
            io_delay: whole_delay(measured.io_delay),
            gain: measured.axis.each_ref().map(|axis| axis.gain),
            // 0 would be the nominal one
            lag: measured.axis.each_ref().map(|axis| axis.lag.max(LAG_MIN)),
            // an uncertain one follows from the lag
            frequency: measured
                .axis
                .each_ref()
                .map(|axis| if_certain(axis.natural_frequency, axis.natural_frequency_std, FREQUENCY_STD_MAX)),
            // an uncertain one may be 0
            friction: measured
                .axis
                .each_ref()
                .map(|axis| if_certain(axis.friction, axis.friction_std, FRICTION_STD_MAX)),
            idle_speed: measured.idle_speed,
            scale: self.scale * measured.idle_speed / self.idle_speed,
        }
    }

    /// Their names and values, with the speeds of `p`.
    pub fn entries(&self, p: &Parameters) -> [(&'static str, f64); ENTRIES] {
        let all: [(&[&'static str], &[f64]); 5] = [
            (
                &["io_delay", "load.idle_speed", "load.spindle_speed", "limits.spindle_speed_min"],
                &[
                    f64::from(self.io_delay),
                    self.idle_speed,
                    self.scale * p.load.spindle_speed,
                    self.scale * p.limits.spindle_speed_min,
                ],
            ),
            (&GAINS, &self.gain),
            (&LAGS, &self.lag),
            (&FREQUENCIES, &self.frequency),
            (&FRICTIONS, &self.friction),
        ];
        let mut entries = [("", 0.0); ENTRIES];
        let values = all.iter().flat_map(|(names, values)| names.iter().zip(*values));
        entries.iter_mut().zip(values).for_each(|(entry, (name, value))| *entry = (name, *value));
        entries
    }
}

/// A value whose standard deviation is at most this ratio of it, else 0.
fn if_certain(value: f64, deviation: f64, ratio: f64) -> f64 {
    if deviation <= ratio * value { value } else { 0.0 }
}

/// The delays that a controller tolerates with the configured `io_delay`.
pub fn delays(io_delay: i32) -> std::ops::RangeInclusive<i32> {
    (io_delay - DELAY_SPREAD).max(0)..=*tolerated_delays(io_delay).end()
}

/// Why a measurement cannot be used with the `configured` values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Rejection {
    /// The drive of an axis, from 1.
    Drive(i32),
    /// The delay of all.
    Delay,
    /// The tool.
    Tool,
    /// The parameters do not fit what follows from it.
    Values,
}

/// Why a measurement cannot be used.
pub fn rejection(p: &Parameters, configured: &Values, m: &Measured) -> Option<Rejection> {
    let whole = whole_delay(m.io_delay);
    let bad = |axis: &MeasuredAxis| {
        !(CREDIBLE.contains(&axis.gain)
            && is_certain(axis.gain, axis.gain_std, p.commission.std_max)
            && axis.lag_std <= DELAY_STD_MAX * p.sample_period
            && axis.lag > -EARLY * p.sample_period
            && (axis.delay - f64::from(whole)).abs() <= APART)
    };
    if let Some(i) = m.axis.iter().position(bad) {
        return Some(Rejection::Drive(i as i32 + 1));
    }
    if !delays(configured.io_delay).contains(&whole) {
        return Some(Rejection::Delay);
    }
    let idles = within_factor(m.idle_speed, configured.idle_speed, RATIO_MAX)
        && is_certain(m.idle_speed, m.idle_speed_std, p.commission.std_max);
    (!idles).then_some(Rejection::Tool)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A good measurement of a machine whose drives do four fifths, two samples late.
    fn good() -> Measured {
        let axis = MeasuredAxis {
            gain: 0.8,
            gain_std: 1e-3,
            lag: 5e-3,
            lag_std: 1e-4,
            natural_frequency: 220.0,
            natural_frequency_std: 20.0,
            delay: 2.13,
            delay_std: 0.01,
            friction: 2e-5,
            friction_std: 1e-6,
        };
        Measured {
            valid: true,
            io_delay: 2.13,
            io_delay_std: 5e-3,
            idle_speed: 1700.0,
            idle_speed_std: 0.1,
            axis: [axis; AXES],
            ..Measured::START
        }
    }

    #[test]
    fn what_is_put_is_what_was_taken() {
        let mut p = Parameters::START;
        let configured = Values::of(&p);
        configured.put(&mut p);
        assert_eq!(p, Parameters::START);
        let values = configured.derived(&good());
        values.put(&mut p);
        assert_eq!(Values::of(&p), values);
        assert_eq!((p.io_delay, p.model.axis[4].gain, p.model.axis[4].lag, p.load.idle_speed), (2, 0.8, 5e-3, 1700.0));
        // what was configured of target and limit stays, and their ratio is in force
        assert_eq!(p.load.spindle_speed, Parameters::START.load.spindle_speed);
        let ratio = 1700.0 / Parameters::START.load.idle_speed;
        assert!((p.load.scale - ratio).abs() < 1e-12);
        let entries = values.entries(&p);
        let entry_of = |name| entries.iter().find(|entry| entry.0 == name).map(|entry| entry.1);
        assert_eq!(
            (entry_of("io_delay"), entry_of("expert.model.axis6.gain"), entry_of("expert.model.axis1.lag")),
            (Some(2.0), Some(0.8), Some(5e-3))
        );
        assert_eq!(entry_of("expert.model.axis2.natural_frequency"), Some(220.0));
        let mut uncertain = good();
        uncertain.axis[1].natural_frequency_std = 45.0;
        let uncertain = Values::of(&Parameters::START).derived(&uncertain);
        assert_eq!(uncertain.frequency, [220.0, 0.0, 220.0, 220.0, 220.0, 220.0]);
        assert_eq!((p.model.axis[4].friction, entry_of("expert.model.axis5.friction")), (2e-5, Some(2e-5)));
        let mut uncertain = good();
        (uncertain.axis[1].friction_std, uncertain.axis[4].friction) = (6.1e-6, -2e-5);
        let uncertain = Values::of(&Parameters::START).derived(&uncertain);
        assert_eq!(uncertain.friction, [2e-5, 0.0, 2e-5, 2e-5, 0.0, 2e-5]);
        assert!(entries.iter().all(|entry| !entry.0.is_empty()));
        assert_eq!(entry_of("limits.spindle_speed_min"), Some(p.load.scale * p.limits.spindle_speed_min));
        assert_eq!(entry_of("load.spindle_speed"), Some(p.load.scale * p.load.spindle_speed));
    }

    #[test]
    fn each_limit_is_the_last_value_that_is_accepted() {
        let p = Parameters::START;
        let found = |set: fn(&mut Measured, f64), x: f64| {
            let mut m = good();
            set(&mut m, x);
            rejection(&p, &Values::of(&p), &m)
        };
        type Case = (fn(&mut Measured, f64), f64, f64, Rejection);
        let idle = p.load.idle_speed;
        let cases: [Case; 12] = [
            (|m, x| m.axis[3].lag = x, -9.9e-4, -1.01e-3, Rejection::Drive(4)),
            (|m, x| m.axis[2].gain_std = x, 1.59e-3, 1.61e-3, Rejection::Drive(3)),
            (|m, x| m.axis[0].gain = x, 2.0, 2.01, Rejection::Drive(1)),
            (|m, x| m.axis[0].gain = x, 0.5, 0.49, Rejection::Drive(1)),
            (|m, x| m.axis[5].lag_std = x, 4.99e-4, 5.01e-4, Rejection::Drive(6)),
            (|m, x| m.axis[1].delay = x, 2.74, 2.76, Rejection::Drive(2)),
            (|m, x| m.axis[1].delay = x, 1.26, 1.24, Rejection::Drive(2)),
            (|m, x| set_delay(m, x), 3.4, 3.6, Rejection::Delay),
            (|m, x| set_delay(m, x), -0.49, -0.51, Rejection::Delay),
            (|m, x| m.idle_speed = x, 2.0 * idle, 2.01 * idle, Rejection::Tool),
            (|m, x| m.idle_speed = x, 0.5 * idle, 0.49 * idle, Rejection::Tool),
            (|m, x| m.idle_speed_std = x, 3.39, 3.41, Rejection::Tool),
        ];
        for (k, (set, last, first, what)) in cases.into_iter().enumerate() {
            assert_eq!((found(set, last), found(set, first)), (None, Some(what)), "{k}");
        }
        assert_eq!(rejection(&p, &Values::of(&p), &Measured::START), Some(Rejection::Drive(1)));
    }

    fn set_delay(m: &mut Measured, delay: f64) {
        m.io_delay = delay;
        m.axis.iter_mut().for_each(|axis| axis.delay = delay);
    }
}

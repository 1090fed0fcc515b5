//! Parameters of the law, grouped as in the FMU, each with its unit, range, default and source.
//!
//! Sources: "paper" = Kimura, Mukai and Kobayashi; "derived" = follows from the equations; "our choice" = the paper is
//! silent; with the reason where there is one.

mod cutting;
mod learning;
mod motion;

use serde::{Deserialize, Serialize};

use crate::kinematics::{AXES, Arm, Joints};
use crate::run::PREVIEW_MAX;

pub use cutting::{Load, Spindle};
pub use learning::{Bank, Format, Law, Learn, Lookup, Model, Speeds};
pub use motion::{Axis, Feed, Path, Servo, Transfer};

/// All parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Sample period t, s; 1e-3 to 0.05, default 0.01 (paper).
    pub sample_period: f64,
    /// Column.
    pub axis1: Axis,
    /// Height.
    pub axis2: Axis,
    /// Arm.
    pub axis3: Axis,
    /// Yaw of the wrist.
    pub axis4: Axis,
    /// Pitch of the wrist.
    pub axis5: Axis,
    /// Roll of the wrist.
    pub axis6: Axis,
    /// Geometry of the robot.
    pub arm: Arm,
    /// Position loop.
    pub servo: Servo,
    /// Motion to the start of the path.
    pub transfer: Transfer,
    /// The taught path.
    pub path: Path,
    /// Feed along the path.
    pub feed: Feed,
    /// Learning of the control patterns.
    pub learn: Learn,
    /// Nominal velocity loop, for `learn.law` = NormOptimal.
    pub model: Model,
    /// Use of the control patterns.
    pub lookup: Lookup,
    /// Files of the control patterns.
    pub bank: Bank,
    /// Cutting-load control, eq. 5.
    pub load: Load,
    /// Spindle of the tool.
    pub spindle: Spindle,
}

impl Parameters {
    /// What a good engineer would ship: learning with lead and zero-phase filter, lookup with preview.
    pub const DEFAULT: Self = Self {
        sample_period: 0.01,
        axis1: Axis::COLUMN,
        axis2: Axis::HEIGHT,
        axis3: Axis::ARM,
        axis4: Axis::WRIST,
        axis5: Axis::WRIST,
        axis6: Axis::WRIST,
        arm: Arm::DEFAULT,
        servo: Servo::DEFAULT,
        transfer: Transfer::DEFAULT,
        path: Path::DEFAULT,
        feed: Feed::DEFAULT,
        learn: Learn::DEFAULT,
        model: Model::DEFAULT,
        lookup: Lookup::DEFAULT,
        bank: Bank::DEFAULT,
        load: Load::DEFAULT,
        spindle: Spindle::DEFAULT,
    };

    /// The paper's method: plain repetitive control without lead and filter, all repetitions.
    pub const PAPER: Self =
        Self { learn: Learn { law: Law::Plain, lead: 0, stop_at_best: false, ..Learn::DEFAULT }, ..Self::DEFAULT };

    /// The axes in their order.
    pub fn axes(&self) -> [&Axis; AXES] {
        [&self.axis1, &self.axis2, &self.axis3, &self.axis4, &self.axis5, &self.axis6]
    }

    /// Encoder pulse of each axis, rad or m.
    pub fn pulses(&self) -> Joints {
        self.axes().map(|axis| axis.pulse)
    }

    /// Whole samples in `time` s, rounded.
    pub fn ticks(&self, time: f64) -> u32 {
        (time / self.sample_period).round() as u32
    }

    /// By how many samples the learning looks ahead: `learn.lead` beyond `servo.io_delay`.
    pub fn shift(&self) -> usize {
        (self.learn.lead + self.servo.io_delay).max(0) as usize
    }

    /// By how many samples the feed is known in advance: `lookup.preview` beyond `servo.io_delay`.
    pub fn preview(&self) -> f64 {
        (self.lookup.preview / self.sample_period + f64::from(self.servo.io_delay)).clamp(0.0, PREVIEW_MAX as f64)
    }
}

//! Parameters of the law, grouped as in the FMU, each with its unit, range, default and source.
//!
//! Sources: "paper" = Nagata and others (2010); "derived" = follows from the equations; "measured" = found on the
//! plant `orthogonal_robot`; "our choice" = the paper is silent; with the reason where there is one.

mod job;
mod law;
mod machine;

use serde::{Deserialize, Serialize};

use crate::axes::Axes;
use crate::force::ForceMode;
use crate::stick_slip::{Mode, Wave};

pub use job::{Approach, Feed, FeedSource, Limits, Path, Retract, Settle, Tare};
pub use law::{Force, Impedance, Misalignment, Position, Ripple, StickSlip, Stiffness};
pub use machine::{Drive, Pulses, Sensor, Tool};

/// All parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Sample period, s; 2e-4 to 5e-3, default 1e-3 (paper).
    pub sample_period: f64,
    /// Polishing tool.
    pub tool: Tool,
    /// Stroke of the axes, m; 1e-3 to 10, default 0.4, 0.3, 0.1 (paper); the middle is the origin of the path.
    pub stroke: Axes,
    /// What a path may be.
    pub path: Path,
    /// Polishing force.
    pub force: Force,
    /// Impedance model of the force law.
    pub impedance: Impedance,
    /// Stiffness of tool and contact.
    pub stiffness: Stiffness,
    /// Position feedback.
    pub position: Position,
    /// Feed along the path.
    pub feed: Feed,
    /// Stick-slip motion.
    pub stick_slip: StickSlip,
    /// Cancellation of the force ripple that stick-slip makes.
    pub ripple: Ripple,
    /// Estimate of the misalignment of the mold.
    pub misalignment: Misalignment,
    /// Model of the drives.
    pub drive: Drive,
    /// Model of the force sensor.
    pub sensor: Sensor,
    /// Pulses of the drives.
    pub pulses: Pulses,
    /// Zero of the force sensor.
    pub tare: Tare,
    /// Approach motion.
    pub approach: Approach,
    /// Building up of the force.
    pub settle: Settle,
    /// Retract motion.
    pub retract: Retract,
    /// What is a fault.
    pub limits: Limits,
}

impl Parameters {
    /// What a good engineer would ship.
    pub const DEFAULT: Self = Self {
        sample_period: 1e-3,
        tool: Tool::DEFAULT,
        stroke: Axes { x: 0.4, y: 0.3, z: 0.1 },
        path: Path::DEFAULT,
        force: Force::DEFAULT,
        impedance: Impedance::DEFAULT,
        stiffness: Stiffness::DEFAULT,
        position: Position::DEFAULT,
        feed: Feed::DEFAULT,
        stick_slip: StickSlip::DEFAULT,
        ripple: Ripple::DEFAULT,
        misalignment: Misalignment::DEFAULT,
        drive: Drive::DEFAULT,
        sensor: Sensor::DEFAULT,
        pulses: Pulses::DEFAULT,
        tare: Tare::DEFAULT,
        approach: Approach::DEFAULT,
        settle: Settle::DEFAULT,
        retract: Retract::DEFAULT,
        limits: Limits::DEFAULT,
    };

    /// The paper's method: impedance law on the norm of the force, weak coupling along z, a stick-slip vector that
    /// changes its sign in every sample.
    pub const PAPER: Self = Self {
        force: Force { mode: ForceMode::Norm, integral_time: 0.0, ..Force::DEFAULT },
        impedance: Impedance { adaptive: false, ..Impedance::DEFAULT },
        position: Position {
            gain: Axes { x: 0.0, y: 0.0, z: 1.0 },
            select: Axes { x: false, y: false, z: true },
            projected: false,
            ..Position::DEFAULT
        },
        stick_slip: StickSlip { mode: Mode::Paper, wave: Wave::Square, half_period: 1, ..StickSlip::DEFAULT },
        ripple: Ripple { gain: 0.0, ..Ripple::DEFAULT },
        misalignment: Misalignment { enable: false, ..Misalignment::DEFAULT },
        ..Self::DEFAULT
    };

    /// Whole samples in `time` s, rounded.
    pub fn ticks(&self, time: f64) -> u32 {
        (time / self.sample_period).round() as u32
    }
}

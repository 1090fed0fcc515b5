//! Parameters of the law, grouped as in the FMU, each with its unit, range, default and source.
//!
//! Sources: "paper" = Ludwick, Chargin, Calzaretta and Trumper (1999); "derived" = follows from the equations;
//! "our choice" = the paper is silent; with the reason where there is one.

mod control;
mod measuring;
mod part;

use serde::{Deserialize, Serialize};

use crate::harmonics::Harmonics;

pub use control::{Afc, Approach, Feedforward, Hold, Limit, Pll, Servo, Tip};
pub use measuring::{Calibration, Identify, Probe};
pub use part::{Path, Surface, SurfaceKind, Tool};

/// All parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Sample period T_s, s; 2e-5 to 1e-3, default 1e-4 (paper: 10 kHz).
    pub sample_period: f64,
    /// The two tools of the double-ended arm.
    pub tool: Tool,
    /// Surface to be cut.
    pub surface: Surface,
    /// Look-up table of the tool path.
    pub path: Path,
    /// Nominal arm and drive, and the position loop designed for them.
    pub servo: Servo,
    /// Flexure of the arm between encoder and tool.
    pub tip: Tip,
    /// Feedforward that pre-shifts the path.
    pub feedforward: Feedforward,
    /// Adaptive feedforward cancellation (repetitive control).
    pub afc: Afc,
    /// Phase-locked loop of the spindle.
    pub pll: Pll,
    /// Motion onto the path.
    pub approach: Approach,
    /// Motion to the held angle.
    pub hold: Hold,
    /// What is a fault.
    pub limit: Limit,
    /// Measurement of the frequency response in place.
    pub identify: Identify,
    /// Depth probe.
    pub probe: Probe,
    /// Calibration.
    pub calibration: Calibration,
}

impl Parameters {
    /// What a good engineer would ship: all harmonics cancelled, flexure compensated.
    pub const DEFAULT: Self = Self {
        sample_period: 1e-4,
        tool: Tool::DEFAULT,
        surface: Surface::DEFAULT,
        path: Path::DEFAULT,
        servo: Servo::DEFAULT,
        tip: Tip::DEFAULT,
        feedforward: Feedforward::DEFAULT,
        afc: Afc::DEFAULT,
        pll: Pll::DEFAULT,
        approach: Approach::DEFAULT,
        hold: Hold::DEFAULT,
        limit: Limit::DEFAULT,
        identify: Identify::DEFAULT,
        probe: Probe::DEFAULT,
        calibration: Calibration::DEFAULT,
    };

    /// The paper's method: eq. 3 as printed on the first five even harmonics, no flexure compensation.
    pub const PAPER: Self = Self {
        tip: Tip { compensation: false, ..Tip::DEFAULT },
        afc: Afc { harmonics: Harmonics::PAPER, tau: 0.2, phase_advance: false, ..Afc::DEFAULT },
        ..Self::DEFAULT
    };

    /// Whole samples in `time` s, rounded.
    pub fn ticks(&self, time: f64) -> u32 {
        (time / self.sample_period).round() as u32
    }

    /// Place of the selected tool in the arrays of [`Tool`].
    pub fn tool_index(&self) -> usize {
        (self.tool.selected - 1) as usize
    }
}

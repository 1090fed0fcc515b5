//! All monitors of the controller, side by side.

use control_blocks::{Consecutive, Progress};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::monitoring::drive::DriveResponse;
use crate::monitoring::life::Life;
use crate::monitoring::oscillation::OscillationMonitor;
use crate::monitoring::rest::Rest;
use crate::monitoring::rest_force::RestForce;

/// Monitors next to the control law.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Monitors {
    /// The drive's answer.
    pub drive: DriveResponse,
    /// Noise of the reading.
    pub life: Life,
    /// The reading at rest.
    pub rest: Rest,
    /// The position has shown noise wherever the stage is, and now does not change.
    pub frozen_at_rest: bool,
    /// Force after the retract.
    pub relief: RestForce,
    /// Oscillation of the stage although its reference does not accelerate.
    pub oscillation: OscillationMonitor,
    /// Consecutive samples too far from the reference.
    pub diverged: Consecutive,
    /// Consecutive samples with too large a disturbance.
    pub overloaded: Consecutive,
    /// Time of the cycle.
    pub cycle: Progress,
}

impl Monitors {
    /// Nothing seen so far.
    pub fn new(p: &Parameters) -> Self {
        Self {
            drive: DriveResponse::new(p),
            life: Life::default(),
            rest: Rest::default(),
            frozen_at_rest: false,
            relief: RestForce::default(),
            oscillation: OscillationMonitor::new(p),
            diverged: Consecutive::NONE,
            overloaded: Consecutive::NONE,
            cycle: Progress::default(),
        }
    }
}

//! Nominal machine for which the position loop is designed: sample period, delays, arm, drive and desired bandwidth.

use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, Servo, Tip};

/// The nominal machine of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Nominal {
    /// Sample period, s.
    pub sample_period: f64,
    /// Samples between a command and its action.
    pub io_delay: i32,
    /// Samples from an angle of the arm to its reading.
    pub arm_delay: i32,
    /// Arm, drive and desired loop.
    pub servo: Servo,
    /// Flexure.
    pub tip: Tip,
}

impl From<&Parameters> for Nominal {
    fn from(p: &Parameters) -> Self {
        let Parameters { sample_period, io_delay, arm_delay, servo, tip, .. } = *p;
        Self { sample_period, io_delay, arm_delay, servo, tip }
    }
}

impl Nominal {
    /// Samples from a command to the reading of the arm that answers it.
    pub fn loop_delay(&self) -> i32 {
        self.io_delay + self.arm_delay
    }
}

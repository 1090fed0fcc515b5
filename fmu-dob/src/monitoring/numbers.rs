//! Numbers that are told with a fault.

use serde::{Deserialize, Serialize};

/// What the monitors know of a sample, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// The contact that the force guard has found.
    pub late: Option<LateContact>,
    /// Change of the force from before the contact to behind the retract, N.
    pub residual_force: f64,
    /// Largest distance from the reference when the drive went off, m.
    pub following_limit: f64,
    /// Thrust constant in force when the fault was found, N/A.
    pub force_constant: f64,
    /// Swings of the stage, in a row.
    pub swings: u32,
    /// Samples by which the readings are late.
    pub late_by: u32,
    /// Second difference of the last readings, m; 0 where they jumped.
    pub bend: f64,
    /// Least and largest mean bias of a speed in a calibration, m.
    pub biases: [f64; 2],
    /// Fastest speed that `calibration.force_max` bears, where that is too slow to calibrate, m/s.
    pub bearable: Option<f64>,
    /// How long the job or the commission took, s.
    pub lasted: f64,
    /// How long it may, s.
    pub time_limit: f64,
}

impl Numbers {
    /// Before the first approach.
    pub const START: Self = Self {
        late: None,
        residual_force: 0.0,
        following_limit: 0.0,
        force_constant: 0.0,
        swings: 0,
        late_by: 0,
        bend: 0.0,
        biases: [0.0; 2],
        bearable: None,
        lasted: 0.0,
        time_limit: 0.0,
    };
}

/// A contact that the force guard has found, and the detector has not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LateContact {
    /// Encoder position at which the approach was stopped, m.
    pub position: f64,
    /// Force there above that before, N.
    pub force: f64,
    /// Why the detector had not.
    pub unseen: Unseen,
}

/// Why the detector has not found a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unseen {
    /// It was not armed.
    Unarmed,
    /// A reading that it remembers did not count in full.
    Doubted,
    /// It was armed, and missed it.
    Missed,
}

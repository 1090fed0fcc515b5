//! Details of a fault for the log.

use serde::{Deserialize, Serialize};

/// Details of the monitors in one sample, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// The contact that the force guard has found.
    pub late: Option<LateContact>,
    /// Change of the force from before the contact to after the retract, N.
    pub residual_force: f64,
    /// Largest distance from the reference when the drive went off, m.
    pub following_limit: f64,
    /// Thrust constant in force when the fault was found, N/A.
    pub force_constant: f64,
    /// Consecutive oscillations of the stage.
    pub oscillations: u32,
    /// Delay of the position, samples.
    pub late_by: u32,
    /// Second difference of the last positions, m; 0 where they jumped.
    pub bend: f64,
    /// Minimum and maximum mean bias of a speed in a calibration cycle, m.
    pub biases: [f64; 2],
    /// Fastest speed that `calibration.force_max` allows, where that is too slow to calibrate, m/s.
    pub tolerated: Option<f64>,
    /// Time of the cycle or of the commissioning run, s.
    pub lasted: f64,
    /// Limit of that time, s.
    pub time_limit: f64,
}

impl Numbers {
    /// Before the first approach.
    pub const START: Self = Self {
        late: None,
        residual_force: 0.0,
        following_limit: 0.0,
        force_constant: 0.0,
        oscillations: 0,
        late_by: 0,
        bend: 0.0,
        biases: [0.0; 2],
        tolerated: None,
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
    /// A position in its memory was only partly used.
    Doubted,
    /// It was armed, and missed the contact.
    Missed,
}

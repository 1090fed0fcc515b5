//! Parameters of one job: path, feed, contact, limits.

use serde::{Deserialize, Serialize};

/// What a path may be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Steepest surface, rad; 0.1 to 1.5, default 1.05 = 60 deg (our choice: the shank stays clear of the wall).
    pub slope_max: f64,
}

impl Path {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { slope_max: 1.05 };
}

/// Where the feed comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FeedSource {
    /// `feed.velocity`.
    Parameter = 1,
    /// FEDRAT in the CL file.
    File = 2,
}

/// Feed along the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feed {
    /// Parameter or file; default `Parameter` (our choice).
    pub source: FeedSource,
    /// Velocity v_tangent of the contact point, m/s; 1e-6 to 0.1, default 2 mm/s (our choice). Tunable.
    pub velocity: f64,
    /// Largest acceleration along the path, m/s2; 1e-3 to 10, default 0.05 (our choice).
    pub acceleration: f64,
    /// Fastest turn of the direction of motion, rad/s; 1 to 1e3, default 25 (our choice: 5 % of the velocity loop).
    pub turn_rate_max: f64,
}

impl Feed {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { source: FeedSource::Parameter, velocity: 2e-3, acceleration: 0.05, turn_rate_max: 25.0 };

    /// Whether the feed stands in the CL file.
    pub fn uses_file(&self) -> bool {
        self.source == FeedSource::File
    }
}

/// Zero of the force sensor, taken before the approach.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tare {
    /// Time of averaging, s; 1e-3 to 10, default 0.1 (our choice).
    pub time: f64,
    /// Largest force that may be a zero, N; 0.1 to 100, default 2 (our choice: the tip weighs 0.1 N).
    pub force_max: f64,
}

impl Tare {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { time: 0.1, force_max: 2.0 };
}

/// Approach motion along the normal of the first point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Approach {
    /// Velocity, m/s; 1e-5 to 0.01, default 0.5 mm/s (our choice; measured: 2 mm/s overshoots).
    pub velocity: f64,
    /// Force that is a contact, N; 0.05 to 50, default 0.6 (our choice: three steps of the sensor).
    pub contact_force: f64,
    /// Samples in a row above it; 1 to 100, default 3 (our choice).
    pub contact_samples: i32,
    /// Longest way without contact, m; 1e-5 to 0.1, default 2 mm (our choice).
    pub distance_max: f64,
    /// Largest distance from the line of approach at its begin, m; 1e-6 to 0.05, default 0.5 mm (our choice).
    pub offset_max: f64,
}

impl Approach {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { velocity: 0.5e-3, contact_force: 0.6, contact_samples: 3, distance_max: 2e-3, offset_max: 0.5e-3 };
}

/// Building up of the force, and its end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settle {
    /// Time in which the wanted force rises to `force.target` and falls to 0, s; 1e-3 to 10, default 0.2 (our choice).
    pub ramp_time: f64,
    /// Force error that is settled, part of the target; 0.01 to 0.5, default 0.15 (our choice).
    pub tolerance: f64,
    /// Time for which the error must stay there, s; 1e-3 to 10, default 0.1 (our choice).
    pub hold_time: f64,
    /// Longest time of settling, and of unloading, s; 0.01 to 60, default 2 (our choice).
    pub time_max: f64,
}

impl Settle {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { ramp_time: 0.2, tolerance: 0.15, hold_time: 0.1, time_max: 2.0 };
}

/// Retract motion along the normal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Retract {
    /// Distance, m; 1e-5 to 0.1, default 0.5 mm (our choice).
    pub distance: f64,
    /// Velocity, m/s; 1e-5 to 0.1, default 5 mm/s (our choice).
    pub velocity: f64,
}

impl Retract {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { distance: 0.5e-3, velocity: 5e-3 };
}

/// What is a fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Largest force, N; 0.5 to 1e3, default 25 (our choice).
    pub force: f64,
    /// Force below which contact is lost, N; 0 to 50, default 0.4 (our choice).
    pub lost_force: f64,
    /// Time below that force, s; 1e-3 to 10, default 0.1 (our choice).
    pub lost_time: f64,
    /// Largest position error along the path or beside it, m; 1e-6 to 0.05, default 0.5 mm (our choice).
    pub position_error: f64,
    /// Largest distance between surface and path along the normal, m; 1e-6 to 0.05, default 0.5 mm (our choice).
    pub surface_error: f64,
    /// Largest angle between the mean force and the normal, rad; 0.1 to 3, default 0.87 = 50 deg (derived: friction
    /// alone gives 22 deg at 0.4).
    pub force_angle: f64,
    /// Largest commanded velocity, m/s; 1e-3 to 1, default 50 mm/s (our choice).
    pub velocity: f64,
}

impl Limits {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        force: 25.0,
        lost_force: 0.4,
        lost_time: 0.1,
        position_error: 0.5e-3,
        surface_error: 0.5e-3,
        force_angle: 0.87,
        velocity: 0.05,
    };
}

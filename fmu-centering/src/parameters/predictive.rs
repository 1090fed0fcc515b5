//! Parameters of the default mode.

use serde::{Deserialize, Serialize};

/// Parking of the slide between the pushes: the probe hardly collapsed, for little force on the ring, and the slide
/// mostly at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Park {
    /// Collapse of the probe, m; 1e-4 to 0.5, default 4.5e-3 (our choice: a fifth of its force range).
    pub probe: f64,
    /// Change of the collapse without reaction of the slide, m; 0 to 0.1, default 3e-3 (our choice).
    pub dead_zone: f64,
}

impl Park {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { probe: 4.5e-3, dead_zone: 3e-3 };
}

/// Recursive model of the ring.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimator {
    /// Standard deviation of one measurement, m; 1e-9 to 1e-3, default 0.2e-6 (our choice: probe and roughness twice).
    pub noise: f64,
    /// Standard deviation of each coordinate of the centre before the first measurement, m; 1e-6 to 0.1, default 5e-3
    /// (our choice: placed by hand).
    pub centre: f64,
    /// Standard deviation of each form coefficient before the first measurement, m; 0 (a round ring) to 1e-3,
    /// default 2e-6 (our choice: ground rings).
    pub form: f64,
    /// Innovations beyond this many standard deviations are dirt; 1 to 1e6 (none), default 6 (our choice).
    pub gate: f64,
    /// Whether a part of a revolution may suffice for a push; default true (paper, as future work).
    pub partial: bool,
    /// Largest relative standard deviation of the eccentricity for a push; 0.01 to 1, default 0.2 (our choice).
    pub certainty: f64,
    /// Standard deviations by which a centred ring must stay within the tolerance; 0 to 10, default 3 (our choice).
    pub margin: f64,
}

impl Estimator {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { noise: 2e-7, centre: 5e-3, form: 2e-6, gate: 6.0, partial: true, certainty: 0.2, margin: 3.0 };
}

/// Strokes of the pusher.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stroke {
    /// Shortest time from contact to rest, s; 0.01 to 1, default 0.08 (our choice: three periods of the servo).
    pub duration: f64,
    /// Largest deceleration of the ring, m/s2; 0.01 to 10, default 0.2 (derived: less than friction gives a light ring).
    pub deceleration: f64,
    /// Largest velocity at contact, m/s; 1e-4 to 1, default 0.04 (our choice).
    pub velocity_max: f64,
    /// Longest wait at the end for the surface to arrive, s; 0 to 1, default 0.04 (our choice: one period of the servo).
    pub hold: f64,
    /// Integral gain from the place of the surface to the slide, 1/s; 0 (off) to 200, default 60 (derived: a quarter
    /// of the servo's bandwidth).
    pub feedback: f64,
    /// Whether rotation and friction during the push are planned; default true (derived).
    pub phase_plan: bool,
}

impl Stroke {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { duration: 0.08, deceleration: 0.2, velocity_max: 0.04, hold: 0.04, feedback: 60.0, phase_plan: true };
}

/// What pushes teach.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learn {
    /// Whether the lateral ratio is learned; default true.
    pub lateral: bool,
    /// Lateral ratio before the first push, 0 to 1, default 0.05 (derived: less than any, so that what is left comes to
    /// the pusher after a quarter of a revolution and not after three).
    pub lateral_start: f64,
    /// Its standard deviation, 0.01 to 1, default 0.1 (our choice).
    pub lateral_sigma: f64,
    /// Whether the probe position at contact is learned; default true.
    pub contact: bool,
    /// Whether the deflection of the servo is learned; default true.
    pub deflection: bool,
    /// Whether the way of the ring after the push is learned; default true.
    pub recoil: bool,
}

impl Learn {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { lateral: true, lateral_start: 0.05, lateral_sigma: 0.1, contact: true, deflection: true, recoil: true };
}

/// Tapping of heavy rings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tap {
    /// Whether heavy rings are tapped; default true.
    pub enabled: bool,
    /// Largest distance for a tap, in deflections of the servo; 0.1 to 100, default 1.5 (our choice).
    pub reach: f64,
    /// A ring that deflects the servo less is light, m; 1e-7 to 1e-3, default 8e-6 (derived: 2 kg at 40 Hz).
    pub deflection_min: f64,
    /// Largest speed, m/s; 1e-3 to 1, default 0.115 (our choice: of the slide).
    pub speed_max: f64,
    /// Stiffness of the pusher tip for the first guess, N/m; 1e4 to 1e9, default 5e6 (our choice).
    pub tip_stiffness: f64,
    /// Moving mass of the slide for the first guess, kg; 0.1 to 1e3, default 8 (our choice).
    pub slide_mass: f64,
}

impl Tap {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { enabled: true, reach: 1.5, deflection_min: 8e-6, speed_max: 0.115, tip_stiffness: 5e6, slide_mass: 8.0 };
}

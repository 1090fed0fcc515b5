//! Parameters of the law, grouped as in the FMU, each with its unit, range, default and source.
//!
//! Sources: "paper" = Mears et al. (2007); "derived" = follows from the equations;
//! "our choice" = usual practice, with the reason where there is one.

use serde::{Deserialize, Serialize};

use crate::law::Method;
use crate::offset::OffsetMethod;

mod predictive;

pub use predictive::{Estimator, Learn, Park, Stroke, Tap};

/// All parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Sample period, s; 1e-4 to 0.01, default 1e-3 (our choice: a 12 ms push needs setpoints at this rate).
    pub sample_period: f64,
    /// Largest eccentricity of a centred ring, m; 1e-8 to 1e-3, default 2.5e-6 (paper).
    pub tolerance: f64,
    /// How the ring is centred; default `Predictive` (our choice).
    pub method: Method,
    /// The part.
    pub ring: Ring,
    /// Measuring probe.
    pub probe: Probe,
    /// Slide and its servo.
    pub slide: Slide,
    /// Spindle encoder.
    pub spindle: Spindle,
    /// Approach motion.
    pub approach: Approach,
    /// Following of the surface.
    pub follow: Follow,
    /// Rates of the loops.
    pub rates: Rates,
    /// Scalar Kalman filter of the surface.
    pub kalman: Kalman,
    /// Pushes.
    pub push: Push,
    /// Offset that is learned from push to push.
    pub offset: Offset,
    /// What is assumed about friction.
    pub friction: Friction,
    /// Parking of the default mode.
    pub park: Park,
    /// Recursive model of the default mode.
    pub estimator: Estimator,
    /// Strokes of the default mode.
    pub stroke: Stroke,
    /// Learning of the default mode.
    pub learn: Learn,
    /// Tapping in the default mode.
    pub tap: Tap,
}

impl Parameters {
    /// The paper's method with the paper's numbers.
    pub const PAPER: Self = Self {
        sample_period: 1e-3,
        tolerance: 2.5e-6,
        method: Method::Paper,
        ring: Ring::DEFAULT,
        probe: Probe::DEFAULT,
        slide: Slide::DEFAULT,
        spindle: Spindle::DEFAULT,
        approach: Approach::DEFAULT,
        follow: Follow::DEFAULT,
        rates: Rates::DEFAULT,
        kalman: Kalman::DEFAULT,
        push: Push::DEFAULT,
        offset: Offset::DEFAULT,
        friction: Friction::DEFAULT,
        park: Park::DEFAULT,
        estimator: Estimator::DEFAULT,
        stroke: Stroke::DEFAULT,
        learn: Learn::DEFAULT,
        tap: Tap::DEFAULT,
    };

    /// What a good engineer would ship.
    pub const DEFAULT: Self = Self { method: Method::Predictive, ..Self::PAPER };

    /// Whole samples in `time` s, rounded.
    pub fn ticks(&self, time: f64) -> u32 {
        (time / self.sample_period).round() as u32
    }

    /// Collapse of the probe while following, m.
    pub fn null(&self) -> f64 {
        match self.method {
            Method::Paper => self.probe.at_pusher - self.follow.gap,
            Method::Predictive => self.park.probe,
        }
    }

    /// Error of following without reaction, m.
    pub fn dead_zone(&self) -> f64 {
        match self.method {
            Method::Paper => self.follow.dead_zone,
            Method::Predictive => self.park.dead_zone,
        }
    }

    /// Error of following that counts as settled (m), and for how long (s).
    pub fn settling(&self) -> (f64, f64) {
        match self.method {
            Method::Paper => (self.follow.settle_band, self.follow.settle_time),
            // the model takes the surface as it comes, the slide may move
            Method::Predictive => (self.park.probe, 0.0),
        }
    }
}

/// The part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ring {
    /// Nominal outer radius r, m; 1e-3 to 2, default 0.05 (our choice: of the paper's size; told by the operator).
    pub radius: f64,
    /// Largest eccentricity expected, m; 1e-6 to 1, default 0.025 (paper).
    pub eccentricity_max: f64,
}

impl Ring {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { radius: 0.05, eccentricity_max: 0.025 };
}

/// Measuring probe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Collapse at which the pusher touches, m; 1e-4 to 0.5, default 0.020 (our choice: more than eq. 9; from a calibration).
    pub at_pusher: f64,
    /// Stroke, m; 1e-4 to 0.5, default 0.025 (paper).
    pub stroke: f64,
    /// Collapse that counts as touching, m; 1e-6 to 0.01, default 2e-4 (our choice: far above noise and dirt).
    pub contact: f64,
}

impl Probe {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { at_pusher: 0.020, stroke: 0.025, contact: 2e-4 };
}

/// Slide and its servo.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slide {
    /// Largest velocity, m/s; 1e-3 to 10, default 0.12 (paper).
    pub velocity_max: f64,
    /// Acceleration of all moves, m/s2; 0.01 to 100, default 2.56 (paper).
    pub acceleration_max: f64,
    /// Samples between a setpoint and its action, 0 to 8, default 1 (our choice: what a standard master does).
    pub io_delay: i32,
    /// Bandwidth of its servo for the feed-forward of acceleration, Hz; 0 (none) to 1000, default 40 (our choice).
    pub servo_bandwidth: f64,
}

impl Slide {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { velocity_max: 0.12, acceleration_max: 2.56, io_delay: 1, servo_bandwidth: 40.0 };
}

/// Spindle encoder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spindle {
    /// Resolution of the encoder, rad; 0 to 0.1, default 2 pi / 4000 (paper).
    pub quantum: f64,
    /// Length of the regression that smooths angle and speed, s; 0.1 to 5, default 0.5 (derived: jitter 0.02 %).
    pub window: f64,
    /// Slower than this is standing still, rad/s; 1e-3 to 10, default 0.1 (our choice: 1 rpm).
    pub speed_min: f64,
}

impl Spindle {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { quantum: std::f64::consts::TAU / 4000.0, window: 0.5, speed_min: 0.1 };
}

/// Approach motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Approach {
    /// Velocity until the probe touches, and of the way back, m/s; 1e-4 to 10, default 0.12 (paper).
    pub velocity: f64,
    /// Longest travel from the start position, m; 1e-3 to 10, default 0.15 (our choice).
    pub travel: f64,
}

impl Approach {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { velocity: 0.12, travel: 0.15 };
}

/// Following of the surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Follow {
    /// Velocity per error Kp, 1/s; 0.1 to 1e3, default 15 (derived: critically damped at 25 with one sample of delay).
    pub gain: f64,
    /// Gap between pusher and ring while following, m; 1e-5 to 0.1, default 5e-4 (our choice).
    pub gap: f64,
    /// Error without reaction, m; 0 to 0.1, default 0 (paper).
    pub dead_zone: f64,
    /// Error that counts as settled, m; 1e-6 to 0.1, default 2e-4 (our choice).
    pub settle_band: f64,
    /// Time within that band, s; 0 to 10, default 0.1 (our choice).
    pub settle_time: f64,
}

impl Follow {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { gain: 15.0, gap: 5e-4, dead_zone: 0.0, settle_band: 2e-4, settle_time: 0.1 };
}

/// Rates of the loops.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Following and launching, Hz; 1 to 1e4, default 100 (paper).
    pub control: f64,
    /// Collecting, Hz; 1 to 1e4, default 66 (paper).
    pub collect: f64,
    /// Modelling, Hz; 0.1 to 1e4, default 10 (paper).
    pub model: f64,
}

impl Rates {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { control: 100.0, collect: 66.0, model: 10.0 };
}

/// Scalar Kalman filter of the surface; standard deviations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kalman {
    /// Walk of the surface from sample to sample sqrt(Q), m; 1e-9 to 1e-3, default 0.015e-6 (paper).
    pub process_noise: f64,
    /// Noise of the measurement sqrt(R), m; 1e-9 to 1e-3, default 0.03e-6 (paper).
    pub measurement_noise: f64,
}

impl Kalman {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { process_noise: 0.015e-6, measurement_noise: 0.03e-6 };
}

/// Pushes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Push {
    /// Velocity of the smallest push, m/s; 1e-6 to 1, default 4e-4 (paper, printed as 400 mm/s).
    pub velocity_min: f64,
    /// Velocity of a large push, m/s; 1e-6 to 1, default 3.5e-3 (paper, printed as 3500 mm/s).
    pub velocity_max: f64,
    /// Eccentricity from which a push is large, m; 1e-6 to 0.1, default 2.5e-3 (paper).
    pub critical_distance: f64,
    /// Steepness s of the velocity below it, 0.1 to 10, default 1 (paper).
    pub steepness: f64,
    /// Time at the end of the stroke, s; 0 to 1, default 0.01 (our choice: the lag of a 40 Hz servo).
    pub dwell: f64,
    /// Most pushes of one centring, 1 to 1000, default 25 (our choice).
    pub max_count: i32,
}

impl Push {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        velocity_min: 4e-4,
        velocity_max: 3.5e-3,
        critical_distance: 2.5e-3,
        steepness: 1.0,
        dwell: 0.01,
        max_count: 25,
    };
}

/// Offset that is learned from push to push.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offset {
    /// What is learned after a push; `Recursive` is the paper's.
    pub method: OffsetMethod,
    /// Only pushes of a smaller eccentricity teach, m; 1e-6 to 1, default 2e-4 (paper).
    pub gate: f64,
    /// Largest offset in either direction, m; 0 to 0.01, default 3e-4 (our choice).
    pub limit: f64,
}

impl Offset {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { method: OffsetMethod::Recursive, gate: 2e-4, limit: 3e-4 };
}

/// What is assumed about friction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Friction {
    /// Coefficient that the centrifugal force must not exceed, eq. 2; 1e-3 to 2, default 0.05 (paper).
    pub mu_limit: f64,
}

impl Friction {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { mu_limit: 0.05 };
}

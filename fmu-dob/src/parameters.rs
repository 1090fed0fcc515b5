//! Parameters of the law, grouped as in the FMU, each with its unit, range, default and source.
//!
//! Sources: "paper" = Kakinuma and Nagakari (2017); "derived" = follows from the equations;
//! "our choice" = usual practice, with the reason where there is one.

use serde::{Deserialize, Serialize};

use crate::detector::DetectorKind;
use crate::threshold::ThresholdMode;

/// All parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Sample period T_s, s; 2e-5 to 1e-3, default 1e-4 (our choice: a usual amplifier rate).
    pub sample_period: f64,
    /// Nominal model of the stage.
    pub stage: Stage,
    /// Position servo.
    pub servo: Servo,
    /// Disturbance observer.
    pub observer: Observer,
    /// Notch filters that follow the spindle.
    pub notch: Notch,
    /// Deviation from the moving average.
    pub deviation: Deviation,
    /// Least-squares slope.
    pub slope: Slope,
    /// Which detector decides; default `MultiSlope` (our choice), `Slope` is the paper's.
    pub detector: DetectorKind,
    /// Threshold of the raw, deviation and slope detectors.
    pub threshold: Threshold,
    /// Learning of the noise before contact.
    pub learn: Learn,
    /// Kalman filter behind the detectors `Cusum` and `Glr`.
    pub kalman: Kalman,
    /// Cumulative-sum detector.
    pub cusum: Cusum,
    /// Generalised-likelihood-ratio detector.
    pub glr: Glr,
    /// Approach motion.
    pub approach: Approach,
    /// Retract motion.
    pub retract: Retract,
    /// Hard force guard.
    pub guard: Guard,
    /// Contact position.
    pub contact: Contact,
}

impl Parameters {
    /// What a good engineer would ship: multi-slope detector with automatic thresholds.
    pub const DEFAULT: Self = Self {
        sample_period: 1e-4,
        stage: Stage::DEFAULT,
        servo: Servo::DEFAULT,
        observer: Observer::DEFAULT,
        notch: Notch::DEFAULT,
        deviation: Deviation::DEFAULT,
        slope: Slope::DEFAULT,
        detector: DetectorKind::MultiSlope,
        threshold: Threshold::DEFAULT,
        learn: Learn::DEFAULT,
        kalman: Kalman::DEFAULT,
        cusum: Cusum::DEFAULT,
        glr: Glr::DEFAULT,
        approach: Approach::DEFAULT,
        retract: Retract::DEFAULT,
        guard: Guard::DEFAULT,
        contact: Contact::DEFAULT,
    };

    /// The paper's method: slope detector with the fixed threshold mu + 4 sigma.
    pub const PAPER: Self = Self {
        detector: DetectorKind::Slope,
        threshold: Threshold { mode: ThresholdMode::Fixed, alpha: 4.0, ..Threshold::DEFAULT },
        ..Self::DEFAULT
    };

    /// Whole samples in `time` s, rounded.
    pub fn ticks(&self, time: f64) -> u32 {
        (time / self.sample_period).round() as u32
    }

    /// Sign of the approach along the encoder axis, +1 or -1.
    pub fn direction(&self) -> f64 {
        f64::from(self.approach.direction)
    }
}

/// Nominal model of the stage and its drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Moving mass M_n, kg; 0.01 to 1e4, default 10 (our choice: small air-bearing stage).
    pub mass: f64,
    /// Thrust constant K_tn, N/A; 0.01 to 1e4, default 20 (our choice: shaft motor).
    pub force_constant: f64,
    /// Largest current, A; 0.01 to 1e3, default 5 (our choice).
    pub current_max: f64,
    /// Resolution of the current command over +-`current_max`, bit; 8 to 24, default 16 (paper).
    pub current_bits: i32,
    /// Samples between a command and its action, 0 to 8, default 1 (our choice: what a standard master does).
    pub io_delay: i32,
    /// Bandwidth of the current loop, rad/s; 100 to 1e6, default 6283 = 1 kHz (our choice; Kalman filter only).
    pub current_bandwidth: f64,
}

impl Stage {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        mass: 10.0,
        force_constant: 20.0,
        current_max: 5.0,
        current_bits: 16,
        io_delay: 1,
        current_bandwidth: 6283.0,
    };
}

/// Proportional-derivative position servo on top of the disturbance observer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Servo {
    /// Natural frequency omega_n, rad/s; 1 to 2000, default 188 = 30 Hz (our choice: 40 degrees of phase left).
    pub bandwidth: f64,
    /// Damping ratio zeta; 0.1 to 5, default 1 (our choice).
    pub damping: f64,
    /// Feed the estimated disturbance back (robust acceleration control); default true (our choice).
    pub disturbance_compensation: bool,
    /// Integral gain used instead when the compensation is off, 1/s3; 0 to 1e9, default 2e6 (our choice).
    pub integral_gain: f64,
}

impl Servo {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { bandwidth: 188.0, damping: 1.0, disturbance_compensation: true, integral_gain: 2e6 };
}

/// Disturbance observer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observer {
    /// Cut-off g_dis of the disturbance, rad/s; 10 to 1e4, default 628 = 100 Hz (our choice; depth is flat from 50 to 200 Hz).
    pub bandwidth: f64,
    /// Cut-off g_v of the velocity, rad/s; 10 to 5e4, default 3142 = 500 Hz (our choice).
    pub velocity_bandwidth: f64,
}

impl Observer {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { bandwidth: 628.0, velocity_bandwidth: 3142.0 };
}

/// Notch filters at the spindle frequency and its harmonics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Notch {
    /// Number of harmonics removed, 0 to 4, default 2 (our choice).
    pub harmonics: i32,
    /// Quality Q of each notch; 0.5 to 100, default 2 (our choice).
    pub quality: f64,
}

impl Notch {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { harmonics: 2, quality: 2.0 };
}

/// Deviation from the moving average, eq. 2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Samples r of the moving average, 10 to 100000, default 1000 (our choice; depth is flat from 200 to 5000).
    pub window: i32,
}

impl Deviation {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { window: 1000 };
}

/// Least-squares slope of the deviation, eq. 3.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slope {
    /// Samples N of the fit, 3 to 1000, default 50 (our choice).
    pub window: i32,
}

impl Slope {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { window: 50 };
}

/// Threshold mu + alpha sigma.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Threshold {
    /// Fixed alpha (paper) or alpha from the wished false-alarm interval (default, our choice).
    pub mode: ThresholdMode,
    /// Fixed alpha, 1 to 50, default 4 (paper).
    pub alpha: f64,
    /// Wished mean time between false alarms, s; 1 to 1e9, default 36000 (our choice).
    pub false_alarm_interval: f64,
    /// Samples in a row above the threshold that make a detection, 1 to 100, default 3 (paper).
    pub row: i32,
}

impl Threshold {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { mode: ThresholdMode::Automatic, alpha: 4.0, false_alarm_interval: 36_000.0, row: 3 };
}

/// Learning of the noise before contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learn {
    /// Time at constant speed before learning, s; 0 to 100, default 0.25 (our choice).
    pub settle_time: f64,
    /// Time of learning, s; 0.001 to 100, default 0.5 (our choice; 0.1 s triples the false alarms of alpha 4).
    pub time: f64,
    /// Largest believable sigma of the slope, N/s; 1e-6 to 1e6, default 5 (our choice: a spindle without notch is above).
    pub slope_sigma_max: f64,
}

impl Learn {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { settle_time: 0.25, time: 0.5, slope_sigma_max: 5.0 };
}

/// Noise model of the Kalman filter; all values are standard deviations (our choice, from the noise of such stages).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kalman {
    /// Random walk of the disturbance in one sample, N; 1e-9 to 1e3, default 7e-4.
    pub disturbance_walk: f64,
    /// Random walk of each spindle harmonic in one sample, N; 1e-9 to 1e3, default 1e-4.
    pub harmonic_walk: f64,
    /// White force in one sample, N; 1e-9 to 1e3, default 5e-3.
    pub force_noise: f64,
    /// Position noise with quantisation, m; 1e-12 to 1e-3, default 0.6e-9.
    pub position_noise: f64,
}

impl Kalman {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { disturbance_walk: 7e-4, harmonic_walk: 1e-4, force_noise: 5e-3, position_noise: 0.6e-9 };
}

/// Cumulative sum of the normalised innovation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cusum {
    /// Subtracted in each sample, 0 to 5 sigma, default 0.25 (our choice).
    pub drift: f64,
    /// Alarm level, 1 to 1000 sigma, default 16 (our choice: about one false alarm per hour).
    pub threshold: f64,
}

impl Cusum {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { drift: 0.25, threshold: 16.0 };
}

/// Generalised likelihood ratio over a bank of contact instants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Glr {
    /// Contact instants in the bank, one per sample, 10 to 1000, default 300 (our choice).
    pub onsets: i32,
    /// Alarm level of the log-likelihood ratio, 1 to 1000, default 15 (our choice: at most one false alarm per hour).
    pub threshold: f64,
}

impl Glr {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { onsets: 300, threshold: 15.0 };
}

/// Approach motion; latched at `start`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Approach {
    /// Approach speed v, m/s; 1e-7 to 0.01, default 1e-4 (our choice).
    pub velocity: f64,
    /// Acceleration to the approach speed, m/s2; 1e-4 to 10, default 0.05 (our choice).
    pub acceleration: f64,
    /// Longest travel from the start position, m; 1e-6 to 1, default 0.005 (our choice).
    pub travel_max: f64,
    /// +1 if the encoder counts up towards the workpiece, -1 if down; default +1.
    pub direction: i32,
}

impl Approach {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { velocity: 1e-4, acceleration: 0.05, travel_max: 0.005, direction: 1 };
}

/// Retract motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Retract {
    /// Retract speed, m/s; 1e-6 to 0.1, default 1e-3 (our choice).
    pub velocity: f64,
    /// Deceleration a_stop after a detection, m/s2; 0.01 to 50, default 2 (our choice: 1 A of this stage).
    pub deceleration: f64,
    /// Distance back from the detection, m; 1e-7 to 0.1, default 2e-5 (our choice).
    pub distance: f64,
}

impl Retract {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { velocity: 1e-3, deceleration: 2.0, distance: 2e-5 };
}

/// Hard force guard, beside the detector.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Guard {
    /// Force change that stops the approach, N; 1e-3 to 1e4, default 0.4 (our choice: 1.3 um at 100 um/s; must exceed the cogging).
    pub force: f64,
}

impl Guard {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { force: 0.4 };
}

/// Contact position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Travel between first touch and detection, m; -1e-3 to 1e-3, default 0; from one calibration touch.
    pub bias: f64,
}

impl Contact {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { bias: 0.0 };
}

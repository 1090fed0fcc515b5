//! What goes in and out of the law in one sample, grouped as in the FMU.

use serde::{Deserialize, Serialize};

use crate::calibration::Status;
use crate::loop_response::LoopResponse;
use crate::machine::{Fault, Mode, State};
use crate::margins::{Margins, margins};
use crate::response::{FrequencyResponse, Point};

/// Harmonics of the tracking error that are reported.
pub const ERROR_HARMONICS: usize = 24;
/// Points of the frequency response that are reported.
pub const RESPONSE_POINTS: usize = crate::response::POINTS_MAX;

/// Inputs, sampled at the start of the tick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Encoder angle b of the arm from its index, rad.
    pub arm_angle: f64,
    /// Spindle angle theta, wrapped or unwrapped, rad.
    pub spindle_angle: f64,
    /// Reading x of the cross slide, m.
    pub slide_position: f64,
    /// What is asked for.
    pub mode: Mode,
    /// Switch of the feedforward.
    pub feedforward: FeedforwardInput,
    /// Switches of the cancellation.
    pub afc: AfcInput,
    /// Angle b to be held, rad.
    pub hold_angle: f64,
    /// Depth probe.
    pub probe: ProbeInput,
    /// Calibration.
    pub calibration: CalibrationInput,
}

/// Switch of the feedforward.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FeedforwardInput {
    /// Pre-shift the path.
    pub enable: bool,
}

/// Switches of the cancellation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AfcInput {
    /// Cancel harmonics; off also forgets what was learned.
    pub enable: bool,
    /// Rising edge forgets what was learned.
    pub reset: bool,
}

/// Depth probe, for the calibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbeInput {
    /// Depth reading p, m.
    pub depth: f64,
    /// Distance l of the probe from the spindle axis, negative on its other side, m.
    pub lateral: f64,
    /// Rising edge stores a sample; while it stays, one more every `probe.pitch` of way.
    pub capture: bool,
}

/// Commands of the calibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibrationInput {
    /// The tool cuts the part that will be probed.
    pub cut: bool,
    /// Rising edge runs the fit.
    pub solve: bool,
}

impl Input {
    /// At rest, off, with feedforward and cancellation allowed.
    pub const START: Self = Self {
        arm_angle: 0.0,
        spindle_angle: 0.0,
        slide_position: 0.0,
        mode: Mode::Off,
        feedforward: FeedforwardInput { enable: true },
        afc: AfcInput { enable: true, reset: false },
        hold_angle: 0.0,
        probe: ProbeInput { depth: 0.0, lateral: 0.0, capture: false },
        calibration: CalibrationInput { cut: false, solve: false },
    };
}

/// Outputs; always finite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Torque command, N.m.
    pub torque: f64,
    /// What the controller is doing.
    pub state: State,
    /// Why it is in the fault state.
    pub fault: Fault,
    /// Where the tool should be.
    pub reference: Reference,
    /// Tracking error at the tool.
    pub error: ErrorReport,
    /// Estimated spindle speed, rad/s.
    pub spindle_speed: f64,
    /// The torque is at its limit.
    pub saturated: bool,
    /// State of the cancellation.
    pub afc: AfcOutput,
    /// What is known of the path beforehand.
    pub path: PathOutput,
    /// Result of the calibration.
    pub calibration: Calibration,
    /// Frequency response of the position loop.
    pub response: ResponseOutput,
    /// Measurement of the frequency response.
    pub identify: IdentifyOutput,
}

/// Where the tool should be, before feedforward and cancellation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Depth z of the nose centre, m.
    pub depth: f64,
    /// Encoder angle b_d of the arm, rad.
    pub angle: f64,
}

/// Tracking error at the tool.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorReport {
    /// R_a cos phi (b_d - b), m.
    pub tracking: f64,
    /// Root mean square over the last full turn, m.
    pub rms: f64,
    /// Largest magnitude in the last full turn, m.
    pub peak: f64,
    /// Amplitudes of the harmonics in the last full turn, m.
    pub harmonic: [f64; ERROR_HARMONICS],
}

/// State of the cancellation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AfcOutput {
    /// Nothing is learned at present.
    pub frozen: bool,
}

/// What is known of the path beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathOutput {
    /// At the present speed, anywhere on the table, N.m.
    pub torque: f64,
    /// Largest depth that the harmonics of the table leave out, m.
    pub truncation: f64,
}

/// Result of the calibration, for the selected tool.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// How it goes.
    pub status: Status,
    /// Arm length R_a, m.
    pub arm_length: f64,
    /// Cross-slide offset x_0, m.
    pub centre_offset: f64,
    /// Arm offset angle b_0, rad.
    pub arm_zero: f64,
    /// Standard deviation of R_a, m.
    pub arm_length_sigma: f64,
    /// Standard deviation of x_0, m.
    pub centre_offset_sigma: f64,
    /// Standard deviation of b_0, rad.
    pub arm_zero_sigma: f64,
    /// Root mean square of the residuals of the last fit, m.
    pub residual: f64,
    /// Stored samples.
    pub samples: i32,
}

/// Frequency response of the position loop that is in use: nominal, from `response.file` or identified.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResponseOutput {
    /// -3 dB frequency, rad/s; 0 if it is beyond the table.
    pub bandwidth: f64,
    /// Smallest phase margin, rad.
    pub phase_margin: f64,
    /// Largest magnitude of the sensitivity.
    pub sensitivity_peak: f64,
    /// Frequencies, rad/s; 0 where there is no point.
    pub frequency: [f64; RESPONSE_POINTS],
    /// Magnitudes.
    pub magnitude: [f64; RESPONSE_POINTS],
    /// Phases, rad.
    pub phase: [f64; RESPONSE_POINTS],
}

impl ResponseOutput {
    /// The points of a response, and what follows from the loop in use that they belong to.
    pub fn of(response: &FrequencyResponse, in_use: &LoopResponse) -> Self {
        let frequency = |place: Option<&Point>| place.map_or(0.0, |point| point.frequency);
        let (first, last) = (frequency(response.points().first()), frequency(response.points().last()));
        let Margins { bandwidth, phase_margin, sensitivity_peak } = margins(first, last, |omega| in_use.at(omega));
        let mut output = Self { bandwidth, phase_margin, sensitivity_peak, ..Output::START.response };
        for (i, point) in response.points().iter().enumerate() {
            output.frequency[i] = point.frequency;
            output.magnitude[i] = point.magnitude;
            output.phase[i] = point.phase;
        }
        output
    }
}

/// Measurement of the frequency response.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct IdentifyOutput {
    /// Part of the measurement that is over, 0 to 1.
    pub progress: f64,
}

impl Output {
    /// All zero, idle.
    pub const START: Self = Self {
        torque: 0.0,
        state: State::Idle,
        fault: Fault::None,
        reference: Reference { depth: 0.0, angle: 0.0 },
        error: ErrorReport { tracking: 0.0, rms: 0.0, peak: 0.0, harmonic: [0.0; ERROR_HARMONICS] },
        spindle_speed: 0.0,
        saturated: false,
        afc: AfcOutput { frozen: true },
        path: PathOutput { torque: 0.0, truncation: 0.0 },
        calibration: Calibration {
            status: Status::None,
            arm_length: 0.0,
            centre_offset: 0.0,
            arm_zero: 0.0,
            arm_length_sigma: 0.0,
            centre_offset_sigma: 0.0,
            arm_zero_sigma: 0.0,
            residual: 0.0,
            samples: 0,
        },
        response: ResponseOutput {
            bandwidth: 0.0,
            phase_margin: 0.0,
            sensitivity_peak: 0.0,
            frequency: [0.0; RESPONSE_POINTS],
            magnitude: [0.0; RESPONSE_POINTS],
            phase: [0.0; RESPONSE_POINTS],
        },
        identify: IdentifyOutput { progress: 0.0 },
    };
}

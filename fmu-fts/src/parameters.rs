//! Parameters of the law, grouped as in the FMU, each with its unit, range, default and source.
//!
//! Sources: "paper" = Ludwick, Chargin, Calzaretta and Trumper (1999); "derived" = follows from the equations;
//! "our choice" = the paper is silent; with the reason where there is one.

use serde::{Deserialize, Serialize};

use crate::frequencies::Frequencies;
use crate::harmonics::Harmonics;

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

/// The two tools of the double-ended arm; one calibration record each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// The tool in use, 1 or 2, default 1.
    pub selected: i32,
    /// Arm length R_a, m; 0.02 to 0.5, default 0.08 (paper).
    pub arm_length: [f64; 2],
    /// Arm angle b_0 at the encoder index, rad; -7 to 7, default 0.0523 and half a turn more (our choice).
    pub arm_zero: [f64; 2],
    /// Cross-slide reading x_0 at which the arm axis is above the spindle axis, m; -2 to 2, default 0.15 (our choice).
    pub centre_offset: [f64; 2],
    /// Nose radius R_t, m; 0 to 0.02, default 2 mm (our choice: usual diamond).
    pub nose_radius: [f64; 2],
    /// Standard deviation of the arm length, where the flats begin without a toroid, m; 1e-9 to 1e-3, default 1 um (paper).
    pub arm_length_sigma: [f64; 2],
    /// Standard deviation of the nose radius, m; 0 to 1e-3, default 0.1 um (our choice).
    pub nose_radius_sigma: [f64; 2],
}

impl Tool {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        selected: 1,
        arm_length: [0.08; 2],
        arm_zero: [0.0523, 0.0523 - std::f64::consts::PI],
        centre_offset: [0.15; 2],
        nose_radius: [0.002; 2],
        arm_length_sigma: [1e-6; 2],
        nose_radius_sigma: [1e-7; 2],
    };
}

/// What kind of surface is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SurfaceKind {
    /// Toric with two principal curvatures and tilt.
    Toric = 1,
    /// One harmonic of the tool depth, for cuts in air.
    Wave = 2,
    /// Table from `path.file`.
    File = 3,
}

/// Surface to be cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Toric, wave or a file; default toric (paper).
    pub kind: SurfaceKind,
    /// Curvature across the spindle angle 0, along Y, 1/m; -50 to 50, default 0 = flat (paper: 0x4).
    pub base_curvature: f64,
    /// Curvature along the spindle angle 0, along X, 1/m; -50 to 50, default 1/0.1325 (paper: 132.5 mm, concave).
    pub cross_curvature: f64,
    /// Slope along X, 1; -0.5 to 0.5, default 0 (prism).
    pub tilt_x: f64,
    /// Slope along Y, 1; -0.5 to 0.5, default 0 (prism).
    pub tilt_y: f64,
    /// Amplitude of the wave, m; 0 to 0.05, default 50.7 um (derived: 500 m/s2 at 500 Hz).
    pub wave_amplitude: f64,
    /// Waves per turn; 1 to 64, default 50 (derived: 500 Hz at 600 rpm).
    pub wave_harmonic: i32,
    /// Where the cut ends, distance from the spindle axis, m; 0 to 0.5, default 0.
    pub inner_radius: f64,
    /// Where the cut begins, m; 1e-3 to 0.5, default 0.05 (paper: 100 mm parts).
    pub outer_radius: f64,
    /// Place the part so that the arm works about the plane of its axis; default true (our choice).
    pub depth_auto: bool,
    /// Depth z_c of the nose centre at the spindle axis, used without `depth_auto`, m; -0.2 to 0.2, default 0.
    pub depth: f64,
}

impl Surface {
    /// Documented defaults: the paper's 0x4.
    pub const DEFAULT: Self = Self {
        kind: SurfaceKind::Toric,
        base_curvature: 0.0,
        cross_curvature: 1.0 / 0.1325,
        tilt_x: 0.0,
        tilt_y: 0.0,
        wave_amplitude: 50.7e-6,
        wave_harmonic: 50,
        inner_radius: 0.0,
        outer_radius: 0.05,
        depth_auto: true,
        depth: 0.0,
    };
}

/// Look-up table of the tool path, eq. 2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Harmonics N of eq. 2; 1 to 64, default 12 (paper: 6 to 10; derived: 28 for 0x8 at the rim).
    pub harmonics: i32,
    /// Grid in the slide position, m; 1e-4 to 5e-3, default 0.5 mm (derived: 0.4 nm with cubic interpolation).
    pub grid: f64,
}

impl Path {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { harmonics: 12, grid: 0.5e-3 };
}

/// Nominal arm and drive, and the lead-lag position loop designed for them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Servo {
    /// Wanted -3 dB bandwidth of the closed loop, rad/s; 62.8 to 3142, default 1445 = 230 Hz (paper).
    pub bandwidth: f64,
    /// Lead: crossover over zero, and pole over crossover, 1; 1.5 to 10, default 4 (our choice: 44 degrees left).
    pub lead: f64,
    /// Lag: crossover over the zero of the integrator, 1; 3 to 1000, default 10 (our choice).
    pub lag: f64,
    /// Roll-off, rad/s; 1000 to 31400, default 15708 = 2.5 kHz (our choice).
    pub roll_off: f64,
    /// Inertia J of the whole moving arm, kg.m2; 1e-7 to 10, default 8e-4 (our choice: 500 m/s2 needs 5 N.m).
    pub inertia: f64,
    /// Viscous friction, N.m.s/rad; 0 to 10, default 2e-3 (our choice).
    pub viscous_friction: f64,
    /// Dry friction that is fed forward, N.m; 0 to 10, default 0 = off (our choice: it must be measured first).
    pub dry_friction: f64,
    /// Largest torque, N.m; 1e-3 to 1e4, default 7 (our choice).
    pub torque_max: f64,
    /// Bandwidth of the current loop, rad/s; 600 to 1e6, default 12566 = 2 kHz (our choice).
    pub current_bandwidth: f64,
    /// Samples between a command and its action; 0 to 8, default 1 (our choice: what a standard master does).
    pub io_delay: i32,
}

impl Servo {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        bandwidth: std::f64::consts::TAU * 230.0,
        lead: 4.0,
        lag: 10.0,
        roll_off: std::f64::consts::TAU * 2500.0,
        inertia: 8e-4,
        viscous_friction: 2e-3,
        dry_friction: 0.0,
        torque_max: 7.0,
        current_bandwidth: std::f64::consts::TAU * 2000.0,
        io_delay: 1,
    };
}

/// Flexure of the arm between encoder and tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tip {
    /// Natural frequency of the arm on the locked hub, rad/s; 0 (rigid) to 1e5, default 7540 = 1.2 kHz (our choice).
    pub frequency: f64,
    /// Part of the inertia that is beyond the flexure, 1; 0 to 0.95, default 0.4375 (our choice).
    pub inertia: f64,
    /// Damping ratio of the arm on the locked hub, 1; 0 to 0.5, default 0.02 (our choice: metal).
    pub damping: f64,
    /// Move the hub so that the tool, not the hub, is on the path; default true (our choice).
    pub compensation: bool,
}

impl Tip {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { frequency: std::f64::consts::TAU * 1200.0, inertia: 0.4375, damping: 0.02, compensation: true };
}

/// Feedforward that pre-shifts the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feedforward {
    /// Harmonics that are pre-shifted, 0 for none, else at least those of the path; 0 to 64, default 24 (derived: what the
    /// arc of the arm makes of 12).
    pub harmonics: i32,
}

impl Feedforward {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { harmonics: 24 };
}

/// Adaptive feedforward cancellation, eq. 3.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Afc {
    /// Cancelled harmonics of the spindle; default 1 to 24 (our choice), paper 2, 4, 6, 8, 10.
    pub harmonics: Harmonics,
    /// Of these, cancel only what repeats from turn to turn; default false (our choice: it takes eight turns longer).
    pub automatic: bool,
    /// Time constant tau of each harmonic, s; 0.01 to 100, default 0.3 (derived: 24 harmonics), paper mode 0.2.
    pub tau: f64,
    /// Advance each resonator by the phase of the closed loop; default true, eq. 3 as printed has none.
    pub phase_advance: bool,
    /// Below this spindle speed nothing is learned, rad/s; 0 to 1e3, default 6.28 = 60 rpm (our choice).
    pub speed_min: f64,
    /// Harmonics above this are neither learned nor put out, rad/s; 62.8 to 31400, default 4398 = 700 Hz (our choice:
    /// three times the bandwidth).
    pub frequency_max: f64,
}

impl Afc {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        harmonics: Harmonics::DEFAULT,
        automatic: false,
        tau: 0.3,
        phase_advance: true,
        speed_min: std::f64::consts::TAU,
        frequency_max: std::f64::consts::TAU * 700.0,
    };
}

/// Phase-locked loop that estimates the spindle speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pll {
    /// Natural frequency, rad/s; 1 to 1000, default 126 = 20 Hz (our choice).
    pub bandwidth: f64,
}

impl Pll {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { bandwidth: std::f64::consts::TAU * 20.0 };
}

/// Motion onto the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Approach {
    /// Time of the quintic, s; 0.01 to 60, default 0.3 (our choice).
    pub time: f64,
}

impl Approach {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { time: 0.3 };
}

/// Motion to the held angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hold {
    /// Largest speed on the way to `hold_angle`, rad/s; 1e-4 to 100, default 2 (our choice). Never faster than the approach.
    pub speed: f64,
}

impl Hold {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { speed: 2.0 };
}

/// What is a fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Following error at the tool, m; 1e-6 to 0.1, default 1 mm (our choice).
    pub following_error: f64,
    /// Part of the largest torque that a path may need, 1; 0.1 to 1, default 0.9 (our choice: the rest is for control).
    pub torque_share: f64,
}

impl Limit {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { following_error: 1e-3, torque_share: 0.9 };
}

/// Measurement of the frequency response in place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identify {
    /// Frequencies, each 0.1 Hz to 10 kHz; default 32 from 10 Hz to 1 kHz (our choice: dense where the harmonics are).
    pub frequencies: Frequencies,
    /// Amplitude of the tool, m; 1e-6 to 0.05, default 1.75 mm (derived: the paper's 0x4 at a radius of 30 mm).
    pub amplitude: f64,
    /// Part of the largest torque that the swing may need, 1; 0.01 to 0.9, default 0.5 (our choice).
    pub torque_share: f64,
    /// Largest acceleration of the tool, m/s2; 0.1 to 1e5, default 500 (paper).
    pub acceleration_max: f64,
    /// Time from one frequency to the next, s; 1e-3 to 10, default 0.05 (our choice).
    pub glide_time: f64,
    /// Time at a frequency before it is measured, s; 0 to 10, default 0.1 (our choice: five times the slowest pole).
    pub settle_time: f64,
    /// Least time that is averaged, whole periods, s; 1e-3 to 100, default 0.2 (our choice).
    pub average_time: f64,
}

impl Identify {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        frequencies: Frequencies::DEFAULT,
        amplitude: 1.75e-3,
        torque_share: 0.5,
        acceleration_max: 500.0,
        glide_time: 0.05,
        settle_time: 0.1,
        average_time: 0.2,
    };
}

/// Depth probe on the slide.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Radius R_p of its ball, m; 0 to 0.02, default 1.5 mm (our choice).
    pub radius: f64,
    /// Standard deviation of the radius, m; 0 to 1e-3, default 0.1 um (our choice).
    pub radius_sigma: f64,
    /// Standard deviation of a depth reading on a cut surface, m; 1e-9 to 1e-3, default 65 nm (derived: step 0.1 um of the
    /// paper, 50 nm of noise, 30 nm of roughness).
    pub depth_sigma: f64,
    /// Standard deviation of the lateral position, m; 1e-9 to 1e-3, default 30 nm (derived: step 0.1 um).
    pub lateral_sigma: f64,
    /// Standard deviation of its zero on the spindle axis, m; 1e-9 to 0.1, default 0.1 mm (our choice: set by eye).
    pub cusp_sigma: f64,
    /// Way between two samples of one capture, m; 1e-6 to 0.1, default 0.1 mm (our choice).
    pub pitch: f64,
}

impl Probe {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        radius: 1.5e-3,
        radius_sigma: 1e-7,
        depth_sigma: 65e-9,
        lateral_sigma: 30e-9,
        cusp_sigma: 1e-4,
        pitch: 1e-4,
    };
}

/// Calibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Standard deviation of the arm angle of a flat, rad; 1e-9 to 1e-2, default 0.25 urad (derived: encoder step).
    pub arm_angle_sigma: f64,
    /// Speed of the arm while a calibration part is cut, rad/s; 1e-4 to 1, default 0.03 (our choice: 50 um a turn at
    /// 3000 rpm).
    pub sweep_speed: f64,
}

impl Calibration {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { arm_angle_sigma: 0.25e-6, sweep_speed: 0.03 };
}

//! Parameters of tools, surface and path.

use serde::{Deserialize, Serialize};

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

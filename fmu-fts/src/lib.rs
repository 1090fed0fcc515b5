//! Rotary fast tool servo that turns toric lenses (Ludwick, Chargin, Calzaretta and Trumper, 1999), as an FMU.
//!
//! This file is the FMU: its variables and the calls into the law. [`controller::Controller`] is the law,
//! plain Rust that knows nothing of FMI.
#![forbid(unsafe_code)]

pub mod approach;
pub mod calibration;
pub mod check;
pub mod chooser;
pub mod controller;
pub mod cut;
pub mod depth_table;
pub mod design;
pub mod dry_friction;
pub mod feasibility;
pub mod feedforward;
pub mod flats;
pub mod fourier;
pub mod frequencies;
pub mod harmonics;
pub mod hold;
pub mod identify;
pub mod json_file;
pub mod kinematics;
pub mod lead_lag;
pub mod least_squares;
pub mod loop_model;
pub mod loop_response;
pub mod machine;
pub mod margins;
mod messages;
pub mod parameters;
pub mod path;
pub mod path_file;
pub mod phasors;
pub mod quintic;
pub mod reading;
pub mod resonators;
pub mod response;
pub mod response_file;
pub mod signals;
pub mod spindle;
pub mod statistics;
pub mod store;
pub mod surface;
pub mod sweep;
pub mod texts;
pub mod tip;
pub mod tone;
pub mod toric;
pub mod toroid;
pub mod tracker;

use control_blocks::ParameterError;
use fmi2_export::units::{METRE, METRE_PER_SECOND_SQUARED, NEWTON_METRE, ONE, RADIAN, RADIAN_PER_SECOND, SECOND};
use fmi2_export::{
    Env, Error, Info, Model, Start, Unit, Variable, boolean, choice, enumeration, export, integer, real, text,
};
use serde::{Deserialize, Serialize};

use calibration::Status;
use controller::Controller;
use frequencies::Frequencies;
use harmonics::Harmonics;
use machine::{Fault, Mode, State};
use parameters::{Parameters, SurfaceKind};
use signals::{Input, Output};
use texts::Texts;

enumeration! { Mode, "What is asked for" {
    Off = 1, "No torque; ends a fault",
    Hold = 2, "Hold `hold_angle`",
    Approach = 3, "Get onto the path and follow it without learning",
    Track = 4, "Follow the path and cancel what repeats; gets onto the path first",
    Identify = 5, "Measure the frequency response of the position loop in place",
    CalibrateFlats = 6, "Hold `hold_angle` and collect probed flats",
    CalibrateToroid = 7, "Hold `hold_angle` and collect the probed toroid",
} }

enumeration! { State, "What the controller is doing" {
    Idle = 1, "No torque",
    Hold = 2, "Moves to `hold_angle` and holds it",
    Approach = 3, "Moves onto the path",
    Ready = 4, "Follows the path, learns nothing",
    Track = 5, "Follows the path and learns",
    Identify = 6, "Measures its frequency response",
    Calibrate = 7, "Holds `hold_angle` for a calibration",
    Fault = 8, "No torque; the mode Off ends it",
} }

enumeration! { Fault, "Why the controller is in the fault state" {
    None = 1, "No fault",
    FollowingError = 2, "The arm was more than `limit.following_error` behind",
    Infeasible = 3, "The path needs more than `limit.torque_share` of `servo.torque_max`",
    OutsideTable = 4, "The slide is where the path has no table",
    InvalidInput = 5, "An angle or position is NaN, infinite or absurd",
} }

enumeration! { Status, "How the calibration goes" {
    None = 1, "Nothing was fitted",
    Solved = 2, "The last fit succeeded",
    TooFewSamples = 3, "There are not enough samples for a fit",
    NotObservable = 4, "The samples do not tell the parameters apart",
    NotConverged = 5, "The fit did not come to an end",
    NoCut = 6, "A sample was left out: `calibration.cut` was never set before",
    Moved = 7, "A sample was left out: during the cut the slide (toroid) or the arm (flats) moved",
    InvalidProbe = 8, "A sample was left out: the probe reading is NaN, infinite or absurd",
    Full = 9, "A sample was left out: 512 are stored",
} }

enumeration! { SurfaceKind, "What kind of surface is cut" {
    Toric = 1, "Toric with two principal curvatures and tilt",
    Wave = 2, "One harmonic of the tool depth, for cuts in air",
    File = 3, "Table from `path.file`",
} }

/// Parameters that follow from others.
#[derive(Clone, Serialize, Deserialize)]
pub struct Calculated {
    /// Of the measurement of the frequency response.
    pub identify: CalculatedIdentify,
}

/// Parameters of the measurement of the frequency response that follow from others.
#[derive(Clone, Serialize, Deserialize)]
pub struct CalculatedIdentify {
    /// Time of the measurement, s.
    pub duration: f64,
}

/// All variables of the FMU.
#[derive(Clone, Serialize, Deserialize)]
pub struct Vars {
    /// Inputs of the law.
    pub input: Input,
    /// Outputs of the law.
    pub output: Output,
    /// Parameters of the law.
    pub parameters: Parameters,
    /// Texts among the parameters.
    pub text: Texts,
    /// Parameters that follow from others.
    pub calculated: Calculated,
}

impl Start for Vars {
    const START: Self = Self {
        input: Input::START,
        output: Output::START,
        parameters: Parameters::DEFAULT,
        text: Texts::EMPTY,
        calculated: Calculated { identify: CalculatedIdentify { duration: 0.0 } },
    };
}

/// Unit of a curvature.
const PER_METRE: Unit = Unit::si("1/m", [0, -1, 0, 0, 0], &[]);
/// Unit of an inertia.
const KILOGRAM_METRE_SQUARED: Unit = Unit::si("kg.m2", [1, 2, 0, 0, 0], &[]);
/// Unit of a viscous friction.
const NEWTON_METRE_SECOND: Unit = Unit::si("N.m.s/rad", [1, 2, -1, 0, -1], &[]);

/// The FMU.
pub struct Fts;

impl Model for Fts {
    const INFO: Info = Info {
        name: "RotaryFastToolServo",
        identifier: "fmu_fts",
        description: "Drives the arm of a rotary fast tool servo that turns toric lenses (Ludwick, Chargin, \
                      Calzaretta and Trumper, 1999)",
        state_version: 1,
        stop_time: 2.0,
        step_size: 1e-4,
        ..fmi2_export::package!()
    };
    type Vars = Vars;
    type State = Controller;

    #[rustfmt::skip]
    const VARIABLES: &'static [Variable<Vars>] = &[
        // inputs
        real!(Vars.input => arm_angle).input().unit(&RADIAN).display("deg").accepts_nan().describe("Encoder angle b of the arm from its index"),
        real!(Vars.input => spindle_angle).input().unit(&RADIAN).display("deg").accepts_nan().describe("Spindle angle theta, wrapped or unwrapped"),
        real!(Vars.input => slide_position).input().unit(&METRE).display("mm").accepts_nan().describe("Reading x of the cross slide"),
        choice!(Vars.input => mode: Mode).input().describe("What is asked for"),
        boolean!(Vars.input => feedforward.enable).input().describe("Pre-shift the path by the frequency response of the position loop"),
        boolean!(Vars.input => afc.enable).input().describe("Cancel harmonics of the error; false also forgets what was learned"),
        boolean!(Vars.input => afc.reset).input().describe("Rising edge forgets what the cancellation has learned"),
        real!(Vars.input => hold_angle).input().unit(&RADIAN).display("deg").accepts_nan().describe("Encoder angle b to be held in Hold, Identify and the calibrations"),
        real!(Vars.input => probe.depth).input().unit(&METRE).display("mm").accepts_nan().describe("Depth reading p of the probe, positive into the part"),
        real!(Vars.input => probe.lateral).input().unit(&METRE).display("mm").accepts_nan().describe("Distance l of the probe from the spindle axis, negative on its other side"),
        boolean!(Vars.input => probe.capture).input().describe("Rising edge stores a probed sample; while it stays, one more every `probe.pitch` of way"),
        boolean!(Vars.input => calibration.cut).input().describe("The tool cuts the part that will be probed: the arm moves with `calibration.sweep_speed`, arm angle and slide position are averaged"),
        boolean!(Vars.input => calibration.solve).input().describe("Rising edge fits the stored samples"),
        // outputs
        real!(Vars.output => torque).output().unit(&NEWTON_METRE).describe("Torque command"),
        choice!(Vars.output => state: State).output().describe("What the controller is doing"),
        choice!(Vars.output => fault: Fault).output().describe("Why it is in the state Fault"),
        real!(Vars.output => reference.depth).output().unit(&METRE).display("um").describe("Wanted depth z of the tool-nose centre below the arm axis, eq. 2"),
        real!(Vars.output => reference.angle).output().unit(&RADIAN).display("deg").describe("Wanted encoder angle b_d = asin(z / R_a) - b_0"),
        real!(Vars.output => error.tracking).output().unit(&METRE).display("um").describe("Tracking error at the tool, R_a cos(phi) (b_d - b)"),
        real!(Vars.output => error.rms).output().unit(&METRE).display("um").describe("Root mean square of the tracking error over the last full turn"),
        real!(Vars.output => error.peak).output().unit(&METRE).display("um").describe("Largest tracking error of the last full turn"),
        real!(Vars.output => error.harmonic[signals::ERROR_HARMONICS]).output().unit(&METRE).display("um").describe("Amplitude of a spindle harmonic of the tracking error in the last full turn"),
        real!(Vars.output => spindle_speed).output().unit(&RADIAN_PER_SECOND).display("rpm").describe("Estimated spindle speed"),
        boolean!(Vars.output => saturated).output().describe("The torque is at its limit"),
        boolean!(Vars.output => afc.frozen).output().describe("The cancellation learns nothing at present"),
        real!(Vars.output => path.torque).output().unit(&NEWTON_METRE).describe("Torque that the path needs somewhere at the present speed"),
        real!(Vars.output => path.truncation).output().unit(&METRE).display("nm").describe("Largest depth that the harmonics of the table leave out"),
        choice!(Vars.output => calibration.status: Status).output().describe("How the calibration goes"),
        real!(Vars.output => calibration.arm_length).output().unit(&METRE).display("mm").describe("Calibrated arm length R_a"),
        real!(Vars.output => calibration.centre_offset).output().unit(&METRE).display("mm").describe("Calibrated cross-slide offset x_0"),
        real!(Vars.output => calibration.arm_zero).output().unit(&RADIAN).display("deg").describe("Calibrated arm offset angle b_0"),
        real!(Vars.output => calibration.arm_length_sigma).output().unit(&METRE).display("um").describe("Standard deviation of the arm length"),
        real!(Vars.output => calibration.centre_offset_sigma).output().unit(&METRE).display("um").describe("Standard deviation of the cross-slide offset"),
        real!(Vars.output => calibration.arm_zero_sigma).output().unit(&RADIAN).display("deg").describe("Standard deviation of the arm offset angle"),
        real!(Vars.output => calibration.residual).output().unit(&METRE).display("um").describe("Root mean square of the residuals of the last fit"),
        integer!(Vars.output => calibration.samples).output().describe("Stored samples"),
        real!(Vars.output => response.bandwidth).output().unit(&RADIAN_PER_SECOND).display("Hz").describe("-3 dB frequency of the response in use; 0 if it is beyond the table"),
        real!(Vars.output => response.phase_margin).output().unit(&RADIAN).display("deg").describe("Phase margin that follows from the response in use"),
        real!(Vars.output => response.sensitivity_peak).output().unit(&ONE).describe("Largest magnitude of the sensitivity 1 - T that follows from the response in use"),
        real!(Vars.output => response.frequency[signals::RESPONSE_POINTS]).output().unit(&RADIAN_PER_SECOND).display("Hz").describe("Frequency of a point of the response in use (nominal, from `response.file` or identified); 0 if there is none"),
        real!(Vars.output => response.magnitude[signals::RESPONSE_POINTS]).output().unit(&ONE).describe("Magnitude of T, set-point to arm angle, at this frequency"),
        real!(Vars.output => response.phase[signals::RESPONSE_POINTS]).output().unit(&RADIAN).display("deg").describe("Phase of T at this frequency, without jumps"),
        real!(Vars.output => identify.progress).output().unit(&ONE).describe("Part of the measurement of the response that is over"),
        // machine
        real!(Vars.parameters => sample_period).parameter().unit(&SECOND).display("us").range(2e-5, 1e-3).describe("Sample period T_s"),
        integer!(Vars.parameters => tool.selected).parameter().range_int(1, 2).describe("Tool in use"),
        real!(Vars.parameters => tool.arm_length[2]).parameter().unit(&METRE).display("mm").range(0.02, 0.5).describe("Arm length R_a of each tool"),
        real!(Vars.parameters => tool.arm_zero[2]).parameter().unit(&RADIAN).display("deg").range(-7.0, 7.0).describe("Arm offset angle b_0 of each tool: angle out of the plane through the arm axis at the encoder index"),
        real!(Vars.parameters => tool.centre_offset[2]).parameter().unit(&METRE).display("mm").range(-2.0, 2.0).describe("Cross-slide reading x_0 at which the arm axis is above the spindle axis, for each tool"),
        real!(Vars.parameters => tool.nose_radius[2]).parameter().unit(&METRE).display("mm").range(0.0, 0.02).describe("Nose radius R_t of each tool"),
        real!(Vars.parameters => tool.arm_length_sigma[2]).parameter().unit(&METRE).display("um").range(1e-9, 1e-3).describe("Standard deviation of the arm length of each tool, where flats are fitted without a toroid before"),
        real!(Vars.parameters => tool.nose_radius_sigma[2]).parameter().unit(&METRE).display("um").range(0.0, 1e-3).describe("Standard deviation of the nose radius of each tool"),
        // path
        choice!(Vars.parameters => surface.kind: SurfaceKind).parameter().describe("What kind of surface is cut"),
        real!(Vars.parameters => surface.base_curvature).parameter().unit(&PER_METRE).range(-50.0, 50.0).describe("Curvature along Y (spindle angle pi/2), concave is positive; dioptres over 0.53"),
        real!(Vars.parameters => surface.cross_curvature).parameter().unit(&PER_METRE).range(-50.0, 50.0).describe("Curvature along X (spindle angle 0), concave is positive; dioptres over 0.53"),
        real!(Vars.parameters => surface.tilt_x).parameter().unit(&ONE).range(-0.5, 0.5).describe("Slope along X (prism)"),
        real!(Vars.parameters => surface.tilt_y).parameter().unit(&ONE).range(-0.5, 0.5).describe("Slope along Y (prism)"),
        real!(Vars.parameters => surface.wave_amplitude).parameter().unit(&METRE).display("um").range(0.0, 0.05).describe("Amplitude of the wave"),
        integer!(Vars.parameters => surface.wave_harmonic).parameter().range_int(1, 64).describe("Waves per turn"),
        real!(Vars.parameters => surface.inner_radius).parameter().unit(&METRE).display("mm").range(0.0, 0.5).describe("Distance from the spindle axis where the cut ends"),
        real!(Vars.parameters => surface.outer_radius).parameter().unit(&METRE).display("mm").range(1e-3, 0.5).describe("Distance from the spindle axis where the cut begins"),
        boolean!(Vars.parameters => surface.depth_auto).parameter().describe("Place the part so that the arm works about the plane of its axis"),
        real!(Vars.parameters => surface.depth).parameter().unit(&METRE).display("mm").range(-0.2, 0.2).describe("Depth z_c of the nose centre at the spindle axis, used without `surface.depth_auto`"),
        integer!(Vars.parameters => path.harmonics).parameter().range_int(1, 64).describe("Harmonics N of eq. 2"),
        real!(Vars.parameters => path.grid).parameter().unit(&METRE).display("mm").range(1e-4, 5e-3).describe("Grid of the look-up table in the slide position"),
        text!(Vars.text => path.file).parameter().describe("JSON table of the path, in the folder resources of the FMU or with its whole path; for `surface.kind` = File"),
        // position loop
        real!(Vars.parameters => servo.bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(62.8, 3142.0).describe("Wanted -3 dB bandwidth of the position loop"),
        real!(Vars.parameters => servo.lead).parameter().unit(&ONE).range(1.5, 10.0).describe("Crossover over zero and pole over crossover of the lead"),
        real!(Vars.parameters => servo.lag).parameter().unit(&ONE).range(3.0, 1e3).describe("Crossover over the zero of the integrator"),
        real!(Vars.parameters => servo.roll_off).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(1e3, 31_400.0).describe("Roll-off of the compensator"),
        real!(Vars.parameters => servo.inertia).parameter().unit(&KILOGRAM_METRE_SQUARED).range(1e-7, 10.0).describe("Nominal inertia J of the whole moving arm"),
        real!(Vars.parameters => servo.viscous_friction).parameter().unit(&NEWTON_METRE_SECOND).range(0.0, 10.0).describe("Nominal viscous friction"),
        real!(Vars.parameters => servo.dry_friction).parameter().unit(&NEWTON_METRE).range(0.0, 10.0).describe("Dry friction that is fed forward with the sign of the wanted speed; 0 for none"),
        real!(Vars.parameters => servo.torque_max).parameter().unit(&NEWTON_METRE).range(1e-3, 1e4).describe("Largest torque"),
        real!(Vars.parameters => servo.current_bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(600.0, 1e6).describe("Bandwidth of the current loop"),
        integer!(Vars.parameters => servo.io_delay).parameter().range_int(0, 8).describe("Samples between a command and its action; 1 for a standard master, 0 if the command acts at once"),
        real!(Vars.parameters => tip.frequency).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(0.0, 1e5).describe("Natural frequency of the arm on the locked hub; 0 for a rigid arm"),
        real!(Vars.parameters => tip.inertia).parameter().unit(&ONE).range(0.0, 0.95).describe("Part of the inertia beyond the flexure"),
        real!(Vars.parameters => tip.damping).parameter().unit(&ONE).range(0.0, 0.5).describe("Damping ratio of the arm on the locked hub"),
        boolean!(Vars.parameters => tip.compensation).parameter().describe("Move the hub so that the tool, not the hub, is on the path"),
        // feedforward and cancellation
        integer!(Vars.parameters => feedforward.harmonics).parameter().range_int(0, 64).describe("Harmonics that are pre-shifted; 0 for none, else at least those of the path"),
        text!(Vars.text => response.file).parameter().describe("JSON table of the frequency response, in the folder resources of the FMU or with its whole path; empty for the response of the nominal loop"),
        text!(Vars.text => afc.harmonics).parameter().start_text(Harmonics::DEFAULT_TEXT).describe("Cancelled harmonics of the spindle: numbers and ranges like `2, 4, 6` or `1-24`, up to 64"),
        boolean!(Vars.parameters => afc.automatic).parameter().describe("Of `afc.harmonics`, cancel only what repeats from turn to turn"),
        real!(Vars.parameters => afc.tau).parameter().unit(&SECOND).range(0.01, 100.0).describe("Time constant tau of each cancelled harmonic"),
        boolean!(Vars.parameters => afc.phase_advance).parameter().describe("Advance each resonator by the phase of the position loop; without it eq. 3 as printed, unstable above some speed"),
        real!(Vars.parameters => afc.speed_min).parameter().unit(&RADIAN_PER_SECOND).display("rpm").range(0.0, 1e3).describe("Spindle speed below which nothing is learned"),
        real!(Vars.parameters => afc.frequency_max).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(62.8, 31_400.0).describe("Harmonics above this frequency are left alone"),
        real!(Vars.parameters => pll.bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(1.0, 1e3).describe("Natural frequency of the loop that estimates the spindle speed"),
        // motion and limits
        real!(Vars.parameters => approach.time).parameter().unit(&SECOND).range(0.01, 60.0).describe("Time of the motion onto the path"),
        real!(Vars.parameters => hold.speed).parameter().unit(&RADIAN_PER_SECOND).range(1e-4, 100.0).describe("Largest speed of the motion to `hold_angle`"),
        real!(Vars.parameters => limit.following_error).parameter().unit(&METRE).display("um").range(1e-6, 0.1).describe("Following error at the tool that is a fault"),
        real!(Vars.parameters => limit.torque_share).parameter().unit(&ONE).range(0.1, 1.0).describe("Part of `servo.torque_max` that a path may need"),
        // identification
        text!(Vars.text => identify.frequencies).parameter().start_text(Frequencies::DEFAULT_TEXT).describe("Ascending frequencies at which the response is measured, Hz, at most 32"),
        real!(Vars.parameters => identify.amplitude).parameter().unit(&METRE).display("mm").range(1e-6, 0.05).describe("Amplitude of the tool; friction falsifies amplitudes below that of the job"),
        real!(Vars.parameters => identify.torque_share).parameter().unit(&ONE).range(0.01, 0.9).describe("Part of `servo.torque_max` that the swing may need"),
        real!(Vars.parameters => identify.acceleration_max).parameter().unit(&METRE_PER_SECOND_SQUARED).range(0.1, 1e5).describe("Largest acceleration of the tool"),
        real!(Vars.parameters => identify.glide_time).parameter().unit(&SECOND).range(1e-3, 10.0).describe("Time from one frequency to the next"),
        real!(Vars.parameters => identify.settle_time).parameter().unit(&SECOND).range(0.0, 10.0).describe("Time at a frequency before it is measured"),
        real!(Vars.parameters => identify.average_time).parameter().unit(&SECOND).range(1e-3, 100.0).describe("Least time that is averaged, in whole periods"),
        real!(Vars.calculated => identify.duration).calculated().unit(&SECOND).describe("Time that the measurement takes"),
        // calibration
        real!(Vars.parameters => probe.radius).parameter().unit(&METRE).display("mm").range(0.0, 0.02).describe("Radius R_p of the probe ball"),
        real!(Vars.parameters => probe.radius_sigma).parameter().unit(&METRE).display("um").range(0.0, 1e-3).describe("Standard deviation of the radius of the probe ball"),
        real!(Vars.parameters => probe.depth_sigma).parameter().unit(&METRE).display("nm").range(1e-9, 1e-3).describe("Standard deviation of a depth reading on a cut surface"),
        real!(Vars.parameters => probe.lateral_sigma).parameter().unit(&METRE).display("nm").range(1e-9, 1e-3).describe("Standard deviation of the lateral position of the probe"),
        real!(Vars.parameters => probe.cusp_sigma).parameter().unit(&METRE).display("um").range(1e-9, 0.1).describe("Standard deviation of the zero of the lateral position on the spindle axis; a toroid probed on both sides finds it"),
        real!(Vars.parameters => probe.pitch).parameter().unit(&METRE).display("um").range(1e-6, 0.1).describe("Way of the probe between two samples of one capture"),
        real!(Vars.parameters => calibration.arm_angle_sigma).parameter().unit(&RADIAN).range(1e-9, 1e-2).describe("Standard deviation of the arm angle of a flat"),
        real!(Vars.parameters => calibration.sweep_speed).parameter().unit(&RADIAN_PER_SECOND).range(1e-4, 1.0).describe("Speed of the arm towards `hold_angle` while a calibration part is cut"),
    ];

    fn period(vars: &Vars) -> f64 {
        vars.parameters.sample_period
    }

    fn calculate(vars: &mut Vars) {
        if let Ok(frequencies) = vars.text.identify.frequencies.parse() {
            vars.parameters.identify.frequencies = frequencies;
            vars.calculated.identify.duration = identify::duration(&vars.parameters);
        }
    }

    fn initialise(vars: &mut Vars, env: &mut Env) -> Result<Controller, Error> {
        let text = |error: ParameterError| error.to_string();
        vars.parameters.identify.frequencies = vars.text.identify.frequencies.parse().map_err(text)?;
        vars.parameters.afc.harmonics = vars.text.afc.harmonics.parse().map_err(text)?;
        let tables = vars.text.tables(&vars.parameters, env.resources()).map_err(text)?;
        let controller = Controller::new(&vars.parameters, &tables).map_err(text)?;
        vars.output.path.truncation = controller.path().truncation;
        messages::warn_of_truncation(vars, env);
        Ok(controller)
    }

    fn tick(vars: &mut Vars, controller: &mut Controller, env: &mut Env) -> Result<(), Error> {
        let before = vars.output.state;
        controller.tick(&vars.parameters, &vars.input, &mut vars.output);
        if vars.output.state != before {
            messages::tell_state(vars, env);
        }
        Ok(())
    }
}

export!(Fts);

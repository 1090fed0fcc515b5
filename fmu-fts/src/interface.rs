//! Every variable of the FMU, told once. Sources: "paper" = Ludwick, Chargin, Calzaretta and Trumper (1999);
//! "derived" = follows from the equations; "our choice" = the paper is silent.

pub use variables::*;

#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use std::f64::consts::{PI, TAU};

    use control_blocks::DELAY_MAX;
    use fmi2_export::Unit;
    use fmi2_export::units::{METRE, METRE_PER_SECOND, METRE_PER_SECOND_SQUARED, NEWTON_METRE, ONE, RADIAN};
    use fmi2_export::units::{RADIAN_PER_SECOND, RADIAN_PER_SECOND_SQUARED, SECOND};

    use crate::lists::frequencies::{COUNT_MAX, Frequencies};
    use crate::lists::harmonics::Harmonics;
    use crate::monitoring::numbers::Numbers;

    /// Harmonics of the tracking error that are reported.
    pub const ERROR_HARMONICS: usize = 24;
    const PER_METRE: Unit = Unit::si("1/m", [0, -1, 0, 0, 0], &[]);
    const KILOGRAM_METRE_SQUARED: Unit = Unit::si("kg.m2", [1, 2, 0, 0, 0], &[]);
    const NEWTON_METRE_SECOND: Unit = Unit::si("N.m.s/rad", [1, 2, -1, 0, -1], &[]);

    /// What is asked for
    pub enum Mode {
        /// Leave the path and the part, then no torque
        Idle,
        /// Hold `hold_angle`
        Hold,
        /// Get onto the path and follow it without learning
        Approach,
        /// Follow the path and cancel what repeats; gets onto the path first
        Track,
        /// Measure the frequency response of the position loop in place
        Identify,
        /// Hold `hold_angle` and collect probed flats
        CalibrateFlats,
        /// Hold `hold_angle` and collect the probed toroid
        CalibrateToroid,
        /// Hold `hold_angle` and collect the probed lens
        CalibrateForm,
    }
    /// What the controller is doing
    pub enum State {
        /// No torque
        Idle,
        /// Moves to `hold_angle` and holds it
        Hold,
        /// Moves onto the path
        Approach,
        /// Follows the path, learns nothing
        Ready,
        /// Follows the path and learns
        Track,
        /// Measures its frequency response
        Identify,
        /// Holds `hold_angle` for a calibration
        Calibrate,
        /// Stopped for the reason that `fault` gives: out of the part where the arm obeys, else without torque; `reset_fault` ends it once the arm is there
        Fault,
        /// The slide has left the table at least a row from where the path was joined, the cut is finished: holds the tool out of the
        /// part
        Done,
        /// No job is asked for any more: leaves the path and the part, or stops beside them; `Idle` comes next
        Retract,
        /// Measures its machine with small swings where the arm stands
        Commission,
    }
    /// Why the controller is in the fault state
    pub enum Fault {
        /// No fault
        None,
        /// The arm was more than `limits.following_error` from where it should be, though drive and encoder answer
        #[hint("free the arm, or allow more `limits.following_error`")] FollowingError,
        /// The path needs more than `limits.torque_share` of `servo.torque_max`
        #[hint("turn slower, or end the cut at a smaller `surface.outer_radius`")] Infeasible,
        /// The slide is where the path has no table
        #[hint("move the slide between `surface.outer_radius` and `surface.inner_radius`, or to the rows of `path.file`")] OutsideTable,
        /// `hold_angle` is NaN, infinite or absurd
        #[hint("check what is wired to `hold_angle`")] InvalidInput,
        /// The arm encoder gives NaN, infinite or absurd readings
        #[hint("check the arm encoder and its link")] LostReading,
        /// The arm encoder stands though the arm must move
        #[hint("check the arm encoder; communicate in steps of `sample_period`; with an arm that sticks, allow more `limits.disturbance`")] FrozenReading,
        /// The arm encoder reads where the arm cannot be
        #[hint("check the arm encoder and its link, what has hit the arm, and `servo.inertia` and `tip.*`; with a coarse or noisy encoder allow more `limits.arm_spread`")] ReadingJump,
        /// The spindle encoder gives NaN, infinite or absurd readings while the path needs it
        #[hint("check the spindle encoder and its link")] LostSpindle,
        /// The slide encoder gives NaN, infinite or absurd readings while the path needs it
        #[hint("check the slide encoder and its link")] LostSlide,
        /// The torque was at its limit for too long
        #[hint("turn slower, or look for what is in the way of the arm")] Saturation,
        /// The arm accelerates against the torque
        #[hint("swap the sign of the torque, or of the arm encoder")] DriveSign,
        /// The arm does less than `limits.drive_share` of what the torque should do
        #[hint("check amplifier and motor, `servo.inertia`, and the arm encoder")] WeakDrive,
        /// The torque goes from one limit to the other again and again
        #[hint("the loop is not stable: check `tip.*`, `io_delay`, `servo.inertia`, or wish for less `servo.bandwidth`")] Oscillation,
        /// The job comes to no end, or the cancellation to no small error
        #[hint("check the drive, or allow more `limits.job_time` or `limits.tracking_error`")] NoProgress,
        /// A step of the importer is longer than a sample: several samples have the same inputs, and of their commands the last alone is seen
        #[hint("co-simulation: set the communication step to `sample_period`; model exchange: the importer has to stop at every time event")] LongStep,
        /// The error grows from turn to turn: the cut or the cancellation is not stable
        #[hint("cut less deep or at another speed; check `servo.inertia`, `io_delay` and `response.file`, or allow more `afc.tau`")] Divergence,
        /// The spindle encoder reads where the spindle cannot be while the path needs it
        #[hint("check the spindle encoder; communicate in steps of `sample_period`; with a coarse or quick spindle, allow more `limits.spindle_spread` or `limits.spindle_acceleration`")] SpindleJump,
        /// The spindle encoder stands though the spindle must turn, while the path needs it
        #[hint("check the spindle encoder, or allow more `limits.spindle_acceleration` to a spindle that is stopped; communicate in steps of `sample_period`")] FrozenSpindle,
        /// The slide encoder reads where the slide cannot be while the path needs it
        #[hint("check the slide encoder, or allow more `limits.slide_speed`")] SlideJump,
        /// The slide encoder stands, or does not go on with `limits.feed`, while the path needs it
        #[hint("check the slide encoder; set `limits.feed` to 0 if the slide may stand")] FrozenSlide,
        /// What the commission has measured is not sure enough, or not what this controller can hold
        #[hint("allow more `commission.torque`, `commission.travel` or `limits.following_error`, look for play and vibration, and check the arm encoder, `servo.inertia`, `servo.current_bandwidth`, `tip.*` and `io_delay`")] CommissionRejected,
    }
    /// How the calibration goes
    pub enum Status {
        /// Nothing was fitted
        None,
        /// The last fit succeeded
        Solved,
        /// There are not enough samples for a fit
        TooFewSamples,
        /// The samples do not tell the parameters apart
        NotObservable,
        /// The fit did not come to an end
        NotConverged,
        /// A sample was left out: `calibration.cut` was never set before
        NoCut,
        /// A sample was left out: during the cut the slide (toroid) or the arm (flats) moved
        Moved,
        /// A sample was left out: the probe reading is NaN, infinite or absurd
        InvalidProbe,
        /// A sample was left out: 512 are stored
        Full,
        /// A sample was left out: the probe is where the path has no table
        OutsidePath,
        /// The correction would be more than `form.depth_max` somewhere: no error of the form
        NotForm,
        /// The correction would be less sure than `form.deviation_max`
        Unsure,
    }
    /// Which law is in force
    pub enum Law {
        /// What a good engineer would ship: 24 harmonics with phase advance, flexure of the arm compensated
        Default,
        /// The law as printed, where a parameter was not set
        Paper,
    }
    /// What kind of surface is cut
    pub enum SurfaceKind {
        /// Toric with two principal curvatures and tilt
        Toric,
        /// One harmonic of the tool depth, for cuts in air
        Wave,
        /// Table from `path.file`
        File,
    }
    /// Inputs, sampled at the start of the tick.
    #[inputs] pub struct Input {
        /// Encoder angle b of the arm from its index
        #[var(unit = RADIAN as "deg", accepts_nan)] pub arm_angle: f64,
        /// Spindle angle theta, wrapped or unwrapped
        #[var(unit = RADIAN as "deg", accepts_nan)] pub spindle_angle: f64,
        /// Reading x of the cross slide
        #[var(unit = METRE as "mm", accepts_nan)] pub slide_position: f64,
        /// The controller may act; false is the mode `Idle`: off the path and out of the part, then no torque
        pub enable: bool,
        /// What is asked for; acts while `enable` is true
        pub mode: Mode,
        /// Rising edge after the first sample measures the machine from `Idle` or `Done`, once the arm is known and at rest; false, a rising edge of `enable` or another `mode` breaks off: stop, `Idle`
        pub commission: bool,
        /// Rising edge ends a fault, once the arm is out of the part or the drive off; the next job begins when `mode` changes or `enable` rises anew
        pub reset_fault: bool,
        /// Pre-shift the path by the frequency response of the position loop
        #[var(name = "feedforward.enable", start = true)] pub feedforward_enable: bool,
        /// Cancel harmonics of the error; false also forgets what was learned
        #[var(name = "afc.enable", start = true)] pub afc_enable: bool,
        /// Rising edge forgets what the cancellation has learned
        #[var(name = "afc.reset")] pub afc_reset: bool,
        /// Encoder angle b to be held in Hold, Identify and the calibrations
        #[var(unit = RADIAN as "deg", accepts_nan)] pub hold_angle: f64,
        pub probe: ProbeInput,
        pub calibration: CalibrationInput,
    }
    /// Depth probe, for the calibration.
    pub struct ProbeInput {
        /// Depth reading p of the probe, positive into the part
        #[var(unit = METRE as "mm", accepts_nan)] pub depth: f64,
        /// Distance l of the probe from the spindle axis, negative on its other side
        #[var(unit = METRE as "mm", accepts_nan)] pub lateral: f64,
        /// Angle of the spindle to which the part is turned for the probe; of a lens
        #[var(unit = RADIAN as "deg", accepts_nan)] pub angle: f64,
        /// Rising edge stores a probed sample; while it stays, one more every `probe.pitch` of way
        pub capture: bool,
    }
    /// Commands of the calibration.
    pub struct CalibrationInput {
        /// The tool cuts the part that will be probed: the arm moves with `calibration.sweep_speed`; its angle and the slide position are averaged
        pub cut: bool,
        /// Rising edge fits the stored samples
        pub solve: bool,
    }
    /// Outputs; always finite.
    #[outputs] pub struct Output {
        /// Torque command
        #[var(unit = NEWTON_METRE)] pub torque: f64,
        pub state: State,
        /// Why it is in the state Fault
        pub fault: Fault,
        /// The drive may be on; false from a fault that ends without torque until it is reset
        #[var(start = true)] pub drive_enable: bool,
        pub reference: ReferenceOutput,
        pub error: ErrorOutput,
        /// Estimated spindle speed
        #[var(unit = RADIAN_PER_SECOND as "rpm")] pub spindle_speed: f64,
        /// Acceleration of the arm over that of the torque in the last 10 ms; 1 while the torque is too small to tell
        #[var(unit = ONE, start = 1.0)] pub drive_share: f64,
        /// The torque is at its limit
        pub saturated: bool,
        /// The cancellation learns nothing at present
        #[var(name = "afc.frozen", start = true)] pub afc_frozen: bool,
        /// Torque that the path needs somewhere at the present speed
        #[var(name = "path.torque", unit = NEWTON_METRE)] pub path_torque: f64,
        /// Torque that the path takes over that which the response in use says, as learned; 1 before, and without `feedforward.adaptive`
        #[var(name = "path.torque_share", unit = ONE, start = 1.0)] pub path_torque_share: f64,
        /// Largest depth that the harmonics of the table leave out
        #[var(name = "path.truncation", unit = METRE as "nm")] pub path_truncation: f64,
        pub calibration: CalibrationOutput,
        pub form: FormOutput,
        pub response: ResponseOutput,
        pub measured: Measured,
        /// Part of the measurement of the response that is over, 0 to 1
        #[var(name = "identify.progress", unit = ONE)] pub identify_progress: f64,
        /// Numbers of the monitors, which are told with a fault.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
    }
    /// Where the tool should be, before feedforward and cancellation.
    pub struct ReferenceOutput {
        /// Wanted depth z of the tool-nose centre below the arm axis, eq. 2; `arm_delay` samples ago, as the reading of the arm
        #[var(unit = METRE as "um")] pub depth: f64,
        /// Wanted encoder angle b_d = asin(z / R_a) - b_0
        #[var(unit = RADIAN as "deg")] pub angle: f64,
    }
    /// Tracking error at the tool.
    pub struct ErrorOutput {
        /// Tracking error at the tool, R_a cos(phi) (b_d - b)
        #[var(unit = METRE as "um")] pub tracking: f64,
        /// Root mean square of the tracking error over the last full turn
        #[var(unit = METRE as "um")] pub rms: f64,
        /// Largest tracking error of the last full turn
        #[var(unit = METRE as "um")] pub peak: f64,
        /// Amplitude of a spindle harmonic of the tracking error in the last full turn
        #[var(unit = METRE as "um")] pub harmonic: [f64; ERROR_HARMONICS],
    }
    /// Result of the calibration, for the selected tool.
    pub struct CalibrationOutput {
        pub status: Status,
        /// Calibrated arm length R_a
        #[var(unit = METRE as "mm")] pub arm_length: f64,
        /// Calibrated cross-slide offset x_0
        #[var(unit = METRE as "mm")] pub centre_offset: f64,
        /// Calibrated arm offset angle b_0
        #[var(unit = RADIAN as "deg")] pub arm_zero: f64,
        /// Standard deviation of the arm length
        #[var(unit = METRE as "um")] pub arm_length_sigma: f64,
        /// Standard deviation of the cross-slide offset
        #[var(unit = METRE as "um")] pub centre_offset_sigma: f64,
        /// Standard deviation of the arm offset angle
        #[var(unit = RADIAN as "deg")] pub arm_zero_sigma: f64,
        /// Root mean square of the residuals of the last fit
        #[var(unit = METRE as "um")] pub residual: f64,
        /// Stored samples
        pub samples: i32,
    }
    /// Form of the lens that was probed last, and what the path is corrected by.
    pub struct FormOutput {
        /// Error of the form: what of the probed depths is smooth, root mean square without the mean
        #[var(unit = METRE as "um")] pub error: f64,
        /// Largest depth of the correction that it asks for
        #[var(unit = METRE as "um")] pub largest: f64,
        /// Standard deviation of that correction, root mean square over what was probed
        #[var(unit = METRE as "um")] pub deviation: f64,
        /// The path that was followed last, or is, is corrected
        pub corrected: bool,
    }
    /// Frequency response of the position loop that is in use: nominal, from `response.file` or identified.
    pub struct ResponseOutput {
        /// -3 dB frequency of the response in use; 0 if it is beyond the table
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub bandwidth: f64,
        /// Phase margin that follows from the response in use
        #[var(unit = RADIAN as "deg")] pub phase_margin: f64,
        /// Largest magnitude of the sensitivity 1 - T that follows from the response in use
        #[var(unit = ONE)] pub sensitivity_peak: f64,
        /// Natural frequency of the arm on the locked hub that is compensated: `tip.frequency`, or as the response tells it
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub tip_frequency: f64,
        /// Damping ratio of it: `tip.damping`, or as the response tells it
        #[var(unit = ONE)] pub tip_damping: f64,
        /// Standard deviation of that frequency; 0 while it is `tip.frequency`
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub tip_sigma: f64,
        /// Frequency of a point of the response in use (nominal, from `response.file` or identified); 0 if there is none
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub frequency: [f64; COUNT_MAX],
        /// Magnitude of T, set-point to arm angle, at this frequency
        #[var(unit = ONE)] pub magnitude: [f64; COUNT_MAX],
        /// Phase of T at this frequency, without jumps
        #[var(unit = RADIAN as "deg")] pub phase: [f64; COUNT_MAX],
    }
    /// What the commission has measured, each with its standard deviation; 0 before
    pub struct Measured {
        /// The last commission came to its end, and its results are good; false from the next one on
        pub valid: bool,
        /// Inertia that goes with the commanded torque: its ratio to the gain of the drive is what can be known
        #[var(unit = KILOGRAM_METRE_SQUARED)] pub inertia: f64,
        /// Its standard deviation
        #[var(unit = KILOGRAM_METRE_SQUARED)] pub inertia_deviation: f64,
        /// Viscous friction, in commanded torque as well
        #[var(unit = NEWTON_METRE_SECOND)] pub viscous_friction: f64,
        /// Its standard deviation
        #[var(unit = NEWTON_METRE_SECOND)] pub viscous_friction_deviation: f64,
        /// Dry friction, in commanded torque as well
        #[var(unit = NEWTON_METRE)] pub dry_friction: f64,
        /// Its standard deviation
        #[var(unit = NEWTON_METRE)] pub dry_friction_deviation: f64,
        /// Samples between a command and its reading, not rounded, without half a sample of hold and the current loop of
        /// `servo.current_bandwidth`; a late encoder counts in it
        #[var(unit = ONE)] pub io_delay: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub io_delay_deviation: f64,
        /// Natural frequency of the arm on the locked hub; 0 for an arm that is told rigid
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub tip_frequency: f64,
        /// Its standard deviation
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub tip_frequency_deviation: f64,
        /// Part of the inertia beyond the flexure
        #[var(unit = ONE)] pub tip_inertia: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub tip_inertia_deviation: f64,
        /// Damping ratio of the arm on the locked hub
        #[var(unit = ONE)] pub tip_damping: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub tip_damping_deviation: f64,
    }
    /// Parameters.
    #[parameters] pub struct Parameters {
        pub law: Law,
        /// Sample period T_s
        #[var(unit = SECOND as "us", range = 2e-5..=1e-3, start = 1e-4, source = "paper: 10 kHz")] pub sample_period: f64,
        /// Samples between a command and its action; 1 for a standard master, 0 if the command acts at once
        #[var(range = 0..=DELAY_MAX as i32, start = 1, source = "our choice: what a standard master does")] pub io_delay: i32,
        /// Samples by which the reading of the arm is older than that of the spindle; with `io_delay` at most 8
        #[var(range = 0..=DELAY_MAX as i32, start = 0, source = "our choice: both encoders on one link")] pub arm_delay: i32,
        pub tool: Tool,
        pub surface: Surface,
        pub path: Path,
        pub servo: Servo,
        pub tip: Tip,
        /// Harmonics that are pre-shifted; 0 for none, else at least those of the path
        #[var(name = "feedforward.harmonics", range = 0..=64, start = 24, source = "derived: what the arc of the arm makes of 12")]
        pub feedforward_harmonics: i32,
        /// Learn in `Track` what torque the path takes, which every radius, feed and speed has in common; without it amplitudes are learned
        #[var(name = "feedforward.adaptive", start = true, paper = false, source = "our choice: the paper measures the response once")]
        pub feedforward_adaptive: bool,
        /// JSON table of the frequency response, in the folder resources or with its whole path; empty for the nominal loop
        #[var(name = "response.file")] pub response_file: String,
        pub afc: Afc,
        /// Natural frequency of the loop that estimates the spindle speed; the path uses the raw angle
        #[var(name = "pll.bandwidth", unit = RADIAN_PER_SECOND as "Hz", range = 1.0..=1e3, start = TAU * 20.0, source = "our choice: 20 Hz")]
        pub pll_bandwidth: f64,
        /// Time of the motion onto the path
        #[var(name = "approach.time", unit = SECOND, range = 0.01..=60.0, start = 0.3, source = "our choice")] pub approach_time: f64,
        /// Largest speed of the motion to `hold_angle`, which never takes less than `approach.time`
        #[var(name = "hold.speed", unit = RADIAN_PER_SECOND, range = 1e-4..=100.0, start = 2.0, source = "our choice")] pub hold_speed: f64,
        pub limits: Limits,
        pub identify: Identify,
        pub commission: Commission,
        pub probe: Probe,
        pub calibration: Calibration,
        pub form: Form,
    }
    /// The two tools of the double-ended arm; one calibration record each.
    pub struct Tool {
        /// Tool in use
        #[var(range = 1..=2, start = 1)] pub selected: i32,
        /// Arm length R_a of each tool
        #[var(unit = METRE as "mm", range = 0.02..=0.5, start = [0.08; 2], source = "paper")] pub arm_length: [f64; 2],
        /// Arm offset angle b_0 of each tool: angle out of the plane through the arm axis at the encoder index
        #[var(unit = RADIAN as "deg", range = -7.0..=7.0, start = [0.0523, 0.0523 - PI], source = "our choice: half a turn apart")] pub arm_zero: [f64; 2],
        /// Cross-slide reading x_0 at which the arm axis is above the spindle axis, for each tool
        #[var(unit = METRE as "mm", range = -2.0..=2.0, start = [0.15; 2], source = "our choice")] pub centre_offset: [f64; 2],
        /// Nose radius R_t of each tool
        #[var(unit = METRE as "mm", range = 0.0..=0.02, start = [0.002; 2], source = "our choice: usual diamond")] pub nose_radius: [f64; 2],
        /// Standard deviation of the arm length of each tool, where flats are fitted without a toroid before
        #[var(unit = METRE as "um", range = 1e-9..=1e-3, start = [1e-6; 2], source = "paper")] pub arm_length_sigma: [f64; 2],
        /// Standard deviation of the nose radius of each tool
        #[var(unit = METRE as "um", range = 0.0..=1e-3, start = [1e-7; 2], source = "our choice")] pub nose_radius_sigma: [f64; 2],
    }
    /// Surface to be cut.
    pub struct Surface {
        #[var(source = "paper")] pub kind: SurfaceKind,
        /// Curvature along Y (spindle angle pi/2), concave is positive; dioptres over 0.53
        #[var(unit = PER_METRE, range = -50.0..=50.0, source = "paper: 0x4, flat")] pub base_curvature: f64,
        /// Curvature along X (spindle angle 0), concave is positive; dioptres over 0.53
        #[var(unit = PER_METRE, range = -50.0..=50.0, start = 1.0 / 0.1325, source = "paper: 132.5 mm, concave")] pub cross_curvature: f64,
        /// Slope along X (prism)
        #[var(unit = ONE, range = -0.5..=0.5)] pub tilt_x: f64,
        /// Slope along Y (prism)
        #[var(unit = ONE, range = -0.5..=0.5)] pub tilt_y: f64,
        /// Amplitude of the wave
        #[var(unit = METRE as "um", range = 0.0..=0.05, start = 50.7e-6, source = "derived: 500 m/s2 at 500 Hz")] pub wave_amplitude: f64,
        /// Waves per turn
        #[var(range = 1..=64, start = 50, source = "derived: 500 Hz at 600 rpm")] pub wave_harmonic: i32,
        /// Distance from the spindle axis where the cut ends
        #[var(unit = METRE as "mm", range = 0.0..=0.5)] pub inner_radius: f64,
        /// Distance from the spindle axis where the cut begins
        #[var(unit = METRE as "mm", range = 1e-3..=0.5, start = 0.05, source = "paper: 100 mm parts")] pub outer_radius: f64,
        /// Place the part so that the arm works about the plane of its axis
        #[var(start = true, source = "our choice")] pub depth_auto: bool,
        /// Depth z_c of the nose centre at the spindle axis, used without `surface.depth_auto`
        #[var(unit = METRE as "mm", range = -0.2..=0.2)] pub depth: f64,
    }
    /// Look-up table of the tool path, eq. 2.
    pub struct Path {
        /// Harmonics N of eq. 2
        #[var(range = 1..=64, start = 12, source = "paper: 6 to 10; derived: 28 for 0x8 at the rim")] pub harmonics: i32,
        /// Grid of the look-up table in the slide position
        #[var(unit = METRE as "mm", range = 1e-4..=5e-3, start = 0.5e-3, source = "derived: 0.4 nm with cubic interpolation")] pub grid: f64,
        /// JSON table of the path, in the folder resources of the FMU or with its whole path; for `surface.kind` = File
        pub file: String,
    }
    /// Nominal arm and drive, and the lead-lag position loop designed for them.
    pub struct Servo {
        /// Wanted -3 dB bandwidth of the position loop
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 62.8..=3142.0, start = TAU * 230.0, source = "paper: 230 Hz")] pub bandwidth: f64,
        /// Crossover over zero and pole over crossover of the lead
        #[var(unit = ONE, range = 1.5..=10.0, start = 4.0, source = "our choice: 44 degrees left")] pub lead: f64,
        /// Crossover over the zero of the integrator
        #[var(unit = ONE, range = 3.0..=1e3, start = 10.0, source = "our choice")] pub lag: f64,
        /// Roll-off of the compensator
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 1e3..=31_400.0, start = TAU * 2500.0, source = "our choice: 2.5 kHz")] pub roll_off: f64,
        /// Nominal inertia J of the whole moving arm
        #[var(unit = KILOGRAM_METRE_SQUARED, range = 1e-7..=10.0, start = 8e-4, source = "our choice: 500 m/s2 needs 5 N.m")] pub inertia: f64,
        /// Nominal viscous friction
        #[var(unit = NEWTON_METRE_SECOND, range = 0.0..=10.0, start = 2e-3, source = "our choice")] pub viscous_friction: f64,
        /// Dry friction that is fed forward with the sign of the wanted speed; 0 for none
        #[var(unit = NEWTON_METRE, range = 0.0..=10.0, source = "our choice: it must be measured first")] pub dry_friction: f64,
        /// Largest torque
        #[var(unit = NEWTON_METRE, range = 1e-3..=1e4, start = 7.0, source = "our choice")] pub torque_max: f64,
        /// Bandwidth of the current loop
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 600.0..=1e6, start = TAU * 2000.0, source = "our choice: 2 kHz")] pub current_bandwidth: f64,
    }
    /// Flexure of the arm between encoder and tool.
    pub struct Tip {
        /// Natural frequency of the arm on the locked hub; 0 for a rigid arm
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=1e5, start = TAU * 1200.0, source = "our choice: 1.2 kHz")] pub frequency: f64,
        /// Part of the inertia beyond the flexure
        #[var(unit = ONE, range = 0.0..=0.95, start = 0.4375, source = "our choice")] pub inertia: f64,
        /// Damping ratio of the arm on the locked hub
        #[var(unit = ONE, range = 0.0..=0.5, start = 0.02, source = "our choice: metal")] pub damping: f64,
        /// Move the hub so that the tool, not the hub, is on the path
        #[var(start = true, paper = false, source = "our choice")] pub compensation: bool,
    }
    /// Adaptive feedforward cancellation (repetitive control), eq. 3; learns in `Track` while the input `afc.enable` is true.
    pub struct Afc {
        /// Cancelled harmonics of the spindle: numbers and ranges like `2, 4, 6` or `1-24`, up to 64
        #[var(start = Harmonics::DEFAULT_TEXT, paper = Harmonics::PAPER_TEXT, source = "our choice")] pub harmonics: String,
        /// `afc.harmonics` as they were read
        #[var(hidden, start = Harmonics::DEFAULT, paper = Harmonics::PAPER)] pub cancelled: Harmonics,
        /// Of `afc.harmonics`, cancel only what repeats from turn to turn
        #[var(source = "our choice: to choose takes eight turns")] pub automatic: bool,
        /// Time constant tau of each cancelled harmonic
        #[var(unit = SECOND, range = 0.01..=100.0, start = 0.3, paper = 0.2, source = "derived: 24 harmonics; 0.2 s for up to 12")] pub tau: f64,
        /// Advance each resonator by the phase of the position loop; without it eq. 3 as printed, unstable above some speed
        #[var(start = true, paper = false, source = "Messner and Bodson")] pub phase_advance: bool,
        /// Spindle speed below which nothing is learned
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 0.0..=1e3, start = TAU, source = "our choice: 60 rpm")] pub speed_min: f64,
        /// Harmonics above this frequency are left alone
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 62.8..=31_400.0, start = TAU * 700.0, source = "our choice: three times the bandwidth")]
        pub frequency_max: f64,
    }
    /// What is a fault.
    pub struct Limits {
        /// Following error at the tool that is a fault
        #[var(unit = METRE as "um", range = 1e-6..=0.1, start = 1e-3, source = "our choice")] pub following_error: f64,
        /// Part of `servo.torque_max` that a path may need
        #[var(unit = ONE, range = 0.1..=1.0, start = 0.9, source = "our choice: the rest is for control")] pub torque_share: f64,
        /// Samples in a row for which an input that cannot be believed is bridged; no more than one of three for long; one more is a fault
        #[var(range = 1..=100, start = 3, source = "derived: the fourth is the fault; 30 um at 500 m/s2 meanwhile")] pub lost_samples: i32,
        /// Largest difference of two readings of the arm at rest
        #[var(unit = RADIAN, range = 1e-9..=0.1, start = 2e-5, source = "derived: 1.6 um at the tool, 26 steps of the encoder")] pub arm_spread: f64,
        /// Largest difference of two readings of the spindle at steady speed; a slower spindle may stand without a fault
        #[var(unit = RADIAN, range = 1e-9..=1.0, start = 1.6e-3, source = "derived: two steps of 2^13 a turn; 153 rpm at 10 kHz")] pub spindle_spread: f64,
        /// Largest acceleration of the spindle
        #[var(unit = RADIAN_PER_SECOND_SQUARED, range = 1.0..=1e6, start = 1e4, source = "our choice: three times the quickest that was tried")] pub spindle_acceleration: f64,
        /// Largest speed of the slide
        #[var(unit = METRE_PER_SECOND, range = 1e-3..=10.0, start = 0.5, source = "our choice: rapid traverse")] pub slide_speed: f64,
        /// Feed of the slide in a turn of the spindle, either way; once it went with that for a turn it must until the cut is over,
        /// to a half of it. 0 for a slide that may stand
        #[var(unit = METRE as "um", range = 0.0..=0.01, source = "our choice: only the machine knows it")] pub feed: f64,
        /// Torque of friction and cut that may come without a command; 0 for 3 % of `servo.torque_max`
        #[var(unit = NEWTON_METRE, range = 0.0..=1e4, source = "derived: 2 N of thrust and 0.05 N.m of friction")] pub disturbance: f64,
        /// Least part of what a torque should do to the arm that it must do; 0 for no check
        #[var(unit = ONE, range = 0.0..=0.9, start = 0.4, source = "our choice: half the torque still tracks within 1 um")] pub drive_share: f64,
        /// Part of the samples at the limit of the torque that is too much, as a mean over 0.1 s; 1 for no check
        #[var(unit = ONE, range = 0.01..=1.0, start = 0.18, source = "derived: 20 ms from rest, a fifth of a turn at 600 rpm")] pub saturated_share: f64,
        /// Error over a turn that the cancellation must come below, within 8 `afc.tau`, root mean square; one beyond it may not double
        #[var(unit = METRE as "um", range = 1e-7..=0.1, start = 20e-6, source = "derived: fifty times what it leaves, three times what x20 noise leaves")] pub tracking_error: f64,
        /// Way out of the part after a fault and after the cut
        #[var(unit = METRE as "mm", range = 0.0..=0.05, start = 1e-3, source = "our choice")] pub retract: f64,
        /// Longest time of a job; 0 for a feed of 1 um/s through the table, and twice the measurement of a response
        #[var(unit = SECOND, range = 0.0..=1e6, source = "derived: slower is no cut")] pub job_time: f64,
    }
    /// Measurement of the frequency response in place, in `Identify`.
    pub struct Identify {
        /// Ascending frequencies at which the response is measured, Hz, at most 32
        #[var(start = Frequencies::DEFAULT_TEXT, source = "our choice: dense where the harmonics are; the last ones tell the flexure")] pub frequencies: String,
        /// `identify.frequencies` as they were read
        #[var(hidden, start = Frequencies::DEFAULT)] pub grid: Frequencies,
        /// Amplitude of the tool; friction falsifies amplitudes below that of the job
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 1.75e-3, source = "derived: the paper's 0x4 at a radius of 30 mm")] pub amplitude: f64,
        /// Part of `servo.torque_max` that the swing may need
        #[var(unit = ONE, range = 0.01..=0.9, start = 0.5, source = "our choice")] pub torque_share: f64,
        /// Largest acceleration of the tool
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.1..=1e5, start = 500.0, source = "paper")] pub acceleration_max: f64,
        /// Time from one frequency to the next
        #[var(unit = SECOND, range = 1e-3..=10.0, start = 0.05, source = "our choice")] pub glide_time: f64,
        /// Time at a frequency before it is measured
        #[var(unit = SECOND, range = 0.0..=10.0, start = 0.1, source = "our choice: five times the slowest pole")] pub settle_time: f64,
        /// Least time that is averaged, in whole periods
        #[var(unit = SECOND, range = 1e-3..=100.0, start = 0.2, source = "our choice")] pub average_time: f64,
        /// Time that the measurement takes
        #[var(unit = SECOND, calculated)] pub duration: f64,
    }
    /// Bounds of the state `Commission`, and what becomes of its results
    pub struct Commission {
        /// Farthest way of the tool from where it begins; 0: `identify.amplitude`
        #[var(unit = METRE as "mm", range = 0.0..=0.05, start = 0.0, source = "derived: identify.amplitude")] pub travel: f64,
        /// Largest torque of a tone, at least `limits.disturbance`; 0: a fifth of `servo.torque_max`
        #[var(unit = NEWTON_METRE, range = 0.0..=1e4, start = 0.0, source = "derived: servo.torque_max / 5")] pub torque: f64,
        /// Longest time; 0: what its motions take, a quarter more and 1 s
        #[var(unit = SECOND, range = 0.0..=1e6, start = 0.0, source = "derived: 1.25 times the motions + 1 s")] pub time: f64,
        /// Largest relative standard deviation of inertia and frequency of the flexure; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-6..=0.5, start = 0.02, source = "derived: what leaves the tip 0.2 um at 500 Hz is 1.3 %")] pub deviation_max: f64,
        /// Largest standard deviation of the delay, samples; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-3..=2.0, start = 0.25, source = "our choice: two of them to the next half sample")] pub delay_deviation_max: f64,
        /// Largest sensitivity of the loop that is derived: where `servo.bandwidth` leaves more, it is lowered
        #[var(unit = ONE, range = 1.3..=3.0, start = 1.8, source = "our choice: 32 degrees of phase and a factor 2.2 of gain")] pub sensitivity_max: f64,
        /// Use what was measured in place of what was told
        #[var(source = "our choice: first look, then trust")] pub apply: bool,
        /// File that a good commission writes: JSON, the parameters that it derives; empty: none
        pub export: String,
    }
    /// Depth probe on the slide; counts in `Calibrate`.
    pub struct Probe {
        /// Radius R_p of the probe ball
        #[var(unit = METRE as "mm", range = 0.0..=0.02, start = 1.5e-3, source = "our choice")] pub radius: f64,
        /// Standard deviation of the radius of the probe ball
        #[var(unit = METRE as "um", range = 0.0..=1e-3, start = 1e-7, source = "our choice")] pub radius_sigma: f64,
        /// Standard deviation of a depth reading on a cut surface
        #[var(unit = METRE as "nm", range = 1e-9..=1e-3, start = 65e-9, source = "derived: step 0.1 um of the paper, 50 nm of noise, 30 nm of roughness")]
        pub depth_sigma: f64,
        /// Standard deviation of the lateral position of the probe
        #[var(unit = METRE as "nm", range = 1e-9..=1e-3, start = 30e-9, source = "derived: step 0.1 um")] pub lateral_sigma: f64,
        /// Standard deviation of the zero of the lateral position on the spindle axis; a toroid probed on both sides finds it
        #[var(unit = METRE as "um", range = 1e-9..=0.1, start = 1e-4, source = "our choice: set by eye")] pub cusp_sigma: f64,
        /// Way of the probe between two samples of one capture
        #[var(unit = METRE as "um", range = 1e-6..=0.1, start = 1e-4, source = "our choice")] pub pitch: f64,
    }
    /// Calibration of arm length, zero and centre offset; counts in `Calibrate`.
    pub struct Calibration {
        /// Standard deviation of the arm angle of a flat
        #[var(unit = RADIAN, range = 1e-9..=1e-2, start = 0.25e-6, source = "derived: encoder step")] pub arm_angle_sigma: f64,
        /// Speed of the arm towards `hold_angle` while a calibration part is cut
        #[var(unit = RADIAN_PER_SECOND, range = 1e-4..=1.0, start = 0.03, source = "our choice: 50 um a turn at 3000 rpm")] pub sweep_speed: f64,
    }
    /// Correction of the form by a probed lens; counts in `CalibrateForm` and on the next path.
    pub struct Form {
        /// Correct the path of the next cut by what the lens before asks for
        #[var(source = "our choice: first look, then trust")] pub apply: bool,
        /// Largest depth of a correction; what is more is `NotForm`
        #[var(unit = METRE as "um", range = 1e-7..=1e-2, start = 1e-4, source = "our choice: more is another part, or another machine")] pub depth_max: f64,
        /// Largest standard deviation of a correction; above it is `Unsure`
        #[var(unit = METRE as "um", range = 1e-9..=1e-3, start = 0.2e-6, source = "our choice: a fifth of a micrometre")] pub deviation_max: f64,
    }
}

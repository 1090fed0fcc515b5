//! Every variable of the FMU, declared once. Sources: "paper" = Ludwick, Chargin, Calzaretta and Trumper (1999);
//! "derived" = follows from the equations; "default" = a choice of this project, with its reason.

pub use variables::*;

#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use std::f64::consts::{PI, TAU};

    use control_blocks::{DELAY_MAX, Reaction};
    use fmi2_export::Unit;
    use fmi2_export::units::{METRE, METRE_PER_SECOND, METRE_PER_SECOND_SQUARED, NEWTON_METRE, ONE, RADIAN};
    use fmi2_export::units::{RADIAN_PER_SECOND, RADIAN_PER_SECOND_SQUARED, SECOND};

    use crate::lists::frequencies::{COUNT_MAX, Frequencies};
    use crate::lists::harmonics::Harmonics;
    use crate::monitoring::numbers::Numbers;

    /// Number of harmonics of the tracking error that are reported.
    pub const ERROR_HARMONICS: usize = 24;
    const PER_METRE: Unit = Unit::si("1/m", [0, -1, 0, 0, 0], &[]);
    const KILOGRAM_METRE_SQUARED: Unit = Unit::si("kg.m2", [1, 2, 0, 0, 0], &[]);
    const NEWTON_METRE_SECOND: Unit = Unit::si("N.m.s/rad", [1, 2, -1, 0, -1], &[]);

    /// Requested operating mode
    pub enum Mode {
        /// Leave the path and the part, then zero torque
        Idle,
        /// Move to the hold angle and hold it
        Hold,
        /// Move onto the path and follow it without learning
        Approach,
        /// Move onto the path, follow it and cancel the repeating error
        Track,
        /// Measure the frequency response of the position loop
        Identify,
        /// Hold the hold angle and collect probed flats
        CalibrateFlats,
        /// Hold the hold angle and collect probe samples of the toroid
        CalibrateToroid,
        /// Hold the hold angle and collect probe samples of the lens
        CalibrateForm,
    }
    /// State of the controller
    pub enum State {
        /// Zero torque
        Idle,
        /// Moves to the hold angle and holds it
        Hold,
        /// Moves onto the path
        Approach,
        /// Follows the path without learning
        Ready,
        /// Follows the path and learns
        Track,
        /// Measures the frequency response of the position loop
        Identify,
        /// Holds the hold angle for a calibration
        Calibrate,
        /// Stopped by a fault; a rising edge of reset_fault leads to Idle
        Fault,
        /// The slide has left the table and the cut is finished; holds the tool out of the part
        Done,
        /// No mode is requested: leaves the path and the part, then Idle
        Retract,
        /// Identifies the machine with small oscillations about the present angle
        Commission,
    }
    /// Cause of the state Fault
    #[reactions(Reaction,
        Retract = ["Leaves the path, moves the tool `limits.retract` out of the part and holds it", "Rising edge of `reset_fault` once the arm is out of the part and at rest"],
        DriveOff = ["Brakes where arm and drive obey, then sets `torque` to zero and `drive_enable` to false", "Rising edge of `reset_fault` after the braking pulse"])]
    pub enum Fault {
        /// No fault
        None,
        /// The arm does not follow its reference, although drive and encoder respond
        #[reaction(DriveOff)]
        #[detection("Following error at the tool above `limits.following_error`, without a fault of drive or encoder")]
        #[hint("Free the arm. Increase `limits.following_error` if the process allows it.")]
        FollowingError,
        /// The path needs more torque than the drive has
        #[reaction(Retract)]
        #[detection("Torque that the path needs above `expert.limits.torque_ratio` of `servo.torque_max`; checked \
            before a motion and in each sample")]
        #[hint("Reduce the spindle speed, or reduce `surface.outer_radius`.")]
        Infeasible,
        /// The slide is where the path has no table
        #[reaction(Retract)]
        #[detection("`slide_position` outside the rows of the table while a path is requested, and not at the end of a \
            cut")]
        #[hint("Move the slide between `surface.outer_radius` and `surface.inner_radius`, or onto the rows of \
            `path.file`.")]
        OutsideTable,
        /// The hold angle is not a usable number
        #[reaction(Retract)]
        #[detection("`hold_angle` NaN, infinite or out of range for more than `limits.lost_samples` samples")]
        #[hint("Check the source of `hold_angle`.")]
        InvalidInput,
        /// The arm encoder delivers no usable number
        #[reaction(DriveOff)]
        #[detection("`arm_angle` NaN, infinite or out of range for more than `limits.lost_samples` samples")]
        #[hint("Check the arm encoder and its link.")]
        PositionLost,
        /// The arm angle does not change although the arm must have moved
        #[reaction(DriveOff)]
        #[detection("No change of `arm_angle` beyond its last bit, in spite of arm speed, 50 um of reference travel, \
            or a torque above twice `limits.disturbance`")]
        #[hint("Check the arm encoder and that the step is `sample_period`. Increase `limits.disturbance` if the arm \
            sticks.")]
        PositionFrozen,
        /// The arm angle is where the arm cannot be
        #[reaction(DriveOff)]
        #[detection("`arm_angle` farther from its prediction than `limits.arm_spread` and the disturbances allow, for \
            more than `limits.lost_samples` samples")]
        #[hint("Check the arm encoder, `servo.inertia` and `tip.frequency`. Increase `limits.arm_spread` for a noisy \
            encoder.")]
        PositionJump,
        /// The spindle encoder delivers no usable number
        #[reaction(Retract)]
        #[detection("`spindle_angle` NaN, infinite or out of range for more than `limits.lost_samples` samples, while \
            a path needs it")]
        #[hint("Check the spindle encoder and its link.")]
        SpindleLost,
        /// The slide encoder delivers no usable number
        #[reaction(Retract)]
        #[detection("`slide_position` NaN, infinite or out of range for more than `limits.lost_samples` samples, while \
            a path needs it")]
        #[hint("Check the slide encoder and its link.")]
        SlideLost,
        /// The torque was at its limit for too long
        #[reaction(DriveOff)]
        #[detection("More than `expert.limits.saturated_ratio` of the samples at `servo.torque_max`, averaged over 0.1 \
            s, without a fault of drive or encoder")]
        #[hint("Reduce the spindle speed. Check that nothing blocks the arm.")]
        Saturation,
        /// The arm accelerates against the torque
        #[reaction(DriveOff)]
        #[detection("Acceleration over torque, least squares over 10 ms between 8 and 200 Hz, below -0.2; below -0.6 \
            within 1 to 2 ms the brake reverses")]
        #[hint("Swap the sign of `torque`, or of `arm_angle`.")]
        DriveSign,
        /// The torque accelerates the arm too little
        #[reaction(DriveOff)]
        #[detection("Acceleration over torque, least squares over 10 ms between 8 and 200 Hz, below \
            `expert.limits.drive_gain_ratio`")]
        #[hint("Check the amplifier, the motor, `servo.inertia` and the arm encoder.")]
        WeakDrive,
        /// The torque alternates between its limits
        #[reaction(DriveOff)]
        #[detection("Eight changes from one torque limit to the other, each within 5 ms")]
        #[hint("The loop is unstable. Check `tip.frequency`, `io_delay` and `servo.inertia`, or reduce \
            `servo.bandwidth`.")]
        Oscillation,
        /// The task takes too long, or the tracking error stays too large
        #[reaction(Retract)]
        #[detection("Error of a revolution above `expert.limits.tracking_error` during 8 `afc.tau` of learning; or \
            task longer than `expert.limits.cycle_time`; or commissioning run longer than \
            `expert.commission.time`")]
        #[hint("Check the drive. Increase `expert.limits.cycle_time` or `expert.limits.tracking_error`.")]
        NoProgress,
        /// A communication step is longer than the sample period
        #[reaction(DriveOff)]
        #[detection("Communication step longer than `sample_period`: several samples share one input, and only the \
            last command takes effect")]
        #[hint("Co-simulation: set the step to `sample_period`. Model exchange: stop the solver at every time event.")]
        LongStep,
        /// The tracking error grows from revolution to revolution
        #[reaction(Retract)]
        #[detection("Error rises by a factor 1.05 to 4 in each of 4 to 10 consecutive revolutions at steady speed, \
            doubles, and exceeds `expert.limits.tracking_error`")]
        #[hint("Reduce the depth of cut, change the speed, or increase `afc.tau`. Check `servo.inertia`, `io_delay` \
            and `response.file`.")]
        Divergence,
        /// The spindle angle is where the spindle cannot be
        #[reaction(Retract)]
        #[detection("`spindle_angle` off its prediction by more than `expert.limits.spindle_spread` and \
            `expert.limits.spindle_acceleration` allow, for more than `limits.lost_samples` samples of a path")]
        #[hint("Check the spindle encoder and the step. Increase `expert.limits.spindle_spread` or \
            `expert.limits.spindle_acceleration`.")]
        SpindleJump,
        /// The spindle angle does not change although the spindle must turn
        #[reaction(Retract)]
        #[detection("No change of `spindle_angle` that `expert.limits.spindle_acceleration` could explain, for more \
            than `limits.lost_samples` samples, while a path needs it")]
        #[hint("Check the spindle encoder and the step. Increase `expert.limits.spindle_acceleration` for a spindle \
            that stops quickly.")]
        SpindleFrozen,
        /// The slide position is where the slide cannot be
        #[reaction(Retract)]
        #[detection("Change of `slide_position` above `expert.limits.slide_speed`, for more than `limits.lost_samples` \
            samples, while a path needs it")]
        #[hint("Check the slide encoder. Increase `expert.limits.slide_speed` for a faster slide.")]
        SlideJump,
        /// The slide position does not change although the slide must move
        #[reaction(Retract)]
        #[detection("Frozen during a motion; or travel of a revolution outside half to one and a half times \
            `limits.feed`, after one revolution with that feed")]
        #[hint("Check the slide encoder. Set `limits.feed` = 0 if the slide may rest.")]
        SlideFrozen,
        /// The commissioning run gave a result that cannot be used
        #[reaction(Retract)]
        #[detection("Standard deviation above `expert.commission.std_max` or `expert.commission.delay_std_max`; value \
            outside the allowed machines; or no loop with `expert.commission.sensitivity_max`")]
        #[hint("Increase `commission.torque` or `commission.travel`. Check play, vibration, the arm encoder, \
            `servo.inertia`, `tip.frequency` and `io_delay`.")]
        CommissionRejected,
    }
    /// Result of the last calibration command
    pub enum Status {
        /// No fit was made
        None,
        /// The last fit succeeded
        Solved,
        /// There are too few samples for a fit
        TooFewSamples,
        /// The samples do not determine the parameters
        NotObservable,
        /// The fit did not converge
        NotConverged,
        /// Sample ignored: calibration_cut was never true before
        NoCut,
        /// Sample ignored: slide (toroid) or arm (flats) moved during the cut
        Moved,
        /// Sample ignored: the probe depth is NaN, infinite or out of range
        InvalidProbe,
        /// Sample ignored: 512 samples are stored
        Full,
        /// Sample ignored: the probe is where the path has no table
        OutsidePath,
        /// Correction rejected: its depth exceeds the limit
        TooLarge,
        /// Correction rejected: its standard deviation exceeds the limit
        Uncertain,
    }
    /// Active control law
    pub enum Law {
        /// 24 harmonics with phase advance, learned feedforward, flexure of the arm compensated
        Default,
        /// The published control law, for each parameter that is not set
        Paper,
    }
    /// Kind of the surface that is cut
    pub enum SurfaceKind {
        /// Toric with two principal curvatures and tilt
        Toric,
        /// One harmonic of the tool depth, for motions in air
        Wave,
        /// Table from path.file
        File,
    }
    /// Inputs, sampled at the start of the control step.
    #[inputs] pub struct Input {
        /// Encoder angle b of the arm from its index
        #[var(unit = RADIAN as "deg", accepts_nan)] pub arm_angle: f64,
        /// Spindle angle theta, wrapped or unwrapped
        #[var(unit = RADIAN as "deg", accepts_nan)] pub spindle_angle: f64,
        /// Position x of the cross slide
        #[var(unit = METRE as "mm", accepts_nan)] pub slide_position: f64,
        /// True: mode is active; false: as mode Idle, the arm leaves path and part
        pub enable: bool,
        /// Requested operating mode, active while enable is true
        pub mode: Mode,
        /// Rising edge in Idle or Done at rest identifies the machine; false aborts
        pub commission: bool,
        /// Rising edge acknowledges a fault once the arm is at rest or the drive is off
        pub reset_fault: bool,
        /// Feed the path forward through the inverse response of the position loop
        #[var(start = true)] pub feedforward_enable: bool,
        /// Cancel harmonics of the error; false also discards what was learned
        #[var(start = true)] pub afc_enable: bool,
        /// Encoder angle b to be held in Hold, Identify and the calibrations
        #[var(unit = RADIAN as "deg", accepts_nan)] pub hold_angle: f64,
        /// Depth p measured by the probe, positive into the part
        #[var(unit = METRE as "mm", accepts_nan)] pub probe_depth: f64,
        /// Distance l of the probe from the spindle axis, negative on its other side
        #[var(unit = METRE as "mm", accepts_nan)] pub probe_lateral: f64,
        /// Spindle angle at which the probe measures the lens (CalibrateForm)
        #[var(unit = RADIAN as "deg", accepts_nan)] pub probe_angle: f64,
        /// Rising edge stores a probe sample; while true, one more per probe pitch
        pub probe_capture: bool,
        /// The tool cuts the calibration part: arm angle and slide position are averaged
        pub calibration_cut: bool,
        /// Rising edge fits the stored samples
        pub calibration_solve: bool,
    }
    /// Outputs; always finite.
    #[outputs] pub struct Output {
        /// Torque command
        #[var(unit = NEWTON_METRE)] pub torque: f64,
        /// State of the controller
        pub state: State,
        /// Cause of the state Fault
        pub fault: Fault,
        /// The drive may be on; false after a fault with the reaction DriveOff until it is reset
        #[var(start = true)] pub drive_enable: bool,
        #[var(local)] pub reference: ReferenceOutput,
        pub error: ErrorOutput,
        /// Estimated spindle speed
        #[var(local, unit = RADIAN_PER_SECOND as "rpm")] pub spindle_speed: f64,
        /// Acceleration of the arm over that of the torque, last 10 ms; 1 at small torque
        #[var(local, unit = ONE, start = 1.0)] pub drive_gain_ratio: f64,
        /// The torque is at its limit
        #[var(local)] pub saturated: bool,
        /// The cancellation does not learn at present
        #[var(local, name = "afc.frozen", start = true)] pub afc_frozen: bool,
        /// Largest torque that the path needs at the present speed
        #[var(local, name = "path.torque", unit = NEWTON_METRE)] pub path_torque: f64,
        /// Learned torque of the path over the torque that the response in use predicts
        #[var(local, name = "path.torque_ratio", unit = ONE, start = 1.0)] pub path_torque_ratio: f64,
        /// Largest depth that the harmonics of the table omit
        #[var(local, name = "path.truncation", unit = METRE as "nm")] pub path_truncation: f64,
        pub calibration: CalibrationOutput,
        #[var(local)] pub form: FormOutput,
        #[var(local)] pub response: ResponseOutput,
        pub measured: Measured,
        /// Completed fraction of the frequency response measurement
        #[var(name = "identify.progress", unit = ONE)] pub identify_progress: f64,
        /// Values of the monitors for the fault messages.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
    }
    /// Reference of the tool, before feedforward and cancellation.
    pub struct ReferenceOutput {
        /// Reference depth z of the tool-nose center below the arm axis, eq. 2
        #[var(unit = METRE as "um")] pub depth: f64,
        /// Reference encoder angle b_d = asin(z / R_a) - b_0
        #[var(unit = RADIAN as "deg")] pub angle: f64,
    }
    /// Tracking error at the tool.
    pub struct ErrorOutput {
        /// Tracking error at the tool, R_a cos(phi) (b_d - b)
        #[var(local, unit = METRE as "um")] pub tracking: f64,
        /// Root mean square of the tracking error over the last full revolution
        #[var(unit = METRE as "um")] pub rms: f64,
        /// Largest tracking error of the last full revolution
        #[var(unit = METRE as "um")] pub peak: f64,
        /// Amplitude of a spindle harmonic of the tracking error, last full revolution
        #[var(local, unit = METRE as "um")] pub harmonic: [f64; ERROR_HARMONICS],
    }
    /// Result of the calibration, for the selected tool.
    pub struct CalibrationOutput {
        /// Result of the last calibration command
        pub status: Status,
        /// Calibrated arm length R_a
        #[var(unit = METRE as "mm")] pub arm_length: f64,
        /// Calibrated cross-slide offset x_0
        #[var(unit = METRE as "mm")] pub center_offset: f64,
        /// Calibrated arm offset angle b_0
        #[var(unit = RADIAN as "deg")] pub arm_zero: f64,
        /// Standard deviation of the calibrated arm length
        #[var(local, unit = METRE as "um")] pub arm_length_std: f64,
        /// Standard deviation of the calibrated cross-slide offset
        #[var(local, unit = METRE as "um")] pub center_offset_std: f64,
        /// Standard deviation of the calibrated arm offset angle
        #[var(local, unit = RADIAN as "deg")] pub arm_zero_std: f64,
        /// Root mean square of the residuals of the last fit
        #[var(local, unit = METRE as "um")] pub residual: f64,
        /// Number of stored samples
        #[var(local)] pub samples: i32,
    }
    /// Form of the lens that was probed last, and the correction of the path.
    pub struct FormOutput {
        /// Form error: rms of the smooth part of the probed depths, without the mean
        #[var(unit = METRE as "um")] pub error: f64,
        /// Largest depth of the correction that the probed lens needs
        #[var(unit = METRE as "um")] pub largest: f64,
        /// Standard deviation of the form correction, rms over the probed zone
        #[var(unit = METRE as "um")] pub std: f64,
        /// The present or last path includes the form correction
        pub corrected: bool,
    }
    /// Frequency response of the position loop in use: nominal, from `response.file` or identified.
    pub struct ResponseOutput {
        /// -3 dB frequency of the response in use; 0 if it is beyond the table
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub bandwidth: f64,
        /// Phase margin that follows from the response in use
        #[var(unit = RADIAN as "deg")] pub phase_margin: f64,
        /// Largest magnitude of the sensitivity 1 - T that follows from the response in use
        #[var(unit = ONE)] pub sensitivity_peak: f64,
        /// Natural frequency of the flexure that is compensated, hub locked
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub tip_frequency: f64,
        /// Damping ratio of the flexure that is compensated, hub locked
        #[var(unit = ONE)] pub tip_damping: f64,
        /// Standard deviation of the identified flexure frequency; 0 while nominal
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub tip_frequency_std: f64,
        /// Frequency of a point of the response in use; 0 if there is none
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub frequency: [f64; COUNT_MAX],
        /// Magnitude of the response T, set-point to arm angle, at this frequency
        #[var(unit = ONE)] pub magnitude: [f64; COUNT_MAX],
        /// Unwrapped phase of the response T at this frequency
        #[var(unit = RADIAN as "deg")] pub phase: [f64; COUNT_MAX],
    }
    /// Results of the commissioning run, each with its standard deviation; 0 before.
    pub struct Measured {
        /// The last commissioning run succeeded; false from the next one on
        pub valid: bool,
        /// Measured inertia, relative to the commanded torque
        #[var(local, unit = KILOGRAM_METRE_SQUARED)] pub inertia: f64,
        /// Standard deviation of the measured inertia
        #[var(local, unit = KILOGRAM_METRE_SQUARED)] pub inertia_std: f64,
        /// Measured viscous friction, relative to the commanded torque
        #[var(local, unit = NEWTON_METRE_SECOND)] pub viscous_friction: f64,
        /// Standard deviation of the measured viscous friction
        #[var(local, unit = NEWTON_METRE_SECOND)] pub viscous_friction_std: f64,
        /// Measured dry friction, relative to the commanded torque
        #[var(local, unit = NEWTON_METRE)] pub dry_friction: f64,
        /// Standard deviation of the measured dry friction
        #[var(local, unit = NEWTON_METRE)] pub dry_friction_std: f64,
        /// Measured samples from command to response, not rounded, encoder delay included
        #[var(local, unit = ONE)] pub io_delay: f64,
        /// Standard deviation of the measured delay
        #[var(local, unit = ONE)] pub io_delay_std: f64,
        /// Measured natural frequency of the flexure, hub locked; 0 for a rigid arm
        #[var(local, unit = RADIAN_PER_SECOND as "Hz")] pub tip_frequency: f64,
        /// Standard deviation of the measured flexure frequency
        #[var(local, unit = RADIAN_PER_SECOND as "Hz")] pub tip_frequency_std: f64,
        /// Measured fraction of the inertia beyond the flexure
        #[var(local, unit = ONE)] pub tip_inertia: f64,
        /// Standard deviation of the measured inertia beyond the flexure
        #[var(local, unit = ONE)] pub tip_inertia_std: f64,
        /// Measured damping ratio of the flexure, hub locked
        #[var(local, unit = ONE)] pub tip_damping: f64,
        /// Standard deviation of the measured damping ratio
        #[var(local, unit = ONE)] pub tip_damping_std: f64,
    }
    /// Parameters.
    #[parameters] pub struct Parameters {
        /// Active control law
        pub law: Law,
        /// Sample period T_s
        #[var(unit = SECOND as "us", range = 2e-5..=1e-3, start = 1e-4, source = "paper: 10 kHz")]
        pub sample_period: f64,
        /// Samples between a command and its effect; 1 for a standard master, 0 if immediate
        #[var(essential, range = 0..=DELAY_MAX as i32, start = 1, source = "default; behavior of a standard master")]
        pub io_delay: i32,
        /// Samples by which the arm angle is older than the spindle angle; with io_delay up to 8
        #[var(range = 0..=DELAY_MAX as i32, start = 0, source = "default; both encoders on one link")]
        pub arm_delay: i32,
        pub tool: Tool,
        pub surface: Surface,
        pub path: Path,
        pub servo: Servo,
        pub tip: Tip,
        /// Harmonics in the feedforward; 0: none, otherwise at least those of the path
        #[var(expert, name = "feedforward.harmonics", range = 0..=64, start = 24, source = "derived: the arc of the arm turns 12 harmonics into 24")]
        pub feedforward_harmonics: i32,
        /// Learn the torque ratio of the path in Track; false: learn amplitudes
        #[var(expert, name = "feedforward.adaptive", start = true, paper = false, source = "default; the paper measures the response once")]
        pub feedforward_adaptive: bool,
        /// JSON table of the frequency response, in resources or with full path; empty: nominal
        #[var(name = "response.file")] pub response_file: String,
        pub afc: Afc,
        /// Duration of the motion onto the path
        #[var(expert, name = "approach.time", unit = SECOND, range = 0.01..=60.0, start = 0.3, source = "default; slow against the loop, short against a cut")]
        pub approach_time: f64,
        /// Largest speed of the motion to the hold angle, which takes at least approach.time
        #[var(expert, name = "hold.speed", unit = RADIAN_PER_SECOND, range = 1e-4..=100.0, start = 2.0, source = "default; 0.16 m/s at the tool")]
        pub hold_speed: f64,
        pub limits: Limits,
        pub identify: Identify,
        pub commission: Commission,
        pub probe: Probe,
        pub calibration: Calibration,
        pub form: Form,
    }
    /// The two tools of the double-ended arm; one calibration record each.
    pub struct Tool {
        /// Number of the tool in use
        #[var(range = 1..=2, start = 1)] pub selected: i32,
        /// Arm length R_a of the tool
        #[var(essential, unit = METRE as "mm", range = 0.02..=0.5, start = [0.08; 2], source = "paper")]
        pub arm_length: [f64; 2],
        /// Arm offset angle b_0 of the tool: arm angle to the axis plane at the encoder index
        #[var(unit = RADIAN as "deg", range = -7.0..=7.0, start = [0.0523, 0.0523 - PI], source = "default; the tools are half a revolution apart")]
        pub arm_zero: [f64; 2],
        /// Slide position x_0 with the arm axis above the spindle axis, for the tool
        #[var(unit = METRE as "mm", range = -2.0..=2.0, start = [0.15; 2], source = "default; plant rotary_arm")]
        pub center_offset: [f64; 2],
        /// Nose radius R_t of the tool
        #[var(unit = METRE as "mm", range = 0.0..=0.02, start = [0.002; 2], source = "default; usual diamond")]
        pub nose_radius: [f64; 2],
        /// Standard deviation of the arm length, for flats that are fitted without a toroid
        #[var(expert, unit = METRE as "um", range = 1e-9..=1e-3, start = [1e-6; 2], source = "paper")]
        pub arm_length_std: [f64; 2],
        /// Standard deviation of the nose radius of the tool
        #[var(expert, unit = METRE as "um", range = 0.0..=1e-3, start = [1e-7; 2], source = "default; 0.1 um, it adds 1 : 1 to the arm length")]
        pub nose_radius_std: [f64; 2],
    }
    /// Surface to be cut.
    pub struct Surface {
        /// Kind of the surface that is cut
        #[var(essential, source = "paper")] pub kind: SurfaceKind,
        /// Curvature along Y (spindle angle pi/2), positive if concave; diopters over 0.53
        #[var(unit = PER_METRE, range = -50.0..=50.0, source = "paper: 0x4, flat")] pub base_curvature: f64,
        /// Curvature along X (spindle angle 0), positive if concave; diopters over 0.53
        #[var(essential, unit = PER_METRE, range = -50.0..=50.0, start = 1.0 / 0.1325, source = "paper: 132.5 mm, concave")]
        pub cross_curvature: f64,
        /// Slope of the surface along X (prism)
        #[var(unit = ONE, range = -0.5..=0.5)] pub tilt_x: f64,
        /// Slope of the surface along Y (prism)
        #[var(unit = ONE, range = -0.5..=0.5)] pub tilt_y: f64,
        /// Amplitude of the wave (kind Wave)
        #[var(unit = METRE as "um", range = 0.0..=0.05, start = 50.7e-6, source = "derived: 500 m/s2 at 500 Hz")]
        pub wave_amplitude: f64,
        /// Waves per revolution (kind Wave)
        #[var(range = 1..=64, start = 50, source = "derived: 500 Hz at 600 rpm")] pub wave_harmonic: i32,
        /// Distance from the spindle axis where the cut ends
        #[var(unit = METRE as "mm", range = 0.0..=0.5)] pub inner_radius: f64,
        /// Distance from the spindle axis where the cut starts
        #[var(essential, unit = METRE as "mm", range = 1e-3..=0.5, start = 0.05, source = "paper: 100 mm parts")]
        pub outer_radius: f64,
        /// Place the part so that the arm moves about the plane of its axis
        #[var(expert, start = true, source = "default; smallest sideways motion")] pub depth_auto: bool,
        /// Depth z_c of the nose center at the spindle axis, if depth_auto is false
        #[var(expert, unit = METRE as "mm", range = -0.2..=0.2)] pub depth: f64,
    }
    /// Look-up table of the tool path, eq. 2.
    pub struct Path {
        /// Harmonics N of the tool path, eq. 2
        #[var(range = 1..=64, start = 12, source = "paper: 6 to 10; derived: 28 for 0x8 at the rim")]
        pub harmonics: i32,
        /// Grid of the look-up table along the slide position
        #[var(expert, unit = METRE as "mm", range = 1e-4..=5e-3, start = 0.5e-3, source = "derived: 0.4 nm with cubic interpolation")]
        pub grid: f64,
        /// JSON table of the path, in resources or with full path; for kind File
        pub file: String,
    }
    /// Nominal arm and drive, and the lead-lag position loop designed for them.
    pub struct Servo {
        /// Desired -3 dB bandwidth of the position loop
        #[var(essential, unit = RADIAN_PER_SECOND as "Hz", range = 62.8..=3142.0, start = TAU * 230.0, source = "paper: 230 Hz")]
        pub bandwidth: f64,
        /// Crossover frequency over the zero of the lead, and its pole over the crossover
        #[var(expert, unit = ONE, range = 1.5..=10.0, start = 4.0, source = "default; 44 degrees of phase margin remain")]
        pub lead: f64,
        /// Roll-off frequency of the compensator
        #[var(expert, unit = RADIAN_PER_SECOND as "Hz", range = 1e3..=31_400.0, start = TAU * 2500.0, source = "default; eleven times the bandwidth")]
        pub roll_off: f64,
        /// Nominal inertia J of the whole moving arm
        #[var(essential, unit = KILOGRAM_METRE_SQUARED, range = 1e-7..=10.0, start = 8e-4, source = "default; 500 m/s2 needs 5 N.m")]
        pub inertia: f64,
        /// Nominal viscous friction of the arm
        #[var(expert, unit = NEWTON_METRE_SECOND, range = 0.0..=10.0, start = 2e-3, source = "default; plant rotary_arm")]
        pub viscous_friction: f64,
        /// Dry friction fed forward with the sign of the reference speed; 0: none
        #[var(expert, unit = NEWTON_METRE, range = 0.0..=10.0, source = "default; it must be measured first")]
        pub dry_friction: f64,
        /// Largest torque of the drive
        #[var(essential, unit = NEWTON_METRE, range = 1e-3..=1e4, start = 7.0, source = "default; plant rotary_arm")]
        pub torque_max: f64,
        /// Bandwidth of the current loop
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 600.0..=1e6, start = TAU * 2000.0, source = "default; plant rotary_arm")]
        pub current_bandwidth: f64,
    }
    /// Flexure of the arm between encoder and tool.
    pub struct Tip {
        /// Natural frequency of the arm on the locked hub; 0 for a rigid arm
        #[var(essential, unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=1e5, start = TAU * 1200.0, source = "default; plant rotary_arm")]
        pub frequency: f64,
        /// Fraction of the inertia beyond the flexure
        #[var(expert, unit = ONE, range = 0.0..=0.95, start = 0.4375, source = "default; plant rotary_arm")]
        pub inertia: f64,
        /// Damping ratio of the arm on the locked hub
        #[var(expert, unit = ONE, range = 0.0..=0.5, start = 0.02, source = "default; metal")] pub damping: f64,
        /// Move the hub so that the tool, not the hub, follows the path
        #[var(expert, start = true, paper = false, source = "default; otherwise the tool errs by acceleration / frequency squared")]
        pub compensation: bool,
    }
    /// Adaptive feedforward cancellation (repetitive control), eq. 3; learns in `Track` while the input `afc_enable` is true.
    pub struct Afc {
        /// Canceled spindle harmonics: numbers and ranges, such as 2, 4, 6 or 1-24, up to 64
        #[var(start = Harmonics::DEFAULT_TEXT, paper = Harmonics::PAPER_TEXT, source = "default; leaves a third of the published error")]
        pub harmonics: String,
        /// afc.harmonics after parsing
        #[var(hidden, start = Harmonics::DEFAULT, paper = Harmonics::PAPER)] pub cancelled: Harmonics,
        /// Of afc.harmonics, cancel only those that repeat from revolution to revolution
        #[var(expert, source = "default; the choice takes eight revolutions")] pub automatic: bool,
        /// Time constant tau of each canceled harmonic
        #[var(unit = SECOND, range = 0.01..=100.0, start = 0.3, paper = 0.2, source = "derived: 24 harmonics; 0.2 s for up to 12")]
        pub tau: f64,
        /// Advance each resonator by the loop phase; false: eq. 3 as printed, unstable at high speed
        #[var(expert, start = true, paper = false, source = "Messner and Bodson")] pub phase_advance: bool,
        /// Harmonics above this frequency are not canceled
        #[var(expert, unit = RADIAN_PER_SECOND as "Hz", range = 62.8..=31_400.0, start = TAU * 700.0, source = "default; three times the bandwidth")]
        pub frequency_max: f64,
    }
    /// Fault limits.
    pub struct Limits {
        /// Following error at the tool that raises FollowingError
        #[var(unit = METRE as "um", range = 1e-6..=0.1, start = 1e-3, source = "default; far above the error of a good cut")]
        pub following_error: f64,
        /// Fraction of servo.torque_max that a path may need
        #[var(expert, unit = ONE, range = 0.1..=1.0, start = 0.9, source = "default; the rest is for control")]
        pub torque_ratio: f64,
        /// Consecutive invalid samples of an input that are bridged; at most one of three for long
        #[var(range = 1..=100, start = 3, source = "derived: the fourth raises the fault; 30 um at 500 m/s2 meanwhile")]
        pub lost_samples: i32,
        /// Largest difference of two arm angles at rest
        #[var(unit = RADIAN, range = 1e-9..=0.1, start = 2e-5, source = "derived: 1.6 um at the tool, 26 steps of the encoder")]
        pub arm_spread: f64,
        /// Largest deviation of a spindle angle at steady speed; a slower spindle may rest
        #[var(expert, unit = RADIAN, range = 1e-9..=1.0, start = 1.6e-3, source = "derived: two steps of 2^13 a revolution; 153 rpm at 10 kHz")]
        pub spindle_spread: f64,
        /// Largest acceleration of the spindle
        #[var(expert, unit = RADIAN_PER_SECOND_SQUARED, range = 1.0..=1e6, start = 1e4, source = "default; three times the quickest tested")]
        pub spindle_acceleration: f64,
        /// Largest speed of the slide
        #[var(expert, unit = METRE_PER_SECOND, range = 1e-3..=10.0, start = 0.5, source = "default; rapid traverse")]
        pub slide_speed: f64,
        /// Feed of the slide per revolution in either direction; 0 for a slide that may rest
        #[var(unit = METRE as "um", range = 0.0..=0.01, source = "default; known to the machine only")] pub feed: f64,
        /// Torque of friction and cut without a command; 0: 3 % of servo.torque_max
        #[var(unit = NEWTON_METRE, range = 0.0..=1e4, source = "derived: 2 N of thrust and 0.05 N.m of friction")]
        pub disturbance: f64,
        /// Smallest ratio of actual to expected acceleration of the arm; 0: no check
        #[var(expert, unit = ONE, range = 0.0..=0.9, start = 0.4, source = "default; half the torque still tracks within 1 um")]
        pub drive_gain_ratio: f64,
        /// Largest fraction of samples at the torque limit, mean over 0.1 s; 1: no check
        #[var(expert, unit = ONE, range = 0.01..=1.0, start = 0.18, source = "derived: 20 ms from rest, a fifth of a revolution at 600 rpm")]
        pub saturated_ratio: f64,
        /// Rms error of a revolution that learning must reach within 8 afc.tau
        #[var(expert, unit = METRE as "um", range = 1e-7..=0.1, start = 20e-6, source = "derived: fifty times the usual residual, three times that of 20-fold noise")]
        pub tracking_error: f64,
        /// Distance of the tool from the part after a fault and after the cut
        #[var(unit = METRE as "mm", range = 0.0..=0.05, start = 1e-3, source = "default; 1 mm of clearance")]
        pub retract: f64,
        /// Longest time of a task; 0: derived from the feed or the measurement
        #[var(expert, unit = SECOND, range = 0.0..=1e6, source = "derived: 1 um/s through the table, or twice the response measurement")]
        pub cycle_time: f64,
    }
    /// Measurement of the frequency response, in `Identify`.
    pub struct Identify {
        /// Ascending frequencies in Hz at which the response is measured, at most 32
        #[var(expert, start = Frequencies::DEFAULT_TEXT, source = "default; dense at the harmonics; the last ones identify the flexure")]
        pub frequencies: String,
        /// identify.frequencies after parsing
        #[var(hidden, start = Frequencies::DEFAULT)] pub grid: Frequencies,
        /// Amplitude of the tool during Identify; friction biases smaller ones than the cut needs
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 1.75e-3, source = "derived: the paper's 0x4 at a radius of 30 mm")]
        pub amplitude: f64,
        /// Fraction of servo.torque_max that the oscillation may need
        #[var(expert, unit = ONE, range = 0.01..=0.9, start = 0.5, source = "default; half of the torque remains for control")]
        pub torque_ratio: f64,
        /// Largest acceleration of the tool during Identify
        #[var(expert, unit = METRE_PER_SECOND_SQUARED, range = 0.1..=1e5, start = 500.0, source = "paper")]
        pub acceleration_max: f64,
        /// Duration of the frequency response measurement
        #[var(expert, unit = SECOND, calculated)] pub duration: f64,
    }
    /// Bounds of the state `Commission`, and use of its results.
    pub struct Commission {
        /// Largest travel of the tool from its start; 0: identify.amplitude
        #[var(unit = METRE as "mm", range = 0.0..=0.05, start = 0.0, source = "derived: identify.amplitude")]
        pub travel: f64,
        /// Largest torque of a tone, at least limits.disturbance; 0: servo.torque_max / 5
        #[var(unit = NEWTON_METRE, range = 0.0..=1e4, start = 0.0, source = "derived: servo.torque_max / 5")]
        pub torque: f64,
        /// Longest commissioning run; 0: 1.25 times its motions and 1 s
        #[var(expert, unit = SECOND, range = 0.0..=1e6, start = 0.0, source = "derived: 1.25 times the motions + 1 s")]
        pub time: f64,
        /// Largest relative standard deviation of inertia and flexure frequency
        #[var(expert, unit = ONE, range = 1e-6..=0.5, start = 0.02, source = "derived: 1.3 % leaves 0.2 um at the tool at 500 Hz")]
        pub std_max: f64,
        /// Largest standard deviation of the measured delay, samples
        #[var(expert, unit = ONE, range = 1e-3..=2.0, start = 0.25, source = "default; two standard deviations to the next half sample")]
        pub delay_std_max: f64,
        /// Largest sensitivity of the derived loop; a higher one lowers servo.bandwidth
        #[var(expert, unit = ONE, range = 1.3..=3.0, start = 1.8, source = "default; 32 degrees of phase and a factor 2.2 of gain")]
        pub sensitivity_max: f64,
        /// Use the measured values in place of the configured parameters
        #[var(source = "default; check the result before it is used")] pub apply: bool,
        /// JSON file for the derived parameters of a successful run; empty: none
        pub export: String,
    }
    /// Depth probe on the slide, used in `Calibrate`.
    pub struct Probe {
        /// Radius R_p of the probe ball
        #[var(unit = METRE as "mm", range = 0.0..=0.02, start = 1.5e-3, source = "default; plant rotary_arm")]
        pub radius: f64,
        /// Standard deviation of the radius of the probe ball
        #[var(expert, unit = METRE as "um", range = 0.0..=1e-3, start = 1e-7, source = "default; 0.1 um, it adds 1 : 1 to the arm length")]
        pub radius_std: f64,
        /// Standard deviation of a probed depth on a cut surface
        #[var(expert, unit = METRE as "nm", range = 1e-9..=1e-3, start = 65e-9, source = "derived: step 0.1 um of the paper, 50 nm of noise, 30 nm of roughness")]
        pub depth_std: f64,
        /// Standard deviation of the lateral position of the probe
        #[var(expert, unit = METRE as "nm", range = 1e-9..=1e-3, start = 30e-9, source = "derived: step 0.1 um")]
        pub lateral_std: f64,
        /// Standard deviation of the lateral zero of the probe on the spindle axis
        #[var(expert, unit = METRE as "um", range = 1e-9..=0.1, start = 1e-4, source = "default; set by eye")]
        pub cusp_std: f64,
        /// Distance of the probe between two samples of one capture
        #[var(expert, unit = METRE as "um", range = 1e-6..=0.1, start = 1e-4, source = "default; 512 samples cover a radius of 51 mm")]
        pub pitch: f64,
    }
    /// Calibration of arm length, arm zero and center offset, used in `Calibrate`.
    pub struct Calibration {
        /// Standard deviation of the arm angle of a flat
        #[var(expert, unit = RADIAN, range = 1e-9..=1e-2, start = 0.25e-6, source = "derived: encoder step")]
        pub arm_angle_std: f64,
        /// Speed of the arm towards the hold angle while a calibration part is cut
        #[var(expert, unit = RADIAN_PER_SECOND, range = 1e-4..=1.0, start = 0.03, source = "default; 50 um per revolution at 3000 rpm")]
        pub sweep_speed: f64,
    }
    /// Correction of the form by a probed lens, used in `CalibrateForm` and on the next path.
    pub struct Form {
        /// Correct the next path by the form error of the probed lens
        #[var(source = "default; check the result before it is used")] pub apply: bool,
        /// Largest depth of a form correction; above it the status is TooLarge
        #[var(expert, unit = METRE as "um", range = 1e-7..=1e-2, start = 1e-4, source = "default; more is another part or another machine")]
        pub depth_max: f64,
        /// Largest standard deviation of a form correction; above it the status is Uncertain
        #[var(expert, unit = METRE as "um", range = 1e-9..=1e-3, start = 0.2e-6, source = "default; a fifth of a micrometer")]
        pub std_max: f64,
    }
}

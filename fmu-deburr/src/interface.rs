//! Every variable of the FMU, declared once.
//!
//! Sources: "paper" = Kimura, Mukai and Kobayashi; "derived" = follows from the equations; "default" = the paper does
//! not state it. The axes are 1 column, 2 height, 3 arm, 4 yaw, 5 pitch and 6 roll of the wrist.

pub use variables::*;

// one line for a declaration, as in a table
#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use std::f64::consts::TAU;

    use control_blocks::{DELAY_MAX, Reaction};
    use fmi2_export::units::{METRE, METRE_PER_SECOND, METRE_PER_SECOND_SQUARED, ONE};
    use fmi2_export::units::{RADIAN, RADIAN_PER_SECOND, RADIAN_PER_SECOND_SQUARED, SECOND};
    use fmi2_export::Unit;

    use crate::learning::speeds::Speeds;
    use crate::monitoring::numbers::Numbers;

    const PER_SECOND: Unit = Unit::si("1/s", [0, 0, -1, 0, 0], &[]);
    /// Units of the six axes.
    const JOINT: [Unit; 6] = [RADIAN, METRE, METRE, RADIAN, RADIAN, RADIAN];
    const SHOWN: [&str; 6] = ["deg", "mm", "mm", "deg", "deg", "deg"];
    const FINE: [&str; 6] = ["deg", "um", "um", "deg", "deg", "deg"];
    const ANGULAR: Unit = RADIAN_PER_SECOND;
    const RATE: [Unit; 6] = [ANGULAR, METRE_PER_SECOND, METRE_PER_SECOND, ANGULAR, ANGULAR, ANGULAR];
    const PULSE: [f64; 6] = [TAU / 640e3, 2.5e-6, 5e-6, TAU / 400e3, TAU / 400e3, TAU / 400e3];
    const RPM: f64 = TAU / 60.0;
    /// Largest displacement by which friction may hold a drive back, rad or m; also its standard deviation where the
    /// strokes do not show it.
    pub const FRICTION_MAX: f64 = 0.01;

    /// Requested task; it starts when the mode changes while the controller is enabled
    pub enum Mode {
        /// Hold the pose; a motion stops along the path
        Idle,
        /// Run the path once without compensation
        DryRun,
        /// Learn the patterns of all speeds, in air
        Learn,
        /// Run the path with the patterns at the overridden speed
        Playback,
        /// Run the path with the patterns at the speed that the cutting load allows
        Deburr,
        /// Write the bank
        Export,
    }
    /// State of the controller
    pub enum State {
        /// Not enabled; velocity commands are zero
        Off,
        /// Holds the pose
        Idle,
        /// Moves to the start of the path
        Approach,
        /// Rests before a run
        Settle,
        /// Runs the path
        Run,
        /// Decelerates along its motion
        Stop,
        /// The task is done; holds the pose
        Done,
        /// A fault is active; holds the pose or, after DriveOff, commands zero velocity
        Fault,
        /// Draws the tool out of the workpiece after a fault
        Retract,
        /// Identifies the drives and the tool with small strokes in air
        Commission,
        /// Touches the workpiece to find its position
        Register,
    }
    /// Why the controller is in the state Fault
    #[reactions(Reaction,
        Retract = ["Stops along the planned motion, draws the tool out of the workpiece and holds the pose", "Rising edge of `reset_fault` at rest, after the cause is gone"],
        Stop = ["Stops along the planned motion and holds the pose", "Rising edge of `reset_fault` at rest"],
        DriveOff = ["Sets all velocity commands to zero and `drive_enable` to false", "Rising edge of `reset_fault` at rest, after the cause is gone; then the drives are enabled and nothing moves"])]
    pub enum Fault {
        /// No fault
        None,
        /// The speed override is not a number
        #[reaction(Retract)] #[detection("`speed_override` is NaN or infinite for more than `limits.lost_samples` samples; shorter gaps are bridged by its last value")]
        #[hint("Check the connection of `speed_override`.")] InvalidInput,
        /// An encoder position is implausible, or the encoder loses counts repeatedly
        #[reaction(DriveOff)] #[detection("Unreachable by twice the commanded motion for more than `limits.lost_samples` samples; or three steps or more to one side add up to `expert.limits.axisN.error_max`")]
        #[hint("Check the cable and the counter of the encoder.")] PositionJump,
        /// An encoder position does not change although the axis must have moved
        #[reaction(DriveOff)] #[detection("More than `expert.limits.axisN.error_max` of commanded motion without a change, for more than `limits.lost_samples` samples; or a noisy position stops flickering for longer than its noise explains")]
        #[hint("Check the encoder, its cable, the drive and its brake.")] PositionFrozen,
        /// An axis does not follow and its command oscillates
        #[reaction(DriveOff)] #[detection("A limit of `FollowingError` is exceeded while the velocity command has reversed at least three times")]
        #[hint("Decrease `expert.servo.gain`. Check that `io_delay` is the delay of the importing tool.")] Oscillation,
        /// An axis moves against its command
        #[reaction(DriveOff)] #[detection("A limit of `FollowingError` is exceeded and the axis did less than -0.2 of its commanded motion in the last samples")]
        #[hint("Change the sign of the velocity command or of the encoder.")] DriveSign,
        /// An axis does less than 0.7 of its commanded motion
        #[reaction(DriveOff)] #[detection("A limit of `FollowingError` is exceeded and the axis did less than 0.7 of its commanded motion in the last samples")]
        #[hint("Check the drive for force and speed limits and for a closed brake. Check `axisN.pulse` and `io_delay`.")] WeakDrive,
        /// The following error of an axis is too large
        #[reaction(DriveOff)] #[detection("For more than `limits.lost_samples` samples: farther than `expert.limits.axisN.error_max` + 0.5 V/Kp from the loop model, or + 2 V/Kp from the reference; or more than `rest_error` at rest")]
        #[hint("Check for a collision, `io_delay` and `axisN.pulse`. If it occurs at rest, trim the drive offset and check the encoder.")] FollowingError,
        /// With patterns, the control error of an axis is too large
        #[reaction(Retract)] #[detection("The control error exceeds `expert.limits.axisN.pattern_error` for more than `limits.lost_samples` samples in Playback or Deburr")]
        #[hint("Use the patterns of this machine: learn again, or set `expert.learn.from_bank` and continue learning.")] PatternMismatch,
        /// One or all axes respond with another delay than the configured one
        #[reaction(Retract)] #[detection("At the end of a run or lap: the accelerations fit a delay of 0 to 6 samples that is 0.75 samples or more from `io_delay`, with less than 0.8 of the residual")]
        #[hint("Set `io_delay` to the reported delay and learn again. If one axis differs, check its encoder link.")] WrongDelay,
        /// A learned pattern became too large
        #[reaction(Stop)] #[detection("A renewed pattern exceeds `expert.limits.pulses_max`; the bank keeps what was learned before")]
        #[hint("Use a larger encoder pulse or a learning law that converges.")] PatternTooLarge,
        /// There are no patterns for compensation
        #[reaction(Stop)] #[detection("Playback or Deburr starts with an empty bank")]
        #[hint("Run Learn, set `bank.import`, or set `expert.lookup.enable` = false.")] BankEmpty,
        /// The tool was too slow while deburring
        #[reaction(Retract)] #[detection("In the cut, `spindle_speed` is below `limits.spindle_speed_min` for more than `limits.lost_samples` samples")]
        #[hint("Start the tool before the task, or decrease the programmed speed.")] SpindleSlow,
        /// The tool speed did not change, so nothing was cut or its measurement is frozen
        #[reaction(Retract)] #[detection("At the end of the path or lap, or after `limits.idle_travel` without a cut, `spindle_speed` has not changed by `limits.spindle_change` for more than `limits.lost_samples` samples")]
        #[hint("Check that a part is loaded and that the tool-speed sensor responds. To permit it, set `limits.spindle_change` = 0.")] NoCut,
        /// The task took too long
        #[reaction(Retract)] #[detection("The task exceeds `expert.limits.cycle_time`, the identification `expert.commission.time`, or the registration `expert.register.time`; time on hold is not counted")]
        #[hint("Find what does not finish: an axis that never comes to rest, or a feed that is too slow.")] NoProgress,
        /// An encoder position is not a number
        #[reaction(DriveOff)] #[detection("NaN, infinite or out of range for more than `limits.lost_samples` samples; before the first valid sample immediately. Shorter gaps are bridged along the commands")]
        #[hint("Check the link to the encoder.")] PositionLost,
        /// The communication step is longer than the sample period
        #[reaction(DriveOff)] #[detection("Several samples share one set of inputs; found in the first sample of such a step")]
        #[hint("Set the communication step to `sample_period`. In model exchange, stop at every time event.")] LongStep,
        /// The tool-speed measurement no longer changes
        #[reaction(Retract)] #[detection("On the path, `spindle_speed` does not change for 0.5 s and for ten times its longest earlier interval without a reversal of two steps")]
        #[hint("Check the tool-speed sensor and its link.")] SpindleFrozen,
        /// The tool-speed measurement is not a number
        #[reaction(Retract)] #[detection("`spindle_speed` is NaN, infinite or out of range for more than `limits.lost_samples` samples; before the first valid sample immediately")]
        #[hint("Check the tool-speed sensor and its link.")] SpindleLost,
        /// The tool speed changed faster than physically possible while deburring
        #[reaction(Retract)] #[detection("In the cut, `spindle_speed` changes faster than `expert.limits.spindle_slew` for more than `limits.lost_samples` samples")]
        #[hint("Check for a stalled tool and check its speed sensor. Increase `expert.limits.spindle_slew` for a lighter tool.")] SpindleJump,
        /// The identified drive or tool parameters are too uncertain or out of range
        #[reaction(Stop)] #[detection("A gain or idle speed outside half to twice nominal or above `expert.commission.std_max`; a delay above 0.05 samples of uncertainty, unequal, or outside its range")]
        #[hint("Run the tool in air. Increase `commission.travel`. Check for friction and noise, `axisN.pulse`, `io_delay` and `load.idle_speed`.")] CommissionRejected,
        /// The path file has no touches
        #[reaction(Stop)] #[detection("`register` rises and the file of `path.file` lists no `touches`")]
        #[hint("Add at least four touches to the path file, on faces in two directions.")] NoTouches,
        /// The probe reached the end of a touch without contact
        #[reaction(Retract)] #[detection("No contact within 2 `approach_m` of a touch, or within `expert.register.retract` beyond the first contact")]
        #[hint("Check that a part is loaded, within `approach_m` of its programmed position, and that the probe responds.")] NoPart,
        /// The probe signals a contact where nothing should be
        #[reaction(Retract)] #[detection("`contact` is true for more than `limits.lost_samples` samples during the approach to a touch")]
        #[hint("Check the probe for a stuck contact. Increase `approach_m` of the touch or `transfer.clearance`.")] UnexpectedContact,
        /// The contact of the probe does not open
        #[reaction(Retract)] #[detection("`contact` is still true for more than `limits.lost_samples` samples after the probe has retracted")]
        #[hint("Check the probe for a stuck contact. Set `expert.register.retract` above the travel of the probe.")] ContactFrozen,
        /// The touches do not fit one position of the workpiece
        #[reaction(Stop)] #[detection("A touch is farther than `expert.limits.touch_residual` from the fitted position")]
        #[hint("Check the surface at that touch for chips and burrs. Check that the correct part is loaded.")] TouchMismatch,
        /// The workpiece is too far from its programmed position
        #[reaction(Stop)] #[detection("Displaced by more than `expert.limits.shift`, rotated by more than `expert.limits.angle`, or the robot cannot follow the displaced path")]
        #[hint("Place the part at its programmed position.")] Misplaced,
    }
    /// Control law; Paper does not change the bank format or the sign of load.k2
    pub enum Law {
        /// Identifies the drives in one run, learns the rest, keeps the best pattern, has preview
        Default,
        /// As published: plain repetitive control, last repetition kept, no preview
        Paper,
    }
    /// How a pattern is renewed after a repetition
    pub enum LearningLaw {
        /// Pattern plus error: the published repetitive control
        Plain,
        /// Pattern plus leading error, through a zero-phase low-pass
        LeadFilter,
        /// Pattern plus the optimal change for the nominal loop
        NormOptimal,
    }
    /// Format in which the bank is exported; not changed by law
    pub enum Format {
        /// All digits and a checksum
        Full,
        /// As published: 18 bytes per sample, in whole pulses
        Records,
    }
    /// Origin and storage of the control patterns
    pub enum BankStatus {
        /// There are no patterns
        Empty,
        /// Read from bank.import
        Imported,
        /// Learned, at least in part, and not written
        Learned,
        /// Written to bank.export
        Exported,
        /// Writing failed; the patterns remain in use
        ExportFailed,
        /// Computed from the nominal drives
        Computed,
    }
    /// Inputs, sampled at the start of the tick.
    #[inputs] pub struct Input {
        pub axis: [AxisInput; 6],
        /// Tool speed N
        #[var(unit = RADIAN_PER_SECOND as "rpm", start = 1885.0, accepts_nan)] pub spindle_speed: f64,
        pub mode: Mode,
        /// Enables the drives; false stops the motion, then sets the velocity commands to zero
        pub enable: bool,
        /// Decelerates and waits along the path; false continues
        pub hold: bool,
        /// Fraction of the programmed speed in DryRun, Playback and Deburr, limited to 0 to 1
        #[var(unit = ONE, start = 1.0, accepts_nan)] pub speed_override: f64,
        /// Rising edge in Idle or Done identifies drives and tool at rest; false aborts it
        pub commission: bool,
        /// Rising edge in Idle or Done touches the workpiece to locate it; false aborts it
        pub register: bool,
        /// The probe is in contact; used while the output probe is true
        pub contact: bool,
        /// Rising edge acknowledges a fault once the axes are at rest
        pub reset_fault: bool,
    }
    /// Inputs of one axis.
    pub struct AxisInput {
        /// Encoder position of axis {n} in the order column, height, arm, yaw, pitch, roll
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], accepts_nan)] pub position: f64,
    }
    /// Outputs; always finite.
    #[outputs] pub struct Output {
        pub axis: [AxisOutput; 6],
        /// A velocity command is at its limit
        #[var(local)] pub saturated: bool,
        pub state: State,
        pub fault: Fault,
        /// The drives may be enabled; false after a fault with reaction DriveOff: close the brakes
        #[var(start = true)] pub drive_enable: bool,
        pub path: PathOutput,
        #[var(local)] pub learn: LearnOutput,
        pub load: LoadOutput,
        pub bank: BankOutput,
        /// Details of the fault for its message.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
        pub measured: Measured,
        pub registration: Registration,
        /// Request to mount the probe in place of the tool, with the same tip
        pub probe: bool,
    }
    /// Position of the workpiece as found by touches, each value with its standard deviation; 0 before.
    pub struct Registration {
        /// The last registration succeeded and the path follows it; false when another starts
        pub valid: bool,
        /// Displacement of the workpiece along x, at the center of its touches
        #[var(local, unit = METRE as "mm")] pub x: f64,
        /// Standard deviation of the displacement along x
        #[var(local, unit = METRE as "um")] pub x_std: f64,
        /// Displacement of the workpiece along y, at the center of its touches
        #[var(local, unit = METRE as "mm")] pub y: f64,
        /// Standard deviation of the displacement along y
        #[var(local, unit = METRE as "um")] pub y_std: f64,
        /// Rotation of the workpiece about the vertical
        #[var(local, unit = RADIAN as "deg")] pub angle: f64,
        /// Standard deviation of the rotation
        #[var(local, unit = RADIAN as "deg")] pub angle_std: f64,
        /// Largest distance of a touch from the fitted position of the workpiece
        #[var(local, unit = METRE as "um")] pub residual: f64,
        /// Number of finished touches
        #[var(local)] pub touches: i32,
    }
    /// Results of the commissioning run, each with its standard deviation; 0 before.
    pub struct Measured {
        /// The last commissioning run succeeded; false when another starts
        pub valid: bool,
        /// Measured delay from command to action, mean of all axes, in samples, not rounded
        #[var(local, unit = ONE)] pub io_delay: f64,
        /// Standard deviation of the delay, for drives with a lag within 30 % of nominal
        #[var(local, unit = ONE)] pub io_delay_std: f64,
        /// Measured tool speed without load
        #[var(local, unit = RADIAN_PER_SECOND as "rpm")] pub idle_speed: f64,
        /// Standard deviation of the measured idle speed, including 12-bit resolution
        #[var(local, unit = RADIAN_PER_SECOND as "rpm")] pub idle_speed_std: f64,
        /// Standard deviation of one sample of the tool speed
        #[var(local, unit = RADIAN_PER_SECOND as "rpm")] pub spindle_noise: f64,
        /// Standard deviation of the measured noise of the tool speed
        #[var(local, unit = RADIAN_PER_SECOND as "rpm")] pub spindle_noise_std: f64,
        #[var(local)] pub axis: [MeasuredAxis; 6],
    }
    /// Results of one drive.
    pub struct MeasuredAxis {
        /// Measured velocity gain of drive {n}
        #[var(unit = ONE)] pub gain: f64,
        /// Standard deviation of the measured gain of drive {n}
        #[var(unit = ONE)] pub gain_std: f64,
        /// Measured lag of drive {n} in addition to measured.io_delay rounded
        #[var(unit = SECOND as "ms")] pub lag: f64,
        /// Standard deviation of the measured lag of drive {n}
        #[var(unit = SECOND as "ms")] pub lag_std: f64,
        /// Measured natural frequency of drive {n}; 0 where it is not observable
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub natural_frequency: f64,
        /// Standard deviation of the measured natural frequency of drive {n}
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub natural_frequency_std: f64,
        /// Measured displacement by which friction holds drive {n} back, F / (m wn^2)
        #[var(unit = JOINT[INDEX] as FINE[INDEX])] pub friction: f64,
        /// Standard deviation of the friction of drive {n}; 0.01 where it is not observable
        #[var(unit = JOINT[INDEX] as FINE[INDEX])] pub friction_std: f64,
        /// Measured delay from command to action of axis {n}, in samples, not rounded
        #[var(unit = ONE)] pub delay: f64,
        /// Standard deviation of the delay of axis {n}, for a lag within 30 % of nominal
        #[var(unit = ONE)] pub delay_std: f64,
    }
    /// Outputs of one axis.
    pub struct AxisOutput {
        /// Velocity command of axis {n}
        #[var(unit = RATE[INDEX])] pub velocity: f64,
        /// Reference r of axis {n}, in whole pulses
        #[var(local, unit = JOINT[INDEX] as SHOWN[INDEX])] pub reference: f64,
        /// Control error e of axis {n}
        #[var(local, unit = JOINT[INDEX] as SHOWN[INDEX])] pub error: f64,
        /// Compensation c of axis {n}, in whole pulses
        #[var(local, unit = JOINT[INDEX] as SHOWN[INDEX])] pub compensation: f64,
        /// RMS of the control error of axis {n} in the last finished repetition
        #[var(local, unit = JOINT[INDEX] as SHOWN[INDEX])] pub rms: f64,
        /// Largest control error of axis {n} in the last finished repetition
        #[var(local, unit = JOINT[INDEX] as SHOWN[INDEX])] pub peak: f64,
        /// Velocity gain of drive {n} as identified by Learn, otherwise as configured
        #[var(local, unit = ONE, start = 1.0)] pub gain: f64,
        /// Standard deviation of the gain of drive {n}; 0.3 where it is unknown
        #[var(local, unit = ONE, start = 0.3)] pub gain_std: f64,
        /// Lag of drive {n} beyond io_delay as identified by Learn, otherwise as configured
        #[var(local, unit = SECOND as "ms")] pub lag: f64,
        /// Standard deviation of the lag of drive {n}
        #[var(local, unit = SECOND as "ms")] pub lag_std: f64,
    }
    /// Position of the reference on the path.
    pub struct PathOutput {
        /// Distance L of the reference from the start of the path
        #[var(unit = METRE as "mm")] pub distance: f64,
        /// Speed V of the reference on the path
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub speed: f64,
        /// Number of the path block, from 1
        #[var(local, start = 1)] pub block: i32,
        /// Distance L* from the start of the path block
        #[var(local, unit = METRE as "mm")] pub block_distance: f64,
        /// Length of the path
        #[var(local, unit = METRE as "mm")] pub length: f64,
        /// Full laps of a cyclic path since the start of the run
        #[var(local)] pub laps: i32,
        /// The task is done and the robot is at rest
        #[var(local)] pub done: bool,
        /// Tip of the tool at the reference: x, y, z in the base frame
        #[var(local, unit = METRE as "mm")] pub tip: [f64; 3],
    }
    /// Progress of learning.
    pub struct LearnOutput {
        /// Number of the speed being learned, from 1; 0 before
        pub speed_index: i32,
        /// Number of the present repetition; 0 is the uncompensated servo
        pub repetition: i32,
        /// Repetition with the smallest error so far at this speed
        pub best: i32,
        /// RMS control error at the tip over all axes in the last finished repetition
        #[var(unit = METRE as "um")] pub cost: f64,
        /// All speeds are learned
        pub done: bool,
    }
    /// Cutting-load control.
    pub struct LoadOutput {
        /// Feed V_n that the cutting load allows, eq. 5
        #[var(local, unit = METRE_PER_SECOND as "mm/s")] pub feed: f64,
        /// The load is too high at the slowest feed for more than 0.2 s
        pub overload: bool,
    }
    /// Control patterns.
    pub struct BankOutput {
        pub status: BankStatus,
        /// Number of usable patterns
        #[var(local)] pub patterns: i32,
        /// Result of the last import or export of the bank
        #[var(local)] pub message: String,
    }
    /// All parameters.
    #[parameters] pub struct Parameters {
        pub law: Law,
        /// Sample period t of servo and learning
        #[var(unit = SECOND as "ms", range = 1e-3..=0.05, start = 0.01, source = "paper")] pub sample_period: f64,
        /// Samples between a command and its action: 1 with a standard master, 0 if immediate
        #[var(essential, range = 0..=DELAY_MAX as i32, start = 1, source = "default; the delay of a standard master. Tested up to 6")]
        pub io_delay: i32,
        pub axis: [Axis; 6],
        pub arm: Arm,
        /// Gain Kp of the position loop of each axis
        #[var(expert, name = "servo.gain", unit = PER_SECOND, range = 0.1..=100.0, start = [13.0; 6], source = "paper for axes 1 and 3; default for the others")]
        pub servo_gain: [f64; 6],
        pub transfer: Transfer,
        pub path: Path,
        pub feed: Feed,
        pub learn: Learn,
        /// Natural frequency of the nominal velocity loop, eq. 1
        #[var(expert, name = "model.natural_frequency", unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=1e5, start = 280.0, source = "paper")]
        pub model_natural_frequency: f64,
        /// Damping ratio of the nominal velocity loop, eq. 1
        #[var(expert, name = "model.damping", unit = ONE, range = 0.05..=5.0, start = 0.52, source = "paper")]
        pub model_damping: f64,
        #[var(expert)] pub model: DriveModel,
        #[var(expert)] pub lookup: Lookup,
        pub bank: Bank,
        pub load: Load,
        pub limits: Limits,
        pub commission: Commission,
        pub register: Register,
    }
    /// One axis.
    pub struct Axis {
        /// Encoder pulse q of axis {n}
        #[var(unit = JOINT[INDEX], range = 1e-9..=1e-2, start = PULSE[INDEX], source = "default; 5 um on axis 3 gives the 4 pulses of the paper's Fig. 2")]
        pub pulse: f64,
        /// Largest velocity command of axis {n}
        #[var(expert, unit = RATE[INDEX], range = 1e-3..=100.0, start = [3.0, 1.0, 1.5, 6.0, 6.0, 6.0][INDEX], source = "default; that of the plant")]
        pub velocity_max: f64,
        /// Lower end of the travel of axis {n}
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = -100.0..=100.0, start = [-3.2, -1.0, 0.1, -6.3, -6.3, -6.3][INDEX], source = "default; that of the plant")]
        pub minimum: f64,
        /// Upper end of the travel of axis {n}
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = -100.0..=100.0, start = [3.2, 1.0, 2.0, 6.3, 6.3, 6.3][INDEX], source = "default; that of the plant")]
        pub maximum: f64,
    }
    /// Nominal drives, in addition to the common natural frequency and damping.
    pub struct DriveModel {
        pub axis: [AxisModel; 6],
    }
    /// One drive.
    pub struct AxisModel {
        /// Nominal velocity gain of drive {n}: velocity over commanded velocity
        #[var(unit = ONE, range = 0.1..=10.0, start = 1.0, source = "paper: an ideal drive")] pub gain: f64,
        /// Lag 2 zeta / wn of drive {n} beyond io_delay; 0 for that of the nominal drive
        #[var(unit = SECOND as "ms", range = 0.0..=0.1, source = "derived: 2 zeta / wn of eq. 1; values below 10 us act as 10 us")]
        pub lag: f64,
        /// Natural frequency of drive {n}; 0 derives it from the lag and the nominal damping
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=1e5, source = "derived: 2 zeta / lag")]
        pub natural_frequency: f64,
        /// Displacement by which friction holds drive {n} back, F / (m wn^2)
        #[var(unit = JOINT[INDEX] as FINE[INDEX], range = 0.0..=FRICTION_MAX, source = "default; eq. 1 has no friction")]
        pub friction: f64,
    }
    /// Geometry of the robot.
    pub struct Arm {
        /// Height of the wrist above the base frame where axis 2 reads 0
        #[var(essential, unit = METRE as "mm", range = -10.0..=10.0, source = "default; that of the plant")]
        pub height: f64,
        /// Distance of the wrist from the column where axis 3 reads 0
        #[var(essential, unit = METRE as "mm", range = -10.0..=10.0, source = "default; that of the plant")]
        pub reach: f64,
        /// Distance from the wrist to the tip of the tool
        #[var(essential, unit = METRE as "mm", range = 0.0..=2.0, start = 0.2, source = "default; that of the plant")]
        pub tool_offset: f64,
    }
    /// Motion to the start of the path, and the rest there.
    pub struct Transfer {
        /// Shortest time of each leg of the motion to the start of the path
        #[var(expert, unit = SECOND, range = 0.1..=60.0, start = 1.5, source = "derived: the error is below one count after the rest")]
        pub time: f64,
        /// Rest before a run, with every axis within its error limit
        #[var(expert, unit = SECOND, range = 0.0..=60.0, start = 0.8, source = "derived: ten time constants 1/Kp")]
        pub settle_time: f64,
        /// Distance along the tool by which it leaves and enters the workpiece
        #[var(essential, unit = METRE as "mm", range = 0.0..=1.0, start = 0.02, source = "default; above burr and tool reach, 15 mm")]
        pub clearance: f64,
    }
    /// The programmed path.
    pub struct Path {
        /// JSON file of the path: a name in the folder resources or a full path; empty: path.json
        #[var(essential)] pub file: String,
        /// Programmed speed; 0 for that of the file
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 0.0..=2.0)] pub programmed_speed: f64,
    }
    /// Feed along the path.
    pub struct Feed {
        /// Acceleration and deceleration on the path
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.01..=50.0, start = 0.5, source = "default; moderate for the drives of the plant")]
        pub acceleration: f64,
        /// Samples of the moving average over the speed; 1 for none
        #[var(expert, range = 1..=32, start = 1, source = "default; none")] pub smoothing: i32,
    }
    /// Learning of the control patterns; the shape of a pattern (speeds, lead-in, lead-out) applies
    /// wherever one is used.
    pub struct Learn {
        #[var(expert, start = LearningLaw::NormOptimal, paper = LearningLaw::Plain, source = "derived")]
        pub law: LearningLaw,
        /// Learned multiples of the programmed speed: 0.01 to 1, descending, up to 9
        #[var(start = "1.0 0.8 0.6 0.4 0.2", source = "paper")] pub speeds: String,
        /// The values of the list.
        #[var(hidden, start = Speeds::PAPER)] pub factors: Speeds,
        /// Largest number of renewals of each pattern; 0 only identifies the drives
        #[var(range = 0..=100, start = 19, source = "paper")] pub repetitions: i32,
        /// Identify the drives in the first run and start from the patterns that they need
        #[var(expert, start = true, paper = false, source = "default; one run replaces most repetitions")]
        pub identify: bool,
        /// Error at the tip at which a speed is learned; 0 disables the test
        #[var(expert, unit = METRE as "mm", range = 0.0..=0.1, start = 3e-5, paper = 0.0, source = "default; a few counts")]
        pub tolerance: f64,
        /// Ratio by which a repetition must lower the smallest error; 0 disables the test
        #[var(expert, unit = ONE, range = 0.0..=0.9, start = 0.1, paper = 0.0, source = "default; smaller changes are quantization noise")]
        pub decrease: f64,
        /// Keep the pattern with the smallest error instead of the last one
        #[var(expert, start = true, paper = false, source = "paper, 5.1: \"abort the renewal\"")]
        pub stop_at_best: bool,
        /// Continue learning from the patterns of the bank instead of from zero
        #[var(expert, source = "default; true adapts a bank to another machine")] pub from_bank: bool,
        /// Samples that the error is read ahead, beyond io_delay; Plain and LeadFilter
        #[var(expert, range = -(DELAY_MAX as i32)..=8, start = 2, paper = 0, source = "derived")] pub lead: i32,
        /// Cut-off of the zero-phase filter; LeadFilter
        #[var(expert, unit = RADIAN_PER_SECOND as "Hz", range = 0.6..=2.5e3, start = 20.0 * TAU, source = "derived: 20 Hz")]
        pub bandwidth: f64,
        /// Weight lambda of the change of the pattern; NormOptimal
        #[var(expert, unit = ONE, range = 1e-6..=1e3, start = 0.01, source = "derived")] pub weight: f64,
        /// Samples of a pattern before the start of the path
        #[var(expert, range = 8..=100, start = 10, source = "default; at least lead and preview")] pub lead_in: i32,
        /// Samples of a pattern after the end of the path
        #[var(expert, range = 8..=500, start = 60, source = "default; 8 time constants 1/Kp")] pub lead_out: i32,
    }
    /// Use of the control patterns, eq. 2 to 4, in Playback and Deburr.
    pub struct Lookup {
        /// Compensate with the patterns in Playback and Deburr
        #[var(start = true, tunable)] pub enable: bool,
        /// Apply eq. 4 with the speed recorded at the distance instead of the nominal one
        #[var(start = true, source = "derived")] pub recorded_speed: bool,
        /// Time by which the feed is known before the reference, beyond io_delay
        #[var(unit = SECOND as "ms", range = -0.4..=0.4, start = 0.0037, paper = 0.0, source = "derived: the lag 2 zeta / wn of the velocity loop")]
        pub preview: f64,
    }
    /// Files of the control patterns.
    pub struct Bank {
        /// Bank to read at start: a name in the folder resources or a full path; empty: none
        #[var(essential)] pub import: String,
        /// Compute the patterns from the nominal drives while none are imported or learned
        #[var(source = "default; learned patterns suit the actual drive")] pub compute: bool,
        /// File to write the bank to after learning and on Export; empty: none
        #[var(essential)] pub export: String,
        #[var(expert)] pub format: Format,
    }
    /// Cutting-load control, eq. 5, in `Deburr`.
    pub struct Load {
        /// Regulate the feed by the cutting load in Deburr; false keeps the programmed speed
        #[var(expert, start = true, tunable)] pub enable: bool,
        /// Nominal tool speed without load, reference of the two other tool speeds
        #[var(essential, unit = RADIAN_PER_SECOND as "rpm", range = 10.0..=1e5, start = 18_000.0 * RPM, source = "default; 2 poles at 300 Hz")]
        pub idle_speed: f64,
        /// Active ratio of these two.
        #[var(hidden, start = 1.0)] pub scale: f64,
        /// Target tool speed N_nom
        #[var(essential, unit = RADIAN_PER_SECOND as "rpm", range = 10.0..=1e5, start = 17_300.0 * RPM, tunable, source = "paper: 17,300 rpm")]
        pub spindle_speed: f64,
        /// Gain K1 per 10 ms, the paper's sample period
        #[var(unit = METRE_PER_SECOND, range = 0.0..=10.0, start = 0.092, tunable, source = "derived: damped, and no stall up to 1.8 times the cutting force")]
        pub k1: f64,
        /// Gain K2 at the paper's sample period; a negative value is the unstable printed sign
        #[var(unit = METRE, range = -1.0..=1.0, start = 0.0138, tunable, source = "derived: K2 = tau K1 cancels the pole of the tool, tau = 0.15 s")]
        pub k2: f64,
        /// Slowest feed
        #[var(expert, unit = METRE_PER_SECOND as "mm/s", range = 0.0..=1.0, start = 0.004, tunable, source = "default; a 25th of the programmed speed")]
        pub speed_min: f64,
    }
    /// Bounds of the state `Commission`, and use of its results.
    pub struct Commission {
        /// Largest displacement of the tip by each axis; 0 derives it from speed and acceleration
        #[var(unit = METRE as "mm", range = 0.0..=0.5, source = "derived: 1.64 v^2 / a, 33 mm, at most 50 mm")]
        pub travel: f64,
        /// Largest acceleration of the tip; 0 for feed.acceleration
        #[var(expert, unit = METRE_PER_SECOND_SQUARED, range = 0.0..=50.0, source = "derived: that of the path")]
        pub acceleration: f64,
        /// Longest time of the commissioning run; 0 for 1.25 times its motions + 1 s
        #[var(expert, unit = SECOND, range = 0.0..=1e6, source = "derived: 1.25 times the motions + 1 s")]
        pub time: f64,
        /// Largest relative standard deviation of the measured gains and idle speed
        #[var(expert, unit = ONE, range = 1e-6..=0.5, start = 0.002, source = "default; 0.01 mm of the lag V/Kp at 100 mm/s across 45 degrees")]
        pub std_max: f64,
        /// Use the measured values in place of the configured ones, and compute the patterns
        #[var(source = "default; look at the results first")] pub apply: bool,
        /// JSON file of the derived parameters, written after a successful run; empty: none
        pub export: String,
    }
    /// Bounds of the state `Register`, and properties of the probe.
    pub struct Register {
        /// Speed towards the workpiece and back
        #[var(expert, unit = METRE_PER_SECOND as "mm/s", range = 1e-4..=0.05, start = 5e-3, source = "derived: 0.5 mm of travel after the contact")]
        pub speed: f64,
        /// Speed of the second touch, which is used for the fit
        #[var(expert, unit = METRE_PER_SECOND as "mm/s", range = 1e-5..=0.01, start = 1e-3, source = "derived: 10 um in a sample, 3 um of standard deviation")]
        pub touch_speed: f64,
        /// Distance by which the probe retracts between the two touches
        #[var(expert, unit = METRE as "mm", range = 1e-4..=0.05, start = 1e-3, source = "default; more than the travel after the contact")]
        pub retract: f64,
        /// Travel of the probe from its touch to its contact signal
        #[var(unit = METRE as "um", range = 0.0..=1e-3, source = "measured on a known face")] pub pretravel: f64,
        /// Standard deviation of a touch in addition to sampling and resolution
        #[var(expert, unit = METRE as "um", range = 0.0..=1e-3, start = 3e-6, source = "default; half a count of noise, and the probe")]
        pub touch_std: f64,
        /// Longest time of the registration; 0 for 1.25 times its motions + 1 s
        #[var(expert, unit = SECOND, range = 0.0..=1e6, source = "derived: 1.25 times the motions + 1 s")]
        pub time: f64,
    }
    /// Limits beyond which a fault is raised.
    pub struct Limits {
        #[var(expert)] pub axis: [AxisLimits; 6],
        /// Largest pattern value in pulses
        #[var(expert, unit = ONE, range = 1.0..=1e9, start = 32_767.0, source = "paper: 16 bits")] pub pulses_max: f64,
        /// Lowest tool speed while deburring
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 0.0..=1e5, start = 16_000.0 * RPM, tunable,
            source = "derived: an induction motor of 2.5 times its rated torque breaks down at 15,600 rpm")]
        pub spindle_speed_min: f64,
        /// Fastest possible change of the tool speed in the cut
        #[var(expert, unit = RADIAN_PER_SECOND_SQUARED, range = 1.0..=1e9, start = 2e4,
            source = "derived: 1e-3 kg.m2 stalled by 20 N.m, 25 times the breakdown torque")]
        pub spindle_slew: f64,
        /// Smallest change of the tool speed along a path that shows a cut; 0 disables the test
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 0.0..=1e5, start = 2.0,
            source = "derived: four counts of a 12-bit measurement, a twentieth of the slip at rated load")]
        pub spindle_change: f64,
        /// Longest distance on the path without a cut after the first one; 0 for any
        #[var(unit = METRE as "mm", range = 0.0..=1e3, source = "default; the gaps of the burr depend on the part")]
        pub idle_travel: f64,
        /// Consecutive invalid samples of an input that are bridged
        #[var(range = 1..=100, start = 3, source = "default; 3 mm of travel at 100 mm/s")] pub lost_samples: i32,
        /// Longest time of a task or lap without holds; 0 for twice the time at the slowest feed
        #[var(expert, unit = SECOND, range = 0.0..=1e6, source = "derived")] pub cycle_time: f64,
        /// Largest accepted displacement of a registered workpiece
        #[var(expert, unit = METRE as "mm", range = 1e-6..=0.1, start = 4e-3, source = "default; 2 mm in each direction and some rotation, within an approach of 5 mm")]
        pub shift: f64,
        /// Largest accepted rotation of a registered workpiece
        #[var(expert, unit = RADIAN as "deg", range = 1e-6..=1.0, start = 0.01, source = "default; 1 mm at 0.1 m")]
        pub angle: f64,
        /// Largest accepted distance of a touch from the fitted position
        #[var(expert, unit = METRE as "um", range = 1e-6..=0.01, start = 3e-5, source = "default; six standard deviations of a touch")]
        pub touch_residual: f64,
    }
    /// Limits of one axis.
    pub struct AxisLimits {
        /// Largest following error of axis {n} at rest; in motion part of the lag V/Kp is added
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = 1e-6..=10.0, start = [1.5e-3, 1e-3, 1e-3, 5e-3, 5e-3, 5e-3][INDEX],
            source = "default; 1 mm at the tip; the lag allows drives of 0.7 to 2 times their gain")]
        pub error_max: f64,
        /// Largest control error of axis {n} with patterns in Playback and Deburr
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = 1e-6..=10.0, start = [7.5e-4, 5e-4, 5e-4, 2.5e-3, 2.5e-3, 2.5e-3][INDEX],
            paper = [3e-3, 2e-3, 2e-3, 1e-2, 1e-2, 1e-2][INDEX], source = "paper: 0.5 mm; four times that for the published law")]
        pub pattern_error: f64,
        /// Largest mean error of axis {n} from its loop model in the rest after a run
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = 1e-9..=10.0, start = [7.5e-5, 5e-5, 5e-5, 2.5e-4, 2.5e-4, 2.5e-4][INDEX],
            source = "default; ten counts, which a drift of 0.65 mm/s causes")]
        pub rest_error: f64,
    }
}

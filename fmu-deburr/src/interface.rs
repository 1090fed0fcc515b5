//! Every variable of the FMU, told once.
//!
//! Sources: "paper" = Kimura, Mukai and Kobayashi; "derived" = follows from the equations; "our choice" = the paper is
//! silent. The axes are 1 column, 2 height, 3 arm, 4 yaw, 5 pitch and 6 roll of the wrist.

pub use variables::*;

// one line for a declaration, as in a table
#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use std::f64::consts::TAU;

    use control_blocks::DELAY_MAX;
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
    const TURN: Unit = RADIAN_PER_SECOND;
    const RATE: [Unit; 6] = [TURN, METRE_PER_SECOND, METRE_PER_SECOND, TURN, TURN, TURN];
    const PULSE: [f64; 6] = [TAU / 640e3, 2.5e-6, 5e-6, TAU / 400e3, TAU / 400e3, TAU / 400e3];
    const RPM: f64 = TAU / 60.0;
    /// Most way by which friction may hold a drive back, rad or m; the standard deviation where nothing tells it.
    pub const FRICTION_MAX: f64 = 0.01;

    /// What is asked for; a job begins when the mode changes to it while `enable` is true, and when `enable` rises
    /// for the first time or with a mode that has not changed meanwhile
    pub enum Mode {
        /// Hold the pose; a motion stops on its way
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
    /// What the controller is doing
    pub enum State {
        /// Not enabled: velocity commands are zero
        Off,
        /// Holds the pose
        Idle,
        /// Moves to the start of the path
        Approach,
        /// Rests before a run
        Settle,
        /// Runs the path
        Run,
        /// Stops on its way
        Stop,
        /// The job is done, holds the pose
        Done,
        /// Velocity commands are zero; `reset_fault` ends it at rest
        Fault,
        /// Draws the tool back out of the part after a fault
        Retract,
        /// Measures its drives with small motions about the place where it stands, in air, and comes back to it
        Commission,
        /// Touches the part to find where it lies
        Register,
    }
    /// Why the controller is in the state Fault
    pub enum Fault {
        /// No fault
        None,
        /// `speed_override` was NaN or infinite for more than `limits.lost_samples` samples
        #[hint("check what is wired to `speed_override`")] InvalidInput,
        /// The reading of an axis was for more than `limits.lost_samples` samples where the axis cannot be, or it loses counts again and again
        #[hint("look at the cable and the counter of the encoder")] ReadingJump,
        /// An axis was told to move and its reading stands, or a reading that flickered stands where nothing moves
        #[hint("does the encoder count, is the drive on and its brake open?")] FrozenReading,
        /// An axis does not follow, and its command swings from one side to the other
        #[hint("lower `servo.gain`, and see that `io_delay` is that of the importer")] Oscillation,
        /// An axis moves against its command
        #[hint("change the sign of the command or that of the encoder")] DriveSign,
        /// An axis does less than 0.7 of what it is told
        #[hint("is the drive at a limit of force or speed, does something brake, are `axisN.pulse` and `io_delay` right?")] WeakDrive,
        /// An axis was farther from its reference, or from where its loop brings it, than `limits.axisN.error_max` allows
        #[hint("did the tool collide, and are `io_delay` and `axisN.pulse` right? in the rest after a run: trim the offset of the drive, check the encoder")] FollowingError,
        /// With patterns an axis was farther from its reference than `limits.axisN.pattern_error`
        #[hint("patterns belong to a machine: learn on with `learn.from_bank`, or learn anew")] PatternMismatch,
        /// The axes, or one of them, answer after another number of samples, 0 to 6, than `io_delay`
        #[hint("set `io_delay` to it and learn anew; one axis alone: are its readings late?")] WrongDelay,
        /// A pattern became larger than `limits.pulses_max`
        #[hint("a larger pulse, or a law that converges")] PatternTooLarge,
        /// There is no pattern to compensate with
        #[hint("learn, name a `bank.import`, or switch `lookup.enable` off")] BankEmpty,
        /// The tool turned slower than `limits.spindle_speed_min` while deburring
        #[hint("start the tool before, or lower the taught speed")] SpindleSlow,
        /// The tool speed was the same all along the path, or for longer than `limits.idle_way` after a cut: nothing was cut, or its reading stands
        #[hint("is there a part, and does the speed sensor of the tool live? `limits.spindle_change` = 0 allows it, `limits.idle_way` a gap")] NoCut,
        /// The job took longer than `limits.job_time`
        #[hint("look at what does not come to its end: an axis that never stands, or a feed that is too slow")] NoProgress,
        /// The reading of an axis was NaN, infinite or absurd for more than `limits.lost_samples` samples, or before any good one
        #[hint("look at the link to the encoder")] LostReading,
        /// A step of the importer is longer than a sample: several samples have the same inputs, and of their commands the last alone is seen
        #[hint("co-simulation: set the communication step to `sample_period`; model exchange: the importer has to stop at every time event")] LongStep,
        /// The tool speed stands on the path and flickered before
        #[hint("does the speed sensor of the tool live, and its link?")] FrozenSpindle,
        /// The tool speed was NaN, infinite or absurd for more than `limits.lost_samples` samples, or before any good one
        #[hint("look at the speed sensor of the tool and its link")] LostSpindle,
        /// The tool speed changed faster than `limits.spindle_slew` while deburring, for more than `limits.lost_samples` samples
        #[hint("has the tool stalled? look at its speed sensor, or raise `limits.spindle_slew`")] SpindleJump,
        /// What the commission has measured of a drive or of the tool is not sure enough, or not what this controller can hold
        #[hint("is the tool on, and free? allow more `commission.travel`, look for friction, noise and readings that are late, and check `axisN.pulse`, `io_delay` and `load.idle_speed`")] CommissionRejected,
        /// The path has no `touches`
        #[hint("write at least four into `path.file`, on faces across each other")] NoTouches,
        /// A touch has come to the end of its way, and nothing was felt
        #[hint("is there a part, is it where it should be within `approach_m`, and does the probe live?")] NoPart,
        /// The probe felt something on its way to a touch, where nothing should be
        #[hint("does the contact of the probe stick? is the part farther out than `approach_m`, or lower than `transfer.clearance` thinks?")] UnexpectedContact,
        /// The probe is away from the part again and its contact stays
        #[hint("does the contact of the probe stick, and is `register.retract` more than its travel?")] FrozenContact,
        /// The touches do not fit together: a part that has only moved and turned would leave less than `limits.touch_residual`
        #[hint("is there a chip, a burr or another part at that touch?")] TouchMismatch,
        /// The part lies farther from where it was taught than `limits.shift` or `limits.turn`, or where the robot cannot follow the path
        #[hint("lay it where it was taught")] Misplaced,
    }
    /// Law in force; Paper leaves `bank.format` and the sign of `load.k2` alone
    pub enum Law {
        /// Drives identified in one run, what is left learned until it no longer falls, best repetition kept, feed known ahead of the reference
        Default,
        /// The paper's: plain repetitive control, last repetition kept, no preview
        Paper,
    }
    /// How a pattern is renewed after a repetition
    pub enum LearningLaw {
        /// Pattern plus error: the paper's repetitive control
        Plain,
        /// Pattern plus error read ahead, through a zero-phase low-pass
        LeadFilter,
        /// Pattern plus the change that is best for the nominal loop
        NormOptimal,
    }
    /// What `bank.export` is written as; the paper's Records by this parameter alone, not by `law`
    pub enum Format {
        /// All digits and a checksum
        Full,
        /// The paper's 18 bytes for each sample, in whole pulses
        Records,
    }
    /// Where the control patterns come from, or what became of them
    pub enum BankStatus {
        /// There are none
        Empty,
        /// Read from `bank.import`
        Imported,
        /// Learned, all or some of them, and not written
        Learned,
        /// Written to `bank.export`
        Exported,
        /// Not written; they are still here
        ExportFailed,
        /// Computed from the nominal drive
        Computed,
    }
    /// Inputs, sampled at the start of the tick.
    #[inputs] pub struct Input {
        pub axis: [AxisInput; 6],
        /// Tool speed N
        #[var(unit = RADIAN_PER_SECOND as "rpm", start = 1885.0, accepts_nan)] pub spindle_speed: f64,
        pub mode: Mode,
        /// The drives may move; false stops a motion on its way, then all velocity commands are zero; the stop and the
        /// retract of a fault go on to their end
        pub enable: bool,
        /// Slow down and stand on the way; false goes on
        pub hold: bool,
        /// Part of the taught speed in DryRun, Playback and Deburr, limited to 0 to 1
        #[var(unit = ONE, start = 1.0, accepts_nan)] pub speed_override: f64,
        /// Rising edge in `Idle` or `Done` measures the drives and the tool, once the axes are at rest; false, `hold`, no `enable` or
        /// another `mode` breaks off: decelerate, `Idle`
        pub commission: bool,
        /// Rising edge in `Idle` or `Done` touches the part to find where it lies, once the axes are at rest; false, `hold`, no `enable`
        /// or another `mode` breaks off: decelerate, `Idle`
        pub register: bool,
        /// The probe touches; counts while `probe` is true
        pub contact: bool,
        /// Rising edge ends a fault once the axes are at rest
        pub reset_fault: bool,
    }
    /// Inputs of one axis.
    pub struct AxisInput {
        /// Encoder reading of axis {n} (1 column, positive towards +y; 2 height; 3 arm; 4 yaw, 5 pitch, 6 roll of the wrist)
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], accepts_nan)] pub position: f64,
    }
    /// Outputs; always finite.
    #[outputs] pub struct Output {
        pub axis: [AxisOutput; 6],
        /// A velocity command is at its limit
        pub saturated: bool,
        pub state: State,
        pub fault: Fault,
        /// The drives may live; false from a fault that the drives cannot mend until its reset: then close the brakes
        #[var(start = true)] pub drive_enable: bool,
        pub path: PathOutput,
        pub learn: LearnOutput,
        pub load: LoadOutput,
        pub bank: BankOutput,
        /// What is told with the fault.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
        pub measured: Measured,
        pub registration: Registration,
        /// The probe is to stand in place of the tool, whose tip it has
        pub probe: bool,
    }
    /// Where the part lies, as it was found by touches, each number with its standard deviation; 0 before.
    pub struct Registration {
        /// The last registration came to its end, and the path follows it; false from the next one on
        pub valid: bool,
        /// Shift of the part along x, at the middle of its touches
        #[var(unit = METRE as "mm")] pub x: f64,
        /// Its standard deviation
        #[var(unit = METRE as "um")] pub x_deviation: f64,
        /// Shift of the part along y, at the middle of its touches
        #[var(unit = METRE as "mm")] pub y: f64,
        /// Its standard deviation
        #[var(unit = METRE as "um")] pub y_deviation: f64,
        /// Turn of the part about the vertical
        #[var(unit = RADIAN as "deg")] pub angle: f64,
        /// Its standard deviation
        #[var(unit = RADIAN as "deg")] pub angle_deviation: f64,
        /// Largest distance of a touch from where the part lies by all of them
        #[var(unit = METRE as "um")] pub residual: f64,
        /// Touches that are done
        pub touches: i32,
    }
    /// What the commission has measured, each with its standard deviation; 0 before.
    pub struct Measured {
        /// The last commission came to its end, and its results are good; false from the next one on
        pub valid: bool,
        /// Samples between a command and its action, not rounded: mean of all axes, less the lag of the nominal drive
        #[var(unit = ONE)] pub io_delay: f64,
        /// Its standard deviation, for drives whose lag is that of the nominal one within 30 %
        #[var(unit = ONE)] pub io_delay_deviation: f64,
        /// Tool speed without load
        #[var(unit = RADIAN_PER_SECOND as "rpm")] pub idle_speed: f64,
        /// Standard deviation of that, for a reading of 12 bits that goes to a quarter beyond the idle speed at most
        #[var(unit = RADIAN_PER_SECOND as "rpm")] pub idle_speed_deviation: f64,
        /// Noise of the reading of the tool speed, standard deviation of a sample
        #[var(unit = RADIAN_PER_SECOND as "rpm")] pub spindle_noise: f64,
        /// Standard deviation of that
        #[var(unit = RADIAN_PER_SECOND as "rpm")] pub spindle_noise_deviation: f64,
        pub axis: [MeasuredAxis; 6],
    }
    /// What was measured of one drive.
    pub struct MeasuredAxis {
        /// Velocity over commanded velocity of drive {n}
        #[var(unit = ONE)] pub gain: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub gain_deviation: f64,
        /// Lag of drive {n} beyond `measured.io_delay` in whole samples
        #[var(unit = SECOND as "ms")] pub lag: f64,
        /// Its standard deviation
        #[var(unit = SECOND as "ms")] pub lag_deviation: f64,
        /// Natural frequency of drive {n}; 0 where nothing tells it
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub natural_frequency: f64,
        /// Its standard deviation
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub natural_frequency_deviation: f64,
        /// Way by which friction holds drive {n} back, F / (m wn^2)
        #[var(unit = JOINT[INDEX] as FINE[INDEX])] pub friction: f64,
        /// Its standard deviation; 0.01 where the strokes do not tell it
        #[var(unit = JOINT[INDEX] as FINE[INDEX])] pub friction_deviation: f64,
        /// Samples between a command and its action on axis {n}, not rounded, less the lag of the nominal drive
        #[var(unit = ONE)] pub delay: f64,
        /// Its standard deviation, for a drive whose lag is that of the nominal one within 30 %
        #[var(unit = ONE)] pub delay_deviation: f64,
    }
    /// Outputs of one axis.
    pub struct AxisOutput {
        /// Velocity command of axis {n}
        #[var(unit = RATE[INDEX])] pub velocity: f64,
        /// Reference r of axis {n}, in whole pulses
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX])] pub reference: f64,
        /// Control error e of axis {n}
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX])] pub error: f64,
        /// Compensation c of axis {n}, in whole pulses
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX])] pub compensation: f64,
        /// Root mean square of the control error of axis {n} in the last finished repetition
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX])] pub rms: f64,
        /// Largest control error of axis {n} in the last finished repetition
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX])] pub peak: f64,
        /// Velocity over commanded velocity of drive {n}, as identified by `Learn`; before that, and where the axis hardly moves, of the drive as it is told
        #[var(unit = ONE, start = 1.0)] pub gain: f64,
        /// Standard deviation of that; 0.3 where nothing is known
        #[var(unit = ONE, start = 0.3)] pub gain_deviation: f64,
        /// Lag of drive {n} beyond `io_delay`, 2 zeta / wn of eq. 1, as identified by `Learn` or of the drive as it is told
        #[var(unit = SECOND as "ms")] pub lag: f64,
        /// Standard deviation of that
        #[var(unit = SECOND as "ms")] pub lag_deviation: f64,
    }
    /// Where the reference is on the path.
    pub struct PathOutput {
        /// Distance L of the reference from the start of the path
        #[var(unit = METRE as "mm")] pub distance: f64,
        /// Speed V of the reference on the path
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub speed: f64,
        /// Number of the block, from 1
        #[var(start = 1)] pub block: i32,
        /// Distance L* from the previous teaching point
        #[var(unit = METRE as "mm")] pub block_distance: f64,
        /// Length of the path
        #[var(unit = METRE as "mm")] pub length: f64,
        /// Full laps of a cyclic path since the run began
        pub laps: i32,
        /// The job is done and the robot stands
        pub done: bool,
        /// Tip of the tool that the reference stands for, x, y, z in the base frame
        #[var(unit = METRE as "mm")] pub tip: [f64; 3],
    }
    /// How the learning goes.
    pub struct LearnOutput {
        /// Number of the speed that is learned, from 1; 0 before
        pub speed_index: i32,
        /// Number of the present repetition; 0 is the bare servo
        pub repetition: i32,
        /// Repetition with the smallest error so far at this speed
        pub best: i32,
        /// Root mean square of the control error at the tip over all axes in the last finished repetition
        #[var(unit = METRE as "um")] pub cost: f64,
        /// All speeds are learned
        pub done: bool,
    }
    /// Cutting-load control.
    pub struct LoadOutput {
        /// Feed V_n that the cutting load allows, eq. 5
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub feed: f64,
        /// The slowest feed is still too fast for longer than `load.overload_time`
        pub overload: bool,
    }
    /// Control patterns.
    pub struct BankOutput {
        pub status: BankStatus,
        /// Number of patterns that can be used
        pub patterns: i32,
        /// What became of the last reading or writing of the bank
        pub message: String,
    }
    /// All parameters.
    #[parameters] pub struct Parameters {
        pub law: Law,
        /// Sample period t of servo and learning
        #[var(unit = SECOND as "ms", range = 1e-3..=0.05, start = 0.01, source = "paper")] pub sample_period: f64,
        /// Samples between a command and its action; 1 for a standard master, 0 if the command acts at once; above 6 it
        /// is not tested
        #[var(range = 0..=DELAY_MAX as i32, start = 1, source = "our choice: what a standard master does")] pub io_delay: i32,
        pub axis: [Axis; 6],
        pub arm: Arm,
        /// Gain Kp of the position loop of each axis
        #[var(name = "servo.gain", unit = PER_SECOND, range = 0.1..=100.0, start = [13.0; 6], source = "paper: axes 1 and 3; the others our choice")]
        pub servo_gain: [f64; 6],
        pub transfer: Transfer,
        pub path: Path,
        pub feed: Feed,
        pub learn: Learn,
        /// Natural frequency of the nominal velocity loop, eq. 1; for NormOptimal, `FollowingError` and `WrongDelay`
        #[var(name = "model.natural_frequency", unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=1e5, start = 280.0, source = "paper")]
        pub model_natural_frequency: f64,
        /// Damping ratio of the nominal velocity loop, eq. 1; for NormOptimal, `FollowingError` and `WrongDelay`
        #[var(name = "model.damping", unit = ONE, range = 0.05..=5.0, start = 0.52, source = "paper")] pub model_damping: f64,
        pub model: DriveModel,
        pub lookup: Lookup,
        pub bank: Bank,
        pub load: Load,
        pub limits: Limits,
        pub commission: Commission,
        pub register: Register,
    }
    /// One axis.
    pub struct Axis {
        /// Encoder pulse q of axis {n}
        #[var(unit = JOINT[INDEX], range = 1e-9..=1e-2, start = PULSE[INDEX], source = "our choice: 5 um on axis 3 gives the 4 pulses of the paper's Fig. 2")]
        pub pulse: f64,
        /// Largest velocity command of axis {n}
        #[var(unit = RATE[INDEX], range = 1e-3..=100.0, start = [3.0, 1.0, 1.5, 6.0, 6.0, 6.0][INDEX], source = "our choice")] pub velocity_max: f64,
        /// Lower end of the travel of axis {n}
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = -100.0..=100.0, start = [-3.2, -1.0, 0.1, -6.3, -6.3, -6.3][INDEX], source = "our choice")]
        pub minimum: f64,
        /// Upper end of the travel of axis {n}
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = -100.0..=100.0, start = [3.2, 1.0, 2.0, 6.3, 6.3, 6.3][INDEX], source = "our choice")]
        pub maximum: f64,
    }
    /// What is told of each drive beside `model.natural_frequency` and `model.damping`.
    pub struct DriveModel {
        pub axis: [AxisModel; 6],
    }
    /// One drive.
    pub struct AxisModel {
        /// Velocity over commanded velocity of drive {n}
        #[var(unit = ONE, range = 0.1..=10.0, start = 1.0, source = "paper: a drive does what it is told")] pub gain: f64,
        /// Lag 2 zeta / wn of drive {n} beyond `io_delay`; 0 for that of `model.natural_frequency` and `model.damping`
        #[var(unit = SECOND as "ms", range = 0.0..=0.1, source = "derived: 2 zeta / wn of eq. 1; below 10 us it is one of 10 us")] pub lag: f64,
        /// Natural frequency of drive {n}; 0 for the one that has this lag with `model.damping`
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=1e5, source = "derived: 2 zeta / lag")] pub natural_frequency: f64,
        /// Way by which Coulomb friction holds drive {n} back, F / (m wn^2); the patterns that are computed or identified make up for it
        #[var(unit = JOINT[INDEX] as FINE[INDEX], range = 0.0..=FRICTION_MAX, source = "eq. 1 has none")] pub friction: f64,
    }
    /// Geometry of the robot.
    pub struct Arm {
        /// Height of the wrist above the base frame where axis 2 reads 0
        #[var(unit = METRE as "mm", range = -10.0..=10.0, source = "our choice")] pub height: f64,
        /// Distance of the wrist from the column where axis 3 reads 0
        #[var(unit = METRE as "mm", range = -10.0..=10.0, source = "our choice")] pub reach: f64,
        /// Distance from the wrist to the tip of the tool
        #[var(unit = METRE as "mm", range = 0.0..=2.0, start = 0.2, source = "our choice")] pub tool_offset: f64,
    }
    /// Motion to the start of the path, and the rest there.
    pub struct Transfer {
        /// Shortest time of each leg of the motion to the start of the path
        #[var(unit = SECOND, range = 0.1..=60.0, start = 1.5, source = "derived: no count of error is left after the rest")] pub time: f64,
        /// Rest before a run: so long no axis is farther from its reference than `limits.axisN.error_max`
        #[var(unit = SECOND, range = 0.0..=60.0, start = 0.8, source = "derived: ten time constants 1/Kp")] pub settle_time: f64,
        /// Way along the tool by which it is drawn back out of the part, and from which it comes in
        #[var(unit = METRE as "mm", range = 0.0..=1.0, start = 0.02, source = "our choice: above burr and tool reach, 15 mm")] pub clearance: f64,
        /// Part of the largest velocities that these motions may use
        #[var(unit = ONE, range = 0.01..=1.0, start = 0.3, source = "our choice")] pub velocity_share: f64,
    }
    /// The taught path.
    pub struct Path {
        /// JSON file of the taught path, in the folder resources or with its whole path; empty for `path.json`
        pub file: String,
        /// Taught speed; 0 for that of the file
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 0.0..=2.0)] pub taught_speed: f64,
        /// Turn of the tangent at which the feed stops
        #[var(unit = RADIAN as "deg", range = 1e-3..=3.2, start = 0.2, source = "our choice")] pub corner: f64,
    }
    /// Feed along the path.
    pub struct Feed {
        /// Acceleration and deceleration on the path
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.01..=50.0, start = 0.5, source = "our choice")] pub acceleration: f64,
        /// Samples of the moving average over the speed; 1 for none
        #[var(range = 1..=32, start = 1, source = "our choice")] pub smoothing: i32,
    }
    /// Learning of the control patterns, in `Learn`; what a pattern is (`speeds`, `lead_in`, `lead_out`) counts wherever one is used.
    pub struct Learn {
        #[var(start = LearningLaw::NormOptimal, paper = LearningLaw::Plain, source = "derived")] pub law: LearningLaw,
        /// Multiples of the taught speed at which patterns are learned, 0.01 to 1, descending, up to 9
        #[var(start = "1.0 0.8 0.6 0.4 0.2", source = "paper")] pub speeds: String,
        /// What `speeds` lists.
        #[var(hidden, start = Speeds::PAPER)] pub factors: Speeds,
        /// Renewals of each pattern
        #[var(range = 0..=100, start = 19, source = "paper")] pub repetitions: i32,
        /// Identify the drives in the first run of the bare servo and begin with the patterns that they need; with no `repetitions` that is all
        #[var(start = true, paper = false, source = "our choice: a run in place of most repetitions")] pub identify: bool,
        /// Largest error of any axis at the tip with which a speed is learned; 0 for none
        #[var(unit = METRE as "mm", range = 0.0..=0.1, start = 3e-5, paper = 0.0, source = "our choice: a few counts")] pub tolerance: f64,
        /// Share by which a repetition has to lower the smallest error, or the speed is learned as it can be; 0 for any
        #[var(unit = ONE, range = 0.0..=0.9, start = 0.1, paper = 0.0, source = "our choice: below that the noise of the counts decides")] pub decrease: f64,
        /// Keep the pattern with the smallest error, not the last one
        #[var(start = true, paper = false, source = "paper, 5.1: \"abort the renewal\"")] pub stop_at_best: bool,
        /// Learn on from the patterns of the bank, not from zero
        #[var(source = "our choice: adapts a bank to another machine")] pub from_bank: bool,
        /// Samples that the error is read ahead, beyond `io_delay`; Plain and LeadFilter
        #[var(range = -(DELAY_MAX as i32)..=8, start = 2, paper = 0, source = "derived")] pub lead: i32,
        /// Cut-off of the zero-phase filter; LeadFilter
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.6..=2.5e3, start = 20.0 * TAU, source = "derived: 20 Hz")] pub bandwidth: f64,
        /// Weight lambda of the change of the pattern; NormOptimal
        #[var(unit = ONE, range = 1e-6..=1e3, start = 0.01, source = "derived")] pub weight: f64,
        /// Samples of a pattern before the start of the path
        #[var(range = 8..=100, start = 10, source = "our choice: at least lead and preview")] pub lead_in: i32,
        /// Samples of a pattern after the end of the path
        #[var(range = 8..=500, start = 60, source = "our choice: 8 time constants 1/Kp")] pub lead_out: i32,
    }
    /// Use of the control patterns, eq. 2 to 4, in `Playback` and `Deburr`.
    pub struct Lookup {
        /// Compensate with the patterns in Playback and Deburr
        #[var(start = true, tunable)] pub enable: bool,
        /// Eq. 4 with the speed recorded at the distance, not with the nominal one
        #[var(start = true, source = "derived")] pub recorded_speed: bool,
        /// Time by which the feed is known before the reference follows it, beyond `io_delay`; by as much more as a drive that
        /// `Learn` has identified is later than the nominal one
        #[var(unit = SECOND as "ms", range = -0.4..=0.4, start = 0.0037, paper = 0.0, source = "derived: the lag 2 zeta / wn of the velocity loop")]
        pub preview: f64,
    }
    /// Files of the control patterns.
    pub struct Bank {
        /// Bank that is read at initialisation, in the folder resources or with its whole path; empty for none
        pub import: String,
        /// Compute the patterns from the nominal drive at the start, as long as none are imported or learned
        #[var(source = "our choice: learned patterns suit the drive as it is")] pub compute: bool,
        /// File that the bank is written to after learning and on Export; empty for none
        pub export: String,
        pub format: Format,
    }
    /// Cutting-load control, eq. 5, in `Deburr`.
    pub struct Load {
        /// Regulate the feed by the cutting load in Deburr; false keeps the taught speed
        #[var(start = true, tunable)] pub enable: bool,
        /// Tool speed without load for which `load.spindle_speed` and `limits.spindle_speed_min` are told
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 10.0..=1e5, start = 18_000.0 * RPM, source = "our choice: 2 poles at 300 Hz")] pub idle_speed: f64,
        /// Share of these two that is in force.
        #[var(hidden, start = 1.0)] pub scale: f64,
        /// Target tool speed N_nom
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 10.0..=1e5, start = 17_300.0 * RPM, tunable, source = "paper: 17,300 rpm")] pub spindle_speed: f64,
        /// Gain K1 for each 10 ms, the paper's sample period
        #[var(unit = METRE_PER_SECOND, range = 0.0..=10.0, start = 0.092, tunable, source = "derived: calm, and no stall up to 1.8 times the cutting force")]
        pub k1: f64,
        /// Gain K2 at the paper's sample period; negative is the sign as printed in the paper, which destabilises and which `law` does not set
        #[var(unit = METRE, range = -1.0..=1.0, start = 0.0138, tunable, source = "derived: K2 = tau K1 cancels the pole of the tool, tau = 0.15 s")]
        pub k2: f64,
        /// Slowest feed
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 0.0..=1.0, start = 0.004, tunable, source = "our choice")] pub speed_min: f64,
        /// Time at the slowest feed that is an overload
        #[var(unit = SECOND, range = 0.0..=60.0, start = 0.2, tunable, source = "our choice")] pub overload_time: f64,
    }
    /// Bounds of the state `Commission`, and what becomes of its results.
    pub struct Commission {
        /// Farthest way of the tip with each axis from the place where it stands; 0 for what the taught speed and
        /// `feed.acceleration` need, at most 50 mm
        #[var(unit = METRE as "mm", range = 0.0..=0.5, source = "derived: 1.64 v^2 / a, 33 mm")] pub travel: f64,
        /// Largest acceleration of the tip, which is what the drives need force for; 0 for `feed.acceleration`
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.0..=50.0, source = "derived: that of the path")] pub acceleration: f64,
        /// Longest time; 0 for what its motions take, a quarter more and 1 s
        #[var(unit = SECOND, range = 0.0..=1e6, source = "derived: 1.25 times the motions + 1 s")] pub time: f64,
        /// Largest relative standard deviation of gains and idle speed; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-6..=0.5, start = 0.002, source = "our choice: 0.01 mm of the lag V/Kp at 100 mm/s across 45 degrees")] pub deviation_max: f64,
        /// Largest standard deviation of how late an axis is, delay and lag together, samples; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-4..=0.5, start = 0.05, source = "our choice: 0.5 ms, 0.01 mm at 0.35 m/s2")] pub delay_deviation_max: f64,
        /// Use what was measured in place of what was told, and compute the patterns with it
        #[var(source = "our choice: first look, then trust")] pub apply: bool,
        /// File that a good commission writes: JSON, the parameters that it derives; empty: none
        pub export: String,
    }
    /// Bounds of the state `Register`, and what is known of the probe.
    pub struct Register {
        /// Speed towards the part and back
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-4..=0.05, start = 5e-3, source = "derived: 0.5 mm of way after the contact")] pub speed: f64,
        /// Speed of the second touch, which counts
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-5..=0.01, start = 1e-3, source = "derived: 10 um in a sample, 3 um of deviation")] pub touch_speed: f64,
        /// Way back between both
        #[var(unit = METRE as "mm", range = 1e-4..=0.05, start = 1e-3, source = "our choice: more than the way after the contact")] pub retract: f64,
        /// Way of the probe from its touch to its contact
        #[var(unit = METRE as "um", range = 0.0..=1e-3, source = "touch a known face")] pub pretravel: f64,
        /// Standard deviation of a touch beside those of sample and count
        #[var(unit = METRE as "um", range = 0.0..=1e-3, start = 3e-6, source = "our choice: half a count of noise, and the probe")] pub deviation: f64,
        /// Longest time; 0 for what its motions take, a quarter more and 1 s
        #[var(unit = SECOND, range = 0.0..=1e6, source = "derived: 1.25 times the motions + 1 s")] pub time: f64,
    }
    /// What is a fault beyond.
    pub struct Limits {
        pub axis: [AxisLimits; 6],
        /// Largest pattern value in pulses
        #[var(unit = ONE, range = 1.0..=1e9, start = 32_767.0, source = "paper: 16 bits")] pub pulses_max: f64,
        /// Tool speed below which deburring is a fault, for more than `lost_samples`
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 0.0..=1e5, start = 16_000.0 * RPM, tunable,
            source = "derived: an induction motor of 2.5 times its rated torque breaks down at 15,600 rpm")]
        pub spindle_speed_min: f64,
        /// Fastest change of the tool speed while it cuts; what changes faster is a lost sample
        #[var(unit = RADIAN_PER_SECOND_SQUARED, range = 1.0..=1e9, start = 2e4,
            source = "derived: 1e-3 kg.m2 stalled by 20 N.m, 25 times the breakdown torque")]
        pub spindle_slew: f64,
        /// Change of the tool speed along a whole path below which nothing was cut; 0 allows that
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 0.0..=1e5, start = 2.0,
            source = "derived: four counts of a 12-bit reading, a twentieth of the slip at rated load")]
        pub spindle_change: f64,
        /// Longest way on the path without a cut after the first one, more than the longest gap of the burr; 0 for any
        #[var(unit = METRE as "mm", range = 0.0..=1e3, source = "our choice: any, because only the job knows its gaps")] pub idle_way: f64,
        /// Samples in a row for which an input that cannot be believed is bridged; one more is a fault
        #[var(range = 1..=100, start = 3, source = "our choice: at 100 mm/s the tool is blind for 3 mm")] pub lost_samples: i32,
        /// Longest time of a job, or of a lap of a cyclic path; time that is held does not count, nor at an override
        /// of 0 but for `Learn`, which has its own speeds.
        /// 0 for twice the time at the slowest feed, with motions to the start through the whole travel
        #[var(unit = SECOND, range = 0.0..=1e6, source = "derived")] pub job_time: f64,
        /// Shift of a registered part that is a fault
        #[var(unit = METRE as "mm", range = 1e-6..=0.1, start = 4e-3, source = "our choice: 2 mm each way and some turn, within an approach of 5 mm")] pub shift: f64,
        /// Turn of a registered part that is a fault
        #[var(unit = RADIAN as "deg", range = 1e-6..=1.0, start = 0.01, source = "our choice: 1 mm at 0.1 m")] pub turn: f64,
        /// Distance of a touch from where the part lies by all of them that is a fault
        #[var(unit = METRE as "um", range = 1e-6..=0.01, start = 3e-5, source = "our choice: six deviations of a touch")] pub touch_residual: f64,
    }
    /// What is a fault of one axis.
    pub struct AxisLimits {
        /// Difference of axis {n} from its reference, or from the model of its loop, that is a fault at rest; in motion
        /// twice and half the lag V/Kp of the bare servo more
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = 1e-6..=10.0, start = [1.5e-3, 1e-3, 1e-3, 5e-3, 5e-3, 5e-3][INDEX],
            source = "our choice: 1 mm at the tip; the lag is for drives of 0.7 to 2 times their gain; held at its peak")]
        pub error_max: f64,
        /// Control error of axis {n} with patterns in Playback and Deburr that is a fault
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = 1e-6..=10.0, start = [7.5e-4, 5e-4, 5e-4, 2.5e-3, 2.5e-3, 2.5e-3][INDEX],
            paper = [3e-3, 2e-3, 2e-3, 1e-2, 1e-2, 1e-2][INDEX], source = "paper: 0.5 mm; four times that for the law as printed")]
        pub pattern_error: f64,
        /// Mean difference of axis {n} from the model of its loop in the rest after a run that is a fault
        #[var(unit = JOINT[INDEX] as SHOWN[INDEX], range = 1e-9..=10.0, start = [7.5e-5, 5e-5, 5e-5, 2.5e-4, 2.5e-4, 2.5e-4][INDEX],
            source = "our choice: ten counts, which a reading that drifts by 0.65 mm/s has")]
        pub rest_error: f64,
    }
}

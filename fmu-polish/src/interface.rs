//! Every variable of the FMU, told once; the law sees the structs. The README tells what the sources mean.

#[fmi2_export::interface]
#[rustfmt::skip]
mod variables {
    use crate::axes::Axes;
    use crate::monitoring::numbers::Numbers;
    use control_blocks::DELAY_MAX;
    use fmi2_export::{Unit, units::*};
    const NEWTON_SECOND_PER_METRE: Unit = Unit::si("N.s/m", [1, 0, -1, 0, 0], &[]);
    const PER_SECOND: Unit = Unit::si("1/s", [0, 0, -1, 0, 0], &[]);
    const PER_SECOND_SQUARED: Unit = Unit::si("1/s2", [0, 0, -2, 0, 0], &[]);
    const METRE_SECOND: Unit = Unit::si("m.s", [0, 1, 1, 0, 0], &[]);

    /// What the controller is doing
    pub enum State {
        /// At rest; takes the zero of the force sensor after `enable`
        Idle,
        /// Moves along the first normal until the tool touches
        Approach,
        /// Builds up the force
        Settle,
        /// Follows the path
        Follow,
        /// Takes the force away
        Unload,
        /// Moves out along the normal
        Retract,
        /// At rest after the job
        Done,
        /// At rest, or moving out; `reset_fault` ends it
        Fault,
        /// Measures the machine above the begin of the path and on it; `commission` = false or a rising edge of `enable` ends it
        Commission,
    }
    /// Why the controller is in the state `Fault`
    pub enum Fault {
        /// No fault
        None,
        /// The norm of the force was above `limits.force`
        #[hint("look for a step in the surface, or slow the feed")] ForceLimit,
        /// The force was not settled within `settle.time_max`
        #[hint("lower `impedance.damping`, or `position.gain` if it works along the normal")] SettleTimeout,
        /// The force was below `limits.lost_force` for `limits.lost_time`
        #[hint("look for a drop in the surface, or raise `impedance.bandwidth` (without `impedance.adaptive`: lower `impedance.damping`)")] LostContact,
        /// An override was NaN or infinite for more samples than `limits.lost_samples`
        #[hint("check the wires of `feed_override` and `force_override`")] InvalidInput,
        /// The force does not point along the normals of the path: these are wrong, or the force is larger than it is shown
        #[hint("check the normals of the CL data, how the mold is set up, and the force sensor")] InvalidPath,
        /// No contact within `approach.travel_max`, nor `limits.approach_depth` below the begin of the path
        #[hint("move the tool closer before `enable`, or check the place of the mold and the force sensor")] ApproachTimeout,
        /// The tool was more than `limits.position_error` off along the path or beside it
        #[hint("check the drives, or lower `feed.velocity`")] PositionError,
        /// The position is outside `stroke`
        #[hint("check the origin of the path")] Stroke,
        /// `estop` was set
        EmergencyStop,
        /// The force was above `limits.tare_force` when the zero was taken
        #[hint("lift the tool before `enable`")] TareRejected,
        /// The tool was not above the begin of the path
        #[hint("move there before `enable`")] NotAtStart,
        /// The surface was further from the path than `limits.surface_error`
        #[hint("check how the mold is set up")] SurfaceError,
        /// A position was NaN, infinite or beyond any machine for more samples than `limits.lost_samples`
        #[hint("check the wires of the encoders")] LostReading,
        /// A position was where the machine cannot have come for more samples than `limits.lost_samples`
        #[hint("check shields and plugs of the encoders")] ReadingJump,
        /// An encoder stood while its axis was told to move by `limits.frozen_way`
        #[hint("check the plug of the encoder; if the axis itself stands, its drive")] FrozenReading,
        /// The force stood for `limits.still_time`, or did not answer the way into the mold
        #[hint("check the plug and the amplifier of the force sensor, and that the mold is no steeper against the path than `limits.surface_slope`")] FrozenForce,
        /// The force was at the end of `sensor.range`
        #[hint("take a larger sensor, or press less")] Saturation,
        /// The noise of the force was above `limits.force_noise`
        #[hint("check the shield of the force sensor")] NoisyForce,
        /// An axis was more than `limits.following_error` from where its pulses bring it
        #[hint("make `drive` and `io_delay` those of the machine, or look for what holds the axis")] FollowingError,
        /// An axis moves against its pulses
        #[hint("swap the sign of its pulses, or of its encoder")] DriveSign,
        /// An axis moves less far than its pulses say
        #[hint("make `pulses.size` that of the drives, and look for lost pulses; where `sliding.lengthened` is more than 0 lower `stick_slip.half_period_max`")] WeakDrive,
        /// The force swings about the wanted one, by more than `limits.force_error`, root mean square over 0.2 s
        #[hint("look for what delays the force sensor or the drives, and check that the CL data are of this mold; or lower `impedance.bandwidth`")] Oscillation,
        /// The force was off by more than `limits.force_error`, root mean square over 0.2 s
        #[hint("check that the CL data are of this mold, and how it is set up; where `sliding.lengthened` is more than 0 lower `stick_slip.half_period_max`")] ForceError,
        /// The stiffness that was found is not `stiffness.nominal` within `limits.stiffness_ratio`
        #[hint("check the scale of the force sensor and the tip, or tell their stiffness")] WrongStiffness,
        /// A parameter was tuned to where the force loop is not stable enough
        #[hint("raise `impedance.damping` or `force.integral_time`, or lower `impedance.gain`")] UnstableLoop,
        /// The force did not go within `settle.time_max`, or came back on the way out
        #[hint("look at the force sensor: its zero may have moved")] UnloadTimeout,
        /// The job took longer than `limits.job_time`
        #[hint("raise it, or `feed_override`")] NoProgress,
        /// The ball slid at less than 0.9 of `stick_slip.sliding`, with K_v and half period raised as far as `stick_slip.velocity_max`, `stick_slip.half_period_max` and the sweep let them
        #[hint("raise `stick_slip.half_period_max` or `stick_slip.velocity_max`, take a tip that is stiffer across its axis, or lower `stick_slip.sliding`; check scale and sign of the force across the tip, and `sensor.bandwidth`: a sensor that is slower than told shows less sliding")] NoSliding,
        /// The force was NaN, infinite or beyond any sensor for more samples than `limits.lost_samples`
        #[hint("check the wires of the force sensor")] LostForce,
        /// The force was farther from the last than the fastest motion can bring it for more samples than `limits.lost_samples`
        #[hint("check shield and plug of the force sensor, and what the tool has hit")] ForceJump,
        /// What the commission has measured is not sure enough, or not what this controller can hold
        #[hint("allow more `commission.travel` or `commission.force`, look for play and vibration, and check `stiffness.nominal`, `drive` and `io_delay`")] CommissionRejected,
        /// The communication step is longer than a sample: several samples have the same inputs, and of their commands the last alone is seen
        #[hint("set the communication step of the importer to `sample_period`")] LongStep,
    }
    /// Which law polishes; Paper takes the paper's value where there is one and the parameter was not set
    pub enum Law {
        /// What a good engineer would ship
        Default,
        /// As printed by Nagata and others (2010)
        Paper,
    }
    /// What of the measured force is controlled, eq. 5
    pub enum ForceMode {
        /// Its norm, friction included, as in the paper
        Norm,
        /// Its part along the normal
        Projected,
    }
    /// Where the stick-slip vector points
    pub enum Mode {
        /// No stick-slip
        Off,
        /// Position vector in the tangent plane, eqs. 12 to 15
        Paper,
        /// Normal cross tangent, always beside the path
        Cross,
    }
    /// Wave form of the linear sweep
    pub enum Wave {
        /// Square, as in the paper
        Square,
        /// Sine that travels equally far
        Sine,
    }
    /// Which way the stick-slip motion sweeps
    pub enum Sweep {
        /// To and fro along the stick-slip vector, as in the paper
        Linear,
        /// Round in the tangent plane, on a circle as wide as the linear sweep is long: never at rest
        Circular,
    }
    /// Where the feed comes from
    pub enum FeedSource {
        /// `feed.velocity`
        Parameter,
        /// FEDRAT in the CL file
        File,
    }
    /// What is read at the start of a sample
    #[inputs] pub struct Input {
        /// Rising edge starts a job: zero of the sensor, approach, ...; false ends it: the tool leaves
        pub enable: bool,
        /// Rising edge in `Idle` or `Done` begins the commission: the machine measures itself; false breaks it off
        pub commission: bool,
        /// Stops the motion at once, in contact too; this controller alone has it: its force stays when the motion stops
        pub estop: bool,
        /// Rising edge ends a fault, once the tool is at rest
        pub reset_fault: bool,
        /// Ball centre by the encoders in the work frame of the path
        #[var(fields = f64[x, y, z], unit = METRE as "mm", accepts_nan)] pub position: Axes,
        /// Raw force on the tool in the work frame
        #[var(fields = f64[x, y, z], unit = NEWTON, accepts_nan)] pub force: Axes,
        /// Factor of the feed, 0 to 2
        #[var(unit = ONE as "%", start = 1.0, accepts_nan)] pub feed_override: f64,
        /// Factor of the wanted force, 0 to 2
        #[var(unit = ONE as "%", start = 1.0, accepts_nan)] pub force_override: f64,
    }
    /// What a sample gives; always finite
    #[outputs] pub struct Output {
        pub velocity: VelocityOutput,
        /// Pulses of this sample; for communication steps of `sample_period` alone
        #[var(fields = i32[x, y, z])] pub pulses: Axes<i32>,
        /// Pulses since the beginning, complete at any communication step
        #[var(fields = i32[x, y, z])] pub counts: Axes<i32>,
        pub force: ForceOutput,
        /// Desired ball centre x_d
        #[var(fields = f64[x, y, z], unit = METRE as "mm")] pub desired: Axes,
        /// Unit normal o_d out of the material
        #[var(fields = f64[x, y, z], unit = ONE, start = Axes { x: 0.0, y: 0.0, z: 1.0 })] pub normal: Axes,
        /// Unit tangent t
        #[var(fields = f64[x, y, z], unit = ONE, start = Axes { x: 1.0, y: 0.0, z: 0.0 })] pub tangent: Axes,
        pub error: ErrorOutput,
        /// Encoder less where the pulses bring the axis
        #[var(fields = f64[x, y, z], unit = METRE as "um")] pub following: Axes,
        /// Part of the path that is done
        #[var(unit = ONE as "%")] pub progress: f64,
        pub state: State,
        pub fault: Fault,
        /// The drives are wanted; false from a fault that switches them off until it is reset
        #[var(start = true)] pub drive_enable: bool,
        /// The tool presses on the mold: the force law works and there is a force
        pub in_contact: bool,
        /// The whole path is polished and the tool retracted
        pub done: bool,
        /// Stiffness of tool and contact, estimated while the force builds up
        #[var(name = "stiffness.estimate", unit = NEWTON_PER_METRE as "N/mm")] pub stiffness_estimate: f64,
        pub sliding: SlidingOutput,
        pub misalignment: MisalignmentOutput,
        /// A part of the ripple cancellation, or of the learning from turn to turn, made it worse and has ended
        #[var(name = "ripple.frozen")] pub ripple_frozen: bool,
        /// Length of the path along the contact points
        #[var(name = "path.length", unit = METRE as "mm")] pub path_length: f64,
        pub measured: Measured,
        /// What is told with the fault.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
    }
    /// Commanded velocity and its parts.
    pub struct VelocityOutput {
        /// Velocity command, x, eq. 1
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub x: f64,
        /// Velocity command, y
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub y: f64,
        /// Velocity command, z
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub z: f64,
        /// Part of the force law v_normal, positive out of the material, eq. 3
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub normal: f64,
        /// Part of the feed v_t, of the ball centre, eq. 2
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub tangential: f64,
        /// Size of the part of the position feedback v_p, eq. 6
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub position: f64,
        /// Part of the stick-slip v_v with its sign, eq. 16; its size on a circle
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub stick_slip: f64,
    }
    /// Force of the law.
    pub struct ForceOutput {
        /// Controlled force: norm or normal part, without the zero of the sensor
        #[var(unit = NEWTON)] pub measured: f64,
        /// Wanted force F_d with its ramps
        #[var(unit = NEWTON)] pub setpoint: f64,
        /// Force error E_f, eq. 5
        #[var(unit = NEWTON)] pub error: f64,
    }
    /// Position error x_d - x.
    pub struct ErrorOutput {
        /// Position error x_d - x along t
        #[var(unit = METRE as "um")] pub tangential: f64,
        /// Position error along o_d x t
        #[var(unit = METRE as "um")] pub lateral: f64,
        /// Position error along o_d
        #[var(unit = METRE as "um")] pub normal: f64,
    }
    /// What the work of the axes against the lateral force says of the contact.
    pub struct SlidingOutput {
        /// Mean speed at which the ball slides, measured over 0.2 s or more, in whole periods of the stick-slip motion
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub speed: f64,
        /// Friction of the ball while it slides
        #[var(unit = NEWTON)] pub friction: f64,
        /// What is added to K_v so that the ball slides
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub added: f64,
        /// Samples that are added to `stick_slip.half_period` so that the ball slides
        pub lengthened: i32,
    }
    /// Estimated misalignment of the mold.
    pub struct MisalignmentOutput {
        /// Estimated shift of the mold
        #[var(name = "misalignment", fields = f64[x, y, z], unit = METRE as "um")] pub shift: Axes,
        /// Estimated rotation of the mold about x
        #[var(unit = RADIAN as "deg")] pub rx: f64,
        /// Estimated rotation of the mold about y
        #[var(unit = RADIAN as "deg")] pub ry: f64,
        /// Estimated rotation of the mold about z
        #[var(unit = RADIAN as "deg")] pub rz: f64,
    }
    /// What the commission has measured, each with its standard deviation; 0 before
    pub struct Measured {
        /// The last commission came to its end, and its results are good; false from the next one on
        pub valid: bool,
        /// Stiffness of tool and contact along the normal
        #[var(unit = NEWTON_PER_METRE as "N/mm")] pub stiffness: f64,
        /// Its standard deviation
        #[var(unit = NEWTON_PER_METRE as "N/mm")] pub stiffness_deviation: f64,
        /// Stiffness of the tip across the normal
        #[var(unit = NEWTON_PER_METRE as "N/mm")] pub lateral_stiffness: f64,
        /// Its standard deviation
        #[var(unit = NEWTON_PER_METRE as "N/mm")] pub lateral_stiffness_deviation: f64,
        /// Friction coefficient of the ball on the mold
        #[var(unit = ONE)] pub friction: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub friction_deviation: f64,
        /// How fast the loops of the drives are, `drive.position_gain` and `drive.velocity_bandwidth`, over what was told
        #[var(unit = ONE)] pub drive_gain: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub drive_gain_deviation: f64,
        /// Part of the velocity that the drives feed forward, through `drive.feedforward_bandwidth`
        #[var(unit = ONE)] pub feedforward: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub feedforward_deviation: f64,
        /// Samples between a command and its action, not rounded
        #[var(unit = ONE)] pub io_delay: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub io_delay_deviation: f64,
        /// Angle by which the force sensor is mounted turned about z
        #[var(unit = RADIAN as "deg")] pub sensor_rotation: f64,
        /// Its standard deviation
        #[var(unit = RADIAN as "deg")] pub sensor_rotation_deviation: f64,
        /// -1 where the force sensor counts its y the other way
        pub sensor_direction_y: i32,
        /// -1 where the force sensor counts its z the other way
        pub sensor_direction_z: i32,
    }
    /// What is set before the job, or tuned
    #[parameters] pub struct Parameters {
        pub law: Law,
        /// Sample period
        #[var(unit = SECOND as "ms", range = 2e-4..=5e-3, start = 1e-3, source = "paper")] pub sample_period: f64,
        /// Samples between a command and its action; 1 for a standard master, 0 if the command acts at once
        #[var(range = 0..=DELAY_MAX as i32, start = 1, source = "a standard FMI master")] pub io_delay: i32,
        /// Largest commanded velocity
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-3..=1.0, start = 0.05, source = "our choice")] pub velocity_max: f64,
        /// Stroke of the axes, the origin of the path in its middle
        #[var(fields = f64[x, y, z], unit = METRE as "mm", range = 1e-3..=10.0, start = Axes { x: 0.4, y: 0.3, z: 0.1 }, source = "paper")] pub stroke: Axes,
        /// Radius of the ball end
        #[var(name = "tool.radius", unit = METRE as "mm", range = 5e-5..=0.02, start = 0.5e-3, source = "paper: tip diameter 1 mm")] pub tool_radius: f64,
        /// Way of one pulse
        #[var(name = "pulses.size", unit = METRE as "um", range = 1e-9..=1e-4, start = 1e-6, source = "paper")] pub pulses_size: f64,
        /// Step of the encoders
        #[var(name = "encoder.resolution", unit = METRE as "um", range = 1e-9..=1e-4, start = 1e-6, source = "paper")] pub encoder_resolution: f64,
        pub drive: Drive,
        /// Bandwidth of the filter of the force sensor
        #[var(name = "sensor.bandwidth", unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=1e6, start = 1256.6, source = "our choice: 200 Hz")]
        pub sensor_bandwidth: f64,
        /// Largest force that the sensor can show on each axis
        #[var(name = "sensor.range", unit = NEWTON, range = 1.0..=1e5, start = 100.0, source = "our choice: a usual sensor")] pub sensor_range: f64,
        /// Step of the force sensor
        #[var(name = "sensor.resolution", unit = NEWTON, range = 1e-6..=10.0, start = 0.178, source = "paper: 1 um at 178 N/mm")] pub sensor_resolution: f64,
        /// Angle by which the force sensor is mounted turned about z: it shows a force along x at minus this angle
        #[var(name = "sensor.rotation", unit = RADIAN as "deg", range = -3.2..=3.2, source = "our choice: as the axes")] pub sensor_rotation: f64,
        /// -1 where the force sensor counts its y the other way
        #[var(name = "sensor.direction.y", range = -1..=1, start = 1, source = "our choice: as the axes")] pub sensor_direction_y: i32,
        /// -1 where the force sensor counts its z the other way
        #[var(name = "sensor.direction.z", range = -1..=1, start = 1, source = "our choice: as the axes")] pub sensor_direction_z: i32,
        pub path: Path,
        pub feed: Feed,
        pub force: Force,
        pub impedance: Impedance,
        /// Stiffness of tool and contact before it is estimated
        #[var(name = "stiffness.nominal", unit = NEWTON_PER_METRE as "N/mm", range = 1e3..=1e8, start = 178e3, source = "paper")] pub stiffness_nominal: f64,
        pub position: Position,
        pub stick_slip: StickSlip,
        pub ripple: Ripple,
        pub turns: Turns,
        pub misalignment: Misalignment,
        /// Time over which the zero of the sensor is averaged
        #[var(name = "tare.time", unit = SECOND, range = 1e-3..=10.0, start = 0.1, source = "our choice")] pub tare_time: f64,
        pub approach: Approach,
        pub settle: Settle,
        pub retract: Retract,
        pub limits: Limits,
        pub commission: Commission,
    }
    /// Linear model of an axis from its pulses to its position: position loop, velocity feedforward, velocity loop. It tells the
    /// phases of the ripple and the margin of the force loop, and `FollowingError` is measured from it.
    pub struct Drive {
        /// Gain of the position loop of the drives
        #[var(unit = PER_SECOND, range = 1.0..=1e4, start = 80.0, source = "our choice: usual AC servo")] pub position_gain: f64,
        /// Part of the velocity that the drives feed forward
        #[var(unit = ONE, range = 0.0..=1.0, start = 0.8, source = "our choice")] pub feedforward: f64,
        /// Bandwidth of the velocity feedforward
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 1.0..=1e5, start = 628.3, source = "our choice")] pub feedforward_bandwidth: f64,
        /// Bandwidth of the velocity loop
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=1e5, start = 500.0, source = "our choice")] pub velocity_bandwidth: f64,
        /// Integral action of the velocity loop
        #[var(unit = PER_SECOND, range = 0.0..=1e4, start = 60.0, source = "our choice")] pub velocity_integral: f64,
        /// Largest acceleration of the weakest axis, its force over what it moves, which a circular sweep and a sine must not need; 0: not told
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.0..=1e3, source = "our choice: not told")] pub acceleration_max: f64,
    }
    /// What a path may be.
    pub struct Path {
        /// CL file with contact points and normals, in the folder resources of the FMU or with its whole path; the start value is built in
        #[var(start = crate::path::built_in::NAME)] pub file: String,
        /// Steepest surface that is polished
        #[var(unit = RADIAN as "deg", range = 0.1..=1.5, start = 1.05, source = "our choice: 60 deg, the shank stays clear of the wall")] pub slope_max: f64,
    }
    /// Feed along the path.
    pub struct Feed {
        #[var(source = "our choice")] pub source: FeedSource,
        /// Velocity v_tangent of the contact point, eq. 2
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-6..=0.1, start = 2e-3, source = "our choice", tunable)] pub velocity: f64,
        /// Largest acceleration along the path
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 1e-3..=10.0, start = 0.05, source = "our choice")] pub acceleration: f64,
        /// Fastest turn of the direction of motion; slows the feed where the path bends
        #[var(unit = RADIAN_PER_SECOND, range = 1.0..=1e3, start = 25.0, source = "our choice: 5 % of the velocity loop")] pub turn_rate_max: f64,
    }
    /// Polishing force.
    pub struct Force {
        /// Desired polishing force F_d
        #[var(unit = NEWTON, range = 0.1..=100.0, start = 5.0, source = "our choice: 28 steps of the sensor", tunable)] pub target: f64,
        #[var(start = ForceMode::Projected, paper = ForceMode::Norm, source = "our choice")] pub mode: ForceMode,
        /// Low-pass of the measured force; 0 for none
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=1e5, source = "our choice")] pub filter_bandwidth: f64,
        /// Time T_i of the force integral; 0 for none
        #[var(unit = SECOND, range = 0.0..=100.0, start = 0.15, paper = 0.0, source = "measured", tunable)] pub integral_time: f64,
    }
    /// Impedance model M_d dv/dt + B_d v = - K_f E_f of eq. 4.
    pub struct Impedance {
        /// Desired mass M_d, eq. 4
        #[var(unit = KILOGRAM, range = 0.01..=1e4, start = 10.0, source = "our choice")] pub mass: f64,
        /// Desired damping B_d, eq. 4; with `impedance.adaptive` until the stiffness is known
        #[var(unit = NEWTON_SECOND_PER_METRE, range = 10.0..=1e7, start = 10e3, source = "derived: 17.7 rad/s at 178 N/mm", tunable)] pub damping: f64,
        /// Force feedback gain K_f, eq. 4
        #[var(unit = ONE, range = 0.0..=100.0, start = 1.0, source = "our choice", tunable)] pub gain: f64,
        /// After settling take the damping that the estimated stiffness needs for `impedance.bandwidth`
        #[var(start = true, paper = false, source = "our choice")] pub adaptive: bool,
        /// Wanted bandwidth of the force loop K_f k / B_d, with `impedance.adaptive`
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 1.0..=100.0, start = 35.0, source = "measured: with 80 the force oscillates")] pub bandwidth: f64,
    }
    /// Position feedback, eq. 6.
    pub struct Position {
        /// Gain K_p, eq. 6
        #[var(fields = f64[x, y, z], unit = PER_SECOND, range = 0.0..=200.0,
            start = Axes::all(5.0), paper = Axes { x: 0.0, y: 0.0, z: 1.0 }, source = "our choice", tunable)]
        pub gain: Axes,
        /// Integral gain K_i, the paper's over the sample period
        #[var(fields = f64[x, y, z], unit = PER_SECOND_SQUARED, range = 0.0..=1e4, source = "our choice", tunable)] pub integral: Axes,
        /// Limit of the integrated position error
        #[var(unit = METRE_SECOND, range = 0.0..=1.0, start = 0.2e-3, source = "our choice")] pub integral_max: f64,
        /// Switch S of the position feedback
        #[var(fields = bool[x, y, z], start = Axes::all(true), paper = Axes { x: false, y: false, z: true }, source = "our choice")] pub select: Axes<bool>,
        /// Position feedback in the tangent plane alone, so that force and position do not fight
        #[var(start = true, paper = false, source = "our choice")] pub projected: bool,
    }
    /// Stick-slip motion, eqs. 7 to 17.
    pub struct StickSlip {
        #[var(start = Mode::Cross, paper = Mode::Paper, source = "our choice")] pub mode: Mode,
        /// Velocity K_v, eq. 16, of a square wave; sine and circle sweep as far at pi / 2 times of it; 0 for no stick-slip motion
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 0.0..=0.1, start = 10e-3, source = "measured", tunable)] pub velocity: f64,
        /// Samples of one sign, 1 for eq. 17
        #[var(range = 1..=1000, start = 10, paper = 1, source = "measured: 1 does nothing")] pub half_period: i32,
        #[var(source = "paper")] pub sweep: Sweep,
        /// Wave form of the stick-slip velocity; a circular sweep has its own
        #[var(source = "paper")] pub wave: Wave,
        /// Least mean speed at which the ball is to slide, the feed included, by more K_v and longer half periods; 0 for none; nothing with a `stick_slip.ratio`
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 0.0..=0.1, start = 6e-3, paper = 0.0, source = "our choice: three times a feed of 2 mm/s", tunable)] pub sliding: f64,
        /// Largest K_v to which `stick_slip.sliding` raises it
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 0.0..=0.1, start = 20e-3, source = "our choice: ten times a feed of 2 mm/s")] pub velocity_max: f64,
        /// Half period (samples) to which `stick_slip.sliding` raises `stick_slip.half_period` where the ball slides too little at the largest K_v; 0 for none
        #[var(range = 0..=1000, source = "our choice")] pub half_period_max: i32,
        /// K_v over the feed, keeps the removal per length; 0 for `stick_slip.velocity`
        #[var(unit = ONE, range = 0.0..=100.0, source = "our choice", tunable)] pub ratio: f64,
    }
    /// Cancellation of the force ripple at the frequency of the stick-slip and twice that.
    pub struct Ripple {
        /// Rate at which the force ripple at the frequency of the stick-slip and twice that is cancelled; 0 for none
        #[var(unit = PER_SECOND, range = 0.0..=20.0, start = 3.0, paper = 0.0, source = "measured: 8 is unsafe with other drives")] pub gain: f64,
        /// Growth of a ripple that ends its cancellation
        #[var(unit = NEWTON, range = 0.01..=10.0, start = 0.3, source = "our choice")] pub growth_max: f64,
    }
    /// Learning of what repeats from turn to turn of the path.
    pub struct Turns {
        /// Share of the force error at the first four harmonics of a turn that is taken back per radian; 0 for none
        #[var(unit = ONE, range = 0.0..=0.5, start = 0.18, paper = 0.0, source = "measured: 0.3 swings, since the harmonics are so near")] pub gain: f64,
        /// Share of the ripple that turns with the path, of a sweep on a mold askew, that is taken back per radian; 0 for none
        #[var(unit = ONE, range = 0.0..=0.5, source = "measured: 0.09 halves the deviation on a mold askew, and another mold is found later")] pub ripple_gain: f64,
    }
    /// Estimate of a rigid misalignment of the mold and its feedforward.
    pub struct Misalignment {
        /// Estimate shift and rotation of the mold and feed them forward
        #[var(start = true, paper = false, source = "our choice")] pub enable: bool,
        /// Forgetting factor of the least squares
        #[var(unit = ONE, range = 0.99..=1.0, start = 0.99995, source = "measured: 20 s, shorter memories are noisy")] pub forgetting: f64,
    }
    /// Approach motion along the normal of the first point.
    pub struct Approach {
        /// Velocity of the approach
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-5..=0.01, start = 0.5e-3, source = "our choice; measured: 2 mm/s overshoots")] pub velocity: f64,
        /// Force that is a contact
        #[var(unit = NEWTON, range = 0.05..=50.0, start = 0.6, source = "our choice: three steps of the sensor")] pub contact_force: f64,
        /// Samples in a row above it
        #[var(range = 1..=100, start = 3, source = "our choice")] pub contact_samples: i32,
        /// Longest way without contact
        #[var(unit = METRE as "mm", range = 1e-5..=0.1, start = 2e-3, source = "our choice")] pub travel_max: f64,
    }
    /// Building up of the force, and its end.
    pub struct Settle {
        /// Time in which the wanted force rises to `force.target` and falls to 0
        #[var(unit = SECOND, range = 1e-3..=10.0, start = 0.2, source = "our choice")] pub ramp_time: f64,
        /// Force error that is settled, part of `force.target`
        #[var(unit = ONE as "%", range = 0.01..=0.5, start = 0.15, source = "our choice")] pub tolerance: f64,
        /// Time for which the error must stay there
        #[var(unit = SECOND, range = 1e-3..=10.0, start = 0.1, source = "our choice")] pub hold_time: f64,
        /// Longest time of settling and of unloading
        #[var(unit = SECOND, range = 0.01..=60.0, start = 2.0, source = "our choice")] pub time_max: f64,
    }
    /// Retract motion along the normal.
    pub struct Retract {
        /// Distance of the retract
        #[var(unit = METRE as "mm", range = 1e-5..=0.1, start = 0.5e-3, source = "our choice")] pub distance: f64,
        /// Velocity of the retract
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-5..=0.1, start = 5e-3, source = "our choice")] pub velocity: f64,
    }
    /// What is a fault.
    pub struct Limits {
        /// Largest force
        #[var(unit = NEWTON, range = 0.5..=1e3, start = 25.0, source = "our choice")] pub force: f64,
        /// Force below which contact is lost
        #[var(unit = NEWTON, range = 0.0..=50.0, start = 0.4, source = "our choice")] pub lost_force: f64,
        /// Time below that force that is a fault
        #[var(unit = SECOND, range = 1e-3..=10.0, start = 0.1, source = "our choice")] pub lost_time: f64,
        /// Largest position error along the path or beside it
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 0.5e-3, source = "our choice")] pub position_error: f64,
        /// Largest distance of the surface from the path along the normal
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 0.5e-3, source = "our choice")] pub surface_error: f64,
        /// Largest angle between the mean force and the normal, friction to either side counted: 0.6 rad are a friction of 0.68
        #[var(unit = RADIAN as "deg", range = 0.1..=3.0, start = 0.6, source = "derived: friction alone gives 22 deg at 0.4, the rest for normals")] pub force_angle: f64,
        /// Largest force that may be a zero of the sensor
        #[var(unit = NEWTON, range = 0.1..=100.0, start = 2.0, source = "our choice: the tip weighs 0.1 N")] pub tare_force: f64,
        /// Largest distance beside the begin of the path, and below it
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 0.1e-3, source = "our choice: one winding")] pub start_offset: f64,
        /// Largest depth below the begin of the path without a contact
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 0.13e-3, source = "derived: a dead sensor lets the tool press so far, 23 N at 178 N/mm")] pub approach_depth: f64,
        /// Samples in a row for which an input that cannot be believed is bridged; one more is a fault
        #[var(range = 1..=100, start = 5, source = "derived: 5 ms at `approach.velocity` are 0.4 N")] pub lost_samples: i32,
        /// Way that an encoder or the force may leave unanswered, beyond one and a half steps of it
        #[var(unit = METRE as "um", range = 1e-6..=1e-2, start = 20e-6, source = "derived: a fifth of the stick-slip motion; 3.6 N at 178 N/mm")] pub frozen_way: f64,
        /// Time for which the force may stand to the bit; 0 for a sensor without noise
        #[var(unit = SECOND, range = 0.0..=10.0, start = 0.25, source = "derived: 250 samples of 0.05 N in a step of 0.178 N, once in 3e8 windows")] pub still_time: f64,
        /// Largest standard deviation of the noise of the force
        #[var(unit = NEWTON, range = 1e-3..=100.0, start = 0.35, source = "measured: six times 0.05 N still polishes well")] pub force_noise: f64,
        /// Largest distance of an axis from where its pulses bring it
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 0.1e-3, source = "our choice: one winding; drives without feedforward need half")] pub following_error: f64,
        /// Largest force error while the path is followed, root mean square over 0.2 s; 0 for a fifth of `force.target`
        #[var(unit = NEWTON, range = 0.0..=100.0, source = "measured: over robots and molds the law as printed has 0.68 N, another mold 1.25 N")] pub force_error: f64,
        /// Largest ratio of the stiffness that is found and the nominal one, either way; 4 for any
        #[var(unit = ONE, range = 1.0..=4.0, start = 2.2, source = "measured: tips and woods from 92 to 242 N/mm")] pub stiffness_ratio: f64,
        /// Steepest slope of the surface against the path
        #[var(unit = ONE, range = 1e-3..=1.0, start = 0.1, source = "our choice: a mold that is 6 deg askew")] pub surface_slope: f64,
        /// Longest time of a job; 0 for the time it plans without overrides, four times the path
        #[var(unit = SECOND, range = 0.0..=1e6, source = "derived: tare, way down, settling, unloading, way out, and the path")] pub job_time: f64,
    }
    /// Bounds of the state `Commission`, and what becomes of its results
    pub struct Commission {
        /// Farthest way beside and above where it begins; 0: what an excitation at half of `velocity_max` takes
        #[var(unit = METRE as "um", range = 0.0..=0.01, source = "derived: four times the reach of the excitation")] pub travel: f64,
        /// Force with which it presses; 0: `force.target`
        #[var(unit = NEWTON, range = 0.0..=100.0, source = "derived: stiffness and friction are those of the job")] pub force: f64,
        /// Longest time; 0: what its motions take, a quarter more and 1 s
        #[var(unit = SECOND, range = 0.0..=1e6, source = "derived: 1.25 times the motions + 1 s")] pub time: f64,
        /// Largest relative standard deviation of stiffness, friction and drive, beside what guides leave to the drive, and that of the rotation in rad; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-6..=0.5, start = 0.1, source = "our choice: a tenth is what the law bears without notice")] pub deviation_max: f64,
        /// Largest standard deviation of the delay, samples; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-3..=2.0, start = 0.25, source = "our choice: two of them to the next half sample")] pub delay_deviation_max: f64,
        /// Use what was measured in place of what was told
        #[var(source = "our choice: first look, then trust")] pub apply: bool,
        /// File that a good commission writes: JSON, the parameters that it derives; empty: none
        pub export: String,
    }
}

pub use variables::*;

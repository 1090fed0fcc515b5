//! Every variable of the FMU, declared once; the controller sees the structs. `doc/variables.md` lists them.

#[fmi2_export::interface]
#[rustfmt::skip]
mod variables {
    use crate::axes::Axes;
    use crate::monitoring::numbers::Numbers;
    use control_blocks::{DELAY_MAX, Reaction};
    use fmi2_export::{Unit, units::*};
    const NEWTON_SECOND_PER_METRE: Unit = Unit::si("N.s/m", [1, 0, -1, 0, 0], &[]);
    const PER_SECOND: Unit = Unit::si("1/s", [0, 0, -1, 0, 0], &[]);
    const PER_SECOND_SQUARED: Unit = Unit::si("1/s2", [0, 0, -2, 0, 0], &[]);

    /// Step of the operating sequence
    pub enum State {
        /// At rest; takes the zero of the force sensor after enable
        Idle,
        /// Moves along the first normal until the tool touches
        Approach,
        /// Builds up the force
        Settle,
        /// Follows the path
        Follow,
        /// Takes the force away
        Unload,
        /// Lifts the tool along the normal
        Retract,
        /// At rest after the cycle
        Done,
        /// Fault reaction in progress or complete; reset_fault acknowledges it
        Fault,
        /// Measures the machine above the start of the path and on the mold
        Commission,
    }
    /// Why the controller is in the fault state
    #[reactions(Reaction,
        Retract = ["Lifts the tool along the last normal by `retract.distance`, by pulses alone, and holds", "Rising edge of `reset_fault` at rest"],
        Stop = ["Sends no more pulses; the drives stay enabled, and a force on the mold stays", "Rising edge of `reset_fault` at rest"],
        DriveOff = ["Sends no more pulses and sets `drive_enable` to false; the axes coast", "Rising edge of `reset_fault`"])]
    pub enum Fault {
        /// No fault
        None,
        /// The force exceeded its limit
        #[reaction(Retract)] #[detection("Norm of the force above `limits.force` during approach, settling, path or unloading")] #[hint("Check the surface for a step, or reduce `feed.velocity`.")]
        ForceLimit,
        /// The force did not settle in time
        #[reaction(Retract)] #[detection("State `Settle` lasts longer than `expert.settle.time_max`")] #[hint("Reduce `impedance.damping`. If `expert.position.gain` acts along the normal, reduce it.")]
        SettleTimeout,
        /// The tool lost contact with the mold
        #[reaction(Retract)] #[detection("Force below `expert.limits.lost_force` for `expert.limits.lost_time` while the path is followed")] #[hint("Check the surface for a drop, or increase `impedance.bandwidth`. Without `expert.impedance.adaptive` reduce `impedance.damping`.")]
        ContactLost,
        /// An override is not a finite number
        #[reaction(Retract)] #[detection("`feed_override` or `force_override` NaN or infinite for more than `expert.limits.lost_samples` samples")] #[hint("Check the connections of `feed_override` and `force_override`.")]
        InvalidInput,
        /// The force does not point along the normals of the path
        #[reaction(Retract)] #[detection("Mean force more than `expert.limits.force_angle` from the normal, friction included, during settling or path")] #[hint("Check the normals of the CL data, the position of the mold, and the force sensor.")]
        InvalidPath,
        /// There was no contact where the mold was expected
        #[reaction(Retract)] #[detection("No contact within `approach.travel_max`, or the tool more than `limits.approach_depth` below the start of the path")] #[hint("Start closer to the mold. Check the position of the mold and the force sensor.")]
        ApproachTimeout,
        /// The tool left the path
        #[reaction(Retract)] #[detection("Error along or across the path above `limits.position_error` while the path is followed")] #[hint("Check the drives, or reduce `feed.velocity`.")]
        PositionError,
        /// The position is outside the stroke of the machine
        #[reaction(Stop)] #[detection("A position outside `stroke` while the machine moves or the sensor zero is taken")] #[hint("Check the origin of the path and the unit of `position`.")]
        Stroke,
        /// An emergency stop was requested
        #[reaction(Stop)] #[detection("`estop` is true")] #[hint("Clear the cause of the stop, then set `estop` to false.")]
        EmergencyStop,
        /// A force acted on the tool while the sensor zero was taken
        #[reaction(Stop)] #[detection("Norm of the mean raw force above `expert.limits.tare_force` over `expert.tare.time`")] #[hint("Lift the tool before `enable`.")]
        TareRejected,
        /// The tool was not above the start of the path
        #[reaction(Stop)] #[detection("Tool more than `expert.limits.start_offset` laterally from the start of the path, or below it, when the sensor zero is known")] #[hint("Move the tool to the start of the path before `enable`.")]
        NotAtStart,
        /// The surface is not where the path expects it
        #[reaction(Retract)] #[detection("Surface more than `limits.surface_error` from the path along the normal, during settling or path")] #[hint("Check the position of the mold.")]
        SurfaceError,
        /// A position is missing
        #[reaction(DriveOff)] #[detection("Position NaN, infinite or beyond any machine for more than `expert.limits.lost_samples` consecutive samples")] #[hint("Check the connections of the encoders.")]
        PositionLost,
        /// A position is implausible
        #[reaction(DriveOff)] #[detection("Position farther from the last one than `velocity_max` allows, for more than `expert.limits.lost_samples` samples; shorter outliers are bridged")] #[hint("Check shields and connectors of the encoders.")]
        PositionJump,
        /// A position does not change although the axis must have moved
        #[reaction(DriveOff)] #[detection("Encoder within 1.5 steps while the drive model moves by `expert.limits.frozen`, and at least half of that away from the model")] #[hint("Check the encoder and its cable. If the axis is at rest, check its drive.")]
        PositionFrozen,
        /// The force does not change although the tool moves or noise is expected
        #[reaction(Retract)] #[detection("Loaded sensor axis identical for `expert.limits.frozen_time`, or within 1.5 steps while the tool moves deeper than `expert.limits.frozen`, `limits.surface_slope` and noise explain")] #[hint("Check connector and amplifier of the force sensor. Compare the slope of the mold with `limits.surface_slope`.")]
        ForceFrozen,
        /// The force sensor reached the end of its range
        #[reaction(Retract)] #[detection("A raw force at `sensor.range`")] #[hint("Use a sensor with a larger range, or reduce `force.target`.")]
        Saturation,
        /// The force signal is too noisy
        #[reaction(Retract)] #[detection("Standard deviation of the noise, from second differences of the force, above `limits.force_noise`")] #[hint("Check the shield of the force sensor.")]
        NoisyForce,
        /// An axis is not where its pulses move it
        #[reaction(DriveOff)] #[detection("Position more than `expert.limits.following_error` from the drive model, and neither `DriveSign` nor `WeakDrive`")] #[hint("Check what blocks the axis. Compare `drive.*` and `io_delay` with the machine.")]
        FollowingError,
        /// An axis moves against its pulses
        #[reaction(DriveOff)] #[detection("As `FollowingError`, with a measured motion below -0.2 of the commanded motion")] #[hint("Invert the pulses of the axis, or its encoder.")]
        DriveSign,
        /// An axis moves less than its pulses command
        #[reaction(DriveOff)] #[detection("As `FollowingError`, with a measured motion below 0.5 of the commanded motion")] #[hint("Compare `pulses.size` with the drives and check for lost pulses. If `sliding.lengthened` > 0, reduce `stick_slip.half_period_max`.")]
        WeakDrive,
        /// The force oscillates
        #[reaction(Retract)] #[detection("As `ForceError`, after three sign changes of the error that are faster than the path can turn")] #[hint("Check the delays of sensor and drives, and the CL data. Otherwise reduce `impedance.bandwidth`.")]
        Oscillation,
        /// The force deviates from its target
        #[reaction(Retract)] #[detection("Force error above `expert.limits.force_error`, root mean square over 0.2 s, while the path is followed")] #[hint("Check CL data and position of the mold. If `sliding.lengthened` > 0, reduce `stick_slip.half_period_max`.")]
        ForceError,
        /// The contact stiffness differs from its nominal value
        #[reaction(Retract)] #[detection("Estimated stiffness above `expert.limits.stiffness_ratio` times the nominal one, or below its reciprocal")] #[hint("Check the scale of the force sensor and the tip, or set `stiffness.nominal`.")]
        WrongStiffness,
        /// A tuned parameter makes the force control unstable
        #[reaction(Retract)] #[detection("Phase margin of the force control below 25 degrees while it is active")] #[hint("Increase `impedance.damping` or `expert.force.integral_time`, or reduce `expert.impedance.gain`.")]
        UnstableLoop,
        /// The force did not vanish after the path
        #[reaction(Retract)] #[detection("Force still present after `expert.settle.time_max`, or present again while the tool is lifted")] #[hint("Check the zero of the force sensor.")]
        UnloadTimeout,
        /// The cycle took too long
        #[reaction(Retract)] #[detection("Cycle longer than `limits.cycle_time`; commissioning run longer than 1.25 times its planned motions + 1 s")] #[hint("Increase `limits.cycle_time`, or increase `feed_override`.")]
        NoProgress,
        /// The ball slides too little on the mold
        #[reaction(Retract)] #[detection("Sliding speed below 0.9 of `stick_slip.sliding` over five windows of 0.2 s or more, at the largest permitted velocity and half period")] #[hint("Increase `stick_slip.velocity_max` or `stick_slip.half_period_max`, or use a stiffer tip. Check sign and bandwidth of the force sensor.")]
        NoSliding,
        /// A force is missing
        #[reaction(Retract)] #[detection("Force NaN, infinite or beyond any sensor for more than `expert.limits.lost_samples` consecutive samples")] #[hint("Check the connections of the force sensor.")]
        ForceLost,
        /// The force is implausible
        #[reaction(Retract)] #[detection("Force farther from the last one than the fastest motion allows, for more than `expert.limits.lost_samples` samples")] #[hint("Check shield and connector of the force sensor. Check for obstacles in front of the tool.")]
        ForceJump,
        /// The commissioning run gave no usable result
        #[reaction(Retract)] #[detection("Standard deviation above its `expert.commission` limit, value beyond half or twice its nominal value, or result that the other parameters do not allow")] #[hint("Increase `commission.travel` or `expert.commission.force`. Check for play and vibration, and check `stiffness.nominal`, `drive.*` and `io_delay`.")]
        CommissionRejected,
        /// The communication step is longer than the sample period
        #[reaction(DriveOff)] #[detection("A communication step longer than `sample_period` in the first sample of a motion or during it")] #[hint("Set the communication step of the importing tool to `sample_period`.")]
        LongStep,
    }
    /// Control law; Paper takes published values for parameters that are not set
    pub enum Law {
        /// Extended control law of this controller
        Default,
        /// As published by Nagata and others (2010)
        Paper,
    }
    /// Part of the measured force that is controlled, eq. 5
    pub enum ForceMode {
        /// Norm of the force, friction included, as published
        Norm,
        /// Component of the force along the normal
        Projected,
    }
    /// Direction of the stick-slip motion
    pub enum Mode {
        /// No stick-slip motion
        Off,
        /// Back and forth along the position vector in the tangent plane, eqs. 12 to 15
        Paper,
        /// Back and forth across the path, along normal cross tangent
        Cross,
        /// Circle in the tangent plane, as wide as the linear sweep is long
        Circular,
    }
    /// Source of the feed
    pub enum FeedSource {
        /// Parameter feed.velocity
        Parameter,
        /// FEDRAT statements of the CL file
        File,
    }
    /// Inputs, sampled at the start of a sample period
    #[inputs] pub struct Input {
        /// A rising edge starts a cycle; false ends it in order: the tool unloads and retracts
        pub enable: bool,
        /// A rising edge in Idle or Done starts the commissioning run; false aborts it
        pub commission: bool,
        /// Stops the motion immediately, also in contact; the force on the mold stays
        pub estop: bool,
        /// A rising edge acknowledges a fault
        pub reset_fault: bool,
        /// Center of the ball from the encoders, in the work frame of the path
        #[var(fields = f64[x, y, z], unit = METRE as "mm", accepts_nan)] pub position: Axes,
        /// Raw force on the tool in the work frame
        #[var(fields = f64[x, y, z], unit = NEWTON, accepts_nan)] pub force: Axes,
        /// Factor of the feed, 0 to 2
        #[var(unit = ONE as "%", start = 1.0, accepts_nan)] pub feed_override: f64,
        /// Factor of the target force, 0 to 2
        #[var(unit = ONE as "%", start = 1.0, accepts_nan)] pub force_override: f64,
    }
    /// Outputs of one sample; always finite
    #[outputs] pub struct Output {
        pub velocity: VelocityOutput,
        /// Pulses of this sample, for communication steps equal to sample_period
        #[var(fields = i32[x, y, z])] pub pulses: Axes<i32>,
        /// Sum of all pulses since the start, valid for any communication step
        #[var(local, fields = i32[x, y, z])] pub counts: Axes<i32>,
        pub force: ForceOutput,
        /// Desired center of the ball, x_d
        #[var(local, fields = f64[x, y, z], unit = METRE as "mm")] pub desired: Axes,
        /// Unit normal of the path out of the material, o_d
        #[var(local, fields = f64[x, y, z], unit = ONE, start = Axes { x: 0.0, y: 0.0, z: 1.0 })] pub normal: Axes,
        /// Unit tangent of the path, t
        #[var(local, fields = f64[x, y, z], unit = ONE, start = Axes { x: 1.0, y: 0.0, z: 0.0 })] pub tangent: Axes,
        #[var(local)] pub error: ErrorOutput,
        /// Measured position minus the position of the drive model
        #[var(local, fields = f64[x, y, z], unit = METRE as "um")] pub following: Axes,
        /// Completed fraction of the path
        #[var(local, unit = ONE as "%")] pub progress: f64,
        pub state: State,
        pub fault: Fault,
        /// Enable of the drives; false from a fault with the reaction DriveOff until the reset
        #[var(start = true)] pub drive_enable: bool,
        /// The tool presses on the mold under force control
        pub in_contact: bool,
        /// The whole path is polished and the tool is retracted
        pub done: bool,
        /// Estimated stiffness of tool and contact along the normal
        #[var(local, name = "stiffness.estimate", unit = NEWTON_PER_METRE as "N/mm")] pub stiffness_estimate: f64,
        #[var(local)] pub sliding: SlidingOutput,
        #[var(local)] pub misalignment: MisalignmentOutput,
        /// A part of the ripple cancellation or of the repetitive control grew and was stopped
        #[var(local, name = "ripple.stopped")] pub ripple_stopped: bool,
        /// Length of the path along the contact points
        #[var(local, name = "path.length", unit = METRE as "mm")] pub path_length: f64,
        #[var(local)] pub measured: Measured,
        /// Numbers for the log message of a fault.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
    }
    /// Commanded velocity and its parts.
    pub struct VelocityOutput {
        /// Commanded velocity, x
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub x: f64,
        /// Commanded velocity, y
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub y: f64,
        /// Commanded velocity, z
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub z: f64,
        /// Velocity of the force control along the normal, positive out of the material, eq. 3
        #[var(local, unit = METRE_PER_SECOND as "mm/s")] pub normal: f64,
        /// Feed velocity of the center of the ball, v_t, eq. 2
        #[var(local, unit = METRE_PER_SECOND as "mm/s")] pub tangential: f64,
        /// Magnitude of the position feedback velocity, v_p, eq. 6
        #[var(local, unit = METRE_PER_SECOND as "mm/s")] pub position: f64,
        /// Stick-slip velocity with its sign, v_v, eq. 16; its magnitude for a circle
        #[var(local, unit = METRE_PER_SECOND as "mm/s")] pub stick_slip: f64,
    }
    /// Force of the control loop.
    pub struct ForceOutput {
        /// Controlled force: norm or normal component, minus the sensor zero
        #[var(unit = NEWTON)] pub measured: f64,
        /// Target force F_d with its ramps
        #[var(local, unit = NEWTON)] pub setpoint: f64,
        /// Force error E_f, eq. 5
        #[var(local, unit = NEWTON)] pub error: f64,
    }
    /// Position error x_d - x.
    pub struct ErrorOutput {
        /// Position error x_d - x along the tangent
        #[var(unit = METRE as "um")] pub tangential: f64,
        /// Position error across the path, along normal cross tangent
        #[var(unit = METRE as "um")] pub lateral: f64,
        /// Position error along the normal
        #[var(unit = METRE as "um")] pub normal: f64,
    }
    /// Sliding of the ball, from the work of the axes against the lateral force.
    pub struct SlidingOutput {
        /// Mean sliding speed of the ball over whole stick-slip periods, at least 0.2 s
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub speed: f64,
        /// Friction force of the sliding ball
        #[var(unit = NEWTON)] pub friction: f64,
        /// Velocity added to stick_slip.velocity so that the ball slides
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub added: f64,
        /// Samples added to stick_slip.half_period so that the ball slides
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
    /// Results of the commissioning run, each with its standard deviation; 0 before
    pub struct Measured {
        /// The last commissioning run is complete and its results are usable
        pub valid: bool,
        /// Measured stiffness of tool and contact along the normal
        #[var(unit = NEWTON_PER_METRE as "N/mm")] pub stiffness: f64,
        /// Standard deviation of the measured stiffness
        #[var(unit = NEWTON_PER_METRE as "N/mm")] pub stiffness_std: f64,
        /// Measured stiffness of the tip across the normal
        #[var(unit = NEWTON_PER_METRE as "N/mm")] pub lateral_stiffness: f64,
        /// Standard deviation of the measured lateral stiffness
        #[var(unit = NEWTON_PER_METRE as "N/mm")] pub lateral_stiffness_std: f64,
        /// Measured friction coefficient of the ball on the mold
        #[var(unit = ONE)] pub friction: f64,
        /// Standard deviation of the measured friction coefficient
        #[var(unit = ONE)] pub friction_std: f64,
        /// Measured speed of the drive loops over the nominal speed
        #[var(unit = ONE)] pub drive_gain: f64,
        /// Standard deviation of the measured speed ratio of the drive loops
        #[var(unit = ONE)] pub drive_gain_std: f64,
        /// Measured velocity feedforward of the drives
        #[var(unit = ONE)] pub feedforward: f64,
        /// Standard deviation of the measured velocity feedforward
        #[var(unit = ONE)] pub feedforward_std: f64,
        /// Measured delay between a command and its action in samples, not rounded
        #[var(unit = ONE)] pub io_delay: f64,
        /// Standard deviation of the measured delay
        #[var(unit = ONE)] pub io_delay_std: f64,
        /// Measured mounting angle of the force sensor about z
        #[var(unit = RADIAN as "deg")] pub sensor_rotation: f64,
        /// Standard deviation of the measured mounting angle
        #[var(unit = RADIAN as "deg")] pub sensor_rotation_std: f64,
        /// Measured direction of the y axis of the force sensor: 1 or -1
        pub sensor_direction_y: i32,
        /// Measured direction of the z axis of the force sensor: 1 or -1
        pub sensor_direction_z: i32,
    }
    /// Parameters, set before the cycle or tuned during it
    #[parameters] pub struct Parameters {
        pub law: Law,
        /// Sample period
        #[var(unit = SECOND as "ms", range = 2e-4..=5e-3, start = 1e-3, source = "paper")] pub sample_period: f64,
        /// Samples between a command and its action: 1 for standard masters, 0 if immediate
        #[var(essential, range = 0..=DELAY_MAX as i32, start = 1, source = "a standard FMI master")] pub io_delay: i32,
        /// Maximum commanded velocity
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-3..=1.0, start = 0.05, source = "default; five times the stick-slip velocity")]
        pub velocity_max: f64,
        /// Stroke of the axis; the origin of the path is in its middle
        #[var(fields = f64[x, y, z], unit = METRE as "mm", range = 1e-3..=10.0, start = Axes { x: 0.4, y: 0.3, z: 0.1 }, source = "paper")]
        pub stroke: Axes,
        /// Radius of the ball end
        #[var(essential, name = "tool.radius", unit = METRE as "mm", range = 5e-5..=0.02, start = 0.5e-3, source = "paper: tip diameter 1 mm")]
        pub tool_radius: f64,
        /// Travel of one pulse
        #[var(essential, name = "pulses.size", unit = METRE as "um", range = 1e-9..=1e-4, start = 1e-6, source = "paper")]
        pub pulses_size: f64,
        /// Resolution of the encoders
        #[var(essential, name = "encoder.resolution", unit = METRE as "um", range = 1e-9..=1e-4, start = 1e-6, source = "paper")]
        pub encoder_resolution: f64,
        pub drive: Drive,
        /// Bandwidth of the force sensor filter
        #[var(name = "sensor.bandwidth", unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=1e6, start = 1256.6, source = "default; 200 Hz, usual for force sensors")]
        pub sensor_bandwidth: f64,
        /// Measuring range of each axis of the force sensor
        #[var(name = "sensor.range", unit = NEWTON, range = 1.0..=1e5, start = 100.0, source = "default; a usual sensor")]
        pub sensor_range: f64,
        /// Resolution of the force sensor
        #[var(name = "sensor.resolution", unit = NEWTON, range = 1e-6..=10.0, start = 0.178, source = "paper: 1 um at 178 N/mm")]
        pub sensor_resolution: f64,
        /// Mounting angle of the force sensor about z
        #[var(name = "sensor.rotation", unit = RADIAN as "deg", range = -3.2..=3.2, source = "default; aligned with the axes")]
        pub sensor_rotation: f64,
        /// Direction of the y axis of the force sensor: -1 if inverted
        #[var(name = "sensor.direction.y", range = -1..=1, start = 1, source = "default; aligned with the axes")]
        pub sensor_direction_y: i32,
        /// Direction of the z axis of the force sensor: -1 if inverted
        #[var(name = "sensor.direction.z", range = -1..=1, start = 1, source = "default; aligned with the axes")]
        pub sensor_direction_z: i32,
        pub path: Path,
        pub feed: Feed,
        pub force: Force,
        pub impedance: Impedance,
        /// Nominal stiffness of tool and contact, used until it is estimated
        #[var(essential, name = "stiffness.nominal", unit = NEWTON_PER_METRE as "N/mm", range = 1e3..=1e8, start = 178e3, source = "paper")]
        pub stiffness_nominal: f64,
        #[var(expert)] pub position: Position,
        pub stick_slip: StickSlip,
        /// Rate at which force ripple at one and two times the stick-slip frequency is canceled
        #[var(expert, name = "ripple.gain", unit = PER_SECOND, range = 0.0..=20.0, start = 3.0, paper = 0.0, source = "measured: 8 is unsafe with other drives")]
        pub ripple_gain: f64,
        #[var(expert)] pub repetitive: Repetitive,
        /// Estimate shift and rotation of the mold and compensate them by feedforward
        #[var(expert, name = "misalignment.enable", start = true, paper = false, source = "default; a mold is never set up exactly")]
        pub misalignment_enable: bool,
        /// Time over which the zero of the force sensor is averaged
        #[var(expert, name = "tare.time", unit = SECOND, range = 1e-3..=10.0, start = 0.1, source = "default; averages 100 samples")]
        pub tare_time: f64,
        pub approach: Approach,
        #[var(expert)] pub settle: Settle,
        pub retract: Retract,
        pub limits: Limits,
        pub commission: Commission,
    }
    /// Linear model of an axis from its pulses to its position: position loop, velocity feedforward, velocity loop. The ripple
    /// phases, the phase margin of the force control and `FollowingError` follow from it.
    pub struct Drive {
        /// Gain of the position loop of the drives
        #[var(unit = PER_SECOND, range = 1.0..=1e4, start = 80.0, source = "default; usual AC servo")]
        pub position_gain: f64,
        /// Fraction of the velocity that the drives feed forward
        #[var(unit = ONE, range = 0.0..=1.0, start = 0.8, source = "default; usual AC servo")] pub feedforward: f64,
        /// Bandwidth of the velocity feedforward of the drives
        #[var(expert, unit = RADIAN_PER_SECOND as "Hz", range = 1.0..=1e5, start = 628.3, source = "default; usual AC servo")]
        pub feedforward_bandwidth: f64,
        /// Bandwidth of the velocity loop of the drives
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=1e5, start = 500.0, source = "default; usual AC servo")]
        pub velocity_bandwidth: f64,
        /// Integral action of the velocity loop of the drives
        #[var(expert, unit = PER_SECOND, range = 0.0..=1e4, start = 60.0, source = "default; usual AC servo")]
        pub velocity_integral: f64,
        /// Maximum acceleration of the weakest axis, a limit of a circular sweep; 0: unlimited
        #[var(expert, unit = METRE_PER_SECOND_SQUARED, range = 0.0..=1e3, source = "default; unknown")]
        pub acceleration_max: f64,
    }
    /// CL data of the path.
    pub struct Path {
        /// CL file in the folder resources of the FMU, or its absolute path
        #[var(essential, start = crate::path::built_in::NAME)] pub file: String,
        /// Maximum slope of a surface that is polished
        #[var(expert, unit = RADIAN as "deg", range = 0.1..=1.5, start = 1.05, source = "default; 60 deg keep the shank clear of the wall")]
        pub slope_max: f64,
    }
    /// Feed along the path.
    pub struct Feed {
        #[var(expert, source = "default; independent of the file")] pub source: FeedSource,
        /// Feed velocity of the contact point, eq. 2
        #[var(essential, unit = METRE_PER_SECOND as "mm/s", range = 1e-6..=0.1, start = 2e-3, source = "default; the ball slides three times as far", tunable)]
        pub velocity: f64,
        /// Maximum acceleration along the path
        #[var(expert, unit = METRE_PER_SECOND_SQUARED, range = 1e-3..=10.0, start = 0.05, source = "default; full feed after 40 ms")]
        pub acceleration: f64,
        /// Maximum turning rate of the direction of motion; slows the feed in curves
        #[var(expert, unit = RADIAN_PER_SECOND, range = 1.0..=1e3, start = 25.0, source = "default; 5 % of the velocity loop")]
        pub turn_rate_max: f64,
    }
    /// Polishing force.
    pub struct Force {
        /// Target polishing force F_d
        #[var(essential, unit = NEWTON, range = 0.1..=100.0, start = 5.0, source = "default; 28 steps of the sensor", tunable)]
        pub target: f64,
        #[var(expert, start = ForceMode::Projected, paper = ForceMode::Norm, source = "default; friction does not act as normal force")]
        pub mode: ForceMode,
        /// Low-pass bandwidth of the measured force; 0: no filter
        #[var(expert, unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=1e5, source = "default; the sensor filters")]
        pub filter_bandwidth: f64,
        /// Integral time of the force control; 0: no integral
        #[var(expert, unit = SECOND, range = 0.0..=100.0, start = 0.15, paper = 0.0, source = "measured", tunable)]
        pub integral_time: f64,
    }
    /// Impedance model M_d dv/dt + B_d v = - K_f E_f of eq. 4.
    pub struct Impedance {
        /// Desired mass M_d, eq. 4
        #[var(expert, unit = KILOGRAM, range = 0.01..=1e4, start = 10.0, source = "default; a time constant of 1 ms")]
        pub mass: f64,
        /// Desired damping B_d, eq. 4; with adaptive damping used until the stiffness is known
        #[var(unit = NEWTON_SECOND_PER_METRE, range = 10.0..=1e7, start = 10e3, source = "derived: 17.7 rad/s at 178 N/mm", tunable)]
        pub damping: f64,
        /// Force feedback gain K_f, eq. 4
        #[var(expert, unit = ONE, range = 0.0..=100.0, start = 1.0, source = "default; the damping sets the bandwidth", tunable)]
        pub gain: f64,
        /// Adapt the damping to the estimated stiffness for the desired bandwidth
        #[var(expert, start = true, paper = false, source = "default; the same bandwidth on any tip")]
        pub adaptive: bool,
        /// Desired bandwidth of the force control with adaptive damping
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 1.0..=100.0, start = 35.0, source = "measured: with 80 the force oscillates")]
        pub bandwidth: f64,
    }
    /// Position feedback, eq. 6.
    pub struct Position {
        /// Position feedback gain K_p, eq. 6
        #[var(fields = f64[x, y, z], unit = PER_SECOND, range = 0.0..=200.0,
            start = Axes::all(5.0), paper = Axes { x: 0.0, y: 0.0, z: 1.0 }, source = "default; slow against the drives", tunable)]
        pub gain: Axes,
        /// Integral gain K_i of the position feedback: that of the paper over the sample period
        #[var(fields = f64[x, y, z], unit = PER_SECOND_SQUARED, range = 0.0..=1e4, source = "default; proportional feedback suffices", tunable)]
        pub integral: Axes,
        /// Selection S of the axis for position feedback
        #[var(fields = bool[x, y, z], start = Axes::all(true), paper = Axes { x: false, y: false, z: true }, source = "default; all axes")]
        pub select: Axes<bool>,
        /// Position feedback in the tangent plane only, independent of the force control
        #[var(start = true, paper = false, source = "default; along the normal the force is controlled")]
        pub projected: bool,
    }
    /// Stick-slip motion, eqs. 7 to 17.
    pub struct StickSlip {
        #[var(start = Mode::Cross, paper = Mode::Paper, source = "default; always across the feed")] pub mode: Mode,
        /// Velocity K_v of the square wave, eq. 16; a circle moves pi / 2 times as fast
        #[var(essential, unit = METRE_PER_SECOND as "mm/s", range = 0.0..=0.1, start = 10e-3, source = "measured", tunable)]
        pub velocity: f64,
        /// Samples in half a period; 1 for eq. 17
        #[var(range = 1..=1000, start = 10, paper = 1, source = "measured: 1 has no effect")] pub half_period: i32,
        /// Minimum mean sliding speed, feed included, to which the motion is raised; 0: off
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 0.0..=0.1, start = 6e-3, paper = 0.0, source = "default; three times a feed of 2 mm/s", tunable)]
        pub sliding: f64,
        /// Maximum velocity to which stick_slip.velocity is raised
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 0.0..=0.1, start = 20e-3, source = "default; ten times a feed of 2 mm/s")]
        pub velocity_max: f64,
        /// Half period in samples used if the ball slides too little at velocity_max; 0: off
        #[var(range = 0..=1000, source = "default; weak drives do not follow a longer sweep")] pub half_period_max: i32,
        /// Stick-slip velocity over the feed, for constant removal; 0: stick_slip.velocity
        #[var(unit = ONE, range = 0.0..=100.0, source = "default; a constant velocity", tunable)] pub ratio: f64,
    }
    /// Repetitive control: disturbances that recur with each revolution of the path.
    pub struct Repetitive {
        /// Correction per radian of force error that recurs with each revolution; 0: off
        #[var(unit = ONE, range = 0.0..=0.5, start = 0.18, paper = 0.0, source = "measured: 0.3 oscillates, since the harmonics are close")]
        pub gain: f64,
        /// Correction per radian of sweep ripple that rotates with the path; 0: off
        #[var(unit = ONE, range = 0.0..=0.5, source = "measured: 0.09 halves the deviation on a tilted mold, and a wrong mold is found later")]
        pub ripple_gain: f64,
    }
    /// Approach along the normal of the first point.
    pub struct Approach {
        /// Velocity of the approach
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-5..=0.01, start = 0.5e-3, source = "measured: 2 mm/s overshoots")]
        pub velocity: f64,
        /// Force above which the tool is in contact
        #[var(expert, unit = NEWTON, range = 0.05..=50.0, start = 0.6, source = "default; three steps of the sensor")]
        pub contact_force: f64,
        /// Maximum travel without contact
        #[var(unit = METRE as "mm", range = 1e-5..=0.1, start = 2e-3, source = "default; the tool starts close to the mold")]
        pub travel_max: f64,
    }
    /// Building up of the force, and its end.
    pub struct Settle {
        /// Time in which the target force ramps up and down
        #[var(unit = SECOND, range = 1e-3..=10.0, start = 0.2, source = "default; hardly any overshoot")]
        pub ramp_time: f64,
        /// Maximum time of settling and of unloading
        #[var(unit = SECOND, range = 0.01..=60.0, start = 2.0, source = "default; the force usually settles within 0.5 s")]
        pub time_max: f64,
    }
    /// Retract along the normal.
    pub struct Retract {
        /// Distance of the retract
        #[var(unit = METRE as "mm", range = 1e-5..=0.1, start = 0.5e-3, source = "default; far more than the tip bends")]
        pub distance: f64,
        /// Velocity of the retract
        #[var(expert, unit = METRE_PER_SECOND as "mm/s", range = 1e-5..=0.1, start = 5e-3, source = "default; out within 0.1 s")]
        pub velocity: f64,
    }
    /// Limits of the monitors.
    pub struct Limits {
        /// Maximum force
        #[var(essential, unit = NEWTON, range = 0.5..=1e3, start = 25.0, source = "default; five times the target force")]
        pub force: f64,
        /// Force below which contact is lost
        #[var(expert, unit = NEWTON, range = 0.0..=50.0, start = 0.4, source = "default; two steps of the sensor")]
        pub lost_force: f64,
        /// Time below that force after which the contact is lost
        #[var(expert, unit = SECOND, range = 1e-3..=10.0, start = 0.1, source = "default; five stick-slip periods")]
        pub lost_time: f64,
        /// Maximum position error along or across the path
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 0.5e-3, source = "default; the radius of the ball")]
        pub position_error: f64,
        /// Maximum distance of the surface from the path along the normal
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 0.5e-3, source = "default; the radius of the ball")]
        pub surface_error: f64,
        /// Maximum angle between mean force and normal, friction included
        #[var(expert, unit = RADIAN as "deg", range = 0.1..=3.0, start = 0.6, source = "derived: friction alone gives 22 deg at 0.4, the rest for normals")]
        pub force_angle: f64,
        /// Maximum force accepted as the zero of the sensor
        #[var(expert, unit = NEWTON, range = 0.1..=100.0, start = 2.0, source = "default; the tip weighs 0.1 N")]
        pub tare_force: f64,
        /// Maximum lateral distance of the tool from the start of the path, and depth below it
        #[var(expert, unit = METRE as "mm", range = 1e-6..=0.05, start = 0.1e-3, source = "default; one winding")]
        pub start_offset: f64,
        /// Maximum depth below the start of the path without contact
        #[var(unit = METRE as "mm", range = 1e-6..=0.05, start = 0.13e-3, source = "derived: with a dead sensor the tool presses this far, 23 N at 178 N/mm")]
        pub approach_depth: f64,
        /// Consecutive implausible samples of an input that are bridged; one more is a fault
        #[var(expert, range = 1..=100, start = 5, source = "derived: 5 ms at `approach.velocity` are 0.4 N")]
        pub lost_samples: i32,
        /// Travel without a change of an encoder or of the force, beyond 1.5 steps
        #[var(expert, unit = METRE as "um", range = 1e-6..=1e-2, start = 20e-6, source = "derived: a fifth of the stick-slip motion; 3.6 N at 178 N/mm")]
        pub frozen: f64,
        /// Maximum time without any change of the force; 0 for a sensor without noise
        #[var(expert, unit = SECOND, range = 0.0..=10.0, start = 0.25, source = "derived: 250 samples of 0.05 N in a step of 0.178 N, once in 3e8 windows")]
        pub frozen_time: f64,
        /// Maximum standard deviation of the force noise
        #[var(unit = NEWTON, range = 1e-3..=100.0, start = 0.35, source = "measured: six times 0.05 N still polishes well")]
        pub force_noise: f64,
        /// Maximum distance of an axis from its drive model
        #[var(expert, unit = METRE as "mm", range = 1e-6..=0.05, start = 0.1e-3, source = "default; one winding, drives without feedforward need half")]
        pub following_error: f64,
        /// Maximum force error on the path, rms over 0.2 s; 0: a fifth of force.target
        #[var(expert, unit = NEWTON, range = 0.0..=100.0, source = "measured: over robots and molds the published law has 0.68 N, another mold 1.25 N")]
        pub force_error: f64,
        /// Maximum ratio of estimated and nominal stiffness, in both directions; 4: no limit
        #[var(expert, unit = ONE, range = 1.0..=4.0, start = 2.2, source = "measured: tips and woods from 92 to 242 N/mm")]
        pub stiffness_ratio: f64,
        /// Maximum slope of the surface against the path
        #[var(unit = ONE, range = 1e-3..=1.0, start = 0.1, source = "default; a mold that is tilted by 6 deg")]
        pub surface_slope: f64,
        /// Maximum time of a cycle; 0: planned time, with four times the path
        #[var(unit = SECOND, range = 0.0..=1e6, source = "derived: tare, approach, settling, unloading, retract, and the path")]
        pub cycle_time: f64,
    }
    /// Bounds of the state `Commission`, and the use of its results
    pub struct Commission {
        /// Maximum lateral travel and lift of the run; 0: derived from velocity_max
        #[var(unit = METRE as "um", range = 0.0..=0.01, source = "derived: four times the reach of an excitation at half of `velocity_max`")]
        pub travel: f64,
        /// Force of the commissioning run; 0: force.target
        #[var(expert, unit = NEWTON, range = 0.0..=100.0, source = "derived: stiffness and friction are those of the cycle")]
        pub force: f64,
        /// Maximum relative standard deviation of the results; in rad for the mounting angle
        #[var(expert, unit = ONE, range = 1e-6..=0.5, start = 0.1, source = "default; the control tolerates a tenth without notice")]
        pub std_max: f64,
        /// Maximum standard deviation of the delay in samples
        #[var(expert, unit = ONE, range = 1e-3..=2.0, start = 0.25, source = "default; two of them reach the next half sample")]
        pub delay_std_max: f64,
        /// Use the measured values instead of the configured ones
        #[var(source = "default; look at the results first")] pub apply: bool,
        /// JSON file to which a good run writes the derived parameters; empty: none
        pub export: String,
    }
}

pub use variables::*;

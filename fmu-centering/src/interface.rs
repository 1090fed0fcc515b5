//! Every variable of the FMU, declared once.
//!
//! Sources: "paper" = Mears et al. (2007); "derived" = follows from the equations; "default" = usual practice, with the
//! reason where there is one.
//!
//! The tiers are `essential` (set these first), normal, and `expert`, whose FMI names start with `expert.`. Of the outputs a
//! machine needs twelve; the others are `local`.

pub use variables::*;

#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use std::f64::consts::TAU;

    use control_blocks::{DELAY_MAX, Reaction};
    use crate::monitoring::Numbers;
    use fmi2_export::{Unit, units::*};

    /// Unit of a velocity per length.
    const PER_SECOND: Unit = Unit::si("1/s", [0, 0, -1, 0, 0], &[]);

    /// State of the controller
    pub enum State {
        /// Waits for a rising edge of enable; the slide may still return to its start position
        Idle,
        /// Moves towards the ring until the probe touches it
        Approach,
        /// Moves the probe to its position on the ring
        Follow,
        /// Follows the surface and collects measurements
        Collect,
        /// Fits the model of the ring
        Model,
        /// Follows the surface until the ring is at the angle where the push starts
        Wait,
        /// Pushes the ring
        Push,
        /// Retracts after a push and follows the surface again
        Settle,
        /// Tests the probe: moves the slide out and in by 0.2 mm
        Confirm,
        /// The ring is centered; the probe stays on it until enable is false
        Centered,
        /// A fault is active: the slide returns and holds, or its drive is disabled
        Fault,
        /// Identifies the servo of the slide with short strokes and returns
        Commission,
    }
    /// Why the controller is in the fault state
    #[reactions(Reaction,
        Retract = ["Stops the slide, returns it to the start position of the approach and holds", "Rising edge of `reset_fault` when the slide is at rest"],
        Stop = ["Stops along the planned motion and holds; no fault of this controller uses it", "Rising edge of `reset_fault` when the slide is at rest"],
        DriveOff = ["Sets `drive_enable` to false; the setpoint follows the slide encoder", "Rising edge of `reset_fault` when the slide has not moved for 0.1 s"])]
    pub enum Fault {
        /// No fault
        None,
        /// No ring was found within the travel, or the probe has lost the ring
        #[reaction(Retract)]
        #[detection("The slide would exceed `approach.travel_max`, or the probe has had no contact for 0.1 s")]
        #[hint("Check that a ring is loaded and that the probe moves freely. Compare `approach.travel_max` with the \
            distance.")]
        NoPart,
        /// The spindle axis is outside the ring
        #[reaction(Retract)]
        #[detection("The measured eccentricity is at least `ring.radius` (eq. 32)")]
        #[hint("Place the ring nearer to the axis, or correct `ring.radius`.")]
        RingTooSmall,
        /// The probe is out of its range, does not settle, or the pusher touches unintentionally
        #[reaction(Retract)]
        #[detection("Probe at `probe.stroke`; pusher in contact for 5 ms while following; or not settled 3 s after the \
            time that the travel of the probe takes at `follow.velocity_max`")]
        #[hint("Check `probe.at_pusher`. Approach more slowly, or place the ring nearer to the axis.")]
        ProbeRange,
        /// The centrifugal force exceeds the friction that holds the ring
        #[reaction(Retract)]
        #[detection("Speed above eq. 2 for the measured eccentricity and `limits.friction`, or a surface velocity \
            above eq. 5 for 30 ms")]
        #[hint("Reduce the spindle speed, or place the ring nearer to the axis.")]
        Centrifugal,
        /// The ring is not centered after the allowed number of pushes
        #[reaction(Retract)]
        #[detection("Eccentricity above `tolerance` after `limits.pushes` pushes")]
        #[hint("Check that the ring slides. Increase `tolerance` or `limits.pushes`, or correct `slide.bandwidth`.")]
        PushBudget,
        /// The probe signal is missing or implausible
        #[reaction(Retract)]
        #[detection("NaN, infinite or out of range for more than `limits.lost_samples` samples; shorter gaps are \
            bridged")]
        #[hint("Check the probe and its link.")]
        ProbeLost,
        /// The probe signal has jumped
        #[reaction(Retract)]
        #[detection("Farther from the last value than slide and ring can move, for more than `limits.lost_samples` \
            samples; or the fitted line of the centered ring moved by 0.1 mm and 6 standard deviations")]
        #[hint("Check counter and cable of probe and slide, and the spindle encoder scale. Check that the ring was not \
            moved.")]
        ProbeJump,
        /// The probe does not respond, or not with the correct gain
        #[reaction(Retract)]
        #[detection("No change while the slide moves 0.2 mm to 1 mm or the spindle turns one revolution; or gain \
            outside 0.8 to 1.2 in state `Confirm`; or 1.5 mm from the model in a stroke")]
        #[hint("Check the probe for jamming, its link, its scale and `probe.at_pusher`. Check that the ring was not \
            moved.")]
        ProbeFrozen,
        /// The slide encoder signal is missing or implausible
        #[reaction(DriveOff)]
        #[detection("NaN, infinite or out of range for more than `limits.lost_samples` samples; shorter gaps are \
            bridged")]
        #[hint("Check the slide encoder and its link.")]
        PositionLost,
        /// The slide does not follow its setpoint
        #[reaction(DriveOff)]
        #[detection("Following error above `limits.following_error`, or above a twentieth of it for 0.25 s at a \
            constant setpoint")]
        #[hint("Check drive, servo and free motion of the slide. Check `io_delay`.")]
        FollowingError,
        /// The slide moves against its setpoint
        #[reaction(DriveOff)]
        #[detection("As `FollowingError`, with `monitor.drive_gain_ratio` below -0.2")]
        #[hint("Correct the sign of the drive or of the encoder of the slide.")]
        DriveSign,
        /// The slide moves less than half of its commanded travel
        #[reaction(DriveOff)]
        #[detection("As `FollowingError`, with `monitor.drive_gain_ratio` below 0.5")]
        #[hint("Check scale, current limit and supply of the slide drive.")]
        WeakDrive,
        /// The spindle reverses repeatedly, or is too fast for the model rate
        #[reaction(Retract)]
        #[detection("Less than 0.9 of 1.1 revolutions turn forward; with `law = Paper`, also: the measurements of one \
            revolution make no model")]
        #[hint("Turn the spindle evenly in one direction. Check the noise of its encoder.")]
        SpindleUneven,
        /// The pushes have moved the ring away from the axis
        #[reaction(Retract)]
        #[detection("Eccentricity exceeds that of the first model by more than `expert.push.critical_distance`")]
        #[hint("Check that `spindle_angle` is positive about the upward axis and that probe and slide are sampled \
            simultaneously.")]
        Divergence,
        /// The eccentricity is too uncertain to compare it with the tolerance
        #[reaction(Retract)]
        #[detection("After a full revolution the eccentricity is neither within `tolerance` nor certain enough for a \
            push (default control law)")]
        #[hint("Increase `tolerance` or reduce the probe noise.")]
        Unresolved,
        /// The measurements fit no ring, or the cycle takes too long
        #[reaction(Retract)]
        #[detection("1.1 revolutions in one state or 4.4 since the last push without a result; or `limits.cycle_time` \
            exceeded, or the derived time of a commissioning run")]
        #[hint("Check that the ring is clean, smooth and held. Increase `estimator.noise`, or `limits.cycle_time` for \
            a slow spindle.")]
        NoProgress,
        /// The slide encoder signal has jumped
        #[reaction(DriveOff)]
        #[detection("Farther from the last value than the slide can move, for more than `limits.lost_samples` samples")]
        #[hint("Check counter and cable of the slide encoder.")]
        PositionJump,
        /// The slide encoder signal does not change although the slide must have moved
        #[reaction(DriveOff)]
        #[detection("Following error above `limits.following_error`, and the encoder has moved less than half of it")]
        #[hint("Check the slide encoder. Check that the slide is free and its drive powered. Compare the delay with \
            `io_delay`.")]
        PositionFrozen,
        /// The spindle encoder signal is missing or implausible
        #[reaction(Retract)]
        #[detection("NaN, infinite or out of range for more than `limits.lost_samples` samples; shorter gaps are \
            bridged")]
        #[hint("Check the spindle encoder and its link.")]
        SpindleLost,
        /// The spindle encoder signal has jumped
        #[reaction(Retract)]
        #[detection("Farther from the last value than the spindle can turn, for more than `limits.lost_samples` \
            samples")]
        #[hint("Check counter and cable of the spindle encoder.")]
        SpindleJump,
        /// The spindle does not turn although the ring must turn
        #[reaction(Retract)]
        #[detection("Speed below `limits.spindle_speed_min` for 0.5 s in a state that needs rotation")]
        #[hint("Turn the spindle. Check its encoder.")]
        SpindleFrozen,
        /// The servo of the slide is too slow for the limit of the following error
        #[reaction(Retract)]
        #[detection("Bandwidth measured during the approach is below sqrt(3 a / `limits.following_error`), a = \
            `slide.acceleration_max` (only with `learn.servo`)")]
        #[hint("Increase the gains of the servo, or reduce `slide.acceleration_max`.")]
        SlowServo,
        /// The spindle does not turn at the commanded speed
        #[reaction(Retract)]
        #[detection("More than 5 % from `spindle.speed` one second after `spindle.speed_setpoint` has reached it")]
        #[hint("Check the connection and the sign of `spindle.speed_setpoint`. Set `spindle.speed` = 0 if another \
            system turns the spindle.")]
        SpindleSpeed,
        /// The result of the commissioning run is too uncertain or out of range
        #[reaction(Retract)]
        #[detection("A result exceeds its standard deviation limit or its range, or the probe touches something")]
        #[hint("Start farther from the ring. Increase `commission.travel` or `commission.acceleration`. Check for \
            vibration and friction, `slide.bandwidth`, `io_delay`.")]
        CommissionRejected,
        /// The communication step is longer than the sample period
        #[reaction(DriveOff)]
        #[detection("Communication step longer than `sample_period` outside `Idle` and `Fault`")]
        #[hint("Set the communication step of the importing tool to `sample_period`.")]
        LongStep,
        /// The probe signal is delayed relative to the slide encoder
        #[reaction(Retract)]
        #[detection("A fault of ring or probe, while the motion at the ring fits a probe delay of 0.5 to 25 samples \
            only")]
        #[hint("Sample probe and slide at the same moment. Check for a filter or a slow link of the probe.")]
        ProbeDelayed,
        /// The slide encoder signal is delayed relative to the probe
        #[reaction(Retract)]
        #[detection("A fault of ring or probe, while the motion at the ring fits an encoder delay of 0.5 to 6 samples \
            only")]
        #[hint("Sample probe and slide at the same moment. Check for a filter or a slow link of the encoder.")]
        PositionDelayed,
        /// The pusher has hit the ring before it should
        #[reaction(Retract)]
        #[detection("As `ProbeFrozen` in a stroke, while the probe extends by 0.1 mm although the slide moves in")]
        #[hint("The pusher is longer than `probe.at_pusher` states. Measure `probe.at_pusher` again.")]
        EarlyContact,
    }
    /// Control law
    pub enum Law {
        /// Recursive model of the ring; pushes planned backwards from the center
        Default,
        /// As published: one revolution, one sine fit, one push
        Paper,
    }
    /// Learning of the push offset of the published control law
    pub enum OffsetMethod {
        /// No learning
        Off,
        /// Difference between desired and actual displacement of the ring, eq. 37 to 39
        Recursive,
    }
    /// Inputs, sampled at the start of the step.
    #[inputs] pub struct Input {
        /// Spindle angle, wrapped or continuous; positive about the upward axis
        #[var(unit = RADIAN as "deg", accepts_nan)] pub spindle_angle: f64,
        /// Slide encoder position, positive towards the spindle axis
        #[var(unit = METRE as "mm", accepts_nan)] pub slide_position: f64,
        /// Probe deflection; 0 when free
        #[var(unit = METRE as "mm", accepts_nan)] pub probe_position: f64,
        /// Rising edge in Idle starts a centering cycle; false stops, returns and ends in Idle
        pub enable: bool,
        /// Rising edge in Idle, at rest, starts a commissioning run; false aborts it
        pub commission: bool,
        /// Rising edge acknowledges the fault when the slide is at rest; the next state is Idle
        pub reset_fault: bool,
    }
    /// Outputs; always finite.
    #[outputs] pub struct Output {
        pub slide: Setpoint,
        /// Spindle speed command: spindle.speed during a cycle and while centered, otherwise 0
        #[var(name = "spindle.speed_setpoint", unit = RADIAN_PER_SECOND as "rpm")] pub spindle_speed_setpoint: f64,
        pub state: State,
        /// Fault of the highest severity so far; kept until reset_fault
        pub fault: Fault,
        /// Enable of the slide drive; false after a fault with the reaction DriveOff, until reset
        #[var(start = true)] pub drive_enable: bool,
        /// The ring is centered; kept until the next start
        pub centered: bool,
        /// Time from the start of the cycle until the ring is centered
        #[var(unit = SECOND)] pub time_to_center: f64,
        /// Distance of the ring center from the spindle axis in the last model
        #[var(unit = METRE as "um")] pub eccentricity: f64,
        /// Spindle angle at which the ring is nearest to the pusher
        #[var(unit = RADIAN as "deg")] pub eccentricity_angle: f64,
        /// Standard deviation of the measured eccentricity
        #[var(unit = METRE as "nm")] pub eccentricity_std: f64,
        /// Estimated spindle speed
        #[var(local, unit = RADIAN_PER_SECOND as "rpm")] pub spindle_speed: f64,
        /// Gap between pusher and ring according to the probe
        #[var(local, unit = METRE as "um")] pub pusher_gap: f64,
        pub push: PushReport,
        #[var(local)] pub monitor: MonitorReport,
        #[var(local)] pub measured: Measured,
        /// Values that are logged with a fault.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
    }
    /// Commands to the servo of the slide
    pub struct Setpoint {
        /// Position command to the servo of the slide, positive towards the spindle axis
        #[var(unit = METRE as "mm")] pub position_setpoint: f64,
        /// Velocity command to the servo of the slide
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub velocity_setpoint: f64,
    }
    /// Last push
    pub struct PushReport {
        /// Number of pushes since the start of the cycle
        pub count: i32,
        /// Commanded travel d of the last push, including gap and offset
        #[var(local, unit = METRE as "um")] pub distance: f64,
        /// Commanded velocity v of the last push
        #[var(local, unit = METRE_PER_SECOND as "mm/s")] pub velocity: f64,
        /// Lead angle L of the last push
        #[var(local, unit = RADIAN as "deg")] pub lead_angle: f64,
        /// Learned offset P of the published control law
        #[var(local, unit = METRE as "um")] pub offset: f64,
        /// Distance by which the last push moved the ring beyond the axis
        #[var(local, unit = METRE as "um")] pub overshoot: f64,
        /// Largest overshoot since the start of the cycle
        #[var(local, unit = METRE as "um")] pub overshoot_max: f64,
    }
    /// Monitored quantities
    pub struct MonitorReport {
        /// Slide setpoint minus slide position, aligned by io_delay
        #[var(unit = METRE as "um")] pub following_error: f64,
        /// Recent slide travel over commanded travel; 1 is nominal, and 1 without motion
        #[var(unit = ONE, start = 1.0)] pub drive_gain_ratio: f64,
        /// Probe travel over slide travel in the probe test; 1 is nominal
        #[var(unit = ONE, start = 1.0)] pub probe_gain_ratio: f64,
        /// Time since the start of the cycle, until the ring is centered
        #[var(unit = SECOND)] pub cycle_time: f64,
    }
    /// Results of the commissioning run; before it, the bandwidth measured during the approach
    pub struct Measured {
        /// The results are valid; without a commissioning run, the bandwidth is certain to 5 %
        pub valid: bool,
        /// Measured bandwidth of the slide servo
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub slide_bandwidth: f64,
        /// Standard deviation of the measured slide bandwidth
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub slide_bandwidth_std: f64,
        /// Measured damping ratio of the slide servo
        #[var(unit = ONE)] pub slide_damping: f64,
        /// Standard deviation of the measured slide damping
        #[var(unit = ONE)] pub slide_damping_std: f64,
        /// Measured integral action of the slide servo, 1 / integral time; 0 for none
        #[var(unit = PER_SECOND)] pub slide_integral: f64,
        /// Standard deviation of the measured integral action
        #[var(unit = PER_SECOND)] pub slide_integral_std: f64,
        /// Measured delay between setpoint and action in samples, not rounded
        #[var(unit = ONE)] pub io_delay: f64,
        /// Standard deviation of the measured delay in samples
        #[var(unit = ONE)] pub io_delay_std: f64,
    }
    /// All parameters.
    #[parameters] pub struct Parameters {
        #[var(paper = Law::Paper, source = "default; a quarter of the time of the published law")] pub law: Law,
        /// Sample period of the setpoints
        #[var(unit = SECOND as "ms", range = 1e-4..=0.01, start = 1e-3, source = "default; a 12 ms push needs this rate")]
        pub sample_period: f64,
        /// Samples between a setpoint and its action: 1 for a standard master, 0 if immediate
        #[var(essential, range = 0..=DELAY_MAX as i32, start = 1, source = "default; a standard master")]
        pub io_delay: i32,
        /// Largest allowed eccentricity of a centered ring
        #[var(essential, unit = METRE as "um", range = 1e-8..=1e-3, start = 2.5e-6, source = "paper")]
        pub tolerance: f64,
        pub ring: Ring,
        pub probe: Probe,
        pub slide: Slide,
        /// Resolution of the spindle encoder
        #[var(essential, name = "spindle.resolution", unit = RADIAN as "deg", range = 0.0..=0.1, start = TAU / 4000.0, source = "paper")]
        pub spindle_resolution: f64,
        /// Length of the regression for spindle angle and speed
        #[var(name = "spindle.window", unit = SECOND, range = 0.1..=5.0, start = 0.5, source = "derived: 0.02 % of jitter")]
        pub spindle_window: f64,
        /// Commanded spindle speed; 0 if another system turns the spindle
        #[var(name = "spindle.speed", unit = RADIAN_PER_SECOND as "rpm", range = -20.0..=20.0, source = "default; the spindle of the paper turns by itself")]
        pub spindle_speed: f64,
        /// Acceleration of the commanded spindle speed; 0: 0.6 x limits.friction x g / ring.radius
        #[var(name = "spindle.acceleration", unit = RADIAN_PER_SECOND_SQUARED, range = 0.0..=1e3, source = "derived: leaves 0.8 of the friction for eq. 2")]
        pub spindle_acceleration: f64,
        pub approach: Approach,
        pub follow: Follow,
        #[var(expert)] pub rates: Rates,
        #[var(expert)] pub push: Push,
        #[var(expert)] pub offset: Offset,
        pub park: Park,
        pub estimator: Estimator,
        #[var(expert)] pub stroke: StrokePlan,
        pub learn: Learn,
        pub tap: Tap,
        pub commission: Commission,
        pub limits: Limits,
    }
    /// Ring
    pub struct Ring {
        /// Nominal outer radius r of the ring
        #[var(essential, unit = METRE as "mm", range = 1e-3..=2.0, start = 0.05, source = "default; size of the rings in the paper")]
        pub radius: f64,
        /// Largest expected eccentricity of a loaded ring
        #[var(unit = METRE as "mm", range = 1e-6..=1.0, start = 0.025, source = "paper")] pub eccentricity_max: f64,
    }
    /// Measuring probe
    pub struct Probe {
        /// Probe deflection at which the pusher touches the ring
        #[var(essential, unit = METRE as "mm", range = 1e-4..=0.5, start = 0.020, source = "default; more than eq. 9 requires")]
        pub at_pusher: f64,
        /// Stroke of the probe
        #[var(essential, unit = METRE as "mm", range = 1e-4..=0.5, start = 0.025, source = "paper")] pub stroke: f64,
        /// Probe deflection from which the probe is in contact
        #[var(unit = METRE as "um", range = 1e-6..=0.01, start = 2e-4, source = "default; far above noise and dirt")]
        pub contact: f64,
    }
    /// Slide and its servo
    pub struct Slide {
        /// Maximum velocity of the slide
        #[var(essential, unit = METRE_PER_SECOND as "mm/s", range = 1e-3..=10.0, start = 0.12, source = "paper")]
        pub velocity_max: f64,
        /// Acceleration a of all moves of the slide
        #[var(essential, unit = METRE_PER_SECOND_SQUARED, range = 0.01..=100.0, start = 2.56, source = "paper")]
        pub acceleration_max: f64,
        /// Bandwidth of the slide servo, for feed-forward; 0 for no feed-forward
        #[var(essential, unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=6283.2, start = 40.0 * TAU, source = "default; 40 Hz")]
        pub bandwidth: f64,
    }
    /// Approach
    pub struct Approach {
        /// Velocity of the approach and of the return
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-4..=10.0, start = 0.12, source = "paper")]
        pub velocity: f64,
        /// Maximum travel until the probe touches; afterwards probe.stroke more is allowed
        #[var(unit = METRE as "mm", range = 1e-3..=10.0, start = 0.15, source = "default; set it below the distance of the pusher")]
        pub travel_max: f64,
    }
    /// Following of the surface
    pub struct Follow {
        /// Proportional gain Kp of following
        #[var(expert, unit = PER_SECOND, range = 0.1..=1e3, start = 15.0, source = "derived: critically damped at 25 with one sample of delay")]
        pub gain: f64,
        /// Maximum velocity towards the probe position on the ring, relative to the surface
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-4..=10.0, start = 0.02, source = "derived: a ring hit at 20 mm/s slides 0.4 mm")]
        pub velocity_max: f64,
        /// Gap between pusher and ring while following, published control law
        #[var(expert, unit = METRE as "um", range = 1e-5..=0.1, start = 5e-4, source = "default; reserve for the errors of following")]
        pub gap: f64,
        /// Following error without reaction, published control law
        #[var(expert, unit = METRE as "um", range = 0.0..=0.1, source = "paper")] pub dead_zone: f64,
        /// Following error below which the probe has settled, published control law
        #[var(expert, unit = METRE as "um", range = 1e-6..=0.1, start = 2e-4, source = "default; less than half the gap")]
        pub settle_band: f64,
    }
    /// Rates of the loops
    pub struct Rates {
        /// Rate of following and of the launch decision
        #[var(unit = HERTZ, range = 1.0..=1e4, start = 100.0, source = "paper")] pub control: f64,
        /// Rate of the measurements for the model
        #[var(unit = HERTZ, range = 1.0..=1e4, start = 66.0, source = "paper")] pub collect: f64,
        /// Rate of the model fit
        #[var(unit = HERTZ, range = 0.1..=1e4, start = 10.0, source = "paper")] pub model: f64,
    }
    /// Pushes of the published control law
    pub struct Push {
        /// Velocity v_min of the smallest push
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-6..=1.0, start = 4e-4, source = "paper, printed as 400 mm/s")]
        pub velocity_min: f64,
        /// Velocity v_max of a large push
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-6..=1.0, start = 3.5e-3, source = "paper, printed as 3500 mm/s")]
        pub velocity_max: f64,
        /// Eccentricity d_crit above which a push has v_max; also the limit of fault Divergence
        #[var(unit = METRE as "um", range = 1e-6..=0.1, start = 2.5e-3, source = "paper")] pub critical_distance: f64,
        /// Dwell at the end of the stroke before the retract
        #[var(unit = SECOND as "ms", range = 0.0..=1.0, start = 0.01, source = "default; the lag of a 40 Hz servo")]
        pub dwell: f64,
    }
    /// Learned offset of the published control law
    pub struct Offset {
        #[var(start = OffsetMethod::Recursive, source = "paper")] pub method: OffsetMethod,
    }
    /// Position of the slide between the pushes: low probe force, slide mostly at rest
    pub struct Park {
        /// Probe deflection while the slide is parked
        #[var(unit = METRE as "mm", range = 1e-4..=0.5, start = 4.5e-3, source = "default; a fifth of its force range")]
        pub probe: f64,
        /// Change of the probe deflection without reaction of the parked slide
        #[var(unit = METRE as "mm", range = 0.0..=0.1, start = 3e-3, source = "default; the slide rests for most rings")]
        pub dead_zone: f64,
    }
    /// Recursive model of the ring, default control law
    pub struct Estimator {
        /// Standard deviation of one measurement of the surface
        #[var(unit = METRE as "nm", range = 1e-9..=1e-3, start = 2e-7, source = "default; probe noise and roughness twice")]
        pub noise: f64,
        /// Standard deviation of each coordinate of the center before the first measurement
        #[var(expert, unit = METRE as "mm", range = 1e-6..=0.1, start = 5e-3, source = "default; loaded by hand")]
        pub center: f64,
        /// Standard deviation of each form coefficient before measuring; 0 for a round ring
        #[var(unit = METRE as "um", range = 0.0..=1e-3, start = 2e-6, source = "default; ground rings")] pub form: f64,
        /// Innovations above this many standard deviations are rejected as dirt
        #[var(expert, unit = ONE, range = 1.0..=1e6, start = 6.0, source = "default; rejects no normal noise")]
        pub gate: f64,
        /// A part of a revolution may suffice for a push
        #[var(expert, start = true, source = "paper, as future work")] pub partial: bool,
        /// Largest relative standard deviation of the eccentricity for a push
        #[var(expert, unit = ONE, range = 0.01..=1.0, start = 0.2, source = "default; less costs measuring time")]
        pub certainty: f64,
        /// Standard deviations by which a centered ring must be within the tolerance
        #[var(expert, unit = ONE, range = 0.0..=10.0, start = 3.0, source = "default; 0.1 % beyond the tolerance")]
        pub margin: f64,
    }
    /// Strokes of the pusher, default control law
    pub struct StrokePlan {
        /// Shortest time from contact to rest
        #[var(unit = SECOND as "ms", range = 0.01..=1.0, start = 0.08, source = "default; three periods of the servo")]
        pub duration: f64,
        /// Maximum deceleration at the end of a push
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.01..=10.0, start = 0.2, source = "derived: below the deceleration of a light ring by friction")]
        pub deceleration: f64,
        /// Maximum velocity at contact
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-4..=1.0, start = 0.04, source = "default; a low impact")]
        pub velocity_max: f64,
        /// Maximum wait at the end of the stroke until the surface arrives
        #[var(unit = SECOND as "ms", range = 0.0..=1.0, start = 0.04, source = "default; one period of the servo")]
        pub hold: f64,
        /// Integral gain from the surface position to the slide; 0 for no feedback
        #[var(unit = PER_SECOND, range = 0.0..=200.0, start = 60.0, source = "derived: a quarter of the servo bandwidth")]
        pub feedback: f64,
        /// The plan includes rotation and friction during the push
        #[var(start = true, source = "derived")] pub phase_plan: bool,
    }
    /// Learning from the pushes, default control law
    pub struct Learn {
        /// Use the servo bandwidth that is measured during the approach, where it is certain
        #[var(source = "default; check first, then use")] pub servo: bool,
        /// Learn the lateral ratio of the slip in a push
        #[var(expert, start = true)] pub lateral: bool,
        /// Learn the probe deflection at contact
        #[var(expert, start = true)] pub contact: bool,
        /// Learn the deflection of the servo
        #[var(expert, start = true)] pub deflection: bool,
        /// Learn the motion of the ring after a push
        #[var(expert, start = true)] pub recoil: bool,
    }
    /// Tapping of heavy rings, default control law
    pub struct Tap {
        /// Tap heavy rings instead of pushing them
        #[var(start = true)] pub enabled: bool,
        /// Servo deflection above which a ring is heavy
        #[var(unit = METRE as "um", range = 1e-7..=1e-3, start = 8e-6, source = "derived: 2 kg at 40 Hz")]
        pub deflection_min: f64,
        /// Maximum speed of a tap
        #[var(expert, unit = METRE_PER_SECOND as "mm/s", range = 1e-3..=1.0, start = 0.115, source = "default; below the slide velocity")]
        pub speed_max: f64,
        /// Stiffness of the pusher tip, for the first tap
        #[var(unit = NEWTON_PER_METRE, range = 1e4..=1e9, start = 5e6, source = "default; a steel tip")]
        pub tip_stiffness: f64,
        /// Moving mass of the slide, for the first tap
        #[var(unit = KILOGRAM, range = 0.1..=1e3, start = 8.0, source = "default; a small slide")] pub slide_mass: f64,
    }
    /// Bounds and use of the commissioning run
    pub struct Commission {
        /// Maximum travel towards the ring; 0: four servo periods, at most probe.at_pusher / 10
        #[var(unit = METRE as "mm", range = 0.0..=0.1, start = 0.0, source = "derived: a (2 pi / w)^2")]
        pub travel: f64,
        /// Acceleration of the strokes; 0: slide.acceleration_max
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.0..=100.0, start = 0.0, source = "derived: as all moves")]
        pub acceleration: f64,
        /// Use the measured values instead of the configured ones
        #[var(source = "default; check first, then use")] pub apply: bool,
        /// JSON file to which the derived parameters are written; empty: no file
        pub export: String,
    }
    /// Limits of the monitors
    pub struct Limits {
        /// Lower bound of the static friction between ring and table, eq. 2
        #[var(essential, unit = ONE, range = 1e-3..=2.0, start = 0.05, source = "paper")] pub friction: f64,
        /// Maximum number of pushes in one cycle
        #[var(range = 1..=1000, start = 25, source = "default; five times the usual number of the published law")]
        pub pushes: i32,
        /// Spindle speed below which the spindle is at rest
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 1e-3..=10.0, start = 0.1, source = "default; 1 rpm")]
        pub spindle_speed_min: f64,
        /// Consecutive invalid samples of an input that are bridged; one more is a fault
        #[var(range = 1..=100, start = 3, source = "default; a spike is shorter")] pub lost_samples: i32,
        /// Maximum following error of the slide, in addition to the motion in one sample
        #[var(unit = METRE as "mm", range = 1e-5..=0.1, start = 1e-3,
            source = "derived: three times the lag of 40 Hz and the deflection by 70 kg")]
        pub following_error: f64,
        /// Maximum duration of one cycle; 0: derived from limits.pushes and the spindle speed
        #[var(unit = SECOND, range = 0.0..=1e5, start = 0.0, source = "derived: the longest allowed time for each push")]
        pub cycle_time: f64,
    }
}

//! Every variable of the FMU, told once.
//!
//! Sources: "paper" = Mears et al. (2007); "derived" = follows from the equations; "our choice" = usual practice, with the
//! reason where there is one.

pub use variables::*;

#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use std::f64::consts::TAU;

    use control_blocks::DELAY_MAX;
    use crate::monitoring::Numbers;
    use fmi2_export::{Unit, units::*};

    /// Unit of a velocity per length.
    const PER_SECOND: Unit = Unit::si("1/s", [0, 0, -1, 0, 0], &[]);

    /// What the controller is doing.
    pub enum State {
        /// Waits for `enable`; after a centring that it ended, moves back to where it started first
        Idle,
        /// Moves towards the ring until the probe touches it
        Approach,
        /// Brings the pusher to its gap before the ring
        Follow,
        /// Follows and collects the surface
        Collect,
        /// Makes the model of the ring
        Model,
        /// Follows until the ring is where the push must begin
        Wait,
        /// Pushes
        Push,
        /// Retracts after a push and follows again
        Settle,
        /// Moves the slide out and in by 0.2 mm: a probe that does not answer has measured nothing
        Confirm,
        /// The ring is centred; follows it until `enable` is false
        Centred,
        /// Moves back to where it started and holds, or has switched the drive off; a rising edge of `reset_fault` ends it at rest
        Fault,
        /// Measures the servo of the slide with short strokes before the ring, and comes back
        Commission,
    }
    /// Why the controller is in the fault state.
    pub enum Fault {
        /// No fault
        None,
        /// No ring within `approach.travel_max`, or the probe has lost it
        #[hint("is a ring there, and does the probe move freely?")] NoPart,
        /// The spindle axis is not inside the ring: r <= B, eq. 32
        #[hint("place the ring nearer to the axis, or mend `ring.radius`")] RingTooSmall,
        /// The probe is beyond `probe.stroke`, does not settle, or the pusher touches while following
        #[hint("check `probe.at_pusher`; a slower approach, or a ring nearer to the axis")] ProbeRange,
        /// The centrifugal force exceeds the friction of `limits.friction`, eq. 2
        #[hint("turn the spindle more slowly")] Centrifugal,
        /// Not centred within `limits.pushes` pushes
        #[hint("raise `tolerance` or `limits.pushes`; does the ring slide at all?")] PushBudget,
        /// The probe is NaN, infinite or absurd for more than `limits.lost_samples` samples
        #[hint("check the probe and its link")] LostProbe,
        /// The probe is for more than `limits.lost_samples` samples where neither slide nor ring can have brought it, or the ring's centred surface is elsewhere than before
        #[hint("check counter and cable of the probe, and of the slide, and the scale of the spindle encoder; was the ring touched?")] ProbeJump,
        /// The probe keeps its value although slide or ring moves, or does not answer the slide by what that moves
        #[hint("is the probe jammed, its link dead, or its scale wrong? was the ring touched? does the pusher meet it before `probe.at_pusher`?")] FrozenProbe,
        /// The slide encoder is NaN, infinite or absurd for more than `limits.lost_samples` samples
        #[hint("check the slide encoder and its link")] LostReading,
        /// The slide is further from its setpoint than `limits.following_error`
        #[hint("check drive and servo of the slide, and `io_delay`; or is it blocked?")] FollowingError,
        /// The slide moves against its setpoint
        #[hint("swap the sign of drive or encoder of the slide")] DriveSign,
        /// The slide does less than half of what its setpoint says
        #[hint("check scale, current limit and power of the drive of the slide")] WeakDrive,
        /// The spindle keeps reversing, or is too fast for `rates.collect`
        #[hint("turn the spindle evenly in one direction")] Spindle,
        /// The pushes have moved the ring away from the axis by more than `push.critical_distance`
        #[hint("is `spindle_angle` positive about the upward axis, and is the probe read when the slide is?")] Divergence,
        /// A full revolution does not tell the eccentricity from the tolerance
        #[hint("raise `tolerance`, or mend the noise of the probe")] Unresolved,
        /// The measurements fit no ring for some revolutions, or the centring takes longer than `limits.job_time`
        #[hint("is the ring rough, dirty or loose? raise `estimator.noise`, or `limits.job_time` for a slow spindle")] NoProgress,
        /// The slide encoder is for more than `limits.lost_samples` samples where the slide cannot have gone
        #[hint("check counter and cable of the slide encoder")] ReadingJump,
        /// The slide encoder keeps its value although the slide should move
        #[hint("check the slide encoder; or the slide is blocked, or its drive is dead, or later than `io_delay`")] FrozenReading,
        /// The spindle encoder is NaN, infinite or absurd for more than `limits.lost_samples` samples
        #[hint("check the spindle encoder and its link")] LostSpindle,
        /// The spindle encoder is for more than `limits.lost_samples` samples where the spindle cannot have gone
        #[hint("check counter and cable of the spindle encoder")] SpindleJump,
        /// The spindle encoder stands, or turns slower than `limits.spindle_speed_min`, where the ring must turn
        #[hint("turn the spindle; check its encoder")] FrozenSpindle,
        /// The servo of the slide is measured to be slower than any with which the slide keeps to `limits.following_error`
        #[hint("raise the gains of the servo, or lower `slide.acceleration_max`")] SlowServo,
        /// The spindle does not turn with `spindle.speed`, within 5 %, a second after it was told to
        #[hint("is `spindle.speed_setpoint` wired to the drive, and its sign right? 0 leaves the spindle to others")] SpindleSpeed,
        /// What the commission has measured is not sure enough, or not what this controller can work with; or the probe touches something
        #[hint("begin farther from the ring, allow more `commission.travel` or `commission.acceleration`, look for vibration and friction, and check `slide.bandwidth` and `io_delay`")] CommissionRejected,
        /// The communication step is longer than a sample: several samples have the same inputs, and of their commands the last alone is seen
        #[hint("set the communication step of the importer to `sample_period`")] LongStep,
        /// The probe tells later than the slide where it was, and what both say of the ring makes no sense
        #[hint("read probe and slide at the same moment: look for a filter or a slow link of the probe")] LateProbe,
        /// The slide encoder tells later than the probe where it was, and what both say of the ring makes no sense
        #[hint("read probe and slide at the same moment: look for a filter or a slow link of the slide encoder")] LateReading,
        /// In a stroke the probe has come out although the slide goes in: the pusher has met the ring before it should
        #[hint("the pusher is longer than told: measure `probe.at_pusher` anew")] EarlyContact,
    }
    /// Which law centres the ring.
    pub enum Law {
        /// Recursive model of the ring, pushes planned backwards from the centre
        Default,
        /// As in the paper: one revolution, one sine, one push
        Paper,
    }
    /// What is learned after a push.
    pub enum OffsetMethod {
        /// Nothing
        Off,
        /// The difference between wished and actual way of the ring, as in the paper, eq. 37 to 39
        Recursive,
    }
    /// Inputs, sampled at the start of the tick.
    #[inputs] pub struct Input {
        /// Angle of the spindle, wrapped or not; positive about the upward axis
        #[var(unit = RADIAN as "deg", accepts_nan)] pub spindle_angle: f64,
        /// Slide encoder, positive towards the spindle axis
        #[var(unit = METRE as "mm", accepts_nan)] pub slide_position: f64,
        /// Probe encoder: its collapse, 0 when free
        #[var(unit = METRE as "mm", accepts_nan)] pub probe_position: f64,
        /// Rising edge in Idle begins a centring; false ends it: stop, move back, Idle
        pub enable: bool,
        /// Rising edge in `Idle` measures the servo of the slide, once the slide is at rest; false, or a rising edge of `enable`, breaks off: stop, move back, Idle
        pub commission: bool,
        /// Rising edge ends the state Fault once the slide is at rest: Idle, which waits for a rising edge of `enable`
        pub reset_fault: bool,
    }
    /// Outputs; always finite.
    #[outputs] pub struct Output {
        pub slide: Setpoint,
        /// Speed command to the drive of the spindle: to `spindle.speed` while a ring is centred or is centred and held, 0 otherwise
        #[var(name = "spindle.speed_setpoint", unit = RADIAN_PER_SECOND as "rpm")] pub spindle_speed_setpoint: f64,
        pub state: State,
        /// Why it is in the state Fault, the gravest reason so far; kept until `reset_fault`
        pub fault: Fault,
        /// The drive of the slide may be on; false from a fault in which no command is known to help until `reset_fault`
        #[var(start = true)] pub drive_enable: bool,
        /// The ring was centred; kept until the next start
        pub centred: bool,
        /// From the start to `centred`
        #[var(unit = SECOND)] pub time_to_centre: f64,
        /// Distance B of the ring's centre from the spindle axis in the last model
        #[var(unit = METRE as "um")] pub eccentricity: f64,
        /// Spindle angle at which the ring is nearest to the pusher
        #[var(unit = RADIAN as "deg")] pub eccentricity_angle: f64,
        /// Standard deviation of the measured eccentricity
        #[var(unit = METRE as "nm")] pub eccentricity_sigma: f64,
        /// Estimated spindle speed
        #[var(unit = RADIAN_PER_SECOND as "rpm")] pub spindle_speed: f64,
        /// Gap between pusher and ring as the probe says
        #[var(unit = METRE as "um")] pub pusher_gap: f64,
        pub push: PushReport,
        pub monitor: MonitorReport,
        pub measured: Measured,
        /// Numbers that are told with a fault.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
    }
    /// Command to the servo of the slide.
    pub struct Setpoint {
        /// Position command to the servo of the slide, positive towards the spindle axis
        #[var(unit = METRE as "mm")] pub position_setpoint: f64,
        /// Velocity command to the servo of the slide
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub velocity_setpoint: f64,
    }
    /// What is told about the last push.
    pub struct PushReport {
        /// Pushes since the start
        pub count: i32,
        /// Travel d of the last push, with gap and offset
        #[var(unit = METRE as "um")] pub distance: f64,
        /// Velocity v of the last push
        #[var(unit = METRE_PER_SECOND as "mm/s")] pub velocity: f64,
        /// Lead angle L of the last push
        #[var(unit = RADIAN as "deg")] pub lead_angle: f64,
        /// Learned offset P
        #[var(unit = METRE as "um")] pub offset: f64,
        /// How far the last push moved the ring through the centre
        #[var(unit = METRE as "um")] pub overshoot: f64,
        /// Largest overshoot since the start
        #[var(unit = METRE as "um")] pub overshoot_max: f64,
    }
    /// What the monitors see.
    pub struct MonitorReport {
        /// Setpoint minus position of the slide, aligned by `io_delay`
        #[var(unit = METRE as "um")] pub following_error: f64,
        /// How much of its setpoint the slide has moved lately; 1 is right, and 1 without motion
        #[var(unit = ONE, start = 1.0)] pub drive_share: f64,
        /// How much of the last small move before Centred the probe has answered; 1 is right
        #[var(unit = ONE, start = 1.0)] pub probe_share: f64,
        /// Since the start, until `centred`
        #[var(unit = SECOND)] pub job_time: f64,
    }
    /// What a commission has measured, or without a good one the way to the ring of the bandwidth; each with its standard deviation, 0 before
    pub struct Measured {
        /// The results of the commission are good; without one, the deviation of the bandwidth is at most 5 %
        pub valid: bool,
        /// Bandwidth of the servo of the slide, from setpoint and encoder
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub slide_bandwidth: f64,
        /// Its standard deviation
        #[var(unit = RADIAN_PER_SECOND as "Hz")] pub slide_bandwidth_deviation: f64,
        /// Damping ratio of that servo
        #[var(unit = ONE)] pub slide_damping: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub slide_damping_deviation: f64,
        /// Integral action of that servo, the reciprocal of its integral time; 0 for none
        #[var(unit = PER_SECOND)] pub slide_integral: f64,
        /// Its standard deviation
        #[var(unit = PER_SECOND)] pub slide_integral_deviation: f64,
        /// Samples between a setpoint and its action, not rounded
        #[var(unit = ONE)] pub io_delay: f64,
        /// Its standard deviation
        #[var(unit = ONE)] pub io_delay_deviation: f64,
    }
    /// All parameters.
    #[parameters] pub struct Parameters {
        #[var(paper = Law::Paper, source = "our choice")] pub law: Law,
        /// Sample period of the setpoints
        #[var(unit = SECOND as "ms", range = 1e-4..=0.01, start = 1e-3, source = "our choice: a 12 ms push needs setpoints at this rate")]
        pub sample_period: f64,
        /// Samples between a setpoint and its action; 1 for a standard master, 0 if it acts at once
        #[var(range = 0..=DELAY_MAX as i32, start = 1, source = "our choice: what a standard master does")] pub io_delay: i32,
        /// Largest eccentricity of a centred ring
        #[var(unit = METRE as "um", range = 1e-8..=1e-3, start = 2.5e-6, source = "paper")] pub tolerance: f64,
        pub ring: Ring,
        pub probe: Probe,
        pub slide: Slide,
        /// Resolution of the spindle encoder
        #[var(name = "spindle.quantum", unit = RADIAN as "deg", range = 0.0..=0.1, start = TAU / 4000.0, source = "paper")] pub spindle_quantum: f64,
        /// Length of the regression for angle and speed
        #[var(name = "spindle.window", unit = SECOND, range = 0.1..=5.0, start = 0.5, source = "derived: jitter 0.02 %")] pub spindle_window: f64,
        /// Speed of the spindle that `spindle.speed_setpoint` commands; 0 where somebody else turns it
        #[var(name = "spindle.speed", unit = RADIAN_PER_SECOND as "rpm", range = -20.0..=20.0, source = "our choice: as the paper, whose spindle turns by itself")] pub spindle_speed: f64,
        /// Slope of that command; 0 for 0.6 mu g / r, of `limits.friction` and `ring.radius`
        #[var(name = "spindle.acceleration", unit = RADIAN_PER_SECOND_SQUARED, range = 0.0..=1e3, source = "derived: leaves 0.8 of the friction to eq. 2, which is at right angles")]
        pub spindle_acceleration: f64,
        pub approach: Approach,
        pub follow: Follow,
        pub rates: Rates,
        pub kalman: Kalman,
        pub push: Push,
        pub offset: Offset,
        pub park: Park,
        pub estimator: Estimator,
        pub stroke: StrokePlan,
        pub learn: Learn,
        pub tap: Tap,
        pub commission: Commission,
        pub limits: Limits,
    }
    /// The part.
    pub struct Ring {
        /// Nominal outer radius r of the ring
        #[var(unit = METRE as "mm", range = 1e-3..=2.0, start = 0.05, source = "our choice: of the paper's size; told by the operator")] pub radius: f64,
        /// Largest eccentricity expected, for the look-ahead of the approach
        #[var(unit = METRE as "mm", range = 1e-6..=1.0, start = 0.025, source = "paper")] pub eccentricity_max: f64,
    }
    /// Measuring probe.
    pub struct Probe {
        /// Collapse of the probe at which the pusher touches the ring
        #[var(unit = METRE as "mm", range = 1e-4..=0.5, start = 0.020, source = "our choice: more than eq. 9; from a calibration")] pub at_pusher: f64,
        /// Stroke of the probe
        #[var(unit = METRE as "mm", range = 1e-4..=0.5, start = 0.025, source = "paper")] pub stroke: f64,
        /// Collapse of the probe that counts as touching
        #[var(unit = METRE as "um", range = 1e-6..=0.01, start = 2e-4, source = "our choice: far above noise and dirt")] pub contact: f64,
    }
    /// Slide and its servo.
    pub struct Slide {
        /// Largest velocity of the slide
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-3..=10.0, start = 0.12, source = "paper")] pub velocity_max: f64,
        /// Acceleration a of all moves
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.01..=100.0, start = 2.56, source = "paper")] pub acceleration_max: f64,
        /// Bandwidth of the servo of the slide, for feed-forward; 0 for none
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=6283.2, start = 40.0 * TAU, source = "our choice: 40 Hz")] pub bandwidth: f64,
    }
    /// Approach motion.
    pub struct Approach {
        /// Velocity of the approach and of the way back
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-4..=10.0, start = 0.12, source = "paper")] pub velocity: f64,
        /// Longest travel from the start position until the probe touches, and `probe.stroke` more from then on; where a
        /// dead probe must not let the pusher meet the ring, less than the way to it
        #[var(unit = METRE as "mm", range = 1e-3..=10.0, start = 0.15, source = "our choice")] pub travel_max: f64,
        /// Stroke of the probe before the pusher that the fastest approach needs, eq. 9
        #[var(unit = METRE as "mm", calculated)] pub look_ahead: f64,
    }
    /// Following of the surface.
    pub struct Follow {
        /// Velocity per error Kp of following
        #[var(unit = PER_SECOND, range = 0.1..=1e3, start = 15.0, source = "derived: critically damped at 25 with one sample of delay")] pub gain: f64,
        /// Largest velocity towards the place on the ring, beside that of the surface: a probe that reads too little lets the pusher hit the ring with it
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-4..=10.0, start = 0.02, source = "derived: a ring hit at 20 mm/s slides 0.4 mm; 1 s for the way of the probe")] pub velocity_max: f64,
        /// Gap between pusher and ring while following
        #[var(unit = METRE as "um", range = 1e-5..=0.1, start = 5e-4, source = "our choice")] pub gap: f64,
        /// Error of following without reaction
        #[var(unit = METRE as "um", range = 0.0..=0.1, source = "paper")] pub dead_zone: f64,
        /// Error of following that counts as settled
        #[var(unit = METRE as "um", range = 1e-6..=0.1, start = 2e-4, source = "our choice")] pub settle_band: f64,
        /// Time within that band
        #[var(unit = SECOND, range = 0.0..=10.0, start = 0.1, source = "our choice")] pub settle_time: f64,
    }
    /// Rates of the loops.
    pub struct Rates {
        /// Rate of following and launching
        #[var(unit = HERTZ, range = 1.0..=1e4, start = 100.0, source = "paper")] pub control: f64,
        /// Rate of collecting
        #[var(unit = HERTZ, range = 1.0..=1e4, start = 66.0, source = "paper")] pub collect: f64,
        /// Rate of modelling
        #[var(unit = HERTZ, range = 0.1..=1e4, start = 10.0, source = "paper")] pub model: f64,
    }
    /// Scalar Kalman filter of the surface, standard deviations; counts with `law` = Paper.
    pub struct Kalman {
        /// Walk of the surface from sample to sample sqrt(Q)
        #[var(unit = METRE as "nm", range = 1e-9..=1e-3, start = 0.015e-6, source = "paper")] pub process_noise: f64,
        /// Noise of the measurement sqrt(R)
        #[var(unit = METRE as "nm", range = 1e-9..=1e-3, start = 0.03e-6, source = "paper")] pub measurement_noise: f64,
    }
    /// Pushes.
    pub struct Push {
        /// Velocity v_min of the smallest push
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-6..=1.0, start = 4e-4, source = "paper, printed as 400 mm/s")] pub velocity_min: f64,
        /// Velocity v_max of a large push
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-6..=1.0, start = 3.5e-3, source = "paper, printed as 3500 mm/s")] pub velocity_max: f64,
        /// Eccentricity d_crit from which a push is large
        #[var(unit = METRE as "um", range = 1e-6..=0.1, start = 2.5e-3, source = "paper")] pub critical_distance: f64,
        /// Steepness s of the velocity below it
        #[var(unit = ONE, range = 0.1..=10.0, start = 1.0, source = "paper")] pub steepness: f64,
        /// Time at the end of the stroke, before the retract
        #[var(unit = SECOND as "ms", range = 0.0..=1.0, start = 0.01, source = "our choice: the lag of a 40 Hz servo")] pub dwell: f64,
    }
    /// Offset that is learned from push to push; counts with `law` = Paper.
    pub struct Offset {
        #[var(start = OffsetMethod::Recursive, source = "paper")] pub method: OffsetMethod,
        /// Only pushes of a smaller eccentricity teach
        #[var(unit = METRE as "um", range = 1e-6..=1.0, start = 2e-4, source = "paper")] pub gate: f64,
        /// Largest offset in either direction
        #[var(unit = METRE as "um", range = 0.0..=0.01, start = 3e-4, source = "our choice")] pub limit: f64,
    }
    /// Parking of the slide between the pushes: the probe hardly collapsed, for little force on the ring, and the slide mostly at rest.
    pub struct Park {
        /// Collapse of the probe while the slide is parked
        #[var(unit = METRE as "mm", range = 1e-4..=0.5, start = 4.5e-3, source = "our choice: a fifth of its force range")] pub probe: f64,
        /// Change of that collapse without reaction of the slide
        #[var(unit = METRE as "mm", range = 0.0..=0.1, start = 3e-3, source = "our choice")] pub dead_zone: f64,
    }
    /// Recursive model of the ring; counts with the default law.
    pub struct Estimator {
        /// Standard deviation of one measurement
        #[var(unit = METRE as "nm", range = 1e-9..=1e-3, start = 2e-7, source = "our choice: probe and roughness twice")] pub noise: f64,
        /// Standard deviation of each coordinate of the centre before the first measurement
        #[var(unit = METRE as "mm", range = 1e-6..=0.1, start = 5e-3, source = "our choice: placed by hand")] pub centre: f64,
        /// Standard deviation of each form coefficient before the first measurement; 0 for a round ring
        #[var(unit = METRE as "um", range = 0.0..=1e-3, start = 2e-6, source = "our choice: ground rings")] pub form: f64,
        /// Innovations beyond this many standard deviations are dirt
        #[var(unit = ONE, range = 1.0..=1e6, start = 6.0, source = "our choice")] pub gate: f64,
        /// A part of a revolution may suffice for a push
        #[var(start = true, source = "paper, as future work")] pub partial: bool,
        /// Largest relative standard deviation of the eccentricity for a push
        #[var(unit = ONE, range = 0.01..=1.0, start = 0.2, source = "our choice")] pub certainty: f64,
        /// Standard deviations by which a centred ring stays within `tolerance`
        #[var(unit = ONE, range = 0.0..=10.0, start = 3.0, source = "our choice")] pub margin: f64,
    }
    /// Strokes of the pusher; counts with the default law.
    pub struct StrokePlan {
        /// Shortest time from contact to rest
        #[var(unit = SECOND as "ms", range = 0.01..=1.0, start = 0.08, source = "our choice: three periods of the servo")] pub duration: f64,
        /// Largest deceleration at the end of a push
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.01..=10.0, start = 0.2, source = "derived: less than friction gives a light ring")]
        pub deceleration: f64,
        /// Largest velocity at contact
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-4..=1.0, start = 0.04, source = "our choice")] pub velocity_max: f64,
        /// Longest wait at the end for the surface to arrive
        #[var(unit = SECOND as "ms", range = 0.0..=1.0, start = 0.04, source = "our choice: one period of the servo")] pub hold: f64,
        /// Integral gain from the place of the surface to the slide; 0 for none
        #[var(unit = PER_SECOND, range = 0.0..=200.0, start = 60.0, source = "derived: a quarter of the servo's bandwidth")] pub feedback: f64,
        /// Rotation and friction during the push are planned
        #[var(start = true, source = "derived")] pub phase_plan: bool,
    }
    /// What pushes teach; counts with the default law.
    pub struct Learn {
        /// The bandwidth of the servo that is measured on the way to the ring is used where it is sure and `slide.bandwidth` is not 0
        #[var(source = "our choice: first look, then trust")] pub servo: bool,
        /// The lateral ratio is learned
        #[var(start = true)] pub lateral: bool,
        /// Lateral ratio before the first push: slip across the push over slip along it
        #[var(unit = ONE, range = 0.0..=1.0, start = 0.05,
            source = "derived: less than any, so that what is left comes to the pusher after a quarter of a revolution and not after three")]
        pub lateral_start: f64,
        /// Its standard deviation
        #[var(unit = ONE, range = 0.01..=1.0, start = 0.1, source = "our choice")] pub lateral_sigma: f64,
        /// The probe position at contact is learned
        #[var(start = true)] pub contact: bool,
        /// The deflection of the servo is learned
        #[var(start = true)] pub deflection: bool,
        /// The way of the ring after a push is learned
        #[var(start = true)] pub recoil: bool,
    }
    /// Tapping of heavy rings; counts with the default law.
    pub struct Tap {
        /// Heavy rings are tapped
        #[var(start = true)] pub enabled: bool,
        /// Largest distance for a tap, in deflections of the servo
        #[var(unit = ONE, range = 0.1..=100.0, start = 1.5, source = "our choice")] pub reach: f64,
        /// A ring that deflects the servo less is light
        #[var(unit = METRE as "um", range = 1e-7..=1e-3, start = 8e-6, source = "derived: 2 kg at 40 Hz")] pub deflection_min: f64,
        /// Largest speed of a tap
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-3..=1.0, start = 0.115, source = "our choice: of the slide")] pub speed_max: f64,
        /// Stiffness of the pusher tip, for the first tap
        #[var(unit = NEWTON_PER_METRE, range = 1e4..=1e9, start = 5e6, source = "our choice")] pub tip_stiffness: f64,
        /// Moving mass of the slide, for the first tap
        #[var(unit = KILOGRAM, range = 0.1..=1e3, start = 8.0, source = "our choice")] pub slide_mass: f64,
    }
    /// Bounds of the state `Commission`, and what becomes of its results.
    pub struct Commission {
        /// Farthest way towards the ring from where it begins; 0: the way of which a stroke there and back takes four periods of the servo, at most a tenth of `probe.at_pusher`
        #[var(unit = METRE as "mm", range = 0.0..=0.1, start = 0.0, source = "derived: a (2 pi / w)^2")] pub travel: f64,
        /// Acceleration of the strokes, and with the moving mass their force; 0: `slide.acceleration_max`
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.0..=100.0, start = 0.0, source = "derived: as all moves")] pub acceleration: f64,
        /// Longest time; 0: what five rounds of strokes take, of which three are needed, and 1 s
        #[var(unit = SECOND, range = 0.0..=1e6, start = 0.0, source = "derived: 5/3 of the motions + 1 s")] pub time: f64,
        /// Largest relative standard deviation of the bandwidth; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-6..=0.5, start = 0.02, source = "our choice: feed-forward has twice that error")] pub deviation_max: f64,
        /// Largest standard deviation of the delay, samples; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-3..=2.0, start = 0.25, source = "our choice: two of them to the next half sample")] pub delay_deviation_max: f64,
        /// Use what was measured in place of what was told
        #[var(source = "our choice: first look, then trust")] pub apply: bool,
        /// File that a good commission writes: JSON, the parameters that it derives; empty: none
        pub export: String,
    }
    /// What is a fault.
    pub struct Limits {
        /// Friction mu_s that the centrifugal force must not exceed, eq. 2
        #[var(unit = ONE, range = 1e-3..=2.0, start = 0.05, source = "paper")] pub friction: f64,
        /// Most pushes of one centring
        #[var(range = 1..=1000, start = 25, source = "our choice")] pub pushes: i32,
        /// A slower spindle stands still
        #[var(unit = RADIAN_PER_SECOND as "rpm", range = 1e-3..=10.0, start = 0.1, source = "our choice: 1 rpm")] pub spindle_speed_min: f64,
        /// Samples in a row for which an input that cannot be believed is bridged; one more is a fault
        #[var(range = 1..=100, start = 3, source = "our choice: a spike is shorter")] pub lost_samples: i32,
        /// Largest distance of the slide from its setpoint, beside what one sample of motion is worth
        #[var(unit = METRE as "mm", range = 1e-5..=0.1, start = 1e-3,
            source = "derived: a / w^2 = 0.04 mm in the fastest moves, 0.3 mm of deflection by 70 kg on 40 Hz, and three times that")]
        pub following_error: f64,
        /// Longest centring; 0 for `approach.travel_max` / `approach.velocity` + (`limits.pushes` + 1) (5 s + 2.2 revolutions
        /// + the way of the probe to its place / `follow.velocity_max`)
        #[var(unit = SECOND, range = 0.0..=1e5, start = 0.0, source = "derived: what every push may take until the next")] pub job_time: f64,
    }
}

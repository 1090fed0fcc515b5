//! Every variable of the FMU, told once; the tables of the README come from here.
//!
//! Sources: "paper" = Kakinuma and Nagakari (2017), "derived" = follows from the equations, "our choice" = usual
//! practice, with the reason where there is one.
pub use variables::*;

#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use control_blocks::DELAY_MAX;
    use crate::monitoring::numbers::Numbers;
    use fmi2_export::{Unit, units::*};

    /// Most spindle harmonics that filters can hold.
    pub const HARMONICS_MAX: usize = 4;
    /// Unit of the integral gain.
    const PER_SECOND_CUBED: Unit = Unit::si("1/s3", [0, 0, -3, 0, 0], &[]);
    /// Unit of the viscous friction.
    const NEWTON_SECOND_PER_METRE: Unit = Unit::si("N.s/m", [1, 0, -1, 0, 0], &[]);
    /// Unit of a length that grows as the speed falls.
    const SQUARE_METRE_PER_SECOND: Unit = Unit::si("m2/s", [0, 2, -1, 0, 0], &[]);

    /// What the controller is doing
    pub enum State {
        /// Holds its position and waits for a rising edge of `enable`
        Idle,
        /// Stands to take the force at rest, accelerates, and settles at constant speed
        Approach,
        /// Learns the noise at constant speed
        Learn,
        /// Watches for contact
        Detect,
        /// Has detected contact and decelerates
        Contact,
        /// Moves back, stands, and checks that the force of the contact has gone
        Retract,
        /// Holds its position after the retract; a rising edge of `enable` begins again
        Done,
        /// Moves back and holds, or switches the drive off, whichever the fault asks for; a rising edge of `reset_fault` ends it
        Fault,
        /// Measures its machine with small motions away from the workpiece, and comes back
        Commission,
        /// Goes back a little and touches again where it suspects a contact
        Confirm,
        /// Stands between two touches of a teaching, and learns from the one before
        Teach,
    }
    /// Why the controller is in the fault state
    pub enum Fault {
        /// No fault
        None,
        /// No contact within `approach.travel_max`
        #[hint("start closer to the workpiece, or allow more travel")] TravelLimit,
        /// `position_valid` was false, or `position` NaN, infinite or beyond 1 km, for too many samples in a row
        #[hint("check the encoder and its link")] LostReading,
        /// `position` stands although the stage must have moved
        #[hint("check the encoder, the unit of `position` and its link; is the drive later than `io_delay`? a position without any noise at rest needs `limits.rest_time` = 0")] FrozenReading,
        /// `position` is where the stage cannot be, for too many samples in a row
        #[hint("check the encoder, the unit of `position`, its link and its noise against `limits.jump`; does the drive do more than `stage.force_constant` says, or act later than `io_delay`?")] ReadingJump,
        /// `spindle_speed` changes faster than a spindle can, for too many samples in a row
        #[hint("check the signal of the spindle, or raise `limits.spindle_acceleration`")] SpindleJump,
        /// The stage is too far from its reference
        #[hint("check that the stage moves freely, `stage.mass`, `stage.force_constant` and `io_delay`")] FollowingError,
        /// The current was at its limit for longer than `limits.saturated_time`
        #[hint("check that the stage moves freely, or lower `approach.acceleration` and `retract.deceleration`")] Saturation,
        /// The estimated disturbance is larger than the machine can have
        #[hint("check that nothing blocks the stage, and `stage.mass` and `stage.force_constant`")] Overload,
        /// The stage moves against the current
        #[hint("swap the sign of the current or of the encoder, and check `approach.direction`; if the stage has moved rightly before, look for a link of the encoder or of the drive that has fallen behind")] DriveSign,
        /// The stage moves far less than the current should move it: the drive is weak or off, or the stage is held
        #[hint("check the amplifier, its cable and its limit, that the stage moves freely, and `stage.force_constant`")] WeakDrive,
        /// The loop swings: the current from limit to limit, or the stage about a reference that does not accelerate
        #[hint("check `io_delay` against the delay of drive and encoder, or lower `servo.bandwidth` or `observer.bandwidth`")] Oscillation,
        /// The learned slope is too noisy, not around zero, or silent
        #[hint("check that `spindle_speed` is connected, settle longer, or raise `limits.slope_sigma_max`")] LearnRejected,
        /// Learning did not end
        #[hint("check that `spindle_speed` stands, or raise `limits.learn_time`")] LearnTimeout,
        /// The force did not go away with the retract: something else than a contact changed it
        #[hint("look for a force that changed, or raise `limits.force_left`")] ContactRejected,
        /// The job took longer than it may
        #[hint("check what holds it up, or raise `limits.job_time`")] NoProgress,
        /// `spindle_speed` was NaN, infinite or beyond 1e5 rad/s for too many samples in a row
        #[hint("check what is connected to this input, and its unit")] LostSpindle,
        /// A step of the importer is longer than a sample: several samples have the same inputs, and of their commands the last alone is seen
        #[hint("co-simulation: set the communication step to `sample_period`; model exchange: the importer has to stop at every time event")] LongStep,
        /// The force guard found the contact: the detector was not armed yet, or had missed it, and the tool was deeper than it lets it
        #[hint("start farther from the workpiece, or choose a `detector` that sees this contact at this speed; look for vibration that hides it, and for readings that jump")] LateContact,
        /// What the commission has measured is not sure enough, or not what this controller can hold
        #[hint("allow more `commission.travel` or `commission.force`, look for vibration and friction, tell a larger `guard.force` if the work bears it, and check `stage.mass`, `stage.force_constant`, `stage.current_bandwidth` and `io_delay`")] CommissionRejected,
        /// The touches of a teaching scatter too much, tell a bias that is not sure enough or cannot be, or press too hard
        #[hint("check `teach.place`; on work that is too soft or yields no bias can be taught; touch more often, look for vibration; allow more `approach.travel_max`, or lower `teach.velocity_max`; on hard work allow more `teach.force_max`, or lower `teach.velocity_min`")] TeachingRejected,
        /// `position` says again what it has said some samples before, for too many samples in a row
        #[hint("look for a link or a filter of the encoder that has fallen behind")] LateReading,
    }
    /// What detected the contact
    pub enum ContactSource {
        /// No contact
        None,
        /// Notched force
        Raw,
        /// Deviation from the moving average
        Deviation,
        /// Slope over one window
        Slope,
        /// Slope over four windows
        MultiSlope,
        /// Cumulative sum of the Kalman innovation
        Cusum,
        /// Generalised likelihood ratio of the Kalman innovation
        Glr,
        /// Hard force guard
        ForceGuard,
    }
    /// Which law is in force; `Paper` gives what was not set the value of the paper
    pub enum Law {
        /// Likelihood of a contact at each of `glr.onsets` instants, by a Kalman filter
        Default,
        /// The law as printed: slope over one window, threshold mu + 4 sigma
        Paper,
    }
    /// Which detector decides
    pub enum DetectorKind {
        /// Notched force
        Raw,
        /// Deviation from the moving average, eq. 2
        Deviation,
        /// Slope over one window, eq. 3, as in the paper
        Slope,
        /// Slope over 2, 5, 10 and 20 ms side by side
        MultiSlope,
        /// Cumulative sum of the Kalman innovation
        Cusum,
        /// Generalised likelihood ratio of the Kalman innovation
        Glr,
    }
    /// Where alpha of the threshold mu + alpha sigma comes from
    pub enum ThresholdMode {
        /// `threshold.alpha`, as in the paper
        Fixed,
        /// `threshold.false_alarm_interval` and the learned crossing rate
        Automatic,
    }
    /// Inputs, sampled at the start of a communication step
    #[inputs] pub struct Input {
        /// Encoder position z
        #[var(unit = METRE as "um", accepts_nan)] pub position: f64,
        /// Encoder and its link are good
        #[var(start = true)] pub position_valid: bool,
        /// Spindle speed; 0 switches the notches off
        #[var(unit = RADIAN_PER_SECOND as "rpm", accepts_nan)] pub spindle_speed: f64,
        /// Rising edge after the first sample begins an approach from `Idle` or `Done`, once the stage is found and at rest; false ends one: decelerate, retract, `Done`
        pub enable: bool,
        /// Rising edge after the first sample measures the machine from `Idle` or `Done`, once the stage is found and at rest; false, or a rising edge of `enable`, breaks off: decelerate, `Idle`
        pub commission: bool,
        /// Rising edge after the first sample touches the work at `teach.place` at several speeds from `Idle` or `Done`, once the stage is found and at rest; false, or a rising edge of `enable`, breaks off: decelerate, retract, `Idle`
        pub teach: bool,
        /// Rising edge ends a fault once the stage is at rest behind its retreat, or the drive is off and `position` is good
        pub reset_fault: bool,
    }
    /// Outputs; always finite
    #[outputs] pub struct Output {
        /// Quantised current command I_a^ref
        #[var(unit = AMPERE)] pub current: f64,
        pub state: State,
        pub fault: Fault,
        /// The drive shall be on; false from a fault that the controller cannot control until it is reset
        #[var(start = true)] pub drive_enable: bool,
        /// The approach was ended by `enable`, or broken off with its teaching; kept until the next approach
        pub aborted: bool,
        /// Contact was detected; kept until the next approach, withdrawn by a fault before `Done`
        pub contact: bool,
        pub contact_source: ContactSource,
        /// Encoder position at the detection, as in the paper
        #[var(unit = METRE as "um")] pub contact_position: f64,
        /// Position of the first touch: `contact_position` less the bias at the speed of this approach, in its direction
        #[var(unit = METRE as "um")] pub contact_position_estimate: f64,
        /// Standard deviation of `contact_position_estimate`, by the teaching whose bias is in force; 0 where the bias was told
        #[var(unit = METRE as "nm")] pub contact_position_deviation: f64,
        /// Time of the detection since the initialisation
        #[var(unit = SECOND)] pub contact_time: f64,
        pub force: ForceOutput,
        pub threshold: ThresholdOutput,
        pub reference: ReferenceOutput,
        /// Reference less position; 0 while the position is lost; what it was when the drive went off
        #[var(unit = METRE as "nm")] pub tracking_error: f64,
        /// Share of the commanded force that accelerates the stage; 1 until enough was commanded to tell
        #[var(unit = ONE, start = 1.0)] pub drive_share: f64,
        /// Numbers that are told with a fault.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
        pub measured: Measured,
        pub taught: Taught,
    }
    /// What the commission has measured, each with its standard deviation; 0 before
    pub struct Measured {
        /// The last commission came to its end, and its results are good; false from the next one on
        pub valid: bool,
        /// Thrust constant that goes with `stage.mass`: their ratio is what can be known
        #[var(unit = NEWTON_PER_AMPERE)] pub force_constant: f64,
        /// Its standard deviation, with a ripple of the thrust of 1 %
        #[var(unit = NEWTON_PER_AMPERE)] pub force_constant_deviation: f64,
        /// Samples between a command and its action, not rounded, without the current loop of `stage.current_bandwidth`
        #[var(unit = ONE)] pub io_delay: f64,
        /// Its standard deviation, with a current loop that is told within 30 %
        #[var(unit = ONE)] pub io_delay_deviation: f64,
        /// Viscous friction of a stage of `stage.mass`
        #[var(unit = NEWTON_SECOND_PER_METRE)] pub damping: f64,
        /// Its standard deviation
        #[var(unit = NEWTON_SECOND_PER_METRE)] pub damping_deviation: f64,
        /// Change of the force with the position around the commission: cogging, springs of cables and hoses
        #[var(unit = NEWTON_PER_METRE)] pub stiffness: f64,
        /// Its standard deviation
        #[var(unit = NEWTON_PER_METRE)] pub stiffness_deviation: f64,
        /// Noise of the position in motion, with quantisation
        #[var(unit = METRE as "nm")] pub position_noise: f64,
        /// Its standard deviation
        #[var(unit = METRE as "nm")] pub position_noise_deviation: f64,
        /// White part of the notched force in one sample
        #[var(unit = NEWTON as "mN")] pub force_noise: f64,
        /// Its standard deviation
        #[var(unit = NEWTON as "mN")] pub force_noise_deviation: f64,
        /// Random walk of the notched force in one sample
        #[var(unit = NEWTON as "mN")] pub disturbance_walk: f64,
        /// Its standard deviation
        #[var(unit = NEWTON as "mN")] pub disturbance_walk_deviation: f64,
        /// Standard deviation of the notched force over all strokes
        #[var(unit = NEWTON as "mN")] pub force_sigma: f64,
        /// Its standard deviation
        #[var(unit = NEWTON as "mN")] pub force_sigma_deviation: f64,
        /// Standard deviation of the slope at the approach speed
        #[var(unit = NEWTON_PER_SECOND)] pub slope_sigma: f64,
        /// Its standard deviation
        #[var(unit = NEWTON_PER_SECOND)] pub slope_sigma_deviation: f64,
    }
    /// What a teaching has learned of the bias, each with its standard deviation; 0 before
    pub struct Taught {
        /// The last teaching came to its end, and its results are good; false from the next one on
        pub valid: bool,
        /// Touches of the last teaching
        pub touches: i32,
        /// Slowest speed at which the bias is as sure as it is to be; slower, `contact_position_deviation` is larger
        #[var(unit = METRE_PER_SECOND as "um/s")] pub velocity_min: f64,
        /// Fastest speed that was taught: `teach.velocity_max`, or less where `teach.force_max` bears no more
        #[var(unit = METRE_PER_SECOND as "um/s")] pub velocity_max: f64,
        /// Part of the bias that is the same at every speed, with what `teach.place` is not known to
        #[var(unit = METRE as "nm")] pub bias: f64,
        /// Its standard deviation
        #[var(unit = METRE as "nm")] pub bias_deviation: f64,
        /// Part of the bias that grows with the speed, at 100 um/s
        #[var(unit = METRE as "nm")] pub bias_fast: f64,
        /// Its standard deviation
        #[var(unit = METRE as "nm")] pub bias_fast_deviation: f64,
        /// Part of the bias that grows as the speed falls, times it
        #[var(unit = SQUARE_METRE_PER_SECOND)] pub bias_slow: f64,
        /// Its standard deviation
        #[var(unit = SQUARE_METRE_PER_SECOND)] pub bias_slow_deviation: f64,
        /// Largest standard deviation of the bias from `taught.velocity_min` on; that of one touch besides is `taught.scatter`
        #[var(unit = METRE as "nm")] pub deviation: f64,
        /// Standard deviation of the touches of one speed, from `taught.velocity_min` on
        #[var(unit = METRE as "nm")] pub scatter: f64,
        /// Its standard deviation
        #[var(unit = METRE as "nm")] pub scatter_deviation: f64,
    }
    /// Chain of force estimates; positive when the workpiece pushes back
    pub struct ForceOutput {
        /// Estimated disturbance force F_dis, eq. 1; positive when the workpiece pushes back
        #[var(unit = NEWTON as "mN")] pub disturbance: f64,
        /// Disturbance force without spindle harmonics
        #[var(unit = NEWTON as "mN")] pub notched: f64,
        /// Deviation from the moving average, eq. 2
        #[var(unit = NEWTON as "mN")] pub deviation: f64,
        /// Slope a_k of the deviation over `slope.window`, eq. 3
        #[var(unit = NEWTON_PER_SECOND)] pub slope: f64,
    }
    /// Learned statistics and threshold of a signal, here of the slope over `slope.window`
    pub struct ThresholdOutput {
        /// Learned mean mu of the slope
        #[var(unit = NEWTON_PER_SECOND)] pub mean: f64,
        /// Learned standard deviation sigma of the slope
        #[var(unit = NEWTON_PER_SECOND)] pub sigma: f64,
        /// Threshold mu + alpha sigma of the slope
        #[var(unit = NEWTON_PER_SECOND)] pub value: f64,
        /// The alpha in use
        #[var(unit = ONE)] pub alpha_used: f64,
        /// Learned rate nu_0 at which the slope crosses its mean upwards
        #[var(unit = HERTZ)] pub crossing_rate: f64,
    }
    /// Reference of the servo
    pub struct ReferenceOutput {
        /// Position reference of the servo
        #[var(unit = METRE as "um")] pub position: f64,
        /// Velocity reference of the servo
        #[var(unit = METRE_PER_SECOND as "um/s")] pub velocity: f64,
    }
    /// Parameters
    #[parameters] pub struct Parameters {
        pub law: Law,
        /// Sample period T_s
        #[var(unit = SECOND as "us", range = 2e-5..=1e-3, start = 1e-4, source = "our choice: a usual amplifier rate")] pub sample_period: f64,
        /// Samples between a command and its action; 1 for a standard master, 0 if the command acts at once
        #[var(range = 0..=DELAY_MAX as i32, start = 1, source = "our choice: a standard master")] pub io_delay: i32,
        pub stage: Stage,
        pub servo: Servo,
        pub observer: Observer,
        /// Number of spindle harmonics removed
        #[var(name = "notch.harmonics", range = 0..=HARMONICS_MAX as i32, start = 2, source = "our choice")] pub notch_harmonics: i32,
        /// Quality Q of each notch
        #[var(name = "notch.quality", unit = ONE, range = 0.5..=100.0, start = 2.0, source = "our choice")] pub notch_quality: f64,
        /// Time of the moving average, r samples in eq. 2
        #[var(name = "deviation.window", unit = SECOND as "ms", range = 1e-3..=10.0, start = 0.1, source = "our choice: depth is flat from 20 to 500 ms")] pub deviation_window: f64,
        /// Time of the least-squares slope, N samples in eq. 3
        #[var(name = "slope.window", unit = SECOND as "ms", range = 1e-4..=1.0, start = 5e-3, source = "our choice")] pub slope_window: f64,
        #[var(start = DetectorKind::Glr, paper = DetectorKind::Slope, source = "measured: the least depth, on drawn machines too")] pub detector: DetectorKind,
        pub threshold: Threshold,
        pub learn: Learn,
        pub limits: Limits,
        pub kalman: Kalman,
        pub cusum: Cusum,
        pub glr: Glr,
        pub touch: Touch,
        pub approach: Approach,
        pub retract: Retract,
        pub commission: Commission,
        pub teach: Teach,
        /// Force change that stops the approach whatever the detector says; must exceed the cogging
        #[var(name = "guard.force", unit = NEWTON, range = 1e-3..=1e4, start = 0.4, source = "our choice: 1.3 um at 100 um/s")] pub guard_force: f64,
        pub contact: Contact,
    }
    /// Travel between first touch and detection, late but repeatable: bias + bias_fast (v / 100 um/s)^(5/7) + bias_slow / v at the
    /// approach speed v
    pub struct Contact {
        /// Part that is the same at every speed
        #[var(unit = METRE as "nm", range = -1e-3..=1e-3, source = "a teaching, or one calibration touch", tunable)] pub bias: f64,
        /// Part that grows with the speed, at 100 um/s
        #[var(unit = METRE as "nm", range = -1e-3..=1e-3, source = "a teaching", tunable)] pub bias_fast: f64,
        /// Part that grows as the speed falls, times it
        #[var(unit = SQUARE_METRE_PER_SECOND, range = -1e-6..=1e-6, source = "a teaching", tunable)] pub bias_slow: f64,
    }
    /// Nominal model of the stage and its drive
    pub struct Stage {
        /// Nominal moving mass M_n
        #[var(unit = KILOGRAM, range = 0.01..=1e4, start = 10.0, source = "our choice: small air-bearing stage")] pub mass: f64,
        /// Nominal thrust constant K_tn
        #[var(unit = NEWTON_PER_AMPERE, range = 0.01..=1e4, start = 20.0, source = "our choice: shaft motor")] pub force_constant: f64,
        /// Largest current
        #[var(unit = AMPERE, range = 0.01..=1e3, start = 5.0, source = "our choice")] pub current_max: f64,
        /// Resolution of the current command over +-`stage.current_max`, bit
        #[var(range = 8..=24, start = 16, source = "paper")] pub current_bits: i32,
        /// Step of the encoder; a reading that stays within one and a half of it stands
        #[var(unit = METRE as "nm", range = 0.0..=1e-3, start = 1e-9, source = "paper: 1 nm is usual")] pub encoder_resolution: f64,
        /// Bandwidth of the current loop, for the Kalman filter
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 100.0..=1e6, start = 6283.0, source = "our choice: 1 kHz")] pub current_bandwidth: f64,
    }
    /// Proportional-derivative position servo on top of the disturbance observer
    pub struct Servo {
        /// Natural frequency omega_n of the position servo
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 1.0..=2e3, start = 188.0, source = "our choice: 30 Hz, 40 degrees of phase left")] pub bandwidth: f64,
        /// Damping ratio zeta of the position servo
        #[var(unit = ONE, range = 0.1..=5.0, start = 1.0, source = "our choice")] pub damping: f64,
        /// Feed the estimated disturbance back (robust acceleration control); if not, integrate the error
        #[var(start = true, source = "our choice")] pub disturbance_compensation: bool,
        /// Integral gain K_i, used without disturbance compensation
        #[var(unit = PER_SECOND_CUBED, range = 0.0..=1e9, start = 2e6, source = "our choice")] pub integral_gain: f64,
    }
    /// Disturbance observer
    pub struct Observer {
        /// Cut-off g_dis of the disturbance observer
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=1e4, start = 628.0, source = "our choice: 100 Hz; depth is flat from 50 to 200 Hz")]
        pub bandwidth: f64,
        /// Cut-off g_v of the velocity estimate
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=5e4, start = 3142.0, source = "our choice: 500 Hz")] pub velocity_bandwidth: f64,
    }
    /// Threshold mu + alpha sigma of the raw, deviation and slope detectors
    pub struct Threshold {
        #[var(start = ThresholdMode::Automatic, paper = ThresholdMode::Fixed, source = "our choice: the paper's gives a false alarm a minute")]
        pub mode: ThresholdMode,
        /// Fixed alpha
        #[var(unit = ONE, range = 1.0..=50.0, start = 4.0, paper = 4.0, source = "paper")] pub alpha: f64,
        /// Wished mean time between false alarms, for the automatic alpha
        #[var(unit = SECOND, range = 1.0..=1e9, start = 36_000.0, source = "our choice")] pub false_alarm_interval: f64,
        /// Samples in a row above the threshold that make a detection
        #[var(range = 1..=100, start = 3, source = "paper")] pub row: i32,
    }
    /// Learning of the noise before contact
    pub struct Learn {
        /// Time at constant speed before learning
        #[var(unit = SECOND, range = 0.0..=100.0, start = 0.25, source = "our choice")] pub settle_time: f64,
        /// Time of learning
        #[var(unit = SECOND, range = 1e-3..=100.0, start = 0.5, source = "our choice: 0.1 s triples the false alarms of alpha 4")] pub time: f64,
    }
    /// Limits beyond which there is a fault
    pub struct Limits {
        /// Samples in a row for which an input that cannot be believed is bridged; one more is a fault
        #[var(range = 1..=100, start = 3, source = "our choice")] pub lost_samples: i32,
        /// Time with the current at its limit that is tolerated
        #[var(unit = SECOND as "ms", range = 0.0..=10.0, start = 5e-3, source = "our choice: ten times the 0.5 ms of the hardest acceleration")] pub saturated_time: f64,
        /// Largest plausible sigma of the learned slope
        #[var(unit = NEWTON_PER_SECOND, range = 1e-6..=1e6, start = 5.0, source = "our choice: five times the noise of a good stage")] pub slope_sigma_max: f64,
        /// Largest distance of a reading from where the observer expects it; a reading beyond counts as lost, one beyond half of it in part
        #[var(unit = METRE as "nm", range = 1e-12..=1e-3, start = 1e-8, source = "our choice: ten steps of 1 nm; eight sigma of noise and rounding")] pub jump: f64,
        /// Motion that a reading may leave unanswered before it counts as lost
        #[var(unit = METRE as "nm", range = 1e-12..=1e-3, start = 7.5e-9, source = "derived: five times the 1.5 nm within which a reading stands")] pub frozen: f64,
        /// Time at rest, and at least 300 samples, without any change of a reading that has noise; 0: not watched, for an encoder that hides its noise at rest
        #[var(unit = SECOND, range = 0.0..=100.0, start = 0.03, source = "our choice: 300 equal samples, of which noise of half a step makes every second differ")] pub rest_time: f64,
        /// Largest distance of the stage from its reference, besides the v (1 + io_delay) T_s that it is late; 0: three times what the hardest acceleration makes, at least 20 um
        #[var(unit = METRE as "um", range = 0.0..=1.0, start = 0.0, source = "derived: max(20 um, 3 * 2 zeta a / (omega_n g_v)), 7 um of it once at 2 m/s2")] pub following_error: f64,
        /// Largest disturbance that the machine can have; 0: half of the force of the drive, or `guard.force` and the force of the hardest acceleration
        #[var(unit = NEWTON, range = 0.0..=1e8, start = 0.0, source = "derived: max(K_tn I_max / 2, guard.force + M_n a)")] pub disturbance: f64,
        /// Least share of the commanded force that must accelerate the stage
        #[var(unit = ONE, range = 0.0..=1.0, start = 0.5, source = "our choice: nominal mass and thrust may be wrong by 30 % each")] pub drive_share: f64,
        /// Largest acceleration of the spindle; a speed that changes faster is not believed
        #[var(unit = RADIAN_PER_SECOND_SQUARED, range = 1.0..=1e9, start = 2e4, source = "our choice: 30 000 rpm in 0.16 s")] pub spindle_acceleration: f64,
        /// Longest learning, at least `learn.time`; 0: twice `learn.time` and the time that the filters need
        #[var(unit = SECOND, range = 0.0..=1e4, start = 0.0, source = "derived: 2 learn.time + settling")] pub learn_time: f64,
        /// Largest change of the force from before the contact to behind the retract
        #[var(unit = NEWTON, range = 1e-6..=1e6, start = 0.2, source = "our choice: half of `guard.force`, ten sigma of the weight balancer")] pub force_left: f64,
        /// Largest bias at a taught speed
        #[var(unit = METRE as "um", range = 1e-9..=1e-3, start = 1e-6, source = "our choice: twice that at 300 um/s on steel; more is soft work or a wrong place")] pub bias: f64,
        /// Largest standard deviation of the touches of one speed in a teaching
        #[var(unit = METRE as "nm", range = 1e-10..=1e-4, start = 6e-8, source = "our choice: two to three times that on steel")] pub touch_scatter: f64,
        /// Longest job from `enable` to `Done`; 0: what its ways and times need, and a quarter more
        #[var(unit = SECOND, range = 0.0..=1e9, start = 0.0, source = "derived: 1.25 (travel_max / v + v / a + settle_time + limits.learn_time + (travel_max + distance) / v_retract) + 1 s")] pub job_time: f64,
    }
    /// Kalman filter behind the detectors `Cusum` and `Glr`; all values are standard deviations
    pub struct Kalman {
        /// Random walk of the disturbance in one sample, standard deviation
        #[var(unit = NEWTON as "mN", range = 1e-9..=1e3, start = 5e-4, source = "our choice: the innovation of such stages is white")] pub disturbance_walk: f64,
        /// Random walk of each spindle harmonic in one sample, standard deviation
        #[var(unit = NEWTON as "mN", range = 1e-9..=1e3, start = 1e-4, source = "our choice: noise of such stages")] pub harmonic_walk: f64,
        /// White force in one sample, standard deviation
        #[var(unit = NEWTON as "mN", range = 1e-9..=1e3, start = 5e-3, source = "our choice: noise of such stages")] pub force_noise: f64,
        /// Position noise with quantisation, standard deviation
        #[var(unit = METRE as "nm", range = 1e-12..=1e-3, start = 0.6e-9, source = "our choice: noise of such stages")] pub position_noise: f64,
    }
    /// Cumulative sum of the normalised innovation; counts with `detector` = Cusum
    pub struct Cusum {
        /// Subtracted from the normalised innovation in each sample
        #[var(unit = ONE, range = 0.0..=5.0, start = 0.25, source = "our choice")] pub drift: f64,
        /// Alarm level of the cumulative sum
        #[var(unit = ONE, range = 1.0..=1e3, start = 22.0, source = "our choice: about one false alarm per hour")] pub threshold: f64,
    }
    /// Generalised likelihood ratio over a bank of contact instants; counts with `detector` = Glr
    pub struct Glr {
        /// Contact instants in the bank, one per sample
        #[var(range = 10..=1000, start = 300, source = "our choice")] pub onsets: i32,
        /// Alarm level of the log-likelihood ratio
        #[var(unit = ONE, range = 1.0..=1e3, start = 15.0, source = "measured: 2 false alarms in 10 hours")] pub threshold: f64,
    }
    /// Two-stage touch: what looks like a contact but is not sure of it is touched again; needs `detector` = Glr
    pub struct Touch {
        /// A suspected contact is touched again
        pub confirm: bool,
        /// Log-likelihood ratio of each touch from which on a contact is suspected
        #[var(unit = ONE, range = 1.0..=1e3, start = 7.0, source = "our choice: a suspicion in some seconds")] pub suspicion: f64,
        /// Log-likelihood ratio of both touches together that is a contact
        #[var(unit = ONE, range = 1.0..=1e3, start = 24.0, source = "our choice: a false alarm in hours")] pub evidence: f64,
        /// Time for which the first touch goes on to become sure
        #[var(unit = SECOND as "ms", range = 0.0..=1.0, start = 0.01, source = "our choice: memory of the filter")] pub dwell: f64,
        /// Time at constant speed before the second touch counts
        #[var(unit = SECOND as "ms", range = 0.0..=10.0, start = 0.05, source = "our choice: five times that memory")] pub settle_time: f64,
        /// Distance of both touches of one contact, beside the ways of their times
        #[var(unit = METRE as "nm", range = 0.0..=1e-3, start = 5e-7, source = "our choice: run-out and mark")] pub scatter: f64,
    }
    /// Approach motion
    pub struct Approach {
        /// Approach speed v; counts when an approach begins; no more than `taught.velocity_max`, where that was taught with `teach.force_max` and `teach.apply`; `reference.velocity` tells what is gone
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-7..=0.01, start = 1e-4, source = "our choice", tunable)] pub velocity: f64,
        /// Acceleration to the approach speed; counts when an approach begins
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 1e-4..=10.0, start = 0.05, source = "our choice", tunable)] pub acceleration: f64,
        /// Longest travel from the start position; counts when an approach begins
        #[var(unit = METRE as "mm", range = 1e-6..=1.0, start = 0.005, source = "our choice", tunable)] pub travel_max: f64,
        /// 1 if `position` counts up towards the workpiece, -1 if down
        #[var(range = -1..=1, start = 1, source = "our choice")] pub direction: i32,
        /// Least travel between touch and standstill, from delays and braking alone
        #[var(unit = METRE as "nm", calculated, source = "derived: v (1.5 + io_delay) T_s + v^2 / (2 a_stop)")] pub depth_limit: f64,
    }
    /// Retract motion
    pub struct Retract {
        /// Retract speed
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-6..=0.1, start = 1e-3, source = "our choice")] pub velocity: f64,
        /// Deceleration a_stop after a detection, and acceleration of the retract
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.01..=50.0, start = 2.0, source = "our choice: 1 A of this stage")] pub deceleration: f64,
        /// Distance of the retract, at least the way until the detector is armed; 0: 1.2 times that way
        #[var(unit = METRE as "um", range = 0.0..=0.1, start = 0.0, source = "derived: 1.2 (v^2 / (2 a) + v (settle_time + learn.time)), so that the next approach is armed before it touches")] pub distance: f64,
    }
    /// Bounds of the state `Commission`, and what becomes of its results
    pub struct Commission {
        /// Farthest way back from where it begins; 0: what learning the noise at the approach speed takes, and a fifth more, at least what the excitation needs
        #[var(unit = METRE as "um", range = 0.0..=0.1, start = 0.0, source = "derived: 1.2 (v^2 / a + v (settle_time + learn.time)), at least 45 um")] pub travel: f64,
        /// Largest force beside the one that holds the stage, at least `guard.force`; 0: that of the hardest braking, or half of the drive's
        #[var(unit = NEWTON, range = 0.0..=1e6, start = 0.0, source = "derived: min(M_n a_stop, K_tn I_max / 2), at least guard.force")] pub force: f64,
        /// Longest time; 0: what its motions take, a quarter more and 1 s
        #[var(unit = SECOND, range = 0.0..=1e6, start = 0.0, source = "derived: 1.25 times the motions + 1 s")] pub time: f64,
        /// Largest relative standard deviation of the thrust constant; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-6..=0.5, start = 0.02, source = "our choice: a hundredth of what the detector bears")] pub deviation_max: f64,
        /// Largest standard deviation of the delay, samples, beside what the current loop leaves to it; above it is `CommissionRejected`
        #[var(unit = ONE, range = 1e-3..=2.0, start = 0.25, source = "our choice: two of them to the next half sample")] pub delay_deviation_max: f64,
        /// Use what was measured in place of what was told
        #[var(source = "our choice: first look, then trust")] pub apply: bool,
        /// File that a good commission writes: JSON, the parameters that it derives; empty: none
        pub export: String,
    }
    /// Touches that teach the bias, and what becomes of it
    pub struct Teach {
        /// Slowest of the five speeds, which lie in equal ratios; `taught.velocity_min` is the slowest that is sure
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-7..=0.01, start = 1e-5, source = "our choice")] pub velocity_min: f64,
        /// Fastest of the five speeds, at least three times the slowest
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-7..=0.01, start = 3e-4, source = "our choice")] pub velocity_max: f64,
        /// Largest force of a touch that is wanted, on a stage up to 30 % heavier than told: where the first round tells that faster touches press harder, they are made slower, and with `teach.apply` the approaches behind the teaching; commission first; 0: no limit
        #[var(unit = NEWTON, range = 0.0..=1e4, start = 0.0, source = "our choice: none; what the tool bears")] pub force_max: f64,
        /// Touches at each speed
        #[var(range = 2..=1000, start = 4, source = "our choice: half of the scatter of one touch")] pub touches: i32,
        /// Touches at each speed at most, where so many as `teach.touches` do not make the bias sure; no fewer than those
        #[var(range = 2..=1000, start = 8, source = "our choice: a minute in all")] pub touches_max: i32,
        /// Encoder position at which the tool first touches the work
        #[var(unit = METRE as "um", range = -1e3..=1e3, source = "measured otherwise: no touch tells its own bias")] pub place: f64,
        /// Its standard deviation
        #[var(unit = METRE as "nm", range = 0.0..=1e-3, source = "that of how it was measured")] pub place_deviation: f64,
        /// Largest standard deviation of the bias at a taught speed; above it more touches are made, then the slowest speed is left out, else it is `TeachingRejected`
        #[var(unit = METRE as "nm", range = 1e-10..=1e-3, start = 3e-8, source = "our choice: about the scatter of one touch")] pub deviation_max: f64,
        /// Use what was taught in place of what was told
        #[var(source = "our choice: first look, then trust")] pub apply: bool,
        /// File that a good teaching writes: JSON, the parameters of the bias and `teach.velocity_max`; empty: none
        pub export: String,
    }
}

//! Every variable of the FMU, told once; the tables of the README come from here.
//!
//! Sources: "paper" = Kakinuma and Nagakari (2017), "derived" = follows from the equations, "our choice" = usual
//! practice, with the reason where there is one.
pub use variables::*;

#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use control_blocks::DELAY_MAX;
    use fmi2_export::{Unit, units::*};

    /// Most spindle harmonics that filters can hold.
    pub const HARMONICS_MAX: usize = 4;
    /// Unit of the integral gain.
    const PER_SECOND_CUBED: Unit = Unit::si("1/s3", [0, 0, -3, 0, 0], &[]);

    /// What the controller is doing
    pub enum State {
        /// Holds its position and waits for a rising edge of `enable`
        Idle,
        /// Accelerates and settles at constant speed
        Approach,
        /// Learns the noise at constant speed
        Learn,
        /// Watches for contact
        Detect,
        /// Has detected contact and decelerates
        Contact,
        /// Moves back
        Retract,
        /// Holds its position after the retract; a rising edge of `enable` begins again
        Done,
        /// Decelerates, moves back if it was approaching, then holds; a rising edge of `reset_fault` ends it at rest
        Fault,
    }
    /// Why the controller is in the fault state
    pub enum Fault {
        /// No fault
        None,
        /// No contact within `approach.travel_max`
        #[hint("start closer to the workpiece, or allow more travel")] TravelLimit,
        /// `position_valid` was false for too many samples in a row
        #[hint("check the encoder and its link")] LostSync,
        /// The current was at its limit for too many samples in a row
        #[hint("check that the stage moves freely, or lower `approach.acceleration` and `retract.deceleration`")] Saturation,
        /// The learned slope is too noisy, not around zero, or silent
        #[hint("check that `spindle_speed` is connected, settle longer, or raise `limits.slope_sigma_max`")] LearnRejected,
        /// `position` or `spindle_speed` is NaN, infinite or out of any plausible range
        #[hint("check what is connected to these inputs, and its unit")] InvalidInput,
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
        /// Slopes over four windows with automatic thresholds
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
        /// Slope over 20, 50, 100 and 200 samples side by side
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
        /// Rising edge begins an approach from `Idle` or `Done`; false ends one: decelerate, retract, `Done`
        pub enable: bool,
        /// Rising edge ends a fault once the stage is at rest behind its retreat
        pub reset_fault: bool,
    }
    /// Outputs; always finite
    #[outputs] pub struct Output {
        /// Quantised current command I_a^ref
        #[var(unit = AMPERE)] pub current: f64,
        pub state: State,
        pub fault: Fault,
        /// The approach was ended by `enable`; kept until the next approach
        pub aborted: bool,
        /// Contact was detected; kept until the next approach
        pub contact: bool,
        pub contact_source: ContactSource,
        /// Encoder position at the detection, as in the paper
        #[var(unit = METRE as "um")] pub contact_position: f64,
        /// Position of the first touch: `contact_position` less `contact.bias` in the direction of approach
        #[var(unit = METRE as "um")] pub contact_position_estimate: f64,
        /// Time of the detection since the initialisation
        #[var(unit = SECOND)] pub contact_time: f64,
        pub force: ForceOutput,
        pub threshold: ThresholdOutput,
        pub reference: ReferenceOutput,
        /// Reference less position; 0 while the position is lost
        #[var(unit = METRE as "nm")] pub tracking_error: f64,
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
        /// Samples r of the moving average, eq. 2
        #[var(name = "deviation.window", range = 10..=100_000, start = 1000, source = "our choice: depth is flat from 200 to 5000")] pub deviation_window: i32,
        /// Samples N of the least-squares slope, eq. 3
        #[var(name = "slope.window", range = 3..=1000, start = 50, source = "our choice")] pub slope_window: i32,
        #[var(start = DetectorKind::MultiSlope, paper = DetectorKind::Slope, source = "our choice: sees slow contacts, too")] pub detector: DetectorKind,
        pub threshold: Threshold,
        pub learn: Learn,
        pub limits: Limits,
        pub kalman: Kalman,
        pub cusum: Cusum,
        pub glr: Glr,
        pub approach: Approach,
        pub retract: Retract,
        /// Force change that stops the approach whatever the detector says; must exceed the cogging
        #[var(name = "guard.force", unit = NEWTON, range = 1e-3..=1e4, start = 0.4, source = "our choice: 1.3 um at 100 um/s")] pub guard_force: f64,
        /// Travel between first touch and detection; late but repeatable
        #[var(name = "contact.bias", unit = METRE as "nm", range = -1e-3..=1e-3, source = "one calibration touch", tunable)] pub contact_bias: f64,
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
        /// Samples in a row without a valid position that are bridged
        #[var(range = 0..=100, start = 3, source = "our choice")] pub lost_samples: i32,
        /// Samples in a row with the current at its limit that are tolerated
        #[var(range = 0..=100_000, start = 50, source = "our choice")] pub saturated_samples: i32,
        /// Largest plausible sigma of the learned slope
        #[var(unit = NEWTON_PER_SECOND, range = 1e-6..=1e6, start = 5.0, source = "our choice: five times the noise of a good stage")] pub slope_sigma_max: f64,
    }
    /// Kalman filter behind the detectors `Cusum` and `Glr`; all values are standard deviations
    pub struct Kalman {
        /// Random walk of the disturbance in one sample, standard deviation
        #[var(unit = NEWTON as "mN", range = 1e-9..=1e3, start = 7e-4, source = "our choice: noise of such stages")] pub disturbance_walk: f64,
        /// Random walk of each spindle harmonic in one sample, standard deviation
        #[var(unit = NEWTON as "mN", range = 1e-9..=1e3, start = 1e-4, source = "our choice: noise of such stages")] pub harmonic_walk: f64,
        /// White force in one sample, standard deviation
        #[var(unit = NEWTON as "mN", range = 1e-9..=1e3, start = 5e-3, source = "our choice: noise of such stages")] pub force_noise: f64,
        /// Position noise with quantisation, standard deviation
        #[var(unit = METRE as "nm", range = 1e-12..=1e-3, start = 0.6e-9, source = "our choice: noise of such stages")] pub position_noise: f64,
    }
    /// Cumulative sum of the normalised innovation
    pub struct Cusum {
        /// Subtracted from the normalised innovation in each sample
        #[var(unit = ONE, range = 0.0..=5.0, start = 0.25, source = "our choice")] pub drift: f64,
        /// Alarm level of the cumulative sum
        #[var(unit = ONE, range = 1.0..=1e3, start = 16.0, source = "our choice: about one false alarm per hour")] pub threshold: f64,
    }
    /// Generalised likelihood ratio over a bank of contact instants
    pub struct Glr {
        /// Contact instants in the bank, one per sample
        #[var(range = 10..=1000, start = 300, source = "our choice")] pub onsets: i32,
        /// Alarm level of the log-likelihood ratio
        #[var(unit = ONE, range = 1.0..=1e3, start = 15.0, source = "our choice: at most one false alarm per hour")] pub threshold: f64,
    }
    /// Approach motion
    pub struct Approach {
        /// Approach speed v; counts when an approach begins
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
        /// Distance of the retract
        #[var(unit = METRE as "um", range = 1e-7..=0.1, start = 2e-5, source = "our choice")] pub distance: f64,
    }
}

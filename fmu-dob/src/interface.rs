//! Every variable of the FMU, declared once; the tables of the pages are generated from here.
//!
//! Sources: "paper" = Kakinuma and Nagakari (2017), "derived" = follows from the equations, "default" = usual practice,
//! with its reason.
pub use variables::*;

#[rustfmt::skip]
#[fmi2_export::interface]
mod variables {
    use control_blocks::{DELAY_MAX, Reaction};
    use crate::monitoring::numbers::Numbers;
    use fmi2_export::{Unit, units::*};

    /// Maximum number of spindle harmonics that the filters hold.
    pub const HARMONICS_MAX: usize = 4;
    /// Unit of the integral gain.
    const PER_SECOND_CUBED: Unit = Unit::si("1/s3", [0, 0, -3, 0, 0], &[]);
    /// Unit of the viscous friction.
    const NEWTON_SECOND_PER_METRE: Unit = Unit::si("N.s/m", [1, 0, -1, 0, 0], &[]);
    /// Unit of a length that grows as the speed falls.
    const SQUARE_METRE_PER_SECOND: Unit = Unit::si("m2/s", [0, 2, -1, 0, 0], &[]);

    /// State of the controller
    pub enum State {
        /// Holds the position and waits for a rising edge of an input
        Idle,
        /// Measures the force at rest, accelerates and settles at constant speed
        Approach,
        /// Learns the noise at constant speed
        Learn,
        /// Tests every sample for contact at constant speed
        Detect,
        /// Contact detected: decelerates
        Contact,
        /// Retracts, comes to rest and checks that the contact force is gone
        Retract,
        /// Holds the position after the retract and waits for the next rising edge
        Done,
        /// Performs the reaction of the fault and waits for a rising edge of reset_fault
        Fault,
        /// Commissioning run: measures the machine with small motions away from the workpiece
        Commission,
        /// Retracts a little and touches a second time after a suspected contact
        Confirm,
        /// Is at rest between two touches of a calibration cycle
        Calibrate,
    }
    /// Why the controller is in the fault state
    #[reactions(Reaction,
        Retract = ["Stops along the planned motion, retracts if it was approaching, and holds the position", "Rising edge of `reset_fault` at rest after the retract"],
        Stop = ["Holds the position; the tool is already retracted or was never near the workpiece", "Rising edge of `reset_fault` at rest"],
        DriveOff = ["Sets `current` to zero and `drive_enable` to false; nothing moves by command", "Rising edge of `reset_fault` once `position` is valid and has been tracked"])]
    pub enum Fault {
        /// No fault
        None,
        /// No contact within the maximum travel
        #[reaction(Retract)] #[detection("An immediate stop would end beyond `approach.travel_max`; the stop lies inside the limit")]
        #[hint("Start closer to the workpiece, or increase `approach.travel_max`.")] TravelLimit,
        /// The position signal is invalid, NaN, infinite or out of range
        #[reaction(DriveOff)] #[detection("`position_valid` is false, or `position` is NaN, infinite or beyond 1 km, for more than `limits.lost_samples` consecutive samples; fewer are bridged by the nominal model")]
        #[hint("Check the encoder, its cable and its link.")] PositionLost,
        /// The position does not change although the stage must have moved
        #[reaction(DriveOff)] #[detection("Moving: more than `limits.frozen` of motion without a change, for more than `limits.lost_samples`. At rest: no change for `expert.limits.rest_time` and 300 samples, if the encoder had shown noise")]
        #[hint("Check the encoder and the unit of `position`. Compare the delay with `io_delay`. Encoder without noise: set `expert.limits.rest_time` = 0.")] PositionFrozen,
        /// The position is where the stage cannot be
        #[reaction(DriveOff)] #[detection("`position` is farther than `limits.jump` from the prediction of the observer for more than `limits.lost_samples`. Before the velocity is known: second differences beyond any possible force")]
        #[hint("Check the encoder and the unit of `position`. Compare its noise with `limits.jump` and the delay with `io_delay`.")] PositionJump,
        /// The spindle speed changes faster than a spindle can
        #[reaction(Retract)] #[detection("`spindle_speed` changes faster than `expert.limits.spindle_acceleration` for more than `limits.lost_samples` consecutive samples of an approach")]
        #[hint("Check the spindle-speed signal, or increase `expert.limits.spindle_acceleration`.")] SpindleJump,
        /// The stage is too far from its reference
        #[reaction(DriveOff)] #[detection("The distance exceeds `expert.limits.following_error`, or the error of the hardest acceleration, in 3 consecutive samples")]
        #[hint("Check that the stage moves freely. Check `stage.mass`, `stage.force_constant` and `io_delay`.")] FollowingError,
        /// The current was at its limit for too long
        #[reaction(DriveOff)] #[detection("The current is at `stage.current_max` for longer than `expert.limits.saturated_time`")]
        #[hint("Check that the stage moves freely, or reduce `approach.acceleration` and `retract.deceleration`.")] Saturation,
        /// The estimated disturbance is larger than this machine can produce
        #[reaction(DriveOff)] #[detection("The disturbance estimate exceeds `expert.limits.disturbance` in 3 consecutive samples; in `Commission` also `commission.force` plus `guard.force`")]
        #[hint("Check that nothing blocks the stage. Check `stage.mass` and `stage.force_constant`.")] Overload,
        /// The stage moves against the current
        #[reaction(DriveOff)] #[detection("A drive fault or `PositionJump` is detected while `drive_gain_ratio` is below -0.2")]
        #[hint("Check the signs of `current`, `position` and `approach.direction`. If it worked before, check the links for added delay.")] DriveSign,
        /// The stage moves much less than the current should move it
        #[reaction(DriveOff)] #[detection("`drive_gain_ratio` is below `limits.drive_gain_ratio` after a drive fault, after the acceleration of an approach (from about 60 um/s on) or after the retract")]
        #[hint("Check the amplifier, its cable and its limit. Check that the stage moves freely. Check `stage.force_constant`.")] WeakDrive,
        /// The control loop oscillates
        #[reaction(DriveOff)] #[detection("Six consecutive reversals, each within 50 ms: current from limit to limit, or inertial force beyond `guard.force` in both directions while the reference does not accelerate")]
        #[hint("Compare `io_delay` with the delay of drive and encoder, or reduce `servo.bandwidth` or `observer.bandwidth`.")] Oscillation,
        /// The learned slope is too noisy, has an offset or is zero
        #[reaction(Retract)] #[detection("Sigma of the slope is above `limits.slope_sigma_max` or zero, or its mean is above sigma / 2")]
        #[hint("Check that `spindle_speed` is connected. Increase `learn.settle_time` or `limits.slope_sigma_max`.")] LearnRejected,
        /// Learning did not end in time
        #[reaction(Retract)] #[detection("Learning takes longer than `expert.limits.learn_time`")]
        #[hint("Check that the spindle speed is constant, or increase `expert.limits.learn_time`.")] LearnTimeout,
        /// The force of the contact did not disappear with the retract
        #[reaction(Stop)] #[detection("After the retract the force differs by more than `limits.residual_force` from the force before the contact")]
        #[hint("Look for a force that changed (cable, cogging, drift), or increase `limits.residual_force`.")] ContactRejected,
        /// The cycle or the commissioning run takes too long
        #[reaction(Retract)] #[detection("The cycle takes longer than `limits.cycle_time`, or the commissioning run longer than `expert.commission.time`; no change of state restarts the time")]
        #[hint("Find the cause of the delay, or increase `limits.cycle_time`.")] NoProgress,
        /// The spindle speed is NaN, infinite or out of range
        #[reaction(Retract)] #[detection("`spindle_speed` is NaN, infinite or beyond 1e5 rad/s for more than `limits.lost_samples` consecutive samples; until then the last valid value is used")]
        #[hint("Check the connection and the unit of `spindle_speed`.")] SpindleLost,
        /// The communication step is longer than the sample period
        #[reaction(DriveOff)] #[detection("A communication step is longer than `sample_period`: several samples have the same inputs, and only the last of their commands acts")]
        #[hint("Co-simulation: set the communication step to `sample_period`. Model exchange: stop at every time event.")] LongStep,
        /// The force guard found the contact because the detector was not armed or missed it
        #[reaction(Stop)] #[detection("The force guard stopped the approach (state `Contact`, then `Retract`) and the detector had not; penetration exceeded the limit of the detector")]
        #[hint("Start farther from the workpiece, or change `detector` or `approach.velocity`. Check for vibration and for jumps of `position`.")] LateContact,
        /// A result of the commissioning run is too uncertain or out of range
        #[reaction(Stop)] #[detection("A standard deviation exceeds `expert.commission.std_max` or `expert.commission.delay_std_max`, a value is outside its limits, or the derived parameters do not fit the others")]
        #[hint("Increase `commission.travel` or `commission.force`. Check for vibration and friction. Check `stage.*` and `io_delay`.")] CommissionRejected,
        /// A result of the calibration cycle is too uncertain or out of range
        #[reaction(Stop)] #[detection("Scatter above `expert.limits.touch_scatter`; bias negative, above `expert.limits.bias` or with more than `expert.calibration.std_max`; `approach.travel_max` too short; or `calibration.force_max` allows too few speeds")]
        #[hint("Check `calibration.position`, stiffness of the workpiece and vibration. Increase `approach.travel_max`, or `calibration.force_max` on a hard workpiece.")] CalibrationRejected,
        /// The position repeats values from earlier samples
        #[reaction(DriveOff)] #[detection("As `PositionJump`, and the values are identical to those of 3 to 31 samples before")]
        #[hint("Check the encoder link and its filters for added delay.")] PositionDelayed,
    }
    /// What detected the contact
    pub enum ContactSource {
        /// No contact
        None,
        /// Slope of the force over one window
        Slope,
        /// Generalized likelihood ratio of the Kalman innovation
        Glr,
        /// Force guard
        ForceGuard,
    }
    /// Active control law; Paper sets unset parameters to the published values
    pub enum Law {
        /// Likelihood ratio of a contact at each of several hundred instants
        Default,
        /// As published: slope over one window, threshold mu + 4 sigma
        Paper,
    }
    /// Detector that decides about contact
    pub enum DetectorKind {
        /// Slope of the force over one window, eq. 3, as published
        Slope,
        /// Generalized likelihood ratio of the Kalman innovation
        Glr,
    }
    /// Source of alpha in the threshold mu + alpha sigma
    pub enum ThresholdMode {
        /// Fixed alpha, as published
        Fixed,
        /// Alpha from the configured time between false alarms and the learned crossing rate
        Automatic,
    }
    /// Inputs, sampled at the start of a communication step
    #[inputs] pub struct Input {
        /// Encoder position z
        #[var(unit = METRE as "um", accepts_nan)] pub position: f64,
        /// True while the encoder and its link are good
        #[var(start = true)] pub position_valid: bool,
        /// Spindle speed; 0 switches the notch filters off
        #[var(unit = RADIAN_PER_SECOND as "rpm", accepts_nan)] pub spindle_speed: f64,
        /// Rising edge in Idle or Done starts an approach; false aborts it and retracts
        pub enable: bool,
        /// Rising edge in Idle or Done starts the commissioning run; false aborts it
        pub commission: bool,
        /// Rising edge in Idle or Done starts a calibration cycle; false aborts it
        pub calibrate: bool,
        /// Rising edge acknowledges a fault
        pub reset_fault: bool,
    }
    /// Outputs; always finite
    #[outputs] pub struct Output {
        /// Current command to the amplifier, quantized
        #[var(unit = AMPERE)] pub current: f64,
        pub state: State,
        pub fault: Fault,
        /// Enable of the drive; false after a fault with reaction DriveOff until it is reset
        #[var(start = true)] pub drive_enable: bool,
        /// The last approach was aborted; kept until the next approach
        pub aborted: bool,
        /// Contact was detected; kept until the next approach, cleared by a fault before Done
        pub contact: bool,
        pub contact_source: ContactSource,
        /// Encoder position at the detection, as in the paper
        #[var(unit = METRE as "um")] pub contact_position: f64,
        /// Estimated position of the first touch: contact_position without the bias
        #[var(unit = METRE as "um")] pub contact_position_estimate: f64,
        /// Standard deviation of contact_position_estimate; 0 without an applied calibration
        #[var(unit = METRE as "nm")] pub contact_position_std: f64,
        /// Time of the detection since initialization
        #[var(local, unit = SECOND)] pub contact_time: f64,
        #[var(local)] pub force: ForceOutput,
        #[var(local)] pub threshold: ThresholdOutput,
        #[var(local)] pub reference: ReferenceOutput,
        /// Reference minus position; 0 while the position is lost, frozen after DriveOff
        #[var(local, unit = METRE as "nm")] pub tracking_error: f64,
        /// Ratio of measured to commanded acceleration of the stage; 1 until it is known
        #[var(local, unit = ONE, start = 1.0)] pub drive_gain_ratio: f64,
        /// Details of a fault for the log.
        #[var(hidden, start = Numbers::START)] pub numbers: Numbers,
        pub measured: Measured,
        pub calibrated: Calibrated,
    }
    /// Results of the commissioning run, each with its standard deviation; 0 before it
    pub struct Measured {
        /// The last commissioning run succeeded; false from the start of the next one
        pub valid: bool,
        /// Measured thrust constant of a stage of mass stage.mass
        #[var(local, unit = NEWTON_PER_AMPERE)] pub force_constant: f64,
        /// Standard deviation of the measured thrust constant, with 1 % of thrust ripple
        #[var(local, unit = NEWTON_PER_AMPERE)] pub force_constant_std: f64,
        /// Measured samples between a command and its action, without the current loop
        #[var(local, unit = ONE)] pub io_delay: f64,
        /// Standard deviation of the measured delay, for a current loop known to 30 %
        #[var(local, unit = ONE)] pub io_delay_std: f64,
        /// Measured viscous friction of a stage of mass stage.mass
        #[var(local, unit = NEWTON_SECOND_PER_METRE)] pub damping: f64,
        /// Standard deviation of the measured viscous friction
        #[var(local, unit = NEWTON_SECOND_PER_METRE)] pub damping_std: f64,
        /// Measured change of the force with the position: cogging, cables and hoses
        #[var(local, unit = NEWTON_PER_METRE)] pub stiffness: f64,
        /// Standard deviation of the measured stiffness
        #[var(local, unit = NEWTON_PER_METRE)] pub stiffness_std: f64,
        /// Measured noise of the position in motion, with quantization
        #[var(local, unit = METRE as "nm")] pub position_noise: f64,
        /// Standard deviation of the measured position noise
        #[var(local, unit = METRE as "nm")] pub position_noise_std: f64,
        /// Measured white part of the notch-filtered force in one sample
        #[var(local, unit = NEWTON as "mN")] pub force_noise: f64,
        /// Standard deviation of the measured white force
        #[var(local, unit = NEWTON as "mN")] pub force_noise_std: f64,
        /// Measured random walk of the notch-filtered force in one sample
        #[var(local, unit = NEWTON as "mN")] pub disturbance_walk: f64,
        /// Standard deviation of the measured random walk
        #[var(local, unit = NEWTON as "mN")] pub disturbance_walk_std: f64,
        /// Measured sigma of the notch-filtered force over all strokes
        #[var(local, unit = NEWTON as "mN")] pub force_sigma: f64,
        /// Standard deviation of the measured sigma of the force
        #[var(local, unit = NEWTON as "mN")] pub force_sigma_std: f64,
        /// Measured sigma of the force slope at the approach speed
        #[var(local, unit = NEWTON_PER_SECOND)] pub slope_sigma: f64,
        /// Standard deviation of the measured sigma of the slope
        #[var(local, unit = NEWTON_PER_SECOND)] pub slope_sigma_std: f64,
    }
    /// Results of the calibration cycle, each with its standard deviation; 0 before it
    pub struct Calibrated {
        /// The last calibration cycle succeeded; false from the start of the next one
        pub valid: bool,
        /// Number of touches of the last calibration cycle
        #[var(local)] pub touches: i32,
        /// Slowest speed at which the bias is within the allowed standard deviation
        #[var(local, unit = METRE_PER_SECOND as "um/s")] pub velocity_min: f64,
        /// Fastest calibrated speed; lower than requested where the force limit requires it
        #[var(local, unit = METRE_PER_SECOND as "um/s")] pub velocity_max: f64,
        /// Calibrated part of the bias that is the same at every speed
        #[var(local, unit = METRE as "nm")] pub bias: f64,
        /// Standard deviation of the constant part of the bias, with that of the reference
        #[var(local, unit = METRE as "nm")] pub bias_std: f64,
        /// Calibrated part of the bias that grows with the speed, at 100 um/s
        #[var(local, unit = METRE as "nm")] pub bias_fast: f64,
        /// Standard deviation of the part of the bias that grows with the speed
        #[var(local, unit = METRE as "nm")] pub bias_fast_std: f64,
        /// Calibrated part of the bias that grows as the speed falls, times the speed
        #[var(local, unit = SQUARE_METRE_PER_SECOND)] pub bias_slow: f64,
        /// Standard deviation of the part of the bias that grows as the speed falls
        #[var(local, unit = SQUARE_METRE_PER_SECOND)] pub bias_slow_std: f64,
        /// Largest standard deviation of the bias from calibrated.velocity_min on
        #[var(local, unit = METRE as "nm")] pub std: f64,
        /// Standard deviation of single touches at one speed, from calibrated.velocity_min on
        #[var(local, unit = METRE as "nm")] pub scatter: f64,
        /// Standard deviation of the scatter of single touches
        #[var(local, unit = METRE as "nm")] pub scatter_std: f64,
    }
    /// Chain of force estimates; positive when the workpiece pushes back
    pub struct ForceOutput {
        /// Estimated disturbance force, eq. 1; positive when the workpiece pushes back
        #[var(unit = NEWTON as "mN")] pub disturbance: f64,
        /// Disturbance force without spindle harmonics
        #[var(unit = NEWTON as "mN")] pub notched: f64,
        /// Deviation of the force from its moving average, eq. 2
        #[var(unit = NEWTON as "mN")] pub deviation: f64,
        /// Slope of the force deviation over one window, eq. 3
        #[var(unit = NEWTON_PER_SECOND)] pub slope: f64,
    }
    /// Learned statistics and threshold of the slope
    pub struct ThresholdOutput {
        /// Learned mean mu of the slope
        #[var(unit = NEWTON_PER_SECOND)] pub mean: f64,
        /// Learned standard deviation sigma of the slope
        #[var(unit = NEWTON_PER_SECOND)] pub sigma: f64,
        /// Threshold mu + alpha sigma of the slope
        #[var(unit = NEWTON_PER_SECOND)] pub value: f64,
        /// Alpha of the active threshold
        #[var(unit = ONE)] pub alpha_used: f64,
        /// Learned rate at which the slope crosses its mean upwards
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
        /// Sample period
        #[var(essential, unit = SECOND as "us", range = 2e-5..=1e-3, start = 1e-4, source = "default; a usual amplifier rate")]
        pub sample_period: f64,
        /// Samples between a command and its action; 1 with a standard master
        #[var(essential, range = 0..=DELAY_MAX as i32, start = 1, source = "default; a standard master")]
        pub io_delay: i32,
        pub stage: Stage,
        pub servo: Servo,
        pub observer: Observer,
        /// Number of spindle harmonics that the notch filters remove
        #[var(expert, name = "notch.harmonics", range = 0..=HARMONICS_MAX as i32, start = 2, source = "default; unbalance and two flutes")]
        pub notch_harmonics: i32,
        /// Time of the moving average, r samples in eq. 2
        #[var(expert, name = "deviation.window", unit = SECOND as "ms", range = 1e-3..=10.0, start = 0.1, source = "default; the depth is flat from 20 to 500 ms")]
        pub deviation_window: f64,
        /// Time of the least-squares slope, N samples in eq. 3
        #[var(expert, name = "slope.window", unit = SECOND as "ms", range = 1e-4..=1.0, start = 5e-3, source = "default; 50 samples")]
        pub slope_window: f64,
        #[var(start = DetectorKind::Glr, paper = DetectorKind::Slope, source = "measured: fewest false alarms, smallest depth from 100 um/s on")]
        pub detector: DetectorKind,
        #[var(expert)] pub threshold: Threshold,
        pub learn: Learn,
        pub limits: Limits,
        #[var(expert)] pub kalman: Kalman,
        #[var(expert)] pub glr: Glr,
        pub touch: Touch,
        pub approach: Approach,
        pub retract: Retract,
        pub commission: Commission,
        pub calibration: Calibration,
        /// Force change that stops the approach in every state; must exceed the cogging
        #[var(essential, name = "guard.force", unit = NEWTON, range = 1e-3..=1e4, start = 0.4, source = "default; 1.3 um at 100 um/s")]
        pub guard_force: f64,
        pub contact: Contact,
    }
    /// Travel between first touch and detection as a function of the approach speed
    pub struct Contact {
        /// Part of the contact bias that is the same at every speed
        #[var(unit = METRE as "nm", range = -1e-3..=1e-3, source = "a calibration cycle, or one calibration touch", tunable)]
        pub bias: f64,
        /// Part of the contact bias that grows with the speed, at 100 um/s
        #[var(unit = METRE as "nm", range = -1e-3..=1e-3, source = "a calibration cycle", tunable)] pub bias_fast: f64,
        /// Part of the contact bias that grows as the speed falls, times the speed
        #[var(unit = SQUARE_METRE_PER_SECOND, range = -1e-6..=1e-6, source = "a calibration cycle", tunable)]
        pub bias_slow: f64,
    }
    /// Nominal model of the stage and its drive
    pub struct Stage {
        /// Nominal moving mass
        #[var(essential, unit = KILOGRAM, range = 0.01..=1e4, start = 10.0, source = "default; small air-bearing stage")]
        pub mass: f64,
        /// Nominal thrust constant of the motor
        #[var(essential, unit = NEWTON_PER_AMPERE, range = 0.01..=1e4, start = 20.0, source = "default; shaft motor")]
        pub force_constant: f64,
        /// Maximum current of the amplifier
        #[var(essential, unit = AMPERE, range = 0.01..=1e3, start = 5.0, source = "default; small linear amplifier")]
        pub current_max: f64,
        /// Resolution of the current command from minus to plus the maximum, in bits
        #[var(range = 8..=24, start = 16, source = "paper")] pub current_bits: i32,
        /// Step of the encoder signal, with interpolation
        #[var(essential, unit = METRE as "nm", range = 0.0..=1e-3, start = 1e-9, source = "paper: 1 nm is usual")]
        pub encoder_resolution: f64,
        /// Bandwidth of the current loop
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 100.0..=1e6, start = 6283.0, source = "default; 1 kHz")]
        pub current_bandwidth: f64,
    }
    /// Proportional-derivative position servo on top of the disturbance observer
    pub struct Servo {
        /// Natural frequency of the position servo
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 1.0..=2e3, start = 188.0, source = "default; 30 Hz, 40 degrees of phase margin remain")]
        pub bandwidth: f64,
        /// Damping ratio of the position servo
        #[var(expert, unit = ONE, range = 0.1..=5.0, start = 1.0, source = "default; no overshoot")] pub damping: f64,
        /// Feed the estimated disturbance back; if false, integrate the position error
        #[var(expert, start = true, source = "default; robust acceleration control")]
        pub disturbance_compensation: bool,
        /// Integral gain without disturbance compensation
        #[var(expert, unit = PER_SECOND_CUBED, range = 0.0..=1e9, start = 2e6, source = "default; a third of the cube of the bandwidth")]
        pub integral_gain: f64,
    }
    /// Disturbance observer
    pub struct Observer {
        /// Bandwidth of the disturbance observer
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=1e4, start = 628.0, source = "default; 100 Hz, the depth is flat from 50 to 200 Hz")]
        pub bandwidth: f64,
        /// Bandwidth of the velocity estimate
        #[var(expert, unit = RADIAN_PER_SECOND as "Hz", range = 10.0..=5e4, start = 3142.0, source = "default; 500 Hz")]
        pub velocity_bandwidth: f64,
    }
    /// Threshold mu + alpha sigma of the slope detector
    pub struct Threshold {
        #[var(start = ThresholdMode::Automatic, paper = ThresholdMode::Fixed, source = "default; the published threshold gives about 100 false alarms an hour")]
        pub mode: ThresholdMode,
        /// Fixed alpha of the threshold
        #[var(unit = ONE, range = 1.0..=50.0, start = 4.0, paper = 4.0, source = "paper")] pub alpha: f64,
        /// Target mean time between false alarms for the automatic alpha
        #[var(unit = SECOND, range = 1.0..=1e9, start = 36_000.0, source = "default; ten hours")]
        pub false_alarm_interval: f64,
    }
    /// Learning of the noise before contact
    pub struct Learn {
        /// Time at constant speed before learning starts
        #[var(unit = SECOND, range = 0.0..=100.0, start = 0.25, source = "default; the filters have settled")]
        pub settle_time: f64,
        /// Time of learning
        #[var(unit = SECOND, range = 1e-3..=100.0, start = 0.5, source = "default; 0.1 s triples the false alarms of alpha 4")]
        pub time: f64,
    }
    /// Limits beyond which a fault is raised
    pub struct Limits {
        /// Maximum number of consecutive implausible samples that are bridged
        #[var(range = 1..=100, start = 3, source = "default; 0.3 ms")] pub lost_samples: i32,
        /// Tolerated time with the current at its limit
        #[var(expert, unit = SECOND as "ms", range = 0.0..=10.0, start = 5e-3, source = "default; ten times the 0.5 ms of the hardest acceleration")]
        pub saturated_time: f64,
        /// Maximum plausible sigma of the learned slope
        #[var(unit = NEWTON_PER_SECOND, range = 1e-6..=1e6, start = 5.0, source = "default; five times the noise of a good stage")]
        pub slope_sigma_max: f64,
        /// Maximum distance of the position from its prediction; beyond half it is only partly used
        #[var(unit = METRE as "nm", range = 1e-12..=1e-3, start = 1e-8, source = "default; ten steps of 1 nm, eight sigma of noise and rounding")]
        pub jump: f64,
        /// Motion without a change of the position beyond which a sample is lost
        #[var(unit = METRE as "nm", range = 1e-12..=1e-3, start = 7.5e-9, source = "derived: five times the 1.5 nm that are no change")]
        pub frozen: f64,
        /// Tolerated time at rest without any change of the position; 0 switches the check off
        #[var(expert, unit = SECOND, range = 0.0..=100.0, start = 0.03, source = "default; 300 equal samples, while noise of half a step changes every second one")]
        pub rest_time: f64,
        /// Maximum distance of the stage from its reference; 0: automatic, at least 20 um
        #[var(expert, unit = METRE as "um", range = 0.0..=1.0, start = 0.0, source = "derived: max(20 um, 3 * 2 zeta a / (omega_n g_v)), plus the lag v (1 + io_delay) T_s")]
        pub following_error: f64,
        /// Maximum disturbance that the machine can produce; 0: automatic
        #[var(expert, unit = NEWTON, range = 0.0..=1e8, start = 0.0, source = "derived: max(K_tn I_max / 2, guard.force + M_n a)")]
        pub disturbance: f64,
        /// Minimum ratio of measured to commanded acceleration of the stage
        #[var(unit = ONE, range = 0.0..=1.0, start = 0.5, source = "default; nominal mass and thrust may be wrong by 30 % each")]
        pub drive_gain_ratio: f64,
        /// Maximum acceleration of the spindle
        #[var(expert, unit = RADIAN_PER_SECOND_SQUARED, range = 1.0..=1e9, start = 2e4, source = "default; 30 000 rpm in 0.16 s")]
        pub spindle_acceleration: f64,
        /// Maximum time of learning, at least learn.time; 0: automatic
        #[var(expert, unit = SECOND, range = 0.0..=1e4, start = 0.0, source = "derived: 2 learn.time + settling of the filters")]
        pub learn_time: f64,
        /// Maximum change of the force from before the contact to after the retract
        #[var(unit = NEWTON, range = 1e-6..=1e6, start = 0.2, source = "default; half of guard.force, ten sigma of the weight balancer")]
        pub residual_force: f64,
        /// Maximum bias at a calibrated speed
        #[var(expert, unit = METRE as "um", range = 1e-9..=1e-3, start = 1e-6, source = "default; twice that at 300 um/s on steel; more is a soft workpiece or a wrong position")]
        pub bias: f64,
        /// Maximum standard deviation of the touches of one speed in a calibration cycle
        #[var(expert, unit = METRE as "nm", range = 1e-10..=1e-4, start = 6e-8, source = "default; two to three times that on steel")]
        pub touch_scatter: f64,
        /// Maximum time of a cycle from enable to Done; 0: automatic
        #[var(unit = SECOND, range = 0.0..=1e9, start = 0.0, source = "derived: 1.25 (travel_max / v + v / a + settle_time + limits.learn_time + (travel_max + distance) / v_retract) + 1 s")]
        pub cycle_time: f64,
    }
    /// Kalman filter of the likelihood-ratio detector; all values are standard deviations
    pub struct Kalman {
        /// Random walk of the disturbance in one sample, standard deviation
        #[var(unit = NEWTON as "mN", range = 1e-9..=1e3, start = 5e-4, source = "default; the innovation of such stages is white")]
        pub disturbance_walk: f64,
        /// White force in one sample, standard deviation
        #[var(unit = NEWTON as "mN", range = 1e-9..=1e3, start = 5e-3, source = "default; noise of such stages")]
        pub force_noise: f64,
        /// Position noise with quantization, standard deviation
        #[var(unit = METRE as "nm", range = 1e-12..=1e-3, start = 0.6e-9, source = "default; noise of such stages")]
        pub position_noise: f64,
    }
    /// Generalized likelihood ratio over a bank of contact instants; used if the detector is Glr
    pub struct Glr {
        /// Number of contact instants in the bank, one per sample
        #[var(range = 10..=1000, start = 300, source = "default; 30 ms, the memory of the filter")] pub onsets: i32,
        /// Alarm level of the log-likelihood ratio
        #[var(unit = ONE, range = 1.0..=1e3, start = 15.0, source = "measured: 2 false alarms in 10 hours")]
        pub threshold: f64,
    }
    /// Two-stage touch: an uncertain contact is touched a second time; needs the detector Glr
    pub struct Touch {
        /// Touch a second time where a contact is suspected but not certain
        pub confirm: bool,
        /// Log-likelihood ratio of each touch above which a contact is suspected
        #[var(expert, unit = ONE, range = 1.0..=1e3, start = 7.0, source = "default; one suspicion in several seconds of noise")]
        pub suspicion: f64,
    }
    /// Approach motion
    pub struct Approach {
        /// Approach speed, sampled when an approach starts; a calibration may limit it
        #[var(essential, unit = METRE_PER_SECOND as "um/s", range = 1e-7..=0.01, start = 1e-4, source = "default; 0.3 um of depth", tunable)]
        pub velocity: f64,
        /// Acceleration to the approach speed, sampled when an approach starts
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 1e-4..=10.0, start = 0.05, source = "default; 2 ms to 100 um/s", tunable)]
        pub acceleration: f64,
        /// Maximum travel from the start position, sampled when an approach starts
        #[var(essential, unit = METRE as "mm", range = 1e-6..=1.0, start = 0.005, source = "default; 50 s at 100 um/s", tunable)]
        pub travel_max: f64,
        /// Direction of the approach: 1 if position increases towards the workpiece, otherwise -1
        #[var(essential, range = -1..=1, start = 1, source = "default; encoder counts towards the workpiece")]
        pub direction: i32,
        /// Minimum travel between touch and standstill, from delays and braking alone
        #[var(unit = METRE as "nm", calculated, source = "derived: v (1.5 + io_delay) T_s + v^2 / (2 a_stop)")]
        pub depth_limit: f64,
    }
    /// Retract motion
    pub struct Retract {
        /// Retract speed
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-6..=0.1, start = 1e-3, source = "default; 75 ms of retract")]
        pub velocity: f64,
        /// Deceleration after a detection, and acceleration of the retract
        #[var(unit = METRE_PER_SECOND_SQUARED, range = 0.01..=50.0, start = 2.0, source = "default; 1 A of this stage")]
        pub deceleration: f64,
        /// Distance of the retract, at least the travel until the detector is armed; 0: automatic
        #[var(unit = METRE as "um", range = 0.0..=0.1, start = 0.0, source = "derived: 1.2 (v^2 / (2 a) + v (settle_time + learn.time)), so that the next approach is armed before it touches")]
        pub distance: f64,
    }
    /// Bounds of the commissioning run, and use of its results
    pub struct Commission {
        /// Maximum distance from the start position; 0: automatic, at least 45 um
        #[var(unit = METRE as "um", range = 0.0..=0.1, start = 0.0, source = "derived: 1.2 (v^2 / a + v (settle_time + learn.time)), at least 45 um")]
        pub travel: f64,
        /// Maximum force in addition to the holding force, at least guard.force; 0: automatic
        #[var(unit = NEWTON, range = 0.0..=1e6, start = 0.0, source = "derived: min(M_n a_stop, K_tn I_max / 2), at least guard.force")]
        pub force: f64,
        /// Maximum time of the commissioning run; 0: automatic
        #[var(expert, unit = SECOND, range = 0.0..=1e6, start = 0.0, source = "derived: 1.25 times the motions + 1 s")]
        pub time: f64,
        /// Maximum relative standard deviation of the measured thrust constant
        #[var(expert, unit = ONE, range = 1e-6..=0.5, start = 0.02, source = "default; a hundredth of what the detector tolerates")]
        pub std_max: f64,
        /// Maximum standard deviation of the measured delay, samples, without the current loop
        #[var(expert, unit = ONE, range = 1e-3..=2.0, start = 0.25, source = "default; two of them to the next half sample")]
        pub delay_std_max: f64,
        /// Use the measured values instead of the configured ones
        #[var(source = "default; inspect the result first")] pub apply: bool,
        /// JSON file for the derived parameters, written after success; empty: none
        pub export: String,
    }
    /// Touches that calibrate the contact bias, and use of the result
    pub struct Calibration {
        /// Slowest of the five calibration speeds, which have equal ratios
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-7..=0.01, start = 1e-5, source = "default; a tenth of approach.velocity")]
        pub velocity_min: f64,
        /// Fastest of the five calibration speeds, at least three times the slowest
        #[var(unit = METRE_PER_SECOND as "um/s", range = 1e-7..=0.01, start = 3e-4, source = "default; three times approach.velocity")]
        pub velocity_max: f64,
        /// Target maximum force of a touch; faster touches are made slower; 0: no limit
        #[var(unit = NEWTON, range = 0.0..=1e4, start = 0.0, source = "default; none, set what the tool tolerates")]
        pub force_max: f64,
        /// Number of touches at each speed
        #[var(expert, range = 2..=1000, start = 4, source = "default; half of the scatter of one touch")]
        pub touches: i32,
        /// Maximum number of touches at each speed while the bias is too uncertain
        #[var(expert, range = 2..=1000, start = 8, source = "default; a minute in all")] pub touches_max: i32,
        /// Encoder position at which the tool first touches the workpiece
        #[var(unit = METRE as "um", range = -1e3..=1e3, source = "an independent measurement: no touch shows its own bias")]
        pub position: f64,
        /// Standard deviation of the configured first-touch position
        #[var(unit = METRE as "nm", range = 0.0..=1e-3, source = "uncertainty of that measurement")]
        pub position_std: f64,
        /// Maximum standard deviation of the bias at a calibrated speed
        #[var(expert, unit = METRE as "nm", range = 1e-10..=1e-3, start = 3e-8, source = "default; about the scatter of one touch")]
        pub std_max: f64,
        /// Use the calibrated bias instead of the configured one
        #[var(source = "default; inspect the result first")] pub apply: bool,
        /// JSON file for the calibrated bias, written after success; empty: none
        pub export: String,
    }
}

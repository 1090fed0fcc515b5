//! Sensor-less micro-tool contact detection with a disturbance observer (Kakinuma and Nagakari, 2017), as an FMU.
//!
//! This file is the FMU: its variables and the calls into the law. [`controller::Controller`] is the law,
//! plain Rust that knows nothing of FMI.
#![forbid(unsafe_code)]

pub mod check;
pub mod contact;
pub mod controller;
pub mod cusum;
pub mod depth_limit;
pub mod detector;
pub mod deviation;
pub mod glr;
pub mod guard;
pub mod kalman;
pub mod machine;
pub mod motion;
pub mod notch;
pub mod observer;
pub mod parameters;
pub mod reading;
pub mod servo;
pub mod signals;
pub mod slope;
pub mod threshold;

use fmi2_export::units::{
    AMPERE, HERTZ, KILOGRAM, METRE, METRE_PER_SECOND, METRE_PER_SECOND_SQUARED, NEWTON, NEWTON_PER_AMPERE,
    NEWTON_PER_SECOND, ONE, RADIAN_PER_SECOND, SECOND,
};
use fmi2_export::{
    Enumeration, Env, Error, Info, Model, Start, Unit, Variable, boolean, choice, enumeration, export, integer, real,
};
use serde::{Deserialize, Serialize};

use controller::Controller;
use detector::DetectorKind;
use machine::{ContactSource, Fault, State};
use parameters::Parameters;
use signals::{Input, Output};
use threshold::ThresholdMode;

enumeration! { State, "What the controller is doing" {
    Idle = 1, "Holds its position and waits for `start`",
    Approach = 2, "Accelerates and settles at constant speed",
    Learn = 3, "Learns the noise at constant speed",
    Detect = 4, "Watches for contact",
    Contact = 5, "Has detected contact and decelerates",
    Retract = 6, "Moves back",
    Done = 7, "Holds its position after the retract; a new `start` begins again",
    Fault = 8, "Decelerates, moves back if it was approaching, then holds; a new `start` begins again",
} }

enumeration! { Fault, "Why the controller is in the fault state" {
    None = 1, "No fault",
    TravelLimit = 2, "No contact within `approach.travel_max`",
    LostSync = 3, "`position_valid` was false for more than 3 samples",
    Saturation = 4, "The current was at its limit for more than 50 samples",
    LearnRejected = 5, "The learned slope is too wild, not around zero, or silent",
    InvalidInput = 6, "`position` or `spindle_speed` is NaN, infinite or absurd",
} }

enumeration! { ContactSource, "What detected the contact" {
    None = 1, "No contact",
    Raw = 2, "Notched force",
    Deviation = 3, "Deviation from the moving average",
    Slope = 4, "Slope over one window",
    MultiSlope = 5, "Slope over four windows",
    Cusum = 6, "Cumulative sum of the Kalman innovation",
    Glr = 7, "Generalised likelihood ratio of the Kalman innovation",
    ForceGuard = 8, "Hard force guard",
} }

enumeration! { DetectorKind, "Which detector decides" {
    Raw = 1, "Notched force",
    Deviation = 2, "Deviation from the moving average",
    Slope = 3, "Slope over one window, as in the paper",
    MultiSlope = 4, "Slope over 20, 50, 100 and 200 samples side by side",
    Cusum = 5, "Cumulative sum of the Kalman innovation",
    Glr = 6, "Generalised likelihood ratio of the Kalman innovation",
} }

enumeration! { ThresholdMode, "Where alpha of the threshold mu + alpha sigma comes from" {
    Fixed = 1, "`threshold.alpha`, as in the paper",
    Automatic = 2, "`threshold.false_alarm_interval` and the learned crossing rate",
} }

/// Parameters that follow from others.
#[derive(Clone, Serialize, Deserialize)]
pub struct Calculated {
    /// Of the approach motion.
    pub approach: CalculatedApproach,
}

/// Parameters of the approach that follow from others.
#[derive(Clone, Serialize, Deserialize)]
pub struct CalculatedApproach {
    /// Least travel between touch and standstill, m.
    pub depth_limit: f64,
}

/// All variables of the FMU.
#[derive(Clone, Serialize, Deserialize)]
pub struct Vars {
    /// Inputs of the law.
    pub input: Input,
    /// Outputs of the law.
    pub output: Output,
    /// Parameters of the law.
    pub parameters: Parameters,
    /// Parameters that follow from others.
    pub calculated: Calculated,
}

impl Start for Vars {
    const START: Self = Self {
        input: Input::START,
        output: Output::START,
        parameters: Parameters::DEFAULT,
        calculated: Calculated { approach: CalculatedApproach { depth_limit: 0.0 } },
    };
}

/// Unit of the integral gain.
const PER_SECOND_CUBED: Unit = Unit::si("1/s3", [0, 0, -3, 0, 0], &[]);

/// The FMU.
pub struct Dob;

impl Model for Dob {
    const INFO: Info = Info {
        name: "DisturbanceObserverContactDetection",
        identifier: "fmu_dob",
        description: "Detects the contact of a micro tool without a sensor, from the disturbance observer of the \
                      stage (Kakinuma and Nagakari, CIRP Annals 66, 2017)",
        state_version: 1,
        stop_time: 2.0,
        step_size: 1e-4,
        ..fmi2_export::package!()
    };
    type Vars = Vars;
    type State = Controller;

    #[rustfmt::skip]
    const VARIABLES: &'static [Variable<Vars>] = &[
        // inputs
        real!(Vars.input => position).input().unit(&METRE).display("um").accepts_nan().describe("Encoder position z"),
        boolean!(Vars.input => position_valid).input().describe("Encoder and its link are good; false for more than 3 samples is the fault LostSync"),
        real!(Vars.input => spindle_speed).input().unit(&RADIAN_PER_SECOND).display("rpm").accepts_nan().describe("Spindle speed; 0 switches the notches off"),
        boolean!(Vars.input => start).input().describe("Rising edge begins an approach from Idle, Done or, after the retract, Fault"),
        boolean!(Vars.input => abort).input().describe("Ends an approach: decelerate, retract, Done; blocks `start`"),
        // outputs
        real!(Vars.output => current).output().unit(&AMPERE).describe("Quantised current command I_a^ref"),
        choice!(Vars.output => state: State).output().describe("What the controller is doing"),
        choice!(Vars.output => fault: Fault).output().describe("Why it is in the state Fault; kept until the next start"),
        boolean!(Vars.output => aborted).output().describe("The approach was ended by `abort`; kept until the next start"),
        boolean!(Vars.output => contact).output().describe("Contact was detected; kept until the next start"),
        choice!(Vars.output => contact_source: ContactSource).output().describe("What detected the contact"),
        real!(Vars.output => contact_position).output().unit(&METRE).display("um").describe("Encoder position at the detection, as in the paper"),
        real!(Vars.output => contact_position_estimate).output().unit(&METRE).display("um").describe("Position of the first touch: `contact_position` less `contact.bias` in the direction of approach"),
        real!(Vars.output => contact_time).output().unit(&SECOND).describe("Time of the detection"),
        real!(Vars.output => force.disturbance).output().unit(&NEWTON).display("mN").describe("Estimated disturbance force F_dis, eq. 1; positive when the workpiece pushes back"),
        real!(Vars.output => force.notched).output().unit(&NEWTON).display("mN").describe("Disturbance force without spindle harmonics"),
        real!(Vars.output => force.deviation).output().unit(&NEWTON).display("mN").describe("Deviation from the moving average, eq. 2"),
        real!(Vars.output => force.slope).output().unit(&NEWTON_PER_SECOND).describe("Slope a_k of the deviation over `slope.window`, eq. 3"),
        real!(Vars.output => threshold.mean).output().unit(&NEWTON_PER_SECOND).describe("Learned mean mu of the slope"),
        real!(Vars.output => threshold.sigma).output().unit(&NEWTON_PER_SECOND).describe("Learned standard deviation sigma of the slope"),
        real!(Vars.output => threshold.value).output().unit(&NEWTON_PER_SECOND).describe("Threshold mu + alpha sigma of the slope"),
        real!(Vars.output => threshold.alpha_used).output().unit(&ONE).describe("The alpha in use"),
        real!(Vars.output => threshold.crossing_rate).output().unit(&HERTZ).describe("Learned rate nu_0 at which the slope crosses its mean upwards"),
        real!(Vars.output => reference.position).output().unit(&METRE).display("um").describe("Position reference of the servo"),
        real!(Vars.output => reference.velocity).output().unit(&METRE_PER_SECOND).display("um/s").describe("Velocity reference of the servo"),
        real!(Vars.output => tracking_error).output().unit(&METRE).display("nm").describe("Reference less position; 0 while the position is lost"),
        // stage, servo and observer
        real!(Vars.parameters => sample_period).parameter().unit(&SECOND).display("us").range(2e-5, 1e-3).describe("Sample period T_s"),
        real!(Vars.parameters => stage.mass).parameter().unit(&KILOGRAM).range(0.01, 1e4).describe("Nominal moving mass M_n"),
        real!(Vars.parameters => stage.force_constant).parameter().unit(&NEWTON_PER_AMPERE).range(0.01, 1e4).describe("Nominal thrust constant K_tn"),
        real!(Vars.parameters => stage.current_max).parameter().unit(&AMPERE).range(0.01, 1e3).describe("Largest current"),
        integer!(Vars.parameters => stage.current_bits).parameter().range_int(8, 24).describe("Resolution of the current command over +-`stage.current_max`, bit"),
        integer!(Vars.parameters => stage.io_delay).parameter().range_int(0, 8).describe("Samples between a command and its action; 1 for a standard master, 0 if the command acts at once"),
        real!(Vars.parameters => stage.current_bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(100.0, 1e6).describe("Bandwidth of the current loop, for the Kalman filter"),
        real!(Vars.parameters => servo.bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(1.0, 2e3).describe("Natural frequency omega_n of the position servo"),
        real!(Vars.parameters => servo.damping).parameter().unit(&ONE).range(0.1, 5.0).describe("Damping ratio zeta of the position servo"),
        boolean!(Vars.parameters => servo.disturbance_compensation).parameter().describe("Feed the estimated disturbance back; if not, integrate the error"),
        real!(Vars.parameters => servo.integral_gain).parameter().unit(&PER_SECOND_CUBED).range(0.0, 1e9).describe("Integral gain K_i, used without disturbance compensation"),
        real!(Vars.parameters => observer.bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(10.0, 1e4).describe("Cut-off g_dis of the disturbance observer"),
        real!(Vars.parameters => observer.velocity_bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(10.0, 5e4).describe("Cut-off g_v of the velocity estimate"),
        // signal chain and detection
        integer!(Vars.parameters => notch.harmonics).parameter().range_int(0, 4).describe("Number of spindle harmonics removed"),
        real!(Vars.parameters => notch.quality).parameter().unit(&ONE).range(0.5, 100.0).describe("Quality Q of each notch"),
        integer!(Vars.parameters => deviation.window).parameter().range_int(10, 100_000).describe("Samples r of the moving average, eq. 2"),
        integer!(Vars.parameters => slope.window).parameter().range_int(3, 1000).describe("Samples N of the least-squares slope, eq. 3"),
        choice!(Vars.parameters => detector: DetectorKind).parameter().describe("Which detector decides"),
        choice!(Vars.parameters => threshold.mode: ThresholdMode).parameter().describe("Where alpha comes from"),
        real!(Vars.parameters => threshold.alpha).parameter().unit(&ONE).range(1.0, 50.0).describe("Fixed alpha"),
        real!(Vars.parameters => threshold.false_alarm_interval).parameter().unit(&SECOND).range(1.0, 1e9).describe("Wished mean time between false alarms, for the automatic alpha"),
        integer!(Vars.parameters => threshold.row).parameter().range_int(1, 100).describe("Samples in a row above the threshold that make a detection"),
        real!(Vars.parameters => learn.settle_time).parameter().unit(&SECOND).range(0.0, 100.0).describe("Time at constant speed before learning"),
        real!(Vars.parameters => learn.time).parameter().unit(&SECOND).range(1e-3, 100.0).describe("Time of learning"),
        real!(Vars.parameters => learn.slope_sigma_max).parameter().unit(&NEWTON_PER_SECOND).range(1e-6, 1e6).describe("Largest believable sigma of the slope"),
        real!(Vars.parameters => kalman.disturbance_walk).parameter().unit(&NEWTON).display("mN").range(1e-9, 1e3).describe("Random walk of the disturbance in one sample, standard deviation"),
        real!(Vars.parameters => kalman.harmonic_walk).parameter().unit(&NEWTON).display("mN").range(1e-9, 1e3).describe("Random walk of each spindle harmonic in one sample, standard deviation"),
        real!(Vars.parameters => kalman.force_noise).parameter().unit(&NEWTON).display("mN").range(1e-9, 1e3).describe("White force in one sample, standard deviation"),
        real!(Vars.parameters => kalman.position_noise).parameter().unit(&METRE).display("nm").range(1e-12, 1e-3).describe("Position noise with quantisation, standard deviation"),
        real!(Vars.parameters => cusum.drift).parameter().unit(&ONE).range(0.0, 5.0).describe("Subtracted from the normalised innovation in each sample"),
        real!(Vars.parameters => cusum.threshold).parameter().unit(&ONE).range(1.0, 1e3).describe("Alarm level of the cumulative sum"),
        integer!(Vars.parameters => glr.onsets).parameter().range_int(10, 1000).describe("Contact instants in the bank, one per sample"),
        real!(Vars.parameters => glr.threshold).parameter().unit(&ONE).range(1.0, 1e3).describe("Alarm level of the log-likelihood ratio"),
        // motion, guard and contact position
        real!(Vars.parameters => approach.velocity).tunable().unit(&METRE_PER_SECOND).display("um/s").range(1e-7, 0.01).describe("Approach speed v; counts at `start`"),
        real!(Vars.parameters => approach.acceleration).tunable().unit(&METRE_PER_SECOND_SQUARED).range(1e-4, 10.0).describe("Acceleration to the approach speed; counts at `start`"),
        real!(Vars.parameters => approach.travel_max).tunable().unit(&METRE).display("mm").range(1e-6, 1.0).describe("Longest travel from the start position; counts at `start`"),
        integer!(Vars.parameters => approach.direction).parameter().range_int(-1, 1).describe("1 if `position` counts up towards the workpiece, -1 if down"),
        real!(Vars.calculated => approach.depth_limit).calculated().unit(&METRE).display("nm").describe("Least travel between touch and standstill, from delays and braking alone"),
        real!(Vars.parameters => retract.velocity).parameter().unit(&METRE_PER_SECOND).display("um/s").range(1e-6, 0.1).describe("Retract speed"),
        real!(Vars.parameters => retract.deceleration).parameter().unit(&METRE_PER_SECOND_SQUARED).range(0.01, 50.0).describe("Deceleration a_stop after a detection, and acceleration of the retract"),
        real!(Vars.parameters => retract.distance).parameter().unit(&METRE).display("um").range(1e-7, 0.1).describe("Distance of the retract"),
        real!(Vars.parameters => guard.force).parameter().unit(&NEWTON).range(1e-3, 1e4).describe("Force change that stops the approach whatever the detector says; must exceed the cogging"),
        real!(Vars.parameters => contact.bias).tunable().unit(&METRE).display("nm").range(-1e-3, 1e-3).describe("Travel between first touch and detection, from a calibration touch"),
    ];

    fn period(vars: &Vars) -> f64 {
        vars.parameters.sample_period
    }

    fn calculate(vars: &mut Vars) {
        vars.calculated.approach.depth_limit = depth_limit::depth_limit(&vars.parameters);
    }

    fn initialise(vars: &mut Vars, _: &mut Env) -> Result<Controller, Error> {
        Controller::new(&vars.parameters).map_err(|error| error.to_string().into())
    }

    fn tick(vars: &mut Vars, controller: &mut Controller, env: &mut Env) -> Result<(), Error> {
        let before = vars.output.state;
        vars.output = controller.tick(&vars.parameters, env.time(), &vars.input);
        if vars.output.state != before {
            tell(vars, env);
        }
        Ok(())
    }
}

export!(Dob);

/// One log line for a new state.
fn tell(vars: &Vars, env: &mut Env) {
    let Output { state, fault, threshold, .. } = &vars.output;
    match state {
        State::Fault => {
            let value = match fault {
                Fault::TravelLimit => format!(" = `{} m`", vars.parameters.approach.travel_max),
                Fault::LearnRejected => format!(
                    ": mean `{} N/s`, sigma `{} N/s`, limit `learn.slope_sigma_max` = `{} N/s`",
                    threshold.mean, threshold.sigma, vars.parameters.learn.slope_sigma_max
                ),
                Fault::InvalidInput => {
                    format!(": `{} m`, `{} rad/s`", vars.input.position, vars.input.spindle_speed)
                }
                _ => String::new(),
            };
            env.warn(format_args!("fault `{fault:?}`: {}{value}", meaning::<Fault>(*fault as usize)));
        }
        _ => env.event(format_args!("state `{state:?}`: {}", meaning::<State>(*state as usize))),
    }
}

/// What the model description says about the item `number` of an enumeration.
fn meaning<E: Enumeration>(number: usize) -> &'static str {
    E::TYPE.items[number - 1].description
}

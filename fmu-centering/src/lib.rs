//! Centring of a ring on a rotating table by pushes (Mears, Kolartis, Thompson and Kurfess, 2007), as an FMU.
//!
//! This file is the FMU: its variables and the calls into the law. [`controller::Controller`] is the law,
//! plain Rust that knows nothing of FMI.
#![forbid(unsafe_code)]

pub mod aim;
pub mod belief;
pub mod centre;
pub mod check;
pub mod contact;
pub mod controller;
pub mod despike;
pub mod experience;
pub mod follow;
pub mod frozen;
pub mod kalman;
pub mod launch;
pub mod law;
pub mod limits;
pub mod machine;
pub mod model;
pub mod motion;
pub mod offset;
pub mod paper;
pub mod parameters;
pub mod plan;
pub mod predictive;
pub mod press;
pub mod profile;
pub mod push;
pub mod rates;
pub mod reading;
pub mod ring_model;
pub mod signals;
pub mod sine_fit;
pub mod spindle;
pub mod stroke;
pub mod supervision;
pub mod tap;

use fmi2_export::units::{
    HERTZ, KILOGRAM, METRE, METRE_PER_SECOND, METRE_PER_SECOND_SQUARED, NEWTON_PER_METRE, ONE, RADIAN,
    RADIAN_PER_SECOND, SECOND,
};
use fmi2_export::{
    Enumeration, Env, Error, Info, Model, Start, Unit, Variable, boolean, choice, enumeration, export, integer, real,
};
use serde::{Deserialize, Serialize};

use controller::Controller;
use law::Method;
use machine::{Fault, State};
use offset::OffsetMethod;
use parameters::Parameters;
use signals::{Input, Output};

enumeration! { State, "What the controller is doing" {
    Idle = 1, "Moves back to where it started, holds, and waits for `enable`",
    Approach = 2, "Moves towards the ring until the probe touches it",
    Follow = 3, "Brings the pusher to its gap before the ring",
    Collect = 4, "Follows and collects the surface",
    Model = 5, "Makes the model of the ring",
    Wait = 6, "Follows until the ring is where the push must begin",
    Push = 7, "Pushes",
    Settle = 8, "Retracts after a push and follows again",
    Centred = 9, "The ring is centred; follows it until `enable` is false",
    Fault = 10, "Moves back to where it started and holds until `reset_fault`",
} }

enumeration! { Fault, "Why the controller is in the fault state" {
    None = 1, "No fault",
    NoPart = 2, "No ring within `approach.travel`, or the probe has lost it",
    RingTooSmall = 3, "The spindle axis is not inside the ring: r <= B",
    ProbeRange = 4, "The probe is beyond `probe.stroke`, does not settle, or the pusher touches while following",
    Centrifugal = 5, "The centrifugal force exceeds the friction of `friction.mu_limit`",
    PushBudget = 6, "Not centred within `push.max_count` pushes",
    InvalidInput = 7, "An input is NaN, infinite, absurd, has jumped, or the probe is frozen",
    Spindle = 8, "The spindle stands still, keeps reversing, or is too fast for `rates.collect`",
    Diverged = 9, "The pushes have moved the ring away from the axis by more than `push.critical_distance`",
    Unresolved = 10, "A full revolution does not tell the eccentricity from the tolerance: raise `tolerance`",
} }

enumeration! { Method, "How the ring is centred" {
    Paper = 1, "As in the paper: one revolution, one sine, one push",
    Predictive = 2, "Recursive model of the ring, pushes planned backwards from the centre",
} }

enumeration! { OffsetMethod, "What is learned after a push" {
    Off = 1, "Nothing",
    Recursive = 2, "The difference between wished and actual way of the ring, as in the paper",
} }

/// Parameters that follow from others.
#[derive(Clone, Serialize, Deserialize)]
pub struct Calculated {
    /// Of the approach.
    pub approach: CalculatedApproach,
}

/// Parameters of the approach that follow from others.
#[derive(Clone, Serialize, Deserialize)]
pub struct CalculatedApproach {
    /// Stroke of the probe before the pusher that the fastest approach needs, m.
    pub look_ahead: f64,
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
        calculated: Calculated { approach: CalculatedApproach { look_ahead: 0.0 } },
    };
}

/// Unit of a velocity per length.
const PER_SECOND: Unit = Unit::si("1/s", [0, 0, -1, 0, 0], &[]);

/// The FMU.
pub struct Centering;

impl Model for Centering {
    const INFO: Info = Info {
        name: "RingCentering",
        identifier: "fmu_centering",
        description: "Centres a ring on a rotating table by pushes of a slide with a probe (Mears et al., Design of \
                      a Flexible Centering Tooling System, 2007)",
        state_version: 1,
        stop_time: 60.0,
        step_size: 1e-3,
        ..fmi2_export::package!()
    };
    type Vars = Vars;
    type State = Controller;

    #[rustfmt::skip]
    const VARIABLES: &'static [Variable<Vars>] = &[
        // inputs
        real!(Vars.input => spindle_angle).input().unit(&RADIAN).display("deg").accepts_nan().describe("Angle of the spindle, wrapped or not; positive about the upward axis"),
        real!(Vars.input => slide_position).input().unit(&METRE).display("mm").accepts_nan().describe("Slide encoder, positive towards the spindle axis"),
        real!(Vars.input => probe_position).input().unit(&METRE).display("mm").accepts_nan().describe("Probe encoder: its collapse, 0 when free"),
        boolean!(Vars.input => enable).input().describe("Rising edge in Idle begins a centring; false ends it: stop, move back, Idle"),
        boolean!(Vars.input => reset_fault).input().describe("Rising edge ends the state Fault: Idle, which waits for a rising edge of `enable`"),
        // outputs
        real!(Vars.output => slide.position_setpoint).output().unit(&METRE).display("mm").describe("Position command to the servo of the slide"),
        real!(Vars.output => slide.velocity_setpoint).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Velocity command to the servo of the slide"),
        choice!(Vars.output => state: State).output().describe("What the controller is doing"),
        choice!(Vars.output => fault: Fault).output().describe("Why it is in the state Fault; kept until the next start"),
        boolean!(Vars.output => centred).output().describe("The ring was centred; kept until the next start"),
        real!(Vars.output => time_to_centre).output().unit(&SECOND).describe("From the start to `centred`"),
        real!(Vars.output => eccentricity).output().unit(&METRE).display("um").describe("Distance B of the ring's centre from the spindle axis in the last model"),
        real!(Vars.output => eccentricity_angle).output().unit(&RADIAN).display("deg").describe("Spindle angle at which the ring is nearest to the pusher"),
        real!(Vars.output => eccentricity_sigma).output().unit(&METRE).display("nm").describe("Standard deviation of the measured eccentricity"),
        real!(Vars.output => spindle_speed).output().unit(&RADIAN_PER_SECOND).display("rpm").describe("Estimated spindle speed"),
        real!(Vars.output => pusher_gap).output().unit(&METRE).display("um").describe("Gap between pusher and ring as the probe says"),
        integer!(Vars.output => push.count).output().describe("Pushes since the start"),
        real!(Vars.output => push.distance).output().unit(&METRE).display("um").describe("Travel d of the last push, with gap and offset"),
        real!(Vars.output => push.velocity).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Velocity v of the last push"),
        real!(Vars.output => push.lead_angle).output().unit(&RADIAN).display("deg").describe("Lead angle L of the last push"),
        real!(Vars.output => push.offset).output().unit(&METRE).display("um").describe("Learned offset P"),
        real!(Vars.output => push.overshoot).output().unit(&METRE).display("um").describe("How far the last push moved the ring through the centre"),
        real!(Vars.output => push.overshoot_max).output().unit(&METRE).display("um").describe("Largest overshoot since the start"),
        // task and machine
        real!(Vars.parameters => sample_period).parameter().unit(&SECOND).display("ms").range(1e-4, 0.01).describe("Sample period of the setpoints"),
        real!(Vars.parameters => tolerance).parameter().unit(&METRE).display("um").range(1e-8, 1e-3).describe("Largest eccentricity of a centred ring"),
        choice!(Vars.parameters => method: Method).parameter().describe("How the ring is centred"),
        real!(Vars.parameters => ring.radius).parameter().unit(&METRE).display("mm").range(1e-3, 2.0).describe("Nominal outer radius r of the ring"),
        real!(Vars.parameters => ring.eccentricity_max).parameter().unit(&METRE).display("mm").range(1e-6, 1.0).describe("Largest eccentricity expected, for the look-ahead of the approach"),
        real!(Vars.parameters => probe.at_pusher).parameter().unit(&METRE).display("mm").range(1e-4, 0.5).describe("Collapse of the probe at which the pusher touches the ring"),
        real!(Vars.parameters => probe.stroke).parameter().unit(&METRE).display("mm").range(1e-4, 0.5).describe("Stroke of the probe"),
        real!(Vars.parameters => probe.contact).parameter().unit(&METRE).display("um").range(1e-6, 0.01).describe("Collapse of the probe that counts as touching"),
        real!(Vars.parameters => slide.velocity_max).parameter().unit(&METRE_PER_SECOND).display("mm/s").range(1e-3, 10.0).describe("Largest velocity of the slide"),
        real!(Vars.parameters => slide.acceleration_max).parameter().unit(&METRE_PER_SECOND_SQUARED).range(0.01, 100.0).describe("Acceleration a of all moves"),
        integer!(Vars.parameters => slide.io_delay).parameter().range_int(0, 8).describe("Samples between a setpoint and its action; 1 for a standard master, 0 if it acts at once"),
        real!(Vars.parameters => slide.servo_bandwidth).parameter().unit(&HERTZ).range(0.0, 1e3).describe("Bandwidth of the servo of the slide, for feed-forward; 0 for none"),
        real!(Vars.parameters => spindle.quantum).parameter().unit(&RADIAN).display("deg").range(0.0, 0.1).describe("Resolution of the spindle encoder"),
        real!(Vars.parameters => spindle.window).parameter().unit(&SECOND).range(0.1, 5.0).describe("Length of the regression for angle and speed"),
        real!(Vars.parameters => spindle.speed_min).parameter().unit(&RADIAN_PER_SECOND).display("rpm").range(1e-3, 10.0).describe("A slower spindle stands still"),
        real!(Vars.parameters => friction.mu_limit).parameter().unit(&ONE).range(1e-3, 2.0).describe("Friction mu_s that the centrifugal force must not exceed, eq. 2"),
        // approach, following, rates
        real!(Vars.parameters => approach.velocity).parameter().unit(&METRE_PER_SECOND).display("mm/s").range(1e-4, 10.0).describe("Velocity of the approach and of the way back"),
        real!(Vars.parameters => approach.travel).parameter().unit(&METRE).display("mm").range(1e-3, 10.0).describe("Longest travel from the start position"),
        real!(Vars.calculated => approach.look_ahead).calculated().unit(&METRE).display("mm").describe("Stroke of the probe before the pusher that the fastest approach needs, eq. 9"),
        real!(Vars.parameters => follow.gain).parameter().unit(&PER_SECOND).range(0.1, 1e3).describe("Velocity per error Kp of following"),
        real!(Vars.parameters => follow.gap).parameter().unit(&METRE).display("um").range(1e-5, 0.1).describe("Gap between pusher and ring while following"),
        real!(Vars.parameters => follow.dead_zone).parameter().unit(&METRE).display("um").range(0.0, 0.1).describe("Error of following without reaction"),
        real!(Vars.parameters => follow.settle_band).parameter().unit(&METRE).display("um").range(1e-6, 0.1).describe("Error of following that counts as settled"),
        real!(Vars.parameters => follow.settle_time).parameter().unit(&SECOND).range(0.0, 10.0).describe("Time within that band"),
        real!(Vars.parameters => rates.control).parameter().unit(&HERTZ).range(1.0, 1e4).describe("Rate of following and launching"),
        real!(Vars.parameters => rates.collect).parameter().unit(&HERTZ).range(1.0, 1e4).describe("Rate of collecting"),
        real!(Vars.parameters => rates.model).parameter().unit(&HERTZ).range(0.1, 1e4).describe("Rate of modelling"),
        // model, push, learning
        real!(Vars.parameters => kalman.process_noise).parameter().unit(&METRE).display("nm").range(1e-9, 1e-3).describe("Walk of the surface from sample to sample sqrt(Q)"),
        real!(Vars.parameters => kalman.measurement_noise).parameter().unit(&METRE).display("nm").range(1e-9, 1e-3).describe("Noise of the measurement sqrt(R)"),
        real!(Vars.parameters => push.velocity_min).parameter().unit(&METRE_PER_SECOND).display("um/s").range(1e-6, 1.0).describe("Velocity v_min of the smallest push"),
        real!(Vars.parameters => push.velocity_max).parameter().unit(&METRE_PER_SECOND).display("um/s").range(1e-6, 1.0).describe("Velocity v_max of a large push"),
        real!(Vars.parameters => push.critical_distance).parameter().unit(&METRE).display("um").range(1e-6, 0.1).describe("Eccentricity d_crit from which a push is large"),
        real!(Vars.parameters => push.steepness).parameter().unit(&ONE).range(0.1, 10.0).describe("Steepness s of the velocity below it"),
        real!(Vars.parameters => push.dwell).parameter().unit(&SECOND).display("ms").range(0.0, 1.0).describe("Time at the end of the stroke, before the retract"),
        integer!(Vars.parameters => push.max_count).parameter().range_int(1, 1000).describe("Most pushes of one centring"),
        choice!(Vars.parameters => offset.method: OffsetMethod).parameter().describe("What is learned after a push"),
        real!(Vars.parameters => offset.gate).parameter().unit(&METRE).display("um").range(1e-6, 1.0).describe("Only pushes of a smaller eccentricity teach"),
        real!(Vars.parameters => offset.limit).parameter().unit(&METRE).display("um").range(0.0, 0.01).describe("Largest offset in either direction"),
        // default mode
        real!(Vars.parameters => park.probe).parameter().unit(&METRE).display("mm").range(1e-4, 0.5).describe("Collapse of the probe while the slide is parked"),
        real!(Vars.parameters => park.dead_zone).parameter().unit(&METRE).display("mm").range(0.0, 0.1).describe("Change of that collapse without reaction of the slide"),
        real!(Vars.parameters => estimator.noise).parameter().unit(&METRE).display("nm").range(1e-9, 1e-3).describe("Standard deviation of one measurement"),
        real!(Vars.parameters => estimator.centre).parameter().unit(&METRE).display("mm").range(1e-6, 0.1).describe("Standard deviation of the centre before the first measurement"),
        real!(Vars.parameters => estimator.form).parameter().unit(&METRE).display("um").range(0.0, 1e-3).describe("Standard deviation of each form coefficient before the first measurement; 0 for a round ring"),
        real!(Vars.parameters => estimator.gate).parameter().unit(&ONE).range(1.0, 1e6).describe("Innovations beyond this many standard deviations are dirt"),
        boolean!(Vars.parameters => estimator.partial).parameter().describe("A part of a revolution may suffice for a push"),
        real!(Vars.parameters => estimator.certainty).parameter().unit(&ONE).range(0.01, 1.0).describe("Largest relative standard deviation of the eccentricity for a push"),
        real!(Vars.parameters => estimator.margin).parameter().unit(&ONE).range(0.0, 10.0).describe("Standard deviations by which a centred ring stays within `tolerance`"),
        real!(Vars.parameters => stroke.duration).parameter().unit(&SECOND).display("ms").range(0.01, 1.0).describe("Shortest time from contact to rest"),
        real!(Vars.parameters => stroke.deceleration).parameter().unit(&METRE_PER_SECOND_SQUARED).range(0.01, 10.0).describe("Largest deceleration at the end of a push"),
        real!(Vars.parameters => stroke.velocity_max).parameter().unit(&METRE_PER_SECOND).display("mm/s").range(1e-4, 1.0).describe("Largest velocity at contact"),
        real!(Vars.parameters => stroke.hold).parameter().unit(&SECOND).display("ms").range(0.0, 1.0).describe("Longest wait at the end for the surface to arrive"),
        real!(Vars.parameters => stroke.feedback).parameter().unit(&PER_SECOND).range(0.0, 200.0).describe("Integral gain from the place of the surface to the slide; 0 for none"),
        boolean!(Vars.parameters => stroke.phase_plan).parameter().describe("Rotation and friction during the push are planned"),
        boolean!(Vars.parameters => learn.lateral).parameter().describe("The lateral ratio is learned"),
        real!(Vars.parameters => learn.lateral_start).parameter().unit(&ONE).range(0.0, 1.0).describe("Lateral ratio before the first push: slip across the push over slip along it"),
        real!(Vars.parameters => learn.lateral_sigma).parameter().unit(&ONE).range(0.01, 1.0).describe("Its standard deviation"),
        boolean!(Vars.parameters => learn.contact).parameter().describe("The probe position at contact is learned"),
        boolean!(Vars.parameters => learn.deflection).parameter().describe("The deflection of the servo is learned"),
        boolean!(Vars.parameters => learn.recoil).parameter().describe("The way of the ring after a push is learned"),
        boolean!(Vars.parameters => tap.enabled).parameter().describe("Heavy rings are tapped"),
        real!(Vars.parameters => tap.reach).parameter().unit(&ONE).range(0.1, 100.0).describe("Largest distance for a tap, in deflections of the servo"),
        real!(Vars.parameters => tap.deflection_min).parameter().unit(&METRE).display("um").range(1e-7, 1e-3).describe("A ring that deflects the servo less is light"),
        real!(Vars.parameters => tap.speed_max).parameter().unit(&METRE_PER_SECOND).display("mm/s").range(1e-3, 1.0).describe("Largest speed of a tap"),
        real!(Vars.parameters => tap.tip_stiffness).parameter().unit(&NEWTON_PER_METRE).range(1e4, 1e9).describe("Stiffness of the pusher tip, for the first tap"),
        real!(Vars.parameters => tap.slide_mass).parameter().unit(&KILOGRAM).range(0.1, 1e3).describe("Moving mass of the slide, for the first tap"),
    ];

    fn period(vars: &Vars) -> f64 {
        vars.parameters.sample_period
    }

    fn calculate(vars: &mut Vars) {
        vars.calculated.approach.look_ahead = limits::look_ahead(&vars.parameters);
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

export!(Centering);

/// One log line for a new state.
fn tell(vars: &Vars, env: &mut Env) {
    let Output { state, fault, push, spindle_speed, .. } = &vars.output;
    let (eccentricity, sigma) = (1e6 * vars.output.eccentricity, 1e6 * vars.output.eccentricity_sigma);
    match state {
        State::Fault => {
            let Input { spindle_angle, slide_position, probe_position, .. } = &vars.input;
            let value = match fault {
                Fault::NoPart => format!(": probe at `{probe_position:.6} m`, slide at `{slide_position:.6} m`"),
                Fault::RingTooSmall => {
                    format!(": r = `{} m`, B = `{eccentricity:.2} um`", vars.parameters.ring.radius)
                }
                Fault::ProbeRange => format!(": probe at `{probe_position:.6} m`"),
                Fault::Centrifugal => {
                    format!(": `{spindle_speed:.3} rad/s`, B of the last model `{eccentricity:.2} um`")
                }
                Fault::PushBudget | Fault::Diverged => {
                    format!(": `{}` pushes, B = `{eccentricity:.2} um`", push.count)
                }
                Fault::InvalidInput => format!(": `{spindle_angle} rad`, `{slide_position} m`, `{probe_position} m`"),
                Fault::Spindle => format!(": `{spindle_speed:.3} rad/s`"),
                Fault::Unresolved => format!(": B = `{eccentricity:.3} um`, standard deviation `{sigma:.3} um`"),
                Fault::None => String::new(),
            };
            env.warn(format_args!("fault `{fault:?}`: {}{value}", meaning::<Fault>(*fault as usize)));
        }
        State::Wait | State::Centred => env.event(format_args!(
            "state `{state:?}`: {}; eccentricity `{eccentricity:.2} um`",
            meaning::<State>(*state as usize)
        )),
        _ => env.event(format_args!("state `{state:?}`: {}", meaning::<State>(*state as usize))),
    }
}

/// What the model description says about the item `number` of an enumeration.
fn meaning<E: Enumeration>(number: usize) -> &'static str {
    E::TYPE.items[number - 1].description
}
